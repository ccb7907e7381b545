// Pieces of a mesh as meshes of their own, and a body put together with the balls that fill its holes. Vertices keep
// their relative order, so that every edge keeps its direction and unknowns on edges can be copied without a change of
// sign. A ball meets the body at the n vertices of its hole, found by their coordinates, which are the same numbers in
// both; the edges of that rim lose their labels. Labels, cracks in the order of their paths, regions and arcs carry
// over. Cracks of balls (slits) count behind those of the body.

#include "geometry/part.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

namespace kerf {

namespace {

using Ends = std::pair<Index, Index>;

// Labels and cracks (in path order) of the edges for which `vertex` knows both ends.
void carry_marks(const Mesh& mesh, const std::vector<Index>& vertex, const std::vector<bool>& wanted,
                 std::vector<Marked>& marked) {
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (wanted[e] && mesh.label[e] != none)
      marked.push_back({.a = vertex[mesh.edges[e][0]], .b = vertex[mesh.edges[e][1]], .label = mesh.label[e]});
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c)
    for (const CrackEdge& k : mesh.cracks[c]) {
      if (!wanted[k.edge]) continue;
      const auto& [a, b] = mesh.edges[k.edge];
      marked.push_back(
          {.a = vertex[k.forward ? a : b], .b = vertex[k.forward ? b : a], .crack = static_cast<Index>(c)});
    }
}

std::map<Ends, Index> by_ends(const Mesh& mesh) {
  std::map<Ends, Index> edge;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    edge[{mesh.edges[e][0], mesh.edges[e][1]}] = static_cast<Index>(e);
  return edge;
}

/// Edge e of a mesh bows out as edge `of` of another, which goes the same way.
void carry_arc(const Mesh& from, Index of, Mesh& to, Index e) {
  if (from.arc.empty() || from.arc[of] == none) return;
  to.arc.resize(to.edges.size(), none);
  to.arc[e] = static_cast<Index>(to.arcs.size());
  to.arcs.push_back(from.arcs[from.arc[of]]);
}

Ends ends(Index a, Index b) {
  return {std::min(a, b), std::max(a, b)};
}

/// The body with the balls put in so far.
struct Filler {
  const Mesh& outside;
  std::vector<Vec2> points = outside.points;
  std::vector<std::array<Index, 3>> triangles = outside.triangles;
  std::vector<Index> region = outside.region;
  std::vector<bool> keep = std::vector<bool>(outside.edges.size(), true);  // not between body and ball
  std::vector<std::vector<Index>> number = {};                             // per ball, its vertices in the whole
  const std::map<Ends, Index> edge_of = by_ends(outside);
  const std::map<std::pair<double, double>, Index> at = boundary_vertices();

  std::map<std::pair<double, double>, Index> boundary_vertices() const {
    std::map<std::pair<double, double>, Index> at;
    for (std::size_t e = 0; e < outside.edges.size(); ++e)
      if (outside.label[e] != none)
        for (const Index v : outside.edges[e]) at[{outside.points[v].x(), outside.points[v].y()}] = v;
    return at;
  }

  /// The ball's first vertices are those of the hole, the rest is new.
  std::vector<Index> number_vertices(const BallMesh& ball) {
    std::vector<Index> vertex(ball.mesh.points.size());
    for (std::size_t v = 0; v < vertex.size(); ++v) {
      const Vec2& x = ball.mesh.points[v];
      if (v >= ball.contour[0].size()) {
        vertex[v] = static_cast<Index>(points.size());
        points.push_back(x);
        continue;
      }
      const auto found = at.find({x.x(), x.y()});
      if (found == at.end()) throw std::invalid_argument("fill: the ball's boundary is not in the mesh");
      vertex[v] = found->second;
    }
    return vertex;
  }

  void open_boundary(const std::vector<Index>& vertex, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      const auto found = edge_of.find(ends(vertex[i], vertex[(i + 1) % n]));
      if (found == edge_of.end()) throw std::invalid_argument("fill: the ball's boundary was split");
      keep[found->second] = false;
    }
  }

  void add(const BallMesh& ball) {
    std::vector<Index> vertex = number_vertices(ball);
    open_boundary(vertex, ball.contour[0].size());
    if (!region.empty()) {  // that around the ball
      const auto& sides = outside.sides[edge_of.at(ends(vertex[0], vertex[1]))];
      const Index around = outside.region[sides[0] == none ? sides[1] : sides[0]];
      region.insert(region.end(), ball.mesh.triangles.size(), around);
    }
    for (const auto& v : ball.mesh.triangles) triangles.push_back({vertex[v[0]], vertex[v[1]], vertex[v[2]]});
    number.push_back(std::move(vertex));
  }

  /// Labels and cracks of the body, then the slits of the balls.
  std::vector<Marked> marks(const std::vector<BallMesh>& balls) const {
    std::vector<Index> same(outside.points.size());
    for (std::size_t v = 0; v < same.size(); ++v) same[v] = static_cast<Index>(v);
    std::vector<Marked> marked;
    carry_marks(outside, same, keep, marked);
    for (std::size_t b = 0; b < balls.size(); ++b)
      for (std::size_t c = 0; c < balls[b].mesh.cracks.size(); ++c)
        for (const CrackEdge& k : balls[b].mesh.cracks[c]) {
          const auto& [from, to] = balls[b].mesh.edges[k.edge];
          marked.push_back({.a = number[b][k.forward ? from : to],
                            .b = number[b][k.forward ? to : from],
                            .crack = static_cast<Index>(outside.cracks.size() + c)});
        }
    return marked;
  }
};

/// Per contour of the ball its edges in the whole.
std::vector<std::vector<Index>> contours_in(const std::map<Ends, Index>& edge_of, const BallMesh& ball,
                                            const std::vector<Index>& number) {
  std::vector<std::vector<Index>> contours;
  for (const auto& contour : ball.contour) {
    auto& edges = contours.emplace_back();
    for (const Index e : contour) {
      const auto& [from, to] = ball.mesh.edges[e];
      edges.push_back(edge_of.at(ends(number[from], number[to])));
    }
  }
  return contours;
}

}  // namespace

/// A crack that the part does not touch keeps its number and has no edges.
Part part(const Mesh& whole, const std::vector<bool>& use) {
  Part p;
  std::vector<bool> seen_vertex(whole.points.size(), false), seen_edge(whole.edges.size(), false);
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    if (!use[t]) continue;
    p.triangle.push_back(static_cast<Index>(t));
    for (const Index v : whole.triangles[t]) seen_vertex[v] = true;
    for (const Index e : whole.edges_of[t]) seen_edge[e] = true;
  }
  std::vector<Index> vertex(whole.points.size(), none);
  std::vector<Vec2> points;
  for (std::size_t v = 0; v < vertex.size(); ++v)
    if (seen_vertex[v]) {
      vertex[v] = static_cast<Index>(points.size());
      points.push_back(whole.points[v]);
    }
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Index> region;
  for (const Index t : p.triangle) {
    const auto& v = whole.triangles[t];
    triangles.push_back({vertex[v[0]], vertex[v[1]], vertex[v[2]]});
    if (!whole.region.empty()) region.push_back(whole.region[t]);
  }
  std::vector<Marked> marked;
  carry_marks(whole, vertex, seen_edge, marked);
  p.mesh = connect(std::move(points), std::move(triangles), marked, std::move(region));
  p.mesh.cracks.resize(whole.cracks.size());
  p.edge.resize(p.mesh.edges.size());
  for (std::size_t t = 0; t < p.triangle.size(); ++t)
    for (int i = 0; i < 3; ++i) p.edge[p.mesh.edges_of[t][i]] = whole.edges_of[p.triangle[t]][i];
  for (std::size_t e = 0; e < p.edge.size(); ++e) carry_arc(whole, p.edge[e], p.mesh, static_cast<Index>(e));
  return p;
}

Mesh part_without_cracks(Mesh whole, const std::vector<bool>& use) {
  whole.cracks.clear();
  std::ranges::fill(whole.crack, none);
  return part(whole, use).mesh;
}

/// The ball's own label on its boundary is lost with the hole's; its slit becomes a crack behind those of the body.
Filled fill(const Mesh& outside, const std::vector<BallMesh>& balls) {
  Filler filler{outside};
  Filled filled;
  for (const BallMesh& ball : balls) {
    filled.first_triangle.push_back(static_cast<Index>(filler.triangles.size()));
    filler.add(ball);
  }
  filled.first_triangle.push_back(static_cast<Index>(filler.triangles.size()));
  const std::vector<Marked> marked = filler.marks(balls);
  filled.mesh = connect(std::move(filler.points), std::move(filler.triangles), marked, std::move(filler.region));
  if (filled.mesh.cracks.size() < outside.cracks.size()) filled.mesh.cracks.resize(outside.cracks.size());
  const std::map<Ends, Index> edge_of = by_ends(filled.mesh);
  for (std::size_t e = 0; e < outside.arc.size(); ++e)
    if (const auto found = edge_of.find({outside.edges[e][0], outside.edges[e][1]}); found != edge_of.end())
      carry_arc(outside, static_cast<Index>(e), filled.mesh, found->second);
  for (std::size_t b = 0; b < balls.size(); ++b) {
    filled.contour.push_back(contours_in(edge_of, balls[b], filler.number[b]));
    for (std::size_t k = 1; k < balls[b].contour.size(); ++k)
      for (std::size_t i = 0; i < balls[b].contour[k].size(); ++i)
        carry_arc(balls[b].mesh, balls[b].contour[k][i], filled.mesh, filled.contour[b][k][i]);
  }
  return filled;
}

}  // namespace kerf
