// Work and dissipation of a body under loads in steps, with friction that remembers what has slid. On the straight line
// between two states
//   D = sum 1/2 (l_before + l) |dj_t|,   l = slip bound + f p_n   [theory: C.29],
//   W = 1/2 (F_before + F).du + 1/2 (q_before + q).du_D           [theory: C.30],
// q the reactions; W is the energy gained plus D, exactly, where every row keeps what it does within the step. Slips of
// a step are jumps less where the step before left them, the prescribed values of frictional rows [theory: C.28].
// Derived in docs/theory/contact.md, section Steps of loading.

#include "solver/history.hpp"

#include "kerf/recover.hpp"
#include "solver/tangent_cone.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// What the supports exert, per skeleton unknown: the moments of the tractions, which the Gauss points of the trace
// integrate exactly on straight edges, less those of the loads. Where a motion is stopped that no support stops, these
// are all.
Eigen::VectorXd support_forces(const Model& m, const Field& s) {
  const Skeleton& skeleton = m.inner->skeleton;
  const EdgeRule& trace = m.inner->kernel.trace;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(skeleton.total);
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    const auto& [left, right] = m.mesh.sides[e];
    if (left != none && right != none) continue;
    const Index first = edge_unknown(skeleton, e), t = left != none ? left : right;
    const Triangle shape = triangle(m, t);
    const Vec2 outward = outward_normal(m.mesh, e);
    for (int g = 0; g < static_cast<int>(trace.s.size()); ++g) {
      if (!skeleton.fixed[first + 2 * g] && !skeleton.fixed[first + 2 * g + 1]) continue;
      const OnEdge p = on_edge(m.mesh, skeleton.curvatures, e, trace.s[g]);
      const Vec2 traction = trace.w[g] *
                            (tensor(stress_at(m.inner->kernel, shape, s.interior.col(t), p.x)) * normal_at(p, outward)),
                 along = frame_at(skeleton, e, g).transpose() * traction;
      for (int d = 0; d < 2; ++d)
        if (const Index u = first + 2 * g + d; skeleton.fixed[u]) force[u] = along[d] - m.inner->system.tractions[u];
    }
  }
  return force;
}

// Per row in contact the unknown.
std::vector<Index> unknowns(const Model& m) {
  const Index leading = m.inner->ordering.leading();
  std::vector<Index> all(static_cast<std::size_t>(m.inner->ordering.contact_rows));
  for (Index u = m.inner->skeleton.base; u < m.inner->skeleton.total; ++u)
    if (const Index row = m.inner->ordering.row[u]; row >= leading) all[static_cast<std::size_t>(row - leading)] = u;
  return all;
}

// Of friction, on the tangential rows in contact.
// Pressures below zero are rounding at open points: no friction from them.
Eigen::VectorXd limits(const InHistory& of) {
  const std::vector<Index> unknown = unknowns(of.model);
  Eigen::VectorXd limit = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknown.size()));
  for (const ContactPoint& p : contact_points(of.model))
    if (p.tangential != none)
      limit[p.tangential] =
          p.slip_bound + p.friction * std::max(of.state.force[unknown[static_cast<std::size_t>(p.normal)]], 0.0);
  return limit;
}

// |slip| of the step that led to a state, on all rows in contact.
Eigen::VectorXd slips(const InHistory& of) {
  const std::vector<Index> unknown = unknowns(of.model);
  Eigen::VectorXd slip(static_cast<Eigen::Index>(unknown.size()));
  for (std::size_t i = 0; i < unknown.size(); ++i)
    slip[static_cast<Eigen::Index>(i)] =
        std::abs(of.state.skeleton[unknown[i]] - of.model.inner->skeleton.prescribed[unknown[i]]);
  return slip;
}

double on_supports(const Model& m, const Eigen::VectorXd& force, const Field& moved) {
  double work = 0;
  for (Index u = 0; u < m.inner->skeleton.base; ++u)
    if (m.inner->skeleton.fixed[u]) work += force[u] * moved.skeleton[u];
  return work;
}

}  // namespace

double dissipation_between(const InHistory& from, const InHistory& to) {
  const Eigen::VectorXd before = limits(from);
  return 0.5 * (before + limits(to)).dot(slips(to));
}

// The unloaded body has no pressures: its limits are the slip bounds alone.
double dissipation_from_rest(const InHistory& to) {
  Eigen::VectorXd before = Eigen::VectorXd::Zero(to.model.inner->ordering.contact_rows);
  for (const ContactPoint& p : contact_points(to.model))
    if (p.tangential != none) before[p.tangential] = p.slip_bound;
  return 0.5 * (before + limits(to)).dot(slips(to));
}

double work_from_rest(const InHistory& to) {
  return 0.5 *
         (work_of_loads(to.model, to.state) + on_supports(to.model, support_forces(to.model, to.state), to.state));
}

// Reactions of both states act on the motion of the supports between them: the trapezoidal rule, exact on a straight
// line.
double work_between(const InHistory& from, const InHistory& to) {
  Field moved = to.state;
  moved.skeleton -= from.state.skeleton;
  moved.interior -= from.state.interior;
  const Eigen::VectorXd held = support_forces(from.model, from.state) + support_forces(to.model, to.state);
  return 0.5 * (work_of_loads(from.model, moved) + work_of_loads(to.model, moved) + on_supports(to.model, held, moved));
}

std::vector<double> slip_profile(const Model& m, const Field& s, Index crack) {
  const Skeleton& skeleton = m.inner->skeleton;
  const int points = skeleton.per_edge / 2;
  std::vector<double> slip;
  for (const CrackEdge& edge : m.mesh.cracks[crack])
    for (int k = 0; k < points; ++k) {
      const Index u = skeleton.jump[edge.edge] + 2 * (edge.forward ? k : points - 1 - k) + 1;
      slip.push_back(skeleton.prescribed[u] - s.skeleton[u]);
    }
  return slip;
}

// A held row is exactly where the step before left it, so that 0 tells sticking.
SlipLengths slip_lengths(const Model& m, const Field& s) {
  SlipLengths lengths;
  for (std::size_t c = 0; c < m.mesh.cracks.size(); ++c) {
    if (!has_friction(m.scene.laws[c])) continue;
    const std::vector<CrackPoint> profile = crack_profile(m, s, static_cast<Index>(c));
    const std::vector<double> slip = slip_profile(m, s, static_cast<Index>(c));
    for (std::size_t i = 0; i < profile.size(); ++i)
      if (profile[i].status == CrackPoint::Status::Closed)
        (slip[i] == 0 ? lengths.stick : lengths.slip) += profile[i].length;
  }
  return lengths;
}

}  // namespace kerf
