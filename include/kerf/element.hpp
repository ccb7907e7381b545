#pragma once
// The elements, as data: polynomial spaces per triangle and per edge, no basis functions. Hybridization asks only for
// the span of the stresses, so that an element is a row of this table.

#include "kerf/types.hpp"

#include <array>
#include <string_view>

namespace kerf {

/// Linear conditions that cut the stresses of an element out of the full tensors P_stress(T).
enum class Cut {
  None,
  RaviartThomas,     // rows in P_0^2 + x P_0
  LinearDivergence,  // symmetric, div s in P_1^2
  LinearNormal,      // symmetric, n.s n in P_1 on each edge
};

/// What lives at vertices, one value per fan of triangles between open cracks.
enum class AtVertices { Nothing, Rotation, Stress, Displacement };

/// Mixed elements. Stress: P_stress(T) tensors after the cut, plus rows curl(b_T w), w homogeneous of degree `bubble`,
/// when bubble >= 0; displacement in P_displacement(T)^2, discontinuous; edge multipliers (the trace of the
/// displacement) in P_trace(e)^2. The rotation in P_rotation(T) enforces weak symmetry; symmetric elements get theirs
/// from their strains afterwards.
/// Displacement elements: continuous P_displacement; `stress` and `rotation` are those of its gradient.
struct Element {
  std::string_view name;
  int degree = 1;  // the user's
  int order = 2;   // the stress error is h^order on smooth fields
  int stress = 1;
  Cut cut = Cut::None;
  int bubble = -1;
  int displacement = 0;
  int rotation = 1;
  int trace = 1;
  AtVertices at_vertices = AtVertices::Nothing;
  double efficiency = 1;  // measured: error indicator over stress error, the middle of its range
};

/// BDM_k rows with curl(b P_(k-1)) and discontinuous rotation in P_k [Stenberg 1988; Belhachmi 2008 for k = 1]. The
/// bubbles have no divergence and no normal trace: (as curl(b w), eta) = (b w, grad eta) controls the non-constant part
/// of the rotation, so that the family is stable because Arnold-Falk-Winther's is. For w of degree up to k - 2 they lie
/// in P_k already.
constexpr Element bdms(int k) {
  return {.name = "bdms",
          .degree = k,
          .order = k + 1,
          .stress = k,
          .bubble = k - 1,
          .displacement = k - 1,
          .rotation = k,
          .trace = k,
          .efficiency = k == 1   ? 5.2
                        : k == 2 ? 8
                                 : 11};
}
/// [Arnold, Falk, Winther 2007]: no bubbles, the rotation one degree lower, and with it the order.
constexpr Element afw(int k) {
  return {.name = "afw",
          .degree = k,
          .order = k,
          .stress = k,
          .displacement = k - 1,
          .rotation = k - 1,
          .trace = k,
          .efficiency = k == 1   ? 1.7
                        : k == 2 ? 6.3
                                 : 8.5};
}

/// [Arnold, Brezzi, Douglas 1984]
inline constexpr Element peers{.name = "peers",
                               .order = 1,
                               .cut = Cut::RaviartThomas,
                               .bubble = 0,
                               .trace = 0,
                               .at_vertices = AtVertices::Rotation,
                               .efficiency = 3.4};
/// BDM_1 rows with the two bubbles and a continuous rotation.
inline constexpr Element bdms_continuous{
    .name = "bdms-c", .bubble = 0, .at_vertices = AtVertices::Rotation, .efficiency = 3.3};
/// [Arnold, Winther 2002]: symmetric P_3 with linear divergence, hybridized by P_3 traces, which see normal continuity
/// only: no unknowns at vertices, cracks come for free.
inline constexpr Element arnold_winther{.name = "arnold-winther",
                                        .order = 3,
                                        .stress = 3,
                                        .cut = Cut::LinearDivergence,
                                        .displacement = 1,
                                        .rotation = 3,
                                        .trace = 3,
                                        .efficiency = 8};
/// The same with the stress continuous at vertices, as in the paper; bodies without cracks.
inline constexpr Element arnold_winther_conforming{.name = "arnold-winther-c",
                                                   .order = 3,
                                                   .stress = 3,
                                                   .cut = Cut::LinearDivergence,
                                                   .displacement = 1,
                                                   .rotation = 3,
                                                   .trace = 1,
                                                   .at_vertices = AtVertices::Stress,
                                                   .efficiency = 8.2};
/// [Arnold, Winther 2003]: nonconforming.
inline constexpr Element arnold_winther_nonconforming{.name = "arnold-winther-nc",
                                                      .order = 1,
                                                      .stress = 2,
                                                      .cut = Cut::LinearNormal,
                                                      .displacement = 1,
                                                      .rotation = 2,
                                                      .trace = 1,
                                                      .efficiency = 4.7};
/// Continuous displacements, for comparison: they lock as nu -> 1/2.
constexpr Element displacement_element(int k) {
  return {.name = k == 1 ? "p1" : "p2",
          .order = k,
          .stress = k - 1,
          .displacement = k,
          .rotation = k - 1,
          .trace = k - 2,
          .at_vertices = AtVertices::Displacement};
}

inline constexpr std::array elements{bdms(1),
                                     bdms(2),
                                     bdms(3),
                                     bdms_continuous,
                                     peers,
                                     afw(1),
                                     afw(2),
                                     afw(3),
                                     arnold_winther,
                                     arnold_winther_conforming,
                                     arnold_winther_nonconforming,
                                     displacement_element(1),
                                     displacement_element(2)};

constexpr bool is_mixed(const Element& e) {
  return e.at_vertices != AtVertices::Displacement;
}
constexpr bool is_symmetric(const Element& e) {
  return e.cut == Cut::LinearDivergence || e.cut == Cut::LinearNormal;
}

const Element& element(std::string_view name, int degree = 1);  // throws Error(Usage) naming the known ones

}  // namespace kerf
