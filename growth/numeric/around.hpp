#pragma once
// The largest value of a function of an angle, looked for all around.

#include "growth/numeric/root.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <vector>

namespace kerf::growth {

struct LargestAround {
  double angle = 0, value = 0;
  std::optional<double> rival;  // another angle whose value is the same to 1e-9
};

/// Over [-reach, reach], by 2 steps + 1 samples and golden sections beside each local maximum. Of equal maxima that
/// which is nearest to 0 counts, then the one at a positive angle. f >= 0.
template <class Function>
LargestAround largest_around(const Function& f, double reach, int steps) {
  const auto angle = [&](int i) { return reach * i / steps; };
  std::vector<double> samples;
  for (int i = -steps; i <= steps; ++i) samples.push_back(f(angle(i)));
  const auto sample = [&](int i) { return std::abs(i) <= steps ? samples[i + steps] : -1; };
  std::vector<LargestAround> found;
  for (int n = 0; n <= steps; ++n)
    for (const int i : {n, -n}) {
      if (sample(i) < sample(i - 1) || sample(i) < sample(i + 1) || (i == 0 && !found.empty())) continue;
      const double low = angle(std::max(i - 1, -steps)), high = angle(std::min(i + 1, steps));
      LargestAround best{angle(i), sample(i), {}};
      for (const double a : {low, high, maximizer(f, low, high, 1e-9)})
        if (const double value = f(a); value > best.value) best = {a, value, {}};
      found.push_back(best);
    }
  LargestAround first = found.front();
  for (const LargestAround& c : found)
    if (c.value > first.value * (1 + 1e-9)) first = c;
  if (first.value > 0)
    for (const LargestAround& c : found)
      if (c.value >= first.value * (1 - 1e-9) && std::abs(c.angle - first.angle) > 1e-6) {
        first.rival = c.angle;
        break;
      }
  return first;
}

}  // namespace kerf::growth
