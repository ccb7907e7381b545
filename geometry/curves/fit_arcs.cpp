// A chain of circular arcs [theory: K.1, K.2] near a polyline, with few knots. For given knots at places along the
// line, Gauss and Newton minimise over normal offsets and directions of the knots
//   sum_i w_i (distance of sample i)^2 + sum_k (stiffness l^(5/2) (curvature of arc k + 1 less that of arc k))^2,
// with samples at the points of the line and their middles, each on the nearest arc found before. Segments that miss
// the line by more than the tolerance, or turn by more than a quarter of a circle, are halved, and the fit starts
// again. Steps keep arcs from folding (a turn of 180 degrees makes a loop). Pinned points stay. The result does not
// depend on units. docs/theory/curves.md, "Arcs".

#include "geometry/arc_chain.hpp"

#include "base/dense.hpp"
#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double widest = 0.5;        // turn of an arc that is not halved, in half turns
constexpr double folded = 0.85;       // turn of an arc that no step may make
constexpr double largest_step = 0.4;  // of an angle
constexpr double stiffness = 0.03;    // against differences of curvature, in the units of distances

/// A line by its length.
struct Line {
  std::vector<Vec2> points;  // of a closed line the first once more at the end
  std::vector<double> s;     // where they are
  bool closed;

  double length() const {
    return s.back();
  }
  Vec2 at(double where) const {
    if (closed) where -= length() * std::floor(where / length());
    where = std::clamp(where, 0.0, length());
    const auto next = std::upper_bound(s.begin() + 1, s.end() - 1, where);
    const std::size_t k = std::size_t(next - s.begin());
    const double part = (where - s[k - 1]) / (s[k] - s[k - 1]);
    return (1 - part) * points[k - 1] + part * points[k];
  }
};

Line line_of(const ChainTrace& trace) {
  Line line{trace.points, {0}, trace.closed};
  if (trace.closed) line.points.push_back(trace.points.front());
  for (std::size_t k = 1; k < line.points.size(); ++k)
    line.s.push_back(line.s.back() + (line.points[k] - line.points[k - 1]).norm());
  return line;
}

struct Sample {
  Vec2 at;
  double s, weight;
};

/// Points of the line and the middles between them.
std::vector<Sample> samples_of(const Line& line) {
  std::vector<Sample> all;
  const std::size_t n = line.points.size();
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const double after = line.s[k + 1] - line.s[k];
    const double before = k > 0 ? line.s[k] - line.s[k - 1] : line.closed ? line.s[n - 1] - line.s[n - 2] : after;
    all.push_back({line.points[k], line.s[k], (before + after) / 4});
    all.push_back({0.5 * (line.points[k] + line.points[k + 1]), line.s[k] + after / 2, after / 2});
  }
  return all;
}

struct Fit {
  const Line& line;
  const std::vector<Sample>& samples;
  std::vector<double> s = {};      // of the knots
  std::vector<Index> pinned = {};  // per knot
  ArcChain chain = {};
  VectorXd off = {};  // distance of the samples
  std::vector<ChainPlace> place = {};

  std::size_t segment_at(double where) const {
    const auto next = std::upper_bound(s.begin(), s.end(), where);
    const auto k = std::size_t(std::max<std::ptrdiff_t>(next - s.begin() - 1, 0));
    return std::min(k, segment_count(chain) - 1);
  }

  /// The nearest place among three segments around the sample's own: along the line it cannot be far from it.
  void measure() {
    off.resize(Eigen::Index(samples.size()));
    place.resize(samples.size());
    const std::size_t n = segment_count(chain);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const std::size_t k = segment_at(samples[i].s);
      double least = infinity;
      for (std::size_t step = 0; step < std::min<std::size_t>(3, n); ++step) {
        std::size_t segment = k + step + n - 1;
        if (!chain.closed && (segment < n || segment >= 2 * n)) continue;
        segment %= n;
        const ChainPlace there = nearest(chain, samples[i].at, segment, segment + 1);
        const double d = (kerf::at(chain, there) - samples[i].at).norm();
        if (!(d < least)) continue;
        least = d;
        place[i] = there;
      }
      off[Eigen::Index(i)] = least;
    }
  }

  double cost(double unit) const {
    double sum = 0;
    for (std::size_t i = 0; i < samples.size(); ++i)
      sum += samples[i].weight * std::pow(off[Eigen::Index(i)] / unit, 2);
    for (std::size_t k = 0; k < 2 * segment_count(chain); ++k) sum += std::pow(bend(k, nullptr) / unit, 2);
    return sum;
  }

  /// Difference of curvature to the arc after it, as a distance, times the root of a length.
  double bend(std::size_t arc, VectorXd* by) const {
    const std::size_t count = 2 * segment_count(chain);
    if (!chain.closed && arc + 1 == count) return 0;
    const ChainPoint a = point_on(chain, {arc, 0.5}), b = point_on(chain, {(arc + 1) % count, 0.5});
    const double l = (a.speed + b.speed) / 2, scale = stiffness * std::pow(l, 2.5);
    if (by) {
      add(arc / 2, -scale * a.bends, *by);
      add((arc + 1) % count / 2, scale * b.bends, *by);
    }
    return scale * (b.curvature - a.curvature);
  }

  /// Derivatives by the knots of a segment as those by normal offsets and angles.
  void add(std::size_t segment, const Eigen::Matrix<double, 1, 6>& by, VectorXd& row) const {
    for (std::size_t end = 0; end < 2; ++end) {
      const std::size_t k = (segment + end) % chain.knots.size();
      const double angle = chain.knots[k].angle;
      const auto at = Eigen::Index(2 * k), from = Eigen::Index(3 * end);
      if (pinned[k] == none) row[at] += -std::sin(angle) * by[from] + std::cos(angle) * by[from + 1];
      row[at + 1] += by[from + 2];
    }
  }

  /// In the frames of the knots before the step.
  ArcChain moved(const VectorXd& step) const {
    ArcChain next = chain;
    for (std::size_t k = 0; k < next.knots.size(); ++k) {
      Knot& knot = next.knots[k];
      const double angle = knot.angle;
      if (pinned[k] == none) knot.at += step[Eigen::Index(2 * k)] * Vec2(-std::sin(angle), std::cos(angle));
      knot.angle += step[Eigen::Index(2 * k) + 1];
    }
    return next;
  }

  /// One step of Gauss and Newton; false when it brings nothing.
  /// A normal offset moves the knot across its direction, an angle turns it; pinned knots only turn. 1e-9 of the
  /// diagonal keeps the matrix definite where samples do not determine a knot. `largest_step`: radians, beyond which
  /// the linearization is not one.
  bool improve(double unit) {
    const Eigen::Index n = Eigen::Index(2 * chain.knots.size());
    MatrixXd normal = MatrixXd::Zero(n, n);
    VectorXd right = VectorXd::Zero(n), row(n);
    const auto take = [&](double value, double weight) {
      normal.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
      right -= weight * value * row;
    };
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const ChainPoint p = point_on(chain, place[i]);
      const Vec2 side(-p.tangent.y(), p.tangent.x());
      row.setZero();
      add(place[i].arc / 2, side.transpose() * p.by, row);
      take(side.dot(p.at - samples[i].at), samples[i].weight);
    }
    for (std::size_t k = 0; k < 2 * segment_count(chain); ++k) {
      row.setZero();
      const double value = bend(k, &row);
      take(value, 1);
    }
    for (Eigen::Index i = 0; i < n; ++i) normal(i, i) += normal(i, i) > 0 ? 1e-9 * normal(i, i) : 1.0;
    VectorXd step = solve_symmetric(normal, right);
    double turn = 0;
    for (Eigen::Index i = 1; i < n; i += 2) turn = std::max(turn, std::abs(step[i]));
    if (turn > largest_step) step *= largest_step / turn;
    const ArcChain before = chain;
    const double was = cost(unit), limit = std::max(folded, largest_turn(before));
    for (const double part : {1.0, 0.5, 0.25}) {
      chain = before;
      chain = moved(part * step);
      if (largest_turn(chain) > limit) continue;
      measure();
      if (cost(unit) < was) return cost(unit) < was * (1 - 1e-3);
    }
    chain = before;
    measure();
    return false;
  }

  void solve(double unit) {
    measure();
    for (int i = 0; i < 8 && improve(unit); ++i) {
    }
  }

  /// A knot on the line at s, in its direction there.
  Knot knot_at(double where, double window) const {
    const Vec2 along = line.at(where + window) - line.at(where - window);
    return {line.at(where), std::atan2(along.y(), along.x())};
  }
};

std::vector<double> first_knots(const Line& line, const std::vector<bool>& pinned, double least_spacing,
                                std::vector<Index>& which) {
  std::vector<double> s;
  const std::size_t points = line.points.size() - (line.closed ? 1 : 0);
  for (std::size_t k = 0; k < points; ++k) {
    const bool end = !line.closed && (k == 0 || k + 1 == points);
    if (!end && !(k < pinned.size() && pinned[k])) continue;
    s.push_back(line.s[k]);
    which.push_back(Index(k));
  }
  if (!line.closed) return s;
  // Pieces that turn by a sixth of a circle where there is room for so many.
  const double room = line.length() / (0.6 * least_spacing);
  const int pieces = std::clamp(int(room), 3, 6);
  if (s.size() >= 3) return s;
  const double first = s.empty() ? 0 : s[0];
  for (int k = s.empty() ? 0 : 1; k < pieces; ++k) {
    const double at = first + line.length() * k / pieces;
    if (s.size() == 2 && std::abs(at - s[1]) < 0.5 * line.length() / pieces) continue;
    s.push_back(at);
    which.push_back(none);
  }
  return s;
}

/// In the order of s, which lies in [0, length).
void sort_knots(Fit& fit) {
  std::vector<std::size_t> order(fit.s.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    order[k] = k;
    if (fit.line.closed) fit.s[k] -= fit.line.length() * std::floor(fit.s[k] / fit.line.length());
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return fit.s[a] < fit.s[b]; });
  const std::vector<double> s = fit.s;
  const std::vector<Index> pinned = fit.pinned;
  const std::vector<Knot> knots = fit.chain.knots;
  for (std::size_t k = 0; k < order.size(); ++k) {
    fit.s[k] = s[order[k]];
    fit.pinned[k] = pinned[order[k]];
    fit.chain.knots[k] = knots[order[k]];
  }
}

/// By how far segments miss the line.
std::vector<double> misses(const Fit& fit) {
  std::vector<double> miss(segment_count(fit.chain), 0.0);
  for (std::size_t i = 0; i < fit.samples.size(); ++i) {
    double& m = miss[fit.place[i].arc / 2];
    m = std::max(m, fit.off[Eigen::Index(i)]);
  }
  return miss;
}

/// How far their arcs turn, in half turns.
std::vector<double> turns_of(const ArcChain& chain) {
  std::vector<double> turns(segment_count(chain), 0.0);
  for (std::size_t arc = 0; arc < 2 * turns.size(); ++arc) {
    const ChainPoint p = point_on(chain, {arc, 0.5});
    turns[arc / 2] = std::max(turns[arc / 2], std::abs(p.curvature) * p.speed / pi);
  }
  return turns;
}

/// Halves the segments that miss or turn too far, these down to shorter ones; false when none can be.
bool halve(Fit& fit, const ArcFit& how) {
  const std::vector<double> miss = misses(fit), turns = turns_of(fit.chain);
  const std::size_t n = fit.s.size();
  std::vector<double> added;
  for (std::size_t k = 0; k < miss.size(); ++k) {
    if (!(miss[k] > how.tolerance || turns[k] > widest)) continue;
    const double from = fit.s[k], to = k + 1 < n ? fit.s[k + 1] : fit.s[0] + fit.line.length();
    if (to - from < (turns[k] > widest ? 0.6 : 2.0) * how.least_spacing) continue;
    added.push_back((from + to) / 2);
  }
  const double window = std::min(how.least_spacing, fit.line.length() / 8);
  for (const double s : added) {
    fit.s.push_back(s);
    fit.pinned.push_back(none);
    fit.chain.knots.push_back(fit.knot_at(s, window));
  }
  if (!added.empty()) sort_knots(fit);
  return !added.empty();
}

}  // namespace

/// Every round of halving has more knots, at least .3 of the least spacing apart, so that the loop ends.
Fitted fit_arcs(const ChainTrace& trace, const ArcFit& how) {
  if (trace.points.size() < (trace.closed ? 3u : 2u)) throw std::invalid_argument("too few points for a chain of arcs");
  const Line line = line_of(trace);
  const std::vector<Sample> samples = samples_of(line);
  Fit fit{line, samples};
  fit.chain.closed = trace.closed;
  fit.s = first_knots(line, trace.pinned, how.least_spacing, fit.pinned);
  const double window = std::min(how.least_spacing, line.length() / 8);
  for (const double s : fit.s) fit.chain.knots.push_back(fit.knot_at(s, window));
  sort_knots(fit);
  do fit.solve(how.tolerance);
  while (halve(fit, how));
  return {std::move(fit.chain), std::move(fit.pinned), fit.off.size() > 0 ? fit.off.maxCoeff() : 0};
}

}  // namespace kerf
