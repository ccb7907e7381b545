// Signs turned, so that what the zero line bounds keeps apart and together.
// A vertex turns its sign, at most once, where around it the other sign comes in two runs nearer together than the
// least width (a neck is opened, a gap closed), where it stands alone, where a crack would lie in a sliver of material,
// or where a corner of the frame would get a side shorter than the tolerance. Vertices of regions and on labels to keep
// never turn into void. Six sweeps at most. Afterwards every vertex gets a distance that crossings keep from it, so
// that no triangle of the later mesh is squeezed between the zero line and something that stays.

#include "geometry/carve/signs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace kerf {

namespace {

/// Triangles around each vertex.
struct Stars {
  std::vector<Index> start, triangle;
};
Stars stars(const Mesh& mesh) {
  Stars s;
  s.start.assign(mesh.points.size() + 1, 0);
  for (const auto& t : mesh.triangles)
    for (const Index v : t) ++s.start[std::size_t(v) + 1];
  std::partial_sum(s.start.begin(), s.start.end(), s.start.begin());
  s.triangle.resize(3 * mesh.triangles.size());
  std::vector<Index> fill(s.start.begin(), s.start.end() - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const Index v : mesh.triangles[t]) s.triangle[std::size_t(fill[std::size_t(v)]++)] = Index(t);
  return s;
}

/// The edges at a vertex, counter-clockwise; on the boundary of the mesh from its first to its last.
struct Ring {
  std::vector<Index> edge, other;
  bool open = false;
};
/// On the boundary the first edge is the one that no triangle's turn ends at.
Ring ring(const Mesh& mesh, const Stars& stars, Index v) {
  struct Step {
    Index from, to, edge_from, edge_to;
  };
  std::vector<Step> steps;
  for (Index k = stars.start[std::size_t(v)]; k < stars.start[std::size_t(v) + 1]; ++k) {
    const Index t = stars.triangle[std::size_t(k)];
    const auto& corner = mesh.triangles[std::size_t(t)];
    const auto& edge = mesh.edges_of[std::size_t(t)];
    const std::size_t i = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
    // Edge i + 2 joins corners i and i + 1, edge i + 1 corners i + 2 and i.
    steps.push_back({corner[(i + 1) % 3], corner[(i + 2) % 3], edge[(i + 2) % 3], edge[(i + 1) % 3]});
  }
  Ring ring;
  std::size_t at = 0;
  for (std::size_t s = 0; s < steps.size(); ++s)
    if (std::none_of(steps.begin(), steps.end(), [&](const Step& o) { return o.to == steps[s].from; })) {
      at = s;
      ring.open = true;
    }
  ring.edge.push_back(steps[at].edge_from);
  ring.other.push_back(steps[at].from);
  for (std::size_t count = 1; count < steps.size() + (ring.open ? 1 : 0); ++count) {
    ring.edge.push_back(steps[at].edge_to);
    ring.other.push_back(steps[at].to);
    const Index to = steps[at].to;
    for (std::size_t s = 0; s < steps.size(); ++s)
      if (steps[s].from == to) at = s;
  }
  return ring;
}

/// How far along the edge from v its crossing lies.
double reach(const Mesh& mesh, const Signs& signs, Index edge, Index v) {
  const double t = exact_crossing(mesh, signs, edge);
  return length(mesh, edge) * (mesh.edges[std::size_t(edge)][0] == v ? t : 1 - t);
}

/// What the other sign does around a vertex.
struct Around {
  int runs = 0;                 // of neighbors with the other sign
  double thickness = infinity;  // between the two nearest runs
  double nearest = infinity;
  double farthest = 0;
  bool alone = false;                // no neighbor has the same sign
  double at_first = 0, at_last = 0;  // on the boundary: to the crossings along it; 0: none there
};
/// Runs of neighbours with the other sign, each with its nearest crossing; on the boundary the outside of the frame
/// counts as void, at distance 0.
Around look(const Mesh& mesh, const Signs& signs, const Ring& ring, Index v) {
  const bool here = signs.inside[std::size_t(v)];
  struct Part {
    bool other;
    double distance;
  };
  std::vector<Part> parts;
  Around around;
  around.alone = true;
  for (std::size_t i = 0; i < ring.edge.size(); ++i) {
    const bool other = bool(signs.inside[std::size_t(ring.other[i])]) != here;
    const double d = other ? reach(mesh, signs, ring.edge[i], v) : infinity;
    parts.push_back({other, d});
    if (!other) {
      around.alone = false;
      continue;
    }
    around.nearest = std::min(around.nearest, d);
    around.farthest = std::max(around.farthest, d);
    if (ring.open && i == 0) around.at_first = d;
    if (ring.open && i + 1 == ring.edge.size()) around.at_last = d;
  }
  if (ring.open) parts.push_back({here, 0.0});  // beyond the frame there is no material
  std::size_t first = 0;
  while (first < parts.size() && parts[first].other) ++first;
  if (first == parts.size()) {
    around.runs = 1;
    return around;
  }
  std::vector<double> runs;
  for (std::size_t i = 1; i <= parts.size(); ++i) {
    const Part& part = parts[(first + i) % parts.size()];
    if (!part.other) continue;
    if (!parts[(first + i - 1) % parts.size()].other) runs.push_back(infinity);
    runs.back() = std::min(runs.back(), part.distance);
  }
  around.runs = int(runs.size());
  std::sort(runs.begin(), runs.end());
  if (runs.size() > 1) around.thickness = runs[0] + runs[1];
  return around;
}

/// What happened, once in words however often it did.
struct Count {
  int times = 0;
  Vec2 first = Vec2::Zero();
  void add(const Vec2& x) {
    if (times++ == 0) first = x;
  }
  std::string where() const {
    return times == 1 ? "at " + text(first) : fmt::format("in {} places, the first at {}", times, text(first));
  }
};

/// Vertices where signs do not turn as elsewhere.
struct Special {
  std::vector<bool> solid;      // of regions and on labels to keep
  std::vector<bool> in_region;  // these too are solid
  std::vector<Index> crack_of;  // or none
  std::vector<bool> tip;
};

void mark_regions(const Block& block, const Signs& signs, Special& special) {
  const Mesh& mesh = block.mesh;
  for (std::size_t t = 0; t < mesh.region.size(); ++t)
    if (mesh.region[t] != none)
      for (const Index v : mesh.triangles[t]) {
        special.solid[std::size_t(v)] = special.in_region[std::size_t(v)] = true;
        if (!signs.inside[std::size_t(v)])
          throw Error(Fault::Geometry, fmt::format("the zero line reaches region '{}' at {}; keep it solid, or draw it "
                                                   "as what may be carved",
                                                   block.frame.regions[std::size_t(mesh.region[t])].name,
                                                   text(mesh.points[std::size_t(v)])));
      }
}

void mark_cracks(const Mesh& mesh, Special& special) {
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c) {
    std::map<Index, int> degree;
    for (const CrackEdge& edge : mesh.cracks[c])
      for (const Index v : mesh.edges[std::size_t(edge.edge)]) {
        special.crack_of[std::size_t(v)] = Index(c);
        ++degree[v];
      }
    for (const auto& [v, d] : degree) special.tip[std::size_t(v)] = special.tip[std::size_t(v)] || d == 1;
  }
}

Special special_vertices(const Block& block, const Signs& signs) {
  const std::size_t n = block.mesh.points.size();
  Special special{std::vector<bool>(n, false), std::vector<bool>(n, false), std::vector<Index>(n, none),
                  std::vector<bool>(n, false)};
  mark_regions(block, signs, special);
  for (std::size_t e = 0; e < block.mesh.edges.size(); ++e)
    if (block.mesh.label[e] != none && has(block.how.keep, block.mesh.label[e]))
      for (const Index v : block.mesh.edges[e]) special.solid[std::size_t(v)] = true;
  mark_cracks(block.mesh, special);
  return special;
}

/// Turns signs one by one, each at most once, and counts why.
struct Turner {
  const Block& block;
  const Special& special;
  Signs& signs;
  const Stars star = stars(block.mesh);
  std::vector<bool> turned = std::vector<bool>(block.mesh.points.size(), false);
  Count opened = {}, closed = {};
  std::vector<Count> swallowed = std::vector<Count>(block.frame.cracks.size());

  /// Vertices with a crossing near by, which every reason to turn asks for.
  std::vector<Index> candidates() const {
    std::vector<Index> found;
    for (std::size_t e = 0; e < block.mesh.edges.size(); ++e)
      if (crossed(block.mesh, signs, Index(e)))
        for (const Index v : block.mesh.edges[e])
          if (reach(block.mesh, signs, Index(e), v) < block.how.least_width) found.push_back(v);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// The first reason that holds counts; `solid` vertices inside never turn.
  bool wants_to_turn(Index v) {
    const std::size_t i = std::size_t(v);
    const double near = block.how.tolerance, narrow = block.how.least_width;
    if (turned[i] || (special.solid[i] && signs.inside[i])) return false;
    const Around around = look(block.mesh, signs, ring(block.mesh, star, v), v);
    if (around.runs == 0) return false;  // its neighbors have turned
    const Vec2& x = block.mesh.points[i];
    const bool inside = signs.inside[i], on_crack = special.crack_of[i] != none;
    if (inside && on_crack && around.nearest < near && (around.runs == 1 || around.thickness < narrow)) {
      swallowed[std::size_t(special.crack_of[i])].add(x);
      return true;
    }
    if (around.runs > 1 && around.thickness < narrow && (inside || !on_crack)) {
      (inside ? opened : closed).add(x);
      return true;
    }
    if (around.alone && around.farthest < narrow && (inside || !on_crack)) return true;
    if (around.at_first > 0 && around.at_last > 0 && around.at_first + around.at_last < narrow) {
      (inside ? opened : closed).add(x);  // it touches the frame's boundary, or is a mouth in it
      return true;
    }
    const double along = std::max(around.at_first, around.at_last);
    return inside && block.rim.corner[i] && along > 0 && along < near;  // no side shorter than this
  }

  bool sweep() {
    bool changed = false;
    for (const Index v : candidates()) {
      if (!wants_to_turn(v)) continue;
      signs.inside[std::size_t(v)] = !signs.inside[std::size_t(v)];
      signs.magnitude[std::size_t(v)] = -1;
      turned[std::size_t(v)] = changed = true;
    }
    return changed;
  }

  void tell(std::vector<std::string>& notes) const {
    const double narrow = block.how.least_width;
    if (opened.times > 0)
      notes.push_back(fmt::format("opened necks of material thinner than {:.3g} {}", narrow, opened.where()));
    if (closed.times > 0) notes.push_back(fmt::format("closed gaps narrower than {:.3g} {}", narrow, closed.where()));
    for (std::size_t c = 0; c < swallowed.size(); ++c)
      if (swallowed[c].times > 2)
        notes.push_back(fmt::format("the zero line runs along crack '{}' {}: that part lies in the void",
                                    block.frame.cracks[c].name, swallowed[c].where()));
  }
};

/// What stays keeps clear: cracks more than the rest, and sides of arcs by more than the arc lies off its chords.
void keep_clear(const Block& block, const Special& special, Signs& signs) {
  const Mesh& mesh = block.mesh;
  const double near = block.how.tolerance;
  std::fill(signs.clear.begin(), signs.clear.end(), near / 4);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (signs.inside[v] && (special.crack_of[v] != none || special.in_region[v]))
      signs.clear[v] = special.tip[v] || special.in_region[v] ? near : near / 2;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (block.rim.strand[e] == none) continue;
    const Strand& strand = block.rim.drawing.strands[std::size_t(block.rim.strand[e])];
    if (!strand.arc) continue;
    const auto& [a, b] = mesh.edges[e];
    const Vec2 middle = (mesh.points[std::size_t(a)] + mesh.points[std::size_t(b)]) / 2;
    const double off = (onto(*strand.arc, middle) - middle).norm();
    for (const Index v : mesh.edges[e]) signs.clear[std::size_t(v)] = std::max(signs.clear[std::size_t(v)], 2 * off);
  }
}

}  // namespace

void clean(const Block& block, Signs& signs, std::vector<std::string>& notes) {
  constexpr int sweeps = 6;
  const Special special = special_vertices(block, signs);
  Turner turner{block, special, signs};
  for (int sweep = 0; sweep < sweeps; ++sweep)
    if (!turner.sweep()) break;
  keep_clear(block, special, signs);
  turner.tell(notes);
}

}  // namespace kerf
