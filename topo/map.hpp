#pragma once
// T(x) over candidate points, from the stress itself.

#include "solver/recover.hpp"
#include "topo/functional.hpp"

#include <memory>
#include <optional>
#include <span>

namespace kerf {

/// What T(x) is made of, for one J: solved once, evaluated anywhere.
struct Analysis {
  const Model* model;
  const State* state;
  double value = 0;                // J
  std::vector<double> term_value;  // of each term, factor left out
  // Weights of -1/2 form(s, s) + b.u: energies, and compliances under homogeneous supports (-2).
  double energy_share = 0;
  State adjoint = {};  // of all other terms; nothing in it when there are none
  // With a misfit: the body with measured displacements.
  std::shared_ptr<const Model> measured_model = {};
  std::shared_ptr<const State> measured = {};
  double measured_share = 0;
  std::vector<ContactStatus> status = {};  // per row in contact
  double biactive_length = 0;
};

/// Value of J and, unless `value_only`, everything that its map needs. Throws Error(Usage | Numerics).
Analysis analyse(const Functional& j, const Model& model, const State& state, bool value_only = false);

struct MapPoint {
  Vec2 at = Vec2::Zero();
  double value = 0;  // T; of a clamped hole the predicted difference of J at MapRequest::radius; NaN outside the body
  double angle = 0;  // radians, of the ellipse or the crack
  bool masked = false;  // the expansion cannot hold here at the asked radius
  std::optional<double> lower = {}, upper = {};
};

/// The expansion needs this many radii to the next feature (boundary, crack, tip, end of contact, region, support or
/// load that ends, ring of the functional).
inline constexpr double clear_radii = 4;

struct MapRequest {
  Perturbation perturbation;
  double radius = 0;  // that the mask, and a clamped hole, are for
  bool bounds = false;
};

std::vector<MapPoint> map_at(const Analysis& a, const Functional& j, const MapRequest& r, std::span<const Vec2> points);

/// The same everywhere: at the centroid of every triangle and at every corner of split_at_cracks.
struct FullMap {
  Eigen::VectorXd at_centroids, at_corners, angle;  // angle at centroids, or empty
  Eigen::VectorXd lower, upper;                     // at corners, or empty
  std::vector<bool> masked_centroid, masked_corner;
};
FullMap map_everywhere(const Analysis& a, const Functional& j, const MapRequest& r, const Corners& corners);

}  // namespace kerf
