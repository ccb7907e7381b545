// One elimination for all straight triangles of one shape, material and penalty. What the elimination gives is linear
// in the trace m, in the moments of the force and in theta, so that a column each of the interior (s, u, r) is made
// once; a triangle turns it to its own numbering of edges, directions of points and signs of frames. Shapes that are
// called equal differ by rounding, and so do their rigid motions R, which in slender bodies are far larger than the
// strains:
//   K <- P K P,   P = I - R (R'R)^-1 R'   [theory: E.18],
// with the triangle's own R, so that its own motions cost no energy. Derived in docs/theory/elements.md, section
// Slender bodies.

#include "solver/element/shared_shape.hpp"

#include "solver/element/motions.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

Mat2 outward_frame(const Triangle& t, int edge) {
  const Vec2 along = (t.x[(edge + 2) % 3] - t.x[(edge + 1) % 3]).normalized();
  return (Mat2() << Vec2(along.y(), -along.x()), along).finished();
}

/// Per unknown of the shape the one of the triangle and its sign: edges turn, along one that runs the other way the
/// points come in the opposite order, and frames point out or in.
struct Places {
  std::array<int, max_skeleton> at{};
  std::array<double, max_skeleton> sign{};
};
Places places(const Kernel& k, const LocalTriangle& t) {
  const int points = points_per_edge(k.element);
  Places p;
  int next = 0;
  for (int e = 0; e < 3; ++e) {
    const int own = (e + t.turn) % 3;
    const Vec2 along = t.shape.x[(own + 2) % 3] - t.shape.x[(own + 1) % 3];
    const double sign = t.shape.frame[own].col(1).dot(along) > 0 ? 1 : -1;
    for (int g = 0; g < points; ++g)
      for (int d = 0; d < 2; ++d, ++next) {
        p.at[next] = 2 * (points * own + (t.shape.forward[own] ? g : points - 1 - g)) + d;
        p.sign[next] = sign;
      }
  }
  return p;
}

/// Equal shapes differ by rounding, and so do their motions, which are far larger than what strains a triangle: its own
/// motions must cost nothing.
void drop_motions(const Kernel& k, const Triangle& t, Condensed& c) {
  const MotionTraces m = motion_traces(k, t, centroid(t), std::sqrt(2 * area(t)));
  using Columns = decltype(m.span);
  const Columns dual = m.span * m.inverse, by = c.K * m.span;
  const Columns half = by - dual * (0.5 * m.span.transpose() * by);
  // K <- P K P, P = I - dual span'
  for (Eigen::Index j = 0; j < c.K.cols(); ++j)
    for (Eigen::Index i = j; i < c.K.rows(); ++i) {
      for (int n = 0; n < 3; ++n) c.K(i, j) -= dual(i, n) * half(j, n) + half(i, n) * dual(j, n);
      c.K(j, i) = c.K(i, j);
    }
  if (c.trace.size() > 0) c.trace -= dual * (m.span.transpose() * c.trace);
}

}  // namespace

// Elements with packed kernels have all their unknowns on edges, in frames that turn by a sign.
bool can_share(const Kernel& k) {
  return k.run->condense_packed != nullptr;
}

bool can_share(const Triangle& t) {
  constexpr double rounding = 1e-13;
  if (is_curved(t)) return false;
  for (int e = 0; e < 3; ++e) {
    const Mat2 out = outward_frame(t, e);
    if (t.bent[e] || std::min((t.frame[e] - out).norm(), (t.frame[e] + out).norm()) > rounding) return false;
  }
  return true;
}

// All edges run counter-clockwise and all frames are (outward, along): the shape knows nothing of the mesh.
Triangle turned(const Triangle& t, int turn) {
  Triangle to;
  for (int i = 0; i < 3; ++i) {
    to.x[i] = t.x[(i + turn) % 3];
    to.forward[i] = true;
  }
  for (int i = 0; i < 3; ++i) to.frame[i] = outward_frame(to, i);
  return to;
}

// Unit traces, unit moments and theta = 1, each through the ordinary elimination.
SharedShape::SharedShape(const Kernel& k, const Triangle& of, const Material& material, double penalty, bool forced) {
  const int X = skeleton_count(k.element), U = forced ? displacement_count(k.element) : 0, T = penalty > 0 ? 1 : 0;
  const LocalTriangle plain{of, &material, forced ? ForceMoments::Zero(U).eval() : ForceMoments(), {.a = penalty}};
  // Once for the matrix, once per moment for what that adds to the mean of the trace.
  std::vector<LocalTriangle> units(static_cast<std::size_t>(T > 0 ? 1 + U : 1), plain);
  for (std::size_t i = 1; i < units.size(); ++i) units[i].force[static_cast<Eigen::Index>(i) - 1] = 1;
  std::vector<Condensed> shares(units.size());
  condense(k, units, shares);
  K_ = shares[0].K;
  trace_ = shares[0].trace;
  by_theta_ = shares[0].by_theta;
  own_.setZero(U);
  for (std::size_t i = 1; i < units.size(); ++i) own_[static_cast<Eigen::Index>(i) - 1] = shares[i].own;

  const std::size_t columns = static_cast<std::size_t>(X + U + T);
  units.assign(columns, plain);
  std::vector<Recovered> found(columns);
  interior_.resize(interior_count(k.element), X + U + T);
  for (std::size_t i = 0; i < columns; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    found[i].m = SkeletonVector::Zero(X);
    if (column < X)
      found[i].m[column] = 1;
    else if (column < X + U)
      units[i].force[column - X] = 1;
    else
      units[i].penalty.theta = 1;
    found[i].interior = interior_.col(column).data();
  }
  interiors(k, units, found);
  const LocalSystem local = local_system(k, of, material, {});
  tractions_ = local.h * local.Ct.transpose();
  given_.resize(X, U);
  for (Eigen::Index u = 0; u < U; ++u) given_.col(u) = found[static_cast<std::size_t>(X + u)].forces.given;
}

// by_theta and own are numbers of the shape: they do not turn.
Condensed SharedShape::condensed(const Kernel& k, const LocalTriangle& t) const {
  const Places p = places(k, t);
  const int X = static_cast<int>(K_.rows());
  Condensed c{SkeletonMatrix(X, X), SkeletonVector::Zero(X), {}, 0, 0};
  for (int j = 0; j < X; ++j) {
    double* to = &c.K(0, p.at[j]);
    for (int i = 0; i < X; ++i) to[p.at[i]] = p.sign[i] * p.sign[j] * K_(i, j);
  }
  if (t.force.size() > 0) {
    const SkeletonVector F = given_ * t.force;
    for (int i = 0; i < X; ++i) c.F[p.at[i]] = p.sign[i] * F[i];
  }
  if (trace_.size() > 0) {
    c.trace.resize(X);
    for (int i = 0; i < X; ++i) c.trace[p.at[i]] = p.sign[i] * trace_[i];
  }
  drop_motions(k, t.shape, c);
  if (trace_.size() == 0) return c;
  if (t.force.size() > 0) c.own = own_.dot(t.force);
  c.by_theta = by_theta_;
  return c;
}

void SharedShape::recover(const Kernel& k, const LocalTriangle& t, Recovered& to) const {
  const Places p = places(k, t);
  const int X = static_cast<int>(K_.rows()), U = static_cast<int>(t.force.size());
  SkeletonVector m(X), given = SkeletonVector::Zero(X);
  for (int i = 0; i < X; ++i) m[i] = p.sign[i] * to.m[p.at[i]];
  Eigen::Map<Eigen::VectorXd> interior(to.interior, interior_.rows());
  interior.noalias() = interior_.leftCols(X) * m;
  if (U > 0) {
    interior.noalias() += interior_.middleCols(X, U) * t.force;
    given.noalias() = given_ * t.force;
  }
  if (trace_.size() > 0) interior += t.penalty.theta * interior_.rightCols<1>();
  // From the stress, whose rounding balances itself; that of K m does not.
  const SkeletonVector of_trace = tractions_ * interior.head(tractions_.cols()) + given;
  to.forces.given.resize(X);
  to.forces.of_trace.resize(X);
  for (int i = 0; i < X; ++i) {
    to.forces.given[p.at[i]] = p.sign[i] * given[i];
    to.forces.of_trace[p.at[i]] = p.sign[i] * of_trace[i];
  }
}

}  // namespace kerf
