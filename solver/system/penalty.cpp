// One linear solve around a factor, with the contact rows condensed, and the rounds that a state and an adjoint need:
//   solve K x = F(theta);   theta <- a mean_T(tr s);   F = F_0 - sum_T theta_T t_m   [theory: E.13, E.14],
// which pay back the penalty of nearly incompressible triangles, and remove what rounding leaves of the residual. A
// round shrinks all errors by about a/(a + 1/mu) but uniform pressures of pieces of one material in stiffer
// surroundings; these are taken out exactly, theta + a delta_k on piece k, by a small symmetric system [theory: E.23].
// With c = 0 everywhere and all of the boundary held the level of pressure is open: its mean is set to zero, and the
// boundary must keep the area. Derived in docs/theory/elements.md, section Nearly incompressible.

#include "solver/system/penalty.hpp"

#include "base/parallel.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

auto lower(const Model& m) {
  return m.inner->factor->contact_factor().triangularView<Eigen::Lower>();
}

}  // namespace

// The last two rows of System::traces are own and by_theta (Condensed).
Loads loads_of(const Model& m) {
  Loads l{m.inner->system.F, {}, m.inner->skeleton.prescribed};
  if (m.inner->system.penalty > 0) l.own = m.inner->system.traces.row(m.inner->system.traces.rows() - 2).transpose();
  return l;
}

// Rows to unknowns, with the values of those that are not solved for; of contact rows with a gap or a slip of the step
// before both add up: j = k - g.
Eigen::VectorXd on_skeleton(const Model& m, const Eigen::VectorXd& rows, const std::vector<double>* given) {
  Eigen::VectorXd all(m.inner->skeleton.total);
  for (Index u = 0; u < m.inner->skeleton.total; ++u) {
    const Index row = m.inner->ordering.row[u];
    all[u] = row == none ? 0 : rows[row];
    if (given && (*given)[u] != 0) all[u] += (*given)[u];
  }
  return all;
}

Eigen::VectorXd on_rows(const Model& m, const Eigen::VectorXd& skeleton) {
  Eigen::VectorXd rows(m.inner->ordering.size);
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    if (const Index row = m.inner->ordering.row[u]; row != none) rows[row] = skeleton[u];
  return rows;
}

DoubleDouble on_skeleton(const Model& m, const PenaltyIterate& s, const std::vector<double>& given) {
  DoubleDouble all{on_skeleton(m, s.x, &given), {}};
  if (s.low.size() > 0) all.low = on_skeleton(m, s.low, nullptr);
  return all;
}

// An enclosed body does not feel a uniform theta/a, so that its error must be watched here: as a pressure, relative to
// the terms that it is the sum of.
ThetaChange move_theta(const Model& m, const Loads& loads, const DoubleDouble& skeleton, Eigen::VectorXd& theta) {
  const Eigen::VectorXd before = theta;
  Eigen::VectorXd size(theta.size()), change(theta.size());
  const Eigen::Index count = m.inner->system.traces.rows() - 2;
  parallel_for(static_cast<Index>(theta.size()), m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const auto column = m.inner->system.traces.col(t);
      const SkeletonVector seen_here = skeleton.low.size() > 0
                                           ? strained(m, skeleton, t).rest
                                           : trace_seen(m.mesh, m.inner->skeleton, skeleton.high, t);
      const double size_of = cell_area(m, t), a = penalty_at(m, t),
                   mean = column.head(count).dot(seen_here) / size_of + loads.own[t] + theta[t] * column[count + 1];
      size[t] = std::max(column.head(count).cwiseProduct(seen_here).cwiseAbs().sum() / size_of + std::abs(loads.own[t]),
                         std::abs(mean));
      theta[t] = a * mean;
      change[t] = mean - before[t] / a;
    }
  });
  const Index own = own_triangles(m);
  return own > 0 ? ThetaChange{change.head(own).cwiseAbs().maxCoeff(), size.head(own).maxCoeff()} : ThetaChange{};
}

void update_theta(const Model& m, const Loads& loads, PenaltyIterate& s) {
  const ThetaChange moved = move_theta(m, loads, on_skeleton(m, s, loads.prescribed), s.theta);
  s.penalty_error = moved.size > 0 ? moved.change / moved.size : 0;
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

Condensation::Condensation(const Model& model) : m(model), points(contact_points(model)) {
  if (has_large_contact(m)) return;
  S = m.inner->factor->contact_complement();
  m.inner->semicoercive.release(S);
}

// |L^-1 b|^2, half a solve; with large contact a whole one.
double Condensation::energy_of(const Eigen::VectorXd& b, const std::vector<Motion>& motion) const {
  if (has_large_contact(m)) return std::abs(b.dot(solve_frozen(b, motion)));
  return std::abs(m.inner->factor->energy(b));
}

namespace {

// With large contact. `given`: of the held rows, 0 on the others.
Eigen::VectorXd solve_held(const Model& m, const Eigen::VectorXd& b, const std::vector<Motion>& motion,
                           const Eigen::VectorXd* given) {
  const LowerTriangle& K = *m.inner->system.K;
  const std::vector<bool> held = held_by(motion, m.inner->ordering.contact_rows);
  if (!given || given->isZero(0)) return m.inner->held->solve(K, held, b);
  Eigen::VectorXd at = Eigen::VectorXd::Zero(b.size());
  at.tail(given->size()) = *given;
  return at + m.inner->held->solve(K, held, b - multiply(K, at));
}

}  // namespace

Eigen::VectorXd Condensation::load(const Eigen::VectorXd& y) const {
  Eigen::VectorXd r = lower(m) * y.tail(m.inner->ordering.contact_rows);
  if (const Eigen::MatrixXd& slides = m.inner->semicoercive.slides; slides.cols() > 0)
    r -= slides * (slides.transpose() * r);  // rounding: the loads do no work on it
  return r;
}

Eigen::VectorXd Condensation::complete(Eigen::VectorXd y, const Eigen::VectorXd& jump) const {
  const auto l = lower(m);
  y.tail(jump.size()) = l.transpose() * jump;
  Eigen::VectorXd x = m.inner->factor->backward(y);
  x.tail(jump.size()) = jump;
  return x;
}

// The block of the moving rows is factorized once for all rounds with the same set.
Eigen::VectorXd Condensation::moving_jumps(const Eigen::VectorXd& r, const std::vector<Motion>& motion) const {
  std::vector<bool> held(motion.size());
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = motion[i] == Motion::Held;
  if (!open_rows_ || open_rows_->closed() != held) open_rows_.emplace(S, std::move(held));
  return open_rows_->jumps(r);
}

// Held rows keep their jumps, moving ones their forces: S_MM j_M = r_M - S_MH g, then one substitution backwards
// [theory: C.7].
Eigen::VectorXd Condensation::solve_frozen(const Eigen::VectorXd& b, const std::vector<Motion>& motion,
                                           const Eigen::VectorXd* held) const {
  if (has_large_contact(m)) return solve_held(m, b, motion, held);
  const Eigen::VectorXd y = m.inner->factor->forward(b);
  if (m.inner->ordering.contact_rows == 0) return m.inner->factor->backward(y);
  if (sliding) {
    if (!sliding_rows_) sliding_rows_.emplace(S, motion, *sliding);
    return complete(y, sliding_rows_->jumps(load(y), held));
  }
  if (!held) return complete(y, moving_jumps(load(y), motion));
  return complete(y, *held + moving_jumps(load(y) - S * *held, motion));
}

Eigen::VectorXd Condensation::solve_at_contact(const Eigen::VectorXd& b, const std::vector<Motion>& motion) const {
  return m.inner->held->solve(*m.inner->system.K, held_by(motion, m.inner->ordering.contact_rows), b,
                              HeldFactors::On::Contact);
}

namespace {

PressedBody pressed(const Condensation& condensed, const Loads& loads, const std::vector<Motion>& motion) {
  const Model& m = condensed.m;
  const auto respond = [&](const Eigen::VectorXd& theta) -> Eigen::VectorXd {
    PenaltyIterate unit;
    unit.theta = theta;
    return condensed.solve_frozen(right_hand_side(m, loads, unit) - loads.F, motion);
  };
  return {.model = m,
          .loads = loads,
          .respond = respond,
          .skeleton = [&m](const Eigen::VectorXd& x) { return on_skeleton(m, x, nullptr); },
          .symmetric = !condensed.sliding};
}

void correct(const Condensation& condensed, const Loads& loads, UniformPressure& uniform, PenaltyIterate& s) {
  const Model& m = condensed.m;
  const PressedBody body = pressed(condensed, loads, s.motion);
  const Eigen::VectorXd delta = uniform.correct(body, held_by(s.motion, m.inner->ordering.contact_rows),
                                                on_skeleton(m, s, loads.prescribed), s.theta);
  if (s.low.size() > 0) {  // a stiff material feels the rounding of x
    DoubleDouble x{std::move(s.x), std::move(s.low)};
    for (Eigen::Index k = 0; k < delta.size(); ++k) add(x, delta[k], uniform.response().col(k));
    s.x = std::move(x.high);
    s.low = std::move(x.low);
  } else {
    s.x += uniform.response() * delta;
  }
  if (uniform.level_open()) uniform.take_out_level(body, on_skeleton(m, s, loads.prescribed), s.theta);
}

}  // namespace

// A product K x is known to a unit in the last place of |K| |x| (E.17).
double rounding_of(const Model& m, const Eigen::VectorXd& x, double load) {
  return std::numeric_limits<double>::epsilon() * multiply_sizes(*m.inner->system.K, x).maxCoeff() / load;
}

bool RoundsEnd::take(double error) {
  const bool first = std::exchange(begins_, false), slow = !first && !(error <= 0.5 * least_),
             best = first || error < least_;
  if (best) least_ = error;
  patience_ = penalized_ && least_ > settled ? 6 : 1;
  without_gain_ = slow ? without_gain_ + 1 : 0;
  return best;
}

// A round is one solve, its uniform pressures, one step of theta, the loads of that. The best round is kept: with a
// penalty errors may rise before they fall.
PenaltyIterate iterate(const Condensation& condensed, const Loads& loads, PenaltyIterate next, UniformPressure& uniform,
                       const PenaltySteps& steps) {
  const Model& m = condensed.m;
  const bool penalized = m.inner->system.penalty > 0, any_rows = m.inner->ordering.size > 0;
  if (penalized && next.theta.size() == 0) next.theta.setZero(static_cast<Eigen::Index>(m.mesh.triangles.size()));
  Eigen::VectorXd F = loads.F;
  const auto pay_back = [&](PenaltyIterate& s) {
    correct(condensed, loads, uniform, s);
    update_theta(m, loads, s);
    F = right_hand_side(m, loads, s);
  };
  if (!any_rows) {
    for (int round = 0; round < steps.most && penalized; ++round) pay_back(next);
    return next;
  }
  const auto round = [&](PenaltyIterate& s) {
    steps.solve(F, s);
    if (penalized) pay_back(s);
    steps.certify(F, s);
    return s.certificate.kkt;
  };
  const auto enough = [&](const PenaltyIterate& s, double error) {
    return error <= steps.enough ||
           (!penalized && steps.rounding && error <= RoundsEnd::settled && error <= steps.rounding(s));
  };
  return best_round(std::move(next), penalized, steps.most, round, enough).best;
}

}  // namespace kerf
