// The functionals, each as the densities of a Term with their derivatives by the fields. Energy, compliance and misfit
// name what the solver computes (N.8, T.7). Tracking is 1/2 int w |u - u_d|^2 over the body or a part of the boundary
// [theory: T.15]; displacement, opening and pressure of a crack are integrals over boundary and faces. What is of a tip
// is in tip.cpp. Derived in docs/theory/topological_derivatives.md, section "Functionals of the displacement and of
// cracks".

#include "kerf/functional.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

double weigh(const ScalarField& weight, const Vec2& x) {
  return weight ? weight(x) : 1;
}

}  // namespace

Term energy() {
  return {.kind = "energy", .energy = true};
}

Term compliance() {
  return {.kind = "compliance", .linear = true, .work = true};
}

// Its density sees no place, so that no rule is cut for it.
Term volume() {
  return {.kind = "volume",
          .linear = true,
          .volume = true,
          .density = [](const FieldPoint&) { return Density{.value = 1}; },
          .uses_place = false};
}

Term misfit(Index label, BoundaryField measured) {
  return {.kind = "misfit", .measured = Support{.label = label, .value = std::move(measured)}};
}

// 1/2 w |u - u_d|^2; without a target u_d = 0, without a weight w = 1.
Term displacement_tracking(VectorField target, ScalarField weight) {
  const bool varies = target || weight;
  return {.kind = "displacement_tracking",
          .density =
              [target = std::move(target), weight = std::move(weight)](const FieldPoint& p) {
                const Vec2 away = target ? Vec2(p.displacement - target(p.x)) : p.displacement;
                const double w = weigh(weight, p.x);
                return Density{.value = 0.5 * w * away.squaredNorm(), .by_displacement = w * away};
              },
          .uses_displacement = true,
          .uses_place = varies};
}

// The same over a part of the boundary, data depending on the normal as well.
Term boundary_tracking(Index label, BoundaryField target, BoundaryWeight weight) {
  return {.kind = "boundary_tracking",
          .label = label,
          .on_boundary = [target = std::move(target), weight = std::move(weight)](const Vec2& x, const Vec2& n,
                                                                                  const Vec2& u) {
            const Vec2 away = target ? Vec2(u - target(x, n)) : u;
            const double w = weight ? weight(x, n) : 1;
            return Density{.value = 0.5 * w * away.squaredNorm(), .by_displacement = w * away};
          }};
}

// w d . u, linear: its derivative does not depend on the state.
Term boundary_displacement(Index label, BoundaryField direction, BoundaryWeight weight) {
  return {.kind = "displacement",
          .linear = true,
          .label = label,
          .on_boundary = [direction = std::move(direction), weight = std::move(weight)](const Vec2& x, const Vec2& n,
                                                                                        const Vec2& u) {
            const Vec2 along = (weight ? weight(x, n) : 1) * direction(x, n);
            return Density{.value = along.dot(u), .by_displacement = along};
          }};
}

Term crack_opening(Index crack, ScalarField weight) {
  return {.kind = "crack_opening",
          .linear = true,
          .crack = crack,
          .on_crack = [weight = std::move(weight)](const CrackState& c) {
            const double w = weigh(weight, c.x);
            return CrackDensity{.value = w * c.jump_n, .by_jump_n = w};
          }};
}

// 1/2 w (p - p_d)^2 over the faces.
Term crack_pressure(Index crack, ScalarField target, ScalarField weight) {
  return {.kind = "crack_pressure",
          .crack = crack,
          .on_crack = [target = std::move(target), weight = std::move(weight)](const CrackState& c) {
            const double w = weigh(weight, c.x), away = c.pressure - (target ? target(c.x) : 0);
            return CrackDensity{.value = 0.5 * w * away * away, .by_pressure = w * away};
          }};
}

}  // namespace kerf
