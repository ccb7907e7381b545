// Taylor coefficients of a solved stress field at a point, as those of Kolosov's potentials [Muskhelishvili 1953;
// theory: Q.2].
//   phi' = sum A_k z^k, psi' = sum B_k z^k, k <= 5,   tr s = 4 Re phi',   s22 - s11 + 2i s12 = 2 (conj(z) phi'' + psi')
// are fitted to the element's own stress over a disc of radius R, in the mean of squares with the weight (1 -
// r^2/R^2)^2. On whole circles the terms are orthogonal and the coefficients are Fourier means, free of truncation;
// here they average the error of the element over the disc. The Gram matrix depends on the disc alone and is factorized
// once for all fields. docs/theory/second_order.md, section "How it is computed".

#include "topo/map/taylor.hpp"

#include "base/quadrature.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace kerf {

namespace {

using Complex = std::complex<double>;

// phi' = sum A_k z^k, psi' = sum B_k z^k up to this degree, z in radii: Re A_0, then real and imaginary parts.
constexpr int degree = 5, unknowns = 1 + 2 * degree + 2 * (degree + 1);
using Row = Eigen::Matrix<double, 1, unknowns>;
using Rows = Eigen::Matrix<double, 3, unknowns>;

// Of tr s / sqrt(2) and (s22 - s11 + 2i s12)/sqrt(2): their squares sum to s : s.
// Row 0 is tr s, rows 1 and 2 the deviator; a column per real unknown. Im A_0 is a rotation, without stress, and has
// none.
Rows rows_at(const Complex& z) {
  Rows r = Rows::Zero();
  const auto put = [&](int column, double trace, const Complex& deviator) {
    r.col(column) << trace, deviator.real(), deviator.imag();
  };
  const double unit = 1 / std::sqrt(2.0);
  const Complex i(0, 1);
  Complex power = 1, before = 0;  // z^k, k z^(k - 1)
  for (int k = 0; k <= degree; ++k) {
    const Complex bent = 2.0 * unit * std::conj(z) * before;
    if (k == 0) {
      put(0, 4 * unit, 0);
    } else {
      put(2 * k - 1, 4 * unit * power.real(), bent);
      put(2 * k, 4 * unit * (i * power).real(), i * bent);
    }
    const int first = 1 + 2 * degree + 2 * k;
    put(first, 0, 2.0 * unit * power);
    put(first + 1, 0, 2.0 * unit * i * power);
    before = static_cast<double>(k + 1) * power;
    power *= z;
  }
  return r;
}

template <class Do>
void over_points(const Model& m, const std::vector<Index>& use, const Vec2& at, double radius, const Do& take) {
  // Points beyond the radius have no weight: triangles on the rim count with what lies inside.
  static const TriangleRule rule = triangle_rule(5);
  for (const Index t : use) {
    const Triangle shape = triangle(m, t);
    const Points x = rule_points(rule, shape);
    const double size = area(shape) / (radius * radius);
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      const Vec2 d = (x.col(q) - at) / radius;
      const double inner = 1 - d.squaredNorm();
      if (inner > 0) take(t, shape, Vec2(x.col(q)), Complex(d.x(), d.y()), size * rule.w[q] * inner * inner);
    }
  }
}

}  // namespace

// Triangles around x by a front from that of x, sorted: sums do not depend on the way.
TaylorFit::TaylorFit(const Model& m, const Vec2& x, Index start, double radius) : m_(m), at_(x), radius_(radius) {
  // Neighbors are taken while one of their vertices lies in the disc.
  const auto reaches = [&](Index t) {
    return std::ranges::any_of(m.mesh.triangles[t], [&](Index v) { return (m.mesh.points[v] - x).norm() < radius; });
  };
  use_.push_back(start);
  std::unordered_set<Index> seen{start};
  for (std::size_t i = 0; i < use_.size(); ++i)
    for (const Index e : m.mesh.edges_of[use_[i]])
      for (const Index t : m.mesh.sides[e])
        if (t != none && seen.insert(t).second && reaches(t)) use_.push_back(t);
  std::sort(use_.begin(), use_.end());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(unknowns, unknowns);
  over_points(m, use_, x, radius, [&](Index, const Triangle&, const Vec2&, const Complex& z, double weight) {
    const Rows r = rows_at(z);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(r.transpose(), weight);
  });
  fit_.compute(gram.selfadjointView<Eigen::Lower>());
}

bool TaylorFit::coarse() const {
  // The fit has 23 unknowns.
  constexpr std::size_t least = 24;
  return use_.size() < least;
}

// Moments of the field with the columns, then the factor of the Gram matrix.
TaylorField TaylorFit::of(const Field& s) const {
  const double unit = 1 / std::sqrt(2.0);
  Eigen::VectorXd moments = Eigen::VectorXd::Zero(unknowns);
  over_points(m_, use_, at_, radius_,
              [&](Index t, const Triangle& shape, const Vec2& x, const Complex& z, double weight) {
                const Eigen::Vector4d v = stress_at(m_.inner->kernel, shape, s.interior.col(t), x);
                const Eigen::Vector3d value = unit * Eigen::Vector3d(v[0] + v[3], v[3] - v[0], v[1] + v[2]);
                moments += weight * rows_at(z).transpose() * value;
              });
  const Eigen::VectorXd c = fit_.solve(moments);
  const auto a = [&](int k) { return Complex(c[2 * k - 1], c[2 * k]); };
  const auto b = [&](int k) { return Complex(c[1 + 2 * degree + 2 * k], c[2 + 2 * degree + 2 * k]); };
  // From phi' and psi' in units of the radius: a_n = A_(n-1)/(n R^(n-1)).
  return {.a1 = c[0],
          .a2 = a(1) / (2 * radius_),
          .a3 = a(2) / (3 * radius_ * radius_),
          .b1 = b(0),
          .b2 = b(1) / (2 * radius_)};
}

}  // namespace kerf
