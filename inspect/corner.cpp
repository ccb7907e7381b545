// Generalised stress intensities of reentrant corners by the reciprocal theorem. The field of a wedge for -lambda does
// no work on any other eigenfunction of the wedge across an arc around its apex, so that with it as (s*, u*)
//   N = H(state)/H(mode),   H = int (s_rr u*_r + s_rt u*_t - s*_rr u_r - s*_rt u_t) r dtheta                [theory:
//   M.11]
// on an arc of any radius within the room of the corner: of half of it, where the mesh sees a smooth stress.

#include "inspect/corner.hpp"

#include "geometry/boundary_walk.hpp"
#include "geometry/plane.hpp"
#include "inspect/boundary.hpp"
#include "kerf/recover.hpp"
#include "solver/system.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace kerf::inspect {

namespace {

bool bears_nothing(const Model& model, const BoundaryRun& run) {
  const Index label = model.mesh.label[run.edge];
  const auto is_here = [label](const auto& of) { return of.label == label; };
  if (std::ranges::any_of(model.scene.supports, is_here)) return false;
  const Vec2 middle = (model.mesh.points[run.from] + model.mesh.points[run.to]) / 2;
  return std::ranges::all_of(model.scene.tractions, [&](const Traction& t) {
    return t.label != label || t.value(middle, outward_normal(model.mesh, run.edge)).isZero(0);
  });
}

/// The edges of a straight side without loads, from a run on, and how long they are.
struct StraightSide {
  std::vector<Index> edges = {};
  double length = 0;
};
StraightSide straight_side(const Model& model, const std::vector<BoundaryRun>& runs, Index first, bool forwards) {
  constexpr double straight = 1e-6;
  StraightSide side;
  for (Index r = first; r != none;) {
    const BoundaryRun& run = runs[static_cast<std::size_t>(r)];
    const bool curved = !model.mesh.arc.empty() && model.mesh.arc[run.edge] != none;
    if (curved || !bears_nothing(model, run)) break;
    side.edges.push_back(run.edge);
    side.length += run.length;
    if (std::abs(forwards ? run.turn_behind : run.turn_before) > straight) break;
    r = forwards ? run.behind : run.before;
    if (r == first) break;
  }
  return side;
}

/// Up to where nothing but the two sides is there.
double room_of(const Model& model, const Vec2& at, const StraightSide& one, const StraightSide& other) {
  const Mesh& mesh = model.mesh;
  double room = std::min(one.length, other.length);
  const auto own = [&](Index e) {
    return std::ranges::find(one.edges, e) != one.edges.end() || std::ranges::find(other.edges, e) != other.edges.end();
  };
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (is_feature(mesh, e) && !own(e))
      room = std::min(room, distance(at, mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]]));
  return room;
}

/// H of the state with the dual field of a mode, over H of the mode itself.
std::array<double, 2> intensities(const RecoveredState& s, const ReentrantCorner& corner) {
  const double alpha = corner.wedge.half_angle, r = corner.room / 2;
  const Material& material = material_of(s.model.mesh, s.model.scene, corner.triangle);
  const Mat2 frame{{corner.bisector.x(), -corner.bisector.y()}, {corner.bisector.y(), corner.bisector.x()}};
  constexpr int panels = 24;
  const EdgeRule rule = gauss(4);
  std::array<double, 2> of_state{}, of_mode{};
  for (int panel = 0; panel < panels; ++panel)
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const double theta = alpha * (2 * (panel + rule.s[q]) / panels - 1), weight = rule.w[q];
      const Vec2 out = frame * Vec2(std::cos(theta), std::sin(theta)), around(-out.y(), out.x());
      const Vec2 x = corner.at + r * out;
      Index t = locate(s.model.mesh, s.locator, x);
      if (t == none) t = nearest_triangle(s.model.mesh, s.locator, x);
      const Eigen::Vector3d v = s.at({t, x});
      const Vec2 traction(v[0] * out.x() + v[2] * out.y(), v[2] * out.x() + v[1] * out.y());
      const Vec2 u = recovered_displacement(s.model, s.state, t, x).col(0);
      for (int mode = 0; mode < 2; ++mode) {
        const auto m = static_cast<std::size_t>(mode);
        const PolarField dual = wedge_field(mode, corner.wedge, true, material, r, theta),
                         own = wedge_field(mode, corner.wedge, false, material, r, theta);
        of_state[m] += weight * (traction.dot(out) * dual.u_r + traction.dot(around) * dual.u_t - dual.rr * u.dot(out) -
                                 dual.rt * u.dot(around));
        of_mode[m] += weight * (own.rr * dual.u_r + own.rt * dual.u_t - dual.rr * own.u_r - dual.rt * own.u_t);
      }
    }
  return {of_state[0] / of_mode[0], of_state[1] / of_mode[1]};
}

}  // namespace

std::vector<ReentrantCorner> reentrant_corners(const RecoveredState& s) {
  std::vector<ReentrantCorner> corners;
  const Model& model = s.model;
  if (model.scene.body || has_eigenstrain(model.scene)) return corners;
  const std::vector<BoundaryRun> runs = boundary_runs(model.mesh);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const BoundaryRun& run = runs[r];
    if (run.before == none || !(run.turn_before < -corner_turn)) continue;
    const StraightSide behind = straight_side(model, runs, static_cast<Index>(r), true),
                       before = straight_side(model, runs, run.before, false);
    ReentrantCorner corner{.at = model.mesh.points[run.from], .edge = run.edge, .triangle = run.triangle};
    if (!(behind.length > 0 && before.length > 0)) continue;
    corner.room = room_of(model, corner.at, behind, before);
    if (!(corner.room > run.length / 2)) continue;
    const double half = (pi - run.turn_before) / 2;
    corner.bisector = Eigen::Rotation2D<double>(half) * run.begin;
    corner.wedge = wedge(half);
    corner.intensity = intensities(s, corner);
    corners.push_back(corner);
  }
  return corners;
}

}  // namespace kerf::inspect
