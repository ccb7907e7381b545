#include "solver/adapting.hpp"

#include "geometry/curved.hpp"
#include "solver/system.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// The curvature of the arc at the foot of a point that the mesh has put near it.
double curvature(const Arc& arc, const Vec2& x) {
  const Vec2 y = arc.axes.inverse() * (x - arc.center);
  const double t = std::atan2(y.y(), y.x());
  const Vec2 first = arc.axes * Vec2(-std::sin(t), std::cos(t)), second = arc.axes * Vec2(-std::cos(t), -std::sin(t));
  return std::abs(cross(first, second)) / std::pow(first.norm(), 3);
}

/// Whether the point lies on the arc, up to what keeps the area of a whole circle: less than the height of the chord.
bool on_arc(const Arc& arc, const Vec2& x, double tolerance) {
  const Vec2 y = arc.axes.inverse() * (x - arc.center);
  const double radius = y.norm(), reach = arc.axes.colwise().norm().minCoeff();
  if (std::abs(radius - 1) * reach > tolerance) return false;
  const double sweep = arc.to - arc.from, slack = 1e-6;
  const double t = std::atan2(y.y(), y.x());
  const double along = sweep > 0 ? std::fmod(std::fmod(t - arc.from, 2 * pi) + 2 * pi, 2 * pi)
                                 : std::fmod(std::fmod(arc.from - t, 2 * pi) + 2 * pi, 2 * pi);
  return along <= std::abs(sweep) + slack || along >= 2 * pi - slack;
}

/// Of the arc that an edge is a part of a chord of, which is as long as `h`; 0 for none.
double chord_curvature(const std::vector<Arc>& arcs, const Vec2& a, const Vec2& b, double h) {
  for (const Arc& arc : arcs) {
    const double k = curvature(arc, 0.5 * (a + b)), height = h * h * k / 4 + 1e-9 * h;
    if (on_arc(arc, a, height) && on_arc(arc, b, height)) return k;
  }
  return 0;
}

}  // namespace

void add_chords(const Shape& shape, int divisions, const Model& m, const State& s, Indicator& indicator) {
  const std::vector<Arc> arcs = arcs_of(shape);
  if (arcs.empty() || !std::isfinite(indicator.relative)) return;
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
      const double h = std::ldexp((b - a).norm(), divisions), bend = chord_curvature(arcs, a, b, h);
      if (!(bend > 0)) continue;
      const double size = evaluate(m, s, t, 0.5 * (a + b)).stress.squaredNorm(),
                   of_chord = size * std::pow(h * h * bend, 2) * (zeta_3 / (2 * std::pow(pi, 3)) + h * bend / 144);
      lost[t] += std::ldexp(of_chord, -divisions);
    }
  if (!(indicator.stress > 0)) return;
  const double squared_efficiency =
      indicator.error > 0 ? indicator.eta.head(own).squaredNorm() / indicator.error : std::pow(m.element.efficiency, 2);
  indicator.eta = (indicator.eta.array().square() + squared_efficiency * lost.array()).sqrt();
  indicator.error += lost.sum();
  indicator.relative = std::sqrt(indicator.error / indicator.stress);
}

}  // namespace kerf
