#pragma once
// The elements, as data: polynomial spaces per triangle and per edge, no basis functions. Hybridisation asks only for
// the span of the stresses, so that an element is a row of this table.

#include "solver/polynomial.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace kerf {

/// Stress: full tensors P_stress(T), plus rows curl(b_T w), w homogeneous of degree `bubble`, when bubble >= 0; weakly
/// symmetric by a discontinuous rotation in P_rotation(T); displacement in P_displacement(T)^2, discontinuous; edge
/// multipliers (the trace of the displacement) in P_trace(e)^2. `degree` is the user's: the order of the stress is
/// stress + 1 with bubbles.
struct Element {
  std::string_view name;
  int degree = 1;
  int stress = 1;
  int bubble = -1;
  int displacement = 0;
  int rotation = 1;
  int trace = 1;
};

/// Element of a family at degree k: BDM_k rows with curl(b P_(k-1)) and discontinuous rotation in P_k [Stenberg 1988;
/// Belhachmi 2008 for k = 1]. The bubbles have no divergence and no normal trace: (as curl(b w), eta) = (b w, grad eta)
/// controls the non-constant part of the rotation, so that the family is stable because Arnold-Falk-Winther's is. For
/// w of degree up to k - 2 they lie in P_k already.
constexpr Element bdms(int k) {
  return {.name = "bdms", .degree = k, .stress = k, .bubble = k - 1, .displacement = k - 1, .rotation = k, .trace = k};
}

inline constexpr std::array elements{bdms(1), bdms(2), bdms(3)};

/// Highest polynomial degree of a stress function.
constexpr int stress_degree(const Element& e) {
  return e.bubble < 0 ? e.stress : std::max(e.stress, e.bubble + 2);
}
constexpr int stress_count(const Element& e) {
  return 4 * dim(e.stress) + 2 * (e.bubble + 1);
}
constexpr int displacement_count(const Element& e) {
  return 2 * dim(e.displacement);
}
constexpr int rotation_count(const Element& e) {
  return dim(e.rotation);
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

const Element& element(std::string_view name, int degree = 1);  // throws Error(Usage) naming the known ones

}  // namespace kerf
