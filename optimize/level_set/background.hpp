#pragma once
// The moving boundary: a function that is linear on a mesh of the frame, negative in the material, kept near the signed
// distance to its own zero line.

#include "geometry/carve.hpp"
#include "kerf/optimize.hpp"
#include "optimize/constraints/mirrored.hpp"
#include "optimize/level_set/start.hpp"

namespace kerf {

/// What never changes while the boundary moves.
struct BackgroundMesh {
  Mesh mesh;
  double size = 0;                   // edge length of the mesh
  Eigen::VectorXd lumped;            // per vertex: a third of the triangles around
  Eigen::VectorXd frozen;            // per vertex: signed distance to what stays solid, negative inside; or empty
  Eigen::VectorXd hollow;            // per vertex: minus the distance to what stays void, positive inside; or empty
  std::vector<Index> start, around;  // neighbors of each vertex
  std::vector<Index> rim;            // edges of the frame's boundary that may recede: no supports, no loads
  struct Image {                     // of a vertex in the mirror, inside a triangle; none: there is no body
    Index triangle = none;
    Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  };
  std::vector<Image> image;      // or empty
  std::optional<Mirror> mirror;  // that these are of
  Locator locator;
};

struct Solid {                                 // what stays solid
  std::vector<std::pair<Loop, double>> loops;  // closed areas, and how far around them
  std::vector<Index> labels;                   // strips along these labels
  double width = 0;                            // of the strips
  std::vector<Index> held;                     // labels of supports: their edges do not recede by themselves
  std::vector<std::pair<Vec2, double>> discs = {};
};

BackgroundMesh background_mesh(Mesh mesh, const Solid& solid, const std::optional<Mirror>& mirror);

/// The signed distance to the boundary that can move: the zero line of phi and the rim with material on it. Its sign is
/// that of phi. Next to the boundary exact, elsewhere to the nearest piece that a front from there carries, and no
/// larger than 20 edges.
Eigen::VectorXd signed_distance(const BackgroundMesh& b, const Eigen::VectorXd& phi);

/// A function that is linear on triangles, at a point; where the point lies outside, continued from the nearest one.
double value_at(const BackgroundMesh& b, const Eigen::VectorXd& f, const Vec2& x);

/// phi with what must stay solid or void made so, mirrored where asked.
Eigen::VectorXd constrained(const BackgroundMesh& b, Eigen::VectorXd phi);

/// What must stay solid or void, over phi.
Eigen::VectorXd clipped(const BackgroundMesh& b, Eigen::VectorXd phi);

/// phi + c, made solid where it must be, with |{phi < 0}| = area to 1e-9 of the frame where that is possible.
Eigen::VectorXd with_area(const BackgroundMesh& b, const Eigen::VectorXd& phi, double area);

/// Without the discs: the largest of phi and radius - |x - center|.
void cut_discs(const BackgroundMesh& b, std::span<const Disc> discs, Eigen::VectorXd& phi);

/// sum_i amount_i N_v(x_i) with the linear basis functions N_v.
Eigen::VectorXd spread_onto(const BackgroundMesh& b, std::span<const Vec2> points, const Eigen::VectorXd& amounts);

/// Values given at points along the boundary, at every vertex that is near: of the nearest point, so that they are
/// constant along normals.
Eigen::VectorXd extend(const BackgroundMesh& b, std::span<const Vec2> points, const Eigen::VectorXd& values);

}  // namespace kerf
