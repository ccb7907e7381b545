// The shares of triangles with curved edges in the bounds of the energy. Fields live on the triangle of the chords and
// are carried to the body by its map Phi, D = grad Phi, J = det D, k the degree of the element's stress:
//   sigma = S D'/J + curl beta,  beta = D B/J,  div B = (S D')_12 - (S D')_21,  B in H^1_0      [theory: B.29],
// symmetric and with the loads of S, and v + alpha D W/J with div W = J (tr(A S D'/J) + tr e - div v). Right-hand sides
// are polynomials of degree n + k, so that the right inverse of straight triangles serves. Energies are integrals of
// rational functions: two rules on the thirds of the triangle are taken, and doubt_of_rules times their difference is
// added on both sides. What the body has beyond the polynomials of its edges is estimated. docs/theory/bounds.md,
// "Curved triangles".

#include "solver/bounds/curved.hpp"

#include "solver/anisotropic.hpp"
#include "solver/bounds/polynomial_data.hpp"
#include "solver/recovery.hpp"
#include "solver/system.hpp"

#include "kerf/recover.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// The map of a triangle at a point, and how D changes along its two coordinates.
struct Place {
  Mat2 D, inverse;
  double J;
  std::array<Mat2, 2> D_by;
  Vec2 J_by;

  /// Derivative of the determinant: J_,i = J tr(D^-1 D_,i).
  Place(const Triangle& cell, const Vec2& l) {
    const CellMap map = cell_map(cell, l);
    D = map.D;
    inverse = D.inverse();
    J = map.J;
    D_by = cell_map_slopes(cell, l);
    for (int axis = 0; axis < 2; ++axis) J_by[axis] = J * (inverse * D_by[axis]).trace();
  }
  /// The gradient of D B/J on the body, B and its gradient those on the triangle of the chords [Piola].
  Mat2 gradient(const Vec2& B, const Mat2& slope) const {
    Mat2 by;
    for (int axis = 0; axis < 2; ++axis)
      by.col(axis) = (D_by[axis] * B + D * slope.col(axis)) / J - D * B * (J_by[axis] / (J * J));
    return by * inverse;
  }
};

/// S D': the stress on the body times J.
Mat2 piola(const Eigen::Vector4d& S, const Mat2& D) {
  return (Mat2() << S[0], S[1], S[2], S[3]).finished() * D.transpose();
}

/// B in H^1_0 with div B = wanted, at a point of the rule.
/// The right inverse is that of the triangle of reference; this is Piola's map from there to the triangle of the
/// chords.
struct Corrected {
  const CurvedReference& r;
  Mat2 map, inverse;
  double det;
  Eigen::VectorXd value, derivative;

  Corrected(const CurvedReference& by, const Triangle& cell, const Eigen::VectorXd& wanted)
      : r(by), map(jacobian(cell.x)), inverse(map.inverse()), det(map.determinant()) {
    value = r.inverse.value * (det * wanted);
    derivative = r.inverse.derivative * (det * wanted);
  }
  Vec2 at(Eigen::Index q) const {
    return map * value.segment<2>(2 * q) / det;
  }
  Mat2 slope(Eigen::Index q) const {
    const Eigen::Vector4d d = derivative.segment<4>(4 * q);
    return map * (Mat2() << d[0], d[1], d[2], d[3]).finished() * inverse / det;
  }
};

Mat2 free_at(const Eigen::Matrix4Xd& free, Eigen::Index q) {
  return free.cols() == 0 ? Mat2(Mat2::Zero()) : Mat2(tensor(free.col(q)));
}

/// The trace of A s, in the plane.
double strain_trace(const Material& m, const Mat2& s) {
  double trace = 2 * m.c * s.trace();
  if (!isotropic(m)) trace += orthotropic_strain(m, s(0, 0), s(1, 1), 0.5 * (s(0, 1) + s(1, 0))).head<2>().sum();
  return trace;
}

/// Twice the energy density of a symmetric stress.
double stress_work(const Material& m, const Mat2& s) {
  const double trace = s.trace(), difference = s(0, 0) - s(1, 1), shear = 0.5 * (s(0, 1) + s(1, 0));
  double work = (0.5 * difference * difference + 2 * shear * shear) / (2 * m.mu) + m.c * trace * trace;
  if (!isotropic(m)) {
    const Eigen::Vector3d e = orthotropic_strain(m, s(0, 0), s(1, 1), shear);
    work += e[0] * s(0, 0) + e[1] * s(1, 1) + 2 * e[2] * shear;
  }
  return work;
}

/// The work of the stress of the strain g on the strain h; without compressibility that of their deviators.
double strain_work(const Material& m, const Eigen::Matrix3d& C, const Mat2& g, const Mat2& h) {
  const double difference = g(0, 0) - g(1, 1), other = h(0, 0) - h(1, 1), shear = g(0, 1) + g(1, 0),
               other_shear = h(0, 1) + h(1, 0);
  if (!isotropic(m))
    return Eigen::Vector3d(g(0, 0), g(1, 1), shear).dot(C * Eigen::Vector3d(h(0, 0), h(1, 1), other_shear));
  const double volume = m.c > 0 ? g.trace() * h.trace() / (4 * m.c) : 0;
  return m.mu * (difference * other + shear * other_shear) + volume;
}

}  // namespace

/// Rules of degree 2 (n + k) and 2 (n + k) - 4. The points of both lie in one list, third by third, as right_inverse
/// takes them.
CurvedReference curved_reference(int n, int k) {
  const int degree = n + k;
  const TriangleRule good = split_rule(2 * degree), other = split_rule(2 * degree - 4);
  const Eigen::Index a = good.w.size() / 3, b = other.w.size() / 3;
  CurvedReference r;
  r.nodes = lattice(degree);
  r.rule = {Points(2, 3 * (a + b)), Eigen::VectorXd::Zero(3 * (a + b))};
  r.coarse = Eigen::VectorXd::Zero(3 * (a + b));
  for (Eigen::Index t = 0; t < 3; ++t) {
    r.rule.x.middleCols(t * (a + b), a) = good.x.middleCols(t * a, a);
    r.rule.x.middleCols(t * (a + b) + a, b) = other.x.middleCols(t * b, b);
    r.rule.w.segment(t * (a + b), a) = good.w.segment(t * a, a);
    r.coarse.segment(t * (a + b) + a, b) = other.w.segment(t * b, b);
  }
  r.at_nodes = interpolation(n, r.nodes);
  r.at_rule = interpolation(n, r.rule.x);
  r.slope = differentiation(n + 1, r.nodes);
  r.slope_at_rule = differentiation(n + 1, r.rule.x);
  r.value_at_rule = interpolation(n + 1, r.rule.x);
  r.inverse = right_inverse(degree, r.rule);
  r.to_strains = projection(strain_degree, r.rule);
  r.of_strains = interpolation(strain_degree, r.rule.x);
  return r;
}

// s = S D'/J + curl beta with beta = D B/J, div B = J times the asymmetry: curl of what vanishes on the edges has
// neither divergence nor normal trace there.
// By both rules at once; `rest`: the stress is also asked for as J p on the triangle of the chords, where the rest of
// the eigenstrain is orthogonal to polynomials.
void add_complementary_energy(const CurvedReference& r, const Triangle& cell, const Material& material,
                              const Eigen::Matrix4Xd& stress, const CurvedStrain& free, Share& share, bool keep,
                              bool rest) {
  const Eigen::Matrix4Xd at_nodes = stress * r.at_nodes.transpose(), at_rule = stress * r.at_rule.transpose();
  Eigen::VectorXd asymmetry(r.nodes.cols());
  for (Eigen::Index q = 0; q < asymmetry.size(); ++q) {
    const Mat2 s = piola(at_nodes.col(q), cell_map(cell, r.nodes.col(q)).D);
    asymmetry[q] = s(0, 1) - s(1, 0);
  }
  const Corrected by(r, cell, asymmetry);
  double energy = 0, other = 0;
  Eigen::Matrix4Xd scaled(4, rest ? at_rule.cols() : 0);
  if (keep) {
    share.kept_stress.resize(4, at_rule.cols());
    share.kept_weight.resize(2, at_rule.cols());
  }
  for (Eigen::Index q = 0; q < at_rule.cols(); ++q) {
    const Place p(cell, r.rule.x.col(q));
    const Mat2 g = p.gradient(by.at(q), by.slope(q));
    Mat2 s = piola(at_rule.col(q), p.D) / p.J;
    s += (Mat2() << g(0, 1), -g(0, 0), g(1, 1), -g(1, 0)).finished();
    share.asymmetry = std::max(share.asymmetry, std::abs(s(0, 1) - s(1, 0)));
    share.stress = std::max(share.stress, (rest ? std::max(1.0, p.J) : 1) * s.cwiseAbs().maxCoeff());
    if (rest) scaled.col(q) << p.J * s(0, 0), p.J * s(0, 1), p.J * s(1, 0), p.J * s(1, 1);
    if (keep) {
      share.kept_stress.col(q) << s(0, 0), s(0, 1), s(1, 0), s(1, 1);
      share.kept_weight.col(q) << area(cell) * p.J * r.rule.w[q], area(cell) * p.J * r.coarse[q];
    }
    const double work = p.J * (stress_work(material, s) + 2 * free_at(free.at_rule, q).cwiseProduct(s).sum());
    energy += r.rule.w[q] * work;
    other += r.coarse[q] * work;
  }
  energy *= 0.5 * area(cell);
  other *= 0.5 * area(cell);
  share.lower -= energy;
  share.size += std::abs(energy);
  share.below += doubt_of_rules * std::abs(energy - other);
  share.rules += doubt_of_rules * std::abs(energy - other);
  if (rest) {
    const Eigen::Matrix4Xd unseen = scaled - scaled * r.to_strains.transpose() * r.of_strains.transpose();
    share.square = unseen.colwise().squaredNorm().dot(r.rule.w);
  }
}

/// As on straight triangles: the energy e + alpha b + alpha^2 a of the strain g + alpha h, g = grad v - e, h the
/// gradient of D W/J, all at the points of both rules. alpha minimises by the better rule.
void add_elastic_energy(const CurvedReference& r, const Triangle& cell, const Material& material,
                        const Eigen::Matrix4Xd& stress, const CurvedStrain& free, const Points& load, const Points& v,
                        Share& share, bool keep) {
  const Mat2 inverse = jacobian(cell.x).inverse();
  const Eigen::Matrix3d C = isotropic(material) ? Eigen::Matrix3d::Zero() : stress_matrix(material);
  const auto slopes = [&](const std::array<Eigen::MatrixXd, 2>& by, Eigen::Index q) -> Mat2 {
    Mat2 g;
    g << v * by[0].row(q).transpose(), v * by[1].row(q).transpose();
    return g * inverse;
  };
  const Eigen::Matrix4Xd at_nodes = stress * r.at_nodes.transpose();
  Eigen::VectorXd wanted(r.nodes.cols());
  for (Eigen::Index q = 0; q < wanted.size(); ++q) {
    const CellMap map = cell_map(cell, r.nodes.col(q));
    wanted[q] = strain_trace(material, piola(at_nodes.col(q), map.D)) +
                map.J * (free_at(free.at_nodes, q) - slopes(r.slope, q) * map.D.inverse()).trace();
  }
  const Corrected by(r, cell, wanted);
  // J(v + alpha w) = e + alpha b + alpha^2 a, by both rules; the least one, less the work of the load.
  std::array<double, 2> e{}, b{}, a{}, work{}, added_work{};
  const Points value = v * r.value_at_rule.transpose();
  Points added_value(2, r.rule.w.size());
  double worst = 0;
  Eigen::Matrix4Xd added_strain;
  if (keep) {
    share.kept_strain.resize(4, r.rule.w.size());
    added_strain.resize(4, r.rule.w.size());
  }
  for (Eigen::Index q = 0; q < r.rule.w.size(); ++q) {
    const Place p(cell, r.rule.x.col(q));
    const Mat2 g = slopes(r.slope_at_rule, q) * p.inverse - free_at(free.at_rule, q),
               h = p.gradient(by.at(q), by.slope(q));
    added_value.col(q) = p.D * by.at(q) / p.J;
    const double own = strain_work(material, C, g, g), mixed = strain_work(material, C, g, h),
                 added = strain_work(material, C, h, h);
    for (std::size_t i = 0; i < 2; ++i) {
      const double w = area(cell) * p.J * (i == 0 ? r.rule.w[q] : r.coarse[q]);
      e[i] += 0.5 * w * own;
      b[i] += w * mixed;
      a[i] += 0.5 * w * added;
      if (load.cols() == 0) continue;
      work[i] += w / p.J * load.col(q).dot(value.col(q));
      added_work[i] += w / p.J * load.col(q).dot(added_value.col(q));
    }
    if (keep) {
      share.kept_strain.col(q) << g(0, 0), g(0, 1), g(1, 0), g(1, 1);
      added_strain.col(q) << h(0, 0), h(0, 1), h(1, 0), h(1, 1);
    }
    worst = std::max(worst, std::abs(g.trace() + h.trace()));
    share.gradient = std::max(share.gradient, g.cwiseAbs().maxCoeff());
    share.strain = std::max(share.strain, largest_strain(g) + largest_strain(h));
  }
  const double alpha = material.c == 0 ? 1 : a[0] > 0 ? -(b[0] - added_work[0]) / (2 * a[0]) : 0;
  const auto less_work = [&](std::size_t i) {
    return e[i] + alpha * (b[i] + alpha * a[i]) - work[i] - alpha * added_work[i];
  };
  const double energy = less_work(0), other = less_work(1);
  share.divergence = material.c == 0 ? worst : 0;
  share.above += doubt_of_rules * std::abs(energy - other);
  share.rules += doubt_of_rules * std::abs(energy - other);
  if (keep) {
    share.kept_strain += alpha * added_strain;
    share.kept_displacement = value + alpha * added_value;
  }
  share.elastic = e[0] + alpha * (b[0] + alpha * a[0]);
  share.upper = energy;
  share.size += share.elastic + std::abs(work[0]);
}

namespace {

/// How many times the area between an arc and its polynomial counts [theory: B.29].
constexpr double several = 4;

/// visit(point, distance times length, stress of the state on a side, its material) along the arc of an edge.
/// The distance is measured in the coordinates where the ellipse is the unit circle, and taken back by the larger
/// semi-axis: not less than the distance to the arc.
template <class Visit>
void along_arc(const Model& m, const Field& s, Index e, const Visit& visit) {
  static const EdgeRule rule = gauss(data_points);
  const Arc& arc = m.mesh.arcs[m.mesh.arc[e]];
  const Mat2 to_circle = arc.axes.inverse();
  const double radius = arc.axes.colwise().norm().maxCoeff();
  for (const Index t : m.mesh.sides[e]) {
    if (t == none || t >= own_triangles(m)) continue;
    const Triangle cell = triangle(m, t);
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const OnEdge p = on_edge(m.mesh, m.inner->skeleton.curvatures, e, rule.s[q]);
      const double distance = radius * std::abs((to_circle * (p.x - arc.center)).norm() - 1);
      visit(p.x, p.slope.norm() * rule.w[q] * distance,
            tensor(stress_at(m.inner->kernel, cell, s.interior.col(t), p.x)), material_of(m.mesh, m.scene, t));
    }
  }
}

/// |A s| is at most |s| (1/(2 mu) + 2 c), as |tr s| <= sqrt(2) |s|.
double strain_size(const Material& m, const Mat2& stress) {
  return stress.norm() * (1 / (2 * m.mu) + 2 * m.c);
}

}  // namespace

double beyond_arcs(const Model& m, const Field& s) {
  double total = 0;
  for (Index e = 0; e < static_cast<Index>(m.mesh.arc.size()); ++e)
    if (m.mesh.arc[e] != none)
      along_arc(m, s, e, [&](const Vec2&, double area, const Mat2& stress, const Material& material) {
        total += several * area * stress.norm() * strain_size(material, stress);
      });
  return total;
}

/// G leaves the arc free and not its polynomial: what it works there on the state is of the size of the area between
/// them.
double beyond_crack(const Model& m, const Field& s, Index crack, const Nucleus& G) {
  double total = 0;
  for (const CrackEdge& c : m.mesh.cracks[crack])
    if (!m.mesh.arc.empty() && m.mesh.arc[c.edge] != none)
      along_arc(m, s, c.edge, [&](const Vec2& x, double area, const Mat2& stress, const Material& material) {
        total += several * area * G.stress(x).norm() * strain_size(material, stress);
      });
  return total;
}

}  // namespace kerf
