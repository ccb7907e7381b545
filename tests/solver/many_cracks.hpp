#pragma once
// Bodies with cracks at random, some of which open and some close.

#include "kerf/scene.hpp"
#include "kerf/shape.hpp"
#include "tests/support/exact.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace kerf {

inline Shape square(double half) {
  Shape shape;
  shape.outline = polygon("outline", {{-half, -half}, {half, -half}, {half, half}, {-half, half}}, 0);
  shape.labels = {"bottom", "right", "top", "left"};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[static_cast<std::size_t>(i)].label = i;
  return shape;
}

inline double distance_to(const Vec2& x, const std::vector<Vec2>& segment) {
  const Vec2 d = segment[1] - segment[0];
  return (x - segment[0] - std::clamp((x - segment[0]).dot(d) / d.squaredNorm(), 0.0, 1.0) * d).norm();
}

/// Straight cracks at random, none nearer than .15 to another.
inline Shape random_cracks(int count, double half, unsigned seed) {
  Shape shape = square(half);
  std::mt19937 generator(seed);
  const auto random = [&](double low, double high) { return low + (high - low) * (generator() / 4294967296.0); };
  while (static_cast<int>(shape.cracks.size()) < count) {
    const Vec2 center(random(-half + 0.6, half - 0.6), random(-half + 0.6, half - 0.6));
    const double angle = random(0, 3.14159), length = random(0.2, 0.5);
    const std::vector<Vec2> ends{center - length * Vec2(std::cos(angle), std::sin(angle)),
                                 center + length * Vec2(std::cos(angle), std::sin(angle))};
    const auto near = [&](const Crack& other) {
      for (int i = 0; i <= 20; ++i)
        if (distance_to(ends[0] + i / 20.0 * (ends[1] - ends[0]), other.points) < 0.15) return true;
      return false;
    };
    if (std::ranges::none_of(shape.cracks, near))
      shape.cracks.push_back({fmt::format("c{}", shape.cracks.size()), ends, {}});
  }
  return shape;
}

/// Clamped below, pushed and pulled on the other sides: some cracks open, some close, some do both.
inline Scene pushed(std::size_t cracks, const CrackLaw& law, double poisson = 0.3) {
  Scene s;
  s.material = plane_strain(1, poisson);
  s.supports.push_back({0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  s.tractions.push_back({1, [](const Vec2& x, const Vec2&) -> Vec2 { return {0.4 * std::sin(x.y()), 0.3}; }});
  s.tractions.push_back({2, [](const Vec2& x, const Vec2&) -> Vec2 { return {0.3, 0.2 * x.x() - 0.3}; }});
  s.tractions.push_back({3, [](const Vec2& x, const Vec2&) -> Vec2 { return {-0.4 * std::sin(x.y()), -0.3}; }});
  s.laws.assign(cracks, law);
  return s;
}

}  // namespace kerf
