#pragma once
// The dual problem of a derivative, for one process and for many.

#include "base/parallel.hpp"
#include "kerf/adjoint.hpp"
#include "solver/contact/sliding.hpp"
#include "solver/system.hpp"
#include "solver/system/elementwise.hpp"

namespace kerf {

/// What the dual problem is loaded by.
struct DualLoads {
  Eigen::VectorXd forces;  // per skeleton unknown: derivatives by the skeleton, and those by the interior condensed
  Eigen::VectorXd own;     // per triangle Loads::own, with a penalty
};
DualLoads dual_loads(const Model& m, const Sensitivity& dJ);

/// The interiors of a field: find(triangle, its shape, what strains it, Penalty). `theta`: per triangle, with a
/// penalty.
template <typename Find>
void fill_interior(const Model& m, const DoubleDouble& traces, const Eigen::VectorXd& theta, const Find& find,
                   Field& field) {
  const auto triangles = static_cast<Index>(m.mesh.triangles.size());
  field.interior.resize(interior_count(m.element), triangles);
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Strained s = strained(m, traces, t);
      field.interior.col(t) =
          find(t, triangle(m, t), s.rest, Penalty{penalty_at(m, t), theta.size() > 0 ? theta[t] : 0});
      add_motion(m, t, s.motion, field.interior.col(t));
    }
  });
}
/// Those of the dual field under dJ.
void fill_dual(const Model& m, const Sensitivity& dJ, const DoubleDouble& traces, const Eigen::VectorXd& theta,
               Field& dual);

/// Dual jumps of the held rows by derivatives `by` the forces of all rows in contact [theory: A.9, A.15].
Eigen::VectorXd dual_jumps(Eigen::VectorXd by, const std::vector<bool>& held, const std::vector<SlidingPoint>& sliding);

/// What the derivative says about each of Inner::floating, over own triangles and unknowns.
Eigen::VectorXd work_on_motions(const Model& m, const Sensitivity& dJ);
/// The derivative less `share` of the derivatives of int u . motion.
Sensitivity without_moments(const Model& m, Sensitivity dJ, const Eigen::VectorXd& share);

/// Of these points those that are closed and slide. `held`, `jump`: by rows in contact.
std::vector<SlidingPoint> sliding_points(const std::vector<ContactPoint>& points, const std::vector<bool>& held,
                                         const Eigen::VectorXd& jump);

}  // namespace kerf
