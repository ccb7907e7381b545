// Explicit derivatives of a Term when the vertices of the mesh move by theta, G = grad theta constant on a triangle.
// Stresses move with Piola's transformation, delta s = s G' - s div theta, all else by composition [theory: S.1]:
//   delta int j = int j div theta + d_x j . theta + j_s : (s G' - s div theta) + j_u . delta u*,
// u* as the moved stress recovers it [theory: R.1]: two small problems per triangle, one for u* and one for its adjoint
// w. Integrals over edges see a new place, length and normal while the unknowns stay: their derivative by the two ends
// is taken by differences of fourth order, exact to rounding for smooth data. Derived in docs/theory/shape_gradient.md,
// section "Moving vertices".

#include "topo/shape/moving.hpp"
#include "solver/system.hpp"

#include "base/dense.hpp"
#include "base/polynomial.hpp"
#include "kerf/recover.hpp"
#include "topo/functional/edge_crack_norm.hpp"
#include "topo/functional/integrate.hpp"
#include "topo/functional/places.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// grad u = A s + Gamma(omega), d_j u_i in row i.
Mat2 gradient_of(const Material& m, const Mat2& stress, double rotation) {
  Mat2 g = strain(m, stress);
  g(0, 1) += rotation;
  g(1, 0) -= rotation;
  return g;
}

void add_columns(Points& gradient, const Mesh& mesh, Index e, const Mat2& by) {
  for (int end = 0; end < 2; ++end) gradient.col(mesh.edges[e][end]) += by.col(end);
}

}  // namespace

// The opposite side turned by 90 degrees, over twice the area.
Eigen::Matrix<double, 2, 3> barycentric_gradients(const Triangle& t) {
  Eigen::Matrix<double, 2, 3> g;
  const double twice = 2 * area(t);
  for (int i = 0; i < 3; ++i) {
    const Vec2 e = t.x[(i + 2) % 3] - t.x[(i + 1) % 3];
    g.col(i) = Vec2(-e.y(), e.x()) / twice;
  }
  return g;
}

// Four points, (8 (f1 - f-1) - (f2 - f-2))/(12 h); one-sided of third order where f is not finite on one side.
Mat2 by_ends(const Vec2& a, const Vec2& b, const std::function<double(const Vec2&, const Vec2&)>& f) {
  // Truncation is h^4/30 of the fifth derivative, rounding about 1e-13 of f over the length.
  const double h = 1e-3 * (b - a).norm();
  Mat2 by;
  for (int end = 0; end < 2; ++end)
    for (int k = 0; k < 2; ++k) {
      const auto at = [&](double step) {
        const Vec2 d = step * h * Vec2::Unit(k);
        return end == 0 ? f(a + d, b) : f(a, b + d);
      };
      double& slope = by(k, end);
      slope = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h);
      for (const double side : {1, -1})  // data that end at the boundary
        if (!std::isfinite(slope))
          slope = side * (18 * at(side) - 9 * at(2 * side) + 2 * at(3 * side) - 11 * at(0)) / (6 * h);
    }
  return by;
}

// d_x j . theta at the points, theta linear on the triangle: to its vertices by the barycentric coordinates.
void add_place(const OfPlace& of, double share, TriangleMotion& motion) {
  const auto& [rule, x, size, here, f] = of;
  // A second difference of more than a hundredth of the largest value over so short a step is a jump of f, not its
  // slope.
  const double step = 1e-4 * size;
  constexpr double jump = 1e-2;
  const double largest = here.cwiseAbs().maxCoeff();
  for (Eigen::Index q = 0; q < x.cols(); ++q) {
    Vec2 slope;
    for (int k = 0; k < 2; ++k) {
      const Vec2 d = step * Vec2::Unit(k);
      const double after = f(q, x.col(q) + d), before = f(q, x.col(q) - d);
      const bool jumps =
          std::abs(after - 2 * here[q] + before) > jump * std::max({largest, std::abs(after), std::abs(before)});
      slope[k] = jumps ? 0 : (after - before) / (2 * step);
    }
    motion.rest += share * rule.w[q] * slope * barycentric(rule, q).transpose();
  }
}

// The normal leaves the triangle that the edge has: to the right where that is on the left.
MovedEdge moved_edge(const Mesh& mesh, Index e, const Vec2& a, const Vec2& b) {
  const Vec2 side = b - a;
  const double length = side.norm();
  const Vec2 right = Vec2(side.y(), -side.x()) / length;
  return {a, side, mesh.sides[e][1] == none ? right : Vec2(-right), length};
}

MovingDensity::MovingDensity(const Model& model, const Field& state)
    : m_(model),
      s_(state),
      rule_(domain_rule(model)),
      degree_(std::min(model.element.stress + 1, 4)),
      d1_(derivative(degree_, 0)),
      d2_(derivative(degree_, 1)) {}

// The rule of the value, so that the derivative is that of the discrete J.
void MovingDensity::add(const Term& term, double share, Index t, const Triangle& shape, TriangleMotion& motion) const {
  if (!term.density || !wanted(term, shape)) return;
  const Points x = rule_points(rule_, shape);
  const Material& material = material_of(m_.mesh, m_.scene, t);
  Fields f;
  if (term.uses_stress || term.uses_rotation) f = evaluate(m_.inner->kernel, shape, s_.interior.col(t), x);
  Points u, by_u;
  if (term.uses_displacement) {
    u = recovered_displacement(m_, s_, t, x);
    by_u.resize(2, x.cols());
  }
  const auto point = [&](Eigen::Index q) {
    FieldPoint at{.x = x.col(q), .material = material};
    if (term.uses_stress) at.stress = tensor(f.stress.col(q));
    if (term.uses_rotation) at.rotation = f.rotation[q];
    if (term.uses_displacement) at.displacement = u.col(q);
    return at;
  };
  // j_s : (s G') = (j_s' s) : G in the convention of by_gradient(j, k), which multiplies d_k theta_j.
  const double whole = share * area(shape);
  Eigen::VectorXd here(x.cols());
  for (Eigen::Index q = 0; q < x.cols(); ++q) {
    const FieldPoint at = point(q);
    const Density d = term.density(at);
    here[q] = d.value;
    const double w = whole * rule_.w[q];
    motion.by_gradient += w * d.value * Mat2::Identity();
    if (term.uses_stress)
      motion.by_gradient +=
          w * (d.by_stress.transpose() * at.stress - d.by_stress.cwiseProduct(at.stress).sum() * Mat2::Identity());
    if (term.uses_displacement) by_u.col(q) = w * d.by_displacement;
  }
  if (term.uses_place)
    add_place({rule_, x, std::sqrt(area(shape)), here,
               [&](Eigen::Index q, const Vec2& y) {
                 FieldPoint at = point(q);
                 at.x = y;
                 return term.density(at).value;
               }},
              whole, motion);
  if (term.uses_displacement) add_recovered(t, shape, x, by_u, motion);
}

// (grad u*, grad v) = (D, grad v), D = A s + Gamma(omega), with the mean of u_h, which stays. With w in the space of u*
// and (grad w, grad v) = sum_q weights_q . (v - mean v)(x_q):
//   sum weights . du* = (A(s G' - s div), grad w) - (D - grad u*, grad w G) + (grad u* G, grad w),  G = grad theta.
void MovingDensity::add_recovered(Index t, const Triangle& shape, const Points& x, const Points& weights,
                                  TriangleMotion& motion) const {
  const TriangleRule& rule = m_.inner->kernel.rule;
  const Points points = rule_points(rule, shape);
  const Vec2 center = centroid(shape);
  const double h = std::sqrt(2 * area(shape)), size = area(shape);
  const Material& material = material_of(m_.mesh, m_.scene, t);
  const Fields f = evaluate(m_.inner->kernel, shape, s_.interior.col(t), points);
  const Eigen::MatrixXd v = monomials(degree_, (points.colwise() - center) / h);
  // Per point the gradients of the monomials but the constant.
  const Eigen::Index n = v.rows() - 1;
  const Eigen::MatrixXd along1 = (d1_.transpose() * v).bottomRows(n) / h,
                        along2 = (d2_.transpose() * v).bottomRows(n) / h;
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n, n), load = Eigen::MatrixXd::Zero(n, 4);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
  for (Eigen::Index q = 0; q < points.cols(); ++q) {
    const double w = size * rule.w[q];
    const Mat2 d = gradient_of(material, tensor(f.stress.col(q)), f.rotation[q]);
    stiffness += w * (along1.col(q) * along1.col(q).transpose() + along2.col(q) * along2.col(q).transpose());
    for (int row = 0; row < 2; ++row) load.col(row) += w * (d(row, 0) * along1.col(q) + d(row, 1) * along2.col(q));
    mean += rule.w[q] * v.col(q).tail(n);
  }
  const Eigen::MatrixXd at_x = monomials(degree_, (x.colwise() - center) / h);
  for (Eigen::Index q = 0; q < x.cols(); ++q)
    load.rightCols<2>() += (at_x.col(q).tail(n) - mean) * weights.col(q).transpose();
  const Eigen::MatrixXd c = solve_spd(stiffness, load);  // columns: u* (two), w (two)
  for (Eigen::Index q = 0; q < points.cols(); ++q) {
    const double share = size * rule.w[q];
    const Mat2 s = tensor(f.stress.col(q)), d = gradient_of(material, s, f.rotation[q]);
    Eigen::Matrix<double, 4, 2> g;
    g << c.transpose() * along1.col(q), c.transpose() * along2.col(q);
    const Mat2 u = g.topRows<2>(), w = g.bottomRows<2>(), a = strain(material, w);
    motion.by_gradient += share * (a.transpose() * s - a.cwiseProduct(s).sum() * Mat2::Identity() -
                                   w.transpose() * (d - u) + u.transpose() * w);
  }
}

// Unknowns on edges keep their components while the edge moves: the value changes by place, length and normal.
void add_surface_motion(const Term& term, double share, const Model& m, const Field& s, Points& gradient) {
  const Mesh& mesh = m.mesh;
  if (term.on_boundary) {
    const EdgeRule rule = gauss(8);
    const Eigen::Index points = m.inner->kernel.trace.s.size();
    for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
      if (mesh.label[e] != term.label) continue;
      Points u = Points::Zero(2, rule.s.size());
      for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
        const Eigen::VectorXd basis = trace_basis(m.inner->kernel.trace, rule.s[q]);
        for (Eigen::Index g = 0; g < points; ++g)
          u.col(q) +=
              basis[g] * (m.inner->skeleton.frame[e] *
                          s.skeleton.segment<2>(edge_unknown(m.inner->skeleton, e) + 2 * static_cast<Index>(g)));
      }
      add_columns(gradient, mesh, e,
                  share * by_ends(mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]],
                                  [&](const Vec2& a, const Vec2& b) {
                                    const MovedEdge edge = moved_edge(mesh, e, a, b);
                                    double sum = 0;
                                    for (Eigen::Index q = 0; q < rule.s.size(); ++q)
                                      sum += edge.length * rule.w[q] *
                                             term.on_boundary(edge.at(rule.s[q]), edge.normal, u.col(q)).value;
                                    return sum;
                                  }));
    }
  }
  if (term.edge_cracks) add_edge_crack_motion(*term.edge_cracks, share, m, s, gradient);
  if (term.on_crack)
    for (const CrackEdge& c : mesh.cracks[term.crack]) {
      if (m.inner->skeleton.jump[c.edge] == none) continue;
      // Jumps and forces keep their components; a pressure is a force over a length.
      add_columns(gradient, mesh, c.edge,
                  share * by_ends(mesh.points[mesh.edges[c.edge][0]], mesh.points[mesh.edges[c.edge][1]],
                                  [&](const Vec2& a, const Vec2& b) {
                                    double sum = 0;
                                    for (Eigen::Index g = 0; g < m.inner->kernel.trace.s.size(); ++g) {
                                      const Index unknown = m.inner->skeleton.jump[c.edge] + 2 * static_cast<Index>(g);
                                      const double length = (b - a).norm() * m.inner->kernel.trace.w[g];
                                      sum += length * term.on_crack({a + m.inner->kernel.trace.s[g] * (b - a),
                                                                     s.skeleton[unknown], s.force[unknown] / length})
                                                          .value;
                                    }
                                    return sum;
                                  }));
    }
}

}  // namespace kerf
