// Data on triangles, body forces and eigenstrains, proved where expressions are known. Over the box about a cell a
// polynomial T of degree 4 or 7 is near f; what is left goes into the integral with any weight w,
//   |f - T| <= delta,   |int f w - sum_q w_q (f w)(x_q)| <= 2 delta int |w|   [theory: D.4].
// A triangle is settled when what its range or a polynomial leaves of each component is at most 5e-6 of the mean of |f|
// over the body; else it is cut in four, the worst cell first, until 1e-6 are left in all or the looks are spent. Where
// proofs leave too much, rules of two degrees that agree to 1e-6 are taken, and the cell counts as sampled. Black boxes
// are settled where a finer rule gives the same mean. A triangle that was cut carries the projection onto P_4, and what
// that leaves out. Looks are shared out over the body (`SharedLooks`). Derived in docs/theory/data.md, sections
// Triangles and Black boxes.

#include "solver/cut_triangle.hpp"
#include "solver/data.hpp"
#include "solver/data/all_triangles.hpp"
#include "solver/left_out.hpp"

#include "base/dense.hpp"
#include "base/parallel.hpp"
#include "base/polynomial.hpp"
#include "solver/element/local.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace kerf {

Points places(const TriangleRule& rule, const Vertices& c) {
  Points x(2, rule.w.size());
  for (Eigen::Index q = 0; q < x.cols(); ++q)
    x.col(q) = (1 - rule.x(0, q) - rule.x(1, q)) * c[0] + rule.x(0, q) * c[1] + rule.x(1, q) * c[2];
  return x;
}

std::array<Vertices, 4> quarters(const Vertices& c) {
  const Vec2 a = 0.5 * (c[1] + c[2]), b = 0.5 * (c[2] + c[0]), d = 0.5 * (c[0] + c[1]);
  return {Vertices{c[0], d, b}, {d, c[1], a}, {b, a, c[2]}, {a, b, d}};
}

namespace {

constexpr int kept_degree = 4;
// Shares of the mean of |f| over the body: ranges that count as one number, what is looked for on a triangle, what is
// put up with there, in cells, and at the last for the sake of a proof, and what two rules of a cell that is not proved
// may differ by.
constexpr double narrow = 1e-9, wanted = 1e-8, agreed = 5e-6, of_cells = 1e-6, proved = 1e-3, rules_agree = 1e-6;
constexpr int left_degree = 7;  // of the polynomials of left_by_polynomial

constexpr int most_looks = 400, shared_looks = 2000;  // at one triangle, alone and where few are open

double area_of(const Vertices& c) {
  return 0.5 * cross(c[1] - c[0], c[2] - c[0]);
}

// The means of two looks at a black box.
struct Look {
  double difference, size;
  bool agrees;
};
Look compared(const Eigen::Ref<const Points>& at, const TriangleRule& rule, const Eigen::Ref<const Points>& finer) {
  constexpr double agree = 1e-5;
  const double size = std::max(at.cwiseAbs().maxCoeff(), finer.cwiseAbs().maxCoeff()),
               difference = (at * rule.w - finer * finer_rule().w).cwiseAbs().sum();
  return {difference, size, difference <= agree * size};
}

// The better of two rules that agree: of twice the order or nearly.
// The error of the finer rule, relative to the size, is about the square of the relative difference.
double better(double difference, double size) {
  return size > 0 ? difference * difference / size : 0;
}

double largest_of(const std::array<Interval, 2>& range, double size) {
  for (const Interval& r : range) size = std::max({size, std::abs(r.low), std::abs(r.high)});
  return size;
}

// Shares of the triangle: its errors and areas are relative to the triangle's area, so that means over it are sums.
struct Cell {
  Vertices corners;  // in barycentric coordinates (l1, l2) of the triangle
  Points value;      // at the points of the rule; one column, the middle of the range, where only that is known
  const TriangleRule* rule = nullptr;
  std::array<Interval, 2> range{};
  double area = 0, error = 0;           // shares of the triangle
  Vec2 seen = Vec2::Zero();             // of the integral of |f|, as the values see it
  std::array<Interval, 2> rim_range{};  // on the rim of the cell, this share of the triangle
  double rim = 0;
  bool settled = false, smooth = true;
  bool sampled = false;              // settled by points
  Vec2 left = Vec2::Zero();          // by a polynomial that is as good as its values, of each component
  std::array<bool, 2> polynomial{};  // there is one, better than the range
  double rim_error = 0;
};

// `looks`: cells that may be looked at; `share`: by how much more than beside its own size may be left, where proofs
// fail.
class TriangleIntegration {
 public:
  TriangleIntegration(const VectorField& f, const Vertices& corners, const TriangleRule& rule, const char* what,
                      double size, int looks, double share = 1, bool may_sample = true)
      : f_(f),
        corners_(corners),
        rule_(rule),
        what_(what),
        size_(size),
        looks_(looks),
        share_(share),
        may_sample_(may_sample) {}

  /// Whether more looks would add nothing.
  bool is_settled() const {
    return is_settled_;
  }
  /// The mean of each component's size.
  Vec2 seen() const {
    Vec2 sum = Vec2::Zero();
    for (const Cell& c : cells_) sum += c.seen;
    return sum;
  }
  TriangleValues run() {
    static const Vertices unit{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
    TriangleValues result;
    cells_.push_back(cell(unit));
    result.at = cells_[0].value;
    is_settled_ = cells_[0].settled;
    if (is_settled_ || looks_ == 1) {
      result.error = cells_[0].error;
      result.rest = cells_[0].left.squaredNorm();
      if (cells_[0].rim > 0) result.rest += cells_[0].rim * std::pow(width_of(cells_[0].rim_range), 2);
      result.how = f_.known() && !cells_[0].sampled ? Resolution::Proved : Resolution::Sampled;
      return result;
    }
    refine();
    collect(result);
    return result;
  }

 private:
  Vec2 place(const Vec2& l) const {
    return (1 - l.x() - l.y()) * corners_[0] + l.x() * corners_[1] + l.y() * corners_[2];
  }
  Vec2 value(const Vec2& l) const {
    const Vec2 x = place(l), v = f_(x);
    if (!v.allFinite())
      throw Error(Fault::Numerics, fmt::format("the {} is not finite at ({:.6g}, {:.6g})", what_, x.x(), x.y()));
    return v;
  }
  Points values(const TriangleRule& rule, const Vertices& c) const {
    const Points l = places(rule, c);
    Points v(2, l.cols());
    for (Eigen::Index q = 0; q < l.cols(); ++q) v.col(q) = value(l.col(q));
    return v;
  }

  static const TriangleRule& coarse_rule() {
    static const TriangleRule rule = triangle_rule(5);
    return rule;
  }
  // Integrates the products of Taylor's polynomials and those that are kept.
  static const TriangleRule& exact_rule() {
    static const TriangleRule rule = triangle_rule(left_degree + kept_degree);
    return rule;
  }
  void take_values(Cell& c, const TriangleRule& rule) const {
    c.value = values(rule, c.corners);
    c.rule = &rule;
  }

  Cell cell(const Vertices& c) {
    Cell made{.corners = c, .area = 2 * area_of(c)};
    f_.known() ? enclose(made) : sample(made);
    ++evaluations_;
    if (made.smooth) made.seen = made.area * (made.value.cwiseAbs() * made.rule->w);
    if (!f_.known())
      scale_ = std::max(scale_, made.area * made.value.cwiseAbs().maxCoeff());
    else if (cells_.empty())
      scale_ = made.seen.maxCoeff();
    return made;
  }

  /// The box of a cell.
  /// Along x and y, in the coordinates of the body: enclosures know boxes alone.
  std::array<Interval, 2> box_of(const Cell& c) const {
    Interval x{infinity, -infinity}, y = x;
    for (const Vec2& l : c.corners) {
      const Vec2 p = place(l);
      x = {std::min(x.low, p.x()), std::max(x.high, p.x())};
      y = {std::min(y.low, p.y()), std::max(y.high, p.y())};
    }
    return {x, y};
  }

  // Known: settled where the range of each component is narrow, or Taylor's polynomial leaves little of it.
  // A range that is narrower inside than on the whole box belongs to a field that jumps along the cell's edge: the rim
  // alone, 1e-12 of the size, keeps the whole range.
  void enclose(Cell& c) const {
    auto [x, y] = box_of(c);
    c.range = f_.known()->over(x, y);
    double width = width_of(c.range), rim_error = 0;
    // What the whole triangle keeps as it is need not be as exact as what is projected piece by piece.
    // And no more than is little beside the integral, which the values in a narrow place say nothing of.
    const double size = size_ > 0 ? size_ : largest_of(c.range, 0),
                 enough = (cells_.empty() ? agreed : of_cells) * size;
    const auto leave = [&] {
      return left_by_polynomial(*f_.known(), x, y, c.range, wanted * size, std::max(enough, left_open() / c.area));
    };
    LeftOut leaves = leave();
    if (leaves.of.maxCoeff() > enough) {
      // A field that jumps along the edge of a cell (beside a crack) does not jump in it.
      const Interval x_in = inner(x), y_in = inner(y);
      const std::array<Interval, 2> inside = f_.known()->over(x_in, y_in);
      constexpr double narrower = 0.999;
      if (width_of(inside) < narrower * width) {
        const double dx = x.high - x.low, dy = y.high - y.low;
        c.rim = 1.01 * ((x_in.low - x.low + x.high - x_in.high) * dy + (y_in.low - y.low + y.high - y_in.high) * dx) /
                area_of(corners_);
        c.rim_range = c.range;
        rim_error = c.rim * width;
        c.range = inside;
        width = width_of(inside);
        x = x_in;
        y = y_in;
        leaves = leave();
      }
    }
    if (!std::isfinite(width)) {
      if (cells_.empty()) values(rule_, c.corners);  // refuses what has no value
      c.smooth = false;
      c.value = Points::Zero(2, 1);
      c.rule = &coarse_rule();
      c.error = infinity;
      return;
    }
    const auto& [left, rough] = leaves;
    c.settled = left.maxCoeff() <= enough;
    c.error = c.area * left.sum() + rim_error;
    // The first cell's values are wanted at the points of the rule in any case.
    c.left = left;
    for (int d = 0; d < 2; ++d) c.polynomial[d] = c.settled || left[d] < width_of(c.range[static_cast<std::size_t>(d)]);
    take_values(c, cells_.empty() ? rule_ : c.polynomial[0] || c.polynomial[1] ? exact_rule() : coarse_rule());
    c.rim_error = rim_error;
    if (rough) settle_by_samples(c);
  }
  /// Derivatives say nothing, or do not come to an end: what two rules agree on is taken, and is no proof.
  void settle_by_samples(Cell& c) const {
    if (c.settled || !c.smooth || !may_sample_) return;
    const double size = largest_of(c.range, size_);
    const std::optional<double> difference = agreement(c, size);
    if (!difference) return;
    c.settled = c.sampled = true;
    c.error = c.area * better(*difference, size) + c.rim_error;
    take_values(c, rule_);
  }
  /// What two rules differ by, where the range of each component is hardly wider than the
  /// values at points, and they agree. That is no proof.
  std::optional<double> agreement(const Cell& c, double size) const {
    constexpr double beyond = 8;
    const Points at = values(rule_, c.corners), coarse = values(coarse_rule(), c.corners);
    const Vec2 difference = (at * rule_.w - coarse * coarse_rule().w).cwiseAbs();
    for (int d = 0; d < 2; ++d) {
      const double seen = coarse.row(d).maxCoeff() - coarse.row(d).minCoeff(),
                   width = c.range[static_cast<std::size_t>(d)].high - c.range[static_cast<std::size_t>(d)].low;
      if (width > narrow * size && (width > beyond * seen || difference[d] > rules_agree * size)) return std::nullopt;
    }
    return difference.sum();
  }

  static double width_of(const Interval& range) {
    return range.high - range.low;
  }
  static double width_of(const std::array<Interval, 2>& range) {
    return width_of(range[0]) + width_of(range[1]);
  }
  // Without a rim as thin as the numbers allow.
  static Interval inner(const Interval& all) {
    constexpr double thin = 1e-12, rounding = 8 * std::numeric_limits<double>::epsilon();
    const double by = std::max(thin * (all.high - all.low), rounding * std::max(std::abs(all.low), std::abs(all.high)));
    return 2 * by < all.high - all.low ? Interval{all.low + by, all.high - by} : all;
  }

  // A black box: settled where a finer look gives the same mean.
  // Two rules of different points that agree to 1e-5: more is not known of a function.
  void sample(Cell& c) const {
    take_values(c, rule_);
    const Look look = compared(c.value, rule_, values(finer_rule(), c.corners));
    c.settled = look.agrees;
    c.error = c.area * (c.settled ? better(look.difference, look.size) : look.difference);
  }

  /// Of a black box next to nothing: it is not asked again what the difference of two rules may hide.
  /// The least that is worth a look: beside the integral for what is known, beside the largest value for a black box.
  double left_open() const {
    constexpr double of_samples = 1e-7;
    return f_.known() ? of_cells * std::max(scale_, size_) : std::max(of_samples * scale_, narrow * size_);
  }
  struct Open {
    double error = 0;
    std::optional<std::size_t> worst = {};
  };
  // Cells of 1e-12 of the area are not cut any more.
  Open open_cells() const {
    constexpr double finest = 1e-12;  // share of the area
    Open open;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (cells_[i].settled || cells_[i].area < finest) continue;
      open.error += cells_[i].error;
      if (!open.worst || cells_[i].error > cells_[*open.worst].error) open.worst = i;
    }
    return open;
  }
  /// Where looks do not prove enough.
  bool take_samples() {
    if (!f_.known() || !may_sample_ || open_cells().error <= proved * std::max(scale_, share_ * size_)) return false;
    for (Cell& c : cells_) settle_by_samples(c);
    return true;
  }

  // Half of the looks, at least 120, wait for a proof; after these, what rules agree on is taken where proofs leave
  // more than 1e-3.
  void refine() {
    const int proofs = std::max(120, looks_ / 2);  // looks that wait for a proof
    bool waits = true, samples = false;
    for (;;) {
      if (f_.known()) scale_ = seen().maxCoeff();
      if (waits && evaluations_ > proofs) {
        waits = false;
        samples = take_samples();
      }
      const auto [open, worst] = open_cells();
      is_settled_ = !worst || open <= left_open();
      if (is_settled_) return;
      if (evaluations_ >= looks_) break;
      const auto four = quarters(cells_[*worst].corners);
      cells_[*worst] = cell(four[0]);
      for (std::size_t k = 1; k < 4; ++k) cells_.push_back(cell(four[k]));
      if (!samples) continue;
      settle_by_samples(cells_[*worst]);
      for (std::size_t k = 1; k < 4; ++k) settle_by_samples(cells_[cells_.size() - k]);
    }
    if (waits) take_samples();
  }

  // What f and its projection differ by: at the points where a polynomial is near f, with what that leaves; by the
  // range, against the least and largest value of the projection at points, where it alone is known.
  void collect(TriangleValues& result) const {
    const Eigen::MatrixXd basis = monomials(kept_degree, rule_.x);
    const Eigen::MatrixXd mass = multiply_transposed(basis * rule_.w.asDiagonal(), basis);
    Eigen::MatrixXd moment = Eigen::MatrixXd::Zero(basis.rows(), 2);
    for (const Cell& c : cells_)
      if (c.smooth)
        moment += multiply(c.area * monomials(kept_degree, places(*c.rule, c.corners)) * c.rule->w.asDiagonal(),
                           Eigen::MatrixXd(c.value.transpose()));
    const Eigen::MatrixXd coefficients = solve_spd(mass, moment);
    result.whole = false;
    result.at = transposed_multiply(basis, coefficients).transpose();
    bool open = false;
    for (const Cell& c : cells_) {
      result.error += c.error;
      if (!c.smooth) {
        result.rest = infinity;
        open = true;
        continue;
      }
      const Points seen =
          transposed_multiply(monomials(kept_degree, places((*c.rule), c.corners)), coefficients).transpose();
      const Points rest = c.value - seen;
      for (int d = 0; d < 2 && c.rim > 0; ++d)
        result.rest += c.rim * std::pow(std::max(std::abs(c.rim_range[d].low - seen.row(d).minCoeff()),
                                                 std::abs(c.rim_range[d].high - seen.row(d).maxCoeff())),
                                        2);
      for (int d = 0; d < 2; ++d) {
        if (c.settled || !f_.known() || c.polynomial[static_cast<std::size_t>(d)]) {
          const double seen_rest = std::sqrt(rest.row(d).cwiseAbs2().dot(c.rule->w.transpose()));
          result.rest += c.area * std::pow(seen_rest + (c.sampled ? 0 : c.left[d]), 2);
        } else {
          const Interval& range = c.range[static_cast<std::size_t>(d)];
          result.rest += c.area * std::pow(std::max(std::abs(range.low - seen.row(d).minCoeff()),
                                                    std::abs(range.high - seen.row(d).maxCoeff())),
                                           2);
        }
      }
    }
    const bool sampled = !f_.known() || std::ranges::any_of(cells_, &Cell::sampled);
    result.how = open ? Resolution::Open : sampled ? Resolution::Sampled : Resolution::Proved;
  }

  const VectorField& f_;
  const Vertices& corners_;
  const TriangleRule& rule_;
  const char* what_;
  double size_;
  int looks_;
  double share_;  // what may be left of a proof here, over what may be left of the triangle's own size
  bool may_sample_;
  std::vector<Cell> cells_;
  int evaluations_ = 0;
  double scale_ = 0;
  bool is_settled_ = false;
};

/// The values of a curved triangle are proved where a polynomial leaves little of f over its box: what two rules of the
/// polynomial along the polynomial map differ by is seen.
void prove(const Enclosure& f, const Triangle& cell, double size, TriangleValues& v) {
  Interval x{infinity, -infinity}, y = x;
  const auto holding = [](Interval& all, double low, double high) {
    all = {std::min(all.low, low), std::max(all.high, high)};
  };
  double beyond = 0;  // of the chords: products of two coordinates are 1/4 at most
  for (const EdgeCurvature* curvature : cell.curvature)
    if (curvature)
      for (const Vec2& q : curvature->q) beyond += 0.25 * q.norm();
  for (const Vec2& corner : cell.x) {
    holding(x, corner.x() - beyond, corner.x() + beyond);
    holding(y, corner.y() - beyond, corner.y() + beyond);
  }
  const std::array<Interval, 2> range = f.over(x, y);
  const double enough = agreed * largest_of(range, size);
  const Vec2 left = left_by_polynomial(f, x, y, range, enough).of;
  if (!(left.maxCoeff() <= enough)) return;
  v.error += left.sum();
  v.how = Resolution::Proved;
}

/// Looks at many triangles: few at all of them, and more at those that few do not settle.
class SharedLooks {
 public:
  SharedLooks(const VectorField& f, const std::vector<Index>& which, const std::function<Triangle(Index)>& cell,
              const TriangleRule& rule, double largest, const char* what, int threads)
      : f_(f),
        which_(which),
        cell_(cell),
        rule_(rule),
        largest_(largest),
        what_(what),
        threads_(threads),
        values_(which.size()),
        size_(which.size(), Vec2::Zero()),
        open_(which.size()),
        looks_(which.size(), 0) {
    std::iota(open_.begin(), open_.end(), std::size_t{0});
    for (const Index t : which_) area_ += area(cell_(t));
  }

  // Sizes |f| first, by few points, since what counts as little is relative to the mean over the body. One look at each
  // triangle, then 5, 30, 120, 500 and 2000 at those that leave most: half of what is left of the budget at a time, all
  // of it in the end.
  std::vector<TriangleValues> run() && {
    static const TriangleRule few = triangle_rule(5);
    for_each_open(open_.size(), [&](std::size_t k, const Triangle& t) {
      const Points x = places(few, t.x);
      for (Eigen::Index q = 0; q < x.cols(); ++q)
        if (const Vec2 v = f_(x.col(q)).cwiseAbs(); v.allFinite()) size_[k] += few.w[q] * v;
      return false;
    });
    look(1, open_.size());
    double budget = 8 * static_cast<double>(which_.size()) + 4 * shared_looks;
    for (const int looks : {5, 30, 120, 500, shared_looks}) {
      const double some = looks == shared_looks ? budget : 0.5 * budget;
      const std::size_t count = std::min(open_.size(), static_cast<std::size_t>(some / looks));
      budget -= static_cast<double>(looks) * static_cast<double>(count);
      look(looks, count);
    }
    sample_rest();
    return std::move(values_);
  }

 private:
  /// Of the first `count` on the list those of which `settles` is true come off it.
  template <typename Settles>
  void for_each_open(std::size_t count, const Settles& settles) {
    std::vector<char> settled(open_.size(), 0);
    parallel_for(static_cast<Index>(count), threads_, [&](Index begin, Index end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
        settled[i] = settles(open_[i], cell_(which_[open_[i]]));
    });
    std::size_t left = 0;
    for (std::size_t i = 0; i < open_.size(); ++i)
      if (!settled[i]) open_[left++] = open_[i];
    open_.resize(left);
  }
  // The mean of |f| over the body, of the larger component; not less than rounding of the largest value.
  double mean() const {
    constexpr double nothing = 1e-13;
    Vec2 sum = Vec2::Zero();
    for (std::size_t k = 0; k < which_.size(); ++k) sum += area(cell_(which_[k])) * size_[k];
    return std::max(sum.maxCoeff() / area_, nothing * largest_);
  }
  double left(std::size_t k) const {
    return area(cell_(which_[k])) * values_[k].error;
  }
  // In triangles smaller than the usual one more may be left by the root of the area ratio, ten times at most: their
  // errors add up to the same share of the integral.
  TriangleIntegration at(const Triangle& t, double mean, int looks, double share, bool may_sample) const {
    constexpr double most = 10;
    const double usual = area_ / static_cast<double>(which_.size()),
                 times = std::clamp(std::sqrt(usual / area(t)), 1.0, most);
    return {f_, t.x, rule_, what_, mean * times, looks, std::max(1.0, share / times), may_sample};
  }
  /// Where proofs leave more than they are worth, what rules agree on is taken.
  /// Less than 1e-3 of the integral stays open, as it is.
  void sample_rest() {
    const double mean = this->mean();
    double open = 0;
    for (const std::size_t k : open_) open += left(k);
    if (open <= proved * mean * area_) return;
    for_each_open(open_.size(), [&](std::size_t k, const Triangle& t) {
      constexpr int few = 5;
      if (looks_[k] < enough_) values_[k] = at(t, mean, std::max(few, looks_[k]), 0, true).run();
      return true;
    });
  }
  /// At those `count` with most of what is open.
  /// From 120 looks on samples may settle what proofs do not: before, more looks may still prove it.
  void look(int looks, std::size_t count) {
    const double mean = this->mean(), all = static_cast<double>(open_.size());
    std::ranges::stable_sort(open_, std::greater(), [&](std::size_t k) { return left(k); });
    for_each_open(count, [&](std::size_t k, const Triangle& t) {
      if (!f_.known() || is_curved(t)) {
        values_[k] = triangle_values(f_, t, rule_, largest_, what_);
        return true;
      }
      TriangleIntegration of = at(t, mean, looks, area_ / (area(t) * all), looks >= enough_);
      looks_[k] = looks;
      values_[k] = of.run();
      size_[k] = of.seen();
      return of.is_settled();
    });
  }

  const VectorField& f_;
  const std::vector<Index>& which_;
  const std::function<Triangle(Index)>& cell_;
  const TriangleRule& rule_;
  const double largest_;
  const char* what_;
  const int threads_;
  std::vector<TriangleValues> values_;
  std::vector<Vec2> size_;  // the mean of |f| in each, as seen so far
  std::vector<std::size_t> open_;
  std::vector<int> looks_;  // at each, so far
  double area_ = 0;
  static constexpr int enough_ = 120;  // looks: what they do not prove more will not
};

}  // namespace

// The values at the points are those of a polynomial of degree 4, which the rule reproduces.
Points polynomial_at(const TriangleValues& values, const TriangleRule& rule, const Points& l) {
  const Eigen::MatrixXd basis = monomials(kept_degree, rule.x), weighted = basis * rule.w.asDiagonal();
  const Eigen::MatrixXd moment = multiply(weighted, Eigen::MatrixXd(values.at.transpose()));
  const Eigen::MatrixXd coefficients = solve_spd(multiply_transposed(weighted, basis), moment);
  return transposed_multiply(monomials(kept_degree, l), coefficients).transpose();
}

// Of degree 4 on each quarter.
const TriangleRule& finer_rule() {
  static const TriangleRule rule = [] {
    static const Vertices unit{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
    const TriangleRule each = triangle_rule(4);
    TriangleRule all{Points(2, 4 * each.w.size()), each.w.replicate(4, 1) / 4};
    Eigen::Index at = 0;
    for (const Vertices& quarter : quarters(unit)) {
      all.x.middleCols(at, each.w.size()) = places(each, quarter);
      at += each.w.size();
    }
    return all;
  }();
  return rule;
}

std::optional<TriangleValues> first_look(const Eigen::Ref<const Points>& at, const TriangleRule& rule,
                                         const Eigen::Ref<const Points>& finer) {
  if (!at.allFinite() || !finer.allFinite()) return std::nullopt;
  const Look look = compared(at, rule, finer);
  if (!look.agrees) return std::nullopt;
  TriangleValues v;
  v.at = at;
  v.error = better(look.difference, look.size);
  v.how = Resolution::Sampled;
  return v;
}

// Curved triangles are looked at once: no cutting.
TriangleValues triangle_values(const VectorField& f, const Triangle& cell, const TriangleRule& rule, double size,
                               const char* what) {
  if (!is_curved(cell)) return triangle_values(f, cell.x, rule, size, what);
  const auto sampled = [&](const TriangleRule& at) {
    Points values = rule_points(at, cell);
    for (Eigen::Index q = 0; q < values.cols(); ++q) {
      const Vec2 x = values.col(q);
      values.col(q) = f(x);
      if (!values.col(q).allFinite())
        throw Error(Fault::Numerics, fmt::format("the {} is not finite at ({:.6g}, {:.6g})", what, x.x(), x.y()));
    }
    return values;
  };
  const Points at = sampled(rule), finer = sampled(finer_rule());
  if (std::optional<TriangleValues> seen = first_look(at, rule, finer)) {
    if (f.known()) prove(*f.known(), cell, size, *seen);
    return *std::move(seen);
  }
  const Look look = compared(at, rule, finer);
  TriangleValues open;
  open.at = at;
  open.error = look.difference + look.size;
  open.rest = open.error * open.error;
  open.how = Resolution::Open;
  return open;
}

TriangleValues triangle_values(const VectorField& f, const std::array<Vec2, 3>& corners, const TriangleRule& rule,
                               double size, const char* what) {
  return TriangleIntegration(f, corners, rule, what, size, most_looks).run();
}

std::vector<TriangleValues> triangle_values(const VectorField& f, const std::vector<Index>& which,
                                            const std::function<Triangle(Index)>& cell, const TriangleRule& rule,
                                            double size, const char* what, int threads) {
  return SharedLooks(f, which, cell, rule, size, what, threads).run();
}

}  // namespace kerf
