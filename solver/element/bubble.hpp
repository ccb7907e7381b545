#pragma once
// Coordinates of one triangle and what its spaces are spanned by: monomials, and curls of bubbles.

#include "solver/element/local.hpp"
#include "solver/polynomial.hpp"

#include <algorithm>

namespace kerf {

// The local problem is set in xi = (x - centroid)/h, h = sqrt(2 |T|), where the triangle has area 1/2 and every basis
// function is O(1). In these coordinates the condensed matrix does not depend on h: with u = h u_xi and m = h m_xi,
//   M s + B'(u_xi, r) = C' m_xi,   B s = (-h (f, v), 0),   tractions = h C s.
struct Scaled {
  Vec2 center;
  double h;
  std::array<Vec2, 3> x;         // vertices in xi
  std::array<Vec2, 3> gradient;  // of the barycentric coordinates, in xi
};
Scaled scale(const Triangle& t);

inline Vec2 point(const Scaled& s, double l1, double l2) {
  return (1 - l1 - l2) * s.x[0] + l1 * s.x[1] + l2 * s.x[2];
}

// b = 27 l0 l1 l2 and its gradient in xi.
struct Bubble {
  double value;
  Vec2 gradient;
};
inline Bubble bubble(const Scaled& s, const Vec2& xi) {
  const double l1 = 1.0 / 3 + s.gradient[1].dot(xi), l2 = 1.0 / 3 + s.gradient[2].dot(xi), l0 = 1 - l1 - l2;
  return {27 * l0 * l1 * l2, 27 * (l1 * l2 * s.gradient[0] + l0 * l2 * s.gradient[1] + l0 * l1 * s.gradient[2])};
}

// Sizes of the spaces of an element. F: coefficients of the full tensors and the bubbles; S: stress functions after the
// cut; U, R: displacement functions, rotation functions that are eliminated; X: skeleton unknowns, V of them at
// vertices.
template <const Element& E>
struct Space {
  static constexpr int P = dim(E.stress);
  static constexpr int W = E.bubble + 1;  // homogeneous polynomials of that degree
  static constexpr int F = stress_count(E);
  static constexpr int S = stress_dimension(E);
  static constexpr int U = displacement_count(E);
  static constexpr int R = inner_rotation_count(E);
  static constexpr int B = U + R;
  static constexpr int G = points_per_edge(E);
  static constexpr int V = E.at_vertices == AtVertices::Rotation ? 3 : 0;
  static constexpr int X = 6 * G + V;
  static constexpr bool IsCut = E.cut != Cut::None;
  static constexpr int Degree = std::max({E.stress, E.bubble, E.displacement, E.rotation});
  static constexpr int Monomials = dim(Degree);
  using Values = Eigen::Matrix<double, Monomials, 1>;
  using Curls = Eigen::Matrix<double, W, 2>;

  // Monomials of degree <= Degree.
  static Values monomials_at(const Vec2& xi) {
    Values v;
    v[0] = 1;
    for (int k = 1; k <= Degree; ++k) {
      for (int j = 0; j < k; ++j) v[place(k - j, j)] = v[place(k - j - 1, j)] * xi.x();
      v[place(0, k)] = v[place(0, k - 1)] * xi.y();
    }
    return v;
  }

  // Stress function 4 m + c is monomial m in component c of 11, 12, 21, 22. Then come the bubbles: function
  // 4 P + 2 w + r is curl(b w) = (d2, -d1) in row r, w the homogeneous monomials in their order.
  static Curls curls_at(const Scaled& s, const Vec2& xi, const Values& v) {
    Curls curl;
    if constexpr (W > 0) {
      const Bubble b = bubble(s, xi);
      for (int j = 0; j < W; ++j) {
        const int i = E.bubble - j;
        const double w = v[place(i, j)];
        const double dx = i > 0 ? i * v[place(i - 1, j)] : 0, dy = j > 0 ? j * v[place(i, j - 1)] : 0;
        curl(j, 0) = b.gradient.y() * w + b.value * dy;
        curl(j, 1) = -(b.gradient.x() * w + b.value * dx);
      }
    }
    return curl;
  }
};

}  // namespace kerf
