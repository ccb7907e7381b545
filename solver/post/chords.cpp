// What the stress of a body lacks whose curved sides are chords: a free side of curvature k has no traction on the
// chord of length h instead of on the arc, which leaves a saw tooth of tractions k (s - h/2) sigma. A traction a sin(q
// x) along a half plane has int |s|^2 = a^2/q per length, so that the saw teeth and the mean depth h^2 k/12 of the
// chords add
//   sum_e |sigma|^2 (h^2 k)^2 (zeta(3)/(2 pi^3) + h k/144)      [theory: R.10]
// to the square of the error, and to eta^2 at the rate of the indicator. Edges that follow an arc have none of it. See
// "Curved sides" in docs/theory/recovery_and_estimates.md. The first part of the file finds the arc that an edge is a
// chord of.

#include "solver/adapting.hpp"

#include "geometry/curved.hpp"
#include "geometry/plane.hpp"
#include "solver/post/chords.hpp"
#include "solver/system.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

/// The curvature of the arc at the foot of a point that the mesh has put near it.
/// Curvature |cross(x', x'')|/|x'|^3 of the ellipse at the parameter whose ray from the center meets the point.
double curvature_at(const Arc& arc, const Vec2& x) {
  const Vec2 y = arc.axes.inverse() * (x - arc.center);
  const double t = std::atan2(y.y(), y.x());
  const Vec2 first = arc.axes * Vec2(-std::sin(t), std::cos(t)), second = arc.axes * Vec2(-std::cos(t), -std::sin(t));
  return std::abs(cross(first, second)) / std::pow(first.norm(), 3);
}

/// How far a point is from the arc, infinite beyond its ends.
/// Radially in the coordinates where the ellipse is the unit circle, by the shorter semi-axis: at most the distance.
double distance_to(const Arc& arc, const Vec2& x) {
  const Vec2 y = arc.axes.inverse() * (x - arc.center);
  const double radius = y.norm(), reach = arc.axes.colwise().norm().minCoeff();
  const double sweep = arc.to - arc.from, slack = 1e-6;
  const double t = std::atan2(y.y(), y.x());
  const double along = sweep > 0 ? std::fmod(std::fmod(t - arc.from, 2 * pi) + 2 * pi, 2 * pi)
                                 : std::fmod(std::fmod(arc.from - t, 2 * pi) + 2 * pi, 2 * pi);
  return along <= std::abs(sweep) + slack || along >= 2 * pi - slack ? std::abs(radius - 1) * reach : infinity;
}

/// Twice the height of a chord over its arc: what keeps the area of a whole circle moves its ends by less.
double twice_height(double h, double curvature) {
  const double half = std::min(0.5 * h * curvature, 1.0);
  return 2 * half * half / (1 + std::sqrt(1 - half * half)) / curvature;
}

}  // namespace

/// Straight sides are kept, too: an edge on one of them may lie near an arc that it is tangent to.
Chords::Chords(const Shape& shape) : arcs_(arcs_of(shape)) {
  const auto add = [&](const Loop& loop) {
    for (std::size_t i = 0; i < loop.sides.size(); ++i)
      if (!loop.sides[i].arc) straight_.push_back({loop.sides[i].start, loop.sides[(i + 1) % loop.sides.size()].start});
  };
  add(shape.outline);
  for (const Loop& hole : shape.holes) add(hole);
  for (const Loop& region : shape.regions) add(region);
  for (const Crack& crack : shape.cracks)
    for (std::size_t i = 0; i + 1 < crack.points.size() && !crack.arc; ++i)
      straight_.push_back({crack.points[i], crack.points[i + 1]});
}

bool Chords::is_straight(const Vec2& a, const Vec2& b) const {
  constexpr double rounding = 1e-9;
  const double near = rounding * (b - a).norm();
  return std::ranges::any_of(straight_, [&](const std::array<Vec2, 2>& side) {
    return distance(a, side[0], side[1]) <= near && distance(b, side[0], side[1]) <= near;
  });
}

/// Of several arcs the one that both ends lie nearest to. Points of the mesh lie off their arc by less than twice the
/// height of the chord, since polygons with the area of the arcs move them.
double Chords::curvature(const Vec2& a, const Vec2& b, double h) const {
  constexpr double widest = 2.7;  // radii: the side of the triangle that has the area of its circle
  double nearest = infinity, found = 0;
  for (const Arc& arc : arcs_) {
    const double k = curvature_at(arc, 0.5 * (a + b)), off = std::max(distance_to(arc, a), distance_to(arc, b));
    if (h * k > widest || off > twice_height(h, k) + 1e-9 * h || off >= nearest) continue;
    nearest = off;
    found = k;
  }
  return found > 0 && !is_straight(a, b) ? found : 0;
}

/// An edge of a divided mesh is a part of a chord of 2^divisions times its length, and carries that part of the term.
void add_chords(const Shape& shape, int divisions, const Model& m, const State& s, Indicator& indicator,
                const Sums& sums) {
  const Chords chords(shape);
  if (chords.empty() || !std::isfinite(indicator.relative)) return;
  constexpr double zeta_3 = 1.2020569031595942;
  const Index own = own_triangles(m);
  Eigen::VectorXd lost = Eigen::VectorXd::Zero(indicator.eta.size());
  for (Index t = 0; t < own; ++t)
    for (const Index e : m.mesh.edges_of[static_cast<std::size_t>(t)]) {
      const auto k = static_cast<std::size_t>(e);
      if (!m.mesh.arc.empty() && m.mesh.arc[k] != none) continue;
      if (m.mesh.label[k] == none && m.mesh.crack[k] == none && !is_interface(m.mesh, e)) continue;
      const Vec2 &a = m.mesh.points[static_cast<std::size_t>(m.mesh.edges[k][0])],
                 &b = m.mesh.points[static_cast<std::size_t>(m.mesh.edges[k][1])];
      const double h = std::ldexp((b - a).norm(), divisions), bend = chords.curvature(a, b, h);
      if (!(bend > 0)) continue;
      const double size = evaluate(m, s, t, 0.5 * (a + b)).stress.squaredNorm(),
                   of_chord = size * std::pow(h * h * bend, 2) * (zeta_3 / (2 * std::pow(pi, 3)) + h * bend / 144);
      lost[t] += std::ldexp(of_chord, -divisions);
    }
  if (!(indicator.stress > 0)) return;
  std::array<double, 2> of_body{indicator.eta.head(own).squaredNorm(), lost.sum()};
  if (sums.add) sums.add(of_body);
  const double squared_efficiency =
      indicator.error > 0 ? of_body[0] / indicator.error : std::pow(m.element.efficiency, 2);
  indicator.eta = (indicator.eta.array().square() + squared_efficiency * lost.array()).sqrt();
  indicator.error += of_body[1];
  indicator.relative = std::sqrt(indicator.error / indicator.stress);
}

}  // namespace kerf
