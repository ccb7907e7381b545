// Sets of points that touch, by the factors of one of them.
//
// The system K z = f is made and factorized for one set R of rows in contact that are held, the first guess. Another
// set H differs from it in few rows: those that R holds and H lets move, each of which has a response w_r of R to a
// unit jump of it, and those that H holds besides, each with a response v_h of R to a unit force on it. The solution
// for H is that of R and a combination of these, whose coefficients c make the forces of the former what is asked and
// the jumps of the latter nothing, a small dense system [theory: E.38]. By symmetry its right-hand side is the work of
// the forces on the responses, so that a set takes one solve, and each of its rows one more, once.

#include "base/dense.hpp"
#include "solver/state/shared_body.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// Each takes a vector of all unknowns of a process; so many are about as much as its factor.
constexpr std::size_t most_exchanged = 40;

/// How many solves a new system is worth: factors of n unknowns take n^1.5 operations, solves n log n of slower ones.
/// Measured: 7 at n = 45,000.
std::size_t worth(Index unknowns) {
  constexpr double least = 4, share = 30;
  return static_cast<std::size_t>(std::max(least, std::sqrt(static_cast<double>(unknowns)) / share));
}

}  // namespace

std::vector<Index> SharedBody::Impl::exchanged_rows(const std::vector<bool>& rows) const {
  std::vector<Index> differ;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] != now.held[i]) differ.push_back(static_cast<Index>(i));
  return differ;
}

void SharedBody::Impl::hold(const std::vector<bool>& rows) {
  if (now.solver) {
    const std::vector<Index> differ = exchanged_rows(rows);
    const auto missing = std::ranges::count_if(differ, [&](Index row) { return !exchanged.contains(row); });
    if (differ.size() > most_exchanged || static_cast<std::size_t>(missing) > worth(now.total / comm.count()))
      make_system(rows);
  } else {
    make_system(rows);
  }
  held = rows;
  for (const Index row : exchanged_rows(rows))
    if (!exchanged.contains(row)) exchanged.emplace(row, exchange(row));
}

ExchangedRow SharedBody::Impl::exchange(Index row) {
  const Skeleton& s = model.inner->skeleton;
  const auto none_of = [&]() -> Eigen::VectorXd { return Eigen::VectorXd::Zero(s.total); };
  DoubleDouble x{none_of(), none_of()};
  Eigen::VectorXd forces = none_of();
  for (Index u = s.base; u < s.total; ++u)
    if (contact_of[u] == row) (now.held[row] ? x.high : forces)[u] = 1;
  ExchangedRow found{.own = none_of(), .jumps = {}, .forces = {}, .stiffness = {}};
  if (now.held[row]) {
    forces = -forces_at_contact(x.high);
    for (Index u = 0; u < s.total; ++u)
      if (forces[u] != 0) found.stiffness.emplace_back(u, -forces[u]);
  }
  move(now.solver->solve(on_own_rows(forces)), x);
  found.jumps = on_contact(x.high);
  found.forces = on_contact(forces_at_contact(x.high));
  for (Index u = 0; u < s.total; ++u)
    if (owns(model, u)) found.own[u] = x.high[u];
  return found;
}

Eigen::VectorXd SharedBody::Impl::forces_of(const DoubleDouble& x, const Eigen::VectorXd& theta) {
  if (!products) products.emplace(model);
  Eigen::VectorXd forces = (*products)(x).forces;
  for (Index t = 0; t < static_cast<Index>(theta.size()); ++t) {
    const Seen view = seen(model.mesh, model.inner->skeleton, t);
    for (int i = 0; i < view.count; ++i)
      for (const Index u : {view.base[i], view.jump[i]})
        if (u != none) forces[u] += theta[t] * model.inner->system.traces(i, t);
  }
  return forces;
}

double SharedBody::Impl::work(const Eigen::VectorXd& forces, const Eigen::VectorXd& x) {
  double here = 0;
  for (Index u = 0; u < model.inner->skeleton.total; ++u)
    if (owns(model, u)) here += forces[u] * x[u];
  return sum(comm, here);
}

Eigen::VectorXd SharedBody::Impl::forces_at_contact(const Eigen::VectorXd& x) {
  const Skeleton& s = model.inner->skeleton;
  const int n = skeleton_count(model.element);
  if (contact_cells.empty())
    for (Index t = 0; t < static_cast<Index>(model.mesh.triangles.size()); ++t) {
      const Seen view = seen(model.mesh, s, t);
      const bool touches = std::any_of(view.jump.begin(), view.jump.begin() + n,
                                       [&](Index u) { return u != none && contact_of[u] != none; });
      if (touches)
        contact_cells.push_back({t, condense(model.inner->kernel, triangle(model, t),
                                             material_of(model.mesh, model.scene, t), {}, {.a = penalty_at(model, t)})
                                        .K});
    }
  Eigen::VectorXd forces = Eigen::VectorXd::Zero(s.total);
  const DoubleDouble values{x, Eigen::VectorXd::Zero(s.total)};
  for (const ContactCell& cell : contact_cells) {
    const Seen view = seen(model.mesh, s, cell.triangle);
    const Strained at = strained(model, values, cell.triangle);
    const SkeletonVector f = at.without_motions(cell.K * at.rest);
    for (int i = 0; i < n; ++i)
      for (const Index u : {view.base[i], view.jump[i]})
        if (u != none) forces[u] += f[i];
  }
  return forces;
}

Eigen::VectorXd SharedBody::Impl::settle(const Eigen::VectorXd& forces, DoubleDouble& x) {
  const std::vector<Index> rows = exchanged_rows(held);
  const Skeleton& s = model.inner->skeleton;
  DoubleDouble change{Eigen::VectorXd::Zero(s.total), Eigen::VectorXd::Zero(s.total)};
  if (rows.empty()) {
    move(now.solver->solve(on_own_rows(forces)), change);
    add(x, 1, change.high);
    return change.high;
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd system(n, n);
  Eigen::VectorXd asked(n), size(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Index row = rows[static_cast<std::size_t>(i)];
    const ExchangedRow& of = exchanged.at(row);
    asked[i] = (held[row] ? -1 : 1) * of.own.dot(forces);
    size[i] = 1 / std::sqrt(std::abs((held[row] ? of.jumps : of.forces)[row]));
    for (Eigen::Index k = 0; k < n; ++k) {
      const ExchangedRow& other = exchanged.at(rows[static_cast<std::size_t>(k)]);
      system(i, k) = (held[row] ? other.jumps : other.forces)[row];
    }
  }
  comm.sum({asked.data(), static_cast<std::size_t>(n)});
  const Eigen::MatrixXd scaled = size.asDiagonal() * system * size.asDiagonal();
  const Eigen::VectorXd share = size.cwiseProduct(multiply(inverse(scaled), size.cwiseProduct(asked)));
  Eigen::VectorXd pushed = forces;
  const auto on_row = [&](Index row, const auto& each) {
    for (Index u = s.base; u < s.total; ++u)
      if (contact_of[u] == row) each(u);
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    const Index row = rows[static_cast<std::size_t>(i)];
    on_row(row, [&](Index u) { held[row] ? pushed[u] += share[i] : change.high[u] = share[i]; });
    for (const auto& [u, stiffness] : exchanged.at(row).stiffness) pushed[u] -= share[i] * stiffness;
  }
  move(now.solver->solve(on_own_rows(pushed)), change);
  for (const Index row : rows)
    if (held[row]) on_row(row, [&](Index u) { change.high[u] = change.low[u] = 0; });
  add(x, 1, change.high);
  return change.high;
}

}  // namespace kerf
