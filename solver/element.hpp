#pragma once
// The elements, as data: polynomial spaces per triangle and per edge, no basis functions. Hybridisation asks only for
// the span of the stresses, so that an element is a row of this table.

#include "geometry/types.hpp"

#include <array>
#include <string_view>

namespace kerf {

/// Stress: full tensors P_stress(T), plus the two rows curl(b_T) when `bubbles`; weakly symmetric by a discontinuous
/// rotation in P_rotation(T); displacement in P_displacement(T)^2, discontinuous; edge multipliers (the trace of the
/// displacement) in P_trace(e)^2.
struct Element {
  std::string_view name;
  int stress = 1;
  bool bubbles = false;
  int displacement = 0;
  int rotation = 1;
  int trace = 1;
};

inline constexpr std::array elements{
    // BDM1 rows with curl bubbles and discontinuous linear rotation [Stenberg 1988; Belhachmi 2008]
    Element{.name = "bdms", .stress = 1, .bubbles = true, .displacement = 0, .rotation = 1, .trace = 1},
};

constexpr int monomial_count(int degree) {
  return (degree + 1) * (degree + 2) / 2;
}
constexpr int stress_count(const Element& e) {
  return 4 * monomial_count(e.stress) + (e.bubbles ? 2 : 0);
}
constexpr int displacement_count(const Element& e) {
  return 2 * monomial_count(e.displacement);
}
constexpr int rotation_count(const Element& e) {
  return monomial_count(e.rotation);
}
/// Stress, displacement and rotation coefficients of one triangle.
constexpr int interior_count(const Element& e) {
  return stress_count(e) + displacement_count(e) + rotation_count(e);
}
constexpr int points_per_edge(const Element& e) {
  return e.trace + 1;
}
constexpr int per_edge(const Element& e) {
  return 2 * points_per_edge(e);
}

const Element& element(std::string_view name);  // throws Error(Usage) naming the known ones

}  // namespace kerf
