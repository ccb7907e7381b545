#pragma once
// Bodies, and validations of them in one line, for the tests of the expansions.

#include "kerf/validate.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf::scenes {

/// Labels 0 bottom, 1 right, 2 top, 3 left.
inline Shape rectangle(const Vec2& low, const Vec2& high) {
  Shape s;
  s.labels = {"bottom", "right", "top", "left"};
  s.outline = polygon("outline", {low, {high.x(), low.y()}, high, {low.x(), high.y()}}, 0);
  for (Index i = 0; i < 4; ++i) s.outline.sides[i].label = i;
  return s;
}

/// [-1, 1]^2 with crack 0 from (-half, 0) to (half, 0).
inline Shape cracked_square(double half = 0.4) {
  Shape s = rectangle({-1, -1}, {1, 1});
  s.cracks = {{"crack", {Vec2(-half, 0), Vec2(half, 0)}}};
  return s;
}

inline Support clamp(Index label) {
  return {label, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }};
}

/// Clamped at the bottom; the traction f(x) on top.
inline Scene pulled(const Material& m, VectorField top) {
  Scene s;
  s.material = m;
  s.laws.resize(1);
  s.supports = {clamp(0)};
  s.tractions = {{2, [top = std::move(top)](const Vec2& x, const Vec2&) { return top(x); }}};
  return s;
}
inline Vec2 opens(const Vec2& x) {
  return {0.1, 1 + 0.3 * x.x()};
}
inline Vec2 closes_half(const Vec2& x) {
  return {0.1, x.x() - 0.05};
}

/// Sees the rotation alone.
inline Term turning() {
  return {.kind = "turning",
          .density =
              [](const FieldPoint& p) {
                return Density{.value = 0.5 * p.rotation * p.rotation, .by_rotation = p.rotation};
              },
          .uses_rotation = true,
          .uses_place = false};
}

inline const std::vector<double> usual_radii = {0.08, 0.04, 0.02, 0.01};

struct Body {
  Shape shape;
  Scene scene;
  Sizing sizing = {.size = 0.1};
  Element element = kerf::element("bdms", 2);
};
inline Validation validated(const Body& b, const Functional& j, const Vec2& at, const Perturbation& p = {},
                            const std::vector<double>& radii = usual_radii) {
  return validate({b.shape, b.sizing}, b.element, b.scene, j, {{at}, radii, p, 2}).front();
}

/// (J(eps) - J(0)) / f(eps).
inline double quotient(const Validation& v, std::size_t row) {
  return v.rows[row].difference / v.rows[row].predicted * v.coefficient;
}

/// For messages.
inline std::string text(const Validation& v) {
  std::string s =
      fmt::format("T {:.9g} intercept {:.9g} ({:.1e}) order {:.3f} verdict {}: {}\n", v.coefficient, v.intercept,
                  v.intercept / v.coefficient - 1, v.order, static_cast<int>(v.verdict), v.reason);
  for (const ValidationRow& r : v.rows)
    s += fmt::format("  eps {} D {:.9g} remainder {:.2e} order {:.3f}{}\n", r.radius,
                     r.difference / r.predicted * v.coefficient, r.remainder / r.predicted, r.order,
                     r.same_contact ? "" : " other contact");
  return s;
}

}  // namespace kerf::scenes
