#pragma once
// The data of a scene as the rules of the solver see them: integrated adaptively, with what is proved of the error
// [theory: D.1].

#include "base/quadrature.hpp"
#include "kerf/mesh.hpp"
#include "kerf/scene.hpp"
#include "solver/element/edge_curvature.hpp"

#include <optional>

namespace kerf {

struct Triangle;

/// Proved: by enclosures. Sampled: black boxes, at stratified points. Open: neither settles it.
enum class Resolution { Proved, Sampled, Open };

inline constexpr int data_points = 8;  // Gauss points per edge that carry boundary data

/// Two components of data f on an edge as a polynomial P of degree 7: its moments with polynomials of degree 7 are
/// those of f. Where f is smooth, P takes its values at the points.
struct EdgeValues {
  Eigen::Matrix<double, 2, data_points> at = Eigen::Matrix<double, 2, data_points>::Zero();  // at gauss(data_points)
  Vec2 rest = Vec2::Zero();       // at least the mean of (f - P)^2
  Vec2 primitive = Vec2::Zero();  // at least the mean of the square of the primitive of f - P by s, 0 at both ends
  Vec2 error = Vec2::Zero();      // at least the error of the mean of f w, |w| <= 1
  Vec2 rough = Vec2::Zero();      // the mean of (d(f - P)/ds)^2, estimated; infinite where f jumps
  Resolution how = Resolution::Proved;
  double worst = 0.5;  // where s has the largest share of the error
  bool jumps = false;
};
/// Errors below `size` times rounding are left: the largest of f on all edges, or 0. Throws Error(Numerics), naming
/// `what` and the place, where the data are not finite.
EdgeValues edge_values(const BoundaryField& f, const EdgeLine& edge, const char* what, double size = 0);
struct EdgeOf {
  const Mesh& mesh;
  const EdgeCurvatures& curvatures;
  Index edge;
};
EdgeLine edge_line(const EdgeOf& of);
/// The same on an edge of a mesh, with the normal of the curve; `density`: times |dx/ds| over the length of the chord,
/// so that length times weight integrates a traction as on straight edges.
EdgeValues edge_values(const BoundaryField& f, const EdgeOf& of, const char* what, bool density, double size = 0);
/// The largest value that is known of f on the edge, where that is finite; else 0.
double size_on(const BoundaryField& f, const EdgeLine& edge);

/// Data f on a triangle at the points of a rule of degree 8 or more.
struct TriangleValues {
  Points at;
  bool whole = true;  // the values of f; else of its projection onto P4
  double rest = 0;    // at least the mean of |f - values|^2 beyond what the points show
  double error = 0;   // at least the error of the mean of f.w, |w| <= 1
  Resolution how = Resolution::Proved;
};
/// Errors far below `size` are left: the largest of f on the body, or 0. Curved triangles are sampled.
TriangleValues triangle_values(const VectorField& f, const Triangle& cell, const TriangleRule& rule, double size = 0,
                               const char* what = "body force");
TriangleValues triangle_values(const VectorField& f, const std::array<Vec2, 3>& corners, const TriangleRule& rule,
                               double size = 0, const char* what = "body force");
/// The first look at a black box, from its values at the points of the rule and of `finer_rule()`, for those who have
/// many of them at once: nothing where it does not settle the matter, and triangle_values is to look further.
std::optional<TriangleValues> first_look(const Eigen::Ref<const Points>& at, const TriangleRule& rule,
                                         const Eigen::Ref<const Points>& finer);
const TriangleRule& finer_rule();
/// Of a known polynomial of a degree that every rule integrates against the fields of the elements.
bool is_polynomial(const VectorField& f);
/// The largest value that is known of f on the mesh, where that is finite; else 0.
double size_over(const VectorField& f, const Mesh& mesh);

/// What one support or traction prescribes, per edge of its label.
struct LoadedEdges {
  Index label;
  std::vector<EdgeValues> values;
};

/// The eigenstrain e as a polynomial P per triangle, of degree 4 or of its own where that is lower: its projection in
/// the mean of squares, so that its moments with stresses of degree 4 are those of e (bubbles of bdms of degree 4 are
/// of degree 5). In curved triangles a polynomial in the coordinates (l1, l2) that their map takes to the place.
struct StrainData {
  int degree = 0;
  Eigen::MatrixXd coefficients;  // a column per triangle: 11, 22, 12, 33 per monomial of (l1, l2); no columns: none
  Eigen::VectorXd rest;          // per triangle at least the mean of |e - P|^2
  Eigen::VectorXd error;         // per triangle at least the error of the mean of e:w, |w| <= 1
  std::vector<Resolution> how;   // per triangle
  bool empty() const {
    return coefficients.cols() == 0;
  }
};
/// The eigenstrain that a triangle has, or null.
const Eigenstrain* eigenstrain_of(const Mesh& mesh, const Scene& scene, Index t);
StrainData strain_data(const Mesh& mesh, const Scene& scene, const TriangleRule& rule, int threads,
                       const EdgeCurvatures& curvatures = {});
/// Its values (rows 11, 12, 21, 22) at points (l1, l2) of triangle t.
Eigen::Matrix4Xd strain_at(const StrainData& data, Index t, const Points& l);
/// The same derived by l1 (axis 0) or l2 (axis 1).
Eigen::Matrix4Xd strain_slope_at(const StrainData& data, Index t, const Points& l, int axis);
/// Its component 33, as in Eigenstrain.
Eigen::RowVectorXd strain_33_at(const StrainData& data, Index t, const Points& l);

/// The pressure in one crack, in the first component, per edge of Mesh::cracks.
struct LoadedCrack {
  Index crack;
  std::vector<EdgeValues> values;
};

/// All data of a scene on a mesh, once.
struct SceneData {
  std::vector<std::vector<Index>> edges;  // per label, increasing
  std::vector<LoadedEdges> supports, tractions;
  std::vector<LoadedCrack> pressures;  // of the cracks that have one
  std::vector<TriangleValues> body;    // per triangle, where the body force is not a polynomial of low degree
  StrainData strain;
};
SceneData scene_data(const Mesh& mesh, const Scene& scene, const TriangleRule& rule, int threads,
                     const EdgeCurvatures& curvatures = {});

/// All but the body force.
SceneData boundary_data(const Mesh& mesh, const Scene& scene, const EdgeCurvatures& curvatures = {});

/// The pressure in a crack, or null.
const LoadedCrack* pressure_in(const SceneData& data, Index crack);
/// The polynomial of the pressure on an edge, at s.
double pressure_at(const EdgeValues& on_edge, double s);

/// The edges of a label, none of them for a label without.
const std::vector<Index>& labeled(const SceneData& data, Index label);

/// Data that the rules do not resolve, or that are black boxes: the worst place of each condition.
struct UnseenData {
  Index label = none;  // none: the body force, or the pressure or the gap in a crack
  Vec2 at;
  const char* what;          // "the traction"
  const char* how;           // "is not resolved"
  bool stops_bounds = true;  // and with them every claim on the error
  Index crack = none;
};
std::vector<UnseenData> unseen_data(const Mesh& mesh, const Scene& scene, const SceneData& data);

EdgeLine edge_line(const Mesh& mesh, Index e);

/// P at further points of the triangle, in barycentric coordinates (l1, l2), where the values are not all of f.
Points polynomial_at(const TriangleValues& values, const TriangleRule& rule, const Points& l);

/// The body force at the points of the rule on a triangle: x are these.
Points body_force(const SceneData& data, const Scene& scene, Index t, const Points& x);

}  // namespace kerf
