#include "topo/validate/verdict.hpp"

#include <fmt/core.h>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

struct Fit {
  double intercept = nan, c2 = nan, c3 = nan;
};

// D = T + c2 eps^2 + c3 eps^2 ln eps in the mean of squares over the smallest radii; without the logarithm below four.
Fit fit(const std::vector<ValidationRow>& rows, const std::vector<double>& scale) {
  std::vector<std::size_t> use;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (std::isfinite(rows[i].difference) && rows[i].same_contact) use.push_back(i);
  if (use.size() < 2) {  // rather a fit across a change of contact than none
    use.clear();
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (std::isfinite(rows[i].difference)) use.push_back(i);
  }
  if (use.size() < 2) return {};
  if (use.size() > 4) use.erase(use.begin(), use.end() - 4);
  const Eigen::Index n = static_cast<Eigen::Index>(use.size()), unknowns = n >= 4 ? 3 : 2;
  const double largest = rows[use.front()].radius;
  Eigen::MatrixXd a(n, unknowns);
  Eigen::VectorXd b(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double x = rows[use[static_cast<std::size_t>(k)]].radius / largest;
    a(k, 0) = 1;
    a(k, 1) = x * x;
    if (unknowns == 3) a(k, 2) = x * x * std::log(x);
    b[k] = rows[use[static_cast<std::size_t>(k)]].difference / scale[use[static_cast<std::size_t>(k)]];
  }
  const Eigen::VectorXd c = a.colPivHouseholderQr().solve(b);
  const double square = largest * largest, log_share = unknowns == 3 ? c[2] / square : 0;
  // x^2 ln x = eps^2/largest^2 (ln eps - ln largest)
  return {c[0], c[1] / square - log_share * std::log(largest), log_share};
}

double median(std::vector<double> v) {
  if (v.empty()) return nan;
  std::sort(v.begin(), v.end());
  return v.size() % 2 ? v[v.size() / 2] : 0.5 * (v[v.size() / 2 - 1] + v[v.size() / 2]);
}

}  // namespace

void judge(Validation& v, const Perturbation& p, const std::vector<double>& scale, double clear) {
  const bool clamped = p.kind == Perturbation::Kind::ClampedHole;
  std::vector<ValidationRow>& rows = v.rows;
  for (ValidationRow& r : rows) r.remainder = r.difference - r.predicted;
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i].order = i + 1 < rows.size() ? std::log(std::abs(rows[i].remainder / rows[i + 1].remainder)) /
                                              std::log(rows[i].radius / rows[i + 1].radius)
                                        : nan;
  const auto relative = [&](std::size_t i) { return std::abs(rows[i].remainder / rows[i].predicted); };
  std::vector<double> orders;
  std::size_t computed = 0, settled = 0, comparable = 0;  // comparable: of the unperturbed contact set
  bool moved = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!std::isfinite(rows[i].remainder)) continue;
    ++computed;
    moved = moved || !rows[i].same_contact;
    if (rows[i].same_contact) ++comparable;
    if (relative(i) < 3 * v.plateau) ++settled;
    if (std::isfinite(rows[i].order) && rows[i].same_contact && relative(i + 1) > v.plateau)
      orders.push_back(rows[i].order);
  }
  // The last pairs above the plateau are the most asymptotic ones.
  if (orders.size() > 3) orders.erase(orders.begin(), orders.end() - 3);
  v.order = median(orders);
  if (!clamped) {
    const Fit f = fit(rows, scale);
    v.intercept = f.intercept;
    v.c2 = f.c2;
    v.c3 = f.c3;
  }
  if (computed < 2) {
    v.verdict = Verdict::OutOfRange;
    v.reason = fmt::format(
        "fewer than two radii fit: the nearest boundary, crack or other feature is {:.3g} away; use radii below {:.3g}",
        clear, 0.25 * clear);
    return;
  }
  std::size_t last = rows.size() - 1;
  while (!std::isfinite(rows[last].remainder)) --last;
  const double expected = clamped ? 1.7 : 3.3, most = clamped ? 2.6 : 4.7;
  const bool slope = v.order > expected && v.order < most;
  const double error = clamped ? relative(last) : std::abs(v.intercept / v.coefficient - 1);
  const double allowed = clamped ? 0.02 : std::max(2e-3, 3 * v.plateau);
  const double smallest = rows[last].radius;
  const double reach = p.kind == Perturbation::Kind::Ellipse ? std::sqrt(p.aspect) : 1;  // of a radius
  if (!clamped && !(std::abs(v.coefficient) > 0)) {
    v.verdict = Verdict::OutOfRange;
    v.reason = "the coefficient vanishes here: the leading term says nothing";
  } else if (error <= allowed && (slope || settled >= 1)) {
    v.verdict = Verdict::Holds;
    v.reason = slope ? fmt::format("the remainder falls like eps^{:.2f}", v.order)
                     : "the remainder has fallen to what the mesh leaves";
    if (moved) v.reason += "; the contact set changes at the larger radii";
  } else if (!clamped && std::abs(v.intercept - v.coefficient) <= allowed * v.size) {
    v.verdict = Verdict::OutOfRange;
    v.reason = fmt::format(
        "the coefficient is {:.2g} of what stresses of this size could give: what cancels hides it; try a point beside",
        std::abs(v.coefficient) / v.size);
  } else if (reach * smallest > 0.25 * clear) {
    v.verdict = Verdict::OutOfRange;
    v.reason = fmt::format("the radii are too large: the nearest feature is {:.3g} away; use radii below {:.3g}", clear,
                           0.25 * clear);
  } else if (moved && (comparable < 2 || !rows[last].same_contact)) {
    v.verdict = Verdict::OutOfRange;
    v.reason = rows[last].same_contact ? "the contact set changes at all radii but the smallest; use smaller radii"
                                       : "the contact set changes even at the smallest radius; use smaller radii";
  } else if (!clamped && slope && error < relative(last)) {
    v.verdict = Verdict::OutOfRange;
    v.reason = fmt::format(
        "the remainder falls like eps^{:.2f}, but these radii do not tell eps^4 ln eps from an error of the "
        "coefficient; "
        "use four, and smaller ones",
        v.order);
  } else if (relative(last) > 0.05 && relative(last) < 0.6 * relative(last > 0 ? last - 1 : 0)) {
    v.verdict = Verdict::OutOfRange;
    v.reason = fmt::format(
        "the radii are too large for the series: the remainder is still {:.2g} of the prediction and "
        "falling; use smaller radii",
        relative(last));
  } else {
    v.verdict = Verdict::Fails;
    v.reason = clamped ? fmt::format("the prediction is off by {:.2g} at the smallest radius, observed order {:.2f}",
                                     relative(last), v.order)
                       : fmt::format(
                             "the intercept {:.6g} of the series differs from the coefficient {:.6g} by {:.2g}, "
                             "observed order {:.2f}",
                             v.intercept, v.coefficient, error, v.order);
  }
}

}  // namespace kerf
