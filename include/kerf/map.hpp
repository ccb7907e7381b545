#pragma once
// T(x) over candidate points, from the stress itself.

#include "kerf/analysis.hpp"
#include "kerf/mesher.hpp"
#include "kerf/recover.hpp"

#include <optional>
#include <span>

namespace kerf {

struct MapPoint {
  Vec2 at = Vec2::Zero();
  double value = 0;  // T; of a clamped hole the predicted difference of J at MapRequest::radius; NaN outside the body
  double angle = 0;  // radians, of the ellipse or the crack
  bool masked = false;  // the expansion cannot hold here at the asked radius
  std::optional<double> lower = {}, upper = {};
  std::optional<double> c2 = {}, valid_radius = {};  // where MapRequest::second asks for them; NaN: not known there
};

/// The expansion needs this many radii to the next feature (boundary, crack, tip, end of contact, region, support or
/// load that ends, ring of the functional), where nothing else tells how far it reaches.
inline constexpr double clear_radii = 4;

struct MapRequest {
  Perturbation perturbation;
  double radius = 0;  // that the mask, and a clamped hole, are for
  bool bounds = false;
  // c2 of second_order.hpp, and up to which radius the first term is good to 5 %, which masks points instead of the
  // distance to the next feature. On whole maps |T| below 1 % of the largest counts as that.
  bool second = false;
};

std::vector<MapPoint> map_at(const Analysis& a, const Functional& j, const MapRequest& r, std::span<const Vec2> points);

/// The same everywhere: at the centroid of every triangle and at every corner of split_for_stress.
struct FullMap {
  Eigen::VectorXd at_centroids, at_corners, angle;  // angle at centroids, or empty
  Eigen::VectorXd lower, upper;                     // at corners, or empty
  std::vector<bool> masked_centroid, masked_corner;
  Eigen::VectorXd margin;            // at corners: distance to the nearest feature less what the mask asks for; where
                                     // c2 is known the radius that the first term reaches, less that of the request
  Eigen::VectorXd c2, valid_radius;  // at corners, or empty; NaN where not known
  std::string second_note;           // why c2 is not known anywhere
};
FullMap map_everywhere(const Analysis& a, const Functional& j, const MapRequest& r, const Corners& corners);

/// What meshes are made of, for solutions on other meshes than the analysis has.
struct Meshing {
  const Shape& shape;
  const Sizing& sizing;
};
/// Maps of one analysis and one request.
struct Maps {
  FullMap& everywhere;
  std::span<MapPoint> points;
};
/// Error bars for maps of a: lower and upper at the corners and at the points. They come from a better solution (a
/// higher degree, finer where the body is singular or curved, 2 to 6 times the work of the state), are asymptotically
/// right, cover at least 95 % of the points of known solutions, and are no guarantee. Throws Error(Usage) for elements
/// without a better one, Error(Numerics) when that solution fails.
void add_bars(const Analysis& a, const Functional& j, const MapRequest& r, const Meshing& meshing, const Maps& maps);

}  // namespace kerf
