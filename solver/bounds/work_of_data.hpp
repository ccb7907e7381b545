#pragma once
// The work of the data of a state on a singular field: what is known of a quantity without a dual solution. The data
// are a polynomial and an enclosed remainder on each piece; the field is analytic away from its singular place [theory:
// D.5].

#include "solver/data/known.hpp"
#include "solver/nucleus.hpp"
#include "solver/system.hpp"

namespace kerf {

inline constexpr const char *work_sampled =
                                "the bounds are estimates: a load that is known at sampled points only is not "
                                "resolved by the mesh",
                            *not_integrated = "no bounds: the work of a load is not resolved where the quantity is";

/// What enclosures leave open is part of the interval; what sampling does is none of it if it is small beside its
/// width.
inline bool is_resolved(const Known& known, double width) {
  constexpr double negligible = 0.01;
  return !known.sampled || known.error <= negligible * width;
}

/// 1 within the inner radius, 0 beyond the outer one, three derivatives continuous.
struct Fade {
  double inner, outer;
  double operator()(double r) const;
  double slope(double r) const;
};

/// int t.G over the tractions t of the state.
Known work_of_tractions(const Model& m, const Nucleus& G);

/// A field about a point, where it is singular, that fades.
struct FadingField {
  const Nucleus& G;
  Vec2 middle;
  Fade fade;
  double start = 0;  // an angle at which G may jump, or is rough
  double rough = 0;  // within this radius G is singular on the line at that angle, or beyond it another
};
/// int f.G over the body force f.
Known work_of_body(const VectorField& f, const FadingField& field);
/// The work of a pressure in the crack that ends at the middle on the opening of G, a root that is singular there.
/// `along`: the direction in which the crack would go on.
Known work_of_pressure(const BoundaryField& p, const FadingField& field, const Vec2& along);

}  // namespace kerf
