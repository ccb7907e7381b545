#include "solver/system/penalty.hpp"

#include "solver/system.hpp"

#include "solver/contact/law.hpp"
#include "solver/parallel.hpp"
#include "solver/stopwatch.hpp"

#include <fmt/core.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

// |K x - F| on the rows that no contact holds; the contact forces and how far they and the jumps are from the law.
Certificate certify(const Condensation& condensed, PenaltyIterate& s, const Eigen::VectorXd& F) {
  const Model& m = condensed.m;
  const Index contact_rows = m.inner->ordering.contact_rows, leading = m.inner->ordering.size - contact_rows;
  const Eigen::VectorXd rest = multiply(m.inner->system.K, s.x) - F;
  const double load = std::max(m.inner->system.F.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  Certificate c;
  c.residual = leading > 0 ? rest.head(leading).cwiseAbs().maxCoeff() / load : 0;
  s.force = Eigen::VectorXd::Zero(m.inner->ordering.size);
  double law = 0;
  if (contact_rows > 0) {
    const Eigen::VectorXd force = rest.tail(contact_rows);
    const Admissible allowed = admissible(condensed.points, force);
    for (Index i = 0; i < contact_rows; ++i) {
      if (s.motion[i] == Motion::Held)
        s.force[leading + i] = force[i];
      else
        s.force[leading + i] = s.motion[i] == Motion::Forward ? allowed.low[i] : allowed.high[i];
      if (s.motion[i] != Motion::Held)
        c.residual = std::max(c.residual, std::abs(force[i] - s.force[leading + i]) / load);
    }
    law = optimality(condensed.points, s.x.tail(contact_rows), force, load);
  }
  c.kkt = std::max({c.residual, law, s.penalty_error});
  return c;
}

// Jumps and forces of the whole sparse system for `active_set`.
Contact eliminate(const Condensation& condensed, const Eigen::VectorXd& b, const Eigen::VectorXd& y,
                  const std::vector<Motion>& guess) {
  const Eigen::VectorXd r = condensed.load(y);
  const auto respond = [&](const std::vector<Motion>& motion, const Eigen::VectorXd& force) -> Response {
    const Eigen::VectorXd jump = condensed.moving_jumps(r + force, motion);
    const Eigen::VectorXd rest = multiply(condensed.m.inner->system.K, condensed.complete(y, jump)) - b;
    return {jump, rest.tail(jump.size())};
  };
  return active_set({condensed.m.inner->ordering.contact_rows, respond}, condensed.points, guess);
}

// K x = F + contact forces, from a first guess x (corrected by its residual) or from nothing.
void solve_contact(const Condensation& condensed, ContactMethod method, const Eigen::VectorXd& F, PenaltyIterate& s,
                   State& state) {
  const Model& m = condensed.m;
  Stopwatch watch;
  const Index contact_rows = m.inner->ordering.contact_rows;
  // The correction solves for x as a whole on the rows in contact: their part of the guess is dropped first.
  const bool guess = s.x.size() > 0;
  if (guess) s.x.tail(contact_rows).setZero();
  const Eigen::VectorXd rest = guess ? Eigen::VectorXd(F - multiply(m.inner->system.K, s.x)) : F;
  const Eigen::VectorXd y = m.inner->factor.forward(rest);
  ++state.linear_solves;
  state.seconds.solve += watch.lap();
  Eigen::VectorXd correction;
  if (contact_rows > 0) {
    const Contact contact = method == ContactMethod::DualQp
                                ? dual_qp(condensed.S, condensed.load(y), condensed.points, s.motion)
                            : method == ContactMethod::Uzawa ? uzawa(condensed.S, condensed.load(y), condensed.points)
                                                             : eliminate(condensed, rest, y, s.motion);
    if (method == ContactMethod::ActiveSet) state.linear_solves += contact.solves;
    s.motion = contact.motion;
    state.contact_iterations += contact.iterations;
    state.converged = contact.converged;
    state.seconds.contact += watch.lap();
    correction = condensed.complete(y, contact.jump);
    for (Index i = 0; i < contact_rows; ++i)
      if (s.motion[i] == Motion::Held) correction[m.inner->ordering.size - contact_rows + i] = 0;
  } else {
    correction = m.inner->factor.backward(y);
  }
  if (guess)
    s.x += correction;
  else
    s.x = std::move(correction);
  state.seconds.solve += watch.lap();
}

}  // namespace

Eigen::VectorXd floating_shares(const Model& m, const Field& s) {
  const Index n = static_cast<Index>(m.inner->floating.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd moment = Eigen::VectorXd::Zero(n);
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Triangle shape = triangle(m, t);
    const Points x = rule_points(m.inner->kernel.rule, shape), u = evaluate(m, s, t, x).displacement;
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      const double w = area(shape) * m.inner->kernel.rule.w[q];
      // The motion as the element's displacement sees it: its mean when that is constant.
      const Vec2 at = m.element.displacement == 0 ? centroid(shape) : Vec2(x.col(q));
      for (Index i = 0; i < n; ++i) {
        moment[i] += w * u.col(q).dot(m.inner->floating[i].at(at));
        for (Index j = 0; j < n; ++j) gram(i, j) += w * m.inner->floating[i].at(at).dot(m.inner->floating[j].at(at));
      }
    }
  }
  return gram.llt().solve(moment);
}

std::vector<ContactPoint> contact_points(const Model& m) {
  const Index leading = m.inner->ordering.size - m.inner->ordering.contact_rows;
  std::vector<ContactPoint> points;
  for (std::size_t crack = 0; crack < m.mesh.cracks.size(); ++crack) {
    const CrackLaw& law = m.scene.laws[crack];
    for (const CrackEdge& c : m.mesh.cracks[crack])
      for (int g = 0; g < m.inner->skeleton.per_edge / 2; ++g) {
        const Index unknown = m.inner->skeleton.jump[c.edge] + 2 * g;
        if (!m.inner->skeleton.bounded[unknown]) continue;
        ContactPoint p;
        p.normal = m.inner->ordering.row[unknown] - leading;
        if (m.inner->skeleton.frictional[unknown + 1]) {
          p.tangential = m.inner->ordering.row[unknown + 1] - leading;
          p.slip_bound = law.slip_bound * length(m.mesh, c.edge) * m.inner->kernel.trace.w[g];
          p.friction = law.friction;
        }
        points.push_back(p);
      }
  }
  return points;
}

void check_volume(const Model& m, double change, double largest_strain) {
  const double displacement = std::transform_reduce(
      m.inner->skeleton.prescribed.begin(), m.inner->skeleton.prescribed.end(), 0.0,
      [](double a, double b) { return std::max(a, b); }, [](double v) { return std::abs(v); });
  constexpr double rounding = 1e-7;
  const double whole = area(m);
  if (std::abs(change) > 2 * rounding * std::max(displacement * std::sqrt(whole), largest_strain * whole))
    throw Error(Fault::Numerics,
                fmt::format("the body is incompressible (poisson = 0.5) and wholly enclosed by its supports, but the "
                            "prescribed displacements change its area by {:.3g}; free a part of the boundary, or "
                            "prescribe displacements that keep the area",
                            change));
}

State solve(const Model& m, ContactMethod method) {
  State state;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  PenaltyIterate solved;
  if (m.inner->system.penalty > 0) solved.theta = Eigen::VectorXd::Zero(triangles);
  Eigen::VectorXd F = m.inner->system.F;
  Stopwatch watch;
  const Condensation condensed(m);
  const Loads loads = loads_of(m);
  state.seconds.contact += watch.lap();
  UniformPressure uniform;
  // One solve, then iterations that remove the residual: of rounding, and of the penalty when there is one. With a
  // penalty F is as large as 1/a, so that the iterations go on until rounding stops them; before they shrink the error
  // they may raise it, while a pressure builds up or contacts change.
  const bool penalized = m.inner->system.penalty > 0;
  const int most_iterations = penalized ? 40 : 15;
  const double good_enough = penalized ? 1e-16 : 1e-12;
  PenaltyIterate next = solved;
  int without_gain = 0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (m.inner->ordering.size > 0) solve_contact(condensed, method, F, next, state);
    watch.lap();
    if (penalized) {
      uniform.correct(condensed, loads, next);
      if (uniform.level_open) check_volume(m, uniform.change_of_area, uniform.largest_strain);
      update_theta(m, loads, next);
      F = right_hand_side(m, loads, next);
    }
    if (m.inner->ordering.size == 0) {
      solved = next;
      if (!penalized) break;
      continue;
    }
    const Certificate certificate = certify(condensed, next, F);
    state.seconds.solve += watch.lap();
    const bool better = iteration == 0 || certificate.kkt < state.certificate.kkt;
    const bool slow = iteration > 0 && certificate.kkt > 0.5 * state.certificate.kkt;
    if (better) {
      solved = next;
      state.certificate = certificate;
    }
    constexpr double settled = 1e-9;
    without_gain = slow ? without_gain + 1 : 0;
    const int patience = penalized && state.certificate.kkt > settled ? 6 : 1;
    if (certificate.kkt <= good_enough || without_gain == patience) break;
  }

  state.linear_solves += uniform.solves;
  if (uniform.level_open)
    has_free_pressure(m.mesh, m.scene, m.inner->skeleton);  // an opening crack would have fixed it
  watch.lap();
  if (m.inner->ordering.size > 0) {
    const double load = std::max(m.inner->system.F.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
    state.certificate.rounding =
        std::numeric_limits<double>::epsilon() * multiply_absolute(m.inner->system.K, solved.x).maxCoeff() / load;
  }
  state.skeleton = on_skeleton(m, solved.x, &m.inner->skeleton.prescribed);
  state.force = on_skeleton(m, solved.force, nullptr);
  state.interior.resize(interior_count(m.element), triangles);
  const auto recover = [&] {
    parallel_for(triangles, m.threads, [&](Index begin, Index end) {
      for (Index t = begin; t < end; ++t) {
        const Penalty penalty{m.inner->system.penalty, m.inner->system.penalty > 0 ? solved.theta[t] : 0};
        state.interior.col(t) =
            interior(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), force_of(m.inner->system, t),
                     trace_seen(m.mesh, m.inner->skeleton, state.skeleton, t), penalty);
      }
    });
  };
  recover();
  if (!m.inner->floating.empty()) {
    const Eigen::VectorXd share = floating_shares(m, state);
    for (Index i = 0; i < static_cast<Index>(m.inner->floating.size()); ++i)
      state.skeleton.head(m.inner->skeleton.base) -=
          share[i] * trace(m.mesh, m.inner->kernel, m.inner->skeleton, m.inner->floating[i]);
    recover();
  }
  state.seconds.solve += watch.lap();
  return state;
}

}  // namespace kerf
