#pragma once
// Elimination of stress, displacement and rotation of one triangle by two Cholesky factors, and the way back.

#include "solver/element/local_problem.hpp"

#include <cmath>

namespace kerf {

// y += f x and y -= f x, rows of N numbers: as Eigen's rows, which vectorize where plain loops did not (a third of the
// elimination's time).
template <int N>
inline void add(double* y, double f, const double* x) {
  Eigen::Map<Eigen::Matrix<double, 1, N>>(y).noalias() += f * Eigen::Map<const Eigen::Matrix<double, 1, N>>(x);
}
template <int N>
inline void subtract(double* y, double f, const double* x) {
  Eigen::Map<Eigen::Matrix<double, 1, N>>(y).noalias() -= f * Eigen::Map<const Eigen::Matrix<double, 1, N>>(x);
}

// In place, in the upper triangle: A = U'U, with the inverse of the diagonal on the diagonal.
template <int N>
inline __attribute__((always_inline)) void cholesky(Rowwise<N, N>& a) {
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
inline __attribute__((always_inline)) void forward(const Rowwise<N, N>& u, Rowwise<N, Columns>& x) {
  double* row = x.data();
  for (int k = 0; k < N; ++k, row += Columns) {
    for (int j = 0; j < Columns; ++j) row[j] *= u(k, k);
    for (int i = k + 1; i < N; ++i) subtract<Columns>(row + (i - k) * Columns, u(k, i), row);
  }
}
// x <- U^-1 x
template <int N>
void backward(const Rowwise<N, N>& u, Rowwise<N, 1>& x) {
  for (int i = N - 1; i >= 0; --i) {
    double sum = x[i];
    for (int k = i + 1; k < N; ++k) sum -= u(i, k) * x[k];
    x[i] = sum * u(i, i);
  }
}

template <int N, int Columns>
inline __attribute__((always_inline)) void backward(const Rowwise<N, N>& u, Rowwise<N, Columns>& x) {
  for (int i = N - 1; i >= 0; --i) {
    double* row = x.data() + i * Columns;
    for (int k = i + 1; k < N; ++k) subtract<Columns>(row, u(i, k), x.data() + k * Columns);
    for (int j = 0; j < Columns; ++j) row[j] *= u(i, i);
  }
}

// Elimination of s and (u, r), as far as every right-hand side needs it. M alone is singular at nu = 1/2; on the kernel
// of B it is not, but for a constant pressure, so M + gamma B'B, which has the same solution, has a Cholesky factor for
// every nu < 1/2:
//   L L' = M + gamma B'B (L' stored),  YB = L^-1 B',  LB LB' = YB'YB.
template <const Element& E>
struct Reduction : Space<E> {
  using Space<E>::S, Space<E>::B, Space<E>::X, Space<E>::V;
  Rowwise<S, S> L;
  Rowwise<B, B> LB;
  Rowwise<S, B> YB;
  Rowwise<B, 1> given;  // LB^-1 of the right-hand side of the constraints
  Rowwise<S, 1> YT;     // L^-1 of the trace, and LB^-1 YB'YT: with a penalty only
  Rowwise<B, 1> ZT;
  double gamma;
  double density;  // one over the area in xi

  Reduction(const LocalArrays<E, S>& a, const Material& material, const Penalty& penalty) {
    gamma = 1 / (2 * material.mu);
    density = 1 / a.area;
    factorize(a, penalty);
    YB = a.Bt;
    forward<S, B>(L, YB);
    set_zero(LB);
    for (int i = 0; i < S; ++i)
      for (int b = 0; b < B; ++b) add<B>(&LB(b, 0), YB(i, b), &YB(i, 0));
    cholesky<B>(LB);
    given = a.given;
    forward<B, 1>(LB, given);
    if (penalty.a > 0) {
      YT = a.trace;
      forward<S, 1>(L, YT);
      ZT = YB.transpose().lazyProduct(YT);
      forward<B, 1>(LB, ZT);
    }
  }

  // What a load on the stress functions, reduced to (L^-1 stress, low), adds to Condensed::F and Condensed::own; the
  // body force alone is (0, given): C L^-T (stress + YB LB^-T low).
  SkeletonVector pull(const LocalArrays<E, S>& a, const Scaled& s, Rowwise<S, 1> stress, Rowwise<B, 1> low) const {
    backward<B>(LB, low);
    stress += YB.lazyProduct(low);
    backward<S>(L, stress);
    SkeletonVector F = -s.h * a.Ct.transpose().lazyProduct(stress);
    if constexpr (V > 0) F.template tail<V>() *= s.h;  // rotations do not scale with the triangle
    return F;
  }
  double mean_trace(const Rowwise<S, 1>& stress, const Rowwise<B, 1>& low) const {
    return density * (YT.dot(stress) + ZT.dot(low));
  }

  // Right-hand sides of the dual problem: `stress` <- L^-1 stress, `own` <- LB^-1 own; returned is
  // LB^-1 (own - YB'stress).
  Rowwise<B, 1> reduce(Rowwise<S, 1>& stress, Rowwise<B, 1>& own) const {
    forward<S, 1>(L, stress);
    forward<B, 1>(LB, own);
    Rowwise<B, 1> from_stress = YB.transpose().lazyProduct(stress);
    forward<B, 1>(LB, from_stress);
    return own - from_stress;
  }

  // The solution s, (u_xi, r) for a trace m_xi. `low` is LB^-1 of the constraints' right-hand side `right` (less what
  // the stress load adds to it), `load` L^-1 of a load on the stresses.
  struct Solution {
    Rowwise<S, 1> stress;
    Rowwise<B, 1> inner;
  };
  Solution back(const LocalArrays<E, S>& a, const Rowwise<X, 1>& m, const Rowwise<B, 1>& low,
                const Rowwise<B, 1>& right, const Rowwise<S, 1>* load, const Penalty& penalty) const {
    // S_B (gamma given - p) = given - B M^-1 C' m,   s = M^-1 (C' m + B' (gamma given - p))
    Rowwise<S, 1> stress = a.Ct.lazyProduct(m);
    forward<S, 1>(L, stress);
    Rowwise<B, 1> p = YB.transpose().lazyProduct(stress);
    forward<B, 1>(LB, p);
    p = low - p;
    if (penalty.a > 0) p -= penalty.theta * ZT;
    backward<B>(LB, p);
    stress += YB.lazyProduct(p);
    if (load) stress += *load;
    if (penalty.a > 0) stress += penalty.theta * YT;
    backward<S>(L, stress);
    p = gamma * right - p;
    return {stress, p};
  }

  // The same for the traces of several fields side by side, without loads: s and -p.
  template <int Columns>
  struct Solutions {
    Rowwise<S, Columns> stress;
    Rowwise<B, Columns> inner;
  };
  template <int Columns>
  void back(const LocalArrays<E, S>& a, const Rowwise<X, Columns>& m, Solutions<Columns>& to) const {
    set_zero(to.stress);
    for (int i = 0; i < S; ++i)
      for (int x = 0; x < X; ++x)
        if (const double factor = a.Ct(i, x); factor != 0) add<Columns>(&to.stress(i, 0), factor, &m(x, 0));
    forward<S, Columns>(L, to.stress);
    set_zero(to.inner);
    for (int i = 0; i < S; ++i)
      for (int b = 0; b < B; ++b) add<Columns>(&to.inner(b, 0), YB(i, b), &to.stress(i, 0));
    forward<B, Columns>(LB, to.inner);
    backward<B, Columns>(LB, to.inner);
    for (int i = 0; i < S; ++i)
      for (int b = 0; b < B; ++b) subtract<Columns>(&to.stress(i, 0), YB(i, b), &to.inner(b, 0));
    backward<S, Columns>(L, to.stress);
  }

 private:
  void factorize(const LocalArrays<E, S>& a, const Penalty& penalty) {
    L = a.M;
    if (penalty.a > 0) L += density * penalty.a * a.trace * a.trace.transpose();
    for (int i = 0; i < S; ++i)
      for (int b = 0; b < B; ++b) {
        const double factor = gamma * a.Bt(i, b);
        if (factor != 0)
          for (int j = i; j < S; ++j) L(i, j) += factor * a.Bt(j, b);
      }
    cholesky<S>(L);
  }
};

// What the traces see of it:  YC = L^-1 C',  Z = LB^-1 YB'YC,  K = YC'YC - Z'Z. Half of the work.
template <const Element& E>
struct Elimination : Reduction<E> {
  using Reduction<E>::S, Reduction<E>::B, Reduction<E>::X, Reduction<E>::V;
  using Reduction<E>::L, Reduction<E>::LB, Reduction<E>::YB, Reduction<E>::given, Reduction<E>::YT, Reduction<E>::ZT,
      Reduction<E>::density;
  Rowwise<S, X> YC;
  Rowwise<B, X> Z;

  Elimination(const LocalArrays<E, S>& a, const Material& material, const Penalty& penalty)
      : Reduction<E>(a, material, penalty) {
    YC = a.Ct;
    forward<S, X>(L, YC);
    set_zero(Z);
    for (int i = 0; i < S; ++i)
      for (int b = 0; b < B; ++b) add<X>(&Z(b, 0), YB(i, b), &YC(i, 0));
    forward<B, X>(LB, Z);
  }

  // Condensed::F. s_f = L^-T YB LB^-T given, so that C s_f = Z' given.
  SkeletonVector load(const Scaled& s, const ForceMoments& force) const {
    SkeletonVector F = SkeletonVector::Zero(X);
    if (force.size() > 0) F = -s.h * (Z.transpose().lazyProduct(given));
    if constexpr (V > 0) F.template tail<V>() *= s.h;
    return F;
  }

  Condensed condensed(const Scaled& s, const ForceMoments& force, const Penalty& penalty) const {
    Rowwise<X, X> K;
    set_zero(K);
    for (int i = 0; i < S; ++i)
      for (int x = 0; x < X; ++x) add<X>(&K(x, 0), YC(i, x), &YC(i, 0));
    for (int b = 0; b < B; ++b)
      for (int x = 0; x < X; ++x) subtract<X>(&K(x, 0), Z(b, x), &Z(b, 0));
    Condensed result{SkeletonMatrix(X, X), load(s, force), {}, 0, 0};
    for (int j = 0; j < X; ++j)
      for (int i = 0; i < X; ++i) result.K(i, j) = K(i, j);
    if constexpr (V > 0) {  // rotations do not scale with the triangle
      result.K.template bottomRows<V>() *= s.h;
      result.K.template rightCols<V>() *= s.h;
    }
    if (penalty.a > 0) {
      result.trace = s.h * (YC.transpose().lazyProduct(YT) - Z.transpose().lazyProduct(ZT));
      if constexpr (V > 0) result.trace.template tail<V>() *= s.h;
      result.own = density * ZT.dot(given);
      result.by_theta = density * (YT.squaredNorm() - ZT.squaredNorm());
    }
    return result;
  }
};

}  // namespace kerf
