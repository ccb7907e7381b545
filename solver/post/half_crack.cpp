// Faces of cracks in planes of symmetry, found on the boundary: from every vertex where an edge of a plane and an edge
// without supports lie on one straight line, the edges without supports up to the first turn. The half that is not
// there is the mirror image of this one: the jump is twice the normal displacement.

#include "geometry/boundary_walk.hpp"
#include "solver/half_cracks.hpp"
#include "solver/recovery.hpp"
#include "solver/system.hpp"

#include <algorithm>

namespace kerf {

namespace {

// A turn this small is rounding of coordinates.
constexpr double off_line = 1e-6;

/// The boundary as a walk from edge to edge.
struct Rim {
  const Mesh& mesh;
  const std::vector<BoundaryRun> runs;
  std::vector<Index> run_of;  // per edge
  explicit Rim(const Mesh& m) : mesh(m), runs(boundary_runs(m)), run_of(m.edges.size(), none) {
    for (std::size_t r = 0; r < runs.size(); ++r) run_of[runs[r].edge] = static_cast<Index>(r);
  }
  const BoundaryRun& run(Index e) const {
    return runs[static_cast<std::size_t>(run_of[e])];
  }
  Index start(Index e) const {
    return run(e).from;
  }
  Index end(Index e) const {
    return run(e).to;
  }
  /// The next edge, forwards or back, if it goes on straight.
  Index next(Index e, bool forwards) const {
    const Index r = forwards ? run(e).behind : run(e).before;
    if (r == none) return none;
    const Index f = runs[static_cast<std::size_t>(r)].edge;
    if (f == e || is_curved(e) || is_curved(f)) return none;
    const Vec2 a = mesh.points[end(e)] - mesh.points[start(e)], b = mesh.points[end(f)] - mesh.points[start(f)];
    return std::abs(cross(a, b)) <= off_line * a.dot(b) ? f : none;
  }
  bool is_curved(Index e) const {
    return !mesh.arc.empty() && mesh.arc[e] != none;
  }
};

}  // namespace

std::vector<HalfCrack> half_cracks(const Mesh& mesh, const Scene& scene, std::span<const Index> planes) {
  std::vector<HalfCrack> found;
  if (planes.empty()) return found;
  const Rim rim(mesh);
  const auto in_plane = [&](Index e) { return e != none && std::ranges::find(planes, mesh.label[e]) != planes.end(); };
  const auto is_free = [&](Index e) {
    return e != none && std::ranges::find(scene.supports, mesh.label[e], &Support::label) == scene.supports.end();
  };
  std::vector<bool> ends(mesh.points.size(), false), seen(mesh.edges.size(), false);  // of cracks and regions
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (mesh.crack[e] != none || is_interface(mesh, e))
      for (const Index v : mesh.edges[e]) ends[v] = true;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    if ((mesh.sides[e][0] != none && mesh.sides[e][1] != none) || !in_plane(e)) continue;
    for (const bool forwards : {true, false}) {
      Index f = rim.next(e, forwards);
      if (!is_free(f) || seen[f]) continue;
      HalfCrack crack;
      Index last = e;
      for (; is_free(f) && !seen[f]; f = rim.next(f, forwards)) {
        crack.edges.push_back(f);
        seen[f] = true;
        last = f;
      }
      if (!forwards) std::ranges::reverse(crack.edges);
      for (const bool start : {true, false}) {
        const auto end = static_cast<std::size_t>(start ? 0 : 1);
        const Index first = start ? crack.edges.front() : crack.edges.back();
        crack.label[end] = mesh.label[first];
        if (ends[start ? rim.start(first) : rim.end(first)]) continue;
        for (Index g = rim.next(first, !start); in_plane(g) && g != last; g = rim.next(g, !start)) {
          if (!crack.ahead[end].empty() && g == crack.ahead[end].front()) break;
          crack.ahead[end].push_back(g);
        }
        crack.tips[end] = !crack.ahead[end].empty();
      }
      if (crack.tips[0] || crack.tips[1]) found.push_back(std::move(crack));
    }
  }
  std::ranges::sort(found, {}, [](const HalfCrack& c) { return std::ranges::min(c.edges); });
  return found;
}

Vec2 tip_of(const Mesh& mesh, const HalfCrack& crack, bool start) {
  const Rim rim(mesh);
  return mesh.points[start ? rim.start(crack.edges.front()) : rim.end(crack.edges.back())];
}

std::vector<CrackPoint> half_profile(const Model& model, const Field& state, const HalfCrack& crack) {
  const Mesh& mesh = model.mesh;
  const Rim rim(mesh);
  const EdgeRule rule = gauss(2);
  std::vector<CrackPoint> profile;
  double done = 0;
  for (const Index e : crack.edges) {
    const Vec2 a = mesh.points[rim.start(e)], b = mesh.points[rim.end(e)], n = outward_normal(mesh, e);
    const Index inside = mesh.sides[e][mesh.sides[e][0] == none ? 1 : 0];
    const double l = (b - a).norm();
    for (Eigen::Index k = 0; k < rule.s.size(); ++k) {
      CrackPoint p{};
      p.at = a + rule.s[k] * (b - a);
      p.s = done + rule.s[k] * l;
      p.length = l * rule.w[k];
      p.jump_n = -2 * n.dot(recovered_displacement(model, state, inside, p.at).col(0));
      for (const Traction& t : model.scene.tractions)
        if (t.label == mesh.label[e]) p.sigma_n += n.dot(t.value(p.at, n));
      p.fluid_pressure = -p.sigma_n;
      profile.push_back(p);
    }
    done += l;
  }
  return profile;
}

}  // namespace kerf
