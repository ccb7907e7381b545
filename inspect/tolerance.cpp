// What a place tolerates: K of the crack on its line at lengths from that of the map to valid_length, equal in their
// logarithms; the length where K reaches the toughness, and the cycles until then by the law of growth [theory: G.13].
// K of a cycle is that of its largest load, and of its least one where that is not negative: else faces touch and K is
// 0. A crack that is critical already has its length by K ~ sqrt(a) times a polynomial: five steps of a (K_c/K)^2.

#include "inspect/tolerance.hpp"

#include "growth/life.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf::inspect {

std::string_view word(Tolerated how) {
  static constexpr std::array<std::string_view, 4> words{"", "critical", "at least", "rests"};
  return words[static_cast<std::size_t>(how)];
}

namespace {

double toughness_of(const ToleranceRequest& r) {
  return r.toughness ? *r.toughness : r.law ? r.law->K_c : infinity;
}

/// Lengths from `from` to `to`, until the stress is no longer smooth over one.
std::vector<growth::PathPoint> path_of(const NearBoundary& near, const BoundaryPlace& place, double angle,
                                       std::array<double, 2> lengths, const ToleranceRequest& r) {
  constexpr int steps = 8;
  std::vector<growth::PathPoint> path;
  for (int i = 0; i <= steps; ++i) {
    const double a = i == steps ? lengths[1] : lengths[0] * std::pow(lengths[1] / lengths[0], i / (steps * 1.));
    const EdgeCrack crack = near.at(place, a, angle);
    if (crack.masked != Masked::No && i > 0) break;
    path.push_back({a, r.max * crack.K, std::max(r.min, 0.) * crack.K});
  }
  return path;
}

/// Below the length of the map.
double shorter(const NearBoundary& near, const BoundaryPlace& place, const EdgeCrack& crack, double length, double K) {
  double a = length;
  for (int i = 0; i < 5; ++i) a *= std::pow(K / near.at(place, a, crack.angle).K, 2);
  return a;
}

}  // namespace

void check(const ToleranceRequest& r) {
  if (!r.toughness && !r.law)
    throw Error(Fault::Usage, "what a crack may bear needs a toughness or a law of growth: inspect.law");
  if (r.law) growth::check(*r.law);
  if (!(r.factor >= 1)) throw Error(Fault::Usage, fmt::format("a factor {} on lives: 1 or more is wanted", r.factor));
  if (!(r.max > 0 && r.min < r.max))
    throw Error(Fault::Usage, fmt::format("a cycle from {} to {}: a positive largest load and a smaller least one are "
                                          "wanted",
                                          r.min, r.max));
}

Tolerance tolerate(const NearBoundary& near, const BoundaryPlace& place, const EdgeCrack& crack, double length,
                   const ToleranceRequest& r) {
  Tolerance t;
  if (crack.masked != Masked::No) return t;
  const double K_c = toughness_of(r);
  if (r.max * crack.K >= K_c) {
    t.how = Tolerated::Critical;
    t.critical_length = shorter(near, place, crack, length, K_c / r.max);
    t.cycles = t.interval = 0;
    return t;
  }
  const std::vector<growth::PathPoint> path = path_of(near, place, crack.angle, {length, crack.valid_length}, r);
  if (path.size() < 2) return t;
  const std::optional<double> critical = std::isfinite(K_c) ? growth::length_at_K(path, K_c) : std::nullopt;
  if (critical) t.critical_length = *critical;
  t.how = critical ? Tolerated::Critical : Tolerated::AtLeast;
  if (!r.law) return t;
  const growth::Life life(*r.law, path);
  t.cycles = life.cycles();
  t.interval = t.cycles / r.factor;
  if (life.end() == growth::LifeEnd::Rests) t.how = Tolerated::Rests;
  return t;
}

void set_safe_length(const std::vector<BoundaryPlace>& places, EdgeCrackMap& map) {
  for (std::size_t i = 0; i < places.size(); ++i)
    if (const double a = map.tolerance[i].critical_length; !(a >= map.safe_length) && !std::isnan(a))
      map.safe_length = a, map.safe_at = i;
  double all = 0, open = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    all += places[i].length;
    const EdgeCrack& crack = map.places[i];
    const bool known = crack.masked == Masked::No &&
                       (!std::isnan(map.tolerance[i].critical_length) || !(crack.valid_length < map.safe_length));
    if (!known) open += places[i].length;
  }
  map.open_share = all > 0 ? open / all : 0;
}

}  // namespace kerf::inspect
