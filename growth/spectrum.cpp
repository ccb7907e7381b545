// Rainflow counting on a stack of turning points, and K over the level of load.

#include "growth/spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf::growth {

namespace {

void check_history(std::span<const double> history) {
  if (history.size() < 2)
    throw Error(Fault::Usage, fmt::format("a history of load has {} values; two at least are wanted", history.size()));
  for (std::size_t i = 0; i < history.size(); ++i)
    if (!std::isfinite(history[i]))
      throw Error(Fault::Usage,
                  fmt::format("value {} of a history of load is {}; a finite number is wanted", i + 1, history[i]));
}

LoadCycle between(double a, double b, double count) {
  return {std::max(a, b), std::min(a, b), count};
}

// Closes the cycles of a stack of turning points whose last one is new. `halves`: a range with the first point is half
// a cycle, after which the history begins with the next point.
void close_cycles(std::vector<double>& stack, bool halves, std::vector<LoadCycle>& found) {
  while (stack.size() >= 3) {
    const std::size_t n = stack.size();
    const double range = std::abs(stack[n - 1] - stack[n - 2]), before = std::abs(stack[n - 2] - stack[n - 3]);
    if (range < before) return;
    if (n == 3 && halves) {
      found.push_back(between(stack[0], stack[1], 0.5));
      stack.erase(stack.begin());
    } else {
      found.push_back(between(stack[n - 3], stack[n - 2], 1));
      stack.erase(stack.end() - 3, stack.end() - 1);
    }
  }
}

// A component of K over levels.
struct Component {
  std::span<const double> x;
  std::span<const TipLoad> tips;
  double TipLoad::*part;

  double value(std::size_t i) const {
    return tips[i].*part;
  }
  double secant(std::size_t i) const {
    return (value(i + 1) - value(i)) / (x[i + 1] - x[i]);
  }
  // Second difference of the points i, i + 1, i + 2.
  double bend(std::size_t i) const {
    return (secant(i + 1) - secant(i)) / (x[i + 2] - x[i]);
  }
  // The bend that is taken in the interval i.
  double taken(std::size_t i) const {
    if (i == 0 || i + 2 >= x.size()) return 0;
    const double left = bend(i - 1), right = bend(i), least = std::abs(left) <= std::abs(right) ? left : right;
    return std::abs(least) * (x[i + 1] - x[i]) > std::abs(secant(i)) ? 0 : least;
  }
  double at(std::size_t i, double t) const {
    return value(i) + (t - x[i]) * (secant(i) + taken(i) * (t - x[i + 1]));
  }
  // How far what is taken is from the line and from the parabolas in the middle of the interval i.
  double doubt(std::size_t i) const {
    const double own = taken(i), h = x[i + 1] - x[i];
    double most = std::abs(own);
    if (i > 0) most = std::max(most, std::abs(bend(i - 1) - own));
    if (i + 2 < x.size()) most = std::max(most, std::abs(bend(i) - own));
    return most * h * h / 4;
  }
};

}  // namespace

std::vector<double> turning_points(std::span<const double> history) {
  check_history(history);
  std::vector<double> points;
  for (const double v : history) {
    if (!points.empty() && v == points.back()) continue;
    const std::size_t n = points.size();
    if (n >= 2 && (points[n - 1] > points[n - 2]) == (v > points[n - 1])) points.pop_back();
    points.push_back(v);
  }
  return points;
}

std::vector<LoadCycle> rainflow(std::span<const double> history) {
  std::vector<LoadCycle> found;
  std::vector<double> stack;
  for (const double v : turning_points(history)) {
    stack.push_back(v);
    close_cycles(stack, true, found);
  }
  for (std::size_t i = 0; i + 1 < stack.size(); ++i) found.push_back(between(stack[i], stack[i + 1], 0.5));
  return found;
}

std::vector<LoadCycle> rainflow_of_block(std::span<const double> history) {
  check_history(history);
  // From its largest value to that again.
  std::vector<double> turned(history.begin(), history.end());
  std::rotate(turned.begin(), std::max_element(turned.begin(), turned.end()), turned.end());
  turned.push_back(turned.front());
  std::vector<LoadCycle> found;
  std::vector<double> stack;
  for (const double v : turning_points(turned)) {
    stack.push_back(v);
    close_cycles(stack, false, found);
  }
  return found;
}

std::vector<LoadCycle> merged(std::span<const LoadCycle> cycles) {
  std::vector<LoadCycle> all(cycles.begin(), cycles.end());
  std::stable_sort(all.begin(), all.end(), [](const LoadCycle& a, const LoadCycle& b) {
    const double first = a.max - a.min, second = b.max - b.min;
    return first != second ? first > second : a.max > b.max;
  });
  std::vector<LoadCycle> kept;
  for (const LoadCycle& c : all) {
    if (!kept.empty() && kept.back().max == c.max && kept.back().min == c.min)
      kept.back().count += c.count;
    else
      kept.push_back(c);
  }
  return kept;
}

LoadCurve::LoadCurve(std::vector<double> levels, std::vector<TipLoad> tips)
    : levels_(std::move(levels)), tips_(std::move(tips)) {
  if (levels_.size() < 2 || levels_.size() != tips_.size())
    throw Error(Fault::Usage, fmt::format("K at {} levels of {} loads; two at least, and as many, are wanted",
                                          tips_.size(), levels_.size()));
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    if (!std::isfinite(levels_[i]) || (i > 0 && !(levels_[i] > levels_[i - 1])))
      throw Error(Fault::Usage,
                  fmt::format("level {} of load is {}; finite levels that rise are wanted", i + 1, levels_[i]));
    if (!std::isfinite(tips_[i].K_I) || !std::isfinite(tips_[i].K_II) || !std::isfinite(tips_[i].T))
      throw Error(Fault::Usage, fmt::format("K at the level {} of load is no finite number", levels_[i]));
  }
}

TipLoad LoadCurve::at(double level) const {
  if (!(level >= levels_.front() && level <= levels_.back()))
    throw Error(Fault::Usage, fmt::format("K at the level {} of load is asked; levels from {} to {} were solved", level,
                                          levels_.front(), levels_.back()));
  const auto i = std::min<std::size_t>(std::upper_bound(levels_.begin(), levels_.end(), level) - levels_.begin() - 1,
                                       levels_.size() - 2);
  const auto part = [&](double TipLoad::*p) { return Component{levels_, tips_, p}.at(i, level); };
  return {part(&TipLoad::K_I), part(&TipLoad::K_II), part(&TipLoad::T)};
}

LoadCurve LoadCurve::homogeneous(double level, const TipLoad& pushed, const TipLoad& pulled) {
  LoadCurve curve({-level, 0, level}, {pulled, {}, pushed});
  curve.exact_ = true;
  return curve;
}

LevelDoubt LoadCurve::doubt() const {
  LevelDoubt worst{levels_.front(), 0};
  if (exact_) return worst;
  for (std::size_t i = 0; i + 1 < levels_.size(); ++i)
    for (const auto part : {&TipLoad::K_I, &TipLoad::K_II})
      if (const double d = Component{levels_, tips_, part}.doubt(i); d > worst.difference)
        worst = {0.5 * (levels_[i] + levels_[i + 1]), d};
  return worst;
}

double block_growth(const GrowthLaw& law, std::span<const LoadCycle> block, const LoadCurve& curve, Equivalence how,
                    double a) {
  double sum = 0;
  for (const LoadCycle& c : merged(block)) {
    const EquivalentCycle e = equivalent(how, curve.at(c.max), curve.at(c.min));
    sum += c.count * rate(law, e.K_max, e.K_min, a);
  }
  return sum;
}

Life block_life(const GrowthLaw& law, std::span<const LoadCycle> block, std::span<const double> a,
                std::span<const LoadCurve> curves, Equivalence how) {
  check(law);
  if (a.size() != curves.size())
    throw Error(Fault::Usage,
                fmt::format("{} curves of K for {} lengths of a crack; as many are wanted", curves.size(), a.size()));
  std::vector<double> growth;
  for (std::size_t i = 0; i < a.size(); ++i) growth.push_back(block_growth(law, block, curves[i], how, a[i]));
  return Life::of_rates(a, growth);
}

}  // namespace kerf::growth
