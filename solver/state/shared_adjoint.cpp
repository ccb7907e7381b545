// Adjoints and one-sided responses of a body whose parts several processes have: the linear problems of adjoint.cpp on
// the tangent cone of the contact, each process with its own triangles and rows,
//   K mu = sum_T F_T + J_m,   mu_j = -J_p on closed rows   [theory: A.6, A.10],
// found as the state is, by rounds of x_u <- x_u + (K^-1 r)_u [theory: E.34] in the system in which closed rows are
// held. With Coulomb's friction normal rows under sliding points have mu_n = -J_pn - c (mu_t + J_pt) [theory: A.15]:
// linear in these jumps, which GMRES [Saad, Schultz 1986] finds, a solve per step. Where faces touch without pressure,
// each such point takes a solve, and the matrix of their openings is that of (A.12). Derived in docs/theory/adjoint.md
// and docs/theory/elements.md, section Solving in parts.

#include "base/dense.hpp"
#include "solver/contact/gmres.hpp"
#include "solver/state/dual.hpp"
#include "solver/state/shared_body.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {

// Jumps of held rows are put into x before the first round, and their forces are then unmet like any others.
SharedBody::Impl::Round SharedBody::Impl::solve_linear(const Problem& problem, TangentField& field) {
  const Skeleton& s = model.inner->skeleton;
  const bool penalized = model.inner->system.penalty > 0 && !problem.one_sweep;
  const Loads loads{.F = {}, .own = problem.own, .prescribed = {}};
  const auto is_held = [&](Index u) {
    return !contact_of.empty() && contact_of[u] != none && problem.held[contact_of[u]];
  };
  hold(problem.held);
  Round at{.x = {Eigen::VectorXd::Zero(s.total), Eigen::VectorXd::Zero(s.total)}};
  if (penalized) at.theta.setZero(static_cast<Eigen::Index>(model.mesh.triangles.size()));
  for (Index u = 0; u < s.total; ++u)
    if (is_held(u)) at.x.high[u] = problem.jump[contact_of[u]];
  const auto largest = [&](const Eigen::VectorXd& force) {
    double most = 0;
    for (Index u = 0; u < s.total; ++u)
      if (owns(model, u) && moves(u)) most = std::max(most, std::abs(force[u]));
    comm.largest({&most, 1});
    return most;
  };
  at.unmet = forces_of(at.x, at.theta) - problem.load;
  const double size = std::max({largest(problem.load), largest(at.unmet), std::numeric_limits<double>::min()});
  const auto round = [&](Round& r) {
    settle(-r.unmet, r.x);
    ++field.linear_solves;
    if (penalized) step_theta(loads, r, field.linear_solves, false);
    r.unmet = forces_of(r.x, r.theta) - problem.load;
    return r.certificate.kkt = std::max(largest(r.unmet) / size, r.penalty_error);
  };
  const auto enough = [](const Round&, double error) { return error <= TangentSolver::to_rounding; };
  Round best = best_round(std::move(at), penalized, penalized ? 40 : 4, round, enough).best;
  field.residual = best.certificate.kkt;
  field.skeleton = best.x.high;
  field.force.setZero(s.total);
  return best;
}

// Own rows of all processes, one process after the other: the numbers of find_contact.
std::vector<ContactStatus> SharedBody::Impl::status(const Field& state) {
  const std::vector<ContactStatus> here = contact_status(model, state);
  std::vector<ContactStatus> own;
  for (const Index u : own_contact)
    own.push_back(here[static_cast<std::size_t>(model.inner->ordering.row[u] - leading_rows())]);
  return gathered(comm, own);
}

std::vector<SlidingPoint> SharedBody::Impl::sliding(const Field& state, const std::vector<bool>& held) {
  if (contact_rows == 0) return {};
  return sliding_points(points, held, on_contact(state.skeleton) - gaps);
}

// x = B x + b in the jumps x of the normal rows: b is what the problem asks of them at x = 0, B x what a solve without
// loads asks at x.
void SharedBody::Impl::tie(Problem& problem, const std::vector<SlidingPoint>& sliding, int& solves) {
  if (sliding.empty()) return;
  const auto n = static_cast<Eigen::Index>(sliding.size());
  const auto follow = [&](const Problem& of) -> Eigen::VectorXd {  // what the slips ask of the normal rows
    TangentField field;
    solve_linear(of, field);
    solves += field.linear_solves;
    const Eigen::VectorXd jumps = on_contact(field.skeleton);
    Eigen::VectorXd normal(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const SlidingPoint& p = sliding[static_cast<std::size_t>(i)];
      normal[i] = -p.share * jumps[p.tangential];
    }
    return normal;
  };
  const auto put = [&](const Eigen::VectorXd& normal, Eigen::VectorXd& jump) {
    for (Eigen::Index i = 0; i < n; ++i) jump[sliding[static_cast<std::size_t>(i)].normal] += normal[i];
  };
  Problem change{.held = problem.held,
                 .jump = {},
                 .load = Eigen::VectorXd::Zero(problem.load.size()),
                 .own = Eigen::VectorXd::Zero(problem.own.size())};
  const auto answer = [&](const Eigen::VectorXd& normal) -> Eigen::VectorXd {
    change.jump = Eigen::VectorXd::Zero(contact_rows);
    put(normal, change.jump);
    return follow(change);
  };
  const Eigen::VectorXd asked = follow(problem);
  constexpr double enough = 1e-13;
  if (!asked.isZero(0)) put(gmres(answer, asked, enough * asked.norm()), problem.jump);
}

// The residual counts what the tie between slips and normal jumps lacks, too.
TangentField SharedBody::Impl::solve_adjoint(const Field& state, Sensitivity dJ) {
  if (!model.inner->floating.empty()) {
    Eigen::VectorXd work = work_on_motions(model, dJ);
    comm.sum({work.data(), static_cast<std::size_t>(work.size())});
    dJ = without_moments(model, std::move(dJ), solve_spd(gram(), work));
  }
  DualLoads loads = dual_loads(model, dJ);
  Problem problem{.held = tied(status(state)),
                  .jump = Eigen::VectorXd::Zero(contact_rows),
                  .load = std::move(loads.forces),
                  .own = std::move(loads.own)};
  const std::vector<SlidingPoint> slides = sliding(state, problem.held);
  if (dJ.force.size() > 0 && contact_rows > 0) problem.jump = dual_jumps(on_contact(dJ.force), problem.held, slides);
  const Eigen::VectorXd given = problem.jump;
  TangentField field;
  int before = 0;
  tie(problem, slides, before);
  const Round found = solve_linear(problem, field);
  field.linear_solves += before;
  if (!slides.empty()) {
    const Eigen::VectorXd jumps = on_contact(field.skeleton);
    for (const SlidingPoint& p : slides)
      field.residual =
          std::max(field.residual, std::abs(jumps[p.normal] - given[p.normal] + p.share * jumps[p.tangential]) /
                                       jumps.cwiseAbs().maxCoeff());
  }
  fill_dual(model, dJ, found.x, found.theta, field);
  return field;
}

// One sweep of the penalty: theta stays 0, as OpenSolve has it.
Eigen::VectorXd SharedBody::Impl::solve_open(const Eigen::VectorXd& forces) {
  TangentField field;
  solve_linear({.held = std::vector<bool>(static_cast<std::size_t>(contact_rows), false),
                .jump = Eigen::VectorXd::Zero(contact_rows),
                .load = forces,
                .own = {},
                .one_sweep = true},
               field);
  return field.skeleton;
}

// S_ki of (A.12); symmetrized, because the solves end at a tolerance.
OneSided SharedBody::Impl::one_sided(const Field& state) {
  const std::vector<ContactStatus> of = status(state);
  std::vector<Index> rows;
  for (std::size_t i = 0; i < of.size(); ++i)
    if (of[i] == ContactStatus::Biactive) rows.push_back(static_cast<Index>(i));
  const auto n = static_cast<Eigen::Index>(rows.size());
  OneSided found{.response = {}, .opening = Eigen::MatrixXd::Zero(n, n)};
  constexpr Eigen::Index most = 200;  // each takes a solve
  if (n > most)
    throw Error(Fault::Numerics,
                fmt::format("{} points of the cracks carry neither a gap nor a pressure, too many for one-sided "
                            "derivatives in parts; use longer edges there (mesh.size), or loads that open or close the "
                            "cracks",
                            n));
  const Index triangles = static_cast<Index>(model.mesh.triangles.size());
  Problem problem{.held = tied(of),
                  .jump = Eigen::VectorXd::Zero(contact_rows),
                  .load = {},
                  .own = Eigen::VectorXd::Zero(model.inner->system.penalty > 0 ? triangles : 0)};
  const Kernel& k = model.inner->kernel;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Index row = rows[static_cast<std::size_t>(i)];
    problem.load = Eigen::VectorXd::Zero(model.inner->skeleton.total);
    for (Index u = model.inner->skeleton.base; u < model.inner->skeleton.total; ++u)
      if (contact_of[u] == row) problem.load[u] = 1;
    TangentField field;
    const Round at = solve_linear(problem, field);
    const auto tangent = [&](Index t, const Triangle& shape, const SkeletonVector& rest, const Penalty& p) {
      return interior(k, shape, material_of(model.mesh, model.scene, t), {}, rest, p);
    };
    fill_interior(model, at.x, at.theta, tangent, field);
    const Eigen::VectorXd jumps = on_contact(field.skeleton);
    for (Eigen::Index j = 0; j < n; ++j) found.opening(j, i) = jumps[rows[static_cast<std::size_t>(j)]];
    found.response.push_back(std::move(field));
  }
  found.opening = 0.5 * (found.opening + found.opening.transpose()).eval();
  return found;
}

}  // namespace kerf
