// Integrals over triangles by collapsed Gauss rules; about a tip R = rho^2 takes the singularity r^(-1/2) away.

#include "tests/support/integral.hpp"
#include "kerf/state.hpp"
#include "solver/system.hpp"

#include "base/quadrature.hpp"

#include <cmath>

namespace kerf::exact {

Cubature cubature(const Triangle& triangle, int singular_vertex, int per_direction) {
  // x = v + R ((1 - t)(a - v) + t (b - v)), dx = 2 area R dR dt; about a tip R = rho^2 turns r^(-1/2) into 1/rho.
  const bool singular = singular_vertex >= 0;
  const int i = singular ? singular_vertex : 0;
  const Vec2 v = triangle[i], a = triangle[(i + 1) % 3] - v, b = triangle[(i + 2) % 3] - v;
  const EdgeRule rule = gauss(singular ? 12 : per_direction);
  const double twice = std::abs(cross(a, b));
  const Index n = static_cast<Index>(rule.s.size());
  Cubature c{Points(2, n * n), Eigen::VectorXd(n * n)};
  for (Index j = 0; j < n; ++j) {
    const double rho = rule.s[j], R = singular ? rho * rho : rho;
    const double weight = twice * rule.w[j] * R * (singular ? 2 * rho : 1);
    for (Index k = 0; k < n; ++k) {
      c.x.col(j * n + k) = v + R * ((1 - rule.s[k]) * a + rule.s[k] * b);
      c.w[j * n + k] = weight * rule.w[k];
    }
  }
  return c;
}

int singular_vertex(const Mesh& mesh, const ExactField& field, Index t) {
  for (int i = 0; i < 3; ++i)
    for (const ExactTip& tip : field.tips)
      if ((mesh.points[mesh.triangles[t][i]] - tip.at).norm() < 1e-12 * (1 + tip.at.norm())) return i;
  return -1;
}

double integrate(const Triangle& triangle, int singular_vertex, const std::function<double(const Vec2&)>& f) {
  const Cubature c = cubature(triangle, singular_vertex);
  double sum = 0;
  for (Index q = 0; q < static_cast<Index>(c.w.size()); ++q) sum += c.w[q] * f(c.x.col(q));
  return sum;
}

double l2_error_squared(const Triangle& triangle, int singular_vertex,
                        const std::function<Mat2(const Vec2&)>& difference) {
  return integrate(triangle, singular_vertex, [&](const Vec2& x) { return difference(x).squaredNorm(); });
}

double integrate(const Mesh& mesh, const ExactField& field,
                 const std::function<double(Index triangle, int side, const Vec2& x)>& f) {
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Triangle triangle{mesh.points[a], mesh.points[b], mesh.points[c]};
    const int side = side_of(field, centroid(mesh, t));
    sum += integrate(triangle, singular_vertex(mesh, field, t), [&](const Vec2& x) { return f(t, side, x); });
  }
  return sum;
}

double stress_error(const Mesh& mesh, const ExactField& field, const std::function<Mat2(Index, const Vec2&)>& stress) {
  return std::sqrt(integrate(mesh, field, [&](Index t, int side, const Vec2& x) {
    return (field.stress(x, side) - stress(t, x)).squaredNorm();
  }));
}

double stress_error(const Model& model, const State& state, const ExactField& field) {
  return stress_error(model.mesh, field, [&](Index t, const Vec2& x) {
    return tensor(stress_at(model.inner->kernel, kerf::triangle(model, t), state.interior.col(t), x));
  });
}

}  // namespace kerf::exact
