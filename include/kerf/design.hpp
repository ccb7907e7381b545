#pragma once
// A few numbers that draw holes, cracks and inclusions into a frame, and how meshes follow them.

#include "kerf/mesh.hpp"
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
bool is_hole(const Drawn& drawn);

Eigen::VectorXd lower_bounds(const Design& d);
Eigen::VectorXd upper_bounds(const Design& d);
Eigen::VectorXd start_of(const Design& d);
Eigen::Index variables(const Design& d);
/// Where the variables of drawn[k] begin.
std::vector<Eigen::Index> first_variables(const Design& d);

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

/// Material of a drawn inclusion.
Material material_of(const Drawn& inclusion, double young, const Problem& p);

/// Point of the closed uniform cubic B-spline through its spans: s in [0, number of control points].
/// weights: of the control points in `first`, first + 1, ... (cyclic).
struct SplineWeights {
  Index first;
  Eigen::Vector4d position, derivative;
};
SplineWeights spline_weights(Index control_points, double s);

/// Which vertices of a mesh of body_of(d, at, p) lie on what is drawn, and where there.
struct Followers {
  struct One {
    Index vertex;
    Index drawn;
    Vec2 local = Vec2::Zero();  // circles, ellipses: x = center + axes local
    Index piece = none;         // polygons, paths: of their pieces
    double part = 0;            // along it
  };
  Eigen::VectorXd at;
  std::vector<One> all;
  std::vector<Index> pieces;  // per drawn thing: of the polygon of a spline
};
Followers followers(const Design& d, const Eigen::VectorXd& at, const Problem& p, const Mesh& mesh);

/// Where the followers lie in the design x: 2 x followers. At `at` they lie where the mesh has them, up to rounding.
Points positions(const Design& d, const Followers& f, const Eigen::VectorXd& x);
/// sum over followers k of force(k) . d positions(k) / dx.
Eigen::VectorXd pull_back(const Design& d, const Followers& f, const Eigen::VectorXd& x, const Points& force);

/// Area of the holes drawn, and its derivative unless null. Splines exactly, not as polygons.
double area_of_holes(const Design& d, const Eigen::VectorXd& x, Eigen::VectorXd* gradient);

}  // namespace kerf
