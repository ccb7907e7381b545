// The verdict of a series of radii eps_i with differences D_i = (J(eps_i) - J)/f(eps_i), f the exact area [theory: V.7,
// V.8].
//   D = T' + c2 eps^2 + c4 eps^4 (or c3 eps^2 ln eps),
//   R_i = (D_i - T) f(eps_i),   order_i = ln |R_i/R_(i+1)| / ln(eps_i/eps_(i+1)).
// The fits of three and four radii leave an interval [T'_-, T'_+] for the limit. With a = max(1e-3, 3 plateau) the
// series agrees with T when the interval, widened by a |T|, holds T and is narrow, and one of three besides: an order
// near 4, the two smallest radii within 3 plateaus, or four radii on one curve. It fails when T lies farther outside
// than a |T| and half the interval. Between the two it is out of range, or nothing can be said, and the reason is told.
// A clamped hole has no T: its prediction takes the place, and all is in multiples of it [theory: T.30]. `conclude`
// adds what a change drawn on another mesh says [theory: V.9]; `withdraw` takes back what radii too large for the body
// say [theory: V.11]. Derived in docs/theory/validation.md, section "The verdict".

#include "topo/validate/verdict.hpp"

#include "base/dense.hpp"
#include "topo/formulas/kind.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf {

namespace {

// D = T + c2 eps^2 + c4 eps^4, or c3 eps^2 ln eps for the last. What the radii leave open lies between `low` and
// `high`: of four radii three in a row with both terms and all in the mean of squares; of fewer the fits with either
// term (ln of eps over the distance to the next feature, whatever stands for what they cannot tell) and with both.
struct Fit {
  double intercept = nan, c2 = nan, last = nan;
  double low = infinity, high = -infinity;
  double low_c2 = infinity, high_c2 = -infinity;  // of four radii and more
  double spread() const {
    return 0.5 * (high - low);
  }
};

struct Sample {
  double radius, quotient;
};

enum class Terms { Square, Logarithm, Both, Even };

// T, c2 and the coefficient of the last term; those that are not asked for are 0.
Eigen::Vector3d solve_fit(std::span<const Sample> s, Terms terms, double length) {
  const bool square = terms != Terms::Logarithm, even = terms == Terms::Even,
             logarithm = terms == Terms::Logarithm || terms == Terms::Both;
  const Eigen::Index n = static_cast<Eigen::Index>(s.size()),
                     unknowns = 1 + (square ? 1 : 0) + (logarithm || even ? 1 : 0);
  // Columns in units of the largest radius: without that their sizes would differ by eps^4.
  const double per = s.front().radius * s.front().radius;
  Eigen::MatrixXd a(n, unknowns);
  Eigen::VectorXd b(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double eps = s[static_cast<std::size_t>(k)].radius, x = eps * eps / per;
    a(k, 0) = 1;
    Eigen::Index column = 1;
    if (square) a(k, column++) = x;
    if (logarithm) a(k, column) = x * std::log(eps / length);
    if (even) a(k, column) = x * x;
    b[k] = s[static_cast<std::size_t>(k)].quotient;
  }
  const Eigen::VectorXd c = solve_least_squares(a, b);
  if (even) return {c[0], c[1] / per, c[2] / (per * per)};
  // eps^2 ln (eps/length) = eps^2 ln eps - eps^2 ln length
  const double c3 = logarithm ? c[unknowns - 1] / per : 0;
  return {c[0], (square ? c[1] / per : 0) - c3 * std::log(length), c3};
}

// From the smallest radii; the interval holds every fit that was taken.
Fit fit(std::span<const Sample> s, double length, Terms both) {
  Fit f;
  if (s.size() < 2) return f;
  const auto take = [&](std::span<const Sample> part, Terms terms) {
    const Eigen::Vector3d c = solve_fit(part, terms, length);
    f.low = std::min(f.low, c[0]);
    f.high = std::max(f.high, c[0]);
    if (s.size() >= 4) f.low_c2 = std::min(f.low_c2, c[1]), f.high_c2 = std::max(f.high_c2, c[1]);
    f.intercept = c[0], f.c2 = c[1], f.last = c[2];
  };
  // The last fit taken is the one that is told: of four radii all of them.
  if (s.size() >= 3) take(s.last(3), both);
  if (s.size() >= 4) {
    take(s.last(4).first(3), both);
    take(s.last(4), both);
    return f;
  }
  take(s.last(2), Terms::Logarithm);
  take(s, Terms::Square);
  if (s.size() == 3 && both == Terms::Even) take(s, both);
  return f;
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

// The rows of one validation, and what they show. All in multiples of the prediction where there is no series.
class Series {
 public:
  Series(Validation& v, const Perturbation& p, const std::vector<double>& scale, double clear)
      : v_(v),
        rows_(v.rows),
        has_series_(has_series(p)),
        T_(has_series_ ? v.coefficient : 1),
        allowed_(std::max(1e-3, 3 * v.plateau)),
        reach_(reach(p)),
        clear_(clear),
        could_be_(v.size) {
    if (row(p).becomes == Becomes::Slit) {  // the pressure on closed faces is no part of T
      could_be_ = 0;
      for (const Mode& m : v.modes) could_be_ += std::abs(m.value);
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      rows_[i].remainder = rows_[i].difference - rows_[i].predicted;
      const double size = std::isfinite(rows_[i].size) ? rows_[i].size : std::abs(rows_[i].predicted);
      scale_.push_back(has_series_ ? scale[i] : size);
    }
    for (std::size_t i = 0; i < rows_.size(); ++i)
      rows_[i].order = i + 1 < rows_.size() ? std::log(std::abs(rows_[i].remainder / rows_[i + 1].remainder)) /
                                                  std::log(rows_[i].radius / rows_[i + 1].radius)
                                            : nan;
    count();
    const bool even = has_series_ && v_.logarithm != Logarithm::Unknown;
    fit_ = fit(samples(), clear_, even ? Terms::Even : Terms::Both);
    v_.order = median(orders_);
    if (!has_series_) return;
    v_.intercept = fit_.intercept;
    v_.c2 = fit_.c2;
    (even ? v_.c4 : v_.c3) = fit_.last;
    if (v_.logarithm == Logarithm::Absent) v_.c3 = 0;
    if (std::isfinite(v_.c2_predicted)) predict_second();
  }

  // In this order: too few numbers, nothing there, agreement, reasons for none, failure, and what is open.
  Finding finding() const {
    if (computed_ < 2)
      return {Verdict::OutOfRange,
              fmt::format("fewer than two radii fit: the nearest boundary, crack or other feature is {:.3g} away; use "
                          "radii below {:.3g}",
                          clear_, 0.25 * clear_)};
    if (!std::isfinite(fit_.intercept) || !std::isfinite(T_))
      return {Verdict::NothingSaid,
              "the prediction and the differences leave the range of numbers, or are null; use "
              "larger loads or other units"};
    if (vanishes())
      return {Verdict::Vanishes,
              fmt::format("coefficient and differences are below {:.1g} of what stresses of this size could give",
                          allowed_)};
    const double error = std::abs(fit_.intercept - T_);
    const bool agrees = outside() <= allowed_ * std::abs(T_), narrow = fit_.spread() <= 1.5 * allowed_ * std::abs(T_);
    if (agrees && narrow && (slope() || settled() || fits_four())) {
      if (same_ && beyond_second() > 0)
        return {Verdict::Fails,
                fmt::format("the second term is {:.5g} by the formula, and the series says between {:.5g} and {:.5g}",
                            v_.c2_predicted, fit_.low_c2, fit_.high_c2)};
      return {Verdict::Holds, how_it_holds() + second_in_words()};
    }
    // Reasons before "fails": what explains a wrong limit without a wrong formula comes first.
    if (const auto words = beyond_contact_and_features()) return {Verdict::OutOfRange, *words};
    if (rounding_rules())
      return {Verdict::NothingSaid, "the differences of the smallest radii are rounding; use larger radii"};
    // An error that is small against what T is made of, of a T that is itself a small rest.
    if (has_series_ && error <= allowed_ * could_be_ && std::abs(T_) < 0.1 * could_be_)
      return {Verdict::NothingSaid,
              fmt::format("the coefficient is {:.2g} of what stresses of this size could give: what cancels hides it; "
                          "try a point beside",
                          std::abs(T_) / could_be_)};
    if (excluded()) return {Verdict::Fails, how_it_fails(error)};
    return {Verdict::OutOfRange,
            fmt::format("these radii leave the limit between {:.5g} and {:.5g} of the {} {:.5g}; use four, and smaller "
                        "ones",
                        fit_.low, fit_.high, has_series_ ? "coefficient" : "prediction", T_)};
  }

  // The largest radius at which the series is within a tenth of its limit: there contact may still move.
  std::size_t row_to_draw() const {
    constexpr double near = 0.1;
    std::size_t best = last_;
    for (std::size_t i = rows_.size(); i-- > 0;)
      if (computed(i) && std::abs(quotient(i) - fit_.intercept) <= near * std::abs(T_)) best = i;
    return best;
  }
  // 0 where what is wrong is not the limit.
  // How far the limit is from T, in what the drawn change is measured by.
  double apart(std::size_t i) const {
    return excluded() ? (fit_.intercept - T_) * (has_series_ ? 1 : scale_[i]) : 0;
  }
  double rest(std::size_t i) const {
    return (quotient(i) - fit_.intercept) * (has_series_ ? 1 : scale_[i]);
  }

 private:
  bool computed(std::size_t i) const {
    return std::isfinite(rows_[i].remainder);
  }
  // Of a clamped hole 1 and what the prediction leaves, in multiples of its parts: their sum may pass through zero.
  double quotient(std::size_t i) const {
    return has_series_ ? rows_[i].difference / scale_[i] : 1 + rows_[i].remainder / scale_[i];
  }
  double relative(std::size_t i) const {
    return std::abs(quotient(i) / T_ - 1);
  }

  // Contact that moves with the change is part of it: where its ends are resolved, the series is as smooth.
  std::vector<Sample> samples() const {
    std::vector<Sample> s;
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (computed(i)) s.push_back({rows_[i].radius, quotient(i) - known_logarithm(rows_[i].radius)});
    return s;
  }
  double known_logarithm(double eps) const {
    return has_series_ && v_.logarithm == Logarithm::Known ? v_.c3 * eps * eps * std::log(eps) : 0;
  }

  // The rows once more with both terms. Their orders with the intercept for T: the error of the mesh is the same at
  // every radius, and what is left falls like eps^6 down to a share of the plateau.
  void predict_second() {
    constexpr double seen = 0.1;
    std::vector<double> left(rows_.size(), nan), orders;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      ValidationRow& r = rows_[i];
      const double square = r.radius * r.radius, logarithm = known_logarithm(r.radius);
      r.predicted_second = scale_[i] * (T_ + v_.c2_predicted * square + logarithm);
      r.remainder_second = r.difference - r.predicted_second;
      left[i] = std::abs(quotient(i) - logarithm - fit_.intercept - v_.c2_predicted * square);
    }
    for (std::size_t i = 0; i + 1 < rows_.size(); ++i) {
      rows_[i].order_second = std::log(scale_[i] * left[i] / (scale_[i + 1] * left[i + 1])) /
                              std::log(rows_[i].radius / rows_[i + 1].radius);
      if (left[i + 1] > seen * v_.plateau * std::abs(T_)) orders.push_back(rows_[i].order_second);
    }
    v_.order_second = median(orders);
  }

  // c2 by the formula lies outside of all that four radii leave open, by more than what the mesh leaves of it.
  double beyond_second() const {
    if (!std::isfinite(v_.c2_predicted) || !(fit_.low_c2 <= fit_.high_c2)) return 0;
    // b of docs/theory/validation.md: 2 % of c2, three times what two meshes differ by, a third of the plateau over
    // eps^2.
    constexpr double formula = 0.02, meshes = 3, noise = 1.0 / 3;
    const double largest = rows_[first_fitted()].radius, own = std::abs(v_.c2_predicted - v_.c2_on_mesh),
                 allowed = formula * std::abs(v_.c2_predicted) + 0.5 * (fit_.high_c2 - fit_.low_c2) +
                           noise * v_.plateau * std::abs(T_) / (largest * largest) +
                           (std::isfinite(own) ? meshes * own : 0);
    return std::max({fit_.low_c2 - v_.c2_predicted, v_.c2_predicted - fit_.high_c2, 0.0}) - allowed;
  }
  // Of the last four radii that were computed.
  std::size_t first_fitted() const {
    std::size_t i = rows_.size();
    for (int left = 4; left > 0 && i > 0;)
      if (computed(--i)) --left;
    return i;
  }
  // What c2 says beside a verdict that it does not decide.
  std::string second_in_words() const {
    if (!std::isfinite(v_.c2_predicted)) return {};
    std::string words = fmt::format("; c2 is {:.4g} by the formula and {:.4g} by the series", v_.c2_predicted, v_.c2);
    if (beyond_second() > 0)
      return words + ", which says nothing of the formula: it is for contact that stays as it is";
    if (std::isfinite(v_.order_second))
      words += fmt::format(", what both terms leave falls like eps^{{{:.2f}}}", v_.order_second);
    return words;
  }

  // From the largest radius to the smallest. Rows in a row near T count as settled; orders above the plateau alone.
  void count() {
    std::size_t before = rows_.size();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const ValidationRow& r = rows_[i];
      if (!computed(i)) continue;
      moved_ = moved_ || !r.same_contact;
      same_ = r.same_contact;
      settled_ = relative(i) < 3 * v_.plateau ? settled_ + 1 : 0;
      if (before < rows_.size() && std::isfinite(rows_[before].order) && relative(i) > v_.plateau)
        orders_.push_back(rows_[before].order);
      before = last_ = i;
      ++computed_;
    }
    // The last pairs above the plateau are the most asymptotic ones.
    if (orders_.size() > 3) orders_.erase(orders_.begin(), orders_.end() - 3);
  }

  // The remainder of the series falls like eps^4 ln eps, that of a clamped hole like eps^2 ln eps.
  bool slope() const {
    return has_series_ ? v_.order > 3.3 && v_.order < 4.7 : v_.order > 1.7 && v_.order < 2.6;
  }
  // Two radii in a row, the smallest ones: one alone is where a wrong coefficient crosses the series.
  bool settled() const {
    return settled_ >= 2;
  }
  // Remainders that change sign have no slope; four radii on one curve with the right limit say as much.
  bool fits_four() const {
    return computed_ >= 4 && fit_.spread() <= 0.5 * allowed_ * std::abs(T_);
  }

  // Ten times as much is allowed to the quotients themselves, which hold the c2 eps^2 of a T that vanishes.
  bool vanishes() const {
    const double nothing = std::max(10 * allowed_ * v_.size, infinitesimal);
    double largest = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (!computed(i)) continue;
      largest = std::max(largest, std::abs(has_series_ ? quotient(i) : rows_[i].difference));
      if (!has_series_) largest = std::max(largest, std::abs(rows_[i].predicted));
    }
    if (!has_series_) return v_.size > 0 && largest <= nothing;
    return std::abs(T_) <= allowed_ * v_.size && std::abs(fit_.intercept) <= allowed_ * v_.size && largest <= nothing;
  }

  // T lies outside of all that the radii leave open, by more than the mesh explains, and farther than that is wide.
  bool excluded() const {
    return outside() > allowed_ * std::abs(T_) + fit_.spread();
  }
  double outside() const {
    return std::max({fit_.low - T_, T_ - fit_.high, 0.0});
  }

  // The quotients move apart instead of together.
  bool rounding_rules() const {
    std::vector<Sample> s = samples();
    if (s.size() < 3) return false;
    const double last = std::abs(s[s.size() - 1].quotient - s[s.size() - 2].quotient),
                 before = std::abs(s[s.size() - 2].quotient - s[s.size() - 3].quotient);
    return last > allowed_ * std::abs(T_) && last > 2 * before;
  }

  std::string how_it_holds() const {
    std::string words = slope()     ? fmt::format("the remainder falls like eps^{:.2f}", v_.order)
                        : settled() ? "the remainder has fallen to what the mesh leaves"
                                    : "four radii and more lie on one curve to the coefficient";
    if (moved_) words += same_ ? "; contact moves with the larger radii" : "; contact moves with every radius";
    return words;
  }
  std::string how_it_fails(double error) const {
    return has_series_ ? fmt::format(
                             "the intercept {:.6g} of the series differs from the coefficient {:.6g} by {:.2g}, "
                             "observed order {:.2f}",
                             fit_.intercept, T_, error / std::abs(T_), v_.order)
                       : fmt::format("the differences tend to {:.5g} of the prediction, observed order {:.2f}",
                                     fit_.intercept, v_.order);
  }

  // Features, contact, radii that are too large, in this order.
  std::optional<std::string> beyond_contact_and_features() const {
    if (reach_ * rows_[last_].radius > 0.25 * clear_)
      return fmt::format("the radii are too large: the nearest feature is {:.3g} away; use radii below {:.3g}", clear_,
                         0.25 * clear_);
    if (moved_)
      return same_ ? "the contact set changes at larger radii; use more and smaller ones"
                   : "the contact set changes even at the smallest radius; use smaller radii, or a smaller mesh.size";
    if (relative(last_) > 0.05 && relative(last_) < 0.6 * relative(last_ - 1))
      return fmt::format(
          "the radii are too large for the series: the remainder is still {:.2g} of the prediction and "
          "falling; use smaller radii",
          relative(last_));
    return std::nullopt;
  }

  static constexpr double infinitesimal = 1e-300;

  Validation& v_;
  std::vector<ValidationRow>& rows_;
  std::vector<double> scale_;  // what a difference is divided by
  bool has_series_;
  double T_, allowed_;
  double reach_, clear_;  // reach: of a radius
  double could_be_;       // |T| where nothing cancels
  std::size_t computed_ = 0, settled_ = 0, last_ = 0;
  bool moved_ = false, same_ = true;  // some contact set; that of the smallest radius
  std::vector<double> orders_;
  Fit fit_;
};

// Parts of the formula that an error of 1 % in would pass.
std::string unseen(const Validation& v) {
  constexpr double seen = 0.2;
  std::string words;
  for (const Mode& m : v.modes)
    if (std::abs(m.value) < seen * std::abs(v.coefficient))
      words += fmt::format("{}{} ({:.1f} % of T)", words.empty() ? "" : ", ", m.name,
                           100 * std::abs(m.value / v.coefficient));
  return words.empty() ? words : "; parts of the formula that hardly count here, and are hardly tested: " + words;
}

}  // namespace

std::string_view word(Verdict verdict) {
  switch (verdict) {
    case Verdict::Holds:
      return "holds";
    case Verdict::Fails:
      return "fails";
    case Verdict::Vanishes:
      return "vanishes";
    case Verdict::OutOfRange:
      return "out of range";
    case Verdict::NothingSaid:
      break;
  }
  return "nothing can be said";
}

void judge(Validation& v, const Perturbation& p, const std::vector<double>& scale, double clear) {
  const Series series(v, p, scale, clear);
  Finding found = series.finding();
  v.verdict = found.verdict;
  v.reason = std::move(found.reason);
  if (v.verdict != Verdict::Holds && v.verdict != Verdict::Fails) return;
  const std::size_t row = series.row_to_draw();
  v.drawn.radius = v.rows[row].radius;
  v.drawn.apart = series.apart(row);
  v.drawn.rest = series.rest(row);
  if (!has_series(p)) v.drawn.predicted = v.rows[row].predicted;
}

// Only where the body, not a feature nearby, is what the radii are too large for.
void withdraw(Validation& v, double answer_radius, double clear) {
  constexpr double small = 0.25;
  double least = nan;
  for (const ValidationRow& r : v.rows)
    if (std::isfinite(r.difference)) least = r.radius;
  if (v.verdict == Verdict::Holds || v.verdict == Verdict::Vanishes) return;
  if (!(least > small * answer_radius && answer_radius < small * clear)) return;
  v.verdict = Verdict::OutOfRange;
  v.reason = fmt::format(
      "the radii are too large for this body: it answers a change of radius {:.2g} by as much stress as there was "
      "before, as bodies do that are nearly incompressible and held all around; use radii below {:.2g}",
      answer_radius, small * answer_radius);
}

// The bar is three times the largest of what map, series and drawn change differ by. "Fails" stays where the drawn
// change says at least half of it; "holds" where the drawn change agrees with its own formula and the map depends
// little on the mesh.
void conclude(Validation& v, double area, bool clamped) {
  // Half as large it held 92 of 102 truths on random bodies.
  constexpr double of_formula = 5e-3, of_mesh = 0.1, safety = 3;
  DrawnChange& d = v.drawn;
  d.intercept = d.difference / (clamped ? 1 : area) - d.rest;
  const double here = clamped ? d.predicted : v.coefficient, size = std::abs(d.intercept);
  v.bar = safety * std::max({std::abs(v.on_mesh - d.intercept), std::abs(v.on_mesh - d.coefficient),
                             std::abs(v.on_mesh - here)});
  if (v.verdict == Verdict::Fails) {
    constexpr double confirmed = 0.5;  // of what the series is apart
    if (d.apart == 0 || (d.intercept - d.coefficient) * d.apart >= confirmed * d.apart * d.apart) return;
    v.verdict = Verdict::NothingSaid;
    v.reason += fmt::format(
        "; but a change of radius {:.3g} drawn on another mesh says {:.5g}, and the formula there {:.5g}: that much is "
        "left by the mesh of the series",
        d.radius, d.intercept, d.coefficient);
    return;
  }
  if (!(std::abs(d.coefficient - d.intercept) <= std::max(of_formula, 3 * v.plateau) * size)) {
    v.verdict = Verdict::NothingSaid;
    v.reason = fmt::format(
        "a change of radius {:.3g} drawn on another mesh says {:.5g}, the formula there {:.5g}, here {:.5g}; use a "
        "smaller mesh.size",
        d.radius, d.intercept, d.coefficient, here);
  } else if (!(v.bar <= of_mesh * size)) {
    v.verdict = Verdict::NothingSaid;
    v.reason = fmt::format(
        "the value depends on the mesh: {:.5g} on that of the case, {:.5g} by a change of radius {:.3g} drawn on a "
        "better one; use a smaller mesh.size",
        v.on_mesh, d.intercept, d.radius);
  } else {
    v.reason += fmt::format("; a change of radius {:.3g} drawn on another mesh says {:.5g}, the map {:.5g} +- {:.2g}",
                            d.radius, d.intercept, v.on_mesh, v.bar);
  }
  if (!clamped && v.verdict == Verdict::Holds) v.reason += unseen(v);
}

}  // namespace kerf
