// Displacements of one degree more than the stresses, corner values, and the profiles of cracks. On each triangle of a
// mixed element u* solves, for all polynomials v of its degree,
//   (grad u*, grad v) = (A s + Gamma(omega) + eigenstrain, grad v),   int u* = int u      [Stenberg 1991; theory: R.1],
// by monomials of degree 1 to D about the centroid, of which the mean is taken off. Straight triangles take the tables
// of the reference triangle and the metric of the map; curved ones integrate on the body. Each has its transpose
// (weigh_*), which carries the derivative of a functional of u* back to the coefficients of s, u, omega: step by step
// backwards, so that it is exact. recovered_lanes is the same for several fields side by side. Displacement elements
// have their own u. The rest of the file reads points of cracks: jumps, pressures, and whether the faces touch.
// docs/theory/recovery_and_estimates.md.

#include "kerf/recover.hpp"

#include "solver/recovery.hpp"

#include "solver/system.hpp"

#include "base/parallel.hpp"
#include "base/polynomial.hpp"

#include <Eigen/Cholesky>

#include <array>
#include <cmath>
#include <vector>

namespace kerf {

namespace {

// The monomials of degree 1 to D and their gradients (columns).
template <int D>
struct Monomials {
  static constexpr int count = dim(D) - 1;
  Eigen::Matrix<double, count, 1> value;
  Eigen::Matrix<double, 2, count> gradient;
  explicit Monomials(const Vec2& xi) {
    const auto at = [&](int i, int j) -> double {
      if (i < 0 || j < 0) return 0;
      return i + j == 0 ? 1 : value[place(i, j) - 1];
    };
    for (int degree = 1; degree <= D; ++degree)
      for (int j = 0; j <= degree; ++j) {
        const int i = degree - j, m = place(i, j) - 1;
        value[m] = i > 0 ? at(i - 1, j) * xi.x() : at(i, j - 1) * xi.y();
        gradient.col(m) << i * at(i - 1, j), j * at(i, j - 1);
      }
  }
};

// The local problem of u*: sums over the element's rule.
template <int D>
struct Projection {
  static constexpr int n = Monomials<D>::count;
  Triangle shape;
  Vec2 center;
  double h;
  const TriangleRule& rule;
  Points q;
  Eigen::VectorXd w;  // over the triangle; means are those that the displacements have, over the one of its chords
  Eigen::Matrix<double, n, n> stiffness = Eigen::Matrix<double, n, n>::Zero();
  Eigen::Matrix<double, n, 1> mean = Eigen::Matrix<double, n, 1>::Zero();

  Projection(const Model& model, Index t)
      : shape(triangle(model, t)),
        center(centroid(shape)),
        h(std::sqrt(2 * area(shape))),
        rule(stress_rule(model.inner->kernel, shape)),
        q(rule_points(rule, shape)),
        w(rule_weights(rule, shape)) {
    for (Eigen::Index i = 0; i < q.cols(); ++i) {
      const Monomials<D> v = at(q.col(i));
      stiffness += w[i] * v.gradient.transpose() * v.gradient;
      mean += rule.w[i] * v.value;
    }
  }
  Monomials<D> at(const Vec2& x) const {
    return Monomials<D>((x - center) / h);
  }
};

// What the strain of s has beyond that of an isotropic material.
void add_orthotropic(const Material& m, const Eigen::Vector4d& s, Eigen::Ref<Eigen::Vector4d> to) {
  if (isotropic(m)) return;
  const Eigen::Vector3d more = orthotropic_strain(m, s[0], s[3], 0.5 * (s[1] + s[2]));
  to += Eigen::Vector4d(more[0], more[2], more[2], more[1]);
}

// Straight triangles: u* = mean + sum_k c_k (v_k - mean v_k), v_k the monomials of degree 1 to D in scaled barycentric
// coordinates, in which all that does not depend on the triangle's shape is tabled. D lies above the degree of the
// strains, which is that of the stresses without their bubbles.
// With G = grad v in the scaled coordinates and M = inverse of the map, (grad v_i, grad v_j) = G_i M M' G_j': three
// tables.
template <int D>
struct Tables {
  static constexpr int n = Monomials<D>::count;
  using Matrix = Eigen::Matrix<double, n, n>;
  std::array<Matrix, 3> stiffness;  // of the products of derivatives 1 1, 1 2 and 2 1, 2 2
  Eigen::Matrix<double, n, 1> mean;
  std::vector<Eigen::Matrix<double, n, 2>> weighted;  // per point of the rule the gradients, times the weight

  static constexpr double scale = 1.5;  // coordinates up to 1
  static Vec2 coordinates(const Vec2& l) {
    return scale * (l - Vec2::Constant(1.0 / 3));
  }
  /// Products of gradients by the rule of the element, exact for them; one table for each of the two rules that may
  /// occur.
  explicit Tables(const TriangleRule& rule) {
    for (Matrix& s : stiffness) s.setZero();
    mean.setZero();
    for (Eigen::Index q = 0; q < rule.w.size(); ++q) {
      const Monomials<D> v(coordinates(rule.x.col(q)));
      const Eigen::Matrix<double, n, 2> g = scale * v.gradient.transpose();
      mean += rule.w[q] * v.value;
      stiffness[0] += rule.w[q] * g.col(0) * g.col(0).transpose();
      stiffness[1] += rule.w[q] * (g.col(0) * g.col(1).transpose() + g.col(1) * g.col(0).transpose());
      stiffness[2] += rule.w[q] * g.col(1) * g.col(1).transpose();
      weighted.push_back(rule.w[q] * g);
    }
  }
  // Of the kernel's rule, which follows from the degree of the stresses: D - 1, or D with bubbles of higher degree.
  static const Tables& of(const Kernel& k) {
    static const std::array<Tables, 2> all = {Tables(triangle_rule(2 * (D - 1))), Tables(triangle_rule(2 * D))};
    return all[static_cast<std::size_t>(stress_degree(k.element) - (D - 1))];
  }
};

template <int D>
struct StraightProjection {
  static constexpr int n = Tables<D>::n;
  const Tables<D>& tables;
  Vec2 origin;
  Mat2 inverse;  // of the map from barycentric coordinates
  Eigen::LLT<typename Tables<D>::Matrix> stiffness;

  StraightProjection(const Kernel& k, const Triangle& t) : tables(Tables<D>::of(k)), origin(t.x[0]) {
    Mat2 sides;
    sides << t.x[1] - t.x[0], t.x[2] - t.x[0];
    inverse = sides.inverse();
    const Mat2 metric = inverse * inverse.transpose();
    stiffness.compute(metric(0, 0) * tables.stiffness[0] + metric(0, 1) * tables.stiffness[1] +
                      metric(1, 1) * tables.stiffness[2]);
  }
  // v - mean v
  Eigen::Matrix<double, n, 1> at(const Vec2& x) const {
    const Vec2 l = Tables<D>::coordinates(inverse * (x - origin));
    Eigen::Matrix<double, n, 1> v;
    v[0] = l.x();
    v[1] = l.y();
    for (int degree = 2, k = 2; degree <= D; ++degree) {
      const int before = k - degree;
      for (int j = 0; j < degree; ++j) v[k + j] = v[before + j] * l.x();
      v[k + degree] = v[before + degree - 1] * l.y();
      k += degree + 1;
    }
    return v - tables.mean;
  }
};

template <int D>
/// load_k = sum_q w_q grad v_k . D with D = A s + Gamma(omega) + eigenstrain; the stiffness is factorized once per
/// triangle for both components.
Points recovered_straight(const Model& model, const Triangle& shape, const Eigen::Ref<const Eigen::VectorXd>& interior,
                          Index t, const Points& x, double eigenstrain) {
  const StraightProjection<D> p(model.inner->kernel, shape);
  const TriangleRule& rule = model.inner->kernel.rule;
  const Points q = rule_points(rule, shape);
  const Fields f = evaluate(model.inner->kernel, shape, interior, q);
  const bool strained = !model.inner->data.strain.empty();
  const Eigen::Matrix4Xd free = strained ? eigenstrain_at(model, eigenstrain, t, q) : Eigen::Matrix4Xd();
  Eigen::Matrix<double, p.n, 2> load = Eigen::Matrix<double, p.n, 2>::Zero();
  Vec2 mean = Vec2::Zero();
  const Material& material = material_of(model.mesh, model.scene, t);
  for (Eigen::Index i = 0; i < q.cols(); ++i) {
    Eigen::Vector4d d = displacement_gradient(material, f.stress.col(i), f.rotation[i]);
    if (strained) d += free.col(i);
    load += p.tables.weighted[static_cast<std::size_t>(i)] * (p.inverse * Eigen::Map<const Mat2>(d.data()));
    mean += rule.w[i] * f.displacement.col(i);
  }
  const Eigen::Matrix<double, p.n, 2> c = p.stiffness.solve(load);
  Points u(2, x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i) u.col(i) = mean + c.transpose() * p.at(x.col(i));
  return u;
}

template <int D>
Points recovered(const Model& model, const Eigen::Ref<const Eigen::VectorXd>& interior, Index t, const Points& x,
                 double eigenstrain) {
  if (const Triangle shape = triangle(model, t); !is_curved(shape))
    return recovered_straight<D>(model, shape, interior, t, x, eigenstrain);
  const Projection<D> p(model, t);
  const Fields f = evaluate(model.inner->kernel, p.shape, interior, p.q);
  const Eigen::Matrix4Xd free = eigenstrain_at(model, eigenstrain, t, p.q);
  Eigen::Matrix<double, p.n, 2> load = Eigen::Matrix<double, p.n, 2>::Zero();
  Vec2 mean_displacement = Vec2::Zero();
  const Material& material = material_of(model.mesh, model.scene, t);
  for (Eigen::Index i = 0; i < p.q.cols(); ++i) {
    const Monomials<D> v = p.at(p.q.col(i));
    const Eigen::Vector4d d = displacement_gradient(material, f.stress.col(i), f.rotation[i]) + free.col(i);
    load.col(0) += p.w[i] * v.gradient.transpose() * d.head<2>();
    load.col(1) += p.w[i] * v.gradient.transpose() * d.tail<2>();
    mean_displacement += p.rule.w[i] * f.displacement.col(i);
  }
  // d/dx = 1/h d/dxi: coefficients in xi are h times the solution.
  const Eigen::Matrix<double, p.n, 2> c = p.h * p.stiffness.llt().solve(load);
  Points u(2, x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    u.col(i) = mean_displacement + c.transpose() * (p.at(x.col(i)).value - p.mean);
  return u;
}

template <int D>
/// As for one field, with the inverse of the stiffness: it is applied to sixteen right-hand sides. Isotropic materials
/// alone, gradients without eigenstrain, which the caller adds to the stress.
void recovered_side_by_side(const Model& model, Index t, const double* fields, const Points& x, double* u) {
  using Row = Eigen::Array<double, 1, lanes>;
  using ByLane = Eigen::Matrix<double, Projection<D>::n, 2 * lanes, Eigen::RowMajor>;
  const Projection<D> p(model, t);
  const Material& m = material_of(model.mesh, model.scene, t);
  ByLane load = ByLane::Zero();
  Row mean[2] = {Row::Zero(), Row::Zero()};
  for (Eigen::Index i = 0; i < p.q.cols(); ++i) {
    const auto at = [&](int k) { return Eigen::Map<const Row>(fields + (i * lane_fields + k) * lanes); };
    const Row pressure = m.c * (at(0) + at(3)), difference = (at(0) - at(3)) / (4 * m.mu);
    const Row d[4] = {pressure + difference, at(1) / (2 * m.mu) + at(6), at(2) / (2 * m.mu) - at(6),
                      pressure - difference};
    const Monomials<D> v = p.at(p.q.col(i));
    for (int k = 0; k < p.n; ++k)
      for (int c = 0; c < 2; ++c)
        Eigen::Map<Row>(&load(k, c * lanes)) +=
            p.w[i] * v.gradient(0, k) * d[2 * c] + p.w[i] * v.gradient(1, k) * d[2 * c + 1];
    for (int c = 0; c < 2; ++c) mean[c] += p.rule.w[i] * at(4 + c);
  }
  const Eigen::Matrix<double, Projection<D>::n, Projection<D>::n> inverse =
      p.stiffness.llt().solve(decltype(p.stiffness)(decltype(p.stiffness)::Identity()));
  ByLane c = ByLane::Zero();
  for (int i = 0; i < p.n; ++i)
    for (int k = 0; k < p.n; ++k) c.row(i) += p.h * inverse(i, k) * load.row(k);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Eigen::Matrix<double, Projection<D>::n, 1> value = p.at(x.col(i)).value - p.mean;
    for (int k = 0; k < 2; ++k) {
      Row sum = mean[k];
      for (int j = 0; j < p.n; ++j) sum += value[j] * Eigen::Map<const Row>(&c(j, k * lanes));
      Eigen::Map<Row>(u + (2 * i + k) * lanes) = sum;
    }
  }
}

// By the stresses, from the derivative by the gradient d1 u1, d2 u1, d1 u2, d2 u2.
// The transpose of A, which is symmetric.
Eigen::Vector4d by_stress(const Material& m, const Eigen::Vector4d& d) {
  const double difference = (d[0] - d[3]) / (4 * m.mu), trace = m.c * (d[0] + d[3]);
  Eigen::Vector4d s(difference + trace, d[1] / (2 * m.mu), d[2] / (2 * m.mu), trace - difference);
  add_orthotropic(m, d, s);
  return s;
}

// The transpose, step by step backwards.
template <int D>
/// u(x) = mean + c' (v(x) - mean v), c = K^-1 load(D): the weights of u give those of c and of the mean, these those of
/// D, and D is linear in the stress and the rotation.
Eigen::VectorXd weigh_straight(const Model& model, const Triangle& shape, Index t, const Points& x,
                               const Points& weights) {
  const StraightProjection<D> p(model.inner->kernel, shape);
  const TriangleRule& rule = model.inner->kernel.rule;
  const Points q = rule_points(rule, shape);
  Eigen::Matrix<double, p.n, 2> by_c = Eigen::Matrix<double, p.n, 2>::Zero();
  Vec2 by_mean = Vec2::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    by_c += p.at(x.col(i)) * weights.col(i).transpose();
    by_mean += weights.col(i);
  }
  const Eigen::Matrix<double, p.n, 2> by_load = p.stiffness.solve(by_c);
  Fields w{Eigen::Matrix4Xd(4, q.cols()), Points(2, q.cols()), Eigen::RowVectorXd(q.cols())};
  const Material& m = material_of(model.mesh, model.scene, t);
  for (Eigen::Index i = 0; i < q.cols(); ++i) {
    const Mat2 gradient =
        p.inverse.transpose() * (p.tables.weighted[static_cast<std::size_t>(i)].transpose() * by_load);
    const Eigen::Vector4d d = Eigen::Map<const Eigen::Vector4d>(gradient.data());
    w.stress.col(i) = by_stress(m, d);
    w.rotation[i] = d[1] - d[2];
    w.displacement.col(i) = rule.w[i] * by_mean;
  }
  return weigh(model.inner->kernel, shape, q, w);
}

template <int D>
Eigen::VectorXd weigh_recovered(const Model& model, Index t, const Points& x, const Points& weights) {
  if (const Triangle shape = triangle(model, t); !is_curved(shape))
    return weigh_straight<D>(model, shape, t, x, weights);
  const Projection<D> p(model, t);
  Eigen::Matrix<double, p.n, 2> by_c = Eigen::Matrix<double, p.n, 2>::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) by_c += (p.at(x.col(i)).value - p.mean) * weights.col(i).transpose();
  const Vec2 by_mean = weights.rowwise().sum();
  const Eigen::Matrix<double, p.n, 2> by_load = p.h * p.stiffness.llt().solve(by_c);
  Fields w{Eigen::Matrix4Xd(4, p.q.cols()), Points(2, p.q.cols()), Eigen::RowVectorXd(p.q.cols())};
  const Material& m = material_of(model.mesh, model.scene, t);
  for (Eigen::Index i = 0; i < p.q.cols(); ++i) {
    const Monomials<D> v = p.at(p.q.col(i));
    Eigen::Vector4d d;  // by the gradient d1 u1, d2 u1, d1 u2, d2 u2
    d << v.gradient * by_load.col(0), v.gradient * by_load.col(1);
    d *= p.w[i];
    w.stress.col(i) = by_stress(m, d);
    w.rotation[i] = d[1] - d[2];
    w.displacement.col(i) = p.rule.w[i] * by_mean;
  }
  return weigh(model.inner->kernel, p.shape, p.q, w);
}

/// visit<D>(), D the degree of u*.
template <class Visit>
/// One degree more than the stresses without bubbles, 2 to 5.
auto by_degree(const Model& model, const Visit& visit) {
  switch (model.element.stress) {
    case 1:
      return visit.template operator()<2>();
    case 2:
      return visit.template operator()<3>();
    case 3:
      return visit.template operator()<4>();
    default:
      return visit.template operator()<5>();
  }
}

}  // namespace

/// Order d1 u1, d2 u1, d1 u2, d2 u2; the rotation has the sign of (N.1), + in d2 u1.
Eigen::Vector4d displacement_gradient(const Material& m, const Eigen::Vector4d& s, double rotation) {
  const double trace = s[0] + s[3], pressure = m.c * trace;
  const double difference = 0.5 * (s[0] - s[3]) / (2 * m.mu);
  Eigen::Vector4d gradient(difference + pressure, s[1] / (2 * m.mu) + rotation, s[2] / (2 * m.mu) - rotation,
                           -difference + pressure);
  add_orthotropic(m, s, gradient);
  return gradient;
}

Points recovered_displacement(const Model& model, const Field& state, Index t, const Points& x) {
  return recovered_displacement(model, Eigen::Ref<const Eigen::VectorXd>(state.interior.col(t)), t, x,
                                state.eigenstrain);
}

Points recovered_displacement(const Model& model, const Eigen::Ref<const Eigen::VectorXd>& interior, Index t,
                              const Points& x, double eigenstrain) {
  if (!is_mixed(model.element)) return evaluate(model.inner->kernel, triangle(model, t), interior, x).displacement;
  return by_degree(model, [&]<int D>() { return recovered<D>(model, interior, t, x, eigenstrain); });
}

void recovered_lanes(const Model& model, Index t, const double* fields, const Points& x, double* u) {
  by_degree(model, [&]<int D>() { recovered_side_by_side<D>(model, t, fields, x, u); });
}

Eigen::VectorXd weigh_recovered(const Model& model, Index t, const Points& x, const Points& weights) {
  if (!is_mixed(model.element)) {
    const Fields w{Eigen::Matrix4Xd::Zero(4, x.cols()), weights, Eigen::RowVectorXd::Zero(x.cols())};
    return weigh(model.inner->kernel, triangle(model, t), x, w);
  }
  return by_degree(model, [&]<int D>() { return weigh_recovered<D>(model, t, x, weights); });
}

/// Averages over the triangles at a corner, weighted by area; corners on the two sides of a crack are different ones.
CornerValues corner_values(const Model& model, const Field& state, const Corners& corners) {
  const Index triangles = static_cast<Index>(model.mesh.triangles.size());
  const Eigen::Index n = static_cast<Eigen::Index>(corners.vertex.size());
  // Values in every triangle in parallel, then sums in the order of the triangles.
  Eigen::Matrix<double, 7, Eigen::Dynamic> local(7, Eigen::Index{3} * triangles);
  parallel_for(triangles, model.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Triangle shape = triangle(model, t);
      Points x(2, 3);
      x << shape.x[0], shape.x[1], shape.x[2];
      const Fields f = evaluate(model.inner->kernel, shape, state.interior.col(t), x);
      auto block = local.middleCols<3>(Eigen::Index{3} * t);
      block.topRows<2>() = recovered_displacement(model, state, t, x);
      block.middleRows<4>(2) = f.stress;
      block.row(6) = f.rotation;
    }
  });
  Eigen::Matrix<double, 7, Eigen::Dynamic> sum = Eigen::Matrix<double, 7, Eigen::Dynamic>::Zero(7, n);
  Eigen::RowVectorXd weight = Eigen::RowVectorXd::Zero(n);
  for (Index t = 0; t < triangles; ++t) {
    const double w = cell_area(model, t);
    for (int i = 0; i < 3; ++i) {
      sum.col(corners.of[t][i]) += w * local.col(Eigen::Index{3} * t + i);
      weight[corners.of[t][i]] += w;
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) sum.col(i) /= weight[i];
  return {sum.topRows<2>(), sum.middleRows<4>(2), sum.row(6)};
}

std::vector<Material> corner_materials(const Model& model, const Corners& corners) {
  std::vector<Material> materials(corners.vertex.size(), model.scene.material);
  for (Index t = 0; t < static_cast<Index>(model.mesh.triangles.size()); ++t)
    for (const Index corner : corners.of[t]) materials[corner] = material_of(model.mesh, model.scene, t);
  return materials;
}

/// Of several triangles at a corner the last one.
Eigen::MatrixXd corner_eigenstrains(const Model& model, const Corners& corners) {
  Eigen::MatrixXd strains = Eigen::MatrixXd::Zero(5, static_cast<Eigen::Index>(corners.vertex.size()));
  const StrainData& data = model.inner->data.strain;
  if (data.empty()) return strains;
  const Points at = (Points(2, 3) << 0, 1, 0, 0, 0, 1).finished();
  for (Index t = 0; t < static_cast<Index>(model.mesh.triangles.size()); ++t) {
    const Eigen::Matrix4Xd e = strain_at(data, t, at);
    const Eigen::RowVectorXd e33 = strain_33_at(data, t, at);
    for (int i = 0; i < 3; ++i) strains.col(corners.of[t][i]) << e.col(i), e33[i];
  }
  return strains;
}

/// The root of the mean of |s|^2 at centroids, over the triangles that the process owns.
double mean_stress(const Model& model, const Field& state) {
  double square = 0;
  for (Index t = 0; t < own_triangles(model); ++t) {
    const Triangle shape = triangle(model, t);
    square += cell_area(model, t) *
              stress_at(model.inner->kernel, shape, state.interior.col(t), centroid(shape)).squaredNorm();
  }
  return std::sqrt(square / area(model));
}

/// Of the material on the left of the crack's first edge.
double modulus_beside(const Model& model, Index crack) {
  const Index beside = model.mesh.sides[model.mesh.cracks[crack].front().edge][0];
  return plane_modulus(material_of(model.mesh, model.scene, beside));
}

namespace {

// Below these a pressure or a gap is rounding: relative to the opening that the mean stress could cause.
// A jump that is the difference of two large rigid motions has their rounding: hence the second bound.
struct Smallest {
  double pressure, gap;
};
Smallest smallest(const Model& model, const Field& field, Index crack, double crack_length) {
  constexpr double rounding = 1e-8;
  const double modulus = modulus_beside(model, crack);
  const double floor = 1e-12 * field.skeleton.cwiseAbs().maxCoeff();  // of a large rigid motion
  const double pressure = std::max(rounding * mean_stress(model, field), floor * modulus / crack_length);
  return {pressure, pressure * crack_length / modulus};
}

// The jumps and the forces of contact at the Gauss points of mixed elements.
// Forces of contact are per edge and Gauss point: over the length of the point's share they are tractions.
void read_jump(const Model& model, const Field& field, Index edge, int g, CrackPoint& p) {
  const Index unknown = model.inner->skeleton.jump[edge] + 2 * g;
  p.jump_n = field.skeleton[unknown];
  if (has_gap(model.scene.laws[model.mesh.crack[edge]])) p.gap = -model.inner->skeleton.prescribed[unknown];
  p.jump_t = -field.skeleton[unknown + 1];
  if (!is_unilateral(model.scene.laws[model.mesh.crack[edge]])) return;
  p.sigma_n -= field.force[unknown] / p.length;
  p.sigma_t = field.force[unknown + 1] / p.length;
}

// Displacement elements have no jumps of their own.
void evaluate_jump(const Model& model, const Field& field, Index edge, CrackPoint& p) {
  const auto side = [&](int which) -> Vec2 {
    return evaluate(model, field, model.mesh.sides[edge][which], p.at).displacement.col(0);
  };
  const Vec2 jump = model.inner->skeleton.frame[edge].transpose() * (side(1) - side(0));
  p.jump_n = jump[0];
  p.jump_t = -jump[1];
}

// What a bonded crack transmits: the stress on its left.
// The stress at the point in the triangle on the left; tension is positive, shear as in CrackPoint.
void evaluate_traction(const Model& model, const Field& field, Index edge, int g, CrackPoint& p) {
  const Index left = model.mesh.sides[edge][0];
  const Eigen::Vector4d v = stress_at(model.inner->kernel, triangle(model, left), field.interior.col(left), p.at);
  const Mat2& frame = frame_at(model.inner->skeleton, edge, g);
  const Vec2 n = frame.col(0), traction(v[0] * n.x() + v[1] * n.y(), v[2] * n.x() + v[3] * n.y());
  p.sigma_n = traction.dot(n);
  p.sigma_t = -traction.dot(frame.col(1));
}

/// Neither pressure nor gap: biactive, where a small change of the load may open or close the point.
CrackPoint::Status status_of(const CrackPoint& p, CrackLaw::Kind law, const Smallest& least) {
  const bool gap = p.distance() > least.gap, pressure = p.contact_pressure() > least.pressure;
  if (law == CrackLaw::Kind::Bonded || pressure) return CrackPoint::Status::Closed;
  return gap || law != CrackLaw::Kind::Unilateral ? CrackPoint::Status::Open : CrackPoint::Status::Biactive;
}

}  // namespace

/// Along a curved edge by Gauss points of |dx/ds|.
double length_along(const Model& model, Index edge) {
  const EdgeCurvatures& curvatures = model.inner->skeleton.curvatures;
  if (!curvature_at(curvatures, edge)) return length(model.mesh, edge);
  static const EdgeRule rule = gauss(8);
  double sum = 0;
  for (Eigen::Index q = 0; q < rule.s.size(); ++q)
    sum += rule.w[q] * on_edge(model.mesh, curvatures, edge, rule.s[q]).slope.norm();
  return sum;
}

/// Points run along the path of the crack, edges that lie against it are read backwards. `done` counts lengths along
/// curves, so that s is the arc length.
std::vector<CrackPoint> crack_profile(const Model& model, const Field& field, Index crack) {
  const CrackLaw::Kind law = model.scene.laws[crack].kind;
  const bool mixed = is_mixed(model.element);
  const EdgeRule rule = mixed ? model.inner->kernel.trace : gauss(2);
  const int points = static_cast<int>(rule.s.size());
  double total = 0, done = 0;
  for (const CrackEdge& c : model.mesh.cracks[crack]) total += length(model.mesh, c.edge);
  if (total == 0) return {};
  const Smallest least = smallest(model, field, crack, total);
  const BoundaryField& fluid = model.scene.laws[crack].pressure;
  std::vector<CrackPoint> profile;
  for (const CrackEdge& c : model.mesh.cracks[crack]) {
    const double l = length_along(model, c.edge);
    for (int k = 0; k < points; ++k) {
      const int g = c.forward ? k : points - 1 - k;
      const double along = rule.s[g];
      CrackPoint p{};
      p.s = done + l * (c.forward ? along : 1 - along);
      const OnEdge on = on_edge(model.mesh, model.inner->skeleton.curvatures, c.edge, along);
      p.at = on.x;
      p.length = on.slope.norm() * rule.w[g];
      if (fluid) p.fluid_pressure = fluid(p.at, normal(model.mesh, c.edge))[0];
      p.sigma_n = -p.fluid_pressure;
      if (mixed)
        read_jump(model, field, c.edge, g, p);
      else
        evaluate_jump(model, field, c.edge, p);
      if (law == CrackLaw::Kind::Bonded) evaluate_traction(model, field, c.edge, g, p);
      p.status = status_of(p, law, least);
      profile.push_back(p);
    }
    done += l;
  }
  return profile;
}

}  // namespace kerf
