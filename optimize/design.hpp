#pragma once
// A few numbers that draw holes, cracks and inclusions into a frame.

#include "geometry/mesh.hpp"
#include "geometry/shape.hpp"
#include "solver/scene.hpp"

namespace kerf {

/// One thing that numbers draw. Its variables, in this order:
///   Circle     center x, y, radius
///   Ellipse    center x, y, semi-axes a, b, angle of the first (radians)
///   Spline     x, y of the control points of a closed uniform cubic B-spline, counter-clockwise
///   Crack      x, y of the vertices of its path, from start to end
///   Inclusion  center x, y, radius of a circle of another material, Young's modulus
/// A variable whose bounds are equal is fixed.
struct Drawn {
  enum class Kind { Circle, Ellipse, Spline, Crack, Inclusion } kind = Kind::Circle;
  std::string name;                     // of the hole, crack or region
  Eigen::VectorXd lower, upper, start;  // equally long
  CrackLaw law = {};                    // of a crack
  double poisson = 0.3;                 // of an inclusion
  bool from_map = false;                // `start` is to be read off the map: see one_shot.hpp
};

struct Design {
  std::vector<Drawn> drawn;
};

}  // namespace kerf
