// Fields, forces and energies inside a ball of the difference problem [theory: V.2, V.3, V.5]. A ball is cut into an
// annulus and a disc. What validation asks of them: the moments of the tractions sigma n that the disc exerts through
// the contour (the load q of the problem), 1/2 (A s, s) - (f, u) of the disc in the state and in its new content, the
// work of the body force, and the fields of the change from the values on contours. Compliances are floored at 1e-8/mu:
// the unknown is the change of the state, so that the error is relative to the change. Derived in
// docs/theory/validation.md, section "The difference problem".

#include "topo/validate/ball_fields.hpp"

#include <Eigen/QR>

#include <algorithm>

namespace kerf {

Material floored(Material m) {
  constexpr double least = 1e-8;
  m.c = std::max(m.c, least / m.mu);
  return m;
}
Scene floored(Scene scene) {
  scene.material = floored(scene.material);
  for (Material& m : scene.regions) m = floored(m);
  return scene;
}

Eigen::VectorXd on_edges(const Skeleton& s, const std::vector<Index>& edges, const Eigen::VectorXd& values) {
  Eigen::VectorXd x(static_cast<Eigen::Index>(edges.size()) * s.per_edge);
  for (std::size_t i = 0; i < edges.size(); ++i)
    x.segment(static_cast<Eigen::Index>(i) * s.per_edge, s.per_edge) =
        values.segment(edge_unknown(s, edges[i]), s.per_edge);
  return x;
}

// Less its projection on rigid motions: what strains anything.
Eigen::VectorXd strained(const Model& m, const std::vector<Index>& edges, const Eigen::VectorXd& values) {
  // Columns: two translations and the rotation about a vertex of the contour, in the frames of the edges.
  const Vec2 center = m.mesh.points[m.mesh.edges[edges[0]][0]];
  Eigen::MatrixXd rigid(values.size(), 3);
  Eigen::Index row = 0;
  for (const Index e : edges) {
    for (Eigen::Index g = 0; g < m.inner->kernel.trace.s.size(); ++g, row += 2) {
      const Vec2 d = on_edge(m.mesh, m.inner->skeleton.curvatures, e, m.inner->kernel.trace.s[g]).x - center;
      const Mat2 frame = frame_at(m.inner->skeleton, e, static_cast<int>(g)).transpose();
      rigid.block<2, 2>(row, 0) = frame;
      rigid.block<2, 1>(row, 2) = frame * Vec2(-d.y(), d.x());
    }
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rigid);
  return values - rigid * qr.solve(values);
}

// Moments of s n against the trace functions, s of the triangles inside.
Eigen::VectorXd forces_from(const Model& m, const Field& s, const std::vector<Index>& edges,
                            const std::vector<bool>& inside) {
  // normal_at includes |dx/ds|.
  const EdgeRule rule = gauss(8);
  const int per = m.inner->skeleton.per_edge;
  Eigen::VectorXd f = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(edges.size()) * per);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Index e = edges[i];
    const auto& [left, right] = m.mesh.sides[e];
    const Index t = left != none && inside[left] ? left : right;
    const Vec2 outward = (t == left ? 1 : -1) * normal(m.mesh, e);
    const Triangle shape = triangle(m, t);
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const OnEdge p = on_edge(m.mesh, m.inner->skeleton.curvatures, e, rule.s[q]);
      const Vec2 traction =
          rule.w[q] * tensor(stress_at(m.inner->kernel, shape, s.interior.col(t), p.x)) * normal_at(p, outward);
      const Eigen::VectorXd basis = trace_basis(m.inner->kernel.trace, rule.s[q]);
      for (Eigen::Index g = 0; g < basis.size(); ++g)
        f.segment<2>(static_cast<Eigen::Index>(i) * per + 2 * g) +=
            basis[g] * (frame_at(m.inner->skeleton, e, static_cast<int>(g)).transpose() * traction);
    }
  }
  return f;
}

// 1/2 (A s, s) - (f, u) of one triangle; displacements are moments against the force's.
double energy_of(const Model& m, const Eigen::MatrixXd& interior, Index t, const Material& material) {
  const Triangle shape = triangle(m, t);
  const TriangleRule& rule = stress_rule(m.inner->kernel, shape);
  const Points x = rule_points(rule, shape);
  const Eigen::VectorXd w = rule_weights(rule, shape);
  double sum = 0;
  for (Eigen::Index q = 0; q < x.cols(); ++q) {
    const Mat2 s = tensor(stress_at(m.inner->kernel, shape, interior.col(t), x.col(q)));
    sum += 0.5 * w[q] * s.cwiseProduct(strain(material, s)).sum();
  }
  if (m.inner->system.force.cols() > 0) {
    const int first = stress_count(m.element), count = displacement_count(m.element);
    sum -= m.inner->system.force.col(t).head(count).dot(interior.col(t).segment(first, count));
  }
  return area(shape) * sum;
}

InnerState inner_state(const CondensedPiece& inner, const Kernel& kernel, const Scene& scene,
                       const Eigen::VectorXd& contour, bool body) {
  // A model without a factor: nothing is solved with it.
  Model m{.mesh = inner.part.mesh,
          .element = kernel.element,
          .scene = scene,
          .inner = std::make_shared<Inner>(Inner{kernel,
                                                 inner.skeleton,
                                                 inner.ordering,
                                                 inner.system,
                                                 std::make_shared<const Factor>(LowerTriangle{}, 0),
                                                 {},
                                                 inner.data})};
  Field s;
  s.skeleton = complete(inner, contour, body);
  s.force.setZero(inner.skeleton.total);
  s.eigenstrain = inner.data.strain.empty() ? 0 : 1;
  s.interior.resize(interior_count(kernel.element), static_cast<Eigen::Index>(inner.part.triangle.size()));
  for (Index t = 0; t < static_cast<Index>(inner.part.triangle.size()); ++t)
    s.interior.col(t) = interior(kernel, triangle(m, t), material_of(m.mesh, m.scene, t), force_of(m.inner->system, t),
                                 trace_seen(m.mesh, m.inner->skeleton, s.skeleton, t));
  return {std::move(m), std::move(s)};
}

double energy_inside(const InnerState& inner) {
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(inner.state.interior.cols()); ++t)
    sum += energy_of(inner.model, inner.state.interior, t, material_of(inner.model.mesh, inner.model.scene, t));
  return sum;
}

double work_inside(const Model& m, const Field& s, Index t) {
  if (m.inner->system.force.cols() == 0) return 0;
  const int first = stress_count(m.element), count = displacement_count(m.element);
  return area(m.mesh, t) * m.inner->system.force.col(t).head(count).dot(s.interior.col(t).segment(first, count));
}

// The disc loses its work, the ring gains that of the change, and a new content does that of its own state.
double work_difference(const Model& m, const Field& s, const Field& change, const DiscAndRing& ball,
                       const InnerState* starred) {
  double d = 0;
  for (Index t = 0; t < static_cast<Index>(ball.disc.size()); ++t) {
    if (ball.disc[t]) d -= work_inside(m, s, t);
    if (ball.ring[t]) d += work_inside(m, change, t);
  }
  if (starred)
    for (Index t = 0; t < static_cast<Index>(starred->state.interior.cols()); ++t)
      d += work_inside(starred->model, starred->state, t);
  return d;
}

void add_fields(Field& s, const CondensedPiece& p, const Eigen::VectorXd& values, const Kernel& kernel,
                const Scene& scene) {
  for (Index t = 0; t < static_cast<Index>(p.part.triangle.size()); ++t)
    s.interior.col(p.part.triangle[static_cast<std::size_t>(t)]) =
        interior(kernel, triangle(p.part.mesh, p.skeleton, t), material_of(p.part.mesh, scene, t), {},
                 trace_seen(p.part.mesh, p.skeleton, values, t));
}

}  // namespace kerf
