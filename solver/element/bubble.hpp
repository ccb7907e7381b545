#pragma once
// Coordinates of one triangle and what its spaces are spanned by: monomials, and curls of bubbles.

#include "base/polynomial.hpp"
#include "solver/element/local.hpp"
#include "solver/element/number.hpp"

#include <algorithm>

namespace kerf {

// The local problem is set in xi = (x - centroid)/h, h = sqrt(2 |T|), where the triangle has area 1/2 and every basis
// function is O(1). In these coordinates the condensed matrix does not depend on h: with u = h u_xi and m = h m_xi,
//   M s + B'(u_xi, r) = C' m_xi,   B s = (-h (f, v), 0),   tractions = h C s.
template <class Number>
struct ScaledOf {
  Plane<Number> center;
  Number h;
  std::array<Plane<Number>, 3> x;         // vertices in xi
  std::array<Plane<Number>, 3> gradient;  // of the barycentric coordinates, in xi
};
using Scaled = ScaledOf<double>;
Scaled scale(const Triangle& t);

template <class Number>
Plane<Number> point(const ScaledOf<Number>& s, double l1, double l2) {
  return (1 - l1 - l2) * s.x[0] + l1 * s.x[1] + l2 * s.x[2];
}

// b = 27 l0 l1 l2 and its gradient in xi.
template <class Number>
struct Bubble {
  Number value;
  Plane<Number> gradient;
};
// 27 l0 l1 l2 is 1 at the centroid.
template <class Number>
Bubble<Number> bubble(const ScaledOf<Number>& s, const Plane<Number>& xi) {
  const Number l1 = 1.0 / 3 + s.gradient[1].dot(xi), l2 = 1.0 / 3 + s.gradient[2].dot(xi), l0 = 1.0 - l1 - l2;
  const Number b01 = 27.0 * (l0 * l1), b02 = 27.0 * (l0 * l2), b12 = 27.0 * (l1 * l2);
  return {l0 * b12, b12 * s.gradient[0] + b02 * s.gradient[1] + b01 * s.gradient[2]};
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
  template <class Number>
  using ValuesOf = Grid<Number, Monomials, 1>;
  template <class Number>
  using CurlsOf = Grid<Number, W, 2>;
  using Values = ValuesOf<double>;

  // Monomials of degree <= Degree.
  template <class Number>
  static ValuesOf<Number> monomials_of(const Plane<Number>& xi) {
    ValuesOf<Number> v;
    set_zero(v);
    v[0] += 1.0;
    for (int k = 1; k <= Degree; ++k) {
      for (int j = 0; j < k; ++j) v[place(k - j, j)] = v[place(k - j - 1, j)] * xi.x();
      v[place(0, k)] = v[place(0, k - 1)] * xi.y();
    }
    return v;
  }
  static Values monomials_at(const Vec2& xi) {
    return monomials_of<double>(xi);
  }

  // Stress function 4 m + c is monomial m in component c of 11, 12, 21, 22. Then come the bubbles: function
  // 4 P + 2 w + r is curl(b w) = (d2, -d1) in row r, w the homogeneous monomials in their order.
  template <class Number>
  static CurlsOf<Number> curls_at(const ScaledOf<Number>& s, const Plane<Number>& xi, const ValuesOf<Number>& v) {
    CurlsOf<Number> curl;
    if constexpr (W > 0) {
      const Bubble<Number> b = bubble<Number>(s, xi);
      for (int j = 0; j < W; ++j) {
        const int i = E.bubble - j;
        const Number w = v[place(i, j)];
        curl(j, 0) = b.gradient.y() * w;
        curl(j, 1) = -(b.gradient.x() * w);
        if (j > 0) curl(j, 0) += static_cast<double>(j) * b.value * v[place(i, j - 1)];
        if (i > 0) curl(j, 1) -= static_cast<double>(i) * b.value * v[place(i - 1, j)];
      }
    }
    return curl;
  }
};

}  // namespace kerf
