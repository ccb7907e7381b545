// The saddle point (C.2) as it stands, factorized as a whole by UMFPACK: the reference for the condensed systems.
// Unknowns are tractions T at the Gauss points of edges, one value for both sides, the stress functions of each
// triangle without traction, u and omega; a crack is a set of interior edges on which T lies in the cone,
//   T_n <= 0,   T_t = 0 at the Gauss points of cracks,   multipliers: the jumps   [theory: C.13].
// Stress functions dual to the tractions come from C' = Q R P', C the moments of s n: Q R'^-1 P' has unit moments, the
// rest of Q none. Rows in contact that move have given tractions, the others are solved for; a factor per set.
// Displacements and rotations are multiplied by 2 mu, equations by h^2: all unknowns are stresses, all rows forces.
// Nothing degenerates at nu = 1/2, so that no penalty is needed; in an enclosed body a multiplier fixes the mean
// pressure. Derived in docs/theory/contact.md, section Saddle point without elimination.

#include "solver/saddle_point.hpp"
#include "solver/recovery.hpp"

#include "solver/system.hpp"

#include "base/dense.hpp"
#include "base/parallel.hpp"
#include "base/stopwatch.hpp"
#include "kerf/recover.hpp"
#include "kerf/stop.hpp"
#include "solver/contact/law.hpp"
#include "solver/state/solve.hpp"
#include "solver/system/lu.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace kerf {

namespace {

constexpr Index few = 64;  // triangles between two looks for a request to stop

// Unknowns: under the numbers of the base unknowns of the skeleton the traction that goes with each (sigma n at the
// Gauss points, n from left to right, outward on the boundary) and the rotations at vertices; then per triangle the
// stress functions without traction, and u_xi, r; in an enclosed incompressible body last the multiplier of the mean
// pressure. Displacements and rotations are multiplied by 2 mu (of `material`, one for all) and equations weighted with
// h^2, so that all unknowns are stresses and all rows forces.
struct Layout {
  int edge = 0;       // tractions seen by one triangle
  int stress = 0;     // functions without traction
  int inner = 0;      // u_xi, r
  Index first = 0;    // unknown behind the skeleton
  Index mean = none;  // mean pressure
  Index size = 0;
  Eigen::VectorXd share;  // per base unknown on an edge: the length that its Gauss point stands for
};

// One triangle in that basis.
struct Local {
  LocalSystem system;
  Eigen::MatrixXd basis;   // columns: stresses dual to the tractions, then those without
  Eigen::MatrixXd matrix;  // over the unknowns of the triangle
  Eigen::VectorXd load;
  std::vector<Index> unknowns;
  Eigen::VectorXd sign;  // of n per traction
};

// The sign turns the triangle's outward traction into that of the edge's own normal; share/h scales moments to values
// at Gauss points. A rank below the number of moments at 1e-8 means a triangle so flat that its tractions depend on
// each other.
Local local(const Model& m, const Layout& layout, Index t) {
  const Triangle shape = triangle(m, t);
  Local l{local_system(m.inner->kernel, shape, material_of(m.mesh, m.scene, t), force_of(m.inner->system, t)),
          {},
          {},
          {},
          {},
          {}};
  const LocalSystem& a = l.system;
  const Eigen::Index edge = layout.edge, stress = a.M.rows(), own = stress - edge, inner = a.Bt.cols(),
                     corners = a.Ct.cols() - edge, size = stress + inner + corners;
  // C' = Q R P': the dual functions are Q R'^-1 P', what is orthogonal to C the rest of Q.
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr = pivoted_qr(a.Ct.leftCols(edge), 1e-8);
  if (qr.rank() < edge)
    throw Error(Fault::Numerics,
                fmt::format("triangle {} is too flat for the saddle-point system (backend \"umfpack\"): its normal "
                            "stress reaches only {} of {} edge moments independently; use the backend \"cholmod\"",
                            t, qr.rank(), edge));
  const Eigen::MatrixXd q = full_q(qr);
  const Eigen::MatrixXd permuted = qr.colsPermutation().transpose();
  l.basis.resize(stress, stress);
  l.basis.leftCols(edge) =
      multiply(q.leftCols(edge), solve_upper_transposed(qr.matrixR().topLeftCorner(edge, edge), permuted));
  l.basis.rightCols(own) = q.rightCols(own);

  const Seen view = seen(m.mesh, m.inner->skeleton, t);
  l.unknowns.assign(view.base.begin(), view.base.begin() + edge);
  const Index first = layout.first + t * static_cast<Index>(own + inner);
  for (Index i = 0; i < own + inner; ++i) l.unknowns.push_back(first + i);
  l.unknowns.insert(l.unknowns.end(), view.base.begin() + edge, view.base.begin() + view.count);

  l.sign.resize(edge);
  for (Eigen::Index i = 0; i < edge; ++i) {
    const Index e = m.mesh.edges_of[t][i / m.inner->skeleton.per_edge];
    const bool boundary = m.mesh.sides[e][0] == none || m.mesh.sides[e][1] == none;
    l.sign[i] = boundary || m.mesh.sides[e][0] == t ? 1 : -1;
    l.basis.col(i) *= l.sign[i] * layout.share[l.unknowns[i]] / a.h;
  }
  const double h2 = a.h * a.h;
  l.matrix = Eigen::MatrixXd::Zero(size, size);
  l.matrix.topLeftCorner(stress, stress) =
      multiply(2 * m.scene.material.mu * h2 * transposed_multiply(l.basis, a.M), l.basis);
  l.matrix.block(0, stress, stress, inner) = h2 * transposed_multiply(l.basis, a.Bt);
  l.matrix.topRightCorner(stress, corners) = -h2 * transposed_multiply(l.basis, a.Ct.rightCols(corners));
  l.matrix.bottomLeftCorner(inner + corners, stress) = l.matrix.topRightCorner(stress, inner + corners).transpose();
  l.load = Eigen::VectorXd::Zero(size);
  l.load.segment(stress, inner) = h2 * a.given;
  if (a.strain.size() > 0) l.load.head(stress) = 2 * m.scene.material.mu * h2 * transposed_multiply(l.basis, a.strain);
  return l;
}

// The unknowns that the skeleton has for traces stand for tractions here: one number per Gauss point and component.
Layout lay_out(const Model& m) {
  Layout layout;
  const Element& e = m.element;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  layout.edge = 3 * m.inner->skeleton.per_edge;
  layout.stress = stress_dimension(e) - layout.edge;
  layout.inner = displacement_count(e) + inner_rotation_count(e);
  layout.first = m.inner->skeleton.base;
  layout.size = layout.first + triangles * static_cast<Index>(layout.stress + layout.inner);
  if (has_free_pressure(m.mesh, m.scene, m.inner->skeleton)) layout.mean = layout.size++;
  layout.share = Eigen::VectorXd::Zero(m.inner->skeleton.base);
  for (Index i = 0; i < static_cast<Index>(m.mesh.edges.size()); ++i)
    for (int k = 0; k < m.inner->skeleton.per_edge; ++k)
      layout.share[edge_unknown(m.inner->skeleton, i) + k] = length(m.mesh, i) * m.inner->kernel.trace.w[k / 2];
  return layout;
}

// The system over all unknowns, as if no traction were given.
// The lower triangle alone: LU makes both halves of it.
struct Saddle {
  LowerTriangle matrix;
  Eigen::VectorXd load;
};

struct Entry {
  Index row, column;
  double value;
};

// Entries are filed by columns, then sorted by rows; equal ones are added in the order of the triangles.
LowerTriangle sum_up(Index size, const std::vector<Entry>& entries) {
  std::vector<Index> start(size + 1, 0);
  for (const Entry& e : entries) ++start[e.column + 1];
  for (Index j = 0; j < size; ++j) start[j + 1] += start[j];
  std::vector<std::pair<Index, double>> sorted(entries.size());
  std::vector<Index> next(start.begin(), start.end() - 1);
  for (const Entry& e : entries) sorted[next[e.column]++] = {e.row, e.value};
  LowerTriangle a;
  a.size = size;
  a.start.push_back(0);
  for (Index j = 0; j < size; ++j) {
    // Stable, so that the sums do not depend on the library.
    std::stable_sort(sorted.begin() + start[j], sorted.begin() + start[j + 1],
                     [](const auto& p, const auto& q) { return p.first < q.first; });
    for (Index p = start[j]; p < start[j + 1]; ++p) {
      if (static_cast<Index>(a.rows.size()) > a.start.back() && a.rows.back() == sorted[p].first) {
        a.values.back() += sorted[p].second;
        continue;
      }
      a.rows.push_back(sorted[p].first);
      a.values.push_back(sorted[p].second);
    }
    a.start.push_back(static_cast<Index>(a.rows.size()));
  }
  return a;
}

// Supports: <u_D, t n> with t dual to the traction at a Gauss point is share times u_D there.
Saddle assemble_saddle(const Model& m, const Layout& layout) {
  Saddle saddle;
  saddle.load = Eigen::VectorXd::Zero(layout.size);
  std::vector<Entry> entries;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    if (t % few == 0) check_stop();
    const Local l = local(m, layout, t);
    const auto add = [&](Index i, Index j, double value) {
      if (value != 0) entries.push_back({std::max(i, j), std::min(i, j), value});
    };
    const Index size = static_cast<Index>(l.unknowns.size());
    for (Index j = 0; j < size; ++j) {
      saddle.load[l.unknowns[j]] += l.load[j];
      for (Index i = j; i < size; ++i) add(l.unknowns[i], l.unknowns[j], l.matrix(i, j));
    }
    if (layout.mean == none) continue;
    const Eigen::VectorXd mean = l.system.h * l.system.h * l.basis.transpose() * l.system.trace;
    for (Index i = 0; i < static_cast<Index>(mean.size()); ++i) add(layout.mean, l.unknowns[i], mean[i]);
  }
  saddle.matrix = sum_up(layout.size, entries);
  for (Index u = 0; u < m.inner->skeleton.base; ++u)
    if (m.inner->skeleton.fixed[u])
      saddle.load[u] += 2 * m.scene.material.mu * layout.share[u] * m.inner->skeleton.prescribed[u];
  return saddle;
}

// Which tractions are given, and their values; those in contact are decided by it.
struct Given {
  std::vector<bool> known;
  Eigen::VectorXd value;       // 0 where not known
  std::vector<Index> contact;  // per row in contact its traction
  Eigen::VectorXd fluid;       // and the force of the fluid in the crack, which the traction bears besides
};

// On free boundary edges and on open cracks tractions are known; rows in contact decide theirs. What the fluid in a
// crack presses is borne besides.
Given given_tractions(const Model& m, const Layout& layout) {
  const Skeleton& s = m.inner->skeleton;
  Given g{std::vector<bool>(layout.size, false), Eigen::VectorXd::Zero(layout.size),
          std::vector<Index>(m.inner->ordering.contact_rows), Eigen::VectorXd::Zero(m.inner->ordering.contact_rows)};
  const Eigen::VectorXd loads = traction_loads(m.mesh, m.inner->kernel, s, m.inner->data);
  const Index leading = m.inner->ordering.leading();
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e)
    for (int i = 0; i < s.per_edge; ++i) {
      const Index u = edge_unknown(s, e) + i;
      if (m.mesh.sides[e][0] == none || m.mesh.sides[e][1] == none) {
        g.known[u] = !s.fixed[u];
        if (g.known[u]) g.value[u] = loads[u] / layout.share[u];
      } else if (s.jump[e] != none && !s.fixed[s.jump[e] + i]) {
        const Index row = m.inner->ordering.row[s.jump[e] + i];
        const double fluid = loads[s.jump[e] + i];
        if (row >= leading) {
          g.contact[row - leading] = u;
          g.fluid[row - leading] = fluid;
        } else {
          g.known[u] = true;
          g.value[u] = -fluid / layout.share[u];
        }
      }
    }
  return g;
}

// Solutions for given tractions on the rows in contact that move. Keeps the factor while these rows stay the same.
struct Solver {
  const Model& m;
  const Layout& layout;
  const Saddle& saddle;
  const Given& given;
  std::vector<Motion> motion = {};
  std::vector<Index> row = {};  // per unknown its row in the factor, or none
  std::optional<Lu> lu = {};

  std::vector<bool> known(const std::vector<Motion>& moving) const {
    std::vector<bool> k = given.known;
    for (std::size_t i = 0; i < moving.size(); ++i) k[given.contact[i]] = moving[i] != Motion::Held;
    return k;
  }
  // Known unknowns have no row: their columns go to the right-hand side. Friction that slides forward or backward is
  // one set for the factor.
  void factorize(const std::vector<Motion>& moving) {
    const std::vector<bool> k = known(moving);
    if (lu && k == known(motion)) return;
    motion = moving;
    Index size = 0;
    row.assign(layout.size, none);
    for (Index u = 0; u < layout.size; ++u)
      if (!k[u]) row[u] = size++;
    LowerTriangle a;
    a.size = size;
    a.start.push_back(0);
    for (Index j = 0; j < layout.size; ++j) {
      if (row[j] == none) continue;
      for (Index p = saddle.matrix.start[j]; p < saddle.matrix.start[j + 1]; ++p) {
        if (row[saddle.matrix.rows[p]] == none) continue;
        a.rows.push_back(row[saddle.matrix.rows[p]]);
        a.values.push_back(saddle.matrix.values[p]);
      }
      a.start.push_back(static_cast<Index>(a.rows.size()));
    }
    lu.reset();
    lu.emplace(a);
  }
  /// All unknowns when the moving rows carry `force`.
  /// T = -(p + fluid)/share: what a moving row bears is its force and what the fluid presses, over the length of its
  /// point.
  Eigen::VectorXd solve(const std::vector<Motion>& moving, const Eigen::VectorXd& force) {
    factorize(moving);
    Eigen::VectorXd x = given.value;
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const Index u = given.contact[i];
      const auto row = static_cast<Eigen::Index>(i);
      x[u] = moving[i] == Motion::Held ? 0 : -(force[row] + given.fluid[row]) / layout.share[u];
    }
    const Eigen::VectorXd rest = saddle.load - multiply(saddle.matrix, x);
    Eigen::VectorXd b(std::count_if(row.begin(), row.end(), [](Index r) { return r != none; }));
    for (Index u = 0; u < layout.size; ++u)
      if (row[u] != none) b[row[u]] = rest[u];
    const Eigen::VectorXd y = lu->solve(b);
    for (Index u = 0; u < layout.size; ++u)
      if (row[u] != none) x[u] = y[row[u]];
    return x;
  }
  /// What the equations of the given tractions lack is the displacement there: on cracks left minus right.
  Response respond(const std::vector<Motion>& moving, const Eigen::VectorXd& force) {
    const Eigen::VectorXd x = solve(moving, force), rest = multiply(saddle.matrix, x) - saddle.load;
    Response r{Eigen::VectorXd::Zero(m.inner->ordering.contact_rows), Eigen::VectorXd(m.inner->ordering.contact_rows)};
    for (Index i = 0; i < m.inner->ordering.contact_rows; ++i) {
      const Index u = given.contact[i];
      if (moving[i] == Motion::Held) {
        r.force[i] = -layout.share[u] * x[u] - given.fluid[i];
      } else {
        r.jump[i] = -rest[u] / (2 * m.scene.material.mu * layout.share[u]);
        r.force[i] = force[i];
      }
    }
    return r;
  }
};

// Residual relative to the largest right-hand side of the rows that are solved for, kkt with forces relative to the
// largest traction.
Certificate certificate_of(const Solver& s, const Eigen::VectorXd& x, const std::vector<ContactPoint>& points,
                           const Contact& contact) {
  Eigen::VectorXd known = x;
  for (Index u = 0; u < s.layout.size; ++u)
    if (s.row[u] != none) known[u] = 0;
  const Eigen::VectorXd right = s.saddle.load - multiply(s.saddle.matrix, known),
                        rest = multiply(s.saddle.matrix, x) - s.saddle.load;
  double load = std::numeric_limits<double>::min(), worst = 0;
  for (Index u = 0; u < s.layout.size; ++u) {
    if (s.row[u] == none) continue;
    load = std::max(load, std::abs(right[u]));
    worst = std::max(worst, std::abs(rest[u]));
  }
  Certificate c;
  c.residual = worst / load;
  const double traction = x.head(s.layout.share.size()).cwiseProduct(s.layout.share).cwiseAbs().maxCoeff();
  c.kkt = std::max(c.residual, optimality(points, contact.jump, contact.force, traction));
  return c;
}

// |2 strain energy - work of loads, supports and friction|, relative [theory: E.21]: from the stresses alone.
// 2 strain energy plus (e, s) equals the work of loads, supports and contact: with an eigenstrain (H.4).
double work_defect(const Model& m, const Field& state) {
  const Skeleton& s = m.inner->skeleton;
  const Kernel& k = m.inner->kernel;
  double work = work_of_loads(m, state) + state.force.dot(state.skeleton), given = 0;
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    if (m.mesh.label[e] == none) continue;
    const Index t = m.mesh.sides[e][0] == none ? m.mesh.sides[e][1] : m.mesh.sides[e][0];
    for (int i = 0; i < s.per_edge; ++i) {
      const double value = s.prescribed[edge_unknown(s, e) + i];
      if (value == 0) continue;
      const auto& [a, b] = m.mesh.edges[e];
      const Vec2 x = m.mesh.points[a] + k.trace.s[i / 2] * (m.mesh.points[b] - m.mesh.points[a]);
      const Vec2 traction = tensor(stress_at(k, triangle(m, t), state.interior.col(t), x)) * outward_normal(m.mesh, e);
      work += value * length(m.mesh, e) * k.trace.w[i / 2] * traction.dot(s.frame[e].col(i % 2));
      given += m.scene.material.mu * value * value;
    }
  }
  constexpr double rounding = 100 * std::numeric_limits<double>::epsilon();
  const double energy = 2 * strain_energy(m, state) + work_of_eigenstrain(m, state), size = energy + rounding * given;
  return size > 0 ? std::abs(energy - work) / size : 0;
}

// Base values of an edge are those of its left triangle, or the only one.
// Traces follow from the equations tested with the dual functions: (A s, t) + (u, div t) + (r, as t) = <m, t n> has the
// trace at one Gauss point on its right side.
void recover(const Solver& solver, const Eigen::VectorXd& x, Field& state) {
  const Model& m = solver.m;
  const Layout& layout = solver.layout;
  const Skeleton& s = m.inner->skeleton;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const double mu2 = 2 * m.scene.material.mu;
  Eigen::MatrixXd traces(layout.edge, triangles);
  state.interior.resize(interior_count(m.element), triangles);
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      if (t % few == 0) check_stop();
      const Local l = local(m, layout, t);
      const Eigen::Index stress = l.basis.cols(), inner = l.system.Bt.cols(),
                         corners = l.system.Ct.cols() - layout.edge;
      Eigen::VectorXd y(l.unknowns.size());
      for (Eigen::Index i = 0; i < y.size(); ++i) y[i] = x[l.unknowns[i]];
      // (A s, t) + (u, div t) + (r, as t) = <m, t n> with t dual to the tractions.
      Eigen::VectorXd moment = l.matrix.topRows(layout.edge) * y - l.load.head(layout.edge);
      if (layout.mean != none)
        moment += x[layout.mean] * l.system.h * l.system.h * l.basis.leftCols(layout.edge).transpose() * l.system.trace;
      for (int i = 0; i < layout.edge; ++i) traces(i, t) = l.sign[i] * moment[i] / (mu2 * layout.share[l.unknowns[i]]);
      Eigen::VectorXd solution(stress + inner);
      solution << l.basis * y.head(stress), y.segment(stress, inner) / mu2;
      SkeletonVector at(layout.edge + corners);
      at << traces.col(t), y.tail(corners) / mu2;
      state.interior.col(t) =
          interior_of(m.inner->kernel, triangle(m, t), material_of(m.mesh, m.scene, t), solution, at);
    }
  });
  state.skeleton = Eigen::VectorXd::Zero(s.total);
  for (Index u = edge_unknown(s, static_cast<Index>(m.mesh.edges.size())); u < s.base; ++u)
    state.skeleton[u] = x[u] / mu2;
  const auto seen_from = [&](Index t, Index e) -> Eigen::VectorXd {
    Eigen::Index place = 0;
    while (m.mesh.edges_of[t][place] != e) ++place;
    return traces.col(t).segment(place * s.per_edge, s.per_edge);
  };
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    const auto [left, right] = m.mesh.sides[e];
    const Eigen::VectorXd base = seen_from(left == none ? right : left, e);
    for (int i = 0; i < s.per_edge; ++i) {
      const Index u = edge_unknown(s, e) + i;
      state.skeleton[u] = s.fixed[u] ? s.prescribed[u] : base[i];
    }
    if (s.jump[e] == none) continue;
    const Eigen::VectorXd jump = seen_from(right, e) - base;
    for (int i = 0; i < s.per_edge; ++i)
      if (solver.row[edge_unknown(s, e) + i] == none) state.skeleton[s.jump[e] + i] = jump[i];
  }
}

// The strain of a stiff region is the difference of displacements that the rest of the body makes as large as it
// likes, so that their rounding is a stress there: how large, relative to the mean one. The equations do not tell.
// Rounding of u over the size of a triangle is a strain, times mu a stress: added to the certificate, since equations
// in stresses do not show it.
double rounding_in_stiff_regions(const Model& m, const State& state) {
  constexpr double rounding = 20 * std::numeric_limits<double>::epsilon();  // as measured against closed forms
  double largest = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const double mu = material_of(m.mesh, m.scene, t).mu;
    if (mu <= m.scene.material.mu) continue;
    const double u = trace_seen(m.mesh, m.inner->skeleton, state.skeleton, t).cwiseAbs().maxCoeff();
    largest = std::max(largest, mu * u / std::sqrt(area(m.mesh, t)));
  }
  const double stress = mean_stress(m, state);
  return stress > 0 ? rounding * largest / stress : 0;
}

}  // namespace

// It has no gap, no pieces that contact alone holds and no curved triangles: these are refused.
State solve_saddle_point(const Model& m) {
  require_straight(m, "the saddle-point system (backend \"umfpack\")");
  if (std::ranges::any_of(m.scene.laws, has_gap))
    throw Error(Fault::Usage,
                "the saddle-point system (backend \"umfpack\") knows no gap of a crack; use the backend \"cholmod\"");
  if (!m.inner->semicoercive.empty())
    throw Error(Fault::Usage,
                "the saddle-point system (backend \"umfpack\") needs a support on every piece of the body; use the "
                "backend \"cholmod\"");
  State state;
  Stopwatch watch;
  const Layout layout = lay_out(m);
  const Saddle saddle = assemble_saddle(m, layout);
  const Given given = given_tractions(m, layout);
  Solver solver{m, layout, saddle, given};
  const std::vector<ContactPoint> points = contact_points(m);
  state.seconds.solve += watch.lap();
  Contact contact;
  if (m.inner->ordering.contact_rows > 0) {
    const auto respond = [&](const std::vector<Motion>& motion, const Eigen::VectorXd& force) {
      return solver.respond(motion, force);
    };
    contact = active_set({m.inner->ordering.contact_rows, respond}, points);
    state.contact_iterations = contact.iterations;
    state.linear_solves = contact.solves;
    state.converged = contact.converged;
    state.seconds.contact += watch.lap();
  }
  const Eigen::VectorXd x = solver.solve(contact.motion, contact.force);
  ++state.linear_solves;
  state.certificate = certificate_of(solver, x, points, contact);
  state.force = Eigen::VectorXd::Zero(m.inner->skeleton.total);
  for (Index u = m.inner->skeleton.base; u < m.inner->skeleton.total; ++u) {
    const Index row = m.inner->ordering.row[u] - m.inner->ordering.leading();
    if (m.inner->ordering.row[u] == none || row < 0) continue;
    const bool held = contact.motion[row] == Motion::Held;
    state.force[u] =
        held ? -layout.share[given.contact[row]] * x[given.contact[row]] - given.fluid[row] : contact.force[row];
  }
  recover(solver, x, state);
  state.certificate.kkt = std::max(state.certificate.kkt, rounding_in_stiff_regions(m, state));
  state.eigenstrain = m.inner->data.strain.empty() ? 0 : 1;
  if (!m.inner->floating.empty()) remove_motions(m, state);
  state.certificate.work = work_defect(m, state);
  if (layout.mean != none) {
    const double strain = mean_stress(m, state) / m.scene.material.mu;
    check_volume(m, x[layout.mean] / m.scene.material.mu * area(m), strain);
  }
  state.seconds.solve += watch.lap();
  return state;
}

}  // namespace kerf
