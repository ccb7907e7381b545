// Charts and curves from results. Of a validation: |remainder| of each point against the radius, logarithmic; of four
// points at most also the difference J(eps) - J(0), with slope 2, its order, and slope 4, that of what the first term
// leaves. Of an optimization: objective (and what is minimized, where penalties are in it), volume fraction, bounded
// quantities over their bounds. A step that was refused leaves the values of the one before, and its own are dots of
// another color. A panel is logarithmic where all values are positive and the largest is more than thirty times the
// smallest.

#include "plot/charts.hpp"

#include "io/text.hpp"
#include "plot/figure/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

Chart validation_chart(const ValidationResult& result, const std::string& title) {
  constexpr std::size_t most = 24, with_differences = 4;
  Chart chart;
  chart.title = title;
  const std::size_t shown = std::min(result.points.size(), most);
  chart.subtitle = fmt::format(
      "validation of the expansion for a {}: difference J(\u03b5) \u2212 J(0) and what the "
      "prediction leaves of it{}",
      result.perturbation == "clamped_hole" ? "clamped hole" : result.perturbation,
      shown < result.points.size() ? fmt::format("; the first {} of {} points", shown, result.points.size()) : "");
  chart.x_label = "radius \u03b5";
  chart.y_label = result.points.size() <= with_differences ? "|remainder|, |difference|" : "|remainder|";
  for (std::size_t i = 0; i < shown; ++i) {
    const Validation& v = result.points[i];
    Series remainder, difference;
    remainder.style = difference.style = i;
    remainder.name = fmt::format("remainder at {}", place(v.at));
    if (std::isfinite(v.order)) remainder.name += fmt::format(", order {:.2f}", v.order);
    difference.name = fmt::format("difference at {}", place(v.at));
    difference.dashed = true;
    for (const ValidationRow& row : v.rows) {
      remainder.points.emplace_back(row.radius, std::abs(row.remainder));
      difference.points.emplace_back(row.radius, std::abs(row.difference));
    }
    chart.series.push_back(std::move(remainder));
    if (result.points.size() <= with_differences) chart.series.push_back(std::move(difference));
  }
  chart.slopes = {{2, "slope 2"}, {4, "slope 4"}};
  return chart;
}

bool wants_logarithm(const std::vector<double>& values) {
  double least = infinity, most = 0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    if (!(v > 0)) return false;
    least = std::min(least, v);
    most = std::max(most, v);
  }
  return most > 30 * least;
}

Curves history_curves(const OptimizeResult& result, const OptimizeNames& names, const std::string& title) {
  Curves out{.title = title, .x_label = "iteration", .upper_label = "state solves"};
  const auto column = [&](const auto& value) {
    std::vector<double> values;  // a step that was refused leaves them
    for (const Iteration& row : result.history)
      values.push_back(row.accepted || values.empty() ? value(row) : values.back());
    return values;
  };
  out.x = column([](const Iteration& row) { return static_cast<double>(row.number); });
  for (std::size_t i = 0; i < result.history.size(); ++i) {
    out.x[i] = result.history[i].number;
    out.upper.push_back(result.history[i].state_solves);
  }
  const std::vector<double> objective = column([](const Iteration&row) { return row.objective; }),
                            merit = column([](const Iteration&row) { return row.merit; });
  out.subtitle = fmt::format("{}, {} iterations, {} state solves; {}", word(result.method), result.iterations,
                             result.state_solves, result.stopped);
  const bool apart = [&] {
    for (std::size_t i = 0; i < merit.size(); ++i)
      if (std::abs(merit[i] - objective[i]) > 1e-3 * std::abs(objective[i])) return true;
    return false;
  }();
  Panel first{.label = "objective J", .curves = {{"", objective}}, .share = 2};
  if (apart) {
    first.curves[0].name = std::string("J");
    first.curves.push_back({"what is minimized, with penalties", merit});
  }
  std::vector<double> refused;
  for (const Iteration& row : result.history) refused.push_back(row.accepted ? std::nan("") : row.objective);
  if (std::any_of(refused.begin(), refused.end(), [](double v) { return std::isfinite(v); })) {
    if (!apart) first.curves[0].name = std::string("J");
    first.curves.push_back({"steps that were refused", refused});
  }
  std::vector<double> all = objective;
  if (apart) all.insert(all.end(), merit.begin(), merit.end());
  first.logarithmic = wants_logarithm(all);
  out.panels.push_back(std::move(first));
  out.panels.push_back(
      {.label = "volume fraction",
       .curves = {{"", column([](const Iteration& row) { return row.volume_fraction; }), names.volume_at_most}}});
  if (!names.bounds.empty()) {
    Panel bounds{.label = names.bounds.size() == 1 ? names.bounds[0] : "bounded, over its bound"};
    for (std::size_t i = 0; i < names.bounds.size(); ++i) {
      const double scale = names.bounds.size() == 1 ? 1 : names.at_most[i];
      bounds.curves.push_back({names.bounds.size() == 1 ? "" : names.bounds[i], column([&](const Iteration& row) {
                                 return i < row.bounds.size() ? row.bounds[i] / scale : std::nan("");
                               }),
                               names.at_most[i] / scale});
    }
    std::vector<double> values;
    for (const Curve& curve : bounds.curves) values.insert(values.end(), curve.values.begin(), curve.values.end());
    bounds.logarithmic = wants_logarithm(values);
    out.panels.push_back(std::move(bounds));
  }
  return out;
}

}  // namespace kerf
