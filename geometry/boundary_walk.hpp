#pragma once
// The boundary of a mesh as a walk: its edges, each with the body to its left, and which one comes before and behind.

#include "kerf/mesh.hpp"

#include <vector>

namespace kerf {

/// Two edges that meet at more than this make a corner, chords that turn by less stand for a curve.
inline constexpr double corner_turn = 35 * pi / 180;

/// An edge of the boundary from `from` to `to`, the body to its left.
struct BoundaryRun {
  Index edge = none, from = none, to = none;
  Index triangle = none;                          // beside it
  Index before = none, behind = none;             // among the runs; none where several parts of the boundary meet
  Vec2 begin = Vec2::Zero(), end = Vec2::Zero();  // unit tangents: those of its arc, else of the chord
  double length = 0;                              // of the chord
  double turn_before = 0, turn_behind = 0;        // radians to the left, at `from` and at `to`
};

/// All of them, in the order of their edges.
std::vector<BoundaryRun> boundary_runs(const Mesh& mesh);

/// A place at a share s of a run: on its arc where it has one. `inward` is the tangent turned by +90 degrees.
struct RunPoint {
  Vec2 x, tangent, inward;
  double speed = 0;      // length of the boundary per s
  double curvature = 0;  // positive: the body is convex. Of chords: the turns at both ends over the length between the
                         // middles of the edges before and behind; 0 beside a corner
};
RunPoint point_on(const Mesh& mesh, const std::vector<BoundaryRun>& runs, const BoundaryRun& run, double s);

/// Whether chords have a curvature here: neighbors on both sides and no corner between.
bool is_bent(const BoundaryRun& run);

}  // namespace kerf
