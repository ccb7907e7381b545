// Products in which derivatives become velocities [Burger 2003; Schulz, Siebenborn 2016; theory: L.4]:
//   int v phi + r^2 v' phi' ds = int v0 phi ds                  along the boundary, linear elements per edge
//   (v, phi) + r^2 (grad v, grad phi)                           on the canvas
//   (v, phi) + r^2 (eps(v), eps(phi))                           of vector fields on the canvas
// Each matrix is sparse, symmetric and positive definite, and factorized once (that of the boundary per step). The
// elastic product extends a normal speed v as a field loaded by v n along the boundary; its component along the
// gradient of the distance moves phi, scaled so that it is as fast as v where v is largest. docs/theory/level_set.md,
// section "Smoothing".

#include "optimize/level_set/regularize.hpp"

#include <Eigen/SparseCholesky>

namespace kerf {

namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// Gradients of the barycentric coordinates.
struct Slopes {
  double area;
  std::array<Vec2, 3> slope;
};
Slopes slopes(const Mesh& mesh, const std::array<Index, 3>& t) {
  const Vec2 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
  Slopes s{.area = 0.5 * cross(b - a, c - a)};
  const std::array<Vec2, 3> side = {c - b, a - c, b - a};
  for (std::size_t i = 0; i < 3; ++i) s.slope[i] = Vec2(-side[i].y(), side[i].x()) / (2 * s.area);
  return s;
}

}  // namespace

struct Helmholtz::Impl {
  Eigen::SimplicialLDLT<Sparse> factor;
};

// Mass of linear elements: area/6 on the diagonal, area/12 beside it.
Helmholtz::Helmholtz(const BackgroundMesh& background, double r) : impl_(std::make_unique<Impl>()) {
  const Mesh& mesh = background.mesh;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(9 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Slopes s = slopes(mesh, t);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        entries.emplace_back(t[i], t[k], s.area * (r * r * s.slope[i].dot(s.slope[k]) + (i == k ? 1.0 / 6 : 1.0 / 12)));
  }
  const Eigen::Index n = static_cast<Eigen::Index>(mesh.points.size());
  Sparse matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  impl_->factor.compute(matrix);
}

Helmholtz::~Helmholtz() = default;
Helmholtz::Helmholtz(Helmholtz&&) noexcept = default;

Eigen::VectorXd Helmholtz::solve(const Eigen::VectorXd& load) const {
  return impl_->factor.solve(load);
}

Eigen::VectorXd smooth_along(const EdgeCurve& curve, const Eigen::VectorXd& length, double r,
                             const Eigen::VectorXd& value) {
  const Eigen::Index n = static_cast<Eigen::Index>(curve.points.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * curve.edges.size());
  Eigen::VectorXd load = Eigen::VectorXd::Zero(n);
  for (std::size_t e = 0; e < curve.edges.size(); ++e) {
    const auto& [i, k] = curve.edges[e];
    const double h = length[static_cast<Eigen::Index>(e)], half = 0.5 * h * value[static_cast<Eigen::Index>(e)];
    // Mass h/3, h/6 and stiffness r^2/h of a linear element; the load is lumped to both ends.
    const double stiff = r * r / h;
    entries.emplace_back(i, i, stiff + h / 3);
    entries.emplace_back(k, k, stiff + h / 3);
    entries.emplace_back(i, k, h / 6 - stiff);
    entries.emplace_back(k, i, h / 6 - stiff);
    load[i] += half;
    load[k] += half;
  }
  Sparse matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Sparse> factor(matrix);
  return factor.solve(load);
}

struct ElasticProduct::Impl {
  Eigen::SimplicialLDLT<Sparse> factor;
};

// Unknowns are 2 vertex + component.
ElasticProduct::ElasticProduct(const BackgroundMesh& background, double r) : impl_(std::make_unique<Impl>()) {
  const Mesh& mesh = background.mesh;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Slopes s = slopes(mesh, t);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        // eps(N_i e_p) : eps(N_k e_q) = 1/2 (slope_i . slope_k delta_pq + slope_i,q slope_k,p)
        const double mass = s.area / (i == k ? 6 : 12), product = s.slope[i].dot(s.slope[k]);
        for (int p = 0; p < 2; ++p)
          for (int q = 0; q < 2; ++q)
            entries.emplace_back(
                2 * t[i] + p, 2 * t[k] + q,
                0.5 * r * r * s.area * ((p == q ? product : 0) + s.slope[i][q] * s.slope[k][p]) + (p == q ? mass : 0));
      }
  }
  const Eigen::Index n = 2 * static_cast<Eigen::Index>(mesh.points.size());
  Sparse matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  impl_->factor.compute(matrix);
}

ElasticProduct::~ElasticProduct() = default;
ElasticProduct::ElasticProduct(ElasticProduct&&) noexcept = default;

// The normal away from the boundary is the gradient of the distance, averaged at vertices by area and normed.
Eigen::VectorXd ElasticProduct::extend(const BackgroundMesh& background, const EdgeCurve& curve,
                                       const Eigen::VectorXd& speed, const Eigen::VectorXd& distance) const {
  const Eigen::Index n = distance.size();
  Eigen::Matrix2Xd gradient = Eigen::Matrix2Xd::Zero(2, n);  // of the distance, at vertices
  for (const auto& t : background.mesh.triangles) {
    const Slopes s = slopes(background.mesh, t);
    Vec2 g = Vec2::Zero();
    for (std::size_t i = 0; i < 3; ++i) g += distance[t[i]] * s.slope[i];
    for (const Index v : t) gradient.col(v) += s.area * g;
  }
  for (Eigen::Index v = 0; v < n; ++v)
    if (const double norm = gradient.col(v).norm(); norm > 0) gradient.col(v) /= norm;
  std::vector<Vec2> points;
  Eigen::VectorXd amount(static_cast<Eigen::Index>(curve.edges.size()));
  for (std::size_t e = 0; e < curve.edges.size(); ++e) {
    const auto& [i, k] = curve.edges[e];
    points.push_back(0.5 * (curve.points[i] + curve.points[k]));
    amount[static_cast<Eigen::Index>(e)] = 0.5 * (speed[i] + speed[k]) * (curve.points[k] - curve.points[i]).norm();
  }
  const Eigen::VectorXd normal_load = spread_onto(background, points, amount);
  Eigen::VectorXd load(2 * n);
  for (Eigen::Index v = 0; v < n; ++v) load.segment<2>(2 * v) = normal_load[v] * gradient.col(v);
  const Eigen::VectorXd field = impl_->factor.solve(load);
  Eigen::VectorXd along(n);
  for (Eigen::Index v = 0; v < n; ++v) along[v] = field.segment<2>(2 * v).dot(gradient.col(v));
  double fastest = 0;
  for (const Vec2& x : points) fastest = std::max(fastest, std::abs(value_at(background, along, x)));
  if (fastest > 0) along *= speed.cwiseAbs().maxCoeff() / fastest;
  return along;
}

}  // namespace kerf
