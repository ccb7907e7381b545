#pragma once
// What small changes of a design's topology would bring, against what their area costs [theory: L.11, L.13].

#include "kerf/validate.hpp"
#include "optimize/level_set/ground.hpp"
#include "optimize/level_set/speed.hpp"
#include "optimize/loop/evaluate.hpp"

namespace kerf {

/// Prices of area and of the bounds that bind: those that balance the rates along the boundary best.
struct Prices {
  double area = 0;
  std::vector<double> bound;  // 0: does not bind
  BoundaryRate rate = {};     // of J, and of the bounds times their prices
};
Prices prices_of(const Ground& g, const Evaluated& e);

/// The least of (T - price)/price over the triangles in which a hole may be: away from singular points, and from the
/// boundary, where moving it does the same and the shape residual says what that brings.
HoleMargin hole_margin(const Ground& g, const Evaluated& e, const Prices& prices);

/// The least of (price - worth)/price of half discs of material along the free boundary, away from singular points.
/// Not a number under body forces, and with functionals that have a density in what is added.
BumpMargin bump_margin(const Ground& g, const Evaluated& e, const Prices& prices);

/// The hole that gains most by two terms of the expansion, of radii that fit: a third of the room to the boundary at
/// most, as wide as gaps have to be at least [theory: L.14]. With a mirror the hole and its image.
BestChange best_hole(const Ground& g, const Evaluated& e, const Prices& prices, const HoleMargin& holes);

/// The half disc of material that gains most, on a base where every place pays [theory: L.21].
BestChange best_bump(const Ground& g, const Evaluated& e, const Prices& prices);

/// Holes really made where they would pay most, or cost least: whether T says what they bring.
Verdict proved(const Ground& g, const Evaluated& e, const Vec2& at);

}  // namespace kerf
