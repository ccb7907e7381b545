// Distances from points to features: sides, cracks that may move, other materials, jumps of the data, rings of
// functionals. A change of radius eps needs clear_radii eps of room, as the remainder relative to T is about C
// (eps/distance)^2 (docs/theory/topological_derivatives.md, section "How good the expansion is"). Segments are listed
// in the square cells that they come nearer to than `reach`, so that a point looks into one cell. Of a part of a body
// the features are those of the whole mesh, and cells cover the part.

#include "topo/map/mask.hpp"
#include "kerf/state.hpp"
#include "topo/map/jumps.hpp"
#include "topo/near.hpp"

#include "base/parallel.hpp"
#include "geometry/plane.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

struct Segment {
  Vec2 a, b;
  Near kind;
  double depth = 0;  // of edge cracks that may begin there
};

/// Distance to the nearest feature less `clear`, and which one it is.
struct Looked {
  std::vector<double> margin;
  std::vector<Near> to;
};

double longest_edge_crack(const Functional& j, Index label) {
  double longest = 0;
  for (const Term& term : j.terms)
    if (term.edge_cracks && std::ranges::find(term.edge_cracks->labels, label) != term.edge_cracks->labels.end())
      longest = std::max(longest, term.edge_cracks->length);
  return longest;
}

// Jumps of the data count as another material.
std::vector<Segment> features(const Model& m, const Functional& j) {
  const Mesh& mesh = whole_mesh(m);
  std::vector<Segment> all;
  for (const auto& [a, b] : jumps_of_data(m, j)) all.push_back({a, b, Near::Material});
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& [left, right] = mesh.sides[e];
    const bool interface =
        left != none && right != none && !mesh.region.empty() && mesh.region[left] != mesh.region[right];
    const bool crack = mesh.crack[e] != none && m.scene.laws[mesh.crack[e]].kind != CrackLaw::Kind::Bonded;
    const bool boundary = left == none || right == none;
    if (boundary || crack || interface)
      all.push_back({mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]],
                     boundary ? Near::Boundary
                     : crack  ? Near::Crack
                              : Near::Material,
                     boundary ? longest_edge_crack(j, mesh.label[e]) : 0});
  }
  return all;
}

double to_rings(const Functional& j, const Vec2& x) {
  double least = infinity;
  for (const Term& term : j.terms)
    if (term.feature_radius > 0) least = std::min(least, (x - term.feature).norm() - term.feature_radius);
  return least;
}

// Segments in square cells of side `reach` (few enough of them): a point looks into its own, where every segment that
// comes near enough is listed.
Looked look(const Model& m, const Functional& j, std::span<const Vec2> points, const MaskReach& c) {
  const auto& [clear, radius, reach] = c;
  Looked out{std::vector<double>(points.size(), -clear), std::vector<Near>(points.size(), Near::Nothing)};
  if (m.mesh.points.empty()) return out;  // outside the box
  Vec2 low = m.mesh.points[0], high = low;
  for (const Vec2& p : m.mesh.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const double width = (high - low).maxCoeff();
  // About as many cells as points, and never smaller than the reach: a segment is listed in few cells.
  const double finest = std::clamp(std::sqrt(static_cast<double>(points.size())), 1.0, 512.0);
  const double cell = std::max(reach, width / finest);
  const auto column = [&](double x, int d) { return static_cast<Index>(std::floor((x - low[d]) / cell)); };
  const Index across = column(high.x(), 0) + 1, up = column(high.y(), 1) + 1;
  std::vector<std::vector<Segment>> cells(static_cast<std::size_t>(across) * static_cast<std::size_t>(up));
  for (const Segment& s : features(m, j)) {
    const double around = reach + s.depth;
    const Vec2 from = s.a.cwiseMin(s.b).array() - around, to = s.a.cwiseMax(s.b).array() + around;
    for (Index i = std::max(column(from.x(), 0), 0); i <= std::min(column(to.x(), 0), across - 1); ++i)
      for (Index k = std::max(column(from.y(), 1), 0); k <= std::min(column(to.y(), 1), up - 1); ++k)
        cells[static_cast<std::size_t>(k) * across + i].push_back(s);
  }
  // Points outside the box keep a margin of -clear.
  parallel_for(static_cast<Index>(points.size()), m.threads, [&](Index begin, Index end) {
    for (auto p = static_cast<std::size_t>(begin); p < static_cast<std::size_t>(end); ++p) {
      const Vec2& x = points[p];
      if (!x.allFinite() || (x - low).minCoeff() < 0 || (high - x).minCoeff() < 0) continue;
      const double to_ring = to_rings(j, x) - radius + clear;
      double least = std::min(reach, to_ring);
      Near what = to_ring < reach ? Near::Ring : Near::Nothing;
      for (const Segment& s : cells[static_cast<std::size_t>(column(x.y(), 1)) * across + column(x.x(), 0)])
        if (const double here = distance(x, s.a, s.b) - s.depth; here < least) {
          least = here;
          what = s.kind;
        }
      out.margin[p] = least - clear;
      out.to[p] = what;
    }
  });
  return out;
}

}  // namespace

std::vector<double> margins(const Model& m, const Functional& j, std::span<const Vec2> points, const MaskReach& c) {
  return look(m, j, points, c).margin;
}

std::vector<Near> nearest(const Model& m, const Functional& j, std::span<const Vec2> points, double reach,
                          double radius) {
  return look(m, j, points, {reach, radius, reach}).to;
}

std::vector<bool> too_close(const Model& m, const Functional& j, std::span<const Vec2> points, double clear,
                            double radius) {
  const std::vector<double> margin = margins(m, j, points, {clear, radius, clear});
  std::vector<bool> close(points.size());
  for (std::size_t i = 0; i < close.size(); ++i) close[i] = margin[i] < 0;
  return close;
}

}  // namespace kerf
