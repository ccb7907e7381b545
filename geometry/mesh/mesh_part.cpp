// The part of a mesh that one process works on. It has its own triangles first, then rings of those of others around
// them (as many coarse rings as make six once the mesh is divided `times` times, since recovered stresses look at up to
// five) and what lies beyond a crack from any of these. The lists `shown` and `seen` of two processes are in the same
// order, which is that of the coarse mesh: what one sends the other stores without names. Each division makes four
// children that follow each other, so that all lists are divided by the same rule. See "Solving in parts" in
// docs/theory/elements.md.

#include "geometry/mesh_part.hpp"

#include "geometry/part.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace kerf {

namespace {

/// Rings of coarse triangles around a part that are six or more once they are divided: recovered stresses look at up to
/// five around a vertex, and those at the rim are cut off.
/// A ring of coarse triangles is two rings of its children.
int rings_around(int times) {
  constexpr int rings = 6;
  int coarse = rings;
  for (int time = 0; time < times; ++time) coarse = (coarse + 1) / 2;
  return coarse;
}

/// Which triangles a process has: its own, rings of those that share a vertex with them, and what lies beyond a crack
/// from these, so that both sides of every crack edge are there.
std::vector<bool> triangles_of(const Mesh& mesh, const std::vector<Index>& process, Index here, int rings) {
  std::vector<bool> touched(mesh.points.size(), false), use(mesh.triangles.size(), false);
  std::vector<Index> ring, next;
  const auto take = [&](Index t) {
    if (use[static_cast<std::size_t>(t)]) return;
    use[static_cast<std::size_t>(t)] = true;
    ring.push_back(t);
    next.push_back(t);
  };
  const auto with_far_sides = [&] {
    while (!next.empty()) {
      const Index t = next.back();
      next.pop_back();
      for (const Index e : mesh.edges_of[static_cast<std::size_t>(t)])
        if (mesh.crack[static_cast<std::size_t>(e)] != none)
          for (const Index side : mesh.sides[static_cast<std::size_t>(e)]) take(side);
    }
  };
  for (std::size_t t = 0; t < use.size(); ++t)
    if (process[t] == here) take(static_cast<Index>(t));
  with_far_sides();
  for (int k = 0; k < rings; ++k) {
    for (const Index t : std::exchange(ring, {}))
      for (const Index v : mesh.triangles[static_cast<std::size_t>(t)]) touched[static_cast<std::size_t>(v)] = true;
    for (std::size_t t = 0; t < use.size(); ++t)
      if (!use[t] &&
          std::ranges::any_of(mesh.triangles[t], [&](Index v) { return touched[static_cast<std::size_t>(v)]; }))
        take(static_cast<Index>(t));
    with_far_sides();
  }
  return use;
}

/// The triangles in another order: `order[i]` comes to place i.
void reorder(const std::vector<Index>& order, Mesh& mesh) {
  const auto moved = [&](const auto& all) {
    auto next = all;
    for (std::size_t i = 0; i < order.size(); ++i) next[i] = all[static_cast<std::size_t>(order[i])];
    return next;
  };
  mesh.triangles = moved(mesh.triangles);
  mesh.edges_of = moved(mesh.edges_of);
  if (!mesh.region.empty()) mesh.region = moved(mesh.region);
  std::vector<Index> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[static_cast<std::size_t>(order[i])] = static_cast<Index>(i);
  for (auto& sides : mesh.sides)
    for (Index& t : sides)
      if (t != none) t = place[static_cast<std::size_t>(t)];
}

/// MeshPart::from of a part that is not divided yet.
std::vector<std::vector<double>> starts_along(const Mesh& whole, const Part& cut, const Mesh& mesh) {
  std::vector<double> start(whole.edges.size(), 0);
  for (const auto& path : whole.cracks) {
    double s = 0;
    for (const CrackEdge& k : path) {
      start[static_cast<std::size_t>(k.edge)] = s;
      s += length(whole, k.edge);
    }
  }
  std::vector<std::vector<double>> from;
  for (const auto& path : mesh.cracks) {
    auto& starts = from.emplace_back();
    for (const CrackEdge& k : path)
      starts.push_back(start[static_cast<std::size_t>(cut.edge[static_cast<std::size_t>(k.edge)])]);
  }
  return from;
}

/// Every triangle into four: the mesh, and all lists of its triangles and of places along cracks.
void divide(MeshPart& part) {
  for (std::size_t c = 0; c < part.from.size(); ++c) {
    std::vector<double> halves;
    for (std::size_t k = 0; k < part.from[c].size(); ++k) {
      halves.push_back(part.from[c][k]);
      halves.push_back(part.from[c][k] + length(part.mesh, part.mesh.cracks[c][k].edge) / 2);
    }
    part.from[c] = std::move(halves);
  }
  part.mesh = refine(part.mesh);
  part.own *= 4;
  const auto divided = [](const std::vector<Index>& triangles) {
    std::vector<Index> all;
    all.reserve(4 * triangles.size());
    for (const Index t : triangles)
      for (Index k = 0; k < 4; ++k) all.push_back(4 * t + k);
    return all;
  };
  for (auto& list : part.shown) list = divided(list);
  for (auto& list : part.seen) list = divided(list);
  for (std::vector<Index>* of : {&part.process, &part.origin}) {
    std::vector<Index> finer;
    finer.reserve(4 * of->size());
    for (const Index p : *of) finer.insert(finer.end(), 4, p);
    *of = std::move(finer);
  }
}

}  // namespace

/// What another process has of this one is found by the same rule on the coarse mesh, without asking it.
MeshPart mesh_part(const Mesh& coarse, const std::vector<Index>& process, int count, Index here, int times) {
  if (process.size() != coarse.triangles.size()) throw std::invalid_argument("mesh_part: a process per triangle");
  const std::vector<bool> use = triangles_of(coarse, process, here, rings_around(times));
  Part cut = part(coarse, use);

  MeshPart out{.mesh = std::move(cut.mesh)};
  std::vector<Index> order;  // of the triangles of the part
  const auto of = [&](Index t) { return process[static_cast<std::size_t>(cut.triangle[static_cast<std::size_t>(t)])]; };
  const Index size = static_cast<Index>(cut.triangle.size());
  for (Index t = 0; t < size; ++t)
    if (of(t) == here) order.push_back(t);
  out.own = static_cast<Index>(order.size());
  for (Index t = 0; t < size; ++t)
    if (of(t) != here) order.push_back(t);
  reorder(order, out.mesh);

  out.from = starts_along(coarse, cut, out.mesh);
  for (const auto& path : coarse.cracks) {
    out.whole.push_back(0);
    for (const CrackEdge& k : path) out.whole.back() += length(coarse, k.edge);
  }
  out.shown.resize(static_cast<std::size_t>(count));
  out.seen.resize(static_cast<std::size_t>(count));
  const auto whole = [&](Index place) {
    return static_cast<std::size_t>(cut.triangle[static_cast<std::size_t>(order[static_cast<std::size_t>(place)])]);
  };
  for (Index i = 0; i < size; ++i) {
    out.process.push_back(process[whole(i)]);
    out.origin.push_back(static_cast<Index>(whole(i)));
    if (i >= out.own) out.seen[static_cast<std::size_t>(process[whole(i)])].push_back(i);
  }
  for (Index p = 0; p < static_cast<Index>(count); ++p) {
    if (p == here) continue;
    const std::vector<bool> there = triangles_of(coarse, process, p, rings_around(times));
    for (Index i = 0; i < out.own; ++i)
      if (there[whole(i)]) out.shown[static_cast<std::size_t>(p)].push_back(i);
  }

  for (int time = 0; time < times; ++time) divide(out);
  return out;
}

}  // namespace kerf
