#pragma once
// The local problem of a mixed element before anything is eliminated, in arrays of compile-time size.

#include "base/dense.hpp"
#include "solver/element/bubble.hpp"

#include <algorithm>

namespace kerf {

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
template <const Element& E, int N, class Number = double>
struct LocalArrays : Space<E> {
  using Space<E>::B, Space<E>::X;
  Grid<Number, N, N> M;      // (A s, t) / h^2
  Grid<Number, N, B> Bt;     // transposed constraints: divergence, then asymmetry
  Grid<Number, N, X> Ct;     // transposed moments of s n, and of -as s against the rotations at vertices
  Grid<Number, B, 1> given;  // right-hand side of the constraints
  Grid<Number, N, 1> trace;  // int tr s
  double area = 0.5;         // of the triangle, in xi
};

template <const Element& E>
struct LocalProblem : Space<E> {
  using Base = Space<E>;
  using Base::P, Base::W, Base::F, Base::S, Base::U, Base::R, Base::B, Base::G, Base::V, Base::X, Base::Monomials,
      Base::monomials_at, Base::curls_at;
  using typename Base::Values;
  template <class Number>
  using FullOf = LocalArrays<E, F, Number>;
  using Full = FullOf<double>;
  template <class Number>
  using Compliance = std::array<std::array<Number, 4>, 4>;

  // Of products of monomials, of monomials with the curls (column 2 w + axis), of curls with each other.
  template <class Number>
  struct Moments {
    Grid<Number, Monomials, Monomials> monomials;
    Grid<Number, Monomials, 2 * W> with_curl;
    Grid<Number, 2 * W, 2 * W> curl_curl;
  };
  template <class Number>
  static void add_moments(const ScaledOf<Number>& s, const Vec2& l, double w, Moments<Number>& of) {
    const Plane<Number> xi = point<Number>(s, l.x(), l.y());
    const auto v = Base::template monomials_of<Number>(xi);
    for (int m = 0; m < Monomials; ++m) {
      const Number weighted = w * v[m];
      for (int n = m; n < Monomials; ++n) of.monomials(m, n) += weighted * v[n];
    }
    if constexpr (W > 0) {
      const auto curl = Base::template curls_at<Number>(s, xi, v);
      for (int m = 0; m < Monomials; ++m) {
        const Number weighted = w * v[m];
        for (int i = 0; i < 2 * W; ++i) of.with_curl(m, i) += weighted * curl(i / 2, i % 2);
      }
      for (int i = 0; i < 2 * W; ++i) {
        const Number weighted = w * curl(i / 2, i % 2);
        for (int j = i; j < 2 * W; ++j) of.curl_curl(i, j) += weighted * curl(j / 2, j % 2);
      }
    }
  }
  // One pass over the rule serves M, B and the traces: stresses, rotations and displacements are monomials of one list.
  // Symmetric arrays are filled above the diagonal, then mirrored.
  template <class Number>
  static Moments<Number> moments(const Kernel& k, const ScaledOf<Number>& s) {
    Moments<Number> of;
    set_zero(of.monomials);
    set_zero(of.with_curl);
    set_zero(of.curl_curl);
    for (Eigen::Index q = 0; q < k.rule.w.size(); ++q) add_moments<Number>(s, k.rule.x.col(q), 0.5 * k.rule.w[q], of);
    for (int m = 0; m < Monomials; ++m)
      for (int n = 0; n < m; ++n) of.monomials(m, n) = of.monomials(n, m);
    for (int i = 0; i < 2 * W; ++i)
      for (int j = 0; j < i; ++j) of.curl_curl(i, j) = of.curl_curl(j, i);
    return of;
  }

  // (A s, t) of monomial tensors; as s = s12 - s21 against the rotations; tr s against 1.
  template <class Number>
  static void add_tensors(const Moments<Number>& of, const Compliance<Number>& A, FullOf<Number>& a) {
    for (int m = 0; m < P; ++m) {
      for (int n = 0; n < P; ++n)
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 4; ++j) a.M(4 * m + i, 4 * n + j) = of.monomials(m, n) * A[i][j];
      a.trace[4 * m] = a.trace[4 * m + 3] = of.monomials(m, 0);
      for (int r = 0; r < R; ++r) {
        a.Bt(4 * m + 1, U + r) = of.monomials(m, r);
        a.Bt(4 * m + 2, U + r) = -of.monomials(m, r);
      }
    }
  }

  // The bubbles have neither divergence nor normal trace.
  template <class Number>
  static void add_bubbles(const Moments<Number>& of, const Compliance<Number>& A, FullOf<Number>& a) {
    for (int b = 0; b < W; ++b)
      for (int row = 0; row < 2; ++row) {
        const int i = 4 * P + 2 * b + row;
        for (int m = 0; m < P; ++m)
          for (int c = 0; c < 4; ++c)
            a.M(4 * m + c, i) = a.M(i, 4 * m + c) =
                A[c][2 * row] * of.with_curl(m, 2 * b) + A[c][2 * row + 1] * of.with_curl(m, 2 * b + 1);
        for (int d = 0; d < W; ++d)
          for (int other = 0; other < 2; ++other) {
            Number sum{};
            for (int c = 0; c < 4; ++c)
              sum += A[2 * row + c % 2][2 * other + c / 2] * of.curl_curl(2 * b + c % 2, 2 * d + c / 2);
            a.M(i, 4 * P + 2 * d + other) = sum;
          }
        a.trace[i] = of.with_curl(0, 2 * b + row);
        // as: component 12 of row 0 minus component 21 of row 1
        for (int r = 0; r < R; ++r) {
          if (row == 0)
            a.Bt(i, U + r) = of.with_curl(r, 2 * b + 1);
          else
            a.Bt(i, U + r) = -of.with_curl(r, 2 * b);
        }
      }
  }

  // div of monomial x^i y^j in component (row, axis) adds its derivative along axis to that row.
  template <class Number>
  static void add_divergence(const Moments<Number>& of, FullOf<Number>& a) {
    for (int degree = 1; degree <= E.stress; ++degree)
      for (int j = 0; j <= degree; ++j) {
        const int i = degree - j, m = place(i, j);
        for (int b = 0; b < U / 2; ++b)
          for (int row = 0; row < 2; ++row) {
            if (i > 0) a.Bt(4 * m + 2 * row, 2 * b + row) = static_cast<double>(i) * of.monomials(place(i - 1, j), b);
            if (j > 0)
              a.Bt(4 * m + 2 * row + 1, 2 * b + row) = static_cast<double>(j) * of.monomials(place(i, j - 1), b);
          }
      }
  }

  // What an edge is to the local problems: the directions of its components at the Gauss points, and where its own
  // direction begins.
  template <class Number>
  struct Side {
    std::array<std::array<Plane<Number>, 2>, G> frame;
    Number forward;  // 1, or 0
  };
  static Side<double> side_of(const Triangle& t, int e) {
    Side<double> side;
    for (int g = 0; g < G; ++g)
      for (int d = 0; d < 2; ++d)
        side.frame[static_cast<std::size_t>(g)][static_cast<std::size_t>(d)] = frame_at(t, e, g).col(d);
    side.forward = t.forward[e] ? 1 : 0;
    return side;
  }

  // Moments of s n against the trace functions. The nodal basis at the Gauss points is orthogonal (E.5): the moment
  // with function g is the value at point g times its weight. With stresses at vertices the trace is of lower degree
  // than s n, and a finer rule is taken.
  template <class Number>
  static void add_edge(const Kernel& k, const Side<Number>& own, const ScaledOf<Number>& s, int e, FullOf<Number>& a) {
    const int from = (e + 1) % 3, to = (e + 2) % 3;
    const Plane<Number> side = s.x[to] - s.x[from];
    const Number nx = side.y(), ny = -side.x();  // outward, times the length
    const auto add = [&](int g, double share, const auto& v) {
      for (int d = 0; d < 2; ++d) {
        const int column = 2 * (G * e + g) + d;
        const Plane<Number>& f = own.frame[static_cast<std::size_t>(g)][static_cast<std::size_t>(d)];
        const Number fx = share * f.x(), fy = share * f.y();
        const Number weight[4] = {fx * nx, fx * ny, fy * nx, fy * ny};
        for (int m = 0; m < P; ++m)
          for (int c = 0; c < 4; ++c) a.Ct(4 * m + c, column) += v[m] * weight[c];
      }
    };
    // With the normal stress in P_trace the Gauss points of the trace integrate its moments.
    constexpr bool fine = E.at_vertices == AtVertices::Stress;
    const EdgeRule& rule = fine ? k.edge : k.trace;
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const Number along = own.forward * rule.s[q] + (1.0 - own.forward) * (1 - rule.s[q]);
      const Plane<Number> at = s.x[from] + along * side;
      const auto v = Base::template monomials_of<Number>(at);
      if constexpr (fine)
        for (int g = 0; g < G; ++g) add(g, rule.w[q] * k.trace_at_edge(g, q), v);
      else
        add(static_cast<int>(q), rule.w[q], v);
    }
  }

  // -(as s, l_v): the continuous rotation is on the side of the skeleton, as a trace is.
  static void add_vertex(const Moments<double>& of, const Scaled& s, int v, Full& a) {
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
    // Four rows per point of the rule: S D', and its strain times the weight.
    const Eigen::Index points = k.curved.w.size();
    Eigen::MatrixXd stresses(4 * points, F), strains(4 * points, F);
    for (Eigen::Index q = 0; q < points; ++q) {
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
      stresses.middleRows<4>(4 * q) = G;
      strains.middleRows<4>(4 * q) = (w / map.J) * (A * G);
      for (int i = 0; i < F; ++i) {
        a.trace[i] += w * (G(0, i) + G(3, i));
        for (int r = 0; r < R; ++r) a.Bt(i, U + r) += w * v[r] * (G(1, i) - G(2, i));
      }
      a.area += w * map.J;
    }
    const Eigen::MatrixXd M = transposed_multiply(stresses, strains);
    for (int i = 0; i < F; ++i)
      for (int j = 0; j < F; ++j) a.M(i, j) = M(std::max(i, j), std::min(i, j));
  }

  // Of the means of the force, on the right-hand side of the constraints: the triangle's area in xi is 1/2.
  // B s = -h (f, v) (E.6).
  template <class Number>
  static Number share_of_force(const ScaledOf<Number>& s) {
    return -0.5 * s.h;
  }

  // Of a triangle with straight edges.
  template <class Number>
  static void add_straight(const Moments<Number>& of, const Compliance<Number>& A, FullOf<Number>& a) {
    add_tensors<Number>(of, A, a);
    if constexpr (W > 0) add_bubbles<Number>(of, A, a);
  }
  template <class Number>
  static void clear(FullOf<Number>& a) {
    set_zero(a.M);
    set_zero(a.Bt);
    set_zero(a.Ct);
    set_zero(a.trace);
    set_zero(a.given);
  }

  static Full assemble_full(const Kernel& k, const Triangle& t, const Scaled& s, const Material& material,
                            const ForceMoments& force) {
    Full a;
    clear(a);
    for (int i = 0; i < U && force.size() > 0; ++i) a.given[i] = share_of_force(s) * force[i];
    const Moments<double> of = moments<double>(k, s);
    const Eigen::Matrix4d A = compliance(material);
    bool straight = true;
    if constexpr (can_be_curved(E)) {
      straight = !is_curved(t);
      if (!straight) add_curved(k, t, s, A, a);
    }
    if (straight) {
      Compliance<double> rows;
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = A(i, j);
      add_straight<double>(of, rows, a);
    }
    add_divergence<double>(of, a);
    for (int e = 0; e < 3; ++e) add_edge<double>(k, side_of(t, e), s, e, a);
    if constexpr (V > 0)
      for (int v = 0; v < 3; ++v) add_vertex(of, s, v, a);
    return a;
  }

  // In the basis that the cut leaves; `given` concerns the constraints and stays.
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
