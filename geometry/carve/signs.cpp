// Signs of a function at vertices, where it crosses edges (linearly, kept clear of vertices), and the area inside.

#include "geometry/carve/signs.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

Signs signs_of(const Mesh& mesh, const Eigen::VectorXd& phi) {
  require_fit(mesh, phi);
  Signs signs;
  signs.inside.resize(mesh.points.size());
  signs.clear.assign(mesh.points.size(), 0);
  signs.magnitude.resize(mesh.points.size());
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    signs.inside[v] = phi[Index(v)] < 0;
    signs.magnitude[v] = std::abs(phi[Index(v)]);
  }
  return signs;
}

double exact_crossing(const Mesh& mesh, const Signs& signs, Index edge) {
  const auto& [a, b] = mesh.edges[std::size_t(edge)];
  const double p = signs.magnitude[std::size_t(a)], q = signs.magnitude[std::size_t(b)];
  if (p <= 0 || q <= 0) return p <= q ? 0 : 1;
  return p / (p + q);
}

double crossing(const Mesh& mesh, const Signs& signs, Index edge) {
  const auto& [a, b] = mesh.edges[std::size_t(edge)];
  const double whole = length(mesh, edge);
  double low = signs.clear[std::size_t(a)] / whole, high = signs.clear[std::size_t(b)] / whole;
  if (const double sum = low + high; sum > 0.9) low *= 0.9 / sum, high *= 0.9 / sum;
  return std::clamp(exact_crossing(mesh, signs, edge), low, 1 - high);
}

/// The corner that is alone cuts off a triangle whose area is in proportion to both shares of its edges.
double inside_area(const Mesh& mesh, const Signs& signs, Index triangle) {
  const auto& v = mesh.triangles[std::size_t(triangle)];
  int count = 0;
  for (const Index i : v) count += signs.inside[std::size_t(i)];
  const double whole = area(mesh, triangle);
  if (count == 0 || count == 3) return count == 0 ? 0 : whole;
  for (std::size_t i = 0; i < 3; ++i) {
    if (bool(signs.inside[std::size_t(v[i])]) != (count == 1)) continue;
    double cut = whole;
    for (const std::size_t opposite : {(i + 1) % 3, (i + 2) % 3}) {
      const Index e = mesh.edges_of[std::size_t(triangle)][opposite];
      const double t = crossing(mesh, signs, e);
      cut *= mesh.edges[std::size_t(e)][0] == v[i] ? t : 1 - t;
    }
    return count == 1 ? cut : whole - cut;
  }
  return 0;
}

Vec2 place(const Block& block, const Signs& signs, Index edge) {
  const auto& [frame, mesh, rim, how] = block;
  const auto& [a, b] = mesh.edges[std::size_t(edge)];
  const Vec2 &p = mesh.points[std::size_t(a)], &q = mesh.points[std::size_t(b)];
  const Vec2 x = p + crossing(mesh, signs, edge) * (q - p);
  if (const Index s = rim.strand[std::size_t(edge)]; s != none) {
    const Strand& strand = rim.drawing.strands[std::size_t(s)];
    return strand.arc ? onto(*strand.arc, x) : x;
  }
  if (const Index c = mesh.crack[std::size_t(edge)]; c != none && frame.cracks[std::size_t(c)].arc)
    return onto(*frame.cracks[std::size_t(c)].arc, x);
  return x;
}

}  // namespace kerf
