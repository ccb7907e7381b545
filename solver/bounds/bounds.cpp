#include "kerf/bounds.hpp"

#include "solver/anisotropic.hpp"
#include "solver/system.hpp"

#include "solver/bounds/admissible.hpp"
#include "solver/bounds/curved.hpp"
#include "solver/bounds/faces.hpp"
#include "solver/bounds/right_inverse.hpp"
#include "solver/bounds/statics.hpp"
#include "solver/parallel.hpp"

#include <fmt/core.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace kerf {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr int strain_degree = 4;  // of the polynomials of eigenstrains that have a rest

// What A s : s has beyond that of the isotropic part.
double orthotropic_work(const Material& m, double s11, double s22, double s12) {
  const Eigen::Vector3d e = orthotropic_strain(m, s11, s22, s12);
  return e[0] * s11 + e[1] * s22 + 2 * e[2] * s12;
}

// |grad w - its mean rotation| <= K |eps(w)| on a triangle, K^2 = 1 + 2/beta^2 with a lower bound of the inf-sup
// constant beta of a body that sees the disk of radius r and lies in the one of radius R [Costabel, Dauge 2015]: the
// rotation has grad omega = div of a tensor as large as eps(w).
double local_korn(const Triangle& t) {
  double perimeter = 0;
  Vec2 center = Vec2::Zero();
  for (int i = 0; i < 3; ++i) {
    const double side = (t.x[(i + 2) % 3] - t.x[(i + 1) % 3]).norm();
    perimeter += side;
    center += side * t.x[i];
  }
  center /= perimeter;
  double outer = 0;
  for (const Vec2& x : t.x) outer = std::max(outer, (x - center).norm());
  const double ratio = std::pow(2 * area(t) / perimeter / outer, 2);
  const double beta_squared = ratio / (2 * (1 + std::sqrt(1 - ratio)));
  return std::sqrt(1 + 2 / beta_squared);
}

// Everything that does not depend on the triangle. Stresses, divergences and forces are polynomials of degree n by
// their values on lattice(n), displacements of degree n + 1 by theirs on lattice(n + 1).
struct Reference {
  int n;
  TriangleRule rule;
  Points nodes, field_nodes;
  Eigen::MatrixXd at_rule, field_at_rule;                                  // values
  std::array<Eigen::MatrixXd, 2> slope, field_slope, field_slope_at_rule;  // derivatives
  Eigen::MatrixXd raise;                                                   // conforming displacement -> lattice(n + 1)
  Eigen::MatrixXd force, mean_force;                                       // body force, what the element sees of it
  RightInverse inverse;
  Eigen::MatrixXd normal_free;
  Eigen::MatrixXd to_strains, of_strains;                 // from the rule to lattice(strain_degree), and back
  std::array<std::array<Eigen::MatrixXd, 2>, 3> at_edge;  // values at the Gauss points, edges backward and forward
  std::shared_ptr<const CurvedReference> curved;          // where there are curved triangles
};

Reference reference(const Element& e, int n, const Forces& f) {
  Reference r;
  r.n = n;
  r.rule = split_rule(2 * n);
  r.nodes = lattice(n);
  r.field_nodes = lattice(n + 1);
  r.at_rule = interpolation(n, r.rule.x);
  r.field_at_rule = interpolation(n + 1, r.rule.x);
  r.slope = differentiation(n, r.nodes);
  r.field_slope = differentiation(n + 1, r.nodes);
  r.field_slope_at_rule = differentiation(n + 1, r.rule.x);
  r.raise = interpolation(e.trace + 1, r.field_nodes);
  r.force = interpolation(f.degree, r.nodes);
  const TriangleRule exact = triangle_rule(f.degree + e.displacement);
  r.mean_force =
      interpolation(e.displacement, r.nodes) * projection(e.displacement, exact) * interpolation(f.degree, exact.x);
  r.inverse = right_inverse(n, r.rule);
  r.normal_free = normal_free_right_inverse(n);
  if (n >= strain_degree) {
    r.to_strains = projection(strain_degree, r.rule);
    r.of_strains = interpolation(strain_degree, r.rule.x);
  }
  const EdgeRule trace = gauss(points_per_edge(e));
  for (int side = 0; side < 3; ++side)
    for (int forward = 0; forward < 2; ++forward) {
      Eigen::Matrix3Xd l = Eigen::Matrix3Xd::Zero(3, trace.s.size());
      l.row((side + (forward ? 1 : 2)) % 3) = (1 - trace.s.array()).matrix().transpose();
      l.row((side + (forward ? 2 : 1)) % 3) = trace.s.transpose();
      r.at_edge[side][forward] = interpolation(n, l.bottomRows<2>());
    }
  return r;
}

struct Bounding {
  const Model& m;
  const Field& s;
  const Forces& f;
  const std::vector<EdgeData>& data;
  const Conforming& conforming;
  const Eigen::MatrixXd& statics;
  bool keep = false;  // the fields
  EdgeRule carrier = gauss(data_carriers);

  /// The coordinate (1 + l_b - l_a)/2 along a boundary edge and l_a l_b, at a point (l1, l2).
  struct Along {
    double s, bump;
  };
  Along along(const EdgeData& d, const Vec2& l) const {
    const std::array<double, 3> full{1 - l.x() - l.y(), l.x(), l.y()};
    const bool forward = m.mesh.sides[d.edge][0] == d.triangle;
    const double from = full[(d.side + (forward ? 1 : 2)) % 3], to = full[(d.side + (forward ? 2 : 1)) % 3];
    return {0.5 * (1 + to - from), from * to};
  }

  /// Symmetric stress in equilibrium: its complementary energy and the work of the supports.
  void lower(const Reference& r, Index t, const std::vector<Index>& edges, Share& share) const {
    const Triangle cell = triangle(m, t), shape = chords_of(cell);
    const Mat2 J = jacobian(shape.x), inverse = J.inverse();
    const double det = J.determinant();
    const Points x = nodes(r, shape);
    Eigen::Matrix4Xd stress = evaluate(m.inner->kernel, shape, statics.col(t), x).stress;
    if (f.couple.size() > 0) {
      const Mat2 c = antisymmetric(f.couple[t]);
      stress.colwise() += Eigen::Vector4d(c(0, 0), c(0, 1), c(1, 0), c(1, 1));
    }
    share.tractions = tractions(r, shape, stress);
    work_of_supports(share.tractions, edges, share);

    add_loads_unseen(r, t, edges, stress);
    if (is_curved(cell)) {
      add_complementary_energy(*r.curved, cell, material_of(m.mesh, m.scene, t), stress, share);
      return;
    }

    const Eigen::VectorXd asymmetry = (stress.row(1) - stress.row(2)).transpose();
    const Eigen::VectorXd q = r.inverse.derivative * (det * asymmetry);
    const Eigen::Matrix4Xd at = stress * r.at_rule.transpose();
    const Material& material = material_of(m.mesh, m.scene, t);
    const double mu = material.mu, c = material.c;
    const Eigen::Matrix4Xd free = eigenstrain(r, t);
    double energy = 0, freed = 0;
    Eigen::Matrix4Xd whole(4, at.cols());
    for (Eigen::Index i = 0; i < at.cols(); ++i) {
      const Mat2 gradient =
          J * (Mat2() << q[4 * i], q[4 * i + 1], q[4 * i + 2], q[4 * i + 3]).finished() * inverse / det;
      const double s11 = at(0, i) + gradient(0, 1), s12 = at(1, i) - gradient(0, 0), s21 = at(2, i) + gradient(1, 1),
                   s22 = at(3, i) - gradient(1, 0), trace = s11 + s22, difference = s11 - s22;
      whole.col(i) << s11, s12, s21, s22;
      energy += r.rule.w[i] * ((0.5 * difference * difference + s12 * s12 + s21 * s21) / (2 * mu) + c * trace * trace);
      if (!isotropic(material)) energy += r.rule.w[i] * orthotropic_work(material, s11, s22, 0.5 * (s12 + s21));
      if (free.cols() > 0) freed += r.rule.w[i] * free.col(i).dot(whole.col(i));
      share.asymmetry = std::max(share.asymmetry, std::abs(s12 - s21));
      share.stress = std::max({share.stress, std::abs(s11), std::abs(s12), std::abs(s22)});
    }
    energy *= 0.5 * area(shape);
    freed *= area(shape);
    share.lower -= energy + freed;
    share.size += energy + std::abs(freed);
    if ((free.cols() > 0 || keep) && r.n >= strain_degree) share.square = beyond_strains(r, whole);
    if (free.cols() > 0) {
      const StrainData& strain = m.inner->data.strain;
      share.below = area(shape) * (std::sqrt(strain.rest[t] * share.square) + strain.error[t] * share.stress);
    }
    if (keep) share.kept_stress = std::move(whole);
  }

  /// The mean of |p - its projection|^2: the rest of an eigenstrain, also of the other state of a pair, works on no
  /// polynomial of its degree.
  static double beyond_strains(const Reference& r, const Eigen::Matrix4Xd& stress) {
    const Eigen::Matrix4Xd rest = stress - stress * r.to_strains.transpose() * r.of_strains.transpose();
    return rest.colwise().squaredNorm().dot(r.rule.w);
  }

  Points nodes(const Reference& r, const Triangle& shape) const {
    Points x(2, r.nodes.cols());
    for (Eigen::Index q = 0; q < x.cols(); ++q)
      x.col(q) = shape.x[0] + r.nodes(0, q) * (shape.x[1] - shape.x[0]) + r.nodes(1, q) * (shape.x[2] - shape.x[0]);
    return x;
  }

  /// Rows with the rest of the tractions as normal trace and the rest of the body force as divergence.
  void add_loads_unseen(const Reference& r, Index t, const std::vector<Index>& edges, Eigen::Matrix4Xd& stress) const {
    const Triangle shape = triangle(m, t);
    const Mat2 J = jacobian(shape.x), inverse = J.inverse();
    const double det = J.determinant();
    const Points x = nodes(r, shape);
    bool correct = f.nodal.cols() > 0 && !f.balanced;
    Eigen::Matrix4Xd rows = Eigen::Matrix4Xd::Zero(4, x.cols());
    for (const Index i : edges) {
      const EdgeData& d = data[i];
      if (d.unbalanced.cwiseAbs().maxCoeff() <= 8 * epsilon * d.load.cwiseAbs().maxCoeff()) continue;
      correct = true;
      const Vec2& apex = shape.x[d.side];
      const double l = length(m.mesh, d.edge);
      for (Eigen::Index q = 0; q < x.cols(); ++q) {
        const Vec2 field = (x.col(q) - apex) * l / (2 * area(shape));  // normal component 1 on this edge, 0 elsewhere
        const Vec2 load =
            m.inner->skeleton.frame[d.edge] * d.unbalanced * trace_basis(carrier, along(d, r.nodes.col(q)).s);
        rows.col(q) += (Eigen::Vector4d() << load.x() * field, load.y() * field).finished();
      }
    }
    if (!correct) return;
    Points wanted = Points::Zero(2, x.cols());
    if (f.nodal.cols() > 0) {
      const Eigen::Map<const Points> force(f.nodal.col(t).data(), 2, f.nodal.rows() / 2);
      wanted = force * (r.mean_force - r.force).transpose();
    }
    for (int row = 0; row < 2; ++row) {
      const auto divergence = [&](int axis) -> Eigen::RowVectorXd {
        return inverse(0, axis) * (rows.row(2 * row + axis) * r.slope[0].transpose()) +
               inverse(1, axis) * (rows.row(2 * row + axis) * r.slope[1].transpose());
      };
      const Eigen::RowVectorXd rest = wanted.row(row) - divergence(0) - divergence(1);
      const Eigen::VectorXd field = r.normal_free * (det * rest).transpose();
      const Points own = J / det * Eigen::Map<const Points>(field.data(), 2, x.cols());
      rows.middleRows<2>(2 * row) += own;
    }
    stress += rows;
  }

  /// At the points of the rule; no columns without one.
  Eigen::Matrix4Xd eigenstrain(const Reference& r, Index t) const {
    return m.inner->data.strain.empty() ? Eigen::Matrix4Xd() : strain_at(m.inner->data.strain, t, r.rule.x);
  }

  /// <u_D, t n> on the prescribed components, less the work of tractions that act there.
  void work_of_supports(const Tractions& tractions, const std::vector<Index>& edges, Share& share) const {
    const Eigen::Index points = m.inner->kernel.trace.w.size();
    for (const Index i : edges) {
      const EdgeData& d = data[i];
      const double l = length(m.mesh, d.edge);
      for (int k = 0; k < 2; ++k) {
        if (!d.held[k]) continue;
        for (Eigen::Index g = 0; g < points; ++g) {
          const Index unknown = d.edge * m.inner->skeleton.per_edge + 2 * static_cast<Index>(g) + k;
          const double work = l * m.inner->kernel.trace.w[g] * tractions(k, points * d.side + g) *
                              m.inner->skeleton.prescribed[unknown];
          share.lower += work;
          share.size += std::abs(work);
        }
        for (int g = 0; g < data_carriers; ++g)
          share.lower -= l * carrier.w[g] * d.load(k, g) * conforming.value[i](k, g);
      }
    }
  }

  Tractions tractions(const Reference& r, const Triangle& shape, const Eigen::Matrix4Xd& stress) const {
    const Eigen::Index points = m.inner->kernel.trace.w.size();
    Tractions result(2, 3 * points);
    for (int e = 0; e < 3; ++e) {
      const Vec2 side = shape.x[(e + 2) % 3] - shape.x[(e + 1) % 3];
      const Vec2 n = Vec2(side.y(), -side.x()).normalized();
      const Eigen::Matrix4Xd there = stress * r.at_edge[e][shape.forward[e] ? 1 : 0].transpose();
      for (Eigen::Index g = 0; g < points; ++g)
        result.col(points * e + g) = shape.frame[e].transpose() * (tensor(there.col(g)) * n);
    }
    return result;
  }

  /// Of the loads on an edge with data, at one of its points and in all.
  double work_at(Index i, int g) const {
    return length(m.mesh, data[i].edge) * carrier.w[g] * data[i].load.col(g).dot(conforming.value[i].col(g));
  }
  double work_on_edge(Index i) const {
    double work = 0;
    for (int g = 0; g < data_carriers; ++g) work += work_at(i, g);
    return work;
  }

  /// The trace of A s, in isotropic bodies 2 c tr s, and that of the eigenstrain.
  Eigen::RowVectorXd wanted_divergence(const Reference& r, Index t) const {
    const Triangle shape = triangle(m, t);
    const Material& material = material_of(m.mesh, m.scene, t);
    const Eigen::Matrix4Xd stress = evaluate(m.inner->kernel, shape, s.interior.col(t), nodes(r, shape)).stress;
    Eigen::RowVectorXd wanted = 2 * material.c * (stress.row(0) + stress.row(3));
    if (!isotropic(material))
      for (Eigen::Index q = 0; q < wanted.size(); ++q)
        wanted[q] += orthotropic_strain(material, stress(0, q), stress(3, q), 0.5 * (stress(1, q) + stress(2, q)))
                         .head<2>()
                         .sum();
    if (!m.inner->data.strain.empty()) {
      const Eigen::Matrix4Xd at = strain_at(m.inner->data.strain, t, r.nodes);
      wanted += at.row(0) + at.row(3);
    }
    return wanted;
  }

  /// Energy of the conforming displacement with its divergence moved towards that of the stress.
  void upper(const Reference& r, Index t, const std::vector<Index>& edges, Share& share) const {
    const Triangle cell = triangle(m, t), shape = chords_of(cell);
    const Mat2 J = jacobian(shape.x), inverse = J.inverse();
    const Material& material = material_of(m.mesh, m.scene, t);
    const double mu = material.mu, c = material.c;
    const Eigen::Matrix3d C = isotropic(material) ? Eigen::Matrix3d::Zero() : stress_matrix(material);
    const double det = J.determinant();
    const Eigen::Map<const Points> nodal(conforming.nodal.col(t).data(), 2, conforming.nodal.rows() / 2);
    Points v = nodal * r.raise.transpose();
    share.largest = nodal.cwiseAbs().maxCoeff();
    const Points low = v;
    for (const Index i : edges) {
      const EdgeData& d = data[i];
      if (!d.held[0] && !d.held[1]) continue;
      for (Eigen::Index q = 0; q < v.cols(); ++q) {
        const Along a = along(d, r.field_nodes.col(q));
        v.col(q) += a.bump * (conforming.bubble[i] * trace_basis(carrier, a.s));
      }
    }
    if (is_curved(cell)) {
      const Eigen::Matrix4Xd stress = evaluate(m.inner->kernel, shape, s.interior.col(t), nodes(r, shape)).stress;
      share.elastic = elastic_energy(*r.curved, cell, material, stress, v, share);
      share.upper = share.elastic;
      share.size += share.elastic;
      for (const Index i : edges) {
        const double work = work_on_edge(i);
        share.upper -= work;
        share.size += std::abs(work);
      }
      return;
    }
    const Eigen::Matrix4Xd free = eigenstrain(r, t);
    Eigen::RowVectorXd wanted = wanted_divergence(r, t);
    for (int axis = 0; axis < 2; ++axis)
      for (int k = 0; k < 2; ++k) wanted -= inverse(k, axis) * (v.row(axis) * r.field_slope[k].transpose());
    const Eigen::VectorXd scaled = det * wanted.transpose();
    const Eigen::VectorXd correction = r.inverse.derivative * scaled;
    const Points dx = v * r.field_slope_at_rule[0].transpose(), dy = v * r.field_slope_at_rule[1].transpose();
    // J(v + alpha w) = e + alpha b + alpha^2 a; the least one. Without compressibility the divergence must vanish.
    double e = 0, b = 0, a = 0, size = 0;
    std::array<double, 2> worst{0, 0};
    // z: what v has beyond polynomials of degree trace + 1; squares and product of the gradients of z and w.
    double zz = 0, zw = 0, ww = 0;
    Points zx, zy;
    Eigen::Matrix4Xd own_strain;
    Points own_displacement;
    if (keep) {
      share.kept_strain.resize(4, r.rule.w.size());
      own_strain.resize(4, r.rule.w.size());
    }
    if (!edges.empty()) {
      zx = (v - low) * r.field_slope_at_rule[0].transpose();
      zy = (v - low) * r.field_slope_at_rule[1].transpose();
    }
    for (Eigen::Index q = 0; q < r.rule.w.size(); ++q) {
      const double w = r.rule.w[q] * area(shape);
      Mat2 g;
      g << dx.col(q), dy.col(q);
      g = (g * inverse).eval();
      const Eigen::Vector4d d = correction.segment<4>(4 * q);
      const Mat2 h = J * (Mat2() << d[0], d[1], d[2], d[3]).finished() * inverse / det;
      const Mat2 whole = g;
      if (free.cols() > 0) g -= tensor(free.col(q));
      if (keep) {
        share.kept_strain.col(q) << g(0, 0), g(0, 1), g(1, 0), g(1, 1);
        own_strain.col(q) << h(0, 0), h(0, 1), h(1, 0), h(1, 1);
      }
      const double volume = g.trace(), own_volume = h.trace();
      const double difference = g(0, 0) - g(1, 1), own_difference = h(0, 0) - h(1, 1), shear = g(0, 1) + g(1, 0),
                   own_shear = h(0, 1) + h(1, 0);
      if (!isotropic(material)) {
        const Eigen::Vector3d strain(g(0, 0), g(1, 1), shear), own(h(0, 0), h(1, 1), own_shear);
        e += w * 0.5 * strain.dot(C * strain);
        b += w * strain.dot(C * own);
        a += w * 0.5 * own.dot(C * own);
      } else {
        e += w * 0.5 * mu * (difference * difference + shear * shear);
        b += w * mu * (difference * own_difference + shear * own_shear);
        a += w * 0.5 * mu * (own_difference * own_difference + own_shear * own_shear);
      }
      if (c > 0 && isotropic(material)) {
        e += w * volume * volume / (8 * c);
        b += w * 2 * volume * own_volume / (8 * c);
        a += w * own_volume * own_volume / (8 * c);
      }
      ww += w * h.squaredNorm();
      if (!edges.empty()) {
        Mat2 z;
        z << zx.col(q), zy.col(q);
        z = (z * inverse).eval();
        zz += w * z.squaredNorm();
        zw += w * z.cwiseProduct(h).sum();
      }
      worst[0] = std::max(worst[0], std::abs(volume + own_volume));
      worst[1] = std::max(worst[1], whole.cwiseAbs().maxCoeff());
    }
    const double alone = e, with_own = b, own_alone = a;
    size += e;
    if (keep) {
      const Eigen::VectorXd own = r.inverse.value * scaled;
      own_displacement = J / det * Eigen::Map<const Points>(own.data(), 2, own.size() / 2);
    }
    if (f.nodal.cols() > 0) {
      const Eigen::Map<const Points> force(f.nodal.col(t).data(), 2, f.nodal.rows() / 2);
      const Points at = force * (r.at_rule * r.force).transpose(), value = v * r.field_at_rule.transpose();
      const Eigen::VectorXd own = r.inverse.value * scaled;
      share.force =
          diameter(shape) / pi * std::sqrt(area(shape) * at.colwise().squaredNorm().dot(r.rule.w)) + f.left_out[t];
      for (Eigen::Index q = 0; q < at.cols(); ++q) {
        const double w = r.rule.w[q] * area(shape), work = at.col(q).dot(value.col(q));
        e -= w * work;
        size += w * std::abs(work);
        b -= w * at.col(q).dot(J * own.segment<2>(2 * q)) / det;
      }
    }
    for (const Index i : edges)
      for (int g = 0; g < data_carriers; ++g) {
        const double work = work_at(i, g);
        e -= work;
        size += std::abs(work);
      }
    const double alpha = c == 0 ? 1 : a > 0 ? -b / (2 * a) : 0;
    share.upper = e + alpha * (b + alpha * a);
    share.elastic = alone + alpha * (with_own + alpha * own_alone);
    if (keep) {
      share.kept_strain += alpha * own_strain;
      share.kept_displacement = v * r.field_at_rule.transpose() + alpha * own_displacement;
    }
    if (free.cols() > 0) {
      const StrainData& strain = m.inner->data.strain;
      share.above = moved_by_eigenstrain(material, shape, strain.rest[t], strain.error[t],
                                         {share.elastic, worst[1], share.stress, share.force});
    }
    const double square = zz + alpha * (2 * zw + alpha * ww);
    share.rough = std::sqrt(std::max(0.0, square));
    share.size += size;
    share.divergence = c == 0 ? worst[0] : 0;
    share.gradient = worst[1];
  }
};

// What the equilibrium of the tractions and the sign of those of contact lack, times the displacements, and the work of
// pressure on penetration: rounding.
double imbalance(const Model& m, const Field& s, const std::vector<EdgeData>& data, const Conforming& conforming,
                 const std::vector<Share>& shares) {
  const Index points = points_per_edge(m.element);
  std::vector<Index> place(m.mesh.edges.size(), none);
  for (std::size_t i = data.size(); i-- > 0;) place[data[i].edge] = static_cast<Index>(i);  // of cracks the left side
  const EdgeRule carrier = gauss(data_carriers);
  double total = 0;
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    std::array<Tractions, 2> side;
    for (int k = 0; k < 2; ++k) {
      side[k] = Tractions::Zero(2, points);
      const Index t = m.mesh.sides[e][k];
      if (t == none) continue;
      int i = 0;
      while (m.mesh.edges_of[t][i] != e) ++i;
      side[k] = shares[t].tractions.middleCols(points * i, points);
    }
    const CrackLaw::Kind kind = m.mesh.crack[e] == none ? CrackLaw::Kind::Bonded : m.scene.laws[m.mesh.crack[e]].kind;
    const EdgeData* d = place[e] == none ? nullptr : &data[place[e]];
    for (Index g = 0; g < points; ++g)
      for (int k = 0; k < 2; ++k) {
        if (d && d->held[k]) continue;
        double given = 0;
        if (d)
          for (int q = 0; q < data_carriers; ++q)
            given += carrier.w[q] / m.inner->kernel.trace.w[g] * trace_basis(m.inner->kernel.trace, carrier.s[q])[g] *
                     d->load(k, q);
        const double rest = side[0](k, g) + side[1](k, g) - (kind == CrackLaw::Kind::Bonded ? given : 0);
        const Index unknown = 2 * g + k;
        double work = std::abs(rest * s.skeleton[e * m.inner->skeleton.per_edge + unknown]);
        if (kind != CrackLaw::Kind::Bonded) {
          const double contact = side[0](k, g) - given,
                       wrong = k == 0 && kind == CrackLaw::Kind::Unilateral ? std::max(0.0, contact) : contact;
          work += std::abs(wrong * s.skeleton[m.inner->skeleton.jump[e] + unknown]);
          if (k == 0) work += std::abs(contact) * conforming.penetration[e];
        }
        total += length(m.mesh, e) * m.inner->kernel.trace.w[g] * work;
      }
  }
  return total;
}

// Values of what is conforming on one side of an edge, at the Gauss points of the trace.
Points on_edge(const Model& m, const Conforming& conforming, Index e, int side) {
  const Index t = m.mesh.sides[e][side];
  int i = 0;
  while (m.mesh.edges_of[t][i] != e) ++i;
  const Eigen::VectorXd& s = m.inner->kernel.trace.s;
  Eigen::Matrix3Xd l = Eigen::Matrix3Xd::Zero(3, s.size());
  l.row((i + (side == 0 ? 1 : 2)) % 3) = (1 - s.array()).matrix().transpose();
  l.row((i + (side == 0 ? 2 : 1)) % 3) = s.transpose();
  const Eigen::Map<const Points> nodal(conforming.nodal.col(t).data(), 2, conforming.nodal.rows() / 2);
  return nodal * interpolation(conforming.degree, l.bottomRows<2>()).transpose();
}

FaceFields face_fields(const Model& m, const std::vector<EdgeData>& data, const Conforming& conforming,
                       const std::vector<Share>& shares) {
  std::vector<Index> edges;
  for (std::size_t c = 0; c < m.mesh.cracks.size(); ++c)
    if (m.scene.laws[c].kind == CrackLaw::Kind::Unilateral)
      for (const CrackEdge& crack : m.mesh.cracks[c]) edges.push_back(crack.edge);
  std::vector<const EdgeData*> given(m.mesh.edges.size(), nullptr);
  for (std::size_t i = data.size(); i-- > 0;) given[data[i].edge] = &data[i];  // of cracks the left side
  const EdgeRule carrier = gauss(data_carriers), &trace = m.inner->kernel.trace;
  const Eigen::Index points = trace.w.size(), count = static_cast<Eigen::Index>(edges.size());
  FaceFields faces{Eigen::VectorXd(count), trace.w, Eigen::MatrixXd(points, count), Eigen::MatrixXd(points, count),
                   Eigen::VectorXd(count)};
  for (Eigen::Index j = 0; j < count; ++j) {
    const Index e = edges[j], left = m.mesh.sides[e][0];
    int i = 0;
    while (m.mesh.edges_of[left][i] != e) ++i;
    Eigen::RowVectorXd normal = shares[left].tractions.middleCols(points * i, points).row(0);
    if (given[e])
      for (int q = 0; q < data_carriers; ++q)
        normal -=
            carrier.w[q] * given[e]->load(0, q) * trace_basis(trace, carrier.s[q]).cwiseQuotient(trace.w).transpose();
    faces.lengths[j] = length(m.mesh, e);
    faces.pressure.col(j) = -normal.transpose();
    faces.opening.col(j) =
        (on_edge(m, conforming, e, 1) - on_edge(m, conforming, e, 0)).transpose() * m.inner->skeleton.frame[e].col(0);
    faces.overlap[j] = conforming.penetration[e];
  }
  return faces;
}

// Rapid changes r = g - P on an edge: with a function psi on T that is the primitive of r on e and 0 on the other
// edges, (r, w)_e = (curl psi, grad w)_T. The primitive is carried towards the apex and fades over a depth d <= H/2,
// which takes the best value [theory: B.10]. The square of the factor of |grad w|, for component k in the frame of the
// edge.
double rapid(const Model& m, const EdgeData& d, int k, double trace) {
  const double l = length(m.mesh, d.edge), square = l * d.unseen[k] * d.unseen[k],
               primitive = l * l * l * d.primitive[k] * d.primitive[k];
  if (square == 0) return 0;
  const Triangle shape = triangle(m, d.triangle);
  const Vec2 &a = shape.x[(d.side + 1) % 3], &b = shape.x[(d.side + 2) % 3], &apex = shape.x[d.side];
  const double height = 2 * area(shape) / l, foot = (apex - a).dot(b - a) / l;
  const double slant = std::max(std::abs(foot), std::abs(l - foot)) / height, steep = 1 + 2 * slant * slant;
  const double depth = std::min(0.5 * height, std::sqrt(3 * primitive / (steep * square)));
  const double carried = depth > 0 ? steep * depth * 2 / 3 * square + 2 * primitive / depth : infinity;
  return std::min(carried, trace * square);
}

std::vector<Rest> rests_of(const Model& m, const std::vector<EdgeData>& data, const Forces& f,
                           const std::vector<std::vector<Index>>& edges) {
  std::vector<Rest> rests(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Index t = static_cast<Index>(i);
    Rest& r = rests[i];
    if (f.nodal.cols() > 0) {
      r.body = f.left_out[t];
      r.quadrature = f.moved[t];
    }
    r.data = r.body;
    const Triangle shape = triangle(m, t);
    for (const Index k : edges[i]) {
      const double h = diameter(shape), factor = length(m.mesh, data[k].edge) * h * h / area(shape);
      const double trace = factor * (1 / (pi * pi) + 1 / pi);
      r.data += std::sqrt(trace * data[k].left_out);
      for (int d = 0; d < 2; ++d)
        if (!data[k].held[d]) {
          r.data += std::sqrt(rapid(m, data[k], d, trace));
          r.quadrature += length(m.mesh, data[k].edge) * data[k].moved[d];
        }
    }
    if (r.data > 0) r.data *= local_korn(shape);
  }
  return rests;
}

Oscillation oscillation(const std::vector<Rest>& rests, const std::vector<Share>& shares) {
  Oscillation o;
  double square = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    square += rests[i].data * rests[i].data;
    o.correction += rests[i].body * shares[i].rough;
    o.quadrature += rests[i].quadrature * shares[i].largest;
  }
  o.eta = std::sqrt(square);
  return o;
}

/// What of triangles with curved edges the bounds do not know; null: nothing.
const char* unavailable_on_arcs(const Model& m) {
  if (m.mesh.arc.empty()) return nullptr;
  if (m.scene.body) return "no bounds of the energy: a body force in curved triangles (mesh.curved)";
  for (std::size_t e = 0; e < m.mesh.edges.size(); ++e) {
    if (m.mesh.arc[e] == none) continue;
    if (m.mesh.crack[e] != none && (m.scene.laws[m.mesh.crack[e]].kind == CrackLaw::Kind::Unilateral ||
                                    has_pressure(m.scene.laws[m.mesh.crack[e]])))
      return "no bounds of the energy: contact or pressure on curved faces (mesh.curved)";
    if (m.inner->skeleton.bent_at[e] != none && m.mesh.label[e] != none)
      return "no bounds of the energy: a curved side that is held along its normal (mesh.curved)";
  }
  return nullptr;
}

std::string unavailable(const Model& m) {
  if (const auto why = refusal(m.element, can_bound_energy)) return *why;
  if (const char* why = unavailable_on_arcs(m)) return why;
  if (!m.inner->standing.empty()) return "no bounds of the energy: a piece of the body is held by contact alone";
  for (const CrackLaw& law : m.scene.laws) {
    if (law.kind == CrackLaw::Kind::Unilateral && law.normal)
      return "no bounds of the energy: the chords of a curved crack in contact do not slide";
    if (has_gap(law)) return "no bounds of the energy: the faces of a crack are apart before loading";
    if (has_friction(law)) return "no bounds of the energy: with friction the solution does not minimize one";
  }
  return {};
}

struct References {
  Reference plain, rich;  // rich: boundary data are of higher degree than the fields inside
};
References references(const Element& e, int inside, const Forces& f, bool curved) {
  References both{reference(e, inside, f), reference(e, std::max(inside, data_carriers), f)};
  for (Reference* r : {&both.plain, &both.rich})
    if (curved) r->curved = std::make_shared<const CurvedReference>(curved_reference(r->n, e.stress));
  return both;
}

std::vector<Share> bound_triangles(const Bounding& of, const References& to,
                                   const std::vector<std::vector<Index>>& edges) {
  std::vector<Share> shares(edges.size());
  parallel_for(static_cast<Index>(edges.size()), of.m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Reference& r = edges[t].empty() ? to.plain : to.rich;
      of.lower(r, t, edges[t], shares[t]);
      of.upper(r, t, edges[t], shares[t]);
    }
  });
  return shares;
}

Share total(const std::vector<Share>& shares) {
  Share sum;
  for (const Share& share : shares) {
    sum.lower += share.lower;
    sum.upper += share.upper;
    sum.size += share.size;
    sum.below += share.below;
    sum.above += share.above;
    sum.asymmetry = std::max(sum.asymmetry, share.asymmetry);
    sum.stress = std::max(sum.stress, share.stress);
    sum.divergence = std::max(sum.divergence, share.divergence);
    sum.gradient = std::max(sum.gradient, share.gradient);
  }
  return sum;
}

EnergyBounds lost(double oscillation, std::string why) {
  return {nan, nan, oscillation, false, std::move(why)};
}

// Data of which the rules cannot say what they leave out.
std::string unseen_by_bounds(const Model& m) {
  for (const UnseenData& u : unseen_data(m.mesh, m.scene, m.inner->data)) {
    if (!u.stops_bounds) continue;
    return fmt::format("no bounds of the energy: {} {} near ({:.6g}, {:.6g})", u.what, u.how, u.at.x(), u.at.y());
  }
  return {};
}

}  // namespace

Unseen unseen(const Model& m, const Oscillation& o, double mismatch_squared, double gap) {
  double mu = shear_moduli(m.scene.material).least;  // |eps|^2 <= energy/mu
  for (const Material& material : m.scene.regions) mu = std::min(mu, shear_moduli(material).least);
  // J(u) >= lower + X^2/2 - eta |eps(u - v)| with |eps(u - v)| <= (X + sqrt(2 gap))/sqrt(2 mu), for every X.
  const double below = o.eta * o.eta / (4 * mu) + o.eta * std::sqrt(gap / mu) + o.correction;
  // An extension of the rest of the prescribed displacement; its energy is estimated.
  constexpr double extension = 4;
  const double mismatch = extension * std::sqrt(mismatch_squared);
  const double displaced = mismatch * std::sqrt(2 * gap) + mismatch * mismatch;
  // The exact displacement is not far from the discrete one that the works are taken on.
  const double quadrature = 2 * o.quadrature;
  return {below + quadrature, o.correction + displaced + quadrature, displaced};
}

bool unseen_couples(const Forces& f) {
  return f.nodal.cols() > 0 && f.degree == 0;
}

namespace {

/// R has zero mean: tr R = div w with w = 0 on the boundary of the triangle, |grad w| <= |tr R|/beta. v + w is
/// admissible, and its strain less the eigenstrain moves by eps(w) - R, which has no trace.
double moved_without_volume(double mu, const Triangle& t, double rest, const MovedField& on) {
  const double size = std::sqrt(area(t) * rest), gradient = size * std::sqrt(std::pow(local_korn(t), 2) - 1),
               square = 2 * mu * std::pow(size + gradient, 2);
  return std::sqrt(2 * on.elastic * square) + 0.5 * square + on.force * gradient;
}

}  // namespace

double moved_by_eigenstrain(const Material& material, const Triangle& t, double rest, double error,
                            const MovedField& on) {
  if (rest == 0 && error == 0) return 0;
  const double mu = material.mu, c = material.c;
  const bool plain = isotropic(material);
  if (plain && c == 0)
    return moved_without_volume(mu, t, rest, on) + area(t) * error * (2 * mu * on.largest + on.stress);
  // C e : e <= stiffness |e|^2
  const double stiffness = plain ? std::max(2 * mu, 1 / (2 * c)) : 2 * shear_moduli(material).largest,
               square = stiffness * area(t) * rest, moved = std::sqrt(2 * on.elastic * square) + 0.5 * square;
  return (plain ? std::min(moved, moved_without_volume(mu, t, rest, on)) : moved) +
         stiffness * area(t) * error * on.largest;
}

double crossed_work(const FaceFields& pressing, const FaceFields& opening) {
  double work = 0;
  for (Eigen::Index e = 0; e < pressing.lengths.size(); ++e)
    for (Eigen::Index g = 0; g < pressing.weights.size(); ++g)  // both are at least 0, up to rounding
      work += pressing.lengths[e] * pressing.weights[g] * std::abs(pressing.pressure(g, e)) *
              (std::max(opening.opening(g, e), 0.0) + opening.overlap[e]);
  return work;
}

namespace {

EnergyBounds bounds_of(const AdmissiblePair& a, const Field& s) {
  EnergyBounds result;
  const Share& sum = a.sum;
  result.asymmetry = sum.stress > 0 ? sum.asymmetry / sum.stress : 0;
  result.imbalance = sum.size > 0 ? imbalance(a.m, s, a.data, a.conforming, a.shares) / sum.size : 0;
  const double rounding = (64 * epsilon + 2 * result.imbalance) * sum.size;
  const double gap = std::max(sum.upper - sum.lower, 0.0) + 2 * rounding;
  const Unseen more = unseen(a.m, oscillation(a.rests, a.shares), a.conforming.mismatch, gap);
  result.oscillation = std::max(more.below, more.above);
  result.lower = sum.lower - rounding - more.below - sum.below;
  result.upper = sum.upper + rounding + more.above + sum.above;
  if (!(result.lower <= result.upper))
    return lost(result.oscillation, "no bounds of the energy: they are lost to rounding");
  constexpr double isochoric = 1e-9;
  if (sum.divergence > isochoric * sum.gradient)
    return lost(result.oscillation,
                "no bounds of the energy: no admissible displacement without change of volume was found");
  constexpr double negligible = 0.01;
  const bool asymptotic = unseen_couples(a.f) && more.below > negligible * gap;
  result.guaranteed = more.displaced <= negligible * gap && !asymptotic;
  if (!result.guaranteed)
    result.note = fmt::format("the bounds of the energy are estimates: the {} not resolved by the mesh",
                              asymptotic ? "body force is" : "prescribed displacements are");
  if (!a.m.mesh.arc.empty()) {
    result.guaranteed = false;
    result.note = fmt::format(
        "the bounds of the energy are estimates: what arcs have beyond the polynomials of the edges is put at {:.1g}",
        a.beyond_arcs);
  }
  return result;
}

AdmissiblePair made(const Model& m, const Field& s, int inside, bool keep) {
  AdmissiblePair a{.m = m};
  if (const std::string why = unavailable(m); !why.empty()) a.bounds = {nan, nan, 0, false, why};
  if (const std::string why = unseen_by_bounds(m); a.bounds.note.empty() && !why.empty())
    a.bounds = lost(infinity, why);
  if (!a.bounds.note.empty()) return a;
  a.data = edge_data(m);
  a.f = forces(m);
  a.conforming = conforming_displacement(m, s, a.data);
  const Eigen::MatrixXd statics = static_interior(m, s, a.f.couple);
  a.edges.resize(m.mesh.triangles.size());
  for (std::size_t i = 0; i < a.data.size(); ++i) a.edges[a.data[i].triangle].push_back(static_cast<Index>(i));
  const int degree =
      std::max({inside, degree_inside(m, a.f.nodal.cols() > 0 && !a.f.balanced, false), m.inner->data.strain.degree});
  const References to = references(m.element, degree, a.f, !m.mesh.arc.empty());
  a.shares = bound_triangles({m, s, a.f, a.data, a.conforming, statics, keep}, to, a.edges);
  a.rests = rests_of(m, a.data, a.f, a.edges);
  a.sum = total(a.shares);
  if (!m.mesh.arc.empty()) {
    a.beyond_arcs = beyond_arcs(m, s);
    a.sum.below += a.beyond_arcs;
    a.sum.above += a.beyond_arcs;
  }
  a.bounds = bounds_of(a, s);
  a.rounding = (64 * epsilon + 2 * a.bounds.imbalance) * a.sum.size;
  a.plain = to.plain.rule;
  a.rich = to.rich.rule;
  return a;
}

}  // namespace

int degree_inside(const Model& m, bool with_body, bool with_eigenstrain) {
  return std::max(
      {stress_degree(m.element), m.element.trace + (with_body ? 2 : 1), with_eigenstrain ? strain_degree : 0});
}

AdmissiblePair admissible(const Model& m, const Field& s, int inside) {
  return made(m, s, inside, true);
}

EnergyBounds energy_bounds(const Model& m, const Field& s) {
  return made(m, s, 0, false).bounds;
}

EnergyBounds energy_bounds(const Model& m, const Field& s, FaceFields& faces) {
  const AdmissiblePair a = made(m, s, 0, false);
  if (!a.shares.empty()) faces = face_fields(m, a.data, a.conforming, a.shares);
  return a.bounds;
}

}  // namespace kerf
