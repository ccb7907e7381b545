#pragma once
// A quarter of a plate with a hole at its center, the hole carved.

#include "geometry/carve.hpp"
#include "kerf/optimize.hpp"

namespace kerf::scenes {

/// [0, side]^2 held by rollers at the axes x = 0 and y = 0, pulled by (2, 0) at the right and (0, 1) at the top.
inline Problem quarter_plate(double side, double size) {
  Problem p;
  p.frame.outline = {"outline",
                     {{{0, 0}, 0, std::nullopt},
                      {{side, 0}, 1, std::nullopt},
                      {{side, side}, 2, std::nullopt},
                      {{0, side}, 3, std::nullopt}}};
  p.frame.labels = {"bottom", "right", "top", "left"};
  p.scene.material = plane_stress(1, 0.3);
  const auto zero = [](const Vec2&, const Vec2&) { return Vec2(0, 0); };
  p.scene.supports = {{.label = 0, .first = false, .value = zero}, {.label = 3, .second = false, .value = zero}};
  p.scene.tractions = {{1, [](const Vec2&, const Vec2&) { return Vec2(2, 0); }},
                       {2, [](const Vec2&, const Vec2&) { return Vec2(0, 1); }}};
  p.sizing.size = size;
  p.objective = {"compliance", {compliance()}};
  return p;
}

/// The plate without what lies inside the circle around the origin, as a polygon.
inline Carved quarter_hole(const Problem& p, double radius, int pieces) {
  Carved carved;
  carved.shape = p.frame;
  carved.shape.labels.push_back("design");
  carved.design_label = 4;
  std::vector<Side>& sides = carved.shape.outline.sides;
  sides[0].start = {radius, 0};
  for (int k = 0; k < pieces; ++k) {
    const double t = pi / 2 * (1 - double(k) / pieces);
    sides.push_back(
        {k == 0 ? Vec2(0, radius) : Vec2(radius * std::cos(t), radius * std::sin(t)), 4, std::nullopt, false, true});
  }
  carved.area = area(carved.shape);
  for (std::size_t k = 0; k < carved.shape.cracks.size(); ++k) carved.crack_of.push_back(Index(k));
  return carved;
}

}  // namespace kerf::scenes
