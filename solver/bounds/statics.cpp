// The stress of the solution made ready for the lower bound [theory: B.1, B.4]; docs/theory/bounds.md, "A stress in
// equilibrium", points 1 and 4. Two changes of the loads on the skeleton, one solve with the factor of the open cracks:
// 1. unilateral cracks: the Bernstein coefficients p_b of the pressure on every edge are made at least 0, so that p >=
// 0 all along it. With moments M against the Bernstein polynomials, force = M' p_b and moments = M jump, they are the
// unknowns of the same complementarity problem [theory: C.6]: S becomes M^-T S M^-1;
// 2. couples: antisymmetric(c_T) on a triangle has no divergence, and its tractions on the edges are balanced by the
// solve. The result is in equilibrium with the loads that the element sees; solver/bounds/triangle_bounds.cpp adds the
// rest.

#include "solver/bounds/statics.hpp"

#include "solver/system.hpp"
#include "solver/system/elementwise.hpp"
#include "solver/system/penalty.hpp"

#include "base/dense.hpp"
#include "base/parallel.hpp"

#include <cmath>

namespace kerf {

namespace {

// From values at the Gauss points of an edge to moments against the Bernstein polynomials.
// The rule is exact for products of two polynomials of degree n - 1, so that this is the matrix of moments.
Eigen::MatrixXd to_moments(const EdgeRule& trace) {
  const Eigen::Index n = trace.w.size();
  Eigen::MatrixXd change(n, n);
  for (Eigen::Index b = 0; b < n; ++b)
    for (Eigen::Index g = 0; g < n; ++g)
      change(b, g) = trace.w[g] * std::round(std::tgamma(n) / (std::tgamma(b + 1) * std::tgamma(n - b))) *
                     std::pow(trace.s[g], b) * std::pow(1 - trace.s[g], n - 1 - b);
  return change;
}

// The unknowns of the openings in contact, those of each edge together.
std::vector<std::vector<Index>> edges_in_contact(const Model& m) {
  const Index leading = m.inner->ordering.leading();
  const auto n = static_cast<Index>(m.inner->kernel.trace.w.size());
  std::vector<std::vector<Index>> blocks;
  for (const auto& crack : m.mesh.cracks)
    for (const CrackEdge& c : crack) {
      std::vector<Index> unknowns;
      for (Index g = 0; g < n; ++g) {
        const Index u = m.inner->skeleton.jump[c.edge] + 2 * g, row = m.inner->ordering.row[u];
        if (row != none && row >= leading) unknowns.push_back(u);
      }
      if (!unknowns.empty()) blocks.push_back(unknowns);
    }
  return blocks;
}

// What must be added to the contact forces so that the cracks carry no tension anywhere, per row in contact: the
// Bernstein coefficients of the normal stress on each edge become the unknowns of the same small contact problem, the
// moments of the opening against the Bernstein polynomials their multipliers.
// S is the stiffness condensed onto the jumps in contact; `load` is its right-hand side with the forces of the solution
// taken out and the jumps that the couples cause put in.
Eigen::VectorXd best_pressures(const Model& m, const Field& s, const Eigen::VectorXd& free_jumps) {
  const Index contact_rows = m.inner->ordering.contact_rows, leading = m.inner->ordering.leading();
  const Eigen::MatrixXd change = to_moments(m.inner->kernel.trace), back = inverse(change);
  const Eigen::VectorXd force = on_rows(m, s.force).tail(contact_rows),
                        jump = on_rows(m, s.skeleton).tail(contact_rows);
  std::vector<std::vector<Index>> blocks = edges_in_contact(m);
  for (auto& rows : blocks)
    for (Index& row : rows) row = m.inner->ordering.row[row] - leading;
  Eigen::MatrixXd S = m.inner->factor->contact_complement();
  Eigen::VectorXd load = multiply(S, jump + free_jumps) - force;
  std::vector<bool> closed(contact_rows, false);
  for (const auto& rows : blocks) {
    S(Eigen::all, rows) = multiply(S(Eigen::all, rows), back);
    load(rows) = transposed_multiply(back, load(rows));
    const Eigen::VectorXd guess = transposed_multiply(back, force(rows));
    for (std::size_t i = 0; i < rows.size(); ++i) closed[rows[i]] = guess[static_cast<Eigen::Index>(i)] > 0;
  }
  for (const auto& rows : blocks) S(rows, Eigen::all) = transposed_multiply(back, S(rows, Eigen::all));
  // Any forces >= 0 will do: the best ones if the iteration settles.
  Eigen::VectorXd pressure = solve_unilateral(S, load, closed).force.cwiseMax(0);
  for (const auto& rows : blocks) pressure(rows) = transposed_multiply(change, pressure(rows));
  return pressure - force;
}

// The same, per skeleton unknown, without that problem: the pressures there are, as far as they press.
// Not the best pressures, but at least 0; a wider interval, and no dense matrix S: for large contact and for parts of a
// body.
Eigen::VectorXd pressing_parts(const Model& m, const Field& s) {
  const Eigen::MatrixXd change = to_moments(m.inner->kernel.trace), back = inverse(change);
  Eigen::VectorXd added = Eigen::VectorXd::Zero(m.inner->skeleton.total);
  for (const auto& u : edges_in_contact(m))
    added(u) = transposed_multiply(change, transposed_multiply(back, s.force(u)).cwiseMax(0)) - s.force(u);
  return added;
}

// What balances antisymmetric(couple[t]) on each triangle, per skeleton unknown.
// The outward normal times the length of the edge is (side.y, -side.x).
Eigen::VectorXd load_of_couples(const Model& m, const Eigen::VectorXd& couple) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(m.inner->skeleton.total);
  for (Index t = 0; t < static_cast<Index>(couple.size()); ++t) {
    const Triangle shape = triangle(m, t);
    const Seen view = seen(m.mesh, m.inner->skeleton, t);
    const Mat2 stress = antisymmetric(couple[t]);
    int i = 0;
    for (int e = 0; e < 3; ++e) {
      const Vec2 side = shape.x[(e + 2) % 3] - shape.x[(e + 1) % 3];
      const Vec2 force = shape.frame[e].transpose() * stress * Vec2(side.y(), -side.x());
      for (Eigen::Index g = 0; g < m.inner->kernel.trace.w.size(); ++g)
        for (int d = 0; d < 2; ++d, ++i)
          for (const Index u : {view.base[i], view.jump[i]})
            if (u != none) load[u] -= m.inner->kernel.trace.w[g] * force[d];
    }
  }
  return load;
}

// The interior fields once the skeleton moves.
// The response of the fields inside to the multipliers alone: no load, since those are in the fields already.
Eigen::MatrixXd moved_interior(const Model& m, const Field& s, const Eigen::VectorXd& moved) {
  Eigen::MatrixXd interior_fields = s.interior;
  parallel_for(static_cast<Index>(m.mesh.triangles.size()), m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t)
      interior_fields.col(t) += interior(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), {},
                                         trace_seen(m.mesh, m.inner->skeleton, moved, t), {penalty_at(m, t), 0});
  });
  return interior_fields;
}

}  // namespace

Mat2 antisymmetric(double g) {
  return (Mat2() << 0, 0.5 * g, -0.5 * g, 0).finished();
}

Eigen::MatrixXd static_interior(const Model& m, const Field& s, const Eigen::VectorXd& couple, Eigen::VectorXd* moved) {
  const Index contact_rows = m.inner->ordering.contact_rows, size = m.inner->ordering.size;
  const bool contact = contact_rows > 0 && s.force.cwiseAbs().maxCoeff() > 0;
  if (size == 0 || (couple.size() == 0 && !contact)) return s.interior;
  const bool large = has_large_contact(m);
  Eigen::VectorXd load = on_rows(m, load_of_couples(m, couple));
  std::shared_ptr<const Factor> open = m.inner->factor;
  if (large) open = m.inner->held->of(*m.inner->system.K, std::vector<bool>(contact_rows, false));
  if (contact_rows > 0 && large)
    load += on_rows(m, pressing_parts(m, s));
  else if (contact_rows > 0)
    load.tail(contact_rows) += best_pressures(m, s,
                                              couple.size() > 0 ? Eigen::VectorXd(open->solve(load).tail(contact_rows))
                                                                : Eigen::VectorXd::Zero(contact_rows));
  const Eigen::VectorXd change = on_skeleton(m, open->solve(load), nullptr);
  if (moved) *moved = change;
  return moved_interior(m, s, change);
}

Eigen::MatrixXd static_interior(const Model& m, const Field& s, const Eigen::VectorXd& couple, const OpenSolve& open) {
  return moved_interior(m, s, open(load_of_couples(m, couple) + pressing_parts(m, s)));
}

}  // namespace kerf
