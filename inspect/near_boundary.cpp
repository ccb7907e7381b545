// K at a place of the boundary for a length, from the recovered stress. What is left out is the rest of the geometry
// [theory: M.6]: a straight side at distance b across changes K by up to 7.5 (a/b)^2, of a strip in bending, a circle
// of radius R by up to 1.7 (a/R)^2 beyond the term of curvature. 5 % of their sum are valid_length; corners, tips and
// ends of supports keep five lengths off.

#include "inspect/near_boundary.hpp"

#include "solver/system.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::inspect {

namespace {

constexpr double across = 7.5, round = 1.7, valid = 0.05, room_to_corners = 0.2;
constexpr double smooth = 0.05;  // of LocalStress::rough

double valid_length(const BoundaryPlace& p) {
  const double left_out = across / (p.across * p.across) + round * p.curvature * p.curvature;  // per length squared
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

NearBoundary::NearBoundary(const Model& model, const State& state, double friction, bool pressurized)
    : model_(model), state_(state), mouths_(friction), pressurized_(pressurized) {
  corners_ = split_for_stress(model.mesh);
  recovered_ = recover_stress(model, state, corners_, singular_corners(model, state, corners_), model.scene.body);
  locator_ = make_locator(model.mesh);
  constexpr int per_edge = 3;
  places_ = places_along(model, per_edge);
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
    Index t = i == 0 ? place.triangle : locate(model_.mesh, locator_, x);
    if (t == none) {  // between a chord and its arc
      t = nearest_triangle(model_.mesh, locator_, x);
      if (t == none || (x - centroid(model_.mesh, t)).norm() > 2 * std::sqrt(area(model_.mesh, t))) return std::nullopt;
    }
    const Eigen::Vector3d s = recovered_at(model_, state_, corners_, recovered_, {t, x});
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

EdgeCrack NearBoundary::at(const BoundaryPlace& place, double length, std::optional<double> angle) const {
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
