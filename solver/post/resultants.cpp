// Forces and moments about the origin: of tractions per label, of the body force, and of supports,
//   force = sum over held components d of (int sigma n . d - load) d,   moment = sum cross(x, force).
// In mixed elements the moments of sigma n with the trace functions act as forces at the Gauss points of the trace. In
// displacement elements the forces on nodes are K u - F summed over triangles, less the loads. Loads come from their
// data, by rules of the data's degree.

#include "solver/resultants.hpp"

#include "solver/element/local.hpp"

namespace kerf {

namespace {

Resultant& entry(std::vector<LabelResultant>& all, Index label) {
  for (LabelResultant& r : all)
    if (r.label == label) return r.of;
  all.push_back({label, {}});
  return all.back().of;
}

Index inside(const Mesh& mesh, Index e) {
  return mesh.sides[e][0] == none ? mesh.sides[e][1] : mesh.sides[e][0];
}

// Forces of the triangles and of the loads on the unknowns of a supported edge, along the directions that are held.
// Only directions that are held count: along the others the loads and the stress balance by themselves.
class Holding {
 public:
  Holding(const Model& m, const Field& s)
      : m_(m), s_(s), loads_(traction_loads(m.mesh, m.inner->kernel, m.inner->skeleton, m.inner->data)) {}

  // Mixed: moments of the normal stress with the trace functions, as forces at the Gauss points.
  // Moments with the trace functions, one per Gauss point, on a curved edge with the normal times |dx/ds|.
  void add_mixed(Index e, Resultant& r) const {
    const Kernel& k = m_.inner->kernel;
    const Skeleton& skeleton = m_.inner->skeleton;
    const Index t = inside(m_.mesh, e);
    const EdgeLine line = edge_line(m_.mesh, e);
    const Triangle shape = triangle(m_, t);
    const double l = length(m_.mesh, e);
    for (int g = 0; g < skeleton.per_edge / 2; ++g) {
      Vec2 force = Vec2::Zero();
      for (Eigen::Index q = 0; q < k.edge.s.size(); ++q) {
        const OnEdge p = on_edge(m_.mesh, skeleton.curvatures, e, k.edge.s[q]);
        const Vec2 n = normal_at(p, line.n) / l;  // times the length of the curve over that of the chord
        const Vec2 traction = tensor(stress_at(k, shape, s_.interior.col(t), p.x)) * n;
        force += l * k.edge.w[q] * k.trace_at_edge(g, q) * traction;
      }
      const Vec2 at = on_edge(m_.mesh, skeleton.curvatures, e, k.trace.s[g]).x;
      for (int d = 0; d < 2; ++d) {
        const Index unknown = edge_unknown(skeleton, e) + 2 * g + d;
        if (!skeleton.fixed[unknown]) continue;
        const Vec2 direction = frame_at(skeleton, e, g).col(d);
        r.add(at, (direction.dot(force) - loads_[unknown]) * direction);
      }
    }
  }

  // Displacement elements: forces on all unknowns, from every triangle.
  // What the triangles pull at a node, less its loads: at a free node it is 0 up to the residual of the solution.
  Eigen::VectorXd nodal_forces() const {
    Eigen::VectorXd force = -loads_;
    for (Index t = 0; t < static_cast<Index>(m_.mesh.triangles.size()); ++t) {
      const Condensed c =
          condense(m_.inner->kernel, triangle(m_, t), material_of(m_.mesh, m_.scene, t), force_of(m_.inner->system, t));
      const SkeletonVector own = c.K * trace_seen(m_.mesh, m_.inner->skeleton, s_.skeleton, t) - c.F;
      const Seen view = seen(m_.mesh, m_.inner->skeleton, t);
      for (int i = 0; i < view.count; ++i) force[view.base[i]] += own[i];
    }
    return force;
  }

 private:
  const Model& m_;
  const Field& s_;
  Eigen::VectorXd loads_;
};

// Adds the force on a node along its directions that are held.
void add_node(const Skeleton& s, const Eigen::VectorXd& force, Index unknown, const Mat2& frame, const Vec2& at,
              Resultant& r) {
  for (int d = 0; d < 2; ++d)
    if (s.fixed[unknown + d]) r.add(at, force[unknown + d] * frame.col(d));
}

/// A node at a corner belongs to several edges and is counted for the first of them.
void add_nodes(const Model& m, const Field& state, std::vector<LabelResultant>& all) {
  const Skeleton& s = m.inner->skeleton;
  const Eigen::VectorXd force = Holding(m, state).nodal_forces();
  std::vector<bool> counted(s.corners.vertex.size(), false);
  for (const LoadedEdges& support : m.inner->data.supports)
    for (const Index e : labeled(m.inner->data, support.label)) {
      Resultant& r = entry(all, support.label);
      const EdgeLine line = edge_line(m.mesh, e);
      if (s.per_edge > 0) add_node(s, force, edge_unknown(s, e), s.frame[e], 0.5 * (line.a + line.b), r);
      const Index t = inside(m.mesh, e);
      for (int i = 0; i < 3; ++i) {
        const Index corner = s.corners.of[t][i], vertex = m.mesh.triangles[t][i];
        if ((vertex != m.mesh.edges[e][0] && vertex != m.mesh.edges[e][1]) || counted[corner]) continue;
        counted[corner] = true;
        add_node(s, force, corner_unknown(s, corner), s.corner_frame[corner].topLeftCorner<2, 2>(),
                 m.mesh.points[vertex], r);
      }
    }
}

}  // namespace

/// Values are those at the Gauss points of the data; on a curved edge per length of its chord.
std::vector<LabelResultant> traction_resultants(const Mesh& mesh, const EdgeCurvatures& curvatures, const Scene& scene,
                                                const SceneData& data) {
  const EdgeRule rule = gauss(data_points);
  std::vector<LabelResultant> all;
  for (std::size_t i = 0; i < data.tractions.size(); ++i) {
    Resultant& r = entry(all, scene.tractions[i].label);
    for (std::size_t j = 0; j < data.tractions[i].values.size(); ++j) {
      const Index e = labeled(data, data.tractions[i].label)[j];
      const double l = length(mesh, e);
      for (int q = 0; q < data_points; ++q)
        r.add(on_edge(mesh, curvatures, e, rule.s[q]).x, l * rule.w[q] * data.tractions[i].values[j].at.col(q));
    }
  }
  return all;
}

Resultant body_resultant(const Mesh& mesh, const EdgeCurvatures& curvatures, const Scene& scene, const SceneData& data,
                         const TriangleRule& rule) {
  Resultant r;
  if (!scene.body) return r;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const Triangle cell = cell_of(mesh, curvatures, t);
    const Points x = rule_points(rule, cell), force = body_force(data, scene, t, x);
    const Eigen::VectorXd w = rule_weights(rule, cell);
    for (Eigen::Index q = 0; q < x.cols(); ++q) r.add(x.col(q), area(cell) * w[q] * force.col(q));
  }
  return r;
}

/// Each edge counts once, to the first support that names it, and on the process that owns the triangle beside it.
std::vector<LabelResultant> reactions(const Model& m, const Field& s) {
  std::vector<LabelResultant> all;
  if (!is_mixed(m.element)) {
    add_nodes(m, s, all);
    return all;
  }
  const Holding holding(m, s);
  std::vector<bool> counted(m.mesh.edges.size(), false);
  for (const LoadedEdges& support : m.inner->data.supports)
    for (const Index e : labeled(m.inner->data, support.label)) {
      Resultant& r = entry(all, support.label);
      if (counted[e] || inside(m.mesh, e) >= own_triangles(m)) continue;
      counted[e] = true;
      holding.add_mixed(e, r);
    }
  return all;
}

}  // namespace kerf
