#pragma once
// The elements, as data: polynomial spaces per triangle and per edge, no basis functions. Hybridization asks only for
// the span of the stresses, so that an element is a row of this table.

#include "kerf/types.hpp"

#include <array>
#include <optional>
#include <string>
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
  double efficiency = 1;  // error indicator over stress error where the body itself does not tell
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
                        : k == 3 ? 11
                                 : 26};
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
                        : k == 3 ? 8.5
                                 : 14.5};
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
                                     bdms(4),
                                     bdms_continuous,
                                     peers,
                                     afw(1),
                                     afw(2),
                                     afw(3),
                                     afw(4),
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
/// At a vertex the tractions on two edges determine each other (s n1 . n2 = s n2 . n1): some traces are seen by no
/// triangle.
constexpr bool has_unseen_traces(const Element& e) {
  return e.cut == Cut::LinearDivergence && e.at_vertices == AtVertices::Nothing;
}

// What an element can do. Every refusal asks these functions, and docs/case-files/solver.md is tested against them.

/// Cracks whose faces part: a stress that is continuous at vertices ties them together there.
constexpr bool can_open(const Element& e) {
  return e.at_vertices != AtVertices::Stress;
}
/// Unilateral contact on cracks, with friction or without: bounds on jumps at the Gauss points of edges.
constexpr bool can_contact(const Element& e) {
  return is_mixed(e) && can_open(e);
}
/// Cracks under the pressure of a fluid: where some traces are seen by no triangle, loads on faces would have to fit.
constexpr bool can_press_cracks(const Element& e) {
  return can_open(e) && !has_unseen_traces(e);
}
/// Regions of other materials, across which the stress along the interface jumps.
constexpr bool can_have_regions(const Element& e) {
  return e.at_vertices != AtVertices::Stress;
}
/// Eigenstrains: the rotation of symmetric elements comes from A s alone.
constexpr bool can_be_strained(const Element& e) {
  return is_mixed(e) && !is_symmetric(e);
}
/// Triangles with curved edges, onto which Piola's transformation takes the spaces of straight ones.
constexpr bool can_be_curved(const Element& e) {
  return is_mixed(e) && !is_symmetric(e) && e.at_vertices == AtVertices::Nothing && e.cut == Cut::None;
}
/// Incompressible materials, nu = 1/2.
constexpr bool can_be_incompressible(const Element& e) {
  return is_mixed(e);
}
/// Incompressible bodies whose supports prescribe their area: the level of the pressure is free.
constexpr bool can_be_enclosed(const Element& e) {
  return is_mixed(e) && e.at_vertices != AtVertices::Stress;
}
/// The saddle point that is not condensed (umfpack): the normal stress of a triangle reaches the moments of its edges
/// independently.
constexpr bool can_stay_uncondensed(const Element& e) {
  return is_mixed(e) && e.at_vertices != AtVertices::Stress && !has_unseen_traces(e);
}
/// Adjoints, and with them the maps of functionals that need one.
constexpr bool can_adjoint(const Element& e) {
  return is_mixed(e) && e.at_vertices != AtVertices::Stress;
}
/// Functionals over a part of the boundary, from the traces on its edges.
constexpr bool can_integrate_boundaries(const Element& e) {
  return is_mixed(e);
}
/// Maps of clamped holes, which need the Green tensor of the body.
constexpr bool can_clamp_holes(const Element& e) {
  return can_adjoint(e);
}
/// Validation of maps: the body is condensed onto edges alone, each trace seen from either side.
constexpr bool can_validate(const Element& e) {
  return e.at_vertices == AtVertices::Nothing && !has_unseen_traces(e);
}
/// Derivatives by the shape, and with them optimization: Piola's transformation maps the spaces onto themselves when
/// the mesh moves. It does not keep a stress symmetric.
constexpr bool can_optimize(const Element& e) {
  return is_mixed(e) && !is_symmetric(e);
}
/// Bounds of the energy, which need a rotation of the triangle's own.
constexpr bool can_bound_energy(const Element& e) {
  return e.at_vertices == AtVertices::Nothing && !is_symmetric(e);
}
/// An estimate of the error, and with it adaptive meshes: the indicator knows what equilibrated stresses lack.
constexpr bool can_estimate_error(const Element& e) {
  return is_mixed(e);
}
/// Error bars, from an element of higher order: bdms of that degree, up to 4.
constexpr bool can_be_bettered(const Element& e) {
  return e.order <= 4;
}

using Ability = bool (*)(const Element&);

bool has_degree(std::string_view name, int degree);
const Element& element(std::string_view name, int degree = 1);  // throws Error(Usage) naming the known ones

/// `"bdms", "peers" or "afw"`: those that can, with their degrees where only some can.
std::string elements_that(Ability can);
/// The one wording of every refusal, such as `element "p2" has no adjoint; use "bdms" or "afw"`, where the element
/// cannot; nothing where it can. `can` is one of the functions above.
std::optional<std::string> refusal(const Element& e, Ability can);
void require(const Element& e, Ability can);  // throws Error(Usage) with it

}  // namespace kerf
