#pragma once
// Shape -> mesh. CGAL lives in mesher.cpp and nowhere else.

#include "kerf/mesh.hpp"
#include "kerf/shape.hpp"

namespace kerf {

struct Sizing {
  double size = 0;  // target edge length; 0: extent / 40
  double crack_tip_size =
      0;  // target edge length at crack tips; 0: size / 100, which is cheap and halves the error of size / 10
  double grading = 0.25;          // growth of the target length per length away from tips, corners and small holes
  double min_angle_deg = 25;      // wherever the input angles allow it
  double across = 2;              // edges across narrow gaps between sides
  bool mirrored_tips = false;     // the mesh around crack tips is its own mirror image in the crack: what Coulomb's
                                  // friction needs [theory: F.8]
  bool curved = false;            // edges along arcs follow them: Mesh::arc
  bool long_ligaments = false;    // between a straight crack and a straight side or crack close by, one layer of
                                  // triangles up to size / 8 long, however thin: for elements of order 2 [theory: C.35]
  std::vector<Mat2> images = {};  // linear maps: curved sides get edges as short as their images would, too
  std::vector<Vec2> ends = {};    // points with edges of end_size: where contact ends (solve_graded finds them)
};
/// Sizing::size, or what it is where it is not given: a 40th of the extent of the shape.
double target_size(const Sizing& sizing, const Shape& shape);

/// Target edge length at Sizing::ends, for a size that is given (not 0). Adjoints are singular there as states are at
/// tips, and T moves with the end: this fraction of the size leaves 1 % where that matters most.
constexpr double end_size(double size) {
  return 4e-4 * size;
}

/// Target edge lengths for a further mesh of the same shape, at the vertices of an earlier one: linear in its
/// triangles, constant beyond its boundary. The mesh must outlive the call that it is given to.
struct Background {
  const Mesh* mesh;
  std::vector<double> size;  // per vertex, positive
};

/// Constrained Delaunay triangulation, seeded with a hexagonal lattice per size level, refined (Ruppert, Shewchuk) and
/// smoothed. Whole circles and ellipses on which no crack ends become polygons of the same area, unless their edges are
/// curved: these are pieces of at most 45 degrees, their ends on the arc. Besides tips, short
/// edges are asked for by kinks and mouths of cracks, reentrant corners, curved sides, short sides and narrow gaps.
/// Sides to be kept are never split; beside those longer than the target the edges grow to their length, and the angles
/// are no longer promised.
/// Throws Error(Geometry) with find_problem's words, for a sizing that cannot be met, or when the step budget runs out.
Mesh triangulate(const Shape& shape, const Sizing& sizing);

/// A tip with less than two of its edges to the next thing drawn, or to the other end of its crack, gets shorter ones:
/// a twentieth of that. What was made finer so, in words, and which ends of cracks were moved to join what lies beside
/// them. Throws as triangulate does for the sizing.
std::vector<std::string> crowded_tips(const Shape& shape, const Sizing& sizing);

/// The same with the target min(sizing.size, background) instead of what tips, kinks, junctions, mouths and reentrant
/// corners ask for. The background is limited to grow by `grading` per length along the edges of its mesh, and to no
/// less than 1e-9 of the extent.
/// Throws std::invalid_argument when the background does not fit its mesh.
Mesh triangulate(const Shape& shape, const Sizing& sizing, const Background& background);

}  // namespace kerf
