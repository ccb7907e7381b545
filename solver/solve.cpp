#include "solver/solve.hpp"

#include "solver/contact_law.hpp"
#include "solver/parallel.hpp"
#include "solver/stopwatch.hpp"

#include <fmt/core.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

struct Solved {
  Eigen::VectorXd x, force;    // per row; force on the rows in contact
  std::vector<Motion> motion;  // per row in contact
  Eigen::VectorXd theta;       // per triangle, with a penalty
  double penalty_error = 0;    // what the last sweep still changed in theta, relative
};

SkeletonVector trace_seen(const Model& m, const Eigen::VectorXd& skeleton, Index t) {
  const Seen view = seen(m.mesh, m.skeleton, t);
  SkeletonVector trace(view.count);
  for (int i = 0; i < view.count; ++i)
    trace[i] = skeleton[view.base[i]] + (view.jump[i] == none ? 0 : skeleton[view.jump[i]]);
  return trace;
}

// All skeleton unknowns from the free ones.
Eigen::VectorXd spread(const Model& m, const Eigen::VectorXd& rows, const std::vector<double>* elsewhere) {
  Eigen::VectorXd all(m.skeleton.total);
  for (Index u = 0; u < m.skeleton.total; ++u)
    all[u] = m.ordering.row[u] != none ? rows[m.ordering.row[u]] : elsewhere ? (*elsewhere)[u] : 0;
  return all;
}

// theta = a mean(tr s) of the present solution. An enclosed body does not feel a uniform theta, so that its error must
// be watched here: relative to the terms that it is the sum of.
void update_theta(const Model& m, Solved& s) {
  const Eigen::VectorXd before = s.theta;
  Eigen::VectorXd size(s.theta.size());
  const Eigen::VectorXd skeleton = spread(m, s.x, &m.skeleton.prescribed);
  const Eigen::Index count = m.system.traces.rows() - 2;
  parallel_for(static_cast<Index>(s.theta.size()), m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const auto column = m.system.traces.col(t);
      const SkeletonVector seen_here = trace_seen(m, skeleton, t);
      const double mean =
          column.head(count).dot(seen_here) / area(m.mesh, t) + column[count] + s.theta[t] * column[count + 1];
      size[t] = m.system.penalty * (column.head(count).cwiseProduct(seen_here).cwiseAbs().sum() / area(m.mesh, t) +
                                    std::abs(column[count]));
      s.theta[t] = m.system.penalty * mean;
    }
  });
  const double scale = size.size() > 0 ? std::max(size.maxCoeff(), s.theta.cwiseAbs().maxCoeff()) : 0;
  s.penalty_error = scale > 0 ? (s.theta - before).cwiseAbs().maxCoeff() / scale : 0;
}

// F with the penalty paid back. Scattered in the order of the triangles.
Eigen::VectorXd right_hand_side(const Model& m, const Solved& s) {
  Eigen::VectorXd F = m.system.F;
  const auto add = [&](Index unknown, double value) {
    if (unknown != none && m.ordering.row[unknown] != none) F[m.ordering.row[unknown]] -= value;
  };
  for (Index t = 0; t < static_cast<Index>(s.theta.size()); ++t) {
    const Seen view = seen(m.mesh, m.skeleton, t);
    for (int i = 0; i < view.count; ++i) {
      add(view.base[i], s.theta[t] * m.system.traces(i, t));
      add(view.jump[i], s.theta[t] * m.system.traces(i, t));
    }
  }
  return F;
}

// The rows in contact condensed: S once for all sweeps, and the two halves of a solve around them.
struct Condensation {
  const Model& m;
  Eigen::MatrixXd S = m.factor.schur_complement();
  std::vector<ContactPoint> points = contact_points(m);

  auto lower() const {
    return m.factor.trailing_factor().triangularView<Eigen::Lower>();
  }
  /// Right-hand side on the rows in contact after the first half, y = L^-1 b.
  Eigen::VectorXd load(const Eigen::VectorXd& y) const {
    return lower() * y.tail(m.ordering.trailing);
  }
  /// The second half with given jumps on the rows in contact.
  Eigen::VectorXd complete(Eigen::VectorXd y, const Eigen::VectorXd& jump) const {
    const auto l = lower();
    y.tail(jump.size()) = l.transpose() * jump;
    Eigen::VectorXd x = m.factor.backward(y);
    x.tail(jump.size()) = jump;
    return x;
  }
  /// Jumps under a load when the held rows stay at 0.
  Eigen::VectorXd moving_jumps(const Eigen::VectorXd& r, const std::vector<Motion>& motion) const {
    std::vector<bool> held(motion.size());
    for (std::size_t i = 0; i < held.size(); ++i) held[i] = motion[i] == Motion::Held;
    return open_jumps(S, r, held);
  }
  /// K x = b with the held rows at 0 and no change of force on the others.
  Eigen::VectorXd solve_frozen(const Eigen::VectorXd& b, const std::vector<Motion>& motion) const {
    const Eigen::VectorXd y = m.factor.forward(b);
    return m.ordering.trailing == 0 ? m.factor.backward(y) : complete(y, moving_jumps(load(y), motion));
  }
  /// Jumps and forces of the whole sparse system for `active_set`.
  Contact eliminate(const Eigen::VectorXd& b, const Eigen::VectorXd& y, const std::vector<Motion>& guess) const {
    const Eigen::VectorXd r = load(y);
    const auto respond = [&](const std::vector<Motion>& motion, const Eigen::VectorXd& force) -> Response {
      const Eigen::VectorXd jump = moving_jumps(r + force, motion);
      const Eigen::VectorXd rest = multiply(m.system.K, complete(y, jump)) - b;
      return {jump, rest.tail(jump.size())};
    };
    return active_set({m.ordering.trailing, respond}, points, guess);
  }
};

// The sweeps shrink every error fast but one: a uniform pressure in a body whose supports leave it no volume to change
// falls only by a/(a + c). It is one-dimensional, so it is taken out exactly: theta + delta, x + delta response, with
// delta such that the mean over the body of theta - a mean(tr s) vanishes. With c = 0 such a body has no level of
// pressure at all, and no solution when its boundary is asked to change the volume: the mean pressure is then zero.
struct UniformPressure {
  std::vector<Motion> motion;  // that the response was computed with
  Eigen::VectorXd response;    // of x to theta = 1
  double stiffness = 0;        // sum_T |T| (1 - a d mean(tr s)/d delta)
  bool level_open = false;     // the last solution leaves the level of pressure free

  void correct(const Condensation& condensed, Solved& s, State& state) {
    const Model& m = condensed.m;
    const Eigen::Index count = m.system.traces.rows() - 2;
    const double a = m.system.penalty;
    if (response.size() == 0 || motion != s.motion) {
      Solved unit;
      unit.theta = Eigen::VectorXd::Ones(s.theta.size());
      motion = s.motion;
      response = condensed.solve_frozen(right_hand_side(m, unit) - m.system.F, motion);
      ++state.linear_solves;
      const Eigen::VectorXd skeleton = spread(m, response, nullptr);
      stiffness = 0;
      for (Index t = 0; t < static_cast<Index>(s.theta.size()); ++t) {
        const auto column = m.system.traces.col(t);
        stiffness +=
            area(m.mesh, t) * (1 - a * column[count + 1]) - a * column.head(count).dot(trace_seen(m, skeleton, t));
      }
    }
    const Eigen::VectorXd before = s.theta;
    update_theta(m, s);
    double rest = 0, whole = 0;
    for (Index t = 0; t < static_cast<Index>(s.theta.size()); ++t) {
      rest += area(m.mesh, t) * (s.theta[t] - before[t]);
      whole += area(m.mesh, t);
    }
    constexpr double none_left = 1e-11;
    level_open = !(stiffness > none_left * whole);
    if (level_open) {
      check_volume(m, 2 * rest, s.theta.cwiseAbs().maxCoeff());
      s.theta = before.array() - rest / whole;
      return;
    }
    const double delta = rest / stiffness;
    s.x += delta * response;
    s.theta = before.array() + delta;
  }
};

// |K x - F| on the rows that no contact holds; the contact forces and how far they and the jumps are from the law.
Certificate certify(const Condensation& condensed, Solved& s, const Eigen::VectorXd& F) {
  const Model& m = condensed.m;
  const Index trailing = m.ordering.trailing, leading = m.ordering.size - trailing;
  const Eigen::VectorXd rest = multiply(m.system.K, s.x) - F;
  const double load = std::max(m.system.F.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  Certificate c;
  c.residual = leading > 0 ? rest.head(leading).cwiseAbs().maxCoeff() / load : 0;
  s.force = Eigen::VectorXd::Zero(m.ordering.size);
  double law = 0;
  if (trailing > 0) {
    const Eigen::VectorXd force = rest.tail(trailing);
    const Admissible allowed = admissible(condensed.points, force);
    for (Index i = 0; i < trailing; ++i) {
      if (s.motion[i] == Motion::Held)
        s.force[leading + i] = force[i];
      else
        s.force[leading + i] = s.motion[i] == Motion::Forward ? allowed.low[i] : allowed.high[i];
      if (s.motion[i] != Motion::Held)
        c.residual = std::max(c.residual, std::abs(force[i] - s.force[leading + i]) / load);
    }
    law = optimality(condensed.points, s.x.tail(trailing), force, load);
  }
  c.kkt = std::max({c.residual, law, s.penalty_error});
  return c;
}

// K x = F + contact forces, from a first guess x (corrected by its residual) or from nothing.
void solve_contact(const Condensation& condensed, ContactMethod method, const Eigen::VectorXd& F, Solved& s,
                   State& state) {
  const Model& m = condensed.m;
  Stopwatch watch;
  const Index trailing = m.ordering.trailing;
  // The correction solves for x as a whole on the rows in contact: their part of the guess is dropped first.
  const bool guess = s.x.size() > 0;
  if (guess) s.x.tail(trailing).setZero();
  const Eigen::VectorXd rest = guess ? Eigen::VectorXd(F - multiply(m.system.K, s.x)) : F;
  const Eigen::VectorXd y = m.factor.forward(rest);
  ++state.linear_solves;
  state.seconds.solve += watch.lap();
  Eigen::VectorXd correction;
  if (trailing > 0) {
    const Contact contact = method == ContactMethod::DualQp
                                ? dual_qp(condensed.S, condensed.load(y), condensed.points, s.motion)
                            : method == ContactMethod::Uzawa ? uzawa(condensed.S, condensed.load(y), condensed.points)
                                                             : condensed.eliminate(rest, y, s.motion);
    if (method == ContactMethod::ActiveSet) state.linear_solves += contact.solves;
    s.motion = contact.motion;
    state.contact_iterations += contact.iterations;
    state.converged = contact.converged;
    state.seconds.contact += watch.lap();
    correction = condensed.complete(y, contact.jump);
    for (Index i = 0; i < trailing; ++i)
      if (s.motion[i] == Motion::Held) correction[m.ordering.size - trailing + i] = 0;
  } else {
    correction = m.factor.backward(y);
  }
  if (guess)
    s.x += correction;
  else
    s.x = std::move(correction);
  state.seconds.solve += watch.lap();
}

}  // namespace

Eigen::VectorXd floating_shares(const Model& m, const State& s) {
  const Index n = static_cast<Index>(m.floating.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd moment = Eigen::VectorXd::Zero(n);
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Triangle shape = triangle(m, t);
    const Points x = rule_points(m.kernel.rule, shape), u = evaluate(m, s, t, x).displacement;
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      const double w = area(shape) * m.kernel.rule.w[q];
      // The motion as the element's displacement sees it: its mean when that is constant.
      const Vec2 at = m.kernel.element.displacement == 0 ? centroid(shape) : Vec2(x.col(q));
      for (Index i = 0; i < n; ++i) {
        moment[i] += w * u.col(q).dot(m.floating[i].at(at));
        for (Index j = 0; j < n; ++j) gram(i, j) += w * m.floating[i].at(at).dot(m.floating[j].at(at));
      }
    }
  }
  return gram.llt().solve(moment);
}

std::vector<ContactPoint> contact_points(const Model& m) {
  const Index leading = m.ordering.size - m.ordering.trailing;
  std::vector<ContactPoint> points;
  for (std::size_t crack = 0; crack < m.mesh.cracks.size(); ++crack) {
    const CrackLaw& law = m.scene.laws[crack];
    for (const CrackEdge& c : m.mesh.cracks[crack])
      for (int g = 0; g < m.skeleton.per_edge / 2; ++g) {
        const Index unknown = m.skeleton.jump[c.edge] + 2 * g;
        if (!m.skeleton.bounded[unknown]) continue;
        ContactPoint p;
        p.normal = m.ordering.row[unknown] - leading;
        if (m.skeleton.frictional[unknown + 1]) {
          p.tangential = m.ordering.row[unknown + 1] - leading;
          p.slip_bound = law.slip_bound * length(m.mesh, c.edge) * m.kernel.trace.w[g];
          p.friction = law.friction;
        }
        points.push_back(p);
      }
  }
  return points;
}

void check_volume(const Model& m, double change, double largest_strain) {
  const double displacement = std::transform_reduce(
      m.skeleton.prescribed.begin(), m.skeleton.prescribed.end(), 0.0,
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
  Solved solved;
  if (m.system.penalty > 0) solved.theta = Eigen::VectorXd::Zero(triangles);
  Eigen::VectorXd F = m.system.F;
  Stopwatch watch;
  const Condensation condensed{m};
  state.seconds.contact += watch.lap();
  UniformPressure uniform;
  // One solve, then sweeps that remove the residual: of rounding, and of the penalty when there is one. With a penalty
  // F is as large as 1/a, so that the sweeps go on until rounding stops them; before they shrink the error they may
  // raise it, while a pressure builds up or contacts change.
  const bool penalised = m.system.penalty > 0;
  const int most_sweeps = penalised ? 40 : 15;
  const double good_enough = penalised ? 1e-16 : 1e-12;
  Solved next = solved;
  int without_gain = 0;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    if (m.ordering.size > 0) solve_contact(condensed, method, F, next, state);
    watch.lap();
    if (penalised) {
      uniform.correct(condensed, next, state);
      update_theta(m, next);
      F = right_hand_side(m, next);
    }
    if (m.ordering.size == 0) {
      solved = next;
      if (!penalised) break;
      continue;
    }
    const Certificate certificate = certify(condensed, next, F);
    state.seconds.solve += watch.lap();
    const bool better = sweep == 0 || certificate.kkt < state.certificate.kkt;
    const bool slow = sweep > 0 && certificate.kkt > 0.5 * state.certificate.kkt;
    if (better) {
      solved = next;
      state.certificate = certificate;
    }
    constexpr double settled = 1e-9;
    without_gain = slow ? without_gain + 1 : 0;
    const int patience = penalised && state.certificate.kkt > settled ? 6 : 1;
    if (certificate.kkt <= good_enough || without_gain == patience) break;
  }

  if (uniform.level_open) has_free_pressure(m.mesh, m.scene, m.skeleton);  // an opening crack would have fixed it
  watch.lap();
  if (m.ordering.size > 0) {
    const double load = std::max(m.system.F.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
    state.certificate.rounding =
        std::numeric_limits<double>::epsilon() * multiply_absolute(m.system.K, solved.x).maxCoeff() / load;
  }
  state.skeleton = spread(m, solved.x, &m.skeleton.prescribed);
  state.force = spread(m, solved.force, nullptr);
  state.interior.resize(interior_count(m.kernel.element), triangles);
  const auto recover = [&] {
    parallel_for(triangles, m.threads, [&](Index begin, Index end) {
      for (Index t = begin; t < end; ++t) {
        const Penalty penalty{m.system.penalty, m.system.penalty > 0 ? solved.theta[t] : 0};
        state.interior.col(t) = interior(m.kernel, triangle(m, t), material_of(m.mesh, m.scene, t),
                                         force_of(m.system, t), trace_seen(m, state.skeleton, t), penalty);
      }
    });
  };
  recover();
  if (!m.floating.empty()) {
    const Eigen::VectorXd share = floating_shares(m, state);
    for (Index i = 0; i < static_cast<Index>(m.floating.size()); ++i)
      state.skeleton.head(m.skeleton.base) -= share[i] * trace(m.mesh, m.kernel, m.skeleton, m.floating[i]);
    recover();
  }
  state.seconds.solve += watch.lap();
  return state;
}

}  // namespace kerf
