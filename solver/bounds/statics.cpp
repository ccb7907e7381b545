#include "solver/bounds/statics.hpp"

#include "solver/system.hpp"
#include "solver/system/elementwise.hpp"

#include "solver/parallel.hpp"

#include <Eigen/LU>

#include <cmath>

namespace kerf {

namespace {

// What must be added to the contact forces so that the cracks carry no tension anywhere: the Bernstein coefficients of
// the normal stress on each edge become the unknowns of the same small contact problem, the moments of the opening
// against the Bernstein polynomials their multipliers.
// Where contact is large they are the ones there are, as far as they press: any that are not negative will do.
Eigen::VectorXd pressures_everywhere(const Model& m, const Field& s, const Eigen::VectorXd& free_jumps) {
  const bool large = has_large_contact(m);
  const Index contact_rows = m.inner->ordering.contact_rows, leading = m.inner->ordering.size - contact_rows;
  const EdgeRule& trace = m.inner->kernel.trace;
  const Eigen::Index n = trace.w.size();
  Eigen::MatrixXd change(n, n);  // from values at the Gauss points to moments
  for (Eigen::Index b = 0; b < n; ++b)
    for (Eigen::Index g = 0; g < n; ++g)
      change(b, g) = trace.w[g] * std::round(std::tgamma(n) / (std::tgamma(b + 1) * std::tgamma(n - b))) *
                     std::pow(trace.s[g], b) * std::pow(1 - trace.s[g], n - 1 - b);
  const Eigen::MatrixXd back = change.inverse();
  Eigen::VectorXd force(contact_rows), jump(contact_rows);
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    if (const Index row = m.inner->ordering.row[u]; row != none && row >= leading) {
      force[row - leading] = s.force[u];
      jump[row - leading] = s.skeleton[u];
    }
  std::vector<std::vector<Index>> blocks;
  for (const auto& crack : m.mesh.cracks)
    for (const CrackEdge& c : crack) {
      std::vector<Index> rows;
      for (Index g = 0; g < static_cast<Index>(n); ++g)
        if (const Index row = m.inner->ordering.row[m.inner->skeleton.jump[c.edge] + 2 * g];
            row != none && row >= leading)
          rows.push_back(row - leading);
      if (!rows.empty()) blocks.push_back(rows);
    }
  if (large) {
    Eigen::VectorXd pressure(contact_rows);
    for (const auto& rows : blocks)
      pressure(rows) = (change.transpose() * (back.transpose() * force(rows)).cwiseMax(0)).eval();
    return pressure - force;
  }
  Eigen::MatrixXd S = m.inner->factor->contact_complement();
  Eigen::VectorXd load = S * (jump + free_jumps) - force;
  std::vector<bool> closed(contact_rows, false);
  for (const auto& rows : blocks) {
    S(Eigen::all, rows) = (S(Eigen::all, rows) * back).eval();
    load(rows) = (back.transpose() * load(rows)).eval();
    const Eigen::VectorXd guess = back.transpose() * force(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) closed[rows[i]] = guess[static_cast<Eigen::Index>(i)] > 0;
  }
  for (const auto& rows : blocks) S(rows, Eigen::all) = (back.transpose() * S(rows, Eigen::all)).eval();
  // Any forces >= 0 will do: the best ones if the iteration settles.
  Eigen::VectorXd pressure = solve_unilateral(S, load, closed).force.cwiseMax(0);
  for (const auto& rows : blocks) pressure(rows) = (change.transpose() * pressure(rows)).eval();
  return pressure - force;
}

}  // namespace

Mat2 antisymmetric(double g) {
  return (Mat2() << 0, 0.5 * g, -0.5 * g, 0).finished();
}

Eigen::MatrixXd static_interior(const Model& m, const Field& s, const Eigen::VectorXd& couple, Eigen::VectorXd* moved) {
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const Index contact_rows = m.inner->ordering.contact_rows, size = m.inner->ordering.size;
  const bool contact = contact_rows > 0 && s.force.cwiseAbs().maxCoeff() > 0;
  if (size == 0 || (couple.size() == 0 && !contact)) return s.interior;
  Eigen::VectorXd load = Eigen::VectorXd::Zero(size);
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
            if (u != none && m.inner->ordering.row[u] != none)
              load[m.inner->ordering.row[u]] -= m.inner->kernel.trace.w[g] * force[d];
    }
  }
  const bool large = has_large_contact(m);
  std::shared_ptr<const Factor> open = m.inner->factor;
  if (large) open = m.inner->held->of(*m.inner->system.K, std::vector<bool>(contact_rows, false));
  if (contact_rows > 0) {
    const Eigen::VectorXd jumps = couple.size() > 0 && !large ? Eigen::VectorXd(open->solve(load).tail(contact_rows))
                                                              : Eigen::VectorXd::Zero(contact_rows);
    load.tail(contact_rows) += pressures_everywhere(m, s, jumps);
  }
  const Eigen::VectorXd change = open->solve(load);
  if (moved) {
    *moved = Eigen::VectorXd::Zero(m.inner->skeleton.total);
    for (Index u = 0; u < m.inner->skeleton.total; ++u)
      if (m.inner->ordering.row[u] != none) (*moved)[u] = change[m.inner->ordering.row[u]];
  }
  Eigen::MatrixXd interior_fields = s.interior;
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Seen view = seen(m.mesh, m.inner->skeleton, t);
      SkeletonVector trace = SkeletonVector::Zero(view.count);
      for (int i = 0; i < view.count; ++i)
        for (const Index u : {view.base[i], view.jump[i]})
          if (u != none && m.inner->ordering.row[u] != none) trace[i] += change[m.inner->ordering.row[u]];
      interior_fields.col(t) +=
          interior(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), {}, trace, {penalty_at(m, t), 0});
    }
  });
  return interior_fields;
}

}  // namespace kerf
