#pragma once
// The local problem of a mixed element before anything is eliminated, in arrays of compile-time size.

#include "solver/element/bubble.hpp"

namespace kerf {

// Filled by plain loops: each expression of Eigen on each size is some ten classes to compile, and there are eleven
// elements with five sizes each.
template <int Rows, int Columns>
using Rowwise = Eigen::Matrix<double, Rows, Columns, Columns == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

template <class Array>
void set_zero(Array& a) {
  std::fill_n(a.data(), a.size(), 0.0);
}

// A s : t = dev s : dev t / (2 mu) + c tr s tr t on the components 11, 12, 21, 22.
Eigen::Matrix4d compliance(const Material& material);

// Rows of length `columns`, one after the other, as a matrix.
Eigen::MatrixXd by_columns(const double* a, int rows, int columns);

// Coefficients (F) of the stress functions that the cut leaves (columns).
Eigen::MatrixXd span_of(const Kernel& k, const Scaled& s);

// The arrays of a local problem by their sizes, row after row, for what need not know them at compile time.
template <class Number>
struct Rows {
  int functions, constraints, traces;
  Number *M, *Bt, *Ct, *trace;
};
// The local problem of the stresses n z: n'M n, n'Bt, n'Ct, n'trace.
void restrict_to(const Eigen::MatrixXd& n, const Rows<const double>& full, const Rows<double>& cut);

// `N` stress functions: those of the full tensors and bubbles (F), or those that the cut leaves (S).
template <const Element& E, int N>
struct LocalArrays : Space<E> {
  using Space<E>::B, Space<E>::X;
  Rowwise<N, N> M;      // (A s, t) / h^2
  Rowwise<N, B> Bt;     // transposed constraints: divergence, then asymmetry
  Rowwise<N, X> Ct;     // transposed moments of s n, and of -as s against the rotations at vertices
  Rowwise<B, 1> given;  // right-hand side of the constraints
  Rowwise<N, 1> trace;  // int tr s
  double area = 0.5;    // of the triangle, in xi
};

template <const Element& E>
struct LocalProblem : Space<E> {
  using Base = Space<E>;
  using Base::P, Base::W, Base::F, Base::S, Base::U, Base::R, Base::B, Base::G, Base::V, Base::X, Base::Monomials,
      Base::monomials_at, Base::curls_at;
  using typename Base::Values;
  using Full = LocalArrays<E, F>;

  // Of products of monomials, of monomials with the curls (column 2 w + axis), of curls with each other.
  struct Moments {
    Eigen::Matrix<double, Monomials, Monomials> monomials;
    Eigen::Matrix<double, Monomials, 2 * W> with_curl;
    Eigen::Matrix<double, 2 * W, 2 * W> curl_curl;
  };
  static Moments moments(const Kernel& k, const Scaled& s) {
    Moments of;
    set_zero(of.monomials);
    set_zero(of.with_curl);
    set_zero(of.curl_curl);
    for (Eigen::Index q = 0; q < k.rule.w.size(); ++q) {
      const double w = 0.5 * k.rule.w[q];
      const Vec2 xi = point(s, k.rule.x(0, q), k.rule.x(1, q));
      const Values v = monomials_at(xi);
      of.monomials += w * v * v.transpose();
      if constexpr (W > 0) {
        const auto curl = curls_at(s, xi, v);
        Eigen::Matrix<double, 2 * W, 1> flat;
        for (int i = 0; i < 2 * W; ++i) flat[i] = curl(i / 2, i % 2);
        of.with_curl += w * v * flat.transpose();
        of.curl_curl += w * flat * flat.transpose();
      }
    }
    return of;
  }

  static void add_tensors(const Moments& of, const Eigen::Matrix4d& A, Full& a) {
    for (int m = 0; m < P; ++m) {
      for (int n = 0; n < P; ++n)
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 4; ++j) a.M(4 * m + i, 4 * n + j) = of.monomials(m, n) * A(i, j);
      a.trace[4 * m] = a.trace[4 * m + 3] = of.monomials(m, 0);
      for (int r = 0; r < R; ++r) {
        a.Bt(4 * m + 1, U + r) = of.monomials(m, r);
        a.Bt(4 * m + 2, U + r) = -of.monomials(m, r);
      }
    }
  }

  // The bubbles have neither divergence nor normal trace.
  static void add_bubbles(const Moments& of, const Eigen::Matrix4d& A, Full& a) {
    for (int b = 0; b < W; ++b)
      for (int row = 0; row < 2; ++row) {
        const int i = 4 * P + 2 * b + row;
        for (int m = 0; m < P; ++m) {
          const Vec2 curl(of.with_curl(m, 2 * b), of.with_curl(m, 2 * b + 1));
          const Eigen::Vector4d column = A.middleCols<2>(2 * row) * curl;
          for (int c = 0; c < 4; ++c) a.M(4 * m + c, i) = a.M(i, 4 * m + c) = column[c];
        }
        for (int d = 0; d < W; ++d) {
          Mat2 curls;
          for (int c = 0; c < 4; ++c) curls(c % 2, c / 2) = of.curl_curl(2 * b + c % 2, 2 * d + c / 2);
          for (int other = 0; other < 2; ++other)
            a.M(i, 4 * P + 2 * d + other) = A.block<2, 2>(2 * row, 2 * other).cwiseProduct(curls).sum();
        }
        a.trace[i] = of.with_curl(0, 2 * b + row);
        // as: component 12 of row 0 minus component 21 of row 1
        for (int r = 0; r < R; ++r) a.Bt(i, U + r) = row == 0 ? of.with_curl(r, 2 * b + 1) : -of.with_curl(r, 2 * b);
      }
  }

  // div of monomial x^i y^j in component (row, axis) adds its derivative along axis to that row.
  static void add_divergence(const Moments& of, Full& a) {
    for (int degree = 1; degree <= E.stress; ++degree)
      for (int j = 0; j <= degree; ++j) {
        const int i = degree - j, m = place(i, j);
        for (int b = 0; b < U / 2; ++b)
          for (int row = 0; row < 2; ++row) {
            if (i > 0) a.Bt(4 * m + 2 * row, 2 * b + row) = i * of.monomials(place(i - 1, j), b);
            if (j > 0) a.Bt(4 * m + 2 * row + 1, 2 * b + row) = j * of.monomials(place(i, j - 1), b);
          }
      }
  }

  static void add_edge(const Kernel& k, const Triangle& t, const Scaled& s, int e, Full& a) {
    const int from = (e + 1) % 3, to = (e + 2) % 3;
    const Vec2 side = s.x[to] - s.x[from];
    const Vec2 n(side.y(), -side.x());  // outward, times the length
    const auto add = [&](int g, double share, const Values& v) {
      for (int d = 0; d < 2; ++d) {
        const int column = 2 * (G * e + g) + d;
        const Vec2 f = share * frame_at(t, e, g).col(d);
        const double weight[4] = {f.x() * n.x(), f.x() * n.y(), f.y() * n.x(), f.y() * n.y()};
        for (int m = 0; m < P; ++m)
          for (int c = 0; c < 4; ++c) a.Ct(4 * m + c, column) += v[m] * weight[c];
      }
    };
    // With the normal stress in P_trace the Gauss points of the trace integrate its moments.
    constexpr bool fine = E.at_vertices == AtVertices::Stress;
    const EdgeRule& rule = fine ? k.edge : k.trace;
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const double along = t.forward[e] ? rule.s[q] : 1 - rule.s[q];
      const Values v = monomials_at(s.x[from] + along * side);
      if constexpr (fine)
        for (int g = 0; g < G; ++g) add(g, rule.w[q] * k.trace_at_edge(g, q), v);
      else
        add(static_cast<int>(q), rule.w[q], v);
    }
  }

  static void add_vertex(const Moments& of, const Scaled& s, int v, Full& a) {
    // l_v = 1/3 + gradient . xi
    const Vec2& slope = s.gradient[v];
    const Eigen::Vector3d hat(1.0 / 3, slope.x(), slope.y());
    for (int m = 0; m < P; ++m) {
      const double value = of.monomials.template block<1, 3>(m, 0).dot(hat);
      a.Ct(4 * m, 6 * G + v) = a.Ct(4 * m + 3, 6 * G + v) = 0;
      a.Ct(4 * m + 1, 6 * G + v) = -value;
      a.Ct(4 * m + 2, 6 * G + v) = value;
    }
    static_assert(W > 0);
    for (int b = 0; b < W; ++b) {
      a.Ct(4 * P + 2 * b, 6 * G + v) = -of.with_curl.template block<3, 1>(0, 2 * b + 1).dot(hat);
      a.Ct(4 * P + 2 * b + 1, 6 * G + v) = of.with_curl.template block<3, 1>(0, 2 * b).dot(hat);
    }
  }

  // What a curved triangle has in place of add_tensors and add_bubbles. A stress function S of the chords' triangle
  // stands for S D'/J: divergence, normal trace and the work on displacements stay as they are [theory: E.26].
  static void add_curved(const Kernel& k, const Triangle& t, const Scaled& s, const Eigen::Matrix4d& A, Full& a) {
    a.area = 0;
    for (Eigen::Index q = 0; q < k.curved.w.size(); ++q) {
      const Vec2 l = k.curved.x.col(q), xi = point(s, l.x(), l.y());
      const CellMap map = cell_map(t, l);
      const double w = 0.5 * k.curved.w[q];
      const Values v = monomials_at(xi);
      Eigen::Matrix<double, 4, F> G;  // S D'
      set_zero(G);
      for (int m = 0; m < P; ++m)
        for (int c = 0; c < 4; ++c) G.template block<2, 1>(c / 2 * 2, 4 * m + c) = v[m] * map.D.col(c % 2);
      if constexpr (W > 0) {
        const auto curl = curls_at(s, xi, v);
        for (int b = 0; b < W; ++b)
          for (int row = 0; row < 2; ++row)
            G.template block<2, 1>(2 * row, 4 * P + 2 * b + row) = map.D * curl.row(b).transpose();
      }
      const Eigen::Matrix<double, 4, F> strain = (w / map.J) * (A * G);
      for (int i = 0; i < F; ++i) {
        for (int j = 0; j < F; ++j) a.M(i, j) += G.col(i).dot(strain.col(j));
        a.trace[i] += w * (G(0, i) + G(3, i));
        for (int r = 0; r < R; ++r) a.Bt(i, U + r) += w * v[r] * (G(1, i) - G(2, i));
      }
      a.area += w * map.J;
    }
  }

  // Of the means of the force, on the right-hand side of the constraints: the triangle's area in xi is 1/2.
  static double share_of_force(const Scaled& s) {
    return -0.5 * s.h;
  }

  static Full assemble_full(const Kernel& k, const Triangle& t, const Scaled& s, const Material& material,
                            const ForceMoments& force) {
    Full a;
    set_zero(a.M);
    set_zero(a.Bt);
    set_zero(a.Ct);
    set_zero(a.trace);
    set_zero(a.given);
    for (int i = 0; i < U && force.size() > 0; ++i) a.given[i] = share_of_force(s) * force[i];
    const Moments of = moments(k, s);
    const Eigen::Matrix4d A = compliance(material);
    bool straight = true;
    if constexpr (can_be_curved(E)) {
      straight = !is_curved(t);
      if (!straight) add_curved(k, t, s, A, a);
    }
    if (straight) {
      add_tensors(of, A, a);
      if constexpr (W > 0) add_bubbles(of, A, a);
    }
    add_divergence(of, a);
    for (int e = 0; e < 3; ++e) add_edge(k, t, s, e, a);
    if constexpr (V > 0)
      for (int v = 0; v < 3; ++v) add_vertex(of, s, v, a);
    return a;
  }

  static LocalArrays<E, S> assemble(const Kernel& k, const Triangle& t, const Scaled& s, const Material& material,
                                    const ForceMoments& force) {
    if constexpr (!Base::IsCut) {
      return assemble_full(k, t, s, material, force);
    } else {
      const Full full = assemble_full(k, t, s, material, force);
      LocalArrays<E, S> a;
      restrict_to(span_of(k, s), {F, B, X, full.M.data(), full.Bt.data(), full.Ct.data(), full.trace.data()},
                  {S, B, X, a.M.data(), a.Bt.data(), a.Ct.data(), a.trace.data()});
      a.given = full.given;
      return a;
    }
  }
};

}  // namespace kerf
