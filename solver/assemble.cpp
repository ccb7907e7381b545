#include "solver/assemble.hpp"

#include "solver/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace kerf {

namespace {

// An order of the edges with `wanted[e]` from nested dissection of the graph of vertices: an edge goes with that of its
// ends that is eliminated first, so that a separating path of vertices becomes the path of edges between them. The
// graph is three times smaller than that of the edges.
std::vector<Index> dissect_edges(const Mesh& mesh, const std::vector<bool>& wanted) {
  const Index vertices = static_cast<Index>(mesh.points.size()), edges = static_cast<Index>(mesh.edges.size());
  std::vector<Index> start(vertices + 1, 0);
  for (const auto& e : mesh.edges)
    for (const Index v : e) ++start[v + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Index> neighbours(start.back()), next(start.begin(), start.end() - 1);
  for (const auto& [a, b] : mesh.edges) {
    neighbours[next[a]++] = b;
    neighbours[next[b]++] = a;
  }
  const std::vector<Index> order = dissection(start, neighbours);
  std::vector<Index> position(vertices);
  for (Index k = 0; k < vertices; ++k) position[order[k]] = k;

  std::vector<Index> count(vertices + 1, 0), sequence;
  const auto early = [&](Index e) { return std::min(position[mesh.edges[e][0]], position[mesh.edges[e][1]]); };
  const auto late = [&](Index e) { return std::max(position[mesh.edges[e][0]], position[mesh.edges[e][1]]); };
  for (Index e = 0; e < edges; ++e)
    if (wanted[e]) ++count[early(e) + 1];
  std::partial_sum(count.begin(), count.end(), count.begin());
  sequence.resize(count.back());
  next.assign(count.begin(), count.end() - 1);
  for (Index e = 0; e < edges; ++e)
    if (wanted[e]) sequence[next[early(e)]++] = e;
  for (Index k = 0; k < vertices; ++k)
    std::sort(sequence.begin() + count[k], sequence.begin() + count[k + 1],
              [&](Index a, Index b) { return late(a) < late(b); });
  return sequence;
}

}  // namespace

Ordering order(const Mesh& mesh, const Skeleton& s) {
  const Index edges = static_cast<Index>(mesh.edges.size());
  // An edge's node holds its free base unknowns and its unbounded jumps; bounded jumps are nodes of their own.
  std::vector<bool> wanted(edges, false);
  for (Index e = 0; e < edges; ++e)
    for (int k = 0; k < s.per_edge; ++k) {
      const Index jump = s.jump[e] == none ? none : s.jump[e] + k;
      if (!s.fixed[e * s.per_edge + k] || (jump != none && !s.fixed[jump] && !s.bounded[jump])) wanted[e] = true;
    }
  const std::vector<Index> sequence = dissect_edges(mesh, wanted);

  Ordering o;
  o.row.assign(s.total, none);
  o.first.push_back(0);
  const auto number = [&o](Index unknown) {
    o.row[unknown] = o.size++;
    o.node_of.push_back(static_cast<Index>(o.first.size()) - 1);
  };
  std::vector<Index> rank(edges, none), trailing_rank(edges, none);
  for (const Index e : sequence) {
    rank[e] = static_cast<Index>(o.first.size()) - 1;
    for (int k = 0; k < s.per_edge; ++k)
      if (!s.fixed[e * s.per_edge + k]) number(e * s.per_edge + k);
    if (s.jump[e] != none)
      for (int k = 0; k < s.per_edge; ++k)
        if (!s.fixed[s.jump[e] + k] && !s.bounded[s.jump[e] + k]) number(s.jump[e] + k);
    o.first.push_back(o.size);
  }
  const Index leading = o.size;
  std::vector<Index> trailing_edges;
  for (const auto& crack : mesh.cracks)
    for (const CrackEdge& c : crack) {
      const Index before = o.size;
      for (int k = 0; k < s.per_edge; ++k) {
        const int point = c.forward ? k / 2 : s.per_edge / 2 - 1 - k / 2;  // Gauss points along the path
        const Index unknown = s.jump[c.edge] + 2 * point + k % 2;
        if (s.bounded[unknown]) number(unknown);
      }
      if (o.size == before) continue;
      trailing_rank[c.edge] = static_cast<Index>(o.first.size()) - 1;
      trailing_edges.push_back(c.edge);
      o.first.push_back(o.size);
    }
  o.trailing = o.size - leading;

  const Index nodes = static_cast<Index>(o.first.size()) - 1;
  o.adjacent_start.reserve(nodes + 1);
  o.adjacent_start.push_back(0);
  o.adjacent.reserve(std::size_t(nodes) * 2);
  std::vector<Index> near;
  const auto gather = [&](Index t, Index self) {
    for (const Index e : mesh.edges_of[t]) {
      if (rank[e] > self) near.push_back(rank[e]);
      if (trailing_rank[e] > self && mesh.sides[e][1] == t) near.push_back(trailing_rank[e]);
    }
  };
  const auto close = [&] {
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    o.adjacent.insert(o.adjacent.end(), near.begin(), near.end());
    o.adjacent_start.push_back(static_cast<Index>(o.adjacent.size()));
    near.clear();
  };
  for (const Index e : sequence) {
    for (const Index t : mesh.sides[e])
      if (t != none) gather(t, rank[e]);
    close();
  }
  for (const Index e : trailing_edges) {
    gather(mesh.sides[e][1], trailing_rank[e]);
    close();
  }
  return o;
}

ForceMoments force_of(const System& a, Index t) {
  return a.force.cols() == 0 ? ForceMoments() : ForceMoments(a.force.col(t));
}

System assemble(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Scene& scene, const Ordering& o,
                int threads) {
  System a;
  // Below this compliance plain condensation loses more than two digits: nu > 0.498 in plane strain.
  const double small = 1e-3 / scene.material.mu;
  if (scene.material.c < small) {
    a.penalty = small;
    a.traces.resize(3 * s.per_edge + 2, static_cast<Eigen::Index>(mesh.triangles.size()));
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
  // Every entry gets at most two contributions, one from each side of an edge: their sum does not depend on the order,
  // so that adding them atomically is deterministic.
  const auto add = [](double& target, double value) {
    std::atomic_ref<double>(target).fetch_add(value, std::memory_order_relaxed);
  };

  if (scene.body) a.force.resize(displacement_count(k.element), static_cast<Eigen::Index>(mesh.triangles.size()));
  Eigen::VectorXd triangles = Eigen::VectorXd::Zero(o.size);
  parallel_for(static_cast<Index>(mesh.triangles.size()), threads, [&](Index begin, Index end) {
    struct Entry {
      int local;
      Index row;
    };
    std::array<Entry, 2 * max_skeleton> entries;
    for (Index t = begin; t < end; ++t) {
      const Triangle shape = triangle(mesh, s, t);
      if (scene.body) a.force.col(t) = force_moments(k, shape, scene.body);
      Condensed c = condense(k, shape, scene.material, force_of(a, t), {a.penalty});
      if (a.penalty > 0) a.traces.col(t) << c.trace, c.own, c.by_theta;
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
          if (entries[p].local / s.per_edge == entries[q].local / s.per_edge)
            add(target, value);
          else
            target += value;
        }
      }
    }
  });

  a.F = triangles;
  const Eigen::VectorXd loads = traction_loads(mesh, k, s, scene);
  for (Index u = 0; u < s.total; ++u)
    if (o.row[u] != none) a.F[o.row[u]] += loads[u];
  return a;
}

}  // namespace kerf
