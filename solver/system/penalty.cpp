#include "solver/system/penalty.hpp"

#include "solver/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

auto lower(const Model& m) {
  return m.inner->factor.contact_factor().triangularView<Eigen::Lower>();
}

}  // namespace

Loads loads_of(const Model& m) {
  Loads l{m.inner->system.F, {}, m.inner->skeleton.prescribed};
  if (m.inner->system.penalty > 0) l.own = m.inner->system.traces.row(m.inner->system.traces.rows() - 2).transpose();
  return l;
}

Eigen::VectorXd on_skeleton(const Model& m, const Eigen::VectorXd& rows, const std::vector<double>* elsewhere) {
  Eigen::VectorXd all(m.inner->skeleton.total);
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    all[u] = m.inner->ordering.row[u] != none ? rows[m.inner->ordering.row[u]] : elsewhere ? (*elsewhere)[u] : 0;
  return all;
}

Eigen::VectorXd on_rows(const Model& m, const Eigen::VectorXd& skeleton) {
  Eigen::VectorXd rows(m.inner->ordering.size);
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    if (const Index row = m.inner->ordering.row[u]; row != none) rows[row] = skeleton[u];
  return rows;
}

Twofold on_skeleton(const Model& m, const PenaltyIterate& s, const std::vector<double>& elsewhere) {
  Twofold all{on_skeleton(m, s.x, &elsewhere), {}};
  if (s.low.size() > 0) all.low = on_skeleton(m, s.low, nullptr);
  return all;
}

// An enclosed body does not feel a uniform theta, so that its error must be watched here: relative to the terms that it
// is the sum of.
void update_theta(const Model& m, const Loads& loads, PenaltyIterate& s) {
  const Eigen::VectorXd before = s.theta;
  Eigen::VectorXd size(s.theta.size());
  const Twofold skeleton = on_skeleton(m, s, loads.prescribed);
  const Eigen::Index count = m.inner->system.traces.rows() - 2;
  parallel_for(static_cast<Index>(s.theta.size()), m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const auto column = m.inner->system.traces.col(t);
      const SkeletonVector seen_here = skeleton.low.size() > 0
                                           ? strained(m, skeleton, t).rest
                                           : trace_seen(m.mesh, m.inner->skeleton, skeleton.high, t);
      const double mean =
          column.head(count).dot(seen_here) / area(m.mesh, t) + loads.own[t] + s.theta[t] * column[count + 1];
      size[t] =
          m.inner->system.penalty *
          (column.head(count).cwiseProduct(seen_here).cwiseAbs().sum() / area(m.mesh, t) + std::abs(loads.own[t]));
      s.theta[t] = m.inner->system.penalty * mean;
    }
  });
  const double scale = size.size() > 0 ? std::max(size.maxCoeff(), s.theta.cwiseAbs().maxCoeff()) : 0;
  s.penalty_error = scale > 0 ? (s.theta - before).cwiseAbs().maxCoeff() / scale : 0;
}

// Scattered in the order of the triangles.
Eigen::VectorXd right_hand_side(const Model& m, const Loads& loads, const PenaltyIterate& s) {
  Eigen::VectorXd F = loads.F;
  const auto add = [&](Index unknown, double value) {
    if (unknown != none && m.inner->ordering.row[unknown] != none) F[m.inner->ordering.row[unknown]] -= value;
  };
  for (Index t = 0; t < static_cast<Index>(s.theta.size()); ++t) {
    const Seen view = seen(m.mesh, m.inner->skeleton, t);
    for (int i = 0; i < view.count; ++i) {
      add(view.base[i], s.theta[t] * m.inner->system.traces(i, t));
      add(view.jump[i], s.theta[t] * m.inner->system.traces(i, t));
    }
  }
  return F;
}

Condensation::Condensation(const Model& model)
    : m(model), S(model.inner->factor.contact_complement()), points(contact_points(model)) {}

Eigen::VectorXd Condensation::load(const Eigen::VectorXd& y) const {
  return lower(m) * y.tail(m.inner->ordering.contact_rows);
}

Eigen::VectorXd Condensation::complete(Eigen::VectorXd y, const Eigen::VectorXd& jump) const {
  const auto l = lower(m);
  y.tail(jump.size()) = l.transpose() * jump;
  Eigen::VectorXd x = m.inner->factor.backward(y);
  x.tail(jump.size()) = jump;
  return x;
}

Eigen::VectorXd Condensation::moving_jumps(const Eigen::VectorXd& r, const std::vector<Motion>& motion) const {
  std::vector<bool> held(motion.size());
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = motion[i] == Motion::Held;
  if (!open_rows_ || open_rows_->closed() != held) open_rows_.emplace(S, std::move(held));
  return open_rows_->jumps(r);
}

Eigen::VectorXd Condensation::solve_frozen(const Eigen::VectorXd& b, const std::vector<Motion>& motion,
                                           const Eigen::VectorXd* held) const {
  const Eigen::VectorXd y = m.inner->factor.forward(b);
  if (m.inner->ordering.contact_rows == 0) return m.inner->factor.backward(y);
  if (!held) return complete(y, moving_jumps(load(y), motion));
  return complete(y, *held + moving_jumps(load(y) - S * *held, motion));
}

void UniformPressure::correct(const Condensation& condensed, const Loads& loads, PenaltyIterate& s) {
  const Model& m = condensed.m;
  const Eigen::Index count = m.inner->system.traces.rows() - 2;
  const double a = m.inner->system.penalty;
  if (response.size() == 0 || motion != s.motion) {
    PenaltyIterate unit;
    unit.theta = Eigen::VectorXd::Ones(s.theta.size());
    motion = s.motion;
    response = condensed.solve_frozen(right_hand_side(m, loads, unit) - loads.F, motion);
    ++solves;
    const Eigen::VectorXd skeleton = on_skeleton(m, response, nullptr);
    stiffness = 0;
    for (Index t = 0; t < static_cast<Index>(s.theta.size()); ++t) {
      const auto column = m.inner->system.traces.col(t);
      stiffness += area(m.mesh, t) * (1 - a * column[count + 1]) -
                   a * column.head(count).dot(trace_seen(m.mesh, m.inner->skeleton, skeleton, t));
    }
  }
  const Eigen::VectorXd before = s.theta;
  update_theta(m, loads, s);
  double rest = 0, whole = 0;
  for (Index t = 0; t < static_cast<Index>(s.theta.size()); ++t) {
    rest += area(m.mesh, t) * (s.theta[t] - before[t]);
    whole += area(m.mesh, t);
  }
  constexpr double none_left = 1e-11;
  level_open = !(stiffness > none_left * whole);
  if (level_open) {
    change_of_area = 2 * rest;
    largest_strain = s.theta.cwiseAbs().maxCoeff();
    if (must_fit) check_volume(m, change_of_area, largest_strain);
    s.theta = before.array() - rest / whole;
    return;
  }
  const double delta = rest / stiffness;
  s.x += delta * response;
  s.theta = before.array() + delta;
}

PenaltyIterate iterate(const Condensation& condensed, const Loads& loads, PenaltyIterate next, UniformPressure& uniform,
                       const PenaltySteps& steps) {
  const Model& m = condensed.m;
  const bool penalized = m.inner->system.penalty > 0, any_rows = m.inner->ordering.size > 0;
  if (penalized && next.theta.size() == 0) next.theta.setZero(static_cast<Eigen::Index>(m.mesh.triangles.size()));
  PenaltyIterate best = next;
  Eigen::VectorXd F = loads.F;
  int without_gain = 0;
  for (int round = 0; round < steps.most; ++round) {
    if (any_rows) steps.solve(F, next);
    if (penalized) {
      uniform.correct(condensed, loads, next);
      update_theta(m, loads, next);
      F = right_hand_side(m, loads, next);
    }
    if (!any_rows) {
      best = next;
      if (!penalized) break;
      continue;
    }
    steps.certify(F, next);
    const double error = next.certificate.kkt, least = best.certificate.kkt;
    const bool slow = round > 0 && error > 0.5 * least;
    if (round == 0 || error < least) best = next;
    // With a penalty F is as large as 1/a, so that the rounds go on until rounding stops them; before they shrink the
    // error they may raise it, while a pressure builds up or contacts change.
    constexpr double settled = 1e-9;
    const int patience = penalized && best.certificate.kkt > settled ? 6 : 1;
    without_gain = slow ? without_gain + 1 : 0;
    if (error <= steps.enough || without_gain == patience) break;
  }
  return best;
}

}  // namespace kerf
