// Points to triangles: a tree of boxes, halved at the median centroid, so that meshes graded over many decades cost no
// more than even ones.
// A point on an edge, or outside by less than 1e-12 of the extent, counts to the nearest triangle, of equals to the one
// found first: queries do not depend on anything but the mesh. Of a curved edge the arc decides and not the chord: a
// point between both belongs to the triangle on the other side of the chord. The tree has at most 4 triangles in a
// leaf, its depth is bounded by the logarithm of their number, and the nearest triangle is found by visiting the nearer
// box first.

#include "kerf/mesh.hpp"

#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr Index leaf = 4;  // no more triangles than this are listed

struct Box {
  Vec2 low, high;
};

Box box(const Mesh& mesh, Index t) {
  const auto& v = mesh.triangles[std::size_t(t)];
  const Vec2 &a = mesh.points[std::size_t(v[0])], &b = mesh.points[std::size_t(v[1])],
             &c = mesh.points[std::size_t(v[2])];
  return {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
}

/// How far x lies outside the triangle, measured along the normals of its sides; not positive inside.
double outside(const Mesh& mesh, Index t, const Vec2& x) {
  double worst = -infinity;
  const auto& v = mesh.triangles[std::size_t(t)];
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 &a = mesh.points[std::size_t(v[i])], &b = mesh.points[std::size_t(v[(i + 1) % 3])];
    const double twice = cross(x - a, b - a);
    worst = std::max(worst, twice <= 0 ? std::min(twice, 0.0) : twice / (b - a).norm());
  }
  return worst;
}

double squared_distance(const Mesh& mesh, Index t, const Vec2& x) {
  if (outside(mesh, t, x) <= 0) return 0;
  const auto& v = mesh.triangles[std::size_t(t)];
  double least = infinity;
  for (std::size_t i = 0; i < 3; ++i)
    least = std::min(
        least, kerf::squared_distance(x, mesh.points[std::size_t(v[i])], mesh.points[std::size_t(v[(i + 1) % 3])]));
  return least;
}

/// Node `number` for the triangles from `first` on.
void grow(Locator& locator, const std::vector<Box>& boxes, Index first, Index count) {
  const std::size_t number = locator.nodes.size();
  locator.nodes.emplace_back();
  const auto begin = locator.triangles.begin() + first, end = begin + count;
  Box all = boxes[std::size_t(*begin)];
  Vec2 low = (all.low + all.high) / 2, high = low;  // of the boxes' centers
  for (auto t = begin; t != end; ++t) {
    const Box& b = boxes[std::size_t(*t)];
    all = {all.low.cwiseMin(b.low), all.high.cwiseMax(b.high)};
    low = low.cwiseMin((b.low + b.high) / 2);
    high = high.cwiseMax((b.low + b.high) / 2);
  }
  locator.nodes[number] = {all.low, all.high, first, count, none};
  if (count <= leaf) return;
  const int axis = (high - low).x() >= (high - low).y() ? 0 : 1;
  const auto center = [&](Index t) { return boxes[std::size_t(t)].low[axis] + boxes[std::size_t(t)].high[axis]; };
  std::nth_element(begin, begin + count / 2, end, [&](Index s, Index t) {
    const double p = center(s), q = center(t);
    return p != q ? p < q : s < t;
  });
  grow(locator, boxes, first, count / 2);
  locator.nodes[number].right = Index(locator.nodes.size());
  grow(locator, boxes, first + count / 2, count - count / 2);
}

}  // namespace

/// Boxes are those of the triangles of the chords; arcs are seen to when a triangle is found.
Locator make_locator(const Mesh& mesh) {
  Locator locator;
  if (mesh.triangles.empty()) return locator;
  std::vector<Box> boxes;
  boxes.reserve(mesh.triangles.size());
  locator.triangles.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    boxes.push_back(box(mesh, Index(t)));
    locator.triangles.push_back(Index(t));
  }
  grow(locator, boxes, 0, Index(boxes.size()));
  return locator;
}

namespace {

/// In the triangle of the chords.
Index locate_straight(const Mesh& mesh, const Locator& locator, const Vec2& x) {
  if (locator.nodes.empty()) return none;
  const double margin = 1e-12 * (locator.nodes[0].high - locator.nodes[0].low).norm();
  double least = margin;
  Index found = none;
  std::array<Index, 64> stack;  // no deeper than twice the logarithm of the number of triangles
  std::size_t height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const Index number = stack[--height];
    const Locator::Node& node = locator.nodes[std::size_t(number)];
    // Not finite: in no box.
    if (!(x.x() >= node.low.x() - margin && x.x() <= node.high.x() + margin && x.y() >= node.low.y() - margin &&
          x.y() <= node.high.y() + margin))
      continue;
    if (node.right != none) {
      stack[height++] = node.right;
      stack[height++] = number + 1;
      continue;
    }
    for (Index i = node.first; i < node.first + node.count; ++i) {
      const Index t = locator.triangles[std::size_t(i)];
      const double distance = outside(mesh, t, x);
      if (distance > least || (found != none && distance == least)) continue;
      least = distance;
      found = t;
      if (least <= 0) return found;
    }
  }
  return found;
}

/// Whether x lies on the side of the arc on which triangle t does.
bool on_own_side(const Mesh& mesh, Index t, Index edge, const Vec2& x) {
  const Arc& arc = mesh.arcs[std::size_t(mesh.arc[std::size_t(edge)])];
  const auto& [a, b] = mesh.edges[std::size_t(edge)];
  const Vec2 &p = mesh.points[std::size_t(a)], &q = mesh.points[std::size_t(b)];
  const bool left = mesh.sides[std::size_t(edge)][0] == t, center_left = cross(q - p, arc.center - p) > 0;
  const Vec2 y = arc.axes.inverse() * (x - arc.center);
  constexpr double rounding = 1e-12;
  return left == center_left ? y.norm() <= 1 + rounding : y.norm() >= 1 - rounding;
}

}  // namespace

// Between a chord and its arc lies what belongs to the other side of the chord.
Index locate(const Mesh& mesh, const Locator& locator, const Vec2& x) {
  Index t = locate_straight(mesh, locator, x);
  if (mesh.arc.empty() || locator.nodes.empty()) return t;
  const bool found = t != none;
  if (!found) t = nearest_triangle(mesh, locator, x);
  for (const Index e : mesh.edges_of[std::size_t(t)]) {
    if (mesh.arc[std::size_t(e)] == none) continue;
    const auto& [a, b] = mesh.edges[std::size_t(e)];
    const Vec2 side = mesh.points[std::size_t(b)] - mesh.points[std::size_t(a)];
    const double along = (x - mesh.points[std::size_t(a)]).dot(side) / side.squaredNorm();
    if (!(along >= 0 && along <= 1)) continue;
    if (found && !on_own_side(mesh, t, e, x)) {
      const auto& [left, right] = mesh.sides[std::size_t(e)];
      return left == t ? right : left;
    }
    // Beyond the chord, within the arc: a flat segment of it.
    const double beyond = std::abs(cross(side, x - mesh.points[std::size_t(a)])) / side.squaredNorm();
    constexpr double flat = 0.3;
    if (!found && beyond < flat && on_own_side(mesh, t, e, x)) return t;
  }
  return found ? t : none;
}

Index nearest_triangle(const Mesh& mesh, const Locator& locator, const Vec2& x) {
  double least = infinity;
  Index found = none;
  const auto to_box = [&](Index number) {
    const Locator::Node& node = locator.nodes[std::size_t(number)];
    return (x - x.cwiseMax(node.low).cwiseMin(node.high)).squaredNorm();
  };
  const auto visit = [&](const auto& self, Index number) -> void {
    const Locator::Node& node = locator.nodes[std::size_t(number)];
    if (node.right == none) {
      for (Index i = node.first; i < node.first + node.count; ++i) {
        const Index t = locator.triangles[std::size_t(i)];
        const double distance = squared_distance(mesh, t, x);
        if (distance >= least) continue;
        least = distance;
        found = t;
      }
      return;
    }
    Index one = number + 1, other = node.right;
    double to_one = to_box(one), to_other = to_box(other);
    if (to_other < to_one) std::swap(one, other), std::swap(to_one, to_other);
    if (to_one < least) self(self, one);
    if (to_other < least) self(self, other);
  };
  if (!locator.nodes.empty()) visit(visit, 0);
  return found;
}

std::vector<Index> locate(const Mesh& mesh, std::span<const Vec2> points) {
  if (points.empty()) return {};
  const Locator locator = make_locator(mesh);
  std::vector<Index> found;
  found.reserve(points.size());
  for (const Vec2& x : points) found.push_back(locate(mesh, locator, x));
  return found;
}

}  // namespace kerf
