// T at the center of a ball by polynomials of degree 4 in the mean of squares over the inner half of the ball, weighted
// by area (15 coefficients; the fit keeps the order of the element and averages its noise).

#include "topo/validate/center.hpp"

#include "solver/system.hpp"
#include "topo/map/fields.hpp"

#include <cmath>

namespace kerf {

// Polynomials in places over half the ball's radius: their constant is the value at the center.
Center::Center(const Model& m, const BallIn& ball) : m_(m), at_(ball.at), last_(ball.end - 1) {
  constexpr double inner_part = 0.5;
  const double radius = inner_part * ball.radius;
  for (Index t = ball.first; t < ball.end; ++t)
    if ((centroid(m.mesh, t) - at_).norm() < radius) use_.push_back(t);
  constexpr int degree = 4, count = 15;
  const Eigen::Index rows = static_cast<Eigen::Index>(use_.size());
  Eigen::MatrixXd a(rows, count);
  weight_.resize(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Vec2 x = (centroid(m.mesh, use_[static_cast<std::size_t>(i)]) - at_) / radius;
    weight_[i] = std::sqrt(area(m.mesh, use_[static_cast<std::size_t>(i)]));
    int column = 0;
    for (int n = 0; n <= degree; ++n)
      for (int k = 0; k <= n; ++k) a(i, column++) = weight_[i] * std::pow(x.x(), n - k) * std::pow(x.y(), k);
  }
  fit_.compute(a);
}

// T, what it could be without cancellation, and its parts, all from the fitted fields.
Center::Value Center::value(const Expansion& e) const {
  PointValues v = point_values(
      e, [&](const FieldOf& of) { return stress(of.field); },
      [&](const FieldOf& of, bool recovered) { return displacement(of.field, recovered); });
  set_place(e, last_, at_, v);
  std::vector<bool> closed = no_row_closed(e.a);
  const Oriented t = expand(e, v, closed);
  return {t.value, size_of(e, v), modes_of(e, v, t)};
}

// The element's own stress at centroids, not recovered: the fit averages.
Eigen::Vector3d Center::stress(const Field& s) const {
  Eigen::Matrix<double, Eigen::Dynamic, 3> v(weight_.size(), 3);
  for (Eigen::Index i = 0; i < v.rows(); ++i) {
    const Index t = use_[static_cast<std::size_t>(i)];
    v.row(i) =
        weight_[i] *
        components(stress_at(m_.inner->kernel, triangle(m_, t), s.interior.col(t), centroid(m_.mesh, t))).transpose();
  }
  return fit_.solve(v).row(0).transpose();
}

Vec2 Center::displacement(const Field& s, bool recovered) const {
  Eigen::Matrix<double, Eigen::Dynamic, 2> v(weight_.size(), 2);
  for (Eigen::Index i = 0; i < v.rows(); ++i) {
    const Index t = use_[static_cast<std::size_t>(i)];
    v.row(i) = weight_[i] * displacement_at(m_, s, t, centroid(m_.mesh, t), recovered).transpose();
  }
  return fit_.solve(v).row(0).transpose();
}

}  // namespace kerf
