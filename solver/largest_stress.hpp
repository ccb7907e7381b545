#pragma once
// Where the von Mises stress is largest inside triangles and on their edges.

#include "kerf/recover.hpp"
#include "solver/recover_stress.hpp"

#include <functional>
#include <vector>

namespace kerf {

inline constexpr double near_largest = 0.85;  // of the largest one, that corners have beside which to look

/// Points in the triangles around the corners where the von Mises stress, `at_corners`, is within 15 % of the largest
/// one, of the hundred largest corners at most: a lattice of each triangle, its corners and edges included. `excluded`:
/// where not to look.
std::vector<PointIn> points_near_largest(const Model& model, const Corners& corners, const Eigen::VectorXd& at_corners,
                                         const std::function<bool(const Vec2&)>& excluded);

/// The von Mises stress there, with the stress along the third axis in plane strain. That of the element: polynomials
/// fitted to it around a corner are off by percents beside a hole, where the stress falls within a few triangles.
Eigen::VectorXd von_mises_at(const Model& model, const Field& field, bool plane_strain,
                             std::span<const PointIn> points);

/// How far the largest of these values is from that of a better solution at the same points: the larger of the
/// difference of the two largest and the typical difference [theory: R.11].
double difference_of(const Eigen::VectorXd& own, const Eigen::VectorXd& better);

}  // namespace kerf
