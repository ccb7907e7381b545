#pragma once
// Every tool's design by the same yardstick: a shape with the asked area on a body-fitted mesh of its own.

#include "bench/optimize/optimize_problems.hpp"

namespace kerf {

/// A function at the points of a regular grid over a box, bilinear between them, smaller where there is material: how
/// other programs hand over their designs.
struct GridField {
  Index columns = 0, rows = 0;  // of points
  std::vector<double> value;    // row by row from the bottom, each from the left
};

/// The material below the level at which its area is that fraction of the frame, loose pieces left out; along the loads
/// and in frozen parts there is always some. `background` is a mesh of the frame. Throws Error(Geometry) for a field
/// that makes no body.
Shape shape_of(const OptimizeProblem& p, double volume, const GridField& field, const Mesh& background);

double frame_area(const OptimizeProblem& p);
/// Area of a shape relative to the frame.
double volume_fraction(const OptimizeProblem& p, const Shape& shape);

struct Judged {
  double compliance = 0;       // load cases by their weights
  double least = 0, most = 0;  // bounds of the exact one on this shape; not a number: not asked for
  double volume = 0;           // fraction
  Mesh mesh;                   // of the first load case
};

/// Edges near `size`, elements of degree 1; with a number of `triangles` of degree 2, refined for each load case until
/// the stress errs by less than 0.5 % or there are so many, with bounds.
struct JudgeMesh {
  double size = 0;
  Index triangles = 0;
};
/// Of a body without cracks. The shape carries the labels of the frame.
Judged judge(const OptimizeProblem& p, const Shape& shape, const JudgeMesh& mesh);

}  // namespace kerf
