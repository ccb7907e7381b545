#pragma once
// The largest stress of a body as a functional, and where it is not looked for.

#include "kerf/functional.hpp"

#include <array>
#include <string_view>
#include <vector>

namespace kerf {

/// Where a largest stress is not looked for: within `radius` of the straight line from a to b, which may be a point.
struct StressZone {
  Vec2 a = Vec2::Zero(), b = Vec2::Zero();
  double radius = 0;
  std::string what;      // is there, in words
  bool support = false;  // of a support: designs choose where they meet it
  bool holds(const Vec2& x) const;
};

/// The largest stress of a body outside of zones. Its derivative is that of the p-norm of the stress there, scaled to
/// the largest value.
struct LargestStress {
  enum class Of { VonMises, Principal } of = Of::VonMises;  // Principal: the larger one, without its sign
  bool plane_strain = false;
  double ends = 0.01, supports = 0.014;  // radii of zones, in diagonals of the body's bounding box
  std::vector<StressZone> zones = {};
  bool leaves_out(const Vec2& x) const;
};
inline constexpr std::array<std::string_view, 2> largest_stress_words{"von_mises", "principal"};
inline constexpr double largest_stress_power = 12;  // of the norm

/// Value: the largest stress outside of the zones, on a mesh at the points of its quadrature and in the middles of
/// boundary edges.
Term max_stress(const LargestStress& what);

}  // namespace kerf
