// Quadrature. On [0, 1] Gauss-Legendre rules of n points, exact to degree 2 n - 1: the zeros of P_n by Newton's method
// on
//   k P_k = (2 k - 1) x P_(k-1) - (k - 1) P_(k-2),   w_i = 1/((1 - x_i^2) P_n'(x_i)^2),
// half of the weights on [-1, 1]. On the triangle symmetric rules up to degree 5 [Dunavant 1985], and above products of
// Gauss rules, collapsed by (r, s) -> (r (1 - s), r s). With k + 1 points on an edge the nodal basis at the points is
// orthogonal, which makes traces and tractions meet point by point [theory: E.5]; docs/theory/elements.md, section
// Hybridization.

#include "base/quadrature.hpp"

#include <cmath>
#include <initializer_list>

namespace kerf {

EdgeRule gauss(int points) {
  EdgeRule rule{Eigen::VectorXd(points), Eigen::VectorXd(points)};
  for (int i = 0; i < points; ++i) {
    // Newton on P_n from the classical first guess.
    double x = std::cos(pi * (i + 0.75) / (points + 0.5)), slope = 1;
    for (int sweep = 0; sweep < 100; ++sweep) {
      double before = 1, value = x;
      for (int k = 2; k <= points; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
        before = value;
        value = next;
      }
      slope = points == 1 ? 1 : points * (x * value - before) / (x * x - 1);
      const double step = value / slope;
      x -= step;
      if (std::abs(step) < 1e-16) break;
    }
    rule.s[points - 1 - i] = 0.5 * (1 + x);
    rule.w[points - 1 - i] = 1 / ((1 - x * x) * slope * slope);
  }
  return rule;
}

Eigen::VectorXd trace_basis(const EdgeRule& trace, double s) {
  const Eigen::Index n = trace.s.size();
  Eigen::VectorXd value = Eigen::VectorXd::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      if (j != i) value[i] *= (s - trace.s[j]) / (trace.s[i] - trace.s[j]);
  return value;
}

namespace {

struct Orbit {  // points (a, b, c) and permutations: 1, 3 (two equal) of them
  double weight, first;
};

// All weights are positive and all points inside the triangle.
TriangleRule symmetric(double centroid_weight, std::initializer_list<Orbit> orbits) {
  const int n = (centroid_weight > 0 ? 1 : 0) + 3 * static_cast<int>(orbits.size());
  TriangleRule rule{Points(2, n), Eigen::VectorXd(n)};
  int q = 0;
  if (centroid_weight > 0) {
    rule.x.col(q).setConstant(1.0 / 3);
    rule.w[q++] = centroid_weight;
  }
  for (const Orbit& o : orbits) {
    const double a = o.first, b = 0.5 * (1 - a);
    rule.x.col(q) << b, b;
    rule.x.col(q + 1) << a, b;
    rule.x.col(q + 2) << b, a;
    rule.w.segment(q, 3).setConstant(o.weight);
    q += 3;
  }
  return rule;
}

// (r, s) -> (r (1 - s), r s) maps the unit square onto the triangle with Jacobian r: one more point along r integrates
// that factor.
TriangleRule collapsed(int degree) {
  const int n = degree / 2 + 1;
  const EdgeRule line = gauss(n), radial = gauss(n + 1);
  TriangleRule rule{Points(2, n * (n + 1)), Eigen::VectorXd(n * (n + 1))};
  int q = 0;
  for (int i = 0; i < n + 1; ++i)
    for (int j = 0; j < n; ++j, ++q) {
      const double r = radial.s[i];
      rule.x.col(q) << r * (1 - line.s[j]), r * line.s[j];
      rule.w[q] = 2 * r * radial.w[i] * line.w[j];
    }
  return rule;
}

}  // namespace

TriangleRule triangle_rule(int degree) {
  if (degree <= 1) return symmetric(1, {});
  if (degree == 2) return symmetric(0, {{1.0 / 3, 2.0 / 3}});
  if (degree <= 4) {
    return symmetric(
        0, {{0.223381589678011465944, 0.108103018168070226664}, {0.109951743655321867640, 0.816847572980458513080}});
  }
  if (degree == 5) {
    const double root = std::sqrt(15.0);
    return symmetric(0.225,
                     {{(155 + root) / 1200, 1 - 2 * (6 + root) / 21}, {(155 - root) / 1200, 1 - 2 * (6 - root) / 21}});
  }
  return collapsed(degree);
}

}  // namespace kerf
