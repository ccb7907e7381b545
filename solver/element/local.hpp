#pragma once
// One triangle: the dense stationary system of the element, its condensation onto the edges, and the way back. The only
// place where unknowns are eliminated.

#include "base/quadrature.hpp"
#include "kerf/scene.hpp"
#include "kerf/state.hpp"
#include "solver/element/edge_curvature.hpp"
#include "solver/element/spaces.hpp"

#include <array>
#include <span>

namespace kerf {

struct Triangle {
  std::array<Vec2, 3> x;        // counter-clockwise; edge i is opposite vertex i
  std::array<Mat2, 3> frame;    // per edge: columns are the directions of its two components
  std::array<bool, 3> forward;  // the edge's own direction (smaller to larger vertex) is counter-clockwise here
  // Per vertex, columns are what its unknowns stand for: displacements (2 x 2), or stresses s11, s22, sqrt(2) s12.
  std::array<Eigen::Matrix3d, 3> corner = {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity(),
                                           Eigen::Matrix3d::Identity()};
  // Per edge its frames at the Gauss points where they differ along it (curved cracks), or nothing.
  std::array<const Mat2*, 3> bent = {nullptr, nullptr, nullptr};
  // Per edge how it curves, or nothing where it is straight.
  std::array<const EdgeCurvature*, 3> curvature = {nullptr, nullptr, nullptr};
};

inline bool is_curved(const Triangle& t) {
  return t.curvature[0] || t.curvature[1] || t.curvature[2];
}
/// Triangle t of a mesh, its edges without frames. The curvatures must outlive it.
Triangle cell_of(const Mesh& mesh, const EdgeCurvatures& curvatures, Index t);
/// With straight edges instead.
inline Triangle chords_of(Triangle t) {
  t.curvature = {};
  return t;
}

inline const Mat2& frame_at(const Triangle& t, int edge, int point) {
  return t.bent[edge] ? t.bent[edge][point] : t.frame[edge];
}

/// Skeleton unknowns of one triangle: per edge, per Gauss point in the edge's direction, two components in its frame;
/// then per vertex.
inline constexpr int max_skeleton = 30;
using SkeletonMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, max_skeleton, max_skeleton>;
using SkeletonVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, max_skeleton, 1>;

struct Operations;  // of one element on one triangle

/// What the local problems of one element share: quadrature and trace points. Made once per model.
struct Kernel {
  Element element;
  const Operations* run;
  Eigen::MatrixXd cut;            // per stress function its coefficients in the full tensors, where the cut is constant
  TriangleRule rule;              // exact for products of two stresses
  TriangleRule load;              // for data: exact to degree 8
  TriangleRule curved;            // in place of `rule` in curved triangles, where products of stresses are rational
  EdgeRule trace;                 // the Gauss points that carry the multipliers; the middle in p2
  EdgeRule edge;                  // exact for the moments of a normal stress of higher degree than the trace
  Eigen::MatrixXd trace_at_edge;  // the trace functions at its points
};
Kernel kernel(const Element& e);

/// Means over T of f v for v in P_displacement(T)^2 (monomials scaled to the triangle): all that the element sees of f.
/// With stresses at vertices the data of supported edges follow, whose normal stress is cubic but whose trace is
/// linear: per edge the x, y components of the Legendre coefficients 2 and 3 of the prescribed displacement, along the
/// edge. With an eigenstrain its means against the stress functions follow (stress_count of them).
inline constexpr int max_moments = 88;
using ForceMoments = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, max_moments, 1>;
inline constexpr int cubic_trace_count = 12;
/// The means alone, from the values of f at the points of Kernel::load.
ForceMoments force_moments(const Kernel& k, const Triangle& t, const Points& force);
/// Orthonormal Legendre polynomial of degree k on [0, 1].
double legendre(int k, double s);

/// Towards nu = 1/2 the compliance c of a constant pressure vanishes, and with it digits of K. Adding a (t.s)^2/|T| /
/// 2, t.s = int_T tr s, makes it c + a; the term is paid back by the load theta (t.s) with theta = a mean(tr s), found
/// by a short iteration [iterated penalty; theory: E.12, E.13]. a = 0: neither.
struct Penalty {
  double a = 0;      // compliance
  double theta = 0;  // strain, from the sweep before
};

/// Stationary point over (s, u, r) for given edge displacements m [theory: E.2, E.4] of
///   1/2 (A s, s) + (e, s) + (u, div s + f) + (r, s12 - s21) - <m, s n>_dT,      e: the eigenstrain,
/// condensed:  K m - F = C s  with C the map from s to the moments of s n, so that  sum_T (K m - F) = tractions.
/// `force` holds the moments of f and e (see ForceMoments), or is empty when there is neither.
struct Condensed {
  SkeletonMatrix K;  // symmetric, positive semidefinite: the rigid motions are its kernel
  SkeletonVector F;
  // With a penalty: theta changes F by -theta trace, and mean(tr s) = trace.m/|T| + own + theta by_theta.
  SkeletonVector trace;
  double own = 0, by_theta = 0;
};
Condensed condense(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force,
                   const Penalty& penalty = {});

/// Coefficients (s, u, r) from the edge displacements; the same elimination, backwards.
Eigen::VectorXd interior(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force,
                         const SkeletonVector& m, const Penalty& penalty = {});

/// What the triangle's boundary gives and takes: f = of_trace - given are the moments of s n.
struct TraceForces {
  SkeletonVector of_trace;  // K m, and theta trace with a penalty
  SkeletonVector given;     // Condensed::F
};
/// `interior` with the forces that it finds on the way.
Eigen::VectorXd interior(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force,
                         const SkeletonVector& m, const Penalty& penalty, TraceForces& forces);

struct SharedShape;  // element/shared_shape.hpp

/// One of several triangles that are eliminated side by side: four straight ones of bdms or afw without an eigenstrain
/// take little more time than one; one whose shape has been eliminated already takes next to none.
struct LocalTriangle {
  Triangle shape;
  const Material* material = nullptr;
  ForceMoments force = {};  // of all triangles, or of none
  Penalty penalty = {};     // likewise
  const SharedShape* shared = nullptr;
  int turn = 0;  // vertex i of the shared shape is vertex (i + turn) % 3
};
/// What `condense` finds of each. The bits of a triangle do not depend on the others, but for its shared shape.
void condense(const Kernel& k, std::span<const LocalTriangle> all, std::span<Condensed> to);
struct Recovered {
  SkeletonVector m;            // given
  double* interior = nullptr;  // room for the coefficients (s, u, r)
  TraceForces forces = {};
};
/// What `interior` finds of each.
void interiors(const Kernel& k, std::span<const LocalTriangle> all, std::span<Recovered> to);

/// The same for several traces without a body force (columns), one elimination.
Eigen::MatrixXd interiors(const Kernel& k, const Triangle& t, const Material& material, const Eigen::MatrixXd& m);

/// Of several loads (columns of ForceMoments), one elimination: what they do in a triangle whose edges rest, and
/// Condensed::F. The columns must be there.
struct Loaded {
  Eigen::Ref<Eigen::MatrixXd> interior, given;
};
void loaded(const Kernel& k, const Triangle& t, const Material& material, const Eigen::MatrixXd& forces, Loaded& to);

/// Fields side by side: of a number of rows, row after row, `lanes` values each.
inline constexpr int lanes = 8, lane_fields = 7;  // s11, s12, s21, s22, u1, u2, r
/// As `interiors`, straight triangles: traces m and coefficients side by side.
void interiors_lanes(const Kernel& k, const Triangle& t, const Material& material, const double* m, double* all);
/// Per point x the lane_fields values of the fields with these coefficients.
void evaluate_lanes(const Kernel& k, const Triangle& t, const double* interior, const Points& x, double* fields);

/// The dual local problem: the same matrix under right-hand sides -J, J the derivative of a quantity by the interior
/// coefficients (s, u, r; as long as an interior column).
struct DualLoad {
  SkeletonVector F;  // K mu = sum_T F + derivatives by the skeleton
  double own = 0;    // as Condensed::own
};
/// Both throw Error(Usage) for elements that are not mixed or have stresses at vertices.
DualLoad condense_dual(const Kernel& k, const Triangle& t, const Material& material, const Eigen::VectorXd& J,
                       const Penalty& penalty = {});
Eigen::VectorXd interior_dual(const Kernel& k, const Triangle& t, const Material& material, const Eigen::VectorXd& J,
                              const SkeletonVector& mu, const Penalty& penalty = {});

Fields evaluate(const Kernel& k, const Triangle& t, Eigen::Ref<const Eigen::VectorXd> interior, const Points& x);
/// Its transpose: the derivative by the interior coefficients of sum_q w_q . fields(x_q).
Eigen::VectorXd weigh(const Kernel& k, const Triangle& t, const Points& x, const Fields& w);

/// The local problem as it stands, for formulations that do not condense it. In xi = (x - centroid)/h with u = h u_xi,
/// m = h m_xi (rotations at vertices, the last columns of Ct, as they are), h^2 times it is the problem in x:
///   M s + Bt (u_xi, r) = Ct m_xi + strain,   Bt' s = given,   tractions = h Ct' s.
struct LocalSystem {
  double h;
  Eigen::MatrixXd M, Bt, Ct;
  Eigen::VectorXd given, trace;  // trace: int tr s, in xi
  Eigen::VectorXd strain;        // of an eigenstrain; empty without one
};
/// Throws Error(Usage) for an element that has no such problem.
LocalSystem local_system(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force);
/// Coefficients (s, u, r) from a solution s, (u_xi, r) of it; of m only what lives at vertices.
Eigen::VectorXd interior_of(const Kernel& k, const Triangle& t, const Material& material, const Eigen::VectorXd& local,
                            const SkeletonVector& m);

/// Four, the last ones again where there are fewer.
using PackedTriangles = std::array<const LocalTriangle*, 4>;

/// How local.cpp reaches the code of an element.
struct Operations {
  Condensed (*condense)(const Kernel&, const Triangle&, const Material&, const ForceMoments&, const Penalty&);
  Eigen::VectorXd (*interior)(const Kernel&, const Triangle&, const Material&, const ForceMoments&,
                              const SkeletonVector&, const Penalty&, TraceForces*);
  Fields (*evaluate)(const Triangle&, const Eigen::Ref<const Eigen::VectorXd>&, const Points&);
  Eigen::Vector4d (*stress_at)(const Triangle&, const Eigen::Ref<const Eigen::VectorXd>&, const Vec2&);
  Eigen::VectorXd (*weigh)(const Triangle&, const Points&, const Fields&);
  // Of mixed elements without stresses at vertices:
  LocalSystem (*local_system)(const Kernel&, const Triangle&, const Material&, const ForceMoments&) = nullptr;
  Eigen::VectorXd (*interior_of)(const Kernel&, const Triangle&, const Material&, const Eigen::VectorXd&,
                                 const SkeletonVector&) = nullptr;
  DualLoad (*condense_dual)(const Kernel&, const Triangle&, const Material&, const Eigen::VectorXd&,
                            const Penalty&) = nullptr;
  Eigen::VectorXd (*interior_dual)(const Kernel&, const Triangle&, const Material&, const Eigen::VectorXd&,
                                   const SkeletonVector&, const Penalty&) = nullptr;
  Eigen::MatrixXd (*interiors)(const Kernel&, const Triangle&, const Material&, const Eigen::MatrixXd&) = nullptr;
  void (*interiors_lanes)(const Kernel&, const Triangle&, const Material&, const double*, double*) = nullptr;
  void (*evaluate_lanes)(const Triangle&, const double*, const Points&, double*) = nullptr;
  void (*loaded)(const Kernel&, const Triangle&, const Material&, const Eigen::MatrixXd&, Loaded&) = nullptr;
  // Of straight triangles without an eigenstrain; not of every element. The last: how many are wanted.
  void (*condense_packed)(const Kernel&, const PackedTriangles&, int, Condensed* const*) = nullptr;
  void (*interior_packed)(const Kernel&, const PackedTriangles&, int, Recovered* const*) = nullptr;
};

/// s11, s12, s21, s22 as a matrix.
inline Mat2 tensor(const Eigen::Vector4d& s) {
  return (Mat2() << s[0], s[1], s[2], s[3]).finished();
}

/// Stress alone at one point: what maps ask for, without allocation.
Eigen::Vector4d stress_at(const Kernel& k, const Triangle& t, Eigen::Ref<const Eigen::VectorXd> interior,
                          const Vec2& x);

double area(const Triangle& t);
Vec2 centroid(const Triangle& t);

/// The map of a curved triangle, from the one of its chords: Phi(X) = X + sum over its curved edges of l_a l_b q(s)
/// [theory: E.25]; its derivative D by X, J = det D. The identity of a straight one.
struct CellMap {
  Vec2 x;
  Mat2 D;
  double J;
};
CellMap cell_map(const Triangle& t, const Vec2& l);  // l: the second and the third barycentric coordinate
/// Of D along the two coordinates.
std::array<Mat2, 2> cell_map_slopes(const Triangle& t, const Vec2& l);
/// (l1, l2) that the map takes to x; of points outside those of the map's polynomial, as far as it can be inverted.
Vec2 cell_coordinates(const Triangle& t, const Vec2& x);

/// The rule of products of two stresses on this triangle.
const TriangleRule& stress_rule(const Kernel& k, const Triangle& t);
/// Its points, and what times area(t) integrates over the triangle: the rule's weights times J.
Points rule_points(const TriangleRule& rule, const Triangle& t);
Eigen::VectorXd rule_weights(const TriangleRule& rule, const Triangle& t);
/// In the coordinates of its spaces, (X - centroid)/sqrt(2 area), those of the chords.
Points chord_points(const TriangleRule& rule, const Triangle& t);
/// The place x in a triangle as its displacements see it: coefficients (columns) of the projection of the map onto
/// them, in the mean of squares over the triangle of the chords.
Points seen_places(const Kernel& k, const Triangle& t);
/// Of the triangle with its curved edges; area(t) is that of its chords.
double cell_area(const Triangle& t);
/// The k-th Gauss point of edge i.
Vec2 trace_point(const Kernel& k, const Triangle& t, int edge, int point);

}  // namespace kerf
