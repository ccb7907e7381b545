#pragma once
// A body whose design sides are chains of arcs, and the variables that move them.

#include "geometry/arc_chain.hpp"
#include "geometry/carve.hpp"
#include "kerf/optimize.hpp"

#include <Eigen/Core>

namespace kerf {

/// A side of the frame along which the end of a chain may slide: straight, or an arc.
struct Rail {
  std::optional<Arc> arc;
  Vec2 from = Vec2::Zero(), along = Vec2::UnitX();  // straight: a point and a unit vector
  double at(const Vec2& x) const;                   // coordinate of a point on it: a length, or the arc's parameter
  Vec2 point(double coordinate) const;
  Vec2 velocity(double coordinate) const;  // by the coordinate
};

/// How a knot moves, besides its angle: along its normal, along a rail, or not at all.
struct KnotHold {
  enum class Kind { Free, Slides, Fixed } kind = Kind::Free;
  Index rail = none;
  double lower = -infinity, upper = infinity;  // of the coordinate on the rail
  Index offset = none, angle = none;           // numbers of its variables
  double offset_sign = 1, angle_sign = 1;      // images move by the variables of what they are images of
};

/// A piece of a loop: a chain, or a side of the frame.
struct LoopPiece {
  Index chain = none;
  Side side = {};  // it ends where the next piece begins
};
struct CurveLoop {
  std::string name;
  std::vector<LoopPiece> pieces;
};

/// Two ends of chains on one rail, `first` at the smaller coordinate, that must stay a distance apart.
struct KnotRef {
  Index chain = none, knot = none;
};
struct RailGap {
  KnotRef first, second;
  double least;  // in the coordinate
};

/// A knot and its mirror image, which follows it; one on the line is its own, and has no angle to vary.
struct KnotImage {
  KnotRef of, image;
};

struct DesignCurves {
  Shape carved;                  // all that is no chain
  std::vector<CurveLoop> loops;  // outline, holes
  std::vector<ArcChain> chains;
  std::vector<std::vector<KnotHold>> holds;  // per chain and knot
  std::vector<Rail> rails;
  std::vector<RailGap> apart;
  std::vector<KnotImage> images;
  std::optional<Mirror> mirror;
  std::vector<std::vector<double>> spacing;  // per chain and segment: its length when the knots were placed
  Index label = none;
  Eigen::Index variables = 0;
  double distance = 0;       // of the fit, the largest
  bool follow_arcs = false;  // arcs of the frame that are the body's own have no corners that steps keep off
};

/// What must stay as it is besides regions and cracks: labels that bear loads or are looked at.
struct CurveRules {
  double size, tolerance, least_spacing, least_gap;
  std::vector<Index> solid;
  std::vector<Index> held = {};  // labels of supports
  std::optional<Mirror> mirror = {};
};
/// With a mirror one half has the variables. Throws Error(Geometry) where the design is not its own image.
DesignCurves design_curves(const Shape& frame, const Carved& carved, const CurveRules& how);

Shape shape_of(const DesignCurves& d);

/// Which variables are angles, of knots or along arcs; the others are lengths.
std::vector<bool> angles_of(const DesignCurves& d);

/// A side of the frame between chains, as drawn: its ends, and the knots that they are.
struct SideEnds {
  Side side;
  Vec2 end;
  KnotRef before, after;
};
/// Piece i of loop l, which is no chain; `shape`: that of d.
SideEnds side_ends(const DesignCurves& d, const Shape& shape, std::size_t l, std::size_t i);

/// The curves with every variable changed by the step: lengths along normals and rails, angles.
DesignCurves moved(const DesignCurves& d, const Eigen::VectorXd& step);

/// Where knots have come much closer together than others of their chain, or further apart, moves them along it to the
/// spacing that they had, in proportion. What is drawn changes by less than a fit does.
void even_out(DesignCurves& d);

/// Derivatives of something by the variables, from those by x, y, angle of the two knots of a segment.
void add_by_segment(const DesignCurves& d, Index chain, std::size_t segment, const Eigen::Matrix<double, 1, 6>& by,
                    Eigen::VectorXd& sum);

/// All knots as numbers (x, y, angle).
Eigen::VectorXd pack(const DesignCurves& d);

/// Area of the body and its derivative, to rounding.
double area_of(const DesignCurves& d, Eigen::VectorXd* by);

/// Moves all free knots by the same distance along their normals until the area is the one wanted. False when it cannot
/// be reached.
bool offset_to_area(DesignCurves& d, double area);

}  // namespace kerf
