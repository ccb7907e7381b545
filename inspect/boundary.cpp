// Places along the boundary, with the room that a crack has there. The room across the body is what rays at 30, 60, 90,
// 120 and 150 degrees meet first, over the sine of the angle: that of a disc is its diameter in each direction.

#include "inspect/boundary.hpp"

#include "base/parallel.hpp"
#include "geometry/boundary_walk.hpp"
#include "geometry/plane.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::inspect {

namespace {

using Segments = std::vector<std::array<Vec2, 2>>;

/// How far a ray goes from a place until it meets a feature; what lies within `begin` is the place's own side.
double ray(const Segments& all, const Vec2& from, const Vec2& along, double begin) {
  double least = infinity;
  for (const auto& [a, b] : all) {
    const Vec2 d = b - a;
    const double across = cross(along, d);
    if (across == 0) continue;
    const double r = cross(a - from, d) / across, s = cross(a - from, along) / across;
    if (r > begin && s >= 0 && s <= 1) least = std::min(least, r);
  }
  return least;
}

}  // namespace

bool is_feature(const Mesh& mesh, Index e) {
  return mesh.sides[e][0] == none || mesh.sides[e][1] == none || mesh.crack[e] != none || is_interface(mesh, e);
}

Segments features(const Mesh& mesh) {
  Segments all;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (is_feature(mesh, e)) all.push_back({mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]]});
  return all;
}

std::vector<BoundaryPlace> places_along(const Model& model, int count) {
  const Mesh& mesh = model.mesh;
  const std::vector<BoundaryRun> runs = boundary_runs(mesh);
  const std::vector<Index> singular = singular_vertices(model);
  Segments held;
  std::vector<Vec2> corners;
  const auto is_held = [&](const BoundaryRun& run) {
    return std::ranges::find(model.scene.supports, mesh.label[run.edge], &Support::label) != model.scene.supports.end();
  };
  for (const BoundaryRun& run : runs) {
    if (is_held(run)) held.push_back({mesh.points[run.from], mesh.points[run.to]});
    if (std::abs(run.turn_before) > corner_turn && !std::ranges::binary_search(singular, run.from))
      corners.push_back(mesh.points[run.from]);
  }
  const Segments all = features(mesh);
  std::vector<BoundaryPlace> places(runs.size() * static_cast<std::size_t>(count));
  parallel_for(static_cast<Index>(runs.size()), model.threads, [&](Index first, Index last) {
    for (Index r = first; r < last; ++r) {
      const BoundaryRun& run = runs[static_cast<std::size_t>(r)];
      for (int i = 0; i < count; ++i) {
        BoundaryPlace& p = places[static_cast<std::size_t>(r * count + i)];
        const RunPoint on = point_on(mesh, runs, run, (2 * i + 1) / (2. * count));
        p.at = on.x;
        p.inward = on.inward;
        p.curvature = on.curvature;
        p.edge = run.edge;
        p.triangle = run.triangle;
        p.length = run.length / count;
        for (const Vec2& x : corners) p.corner = std::min(p.corner, (x - p.at).norm());
        for (const Index v : singular) p.singular = std::min(p.singular, (mesh.points[v] - p.at).norm());
        for (const auto& [a, b] : held) p.support = std::min(p.support, distance(p.at, a, b));
        if (is_held(run)) p.support = 0;
        for (const double angle : {pi / 6, pi / 3, pi / 2, 2 * pi / 3, 5 * pi / 6})
          p.across = std::min(
              p.across, ray(all, p.at, std::cos(angle) * on.tangent + std::sin(angle) * p.inward, run.length / 2) /
                            std::sin(angle));
      }
    }
  });
  return places;
}

}  // namespace kerf::inspect
