#pragma once
// Elimination of stress, displacement and rotation of one triangle by two Cholesky factors, and the way back.

#include "solver/element/local_problem.hpp"
#include "solver/element/pack_kernels.hpp"

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
template <int N>
inline void add(Pack* y, const Pack& f, const Pack* x) {
  for (int j = 0; j < N; ++j) y[j] += f * x[j];
}

// to += factor A'B; of a symmetric product packs find the upper part alone. Rows of numbers are whole, so that they
// vectorize.
template <Wanted W, int Terms, int Rows, int Columns>
inline void add_product(const Rowwise<Terms, Rows>& A, const Rowwise<Terms, Columns>& B, double factor,
                        Rowwise<Rows, Columns>& to) {
  for (int k = 0; k < Terms; ++k)
    for (int i = 0; i < Rows; ++i) add<Columns>(&to(i, 0), factor * A(k, i), &B(k, 0));
}
template <Wanted W, int Terms, int Rows, int Columns>
inline void add_product(const PackGrid<Terms, Rows>& A, const PackGrid<Terms, Columns>& B, double factor,
                        PackGrid<Rows, Columns>& to) {
  const Pack all{factor, factor, factor, factor};
  add_products<W>(
      to, Terms, [&](int k, int i) { return A(k, i); }, [&](int k, int j) { return B(k, j); }, all);
}

// A'x and A x, and x.y.
template <class Number, int Rows, int Columns>
inline Grid<Number, Columns, 1> transposed_product(const Grid<Number, Rows, Columns>& A,
                                                   const Grid<Number, Rows, 1>& x) {
  if constexpr (std::is_same_v<Number, double>) {
    return A.transpose().lazyProduct(x);
  } else {
    Grid<Number, Columns, 1> y;
    set_zero(y);
    for (int i = 0; i < Rows; ++i) add<Columns>(y.data(), x[i], A.data() + i * Columns);
    return y;
  }
}
template <class Number, int Rows, int Columns>
inline Grid<Number, Rows, 1> product(const Grid<Number, Rows, Columns>& A, const Grid<Number, Columns, 1>& x) {
  if constexpr (std::is_same_v<Number, double>) {
    return A.lazyProduct(x);
  } else {
    Grid<Number, Rows, 1> y;
    for (int i = 0; i < Rows; ++i) {
      Number sum{};
      for (int j = 0; j < Columns; ++j) sum += A(i, j) * x[j];
      y[i] = sum;
    }
    return y;
  }
}
template <class Number, int Rows>
inline Number dot(const Grid<Number, Rows, 1>& x, const Grid<Number, Rows, 1>& y) {
  Number sum{};
  for (int i = 0; i < Rows; ++i) sum += x[i] * y[i];
  return sum;
}

// In place, in the upper triangle: A = U'U, with the inverse of the diagonal on the diagonal.
template <int N, class Number = double>
inline __attribute__((always_inline)) void cholesky(Grid<Number, N, N>& a) {
  if constexpr (!std::is_same_v<Number, double>) {
    cholesky_packs<N>(a);
  } else {
    for (int k = 0; k < N; ++k) {
      const double inverse = one_over_root(a(k, k));
      a(k, k) = inverse;
      for (int j = k + 1; j < N; ++j) a(k, j) *= inverse;
      for (int i = k + 1; i < N; ++i) {
        const double factor = a(k, i);
        for (int j = i; j < N; ++j) a(i, j) -= factor * a(k, j);
      }
    }
  }
}
// x <- U'^-1 x
template <int N, int Columns, class Number = double>
inline __attribute__((always_inline)) void forward(const Grid<Number, N, N>& u, Grid<Number, N, Columns>& x) {
  if constexpr (!std::is_same_v<Number, double>) {
    forward_packs<N, Columns>(u, x);
  } else {
    double* row = x.data();
    for (int k = 0; k < N; ++k, row += Columns) {
      for (int j = 0; j < Columns; ++j) row[j] *= u(k, k);
      for (int i = k + 1; i < N; ++i) subtract<Columns>(row + (i - k) * Columns, u(k, i), row);
    }
  }
}
// x <- U^-1 x
template <int N, class Number = double>
void backward(const Grid<Number, N, N>& u, Grid<Number, N, 1>& x) {
  for (int i = N - 1; i >= 0; --i) {
    Number sum = x[i];
    for (int k = i + 1; k < N; ++k) sum -= u(i, k) * x[k];
    x[i] = sum * u(i, i);
  }
}

template <int N, int Columns>
inline __attribute__((always_inline)) void backward_rows(const Rowwise<N, N>& u, Rowwise<N, Columns>& x) {
  for (int i = N - 1; i >= 0; --i) {
    double* row = x.data() + i * Columns;
    for (int k = i + 1; k < N; ++k) subtract<Columns>(row, u(i, k), x.data() + k * Columns);
    for (int j = 0; j < Columns; ++j) row[j] *= u(i, i);
  }
}

// Of each triangle: gamma = 1/(2 mu), the penalty.
// gamma B'B has the size of the deviatoric compliance: M + gamma B'B is balanced whatever mu is.
template <class Number>
struct Compliant {
  Number gamma;
  Number a{}, theta{};
  bool penalized = false;
};
inline Compliant<double> compliant(const Material& material, const Penalty& penalty) {
  return {1 / (2 * material.mu), penalty.a, penalty.theta, penalty.a > 0};
}

// Elimination of s and (u, r), as far as every right-hand side needs it. M alone is singular at nu = 1/2; on the kernel
// of B it is not, but for a constant pressure, so M + gamma B'B, which has the same solution, has a Cholesky factor for
// every nu < 1/2:
//   L L' = M + gamma B'B (L' stored),  YB = L^-1 B',  LB LB' = YB'YB.
template <const Element& E, class Number = double>
struct Reduction : Space<E> {
  using Space<E>::S, Space<E>::B, Space<E>::X, Space<E>::V;
  using Arrays = LocalArrays<E, S, Number>;
  Grid<Number, S, S> L;
  Grid<Number, B, B> LB;
  Grid<Number, S, B> YB;
  Grid<Number, B, 1> given;  // LB^-1 of the right-hand side of the constraints
  Grid<Number, S, 1> YT;     // L^-1 of the trace, and LB^-1 YB'YT: with a penalty only
  Grid<Number, B, 1> ZT;
  Number gamma;
  double density;  // one over the area in xi

  // [theory: E.7]. With a penalty M gets a/|T| t t' as well (E.12), and YT, ZT carry the load theta t and the mean of
  // the trace (E.13, E.14).
  Reduction(const Arrays& a, const Compliant<Number>& is) {
    gamma = is.gamma;
    density = 1 / a.area;
    factorize(a, is);
    YB = a.Bt;
    forward<S, B, Number>(L, YB);
    set_zero(LB);
    add_product<Wanted::Upper, S, B, B>(YB, YB, 1, LB);
    cholesky<B, Number>(LB);
    given = a.given;
    forward<B, 1, Number>(LB, given);
    if (is.penalized) {
      YT = a.trace;
      forward<S, 1, Number>(L, YT);
      ZT = transposed_product<Number, S, B>(YB, YT);
      forward<B, 1, Number>(LB, ZT);
    }
  }

  // What a load on the stress functions, reduced to (L^-1 stress, low), adds to Condensed::F and Condensed::own; the
  // body force alone is (0, given): C L^-T (stress + YB LB^-T low).
  Grid<Number, X, 1> pull(const Arrays& a, const ScaledOf<Number>& s, Grid<Number, S, 1> stress,
                          Grid<Number, B, 1> low) const {
    backward<B, Number>(LB, low);
    const Grid<Number, S, 1> from_low = product<Number, S, B>(YB, low);
    for (int i = 0; i < S; ++i) stress[i] += from_low[i];
    backward<S, Number>(L, stress);
    return tractions(a, s, stress, -s.h);
  }
  // Its tractions, times `factor`.
  static Grid<Number, X, 1> tractions(const Arrays& a, const ScaledOf<Number>& s, const Grid<Number, S, 1>& stress,
                                      const Number& factor) {
    return scaled(s, transposed_product<Number, S, X>(a.Ct, stress), factor);
  }
  // Rotations at vertices do not scale with the triangle.
  static Grid<Number, X, 1> scaled(const ScaledOf<Number>& s, Grid<Number, X, 1> F, const Number& factor) {
    for (int x = 0; x < X; ++x) F[x] *= x < X - V ? factor : Number(factor * s.h);
    return F;
  }
  // mean(tr s) of a load alone: 1/|T| t . s with s eliminated, all in xi.
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
    Grid<Number, S, 1> stress;
    Grid<Number, B, 1> inner;
  };
  // s = L^-T (L^-1 C'm + YB q), q = LB^-T (low - LB^-1 YB'L^-1 C'm), and p = gamma right - q: the proof stands at
  // (E.7).
  Solution back(const Arrays& a, const Grid<Number, X, 1>& m, const Grid<Number, B, 1>& low,
                const Grid<Number, B, 1>& right, const Grid<Number, S, 1>* load, const Compliant<Number>& is) const {
    // S_B (gamma given - p) = given - B M^-1 C' m,   s = M^-1 (C' m + B' (gamma given - p))
    Solution to;
    to.stress = product<Number, S, X>(a.Ct, m);
    forward<S, 1, Number>(L, to.stress);
    Grid<Number, B, 1>& p = to.inner;
    p = transposed_product<Number, S, B>(YB, to.stress);
    forward<B, 1, Number>(LB, p);
    for (int b = 0; b < B; ++b) p[b] = low[b] - p[b];
    if (is.penalized)
      for (int b = 0; b < B; ++b) p[b] -= is.theta * ZT[b];
    backward<B, Number>(LB, p);
    const Grid<Number, S, 1> from_p = product<Number, S, B>(YB, p);
    for (int i = 0; i < S; ++i) {
      to.stress[i] += from_p[i];
      if (load) to.stress[i] += (*load)[i];
      if (is.penalized) to.stress[i] += is.theta * YT[i];
    }
    backward<S, Number>(L, to.stress);
    for (int b = 0; b < B; ++b) p[b] = gamma * right[b] - p[b];
    return to;
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
    backward_rows<B, Columns>(LB, to.inner);
    for (int i = 0; i < S; ++i)
      for (int b = 0; b < B; ++b) subtract<Columns>(&to.stress(i, 0), YB(i, b), &to.inner(b, 0));
    backward_rows<S, Columns>(L, to.stress);
  }

 private:
  // M + a/|T| t t' + gamma B'B. All terms are positive semidefinite; on a constant pressure only c and a are left.
  void factorize(const Arrays& a, const Compliant<Number>& is) {
    L = a.M;
    if (is.penalized)
      for (int i = 0; i < S; ++i) {
        const Number factor = density * is.a * a.trace[i];
        for (int j = i; j < S; ++j) L(i, j) += factor * a.trace[j];
      }
    add_constraints(a.Bt);
    cholesky<S, Number>(L);
  }
  // gamma B'B, its upper part.
  void add_constraints(const Grid<Number, S, B>& Bt) {
    if constexpr (std::is_same_v<Number, double>) {
      for (int i = 0; i < S; ++i)
        for (int b = 0; b < B; ++b) {
          const double factor = gamma * Bt(i, b);
          if (factor == 0) continue;
          for (int j = i; j < S; ++j) L(i, j) += factor * Bt(j, b);
        }
    } else {
      add_products<Wanted::Upper>(
          L, B, [&](int b, int i) { return Bt(i, b); }, [&](int b, int j) { return Bt(j, b); }, gamma);
    }
  }
};

// What the traces see of it:  YC = L^-1 C',  Z = LB^-1 YB'YC,  K = YC'YC - Z'Z. Half of the work.
template <const Element& E, class Number = double>
struct Elimination : Reduction<E, Number> {
  using Base = Reduction<E, Number>;
  using Base::L, Base::LB, Base::YB, Base::given, Base::YT, Base::ZT, Base::density;
  using Base::S, Base::B, Base::X, Base::V;
  Grid<Number, S, X> YC;
  Grid<Number, B, X> Z;

  Elimination(const LocalArrays<E, S, Number>& a, const Compliant<Number>& is) : Base(a, is) {
    YC = a.Ct;
    forward<S, X, Number>(L, YC);
    set_zero(Z);
    add_product<Wanted::All, S, B, X>(YB, YC, 1, Z);
    forward<B, X, Number>(LB, Z);
  }

  // One triangle's share (lane `at`) as Condensed. `forced`: there is a body force; F = -h C s_f with
  // s_f = L^-T YB LB^-T given, so that C s_f = Z'given.
  struct Shares {
    Grid<Number, X, X> K;
    Grid<Number, X, 1> F, trace;
    Number own{}, by_theta{};
    bool forced, penalized;

    Condensed of(int at) const {
      Condensed c{SkeletonMatrix(X, X), SkeletonVector::Zero(X), {}, 0, 0};
      for (int j = 0; j < X; ++j)
        for (int i = 0; i < X; ++i) c.K(i, j) = lane(i <= j ? K(i, j) : K(j, i), at);
      for (int i = 0; forced && i < X; ++i) c.F[i] = lane(F[i], at);
      if (!penalized) return c;
      c.trace.resize(X);
      for (int i = 0; i < X; ++i) c.trace[i] = lane(trace[i], at);
      c.own = lane(own, at);
      c.by_theta = lane(by_theta, at);
      return c;
    }
  };
  // K = YC'YC - Z'Z, which grows like 1/c towards nu = 1/2 by its resistance to changes of the area. by_theta = (YT .
  // YT - ZT . ZT)/|T| is mean(tr s) per theta.
  Shares shares(const ScaledOf<Number>& s, bool forced, const Compliant<Number>& is) const {
    Shares to;
    to.forced = forced;
    to.penalized = is.penalized;
    set_zero(to.K);
    add_product<Wanted::Upper, S, X, X>(YC, YC, 1, to.K);
    add_product<Wanted::Upper, B, X, X>(Z, Z, -1, to.K);
    if constexpr (V > 0)  // rotations do not scale with the triangle
      for (int i = 0; i < X; ++i)
        for (int j = X - V; j < X; ++j) to.K(i, j) *= i < X - V ? s.h : Number(s.h * s.h);
    if (forced) to.F = Base::scaled(s, transposed_product<Number, B, X>(Z, given), -s.h);
    if (!is.penalized) return to;
    to.trace = transposed_product<Number, S, X>(YC, YT);
    const Grid<Number, X, 1> low = transposed_product<Number, B, X>(Z, ZT);
    for (int i = 0; i < X; ++i) to.trace[i] -= low[i];
    to.trace = Base::scaled(s, to.trace, s.h);
    to.own = density * dot<Number, B>(ZT, given);
    to.by_theta = density * (dot<Number, S>(YT, YT) - dot<Number, B>(ZT, ZT));
    return to;
  }
};

}  // namespace kerf
