#pragma once
// The kinds of drawn things: a kind is a file of this folder, which fills a DrawnShape, and a line of the table.

#include "kerf/inverse.hpp"
#include "optimize/parametric/constraints.hpp"
#include "optimize/parametric/distance.hpp"
#include "optimize/parametric/shapes/sought.hpp"

namespace kerf {

/// What a drawn thing becomes in the body.
enum class BodyPart { Hole, Crack, Region };

/// Where a vertex of a mesh lies on what is drawn: in the axes of a disc or an ellipse, on a piece of a polyline.
struct Spot {
  Vec2 local = Vec2::Zero();  // x = center + axes local
  Index piece = none, pieces = 0;
  double part = 0;  // along the piece
};

/// A box that holds something for all variables.
struct CoordinateBox {
  Vec2 low, high;
};

/// A kind of drawn thing. v: the variables of one thing, in the order that kerf/design.hpp lists. Null: nothing.
struct DrawnShape {
  Drawn::Kind kind;
  BodyPart part;
  /// Short names of the variables: "x", "radius".
  std::vector<std::string> (*names)(Eigen::Index count);
  bool (*fits)(Eigen::Index count);  // numbers of variables
  const char* asks;                  // for which ones, in words
  /// Throws Error(Usage) for bounds and materials that no such thing has.
  void (*check)(const Drawn& d, const Problem& p);

  /// Into the shape and the scene.
  void (*draw)(const Drawn& d, const Eigen::VectorXd& v, const Problem& p, DrawnBody& body);
  /// Where points of a mesh of it lie; `size` of the mesh.
  std::function<Spot(const Vec2& x)> (*locate)(const Eigen::VectorXd& v, double size);
  Vec2 (*position)(const Spot& spot, const Eigen::VectorXd& v);
  /// sum += force . d position / d v.
  void (*pull)(const Spot& spot, const Eigen::VectorXd& v, const Vec2& force, Eigen::Ref<Eigen::VectorXd> sum);
  /// area += that of the hole; its derivative by v into `gradient`, zero before, unless null.
  void (*add_area)(const Eigen::VectorXd& v, double& area, Eigen::VectorXd* gradient) = nullptr;

  /// The boundary as constraints see it. `cut`: without what may touch other things, next to fixed ends of a crack.
  DesignCurve (*boundary)(const Drawn& d, const Eigen::VectorXd& v, bool cut);
  CoordinateBox (*box)(const Drawn& d);
  /// Appends constraints on its own shape; `first` of its variables in the design.
  void (*constrain)(const Drawn& d, Eigen::Index first, double least, std::vector<Constraint>& all) = nullptr;

  /// What an initial guess looks for.
  Sought (*seek)(const Drawn& d, const Problem& p);
  /// The variables of a guess, bounds not looked at.
  Eigen::VectorXd (*guessed)(const Guess& g, const Drawn& d);
  std::string (*guess_in_words)(const Guess& g);
  Index young = none;  // which variable is Young's modulus
};

extern const DrawnShape circle_shape, ellipse_shape, spline_shape, crack_shape, inclusion_shape;
inline constexpr std::array drawn_shapes{&circle_shape, &ellipse_shape, &spline_shape, &crack_shape, &inclusion_shape};

const DrawnShape& shape_of(const Drawn& d);

/// Throws Error(Usage): "the design of hole 'h': ".
void require(bool good, const Drawn& d, const std::string& what);

/// The label "hole:<name>", which is added unless it is there.
Index hole_label(Shape& shape, const std::string& name);

/// A constraint on the variables of one thing: `value(v, gradient)`, the gradient zero before.
Constraint own_constraint(std::string what, Eigen::Index first, Eigen::Index count,
                          std::function<double(const Eigen::VectorXd& v, Eigen::VectorXd& gradient)> value);

/// cos of the angle between two vectors, and its derivatives by them.
double cosine(const Vec2& a, const Vec2& b, Vec2& by_a, Vec2& by_b);
inline constexpr double fold = -0.5;  // cosine of the sharpest turn allowed, 120 degrees

/// The edge length that the mesh is to have.
double mesh_size(const Problem& p);
inline constexpr Index samples = 64;  // of a closed boundary

/// "x1", "y1", "x2", ...
std::vector<std::string> coordinate_names(Eigen::Index count);
std::string radius_in_words(const Guess& g);
/// The box of points whose coordinates are the variables.
CoordinateBox box_of_points(const Drawn& d);
/// The piece of a polyline nearest to x, and where along it.
Spot place_on(const std::vector<Vec2>& points, bool closed, const Vec2& x);

}  // namespace kerf
