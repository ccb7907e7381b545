#pragma once
// The local problem of the mixed elements for one triangle, in arrays of compile-time size. Internal to this room:
// local_<family>.cpp instantiate it, local.cpp picks.

#include "solver/element/local.hpp"
#include "solver/polynomial.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

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

inline Scaled scale(const Triangle& t) {
  Scaled s;
  s.center = centroid(t);
  s.h = std::sqrt(2 * area(t));
  for (int i = 0; i < 3; ++i) s.x[i] = (t.x[i] - s.center) / s.h;
  for (int i = 0; i < 3; ++i) {
    const Vec2 e = s.x[(i + 2) % 3] - s.x[(i + 1) % 3];
    s.gradient[i] = Vec2(-e.y(), e.x());  // inward normal times length over twice the area, which is 1
  }
  return s;
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

template <int Rows, int Columns>
using Rowwise = Eigen::Matrix<double, Rows, Columns, Columns == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

// Everything about one triangle. F: coefficients of the full tensors and the bubbles; S: stress functions after the
// cut; U, R: displacement functions, rotation functions that are eliminated; X: skeleton unknowns, V of them at
// vertices.
template <const Element& E>
struct MixedTriangle {
  static constexpr int StressDegree = E.stress, BubbleDegree = E.bubble;
  static constexpr int P = dim(StressDegree);
  static constexpr int W = BubbleDegree + 1;  // homogeneous polynomials of that degree
  static constexpr int F = stress_count(E);
  static constexpr int S = stress_dimension(E);
  static constexpr int U = displacement_count(E);
  static constexpr int R = inner_rotation_count(E);
  static constexpr int B = U + R;
  static constexpr int G = points_per_edge(E);
  static constexpr int V = E.at_vertices == AtVertices::Rotation ? 3 : 0;
  static constexpr int X = 6 * G + V;
  static constexpr bool IsCut = E.cut != Cut::None;
  static constexpr bool FineEdges = E.at_vertices == AtVertices::Stress;
  static constexpr int Degree = std::max({StressDegree, BubbleDegree, E.displacement, E.rotation});
  static constexpr int Monomials = dim(Degree);

  // Monomials of degree <= Degree.
  static Eigen::Matrix<double, Monomials, 1> monomials_at(const Vec2& xi) {
    Eigen::Matrix<double, Monomials, 1> v;
    v[0] = 1;
    for (int k = 1; k <= Degree; ++k) {
      for (int j = 0; j < k; ++j) v[place(k - j, j)] = v[place(k - j - 1, j)] * xi.x();
      v[place(0, k)] = v[place(0, k - 1)] * xi.y();
    }
    return v;
  }

  // Stress function 4 m + c is monomial m in component c of 11, 12, 21, 22. Then come the bubbles: function
  // 4 P + 2 w + r is curl(b w) = (d2, -d1) in row r, w the homogeneous monomials in their order.
  static Eigen::Matrix<double, W, 2> curls_at(const Scaled& s, const Vec2& xi,
                                              const Eigen::Matrix<double, Monomials, 1>& v) {
    Eigen::Matrix<double, W, 2> curl;
    if constexpr (W > 0) {
      const Bubble b = bubble(s, xi);
      for (int j = 0; j < W; ++j) {
        const int i = BubbleDegree - j;
        const double w = v[place(i, j)];
        const double dx = i > 0 ? i * v[place(i - 1, j)] : 0, dy = j > 0 ? j * v[place(i, j - 1)] : 0;
        curl(j, 0) = b.gradient.y() * w + b.value * dy;
        curl(j, 1) = -(b.gradient.x() * w + b.value * dx);
      }
    }
    return curl;
  }

  static Vec2 point(const Scaled& s, double l1, double l2) {
    return (1 - l1 - l2) * s.x[0] + l1 * s.x[1] + l2 * s.x[2];
  }

  template <int N>
  struct System {
    Rowwise<N, N> M;      // (A s, t) / h^2
    Rowwise<N, B> Bt;     // transposed constraints: divergence, then asymmetry
    Rowwise<N, X> Ct;     // transposed moments of s n, and of -as s against the rotations at vertices
    Rowwise<B, 1> given;  // right-hand side of the constraints
    Rowwise<N, 1> trace;  // int tr s
  };

  static System<F> assemble_full(const Kernel& k, const Triangle& t, const Scaled& s, const Material& material,
                                 const ForceMoments& force) {
    System<F> a;
    a.M.setZero();
    a.Bt.setZero();
    a.Ct.setZero();  // the bubbles have no normal trace
    a.trace.setZero();
    a.given.setZero();
    if (force.size() > 0) a.given.template head<U>() = -0.5 * s.h * force;  // the triangle's area in xi is 1/2
    // Moments of products of monomials, of monomials with the curls (column 2 w + axis), of curls with each other.
    Eigen::Matrix<double, Monomials, Monomials> moment = Eigen::Matrix<double, Monomials, Monomials>::Zero();
    Eigen::Matrix<double, Monomials, 2 * W> with_curl = Eigen::Matrix<double, Monomials, 2 * W>::Zero();
    Eigen::Matrix<double, 2 * W, 2 * W> curl_curl = Eigen::Matrix<double, 2 * W, 2 * W>::Zero();
    for (Eigen::Index q = 0; q < k.rule.w.size(); ++q) {
      const double w = 0.5 * k.rule.w[q];
      const Vec2 xi = point(s, k.rule.x(0, q), k.rule.x(1, q));
      const auto v = monomials_at(xi);
      moment += w * v * v.transpose();
      if constexpr (W > 0) {
        const auto curl = curls_at(s, xi, v);
        Eigen::Matrix<double, 2 * W, 1> flat;
        for (int b = 0; b < W; ++b) flat.template segment<2>(2 * b) = curl.row(b).transpose();
        with_curl += w * v * flat.transpose();
        curl_curl += w * flat * flat.transpose();
      }
    }
    // A s : t = dev s : dev t / (2 mu) + c tr s tr t on the components 11, 12, 21, 22.
    const double half = 1 / (4 * material.mu), full = 1 / (2 * material.mu), c = material.c;
    Eigen::Matrix4d compliance;
    compliance << half + c, 0, 0, c - half,  //
        0, full, 0, 0,                       //
        0, 0, full, 0,                       //
        c - half, 0, 0, half + c;
    for (int m = 0; m < P; ++m) {
      for (int n = 0; n < P; ++n) a.M.template block<4, 4>(4 * m, 4 * n) = moment(m, n) * compliance;
      a.trace[4 * m] = a.trace[4 * m + 3] = moment(m, 0);
      for (int r = 0; r < R; ++r) {
        a.Bt(4 * m + 1, U + r) = moment(m, r);
        a.Bt(4 * m + 2, U + r) = -moment(m, r);
      }
    }
    if constexpr (W > 0) {
      for (int b = 0; b < W; ++b)
        for (int row = 0; row < 2; ++row) {
          const int i = 4 * P + 2 * b + row;
          for (int m = 0; m < P; ++m) {
            const Eigen::Vector4d column =
                compliance.middleCols<2>(2 * row) * with_curl.template block<1, 2>(m, 2 * b).transpose();
            a.M.template block<4, 1>(4 * m, i) = column;
            a.M.template block<1, 4>(i, 4 * m) = column.transpose();
          }
          for (int d = 0; d < W; ++d)
            for (int other = 0; other < 2; ++other)
              a.M(i, 4 * P + 2 * d + other) = compliance.block<2, 2>(2 * row, 2 * other)
                                                  .cwiseProduct(curl_curl.template block<2, 2>(2 * b, 2 * d))
                                                  .sum();
          a.trace[i] = with_curl(0, 2 * b + row);
          // as: component 12 of row 0 minus component 21 of row 1
          for (int r = 0; r < R; ++r) a.Bt(i, U + r) = row == 0 ? with_curl(r, 2 * b + 1) : -with_curl(r, 2 * b);
        }
    }
    // div of monomial x^i y^j in component (row, axis) adds its derivative along axis to that row.
    for (int degree = 1; degree <= StressDegree; ++degree)
      for (int j = 0; j <= degree; ++j) {
        const int i = degree - j, m = place(i, j);
        for (int b = 0; b < U / 2; ++b)
          for (int row = 0; row < 2; ++row) {
            if (i > 0) a.Bt(4 * m + 2 * row, 2 * b + row) = i * moment(place(i - 1, j), b);
            if (j > 0) a.Bt(4 * m + 2 * row + 1, 2 * b + row) = j * moment(place(i, j - 1), b);
          }
      }
    for (int e = 0; e < 3; ++e) {
      const int from = (e + 1) % 3, to = (e + 2) % 3;
      const Vec2 side = s.x[to] - s.x[from];
      const Vec2 n(side.y(), -side.x());  // outward, times the length
      const auto add = [&](int g, double share, const Eigen::Matrix<double, Monomials, 1>& v) {
        for (int d = 0; d < 2; ++d) {
          const int column = 2 * (G * e + g) + d;
          const Vec2 f = share * frame_at(t, e, g).col(d);
          const double weight[4] = {f.x() * n.x(), f.x() * n.y(), f.y() * n.x(), f.y() * n.y()};
          for (int m = 0; m < P; ++m)
            for (int c = 0; c < 4; ++c) a.Ct(4 * m + c, column) += v[m] * weight[c];
        }
      };
      // With the normal stress in P_trace the Gauss points of the trace integrate its moments.
      const EdgeRule& rule = FineEdges ? k.edge : k.trace;
      for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
        const double along = t.forward[e] ? rule.s[q] : 1 - rule.s[q];
        const auto v = monomials_at(s.x[from] + along * side);
        if constexpr (FineEdges)
          for (int g = 0; g < G; ++g) add(g, rule.w[q] * k.trace_at_edge(g, q), v);
        else
          add(static_cast<int>(q), rule.w[q], v);
      }
    }
    if constexpr (V > 0)
      for (int v = 0; v < 3; ++v) {
        // l_v = 1/3 + gradient . xi
        const Vec2& slope = s.gradient[v];
        const Eigen::Vector3d hat(1.0 / 3, slope.x(), slope.y());
        for (int m = 0; m < P; ++m) {
          const double value = moment.template block<1, 3>(m, 0).dot(hat);
          a.Ct.template block<4, 1>(4 * m, 6 * G + v) << 0, -value, value, 0;
        }
        static_assert(W > 0);
        for (int b = 0; b < W; ++b) {
          a.Ct(4 * P + 2 * b, 6 * G + v) = -with_curl.template block<3, 1>(0, 2 * b + 1).dot(hat);
          a.Ct(4 * P + 2 * b + 1, 6 * G + v) = with_curl.template block<3, 1>(0, 2 * b).dot(hat);
        }
      }
    return a;
  }

  // Coefficients (F) of the stress functions that the cut leaves (columns).
  static Eigen::MatrixXd span_of(const Kernel& k, const Scaled& s) {
    if constexpr (E.cut == Cut::LinearNormal) {
      // n.s n is linear on an edge when its second derivative along the edge vanishes.
      Eigen::MatrixXd conditions = Eigen::MatrixXd::Zero(F, 3);
      for (int e = 0; e < 3; ++e) {
        const Vec2 tau = (s.x[(e + 2) % 3] - s.x[(e + 1) % 3]).normalized(), n(tau.y(), -tau.x());
        const double second[3] = {tau.x() * tau.x(), tau.x() * tau.y(), tau.y() * tau.y()};
        for (int j = 0; j < 3; ++j)
          for (int c = 0; c < 4; ++c) conditions(4 * place(2 - j, j) + c, e) = second[j] * n[c / 2] * n[c % 2];
      }
      const Eigen::MatrixXd inside = k.cut.transpose() * conditions;
      const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(inside).householderQ();
      return k.cut * q.rightCols(S);
    } else {
      return k.cut;
    }
  }

  static System<S> assemble(const Kernel& k, const Triangle& t, const Scaled& s, const Material& material,
                            const ForceMoments& force) {
    const System<F> full = assemble_full(k, t, s, material, force);
    if constexpr (!IsCut) {
      return full;
    } else {
      // Sizes known at run time only: these elements are for comparison, and compile four times as fast.
      const Eigen::MatrixXd n = span_of(k, s), M = full.M, Bt = full.Bt, Ct = full.Ct;
      System<S> a;
      a.M = n.transpose() * (M * n).eval();
      a.Bt = (n.transpose() * Bt).eval();
      a.Ct = (n.transpose() * Ct).eval();
      a.given = full.given;
      a.trace = (n.transpose() * Eigen::VectorXd(full.trace)).eval();
      return a;
    }
  }

  // In place, in the upper triangle: A = U'U, with the inverse of the diagonal on the diagonal. Row operations, so that
  // the inner loops vectorize.
  template <int N>
  static void cholesky(Rowwise<N, N>& a) {
    for (int k = 0; k < N; ++k) {
      const double inverse = 1 / std::sqrt(a(k, k));
      a(k, k) = inverse;
      for (int j = k + 1; j < N; ++j) a(k, j) *= inverse;
      for (int i = k + 1; i < N; ++i) {
        const double factor = a(k, i);
        for (int j = i; j < N; ++j) a(i, j) -= factor * a(k, j);
      }
    }
  }
  // x <- U'^-1 x
  template <int N, int Columns>
  static void forward(const Rowwise<N, N>& u, Rowwise<N, Columns>& x) {
    for (int k = 0; k < N; ++k) {
      x.row(k) *= u(k, k);
      for (int i = k + 1; i < N; ++i) x.row(i) -= u(k, i) * x.row(k);
    }
  }
  // x <- U^-1 x
  template <int N>
  static void backward(const Rowwise<N, N>& u, Rowwise<N, 1>& x) {
    for (int i = N - 1; i >= 0; --i) {
      double sum = x[i];
      for (int k = i + 1; k < N; ++k) sum -= u(i, k) * x[k];
      x[i] = sum * u(i, i);
    }
  }

  // Elimination of s and (u, r). M alone is singular at nu = 1/2; on the kernel of B it is not, but for a constant
  // pressure, so M + gamma B'B, which has the same solution, has a Cholesky factor for every nu < 1/2:
  //   L L' = M + gamma B'B (L' stored),  Y = L^-1 [B' C'],  Z = (chol(Yb'Yb))^-1 Yb'Yc,  K = Yc'Yc - Z'Z.
  struct Eliminated {
    Rowwise<S, S> L;
    Rowwise<B, B> LB;
    Rowwise<S, B> YB;
    Rowwise<S, X> YC;
    Rowwise<B, X> Z;
    Rowwise<B, 1> given;  // LB^-1 of the right-hand side of the constraints
    Rowwise<S, 1> YT;     // L^-1 of the trace, and LB^-1 YB'YT: with a penalty only
    Rowwise<B, 1> ZT;
    double gamma;
  };
  static Eliminated eliminate(const System<S>& a, const Material& material, const Penalty& penalty) {
    Eliminated e;
    e.gamma = 1 / (2 * material.mu);
    e.L = a.M;
    if (penalty.a > 0) e.L += 2 * penalty.a * a.trace * a.trace.transpose();  // the area in xi is 1/2
    for (int i = 0; i < S; ++i)
      for (int b = 0; b < B; ++b) {
        const double factor = e.gamma * a.Bt(i, b);
        if (factor != 0)
          for (int j = i; j < S; ++j) e.L(i, j) += factor * a.Bt(j, b);
      }
    cholesky<S>(e.L);
    e.YB = a.Bt;
    e.YC = a.Ct;
    forward<S, B>(e.L, e.YB);
    forward<S, X>(e.L, e.YC);
    e.LB.setZero();
    e.Z.setZero();
    for (int i = 0; i < S; ++i)
      for (int b = 0; b < B; ++b) {
        e.LB.row(b) += e.YB(i, b) * e.YB.row(i);
        e.Z.row(b) += e.YB(i, b) * e.YC.row(i);
      }
    cholesky<B>(e.LB);
    forward<B, X>(e.LB, e.Z);
    e.given = a.given;
    forward<B, 1>(e.LB, e.given);
    if (penalty.a > 0) {
      e.YT = a.trace;
      forward<S, 1>(e.L, e.YT);
      e.ZT = e.YB.transpose().lazyProduct(e.YT);
      forward<B, 1>(e.LB, e.ZT);
    }
    return e;
  }

  static Condensed condense(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force,
                            const Penalty& penalty) {
    const Scaled s = scale(t);
    const Eliminated e = eliminate(assemble(k, t, s, material, force), material, penalty);
    Rowwise<X, X> K = Rowwise<X, X>::Zero();
    for (int i = 0; i < S; ++i)
      for (int x = 0; x < X; ++x) K.row(x) += e.YC(i, x) * e.YC.row(i);
    for (int b = 0; b < B; ++b)
      for (int x = 0; x < X; ++x) K.row(x) -= e.Z(b, x) * e.Z.row(b);
    Condensed result{K, SkeletonVector::Zero(X), {}, 0, 0};
    // s_f = L^-T YB LB^-T given, so that C s_f = Z' given.
    if (force.size() > 0) result.F = -s.h * (e.Z.transpose().lazyProduct(e.given));
    if constexpr (V > 0) {  // rotations do not scale with the triangle
      result.K.template bottomRows<V>() *= s.h;
      result.K.template rightCols<V>() *= s.h;
      result.F.template tail<V>() *= s.h;
    }
    if (penalty.a > 0) {
      result.trace = s.h * (e.YC.transpose().lazyProduct(e.YT) - e.Z.transpose().lazyProduct(e.ZT));
      if constexpr (V > 0) result.trace.template tail<V>() *= s.h;
      result.own = 2 * e.ZT.dot(e.given);
      result.by_theta = 2 * (e.YT.squaredNorm() - e.ZT.squaredNorm());
    }
    return result;
  }

  static Eigen::VectorXd interior(const Kernel& k, const Triangle& t, const Material& material,
                                  const ForceMoments& force, const SkeletonVector& m, const Penalty& penalty) {
    const Scaled s = scale(t);
    const System<S> a = assemble(k, t, s, material, force);
    const Eliminated e = eliminate(a, material, penalty);
    return complete(k, s, material, e, e.given, a.given, nullptr, m, penalty);
  }

  static Eigen::MatrixXd interiors(const Kernel& k, const Triangle& t, const Material& material,
                                   const Eigen::MatrixXd& m) {
    const Scaled s = scale(t);
    const System<S> a = assemble(k, t, s, material, {});
    const Eliminated e = eliminate(a, material, {});
    Eigen::MatrixXd all(interior_count(E), m.cols());
    for (Eigen::Index i = 0; i < m.cols(); ++i)
      all.col(i) = complete(k, s, material, e, e.given, a.given, nullptr, m.col(i), {});
    return all;
  }

  // Back substitution: `low` is LB^-1 of the constraints' right-hand side (less what the stress load adds to it),
  // `load` L^-1 of a load on the stresses.
  static Eigen::VectorXd complete(const Kernel& k, const Scaled& s, const Material& material, const Eliminated& e,
                                  const Rowwise<B, 1>& low, const Rowwise<B, 1>& given, const Rowwise<S, 1>* load,
                                  const SkeletonVector& m, const Penalty& penalty) {
    Eigen::Matrix<double, X, 1> scaled = m / s.h;
    if constexpr (V > 0) scaled.template tail<V>() = m.template tail<V>();
    // S_B (gamma given - p) = given - B M^-1 C' m,   s = M^-1 (C' m + B' (gamma given - p))
    Rowwise<B, 1> p = low - e.Z.lazyProduct(scaled);
    if (penalty.a > 0) p -= penalty.theta * e.ZT;
    backward<B>(e.LB, p);
    Rowwise<S, 1> stress = e.YC.lazyProduct(scaled) + e.YB.lazyProduct(p);
    if (load) stress += *load;
    if (penalty.a > 0) stress += penalty.theta * e.YT;
    backward<S>(e.L, stress);
    p = e.gamma * given - p;
    return unpack(k, s, material, stress, p, m);
  }

  // -J as loads: on the stress functions (M s + B'p = C'm + stress), on the constraints, on the unknowns at vertices.
  struct Acting {
    Rowwise<S, 1> stress;
    Rowwise<B, 1> given;
    std::array<double, 3> at_vertices;
  };
  static Acting acting(const Kernel& k, const Scaled& s, const Material& material, const Eigen::VectorXd& J) {
    Eigen::VectorXd by = J;
    if constexpr (is_symmetric(E)) {  // the rotation is a linear function of the rest
      constexpr int N = rotation_count(E);
      if (!by.tail<N>().isZero(0)) {
        Eigen::VectorXd unit = Eigen::VectorXd::Zero(interior_count(E));
        for (int i = 0; i < F + U; ++i) {
          unit[i] = 1;
          by[i] += by.tail<N>().dot(rotation_of(k, s, material, unit));
          unit[i] = 0;
        }
      }
    }
    Acting a;
    if constexpr (IsCut)
      a.stress = -(span_of(k, s).transpose() * by.head(F)).eval() / (s.h * s.h);
    else
      a.stress = -by.template head<F>() / (s.h * s.h);
    for (int b = 0; b < B; ++b) a.given[b] = -by[F + b] / (b < U ? s.h : s.h * s.h);
    a.at_vertices.fill(0);
    if constexpr (V > 0)
      for (int v = 0; v < 3; ++v)
        a.at_vertices[v] = by[F + U] / 3 + by[F + U + 1] * s.gradient[v].x() + by[F + U + 2] * s.gradient[v].y();
    return a;
  }

  static DualLoad condense_dual(const Kernel& k, const Triangle& t, const Material& material, const Eigen::VectorXd& J,
                                const Penalty& penalty) {
    const Scaled s = scale(t);
    const Eliminated e = eliminate(assemble(k, t, s, material, {}), material, penalty);
    Acting a = acting(k, s, material, J);
    forward<S, 1>(e.L, a.stress);
    forward<B, 1>(e.LB, a.given);
    Rowwise<B, 1> from_stress = e.YB.transpose().lazyProduct(a.stress);
    forward<B, 1>(e.LB, from_stress);
    const Rowwise<B, 1> low = a.given - from_stress;
    DualLoad result;
    result.F = -s.h * (e.YC.transpose().lazyProduct(a.stress) + e.Z.transpose().lazyProduct(low));
    if constexpr (V > 0)
      for (int v = 0; v < 3; ++v) result.F[X - V + v] = s.h * result.F[X - V + v] + a.at_vertices[v];
    if (penalty.a > 0) result.own = 2 * (e.YT.dot(a.stress) + e.ZT.dot(low));
    return result;
  }

  static Eigen::VectorXd interior_dual(const Kernel& k, const Triangle& t, const Material& material,
                                       const Eigen::VectorXd& J, const SkeletonVector& m, const Penalty& penalty) {
    const Scaled s = scale(t);
    const Eliminated e = eliminate(assemble(k, t, s, material, {}), material, penalty);
    Acting a = acting(k, s, material, J);
    const Rowwise<B, 1> given = a.given;
    forward<S, 1>(e.L, a.stress);
    forward<B, 1>(e.LB, a.given);
    Rowwise<B, 1> from_stress = e.YB.transpose().lazyProduct(a.stress);
    forward<B, 1>(e.LB, from_stress);
    return complete(k, s, material, e, a.given - from_stress, given, &a.stress, m, penalty);
  }

  // Of the local problem's solution s, (u_xi, r).
  static Eigen::VectorXd unpack(const Kernel& k, const Scaled& s, const Material& material, const Rowwise<S, 1>& stress,
                                const Rowwise<B, 1>& inner, const SkeletonVector& m) {
    Eigen::VectorXd all(interior_count(E));
    if constexpr (IsCut)
      all.head(F) = span_of(k, s) * Eigen::VectorXd(stress);
    else
      all.template head<F>() = stress;
    for (int b = 0; b < B; ++b) all[F + b] = (b < U ? s.h : 1) * inner[b];
    if constexpr (V > 0) {
      const Eigen::Vector3d at = m.template tail<V>();
      all[F + U] = at.mean();
      for (int d = 0; d < 2; ++d)
        all[F + U + 1 + d] = at[0] * s.gradient[0][d] + at[1] * s.gradient[1][d] + at[2] * s.gradient[2][d];
    }
    if constexpr (is_symmetric(E)) all.tail(rotation_count(E)) = rotation_of(k, s, material, all);
    return all;
  }

  static LocalSystem local_system(const Kernel& k, const Triangle& t, const Material& material,
                                  const ForceMoments& force) {
    const Scaled s = scale(t);
    const System<S> a = assemble(k, t, s, material, force);
    return {s.h, a.M, a.Bt, a.Ct, a.given, a.trace};
  }

  static Eigen::VectorXd interior_of(const Kernel& k, const Triangle& t, const Material& material,
                                     const Eigen::VectorXd& local, const SkeletonVector& m) {
    return unpack(k, scale(t), material, local.template head<S>(), local.template tail<B>(), m);
  }

  // Rotation of a symmetric element, from the derivatives of its strain e = A s:
  //   d1 r = d2 e11 - d1 e12,  d2 r = d2 e12 - d1 e22,
  // in the mean of squares, with the mean of (d2 u1 - d1 u2)/2.
  static Eigen::VectorXd rotation_of(const Kernel& k, const Scaled& s, const Material& material,
                                     const Eigen::VectorXd& all) {
    constexpr int N = rotation_count(E);
    static_assert(N == P);
    Eigen::MatrixXd moment = Eigen::MatrixXd::Zero(N, N);
    for (Eigen::Index q = 0; q < k.rule.w.size(); ++q) {
      const Points xi = point(s, k.rule.x(0, q), k.rule.x(1, q));
      const Eigen::VectorXd v = monomials(E.rotation, xi);
      moment += k.rule.w[q] * v * v.transpose();
    }
    Eigen::MatrixXd strain(N, 3);  // 11, 12, 22
    for (int m = 0; m < N; ++m) {
      const double s11 = all[4 * m], s22 = all[4 * m + 3], mean = material.c * (s11 + s22);
      strain.row(m) << (s11 - s22) / (4 * material.mu) + mean, (all[4 * m + 1] + all[4 * m + 2]) / (4 * material.mu),
          (s22 - s11) / (4 * material.mu) + mean;
    }
    const Eigen::MatrixXd d1 = derivative(E.rotation, 0), d2 = derivative(E.rotation, 1);
    const Eigen::VectorXd along1 = d2 * strain.col(0) - d1 * strain.col(1),
                          along2 = d2 * strain.col(1) - d1 * strain.col(2);
    const Eigen::MatrixXd stiffness = d1.transpose() * moment * d1 + d2.transpose() * moment * d2;
    const Eigen::VectorXd load = d1.transpose() * (moment * along1) + d2.transpose() * (moment * along2);
    Eigen::VectorXd r(N);
    r.tail(N - 1) =
        Eigen::LLT<Eigen::MatrixXd>(stiffness.bottomRightCorner(N - 1, N - 1)).solve(Eigen::VectorXd(load.tail(N - 1)));
    r[0] = 0;
    // The constant from the moment of u, which u_h has more exactly than its gradient: u* with this rotation, then the
    // rest of its moment int xi^perp . (u_h - u*) as a rigid rotation.
    constexpr int D = E.rotation + 1;
    const Eigen::MatrixXd e1 = derivative(D, 0), e2 = derivative(D, 1);
    Eigen::MatrixXd product = Eigen::MatrixXd::Zero(dim(D), dim(D));
    for (Eigen::Index q = 0; q < k.rule.w.size(); ++q) {
      const Points xi = point(s, k.rule.x(0, q), k.rule.x(1, q));
      const Eigen::VectorXd v = monomials(D, xi);
      product += k.rule.w[q] * v * v.transpose();
    }
    Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(dim(D), 4);  // d1 u1, d2 u1, d1 u2, d2 u2
    gradient.topRows(N) << strain.col(0), strain.col(1) + r, strain.col(1) - r, strain.col(2);
    const int n = dim(D) - 1;
    const Eigen::MatrixXd laplace = (e1.transpose() * product * e1 + e2.transpose() * product * e2);
    const Eigen::LLT<Eigen::MatrixXd> llt(laplace.bottomRightCorner(n, n));
    double moment_left = 0;
    for (int row = 0; row < 2; ++row) {
      const Eigen::VectorXd right =
          e1.transpose() * (product * gradient.col(2 * row)) + e2.transpose() * (product * gradient.col(2 * row + 1));
      const Eigen::VectorXd u = llt.solve(Eigen::VectorXd(right.tail(n)));
      Eigen::VectorXd rest = -u;
      for (int b = 1; b < U / 2; ++b) rest[b - 1] += all[F + 2 * b + row] / s.h;
      moment_left += row == 0 ? -product.row(2).tail(n).dot(rest) : product.row(1).tail(n).dot(rest);
    }
    r[0] = -moment_left / (product(1, 1) + product(2, 2));
    return r;
  }

  static Eigen::Vector4d stress_at(const Scaled& s, const Eigen::Ref<const Eigen::VectorXd>& c, const Vec2& xi) {
    const auto v = monomials_at(xi);
    Eigen::Vector4d value = Eigen::Vector4d::Zero();
    for (int m = 0; m < P; ++m) value += v[m] * c.template segment<4>(4 * m);
    if constexpr (W > 0) {
      const auto curl = curls_at(s, xi, v);
      for (int b = 0; b < W; ++b) {
        value.template head<2>() += c[4 * P + 2 * b] * curl.row(b).transpose();
        value.template tail<2>() += c[4 * P + 2 * b + 1] * curl.row(b).transpose();
      }
    }
    return value;
  }

  static Eigen::Vector4d stress_at_point(const Triangle& t, const Eigen::Ref<const Eigen::VectorXd>& c, const Vec2& x) {
    const Scaled s = scale(t);
    return stress_at(s, c, (x - s.center) / s.h);
  }

  static Fields evaluate(const Triangle& t, const Eigen::Ref<const Eigen::VectorXd>& c, const Points& x) {
    const Scaled s = scale(t);
    Fields f{Eigen::Matrix4Xd(4, x.cols()), Points::Zero(2, x.cols()), Eigen::RowVectorXd::Zero(x.cols())};
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const Vec2 xi = (x.col(i) - s.center) / s.h;
      const auto v = monomials_at(xi);
      f.stress.col(i) = stress_at(s, c, xi);
      for (int b = 0; b < U / 2; ++b) f.displacement.col(i) += v[b] * c.template segment<2>(F + 2 * b);
      for (int r = 0; r < rotation_count(E); ++r) f.rotation[i] += v[r] * c[F + U + r];
    }
    return f;
  }

  static Eigen::VectorXd weigh(const Triangle& t, const Points& x, const Fields& w) {
    const Scaled s = scale(t);
    Eigen::VectorXd all = Eigen::VectorXd::Zero(interior_count(E));
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const Vec2 xi = (x.col(i) - s.center) / s.h;
      const auto v = monomials_at(xi);
      for (int m = 0; m < P; ++m) all.template segment<4>(4 * m) += v[m] * w.stress.col(i);
      if constexpr (W > 0) {
        const auto curl = curls_at(s, xi, v);
        for (int b = 0; b < W; ++b) {
          all[4 * P + 2 * b] += curl.row(b) * w.stress.col(i).template head<2>();
          all[4 * P + 2 * b + 1] += curl.row(b) * w.stress.col(i).template tail<2>();
        }
      }
      for (int b = 0; b < U / 2; ++b) all.template segment<2>(F + 2 * b) += v[b] * w.displacement.col(i);
      for (int r = 0; r < rotation_count(E); ++r) all[F + U + r] += v[r] * w.rotation[i];
    }
    return all;
  }
};

/// The functions of one element, by which local.cpp reaches the instance.
template <const Element& E>
constexpr Operations mixed_operations() {
  using Sized = MixedTriangle<E>;
  return {&Sized::condense,     &Sized::interior,    &Sized::evaluate,      &Sized::stress_at_point, &Sized::weigh,
          &Sized::local_system, &Sized::interior_of, &Sized::condense_dual, &Sized::interior_dual,   &Sized::interiors};
}

}  // namespace kerf
