// Places along the boundary. Tangents are those of arcs where edges follow them, else of the edges. Two edges that meet
// at more than `corner` make a corner; chords that turn by less stand for a curve, whose curvature is half the turns at
// both ends over the length. The room across the body is what rays at 30, 60, 90, 120 and 150 degrees
// meet first, over the sine of the angle: that of a disc is its diameter in each direction.

#include "inspect/boundary.hpp"

#include "base/parallel.hpp"
#include "geometry/plane.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::inspect {

namespace {

constexpr double corner_turn = 35 * pi / 180;

/// An edge of the boundary, run through with the body to the left.
struct Run {
  Index edge = none, from = none, to = none;
  Vec2 begin = Vec2::Zero(), end = Vec2::Zero();  // unit tangents
  double length = 0, turn_before = 0, turn_behind = 0;
  bool held = false;
};

const Arc* arc_of(const Mesh& mesh, Index edge) {
  return mesh.arc.empty() || mesh.arc[edge] == none ? nullptr : &mesh.arcs[mesh.arc[edge]];
}

/// Parameter of an arc at the share s of a run.
double along(const Mesh& mesh, const Run& run, const Arc& arc, double s) {
  const double share = mesh.edges[run.edge][0] == run.from ? s : 1 - s;
  return arc.from + share * (arc.to - arc.from);
}

Vec2 tangent_at(const Mesh& mesh, const Run& run, double s) {
  const Vec2 chord = mesh.points[run.to] - mesh.points[run.from];
  const Arc* arc = arc_of(mesh, run.edge);
  if (!arc) return chord.normalized();
  const Vec2 v = velocity(*arc, along(mesh, run, *arc, s)).normalized();
  return v.dot(chord) < 0 ? Vec2(-v) : v;
}

double turn(const Vec2& a, const Vec2& b) {
  return std::atan2(cross(a, b), a.dot(b));
}

std::vector<Run> runs_of(const Model& model) {
  const Mesh& mesh = model.mesh;
  std::vector<Run> runs;
  std::vector<Index> into(mesh.points.size(), none);
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    const auto& [left, right] = mesh.sides[e];
    if ((left != none) == (right != none)) continue;
    const auto& [a, b] = mesh.edges[e];
    Run run{.edge = e, .from = left != none ? a : b, .to = left != none ? b : a, .length = length(mesh, e)};
    run.begin = tangent_at(mesh, run, 0);
    run.end = tangent_at(mesh, run, 1);
    run.held = std::ranges::any_of(model.scene.supports, [&](const Support& s) { return s.label == mesh.label[e]; });
    into[run.to] = static_cast<Index>(runs.size());
    runs.push_back(run);
  }
  for (Run& run : runs)
    if (const Index before = into[run.from]; before != none) {
      Run& last = runs[static_cast<std::size_t>(before)];
      run.turn_before = last.turn_behind = turn(last.end, run.begin);
    }
  return runs;
}

/// At the share s of a run: x'' . inward/|x'|^2 of its arc, or that of the curve that chords stand for.
double curvature_at(const Mesh& mesh, const Run& run, double s, const Vec2& inward) {
  if (const Arc* arc = arc_of(mesh, run.edge)) {
    const double t = along(mesh, run, *arc, s);
    return (arc->center - at(*arc, t)).dot(inward) / velocity(*arc, t).squaredNorm();
  }
  if (std::abs(run.turn_before) > corner_turn || std::abs(run.turn_behind) > corner_turn) return 0;
  return (run.turn_before + run.turn_behind) / 2 / run.length;
}

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

Segments features(const Mesh& mesh) {
  Segments all;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (mesh.sides[e][0] == none || mesh.sides[e][1] == none || mesh.crack[e] != none || is_interface(mesh, e))
      all.push_back({mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]]});
  return all;
}

std::vector<BoundaryPlace> places_along(const Model& model, int count) {
  const Mesh& mesh = model.mesh;
  const std::vector<Run> runs = runs_of(model);
  const std::vector<Index> singular = singular_vertices(model);
  Segments held;
  std::vector<Vec2> corners;
  for (const Run& run : runs) {
    if (run.held) held.push_back({mesh.points[run.from], mesh.points[run.to]});
    if (std::abs(run.turn_before) > corner_turn && !std::ranges::binary_search(singular, run.from))
      corners.push_back(mesh.points[run.from]);
  }
  const Segments all = features(mesh);
  std::vector<BoundaryPlace> places(runs.size() * static_cast<std::size_t>(count));
  parallel_for(static_cast<Index>(runs.size()), model.threads, [&](Index first, Index last) {
    for (Index r = first; r < last; ++r) {
      const Run& run = runs[static_cast<std::size_t>(r)];
      const auto& [left, right] = mesh.sides[run.edge];
      for (int i = 0; i < count; ++i) {
        BoundaryPlace& p = places[static_cast<std::size_t>(r * count + i)];
        const double s = (2 * i + 1) / (2. * count);
        const Vec2 tangent = tangent_at(mesh, run, s);
        p.inward = Vec2(-tangent.y(), tangent.x());
        const Arc* arc = arc_of(mesh, run.edge);
        p.at =
            arc ? at(*arc, along(mesh, run, *arc, s)) : Vec2((1 - s) * mesh.points[run.from] + s * mesh.points[run.to]);
        p.curvature = curvature_at(mesh, run, s, p.inward);
        p.edge = run.edge;
        p.triangle = left != none ? left : right;
        p.length = run.length / count;
        for (const Vec2& x : corners) p.corner = std::min(p.corner, (x - p.at).norm());
        for (const Index v : singular) p.singular = std::min(p.singular, (mesh.points[v] - p.at).norm());
        for (const auto& [a, b] : held) p.support = std::min(p.support, distance(p.at, a, b));
        if (run.held) p.support = 0;
        for (const double angle : {pi / 6, pi / 3, pi / 2, 2 * pi / 3, 5 * pi / 6})
          p.across = std::min(
              p.across,
              ray(all, p.at, std::cos(angle) * tangent + std::sin(angle) * p.inward, run.length / 2) / std::sin(angle));
      }
    }
  });
  return places;
}

}  // namespace kerf::inspect
