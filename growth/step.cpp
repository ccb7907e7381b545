// How far tips go that compete, by the shares of their rates [theory: G.22], which way the load goes [theory: G.23],
// and the energy that a path takes. docs/theory/growth.md.

#include "growth/step.hpp"

#include "growth/numeric/cubic.hpp"
#include "growth/numeric/integral.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf::growth {

Advances advance(std::span<const double> rates, double longest) {
  if (!(longest > 0) || !std::isfinite(longest))
    throw Error(Fault::Usage, fmt::format("the longest advance of a tip is {}; a positive length is wanted", longest));
  Advances a;
  double fastest = 0;
  for (const double r : rates) {
    if (!(r >= 0)) throw Error(Fault::Usage, fmt::format("a tip grows by {} per cycle; 0 or more is wanted", r));
    fastest = std::max(fastest, r);
  }
  a.runs = fastest == infinity;
  a.all_rest = fastest == 0;
  for (const double r : rates)
    a.lengths.push_back(a.all_rest     ? 0
                        : a.runs       ? (r == infinity ? longest : 0)
                        : r == fastest ? longest
                                       : longest * (r / fastest));
  return a;
}

Course course(const LoadPoint& before, const LoadPoint& after) {
  if (after.load_factor >= before.load_factor) return Course::Stable;
  return after.displacement >= before.displacement ? Course::LoadFalls : Course::SnapBack;
}

namespace {

void check_releases(std::span<const double> a, std::span<const double> G) {
  if (a.size() < 2 || a.size() != G.size())
    throw Error(Fault::Usage, fmt::format("G at {} of {} lengths of a path; two at least, and as many, are wanted",
                                          G.size(), a.size()));
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!std::isfinite(a[i]) || !std::isfinite(G[i]) || (i > 0 && !(a[i] > a[i - 1])))
      throw Error(
          Fault::Usage,
          fmt::format("G = {} at length {} of a path; finite numbers at lengths that rise are wanted", G[i], a[i]));
}

double area_below(std::span<const double> x, std::span<const double> y) {
  const MonotoneCubic f(x, y);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) sum += gauss(f, x[i], x[i + 1]);  // exact: a cubic
  return sum;
}

}  // namespace

ReleasedEnergy released_energy(std::span<const double> a, std::span<const double> G) {
  check_releases(a, G);
  const double energy = area_below(a, G);
  if (a.size() == 2) return {energy, nan};
  std::vector<double> x, y;
  for (const std::size_t i : every_second(a.size())) {
    x.push_back(a[i]);
    y.push_back(G[i]);
  }
  return {energy, std::abs(energy - area_below(x, y))};
}

ReleasedBounds bound_released_energy(std::span<const double> a, std::span<const double> G_lower,
                                     std::span<const double> G_upper) {
  check_releases(a, G_lower);
  check_releases(a, G_upper);
  ReleasedBounds sum;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (G_lower[i] > G_upper[i])
      throw Error(Fault::Usage,
                  fmt::format("G in [{}, {}] at length {} of a path is no interval", G_lower[i], G_upper[i], a[i]));
  for (std::size_t i = 0; i + 1 < a.size(); ++i) {
    sum.lower += (a[i + 1] - a[i]) * std::min(G_lower[i], G_lower[i + 1]);
    sum.upper += (a[i + 1] - a[i]) * std::max(G_upper[i], G_upper[i + 1]);
  }
  return sum;
}

}  // namespace kerf::growth
