// Rigid motions that the supports leave free, and what the loads do on them. A held component with direction d at the
// place x stops the motion (t, w) by the row (d, cross(x - c, d)/R); the motions that are left are eigenvectors of the
// sum of row'row with eigenvalue 0, c and R center and radius of the body. Loads must be in equilibrium on them; the
// state is then the one without mean motion, shares G^-1 int u . r_i with the Gram matrix G_ij = int r_i . r_j, all as
// the element's displacement sees the motions [theory: A.7]. docs/theory/adjoint.md, section Condensed.

#include "solver/system/rigid.hpp"

#include <fmt/core.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cmath>

namespace kerf {

namespace {

Vec2 edge_point(const Mesh& mesh, const Kernel& k, Index e, int g) {
  const Vec2& a = mesh.points[mesh.edges[e][0]];
  return a + k.trace.s[g] * (mesh.points[mesh.edges[e][1]] - a);
}

// The normal of a straight piece of an arc is right in its middle only: there rollers on a rim leave the rotation about
// its center free, at the Gauss points they seem to hold it. An edge is such a piece when the next edge with its label
// turns away by a little; a corner turns by more, a straight side not at all.
std::vector<bool> on_curves(const Mesh& mesh) {
  std::vector<std::array<Index, 2>> at(mesh.points.size(), {none, none});
  std::vector<bool> curved(mesh.edges.size(), false);
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    if (mesh.label[e] == none) continue;
    for (const Index v : mesh.edges[e]) at[v][at[v][0] == none ? 0 : 1] = e;
  }
  for (const auto& [a, b] : at) {
    if (a == none || b == none || mesh.label[a] != mesh.label[b]) continue;
    const Vec2 n = outward_normal(mesh, a), m = outward_normal(mesh, b);
    constexpr double straight = 1e-7, corner = 0.45;  // radians
    const double turn = std::abs(std::atan2(cross(n, m), n.dot(m)));
    if (turn > straight && turn < corner) curved[a] = curved[b] = true;
  }
  return curved;
}

}  // namespace

// A rotation w about c0 with translation t at c: r(x) = 0 at x = c + (-t_2, t_1)/w.
std::string describe(const RigidMotion& m) {
  // Tidy the numbers of the eigenvectors: -0 and 1e-17 do not help anybody.
  const auto tidy = [](double v, double scale) { return std::abs(v) < 1e-4 * scale ? 0.0 : v; };
  if (std::abs(m.rotation) < 1e-9 * m.translation.norm()) {
    const Vec2 d = m.translation.normalized();
    return fmt::format("a translation along ({:.4g}, {:.4g})", tidy(d.x(), 1), tidy(d.y(), 1));
  }
  const Vec2 c = m.center + Vec2(-m.translation.y(), m.translation.x()) / m.rotation;
  const double size = 1 / std::abs(m.rotation);  // the motions are normalized with the body's radius
  return fmt::format("a rotation about ({:.4g}, {:.4g})", tidy(c.x(), size), tidy(c.y(), size));
}

// Eigenvalues are squares of singular values: 1e-11 of the largest stands for 3e-6.
std::vector<RigidMotion> free_motions(const Mesh& mesh, const Kernel& k, const Skeleton& s,
                                      const std::vector<Index>& piece, Index which) {
  Vec2 low = Vec2::Constant(infinity), high = Vec2::Constant(-infinity);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (piece[t] == which)
      for (const Index v : mesh.triangles[t]) {
        low = low.cwiseMin(mesh.points[v]);
        high = high.cwiseMax(mesh.points[v]);
      }
  const Vec2 center = 0.5 * (low + high);
  const double radius = 0.5 * (high - low).norm();
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  const std::vector<bool> curved = on_curves(mesh);
  double tolerance = 1e-11;
  const auto hold = [&](const Vec2& at, const Vec2& direction) {
    const Vec2 x = (at - center) / radius;
    const Eigen::Vector3d row(direction.x(), direction.y(), cross(x, direction));
    gram += row * row.transpose();
  };
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    const Index t = mesh.sides[e][0] == none ? mesh.sides[e][1] : mesh.sides[e][0];
    if (mesh.label[e] == none || piece[t] != which) continue;
    for (int u = 0; u < s.per_edge; ++u) {
      if (!s.fixed[edge_unknown(s, e) + u]) continue;
      const bool roller = s.fixed[edge_unknown(s, e)] != s.fixed[edge_unknown(s, e) + 1];
      if (roller && curved[e]) tolerance = 1e-6;  // the vertices keep to the curve only nearly: areas are preserved
      const Vec2 middle = 0.5 * (mesh.points[mesh.edges[e][0]] + mesh.points[mesh.edges[e][1]]);
      hold(roller && curved[e] ? middle : edge_point(mesh, k, e, u / 2), s.frame[e].col(u % 2));
    }
  }
  if (!is_mixed(k.element))
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (int i = 0; i < 3 && piece[t] == which; ++i) {
        const Index corner = s.corners.of[t][i];
        for (int d = 0; d < 2; ++d)
          if (s.fixed[corner_unknown(s, corner) + d])
            hold(mesh.points[mesh.triangles[t][i]], s.corner_frame[corner].col(d).head<2>());
      }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spectrum(gram);
  const double largest = spectrum.eigenvalues()[2];
  std::vector<RigidMotion> motions;
  if (largest == 0) {
    motions.push_back({center, Vec2(1, 0), 0});
    motions.push_back({center, Vec2(0, 1), 0});
    motions.push_back({center, Vec2(0, 0), 1 / radius});
    return motions;
  }
  for (int i = 0; i < 3; ++i)
    if (spectrum.eigenvalues()[i] < tolerance * largest) {
      const Eigen::Vector3d v = spectrum.eigenvectors().col(i);
      motions.push_back({center, v.head<2>(), v[2] / radius});
    }
  return motions;
}

// Rotations at vertices have the sign of (N.1), opposite to the usual one.
Eigen::VectorXd trace(const Mesh& mesh, const Kernel& k, const Skeleton& s, const RigidMotion& motion) {
  Eigen::VectorXd value = Eigen::VectorXd::Zero(s.base);
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    for (int g = 0; g < s.per_edge / 2; ++g)
      value.segment<2>(edge_unknown(s, e) + 2 * g) =
          frame_at(s, e, g).transpose() * motion.at(on_edge(mesh, s.curvatures, e, k.trace.s[g]).x);
  for (Index c = 0; c < static_cast<Index>(s.corners.vertex.size()); ++c) {
    if (k.element.at_vertices == AtVertices::Rotation) value[corner_unknown(s, c)] = -motion.rotation;
    if (k.element.at_vertices == AtVertices::Displacement)
      value.segment<2>(corner_unknown(s, c)) =
          s.corner_frame[c].topLeftCorner<2, 2>().transpose() * motion.at(mesh.points[s.corners.vertex[c]]);
  }
  return value;
}

// The traction moments are those that act in the solve, so that what is called balanced here is balanced there.
Work work_on(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Loading& loading, const RigidMotion& motion,
             Index triangles) {
  const Eigen::VectorXd loads = traction_loads(mesh, k, s, loading.data);
  double work = 0, size = 0;
  const auto add = [&](double term) {
    work += term;
    size += std::abs(term);
  };
  const auto counts = [&](Index e) {
    const auto& [left, right] = mesh.sides[e];
    return (left != none && left < triangles) || (right != none && right < triangles);
  };
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    for (int g = 0; g < s.per_edge / 2 && counts(e); ++g) {
      const Vec2 load = loads.segment<2>(edge_unknown(s, e) + 2 * g);
      if (load.isZero(0)) continue;
      const Vec2 moved = frame_at(s, e, g).transpose() * motion.at(on_edge(mesh, s.curvatures, e, k.trace.s[g]).x);
      for (int c = 0; c < 2; ++c) add(load[c] * moved[c]);
    }
  if (s.per_vertex > 0) {
    const Eigen::VectorXd moved = trace(mesh, k, s, motion);
    for (Index u = edge_unknown(s, static_cast<Index>(mesh.edges.size())); u < s.base; ++u) add(loads[u] * moved[u]);
  }
  if (loading.scene.body)
    for (Index t = 0; t < triangles; ++t) {
      const Triangle shape = triangle(mesh, s, t);
      const Points x = rule_points(k.load, shape), force = body_force(loading.data, loading.scene, t, x);
      const Points seen = is_curved(shape) ? seen_points(k, shape, k.load) : x;
      const Eigen::VectorXd w = rule_weights(k.load, shape);
      for (Eigen::Index q = 0; q < x.cols(); ++q) {
        const double weight = area(shape) * w[q];
        const Vec2 moved = motion.at(seen.col(q));
        work += weight * force.col(q).dot(moved);
        size += weight * force.col(q).norm() * moved.norm();  // a radial force works on a rotation by rounding alone
      }
    }
  return {work, size};
}

// Gram-Schmidt with pivoting on the rows of the traces.
std::vector<Index> pins(const Mesh& mesh, const Kernel& k, const Skeleton& s, const std::vector<RigidMotion>& motions,
                        std::span<const Index> piece) {
  const Index n = static_cast<Index>(motions.size());
  Eigen::MatrixXd rows(s.base, n);
  for (Index i = 0; i < n; ++i) rows.col(i) = trace(mesh, k, s, motions[i]);
  // Displacements on the boundary only.
  std::vector<bool> usable(s.base, false);
  Index in = none;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    if (mesh.label[e] == none) continue;
    const Index of = piece.empty() ? 0 : piece[mesh.sides[e][0] == none ? mesh.sides[e][1] : mesh.sides[e][0]];
    if (in == none) in = of;
    for (int i = 0; i < s.per_edge; ++i) usable[edge_unknown(s, e) + i] = of == in;
  }
  if (!is_mixed(k.element) && piece.empty())
    for (Index c = 0; c < static_cast<Index>(s.corners.vertex.size()); ++c)
      usable[corner_unknown(s, c)] = usable[corner_unknown(s, c) + 1] = true;
  for (Index u = 0; u < s.base; ++u)
    if (s.fixed[u] || !usable[u]) rows.row(u).setZero();
  std::vector<Index> chosen;
  for (Index i = 0; i < n; ++i) {
    // The row farthest from the span of those chosen before; the first among equals.
    Eigen::Index best = 0;
    rows.rowwise().squaredNorm().maxCoeff(&best);
    chosen.push_back(static_cast<Index>(best));
    const Eigen::RowVectorXd direction = rows.row(best).normalized();
    rows -= (rows * direction.transpose()) * direction;
  }
  return chosen;
}

Points seen_points(const Kernel& k, const Triangle& t, const TriangleRule& rule) {
  if (is_curved(t)) return seen_places(k, t) * monomials(k.element.displacement, chord_points(rule, t));
  return k.element.displacement == 0 ? Points(centroid(t).replicate(1, rule.w.size())) : rule_points(rule, t);
}

// Over the first triangles, which are own ones in a part.
Eigen::MatrixXd gram_of(const Mesh& mesh, const Kernel& k, const Skeleton& s, const std::vector<RigidMotion>& motions,
                        Index triangles) {
  const auto n = static_cast<Eigen::Index>(motions.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  for (Index t = 0; t < triangles; ++t) {
    const Triangle shape = triangle(mesh, s, t);
    const TriangleRule& rule = stress_rule(k, shape);
    const Points seen = seen_points(k, shape, rule);
    const Eigen::VectorXd weight = rule_weights(rule, shape);
    for (Eigen::Index q = 0; q < seen.cols(); ++q) {
      const double w = area(shape) * weight[q];
      const Vec2 at = seen.col(q);
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) gram(i, j) += w * motions[i].at(at).dot(motions[j].at(at));
    }
  }
  return gram;
}

Eigen::VectorXd shares(const Mesh& mesh, const Kernel& k, const Skeleton& s, const std::vector<RigidMotion>& motions,
                       const Eigen::VectorXd& moments) {
  return gram_of(mesh, k, s, motions, static_cast<Index>(mesh.triangles.size())).llt().solve(moments);
}

}  // namespace kerf
