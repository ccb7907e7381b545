#include "solver/model.hpp"

#include "solver/parallel.hpp"
#include "solver/stopwatch.hpp"

#include <fmt/core.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

// Adds the body force, a combination of the motions, that undoes the work of the loads on them (inertia relief).
void balance(const Mesh& mesh, const std::vector<RigidMotion>& motions, const Eigen::VectorXd& work, Scene& scene) {
  const Eigen::Index n = work.size();
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  const TriangleRule rule = triangle_rule(2);
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const auto& v = mesh.triangles[t];
    for (Eigen::Index q = 0; q < rule.w.size(); ++q) {
      const Vec2 x = (1 - rule.x(0, q) - rule.x(1, q)) * mesh.points[v[0]] + rule.x(0, q) * mesh.points[v[1]] +
                     rule.x(1, q) * mesh.points[v[2]];
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)
          gram(i, j) += area(mesh, t) * rule.w[q] * motions[i].at(x).dot(motions[j].at(x));
    }
  }
  const Eigen::VectorXd share = gram.llt().solve(work);
  scene.body = [body = scene.body, motions, share](const Vec2& x) {
    Vec2 force = body ? body(x) : Vec2::Zero();
    for (Eigen::Index i = 0; i < share.size(); ++i) force -= share[i] * motions[i].at(x);
    return force;
  };
}

// Supports must hold every piece that the cracks leave, but loads in equilibrium hold a whole body by themselves.
std::vector<RigidMotion> check_supports(const Mesh& mesh, const Kernel& k, const Skeleton& s, Scene& scene,
                                        std::vector<std::string>& notes) {
  std::vector<bool> cut(mesh.edges.size(), false);
  for (std::size_t e = 0; e < cut.size(); ++e)
    cut[e] = mesh.crack[e] != none && scene.laws[mesh.crack[e]].kind != CrackLaw::Kind::Bonded;
  const std::vector<Index> piece = pieces(mesh, cut);
  const Index count = piece.empty() ? 0 : 1 + *std::max_element(piece.begin(), piece.end());
  if (count > 1) {
    for (Index p = 0; p < count; ++p) {
      const auto motions = free_motions(mesh, k, s, piece, p);
      if (motions.empty()) continue;
      const Index inside = static_cast<Index>(std::find(piece.begin(), piece.end(), p) - piece.begin());
      const Vec2 x = centroid(mesh, inside);
      throw Error(
          Fault::Numerics,
          fmt::format("cracks cut the body into {} pieces, and the supports do not hold the piece around ({:.4g}, "
                      "{:.4g}): it is free to make {}; support each piece on its own (contact alone does not "
                      "count), or end the crack inside the body",
                      count, x.x(), x.y(), describe(motions.front())));
    }
    return {};
  }
  const auto motions = free_motions(mesh, k, s, piece, 0);
  std::string free;
  double worst = 0;
  Eigen::VectorXd work(static_cast<Eigen::Index>(motions.size()));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    // Polygons for arcs and quadrature of the data leave balanced loads slightly unbalanced.
    constexpr double balanced = 1e-3;
    const Work w = work_on(mesh, k, s, scene, motions[i]);
    if (w.relative > balanced)
      throw Error(Fault::Numerics,
                  fmt::format("the supports leave the body free to make {}, and the loads do not balance on it (net "
                              "work {:.3g} of the loads' absolute work); add a [[boundary]] with a displacement that "
                              "stops it, or loads in equilibrium",
                              describe(motions[i]), w.relative));
    free += (free.empty() ? "" : ", ") + describe(motions[i]);
    worst = std::max(worst, w.relative);
    work[static_cast<Eigen::Index>(i)] = w.value;
  }
  if (motions.empty()) return motions;
  std::string note = "the supports leave " + free +
                     " free; the loads are in equilibrium, and the rigid motion is fixed by zero mean displacement and "
                     "rotation";
  constexpr double exact = 1e-12;
  if (worst > exact) {
    balance(mesh, motions, work, scene);
    note +=
        fmt::format("; their remaining imbalance, {:.2g} of their absolute work, is balanced by a body force", worst);
  }
  notes.push_back(note);
  return motions;
}

// Takes the rigid motions closest to the displacement in the mean out of the traces of a solution that pins hold.
void remove_motion(const Model& m, State& s) {
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
  const Eigen::VectorXd share = gram.llt().solve(moment);
  for (Index i = 0; i < n; ++i)
    s.skeleton.head(m.skeleton.base) -= share[i] * trace(m.mesh, m.kernel, m.skeleton, m.floating[i]);
}

struct Solved {
  Eigen::VectorXd x, force;  // per row; force on closed bounded rows
  std::vector<bool> closed;  // per bounded row
  Eigen::VectorXd theta;     // per triangle, with a penalty
  double penalty_error = 0;  // what the last sweep still changed in theta, relative
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
  const double scale = size.size() > 0 ? size.maxCoeff() : 0;
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

// The bounded rows condensed: S once for all sweeps, and the two halves of a solve around them.
struct Condensation {
  const Model& m;
  Eigen::MatrixXd S = m.factor.schur_complement();

  auto lower() const {
    return m.factor.trailing_factor().triangularView<Eigen::Lower>();
  }
  /// Right-hand side on the bounded rows after the first half, y = L^-1 b.
  Eigen::VectorXd load(const Eigen::VectorXd& y) const {
    return lower() * y.tail(m.ordering.trailing);
  }
  /// The second half with given jumps on the bounded rows.
  Eigen::VectorXd complete(Eigen::VectorXd y, const Eigen::VectorXd& jump) const {
    const auto l = lower();
    y.tail(jump.size()) = l.transpose() * jump;
    Eigen::VectorXd x = m.factor.backward(y);
    x.tail(jump.size()) = jump;
    return x;
  }
  /// K x = b with the closed contacts held at 0.
  Eigen::VectorXd solve_frozen(const Eigen::VectorXd& b, const std::vector<bool>& closed) const {
    const Eigen::VectorXd y = m.factor.forward(b);
    return m.ordering.trailing == 0 ? m.factor.backward(y) : complete(y, open_jumps(S, load(y), closed));
  }
};

// theta is a volume strain: what the prescribed displacements ask for beyond rounding and quadrature cannot be had.
void check_volume(const Model& m, double change, double whole) {
  const double displacement = std::transform_reduce(
      m.skeleton.prescribed.begin(), m.skeleton.prescribed.end(), 0.0,
      [](double a, double b) { return std::max(a, b); }, [](double v) { return std::abs(v); });
  constexpr double rounding = 1e-7;
  if (std::abs(change) > rounding * displacement * std::sqrt(whole))
    throw Error(Fault::Numerics,
                fmt::format("the body is incompressible (poisson = 0.5) and wholly enclosed by its supports, but the "
                            "prescribed displacements change its area by {:.3g}; free a part of the boundary, or "
                            "prescribe displacements that keep the area",
                            2 * change));
}

// The sweeps shrink every error fast but one: a uniform pressure in a body whose supports leave it no volume to change
// falls only by a/(a + c). It is one-dimensional, so it is taken out exactly: theta + delta, x + delta response, with
// delta such that the mean over the body of theta - a mean(tr s) vanishes. With c = 0 such a body has no level of
// pressure at all, and no solution when its boundary is asked to change the volume: the mean pressure is then zero.
struct UniformPressure {
  std::vector<bool> closed;  // contacts that the response was computed with
  Eigen::VectorXd response;  // of x to theta = 1
  double stiffness = 0;      // sum_T |T| (1 - a d mean(tr s)/d delta)

  void correct(const Condensation& condensed, Solved& s, State& state) {
    const Model& m = condensed.m;
    const Eigen::Index count = m.system.traces.rows() - 2;
    const double a = m.system.penalty;
    if (response.size() == 0 || closed != s.closed) {
      Solved unit;
      unit.theta = Eigen::VectorXd::Ones(s.theta.size());
      closed = s.closed;
      response = condensed.solve_frozen(right_hand_side(m, unit) - m.system.F, closed);
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
    if (!(stiffness > none_left * whole)) {
      check_volume(m, rest, whole);
      s.theta = before.array() - rest / whole;
      return;
    }
    const double delta = rest / stiffness;
    s.x += delta * response;
    s.theta = before.array() + delta;
  }
};

// |K x - F| with what the closed contacts carry taken as their force.
Certificate certify(const Model& m, Solved& s, const Eigen::VectorXd& F) {
  const Index leading = m.ordering.size - m.ordering.trailing;
  Eigen::VectorXd rest = multiply(m.system.K, s.x) - F;
  s.force = Eigen::VectorXd::Zero(m.ordering.size);
  double negative = 0, complementarity = 0;
  const double load = std::max(m.system.F.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  const double largest_jump = m.ordering.trailing > 0 ? s.x.tail(m.ordering.trailing).cwiseAbs().maxCoeff() : 0;
  const double displacement = std::max(s.x.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  for (Index i = 0; i < m.ordering.trailing; ++i) {
    const Index row = leading + i;
    if (s.closed[i]) {
      s.force[row] = rest[row];
      rest[row] = 0;
      negative = std::max(negative, -s.force[row] / load);
    } else {
      negative = std::max(negative, -s.x[row] / displacement);
    }
    if (largest_jump > 0)
      complementarity = std::max(complementarity, std::abs(s.force[row] * s.x[row]) / (load * largest_jump));
  }
  Certificate c;
  c.residual = rest.cwiseAbs().maxCoeff() / load;
  c.kkt = std::max({c.residual, negative, complementarity, s.penalty_error});
  return c;
}

// K x = F + contact forces, from a first guess x (corrected by its residual) or from nothing.
void solve_contact(const Condensation& condensed, const Eigen::VectorXd& F, Solved& s, State& state) {
  const Model& m = condensed.m;
  Stopwatch watch;
  const Index trailing = m.ordering.trailing;
  // The correction solves for x as a whole on the bounded rows: their part of the guess is dropped first.
  const bool guess = s.x.size() > 0;
  if (guess) s.x.tail(trailing).setZero();
  const Eigen::VectorXd rest = guess ? Eigen::VectorXd(F - multiply(m.system.K, s.x)) : F;
  const Eigen::VectorXd y = m.factor.forward(rest);
  ++state.linear_solves;
  state.seconds.solve += watch.lap();
  Eigen::VectorXd correction;
  if (trailing > 0) {
    const Unilateral contact = solve_unilateral(condensed.S, condensed.load(y), s.closed);
    s.closed = contact.closed;
    state.contact_iterations += contact.iterations;
    state.converged = contact.converged;
    state.seconds.contact += watch.lap();
    correction = condensed.complete(y, contact.jump);
    for (Index i = 0; i < trailing; ++i)
      if (s.closed[i]) correction[m.ordering.size - trailing + i] = 0;
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

Model prepare(Mesh mesh, const Element& e, Scene scene, int threads) {
  if (scene.laws.size() != mesh.cracks.size()) throw std::invalid_argument("prepare: one law per crack is needed");
  Stopwatch watch;
  const Kernel k = kernel(e);
  Skeleton skeleton = number(mesh, k, scene);
  std::vector<std::string> notes;
  std::vector<RigidMotion> floating = check_supports(mesh, k, skeleton, scene, notes);
  if (!floating.empty())
    for (const Index pin : pins(mesh, k, skeleton, floating)) skeleton.fixed[pin] = true;
  Ordering ordering = order(mesh, skeleton);
  ModelSeconds seconds;
  const double numbering = watch.lap();
  System system = assemble(mesh, k, skeleton, scene, ordering, threads);
  seconds.assemble = watch.lap() + numbering;
  Factor factor(system.K, ordering.trailing, is_definite(e));
  seconds.factor = watch.lap();
  return {std::move(mesh),
          k,
          std::move(scene),
          std::move(skeleton),
          std::move(ordering),
          std::move(system),
          std::move(factor),
          std::move(floating),
          std::move(notes),
          threads,
          seconds};
}

State solve(const Model& m) {
  State state;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  Solved solved;
  if (m.system.penalty > 0) solved.theta = Eigen::VectorXd::Zero(triangles);
  Eigen::VectorXd F = m.system.F;
  Stopwatch watch;
  const Condensation condensed{m};
  state.seconds.contact += watch.lap();
  UniformPressure uniform;
  // One solve, then sweeps that remove the residual: of rounding, and of the penalty when there is one.
  constexpr int most_sweeps = 15;
  // With a penalty F is as large as 1/a, so that the sweeps go on until rounding stops them.
  const double good_enough = m.system.penalty > 0 ? 1e-16 : 1e-12;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    Solved next = solved;
    if (m.ordering.size > 0) solve_contact(condensed, F, next, state);
    watch.lap();
    if (m.system.penalty > 0) {
      uniform.correct(condensed, next, state);
      update_theta(m, next);
      F = right_hand_side(m, next);
    }
    if (m.ordering.size == 0) {
      solved = std::move(next);
      if (m.system.penalty == 0) break;
      continue;
    }
    const Certificate certificate = certify(m, next, F);
    const bool better = sweep == 0 || certificate.kkt < state.certificate.kkt;
    state.seconds.solve += watch.lap();
    if (!better) break;
    const bool slow = sweep > 0 && certificate.kkt > 0.5 * state.certificate.kkt;
    solved = std::move(next);
    state.certificate = certificate;
    if (certificate.kkt <= good_enough || slow) break;
  }

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
        state.interior.col(t) = interior(m.kernel, triangle(m, t), m.scene.material, force_of(m.system, t),
                                         trace_seen(m, state.skeleton, t), penalty);
      }
    });
  };
  recover();
  if (!m.floating.empty()) {
    remove_motion(m, state);
    recover();
  }
  state.seconds.solve += watch.lap();
  return state;
}

bool certified(const State& state) {
  const double allowed = std::max(1e-10, 20 * state.certificate.rounding);
  return state.converged && state.certificate.kkt <= allowed && state.certificate.kkt < 1e-4;
}

Triangle triangle(const Model& model, Index t) {
  return triangle(model.mesh, model.skeleton, t);
}

Fields evaluate(const Model& model, const State& state, Index t, const Points& x) {
  return evaluate(model.kernel, triangle(model, t), state.interior.col(t), x);
}

double strain_energy(const Model& m, const State& s) {
  double energy = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Triangle shape = triangle(m, t);
    const Points x = rule_points(m.kernel.rule, shape);
    double sum = 0;
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      const Eigen::Vector4d v = stress_at(m.kernel, shape, s.interior.col(t), x.col(q));
      const double difference = v[0] - v[3], trace = v[0] + v[3];
      sum += m.kernel.rule.w[q] *
             ((0.5 * difference * difference + v[1] * v[1] + v[2] * v[2]) / (2 * m.scene.material.mu) +
              m.scene.material.c * trace * trace);
    }
    energy += 0.5 * area(shape) * sum;
  }
  return energy;
}

double work_of_loads(const Model& m, const State& s) {
  double work = traction_loads(m.mesh, m.kernel, m.skeleton, m.scene).dot(s.skeleton);
  const int first = stress_count(m.kernel.element), count = displacement_count(m.kernel.element);
  for (Index t = 0; t < static_cast<Index>(m.system.force.cols()); ++t)
    work += area(m.mesh, t) * m.system.force.col(t).head(count).dot(s.interior.col(t).segment(first, count));
  return work;
}

double potential_energy(const Model& m, const State& s) {
  return strain_energy(m, s) - work_of_loads(m, s);
}

double area(const Model& m) {
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) sum += area(m.mesh, t);
  return sum;
}

}  // namespace kerf
