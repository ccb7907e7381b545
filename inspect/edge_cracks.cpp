// The map of edge cracks: K at every place of the boundary, the ten worst, and what each place tolerates. A place is
// one of the worst where no other one of the same side has a larger K within two lengths or four edges.

#include "kerf/edge_cracks.hpp"

#include "base/parallel.hpp"
#include "inspect/near_boundary.hpp"
#include "inspect/tolerance.hpp"

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

std::vector<std::size_t> worst_of(const std::vector<EdgeCrack>& all, double apart) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].masked == Masked::No && all[i].K > 0) order.push_back(i);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return all[a].K > all[b].K; });
  // A place beside a worse one is none of its own, nor is one beside that: only tops count.
  std::vector<std::size_t> worst;
  std::vector<bool> seen(all.size(), false);
  constexpr std::size_t most = 10;
  for (const std::size_t i : order) {
    if (worst.size() == most) break;
    const bool top = std::ranges::none_of(order, [&](std::size_t k) {
      return seen[k] && (all[k].at - all[i].at).norm() < apart && all[k].inward.dot(all[i].inward) > 0;
    });
    seen[i] = true;
    if (top) worst.push_back(i);
  }
  return worst;
}

}  // namespace

EdgeCrackMap edge_cracks(const Model& model, const State& state, const EdgeCrackRequest& request,
                         const std::optional<ToleranceRequest>& tolerance) {
  check(model, request);
  if (tolerance) check(*tolerance);
  const NearBoundary near(model, state, request.friction, request.pressurized);
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
  double all = 0, masked = 0, longest = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    all += places[i].length;
    if (map.places[i].masked != Masked::No) masked += places[i].length;
    longest = std::max(longest, places[i].length);
  }
  map.masked_share = all > 0 ? masked / all : 0;
  map.worst = worst_of(map.places, std::max(2 * request.length, 4 * longest));
  return map;
}

}  // namespace kerf::inspect
