#pragma once
// What a quantity of a state is made of: the loads l of a dual solution, and what is known without it [theory: B.12].

#include "kerf/bounds.hpp"
#include "solver/at_rest.hpp"
#include "solver/bounds/work_of_data.hpp"
#include "solver/nucleus.hpp"
#include "solver/post/crack_tip.hpp"
#include "solver/system.hpp"

#include <memory>
#include <span>

namespace kerf {

/// Where the fields G of a point or a tip are cut off: between two circles.
struct CutOffRing {
  Vec2 middle = Vec2::Zero();
  double inner = 0, outer = 0;
  Nuclei fields;
  /// The slope of the factor by which they fade.
  Vec2 slope(const Vec2& x) const;
};

/// Q(u) = known + l(u) for the state u of a model.
struct DualProblem {
  Scene loads;  // on the labels and components of the model, all else 0
  Known known;
  std::string estimate;  // why these loads, which are sampled, prove nothing; empty: they do
  // Of G that is cut off, all of its loads once more: it is one of these fields.
  std::shared_ptr<const CutOffRing> ring = nullptr;
  std::size_t field = 0;
};

/// A point, a line, or a disc, where stresses are averaged and their field G is singular or not defined.
struct StressPlace {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();  // the same point of a point and of a disc
  double radius = 0;                            // of a disc

  static StressPlace point(const Vec2& x) {
    return {x, x, 0};
  }
  /// Throws std::invalid_argument without a size.
  static StressPlace of(const OverDisc& disc);
  static StressPlace of(const AlongLine& line);
  Vec2 middle() const {
    return 0.5 * (from + to);
  }
  /// From its middle to its end.
  double reach() const {
    return 0.5 * (to - from).norm() + radius;
  }
};

/// The singular field G over the whole body, which is of one isotropic material and has no body force and no
/// eigenstrain: tractions on its boundary and on the faces of its cracks but `own`, whose faces G leaves free.
DualProblem global_dual(const Model& model, const Nucleus& G, const StressPlace& singular, Index own);

/// A disc about a point, in one isotropic material without eigenstrain, that holds no end of the body but the straight
/// piece of a crack that ends at its middle.
struct CutOffDisc {
  Vec2 middle = Vec2::Zero();
  double radius = 0;
  const CrackTip* tip = nullptr;
  double rough = 0;            // within this radius G is singular on a line through the middle, or beyond it another
  Vec2 along = Vec2::UnitX();  // that line
  double solid = 0;            // G does not fade within that radius
  /// `fields`: those that are cut off there.
  std::shared_ptr<const CutOffRing> ring(Nuclei fields) const;
};
/// G cut off within the disc, so that nothing else of the body matters: a body force and an eigenstrain in the ring
/// where it fades [theory: B.20].
DualProblem local_dual(const Model& model, const Nucleus& G, const CutOffDisc& disc,
                       std::shared_ptr<const CutOffRing> ring, std::size_t field);

/// The scene of a dual that is cut off, without the loads in its ring.
Scene unloaded(const Model& model);

/// Of a disc, what is clear of everything else: a margin is left.
inline constexpr double within = 0.95;

/// Whether G may reach through the whole body: one material, no body force, no eigenstrain.
bool is_plain(const Scene& scene);
/// For a disc about a tip: clear of triangles with curved edges, too.
double room_of_tip(const Model& model, const CrackTip& tip);
/// Why G cannot be cut off in the material of that triangle; empty: it can.
std::string no_disc(const Model& model, Index triangle);

/// Every edge of the boundary has a label, so that it can be loaded.
Mesh labelled(Mesh mesh);

/// The parts of the stress at a point, or of its mean over a disc or along a line, in the frame of the line. The model
/// must outlive it, all of its boundary labelled.
class StressDual {
 public:
  StressDual(const Model& model, const StressPlace& place);
  /// Why there is none; empty: there is.
  const std::string& why() const {
    return why_;
  }
  DualProblem operator()(PointStress part) const;

 private:
  std::string why_not() const;

  const Model& m_;
  StressPlace place_;
  Index where_;
  bool plain_;
  CutOffDisc disc_;
  std::shared_ptr<const CutOffRing> ring_;
  std::string why_;
};

/// The interval of a dual; the indicator of its solution, if asked.
struct BoundedDual {
  Bounded interval;
  Eigen::VectorXd eta;
};

/// The duals of the stress at a place, of which the intervals make its bounds. `why`: there are none.
struct StressDuals {
  std::string why;
  std::vector<DualProblem> duals;
};
StressDuals stress_duals(const Model& model, const StressPlace& x, std::string why);
StressBounds stress_of(const StressDuals& of, std::span<const BoundedDual> bounded);

/// The work of given tractions.
DualProblem work_dual(const Model& model, const std::vector<Traction>& of);
/// That of all loads of the state. Its supports may move.
DualProblem loads_dual(const Model& model);
/// Whether the loads of the state work twice its energy, negative: no eigenstrain, and supports that are at rest.
bool works_twice_its_energy(const Model& model);
/// Component 0 or 1 of the force of the supports of these labels.
DualProblem reaction_dual(const Model& model, const std::vector<Index>& labels, int component);
/// Why there is none; empty: there is.
std::string no_reaction(const Model& model, const std::vector<Index>& labels, int component);

/// The scene of the model with loads that are 0 wherever those of a dual may act.
Scene with_all_edges(const Model& model);

/// The scene of u + k w.
Scene superposed(const Scene& u, const Scene& w, double k);

}  // namespace kerf
