#pragma once
// A body inside a frame as the negative set of a function that is linear on the triangles of a mesh of that frame:
// from the function to a shape that can be meshed.

#include "geometry/mesh.hpp"
#include "geometry/shape.hpp"

#include <Eigen/Core>

namespace kerf {

/// Straight pieces of the zero line of phi (linear on triangles), material (phi < 0) on the left of a -> b.
struct ZeroPiece {
  Vec2 a, b;
  Index triangle;
};
std::vector<ZeroPiece> zero_line(const Mesh& background, const Eigen::VectorXd& phi);

/// Area where phi < 0.
double negative_area(const Mesh& background, const Eigen::VectorXd& phi);

struct Carving {
  double tolerance = 0;     // a length: how far the boundary drawn may lie from the zero line
  double spacing = 0;        // a length: of the segments where the boundary is smooth
  double least_area = 0;    // smaller holes are filled, smaller pieces of material dropped
  std::vector<Index> keep;  // labels of the frame (supports, loads): a piece of material that touches none is dropped
  std::vector<Index> holding;  // labels of supports: a piece that touches none is dropped even if it bears loads
};

struct Carved {
  Shape shape;                     // labels: those of the frame in their order, then "design"
  std::vector<Index> crack_of;     // per crack of the shape: the crack of the frame that it is or is a part of
  Index design_label = none;       // of what the zero line drew
  double area = 0;                 // of the shape
  std::vector<std::string> notes;  // what was dropped, filled, moved, each by name
};

/// The negative set as a shape: pieces of the frame's boundary with their labels, and the zero line, simplified and
/// smoothed within the tolerance, labelled "design". `background` is a mesh of the frame. Cracks of the frame are cut
/// to what lies inside. Throws Error(Geometry) naming what is lost: no material, a label of `keep` that has lost its
/// material, pieces that the supports do not hold together with the loads.
Carved carve(const Shape& frame, const Mesh& background, const Eigen::VectorXd& phi, const Carving& how);

}  // namespace kerf
