#include "kerf/adjoint.hpp"

#include "solver/system.hpp"

#include "kerf/recover.hpp"
#include "solver/parallel.hpp"
#include "solver/state/solve.hpp"
#include "solver/system/penalty.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kerf {

namespace {

template <typename Array>
void add(Array& a, const Array& b) {
  if (b.size() == 0) return;
  if (a.size() == 0)
    a = b;
  else
    a += b;
}

// With free rigid motions the state is the one of no mean motion, u - sum_i motion_i (gram^-1 moments)_i: the
// derivative loses what it says about the motions, and with it the work that no support could take.
Sensitivity balanced(const Model& m, Sensitivity dJ) {
  const Eigen::Index n = static_cast<Eigen::Index>(m.inner->floating.size());
  if (n == 0) return dJ;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  Eigen::VectorXd work = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(m.inner->skeleton.total);
    motion.head(m.inner->skeleton.base) = trace(m.mesh, m.inner->kernel, m.inner->skeleton, m.inner->floating[i]);
    if (dJ.skeleton.size() > 0) work[i] += dJ.skeleton.dot(motion);
    if (dJ.interior.size() > 0)
      for (Index t = 0; t < triangles; ++t)
        work[i] += dJ.interior.col(t).dot(interior(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), {},
                                                   trace_seen(m.mesh, m.inner->skeleton, motion, t)));
  }
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  std::vector<Fields> weights(static_cast<std::size_t>(triangles) * static_cast<std::size_t>(n));
  const bool means = m.element.displacement == 0;
  for (Index t = 0; t < triangles; ++t) {
    const Triangle shape = triangle(m, t);
    const Points x = rule_points(m.inner->kernel.rule, shape);
    for (Eigen::Index i = 0; i < n; ++i) {
      Fields& f = weights[static_cast<std::size_t>(t) * n + i];
      f = {Eigen::Matrix4Xd::Zero(4, x.cols()), Points(2, x.cols()), Eigen::RowVectorXd::Zero(x.cols())};
      for (Eigen::Index q = 0; q < x.cols(); ++q) {
        const double w = area(shape) * m.inner->kernel.rule.w[q];
        const Vec2 at = means ? centroid(shape) : Vec2(x.col(q));
        f.displacement.col(q) = w * m.inner->floating[i].at(at);
        for (Eigen::Index j = 0; j < n; ++j)
          gram(i, j) += w * m.inner->floating[i].at(at).dot(m.inner->floating[j].at(at));
      }
    }
  }
  const Eigen::VectorXd share = gram.llt().solve(work);
  if (dJ.interior.size() == 0) dJ.interior.setZero(interior_count(m.element), triangles);
  for (Index t = 0; t < triangles; ++t) {
    const Triangle shape = triangle(m, t);
    const Points x = rule_points(m.inner->kernel.rule, shape);
    for (Eigen::Index i = 0; i < n; ++i)
      dJ.interior.col(t) -= share[i] * weigh(m.inner->kernel, shape, x, weights[static_cast<std::size_t>(t) * n + i]);
  }
  return dJ;
}

// K mu = F on the rows that move, mu = jump on those that are held; `loads` as for a state. Stops at the relative
// residual `enough`, or where the iterations gain no more.
PenaltyIterate solve_tangent(const Condensation& condensed, UniformPressure& uniform, const Loads& loads,
                      const Eigen::VectorXd& jump, const std::vector<bool>& held, double enough, TangentField& result) {
  const Model& m = condensed.m;
  const Index rows = m.inner->ordering.size, contact_rows = m.inner->ordering.contact_rows,
              leading = rows - contact_rows;
  const bool penalized = m.inner->system.penalty > 0;
  PenaltyIterate next;
  next.x.setZero(rows);
  if (penalized) next.theta.setZero(static_cast<Eigen::Index>(m.mesh.triangles.size()));
  next.motion.resize(static_cast<std::size_t>(contact_rows));
  for (Index i = 0; i < contact_rows; ++i) next.motion[i] = held[i] ? Motion::Held : Motion::Forward;
  Eigen::VectorXd F = loads.F;
  PenaltyIterate best = next;
  double least = infinity;
  const int most_iterations = penalized ? 40 : 4;
  int without_gain = 0;
  double scale = std::max(rows > 0 ? F.cwiseAbs().maxCoeff() : 0, std::numeric_limits<double>::min());
  if (!jump.isZero(0)) {
    Eigen::VectorXd given = Eigen::VectorXd::Zero(rows);
    given.tail(contact_rows) = jump;
    scale = std::max(scale, multiply(m.inner->system.K, given).cwiseAbs().maxCoeff());
  }
  for (int iteration = 0; iteration < most_iterations && rows > 0; ++iteration) {
    Eigen::VectorXd rest = F;
    if (iteration > 0) rest -= multiply(m.inner->system.K, next.x);
    const Eigen::VectorXd to_go = iteration == 0 ? jump : Eigen::VectorXd::Zero(contact_rows).eval();
    next.x += condensed.solve_frozen(rest, next.motion, &to_go);
    for (Index i = 0; i < contact_rows; ++i)
      if (held[i]) next.x[leading + i] = jump[i];
    ++result.linear_solves;
    if (penalized) {
      uniform.correct(condensed, loads, next);
      update_theta(m, loads, next);
      F = right_hand_side(m, loads, next);
    }
    rest = F - multiply(m.inner->system.K, next.x);
    next.force = Eigen::VectorXd::Zero(contact_rows);
    for (Index i = 0; i < contact_rows; ++i)
      if (held[i]) next.force[i] = -std::exchange(rest[leading + i], 0);
    const double error = std::max(rest.cwiseAbs().maxCoeff() / scale, next.penalty_error);
    const bool slow = error > 0.5 * least;
    if (error < least) {
      least = error;
      best = next;
    }
    without_gain = slow ? without_gain + 1 : 0;
    if (least <= enough || without_gain == (penalized && least > 1e-9 ? 6 : 1)) break;
  }
  result.residual = rows > 0 ? least : 0;
  result.skeleton = on_skeleton(m, best.x, &loads.prescribed);
  result.force.setZero(m.inner->skeleton.total);
  return best;
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

std::vector<ContactStatus> contact_status(const Model& m, const Field& state) {
  std::vector<ContactStatus> status(static_cast<std::size_t>(m.inner->ordering.contact_rows), ContactStatus::Open);
  const Index leading = m.inner->ordering.size - m.inner->ordering.contact_rows;
  for (std::size_t crack = 0; crack < m.mesh.cracks.size(); ++crack) {
    if (m.scene.laws[crack].kind != CrackLaw::Kind::Unilateral) continue;
    const std::vector<CrackPoint> profile = crack_profile(m, state, static_cast<Index>(crack));
    std::size_t point = 0;
    for (const CrackEdge& c : m.mesh.cracks[crack]) {
      const int points = m.inner->skeleton.per_edge / 2;
      for (int k = 0; k < points; ++k, ++point) {
        const Index unknown = m.inner->skeleton.jump[c.edge] + 2 * (c.forward ? k : points - 1 - k);
        if (!m.inner->skeleton.bounded[unknown]) continue;
        ContactStatus& s = status[static_cast<std::size_t>(m.inner->ordering.row[unknown] - leading)];
        s = profile[point].status == CrackPoint::Status::Closed ? ContactStatus::Closed
            : profile[point].status == CrackPoint::Status::Open ? ContactStatus::Open
                                                                : ContactStatus::Biactive;
      }
    }
  }
  return status;
}

std::vector<bool> tied(const std::vector<ContactStatus>& status) {
  std::vector<bool> held(status.size());
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = status[i] == ContactStatus::Closed;
  return held;
}

Eigen::VectorXd weigh(const Model& model, Index t, const Points& x, const Fields& weights) {
  return weigh(model.inner->kernel, triangle(model, t), x, weights);
}

TangentField solve_adjoint(const Model& m, const Sensitivity& given, const std::vector<bool>& held) {
  if (static_cast<Index>(held.size()) != m.inner->ordering.contact_rows)
    throw std::invalid_argument("solve_adjoint: one entry per row in contact is needed");
  const Sensitivity dJ = balanced(m, given);
  const Index triangles = static_cast<Index>(m.mesh.triangles.size()), rows = m.inner->ordering.size,
              contact_rows = m.inner->ordering.contact_rows, leading = rows - contact_rows;
  const bool penalized = m.inner->system.penalty > 0, loaded = dJ.interior.size() > 0;

  Loads loads;
  loads.prescribed.assign(static_cast<std::size_t>(m.inner->skeleton.total), 0);
  Eigen::VectorXd on_skeleton =
      dJ.skeleton.size() > 0 ? dJ.skeleton : Eigen::VectorXd::Zero(m.inner->skeleton.total).eval();
  loads.own.setZero(penalized ? triangles : 0);
  if (loaded) {
    Eigen::MatrixXd local(skeleton_count(m.element), triangles);
    parallel_for(triangles, m.threads, [&](Index begin, Index end) {
      for (Index t = begin; t < end; ++t) {
        const DualLoad load = condense_dual(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t),
                                            dJ.interior.col(t), {m.inner->system.penalty, 0});
        local.col(t) = load.F;
        if (penalized) loads.own[t] = load.own;
      }
    });
    for (Index t = 0; t < triangles; ++t) {
      const Seen view = seen(m.mesh, m.inner->skeleton, t);
      for (int i = 0; i < view.count; ++i) {
        on_skeleton[view.base[i]] += local(i, t);
        if (view.jump[i] != none) on_skeleton[view.jump[i]] += local(i, t);
      }
    }
  }
  loads.F.resize(rows);
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(contact_rows);
  for (Index u = 0; u < m.inner->skeleton.total; ++u) {
    const Index row = m.inner->ordering.row[u];
    if (row == none) continue;
    loads.F[row] = on_skeleton[u];
    if (row >= leading && held[row - leading] && dJ.force.size() > 0) jump[row - leading] = -dJ.force[u];
  }

  const Condensation condensed(m);
  UniformPressure uniform;
  TangentField adjoint;
  const PenaltyIterate best = solve_tangent(condensed, uniform, loads, jump, held, TangentSolver::to_rounding, adjoint);
  adjoint.interior.resize(interior_count(m.element), triangles);
  const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(interior_count(m.element));
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Penalty penalty{m.inner->system.penalty, penalized ? best.theta[t] : 0};
      adjoint.interior.col(t) = interior_dual(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t),
                                              loaded ? Eigen::VectorXd(dJ.interior.col(t)) : nothing,
                                              trace_seen(m.mesh, m.inner->skeleton, adjoint.skeleton, t), penalty);
    }
  });
  return adjoint;
}

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

struct TangentSolver::Impl {
  Condensation condensed;
  std::vector<bool> held;
  UniformPressure uniform = {};
};

TangentSolver::TangentSolver(const Model& m, std::vector<bool> held) {
  if (static_cast<Index>(held.size()) != m.inner->ordering.contact_rows)
    throw std::invalid_argument("TangentSolver: one entry per row in contact is needed");
  impl_ = std::make_unique<Impl>(Impl{Condensation(m), std::move(held)});
}
TangentSolver::~TangentSolver() = default;

TangentField TangentSolver::solve(const Eigen::VectorXd& load, const std::vector<double>& prescribed, double enough,
                                  std::span<const Index> only) {
  const Model& m = impl_->condensed.m;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size()), contact_rows = m.inner->ordering.contact_rows,
              leading = m.inner->ordering.size - contact_rows;
  const bool penalized = m.inner->system.penalty > 0;
  const auto given = [&](Index u) { return m.inner->skeleton.fixed[u] ? prescribed[u] : 0; };
  Eigen::VectorXd F = load;
  std::vector<Index> beside;  // triangles that see a value
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e)
    for (int k = 0; k < m.inner->skeleton.per_edge; ++k)
      if (given(edge_unknown(m.inner->skeleton, e) + k) != 0)
        for (const Index t : m.mesh.sides[e])
          if (t != none) beside.push_back(t);
  std::sort(beside.begin(), beside.end());
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  for (const Index t : beside) {
    const Condensed c =
        condense(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), {}, {m.inner->system.penalty, 0});
    const Seen view = seen(m.mesh, m.inner->skeleton, t);
    SkeletonVector value(view.count);
    for (int i = 0; i < view.count; ++i) value[i] = given(view.base[i]);
    const SkeletonVector force = c.K * value;
    for (int i = 0; i < view.count; ++i) {
      F[view.base[i]] -= force[i];
      if (view.jump[i] != none) F[view.jump[i]] -= force[i];
    }
  }
  Loads loads{Eigen::VectorXd(m.inner->ordering.size), Eigen::VectorXd::Zero(penalized ? triangles : 0), prescribed};
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    if (m.inner->ordering.row[u] != none) loads.F[m.inner->ordering.row[u]] = F[u];
  TangentField state;
  const PenaltyIterate best = solve_tangent(impl_->condensed, impl_->uniform, loads, Eigen::VectorXd::Zero(contact_rows),
                                     impl_->held, enough, state);
  for (Index u = m.inner->skeleton.base; u < m.inner->skeleton.total; ++u)
    if (const Index row = m.inner->ordering.row[u]; row != none && row >= leading && best.force.size() > 0)
      state.force[u] = best.force[row - leading];
  state.interior.setZero(interior_count(m.element), triangles);
  const auto fill = [&](Index t) {
    const Penalty penalty{m.inner->system.penalty, penalized ? best.theta[t] : 0};
    state.interior.col(t) = interior(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), {},
                                     trace_seen(m.mesh, m.inner->skeleton, state.skeleton, t), penalty);
  };
  for (const Index t : only) fill(t);
  if (only.empty())
    parallel_for(triangles, m.threads, [&](Index begin, Index end) {
      for (Index t = begin; t < end; ++t) fill(t);
    });
  return state;
}

TangentField solve_linear(const Model& m, const Eigen::VectorXd& load, const std::vector<double>& prescribed,
                          const std::vector<bool>& held) {
  return TangentSolver(m, held).solve(load, prescribed);
}

}  // namespace kerf
