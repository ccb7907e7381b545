// The zero line of a function that is linear on triangles, and the area of its negative part: of a triangle with one
// negative corner i it is area f_i^2/((f_i - f_j) (f_i - f_k)).

#include "geometry/carve/signs.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

void require_fit(const Mesh& mesh, const Eigen::VectorXd& phi) {
  if (std::size_t(phi.size()) != mesh.points.size())
    throw std::invalid_argument(
        fmt::format("a function with {} values on a mesh of {} vertices", phi.size(), mesh.points.size()));
  if (!phi.allFinite()) throw std::invalid_argument("a function to carve with has a value that is no finite number");
}

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
  require_fit(mesh, phi);
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
  require_fit(mesh, phi);
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (phi[a] < 0 || phi[b] < 0 || phi[c] < 0) sum += negative_part(area(mesh, Index(t)), {phi[a], phi[b], phi[c]});
  }
  return sum;
}

}  // namespace kerf
