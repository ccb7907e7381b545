// How far tips go that compete, which one moves first, and whether one step agrees with two halves: shares by rates
// [theory: G.22], the least load factor [theory: G.23], differences of order 2^p - 1 [theory: G.24].
// docs/theory/growth.md.

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

LeadingTip leading_tip(std::span<const double> G, std::span<const double> G_c, double tie) {
  if (G.size() != G_c.size())
    throw Error(Fault::Usage, fmt::format("{} tips have G, {} a toughness; as many are wanted", G.size(), G_c.size()));
  std::vector<double> factors;
  LeadingTip lead;
  for (std::size_t i = 0; i < G.size(); ++i) {
    if (!(G_c[i] > 0))
      throw Error(Fault::Usage, fmt::format("the toughness of a tip is {}; a positive number is wanted", G_c[i]));
    if (std::isnan(G[i])) throw Error(Fault::Usage, "G of a tip is not a number");
    factors.push_back(G[i] > 0 ? std::sqrt(G_c[i] / G[i]) : infinity);
    if (factors[i] < lead.load_factor) lead.tip = static_cast<Index>(i), lead.load_factor = factors[i];
  }
  for (std::size_t i = 0; i < factors.size() && lead.tip != none; ++i)
    if (static_cast<Index>(i) != lead.tip && factors[i] <= lead.load_factor * (1 + tie))
      lead.with_it.push_back(static_cast<Index>(i));
  return lead;
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

StepJudgement judge(const StepResultAt& whole, const StepResultAt& halves, double length, const StepControl& control) {
  if (whole.tips.size() != halves.tips.size() || whole.numbers.size() != halves.numbers.size())
    throw Error(Fault::Usage, "a step and its halves have different tips or numbers");
  if (!(length > 0) || !(control.tolerance > 0) || control.order < 1)
    throw Error(Fault::Usage,
                fmt::format("a step of length {} is judged with tolerance {} and order {}; positive numbers are wanted",
                            length, control.tolerance, control.order));
  // The local error of order p falls by 2^(p + 1) per half, and there are two: the halves err by a (2^p - 1)th of the
  // difference.
  const double share = 1 / (std::pow(2, control.order) - 1);
  StepJudgement j;
  double worst = 0;  // error over what is allowed
  for (std::size_t i = 0; i < whole.tips.size(); ++i) {
    const Vec2 error = share * (halves.tips[i] - whole.tips[i]);
    j.better_tips.emplace_back(halves.tips[i] + error);
    j.tip_error = std::max(j.tip_error, error.norm());
  }
  worst = j.tip_error / (control.tolerance * length);
  for (std::size_t i = 0; i < whole.numbers.size(); ++i) {
    const double error =
        whole.numbers[i] == halves.numbers[i] ? 0 : share * std::abs(whole.numbers[i] - halves.numbers[i]);
    j.number_errors.push_back(error);
    if (error == 0) continue;
    const double share_of_allowed = error / (control.tolerance * std::abs(halves.numbers[i]));
    worst = std::isfinite(error) ? std::max(worst, share_of_allowed) : infinity;
  }
  if (std::isnan(worst)) worst = infinity;
  constexpr double safety = 0.9, shortest = 0.25, longest = 2;
  const double scale = std::clamp(safety * std::pow(worst, -1. / control.order), shortest, longest);
  j.next_length = std::clamp(length * scale, control.least, control.most);
  j.accepted = worst <= 1;
  if (!j.accepted && length <= control.least) j.accepted = j.at_least = true;
  return j;
}

void PathErrors::add(const StepJudgement& step) {
  tip += step.tip_error;
  numbers.resize(std::max(numbers.size(), step.number_errors.size()), 0);
  for (std::size_t i = 0; i < step.number_errors.size(); ++i) numbers[i] += step.number_errors[i];
}

}  // namespace kerf::growth
