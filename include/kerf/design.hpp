#pragma once
// A few numbers that draw holes, cracks and inclusions into a frame.

#include "kerf/scene.hpp"
#include "kerf/shape.hpp"

namespace kerf {

struct Problem;

/// One thing that numbers draw. Its variables, in this order:
///   Circle     center x, y, radius
///   Ellipse    center x, y, semi-axes a, b, angle of the first (radians)
///   Spline     x, y of the control points of a closed uniform cubic B-spline, counter-clockwise, four or more
///   Crack      x, y of the vertices of its path, from start to end
///   Inclusion  center x, y, radius of a circle of another material, Young's modulus
/// A variable whose bounds are equal is fixed.
struct Drawn {
  enum class Kind { Circle, Ellipse, Spline, Crack, Inclusion } kind = Kind::Circle;
  std::string name;                     // of the hole, crack or region
  Eigen::VectorXd lower, upper, start;  // equally long
  CrackLaw law = {};                    // of a crack
  double poisson = 0.3;                 // of an inclusion
  bool from_map = false;                // `start` is to be read off the map: initial_guess
};

/// The variables of all drawn things, one after the other.
struct Design {
  std::vector<Drawn> drawn;
};

/// "hole 'h'", "crack 'c'", "region 'r'".
std::string name(const Drawn& drawn);
/// Of all variables: "h.x", "h.y", "h.radius", ...
std::vector<std::string> variable_names(const Design& d);

Eigen::VectorXd lower_bounds(const Design& d);
Eigen::VectorXd upper_bounds(const Design& d);
Eigen::VectorXd start_of(const Design& d);

/// Throws Error(Usage) naming what is drawn wrong: nothing at all, numbers of variables that do not fit the kind,
/// bounds that are not finite or cross, a start outside of them, radii, semi-axes and moduli that may vanish, names
/// that the frame has already, Poisson's ratios that no material has.
void check_design(const Design& d, const Problem& p);

/// The frame with everything drawn into it: holes, cracks and regions after those of the frame, the boundaries of holes
/// labeled "hole:<name>" (the label of the frame, if it has that one). Splines become polygons fine enough for their
/// corners not to count as such. Nothing is checked: find_problem and triangulate do.
struct DrawnBody {
  Shape shape;
  Scene scene;
};
DrawnBody body_of(const Design& d, const Eigen::VectorXd& x, const Problem& p);

}  // namespace kerf
