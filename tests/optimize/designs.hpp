#pragma once
// Bodies with everything that a design can draw, for the tests.

#include "kerf/optimize.hpp"
#include "tests/topo/validation.hpp"

namespace kerf::scenes {

inline Drawn drawn(Drawn::Kind kind, std::string name, const Eigen::VectorXd& start, double box) {
  return {kind, std::move(name), start.array() - box, start.array() + box, start};
}

/// Control points on a circle, each third one farther out.
inline Eigen::VectorXd blob(const Vec2& center, double radius, int points) {
  Eigen::VectorXd v(2 * points);
  for (int i = 0; i < points; ++i) {
    const double t = 2 * M_PI * i / points, r = radius * (i % 3 == 0 ? 1.3 : 1);
    v.segment<2>(2 * i) = center + r * Vec2(std::cos(t), std::sin(t));
  }
  return v;
}

/// [-2, 2]^2, clamped at the bottom, pulled at the top, a fixed crack in it; a circle, an ellipse, a spline, a kinked
/// crack and an inclusion drawn.
inline Problem everything() {
  Problem p;
  p.frame = rectangle({-2, -2}, {2, 2});
  p.frame.cracks = {{"fixed", {Vec2(-0.3, 0.1), Vec2(0.4, 0)}}};
  p.scene = pulled(plane_strain(1, 0.3), [](const Vec2& x) { return Vec2(0.2 + 0.1 * x.x(), 1 + 0.2 * x.x()); });
  p.scene.body = [](const Vec2& x) { return Vec2(0.1 * x.y(), -0.2); };
  p.sizing = {.size = 0.5, .crack_tip_size = 0.15};
  p.objective = {"compliance", {compliance()}};
  return p;
}
inline Design everything_drawn() {
  Design d;
  d.drawn.push_back(drawn(Drawn::Kind::Circle, "circle", Eigen::Vector3d(-1.2, 1.2, 0.3), 0.2));
  Eigen::VectorXd ellipse(5);
  ellipse << 1.1, 1.2, 0.4, 0.25, 0.5;
  d.drawn.push_back(drawn(Drawn::Kind::Ellipse, "ellipse", ellipse, 0.15));
  d.drawn.push_back(drawn(Drawn::Kind::Spline, "spline", blob({-1.1, -1.1}, 0.45, 6), 0.1));
  Eigen::VectorXd crack(6);
  crack << 0.9, 0.1, 1.3, -0.2, 1.5, -0.3;
  d.drawn.push_back(drawn(Drawn::Kind::Crack, "crack", crack, 0.08));
  d.drawn.push_back(drawn(Drawn::Kind::Inclusion, "stiff", Eigen::Vector4d(1, -1.2, 0.35, 3), 0.2));
  return d;
}

}  // namespace kerf::scenes
