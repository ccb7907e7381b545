#pragma once
// A body inside a frame as the negative set of a function that is linear on the triangles of a mesh of that frame:
// from the function to a shape that can be meshed.

#include "kerf/mesh.hpp"
#include "kerf/shape.hpp"

#include <Eigen/Core>

namespace kerf {

/// Straight pieces of the zero line of phi (linear on triangles), material (phi < 0) on the left of a -> b.
struct ZeroPiece {
  Vec2 a, b;
  Index triangle;
};
std::vector<ZeroPiece> zero_line(const Mesh& background, const Eigen::VectorXd& phi);

/// Area of the part of a triangle where a linear function is negative, from the area and the values at its corners.
double negative_part(double area, const std::array<double, 3>& f);

/// Area where phi < 0.
double negative_area(const Mesh& background, const Eigen::VectorXd& phi);

struct Carving {
  double tolerance = 0;     // a length: how far the boundary drawn may lie from the zero line; 0: spacing / 10
  double spacing = 0;       // edges wanted along the zero line; 0: the mean edge of the background
  double least_area = 0;    // smaller holes are filled
  double least_width = 0;   // narrower necks of material are opened, gaps closed; at least the tolerance, at most half
                            // the spacing
  std::vector<Index> keep;  // labels of the frame (supports, loads): a piece of material that touches none is dropped
  std::vector<Index> holding;  // labels of supports: a piece that bears loads and touches none is cut off
};

struct Carved {
  Shape shape;                     // labels: those of the frame in their order, then "design"
  std::vector<Index> crack_of;     // per crack of the shape: the crack of the frame that it is or is a part of
  Index design_label = none;       // of what the zero line drew
  double area = 0;                 // of the shape
  std::vector<char> inside;        // per vertex of the background: in the body, what was dropped and filled seen to
  std::vector<std::string> notes;  // what was dropped, filled, moved, each by name
};

/// The negative set as a shape: pieces of the frame's boundary with their labels, and the zero line, simplified and
/// smoothed within the tolerance without a change of area, labeled "design". `background` is a mesh of the frame.
/// Cracks of the frame are cut to what lies inside; loops that the zero line does not touch are the frame's own.
/// Vertices where phi is 0 lie in the void. What only a crack connects to the body, and no label is on, is dropped.
/// Where the smoothed line meets something it is smoothed less, then drawn as it is, then phi is shifted by less than
/// what the tolerance stands for; the notes say so.
/// Throws Error(Geometry) naming what is lost: no material, a label of `keep` that has lost its material, pieces that
/// the supports do not hold together with the loads, a region that the zero line reaches; std::invalid_argument when
/// phi or the background do not fit.
Carved carve(const Shape& frame, const Mesh& background, const Eigen::VectorXd& phi, const Carving& how);

}  // namespace kerf
