// Where the balls of a validation go: the distance of a point to all features of the shape, the radii that fit into it,
// and batches of balls that keep apart. A radius fits if the change reaches at most 0.6 of the clear distance. The ball
// around it is at least twice the largest change where there is room, and at most 0.88 of the clear distance (0.85 and
// 1.7 for a ball of one change): the ring between them is meshed in shells. Distances are those to the drawn shape,
// arcs flattened to 1e-4 of its size, not to a mesh. Rings of functionals count by their outer radius, edge cracks by
// their length. docs/theory/validation.md, section "One mesh".

#include "topo/validate/sites.hpp"

#include "geometry/ball.hpp"
#include "geometry/plane.hpp"
#include "topo/formulas/kind.hpp"

#include <fmt/core.h>
#include <algorithm>

#include <cmath>

namespace kerf {

namespace {

// Negative outside the body.
double clearance(const Shape& shape, const Functional& j, const Vec2& x, bool& in_body) {
  const double size = extent(shape);
  double least = infinity, to_sides = infinity;
  in_body = true;
  // Regions are features, and not outside the body.
  const auto loop = [&](const Loop& l, bool body_inside, bool counts) {
    const Polygon p = flatten(l, 1e-4 * size, size);
    for (std::size_t i = 0; i < p.points.size(); ++i)
      least = std::min(least, distance(x, p.points[i], p.points[(i + 1) % p.points.size()]));
    if (counts && inside(p.points, x) != body_inside) in_body = false;
  };
  loop(shape.outline, true, true);
  for (const Loop& hole : shape.holes) loop(hole, false, true);
  to_sides = least;
  for (const Loop& region : shape.regions) loop(region, true, false);
  for (const Crack& crack : shape.cracks) {
    const std::vector<Vec2> points = crack.arc ? points_on(*crack.arc, 256) : crack.points;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) least = std::min(least, distance(x, points[i], points[i + 1]));
  }
  for (const Term& term : j.terms)
    if (term.feature_radius > 0) least = std::min(least, (x - term.feature).norm() - term.feature_radius);
  for (const Term& term : j.terms)
    if (term.edge_cracks) least = std::min(least, to_sides - term.edge_cracks->length);
  return in_body ? least : -std::abs(least);  // within a ring it is negative already
}

}  // namespace

Site site_at(const Shape& shape, const Functional& j, const Vec2& x, std::size_t number, const Segments& jumps) {
  Site s{.number = number, .at = x};
  s.clear = clearance(shape, j, x, s.inside);
  for (const auto& [a, b] : jumps) s.clear = std::min(s.clear, distance(x, a, b));
  constexpr double rounding = 1e-12;
  s.inside = s.inside || s.clear > -rounding * extent(shape);  // on the boundary
  return s;
}

bool fits(const Site& s, double reach) {
  constexpr double fullest = 0.6;  // of the clear disc
  return reach <= fullest * s.clear;
}

double ball_of_one(const Site& s, double reach) {
  return std::min(0.85 * s.clear, 1.7 * reach);
}

// Balls of a batch keep a tenth of the sum of their radii between them.
std::vector<std::vector<Site>> in_batches(const std::vector<Site>& sites, std::size_t most) {
  // First fit, in the order of the points.
  constexpr double apart = 1.1;
  std::vector<std::vector<Site>> batches;
  for (const Site& s : sites) {
    const auto has_room = [&](const std::vector<Site>& batch) {
      return batch.size() < most && std::all_of(batch.begin(), batch.end(), [&](const Site& o) {
               return (o.at - s.at).norm() > apart * (o.ball + s.ball);
             });
    };
    const auto batch = std::find_if(batches.begin(), batches.end(), has_room);
    if (batch == batches.end())
      batches.push_back({s});
    else
      batch->push_back(s);
  }
  return batches;
}

std::vector<std::vector<Site>> place(const Shape& shape, const Functional& j, const ValidationRequest& r,
                                     const Segments& jumps) {
  // A change reaches this far per radius, and has a ball at least `roomy` times as large where there is room.
  const double reach = kerf::reach(r.perturbation);
  constexpr double widest = 0.88, roomy = 2;
  std::vector<Site> sites;
  for (std::size_t i = 0; i < r.points.size(); ++i) {
    Site s = site_at(shape, j, r.points[i], i, jumps);
    for (const double radius : r.radii)
      if (fits(s, reach * radius)) s.radii.push_back(radius);
    if (!s.radii.empty()) s.ball = std::min(widest * s.clear, roomy * reach * s.radii.front());
    sites.push_back(std::move(s));
  }
  return in_batches(sites, sites.size());
}

// Holes with polygons of that many sides: what fills them is put into the mesh afterwards.
Shape with_balls(const Shape& shape, const std::vector<Site>& sites, int sides) {
  Shape outside = shape;
  outside.labels.emplace_back("balls of the validation");
  const Index label = static_cast<Index>(outside.labels.size()) - 1;
  for (const Site& s : sites)
    outside.holes.push_back(ball_hole(fmt::format("ball {}", s.number + 1), {s.at, s.ball, sides}, label));
  return outside;
}

}  // namespace kerf
