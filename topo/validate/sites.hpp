#pragma once
// Where the balls of a validation go.

#include "kerf/validate.hpp"

namespace kerf {

struct Site {
  std::size_t number;  // of the point
  Vec2 at;
  double clear = 0;  // distance to the next feature; not positive outside the body, on features and in rings
  bool inside = true;
  double ball = 0;                 // radius; 0: no radius fits
  std::vector<double> radii = {};  // those that fit, decreasing
};

/// Segments that a change keeps away from besides what is drawn: those of jumps_of_data.
using Segments = std::vector<std::pair<Vec2, Vec2>>;

/// The site of a point: what is clear around it, no radii and no ball yet.
Site site_at(const Shape& shape, const Functional& j, const Vec2& x, std::size_t number, const Segments& jumps = {});

/// Whether a change that reaches so far from the point leaves room around it.
bool fits(const Site& s, double reach);

/// The ball of a site that one such change alone is made in, of at most 0.6 of what is clear.
double ball_of_one(const Site& s, double reach);

/// In batches of at most so many whose balls keep apart, in their order.
std::vector<std::vector<Site>> in_batches(const std::vector<Site>& sites, std::size_t most);

/// Of balls in one mesh: each eliminates all others, at the third power of their number.
inline constexpr std::size_t together = 6;

/// Sites in batches whose balls keep apart.
std::vector<std::vector<Site>> place(const Shape& shape, const Functional& j, const ValidationRequest& request,
                                     const Segments& jumps);

/// The shape with a ball_hole of `sides` sides around every site; their label is the last one.
Shape with_balls(const Shape& shape, const std::vector<Site>& sites, int sides);

}  // namespace kerf
