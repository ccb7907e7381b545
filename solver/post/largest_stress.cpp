// Where the von Mises stress is largest, on a lattice of the triangles around the largest corners: the first term of
// the margins of printed maxima [theory: R.11].

#include "solver/largest_stress.hpp"

#include "solver/bounds/right_inverse.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <numeric>

namespace kerf {

namespace {

/// The component 33 of the eigenstrain.
/// In plane strain it adds to s33, which the von Mises stress sees.
double eigenstrain_33(const Model& model, const PointIn& p) {
  const StrainData& strain = model.inner->data.strain;
  if (strain.empty()) return 0;
  Points l(2, 1);
  l.col(0) = cell_coordinates(triangle(model, p.triangle), p.x);
  return strain_33_at(strain, p.triangle, l)[0];
}

}  // namespace

/// The lattice of degree 4 has 15 points per triangle, 12 of them on its edges.
std::vector<PointIn> points_near_largest(const Model& model, const Corners& corners, const Eigen::VectorXd& at_corners,
                                         const std::function<bool(const Vec2&)>& excluded) {
  constexpr std::size_t most = 100;
  std::vector<Index> large;
  for (Index i = 0; i < static_cast<Index>(at_corners.size()); ++i)
    if (std::isfinite(at_corners[i]) && !excluded(model.mesh.points[corners.vertex[i]])) large.push_back(i);
  std::ranges::stable_sort(large, std::greater<>(), [&](Index i) { return at_corners[i]; });
  std::vector<bool> chosen(static_cast<std::size_t>(at_corners.size()), false);
  for (std::size_t i = 0; i < std::min(most, large.size()); ++i)
    if (at_corners[large[i]] >= near_largest * at_corners[large.front()])
      chosen[static_cast<std::size_t>(large[i])] = true;
  const Points places = lattice(4);
  std::vector<PointIn> points;
  for (Index t = 0; t < own_triangles(model); ++t) {
    const auto& of = corners.of[static_cast<std::size_t>(t)];
    if (std::ranges::none_of(of, [&](Index i) { return chosen[static_cast<std::size_t>(i)]; })) continue;
    const Triangle shape = triangle(model, t);
    for (Eigen::Index q = 0; q < places.cols(); ++q) {
      const Vec2 l = places.col(q);
      const Vec2 x = is_curved(shape) ? cell_map(shape, l).x
                                      : Vec2((1 - l.sum()) * shape.x[0] + l[0] * shape.x[1] + l[1] * shape.x[2]);
      if (!excluded(x)) points.push_back({t, x});
    }
  }
  return points;
}

/// From the stress of the element at the point, in the material of its triangle.
Eigen::VectorXd von_mises_at(const Model& model, const Field& field, bool plane_strain,
                             std::span<const PointIn> points) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PointIn& p = points[i];
    const Eigen::Vector4d s =
        stress_at(model.inner->kernel, triangle(model, p.triangle), field.interior.col(p.triangle), p.x);
    values[static_cast<Eigen::Index>(i)] =
        von_mises(material_of(model.mesh, model.scene, p.triangle), plane_strain, s, eigenstrain_33(model, p));
  }
  return values;
}

/// Both at the same points: the mean square sees a maximum that has moved, the difference of the two largest does not.
double difference_of(const Eigen::VectorXd& own, const Eigen::VectorXd& better) {
  if (own.size() == 0) return nan;
  return std::max(std::abs(own.maxCoeff() - better.maxCoeff()),
                  std::sqrt((own - better).squaredNorm() / static_cast<double>(own.size())));
}

}  // namespace kerf
