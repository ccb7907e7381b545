#include "solver/system/assemble.hpp"

#include "solver/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <span>

namespace kerf {

namespace {

// The vertices by nested dissection. Edges and corners follow them: an edge goes with that of its ends that is
// eliminated first, so that a separating path of vertices becomes the path of edges between them. The graph is three
// times smaller than that of the edges.
std::vector<Index> dissect_vertices(const Mesh& mesh) {
  const Index vertices = static_cast<Index>(mesh.points.size());
  std::vector<Index> start(vertices + 1, 0);
  for (const auto& e : mesh.edges)
    for (const Index v : e) ++start[v + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Index> neighbors(start.back()), next(start.begin(), start.end() - 1);
  for (const auto& [a, b] : mesh.edges) {
    neighbors[next[a]++] = b;
    neighbors[next[b]++] = a;
  }
  return dissection(start, neighbors);
}

// Items filed under keys 0 .. count - 1, each list in the order of filing.
struct Lists {
  std::vector<Index> start, items;
  std::span<const Index> operator[](Index key) const {
    return {items.data() + start[key], static_cast<std::size_t>(start[key + 1] - start[key])};
  }
};
Lists file_under(Index count, const std::vector<Index>& key) {  // key[i] of item i, or none
  Lists lists;
  lists.start.assign(count + 1, 0);
  for (const Index k : key)
    if (k != none) ++lists.start[k + 1];
  std::partial_sum(lists.start.begin(), lists.start.end(), lists.start.begin());
  lists.items.resize(lists.start.back());
  std::vector<Index> next(lists.start.begin(), lists.start.end() - 1);
  for (Index i = 0; i < static_cast<Index>(key.size()); ++i)
    if (key[i] != none) lists.items[next[key[i]]++] = i;
  return lists;
}

}  // namespace

Ordering order(const Mesh& mesh, const Skeleton& s, std::span<const Index> interface_edges) {
  const Index edges = static_cast<Index>(mesh.edges.size()), corners = static_cast<Index>(s.corners.vertex.size()),
              vertices = static_cast<Index>(mesh.points.size());
  const auto in_contact = [&](Index unknown) { return s.bounded[unknown] || s.frictional[unknown]; };
  // An edge's node holds its free base unknowns and its jumps without contact; jumps in contact are nodes of their own.
  const auto wanted = [&](Index e) {
    for (int k = 0; k < s.per_edge; ++k) {
      const Index jump = s.jump[e] == none ? none : s.jump[e] + k;
      if (!s.fixed[edge_unknown(s, e) + k] || (jump != none && !s.fixed[jump] && !in_contact(jump))) return true;
    }
    return false;
  };
  const std::vector<Index> sequence = dissect_vertices(mesh);
  std::vector<Index> position(vertices), early(edges, none);
  for (Index k = 0; k < vertices; ++k) position[sequence[k]] = k;
  std::vector<bool> kept(edges, false);
  for (const Index e : interface_edges) kept[e] = true;
  for (Index e = 0; e < edges; ++e)
    if (wanted(e) && !kept[e]) early[e] = std::min(position[mesh.edges[e][0]], position[mesh.edges[e][1]]);
  Lists edges_at = file_under(vertices, early);
  const auto late = [&](Index e) { return std::max(position[mesh.edges[e][0]], position[mesh.edges[e][1]]); };
  for (Index k = 0; k < vertices; ++k)
    std::sort(edges_at.items.begin() + edges_at.start[k], edges_at.items.begin() + edges_at.start[k + 1],
              [&](Index a, Index b) { return late(a) < late(b); });
  std::vector<Index> corner_position(corners, none), corner_of(Index{3} * (corners > 0 ? mesh.triangles.size() : 0));
  for (Index c = 0; c < corners; ++c) corner_position[c] = position[s.corners.vertex[c]];
  for (std::size_t i = 0; i < corner_of.size(); ++i) corner_of[i] = s.corners.of[i / 3][i % 3];
  const Lists corners_at = file_under(vertices, corner_position), around = file_under(corners, corner_of);

  Ordering o;
  o.row.assign(s.total, none);
  o.first.push_back(0);
  const auto number = [&o](Index unknown) {
    o.row[unknown] = o.size++;
    o.node_of.push_back(static_cast<Index>(o.first.size()) - 1);
  };
  std::vector<Index> rank(edges, none), corner_rank(corners, none), contact_rank(edges, none);
  struct Node {
    Index edge, corner;  // one of them none
  };
  std::vector<Node> nodes;
  for (Index k = 0; k < vertices; ++k) {
    for (const Index e : edges_at[k]) {
      rank[e] = static_cast<Index>(nodes.size());
      for (int i = 0; i < s.per_edge; ++i)
        if (!s.fixed[edge_unknown(s, e) + i]) number(edge_unknown(s, e) + i);
      if (s.jump[e] != none)
        for (int i = 0; i < s.per_edge; ++i)
          if (!s.fixed[s.jump[e] + i] && !in_contact(s.jump[e] + i)) number(s.jump[e] + i);
      nodes.push_back({e, none});
      o.first.push_back(o.size);
    }
    for (const Index c : corners_at[k]) {
      const Index before = o.size;
      for (int i = 0; i < s.per_vertex; ++i)
        if (!s.fixed[corner_unknown(s, c) + i]) number(corner_unknown(s, c) + i);
      if (o.size == before) continue;
      corner_rank[c] = static_cast<Index>(nodes.size());
      nodes.push_back({none, c});
      o.first.push_back(o.size);
    }
  }
  for (const Index e : interface_edges) {
    rank[e] = static_cast<Index>(nodes.size());
    for (int i = 0; i < s.per_edge; ++i)
      if (!s.fixed[edge_unknown(s, e) + i]) number(edge_unknown(s, e) + i), ++o.interface_rows;
    nodes.push_back({e, none});
    o.first.push_back(o.size);
  }
  const Index leading = o.size, leading_nodes = static_cast<Index>(nodes.size());
  for (const auto& crack : mesh.cracks)
    for (const CrackEdge& c : crack) {
      if (s.jump[c.edge] == none) continue;
      const Index before = o.size;
      for (int k = 0; k < s.per_edge; ++k) {
        const int point = c.forward ? k / 2 : s.per_edge / 2 - 1 - k / 2;  // Gauss points along the path
        const Index unknown = s.jump[c.edge] + 2 * point + k % 2;
        if (in_contact(unknown)) number(unknown);
      }
      if (o.size == before) continue;
      contact_rank[c.edge] = static_cast<Index>(nodes.size());
      nodes.push_back({c.edge, none});
      o.first.push_back(o.size);
    }
  o.contact_rows = o.size - leading;

  o.adjacent_start.reserve(nodes.size() + 1);
  o.adjacent_start.push_back(0);
  o.adjacent.reserve(2 * nodes.size());
  std::vector<Index> near;
  const auto gather = [&](Index t, Index self) {
    for (int i = 0; i < 3; ++i) {
      const Index e = mesh.edges_of[t][i];
      if (rank[e] > self) near.push_back(rank[e]);
      if (contact_rank[e] > self && mesh.sides[e][1] == t) near.push_back(contact_rank[e]);
      if (corners > 0 && corner_rank[s.corners.of[t][i]] > self) near.push_back(corner_rank[s.corners.of[t][i]]);
    }
  };
  for (Index n = 0; n < static_cast<Index>(nodes.size()); ++n) {
    if (n >= leading_nodes)
      gather(mesh.sides[nodes[n].edge][1], n);
    else if (nodes[n].corner == none)
      for (const Index t : mesh.sides[nodes[n].edge]) {
        if (t != none) gather(t, n);
      }
    else
      for (const Index place : around[nodes[n].corner]) gather(place / 3, n);
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    o.adjacent.insert(o.adjacent.end(), near.begin(), near.end());
    o.adjacent_start.push_back(static_cast<Index>(o.adjacent.size()));
    near.clear();
  }
  return o;
}

// The local problems of displacement elements are not mixed, those with stresses at vertices do not degenerate.
constexpr bool needs_penalty(const Element& e) {
  return e.at_vertices == AtVertices::Nothing || e.at_vertices == AtVertices::Rotation;
}

// See ForceMoments.
Eigen::Matrix<double, cubic_trace_count, 1> cubic_traces(const Mesh& mesh, const Scene& scene, Index t) {
  static const EdgeRule rule = gauss(8);
  Eigen::Matrix<double, cubic_trace_count, 1> coefficients = Eigen::Matrix<double, cubic_trace_count, 1>::Zero();
  for (int i = 0; i < 3; ++i) {
    const Index e = mesh.edges_of[t][i];
    for (const Support& support : scene.supports) {
      if (mesh.label[e] != support.label) continue;
      const Vec2& a = mesh.points[mesh.edges[e][0]];
      const Vec2 side = mesh.points[mesh.edges[e][1]] - a;
      const Vec2 n = mesh.sides[e][1] == none ? normal(mesh, e) : Vec2(-normal(mesh, e));
      for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
        Vec2 value = support.value(a + rule.s[q] * side, n);
        if (!support.first) value[0] = 0;
        if (!support.second) value[1] = 0;
        if (support.normal_frame) value = value[0] * n + value[1] * Vec2(-n.y(), n.x());
        for (int k = 2; k < 4; ++k)
          coefficients.segment<2>(4 * i + 2 * (k - 2)) += rule.w[q] * legendre(k, rule.s[q]) * value;
      }
    }
  }
  return coefficients;
}

ForceMoments force_of(const System& a, Index t) {
  return a.force.cols() == 0 ? ForceMoments() : ForceMoments(a.force.col(t));
}

System assemble(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Scene& scene, const Ordering& o,
                int threads, bool plain) {
  System a;
  // Below this compliance c mu plain condensation loses more than two digits: nu > 0.498 in plane strain.
  constexpr double small = 1e-3, floor = 1e-6;
  double softest = scene.material.mu, stiffest = softest, least = softest * scene.material.c;
  for (const Material& m : scene.regions) {
    softest = std::min(softest, m.mu);
    stiffest = std::max(stiffest, m.mu);
    least = std::min(least, m.c * m.mu);
  }
  if (!plain && least < small && needs_penalty(k.element)) {
    // One a for all materials, so that a uniform pressure stays one mode. The iterations shrink the error by about a/(a
    // + 1/mu) with the mu of what confines the pressure: a is small for the stiffest. The softest loses digits like
    // 1/(a mu): six at most; from a contrast of 1e3 on the iterations get slower instead.
    a.penalty = std::max(small / stiffest, floor / softest);
    a.traces.resize(skeleton_count(k.element) + 2, static_cast<Eigen::Index>(mesh.triangles.size()));
  }
  const Index nodes = static_cast<Index>(o.first.size()) - 1;

  // Columns of one node have the rows of the node from the diagonal down, then those of the adjacent nodes.
  a.K.size = o.size;
  std::int64_t count = 0;
  for (Index n = 0; n < nodes; ++n) {
    const std::int64_t width = o.first[n + 1] - o.first[n];
    std::int64_t below = 0;
    for (Index p = o.adjacent_start[n]; p < o.adjacent_start[n + 1]; ++p)
      below += o.first[o.adjacent[p] + 1] - o.first[o.adjacent[p]];
    count += width * (width + 1) / 2 + width * below;
  }
  if (count > std::numeric_limits<Index>::max())
    throw Error(Fault::Numerics, "the condensed matrix has too many entries; use a coarser mesh (mesh.size)");
  a.K.start.resize(o.size + 1);
  a.K.rows.resize(count);
  a.K.values.resize(count);
  Index* column_start = a.K.start.data();
  Index* rows = a.K.rows.data();
  double* values = a.K.values.data();
  column_start[0] = 0;
  for (Index n = 0; n < nodes; ++n)
    for (Index j = o.first[n]; j < o.first[n + 1]; ++j) {
      Index p = column_start[j];
      for (Index i = j; i < o.first[n + 1]; ++i) rows[p++] = i;
      for (Index q = o.adjacent_start[n]; q < o.adjacent_start[n + 1]; ++q)
        for (Index i = o.first[o.adjacent[q]]; i < o.first[o.adjacent[q] + 1]; ++i) rows[p++] = i;
      column_start[j + 1] = p;
    }

  const auto place = [&](Index row, Index column) -> double& {
    const Index n = o.node_of[column], m = o.node_of[row];
    if (m == n) return values[column_start[column] + row - column];
    Index p = column_start[column] + o.first[n + 1] - column;
    for (Index q = o.adjacent_start[n];; ++q) {
      const Index other = o.adjacent[q];
      if (other == m) return values[p + row - o.first[m]];
      p += o.first[other + 1] - o.first[other];
    }
  };
  // Without unknowns at vertices every entry gets at most two contributions, one from each side of an edge: their sum
  // does not depend on the order, so that adding them atomically is deterministic. With them, triangles are condensed
  // in parallel but added in their order.
  const bool ordered = s.per_vertex > 0;
  const auto add = [](double& target, double value) {
    std::atomic_ref<double>(target).fetch_add(value, std::memory_order_relaxed);
  };

  const bool with_edges = k.element.at_vertices == AtVertices::Stress;
  const int moments = displacement_count(k.element);
  if (scene.body || with_edges)
    a.force.setZero(moments + (with_edges ? cubic_trace_count : 0), static_cast<Eigen::Index>(mesh.triangles.size()));
  Eigen::VectorXd triangles = Eigen::VectorXd::Zero(o.size);
  const auto condense_triangle = [&](Index t) {
    const Triangle shape = triangle(mesh, s, t);
    if (scene.body) a.force.col(t).head(moments) = force_moments(k, shape, scene.body);
    if (with_edges) a.force.col(t).tail<cubic_trace_count>() = cubic_traces(mesh, scene, t);
    Condensed c = condense(k, shape, material_of(mesh, scene, t), force_of(a, t), {a.penalty});
    if (a.penalty > 0) a.traces.col(t) << c.trace, c.own, c.by_theta;
    return c;
  };
  const auto scatter = [&](Index t, Condensed& c) {
    struct Entry {
      int local;
      Index row;
    };
    std::array<Entry, 2 * max_skeleton> entries;
    const Seen view = seen(mesh, s, t);
    int used = 0;
    for (int i = 0; i < view.count; ++i) {
      const double value = s.prescribed[view.base[i]];  // jumps are prescribed as 0 only
      if (value != 0) c.F -= value * c.K.col(i);
      if (o.row[view.base[i]] != none) entries[used++] = {i, o.row[view.base[i]]};
      if (view.jump[i] != none && o.row[view.jump[i]] != none) entries[used++] = {i, o.row[view.jump[i]]};
    }
    for (int p = 0; p < used; ++p) {
      add(triangles[entries[p].row], c.F[entries[p].local]);
      for (int q = 0; q < used; ++q) {
        if (entries[p].row < entries[q].row) continue;
        double& target = place(entries[p].row, entries[q].row);
        const double value = c.K(entries[p].local, entries[q].local);
        // Only a base unknown's own edge is shared by two triangles.
        if (!ordered && entries[p].local / s.per_edge == entries[q].local / s.per_edge)
          add(target, value);
        else
          target += value;
      }
    }
  };
  const Index count_triangles = static_cast<Index>(mesh.triangles.size());
  if (!ordered) {
    parallel_for(count_triangles, threads, [&](Index begin, Index end) {
      for (Index t = begin; t < end; ++t) {
        Condensed c = condense_triangle(t);
        scatter(t, c);
      }
    });
  } else {
    constexpr Index batch = 2048;
    std::vector<Condensed> condensed(batch);
    for (Index from = 0; from < count_triangles; from += batch) {
      const Index size = std::min(batch, count_triangles - from);
      parallel_for(size, threads, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) condensed[i] = condense_triangle(from + i);
      });
      for (Index i = 0; i < size; ++i) scatter(from + i, condensed[i]);
    }
  }

  a.F = triangles;
  const Eigen::VectorXd loads = traction_loads(mesh, k, s, scene);
  for (Index u = 0; u < s.total; ++u)
    if (o.row[u] != none) a.F[o.row[u]] += loads[u];
  return a;
}

}  // namespace kerf
