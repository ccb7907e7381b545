// The functionals, each as the densities of a Term with their derivatives by the fields. Energy, compliance and misfit
// name what the solver computes (N.8, T.7). Tracking is 1/2 int w |u - u_d|^2 over the body or a part of the boundary
// [theory: T.15]; displacement, opening and pressure of a crack are integrals over boundary and faces. The release rate
// of a tip is a domain integral over a ring [Destuynder, Djaoua 1981; theory: T.24],
//   G = int s : (grad u grad theta) - 1/2 s : eps div theta - f . (grad u theta),   grad u = A s + Gamma(omega),
// theta = direction q(r), q = 1 at the tip and 0 beyond the ring. It sees stress and rotation, so that the loads of its
// adjoint live in the ring. Derived in docs/theory/topological_derivatives.md, sections "Functionals of the
// displacement and of cracks" and "Energy release rate".

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

// theta = direction q(r), q = 1 inside ring[0], 0 outside ring[1], a quintic between: two continuous derivatives.
Term energy_release_rate(const Vec2& tip, const Vec2& direction, const std::array<double, 2>& ring, VectorField body) {
  const double inner = ring[0], outer = ring[1];
  const Vec2 along = direction.normalized();
  Term term{.kind = "energy_release_rate"};
  term.uses_stress = term.uses_rotation = true;
  term.feature = tip;
  term.feature_radius = outer;
  term.release_along = along;
  const bool loaded = static_cast<bool>(body);
  // With a body force q itself counts and the disc inside the ring has a density.
  term.somewhere = [=](const Vec2& center, double radius) {
    const double r = (center - tip).norm();
    return r - radius < outer && (loaded || r + radius > inner);
  };
  term.density = [=, body = std::move(body)](const FieldPoint& p) {
    const Vec2 d = p.x - tip;
    const double r = d.norm();
    if (r >= outer) return Density{};
    const double t = (r - inner) / (outer - inner);
    // 1 - 10 t^3 + 15 t^4 - 6 t^5 and its slope -30 t^2 (1 - t)^2 over the width of the ring.
    const double q = r <= inner ? 1 : 1 - t * t * t * (10 - 15 * t + 6 * t * t);
    const double slope = r <= inner ? 0 : -30 * t * t * (1 - t) * (1 - t) / (outer - inner);
    // grad theta = along (x) grad q; grad u from the mixed solution.
    const Vec2 grad_q = r > 0 ? Vec2(slope / r * d) : Vec2::Zero();
    const Mat2& s = p.stress;
    const Mat2 e = strain(p.material, s);
    Mat2 grad_u = e;
    grad_u(0, 1) += p.rotation;
    grad_u(1, 0) -= p.rotation;
    const Vec2 moved = grad_u * along;  // du/d(along)
    const double div = along.dot(grad_q);
    const Vec2 traction = s * grad_q;
    Density g;
    g.value = moved.dot(traction) - 0.5 * s.cwiseProduct(e).sum() * div;
    // By the gradient: traction (x) along; A is symmetric.
    const Mat2 by_gradient = traction * along.transpose();
    // Through s in s grad q, through grad u = A s in both, and through the energy.
    g.by_stress = moved * grad_q.transpose() + strain(p.material, by_gradient) - div * e;
    g.by_rotation = by_gradient(0, 1) - by_gradient(1, 0);
    if (loaded) {
      const Vec2 force = q * body(p.x);
      g.value -= force.dot(moved);
      const Mat2 of_force = force * along.transpose();
      g.by_stress -= strain(p.material, of_force);
      g.by_rotation -= of_force(0, 1) - of_force(1, 0);
    }
    return g;
  };
  return term;
}

}  // namespace kerf
