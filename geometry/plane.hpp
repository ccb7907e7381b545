#pragma once
// Segments, polygons and arcs in the plane: each question about them has its one answer here.

#include "kerf/shape.hpp"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace kerf {

/// A corner of the boundary at which the body fills a larger angle is reentrant, a singular point. Polygons that stand
/// for curves stay below: the mesher turns by 360 / 32 degrees = 0.2 per piece, by 0.24 at the middle of a fillet of
/// two pieces. What lies between 180 degrees and this is hardly singular: stresses grow no faster than r^-0.16
/// [Williams 1952].
inline constexpr double reentrant_angle = pi + 0.3;

/// Where on the segment from a (0) to b (1) the point nearest to x lies; 0 when a = b.
double foot(const Vec2& x, const Vec2& a, const Vec2& b);

/// Distance of x to the segment from a to b, which may be a point.
double distance(const Vec2& x, const Vec2& a, const Vec2& b);
double squared_distance(const Vec2& x, const Vec2& a, const Vec2& b);

/// Where the segment from a (0) to b (1) crosses the one from c to d, if it does. An end on the line of the other
/// segment counts as lying to its right: of two segments that touch, some cross.
std::optional<double> crossing(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// Whether they cross in inner points of both: touching is no crossing.
bool cross_inside(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// Whether the ray from x in the direction of growing x crosses the segment, x itself left out. The lower end belongs
/// to the segment, the upper one does not.
bool crosses_ray(const Vec2& x, const Vec2& a, const Vec2& b);

/// Whether x lies inside a closed polygon, or inside closed polygons of which one has the sides in any order: by the
/// even-odd rule. What lies on a left or lower side is inside, on a right or upper one outside, up to rounding.
bool inside(std::span<const Vec2> polygon, const Vec2& x);
bool inside(std::span<const std::array<Vec2, 2>> sides, const Vec2& x);

Vec2 at(const Arc& arc, double t);
Vec2 velocity(const Arc& arc, double t);             // dx/dt
double determinant(const Arc& arc);                  // of the semi-axes
double largest_radius(const Arc& arc);               // the larger semi-axis
double smallest_radius(const Arc& arc);              // the smaller one
double length(const Arc& arc);                       // at most that; a circle's exactly
std::vector<Vec2> points_on(const Arc& arc, int n);  // n + 1 at even steps of t, its ends among them

/// t of the point of the whole circle or ellipse on the ray from its center to x, up to whole turns.
double parameter(const Arc& arc, const Vec2& x);

Vec2 onto(const Arc& arc, const Vec2& x);  // that point

/// The arc of a circle from a to b, the shorter way round, half a turn counter-clockwise; `center` is moved along the
/// chord until both ends have exactly the same distance to it.
Arc arc_between(const Vec2& a, const Vec2& b, const Vec2& center);

/// The same for a circle, less t of the middle of the arc: at most half a turn.
double beyond_middle(const Arc& arc, const Vec2& x);

/// Whether the direction of x, seen from the center of a circle, lies on the arc; its ends do.
bool faces(const Arc& arc, const Vec2& x);

}  // namespace kerf
