// From edges to what is drawn: loops around sets of triangles, their straight sides, paths of cracks. trace() goes
// along a half edge with the set on its left, then turns around its end from triangle to triangle until an edge leaves
// the set: at a vertex where the set touches itself the loop stays with the fan of triangles it came from. The loop
// with the largest signed area is the outline; areas of loops around holes are negative. Straight sides are as long as
// possible: a line from its first point goes on as long as one direction passes every point within the tolerance, which
// is kept as an interval of slopes that each further point narrows; each point is looked at once.

#include "io/mesh/outlines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf {

namespace {

constexpr std::size_t next(std::size_t i) {
  return i == 2 ? 0 : i + 1;
}
constexpr std::size_t previous(std::size_t i) {
  return i == 0 ? 2 : i - 1;
}

Index across(const Mesh& mesh, Index triangle, Index edge) {
  const auto& [left, right] = mesh.sides[std::size_t(edge)];
  return left == triangle ? right : left;
}

/// A line from its first point may go on as long as its direction passes all further points within the tolerance.
class Sleeve {
 public:
  Sleeve(const Vec2& from, const Vec2& to, double tolerance)
      : from_(from), along_((to - from).normalized()), tolerance_(tolerance) {
    narrow(to);
  }
  bool reaches(const Vec2& x) const {
    const Vec2 d = x - from_;
    const double forward = along_.dot(d);
    if (!(forward > farthest_)) return false;
    const double slope = cross(along_, d) / forward;
    return slope >= low_ && slope <= high_;
  }
  void narrow(const Vec2& x) {
    const Vec2 d = x - from_;
    farthest_ = along_.dot(d);
    const double slope = cross(along_, d) / farthest_, wide = tolerance_ / farthest_;
    low_ = std::max(low_, slope - wide);
    high_ = std::min(high_, slope + wide);
  }

 private:
  Vec2 from_, along_;
  double tolerance_, low_ = -infinity, high_ = infinity, farthest_ = 0;
};

}  // namespace

std::vector<std::size_t> corner_places(const std::vector<Vec2>& line, double tolerance) {
  std::vector<std::size_t> found{0};
  for (std::size_t i = 0; i + 1 < line.size();) {
    Sleeve sleeve(line[i], line[i + 1], tolerance);
    std::size_t end = i + 1;
    while (end + 1 < line.size() && sleeve.reaches(line[end + 1])) sleeve.narrow(line[++end]);
    found.push_back(i = end);
  }
  return found;
}

RimLoops trace(const Mesh& mesh, const std::function<bool(Index)>& in_set) {
  const auto outside = [&](Index triangle, Index edge) {
    const Index other = across(mesh, triangle, edge);
    return other == none || !in_set(other);
  };
  const auto half = [&](Index triangle, std::size_t i) {
    const auto& v = mesh.triangles[std::size_t(triangle)];
    return HalfEdge{v[next(i)], v[previous(i)], mesh.edges_of[std::size_t(triangle)][i], triangle};
  };
  std::vector<std::array<bool, 3>> done(mesh.triangles.size(), {false, false, false});
  RimLoops loops;
  for (std::size_t seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (!in_set(Index(seed))) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      if (done[seed][k] || !outside(Index(seed), mesh.edges_of[seed][k])) continue;
      RimLoop loop;
      Index t = Index(seed);
      std::size_t i = k;
      while (!done[std::size_t(t)][i]) {
        done[std::size_t(t)][i] = true;
        loop.push_back(half(t, i));
        i = next(i);  // from the end of this edge; turned around it until the set ends
        while (!outside(t, mesh.edges_of[std::size_t(t)][i])) {
          const Index e = mesh.edges_of[std::size_t(t)][i];
          t = across(mesh, t, e);
          const auto& edges = mesh.edges_of[std::size_t(t)];
          i = next(std::size_t(std::find(edges.begin(), edges.end(), e) - edges.begin()));
        }
      }
      loops.push_back(std::move(loop));
    }
  }
  const auto most = std::max_element(loops.begin(), loops.end(), [&](const RimLoop& a, const RimLoop& b) {
    return signed_area(mesh, a) < signed_area(mesh, b);
  });
  if (most != loops.end()) std::rotate(loops.begin(), most, most + 1);
  return loops;
}

double signed_area(const Mesh& mesh, const RimLoop& loop) {
  double twice = 0;
  const Vec2& origin = mesh.points[std::size_t(loop.front().a)];
  for (const HalfEdge& h : loop)
    twice += cross(mesh.points[std::size_t(h.a)] - origin, mesh.points[std::size_t(h.b)] - origin);
  return twice / 2;
}

std::vector<Side> sides_of(const Mesh& mesh, const RimLoop& loop, const std::vector<Index>& label, double tolerance) {
  const std::size_t n = loop.size();
  const auto of = [&](std::size_t i) { return label[std::size_t(loop[i % n].edge)]; };
  const auto point = [&](std::size_t i) -> const Vec2& { return mesh.points[std::size_t(loop[i % n].a)]; };
  // Begin at a change of labels or, without one, at the sharpest corner.
  std::size_t begin = 0;
  double sharpest = infinity;
  for (std::size_t i = 0; i < n; ++i) {
    const double turn = of(i) != of(i + n - 1)
                            ? -2
                            : (point(i + 1) - point(i)).normalized().dot((point(i) - point(i + n - 1)).normalized());
    if (turn < sharpest) sharpest = turn, begin = i;
  }
  std::vector<Side> sides;
  for (std::size_t i = 0; i < n;) {
    std::size_t end = i + 1;
    while (end < n && of(begin + end) == of(begin + i)) ++end;
    std::vector<Vec2> line;
    for (std::size_t k = i; k <= end; ++k) line.push_back(point(begin + k));
    const std::vector<std::size_t> kinks = corner_places(line, tolerance);
    for (std::size_t k = 0; k + 1 < kinks.size(); ++k) sides.push_back({line[kinks[k]], of(begin + i), {}});
    i = end;
  }
  return sides;
}

std::vector<CrackEdge> path_of(const Mesh& mesh, const std::vector<std::pair<Index, bool>>& along, std::string& why) {
  const auto at = [&](Index v) {
    return fmt::format("({:.6g}, {:.6g})", mesh.points[std::size_t(v)].x(), mesh.points[std::size_t(v)].y());
  };
  std::map<Index, std::vector<Index>> edges_at;
  for (const auto& [e, forward] : along)
    for (const Index v : mesh.edges[std::size_t(e)]) edges_at[v].push_back(e);
  std::vector<Index> ends;
  for (const auto& [v, list] : edges_at) {
    if (list.size() > 2) {
      why = fmt::format("branches at {}; each branch needs a name of its own", at(v));
      return {};
    }
    if (list.size() == 1) ends.push_back(v);
  }
  if (ends.empty()) {
    why = fmt::format("is closed, through {}; a closed cut is a hole, or in a body that is drawn an [[interface]]",
                      at(edges_at.begin()->first));
    return {};
  }
  if (ends.size() > 2) {
    why = fmt::format("is in several pieces, with ends at {}, {} and {}; each piece needs a name of its own",
                      at(ends[0]), at(ends[1]), at(ends[2]));
    return {};
  }
  std::vector<CrackEdge> path;
  Index v = ends[0], e = edges_at[v].front();
  while (true) {
    const auto& [low, high] = mesh.edges[std::size_t(e)];
    path.push_back({e, low == v});
    v = low == v ? high : low;
    const auto& list = edges_at[v];
    if (list.size() == 1) break;
    e = list[0] == e ? list[1] : list[0];
  }
  if (path.size() < along.size()) {
    why = fmt::format("is in several pieces, one from {} to {}, another closed; each needs a name of its own",
                      at(ends[0]), at(ends[1]));
    return {};
  }
  const auto first =
      std::find_if(path.begin(), path.end(), [&](const CrackEdge& c) { return c.edge == along.front().first; });
  if (first->forward != along.front().second) {
    std::reverse(path.begin(), path.end());
    for (CrackEdge& c : path) c.forward = !c.forward;
  }
  return path;
}

std::vector<Vec2> points_of(const Mesh& mesh, const std::vector<CrackEdge>& path) {
  std::vector<Vec2> out;
  for (const CrackEdge& c : path)
    out.push_back(mesh.points[std::size_t(mesh.edges[std::size_t(c.edge)][c.forward ? 0 : 1])]);
  const CrackEdge& last = path.back();
  out.push_back(mesh.points[std::size_t(mesh.edges[std::size_t(last.edge)][last.forward ? 1 : 0])]);
  return out;
}

}  // namespace kerf
