#pragma once
// Dimensions of an element's spaces: what its row of the table implies.

#include "base/polynomial.hpp"
#include "kerf/element.hpp"

#include <algorithm>

namespace kerf {

/// The condensed matrix is positive definite (else quasi-definite).
constexpr bool is_definite(const Element& e) {
  return e.at_vertices != AtVertices::Stress;
}

/// Highest polynomial degree of a stress function.
constexpr int stress_degree(const Element& e) {
  return e.bubble < 0 ? e.stress : std::max(e.stress, e.bubble + 2);
}
/// Coefficients that a stress is stored with: the full tensors and the bubbles.
constexpr int stress_count(const Element& e) {
  return 4 * dim(e.stress) + 2 * (e.bubble + 1);
}
/// Dimension of the stress space of one triangle.
/// E.10: constants and x tau_1 in two rows, 6. E.11: three symmetric components per monomial less the conditions.
constexpr int stress_dimension(const Element& e) {
  switch (e.cut) {
    case Cut::None:
      return stress_count(e);
    case Cut::RaviartThomas:
      return 6 + 2 * (e.bubble + 1);
    case Cut::LinearDivergence:
      return 3 * dim(e.stress) - 2 * (dim(e.stress - 1) - dim(1));
    case Cut::LinearNormal:
      return 3 * dim(e.stress) - 3;
  }
  return 0;
}
constexpr int displacement_count(const Element& e) {
  return 2 * dim(e.displacement);
}
constexpr int rotation_count(const Element& e) {
  return dim(e.rotation);
}
/// Rotation functions that are eliminated with the triangle.
constexpr int inner_rotation_count(const Element& e) {
  return is_mixed(e) && !is_symmetric(e) && e.at_vertices != AtVertices::Rotation ? dim(e.rotation) : 0;
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
constexpr int per_vertex(const Element& e) {
  switch (e.at_vertices) {
    case AtVertices::Nothing:
      return 0;
    case AtVertices::Rotation:
      return 1;
    case AtVertices::Displacement:
      return 2;
    case AtVertices::Stress:
      return 3;
  }
  return 0;
}
/// Skeleton unknowns that one triangle sees.
constexpr int skeleton_count(const Element& e) {
  return 3 * (per_edge(e) + per_vertex(e));
}

}  // namespace kerf
