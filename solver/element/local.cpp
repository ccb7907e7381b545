// One triangle, for all elements: picks the compiled operations of an element (local_<family>.cpp), and what needs no
// compile-time sizes. That is the quadrature of an element (`kernel`), the cut of its stresses as the null space of
// linear conditions [theory: E.10, E.11], moments of body forces against its displacements, and the map of a curved
// triangle from the triangle of its chords, with l the barycentric coordinates,
//   Phi(X) = X + sum over curved edges of l_a l_b q(1/2 (1 + l_b - l_a)),   D = D Phi,   J = det D   [theory: E.25].
// `condense` and `interiors` of many triangles sort them: those with a shared elimination take it, straight ones go by
// fours through the packed kernels, the others one by one: what is done with a triangle depends on itself.
// Hybridization, spaces and curved triangles: docs/theory/elements.md.

#include "solver/element/local.hpp"
#include "solver/element/shared_shape.hpp"

#include "base/dense.hpp"
#include "base/polynomial.hpp"

#include <fmt/core.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace kerf {

// Eigen looks at the room of vectors in builds with assertions only.
static_assert(std::ranges::all_of(elements, [](const Element& e) {
  return skeleton_count(e) <= max_skeleton && displacement_count(e) + stress_count(e) <= max_moments;
}));

// One file per family instantiates the kernel.
const Operations* bdms_operations(int degree);
const Operations* afw_operations(int degree);
const Operations* continuous_rotation_operations(Cut cut);
const Operations* arnold_winther_operations(Cut cut);
const Operations* vertex_stress_operations();
const Operations* displacement_operations(int degree);

namespace {

const Operations* operations(const Element& e) {
  switch (e.at_vertices) {
    case AtVertices::Displacement:
      return displacement_operations(e.displacement);
    case AtVertices::Stress:
      return vertex_stress_operations();
    case AtVertices::Rotation:
      return continuous_rotation_operations(e.cut);
    case AtVertices::Nothing:
      break;
  }
  if (is_symmetric(e)) return arnold_winther_operations(e.cut);
  return e.bubble < 0 ? afw_operations(e.degree) : bdms_operations(e.degree);
}

// Columns are the stress functions that the cut leaves, rows their coefficients in the full tensors (4 m + c: monomial
// m, component c) and the bubbles. RaviartThomas is spanned explicitly (E.10); the symmetric spaces are the null space
// of symmetry (s12 = s21 for each monomial) and of the high derivatives of the divergence (E.11).
Eigen::MatrixXd constant_cut(const Element& e) {
  const int monomials = dim(e.stress), full = stress_count(e);
  switch (e.cut) {
    case Cut::None:
      break;
    case Cut::RaviartThomas: {
      // The constants, xi in either row, the bubbles.
      Eigen::MatrixXd span = Eigen::MatrixXd::Zero(full, stress_dimension(e));
      span.topLeftCorner<4, 4>().setIdentity();
      for (int row = 0; row < 2; ++row)
        for (int axis = 0; axis < 2; ++axis) span(4 * (1 + axis) + 2 * row + axis, 4 + row) = 1;
      const int bubbles = full - 4 * monomials;
      span.bottomRightCorner(bubbles, bubbles).setIdentity();
      return span;
    }
    case Cut::LinearNormal:
    case Cut::LinearDivergence: {
      // Symmetry; then no derivatives of the divergence beyond P_1. The conditions of LinearNormal depend on the
      // triangle.
      const int high = e.cut == Cut::LinearDivergence ? dim(e.stress - 1) - dim(1) : 0;
      Eigen::MatrixXd conditions = Eigen::MatrixXd::Zero(monomials + 2 * high, full);
      for (int m = 0; m < monomials; ++m) {
        conditions(m, 4 * m + 1) = 1;
        conditions(m, 4 * m + 2) = -1;
      }
      const Eigen::MatrixXd d[2] = {derivative(e.stress, 0), derivative(e.stress, 1)};
      for (int row = 0; row < 2; ++row)
        for (int k = 0; k < high; ++k)
          for (int axis = 0; axis < 2; ++axis)
            for (int m = 0; m < monomials; ++m)
              conditions(monomials + 2 * k + row, 4 * m + 2 * row + axis) = d[axis](dim(1) + k, m);
      return null_space(conditions);
    }
  }
  return {};
}

}  // namespace

double area(const Triangle& t) {
  return 0.5 * cross(t.x[1] - t.x[0], t.x[2] - t.x[0]);
}

Vec2 centroid(const Triangle& t) {
  return (t.x[0] + t.x[1] + t.x[2]) / 3;
}

/// Degrees of the rules: products of two stresses; data of degree 8 against a displacement; where a triangle is curved,
/// the numerator S D' D R' of degree 4 k + 2 (with bubbles), which J divides: the quotient is rational, and no rule is
/// exact for it (E.27).
Kernel kernel(const Element& e) {
  const int points = points_per_edge(e);
  Kernel k{e,
           operations(e),
           constant_cut(e),
           triangle_rule(2 * stress_degree(e)),
           triangle_rule(8 + e.displacement),
           can_be_curved(e) ? triangle_rule(4 * e.stress + 2) : TriangleRule{},
           points > 0 ? gauss(points) : EdgeRule{},
           gauss(std::max({1, e.stress, points})),
           {}};
  k.trace_at_edge.resize(points, k.edge.s.size());
  for (Eigen::Index q = 0; q < k.edge.s.size(); ++q) k.trace_at_edge.col(q) = trace_basis(k.trace, k.edge.s[q]);
  return k;
}

Triangle cell_of(const Mesh& mesh, const EdgeCurvatures& curvatures, Index t) {
  Triangle cell;
  for (int i = 0; i < 3; ++i) {
    const Index edge = mesh.edges_of[t][i];
    cell.x[i] = mesh.points[mesh.triangles[t][i]];
    cell.forward[i] = mesh.sides[edge][0] == t;
    cell.curvature[i] = curvature_at(curvatures, edge);
  }
  return cell;
}

namespace {

// grad l_i: inward normal of edge i over twice the area.
std::array<Vec2, 3> barycentric_slopes(const Triangle& t) {
  const double twice = 2 * area(t);
  std::array<Vec2, 3> slope;
  for (int i = 0; i < 3; ++i) {
    const Vec2 e = t.x[(i + 2) % 3] - t.x[(i + 1) % 3];
    slope[i] = Vec2(-e.y(), e.x()) / twice;
  }
  return slope;
}

// Of a curved edge at a point of the triangle: its ends in its own direction, l_a l_b, s.
struct Bowed {
  int a, b;
  double both, s;
};
// s = 1/2 (1 + l_b - l_a) is 0 at a, 1 at b, and l_a l_b = s (1 - s) on the edge itself (l_a + l_b = 1).
Bowed bowed(const Triangle& t, int e, const std::array<double, 3>& l) {
  const int a = (e + (t.forward[e] ? 1 : 2)) % 3, b = (e + (t.forward[e] ? 2 : 1)) % 3;
  return {a, b, l[a] * l[b], 0.5 * (1 + l[b] - l[a])};
}

}  // namespace

// D by the product and chain rules: grad(l_a l_b) = l_b grad l_a + l_a grad l_b, grad s = 1/2 (grad l_b - grad l_a).
CellMap cell_map(const Triangle& t, const Vec2& l) {
  const std::array<double, 3> at = {1 - l.x() - l.y(), l.x(), l.y()};
  CellMap map{at[0] * t.x[0] + at[1] * t.x[1] + at[2] * t.x[2], Mat2::Identity(), 1};
  if (!is_curved(t)) return map;
  const std::array<Vec2, 3> slope = barycentric_slopes(t);
  for (int e = 0; e < 3; ++e) {
    if (!t.curvature[e]) continue;
    const auto [a, b, both, s] = bowed(t, e, at);
    const Vec2 q = height(*t.curvature[e], s), along = height_slope(*t.curvature[e], s);
    map.x += both * q;
    map.D +=
        q * (at[b] * slope[a] + at[a] * slope[b]).transpose() + 0.5 * both * along * (slope[b] - slope[a]).transpose();
  }
  map.J = map.D.determinant();
  return map;
}

// Second derivatives of Phi; q is quadratic in s, so that its second derivative is 2 q[2].
std::array<Mat2, 2> cell_map_slopes(const Triangle& t, const Vec2& l) {
  const std::array<double, 3> at = {1 - l.x() - l.y(), l.x(), l.y()};
  const std::array<Vec2, 3> slope = barycentric_slopes(t);
  std::array<Mat2, 2> D = {Mat2::Zero(), Mat2::Zero()};
  for (int e = 0; e < 3; ++e) {
    if (!t.curvature[e]) continue;
    const auto [a, b, both, s] = bowed(t, e, at);
    const Vec2 q = height(*t.curvature[e], s), first = height_slope(*t.curvature[e], s),
               second = 2 * t.curvature[e]->q[2], of_both = at[b] * slope[a] + at[a] * slope[b],
               of_s = 0.5 * (slope[b] - slope[a]);
    for (int axis = 0; axis < 2; ++axis)
      D[axis] += of_s[axis] * first * of_both.transpose() +
                 q * (slope[b][axis] * slope[a] + slope[a][axis] * slope[b]).transpose() +
                 (of_both[axis] * first + both * of_s[axis] * second) * of_s.transpose();
  }
  return D;
}

// Newton's method from the coordinates in the triangle of the chords. It ends at rounding, where a step gains nothing,
// or where J is not positive: outside of the triangle the polynomial map need not have an inverse.
Vec2 cell_coordinates(const Triangle& t, const Vec2& x) {
  Mat2 sides;
  sides << t.x[1] - t.x[0], t.x[2] - t.x[0];
  const Mat2 inverse = sides.inverse();
  Vec2 l = inverse * (x - t.x[0]);
  if (!is_curved(t)) return l;
  constexpr int most = 30;
  const double h = std::sqrt(2 * area(t)), close = 1e-15 * (h + x.cwiseAbs().maxCoeff());
  double before = infinity;
  for (int step = 0; step < most; ++step) {
    const CellMap map = cell_map(t, l);
    const Vec2 left = x - map.x;
    const double size = left.norm();
    if (size <= close || !(size < before) || !(map.J > 0)) break;
    before = size;
    l += inverse * map.D.inverse() * left;
  }
  return l;
}

const TriangleRule& stress_rule(const Kernel& k, const Triangle& t) {
  return is_curved(t) ? k.curved : k.rule;
}

// int f over the curved triangle is area(chords) sum_q w_q J(x_q) f(Phi(x_q)).
Eigen::VectorXd rule_weights(const TriangleRule& rule, const Triangle& t) {
  Eigen::VectorXd w = rule.w;
  if (is_curved(t))
    for (Eigen::Index q = 0; q < w.size(); ++q) w[q] *= cell_map(t, rule.x.col(q)).J;
  return w;
}

double cell_area(const Triangle& t) {
  static const TriangleRule exact = triangle_rule(6);  // J is of twice the degree of the element at most
  return is_curved(t) ? area(t) * rule_weights(exact, t).sum() : area(t);
}

Points rule_points(const TriangleRule& rule, const Triangle& t) {
  Points x(2, rule.w.size());
  if (is_curved(t)) {
    for (Eigen::Index q = 0; q < x.cols(); ++q) x.col(q) = cell_map(t, rule.x.col(q)).x;
    return x;
  }
  for (Eigen::Index q = 0; q < x.cols(); ++q)
    x.col(q) = (1 - rule.x(0, q) - rule.x(1, q)) * t.x[0] + rule.x(0, q) * t.x[1] + rule.x(1, q) * t.x[2];
  return x;
}

// The spaces of a curved triangle are those of its chords, taken over by the map: their monomials are evaluated at the
// points of the triangle of the chords.
Points chord_points(const TriangleRule& rule, const Triangle& t) {
  return (rule_points(rule, chords_of(t)).colwise() - centroid(t)) / std::sqrt(2 * area(t));
}

// What a rigid motion is to a curved triangle: its displacements contain polynomials of the chords' coordinates, not
// Phi itself.
Points seen_places(const Kernel& k, const Triangle& t) {
  const Points x = rule_points(k.curved, t);
  const Eigen::MatrixXd v = monomials(k.element.displacement, chord_points(k.curved, t)),
                        weighted = v * k.curved.w.asDiagonal();
  return solve_spd(multiply_transposed(weighted, v), multiply(weighted, Eigen::MatrixXd(x.transpose()))).transpose();
}

// Means over the triangle of the chords, with J: (f, v)/area.
ForceMoments force_moments(const Kernel& k, const Triangle& t, const Points& force) {
  const Points x = rule_points(k.load, t);
  const Eigen::VectorXd w = rule_weights(k.load, t);
  const Eigen::MatrixXd v = monomials(k.element.displacement, chord_points(k.load, t));
  ForceMoments moments = ForceMoments::Zero(displacement_count(k.element));
  for (Eigen::Index q = 0; q < x.cols(); ++q) {
    const Vec2 at = x.col(q), value = force.col(q);
    if (!value.allFinite())
      throw Error(Fault::Numerics, fmt::format("the body force is not finite at ({:.6g}, {:.6g})", at.x(), at.y()));
    for (Eigen::Index b = 0; b < v.rows(); ++b) moments.segment<2>(2 * b) += w[q] * v(b, q) * value;
  }
  return moments;
}

// Three-term recurrence n P_n = (2n - 1) x P_(n-1) - (n - 1) P_(n-2) on [-1, 1], scaled to norm 1 on [0, 1].
double legendre(int k, double s) {
  const double x = 2 * s - 1;
  double before = 0, value = 1;
  for (int n = 0; n < k; ++n) {
    const double next = ((2 * n + 1) * x * value - n * before) / (n + 1);
    before = value;
    value = next;
  }
  return std::sqrt(2.0 * k + 1) * value;
}

// Points are those of the edge in its own direction, from its smaller to its larger vertex, so that both triangles
// beside it number them alike.
Vec2 trace_point(const Kernel& k, const Triangle& t, int edge, int point) {
  const Vec2& from = t.x[(edge + 1) % 3];
  const Vec2& to = t.x[(edge + 2) % 3];
  const double own = k.trace.s[point], along = t.forward[edge] ? own : 1 - own;
  const Vec2 on_chord = from + along * (to - from);
  return t.curvature[edge] ? Vec2(on_chord + own * (1 - own) * height(*t.curvature[edge], own)) : on_chord;
}

Condensed condense(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force,
                   const Penalty& penalty) {
  return k.run->condense(k, t, material, force, penalty);
}

Eigen::VectorXd interior(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force,
                         const SkeletonVector& m, const Penalty& penalty) {
  return k.run->interior(k, t, material, force, m, penalty, nullptr);
}

Eigen::VectorXd interior(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force,
                         const SkeletonVector& m, const Penalty& penalty, TraceForces& forces) {
  return k.run->interior(k, t, material, force, m, penalty, &forces);
}

namespace {

/// Triangles with a shared shape by that; straight ones by fours through `packed`, where the element has it, the others
/// one by one: what is done with a triangle depends on itself.
template <class Result, class Alone, class Shared>
void by_fours(const Kernel& k, std::span<const LocalTriangle> all, std::span<Result> to,
              void (*packed)(const Kernel&, const PackedTriangles&, int, Result* const*), const Alone& alone,
              const Shared& shared) {
  PackedTriangles four{};
  std::array<Result*, four.size()> results{};
  std::size_t count = 0;
  const auto flush = [&] {
    if (count == 0) return;
    for (std::size_t i = count; i < four.size(); ++i) four[i] = four[count - 1];
    packed(k, four, static_cast<int>(count), results.data());
    count = 0;
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].shared) {
      shared(*all[i].shared, all[i], to[i]);
      continue;
    }
    const bool strained = all[i].force.size() > displacement_count(k.element);
    if (!packed || strained || is_curved(all[i].shape)) {
      alone(all[i], to[i]);
      continue;
    }
    four[count] = &all[i];
    results[count] = &to[i];
    if (++count == four.size()) flush();
  }
  flush();
}

}  // namespace

void condense(const Kernel& k, std::span<const LocalTriangle> all, std::span<Condensed> to) {
  by_fours(
      k, all, to, k.run->condense_packed,
      [&](const LocalTriangle& t, Condensed& result) {
        result = condense(k, t.shape, *t.material, t.force, t.penalty);
      },
      [&](const SharedShape& s, const LocalTriangle& t, Condensed& result) { result = s.condensed(k, t); });
}

void interiors(const Kernel& k, std::span<const LocalTriangle> all, std::span<Recovered> to) {
  by_fours(
      k, all, to, k.run->interior_packed,
      [&](const LocalTriangle& t, Recovered& result) {
        const Eigen::VectorXd found = interior(k, t.shape, *t.material, t.force, result.m, t.penalty, result.forces);
        Eigen::Map<Eigen::VectorXd>(result.interior, found.size()) = found;
      },
      [&](const SharedShape& s, const LocalTriangle& t, Recovered& result) { s.recover(k, t, result); });
}

Eigen::MatrixXd interiors(const Kernel& k, const Triangle& t, const Material& material, const Eigen::MatrixXd& m) {
  if (k.run->interiors) return k.run->interiors(k, t, material, m);
  Eigen::MatrixXd all(interior_count(k.element), m.cols());
  for (Eigen::Index i = 0; i < m.cols(); ++i) all.col(i) = interior(k, t, material, {}, m.col(i));
  return all;
}

void interiors_lanes(const Kernel& k, const Triangle& t, const Material& material, const double* m, double* all) {
  k.run->interiors_lanes(k, t, material, m, all);
}

void evaluate_lanes(const Kernel& k, const Triangle& t, const double* interior, const Points& x, double* fields) {
  k.run->evaluate_lanes(t, interior, x, fields);
}

void loaded(const Kernel& k, const Triangle& t, const Material& material, const Eigen::MatrixXd& forces, Loaded& to) {
  k.run->loaded(k, t, material, forces, to);
}

LocalSystem local_system(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force) {
  require(k.element, can_stay_uncondensed);
  return k.run->local_system(k, t, material, force);
}

Eigen::VectorXd interior_of(const Kernel& k, const Triangle& t, const Material& material, const Eigen::VectorXd& local,
                            const SkeletonVector& m) {
  return k.run->interior_of(k, t, material, local, m);
}

DualLoad condense_dual(const Kernel& k, const Triangle& t, const Material& material, const Eigen::VectorXd& J,
                       const Penalty& penalty) {
  require(k.element, can_adjoint);
  return k.run->condense_dual(k, t, material, J, penalty);
}

Eigen::VectorXd interior_dual(const Kernel& k, const Triangle& t, const Material& material, const Eigen::VectorXd& J,
                              const SkeletonVector& mu, const Penalty& penalty) {
  require(k.element, can_adjoint);
  return k.run->interior_dual(k, t, material, J, mu, penalty);
}

Eigen::VectorXd weigh(const Kernel& k, const Triangle& t, const Points& x, const Fields& w) {
  return k.run->weigh(t, x, w);
}

Fields evaluate(const Kernel& k, const Triangle& t, Eigen::Ref<const Eigen::VectorXd> interior, const Points& x) {
  return k.run->evaluate(t, interior, x);
}

Eigen::Vector4d stress_at(const Kernel& k, const Triangle& t, Eigen::Ref<const Eigen::VectorXd> interior,
                          const Vec2& x) {
  return k.run->stress_at(t, interior, x);
}

}  // namespace kerf
