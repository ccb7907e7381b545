// The conforming Arnold-Winther element `arnold-winther-c` [Arnold, Winther 2002]: the stress tensors at the vertices
// are skeleton unknowns v beside P_1 traces m on the edges. With s = I z + E v, I the stresses that vanish at the
// vertices, the local problem is stationary in y = (z, u) for x = (m, v),
//   L = 1/2 y'Y y + y'C x + 1/2 x'D x - y'g - x'f,   K = C'Y^-1 C - D,   F = C'Y^-1 g - f,
// K being minus the Hessian of the stationary value: positive in the traces, negative in v, quasi-definite as a whole.
// The normal stress on an edge is cubic while its trace is linear; the rest of the prescribed displacement (Legendre
// coefficients 2 and 3) enters as the load g, f. Given tractions fix stresses at vertices [theory: E.16]. Derived in
// docs/theory/elements.md, section Stresses at vertices. Small dense matrices: an element to check others with.

#include "solver/element/interior_fields.hpp"

#include "base/dense.hpp"

#include <cmath>

namespace kerf {

namespace {

constexpr const Element& E = arnold_winther_conforming;
using Base = Space<E>;

struct Split {
  LocalArrays<E, Base::S> system;
  Eigen::MatrixXd span;          // F x S
  Eigen::VectorXd edge;          // S: int (u_D - its linear part) . s n, in xi
  Eigen::MatrixXd inner, outer;  // S x (S - 9) and S x 9: no values at the vertices; unit values in the vertex frames
};

// Legendre polynomials 2 and 3 are orthogonal to the linear trace. Four Gauss points are exact for their products with
// cubic normal stresses.
Eigen::VectorXd edge_load(const Triangle& t, const Scaled& s, const Eigen::Matrix<double, cubic_trace_count, 1>& data) {
  static const EdgeRule rule = gauss(4);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(Base::F);
  for (int e = 0; e < 3; ++e) {
    const Vec2 side = s.x[(e + 2) % 3] - s.x[(e + 1) % 3], n(side.y(), -side.x());
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const Vec2 u =
          legendre(2, rule.s[q]) * data.segment<2>(4 * e) + legendre(3, rule.s[q]) * data.segment<2>(4 * e + 2);
      const double along = t.forward[e] ? rule.s[q] : 1 - rule.s[q];
      const auto v = Base::monomials_at(s.x[(e + 1) % 3] + along * side);
      for (int m = 0; m < Base::P; ++m)
        for (int c = 0; c < 4; ++c) load[4 * m + c] += rule.w[q] / s.h * v[m] * u[c / 2] * n[c % 2];
    }
  }
  return load;
}

// `outer` is the pseudoinverse of the map to the values at the vertices: unit values there with the smallest
// coefficients. That choice among all representatives changes z, and nothing that is left.
Split split(const Kernel& k, const Triangle& t, const Scaled& s, const Material& material, const ForceMoments& force) {
  const ForceMoments body = force.head(force.size() > 0 ? Base::U : 0);
  Split r{LocalProblem<E>::assemble(k, t, s, material, body), span_of(k, s), Eigen::VectorXd::Zero(Base::S), {}, {}};
  if (force.size() > 0) r.edge = transposed_multiply(r.span, edge_load(t, s, force.tail<cubic_trace_count>()));
  // Values at the vertices as (s11, s22, sqrt(2) s12) in the vertex's frame.
  Eigen::MatrixXd values(9, Base::F);
  for (int v = 0; v < 3; ++v) {
    const auto at = Base::monomials_at(s.x[v]);
    Eigen::MatrixXd here = Eigen::MatrixXd::Zero(3, Base::F);
    for (int m = 0; m < Base::P; ++m) {
      here(0, 4 * m) = here(1, 4 * m + 3) = at[m];
      here(2, 4 * m + 1) = here(2, 4 * m + 2) = at[m] / std::sqrt(2.0);
    }
    values.middleRows<3>(3 * v) = t.corner[v].transpose() * here;
  }
  const Eigen::MatrixXd at_vertices = multiply(values, r.span);
  r.inner = null_space(at_vertices);
  r.outer = transposed_multiply(at_vertices, inverse(multiply_transposed(at_vertices, at_vertices)));
  return r;
}

// L(y, x) = 1/2 y'Y y + y'C x + 1/2 x'D x - y'g - x'f with y = (z, u) and x = (m, v) in xi: stationary in y.
struct Blocks {
  Eigen::MatrixXd Y, C, D;
  Eigen::VectorXd g, f;
};

// The work of tractions is -<m, s n>: the minus signs of the blocks with Ct.
Blocks blocks(const Split& p) {
  constexpr int Z = Base::S - 9, U = Base::U, M = Base::X, V = 9;
  const Eigen::MatrixXd M_full = p.system.M, Bt = p.system.Bt, Ct = p.system.Ct,
                        inner_M = transposed_multiply(p.inner, M_full);
  Blocks b{Eigen::MatrixXd::Zero(Z + U, Z + U), Eigen::MatrixXd::Zero(Z + U, M + V),
           Eigen::MatrixXd::Zero(M + V, M + V), Eigen::VectorXd::Zero(Z + U), Eigen::VectorXd::Zero(M + V)};
  b.Y.topLeftCorner(Z, Z) = multiply(inner_M, p.inner);
  b.Y.topRightCorner(Z, U) = transposed_multiply(p.inner, Bt);
  b.Y.bottomLeftCorner(U, Z) = b.Y.topRightCorner(Z, U).transpose();
  b.C.topLeftCorner(Z, M) = -transposed_multiply(p.inner, Ct);
  b.C.topRightCorner(Z, V) = multiply(inner_M, p.outer);
  b.C.bottomRightCorner(U, V) = transposed_multiply(Bt, p.outer);
  b.D.topRightCorner(M, V) = -transposed_multiply(Ct, p.outer);
  b.D.bottomLeftCorner(V, M) = b.D.topRightCorner(M, V).transpose();
  b.D.bottomRightCorner(V, V) = multiply(transposed_multiply(p.outer, M_full), p.outer);
  b.g.head(Z) = transposed_multiply(p.inner, p.edge);
  b.g.tail(U) = p.system.given;
  b.f.tail(V) = transposed_multiply(p.outer, p.edge);
  return b;
}

// Physical unknowns are m = h m_xi; v has no length in it. Forces of L scale with h^2.
Eigen::VectorXd weights(double h) {
  Eigen::VectorXd w = Eigen::VectorXd::Ones(Base::X + 9);
  w.tail(9).setConstant(h);
  return w;
}

struct VertexStressTriangle {
  static Condensed condense(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force,
                            const Penalty&) {
    const Scaled s = scale(t);
    const Blocks b = blocks(split(k, t, s, material, force));
    const Eigen::MatrixXd half = solve_lu(b.Y, b.C);
    const Eigen::MatrixXd schur = transposed_multiply(b.C, half) - b.D;  // minus the Hessian of the stationary value
    const Eigen::VectorXd w = weights(s.h);
    Condensed result{w.asDiagonal() * (0.5 * (schur + schur.transpose())).eval() * w.asDiagonal(),
                     SkeletonVector::Zero(Base::X + 9),
                     {},
                     0,
                     0};
    // y = Y^-1 (g - C x): minus the gradient is schur x - C'Y^-1 g + f.
    if (force.size() > 0) result.F = s.h * w.cwiseProduct(transposed_multiply(half, b.g) - b.f);
    return result;
  }

  static Eigen::VectorXd interior(const Kernel& k, const Triangle& t, const Material& material,
                                  const ForceMoments& force, const SkeletonVector& m, const Penalty& penalty,
                                  TraceForces* forces) {
    if (forces) {
      Condensed c = condense(k, t, material, force, penalty);
      *forces = {c.K * m, std::move(c.F)};
    }
    const Scaled s = scale(t);
    const Split p = split(k, t, s, material, force);
    const Blocks b = blocks(p);
    Eigen::VectorXd x = m / s.h;
    x.tail(9) = m.tail(9);
    const Eigen::VectorXd y = solve_lu(b.Y, b.g - multiply(b.C, x));
    constexpr int Z = Base::S - 9;
    Eigen::VectorXd all(interior_count(E));
    all.head<Base::F>() = multiply(p.span, multiply(p.inner, y.head(Z)) + multiply(p.outer, x.tail(9)));
    all.segment<Base::U>(Base::F) = s.h * y.tail<Base::U>();
    all.tail(rotation_count(E)) = rotation_of(k, s, material, all);
    return all;
  }
};

constexpr Operations run{&VertexStressTriangle::condense, &VertexStressTriangle::interior, &InteriorFields<E>::evaluate,
                         &InteriorFields<E>::stress_at_point, &InteriorFields<E>::weigh};

}  // namespace

const Operations* vertex_stress_operations();
const Operations* vertex_stress_operations() {
  return &run;
}

}  // namespace kerf
