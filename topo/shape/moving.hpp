#pragma once
// Explicit derivatives of a Term by the vertices: the state moves along (stresses by Piola, the rest by composition).

#include "kerf/functional.hpp"
#include "kerf/state.hpp"
#include "solver/system.hpp"

namespace kerf {

/// Derivative by the vertices of one triangle, a column each, in two parts: those constant in theta's gradient,
/// G : theta -> sum_jk by_gradient(j, k) d_k theta_j, and the rest.
struct TriangleMotion {
  Mat2 by_gradient = Mat2::Zero();
  Eigen::Matrix<double, 2, 3> rest = Eigen::Matrix<double, 2, 3>::Zero();
};
/// The gradients of the barycentric coordinates, a column each.
Eigen::Matrix<double, 2, 3> barycentric_gradients(const Triangle& t);
/// Values of the barycentric coordinates at a point of a rule.
inline Eigen::Vector3d barycentric(const TriangleRule& rule, Eigen::Index q) {
  return {1 - rule.x(0, q) - rule.x(1, q), rule.x(0, q), rule.x(1, q)};
}

/// Derivative by the two points (columns): differences of fourth order, exact to rounding for data that are smooth
/// along the edge; one-sided ones of third order where data are not finite beside it.
Mat2 by_ends(const Vec2& a, const Vec2& b, const std::function<double(const Vec2& a, const Vec2& b)>& f);
/// A function of the place on a triangle: `here` at the points x of a rule, f(q, y) at y, all else as at x_q.
struct OfPlace {
  const TriangleRule& rule;
  const Points& x;
  double size;  // of the triangle
  const Eigen::VectorXd& here;
  std::function<double(Eigen::Index q, const Vec2& y)> f;
};
/// Adds share sum_q w_q grad f . theta, by central differences over a small part of the size. No slope where f jumps
/// beside a point.
void add_place(const OfPlace& of, double share, TriangleMotion& motion);

/// Of the integral over the body, times `share`. u* moves as the transported stress moves it.
class MovingDensity {
 public:
  MovingDensity(const Model& model, const Field& state);
  void add(const Term& term, double share, Index t, const Triangle& shape, TriangleMotion& motion) const;

 private:
  void add_recovered(Index t, const Triangle& shape, const Points& x, const Points& weights,
                     TriangleMotion& motion) const;
  const Model& m_;
  const Field& s_;
  TriangleRule rule_;
  int degree_;               // of u*
  Eigen::MatrixXd d1_, d2_;  // derivatives of its monomials
};

/// Of the integrals over boundary and crack, times `share`.
void add_surface_motion(const Term& term, double share, const Model& model, const Field& state, Points& gradient);

/// An edge with its ends moved.
struct MovedEdge {
  Vec2 a, side, normal;  // outward
  double length;
  Vec2 at(double s) const {
    return a + s * side;
  }
};
MovedEdge moved_edge(const Mesh& mesh, Index boundary_edge, const Vec2& a, const Vec2& b);

}  // namespace kerf
