// How near the pieces of a zero line come to one another and to what is there already.

#include "geometry/boxes.hpp"
#include "geometry/carve/simplify.hpp"
#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

struct Owner {
  Index chain, number;  // no chain: the obstacle's group
};

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

/// Segments of a point's own chain count from `near` steps away on: closer ones bend towards it without meeting it.
std::vector<std::vector<Clearance>> clearances(const std::vector<Chain>& chains, const std::vector<Obstacle>& obstacles,
                                               double far) {
  std::vector<std::array<Vec2, 2>> segments;
  std::vector<Owner> owner;  // per segment
  const auto add = [&](const Vec2& a, const Vec2& b, const Owner& of) {
    segments.push_back({a, b});
    owner.push_back(of);
  };
  for (const Obstacle& o : obstacles) add(o.a, o.b, {none, o.group});
  std::vector<std::vector<Clearance>> clearance;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const std::vector<Vec2>& x = chains[c].points;
    clearance.emplace_back(x.size(), Clearance{far, far});
    for (std::size_t i = 0; i + (chains[c].closed ? 0 : 1) < x.size(); ++i) {
      add(x[i], x[(i + 1) % x.size()], {Index(c), Index(i)});
    }
  }
  if (segments.empty()) return clearance;
  std::vector<AxisBox> boxes;
  for (const auto& [a, b] : segments) boxes.push_back(box_around(a, b));
  const BoxTree tree(boxes);
  const auto anywhere = [](const AxisBox&) { return true; };
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const Chain& chain = chains[c];
    const Index n = Index(chain.points.size());
    const double step = n > 1 ? (chain.points[1] - chain.points[0]).norm() : far;
    const Index near = std::max<Index>(2, Index(std::ceil(4 * far / std::max(step, far / 10))));
    for (Index i = 0; i < n; ++i) {
      const Vec2& x = chain.points[std::size_t(i)];
      const std::array<Index, 2> met = met_beside(chain, i);
      Clearance& least = clearance[c][std::size_t(i)];
      tree.each_near(x, far, anywhere, [&](Index k) {
        const Owner& s = owner[std::size_t(k)];
        if (s.chain == Index(c) && steps_between(chain, i, s.number) <= near) return;
        const double d = distance(x, segments[std::size_t(k)][0], segments[std::size_t(k)][1]);
        least.all = std::min(least.all, d);
        if (s.chain != none || (s.number != met[0] && s.number != met[1])) least.beside = std::min(least.beside, d);
      });
    }
  }
  return clearance;
}

}  // namespace kerf
