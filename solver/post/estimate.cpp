#include "kerf/adaptive.hpp"
#include "solver/recovery.hpp"

#include "solver/post/calibrate.hpp"
#include "solver/system.hpp"

#include "kerf/recover.hpp"
#include "solver/parallel.hpp"
#include "solver/polynomial.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

#include <cmath>

namespace kerf {

namespace {

constexpr int edge_points = 5;  // exact for the square of a stress of degree 4

// D tau at the Gauss points of the three edges, in each edge's own direction.
using EdgeTraces = Eigen::Matrix<double, 2, 3 * edge_points>;

struct Interior {
  double square = 0;  // the part of eta^2 that the triangle has by itself
  double stress = 0;  // |s|^2
};

// Derivatives of a polynomial known at the quadrature points, by interpolation in (l1, l2).
struct Derivatives {
  Eigen::MatrixXd along[2];  // values at the points -> values of d/dl1, d/dl2 there
};

Derivatives derivatives(const TriangleRule& rule, int degree) {
  const Eigen::MatrixXd v = monomials(degree, rule.x).transpose();
  const Eigen::MatrixXd fit = v.completeOrthogonalDecomposition().pseudoInverse();
  Derivatives d;
  for (int axis = 0; axis < 2; ++axis) d.along[axis] = v * derivative(degree, axis) * fit;
  return d;
}

Interior interior_part(const Model& m, const Field& s, Index t, const Derivatives& d) {
  const Triangle shape = triangle(m, t);
  const TriangleRule& rule = m.inner->kernel.rule;
  const Points x = rule_points(rule, shape);
  const Fields f = evaluate(m.inner->kernel, shape, s.interior.col(t), x);
  const Material& material = material_of(m.mesh, m.scene, t);
  const double mu = material.mu;
  double h = 0;
  for (int i = 0; i < 3; ++i) h = std::max(h, (shape.x[(i + 1) % 3] - shape.x[i]).norm());

  Mat2 jacobian;
  jacobian << shape.x[1] - shape.x[0], shape.x[2] - shape.x[0];
  const Mat2 inverse = jacobian.inverse();  // d/dx = sum_k inverse(k, x) d/dl_k
  const Eigen::Index n = x.cols();
  Eigen::MatrixX4d gradient(n, 4), stress = f.stress.transpose();
  for (Eigen::Index q = 0; q < n; ++q)
    gradient.row(q) = displacement_gradient(material, f.stress.col(q), f.rotation[q]).transpose();
  const auto derive = [&](const auto& column, int axis) -> Eigen::VectorXd {
    return inverse(0, axis) * (d.along[0] * column) + inverse(1, axis) * (d.along[1] * column);
  };
  Interior result;
  for (int row = 0; row < 2; ++row) {
    const Eigen::VectorXd curl = derive(gradient.col(2 * row + 1), 0) - derive(gradient.col(2 * row), 1);
    result.square += 4 * mu * mu * h * h * rule.w.dot(curl.cwiseAbs2());
    if (m.scene.body) {
      Eigen::VectorXd rest = derive(stress.col(2 * row), 0) + derive(stress.col(2 * row + 1), 1);
      for (Eigen::Index q = 0; q < n; ++q) rest[q] += m.scene.body(x.col(q))[row];
      result.square += h * h * rule.w.dot(rest.cwiseAbs2());
    }
  }
  result.square += rule.w.dot((stress.col(1) - stress.col(2)).cwiseAbs2());
  for (int c = 0; c < 4; ++c) result.stress += rule.w.dot(stress.col(c).cwiseAbs2());
  result.square *= area(shape);
  result.stress *= area(shape);
  return result;
}

EdgeTraces edge_traces(const Model& m, const Field& s, Index t, const EdgeRule& rule) {
  const Triangle shape = triangle(m, t);
  Points x(2, 3 * edge_points);
  std::array<Vec2, 3> tau;
  for (int e = 0; e < 3; ++e) {
    const Index edge = m.mesh.edges_of[t][e];
    const Vec2& a = m.mesh.points[m.mesh.edges[edge][0]];
    const Vec2 side = m.mesh.points[m.mesh.edges[edge][1]] - a;
    tau[e] = side.normalized();
    for (int g = 0; g < edge_points; ++g) x.col(edge_points * e + g) = a + rule.s[g] * side;
  }
  const Fields f = evaluate(m.inner->kernel, shape, s.interior.col(t), x);
  EdgeTraces traces;
  for (int i = 0; i < 3 * edge_points; ++i) {
    const Eigen::Vector4d d = displacement_gradient(material_of(m.mesh, m.scene, t), f.stress.col(i), f.rotation[i]);
    const Vec2& direction = tau[i / edge_points];
    traces.col(i) << d.head<2>().dot(direction), d.tail<2>().dot(direction);
  }
  return traces;
}

// What supports prescribe on a boundary edge at parameter s, in the edge's frame: which components, and d_tau u_D by
// central differences of the data.
struct Prescribed {
  std::array<bool, 2> component{false, false};
  Vec2 slope = Vec2::Zero();
};

Prescribed prescribed(const Model& m, Index e, double s) {
  const Vec2& a = m.mesh.points[m.mesh.edges[e][0]];
  const Vec2 side = m.mesh.points[m.mesh.edges[e][1]] - a;
  const Vec2 n = outward_normal(m.mesh, e);
  constexpr double step = 1e-3;
  Prescribed p;
  for (const Support& support : m.scene.supports) {
    if (support.label != m.mesh.label[e]) continue;
    const Vec2 after = support.value(a + (s + step) * side, n), before = support.value(a + (s - step) * side, n);
    for (int d = 0; d < 2; ++d)
      if (d == 0 ? support.first : support.second) {
        p.component[d] = true;
        p.slope[d] = (after[d] - before[d]) / (2 * step * side.norm());
      }
  }
  return p;
}

// d/dtau of the discrete jump of a crack edge in its frame: where a part of it is open, D tau jumps by as much.
Vec2 jump_slope(const Model& m, const Field& s, Index e, double at) {
  constexpr double step = 1e-4;  // central differences: exact to 1e-8 for the cubic functions of a trace
  const Eigen::VectorXd slope =
      (trace_basis(m.inner->kernel.trace, at + step) - trace_basis(m.inner->kernel.trace, at - step)) /
      (2 * step * length(m.mesh, e));
  Vec2 sum = Vec2::Zero();
  for (Eigen::Index g = 0; g < slope.size(); ++g)
    sum += slope[g] * s.skeleton.segment<2>(m.inner->skeleton.jump[e] + 2 * g);
  return sum;
}

// Where the faces of a crack touch, and where they do not slide either.
struct Faces {
  bool touch = false, stick = false;
};
Faces faces(const Model& m, const Field& s, Index e) {
  const Skeleton& skeleton = m.inner->skeleton;
  Faces f;
  if (skeleton.jump[e] == none) return f;
  for (int k = 0; k < skeleton.per_edge; k += 2) {
    const Index normal = skeleton.jump[e] + k, tangential = normal + 1;
    const bool bonded = skeleton.fixed[normal], touching = bonded || s.force[normal] > 0;
    f.touch = f.touch || touching;
    f.stick = f.stick || (touching && (bonded || (skeleton.frictional[tangential] && s.skeleton[tangential] == 0)));
  }
  return f;
}

// What D tau lacks on the edges of the triangles.
struct EdgeResiduals {
  const Model& m;
  const Field& s;
  const EdgeRule& rule;
  const std::vector<EdgeTraces>& traces;

  // Across edge i of triangle t to `other`, at the Gauss point g; on a crack in its frame.
  Vec2 across(Index t, int i, Index other, int g) const {
    const Index e = m.mesh.edges_of[t][i];
    int j = 0;
    while (m.mesh.edges_of[other][j] != e) ++j;
    Vec2 jump = traces[t].col(edge_points * i + g);
    jump -= traces[other].col(edge_points * j + g);
    if (m.inner->skeleton.jump[e] == none) return jump;
    const double sign = m.mesh.sides[e][0] == t ? 1 : -1;  // the jump is right minus left
    return m.inner->skeleton.frame[e].transpose() * jump + sign * jump_slope(m, s, e, rule.s[g]);
  }

  // On the boundary, in the edge's frame.
  Vec2 on_boundary(Index t, int i, int g) const {
    const Index e = m.mesh.edges_of[t][i];
    const Prescribed given = prescribed(m, e, rule.s[g]);
    const Vec2 trace = traces[t].col(edge_points * i + g);
    Vec2 jump = m.inner->skeleton.frame[e].transpose() * trace - given.slope;
    for (int d = 0; d < 2; ++d)
      if (!given.component[d]) jump[d] = 0;
    return jump;
  }

  // Adds to `square` what edge i of triangle t has: |e| times an integral over it.
  void add(Index t, int i, double& square) const {
    const Index e = m.mesh.edges_of[t][i];
    const Index other = m.mesh.sides[e][0] == t ? m.mesh.sides[e][1] : m.mesh.sides[e][0];
    // Between two materials most of the jump is the strain error of the softer one.
    const double mu = material_of(m.mesh, m.scene, t).mu,
                 softer = other == none ? mu : std::min(mu, material_of(m.mesh, m.scene, other).mu);
    const double l = length(m.mesh, e), scale = 4 * std::pow(softer * l, 2), weight = other == none ? 1 : 0.5;
    const Faces contact = faces(m, s, e);
    for (int g = 0; g < edge_points; ++g) {
      Vec2 jump = other == none ? on_boundary(t, i, g) : across(t, i, other, g);
      if (other != none && m.inner->skeleton.jump[e] != none) {
        if (!contact.touch) jump[0] = 0;
        if (!contact.stick) jump[1] = 0;
      }
      square += weight * scale * rule.w[g] * jump.squaredNorm();
    }
  }
};

}  // namespace

Indicator error_indicator(const Model& m, const State& s) {
  if (!can_estimate_error(m.element))  // their gradients are compatible, what they lack is equilibrium
    return {Eigen::VectorXd::Zero(static_cast<Eigen::Index>(m.mesh.triangles.size())), nan};
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const Derivatives difference =
      derivatives(m.inner->kernel.rule, std::max(stress_degree(m.element), m.element.rotation));
  const EdgeRule rule = gauss(edge_points);
  std::vector<Interior> own(triangles);
  std::vector<EdgeTraces> traces(triangles);
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      own[t] = interior_part(m, s, t, difference);
      traces[t] = edge_traces(m, s, t, rule);
    }
  });
  const EdgeResiduals edges{m, s, rule, traces};
  Indicator result{Eigen::VectorXd(triangles), 0};
  double total = 0, stress = 0;
  for (Index t = 0; t < triangles; ++t) {
    double square = own[t].square;
    for (int i = 0; i < 3; ++i) edges.add(t, i, square);
    result.eta[t] = std::sqrt(square);
    total += square;
    stress += own[t].stress;
  }
  if (stress > 0) result.relative = std::sqrt(total / stress) / efficiency(m, s, result.eta);
  return result;
}

}  // namespace kerf
