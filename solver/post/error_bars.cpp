// Error bars of a quantity T at corners and centroids from a better solution T_b, one order more with as many unknowns,
//   half width = max(1.5 |T - T_b|, 1.3 times its typical size in two rings of triangles)      [theory: R.9].
// If the better error is at most a third of the error e, then |T - T_b| >= 2/3 e. The second term is for points where
// the difference changes sign. Also here: the sizes of the better mesh and the places where both are compared. Nothing
// is guaranteed: the factors are measured. See "Error bars" in docs/theory/recovery_and_estimates.md.

#include "solver/error_bars.hpp"

#include "solver/post/blend.hpp"
#include "solver/system.hpp"

#include <cmath>

namespace kerf {

namespace {

// Measured on 31 exact solutions on two meshes each: 95.6 % of the points are covered, of all but one 98.9 %.
constexpr double own = 1.5, of_neighbors = 1.3;

/// Means over the triangles at each corner of a quantity per triangle.
/// Corners, not vertices: values on the two faces of a crack do not mix.
Eigen::VectorXd corner_means(const Corners& c, const Eigen::VectorXd& of_triangle) {
  const Eigen::Index corners = static_cast<Eigen::Index>(c.vertex.size());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(corners), count = Eigen::VectorXd::Zero(corners);
  for (std::size_t t = 0; t < c.of.size(); ++t)
    for (const Index i : c.of[t]) {
      sum[i] += of_triangle[static_cast<Eigen::Index>(t)];
      count[i] += 1;
    }
  return sum.cwiseQuotient(count.cwiseMax(1));
}

/// With corner_means one ring further each time.
Eigen::VectorXd triangle_means(const Corners& c, const Eigen::VectorXd& of_corner) {
  Eigen::VectorXd mean(static_cast<Eigen::Index>(c.of.size()));
  for (std::size_t t = 0; t < c.of.size(); ++t)
    mean[static_cast<Eigen::Index>(t)] = (of_corner[c.of[t][0]] + of_corner[c.of[t][1]] + of_corner[c.of[t][2]]) / 3;
  return mean;
}

}  // namespace

/// Per vertex the mean length of its edges over a factor: 8 at singular corners, 4 along curves that the mesh draws as
/// chords. A turn above 1e-6 is more than rounding, one below 0.4 is no corner.
std::vector<double> better_sizes(const Mesh& mesh, const Corners& c, const std::vector<bool>& singular, double longer) {
  constexpr double at_singular = 8, at_curved = 4;
  std::vector<double> size(mesh.points.size(), 0), count(mesh.points.size(), 0);
  // Two edges of the boundary or of a crack that meet at a small angle belong to a curve.
  std::vector<Vec2> along(mesh.points.size(), Vec2::Zero());
  std::vector<bool> curved(mesh.points.size(), false);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const Index edge = static_cast<Index>(e);
    const Vec2 direction = tangent(mesh, edge);
    const bool follows = !mesh.arc.empty() && mesh.arc[e] != none;
    const bool marked = !follows && (mesh.sides[e][0] == none || mesh.sides[e][1] == none || mesh.crack[e] != none);
    for (const Index v : mesh.edges[e]) {
      size[v] += length(mesh, edge);
      count[v] += 1;
      if (!marked) continue;
      const double turn = std::abs(along[v].x() * direction.y() - along[v].y() * direction.x());
      curved[v] = curved[v] || (turn > 1e-6 && turn < 0.4);
      along[v] = direction;
    }
  }
  std::vector<double> shorter(size.size(), 1 / longer);
  for (std::size_t v = 0; v < size.size(); ++v)
    if (curved[v]) shorter[v] = at_curved;
  for (std::size_t i = 0; i < c.vertex.size(); ++i)
    if (singular[i]) shorter[c.vertex[i]] = at_singular * (curved[c.vertex[i]] ? at_curved : 1);
  for (std::size_t v = 0; v < size.size(); ++v) size[v] /= std::max(count[v], 1.0) * shorter[v];
  return size;
}

/// A corner has a point in each of the triangles that share it; one of them is taken, the last. Where the better mesh
/// has no triangle at a point (beside a curved side that it draws otherwise) the nearest one is taken.
Places places(const Mesh& mesh, const Corners& c, const Mesh& better) {
  constexpr double inwards = 0.02;  // so that it is clear on which side of a crack a point lies
  Places p;
  p.x.resize(c.vertex.size());
  p.own.resize(c.vertex.size());
  for (std::size_t t = 0; t < c.of.size(); ++t)
    for (const Index i : c.of[t]) p.own[i] = static_cast<Index>(t);
  for (std::size_t i = 0; i < c.vertex.size(); ++i)
    p.x[i] = (1 - inwards) * mesh.points[c.vertex[i]] + inwards * centroid(mesh, p.own[i]);
  for (std::size_t t = 0; t < c.of.size(); ++t) {
    p.x.push_back(centroid(mesh, static_cast<Index>(t)));
    p.own.push_back(static_cast<Index>(t));
  }
  p.better = locate(better, p.x);
  const Locator locator = make_locator(better);
  for (std::size_t i = 0; i < p.x.size(); ++i)
    if (p.better[i] == none) p.better[i] = nearest_triangle(better, locator, p.x[i]);
  return p;
}

/// `values` and `better`: corners first, then centroids, as Places has them.
ErrorBars error_bars(const Corners& c, const Eigen::VectorXd& values, const Eigen::VectorXd& better) {
  const auto corners = static_cast<Eigen::Index>(c.vertex.size()), triangles = static_cast<Eigen::Index>(c.of.size());
  const Eigen::VectorXd difference = (values - better).cwiseAbs(), root = difference.cwiseSqrt();
  // Means of square roots, so that the large differences next to singular points do not reach far.
  const Eigen::VectorXd in_triangles = 0.5 * (root.tail(triangles) + triangle_means(c, root.head(corners)));
  const Eigen::VectorXd around = corner_means(c, triangle_means(c, corner_means(c, in_triangles)));
  ErrorBars bars;
  bars.around = around.cwiseAbs2();
  bars.at_corners = (own * difference.head(corners)).cwiseMax(of_neighbors * bars.around);
  bars.at_centroids = (own * difference.tail(triangles)).cwiseMax(of_neighbors * triangle_means(c, around).cwiseAbs2());
  return bars;
}

/// The means around the three corners, blended as roots like the means themselves.
double half_width_at(const Mesh& mesh, const Corners& c, const ErrorBars& bars, const PointIn& at, double difference) {
  const Shares share = shares_at(mesh, at);
  double root = 0;
  for (int i = 0; i < 3; ++i) root += share.of[i] * std::sqrt(bars.around[c.of[at.triangle][i]]);
  root = std::max(0.0, root / share.whole);
  return std::max(own * std::abs(difference), of_neighbors * root * root);
}

/// The element of degree k has the order k + 1, one more than e.
const Element& better_element(const Element& e) {
  require(e, can_be_bettered);
  return element("bdms", e.order);
}

/// As many unknowns: edges of the better mesh are longer by the root of the ratio of unknowns per edge.
double longer_edges(const Element& own) {
  // The unknowns of mixed elements are on edges, one and a half per triangle; others keep theirs elsewhere.
  if (!is_mixed(own) || per_edge(own) == 0) return 1;
  return std::sqrt(std::max(1.0, static_cast<double>(per_edge(better_element(own))) / per_edge(own)));
}

}  // namespace kerf
