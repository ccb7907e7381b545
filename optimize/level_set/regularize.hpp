#pragma once
// Inner products in which gradients become velocities.

#include "optimize/level_set/background.hpp"

#include <memory>

namespace kerf {

/// (r^2 grad v, grad w) + (v, w) on the linear functions of a background mesh, factorized once [H1 gradient; Burger
/// 2003].
class Helmholtz {
 public:
  Helmholtz(const BackgroundMesh& background, double r);
  ~Helmholtz();
  Helmholtz(Helmholtz&&) noexcept;

  /// v with a(v, w) = sum_v load_v w_v.
  Eigen::VectorXd solve(const Eigen::VectorXd& load) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A closed or open curve of edges between points.
struct EdgeCurve {
  std::vector<Vec2> points;
  std::vector<std::array<Index, 2>> edges;
};

/// v on the points of the curve with sum over edges int v w + r^2 v' w' ds = sum over edges length * value * w(middle):
/// the gradient of values per edge in the H1 product of the curve. Edges have the lengths given.
Eigen::VectorXd smooth_along(const EdgeCurve& curve, const Eigen::VectorXd& length, double r,
                             const Eigen::VectorXd& value);

/// r^2 (eps(v), eps(w)) + (v, w) on the linear vector fields of a background mesh, factorized once [Schulz, Siebenborn
/// 2016].
class ElasticProduct {
 public:
  ElasticProduct(const BackgroundMesh& background, double r);
  ~ElasticProduct();
  ElasticProduct(ElasticProduct&&) noexcept;

  /// Speeds on the points of a curve as a vector field on the background mesh: its component along the gradient of
  /// `distance`, as fast as the given speeds where they are largest.
  Eigen::VectorXd extend(const BackgroundMesh& background, const EdgeCurve& curve, const Eigen::VectorXd& speed,
                         const Eigen::VectorXd& distance) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
