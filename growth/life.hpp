#pragma once
// The life of a crack: the cycles from a length to another, by K at a few lengths of its path, with an error that two
// resolutions show, and bounds of it from bounds of K [theory: G.13, G.14, G.15].
//
// Lengths a > 0 along the path, in the unit of the law's C, rising. All functions throw Error (Usage) for points that
// do not rise, are not finite, or are fewer than two.

#include "growth/rates.hpp"

#include <memory>
#include <span>
#include <vector>

namespace kerf::growth {

/// What a cycle of load does to a crack of length a.
struct PathPoint {
  double a = 0, K_max = 0, K_min = 0;
};

enum class LifeEnd {
  Reached,  // the last point
  Runs,     // K_max reached K_c
  Rests     // dK fell to the threshold
};

/// N(a) = int da/(da/dN), ln dK and ln K_max as cubics in ln a.
class Life {
 public:
  Life(const GrowthLaw& law, std::span<const PathPoint> path);
  /// By da/dN itself at lengths, or da per block of loads: cycles are blocks then.
  static Life of_rates(std::span<const double> a, std::span<const double> rates);

  /// Until the end; infinity where it rests.
  double cycles() const;
  /// |cycles - those by about every second point|, above the error where the points resolve the path; infinity where
  /// one of the two rests and the other does not, not a number for two points, which have nothing to be compared with.
  double error() const;
  LifeEnd end() const;
  /// The length at the end: of the last point, or where it runs or rests.
  double end_length() const;
  /// Cycles at the given points, as far as it comes; from where it runs on those at the end, from where it rests on
  /// infinity.
  const std::vector<double>& cycles_at_points() const;
  /// Cycles at any length between the first and the last point.
  double cycles_at(double a) const;
  /// The length after so many cycles; after the end, that of the end.
  double length_at(double cycles) const;

 private:
  struct Inner;
  explicit Life(std::shared_ptr<const Inner> inner);
  std::shared_ptr<const Inner> inner_;
};

/// The first length at which K_max reaches K, between the first and the last point.
std::optional<double> length_at_K(std::span<const PathPoint> path, double K);

/// K of both loads between bounds.
struct BoundedCycle {
  double a = 0;
  double K_max_lower = 0, K_max_upper = 0, K_min_lower = 0, K_min_upper = 0;
};
/// What K does between the points.
enum class BetweenPoints {
  Smooth,   // as cubics through the bounds, whose error by two resolutions widens the interval; three points at least
  Monotone  // K is between its values at the two ends: nothing else is assumed, and a step is as wide as its K changes
};
/// Bounds of the cycles until the last point, or until the crack runs; infinity where it may rest. Theorems of the laws
/// of Paris, Walker and Forman (m >= 1); for NASGRO the rates of a box are looked at in 25 places.
struct LifeBounds {
  double lower = 0, upper = 0;
};
LifeBounds bound_life(const GrowthLaw& law, std::span<const BoundedCycle> path, BetweenPoints between);

}  // namespace kerf::growth
