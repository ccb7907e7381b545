#pragma once
// The Green tensor of a body, and what a small clamped hole does to J [theory: T.28, T.30].

#include "kerf/analysis.hpp"
#include "topo/formulas/clamped_hole.hpp"
#include "topo/map/reply.hpp"

#include <span>

namespace kerf {

struct Green {
  Mat2 regular =
      Mat2::Zero();          // column j: w_j at the point, G + w being the body's displacement under a unit force e_j
  std::vector<Field> field;  // w_1, w_2, where asked for; their forces on the cracks are those of G + w
};

/// The regular part w of the body's Green tensor, with the body's own conditions: w = -G e_j where supports hold it
/// (component by component), s(w) n = -s(G e_j) n where it is free; on cracks the contact of the state linearized:
/// closed rows keep their gap, all others open and slide. Two solves with the model's factor per point.
class GreenTensor {
 public:
  /// Model and state must outlive it. Throws Error(Usage) for several materials, for a body that no support holds, for
  /// an element that is not mixed, and where cracks have neither gap nor pressure on more than 1% of their length.
  GreenTensor(const Model& model, const Field& state);

  /// At x in triangle t. `enough`: relative residual.
  Green at(const Vec2& x, Index t, bool fields, double enough = TangentSolver::to_rounding);

  /// The regular part alone at many points, each in its triangle: all at once, as far as one of them agrees with the
  /// solution that `at` iterates to `enough`; else by `at`.
  std::vector<Mat2> regular_at(std::span<const Vec2> x, std::span<const Index> t, double enough);

 private:
  const Model& model_;
  BodyReply reply_;
};

/// The predicted J(Omega_eps) - J(Omega) of a clamped hole at points, the contact linearized; errors O(eps^2 ln eps),
/// also from the body force, which is not taken out of the hole. Energies: half of u0.F; J linear in the state: -p0.F;
/// others: J of u - (G + w) F, integrated. NaN outside the body, nearer than clear_radii to a feature (see map.hpp),
/// and where the matrix of clamped_hole.hpp is not positive definite. Throws Error(Usage) for functionals of the stress
/// around the hole, and as GreenTensor.
std::vector<double> clamped_at(const Analysis& a, const Functional& j, double eps, std::span<const Vec2> points);

/// One of them, and the sum of its parts without their signs: those that are linear in the displacement put in, and
/// those that are not. Twice the integrals.
struct ClampedChange {
  double value = nan, size = nan;
};
ClampedChange clamped_change(const Analysis& a, const Functional& j, double eps, const Vec2& point);

struct Candidates {
  std::vector<Vec2> x;
  std::vector<Index> in;   // their triangles
  std::vector<bool> skip;  // left out: NaN
};
/// The same at many points: Green's tensor solved for at
/// samples that lie the denser the nearer the boundary, and interpolated. Only for energies and J linear in the state,
/// Error(Usage) for others.
struct ClampedMap {
  Eigen::VectorXd value;
  double error = 0;  // of M^-1 Hreg by interpolation: the largest at the last samples, predicted from those before
  Index samples = 0;
};
ClampedMap clamped_everywhere(const Analysis& a, const Functional& j, double eps, const Candidates& points);

}  // namespace kerf
