#pragma once
// A bound on the largest stress as many constraints: one per box of the body.

#include "kerf/max_stress.hpp"
#include "optimize/curves/curve_mesh.hpp"
#include "optimize/loop/evaluate.hpp"

#include <span>

namespace kerf {

/// Equal squares over a frame, of an edge of 0.035 of its diagonal.
class StressBoxes {
 public:
  explicit StressBoxes(const Shape& frame);
  Index count() const {
    return columns_ * rows_;
  }
  Index of(const Vec2& x) const;
  std::array<Vec2, 2> box(Index i) const;

  /// The largest stress in each, 0 where there is none.
  Eigen::VectorXd largest(const LargestStress& what, const SolvedCase& c) const;

 private:
  Vec2 low_;
  double edge_;
  Index columns_, rows_;
};

/// The largest stress that the functional is, if it is one.
const LargestStress* largest_of(const Functional& j);

/// What rows of boxes have whose stress is far below the bound: no derivative.
inline constexpr double idle_box = -1;

/// Per box (factor * largest stress)/at_most - 1, and its derivatives by the variables of the curves, a column each:
/// those of the norm over the box, scaled to the largest stress. Boxes below 0.75 of the bound are idle.
struct StressRows {
  Eigen::VectorXd value;
  Eigen::MatrixXd by;
};
StressRows stress_rows(const LargestStress& what, double at_most, const StressBoxes& boxes,
                       const Eigen::VectorXd& factor, const SolvedCase& c, const CurveMesh& follows,
                       const DesignCurves& d);

/// The share of the boundary outside of the zones, without loads and supports, where the stress is at least 0.9 of the
/// bound in some load case.
double fully_stressed(const LargestStress& what, double at_most, std::span<const SolvedCase> cases);

/// By what the largest stress of a box is to be multiplied: what a finer mesh says of it over what this one does,
/// between limits.
double stress_factor(double finer, double here);

}  // namespace kerf
