// Which triangles and edges around a crack tip are mirror images of each other in the crack: a walk over pairs of
// triangles, from the edge at the tip outwards. From a pair and an edge of each that are images the two other edges are
// paired, those of the image in the opposite turn, and the triangles beyond them are the next pair as long as the apex
// of one lies where the image of the other's does, up to a twentieth of the edge. An edge that is its own image
// (straight ahead of the tip) ends the walk there. Adaptive meshes keep such images alike (adapt.cpp).

#include "geometry/mesh/mirror.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double alike = 0.05;  // of an edge

/// Two triangles that are images of one another, and an edge of each that is known to be.
struct Pair {
  Index triangle, image, edge, image_edge;
};

struct Walk {
  const Mesh& mesh;
  MirrorImages found;
  Vec2 tip, ahead;
  std::vector<Pair> open = {};

  Vec2 image(const Vec2& x) const {
    const Vec2 d = x - tip;
    return tip + 2 * ahead.dot(d) * ahead - d;
  }

  /// Corner of a triangle opposite to its edge e.
  std::size_t corner(Index t, Index e) const {
    const auto& edges = mesh.edges_of[std::size_t(t)];
    return std::size_t(std::ranges::find(edges, e) - edges.begin());
  }

  Vec2 apex(Index t, Index e) const {
    return mesh.points[std::size_t(mesh.triangles[std::size_t(t)][corner(t, e)])];
  }

  void enter(Index e, Index f, Index t, Index u) {
    if (t == none || u == none || t == u) return;
    if (found.triangle[std::size_t(t)] != none || found.triangle[std::size_t(u)] != none) return;
    const Vec2 there = image(apex(t, e)), shape = apex(u, f);
    if ((there - shape).norm() > alike * length(mesh, e)) return;
    found.triangle[std::size_t(t)] = u;
    found.triangle[std::size_t(u)] = t;
    found.edge[std::size_t(e)] = f;
    found.edge[std::size_t(f)] = e;
    open.push_back({t, u, e, f});
  }

  /// Images run the other way around.
  void spread() {
    while (!open.empty()) {
      const auto [t, u, e, f] = open.back();
      open.pop_back();
      const std::size_t i = corner(t, e), j = corner(u, f);
      for (const std::size_t k : {1, 2}) {
        const Index side = mesh.edges_of[std::size_t(t)][(i + k) % 3],
                    other = mesh.edges_of[std::size_t(u)][(j + 3 - k) % 3];
        found.edge[std::size_t(side)] = other;
        found.edge[std::size_t(other)] = side;
        if (side == other) continue;  // straight ahead of the tip
        const auto beyond = [&](Index edge, Index from) {
          const auto& [left, right] = mesh.sides[std::size_t(edge)];
          return left == from ? right : left;
        };
        enter(side, other, beyond(side, t), beyond(other, u));
      }
    }
  }
};

}  // namespace

/// A vertex with exactly one crack edge and no side is a tip.
MirrorImages mirror_at_tips(const Mesh& mesh) {
  Walk walk{mesh,
            {std::vector<Index>(mesh.triangles.size(), none), std::vector<Index>(mesh.edges.size(), none)},
            Vec2::Zero(),
            Vec2::Zero()};
  std::vector<int> ends(mesh.points.size(), 0);  // crack edges at a vertex; sides count double
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const int count = mesh.crack[e] != none ? 1 : mesh.sides[e][0] == none || mesh.sides[e][1] == none ? 2 : 0;
    for (const Index v : mesh.edges[e]) ends[std::size_t(v)] += count;
  }
  for (const std::vector<CrackEdge>& crack : mesh.cracks)
    if (!crack.empty())
      for (const bool start : {true, false}) {
        const CrackEdge& last = start ? crack.front() : crack.back();
        const auto& [a, b] = mesh.edges[std::size_t(last.edge)];
        const Index tip = last.forward == start ? a : b;
        if (ends[std::size_t(tip)] != 1) continue;
        walk.tip = mesh.points[std::size_t(tip)];
        walk.ahead = (walk.tip - mesh.points[std::size_t(tip == a ? b : a)]).normalized();
        const auto& [left, right] = mesh.sides[std::size_t(last.edge)];
        walk.enter(last.edge, last.edge, left, right);
        walk.spread();
      }
  return std::move(walk.found);
}

}  // namespace kerf
