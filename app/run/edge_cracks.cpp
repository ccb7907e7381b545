// Edge cracks in a run: from the state to edge_cracks.csv (all places), edge_cracks.png and a section of the result
// (the ten worst places, or those that were asked for). docs/theory/edge_cracks.md.

#include "app/run/edge_cracks.hpp"

#include "app/write/draw.hpp"
#include "base/stopwatch.hpp"
#include "growth/rates.hpp"
#include "inspect/interior.hpp"
#include "inspect/recovered.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

std::vector<std::vector<double>> rows_of(const std::vector<inspect::InteriorCrack>& cracks) {
  std::vector<std::vector<double>> rows;
  for (const inspect::InteriorCrack& c : cracks)
    rows.push_back(
        {c.at.x(), c.at.y(), c.direction * 180 / pi, c.K, c.K_I, c.K_II, c.closed ? 1. : 0., c.masked ? 1. : 0.});
  return rows;
}

}  // namespace

EdgeCrackResult inspect_edges(const Case& c, const inspect::RecoveredState& state, Journal& journal) {
  const inspect::EdgeCrackRequest& request = *c.edge_cracks;
  const inspect::EdgeCrackMap map = inspect::edge_cracks(state, request, c.tolerance);
  EdgeCrackResult r{.length = request.length,
                    .angle = request.angle,
                    .friction = request.friction,
                    .pressurized = request.pressurized,
                    .places = static_cast<int>(map.places.size()),
                    .masked_share = map.masked_share,
                    .masked_by = map.masked_by,
                    .worst = {},
                    .asked = !request.points.empty()};
  const auto take = [&](std::size_t i) {
    r.worst.push_back({map.places[i], map.tolerance.empty() ? inspect::Tolerance{} : map.tolerance[i]});
  };
  if (r.asked)
    for (std::size_t i = 0; i < map.places.size(); ++i) take(i);
  else
    std::ranges::for_each(map.worst, take);
  if (c.tolerance) {
    r.law = c.tolerance->law ? growth::name(*c.tolerance->law) : "toughness";
    r.factor = c.tolerance->factor;
    r.open_share = map.open_share;
    if (!std::isnan(map.safe_length)) r.safe = PlacedValue{map.places[map.safe_at].at, map.safe_length};
  }
  const std::vector<inspect::InteriorCrack> interior =
      inspect::interior_cracks(state, request.length, request.friction);
  r.inside = inspect::worst_inside(interior, request.length);
  journal.seconds.map += journal.lap();
  journal.begin("write the edge cracks");
  journal.later([path = journal.file("interior_cracks.csv"), rows = rows_of(interior)] {
    write_csv(path, {"x", "y", "direction", "K", "K_I", "K_II", "closed", "masked"}, rows);
  });
  journal.later([path = journal.file("edge_cracks.csv"), map] { write_edge_cracks_csv(path, map); });
  journal.picture("edge_cracks.png", [&] {
    return edge_crack_picture(journal.title_of_state(), state.model.mesh, map, interior, c.units);
  });
  journal.seconds.output += journal.lap();
  return r;
}

void draw_edge_cracks(const Case& c, const inspect::RecoveredState& state, const Sizing& sizing, const Adaptation& how,
                      Journal& journal, EdgeCrackResult& result) {
  journal.begin("draw edge cracks");
  constexpr std::size_t most = 3;
  std::vector<inspect::EdgeCrack> cracks;
  if (c.drawn_at.empty()) {
    for (const EdgeCrackResult::Row& row : result.worst) cracks.push_back(row.crack);
    if (!result.asked && cracks.size() > most) cracks.resize(most);
  } else {
    inspect::EdgeCrackRequest at = *c.edge_cracks;
    at.points = c.drawn_at;
    cracks = inspect::edge_cracks(state, at).places;
  }
  result.drawn = inspect::draw_cracks(state, {c.shape, sizing}, *c.edge_cracks, cracks, c.drawn_lengths, how);
  journal.seconds.validate += journal.lap();
  journal.later([path = journal.file("drawn_edge_cracks.csv"), drawn = result.drawn] {
    write_drawn_edge_cracks_csv(path, drawn);
  });
  journal.seconds.output += journal.lap();
}

}  // namespace kerf
