#include "topo/validate/verdict.hpp"

#include "topo/formulas/kind.hpp"

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

struct Finding {
  Verdict verdict;
  std::string reason;
};

// The rows of one validation, and what they show.
class Series {
 public:
  Series(Validation& v, const Perturbation& p, double clear)
      : v_(v), rows_(v.rows), has_series_(has_series(p)), reach_(reach(p)), clear_(clear) {
    for (ValidationRow& r : rows_) r.remainder = r.difference - r.predicted;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      rows_[i].order = i + 1 < rows_.size() ? std::log(std::abs(rows_[i].remainder / rows_[i + 1].remainder)) /
                                                  std::log(rows_[i].radius / rows_[i + 1].radius)
                                            : nan;
    count();
  }

  void summarize(const std::vector<double>& scale) {
    v_.order = median(orders_);
    if (!has_series_) return;
    const Fit f = fit(rows_, scale);
    v_.intercept = f.intercept;
    v_.c2 = f.c2;
    v_.c3 = f.c3;
  }

  Finding finding() const {
    if (computed_ < 2)
      return {Verdict::OutOfRange,
              fmt::format("fewer than two radii fit: the nearest boundary, crack or other feature is {:.3g} away; use "
                          "radii below {:.3g}",
                          clear_, 0.25 * clear_)};
    return has_series_ ? of_series() : of_clamped();
  }

 private:
  double relative(std::size_t i) const {
    return std::abs(rows_[i].remainder / rows_[i].predicted);
  }

  void count() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const ValidationRow& r = rows_[i];
      if (!std::isfinite(r.remainder)) continue;
      last_ = i;
      ++computed_;
      moved_ = moved_ || !r.same_contact;
      if (r.same_contact) ++comparable_;
      if (relative(i) < 3 * v_.plateau) ++settled_;
      if (std::isfinite(r.order) && r.same_contact && relative(i + 1) > v_.plateau) orders_.push_back(r.order);
    }
    // The last pairs above the plateau are the most asymptotic ones.
    if (orders_.size() > 3) orders_.erase(orders_.begin(), orders_.end() - 3);
  }

  // The remainder of the series falls like eps^4 ln eps, that of a clamped hole like eps^2 ln eps.
  Finding of_series() const {
    if (!(std::abs(v_.coefficient) > 0))
      return {Verdict::OutOfRange, "the coefficient vanishes here: the leading term says nothing"};
    const bool slope = v_.order > 3.3 && v_.order < 4.7;
    const double error = std::abs(v_.intercept / v_.coefficient - 1), allowed = std::max(2e-3, 3 * v_.plateau);
    if (error <= allowed && (slope || settled_ >= 1)) return holds(slope);
    if (std::abs(v_.intercept - v_.coefficient) <= allowed * v_.size)
      return {Verdict::OutOfRange,
              fmt::format(
                  "the coefficient is {:.2g} of what stresses of this size could give: what cancels hides it; try a "
                  "point beside",
                  std::abs(v_.coefficient) / v_.size)};
    if (const auto words = beyond_contact_and_features()) return {Verdict::OutOfRange, *words};
    if (slope && error < relative(last_))
      return {Verdict::OutOfRange,
              fmt::format("the remainder falls like eps^{:.2f}, but these radii do not tell eps^4 ln eps from an error "
                          "of the coefficient; use four, and smaller ones",
                          v_.order)};
    if (const auto words = still_falling()) return {Verdict::OutOfRange, *words};
    return {Verdict::Fails, fmt::format("the intercept {:.6g} of the series differs from the coefficient {:.6g} by "
                                        "{:.2g}, observed order {:.2f}",
                                        v_.intercept, v_.coefficient, error, v_.order)};
  }

  Finding of_clamped() const {
    const bool slope = v_.order > 1.7 && v_.order < 2.6;
    if (relative(last_) <= 0.02 && (slope || settled_ >= 1)) return holds(slope);
    if (const auto words = beyond_contact_and_features()) return {Verdict::OutOfRange, *words};
    if (const auto words = still_falling()) return {Verdict::OutOfRange, *words};
    return {Verdict::Fails, fmt::format("the prediction is off by {:.2g} at the smallest radius, observed order {:.2f}",
                                        relative(last_), v_.order)};
  }

  Finding holds(bool slope) const {
    std::string words = slope ? fmt::format("the remainder falls like eps^{:.2f}", v_.order)
                              : "the remainder has fallen to what the mesh leaves";
    if (moved_) words += "; the contact set changes at the larger radii";
    return {Verdict::Holds, words};
  }

  std::optional<std::string> beyond_contact_and_features() const {
    if (reach_ * rows_[last_].radius > 0.25 * clear_)
      return fmt::format("the radii are too large: the nearest feature is {:.3g} away; use radii below {:.3g}", clear_,
                         0.25 * clear_);
    if (!moved_ || (comparable_ >= 2 && rows_[last_].same_contact)) return std::nullopt;
    return rows_[last_].same_contact ? "the contact set changes at all radii but the smallest; use smaller radii"
                                     : "the contact set changes even at the smallest radius; use smaller radii";
  }

  std::optional<std::string> still_falling() const {
    if (!(relative(last_) > 0.05 && relative(last_) < 0.6 * relative(last_ > 0 ? last_ - 1 : 0))) return std::nullopt;
    return fmt::format(
        "the radii are too large for the series: the remainder is still {:.2g} of the prediction and "
        "falling; use smaller radii",
        relative(last_));
  }

  Validation& v_;
  std::vector<ValidationRow>& rows_;
  bool has_series_;
  double reach_, clear_;                                                // reach: of a radius
  std::size_t computed_ = 0, settled_ = 0, comparable_ = 0, last_ = 0;  // comparable: of the unperturbed contact set
  bool moved_ = false;                                                  // some contact set
  std::vector<double> orders_;
};

}  // namespace

void judge(Validation& v, const Perturbation& p, const std::vector<double>& scale, double clear) {
  Series series(v, p, clear);
  series.summarize(scale);
  Finding found = series.finding();
  v.verdict = found.verdict;
  v.reason = std::move(found.reason);
}

}  // namespace kerf
