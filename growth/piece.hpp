#pragma once
// Pieces by which a path grows: smooth or with a kink, as chords that end in the direction of the tip [theory: G.19,
// G.20].
//
// Directions are absolute, in radians counter-clockwise from x; angles and turns are relative.

#include "kerf/types.hpp"

#include <span>
#include <vector>

namespace kerf::growth {

/// A tip as its path ends: `curvature` [1/length], positive to the left.
struct PathTip {
  Vec2 at = Vec2::Zero();
  double direction = 0, curvature = 0;
};

/// The end of a polyline. With `smooth` it is the end of the arc through the last three points, else that of the last
/// chord, without curvature. Throws Error (Usage) for fewer than two points and for chords without length.
PathTip tip_of(std::span<const Vec2> path, bool smooth);

/// Begins in `direction`, ends in direction + turn, after `length`. `early` is the share of the turn that is done at
/// the begin: 1/3 after a kink, where directions change like the root of the way [theory: G.6]; 0 of a circular arc, 1
/// of a straight piece in the new direction.
struct GrowthPiece {
  Vec2 from = Vec2::Zero();
  double direction = 0, length = 0, turn = 0, early = 0;
};

/// A circular arc that continues the tip's direction.
GrowthPiece arc_piece(const PathTip& tip, double turn, double length);
/// A piece behind a kink by `angle` that bends by `turn` after it. Straight without a turn.
GrowthPiece kinked_piece(const PathTip& tip, double angle, double turn, double length);
/// A straight piece at the angle to the tip's direction: what an explicit scheme draws.
GrowthPiece straight_piece(const PathTip& tip, double angle, double length);

/// The points of a piece without its first, as n chords of one length. Their directions go from the begin to the end of
/// the turn, so that the last one is the direction of the tip, in which K is measured, and the mean one is right to the
/// second order for n >= 2. One chord for a straight piece; throws (Usage) for n < 2 otherwise.
std::vector<Vec2> chords(const GrowthPiece& piece, int n);
/// The tip at its end.
PathTip end_of(const GrowthPiece& piece, int n);

}  // namespace kerf::growth
