// How near the pieces of a zero line come to one another and to what is there already.

#include "geometry/carve/simplify.hpp"
#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {

namespace {

struct Segment {
  Vec2 a, b;
  Index chain, number;  // no chain: the obstacle's group
};

/// Segments in square cells; each in every cell that its box, widened, meets.
struct Cells {
  Vec2 low;
  double cell;
  int columns, rows;
  std::vector<Index> start, listed;

  int column(double x) const {
    return int(std::clamp((x - low.x()) / cell, 0.0, columns - 1.0));
  }
  int row(double y) const {
    return int(std::clamp((y - low.y()) / cell, 0.0, rows - 1.0));
  }
  std::size_t at(int column, int row) const {
    return std::size_t(row) * std::size_t(columns) + std::size_t(column);
  }
};

Cells file(const std::vector<Segment>& segments, double cell, double margin) {
  Cells cells;
  Vec2 high = Vec2::Constant(-std::numeric_limits<double>::infinity());
  cells.low = -high;
  for (const Segment& s : segments) {
    cells.low = cells.low.cwiseMin(s.a).cwiseMin(s.b);
    high = high.cwiseMax(s.a).cwiseMax(s.b);
  }
  cells.cell = std::max(cell, (high - cells.low).maxCoeff() / 500);
  cells.columns = int((high.x() - cells.low.x()) / cells.cell) + 1;
  cells.rows = int((high.y() - cells.low.y()) / cells.cell) + 1;
  cells.start.assign(std::size_t(cells.columns) * std::size_t(cells.rows) + 1, 0);
  const auto each = [&](const Segment& s, auto&& visit) {
    const Vec2 l = s.a.cwiseMin(s.b).array() - margin, h = s.a.cwiseMax(s.b).array() + margin;
    for (int r = cells.row(l.y()); r <= cells.row(h.y()); ++r)
      for (int c = cells.column(l.x()); c <= cells.column(h.x()); ++c) visit(cells.at(c, r));
  };
  for (const Segment& s : segments) each(s, [&](std::size_t i) { ++cells.start[i + 1]; });
  for (std::size_t i = 0; i + 1 < cells.start.size(); ++i) cells.start[i + 1] += cells.start[i];
  cells.listed.resize(std::size_t(cells.start.back()));
  std::vector<Index> fill(cells.start.begin(), cells.start.end() - 1);
  for (std::size_t k = 0; k < segments.size(); ++k)
    each(segments[k], [&](std::size_t i) { cells.listed[std::size_t(fill[i]++)] = Index(k); });
  return cells;
}

/// What the fixed points that a chord over point i can reach lie on, before it and after it.
std::array<Index, 2> met_beside(const Chain& chain, Index i) {
  const Index n = Index(chain.points.size());
  std::array<Index, 2> met{none, none};
  for (const int way : {-1, 1})
    for (Index k = 0; k < longest_chord; ++k) {
      const Index at = i + way * k;
      if (!chain.closed && (at < 0 || at >= n)) break;
      const std::size_t p = std::size_t(((at % n) + n) % n);
      if (!chain.fixed[p]) continue;
      met[way < 0 ? 0 : 1] = chain.meets[p];
      break;
    }
  return met;
}

/// How many points of its own chain lie between point i and segment `number`.
Index steps_between(const Chain& chain, Index i, Index number) {
  const Index n = Index(chain.points.size());
  const Index one = std::abs(number - i), other = std::abs(number + 1 - i);
  const Index apart = std::min(one, other);
  return chain.closed ? std::min(apart, n - std::max(one, other)) : apart;
}

}  // namespace

std::vector<std::vector<Clearance>> clearances(const std::vector<Chain>& chains, const std::vector<Obstacle>& obstacles,
                                               double far) {
  std::vector<Segment> segments;
  for (const Obstacle& o : obstacles) segments.push_back({o.a, o.b, none, o.group});
  double longest = far;
  std::vector<std::vector<Clearance>> clearance;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const std::vector<Vec2>& x = chains[c].points;
    clearance.emplace_back(x.size(), Clearance{far, far});
    for (std::size_t i = 0; i + (chains[c].closed ? 0 : 1) < x.size(); ++i) {
      segments.push_back({x[i], x[(i + 1) % x.size()], Index(c), Index(i)});
      longest = std::max(longest, (segments.back().b - segments.back().a).norm());
    }
  }
  if (segments.empty()) return clearance;
  const Cells cells = file(segments, 2 * longest, far);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const Chain& chain = chains[c];
    const Index n = Index(chain.points.size());
    const double step = n > 1 ? (chain.points[1] - chain.points[0]).norm() : far;
    const Index near = std::max<Index>(2, Index(std::ceil(4 * far / std::max(step, far / 10))));
    for (Index i = 0; i < n; ++i) {
      const Vec2& x = chain.points[std::size_t(i)];
      const std::array<Index, 2> met = met_beside(chain, i);
      Clearance& least = clearance[c][std::size_t(i)];
      const std::size_t cell = cells.at(cells.column(x.x()), cells.row(x.y()));
      for (Index k = cells.start[cell]; k < cells.start[cell + 1]; ++k) {
        const Segment& s = segments[std::size_t(cells.listed[std::size_t(k)])];
        if (s.chain == Index(c) && steps_between(chain, i, s.number) <= near) continue;
        const double d = distance(x, s.a, s.b);
        least.all = std::min(least.all, d);
        if (s.chain != none || (s.number != met[0] && s.number != met[1])) least.beside = std::min(least.beside, d);
      }
    }
  }
  return clearance;
}

}  // namespace kerf
