// The canvas of a level set: a mesh of the frame with a function phi that is linear on its triangles and negative in
// the material. Signed distances to the zero line (and to the rim with material on it) come from a front that carries
// the nearest piece from vertex to vertex, nearest first, up to 20 edges: exact beside the boundary, where it is used,
// and never of another sign than phi. Values along the boundary are extended by the same front, so that they are
// constant along normals. What stays solid or void is imposed by phi = min(max(phi, hollow), frozen) with the distances
// to both, a mirror by the mean of phi and its image. The area wanted comes by a shift, phi + c, whose derivative is
// minus the length of the zero line: secants in a bracket. Discs are cut by max(phi, radius - |x - center|). What moves
// on it is in docs/theory/level_set.md.

#include "optimize/level_set/background.hpp"

#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace kerf {

namespace {

constexpr double band = 20;  // edges of the mesh; farther from the boundary nothing needs to be exact

/// A front that carries the nearest of some sources from vertex to vertex, nearest first. `distance_to(v, i)`: of
/// vertex v to source i.
/// `distance` is infinite and `source` none beyond the reach.
struct Carried {
  Eigen::VectorXd distance;
  std::vector<Index> source;
};
template <typename DistanceTo>
Carried carry(const BackgroundMesh& b, std::span<const std::pair<Index, Index>> seeds, double reach,
              const DistanceTo& distance_to) {
  const std::size_t n = b.mesh.points.size();
  Carried c{Eigen::VectorXd::Constant(static_cast<Eigen::Index>(n), infinity), std::vector<Index>(n, none)};
  struct Candidate {
    double distance;
    Index vertex, source;
    bool operator>(const Candidate& o) const {
      return std::tie(distance, vertex, source) > std::tie(o.distance, o.vertex, o.source);
    }
  };
  // Ties are broken by vertex and source, so that the result does not depend on the order of the seeds.
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> front;
  // The first of each vertex that waits: no later one will be taken.
  struct First {
    double distance = infinity;
    Index source = none;
  };
  std::vector<First> first(n);
  const auto push = [&](double d, Index v, Index i) {
    First& f = first[static_cast<std::size_t>(v)];
    if (d > reach || std::tie(f.distance, f.source) <= std::tie(d, i)) return;
    f = {d, i};
    front.push({d, v, i});
  };
  for (const auto& [v, i] : seeds) push(distance_to(v, i), v, i);
  while (!front.empty()) {
    const Candidate at = front.top();
    front.pop();
    if (!(at.distance < c.distance[at.vertex])) continue;
    c.distance[at.vertex] = at.distance;
    c.source[static_cast<std::size_t>(at.vertex)] = at.source;
    for (Index k = b.start[static_cast<std::size_t>(at.vertex)]; k < b.start[static_cast<std::size_t>(at.vertex) + 1];
         ++k) {
      const Index v = b.around[static_cast<std::size_t>(k)];
      if (first[static_cast<std::size_t>(v)].source == at.source) continue;
      const double d = distance_to(v, at.source);
      if (d < c.distance[v]) push(d, v, at.source);
    }
  }
  return c;
}

bool inside(const Polygon& p, const Vec2& x) {
  bool odd = false;
  for (std::size_t i = 0, k = p.points.size() - 1; i < p.points.size(); k = i++) {
    const Vec2 &a = p.points[i], &c = p.points[k];
    if ((a.y() > x.y()) != (c.y() > x.y()) && x.x() < (c.x() - a.x()) * (x.y() - a.y()) / (c.y() - a.y()) + a.x())
      odd = !odd;
  }
  return odd;
}

// Negative inside.
double to_polygon(const Polygon& p, const Vec2& x) {
  double least = infinity;
  for (std::size_t i = 0; i < p.points.size(); ++i)
    least = std::min(least, distance(x, p.points[i], p.points[(i + 1) % p.points.size()]));
  return inside(p, x) ? -least : least;
}

// The union of loops with their margins, of strips along labels and of discs: the least of the distances. Empty:
// nothing stays solid.
Eigen::VectorXd distance_to_solid(const Mesh& mesh, const Solid& solid, double chord) {
  if (solid.loops.empty() && solid.labels.empty() && solid.discs.empty()) return {};
  Eigen::VectorXd d = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(mesh.points.size()), infinity);
  std::vector<std::pair<Polygon, double>> polygons;
  for (const auto& [loop, margin] : solid.loops)
    polygons.emplace_back(flatten(loop, chord, extent({.outline = loop}) / 20), margin);
  std::vector<Index> strip;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (std::find(solid.labels.begin(), solid.labels.end(), mesh.label[static_cast<std::size_t>(e)]) !=
            solid.labels.end() &&
        mesh.label[static_cast<std::size_t>(e)] != none)
      strip.push_back(e);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    double& least = d[static_cast<Eigen::Index>(v)];
    for (const auto& [polygon, margin] : polygons)
      least = std::min(least, to_polygon(polygon, mesh.points[v]) - margin);
    for (const auto& [center, radius] : solid.discs) least = std::min(least, (mesh.points[v] - center).norm() - radius);
    for (const Index e : strip)
      least = std::min(least, distance(mesh.points[v], mesh.points[static_cast<std::size_t>(mesh.edges[e][0])],
                                       mesh.points[static_cast<std::size_t>(mesh.edges[e][1])]) -
                                  solid.width);
  }
  return d;
}

Eigen::Vector3d barycentric(const Mesh& mesh, Index t, const Vec2& x) {
  const auto& v = mesh.triangles[static_cast<std::size_t>(t)];
  const Vec2 &a = mesh.points[v[0]], &b = mesh.points[v[1]], &c = mesh.points[v[2]];
  const double whole = cross(b - a, c - a);
  return Eigen::Vector3d(cross(b - x, c - x), cross(c - x, a - x), cross(a - x, b - x)) / whole;
}

}  // namespace

// Neighbors of the vertices in one list, as the rows of a sparse matrix. The rim are edges of the frame that may
// recede: neither supports nor what bears loads.
BackgroundMesh background_mesh(Mesh mesh, const Solid& solid, const std::optional<Mirror>& mirror) {
  BackgroundMesh b{.mesh = std::move(mesh)};
  const std::size_t n = b.mesh.points.size();
  b.lumped.setZero(static_cast<Eigen::Index>(n));
  double lengths = 0;
  for (Index t = 0; t < static_cast<Index>(b.mesh.triangles.size()); ++t)
    for (const Index v : b.mesh.triangles[static_cast<std::size_t>(t)]) b.lumped[v] += area(b.mesh, t) / 3;
  std::vector<Index> count(n + 1, 0);
  for (const auto& [v, w] : b.mesh.edges) ++count[static_cast<std::size_t>(v)], ++count[static_cast<std::size_t>(w)];
  b.start.assign(n + 1, 0);
  for (std::size_t v = 0; v < n; ++v) b.start[v + 1] = b.start[v] + count[v];
  b.around.resize(static_cast<std::size_t>(b.start[n]));
  std::vector<Index> next(b.start.begin(), b.start.end() - 1);
  for (Index e = 0; e < static_cast<Index>(b.mesh.edges.size()); ++e) {
    const auto& [v, w] = b.mesh.edges[static_cast<std::size_t>(e)];
    b.around[static_cast<std::size_t>(next[static_cast<std::size_t>(v)]++)] = w;
    b.around[static_cast<std::size_t>(next[static_cast<std::size_t>(w)]++)] = v;
    lengths += length(b.mesh, e);
  }
  // Mean length of the edges.
  b.size = lengths / static_cast<double>(b.mesh.edges.size());
  b.frozen = distance_to_solid(b.mesh, solid, 0.01 * b.size);
  b.locator = make_locator(b.mesh);
  const auto listed = [](const std::vector<Index>& labels, Index label) {
    return std::find(labels.begin(), labels.end(), label) != labels.end();
  };
  for (Index e = 0; e < static_cast<Index>(b.mesh.edges.size()); ++e) {
    const auto& [left, right] = b.mesh.sides[static_cast<std::size_t>(e)];
    const Index label = b.mesh.label[static_cast<std::size_t>(e)];
    if ((left == none || right == none) && !listed(solid.held, label) && !listed(solid.labels, label))
      b.rim.push_back(e);
  }
  b.mirror = mirror;
  if (mirror) {
    for (const Vec2& x : b.mesh.points) {
      const Vec2 y = image_of(*mirror, x);
      // A point next to the boundary may have its image a rounding outside.
      BackgroundMesh::Image image{nearest_triangle(b.mesh, b.locator, y)};
      image.weight = barycentric(b.mesh, image.triangle, y);
      // Farther outside the mirror shows no body.
      if (image.weight.minCoeff() < -1e-3) image.triangle = none;
      b.image.push_back(image);
    }
    // Images of what stays solid stay so, too.
    const Eigen::VectorXd own = b.frozen;
    for (Eigen::Index v = 0; v < own.size(); ++v) {
      const BackgroundMesh::Image& image = b.image[static_cast<std::size_t>(v)];
      if (image.triangle == none) continue;
      const auto& corner = b.mesh.triangles[static_cast<std::size_t>(image.triangle)];
      b.frozen[v] = std::min(own[v], image.weight.dot(Eigen::Vector3d(own[corner[0]], own[corner[1]], own[corner[2]])));
    }
  }
  return b;
}

// By size it is a distance, by sign it is phi: a vertex never changes sides.
Eigen::VectorXd signed_distance(const BackgroundMesh& b, const Eigen::VectorXd& phi) {
  // Pieces of the zero line, and edges of the rim with material at both ends; seeds are the corners of their triangles.
  std::vector<ZeroPiece> pieces = zero_line(b.mesh, phi);
  for (const Index e : b.rim) {
    const auto& [v, w] = b.mesh.edges[static_cast<std::size_t>(e)];
    if (!(phi[v] < 0 && phi[w] < 0)) continue;
    const auto& [left, right] = b.mesh.sides[static_cast<std::size_t>(e)];
    pieces.push_back({b.mesh.points[static_cast<std::size_t>(v)], b.mesh.points[static_cast<std::size_t>(w)],
                      left != none ? left : right});
  }
  std::vector<std::pair<Index, Index>> seeds;
  for (Index i = 0; i < static_cast<Index>(pieces.size()); ++i)
    for (const Index v : b.mesh.triangles[static_cast<std::size_t>(pieces[static_cast<std::size_t>(i)].triangle)])
      seeds.emplace_back(v, i);
  const Carried c = carry(b, seeds, band * b.size, [&](Index v, Index i) {
    const ZeroPiece& p = pieces[static_cast<std::size_t>(i)];
    return distance(b.mesh.points[static_cast<std::size_t>(v)], p.a, p.b);
  });
  // On the rim the distance is 0, and must not lose its sign.
  const double least = 1e-3 * b.size, most = band * b.size;
  Eigen::VectorXd d = c.distance.cwiseMin(most);
  for (Eigen::Index v = 0; v < phi.size(); ++v)
    if (phi[v] < 0) d[v] = -std::max(d[v], least);
  return d;
}

double value_at(const BackgroundMesh& b, const Eigen::VectorXd& f, const Vec2& x) {
  const Index t = nearest_triangle(b.mesh, b.locator, x);
  const auto& v = b.mesh.triangles[static_cast<std::size_t>(t)];
  return barycentric(b.mesh, t, x).dot(Eigen::Vector3d(f[v[0]], f[v[1]], f[v[2]]));
}

// Points outside, by rounding or beside the frame, give their whole amount to the nearest triangle: shares are made
// nonnegative and normed.
Eigen::VectorXd spread_onto(const BackgroundMesh& b, std::span<const Vec2> points, const Eigen::VectorXd& amounts) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(b.mesh.points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Index t = nearest_triangle(b.mesh, b.locator, points[i]);
    const Eigen::Vector3d share = barycentric(b.mesh, t, points[i]).cwiseMax(0);
    for (int k = 0; k < 3; ++k)
      load[b.mesh.triangles[static_cast<std::size_t>(t)][k]] +=
          amounts[static_cast<Eigen::Index>(i)] * share[k] / share.sum();
  }
  return load;
}

// The mirror first: what stays solid or void counts whatever the mean is.
Eigen::VectorXd constrained(const BackgroundMesh& b, Eigen::VectorXd phi) {
  // Images are read from a copy: they must not be means already.
  if (!b.image.empty()) {
    const Eigen::VectorXd given = phi;
    for (Eigen::Index v = 0; v < phi.size(); ++v) {
      const BackgroundMesh::Image& image = b.image[static_cast<std::size_t>(v)];
      if (image.triangle == none) continue;
      const auto& corner = b.mesh.triangles[static_cast<std::size_t>(image.triangle)];
      phi[v] =
          0.5 * (given[v] + image.weight.dot(Eigen::Vector3d(given[corner[0]], given[corner[1]], given[corner[2]])));
    }
  }
  return clipped(b, std::move(phi));
}

Eigen::VectorXd clipped(const BackgroundMesh& b, Eigen::VectorXd phi) {
  if (b.hollow.size() > 0) phi = phi.cwiseMax(b.hollow);
  if (b.frozen.size() > 0) phi = phi.cwiseMin(b.frozen);
  return phi;
}

// Area falls as c grows, so that a bracket holds throughout; 1e-9 of the frame is enough.
Eigen::VectorXd with_area(const BackgroundMesh& b, const Eigen::VectorXd& phi, double area) {
  const auto shifted = [&](double c) { return clipped(b, (phi.array() + c).matrix()); };
  const double whole = b.lumped.sum(), enough = 1e-9 * whole;
  // Below `low` all is material, above `high` none.
  double low = -phi.maxCoeff() - b.size, high = -phi.minCoeff() + b.size;  // all material, none
  double at = 0, excess = negative_area(b.mesh, shifted(at)) - area;
  // Secants while they stay in the bracket: the derivative by c is minus the length of the zero line.
  double before = 0, excess_before = 0;
  for (int i = 0; i < 60 && std::abs(excess) > enough; ++i) {
    (excess > 0 ? low : high) = at;
    double next = 0.5 * (low + high);
    if (i > 0 && excess != excess_before) {
      const double secant = at - excess * (at - before) / (excess - excess_before);
      if (secant > low && secant < high) next = secant;
    } else if (i == 0) {
      // The first secant needs two points: a tenth of an edge towards the area.
      const double guess = at + std::copysign(0.1 * b.size, excess);
      if (guess > low && guess < high) next = guess;
    }
    before = at, excess_before = excess;
    at = next;
    excess = negative_area(b.mesh, shifted(at)) - area;
  }
  return shifted(at);
}

void cut_discs(const BackgroundMesh& b, std::span<const Disc> discs, Eigen::VectorXd& phi) {
  for (const Disc& disc : discs)
    for (Eigen::Index v = 0; v < phi.size(); ++v)
      phi[v] = std::max(phi[v], disc.radius - (b.mesh.points[static_cast<std::size_t>(v)] - disc.center).norm());
  phi = clipped(b, std::move(phi));
}

// Vertices beyond the band keep 0.
Eigen::VectorXd extend(const BackgroundMesh& b, std::span<const Vec2> points, const Eigen::VectorXd& values) {
  // Points and the three corners of the triangle around (or next to) each.
  std::vector<std::pair<Index, Index>> seeds;
  for (Index i = 0; i < static_cast<Index>(points.size()); ++i)
    for (const Index v : b.mesh.triangles[static_cast<std::size_t>(
             nearest_triangle(b.mesh, b.locator, points[static_cast<std::size_t>(i)]))])
      seeds.emplace_back(v, i);
  const Carried c = carry(b, seeds, band * b.size, [&](Index v, Index i) {
    return (b.mesh.points[static_cast<std::size_t>(v)] - points[static_cast<std::size_t>(i)]).norm();
  });
  Eigen::VectorXd extended = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(b.mesh.points.size()));
  for (Eigen::Index v = 0; v < extended.size(); ++v)
    if (const Index i = c.source[static_cast<std::size_t>(v)]; i != none) extended[v] = values[i];
  return extended;
}

}  // namespace kerf
