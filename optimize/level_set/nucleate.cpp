// Where holes lower J + lambda |Omega|, how large they are cut, and what was drawn of them [theory: L.6, L.14].
// Triangles in the order of T, the least first, as long as T is below the price and area is left: at each a disc of the
// radius r^2 = (lambda - T)/(2 c2) that gains most, but at most a third of the room to the boundary, to what is frozen
// and to the other discs. Fifty places that do not pay end the search. Where the design has a mirror a disc and its
// image come together, or one disc on the axis where both would meet. What a design has of a disc afterwards is neither
// its radius nor its place: `drawn_holes` tells the hole around its center, unless it has grown into a larger one.
// docs/theory/level_set.md, section "Nucleation".

#include "optimize/level_set/nucleate.hpp"

#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

constexpr double clear_radii = 3;  // radii around a hole where the expansion still ranks points

/// Discs that were chosen, and what they have to keep clear of.
class Places {
 public:
  Places(const BackgroundMesh& background, const Eigen::VectorXd& distance, const HolesIn& body, const Nucleation& how)
      : background_(background), distance_(distance), body_(body), how_(how) {
    const Mesh& m = body.mesh;
    for (std::size_t e = 0; e < m.edges.size(); ++e)
      if (m.sides[e][0] == none || m.sides[e][1] == none)
        boundary_.push_back({m.points[std::size_t(m.edges[e][0])], m.points[std::size_t(m.edges[e][1])]});
  }

  /// The disc of largest gain at x and, where the design has a mirror, its image; on the axis where both would meet.
  /// Their area; 0: there is no room, none pays, or the mesh is too coarse to tell.
  double add(Vec2 x) {
    double most = largest(x);
    if (most < how_.least) return 0;
    bool twice = false;
    if (const std::optional<Mirror>& mirror = background_.mirror) {
      const Vec2 image = image_of(*mirror, x);
      const double there = largest(image);  // not positive: the mirror shows no body
      twice = there > 0 && (image - x).norm() >= (1 + clear_radii) * most;
      if (twice) most = std::min(most, there);
      if (there > 0 && !twice) most = largest(x = 0.5 * (x + image));
    }
    if (most < how_.least) return 0;
    if (std::ranges::any_of(refused_, [&](const Vec2& y) { return (x - y).norm() < how_.least; })) return 0;
    // Where only the mesh hides c2 no radius is chosen: T alone would take all the room.
    const HoleTerms terms = body_.terms(x);
    const double radius = best_radius(terms, how_.multiplier, most);
    if (radius < how_.least || (how_.resolved && !terms.resolved)) {
      refused_.push_back(x);
      return 0;
    }
    discs.push_back({x, radius});
    if (twice) discs.push_back({image_of(*background_.mirror, x), radius});
    return (twice ? 2 : 1) * pi * radius * radius;
  }

  /// Whether so many places do not pay, or are not resolved, that the next ones, with a larger T, will not.
  bool exhausted() const {
    constexpr std::size_t enough = 50;
    return refused_.size() >= enough;
  }

  std::vector<Disc> discs;

 private:
  /// A third of the room to the boundary, supports and loads included, to what is frozen and to other discs.
  /// The distances on the canvas settle most points; edges of the mesh are asked for the rest, supports and loads
  /// included.
  double largest(const Vec2& x) const {
    double room = -value_at(background_, distance_, x);
    if (background_.frozen.size() > 0) room = std::min(room, value_at(background_, background_.frozen, x));
    for (const Disc& d : discs) room = std::min(room, (d.center - x).norm() - d.radius);
    if (room < clear_radii * how_.least) return room / clear_radii;
    for (const auto& [a, b] : boundary_) room = std::min(room, kerf::distance(x, a, b));
    return std::min(room / clear_radii, how_.most);
  }

  const BackgroundMesh& background_;
  const Eigen::VectorXd& distance_;
  const HolesIn& body_;
  const Nucleation& how_;
  std::vector<Vec2> refused_;
  std::vector<std::array<Vec2, 2>> boundary_;
};

}  // namespace

std::vector<Disc> places_to_nucleate(const BackgroundMesh& background, const Eigen::VectorXd& distance,
                                     const HolesIn& body, const Nucleation& how) {
  const Eigen::VectorXd& T = body.T;
  std::vector<Index> order(static_cast<std::size_t>(T.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return std::tie(T[a], a) < std::tie(T[b], b); });
  Places places(background, distance, body, how);
  double left = how.area;
  for (const Index t : order) {
    if (!(T[t] < how.multiplier) || left <= 0 || places.exhausted()) break;
    left -= places.add(centroid(body.mesh, t));
  }
  return std::move(places.discs);
}

namespace {

struct DrawnLoop {
  std::vector<Vec2> points;
  double area = 0;
  Vec2 centroid = Vec2::Zero();
};

// Area and centroid by Green's formula about a point of the loop, whichever way it runs.
DrawnLoop drawn(const Loop& loop) {
  const double size = extent({.outline = loop});
  DrawnLoop d{.points = flatten(loop, 1e-3 * size, size).points};
  const Vec2 origin = d.points.front();
  for (std::size_t i = 0; i < d.points.size(); ++i) {
    const Vec2 a = d.points[i] - origin, b = d.points[(i + 1) % d.points.size()] - origin;
    d.area += 0.5 * cross(a, b);
    d.centroid += cross(a, b) / 6 * (a + b);
  }
  d.centroid = origin + d.centroid / d.area;
  d.area = std::abs(d.area);
  return d;
}

}  // namespace

// A hole is one of its own where the drawn loop around the disc's center is round: no corner beyond 1.5 radii of its
// area.
std::vector<NucleatedHole> drawn_holes(std::span<const Disc> discs, const Shape& shape) {
  constexpr double round = 1.5;  // radii of the same area to the farthest corner: a square has 1.25
  std::vector<DrawnLoop> loops;
  for (const Loop& hole : shape.holes) loops.push_back(drawn(hole));
  std::vector<NucleatedHole> holes;
  for (const Disc& disc : discs) {
    NucleatedHole& hole = holes.emplace_back();
    hole.at = disc.center;
    const auto around = std::ranges::find_if(loops, [&](const DrawnLoop& d) { return inside(d.points, disc.center); });
    if (around == loops.end()) {
      hole.note = "the design drawn has no hole of its own there";
      continue;
    }
    const double radius = std::sqrt(around->area / pi);
    if (std::ranges::any_of(around->points,
                            [&](const Vec2& x) { return (x - around->centroid).norm() > round * radius; })) {
      hole.note = "it became part of a larger hole";
      continue;
    }
    hole.at = around->centroid;
    hole.radius = radius;
  }
  return holes;
}

}  // namespace kerf
