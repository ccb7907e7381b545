// K at a place of the boundary for a length, from the recovered stress. What is left out is the rest of the geometry
// [theory: M.6]: a straight side at distance b across changes K by up to 7.5 (a/b)^2, of a strip in bending, a circle
// of radius R by up to 1.7 (a/R)^2 beyond the term of curvature, and a hollow rim with a side across by 7 a^2/(b R)
// more. 5 % of their sum are valid_length; corners, tips and ends of supports keep five lengths off.

#include "inspect/near_boundary.hpp"

#include "solver/system.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::inspect {

namespace {

constexpr double across = 7.5, hollow = 7, round = 1.7, valid = 0.05, room_to_corners = 0.2;
constexpr double smooth = 0.05;       // of LocalStress::rough
constexpr double corner_room = 0.04;  // of ReentrantCorner::room

double valid_length(const BoundaryPlace& p) {
  const double left_out = across / (p.across * p.across) + hollow * std::max(-p.curvature, 0.) / p.across +
                          round * p.curvature * p.curvature;  // per length squared
  return std::min(std::sqrt(valid / left_out), room_to_corners * std::min({p.corner, p.singular, p.support}));
}

Masked why_masked(const BoundaryPlace& p, double length, double rough) {
  if (length > room_to_corners * p.support) return Masked::Support;
  if (length > room_to_corners * p.singular) return Masked::Reentrant;
  if (length > room_to_corners * p.corner) return Masked::Convex;
  if (length > valid_length(p)) return Masked::Near;
  return rough > smooth ? Masked::Rough : Masked::No;
}

}  // namespace

RecoveredState::RecoveredState(const Model& m, const State& s)
    : model(m),
      state(s),
      corners(split_for_stress(m.mesh)),
      stress(recover_stress(m, s, corners, singular_corners(m, s, corners), m.scene.body)),
      locator(make_locator(m.mesh)) {}

Eigen::Vector3d RecoveredState::at(const PointIn& point) const {
  return recovered_at(model, state, corners, stress, point);
}

std::shared_ptr<const RecoveredState> recover_state(const Model& model, const State& state) {
  return std::make_shared<const RecoveredState>(model, state);
}

NearBoundary::NearBoundary(const RecoveredState& state, double friction, bool pressurized)
    : state_(state), model_(state.model), mouths_(friction, state.model.threads), pressurized_(pressurized) {
  constexpr int per_edge = 3;
  places_ = places_along(model_, per_edge);
  corners_ = reentrant_corners(state);
  for (std::size_t i = 0; i < corners_.size(); ++i)
    places_.push_back({.at = corners_[i].at,
                       .inward = corners_[i].bisector,
                       .edge = corners_[i].edge,
                       .triangle = corners_[i].triangle,
                       .wedge = static_cast<Index>(i)});
}

const BoundaryPlace& NearBoundary::nearest(const Vec2& x) const {
  return *std::ranges::min_element(places_, {}, [&](const BoundaryPlace& p) { return (p.at - x).squaredNorm(); });
}

// In the frame of the boundary. Points on the boundary itself may lie outside of its chords by rounding: they take the
// triangle beside them.
std::optional<LocalStress> NearBoundary::stress_near(const BoundaryPlace& place, double length) const {
  const Vec2 tangent(place.inward.y(), -place.inward.x());
  Eigen::Matrix<double, 3, samples> values;
  for (int i = 0; i < samples; ++i) {
    const Vec2& y = sample_places()[static_cast<std::size_t>(i)];
    const Vec2 x = place.at + length * (y.x() * tangent + y.y() * place.inward);
    Index t = i == 0 ? place.triangle : locate(model_.mesh, state_.locator, x);
    if (t == none) {  // between a chord and its arc
      t = nearest_triangle(model_.mesh, state_.locator, x);
      if (t == none || (x - centroid(model_.mesh, t)).norm() > 2 * std::sqrt(area(model_.mesh, t))) return std::nullopt;
    }
    const Eigen::Vector3d s = state_.at({t, x});
    const Mat2 full{{s[0], s[2]}, {s[2], s[1]}};
    values.col(i) << tangent.dot(full * tangent), place.inward.dot(full * place.inward),
        tangent.dot(full * place.inward);
  }
  const Vec2 load = load_on(place);
  return fit_stress(values, {-place.inward.dot(load), -tangent.dot(load)});
}

Vec2 NearBoundary::load_on(const BoundaryPlace& place) const {
  Vec2 sum = Vec2::Zero();
  for (const kerf::Traction& load : model_.scene.tractions)
    if (load.label == model_.mesh.label[place.edge]) sum += load.value(place.at, -place.inward);
  return sum;
}

double NearBoundary::pressure_on(const BoundaryPlace& place) const {
  return std::max(load_on(place).dot(place.inward), 0.);
}

EdgeCrack NearBoundary::at_corner(const ReentrantCorner& corner, double length) const {
  EdgeCrack crack{.at = corner.at, .inward = corner.bisector, .angle = pi / 2};
  crack.corner = corner.wedge.lambda[0];
  crack.stress = crack.gradient = crack.first_order = nan;
  crack.valid_length = corner_room * corner.room;
  const auto K = [&](std::size_t mode) {
    return corner.wedge.factor[mode] * corner.intensity[mode] * std::pow(length, corner.wedge.lambda[mode] - 0.5);
  };
  crack.K_I = K(0);
  crack.K_II = K(1);
  crack.closed = crack.K_I <= 0;  // and then nothing is said
  crack.K = std::hypot(crack.K_I, crack.K_II);
  crack.G = crack.K * crack.K / plane_modulus(material_of(model_.mesh, model_.scene, corner.triangle));
  crack.masked = length > crack.valid_length || crack.closed ? Masked::Reentrant : Masked::No;
  return crack;
}

EdgeCrack NearBoundary::at(const BoundaryPlace& place, double length, std::optional<double> angle) const {
  if (place.wedge != none) return at_corner(corners_[static_cast<std::size_t>(place.wedge)], length);
  EdgeCrack crack{.at = place.at, .inward = place.inward, .along = place.length, .curvature = place.curvature};
  crack.valid_length = valid_length(place);
  const std::optional<LocalStress> stress = stress_near(place, length);
  if (!stress) {
    crack.masked = Masked::Near;
    crack.angle = angle.value_or(pi / 2);
    crack.K_I = crack.K_II = crack.K = crack.G = crack.stress = crack.gradient = crack.first_order = nan;
    return crack;
  }
  const MouthAt mouth{length, place.curvature, pressurized_ ? pressure_on(place) : 0};
  crack.stress = stress->of(0, 0);
  crack.gradient = stress->of(0, 2) / length;
  crack.angle = angle ? *angle : worst_angle(mouths_, *stress, mouth);
  const EdgeIntensity k = intensity(mouths_, *stress, mouth, crack.angle);
  crack.K_I = k.K_I;
  crack.K_II = k.K_II;
  crack.closed = k.closed;
  crack.K = std::hypot(k.K_I, k.K_II);
  crack.G = crack.K * crack.K / plane_modulus(material_of(model_.mesh, model_.scene, place.triangle));
  crack.first_order = 1.1215222552 * (crack.stress + mouth.pressure) * std::sqrt(pi * length);
  crack.masked = why_masked(place, length, stress->rough);
  return crack;
}

}  // namespace kerf::inspect
