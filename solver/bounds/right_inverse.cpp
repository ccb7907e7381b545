// Right inverses of the divergence on the reference triangle (equilateral, side 1), made once per degree [theory: B.5;
// Arnold, Qin 1992; Fu, Guzman, Neilan 2020]; docs/theory/bounds.md, "A stress in equilibrium".
// right_inverse: q in H^1_0(T)^2, continuous and of degree n + 1 on the three triangles that the centroid makes, with
//   div q = g for g in P_n(T) of zero mean,   |grad q| least.
// Unknowns are the Bernstein coefficients that do not lie on the boundary; div q = g is asked at the points of
// lattice(n) of each third; with the Cholesky factor of the Gram matrix of gradients the solution is one of least norm.
// normal_free_right_inverse: the same in H(div) with one polynomial on all of T, from fields l_i l_j p along the edges,
// which have no normal component on any edge. Polynomials are passed on by their values at lattice points.

#include "solver/bounds/right_inverse.hpp"

#include "solver/system.hpp"

#include "base/dense.hpp"
#include "base/polynomial.hpp"

#include <cmath>
#include <map>

namespace kerf {

namespace {

// Coordinates (l1, l2) -> equilateral.
Mat2 reference_jacobian() {
  Mat2 e;
  e << 1, 0.5, 0, std::sqrt(0.75);
  return e;
}

// Bernstein polynomials n!/(a! b! c!) l0^a l1^b l2^c in the order of lattice(n): dim(n) x points.
// Their values, not those of monomials, keep the small systems well conditioned.
Eigen::MatrixXd bernstein_values(int n, const Points& l) {
  Eigen::MatrixXd value(dim(n), l.cols());
  Eigen::Index row = 0;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n - j; ++i, ++row) {
      const double count = std::tgamma(n + 1) / (std::tgamma(i + 1) * std::tgamma(j + 1) * std::tgamma(n - i - j + 1));
      for (Eigen::Index q = 0; q < l.cols(); ++q)
        value(row, q) = std::round(count) * std::pow(l(0, q), i) * std::pow(l(1, q), j) *
                        std::pow(1 - l(0, q) - l(1, q), n - i - j);
    }
  return value;
}

// Their derivatives with respect to l1 and l2.
std::array<Eigen::MatrixXd, 2> bernstein_slopes(int n, const Points& l) {
  std::array<Eigen::MatrixXd, 2> slope;
  for (auto& s : slope) s = Eigen::MatrixXd::Zero(dim(n), l.cols());
  if (n == 0) return slope;
  const Eigen::MatrixXd lower = bernstein_values(n - 1, l);
  const auto at = [n](int i, int j) { return lattice_place(n, i, j); };
  const auto before = [n](int i, int j) { return lattice_place(n - 1, i, j); };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n - j; ++i) {
      const int k = n - i - j;
      if (i > 0) slope[0].row(at(i, j)) += n * lower.row(before(i - 1, j));
      if (j > 0) slope[1].row(at(i, j)) += n * lower.row(before(i, j - 1));
      if (k > 0)
        for (auto& s : slope) s.row(at(i, j)) -= n * lower.row(before(i, j));
    }
  return slope;
}

// d/dX = B^-T d/dl with B = dX/dl.
std::array<Eigen::MatrixXd, 2> rotated_slopes(const std::array<Eigen::MatrixXd, 2>& slope, const Mat2& b) {
  const Mat2 inverse = b.inverse();
  return {inverse(0, 0) * slope[0] + inverse(1, 0) * slope[1], inverse(0, 1) * slope[0] + inverse(1, 1) * slope[1]};
}

// Corner i + 1, corner i + 2, centroid: in (l1, l2).
// The third beside the edge opposite corner i.
std::array<Vec2, 3> third(int i) {
  const std::array<Vec2, 3> corner{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
  return {corner[(i + 1) % 3], corner[(i + 2) % 3], Vec2::Constant(1.0 / 3)};
}

Points in_third(int i, const Points& l) {
  const auto [a, b, c] = third(i);
  Points x(2, l.cols());
  for (Eigen::Index q = 0; q < l.cols(); ++q) x.col(q) = a + l(0, q) * (b - a) + l(1, q) * (c - a);
  return x;
}

// Continuous scalar functions of degree n on the split triangle that vanish on its boundary: per third, the number of
// each Bernstein function (none on the boundary).
// Two thirds share the functions of their common edge, and all three that of the centroid: a control point is known by
// its barycentric coordinates, times 3 n to be whole numbers.
struct Numbering {
  std::array<std::vector<Index>, 3> of;
  Index count = 0;
};

Numbering inner_functions(int n) {
  Numbering numbering;
  std::map<std::array<int, 3>, Index> known;  // control points in barycentric coordinates, times 3 n
  for (int t = 0; t < 3; ++t)
    for (int c = 0; c <= n; ++c)
      for (int b = 0; b <= n - c; ++b) {
        std::array<int, 3> key{c, c, c};
        key[(t + 1) % 3] += 3 * (n - b - c);
        key[(t + 2) % 3] += 3 * b;
        Index number = none;
        if (c > 0) number = known.emplace(key, static_cast<Index>(known.size())).first->second;
        numbering.of[t].push_back(number);
      }
  numbering.count = static_cast<Index>(known.size());
  return numbering;
}

/// Constraints depend on each other: the mean of the divergence is zero whatever q is.
constexpr double dependent = 1e-10;  // pivots, of the largest

}  // namespace

Points lattice(int n) {
  Points x(2, dim(n));
  if (n == 0) x.setConstant(1.0 / 3);
  Eigen::Index q = 0;
  for (int j = 0; n > 0 && j <= n; ++j)
    for (int i = 0; i <= n - j; ++i) x.col(q++) << static_cast<double>(i) / n, static_cast<double>(j) / n;
  return x;
}

/// Both bases span P_n: the values at `at` are V(at) V(lattice)^-1 times those at the lattice.
Eigen::MatrixXd interpolation(int n, const Points& at) {
  return solve_lu(bernstein_values(n, lattice(n)), bernstein_values(n, at)).transpose();
}

std::array<Eigen::MatrixXd, 2> differentiation(int n, const Points& at) {
  const Eigen::PartialPivLU<Eigen::MatrixXd> values = lu(bernstein_values(n, lattice(n)));
  const auto slope = rotated_slopes(bernstein_slopes(n, at), reference_jacobian());
  return {solve(values, slope[0]).transpose(), solve(values, slope[1]).transpose()};
}

/// dx/dX = (dx/dl) (dX/dl)^-1.
Mat2 jacobian(const std::array<Vec2, 3>& x) {
  Mat2 j;
  j << x[1] - x[0], x[2] - x[0];
  return j * reference_jacobian().inverse();
}

/// Functions that are polynomials on each third are integrated exactly, up to the degree of the rule.
TriangleRule split_rule(int degree) {
  const TriangleRule rule = triangle_rule(degree);
  const Eigen::Index n = rule.w.size();
  TriangleRule split{Points(2, 3 * n), Eigen::VectorXd(3 * n)};
  for (int t = 0; t < 3; ++t) {
    split.x.middleCols(t * n, n) = in_third(t, rule.x);
    split.w.segment(t * n, n) = rule.w / 3;
  }
  return split;
}

/// A polynomial of degree n on a third is known by dim(n) values: 3 dim(n) constraints for two components of inner
/// functions. Where they map onto all of zero mean the system has a solution; of those the one of least gradient is
/// independent of the basis.
RightInverse right_inverse(int degree, const TriangleRule& split) {
  const int order = degree + 1;
  const Numbering functions = inner_functions(order);
  const Eigen::Index count = functions.count, points = split.w.size() / 3, rows = dim(degree);
  const TriangleRule rule = triangle_rule(2 * degree);  // split_rule takes it to every third
  const Points nodes = lattice(degree);
  Eigen::MatrixXd value = Eigen::MatrixXd::Zero(3 * points, count), gram = Eigen::MatrixXd::Zero(count, count);
  std::array<Eigen::MatrixXd, 2> slope{value, value};
  Eigen::MatrixXd divergence = Eigen::MatrixXd::Zero(3 * rows, 2 * count), wanted(3 * rows, rows);
  for (int t = 0; t < 3; ++t) {
    const auto [a, b, c] = third(t);
    Mat2 map;
    map << b - a, c - a;
    map = reference_jacobian() * map;
    // Points of the given rule in this third, in its own coordinates.
    Points own(2, points);
    const Mat2 back = (Mat2() << b - a, c - a).finished().inverse();
    for (Eigen::Index q = 0; q < points; ++q) own.col(q) = back * (split.x.col(t * points + q) - a);
    const Eigen::MatrixXd here = bernstein_values(order, own);
    const auto slopes = rotated_slopes(bernstein_slopes(order, own), map),
               at_nodes = rotated_slopes(bernstein_slopes(order, nodes), map),
               at_rule = rotated_slopes(bernstein_slopes(order, rule.x), map);
    for (Eigen::Index f = 0; f < here.rows(); ++f) {
      const Index i = functions.of[t][f];
      if (i == none) continue;
      value.col(i).segment(t * points, points) = here.row(f).transpose();
      for (int axis = 0; axis < 2; ++axis) {
        slope[axis].col(i).segment(t * points, points) = slopes[axis].row(f).transpose();
        divergence.col(axis * count + i).segment(t * rows, rows) = at_nodes[axis].row(f).transpose();
      }
      for (Eigen::Index g = 0; g < here.rows(); ++g)
        if (const Index j = functions.of[t][g]; j != none)
          for (int axis = 0; axis < 2; ++axis)
            gram(i, j) += at_rule[axis].row(f).cwiseProduct(at_rule[axis].row(g)).dot(rule.w.transpose()) / 3;
    }
    wanted.middleRows(t * rows, rows) = interpolation(degree, in_third(t, nodes));
  }
  // Least norm in the metric of the gradients.
  const Eigen::LLT<Eigen::MatrixXd> factor = cholesky(gram);
  Eigen::MatrixXd scaled(divergence.rows(), divergence.cols());
  for (int axis = 0; axis < 2; ++axis)
    scaled.middleCols(axis * count, count) = solve_upper_from_right(divergence.middleCols(axis * count, count), factor);
  const Eigen::MatrixXd solution = solve_least_norm(scaled, wanted, dependent);
  RightInverse result{Eigen::MatrixXd(6 * points, rows), Eigen::MatrixXd(12 * points, rows)};
  for (int component = 0; component < 2; ++component) {
    const Eigen::MatrixXd part = solve_upper(factor, solution.middleRows(component * count, count));
    const Eigen::MatrixXd v = multiply(value, part), dx = multiply(slope[0], part), dy = multiply(slope[1], part);
    for (Eigen::Index q = 0; q < 3 * points; ++q) {
      result.value.row(2 * q + component) = v.row(q);
      result.derivative.row(4 * q + 2 * component) = dx.row(q);
      result.derivative.row(4 * q + 2 * component + 1) = dy.row(q);
    }
  }
  return result;
}

/// 3 dim(n - 2) fields, of which some are dependent for n > 2: eigenvectors of their Gram matrix below 1e-10 are
/// dropped.
Eigen::MatrixXd normal_free_right_inverse(int n) {
  // l_i l_j p along the edge from i to j, p in P_(n-2), over the three edges: all of them, some several times.
  const Points nodes = lattice(n);
  const TriangleRule rule = triangle_rule(2 * n);
  const Eigen::Index rows = dim(n), each = dim(n - 2);
  const std::array<Vec2, 3> corner{reference_jacobian() * Vec2(0, 0), reference_jacobian() * Vec2(1, 0),
                                   reference_jacobian() * Vec2(0, 1)};
  const auto barycentric = [](const Points& x) -> Eigen::Matrix3Xd {
    Eigen::Matrix3Xd l(3, x.cols());
    l << (1 - x.row(0).array() - x.row(1).array()).matrix(), x;
    return l;
  };
  const auto fields = [&](const Points& x) -> Eigen::MatrixXd {
    const Eigen::Matrix3Xd l = barycentric(x);
    const Eigen::MatrixXd p = bernstein_values(n - 2, x);
    Eigen::MatrixXd value(2 * x.cols(), 3 * each);
    for (int e = 0; e < 3; ++e) {
      const int from = (e + 1) % 3, to = (e + 2) % 3;
      const Vec2 along = corner[to] - corner[from];
      for (Eigen::Index f = 0; f < each; ++f)
        for (Eigen::Index q = 0; q < x.cols(); ++q)
          value.col(e * each + f).segment<2>(2 * q) = l(from, q) * l(to, q) * p(f, q) * along;
    }
    return value;
  };
  const Eigen::MatrixXd at_nodes = fields(nodes), at_rule = fields(rule.x);
  const auto d = differentiation(n, nodes);
  Eigen::MatrixXd divergence = Eigen::MatrixXd::Zero(rows, 3 * each);
  for (Eigen::Index q = 0; q < rows; ++q)
    divergence += d[0].col(q) * at_nodes.row(2 * q) + d[1].col(q) * at_nodes.row(2 * q + 1);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(3 * each, 3 * each);
  for (Eigen::Index q = 0; q < rule.w.size(); ++q)
    gram += rule.w[q] * at_rule.middleRows<2>(2 * q).transpose() * at_rule.middleRows<2>(2 * q);
  // An orthonormal basis of their span.
  const auto& [lambda, vectors] = eigenpairs(gram);
  Eigen::Index redundant = 0;
  while (lambda[redundant] < 1e-10 * lambda[lambda.size() - 1]) ++redundant;
  const Eigen::Index rank = lambda.size() - redundant;
  const Eigen::MatrixXd basis = vectors.rightCols(rank) * lambda.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd coefficients =
      solve_least_norm(multiply(divergence, basis), Eigen::MatrixXd::Identity(rows, rows), dependent);
  return multiply(at_nodes, basis, coefficients);
}

}  // namespace kerf
