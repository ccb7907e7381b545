#pragma once
// Polylines with fewer and better placed points, which keep clear of one another.

#include "kerf/types.hpp"

#include <vector>

namespace kerf {

/// A piece of zero line: points, those that must stay; a closed one does not repeat its first point.
struct Chain {
  std::vector<Vec2> points;
  std::vector<bool> fixed;
  std::vector<Index> meets;  // per point, the obstacle (as a group) that it lies on, or none
  bool closed = false;
};

struct Simplifying {
  double spacing;
  double move;        // how far smoothing may move the line
  double chord;       // how far it may lie from the chords that replace it
  double offset = 0;  // area to gain on the left, per length
};

inline constexpr int longest_chord = 8;  // in steps of sample

/// Points at even steps, several per spacing, the fixed ones among them.
Chain sample(const Chain& chain, double spacing);

/// What a zero line must not meet. Segments of one group stand for one thing.
struct Obstacle {
  Vec2 a, b;
  Index group;
};

/// For a point of a chain the distance to other chains, its own beyond its neighborhood, and obstacles; and the same
/// without what the fixed points next to it lie on, which chords from these do not cross.
struct Clearance {
  double all, beside;
};
/// Per chain and point; `far` where nothing is nearer than that.
std::vector<std::vector<Clearance>> clearances(const std::vector<Chain>& chains, const std::vector<Obstacle>& obstacles,
                                               double far);

/// Fewer points than the fine chain has, about `spacing` apart, that enclose the area that `chain` does and what the
/// offset adds, by moves that are small against the clearance of its points. Fixed points stay as they are, among them
/// the ends of an open chain.
Chain simplify(const Chain& chain, const Chain& fine, const std::vector<Clearance>& clearance, const Simplifying& how);

}  // namespace kerf
