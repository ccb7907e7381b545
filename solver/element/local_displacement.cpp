// Continuous displacements P_1 and P_2 (`p1`, `p2`), to compare the mixed elements with: they lock as nu -> 1/2. One
// triangle has the stiffness
//   K = int C e(v) : e(w),   C e = 2 mu e + (1/(4 c) - mu) tr(e) I    (the inverse of the law (N.4); c > 0 is needed),
// or C of the orthotropic law. In the plane K does not depend on the size of the triangle: it is taken in the scaled
// coordinates of (E.6). Skeleton unknowns are values at vertices and, for P_2, in the middles of edges; nothing is
// eliminated. The stress is that of the gradient, C e(u), the rotation its skew part with the sign of (N.1). Notation:
// docs/theory/README.md; scaling: docs/theory/elements.md.

#include "base/dense.hpp"
#include "solver/anisotropic.hpp"
#include "solver/element/interior_fields.hpp"

namespace kerf {

namespace {

// Continuous P_k, k = 1, 2. Skeleton unknowns: the values in the middle of the edges (k = 2), then those at the
// vertices, each in its frame. Nothing is eliminated.
template <const Element& E>
struct DisplacementTriangle {
  static constexpr int Degree = E.displacement;
  static constexpr int N = dim(Degree);  // nodes
  static constexpr int P = dim(Degree - 1);
  static constexpr int Middles = Degree == 2 ? 3 : 0;

  // Monomial coefficients (rows) of the nodal basis (columns).
  static Eigen::MatrixXd basis(const Scaled& s) {
    Points nodes(2, N);
    for (int e = 0; e < Middles; ++e) nodes.col(e) = 0.5 * (s.x[(e + 1) % 3] + s.x[(e + 2) % 3]);
    for (int v = 0; v < 3; ++v) nodes.col(Middles + v) = s.x[v];
    return inverse(monomials(Degree, nodes).transpose());
  }

  // x, y components at the nodes from the components in their frames.
  static Eigen::MatrixXd turn(const Triangle& t) {
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(2 * N, 2 * N);
    for (int e = 0; e < Middles; ++e) q.block<2, 2>(2 * e, 2 * e) = t.frame[e];
    for (int v = 0; v < 3; ++v) q.block<2, 2>(2 * (Middles + v), 2 * (Middles + v)) = t.corner[v].topLeftCorner<2, 2>();
    return q;
  }

  static Eigen::Matrix4d orthotropic_stiffness(const Material& m) {
    const Eigen::Matrix3d C = stress_matrix(m);
    constexpr int at[4] = {0, 2, 2, 1};
    Eigen::Matrix4d a;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) a(i, j) = C(at[i], at[j]);
    return a;
  }

  // s = 2 mu e + (1/(4 c) - mu) tr(e) I on components 11, 12, 21, 22, from the displacement gradient.
  static Eigen::Matrix4d stiffness_of(const Material& m) {
    if (!isotropic(m)) return orthotropic_stiffness(m);
    const double bulk = 1 / (4 * m.c) - m.mu;
    Eigen::Matrix4d a;
    a << 2 * m.mu + bulk, 0, 0, bulk,  //
        0, m.mu, m.mu, 0,              //
        0, m.mu, m.mu, 0,              //
        bulk, 0, 0, 2 * m.mu + bulk;
    return a;
  }

  // Coefficients (4 P) of the displacement gradient in xi from those of the displacement (2 N).
  static Eigen::MatrixXd gradient() {
    Eigen::MatrixXd g = Eigen::MatrixXd::Zero(4 * P, 2 * N);
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::MatrixXd d = derivative(Degree, axis);
      for (int p = 0; p < P; ++p)
        for (int n = 0; n < N; ++n)
          for (int row = 0; row < 2; ++row) g(4 * p + 2 * row + axis, 2 * n + row) = d(p, n);
    }
    return g;
  }

  static Eigen::MatrixXd both_components(const Eigen::MatrixXd& a) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(2 * N, 2 * N);
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) all(2 * i, 2 * j) = all(2 * i + 1, 2 * j + 1) = a(i, j);
    return all;
  }

  // The moments of the force are means over the triangle, hence the factor area(t). There is no penalty: nothing is
  // raised near nu = 1/2.
  static Condensed condense(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force,
                            const Penalty&) {
    const Scaled s = scale(t);
    const Eigen::MatrixXd nodal = multiply(both_components(basis(s)), turn(t));
    const Eigen::MatrixXd g = multiply(gradient(), nodal);
    const Eigen::Matrix4d a = stiffness_of(material);
    Eigen::MatrixXd moment = Eigen::MatrixXd::Zero(P, P);
    for (Eigen::Index q = 0; q < k.rule.w.size(); ++q) {
      const Points xi = point(s, k.rule.x(0, q), k.rule.x(1, q));
      const Eigen::VectorXd v = monomials(Degree - 1, xi);
      moment += 0.5 * k.rule.w[q] * v * v.transpose();
    }
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(2 * N, 2 * N);
    for (int m = 0; m < P; ++m)
      for (int n = 0; n < P; ++n) K += moment(m, n) * g.middleRows<4>(4 * m).transpose() * a * g.middleRows<4>(4 * n);
    Condensed result{0.5 * (K + K.transpose()), SkeletonVector::Zero(2 * N), {}, 0, 0};
    if (force.size() > 0) result.F = area(t) * transposed_multiply(nodal, force);
    return result;
  }

  // The coefficients (s, u, r) as a mixed element has them, so that all later code reads fields in one form: s and r in
  // P_(k-1), u in P_k.
  static Eigen::VectorXd interior(const Kernel& k, const Triangle& t, const Material& material,
                                  const ForceMoments& force, const SkeletonVector& m, const Penalty& penalty,
                                  TraceForces* forces) {
    if (forces) {
      Condensed c = condense(k, t, material, force, penalty);
      *forces = {c.K * m, std::move(c.F)};
    }
    const Scaled s = scale(t);
    const Eigen::VectorXd u = multiply(both_components(basis(s)), multiply(turn(t), m));
    const Eigen::VectorXd g = multiply(gradient(), u) / s.h;
    const Eigen::Matrix4d a = stiffness_of(material);
    Eigen::VectorXd all(interior_count(E));
    for (int p = 0; p < P; ++p) {
      all.segment<4>(4 * p) = a * g.segment<4>(4 * p);
      all[4 * P + 2 * N + p] = 0.5 * (g[4 * p + 1] - g[4 * p + 2]);
    }
    all.segment<2 * N>(4 * P) = u;
    return all;
  }
};

template <const Element& E>
constexpr Operations displacement_element_operations() {
  using Sized = InteriorFields<E>;
  return {&DisplacementTriangle<E>::condense, &DisplacementTriangle<E>::interior, &Sized::evaluate,
          &Sized::stress_at_point, &Sized::weigh};
}

constexpr Element linear = displacement_element(1), quadratic = displacement_element(2);
constexpr std::array<Operations, 2> run{displacement_element_operations<linear>(),
                                        displacement_element_operations<quadratic>()};

}  // namespace

const Operations* displacement_operations(int degree);
const Operations* displacement_operations(int degree) {
  return &run.at(static_cast<std::size_t>(degree) - 1);
}

}  // namespace kerf
