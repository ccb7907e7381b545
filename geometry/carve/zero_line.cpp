#include "geometry/carve/contour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

void check(const Mesh& mesh, const Eigen::VectorXd& phi) {
  if (std::size_t(phi.size()) != mesh.points.size())
    throw std::invalid_argument(
        fmt::format("a function with {} values on a mesh of {} vertices", phi.size(), mesh.points.size()));
  if (!phi.allFinite()) throw std::invalid_argument("a function to carve with has a value that is no finite number");
}

}  // namespace

double negative_part(double area, const std::array<double, 3>& f) {
  const int count = (f[0] < 0) + (f[1] < 0) + (f[2] < 0);
  if (count == 0) return 0;
  if (count == 3) return area;
  for (std::size_t i = 0; i < 3; ++i) {
    if ((f[i] < 0) != (count == 1)) continue;  // the corner that is alone
    const double g = f[(i + 1) % 3], h = f[(i + 2) % 3];
    const double cut = f[i] / (f[i] - g) * (f[i] / (f[i] - h)) * area;
    return count == 1 ? cut : area - cut;
  }
  return 0;
}

std::vector<ZeroPiece> zero_line(const Mesh& mesh, const Eigen::VectorXd& phi) {
  check(mesh, phi);
  std::vector<ZeroPiece> pieces;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    Vec2 in = Vec2::Zero(), out = in;
    int found = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = v[i], b = v[(i + 1) % 3];
      if ((phi[a] < 0) == (phi[b] < 0)) continue;
      // From the smaller vertex, so that both triangles of the edge find the same point.
      const auto [p, q] = std::minmax(a, b);
      const Vec2 &x = mesh.points[std::size_t(p)], &y = mesh.points[std::size_t(q)];
      // Counter-clockwise around the triangle the boundary of its negative part leaves along the edge that goes up.
      (phi[a] < 0 ? out : in) = x + phi[p] / (phi[p] - phi[q]) * (y - x);
      ++found;
    }
    if (found == 2 && in != out) pieces.push_back({out, in, Index(t)});
  }
  return pieces;
}

double negative_area(const Mesh& mesh, const Eigen::VectorXd& phi) {
  check(mesh, phi);
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (phi[a] < 0 || phi[b] < 0 || phi[c] < 0) sum += negative_part(area(mesh, Index(t)), {phi[a], phi[b], phi[c]});
  }
  return sum;
}

Signs signs_of(const Mesh& mesh, const Eigen::VectorXd& phi) {
  check(mesh, phi);
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

}  // namespace kerf
