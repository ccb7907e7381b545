// The rows of K that no contact law acts on, in parts, one per process:
//   K = sum_p R_p' K_p R_p   [theory: E.30],
// K_p condensed from the triangles of part p, R_p the unknowns that it sees. Triangles are partitioned along the graph
// of edges that hold both sides together, pieces cut off from their part are given to neighbors, and unknowns belong to
// the first part that sees them. On a crack that parts freely the unknowns are what each side sees, u and u + [u], so
// that no part holds on to what it does not touch. A part travels
// as bytes (`packed_part`), and is condensed where it arrives (`condensed_part`), with the rows that touch each other
// along borders, from which connected pieces of the interface follow. Derived in docs/theory/elements.md, section
// Solving in parts.

#include "solver/system/parted.hpp"

#include "base/packer.hpp"
#include "geometry/topology.hpp"
#include "kerf/stop.hpp"
#include "solver/system/lists.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

namespace kerf {

namespace {

/// One triangle with its own copies of what Triangle points to.
struct PackedTriangle {
  Triangle shape;
  std::array<std::vector<Mat2>, 3> bent;
  std::array<EdgeCurvature, 3> curvature;
};

void put(const Triangle& t, int points, Packer& to) {
  for (int i = 0; i < 3; ++i) {
    to.put(t.x[i]);
    to.put(t.frame[i]);
    to.put(t.forward[i]);
    to.put(t.bent[i] != nullptr);
    for (int g = 0; t.bent[i] && g < points; ++g) to.put(t.bent[i][g]);
    to.put(t.curvature[i] != nullptr);
    if (t.curvature[i])
      for (const Vec2& q : t.curvature[i]->q) to.put(q);
  }
}

void get(Unpacker& from, int points, PackedTriangle& t) {
  for (int i = 0; i < 3; ++i) {
    t.shape.x[i] = from.get<Vec2>();
    t.shape.frame[i] = from.get<Mat2>();
    t.shape.forward[i] = from.get<bool>();
    t.bent[i].clear();
    if (from.get<bool>())
      for (int g = 0; g < points; ++g) t.bent[i].push_back(from.get<Mat2>());
    t.shape.bent[i] = t.bent[i].empty() ? nullptr : t.bent[i].data();
    const bool curved = from.get<bool>();
    if (curved)
      for (Vec2& q : t.curvature[i].q) q = from.get<Vec2>();
    t.shape.curvature[i] = curved ? &t.curvature[i] : nullptr;
  }
}

/// Whether all components of an edge's sides move by themselves.
/// An edge whose sides share a component still joins them: contact in the normal direction with free sliding is one.
bool splits(const Assembly& from, Index e) {
  const Skeleton& s = from.skeleton;
  if (s.jump[e] == none) return false;
  for (int k = 0; k < s.per_edge; ++k)
    if (!parts_freely(from.ordering, s.jump[e] + k)) return false;
  return true;
}

struct PartGraph {
  std::vector<Index> start, neighbors;
};

// Triangles that hold on to each other, not across cracks that part freely.
// Across a crack that parts freely nothing is shared, so that cutting there is free.
PartGraph graph_of(const Assembly& from) {
  PartGraph g;
  g.start.push_back(0);
  for (Index t = 0; t < static_cast<Index>(from.mesh.triangles.size()); ++t) {
    for (const Index e : from.mesh.edges_of[t]) {
      const auto& [left, right] = from.mesh.sides[e];
      if (left == none || right == none || splits(from, e)) continue;
      g.neighbors.push_back(left == t ? right : left);
    }
    g.start.push_back(static_cast<Index>(g.neighbors.size()));
  }
  return g;
}

// What is cut off from the largest piece of its part goes to the part that it has most edges with.
// Sweeps, because a piece that moves may join another that was cut off, or cut off a third; eight at most.
std::vector<Index> in_one_piece(const PartGraph& graph, std::vector<Index> part) {
  const Index n = static_cast<Index>(part.size());
  constexpr int most = 8;
  for (int sweep = 0; sweep < most; ++sweep) {
    std::vector<Index> piece(part.size(), none), size, of;
    std::vector<Index> stack;
    for (Index seed = 0; seed < n; ++seed) {
      if (piece[seed] != none) continue;
      const Index name = static_cast<Index>(size.size());
      size.push_back(0);
      of.push_back(part[seed]);
      piece[seed] = name;
      stack.push_back(seed);
      while (!stack.empty()) {
        const Index t = stack.back();
        stack.pop_back();
        ++size[name];
        for (Index p = graph.start[t]; p < graph.start[t + 1]; ++p)
          if (const Index o = graph.neighbors[p]; piece[o] == none && part[o] == part[t]) {
            piece[o] = name;
            stack.push_back(o);
          }
      }
    }
    std::vector<Index> largest(static_cast<std::size_t>(*std::ranges::max_element(part)) + 1, none);
    for (Index i = 0; i < static_cast<Index>(size.size()); ++i)
      if (Index& l = largest[of[i]]; l == none || size[i] > size[l]) l = i;
    std::vector<std::vector<Index>> border(size.size());  // parts beyond the edges of pieces that move
    bool moved = false;
    for (Index t = 0; t < n; ++t)
      if (largest[part[t]] != piece[t])
        for (Index p = graph.start[t]; p < graph.start[t + 1]; ++p)
          if (const Index o = graph.neighbors[p]; part[o] != part[t]) border[piece[t]].push_back(part[o]);
    std::vector<Index> to(size.size(), none);
    for (std::size_t i = 0; i < border.size(); ++i) {
      std::ranges::sort(border[i]);
      std::ptrdiff_t best = 0;
      for (auto at = border[i].begin(); at != border[i].end();) {
        const auto end = std::upper_bound(at, border[i].end(), *at);
        if (end - at > best) best = end - at, to[i] = *at;
        at = end;
      }
    }
    for (Index t = 0; t < n; ++t)
      if (to[piece[t]] != none && largest[part[t]] != piece[t]) part[t] = to[piece[t]], moved = true;
    if (!moved) break;
  }
  return part;
}

std::vector<Index> rows_of(const Assembly& from, Index t) {
  const Seen view = seen(from.mesh, from.skeleton, t);
  std::vector<Index> rows(static_cast<std::size_t>(view.count));
  for (int i = 0; i < view.count; ++i)
    rows[i] = from.ordering.row[unknown_of_trace(from.ordering, view.base[i], view.jump[i])];
  return rows;
}

}  // namespace

bool parts_freely(const Ordering& o, Index jump) {
  return jump != none && o.row[jump] != none && o.row[jump] < o.leading();
}

Index unknown_of_trace(const Ordering& o, Index base, Index jump) {
  return parts_freely(o, jump) ? jump : base;
}

Corners corners_at_free_cracks(const Assembly& from) {
  std::vector<bool> cut(from.mesh.edges.size());
  for (Index e = 0; e < static_cast<Index>(cut.size()); ++e) cut[e] = splits(from, e);
  return split_at(from.mesh, cut);
}

// The least number among the processes that see an unknown; a jump belongs to that of its crack's right side.
std::vector<Index> holders(const Mesh& mesh, const Skeleton& s, const Ordering& o, const std::vector<Index>& process) {
  std::vector<Index> holder(static_cast<std::size_t>(s.total), none);
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const Seen view = seen(mesh, s, t);
    for (int i = 0; i < view.count; ++i) {
      if (view.jump[i] != none) holder[view.jump[i]] = process[t];
      if (Index& h = holder[view.base[i]]; !parts_freely(o, view.jump[i]) && (h == none || h > process[t]))
        h = process[t];
    }
  }
  return holder;
}

std::vector<Index> partition(const Assembly& from, const Partitioner& partitioner) {
  const PartGraph graph = graph_of(from);
  return in_one_piece(graph, partitioner(graph.start, graph.neighbors));
}

// Rows of a part are in the order of their numbers among all, so that both sides of a border list what they share in
// the same order.
std::string packed_part(const Packing& by, std::span<const Index> triangles, Index owned) {
  const Assembly& from = by.from;
  std::vector<Index> rows;  // of the leading rows that it sees the numbers, in order
  for (const Index t : triangles)
    for (const Index row : rows_of(from, t))
      if (row != none) rows.push_back(by.number[row]);
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  const auto place = [&](Index row) {
    return row == none ? none : static_cast<Index>(std::ranges::lower_bound(rows, by.number[row]) - rows.begin());
  };
  Packer to;
  const Element& e = from.kernel.element;
  to.put(static_cast<Index>(
      std::ranges::find_if(elements,
                           [&](const Element& other) { return other.name == e.name && other.degree == e.degree; }) -
      elements.begin()));
  to.put(rows);
  to.put(owned);
  to.put(static_cast<Index>(triangles.size()));
  for (const Index t : triangles) {
    const Material& material = material_of(from.mesh, from.scene, t);
    put(triangle(from.mesh, from.skeleton, t), from.skeleton.per_edge / 2, to);
    to.put(by.corners.of[t]);
    to.put(material);
    to.put(by.penalty / material.mu);
    for (const Index row : rows_of(from, t)) to.put(place(row));
  }
  return std::move(to).take();
}

namespace {

/// The triangles of a packed part, one after the other.
struct PackedCell {
  PackedTriangle t;
  std::array<Index, 3> corners;
  Material material;
  double a = 0;  // Penalty::a
  std::array<Index, max_skeleton> rows;
};

void get(Unpacker& from, int count, PackedCell& cell) {
  get(from, count / 6, cell.t);
  cell.corners = from.get<std::array<Index, 3>>();
  cell.material = from.get<Material>();
  cell.a = from.get<double>();
  for (int i = 0; i < count; ++i) cell.rows[i] = from.get<Index>();
}

/// The rows of all triangles, `count` each, and their corners.
/// All that the pattern of K_p needs; three edges and three corners per triangle.
struct Seams {
  std::vector<Index> rows;
  std::vector<std::array<Index, 3>> corners;
};

// For each row that one triangle alone sees here, those like it at its own edge and at the edges that share a corner
// with it: all others lie inside.
void connect_rows(const Seams& all, int per_edge, PartMatrix& part) {
  std::vector<char> seen(static_cast<std::size_t>(part.rows), 0);
  for (const Index row : all.rows)
    if (row != none) seen[row] = static_cast<char>(std::min(2, seen[row] + 1));
  // Of each corner the rows at edges that end there. Edge i of a triangle is opposite its corner i.
  std::vector<std::pair<Index, Index>> at;  // corner, row
  for (std::size_t t = 0; t < all.corners.size(); ++t)
    for (std::size_t e = 0; e < 3; ++e)
      for (std::size_t k = 0; k < static_cast<std::size_t>(per_edge); ++k)
        if (const Index row = all.rows[(3 * t + e) * static_cast<std::size_t>(per_edge) + k];
            row != none && seen[row] == 1)
          for (const std::size_t end : {1, 2}) at.emplace_back(all.corners[t][(e + end) % 3], row);
  std::ranges::sort(at);
  std::vector<std::vector<Index>> near(static_cast<std::size_t>(part.rows));
  for (auto begin = at.begin(); begin != at.end();) {
    auto end = begin;
    while (end != at.end() && end->first == begin->first) ++end;
    for (auto i = begin; i != end; ++i)
      for (auto j = begin; j != end; ++j) near[i->second].push_back(j->second);
    begin = end;
  }
  part.near_start.assign(1, 0);
  for (std::vector<Index>& rows : near) {
    std::ranges::sort(rows);
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    part.near_rows.insert(part.near_rows.end(), rows.begin(), rows.end());
    part.near_start.push_back(static_cast<Index>(part.near_rows.size()));
  }
}

// The pattern of K_p: per row the triangles that see it, then their rows.
// By counting first, so that no list of pairs is stored.
void set_pattern(const Seams& all, int count, PartMatrix& part) {
  const std::size_t rows = static_cast<std::size_t>(part.rows), width = static_cast<std::size_t>(count);
  std::vector<Index> start(rows + 1, 0), by(all.rows.size());
  for (const Index row : all.rows)
    if (row != none) ++start[static_cast<std::size_t>(row) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Index> next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < all.rows.size(); ++i)
    if (all.rows[i] != none) by[next[all.rows[i]]++] = static_cast<Index>(i / width);
  std::vector<Index> columns;
  part.start.assign(1, 0);
  for (std::size_t row = 0; row < rows; ++row) {
    columns.clear();
    for (Index i = start[row]; i < start[row + 1]; ++i)
      for (std::size_t q = 0; q < width; ++q)
        if (const Index column = all.rows[static_cast<std::size_t>(by[i]) * width + q]; column != none)
          columns.push_back(column);
    std::ranges::sort(columns);
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    part.columns.insert(part.columns.end(), columns.begin(), columns.end());
    part.start.push_back(static_cast<Index>(part.columns.size()));
  }
  part.columns.shrink_to_fit();
  part.values.assign(part.columns.size(), 0);
}

}  // namespace

// Unknowns at vertices would belong to more than two parts; unseen traces leave parts singular beyond rigid motions;
// quasi-definite matrices have no conjugate gradients.
void require_edges_alone(const Element& e) {
  if (is_mixed(e) && e.at_vertices == AtVertices::Nothing && !has_unseen_traces(e) && is_definite(e)) return;
  throw Error(Fault::Usage, fmt::format("backend \"petsc\" solves elements whose unknowns live on edges alone; \"{}\" "
                                        "is none of them: use \"bdms\", \"afw\" or \"arnold-winther-nc\", or the "
                                        "backend \"cholmod\"",
                                        e.name));
}

// The packed triangles are read twice, for the pattern and for the values: K_p exists once.
PartMatrix condensed_part(std::string_view packed) {
  use_one_thread();
  Unpacker from(packed);
  const Kernel k = kernel(elements[static_cast<std::size_t>(from.get<Index>())]);
  PartMatrix part;
  part.number = from.all<Index>();
  part.rows = static_cast<Index>(part.number.size());
  part.owned = from.get<Index>();
  const Index triangles = from.get<Index>();
  const int count = skeleton_count(k.element);
  PackedCell cell;
  {
    Seams all;
    Unpacker first = from;
    all.rows.reserve(static_cast<std::size_t>(triangles) * static_cast<std::size_t>(count));
    for (Index t = 0; t < triangles; ++t) {
      get(first, count, cell);
      all.rows.insert(all.rows.end(), cell.rows.begin(), cell.rows.begin() + count);
      all.corners.push_back(cell.corners);
    }
    set_pattern(all, count, part);
    connect_rows(all, count / 3, part);
  }
  part.shear.assign(static_cast<std::size_t>(part.rows), 0);
  for (Index t = 0; t < triangles; ++t) {
    get(from, count, cell);
    const SkeletonMatrix K = condense(k, cell.t.shape, cell.material, {}, {.a = cell.a}).K;
    for (int p = 0; p < count; ++p) {
      if (cell.rows[p] == none) continue;
      part.shear[cell.rows[p]] += cell.material.mu;
      const auto begin = part.columns.begin() + part.start[cell.rows[p]],
                 end = part.columns.begin() + part.start[cell.rows[p] + 1];
      for (int q = 0; q < count; ++q)
        if (cell.rows[q] != none)
          part.values[std::lower_bound(begin, end, cell.rows[q]) - part.columns.begin()] += K(p, q);
    }
  }
  return part;
}

double largest_diagonal(const PartMatrix& part) {
  double most = 0;
  for (Index row = 0; row < part.rows; ++row)
    for (Index p = part.start[row]; p < part.start[row + 1]; ++p)
      if (part.columns[p] == row) most = std::max(most, part.values[p]);
  return most;
}

}  // namespace kerf
