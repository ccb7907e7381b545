// The state: K x = F + contact forces, under the law of the rows in contact. Rounds of one linear solve with its
// contact problem (solver/system/penalty.cpp) remove residuals and pay back the penalty of nearly incompressible
// triangles. What comes out is judged triangle by triangle, free of the rounding of K,
//   a(x, x) = sum_T x.P K_T P x,   W = l.x + g.rho + j.p,   a - W = -x.r   [theory: E.20],
// work error = max(|a - W|/a, (r.K^-1 r/a)^(1/2))   [theory: E.21],   kkt = max |p - P(p - j)|   [theory: C.12]. Where
// that says that digits are lost (bodies that bend by far more than they are strained) conjugate gradients on the exact
// products take over [theory: E.19], and the better of both states is kept. Derived in docs/theory/elements.md, section
// Slender bodies, and docs/theory/contact.md, sections Algorithms and How well a contact problem is solved.

#include "solver/system/refine.hpp"

#include "solver/system.hpp"

#include "base/parallel.hpp"
#include "base/stopwatch.hpp"
#include "solver/contact/law.hpp"
#include "solver/element/spaces.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace kerf {

namespace {

// Never 0: an unloaded body divides by it.
double size_of_loads(const Model& m) {
  return std::max(m.inner->system.F.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
}

// What a state is judged by: `rest` = K x - F per row, `load` the largest force that drives the body.
struct Judged {
  const Eigen::VectorXd& rest;
  double load = 0;
};

// The contact forces, |K x - F| on the rows that no contact holds, and how far jumps and forces are from the law.
// Moving rows are given the force that the law has for their motion; what K x - F differs from that by is residual.
// Held ones take what there is, which the law judges.
void certify_iterate(const Condensation& condensed, const Judged& by, PenaltyIterate& s) {
  const Model& m = condensed.m;
  const Index contact_rows = m.inner->ordering.contact_rows, leading = m.inner->ordering.leading();
  const double load = by.load;
  Certificate& c = s.certificate;
  c.residual = leading > 0 ? by.rest.head(leading).cwiseAbs().maxCoeff() / load : 0;
  s.force = Eigen::VectorXd::Zero(m.inner->ordering.size);
  double law = 0;
  if (contact_rows > 0) {
    const JudgedContact judged =
        judge_contact(condensed.points, s.motion, s.x.tail(contact_rows), by.rest.tail(contact_rows), load);
    s.force.tail(contact_rows) = judged.bears;
    c.residual = std::max(c.residual, judged.residual);
    law = judged.law;
  }
  c.kkt = s.x.allFinite() ? std::max({c.residual, law, s.penalty_error}) : infinity;
}

// Jumps and forces of the whole sparse system for `active_set`.
// Method "active-set": S finds the jumps, but the forces are those of the whole sparse matrix, so that what S misses
// shows on the rows that move.
Contact eliminate(const Condensation& condensed, const Eigen::VectorXd& b, const Eigen::VectorXd& y,
                  const std::vector<Motion>& guess) {
  const Eigen::VectorXd r = condensed.load(y);
  const auto respond = [&](const std::vector<Motion>& motion, const Eigen::VectorXd& force) -> Response {
    const Eigen::VectorXd jump = condensed.moving_jumps(r + force, motion);
    const Eigen::VectorXd rest = multiply(*condensed.m.inner->system.K, condensed.complete(y, jump)) - b;
    return {jump, rest.tail(jump.size())};
  };
  return active_set({condensed.m.inner->ordering.contact_rows, respond}, condensed.points, guess);
}

// K x on the rows in contact.
// Only entries in the last rows are gone through: a small share of K.
class ForcesInContact {
 public:
  ForcesInContact(const LowerTriangle& K, Index rows)
      : K_(K), first_(K.size - rows), rows_(rows), entries_(entries_of_last(K, rows)) {}
  Eigen::VectorXd operator()(const Eigen::VectorXd& x) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(rows_);
    for (const auto& [i, j, at] : entries_) {
      const double value = K_.values[at];
      force[i - first_] += value * x[j];
      if (j >= first_ && j != i) force[j - first_] += value * x[i];
    }
    return force;
  }

 private:
  const LowerTriangle& K_;
  Index first_, rows_;
  std::vector<EntryPlace> entries_;
};

// Where there is no dense matrix of contact: by factors of the whole. Moves s.x on to the solution.
// The same set and the same forces as the last ones are not solved for twice: the exact limits of a set without
// friction are its rough ones.
Contact contact_by_factors(const Condensation& condensed, ContactMethod method, const Eigen::VectorXd& F,
                           PenaltyIterate& s) {
  const Inner& inner = *condensed.m.inner;
  const Index rows = inner.ordering.contact_rows;
  if (method == ContactMethod::Uzawa)
    throw Error(Fault::Usage, fmt::format("\"uzawa\" needs the dense matrix of contact, which {} unknowns are too many "
                                          "for; use \"dual-qp\"",
                                          rows));
  const ForcesInContact forces(*inner.system.K, rows);
  const bool begins = s.x.size() == 0;
  if (begins) s.x.setZero(inner.ordering.size);
  // From nothing, where a set is judged by rows in contact and those beside them, and the last is solved as a whole;
  // later what the rest asks for on top.
  std::vector<Motion> last;
  Eigen::VectorXd given;
  const auto respond = [&](const std::vector<Motion>& motion, const Eigen::VectorXd& force) -> Response {
    const auto answer = [&]() -> Response { return {s.x.tail(rows), forces(s.x) - F.tail(rows)}; };
    if (begins && !last.empty() && held_by(motion, rows) == held_by(last, rows) && force == given) return answer();
    last = motion;
    given = force;
    for (Index i = 0; i < rows; ++i)
      if (motion[i] == Motion::Held) s.x[s.x.size() - rows + i] = 0;
    Eigen::VectorXd missing = begins ? F : F - multiply(*inner.system.K, s.x);
    missing.tail(rows) += force;
    if (begins)
      s.x = condensed.solve_at_contact(missing, motion);
    else
      s.x += condensed.solve_frozen(missing, motion);
    return answer();
  };
  const std::vector<Motion> guess = s.motion.empty() ? inner.start : s.motion;
  Contact contact = active_set({.rows = rows, .solve = respond, .most_iterations = 500, .trusts_guess = true},
                               condensed.points, guess);
  if (begins && !last.empty()) {
    Eigen::VectorXd missing = F;
    missing.tail(rows) += given;
    s.x = condensed.solve_frozen(missing, last);
  }
  return contact;
}

Contact contact_on(const Condensation& condensed, ContactMethod method, const Eigen::VectorXd& b,
                   const Eigen::VectorXd& y, const std::vector<Motion>& guess) {
  if (const Semicoercive& pieces = condensed.m.inner->semicoercive; !pieces.empty())
    return semicoercive({condensed.S, condensed.load(y), condensed.points, pieces}, guess);
  switch (method) {
    case ContactMethod::DualQp:
      return dual_qp(condensed.S, condensed.load(y), condensed.points, guess);
    case ContactMethod::Uzawa:
      return uzawa(condensed.S, condensed.load(y), condensed.points);
    default:
      return eliminate(condensed, b, y, guess);
  }
}

void take(const Contact& contact, Stopwatch& watch, PenaltyIterate& s, State& state) {
  s.motion = contact.motion;
  state.contact_iterations += contact.iterations;
  state.converged = contact.converged;
  state.seconds.contact += watch.lap();
}

// K x = F + contact forces, from a first guess x (corrected by its residual) or from nothing.
void solve_contact(const Condensation& condensed, ContactMethod method, const Eigen::VectorXd& F, PenaltyIterate& s,
                   State& state) {
  const Model& m = condensed.m;
  const Index contact_rows = m.inner->ordering.contact_rows;
  if (has_large_contact(m)) {
    Stopwatch watch;
    const Contact contact = contact_by_factors(condensed, method, F, s);
    state.linear_solves += contact.solves;
    take(contact, watch, s, state);
    return;
  }
  // The correction solves for x as a whole on the rows in contact: their part of the guess is dropped first.
  const bool guess = s.x.size() > 0;
  if (guess) s.x.tail(contact_rows).setZero();
  const Eigen::VectorXd rest = guess ? Eigen::VectorXd(F - multiply(*m.inner->system.K, s.x)) : F;
  const Eigen::VectorXd y = m.inner->factor->forward(rest);
  ++state.linear_solves;
  Eigen::VectorXd correction;
  if (contact_rows > 0) {
    Stopwatch watch;
    const Contact contact = contact_on(condensed, method, rest, y, s.motion);
    if (method == ContactMethod::ActiveSet) state.linear_solves += contact.solves;
    take(contact, watch, s, state);
    correction = condensed.complete(y, contact.jump);
    for (Index i = 0; i < contact_rows; ++i)
      if (s.motion[i] == Motion::Held) correction[m.inner->ordering.leading() + i] = 0;
  } else {
    correction = m.inner->factor->backward(y);
  }
  if (guess)
    s.x += correction;
  else
    s.x = std::move(correction);
}

// What drives the body: loads per skeleton unknown, and the largest of them and of the forces that it takes to
// prescribe what is not 0.
struct Drive {
  Eigen::VectorXd loads;
  double largest = 0;
};

double stiffest(const Model& m) {
  double most = 0;
  if (m.inner->ordering.size == 0) return most;
  const LowerTriangle& K = *m.inner->system.K;
  for (Index j = 0; j < K.size; ++j)
    if (K.start[j] < K.start[j + 1]) most = std::max(most, std::abs(K.values[K.start[j]]));
  return most;
}

// What the slip of the steps before [theory: C.28] would take if nothing answered it. Of an unloaded body that is all
// there is to compare rounding with.
struct PreviousSlip {
  double force = 0, energy = 0;
};
PreviousSlip remembered(const Model& m) {
  const Skeleton& skeleton = m.inner->skeleton;
  Eigen::VectorXd slip = Eigen::VectorXd::Zero(m.inner->ordering.size);
  for (Index u = skeleton.base; u < skeleton.total; ++u)
    if (skeleton.frictional[u]) slip[m.inner->ordering.row[u]] = skeleton.prescribed[u];
  if (slip.isZero(0)) return {};
  const Eigen::VectorXd force = multiply(*m.inner->system.K, slip);
  return {few_digits * force.cwiseAbs().maxCoeff(), few_digits * slip.dot(force)};
}

// The state of an iterate, certified triangle by triangle: the residual, contact and friction by the exact forces, and
// the work [theory: E.20, E.21].
Drive judge(const Condensation& condensed, PenaltyIterate& s, State& state) {
  const Model& m = condensed.m;
  const DoubleDouble values = on_skeleton(m, s, m.inner->skeleton.prescribed);
  Balance balance = recover_interior(m, values, s.theta, state);
  const Eigen::VectorXd rest = on_rows(m, balance.forces - balance.loads);
  Driven driven = driven_by(m, balance, values, stiffest(m), sums_of_one());
  const PreviousSlip before = remembered(m);
  const double largest = std::max(driven.largest, before.force);
  certify_iterate(condensed, {rest, largest}, s);
  driven.work += s.force.dot(s.x);
  // The part of the rest that nothing answers, and the energy of the error that it stands for.
  Eigen::VectorXd missed = rest - s.force;
  const Index leading = m.inner->ordering.leading();
  for (Index i = 0; i < m.inner->ordering.contact_rows; ++i)
    if (s.motion[i] == Motion::Held) missed[leading + i] = 0;
  const double error = condensed.energy_of(missed, s.motion);
  const JudgedWork work = judge_work(m, balance, driven, before.energy, state, sums_of_one());
  s.certificate.work = work.size > 0 ? std::max(work.error, std::sqrt(error / work.size)) : 0;
  state.certificate = s.certificate;
  state.skeleton = values.high;
  state.force = on_skeleton(m, s.force, nullptr);
  return {std::move(balance.loads), largest};
}

// The larger of the two, as nothing when it is not a number.
double defect(const Certificate& c) {
  return std::isfinite(c.kkt) && std::isfinite(c.work) ? std::max(c.kkt, c.work) : infinity;
}

// Contact by the exact forces and the S of the factor, which is as far off as its matrix; then conjugate gradients with
// the rows held that it holds; until the set stays. `largest`: Drive::largest.
// The set of the small problem is that of the factor's S; its forces are not: with exact residuals its fixed points are
// exact. It ends when the law holds to 1e-12, or when a sweep does not halve what it lacks.
struct Settling {
  const Condensation& condensed;
  const Refinement& refinement;
  double largest = 0;
  State& state;

  void operator()(const Eigen::VectorXd& F, PenaltyIterate& s) const {
    const Model& m = condensed.m;
    const Index contact_rows = m.inner->ordering.contact_rows;
    const std::vector<double>& prescribed = m.inner->skeleton.prescribed;
    if (contact_rows == 0) {
      state.linear_solves += refinement.solve(F, prescribed, s);
      return;
    }
    if (has_large_contact(m)) {  // the set stays; the certificate tells
      Eigen::VectorXd driven = F;
      for (Index i = 0, row = m.inner->ordering.leading(); i < contact_rows; ++i, ++row)
        if (s.motion[i] != Motion::Held) driven[row] += s.force[row];
      state.linear_solves += refinement.solve(driven, prescribed, s);
      return;
    }
    constexpr int most = 10;
    constexpr double enough = 1e-12;
    double last = infinity;
    for (int sweep = 0; sweep < most; ++sweep) {
      const Eigen::VectorXd rest = refinement.rest(F, prescribed, s), jump = s.x.tail(contact_rows);
      const double law = optimality(condensed.points, jump, -rest.tail(contact_rows), largest);
      if (sweep > 0 && (law <= enough || (sweep > 1 && law > 0.5 * last))) break;
      last = law;
      state.linear_solves += refinement.solve(exchange(F, rest, jump, s), prescribed, s);
    }
  }

 private:
  // The next set of motions, and F with the forces of the rows that move.
  // The small problem is about whole jumps: S (j - j_0) = r + p with r the residual on the contact rows, so that j_0 is
  // added on the right.
  Eigen::VectorXd exchange(const Eigen::VectorXd& F, const Eigen::VectorXd& rest, const Eigen::VectorXd& jump,
                           PenaltyIterate& s) const {
    const Eigen::VectorXd y = condensed.m.inner->factor->forward(rest);
    const Contact contact = dual_qp(condensed.S, condensed.load(y) + condensed.S * jump, condensed.points, s.motion);
    ++state.linear_solves;
    state.contact_iterations += contact.iterations;
    state.converged = contact.converged;
    s.motion = contact.motion;
    s.x += condensed.complete(y, contact.jump - jump);
    Eigen::VectorXd driven = F;
    for (Index i = 0, row = condensed.m.inner->ordering.leading(); i < static_cast<Index>(jump.size()); ++i, ++row)
      if (s.motion[i] == Motion::Held)
        s.x[row] = s.low[row] = 0;
      else
        driven[row] += contact.force[i];
    return driven;
  }
};

// Before the user is told.
bool loses_digits(const State& state) {
  return !(defect(state.certificate) <= 0.5 * few_digits);
}

// Slender bodies: the same rounds with products that do not lose what the rounding of K loses. Keeps the better state.
// What drives a body by prescribed motions is known only when it is solved, so that there may be another time.
// The loads are those summed triangle by triangle, which the exact products are compared with. A state that is not
// better is put back.
void refine(const Condensation& condensed, Drive drive, UniformPressure& uniform, PenaltyIterate& solution,
            State& state) {
  const Model& m = condensed.m;
  const Refinement refinement(condensed);
  const bool penalized = m.inner->system.penalty > 0;
  Loads loads = loads_of(m);
  loads.F = on_rows(m, drive.loads);
  constexpr int most = 3;
  for (int time = 0; time < most && loses_digits(state); ++time) {
    PenaltyIterate start = solution;
    if (start.low.size() == 0) start.low.setZero(start.x.size());
    const auto by_triangles = [&](const Eigen::VectorXd& F, PenaltyIterate& s) {
      const Eigen::VectorXd rest = -refinement.rest(F, loads.prescribed, s);
      certify_iterate(condensed, {rest, drive.largest}, s);
    };
    const PenaltySteps steps{Settling{condensed, refinement, drive.largest, state}, by_triangles, penalized ? 40 : 3,
                             penalized ? 1e-16 : 1e-12};
    PenaltyIterate refined = iterate(condensed, loads, std::move(start), uniform, steps);
    const double before = defect(state.certificate);
    drive = judge(condensed, refined, state);
    const double after = defect(state.certificate);
    if (!(after < before)) {
      judge(condensed, solution, state);
      return;
    }
    solution = std::move(refined);
    if (after > 0.1 * before) return;
  }
}

}  // namespace

// Each unknown counts where it is answered for. Work of prescribed values: reactions, K x - F on the fixed unknowns,
// times these.
Driven driven_by(const Model& m, const Balance& balance, const DoubleDouble& values, double stiffest,
                 const Sums& sums) {
  const std::vector<double>& prescribed = m.inner->skeleton.prescribed;
  Eigen::VectorXd loads = balance.loads;
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    if (!owns(m, u)) loads[u] = 0;
  Driven d{.largest = std::max(loads.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min()),
           .work = loads.dot(values.high)};
  for (Index u = 0; u < m.inner->skeleton.total; ++u) {
    if (prescribed[u] == 0 || !owns(m, u)) continue;
    const double unmet = balance.forces[u] - balance.loads[u];
    d.largest = std::max(d.largest, std::abs(unmet));
    d.prescribed = std::max(d.prescribed, std::abs(prescribed[u]));
    d.work += prescribed[u] * unmet;
  }
  std::array<double, 2> most{d.largest, d.prescribed};
  sums.most(most);
  d.prescribed = most[1];
  d.rounding = std::numeric_limits<double>::epsilon() * stiffest * d.prescribed;
  d.largest = std::max(most[0], d.rounding);
  return d;
}

// An eigenstrain stores energy without any displacement, too. Sizes of rounding and of remembered slips stand in where
// a body that is unloaded or moves as a whole has no energy to compare with.
JudgedWork judge_work(const Model& m, const Balance& balance, const Driven& driven, double previous, const Field& state,
                      const Sums& sums) {
  const double stored = m.inner->data.strain.empty() ? 0 : strain_energy(m, state);
  std::array<double, 4> all{balance.energy, driven.work, balance.noise, stored};
  sums.add(all);
  const double moved = driven.rounding * std::numeric_limits<double>::epsilon() * driven.prescribed,
               size = std::abs(all[0]) + all[2] + all[3] + moved + previous;
  return {size > 0 ? std::abs(all[0] - all[1]) / size : 0, size};
}

// Stresses stay as they are; displacement and rotation lose the mean motion.
void remove_motions(const Model& m, Field& s) {
  remove_motions(m, floating_shares(m, s), s);
}

void remove_motions(const Model& m, const Eigen::VectorXd& share, Field& s) {
  for (Index i = 0; i < static_cast<Index>(m.inner->floating.size()); ++i) {
    RigidMotion motion = m.inner->floating[i];
    motion.translation *= -share[i];
    motion.rotation *= -share[i];
    s.skeleton.head(m.inner->skeleton.base) += trace(m.mesh, m.inner->kernel, m.inner->skeleton, motion);
    for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) add_motion(m, t, motion, s.interior.col(t));
  }
}

Eigen::VectorXd floating_shares(const Model& m, const Field& s) {
  return shares(m.mesh, m.inner->kernel, m.inner->skeleton, m.inner->floating, floating_moments(m, s));
}

// int u . r_i with r_i as the element's displacement sees it (seen_points): the mean rotation of a piecewise constant
// displacement is that of its centroids.
Eigen::VectorXd floating_moments(const Model& m, const Field& s) {
  const Index n = static_cast<Index>(m.inner->floating.size());
  const Kernel& k = m.inner->kernel;
  Eigen::VectorXd moment = Eigen::VectorXd::Zero(n);
  for (Index t = 0; t < own_triangles(m); ++t) {
    const Triangle shape = triangle(m, t);
    const TriangleRule& rule = stress_rule(k, shape);
    const Points u = evaluate(m, s, t, rule_points(rule, shape)).displacement, seen = seen_points(k, shape, rule);
    const Eigen::VectorXd weight = rule_weights(rule, shape);
    for (Eigen::Index q = 0; q < u.cols(); ++q) {
      const double w = area(shape) * weight[q];
      const Vec2 at = seen.col(q);
      for (Index i = 0; i < n; ++i) moment[i] += w * u.col(q).dot(m.inner->floating[i].at(at));
    }
  }
  return moment;
}

// A slip bound is a stress: the force is that times the share of the curve's length, |dx/ds| w_g.
std::vector<ContactPoint> contact_points(const Model& m) {
  const Index leading = m.inner->ordering.leading();
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
          p.slip_bound =
              law.slip_bound *
              on_edge(m.mesh, m.inner->skeleton.curvatures, c.edge, m.inner->kernel.trace.s[g]).slope.norm() *
              m.inner->kernel.trace.w[g];
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
  check_volume(change, largest_strain, displacement, area(m));
}

void check_volume(double change, double largest_strain, double displacement, double whole) {
  constexpr double rounding = 1e-7;
  if (std::abs(change) > 2 * rounding * std::max(displacement * std::sqrt(whole), largest_strain * whole))
    throw Error(Fault::Numerics,
                fmt::format("the body is incompressible (poisson = 0.5) and wholly enclosed by its supports, but the "
                            "prescribed displacements change its area by {:.3g}; free a part of the boundary, or "
                            "prescribe displacements that keep the area",
                            change));
}

// With a penalty up to 40 rounds: eight reach rounding where uniform pressures are taken out, more while contacts
// change. Without it rounds remove rounding alone, or what the shift of a singular K costs.
State solve(const Model& m, ContactMethod method) {
  State state;
  Stopwatch watch;
  const Condensation condensed(m);
  state.seconds.contact = watch.lap();
  UniformPressure uniform;
  uniform.must_fit = true;
  const auto solve = [&](const Eigen::VectorXd& F, PenaltyIterate& s) {
    solve_contact(condensed, method, F, s, state);
  };
  const auto assembled = [&](const Eigen::VectorXd& F, PenaltyIterate& s) {
    const Eigen::VectorXd rest = multiply(*m.inner->system.K, s.x) - F;
    certify_iterate(condensed, {rest, size_of_loads(m)}, s);
  };
  const bool penalized = m.inner->system.penalty > 0;
  const auto rounding = [&](const PenaltyIterate& s) { return rounding_of(m, s.x, size_of_loads(m)); };
  const PenaltySteps steps{solve, assembled, penalized ? 40 : 15, penalized ? 1e-16 : 1e-12, rounding};
  const double before = state.seconds.contact;
  PenaltyIterate solution = iterate(condensed, loads_of(m), {}, uniform, steps);
  Drive drive = judge(condensed, solution, state);
  // Traces that no triangle sees answer nothing: K is singular there.
  if (loses_digits(state) && m.inner->ordering.size > 0 && m.inner->skeleton.unseen.empty())
    refine(condensed, std::move(drive), uniform, solution, state);
  if (uniform.level_open())
    has_free_pressure(m.mesh, m.scene, m.inner->skeleton);  // an opening crack would have fixed it
  state.linear_solves += uniform.solves();
  state.eigenstrain = m.inner->data.strain.empty() ? 0 : 1;
  if (!m.inner->floating.empty()) remove_motions(m, state);
  state.seconds.solve = watch.lap() - (state.seconds.contact - before);
  return state;
}

}  // namespace kerf
