#include "solver/skeleton.hpp"

#include <fmt/core.h>

namespace kerf {

namespace {

constexpr int data_points = 8;  // Gauss points per edge for boundary data

// The unit normal that points out of the body on a boundary edge.
Vec2 outward(const Mesh& mesh, Index e) {
  const Vec2 n = normal(mesh, e);
  return mesh.sides[e][1] == none ? n : Vec2(-n);
}

Mat2 edge_frame(const Mesh& mesh, Index e) {
  Mat2 f;
  f << normal(mesh, e), tangent(mesh, e);
  return f;
}

void check_finite(const Vec2& value, const Vec2& x, const char* what) {
  if (!value.allFinite())
    throw Error(Fault::Numerics, fmt::format("the {} is not finite at ({:.6g}, {:.6g})", what, x.x(), x.y()));
}

}  // namespace

Eigen::VectorXd trace_basis(const EdgeRule& trace, double s) {
  const Eigen::Index n = trace.s.size();
  Eigen::VectorXd value = Eigen::VectorXd::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      if (j != i) value[i] *= (s - trace.s[j]) / (trace.s[i] - trace.s[j]);
  return value;
}

Skeleton number(const Mesh& mesh, const Kernel& k, const Scene& scene) {
  Skeleton s;
  s.per_edge = per_edge(k.element);
  const Index edges = static_cast<Index>(mesh.edges.size());
  s.base = edges * s.per_edge;
  s.frame.resize(edges);
  s.jump.assign(edges, none);
  s.total = s.base;
  for (Index e = 0; e < edges; ++e) {
    s.frame[e] = edge_frame(mesh, e);
    if (mesh.crack[e] != none) {
      s.jump[e] = s.total;
      s.total += s.per_edge;
    }
  }
  s.prescribed.assign(s.total, 0);
  s.fixed.assign(s.total, false);
  s.bounded.assign(s.total, false);

  const int points = points_per_edge(k.element);
  for (Index e = 0; e < edges; ++e) {
    if (mesh.crack[e] == none) continue;
    const auto kind = scene.laws[mesh.crack[e]].kind;
    for (int g = 0; g < points; ++g)
      for (int d = 0; d < 2; ++d) {
        const Index unknown = s.jump[e] + 2 * g + d;
        s.fixed[unknown] = kind == CrackLaw::Kind::Bonded;
        s.bounded[unknown] = kind == CrackLaw::Kind::Unilateral && d == 0;
      }
  }

  const EdgeRule rule = gauss(data_points);
  for (const Support& support : scene.supports)
    for (Index e = 0; e < edges; ++e) {
      if (mesh.label[e] != support.label) continue;
      const Vec2& a = mesh.points[mesh.edges[e][0]];
      const Vec2& b = mesh.points[mesh.edges[e][1]];
      const Vec2 n = outward(mesh, e);
      s.frame[e] = Mat2::Identity();
      if (support.normal_frame) s.frame[e] << n, Vec2(-n.y(), n.x());
      for (int g = 0; g < points; ++g) {
        // The basis is orthogonal: its mass on the edge is diag(w).
        Vec2 moment = Vec2::Zero();
        for (int q = 0; q < data_points; ++q) {
          const Vec2 x = a + rule.s[q] * (b - a);
          const Vec2 value = support.value(x, n);
          check_finite(value, x, "prescribed displacement");
          moment += rule.w[q] * trace_basis(k.trace, rule.s[q])[g] / k.trace.w[g] * value;
        }
        for (int d = 0; d < 2; ++d)
          if (d == 0 ? support.first : support.second) {
            const Index unknown = e * s.per_edge + 2 * g + d;
            s.fixed[unknown] = true;
            s.prescribed[unknown] = moment[d];
          }
      }
    }
  return s;
}

Triangle triangle(const Mesh& mesh, const Skeleton& s, Index t) {
  Triangle result;
  for (int i = 0; i < 3; ++i) {
    const Index e = mesh.edges_of[t][i];
    result.x[i] = mesh.points[mesh.triangles[t][i]];
    result.frame[i] = s.frame[e];
    result.forward[i] = mesh.sides[e][0] == t;
  }
  return result;
}

Seen seen(const Mesh& mesh, const Skeleton& s, Index t) {
  Seen result;
  for (int i = 0; i < 3; ++i) {
    const Index e = mesh.edges_of[t][i];
    const bool right = s.jump[e] != none && mesh.sides[e][1] == t;
    for (int k = 0; k < s.per_edge; ++k) {
      result.base[result.count] = e * s.per_edge + k;
      result.jump[result.count++] = right ? s.jump[e] + k : none;
    }
  }
  return result;
}

Eigen::VectorXd traction_loads(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Scene& scene) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(s.total);
  const EdgeRule rule = gauss(data_points);
  for (const Traction& traction : scene.tractions)
    for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
      if (mesh.label[e] != traction.label) continue;
      const Vec2& a = mesh.points[mesh.edges[e][0]];
      const Vec2& b = mesh.points[mesh.edges[e][1]];
      const Vec2 n = outward(mesh, e);
      const double l = length(mesh, e);
      for (int q = 0; q < data_points; ++q) {
        const Vec2 x = a + rule.s[q] * (b - a);
        const Vec2 value = traction.value(x, n);
        check_finite(value, x, "traction");
        const Vec2 component = s.frame[e].transpose() * value;
        const Eigen::VectorXd basis = trace_basis(k.trace, rule.s[q]);
        for (int g = 0; g < basis.size(); ++g)
          for (int d = 0; d < 2; ++d) load[e * s.per_edge + 2 * g + d] += l * rule.w[q] * basis[g] * component[d];
      }
    }
  return load;
}

}  // namespace kerf
