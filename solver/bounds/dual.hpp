#pragma once
// What a quantity of a state is made of: the loads l of a dual solution, and what is known without it [theory: B.12].

#include "kerf/bounds.hpp"
#include "solver/nucleus.hpp"
#include "solver/post/crack_tip.hpp"
#include "solver/system.hpp"

namespace kerf {

/// A number and what it may be off by.
struct Known {
  double value = 0, error = 0;
};

/// Q(u) = known + l(u) for the state u of a model.
struct DualProblem {
  Scene loads;  // on the labels and components of the model, all else 0
  Known known;
  std::string estimate;  // why these loads, which are sampled, prove nothing; empty: they do
};

/// The singular field G over the whole body, which is of one isotropic material and has no body force and no
/// eigenstrain: tractions on its boundary and on the faces of its cracks but `own`, whose faces G leaves free.
DualProblem global_dual(const Model& model, const Nucleus& G, const Vec2& singular, Index own);

/// A disc about a point, in one isotropic material without eigenstrain, that holds no end of the body but the straight
/// piece of a crack that ends at its middle.
struct CutOffDisc {
  Vec2 middle = Vec2::Zero();
  double radius = 0;
  const CrackTip* tip = nullptr;
};
/// G cut off within the disc, so that nothing else of the body matters: a body force and an eigenstrain in the ring
/// where it fades [theory: B.20]. Not for materials that are incompressible.
DualProblem local_dual(const Model& model, const Nucleus& G, const CutOffDisc& disc);

/// Of a disc, what is clear of everything else: a margin is left.
inline constexpr double within = 0.95;

/// Whether G may reach through the whole body: one material, no body force, no eigenstrain.
bool is_plain(const Scene& scene);
/// Why G cannot be cut off in the material of that triangle; empty: it can.
std::string no_disc(const Model& model, Index triangle);

/// Every edge of the boundary has a label, so that it can be loaded.
Mesh labelled(Mesh mesh);

/// The parts of the stress at a point. The model must outlive it, all of its boundary labelled.
class PointDual {
 public:
  PointDual(const Model& model, const Vec2& x);
  /// Why there is none; empty: there is.
  const std::string& why() const {
    return why_;
  }
  DualProblem operator()(PointStress part) const;

 private:
  const Model& m_;
  Vec2 x_;
  Index where_;
  bool plain_;
  std::string why_;
};

using BoundDual = std::function<Bounded(const DualProblem& dual, std::vector<Eigen::VectorXd>& eta)>;
/// By intervals of the duals. `why` there are none, if it is known already.
StressBounds bound_stress(const Model& model, const Vec2& x, std::string why, const BoundDual& bound);

/// The body of the model without loads, its supports at rest.
Scene at_rest(const Model& model);

/// The scene of the model with loads that are 0 wherever those of a dual may act.
Scene with_all_edges(const Model& model);

/// The scene of u + k w.
Scene superposed(const Scene& u, const Scene& w, double k);

}  // namespace kerf
