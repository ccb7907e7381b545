#include "solver/system/penalty.hpp"

#include "solver/system.hpp"

#include "solver/contact/law.hpp"
#include "solver/parallel.hpp"
#include "solver/stopwatch.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

double size_of_load(const Model& m) {
  return std::max(m.inner->system.F.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
}

// The contact forces, |K x - F| on the rows that no contact holds, and how far jumps and forces are from the law.
void certify(const Condensation& condensed, const Eigen::VectorXd& F, PenaltyIterate& s) {
  const Model& m = condensed.m;
  const Index contact_rows = m.inner->ordering.contact_rows, leading = m.inner->ordering.size - contact_rows;
  const Eigen::VectorXd rest = multiply(m.inner->system.K, s.x) - F;
  const double load = size_of_load(m);
  Certificate& c = s.certificate;
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

Contact contact_on(const Condensation& condensed, ContactMethod method, const Eigen::VectorXd& b,
                   const Eigen::VectorXd& y, const std::vector<Motion>& guess) {
  switch (method) {
    case ContactMethod::DualQp:
      return dual_qp(condensed.S, condensed.load(y), condensed.points, guess);
    case ContactMethod::Uzawa:
      return uzawa(condensed.S, condensed.load(y), condensed.points);
    default:
      return eliminate(condensed, b, y, guess);
  }
}

// K x = F + contact forces, from a first guess x (corrected by its residual) or from nothing.
void solve_contact(const Condensation& condensed, ContactMethod method, const Eigen::VectorXd& F, PenaltyIterate& s,
                   State& state) {
  const Model& m = condensed.m;
  const Index contact_rows = m.inner->ordering.contact_rows;
  // The correction solves for x as a whole on the rows in contact: their part of the guess is dropped first.
  const bool guess = s.x.size() > 0;
  if (guess) s.x.tail(contact_rows).setZero();
  const Eigen::VectorXd rest = guess ? Eigen::VectorXd(F - multiply(m.inner->system.K, s.x)) : F;
  const Eigen::VectorXd y = m.inner->factor.forward(rest);
  ++state.linear_solves;
  Eigen::VectorXd correction;
  if (contact_rows > 0) {
    Stopwatch watch;
    const Contact contact = contact_on(condensed, method, rest, y, s.motion);
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
}

// What no residual in double precision can be expected to be smaller than.
double rounding_of(const Model& m, const Eigen::VectorXd& x) {
  if (m.inner->ordering.size == 0) return 0;
  return std::numeric_limits<double>::epsilon() * multiply_absolute(m.inner->system.K, x).maxCoeff() / size_of_load(m);
}

void recover_interior(const Model& m, const PenaltyIterate& solution, State& state) {
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const double penalty = m.inner->system.penalty;
  state.interior.resize(interior_count(m.element), triangles);
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t)
      state.interior.col(t) =
          interior(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), force_of(m.inner->system, t),
                   trace_seen(m.mesh, m.inner->skeleton, state.skeleton, t),
                   {.a = penalty, .theta = penalty > 0 ? solution.theta[t] : 0});
  });
}

// Takes the rigid motions out that the supports leave free.
void remove_motions(const Model& m, State& state) {
  const Eigen::VectorXd share = floating_shares(m, state);
  for (Index i = 0; i < static_cast<Index>(m.inner->floating.size()); ++i)
    state.skeleton.head(m.inner->skeleton.base) -=
        share[i] * trace(m.mesh, m.inner->kernel, m.inner->skeleton, m.inner->floating[i]);
}

}  // namespace

Eigen::VectorXd floating_shares(const Model& m, const Field& s) {
  const Index n = static_cast<Index>(m.inner->floating.size());
  const Kernel& k = m.inner->kernel;
  Eigen::VectorXd moment = Eigen::VectorXd::Zero(n);
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Triangle shape = triangle(m, t);
    const Points x = rule_points(k.rule, shape), u = evaluate(m, s, t, x).displacement;
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      const double w = area(shape) * k.rule.w[q];
      const Vec2 at = seen_at(k, shape, x.col(q));
      for (Index i = 0; i < n; ++i) moment[i] += w * u.col(q).dot(m.inner->floating[i].at(at));
    }
  }
  return shares(m.mesh, k, m.inner->skeleton, m.inner->floating, moment);
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
  Stopwatch watch;
  const Condensation condensed(m);
  state.seconds.contact = watch.lap();
  UniformPressure uniform{.must_fit = true};
  const auto solve = [&](const Eigen::VectorXd& F, PenaltyIterate& s) {
    solve_contact(condensed, method, F, s, state);
  };
  const auto judge = [&](const Eigen::VectorXd& F, PenaltyIterate& s) { certify(condensed, F, s); };
  const bool penalized = m.inner->system.penalty > 0;
  const PenaltySteps steps{solve, judge, penalized ? 40 : 15, penalized ? 1e-16 : 1e-12};
  const double before = state.seconds.contact;
  const PenaltyIterate solution = iterate(condensed, loads_of(m), {}, uniform, steps);
  if (uniform.level_open)
    has_free_pressure(m.mesh, m.scene, m.inner->skeleton);  // an opening crack would have fixed it

  state.linear_solves += uniform.solves;
  state.certificate = solution.certificate;
  state.certificate.rounding = rounding_of(m, solution.x);
  state.skeleton = on_skeleton(m, solution.x, &m.inner->skeleton.prescribed);
  state.force = on_skeleton(m, solution.force, nullptr);
  recover_interior(m, solution, state);
  if (!m.inner->floating.empty()) {
    remove_motions(m, state);
    recover_interior(m, solution, state);
  }
  state.seconds.solve = watch.lap() - (state.seconds.contact - before);
  return state;
}

}  // namespace kerf
