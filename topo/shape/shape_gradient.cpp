// The derivative of J when the vertices of the mesh move, a covector on the vertices [theory: S.2, S.3]. With the
// Lagrangian L' (state; adjoint) all partial derivatives of J by the fields are 0, so that only the explicit part is
// left, of fields that the motion carries along (stresses by Piola, the rest by composition):
//   dJ(theta) = int j div theta + d_x j.theta + j_s:(s G' - s div theta)
//             + int D:(z G') + (A z + Gamma(rho)):(s G') - (A s:z) div theta + p.f div theta + p.(grad f theta) + ...
// with D = A s + Gamma(omega), z, p, rho the adjoint, G = grad theta, and
//  dPi(theta) = -int [D:(s G') - 1/2 (A s:s) div theta + u.f div theta + u.(grad f theta) + ...].
// The dots: tractions, pressures, supports, jumps across cracks and integrals over edges, whose data stay in space
// while edge, length and normal move, by differences in the two ends (moving.cpp). It is exact for the discrete J of
// elements whose spaces Piola's transformation preserves, and one-sided where contact is biactive. Derived in
// docs/theory/shape_gradient.md, section "Moving vertices".

#include "kerf/shape_gradient.hpp"
#include "solver/system.hpp"

#include "base/parallel.hpp"
#include "topo/analysis.hpp"
#include "topo/orthotropic.hpp"
#include "topo/shape/moving.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf {

namespace {

// One body under its loads: J holds `energy` times its potential energy.
struct LoadedBody {
  const Model& model;
  const Field& state;
  double energy = 0;
};

// Everything that J is made of. With L the Lagrangian of local.hpp (its stationary value is minus the energy) and L'
// its derivative in the direction of the adjoint:  J = sum energy Pi + terms + L'(state; adjoint),  all partial
// derivatives by the state 0, so that only what the fields meet while they move along counts.
struct Parts {
  std::vector<LoadedBody> loaded;  // the model; with a misfit the measured body
  double work = 0;                 // weight of (f, u) + <g, u>
  const Field* dual = nullptr;
  const Sensitivity* derivative = nullptr;
  double reaction_work = 0;  // of the work of the supports: see add_supports
  struct Explicit {
    const Term* term;
    double share;
  };
  std::vector<Explicit> terms = {};
};

// A compliance under homogeneous supports is -2 Pi as an energy; when supports move, prescribed values that were 0 may
// not be 0 at the new place, and the work of the reactions on them counts besides.
Parts parts_of(const Analysis& a, const Functional& j) {
  Parts p{.loaded = {{*a.model, *a.state, a.energy_share}}, .work = a.work_share};
  if (a.measured) p.loaded.push_back({*a.measured_model, *a.measured, a.measured_share});
  if (a.adjoint) {
    p.dual = &*a.adjoint;
    p.derivative = &a.derivative;
  }
  for (std::size_t i = 0; i < j.terms.size(); ++i) {
    const Term& term = j.terms[i];
    if (term.energy || term.measured) continue;
    if (!term.work)
      p.terms.push_back({&term, a.slope[i]});
    else if (has_self_adjoint_work(*a.model))
      p.reaction_work += a.slope[i];
  }
  return p;
}

void add(Points& gradient, const Mesh& mesh, Index e, const Mat2& by) {
  for (int end = 0; end < 2; ++end) gradient.col(mesh.edges[e][end]) += by.col(end);
}

// The stresses of a body on one triangle: A s + Gamma(omega) in place of grad u.
struct Sample {
  Mat2 stress, strain, gradient;
};
Sample at(const Fields& f, Eigen::Index q, const Material& m) {
  const Mat2 s = tensor(f.stress.col(q)), e = strain(m, s);
  Mat2 gradient = e;
  gradient(0, 1) += f.rotation[q];
  gradient(1, 0) -= f.rotation[q];
  return {s, e, gradient};
}

// X : (s grad theta') = sum_jk (X's)_jk d_k theta_j.
void add_lagrangian(const Parts& p, Index t, const Triangle& shape, const Points& x, TriangleMotion& motion) {
  const Model& m = p.loaded.front().model;
  const Material& material = material_of(m.mesh, m.scene, t);
  const TriangleRule& rule = m.inner->kernel.rule;
  const double whole = area(shape);
  Fields dual;
  if (p.dual) dual = evaluate(m.inner->kernel, shape, p.dual->interior.col(t), x);
  for (const LoadedBody& body : p.loaded) {
    const bool first = &body == &p.loaded.front();
    if (body.energy == 0 && !(first && p.dual)) continue;
    const Fields f = evaluate(m.inner->kernel, shape, body.state.interior.col(t), x);
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      const double w = whole * rule.w[q];
      const Sample s = at(f, q, material);
      motion.by_gradient -=
          w * body.energy *
          (s.gradient.transpose() * s.stress - 0.5 * s.strain.cwiseProduct(s.stress).sum() * Mat2::Identity());
      if (!first || !p.dual) continue;
      const Sample z = at(dual, q, material);
      motion.by_gradient += w * (s.gradient.transpose() * z.stress + z.gradient.transpose() * s.stress -
                                 s.strain.cwiseProduct(z.stress).sum() * Mat2::Identity());
    }
  }
}

// (f, v), v = work u - sum energy u + p: f is met at other places. In the rule of the force moments.
void add_body_force(const Parts& p, Index t, const Triangle& shape, TriangleMotion& motion) {
  const Model& m = p.loaded.front().model;
  const TriangleRule& rule = m.inner->kernel.load;
  const Points x = rule_points(rule, shape);
  Points v = Points::Zero(2, x.cols());
  const auto add = [&](double share, const Field& s) {
    if (share != 0) v += share * evaluate(m.inner->kernel, shape, s.interior.col(t), x).displacement;
  };
  for (const LoadedBody& body : p.loaded) add(-body.energy, body.state);
  add(p.work, p.loaded.front().state);
  if (p.dual) add(1, *p.dual);
  const double whole = area(shape);
  Eigen::VectorXd here(x.cols());
  for (Eigen::Index q = 0; q < x.cols(); ++q) here[q] = m.scene.body(x.col(q)).dot(v.col(q));
  motion.by_gradient += whole * rule.w.dot(here) * Mat2::Identity();
  add_place(
      {rule, x, std::sqrt(whole), here, [&](Eigen::Index q, const Vec2& y) { return m.scene.body(y).dot(v.col(q)); }},
      whole, motion);
}

// Vectors at the Gauss points of an edge from components in its frame.
Points on_edge(const Model& m, Index e, const Eigen::VectorXd& skeleton, Index first) {
  Points v(2, m.inner->kernel.trace.s.size());
  for (int g = 0; g < v.cols(); ++g)
    v.col(g) = frame_at(m.inner->skeleton, e, g) * skeleton.segment<2>(first + 2 * static_cast<Index>(g));
  return v;
}

// Moments of s n against the trace functions, n out of triangle t: the trace's Gauss points integrate them exactly.
Points moments(const Model& m, const Field& s, Index e, Index t) {
  const Triangle shape = triangle(m, t);
  const Vec2& a = m.mesh.points[m.mesh.edges[e][0]];
  const Vec2 side = m.mesh.points[m.mesh.edges[e][1]] - a;
  Vec2 n(side.y(), -side.x());  // times the length
  if (m.mesh.sides[e][1] == t) n = -n;
  Points f(2, m.inner->kernel.trace.s.size());
  for (int g = 0; g < f.cols(); ++g)
    f.col(g) =
        m.inner->kernel.trace.w[g] *
        (tensor(stress_at(m.inner->kernel, shape, s.interior.col(t), a + m.inner->kernel.trace.s[g] * side)) * n);
  return f;
}

// <g, m> for the tractions of a model and displacements m of its skeleton.
void add_tractions(const Model& m, const Eigen::VectorXd& skeleton, Points& gradient) {
  const Mesh& mesh = m.mesh;
  const EdgeRule rule = gauss(8);
  for (const Traction& traction : m.scene.tractions)
    for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
      if (mesh.label[e] != traction.label) continue;
      // Displacements belong to shares of the edge and stay while it moves.
      const Points at_points = on_edge(m, e, skeleton, edge_unknown(m.inner->skeleton, e));
      Points u(2, rule.s.size());
      for (Eigen::Index q = 0; q < rule.s.size(); ++q)
        u.col(q) = at_points * trace_basis(m.inner->kernel.trace, rule.s[q]);
      add(gradient, mesh, e,
          by_ends(mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]], [&](const Vec2& a, const Vec2& b) {
            const MovedEdge edge = moved_edge(mesh, e, a, b);
            double sum = 0;
            for (Eigen::Index q = 0; q < rule.s.size(); ++q)
              sum += edge.length * rule.w[q] * traction.value(edge.at(rule.s[q]), edge.normal).dot(u.col(q));
            return sum;
          }));
    }
}

// Normal and tangent of a crack at x, on an edge with this normal (of any length).
Mat2 frame_of(const CrackLaw& law, const Vec2& x, const Vec2& chord) {
  Vec2 n = chord.normalized();
  if (law.normal) {
    n = law.normal(x);
    if (n.dot(chord) < 0) n = -n;
  }
  return (Mat2() << n, Vec2(-n.y(), n.x())).finished();
}

// int p n . [m] of the pressures in the cracks, n normal to the edges: the jump keeps its components in a frame that
// moves, as in add_cracks.
void add_pressures(const Model& m, const Eigen::VectorXd& skeleton, Points& gradient) {
  const Mesh& mesh = m.mesh;
  const EdgeRule rule = gauss(8);
  const EdgeRule& trace = m.inner->kernel.trace;
  for (std::size_t crack = 0; crack < mesh.cracks.size(); ++crack) {
    const CrackLaw& law = m.scene.laws[crack];
    if (!has_pressure(law)) continue;
    for (const CrackEdge& c : mesh.cracks[crack]) {
      const Index e = c.edge, unknown = m.inner->skeleton.jump[e];
      add(gradient, mesh, e,
          by_ends(mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]], [&](const Vec2& a, const Vec2& b) {
            const Vec2 along = b - a, normal(along.y(), -along.x());  // times the length
            Points jump(2, trace.s.size());
            for (int g = 0; g < jump.cols(); ++g)
              jump.col(g) = frame_of(law, a + trace.s[g] * along, normal) * skeleton.segment<2>(unknown + 2 * g);
            double sum = 0;
            for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
              const double p = law.pressure(a + rule.s[q] * along, normal.normalized())[0];
              sum += rule.w[q] * p * normal.dot(jump * trace_basis(trace, rule.s[q]));
            }
            return sum;
          }));
    }
  }
}

// The work of the tractions that a misfit replaces on the measured displacements.
void add_measured_work(const Model& m, const Support& measured, double share, Points& gradient) {
  const Mesh& mesh = m.mesh;
  const EdgeRule rule = gauss(8);
  for (const Traction& traction : m.scene.tractions)
    for (Index e = 0; traction.label == measured.label && e < static_cast<Index>(mesh.edges.size()); ++e) {
      if (mesh.label[e] != traction.label) continue;
      add(gradient, mesh, e,
          share *
              by_ends(mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]], [&](const Vec2& a, const Vec2& b) {
                const MovedEdge edge = moved_edge(mesh, e, a, b);
                double sum = 0;
                for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
                  const Vec2 x = edge.at(rule.s[q]);
                  sum += edge.length * rule.w[q] * traction.value(x, edge.normal).dot(measured.value(x, edge.normal));
                }
                return sum;
              }));
    }
}

// Supported edges: the components in a frame that turns with the edge, and what is prescribed at the new place. The
// displacements of state and dual change by d(frame c), which meets their reactions r = moments of s n - loads.
void add_supports(const LoadedBody& body, const Parts& p, bool first, Points& gradient) {
  const Model& m = body.model;
  const Mesh& mesh = m.mesh;
  if (m.scene.supports.empty()) return;
  const EdgeRule rule = gauss(8);
  const Eigen::Index points = m.inner->kernel.trace.s.size();
  Eigen::MatrixXd basis(points, rule.s.size());  // times the rule's weights, over the trace's
  for (Eigen::Index q = 0; q < rule.s.size(); ++q)
    basis.col(q) = rule.w[q] * trace_basis(m.inner->kernel.trace, rule.s[q]).cwiseQuotient(m.inner->kernel.trace.w);
  const Eigen::VectorXd loads = traction_loads(mesh, m.inner->kernel, m.inner->skeleton, m.inner->data);
  const bool dual = first && p.dual;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    std::vector<const Support*> here;
    for (const Support& support : m.scene.supports)
      if (mesh.label[e] != none && mesh.label[e] == support.label) here.push_back(&support);
    if (here.empty()) continue;
    const Index t = mesh.sides[e][0] == none ? mesh.sides[e][1] : mesh.sides[e][0],
                unknown = edge_unknown(m.inner->skeleton, e);
    const Points reaction = moments(m, body.state, e, t) - on_edge(m, e, loads, unknown);
    Points of_state = body.energy * reaction;
    if (dual) {
      of_state -= moments(m, *p.dual, e, t);
      if (p.derivative->skeleton.size() > 0) of_state += on_edge(m, e, p.derivative->skeleton, unknown);
    }
    const auto components = [&](const Eigen::VectorXd& skeleton) -> Points {
      return Eigen::Map<const Points>(skeleton.data() + unknown, 2, points);
    };
    const Points c = components(body.state.skeleton), mu = dual ? components(p.dual->skeleton) : Points();
    add(gradient, mesh, e,
        by_ends(mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]], [&](const Vec2& a, const Vec2& b) {
          const MovedEdge edge = moved_edge(mesh, e, a, b);
          const Vec2& n = edge.normal;
          Mat2 frame = Mat2::Identity();
          Points moved = c;
          for (const Support* support : here) {
            frame = Mat2::Identity();
            if (support->normal_frame) frame << n, Vec2(-n.y(), n.x());
            Points value(2, rule.s.size());
            for (Eigen::Index q = 0; q < rule.s.size(); ++q) value.col(q) = support->value(edge.at(rule.s[q]), n);
            const Points moment = value * basis.transpose();
            if (support->first) moved.row(0) = moment.row(0);
            if (support->second) moved.row(1) = moment.row(1);
          }
          double sum = of_state.cwiseProduct(frame * moved).sum();
          if (dual) sum -= reaction.cwiseProduct(frame * mu).sum();
          // Work of the loads = -2 Pi + work of the reactions on what is prescribed, which is 0 until it moves.
          if (first && p.reaction_work != 0)
            sum += p.reaction_work * reaction.cwiseProduct(m.inner->skeleton.frame[e] * moved).sum();
          return sum;
        }));
  }
}

// Jumps keep their components along a normal and a tangent that turn with the edge, or that a curved crack has at the
// new place, and meet the forces on the right side of the crack.
void add_cracks(const LoadedBody& body, const Field* dual, Points& gradient) {
  const Model& m = body.model;
  const Mesh& mesh = m.mesh;
  for (std::size_t crack = 0; crack < mesh.cracks.size(); ++crack) {
    const CrackLaw& law = m.scene.laws[crack];
    if (law.kind == CrackLaw::Kind::Bonded) continue;
    for (const CrackEdge& c : mesh.cracks[crack]) {
      const Index e = c.edge, right = mesh.sides[e][1], unknown = m.inner->skeleton.jump[e];
      const int points = m.inner->skeleton.per_edge / 2;
      const Points force = moments(m, body.state, e, right);
      Points of_state = body.energy * force;
      if (dual) of_state -= moments(m, *dual, e, right);
      add(gradient, mesh, e,
          by_ends(mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]], [&](const Vec2& a, const Vec2& b) {
            const Vec2 along = (b - a).normalized(), chord(along.y(), -along.x());
            double sum = 0;
            for (int g = 0; g < points; ++g) {
              const Mat2 frame = frame_of(law, a + m.inner->kernel.trace.s[g] * (b - a), chord);
              const auto jump = [&](const Field& s) -> Vec2 { return frame * s.skeleton.segment<2>(unknown + 2 * g); };
              sum += of_state.col(g).dot(jump(body.state));
              if (dual) sum -= force.col(g).dot(jump(*dual));
            }
            return sum;
          }));
    }
  }
}

}  // namespace

// Sums per triangle and per edge are gathered onto the vertices; the order of the sums does not depend on threads.
Points shape_gradient(const Analysis& a, const Functional& j) {
  require_isotropic(a.model->scene, "shape derivatives");
  require_no_eigenstrain(a.model->scene);
  const Model& m = *a.model;
  require_straight(m, "a derivative by the shape");
  require(m.element, can_optimize);
  require_supports(j, m);
  Parts p = parts_of(a, j);
  // Loads that come out of balance are balanced by a body force (see prepare), which does no work on such a dual.
  Field balanced;
  if (p.dual && !m.inner->floating.empty()) p.dual = &(balanced = without_motions(m, *a.adjoint));
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const MovingDensity density(m, *a.state);
  const bool fields = p.dual || std::ranges::any_of(p.loaded, [](const LoadedBody& body) { return body.energy != 0; });
  const bool forces = m.inner->system.force.cols() > 0;
  Eigen::Matrix<double, 6, Eigen::Dynamic> part(6, triangles);
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Triangle shape = triangle(m, t);
      TriangleMotion motion;
      if (fields) add_lagrangian(p, t, shape, rule_points(m.inner->kernel.rule, shape), motion);
      if (forces) add_body_force(p, t, shape, motion);
      for (const Parts::Explicit& e : p.terms) density.add(*e.term, e.share, t, shape, motion);
      // theta = N_i e_k has the gradient e_k (x) grad N_i: column i of the product, and what theta itself adds.
      const Eigen::Matrix<double, 2, 3> by = motion.by_gradient * barycentric_gradients(shape) + motion.rest;
      part.col(t) = by.reshaped();
    }
  });
  Points gradient = Points::Zero(2, static_cast<Eigen::Index>(m.mesh.points.size()));
  for (Index t = 0; t < triangles; ++t)
    for (int i = 0; i < 3; ++i) gradient.col(m.mesh.triangles[t][i]) += part.col(t).segment<2>(2 * i);

  for (const LoadedBody& body : p.loaded) {
    const bool first = &body == &p.loaded.front();
    Eigen::VectorXd displacement = -body.energy * body.state.skeleton;
    if (first) displacement += p.work * body.state.skeleton;
    if (first && p.dual) displacement += p.dual->skeleton;
    add_tractions(body.model, displacement, gradient);
    add_pressures(body.model, displacement, gradient);
    add_supports(body, p, first, gradient);
    add_cracks(body, first ? p.dual : nullptr, gradient);
  }
  for (const Parts::Explicit& e : p.terms) add_surface_motion(*e.term, e.share, m, *a.state, gradient);
  for (const Term& term : j.terms)
    if (term.measured) add_measured_work(m, *term.measured, -a.measured_share, gradient);
  for (Eigen::Index v = 0; v < gradient.cols(); ++v)
    if (!gradient.col(v).allFinite()) {
      const Vec2& x = m.mesh.points[static_cast<std::size_t>(v)];
      throw Error(Fault::Numerics,
                  fmt::format("the derivative of the functional \"{}\" by the shape is not finite at ({:.6g}, {:.6g}): "
                              "loads, supports, targets and weights must be defined around the places where they act",
                              j.kind, x.x(), x.y()));
    }
  return gradient;
}

}  // namespace kerf
