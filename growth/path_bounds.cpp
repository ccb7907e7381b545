// Intervals along a path: the bounds of each state for the tips that grow, then what follows from them: the largest k_1
// of a kink, which is the maximum over angles of F11 K_I + F12 K_II and so rises with K_I (F11 > 0) and is convex and
// even in K_II; and the life, by the rates at the ends of these intervals.

#include "growth/path_bounds.hpp"

#include "growth/kink.hpp"
#include "solver/open_faces.hpp"
#include "solver/witness.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf::growth {

namespace {

Interval of(const Bounded& b) {
  return {b.lower, b.upper};
}

}  // namespace

StateBounds bound_state(const Model& model, const State& state, std::span<const TipIntensity> tips, int threads) {
  const EnergyBounds energy = energy_bounds(model, state);
  StateBounds out{.energy = {energy.lower, energy.upper}, .guaranteed = energy.guaranteed, .note = energy.note};
  std::optional<Opened> free;
  if (open_everywhere(model, state)) free.emplace(opened(model, threads));
  const QuantityBounds bounds(free ? free->model : model, free ? free->state : state);
  QuantityRequest request;
  request.tips.assign(tips.begin(), tips.end());
  std::vector<TipBounds> found = bounds.all(request).tips;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    confront(found[i], tips[i]);
    if (free)
      for (Bounded* b : {&found[i].K_I, &found[i].K_II, &found[i].G}) qualify(*b, of_opened);
    const TipBounds& b = found[i];
    out.tips.push_back({.end = {tips[i].crack, tips[i].at_start},
                        .K_I = of(b.K_I),
                        .K_II = of(b.K_II),
                        .G = of(b.G),
                        .guaranteed = b.K_I.guaranteed && b.K_II.guaranteed && b.G.guaranteed,
                        .note = !b.K_I.guaranteed    ? b.K_I.note
                                : !b.K_II.guaranteed ? b.K_II.note
                                                     : b.G.note});
  }
  return out;
}

Interval opening_bounds(const Interval& K_I, const Interval& K_II) {
  const double most = std::max(std::abs(K_II.low), std::abs(K_II.high)),
               least = K_II.low <= 0 && K_II.high >= 0 ? 0 : std::min(std::abs(K_II.low), std::abs(K_II.high));
  return {opening_direction({K_I.low, least, 0}).k.k_1, opening_direction({K_I.high, most, 0}).k.k_1};
}

LifeBounds bound_cycles(const GrowthLaw& law, std::span<const BoundedCycles> path, BetweenPoints between) {
  std::vector<BoundedCycle> cycles;
  for (const BoundedCycles& p : path) {
    const Interval top = opening_bounds(p.top.K_I, p.top.K_II);
    const double least = std::max(p.least, 0.);
    cycles.push_back({.a = p.a,
                      .K_max_lower = top.low,
                      .K_max_upper = top.high,
                      .K_min_lower = least * top.low,
                      .K_min_upper = least * top.high});
  }
  return bound_life(law, cycles, between);
}

}  // namespace kerf::growth
