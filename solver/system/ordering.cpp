// The order of elimination: nested dissection (METIS) of the graph of the vertices, from which edges and corners
// follow. An edge goes with that end which is eliminated first, so that a separating path of vertices becomes the path
// of edges between them; that graph is three times smaller than the one of the edges. The free unknowns of an edge
// (with its jumps that no contact law acts on) or of a corner are one node, eliminated together. Last come the base
// unknowns of an interface, then the jumps in contact along the cracks' paths: their block of the factor is the
// Cholesky factor of S [theory: C.7]. Nodes are coupled when a triangle sees both. docs/theory/elements.md, section The
// factor.

#include "solver/system/ordering.hpp"

#include "solver/factor.hpp"
#include "solver/moved.hpp"
#include "solver/system/lists.hpp"

#include <algorithm>
#include <numeric>

namespace kerf {

namespace {

// Per vertex when it is eliminated. Edges and corners follow their vertices: an edge goes with that of its ends that is
// eliminated first, so that a separating path of vertices becomes the path of edges between them. The graph is three
// times smaller than that of the edges.
std::vector<Index> positions(std::span<const Index> sequence) {
  std::vector<Index> position(sequence.size());
  for (std::size_t k = 0; k < sequence.size(); ++k) position[sequence[k]] = static_cast<Index>(k);
  return position;
}

// Rows on which a law acts, or that hold a free slide (`sliding`): the rows of the small problem.
bool in_contact(const Skeleton& s, Index unknown) {
  return s.bounded[unknown] || s.frictional[unknown] || s.sliding[unknown];
}

// An edge's node holds its free base unknowns and its jumps without contact: whether there are any.
bool has_node(const Skeleton& s, Index e) {
  for (int k = 0; k < s.per_edge; ++k) {
    const Index jump = s.jump[e] == none ? none : s.jump[e] + k;
    if (!s.fixed[edge_unknown(s, e) + k] || (jump != none && !s.fixed[jump] && !in_contact(s, jump))) return true;
  }
  return false;
}

// The edges that go with each position in the sequence of vertices, those whose other end comes soon first.
Lists edges_in_sequence(const Mesh& mesh, const Skeleton& s, const std::vector<Index>& position,
                        std::span<const Index> interface_edges) {
  const auto end = [&](Index e, int k) { return position[mesh.edges[e][k]]; };
  const auto late = [&](Index e) { return std::max(end(e, 0), end(e, 1)); };
  const Index edges = static_cast<Index>(mesh.edges.size()), vertices = static_cast<Index>(position.size());
  std::vector<Index> early(edges, none);
  for (Index e = 0; e < edges; ++e)
    if (has_node(s, e)) early[e] = std::min(end(e, 0), end(e, 1));
  for (const Index e : interface_edges) early[e] = none;
  Lists at = file_under(vertices, early);
  for (Index k = 0; k < vertices; ++k)
    std::sort(at.items.begin() + at.start[k], at.items.begin() + at.start[k + 1],
              [&](Index a, Index b) { return late(a) < late(b); });
  return at;
}

Lists corners_in_sequence(const Skeleton& s, const std::vector<Index>& position) {
  std::vector<Index> of_corner(s.corners.vertex.size());
  for (std::size_t c = 0; c < of_corner.size(); ++c) of_corner[c] = position[s.corners.vertex[c]];
  return file_under(static_cast<Index>(position.size()), of_corner);
}

// What is eliminated together: unknowns of an edge, of a corner, or the jumps in contact of an edge.
struct Node {
  Index edge = none, corner = none;
  bool contact = false;
};

// An ordering in the making, node by node.
class Numbering {
 public:
  Numbering(const Mesh& mesh, const Skeleton& s)
      : mesh_(mesh),
        s_(s),
        of_edge_(mesh.edges.size(), none),
        of_contact_(mesh.edges.size(), none),
        of_corner_(s.corners.vertex.size(), none) {
    ordering_.row.assign(s.total, none);
    ordering_.first.push_back(0);
  }

  void add_edge(Index e) {
    number_base(e);
    if (s_.jump[e] != none)
      for (int i = 0; i < s_.per_edge; ++i)
        if (!s_.fixed[s_.jump[e] + i] && !in_contact(s_, s_.jump[e] + i)) number(s_.jump[e] + i);
    of_edge_[e] = finish({.edge = e});
  }

  void add_corner(Index c) {
    for (int i = 0; i < s_.per_vertex; ++i)
      if (!s_.fixed[corner_unknown(s_, c) + i]) number(corner_unknown(s_, c) + i);
    if (!empty()) of_corner_[c] = finish({.corner = c});
  }

  void add_interface(Index e) {
    const Index before = ordering_.size;
    number_base(e);
    ordering_.interface_rows += ordering_.size - before;
    of_edge_[e] = finish({.edge = e});
  }

  // Contact rows follow the path of their crack, so that neighbors in S are neighbors on the crack.
  void add_contact(const CrackEdge& c) {
    if (s_.jump[c.edge] == none) return;
    const Index before = ordering_.size;
    for (int k = 0; k < s_.per_edge; ++k) {
      const int point = c.forward ? k / 2 : s_.per_edge / 2 - 1 - k / 2;  // Gauss points along the path
      const Index unknown = s_.jump[c.edge] + 2 * point + k % 2;
      if (in_contact(s_, unknown)) number(unknown);
    }
    ordering_.contact_rows += ordering_.size - before;
    if (!empty()) of_contact_[c.edge] = finish({.edge = c.edge, .contact = true});
  }

  // Nodes are coupled when a triangle sees both; what it sees on top of the left side of a crack are the jumps on its
  // right.
  Ordering couple() && {
    const Lists around = corner_places();
    Ordering& o = ordering_;
    o.adjacent_start.reserve(nodes_.size() + 1);
    o.adjacent_start.push_back(0);
    o.adjacent.reserve(2 * nodes_.size());
    std::vector<Index> near;
    for (Index n = 0; n < static_cast<Index>(nodes_.size()); ++n) {
      near.clear();
      if (nodes_[n].contact)
        gather(mesh_.sides[nodes_[n].edge][1], n, near);
      else if (nodes_[n].corner == none)
        for (const Index t : mesh_.sides[nodes_[n].edge]) {
          if (t != none) gather(t, n, near);
        }
      else
        for (const Index place : around[nodes_[n].corner]) gather(place / 3, n, near);
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      o.adjacent.insert(o.adjacent.end(), near.begin(), near.end());
      o.adjacent_start.push_back(static_cast<Index>(o.adjacent.size()));
    }
    return std::move(o);
  }

 private:
  void number(Index unknown) {
    ordering_.row[unknown] = ordering_.size++;
    ordering_.node_of.push_back(static_cast<Index>(nodes_.size()));
  }
  void number_base(Index e) {
    for (int i = 0; i < s_.per_edge; ++i)
      if (!s_.fixed[edge_unknown(s_, e) + i]) number(edge_unknown(s_, e) + i);
  }
  // Whether the node in the making has no unknowns so far.
  bool empty() const {
    return ordering_.size == ordering_.first.back();
  }
  Index finish(const Node& node) {
    nodes_.push_back(node);
    ordering_.first.push_back(ordering_.size);
    return static_cast<Index>(nodes_.size()) - 1;
  }
  // Where each corner is one of a triangle's three: place / 3 is the triangle.
  Lists corner_places() const {
    std::vector<Index> corner;
    for (const auto& of : s_.corners.of) corner.insert(corner.end(), of.begin(), of.end());
    return file_under(static_cast<Index>(of_corner_.size()), corner);
  }
  // The nodes behind `self` that triangle t sees.
  void gather(Index t, Index self, std::vector<Index>& near) const {
    for (int i = 0; i < 3; ++i) {
      const Index e = mesh_.edges_of[t][i];
      if (of_edge_[e] > self) near.push_back(of_edge_[e]);
      if (of_contact_[e] > self && mesh_.sides[e][1] == t) near.push_back(of_contact_[e]);
      if (of_corner_.empty()) continue;
      const Index corner = of_corner_[s_.corners.of[t][i]];
      if (corner > self) near.push_back(corner);
    }
  }

  const Mesh& mesh_;
  const Skeleton& s_;
  Ordering ordering_;
  std::vector<Node> nodes_;
  std::vector<Index> of_edge_, of_contact_, of_corner_;  // the node of each, or none
};

}  // namespace

std::vector<Index> vertex_sequence(const Mesh& mesh, int threads) {
  std::vector<Index> start(mesh.points.size() + 1, 0);
  for (const auto& e : mesh.edges)
    for (const Index v : e) ++start[v + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Index> neighbors(start.back()), next(start.begin(), start.end() - 1);
  for (const auto& [a, b] : mesh.edges) {
    neighbors[next[a]++] = b;
    neighbors[next[b]++] = a;
  }
  return dissection(start, neighbors, threads);
}

// A function of topology, fixed unknowns and contact rows alone, so that loads and moved vertices reuse it.
Ordering order(const Mesh& mesh, const Skeleton& s, std::span<const Index> interface_edges, int threads,
               std::span<const Index> sequence) {
  const std::vector<Index> position = positions(sequence.empty() ? vertex_sequence(mesh, threads) : sequence);
  const Lists edges = edges_in_sequence(mesh, s, position, interface_edges), corners = corners_in_sequence(s, position);
  Numbering numbering(mesh, s);
  for (Index k = 0; k < static_cast<Index>(position.size()); ++k) {
    for (const Index e : edges[k]) numbering.add_edge(e);
    for (const Index c : corners[k]) numbering.add_corner(c);
  }
  for (const Index e : interface_edges) numbering.add_interface(e);
  for (const auto& crack : mesh.cracks)
    for (const CrackEdge& c : crack) numbering.add_contact(c);
  return std::move(numbering).couple();
}

Ordering as_numbered(const Skeleton& s, const std::vector<bool>* held) {
  Ordering o;
  o.row.assign(static_cast<std::size_t>(s.total), none);
  for (const bool contact : {false, true})
    for (Index u = 0; u < s.total; ++u) {
      if (s.fixed[u] || in_contact(s, u) != contact || (contact && held && (*held)[u])) continue;
      o.row[u] = o.size++;
      if (contact && !held) ++o.contact_rows;
    }
  return o;
}

}  // namespace kerf
