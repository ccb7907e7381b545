#pragma once
// Smooth curves of circular arcs: points with directions, joined by two arcs each [theory: K.1]. Exact in case files,
// DXF and SVG, and smooth functions of the points and directions.

#include "kerf/shape.hpp"

#include <span>

namespace kerf {

/// A point and the direction (radians) in which a chain runs through it.
struct Knot {
  Vec2 at = Vec2::Zero();
  double angle = 0;
};

/// Knots joined by biarcs, without corners. Segment k runs from knot k to the next one, in arcs 2k and 2k + 1.
struct ArcChain {
  std::vector<Knot> knots;
  bool closed = false;
};
std::size_t segment_count(const ArcChain& chain);

/// Where on a chain: an arc, and the share of its turn that lies behind.
struct ChainPlace {
  std::size_t arc = 0;
  double part = 0;
};

/// A point of a chain and its derivatives by x, y, angle of the knot before it and of the one after it.
struct ChainPoint {
  Vec2 at, tangent;
  double speed;                       // length per share of the turn
  double curvature;                   // positive to the left
  Eigen::Matrix<double, 2, 6> by;     // of `at`
  Eigen::Matrix<double, 1, 6> bends;  // of the curvature
};
ChainPoint point_on(const ArcChain& chain, const ChainPlace& place);
Vec2 at(const ArcChain& chain, const ChainPlace& place);

/// The place nearest to x among segments [first, last).
ChainPlace nearest(const ArcChain& chain, const Vec2& x, std::size_t first, std::size_t last);
/// Those nearest to the points on all of the chain, which has a segment.
std::vector<ChainPlace> nearest(const ArcChain& chain, std::span<const Vec2> points);

double length(const ArcChain& chain);
/// The largest turn of an arc over pi: from 1 on the chain has loops or cusps.
double largest_turn(const ArcChain& chain);

/// The sides of a chain, smooth; of an open one without the point where it ends.
std::vector<Side> sides(const ArcChain& chain, Index label);

/// The shape with parts of ellipses as chains within the tolerance, with `ellipses` whole ones, too; and with arcs of
/// loops of several sides that turn by less than half a turn.
Shape circular(Shape shape, double tolerance, bool ellipses = false);

/// A line to be followed by a chain: a polygon, open or closed.
struct ChainTrace {
  std::vector<Vec2> points;
  bool closed = false;
  std::vector<bool> pinned;  // points that the chain must meet exactly; the ends of an open line are
};
struct ArcFit {
  double tolerance;      // of the points and the middles between them
  double least_spacing;  // of knots, along the line; wins over the tolerance
};
/// A chain with few knots near the line: knots by least squares, halved where the line is further than the tolerance.
/// Deterministic, and independent of units. Throws std::invalid_argument for fewer than two points, three if closed.
struct Fitted {
  ArcChain chain;
  std::vector<Index> point;  // per knot the pinned point that it is, or none
  double distance = 0;       // of the line, the largest
};
Fitted fit_arcs(const ChainTrace& trace, const ArcFit& how);

}  // namespace kerf
