#pragma once
// Meshes of a ball around a point, with nested contours or a slit in it, for perturbations of finite size: the body
// around the ball is meshed and condensed once, the ball for every radius.

#include "kerf/mesh.hpp"
#include "kerf/shape.hpp"

namespace kerf {

/// A ball with a boundary of n edges. What follows throws std::invalid_argument unless n is a multiple of 4, at least
/// 12, and the radius positive.
struct Ball {
  Vec2 center;
  double radius;
  int n;
};

/// The corners of the regular n-gon on the circle, counter-clockwise, the first at angle 0.
std::vector<Vec2> ball_boundary(const Ball& ball);

/// That polygon as a hole whose n sides are edges of every mesh of the body.
Loop ball_hole(std::string name, const Ball& ball, Index label);

/// Triangles of a ball, the nested contours in it, and what lies between them.
struct BallMesh {
  Mesh mesh;  // points 0 ... n - 1 are those of ball_boundary, whose edges have label 0
  /// Per contour its n edges in the order of their angle; contour[0] is the ball's boundary, edge k from point k to
  /// k + 1; contour[k] belongs to radii[k - 1].
  std::vector<std::vector<Index>> contour;
  std::vector<Index> shell;           // per triangle k: between contours k and k + 1, or inside the last one
  std::vector<double> enclosed_area;  // of the polygon of each contour
};

/// Contours are n-gons with the area of the circle of radius eps = radii[k], or of the ellipse with semi-axes
/// eps sqrt(aspect), eps / sqrt(aspect), the first along `angle` (radians). Rings of n vertices, staggered and in
/// geometric progression, lie between them, rings of ever fewer vertices inside the smallest. Where ellipses would make
/// that worse than 20 degrees, the shells are triangulated freely.
/// Throws std::invalid_argument unless the radii decrease, lie apart by more than 0.3 of an edge, and the largest
/// ellipse by as much inside the ball; and where aspect < 1.
/// `curved`: the contours follow their circles or ellipses (Mesh::arc), the area that they enclose is that of these;
/// not where the shells are triangulated freely.
BallMesh ball_mesh(const Ball& ball, const std::vector<double>& radii, double aspect = 1, double angle = 0,
                   bool curved = false);

/// The ball with a straight slit, crack 0, from center - half_length (cos angle, sin angle) to the opposite point, in
/// n / 2 edges. Elliptic coordinates center + half_length cosh(xi + i eta), so that edges shorten towards the tips like
/// the square root of the distance; they turn into polar ones towards the boundary, the only contour.
/// Throws std::invalid_argument unless 0 < half_length <= 0.8 of the ball's radius.
BallMesh slit_mesh(const Ball& ball, double half_length, double angle);

}  // namespace kerf
