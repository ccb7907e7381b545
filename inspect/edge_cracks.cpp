// The map of edge cracks: K at every place of the boundary, the ten worst, and what each place tolerates. A place is
// one of the worst where no other one of the same side has a larger K within two lengths or four edges.

#include "kerf/edge_cracks.hpp"

#include "base/parallel.hpp"
#include "inspect/near_boundary.hpp"
#include "inspect/tolerance.hpp"
#include "inspect/tops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf::inspect {

std::string_view word(Masked why) {
  static constexpr std::array<std::string_view, 6> words{
      "no", "support", "reentrant corner", "convex corner", "too near", "stress not smooth"};
  return words[static_cast<std::size_t>(why)];
}

Vec2 EdgeCrack::direction() const {
  return std::cos(angle) * Vec2(inward.y(), -inward.x()) + std::sin(angle) * inward;
}

bool EdgeCrack::flattest() const {
  return std::abs(angle - pi / 2) > pi / 2 - Mouths::flattest - 1e-3;
}

namespace {

void check(const Model& model, const EdgeCrackRequest& r) {
  if (!(r.length > 0 && std::isfinite(r.length)))
    throw Error(Fault::Usage, fmt::format("an edge crack of length {}: a positive length is wanted", r.length));
  if (r.angle && !(*r.angle >= Mouths::flattest - 1e-12 && *r.angle <= pi - Mouths::flattest + 1e-12))
    throw Error(Fault::Usage, fmt::format("an edge crack at {} degrees to the boundary: between 30 and 150 are known",
                                          *r.angle * 180 / pi));
  if (!(r.friction >= 0 && std::isfinite(r.friction)))
    throw Error(Fault::Usage, fmt::format("faces with friction {}: 0 or more is wanted", r.friction));
  for (const Material& m : all_materials(model.scene))
    if (!isotropic(m)) throw Error(Fault::Usage, "edge cracks are known in isotropic materials alone");
}

void add_masked_shares(EdgeCrackMap& map) {
  double all = 0;
  for (const EdgeCrack& crack : map.places) all += crack.along;
  if (all == 0) return;
  for (const EdgeCrack& crack : map.places) {
    if (crack.masked == Masked::No) continue;
    map.masked_share += crack.along / all;
    const auto why = std::ranges::find(reasons_to_mask, crack.masked) - reasons_to_mask.begin();
    map.masked_by[static_cast<std::size_t>(why)] += crack.along / all;
  }
}

std::vector<std::size_t> worst_of(const std::vector<EdgeCrack>& all, double apart) {
  std::vector<double> K;
  for (const EdgeCrack& crack : all) K.push_back(crack.masked == Masked::No ? crack.K : 0);
  return tops_of(K, [&](std::size_t a, std::size_t b) {
    return (all[a].at - all[b].at).norm() < apart && all[a].inward.dot(all[b].inward) > 0;
  });
}

}  // namespace

EdgeCrackMap edge_cracks(const Model& model, const State& state, const EdgeCrackRequest& request,
                         const std::optional<ToleranceRequest>& tolerance) {
  check(model, request);
  return edge_cracks(*recover_state(model, state), request, tolerance);
}

EdgeCrackMap edge_cracks(const RecoveredState& state, const EdgeCrackRequest& request,
                         const std::optional<ToleranceRequest>& tolerance) {
  const Model& model = state.model;
  check(model, request);
  if (tolerance) check(*tolerance);
  const NearBoundary near(state, request.friction, request.pressurized);
  std::vector<BoundaryPlace> places = near.places();
  if (!request.points.empty()) {
    std::vector<BoundaryPlace> asked;
    for (const Vec2& x : request.points) asked.push_back(near.nearest(x));
    places = std::move(asked);
  }
  EdgeCrackMap map{.length = request.length, .places = {}, .worst = {}};
  map.places.resize(places.size());
  if (tolerance) map.tolerance.resize(places.size());
  parallel_for(static_cast<Index>(places.size()), model.threads, [&](Index first, Index last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      map.places[i] = near.at(places[i], request.length, request.angle);
      if (tolerance) map.tolerance[i] = tolerate(near, places[i], map.places[i], request.length, *tolerance);
    }
  });
  if (tolerance) set_safe_length(places, map);
  add_masked_shares(map);
  double longest = 0;
  for (const BoundaryPlace& place : places) longest = std::max(longest, place.length);
  map.worst = worst_of(map.places, std::max(2 * request.length, 4 * longest));
  return map;
}

}  // namespace kerf::inspect
