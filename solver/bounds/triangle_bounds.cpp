// The share of one triangle in the two bounds of the energy [theory: B.1]; docs/theory/bounds.md derives both fields.
// Lower bound: to the stress s of the element are added rows that carry the loads it does not see, and the curl of q in
// H^1_0(T)^2 with div q = s12 - s21, so that
//   p = s + (curl q1; curl q2) is symmetric, with the divergence and the normal traces of s [theory: B.4];
//   lower share = -1/2 int A p : p - int e : p + <u_D, p n>, e the eigenstrain.
// Upper bound: to the continuous displacement v is added alpha w with div w = tr(A s) + tr e - div v, w in H^1_0(T)^2,
//   upper share = 1/2 int C(eps(v + alpha w) - e) : (eps(v + alpha w) - e) - l(v + alpha w)      [theory: B.6],
// alpha the minimiser of this parabola, 1 where the material has no compressibility. Both q and w come from the right
// inverse of the divergence [theory: B.5]. Triangles with curved edges go to solver/bounds/curved.cpp.

#include "solver/bounds/triangle_bounds.hpp"

#include "solver/anisotropic.hpp"
#include "solver/bounds/statics.hpp"
#include "solver/system.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {

namespace {

// What A s : s has beyond that of the isotropic part.
// The isotropic part of A is that of mu and c; an orthotropic material adds the strain of orthotropic_strain to it.
double orthotropic_work(const Material& m, double s11, double s22, double s12) {
  const Eigen::Vector3d e = orthotropic_strain(m, s11, s22, s12);
  return e[0] * s11 + e[1] * s22 + 2 * e[2] * s12;
}

/// Elastic energy of strains g + alpha h as a parabola in alpha.
class ElasticEnergy {
 public:
  explicit ElasticEnergy(const Material& m)
      : m_(m), C_(isotropic(m) ? Eigen::Matrix3d(Eigen::Matrix3d::Zero()) : stress_matrix(m)) {}
  void add(double w, const Mat2& g, const Mat2& h, Parabola& to) const {
    const double mu = m_.mu, c = m_.c, volume = g.trace(), own_volume = h.trace();
    const double difference = g(0, 0) - g(1, 1), own_difference = h(0, 0) - h(1, 1), shear = g(0, 1) + g(1, 0),
                 own_shear = h(0, 1) + h(1, 0);
    if (!isotropic(m_)) {
      const Eigen::Vector3d strain(g(0, 0), g(1, 1), shear), own(h(0, 0), h(1, 1), own_shear);
      to.e += w * 0.5 * strain.dot(C_ * strain);
      to.b += w * strain.dot(C_ * own);
      to.a += w * 0.5 * own.dot(C_ * own);
      return;
    }
    to.e += w * 0.5 * mu * (difference * difference + shear * shear);
    to.b += w * mu * (difference * own_difference + shear * own_shear);
    to.a += w * 0.5 * mu * (own_difference * own_difference + own_shear * own_shear);
    if (c > 0) {
      to.e += w * volume * volume / (8 * c);
      to.b += w * 2 * volume * own_volume / (8 * c);
      to.a += w * own_volume * own_volume / (8 * c);
    }
  }

 private:
  const Material& m_;
  Eigen::Matrix3d C_;
};

/// The gradient of z + alpha w: z is what the conforming displacement has beyond polynomials of degree trace + 1.
class Roughness {
 public:
  void set(const Points& z, const std::array<Eigen::MatrixXd, 2>& slope_at_rule) {
    zx_ = z * slope_at_rule[0].transpose();
    zy_ = z * slope_at_rule[1].transpose();
  }
  void add(double weight, Eigen::Index q, const Mat2& inverse, const Mat2& h) {
    ww_ += weight * h.squaredNorm();
    if (zx_.cols() == 0) return;
    Mat2 z;
    z << zx_.col(q), zy_.col(q);
    z = (z * inverse).eval();
    zz_ += weight * z.squaredNorm();
    zw_ += weight * z.cwiseProduct(h).sum();
  }
  double at(double alpha) const {
    return std::sqrt(std::max(0.0, zz_ + alpha * (2 * zw_ + alpha * ww_)));
  }

 private:
  Points zx_ = Points(2, 0), zy_ = Points(2, 0);
  double zz_ = 0, zw_ = 0, ww_ = 0;  // squares and product of the gradients
};

/// Rules of degree 2 n on the thirds of the triangle integrate squares of polynomials of degree n, which stresses and
/// the gradients of q and w are on each third: the energies of straight triangles have no error of quadrature.
TriangleReference reference_of(const Element& e, int n, const Forces& f) {
  TriangleReference r;
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
    for (const bool forward : {false, true})
      r.at_edge[side][forward] = interpolation(n, points_on_side(trace, side, forward));
  return r;
}

}  // namespace

/// The barycentric coordinates (l0, l1, l2) of a point at s on the side opposite corner `side`; the rule may run
/// against the triangle's own direction.
Points points_on_side(const EdgeRule& rule, int side, bool forward) {
  Eigen::Matrix3Xd l = Eigen::Matrix3Xd::Zero(3, rule.s.size());
  l.row((side + (forward ? 1 : 2)) % 3) = (1 - rule.s.array()).matrix().transpose();
  l.row((side + (forward ? 2 : 1)) % 3) = rule.s.transpose();
  return l.bottomRows<2>();
}

/// Curved references exist only where the mesh has curved cells; both rules of a cell are those of its degree.
References references(const Element& e, int inside, const Forces& f, bool curved) {
  References both{reference_of(e, inside, f), reference_of(e, std::max(inside, data_carriers), f)};
  for (TriangleReference* r : {&both.plain, &both.rich})
    if (curved) r->curved = std::make_shared<const CurvedReference>(curved_reference(r->n, e.stress));
  return both;
}

/// l_b - l_a and not l_b: symmetric in both ends, so that the bubble is the same polynomial seen from either.
Bounding::Along Bounding::along(const EdgeData& d, const Vec2& l) const {
  const std::array<double, 3> full{1 - l.x() - l.y(), l.x(), l.y()};
  const bool forward = m.mesh.sides[d.edge][0] == d.triangle;
  const double from = full[(d.side + (forward ? 1 : 2)) % 3], to = full[(d.side + (forward ? 2 : 1)) % 3];
  return {0.5 * (1 + to - from), from * to};
}

/// Shapes: `stress` has rows s11, s12, s21, s22 and a column per point of lattice(n). q is found on the reference
/// triangle: with q = J Q/det J, div Q = det J (s12 - s21), and the gradient of q is J (grad Q) J^-1/det J. The
/// asymmetry has zero mean because the element balances moments on the triangle, or the couple does.
void Bounding::lower(const TriangleReference& r, Index t, const CellFields& at, const std::vector<Index>& edges,
                     Share& share) const {
  const Triangle cell = triangle(m, t), shape = chords_of(cell);
  const Mat2 J = jacobian(shape.x), inverse = J.inverse();
  const double det = J.determinant();
  const Points x = nodes(r, shape);
  Eigen::Matrix4Xd stress = evaluate(m.inner->kernel, shape, at.statics, x).stress;
  if (f.couple.size() > 0) {
    const Mat2 c = antisymmetric(f.couple[column(t)]);
    stress.colwise() += Eigen::Vector4d(c(0, 0), c(0, 1), c(1, 0), c(1, 1));
  }
  share.tractions = tractions(r, shape, stress);
  work_of_supports(share.tractions, edges, share);

  add_loads_unseen(r, t, edges, stress);
  if (is_curved(cell)) {
    const bool rest = leaves_strain(t);
    add_complementary_energy(*r.curved, cell, material_of(m.mesh, m.scene, t), stress, curved_strain(*r.curved, t),
                             share, keep, rest);
    if (rest)
      share.below +=
          area(shape) * (std::sqrt(strain().rest[column(t)] * share.square) + strain().error[column(t)] * share.stress);
    return;
  }

  const Eigen::VectorXd asymmetry = (stress.row(1) - stress.row(2)).transpose();
  const Eigen::VectorXd q = r.inverse.derivative * (det * asymmetry);
  const Eigen::Matrix4Xd at_rule = stress * r.at_rule.transpose();
  const Material& material = material_of(m.mesh, m.scene, t);
  const double mu = material.mu, c = material.c;
  const Eigen::Matrix4Xd free = eigenstrain(r, t);
  // A p : p = |dev p|^2/(2 mu) + c (tr p)^2 with |dev p|^2 = (p11 - p22)^2/2 + p12^2 + p21^2 [theory: B.3]; rounding
  // leaves p12 - p21, which is measured.
  double energy = 0, freed = 0;
  Eigen::Matrix4Xd whole(4, at_rule.cols());
  for (Eigen::Index i = 0; i < at_rule.cols(); ++i) {
    const Mat2 gradient = J * (Mat2() << q[4 * i], q[4 * i + 1], q[4 * i + 2], q[4 * i + 3]).finished() * inverse / det;
    const double s11 = at_rule(0, i) + gradient(0, 1), s12 = at_rule(1, i) - gradient(0, 0),
                 s21 = at_rule(2, i) + gradient(1, 1), s22 = at_rule(3, i) - gradient(1, 0), trace = s11 + s22,
                 difference = s11 - s22;
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
    share.below =
        area(shape) * (std::sqrt(strain().rest[column(t)] * share.square) + strain().error[column(t)] * share.stress);
  }
  if (keep) share.kept_stress = std::move(whole);
}

/// The projection is onto the polynomials of degree 4 of the triangle; what is left has all of the work of the rest of
/// the eigenstrain, since that rest is orthogonal to them [theory: B.28].
double Bounding::beyond_strains(const TriangleReference& r, const Eigen::Matrix4Xd& stress) {
  const Eigen::Matrix4Xd rest = stress - stress * r.to_strains.transpose() * r.of_strains.transpose();
  return rest.colwise().squaredNorm().dot(r.rule.w);
}

Points Bounding::nodes(const TriangleReference& r, const Triangle& shape) const {
  Points x(2, r.nodes.cols());
  for (Eigen::Index q = 0; q < x.cols(); ++q)
    x.col(q) = shape.x[0] + r.nodes(0, q) * (shape.x[1] - shape.x[0]) + r.nodes(1, q) * (shape.x[2] - shape.x[0]);
  return x;
}

/// The field (x - apex) |e|/(2 |T|) has normal component 1 on the edge e opposite the apex and 0 on the two others, so
/// that it carries a missing traction without touching the neighbours. What its divergence adds to, or lacks of, the
/// body force is made up by a field without normal trace. Its data have zero mean: the element balances the resultants
/// of the loads.
void Bounding::add_loads_unseen(const TriangleReference& r, Index t, const std::vector<Index>& edges,
                                Eigen::Matrix4Xd& stress) const {
  const Triangle shape = triangle(m, t);
  const Mat2 J = jacobian(shape.x), inverse = J.inverse();
  const double det = J.determinant();
  const Points x = nodes(r, shape);
  bool correct = f.nodal.cols() > 0 && !f.balanced;
  Eigen::Matrix4Xd rows = Eigen::Matrix4Xd::Zero(4, x.cols());
  for (const Index i : edges) {
    const EdgeData& d = data[i];
    // Below rounding of the load itself there is nothing to carry.
    if (d.unbalanced.cwiseAbs().maxCoeff() <= 8 * std::numeric_limits<double>::epsilon() * d.load.cwiseAbs().maxCoeff())
      continue;
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
    const Eigen::Map<const Points> force(f.nodal.col(column(t)).data(), 2, f.nodal.rows() / 2);
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

Eigen::Matrix4Xd Bounding::eigenstrain(const TriangleReference& r, Index t) const {
  return strain().empty() ? Eigen::Matrix4Xd() : strain_at(strain(), column(t), r.rule.x);
}

CurvedStrain Bounding::curved_strain(const CurvedReference& r, Index t) const {
  if (strain().empty()) return {};
  return {strain_at(strain(), column(t), r.nodes), strain_at(strain(), column(t), r.rule.x)};
}

bool Bounding::leaves_strain(Index t) const {
  return !strain().empty() && (strain().rest[column(t)] > 0 || strain().error[column(t)] > 0);
}

/// Over the Gauss points of the trace. A traction g on a held component adds -g . u_D, which no state changes, to the
/// energy and so to both bounds.
void Bounding::work_of_supports(const Tractions& tractions, const std::vector<Index>& edges, Share& share) const {
  const Eigen::Index points = m.inner->kernel.trace.w.size();
  for (const Index i : edges) {
    const EdgeData& d = data[i];
    if (d.bent) continue;  // nothing moves along the normal
    const double l = length(m.mesh, d.edge);
    for (int k = 0; k < 2; ++k) {
      if (!d.held[k]) continue;
      for (Eigen::Index g = 0; g < points; ++g) {
        const Index unknown = d.edge * m.inner->skeleton.per_edge + 2 * static_cast<Index>(g) + k;
        const double work =
            l * m.inner->kernel.trace.w[g] * tractions(k, points * d.side + g) * m.inner->skeleton.prescribed[unknown];
        share.lower += work;
        share.size += std::abs(work);
      }
      for (int g = 0; g < data_carriers; ++g)
        share.lower -= l * carrier.w[g] * d.load(k, g) * conforming.value[i](k, g);
    }
  }
}

/// (s n) in the frame of each edge, n out of the triangle: the sum over the two sides of an inner edge is the
/// imbalance.
Tractions Bounding::tractions(const TriangleReference& r, const Triangle& shape, const Eigen::Matrix4Xd& stress) const {
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

double Bounding::work_at(Index i, int g) const {
  return length(m.mesh, data[i].edge) * carrier.w[g] * data[i].load.col(g).dot(conforming.value[i].col(g));
}

double Bounding::work_on_edge(Index i) const {
  double work = 0;
  for (int g = 0; g < data_carriers; ++g) work += work_at(i, g);
  return work;
}

/// On curved cells the body force is J f as a polynomial of the reference coordinates.
Points Bounding::load_on(const CurvedReference& r, Index t) const {
  if (f.nodal.cols() == 0) return Points(2, 0);
  const Eigen::Map<const Points> force(f.nodal.col(column(t)).data(), 2, f.nodal.rows() / 2);
  return force * interpolation(f.degree, r.rule.x).transpose();
}

/// The trace of the strain that the discrete stress asks for. Its mean over the triangle is that of div v because the
/// edge means of v are those of the multipliers, so that the right inverse applies.
Eigen::RowVectorXd Bounding::wanted_divergence(const TriangleReference& r, Index t, const CellFields& at) const {
  const Triangle shape = triangle(m, t);
  const Material& material = material_of(m.mesh, m.scene, t);
  const Eigen::Matrix4Xd stress = evaluate(m.inner->kernel, shape, at.interior, nodes(r, shape)).stress;
  Eigen::RowVectorXd wanted = 2 * material.c * (stress.row(0) + stress.row(3));
  if (!isotropic(material))
    for (Eigen::Index q = 0; q < wanted.size(); ++q)
      wanted[q] +=
          orthotropic_strain(material, stress(0, q), stress(3, q), 0.5 * (stress(1, q) + stress(2, q))).head<2>().sum();
  if (!strain().empty()) {
    const Eigen::Matrix4Xd free = strain_at(strain(), column(t), r.nodes);
    wanted += free.row(0) + free.row(3);
  }
  return wanted;
}

/// Along a held edge v is not a polynomial of degree trace + 1: bubble * l_a l_b on top gives it the prescribed values.
Points Bounding::conforming_values(const TriangleReference& r, const CellFields& at,
                                   const std::vector<Index>& edges) const {
  const Eigen::Map<const Points> nodal(at.nodal.data(), 2, at.nodal.size() / 2);
  Points v = nodal * r.raise.transpose();
  for (const Index i : edges) {
    const EdgeData& d = data[i];
    if (!d.held[0] && !d.held[1]) continue;
    for (Eigen::Index q = 0; q < v.cols(); ++q) {
      const Along a = along(d, r.field_nodes.col(q));
      v.col(q) += a.bump * (conforming.bubble[i] * trace_basis(carrier, a.s));
    }
  }
  return v;
}

void Bounding::upper_curved(const TriangleReference& r, Index t, const CellFields& at, const std::vector<Index>& edges,
                            const Points& v, Share& share) const {
  const Triangle cell = triangle(m, t), shape = chords_of(cell);
  const Material& material = material_of(m.mesh, m.scene, t);
  const Eigen::Matrix4Xd stress = evaluate(m.inner->kernel, shape, at.interior, nodes(r, shape)).stress;
  add_elastic_energy(*r.curved, cell, material, stress, curved_strain(*r.curved, t), load_on(*r.curved, t), v, share,
                     keep);
  if (leaves_strain(t))
    share.above += moved_by_eigenstrain(material, cell, strain().rest[column(t)], strain().error[column(t)],
                                        {share.elastic, share.strain, share.stress, share.force});
  for (const Index i : edges) {
    const double work = work_on_edge(i);
    share.upper -= work;
    share.size += std::abs(work);
  }
}

double Bounding::add_works(const TriangleReference& r, Index t, const std::vector<Index>& edges, const Points& v,
                           const Eigen::VectorXd& own, Parabola& along, Share& share) const {
  const Triangle shape = chords_of(triangle(m, t));
  const Mat2 J = jacobian(shape.x);
  const double det = J.determinant();
  double size = along.e;
  if (f.nodal.cols() > 0) {
    const Eigen::Map<const Points> force(f.nodal.col(column(t)).data(), 2, f.nodal.rows() / 2);
    const Points pull = force * (r.at_rule * r.force).transpose(), value = v * r.field_at_rule.transpose();
    share.force = diameter(shape) / pi * std::sqrt(area(shape) * pull.colwise().squaredNorm().dot(r.rule.w)) +
                  f.left_out[column(t)];
    for (Eigen::Index q = 0; q < pull.cols(); ++q) {
      const double w = r.rule.w[q] * area(shape), work = pull.col(q).dot(value.col(q));
      along.e -= w * work;
      size += w * std::abs(work);
      along.b -= w * pull.col(q).dot(J * own.segment<2>(2 * q)) / det;
    }
  }
  for (const Index i : edges)
    for (int g = 0; g < data_carriers; ++g) {
      const double work = work_at(i, g);
      along.e -= work;
      size += std::abs(work);
    }
  return size;
}

/// `wanted` becomes tr(A s) + tr e - div v at the nodes; the correction w and its gradient h follow by Piola's map.
void Bounding::upper(const TriangleReference& r, Index t, const CellFields& at, const std::vector<Index>& edges,
                     Share& share) const {
  const Triangle cell = triangle(m, t), shape = chords_of(cell);
  const Points v = conforming_values(r, at, edges);
  share.largest = at.nodal.cwiseAbs().maxCoeff();
  if (is_curved(cell)) return upper_curved(r, t, at, edges, v, share);
  const Mat2 J = jacobian(shape.x), inverse = J.inverse();
  const double det = J.determinant();
  const Material& material = material_of(m.mesh, m.scene, t);
  const Eigen::Matrix4Xd free = eigenstrain(r, t);
  Eigen::RowVectorXd wanted = wanted_divergence(r, t, at);
  for (int axis = 0; axis < 2; ++axis)
    for (int k = 0; k < 2; ++k) wanted -= inverse(k, axis) * (v.row(axis) * r.field_slope[k].transpose());
  const Eigen::VectorXd scaled = det * wanted.transpose();
  const Eigen::VectorXd correction = r.inverse.derivative * scaled;
  const Points dx = v * r.field_slope_at_rule[0].transpose(), dy = v * r.field_slope_at_rule[1].transpose();
  Roughness rough;
  if (!edges.empty()) {
    const Eigen::Map<const Points> nodal(at.nodal.data(), 2, at.nodal.size() / 2);
    rough.set(v - Points(nodal * r.raise.transpose()), r.field_slope_at_rule);
  }
  const ElasticEnergy energy(material);
  Parabola along;
  std::array<double, 2> worst{0, 0}, strained{0, 0};  // the latter of v and w
  Eigen::Matrix4Xd own_strain;
  if (keep) {
    share.kept_strain.resize(4, r.rule.w.size());
    own_strain.resize(4, r.rule.w.size());
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
    energy.add(w, g, h, along);
    rough.add(w, q, inverse, h);
    worst[0] = std::max(worst[0], std::abs(g.trace() + h.trace()));
    worst[1] = std::max(worst[1], whole.cwiseAbs().maxCoeff());
    strained[0] = std::max(strained[0], largest_strain(g));
    strained[1] = std::max(strained[1], largest_strain(h));
  }
  const Parabola elastic = along;
  const Eigen::VectorXd own =
      keep || f.nodal.cols() > 0 ? Eigen::VectorXd(r.inverse.value * scaled) : Eigen::VectorXd();
  share.size += add_works(r, t, edges, v, own, along, share);
  // At c = 0 the strain must have no trace, which alpha = 1 alone achieves: the volumetric energy has a factor 1/(8 c).
  const double alpha = material.c == 0 ? 1 : along.a > 0 ? -along.b / (2 * along.a) : 0;
  share.upper = along.at(alpha);
  share.elastic = elastic.at(alpha);
  if (keep) {
    share.kept_strain += alpha * own_strain;
    const Points own_displacement = J / det * Eigen::Map<const Points>(own.data(), 2, own.size() / 2);
    share.kept_displacement = v * r.field_at_rule.transpose() + alpha * own_displacement;
  }
  share.strain = strained[0] + std::abs(alpha) * strained[1];
  if (free.cols() > 0)
    share.above = moved_by_eigenstrain(material, shape, strain().rest[column(t)], strain().error[column(t)],
                                       {share.elastic, share.strain, share.stress, share.force});
  share.rough = rough.at(alpha);
  share.divergence = material.c == 0 ? worst[0] : 0;
  share.gradient = worst[1];
}

}  // namespace kerf
