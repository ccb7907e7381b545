// The adjoint of the discrete state, and linear problems on the tangent cone of its contact, by the factor of the
// state. With J_z the derivative of a functional by the unknowns z of all triangles and edges, H their saddle matrix,
//   H y = -J_z,   condensed   K mu = sum_T F_T + J_m   [theory: A.2, A.6],
//   closed rows mu_j = -J_p,  moving rows (K mu)_j = J_j,  normal rows under slips mu_n = -J_pn - c (mu_t + J_pt)
// [theory: A.9, A.10, A.15]. Where supports leave motions R free, dJ first loses its part on them [theory: A.7]. A
// penalty is paid back by the rounds of solver/system/penalty.cpp; where bodies bend by far more than they are
// strained, products triangle by triangle refine the solution [theory: E.17, E.19]. `ConeSolver::read` takes single
// numbers of many solutions from half solves alone, q'K^-1 f = (L^-1 q).(L^-1 f) less what keeps held rows [theory:
// T.38]. Derived in docs/theory/adjoint.md.

#include "kerf/adjoint.hpp"

#include "base/dense.hpp"
#include "base/parallel.hpp"
#include "kerf/recover.hpp"
#include "solver/state/dual.hpp"
#include "solver/state/solve.hpp"
#include "solver/system/partial_forward.hpp"
#include "solver/system/refine.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kerf {

namespace {

// Members without a size are zero (Sensitivity).
template <typename Array>
void add(Array& a, const Array& b) {
  if (b.size() == 0) return;
  if (a.size() == 0)
    a = b;
  else
    a += b;
}

}  // namespace

// J(R) of (A.7). The interior of a rigid trace is the motion as the element sees it, without stress.
Eigen::VectorXd work_on_motions(const Model& m, const Sensitivity& dJ) {
  const Eigen::Index n = static_cast<Eigen::Index>(m.inner->floating.size());
  Eigen::VectorXd work = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(m.inner->skeleton.total);
    motion.head(m.inner->skeleton.base) = trace(m.mesh, m.inner->kernel, m.inner->skeleton, m.inner->floating[i]);
    for (Index u = 0; u < static_cast<Index>(dJ.skeleton.size()); ++u)
      if (owns(m, u)) work[i] += dJ.skeleton[u] * motion[u];
    if (dJ.interior.size() > 0)
      for (Index t = 0; t < own_triangles(m); ++t)
        work[i] += dJ.interior.col(t).dot(interior(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), {},
                                                   trace_seen(m.mesh, m.inner->skeleton, motion, t)));
  }
  return work;
}

namespace {

// The derivative of int u . motion by the interior coefficients of t.
Eigen::VectorXd weigh_motion(const Model& m, Index t, const RigidMotion& motion) {
  const Kernel& k = m.inner->kernel;
  const Triangle shape = triangle(m, t);
  const TriangleRule& rule = stress_rule(k, shape);
  const Points x = rule_points(rule, shape), seen = seen_points(k, shape, rule);
  const Eigen::VectorXd weight = rule_weights(rule, shape);
  Fields f{Eigen::Matrix4Xd::Zero(4, x.cols()), Points(2, x.cols()), Eigen::RowVectorXd::Zero(x.cols())};
  for (Eigen::Index q = 0; q < x.cols(); ++q) f.displacement.col(q) = area(shape) * weight[q] * motion.at(seen.col(q));
  return weigh(k, shape, x, f);
}

}  // namespace

// (R, .) of (A.7) as derivatives by the interior coefficients; shares are G^-1 J(R).
Sensitivity without_moments(const Model& m, Sensitivity dJ, const Eigen::VectorXd& share) {
  const std::vector<RigidMotion>& motions = m.inner->floating;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  if (dJ.interior.size() == 0) dJ.interior.setZero(interior_count(m.element), triangles);
  for (Index t = 0; t < triangles; ++t)
    for (std::size_t i = 0; i < motions.size(); ++i)
      dJ.interior.col(t) -= share[static_cast<Eigen::Index>(i)] * weigh_motion(m, t, motions[i]);
  return dJ;
}

namespace {

// With free rigid motions the state is the one of no mean motion, u - sum_i motion_i (gram^-1 moments)_i: the
// derivative loses what it says about the motions, and with it the work that no support could take.
Sensitivity balanced(const Model& m, Sensitivity dJ) {
  const std::vector<RigidMotion>& motions = m.inner->floating;
  if (motions.empty()) return dJ;
  const Eigen::VectorXd share = shares(m.mesh, m.inner->kernel, m.inner->skeleton, motions, work_on_motions(m, dJ));
  return without_moments(m, std::move(dJ), share);
}

// Triangles beside an edge whose displacement is prescribed and not 0.
std::vector<Index> beside_prescribed(const Model& m, const Eigen::VectorXd& prescribed) {
  std::vector<Index> beside;
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e)
    for (int k = 0; k < m.inner->skeleton.per_edge; ++k)
      if (prescribed[edge_unknown(m.inner->skeleton, e) + k] != 0)
        for (const Index t : m.mesh.sides[e])
          if (t != none) beside.push_back(t);
  std::sort(beside.begin(), beside.end());
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  return beside;
}

// A linear problem on the tangent cone: K x = F on the rows that move, x = jump on those that are held.
// `loads.F` is less what prescribed values do, because the assembled K has no rows for them; `alone` is for products
// that see all unknowns.
struct Tangent {
  const Condensation& condensed;
  const TangentCone& cone;
  Loads loads;  // as for a state
  Eigen::VectorXd jump;
  Eigen::VectorXd alone;  // loads.F without what the prescribed values do
};

// Made when a slender body first needs it.
using Refining = std::unique_ptr<const Refinement>;

// The largest load, that of the given jumps included.
// Jumps that are given load the other rows by K g: without loads they alone set the scale.
double size_of_right_side(const Tangent& of) {
  const Model& m = of.condensed.m;
  const Index rows = m.inner->ordering.size;
  const double scale = std::max(rows > 0 ? of.loads.F.cwiseAbs().maxCoeff() : 0, std::numeric_limits<double>::min());
  if (of.jump.isZero(0)) return scale;
  Eigen::VectorXd given = Eigen::VectorXd::Zero(rows);
  given.tail(of.jump.size()) = of.jump;
  return std::max(scale, multiply(*m.inner->system.K, given).cwiseAbs().maxCoeff());
}

// The solution again with products that do not lose what the rounding of K loses.
// Prescribed values enter the exact products as part of x, so that the loads are those without their share (`alone`).
// Two rounds remove what one leaves; with a penalty there are as many as for a state.
PenaltyIterate refine_tangent(const Tangent& of, UniformPressure& uniform, PenaltyIterate start, Refining& refining,
                              TangentField& result) {
  const Model& m = of.condensed.m;
  const Index leading = m.inner->ordering.leading();
  if (!refining) refining = std::make_unique<const Refinement>(of.condensed);
  Loads loads = of.loads;
  loads.F = of.alone;
  const double scale = size_of_right_side(of);
  const auto solve = [&](const Eigen::VectorXd& F, PenaltyIterate& s) {
    result.linear_solves += refining->solve(F, loads.prescribed, s);
  };
  const auto judge = [&](const Eigen::VectorXd& F, PenaltyIterate& s) {
    Eigen::VectorXd rest = refining->rest(F, loads.prescribed, s);
    s.force = Eigen::VectorXd::Zero(rest.size());
    for (Index i = leading; i < static_cast<Index>(rest.size()); ++i)
      if (of.cone.held[i - leading]) s.force[i] = -std::exchange(rest[i], 0);
    s.certificate.residual = rest.cwiseAbs().maxCoeff() / scale;
    s.certificate.kkt = std::max(s.certificate.residual, s.penalty_error);
  };
  start.low.setZero(start.x.size());
  const int most = m.inner->system.penalty > 0 ? 40 : 2;
  return iterate(of.condensed, loads, std::move(start), uniform, {solve, judge, most, TangentSolver::to_rounding});
}

// x'K x of the whole field, the prescribed values included, by the triangles beside those.
// With x on rows and x' prescribed, (x + x')'K (x + x') = x . (K x + 2 K x') + x'.K x', the last term by the triangles
// that see x'.
double energy_of(const Tangent& of, const PenaltyIterate& s) {
  const Model& m = of.condensed.m;
  const Eigen::VectorXd moved = of.alone - of.loads.F;  // K x' of the prescribed x'
  const Eigen::VectorXd forces =                        // without a penalty K x = F on the rows that move
      m.inner->system.penalty > 0 ? multiply(*m.inner->system.K, s.x) : Eigen::VectorXd(of.loads.F + s.force);
  double energy = s.x.dot(forces + 2 * moved);
  const std::vector<double>& prescribed = of.loads.prescribed;
  for (const Index t : beside_prescribed(
           m, Eigen::Map<const Eigen::VectorXd>(prescribed.data(), static_cast<Eigen::Index>(prescribed.size())))) {
    const SkeletonMatrix K =
        condense(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), {}, {penalty_at(m, t), 0}).K;
    const Seen view = seen(m.mesh, m.inner->skeleton, t);
    SkeletonVector value(view.count);
    for (int i = 0; i < view.count; ++i) value[i] = prescribed[view.base[i]];
    energy += value.dot(K * value);
  }
  return energy;
}

// Stops at the relative residual `enough`, or where the iteration gains no more. Fills in all but forces and interior.
// Rounds: x moves by the solution for what is left of F - K x, held rows keep their jumps. Under sliding points the
// dual jump of the normal row follows the slip after each round [theory: A.15]; forward the force of the tangential row
// is its share of the normal one [theory: A.14], and no part of the residual. Elements with unseen traces are not
// refined: K is singular there.
PenaltyIterate solve_tangent(const Tangent& of, UniformPressure& uniform, double enough, Refining& refining,
                             TangentField& result) {
  const Model& m = of.condensed.m;
  const Index rows = m.inner->ordering.size, contact_rows = m.inner->ordering.contact_rows,
              leading = rows - contact_rows;
  const double scale = size_of_right_side(of);
  const auto solve = [&](const Eigen::VectorXd& F, PenaltyIterate& s) {
    const bool first = s.x.size() == 0;
    if (first) s.x.setZero(rows);
    Eigen::VectorXd rest = F;
    if (!first) rest -= multiply(*m.inner->system.K, s.x);
    const Eigen::VectorXd to_go = first ? of.jump : Eigen::VectorXd::Zero(contact_rows).eval();
    s.x += of.condensed.solve_frozen(rest, s.motion, &to_go);
    for (Index i = 0; i < contact_rows; ++i)
      if (of.cone.held[i]) s.x[leading + i] = of.jump[i];
    if (of.condensed.sliding && of.condensed.sliding->transposed)
      for (const SlidingPoint& p : of.cone.sliding) s.x[leading + p.normal] -= p.share * s.x[leading + p.tangential];
    ++result.linear_solves;
  };
  const auto judge = [&](const Eigen::VectorXd& F, PenaltyIterate& s) {
    Eigen::VectorXd rest = F - multiply(*m.inner->system.K, s.x);
    s.force = Eigen::VectorXd::Zero(rows);
    for (Index i = leading; i < rows; ++i)
      if (of.cone.held[i - leading]) s.force[i] = -std::exchange(rest[i], 0);
    if (of.condensed.sliding && !of.condensed.sliding->transposed)
      for (const SlidingPoint& p : of.cone.sliding) {
        const double force = p.share * s.force[leading + p.normal];
        s.force[leading + p.tangential] = force;
        rest[leading + p.tangential] += force;
      }
    s.certificate.residual = rest.cwiseAbs().maxCoeff() / scale;
    s.certificate.kkt = std::max(s.certificate.residual, s.penalty_error);
  };
  PenaltyIterate start;
  for (const bool held : of.cone.held) start.motion.push_back(held ? Motion::Held : Motion::Forward);
  const int most = m.inner->system.penalty > 0 ? 40 : 4;
  PenaltyIterate best = start;
  if (rows > 0)
    best = iterate(of.condensed, of.loads, start, uniform,
                   {solve, judge, most, enough, [&](const PenaltyIterate& s) { return rounding_of(m, s.x, scale); }});
  else if (m.inner->system.penalty > 0)
    best.theta.setZero(static_cast<Eigen::Index>(m.mesh.triangles.size()));
  // Conjugate gradients are for the symmetric problem.
  if (rows > 0 && !of.condensed.sliding && m.inner->skeleton.unseen.empty() &&
      growth(m, best.x, energy_of(of, best)) > most_growth)
    best = refine_tangent(of, uniform, std::move(best), refining, result);
  result.residual = best.certificate.kkt;
  result.skeleton = on_skeleton(m, best.x, &of.loads.prescribed);
  return best;
}

}  // namespace

// F_T of (A.6): -J_sigma, -J_u, -J_omega condensed onto the traces, in the order of the triangles, so that the sums do
// not depend on threads.
DualLoads dual_loads(const Model& m, const Sensitivity& dJ) {
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const bool penalized = m.inner->system.penalty > 0;
  DualLoads loads;
  loads.own.setZero(penalized ? triangles : 0);
  loads.forces = dJ.skeleton.size() > 0 ? dJ.skeleton : Eigen::VectorXd::Zero(m.inner->skeleton.total).eval();
  if (dJ.interior.size() == 0) return loads;
  Eigen::MatrixXd local(skeleton_count(m.element), triangles);
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const DualLoad load = condense_dual(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t),
                                          dJ.interior.col(t), {penalty_at(m, t), 0});
      local.col(t) = load.F;
      if (penalized) loads.own[t] = load.own;
    }
  });
  for (Index t = 0; t < triangles; ++t) {
    const Seen view = seen(m.mesh, m.inner->skeleton, t);
    for (int i = 0; i < view.count; ++i) {
      loads.forces[view.base[i]] += local(i, t);
      if (view.jump[i] != none) loads.forces[view.jump[i]] += local(i, t);
    }
  }
  return loads;
}

// A derivative by the force of a held row prescribes minus its value as the dual jump.
// The force of a row that slides is its share of one that is held.
Eigen::VectorXd dual_jumps(Eigen::VectorXd by, const std::vector<bool>& held,
                           const std::vector<SlidingPoint>& sliding) {
  for (const SlidingPoint& p : sliding) by[p.normal] += p.share * by[p.tangential];
  for (Eigen::Index i = 0; i < by.size(); ++i) by[i] = held[static_cast<std::size_t>(i)] ? -by[i] : 0;
  return by;
}

// The interiors follow from the traces less their rigid motion, under the triangle's own -J; the motion is added to p
// and rho alone, since it has no stress zeta.
void fill_dual(const Model& m, const Sensitivity& dJ, const DoubleDouble& traces, const Eigen::VectorXd& theta,
               Field& dual) {
  const bool loaded = dJ.interior.size() > 0;
  const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(interior_count(m.element));
  const auto find = [&](Index t, const Triangle& shape, const SkeletonVector& rest, const Penalty& p) {
    return interior_dual(m.inner->kernel, shape, material_of(m.mesh, m.scene, t),
                         loaded ? Eigen::VectorXd(dJ.interior.col(t)) : nothing, rest, p);
  };
  fill_interior(m, traces, theta, find, dual);
}

namespace {

Eigen::VectorXd dual_jumps(const Model& m, const Sensitivity& dJ, const TangentCone& cone) {
  const Index leading = m.inner->ordering.leading();
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(m.inner->ordering.contact_rows);
  if (dJ.force.size() == 0) return jump;
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    if (const Index row = m.inner->ordering.row[u]; row != none && row >= leading) jump[row - leading] = dJ.force[u];
  return dual_jumps(std::move(jump), cone.held, cone.sliding);
}

// The matrix of a cone with slides is not symmetric, and made of the dense S.
void slide(Condensation& condensed, const TangentCone& cone, bool transposed) {
  if (cone.sliding.empty()) return;
  if (has_large_contact(condensed.m))
    throw Error(Fault::Numerics, fmt::format("maps with Coulomb friction need the dense matrix of contact, which {} "
                                             "unknowns are too many for; use a coarser mesh along the cracks",
                                             condensed.m.inner->ordering.contact_rows));
  condensed.sliding = Sliding{cone.sliding, transposed};
}

void require_rows(const Model& m, const TangentCone& cone, const char* who) {
  if (static_cast<Index>(cone.held.size()) != m.inner->ordering.contact_rows)
    throw std::invalid_argument(std::string(who) + ": one entry per row in contact is needed");
}

// Adjoints have strains theta of their own: the rounds find them with the dual means.
Penalty penalty_of(const Model& m, const PenaltyIterate& s, Index t) {
  return {penalty_at(m, t), m.inner->system.penalty > 0 ? s.theta[t] : 0};
}

// `load` less what the prescribed values do.
// Only triangles beside the support see prescribed values: K x' costs their condensation.
Eigen::VectorXd less_prescribed(const Model& m, Eigen::VectorXd load, const std::vector<double>& values) {
  Eigen::VectorXd prescribed = Eigen::VectorXd::Zero(m.inner->skeleton.total);
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    if (m.inner->skeleton.fixed[u]) prescribed[u] = values[u];
  for (const Index t : beside_prescribed(m, prescribed)) {
    const Condensed c =
        condense(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), {}, {penalty_at(m, t), 0});
    const Seen view = seen(m.mesh, m.inner->skeleton, t);
    SkeletonVector value(view.count);
    for (int i = 0; i < view.count; ++i) value[i] = prescribed[view.base[i]];
    const SkeletonVector force = c.K * value;
    for (int i = 0; i < view.count; ++i) {
      load[view.base[i]] -= force[i];
      if (view.jump[i] != none) load[view.jump[i]] -= force[i];
    }
  }
  return load;
}

}  // namespace

Sensitivity& operator+=(Sensitivity& a, const Sensitivity& b) {
  add(a.interior, b.interior);
  add(a.skeleton, b.skeleton);
  add(a.force, b.force);
  return a;
}

bool empty(const Sensitivity& s) {
  return s.interior.size() == 0 && s.skeleton.size() == 0 && s.force.size() == 0;
}

// A tangential row sticks where its jump is exactly the prescribed one: held rows are set, not computed. At open points
// only a slip bound can hold it.
std::vector<ContactStatus> contact_status(const Model& m, const Field& state) {
  std::vector<ContactStatus> status(static_cast<std::size_t>(m.inner->ordering.contact_rows), ContactStatus::Open);
  const Index leading = m.inner->ordering.leading();
  for (std::size_t crack = 0; crack < m.mesh.cracks.size(); ++crack) {
    if (!is_unilateral(m.scene.laws[crack])) continue;
    const std::vector<CrackPoint> profile = crack_profile(m, state, static_cast<Index>(crack));
    std::size_t point = 0;
    for (const CrackEdge& c : m.mesh.cracks[crack]) {
      const int points = m.inner->skeleton.per_edge / 2;
      for (int k = 0; k < points; ++k, ++point) {
        const Index unknown = m.inner->skeleton.jump[c.edge] + 2 * (c.forward ? k : points - 1 - k);
        if (!m.inner->skeleton.bounded[unknown]) continue;
        const bool touches = profile[point].status == CrackPoint::Status::Closed;
        if (m.inner->skeleton.frictional[unknown + 1] &&
            state.skeleton[unknown + 1] == m.inner->skeleton.prescribed[unknown + 1] &&
            (touches || m.scene.laws[crack].slip_bound > 0))
          status[static_cast<std::size_t>(m.inner->ordering.row[unknown + 1] - leading)] = ContactStatus::Closed;
        ContactStatus& s = status[static_cast<std::size_t>(m.inner->ordering.row[unknown] - leading)];
        s = profile[point].status == CrackPoint::Status::Closed ? ContactStatus::Closed
            : profile[point].status == CrackPoint::Status::Open ? ContactStatus::Open
                                                                : ContactStatus::Biactive;
      }
    }
  }
  return status;
}

// Biactive rows move: their one-sided answer is built on that (A.12, A.13).
std::vector<bool> tied(const std::vector<ContactStatus>& status) {
  std::vector<bool> held(status.size());
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = status[i] == ContactStatus::Closed;
  return held;
}

// c = -sign(j_t) f of (A.14): zero, and no point of this list, where the faces are open or f = 0.
std::vector<SlidingPoint> sliding_points(const std::vector<ContactPoint>& points, const std::vector<bool>& held,
                                         const Eigen::VectorXd& jump) {
  std::vector<SlidingPoint> found;
  for (const ContactPoint& p : points)
    if (p.friction > 0 && held[p.normal] && !held[p.tangential])
      found.push_back({p.normal, p.tangential, jump[p.tangential] > 0 ? -p.friction : p.friction});
  return found;
}

// Slips are counted from where the step of loading began (prescribed), as friction counts them.
TangentCone tangent_cone(const Model& m, const Field& state) {
  const std::vector<ContactStatus> status = contact_status(m, state);
  TangentCone cone(tied(status));
  const Index leading = m.inner->ordering.leading();
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(status.size()));
  for (Index u = m.inner->skeleton.base; u < m.inner->skeleton.total; ++u)
    if (const Index row = m.inner->ordering.row[u]; row >= leading)
      jump[row - leading] = state.skeleton[u] - m.inner->skeleton.prescribed[u];
  cone.sliding = sliding_points(contact_points(m), cone.held, jump);
  return cone;
}

// Undecided are points that touch without pressure, that stick with |sigma_t| at the limit, and that move by a slip of
// no size: there the derivative is one-sided and no minimum problem gives it. Limits and slips are compared with the
// largest tractions of the crack.
Undecided undecided_friction(const Model& m, const Field& state, Index crack) {
  Undecided found;
  const CrackLaw& law = m.scene.laws[crack];
  if (!has_friction(law)) return found;
  const std::vector<CrackPoint> profile = crack_profile(m, state, crack);
  double most = 0, length = 0;
  for (const CrackPoint& p : profile) {
    most = std::max({most, std::abs(p.sigma_t), law.friction * p.contact_pressure(), law.slip_bound});
    length += p.length;
  }
  // Of tractions; and of a slip, of which a crack of this length has about most * length/mu.
  constexpr double rounding = 1e-8, no_slip = 1e-10;
  const double slip_size = most * length / m.scene.material.mu;
  std::size_t point = 0;
  const int points = m.inner->skeleton.per_edge / 2;
  for (const CrackEdge& c : m.mesh.cracks[crack])
    for (int k = 0; k < points; ++k, ++point) {
      if (m.mesh.sides[c.edge][1] >= own_triangles(m)) continue;  // of another process
      const CrackPoint& p = profile[point];
      found.whole += p.length;
      const Index slip = m.inner->skeleton.jump[c.edge] + 2 * (c.forward ? k : points - 1 - k) + 1;
      const bool sticks = state.skeleton[slip] == m.inner->skeleton.prescribed[slip],
                 touches = p.status == CrackPoint::Status::Biactive;
      const double limit = law.slip_bound + law.friction * std::max(p.contact_pressure(), 0.0);
      const double slid = std::abs(state.skeleton[slip] - m.inner->skeleton.prescribed[slip]);
      const bool used_up =
          limit > 0 && (sticks ? limit - std::abs(p.sigma_t) <= rounding * most : slid <= no_slip * slip_size);
      if (!touches && !used_up) continue;
      if (found.length == 0) {
        found.at = p.at;
        found.touches = touches;
      }
      found.length += p.length;
    }
  return found;
}

Eigen::VectorXd weigh(const Model& model, Index t, const Points& x, const Fields& weights) {
  return weigh(model.inner->kernel, triangle(model, t), x, weights);
}

TangentField solve_adjoint(const Model& m, const Sensitivity& given, const TangentCone& cone) {
  require_rows(m, cone, "solve_adjoint");
  const Sensitivity dJ = balanced(m, given);
  Condensation condensed(m);
  slide(condensed, cone, true);
  UniformPressure uniform;
  TangentField adjoint;
  Refining refining;
  DualLoads dual = dual_loads(m, dJ);
  Loads loads{.F = on_rows(m, dual.forces),
              .own = std::move(dual.own),
              .prescribed = std::vector<double>(static_cast<std::size_t>(m.inner->skeleton.total), 0)};
  if (condensed.sliding)  // what held rows are loaded by is nothing, not the rounding of it
    for (Index i = 0, row = m.inner->ordering.leading(); i < m.inner->ordering.contact_rows; ++i, ++row)
      if (cone.held[i]) loads.F[row] = 0;
  const Eigen::VectorXd F = loads.F;
  const PenaltyIterate solution = solve_tangent({condensed, cone, std::move(loads), dual_jumps(m, dJ, cone), F},
                                                uniform, TangentSolver::to_rounding, refining, adjoint);
  const DoubleDouble values = on_skeleton(m, solution, std::vector<double>(m.inner->skeleton.total, 0));
  adjoint.force.setZero(m.inner->skeleton.total);
  fill_dual(m, dJ, values, solution.theta, adjoint);
  return adjoint;
}

// The interior of the motions is subtracted as the element sees them, so that stresses stay.
Field without_motions(const Model& m, Field dual) {
  if (m.inner->floating.empty()) return dual;
  const Eigen::VectorXd share = floating_shares(m, dual);
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(m.inner->skeleton.total);
  for (Index i = 0; i < static_cast<Index>(m.inner->floating.size()); ++i)
    motion.head(m.inner->skeleton.base) +=
        share[i] * trace(m.mesh, m.inner->kernel, m.inner->skeleton, m.inner->floating[i]);
  dual.skeleton -= motion;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t)
    dual.interior.col(t) -= interior(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), {},
                                     trace_seen(m.mesh, m.inner->skeleton, motion, t));
  return dual;
}

/// The small block of the cone, uniform pressures and exact products are made at the first solve that needs them, and
/// kept.
struct ConeSolver::Impl {
  Condensation condensed;
  TangentCone cone;
  UniformPressure uniform = {};
  Refining refining = {};

  /// A field of which all but the interior is known, and what that follows from.
  struct Traced {
    TangentField field;
    PenaltyIterate solution;
    DoubleDouble values;
  };

  // The condensed solution alone: the interiors, the larger part of the work, follow where they are asked for.
  Traced trace(const Eigen::VectorXd& load, const std::vector<double>& prescribed, double enough) {
    const Model& m = condensed.m;
    const Index triangles = static_cast<Index>(m.mesh.triangles.size());
    const Tangent tangent{condensed,
                          cone,
                          {.F = on_rows(m, less_prescribed(m, load, prescribed)),
                           .own = Eigen::VectorXd::Zero(m.inner->system.penalty > 0 ? triangles : 0),
                           .prescribed = prescribed},
                          Eigen::VectorXd::Zero(m.inner->ordering.contact_rows),
                          on_rows(m, load)};
    Traced t;
    t.solution = solve_tangent(tangent, uniform, enough, refining, t.field);
    t.values = on_skeleton(m, t.solution, prescribed);
    t.field.force = on_skeleton(m, t.solution.force, nullptr);
    t.field.interior.setZero(interior_count(m.element), triangles);
    return t;
  }

  void fill(Traced& of, Index t) const {
    const Model& m = condensed.m;
    const Strained s = strained(m, of.values, t);
    of.field.interior.col(t) = interior(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), {}, s.rest,
                                        penalty_of(m, of.solution, t));
    add_motion(m, t, s.motion, of.field.interior.col(t));
  }

  // Without a penalty the elimination of a triangle is the same for all fields.
  void fill(std::span<Traced> of, Index t) const {
    const Model& m = condensed.m;
    Eigen::MatrixXd rest(skeleton_count(m.element), static_cast<Eigen::Index>(of.size()));
    std::vector<RigidMotion> motion(of.size());
    for (std::size_t i = 0; i < of.size(); ++i) {
      const Strained s = strained(m, of[i].values, t);
      rest.col(static_cast<Eigen::Index>(i)) = s.rest;
      motion[i] = s.motion;
    }
    const Eigen::MatrixXd found = interiors(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), rest);
    for (std::size_t i = 0; i < of.size(); ++i) {
      of[i].field.interior.col(t) = found.col(static_cast<Eigen::Index>(i));
      add_motion(m, t, motion[i], of[i].field.interior.col(t));
    }
  }
};

ConeSolver::ConeSolver(const Model& m, TangentCone cone) {
  require_rows(m, cone, "TangentSolver");
  impl_ = std::make_unique<Impl>(Impl{Condensation(m), std::move(cone)});
  slide(impl_->condensed, impl_->cone, false);
}
ConeSolver::~ConeSolver() = default;

TangentField ConeSolver::solve(const Eigen::VectorXd& load, const std::vector<double>& prescribed, double enough,
                               std::span<const Index> only) {
  const Model& m = impl_->condensed.m;
  Impl::Traced traced = impl_->trace(load, prescribed, enough);
  for (const Index t : only) impl_->fill(traced, t);
  if (only.empty())
    parallel_for(static_cast<Index>(m.mesh.triangles.size()), m.threads, [&](Index begin, Index end) {
      for (Index t = begin; t < end; ++t) impl_->fill(traced, t);
    });
  return std::move(traced.field);
}

namespace {

using Columns = std::vector<PartialForward::Column>;

// What a substitution takes of a cone's problem: the loads less what the prescribed values do, a column per problem.
class Halves {
 public:
  Halves(const Model& m, const FewLoads& loads)
      : m_(m), loads_(loads), place_(static_cast<std::size_t>(m.inner->skeleton.total), none) {
    for (std::size_t i = 0; i < loads.unknowns.size(); ++i) place_[loads.unknowns[i]] = static_cast<Index>(i);
  }

  // Each load less K x' of the problem's own prescribed values; triangles are condensed once for all columns.
  Columns of_loads() const {
    Columns columns(static_cast<std::size_t>(loads_.load.cols()));
    for (std::size_t i = 0; i < loads_.unknowns.size(); ++i)
      add(loads_.unknowns[i], loads_.load.row(static_cast<Eigen::Index>(i)), columns);
    const Eigen::VectorXd largest = loads_.prescribed.cwiseAbs().rowwise().maxCoeff();
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(m_.inner->skeleton.total);
    for (std::size_t i = 0; i < loads_.unknowns.size(); ++i)
      moved[loads_.unknowns[i]] = largest[static_cast<Eigen::Index>(i)];
    for (const Index t : beside_prescribed(m_, moved)) {
      const SkeletonMatrix K = condense(m_.inner->kernel, triangle(m_, t), material_of(m_.mesh, m_.scene, t), {}).K;
      const Seen view = seen(m_.mesh, m_.inner->skeleton, t);
      const Eigen::MatrixXd force = -multiply(K, prescribed(view));
      for (int i = 0; i < view.count; ++i)
        for (const Index u : {view.base[i], view.jump[i]})
          if (u != none) add(u, force.row(i), columns);
    }
    return columns;
  }

  /// The reading by the skeleton, and what it finds in the prescribed values.
  /// The dual load of a triangle is the derivative of the reading by its traces, the interior eliminated (A.6).
  std::pair<PartialForward::Column, double> of_reading(const Reading& r) const {
    const SkeletonVector by =
        condense_dual(m_.inner->kernel, triangle(m_, r.t), material_of(m_.mesh, m_.scene, r.t), r.weights).F;
    const Seen view = seen(m_.mesh, m_.inner->skeleton, r.t);
    Columns column(1);
    for (int i = 0; i < view.count; ++i)
      for (const Index u : {view.base[i], view.jump[i]})
        if (u != none) add(u, Eigen::RowVectorXd::Constant(1, by[i]), column);
    return {column[0], by.dot(prescribed(view).col(r.of))};
  }

 private:
  void add(Index u, const Eigen::RowVectorXd& values, Columns& columns) const {
    const Index row = m_.inner->ordering.row[u];
    if (row == none) return;
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (const double value = values[static_cast<Eigen::Index>(k)]; value != 0) columns[k].emplace_back(row, value);
  }
  Eigen::MatrixXd prescribed(const Seen& view) const {
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(view.count, loads_.load.cols());
    for (int i = 0; i < view.count; ++i)
      if (const Index at = place_[view.base[i]]; at != none) values.row(i) = loads_.prescribed.row(at);
    return values;
  }

  const Model& m_;
  const FewLoads& loads_;
  std::vector<Index> place_;  // of each unknown of the skeleton among those of the loads
};

}  // namespace

// products = (L^-1 C)'(L^-1 C) with columns C = (loads, readings, unit vectors e_h of held rows): with A = C'K^-1 C the
// answer is A_qf - A_qh A_hh^-1 A_hf. Slides of pieces are replaced in S, not in the factor, so that half solves would
// not see them: no answer then.
std::optional<Eigen::VectorXd> ConeSolver::read(const FewLoads& loads, std::span<const Reading> readings) const {
  const Model& m = impl_->condensed.m;
  const Ordering& o = m.inner->ordering;
  if (m.inner->system.penalty > 0 || impl_->condensed.sliding || !is_definite(m.element) || !m.inner->factor ||
      m.inner->factor->leading() || o.size == 0 || !m.inner->semicoercive.empty())  // then the factor has springs
    return std::nullopt;
  const Halves halves(m, loads);
  Columns columns = halves.of_loads();
  const Eigen::Index problems = loads.load.cols(), count = static_cast<Eigen::Index>(readings.size());
  Eigen::VectorXd found(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    auto [column, known] = halves.of_reading(readings[static_cast<std::size_t>(i)]);
    columns.push_back(std::move(column));
    found[i] = known;
  }
  for (Index i = 0; i < o.contact_rows; ++i)
    if (impl_->cone.held[i]) columns.push_back({{o.leading() + i, 1.0}});
  // All rows moving, less the forces that keep those that are held.
  Eigen::MatrixXd products = PartialForward(*m.inner->factor).add(columns);
  if (const Eigen::Index held = products.rows() - problems - count; held > 0) {
    const Eigen::MatrixXd forces =
        solve_spd(products.bottomRightCorner(held, held), products.bottomLeftCorner(held, problems));
    products.block(problems, 0, count, problems) -=
        multiply(products.block(problems, problems + count, count, held), forces);
  }
  for (Eigen::Index i = 0; i < count; ++i) found[i] += products(problems + i, readings[static_cast<std::size_t>(i)].of);
  return found;
}

std::vector<TangentField> ConeSolver::solve_all(std::size_t count,
                                                const std::function<Eigen::VectorXd(std::size_t)>& load) {
  const Model& m = impl_->condensed.m;
  const std::vector<double> at_rest(static_cast<std::size_t>(m.inner->skeleton.total), 0);
  std::vector<TangentField> fields;
  fields.reserve(count);
  constexpr std::size_t most = 32;  // what a core's cache holds of one triangle's columns
  while (fields.size() < count) {
    const std::size_t here = m.inner->system.penalty > 0 ? 1 : std::min(most, count - fields.size());
    std::vector<Impl::Traced> traced;
    for (std::size_t i = 0; i < here; ++i)
      traced.push_back(impl_->trace(load(fields.size() + i), at_rest, TangentSolver::to_rounding));
    parallel_for(static_cast<Index>(m.mesh.triangles.size()), m.threads, [&](Index begin, Index end) {
      for (Index t = begin; t < end; ++t) here == 1 ? impl_->fill(traced.front(), t) : impl_->fill(traced, t);
    });
    for (Impl::Traced& t : traced) fields.push_back(std::move(t.field));
  }
  return fields;
}

/// The public solver: a cone without sliding points.
struct TangentSolver::Impl {
  Impl(const Model& m, std::vector<bool> held) : solver(m, TangentCone(std::move(held))) {}
  ConeSolver solver;
};

TangentSolver::TangentSolver(const Model& m, std::vector<bool> held)
    : impl_(std::make_unique<Impl>(m, std::move(held))) {}
TangentSolver::~TangentSolver() = default;

TangentField TangentSolver::solve(const Eigen::VectorXd& load, const std::vector<double>& prescribed, double enough,
                                  std::span<const Index> only) {
  return impl_->solver.solve(load, prescribed, enough, only);
}

std::vector<TangentField> TangentSolver::solve_all(std::size_t count,
                                                   const std::function<Eigen::VectorXd(std::size_t)>& load) {
  return impl_->solver.solve_all(count, load);
}

TangentField solve_linear(const Model& m, const Eigen::VectorXd& load, const std::vector<double>& prescribed,
                          const std::vector<bool>& held) {
  return TangentSolver(m, held).solve(load, prescribed);
}

TangentField solve_adjoint(const Model& m, const Sensitivity& dJ, const std::vector<bool>& held) {
  return solve_adjoint(m, dJ, TangentCone(held));
}

// J_(j_t) = p_t of (A.17), frozen. Forces of closed normal rows are in it, too, but their jumps do not change.
Sensitivity work_of_slips(const Field& s) {
  return {.interior = {}, .skeleton = s.force, .force = {}};
}

}  // namespace kerf
