// Walks along the boundary. Tangents and curvatures are those of arcs where edges follow them. A chord of a curve of
// curvature k turns at its ends by k times half the lengths that meet there, so that the sum of both turns over
// (before + 2 own + behind)/2 is k.

#include "geometry/boundary_walk.hpp"

#include "geometry/plane.hpp"

#include <cmath>

namespace kerf {

namespace {

const Arc* arc_of_run(const Mesh& mesh, const BoundaryRun& run) {
  return mesh.arc.empty() || mesh.arc[run.edge] == none ? nullptr : &mesh.arcs[mesh.arc[run.edge]];
}

/// Parameter of an arc at the share s of a run.
double parameter_at(const Mesh& mesh, const BoundaryRun& run, const Arc& arc, double s) {
  const double share = mesh.edges[run.edge][0] == run.from ? s : 1 - s;
  return arc.from + share * (arc.to - arc.from);
}

Vec2 tangent_at(const Mesh& mesh, const BoundaryRun& run, double s) {
  const Vec2 chord = mesh.points[run.to] - mesh.points[run.from];
  const Arc* arc = arc_of_run(mesh, run);
  if (!arc) return chord.normalized();
  const Vec2 v = velocity(*arc, parameter_at(mesh, run, *arc, s)).normalized();
  return v.dot(chord) < 0 ? Vec2(-v) : v;
}

/// Per vertex the run that ends there, and the one that begins; none where there are several.
void join(std::vector<BoundaryRun>& runs, std::size_t vertices) {
  std::vector<Index> into(vertices, none), from(vertices, none), count(vertices, 0);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    into[runs[r].to] = from[runs[r].from] = static_cast<Index>(r);
    ++count[runs[r].from];
  }
  for (BoundaryRun& run : runs) {
    if (count[run.from] == 1) run.before = into[run.from];
    if (count[run.to] == 1) run.behind = from[run.to];
  }
}

}  // namespace

std::vector<BoundaryRun> boundary_runs(const Mesh& mesh) {
  std::vector<BoundaryRun> runs;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    const auto& [left, right] = mesh.sides[e];
    if ((left != none) == (right != none)) continue;
    const auto& [a, b] = mesh.edges[e];
    BoundaryRun run{.edge = e,
                    .from = left != none ? a : b,
                    .to = left != none ? b : a,
                    .triangle = left != none ? left : right,
                    .length = length(mesh, e)};
    run.begin = tangent_at(mesh, run, 0);
    run.end = tangent_at(mesh, run, 1);
    runs.push_back(run);
  }
  join(runs, mesh.points.size());
  for (BoundaryRun& run : runs)
    if (run.before != none) {
      BoundaryRun& last = runs[static_cast<std::size_t>(run.before)];
      run.turn_before = last.turn_behind = std::atan2(cross(last.end, run.begin), last.end.dot(run.begin));
    }
  return runs;
}

bool is_bent(const BoundaryRun& run) {
  return run.before != none && run.behind != none && std::abs(run.turn_before) <= corner_turn &&
         std::abs(run.turn_behind) <= corner_turn;
}

// x'' . inward/|x'|^2 on an arc.
RunPoint point_on(const Mesh& mesh, const std::vector<BoundaryRun>& runs, const BoundaryRun& run, double s) {
  RunPoint p;
  p.tangent = tangent_at(mesh, run, s);
  p.inward = {-p.tangent.y(), p.tangent.x()};
  if (const Arc* arc = arc_of_run(mesh, run)) {
    const double t = parameter_at(mesh, run, *arc, s);
    p.x = at(*arc, t);
    p.speed = velocity(*arc, t).norm() * std::abs(arc->to - arc->from);
    p.curvature = (arc->center - p.x).dot(p.inward) / velocity(*arc, t).squaredNorm();
    return p;
  }
  p.x = (1 - s) * mesh.points[run.from] + s * mesh.points[run.to];
  p.speed = run.length;
  if (is_bent(run)) {
    const double before = runs[static_cast<std::size_t>(run.before)].length,
                 behind = runs[static_cast<std::size_t>(run.behind)].length;
    p.curvature = 2 * (run.turn_before + run.turn_behind) / (before + 2 * run.length + behind);
  }
  return p;
}

}  // namespace kerf
