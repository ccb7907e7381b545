// Signs turned, so that what the zero line bounds keeps apart and together.

#include "geometry/carve/contour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace kerf {

namespace {

std::string text(const Vec2& x) {
  return fmt::format("({:.4g}, {:.4g})", x.x(), x.y());
}

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
  int runs = 0;                                                // of neighbors with the other sign
  double thickness = std::numeric_limits<double>::infinity();  // between the two nearest runs
  double nearest = std::numeric_limits<double>::infinity();
  double farthest = 0;
  bool alone = false;                // no neighbor has the same sign
  double at_first = 0, at_last = 0;  // on the boundary: to the crossings along it; 0: none there
};
Around look(const Mesh& mesh, const Signs& signs, const Ring& ring, Index v) {
  constexpr double far = std::numeric_limits<double>::infinity();
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
    const double d = other ? reach(mesh, signs, ring.edge[i], v) : far;
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
    if (!parts[(first + i - 1) % parts.size()].other) runs.push_back(far);
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

}  // namespace

void clean(const Shape& frame, const Mesh& mesh, const Rim& rim, const Carving& how, Signs& signs,
           std::vector<std::string>& notes) {
  const double near = how.tolerance, narrow = how.least_width;
  const Stars star = stars(mesh);
  std::vector<bool> solid(mesh.points.size(), false), turned = solid, in_region = solid;
  for (std::size_t t = 0; t < mesh.region.size(); ++t)
    if (mesh.region[t] != none)
      for (const Index v : mesh.triangles[t]) {
        solid[std::size_t(v)] = in_region[std::size_t(v)] = true;
        if (!signs.inside[std::size_t(v)])
          throw Error(Fault::Geometry,
                      fmt::format("the zero line reaches region '{}' at {}; keep it solid, or draw it "
                                  "as what may be carved",
                                  frame.regions[std::size_t(mesh.region[t])].name, text(mesh.points[std::size_t(v)])));
      }
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] != none && std::ranges::find(how.keep, mesh.label[e]) != how.keep.end())
      for (const Index v : mesh.edges[e]) solid[std::size_t(v)] = true;
  std::vector<Index> crack_of(mesh.points.size(), none);
  std::vector<bool> tip(mesh.points.size(), false);
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c) {
    std::map<Index, int> degree;
    for (const CrackEdge& edge : mesh.cracks[c])
      for (const Index v : mesh.edges[std::size_t(edge.edge)]) {
        crack_of[std::size_t(v)] = Index(c);
        ++degree[v];
      }
    for (const auto& [v, d] : degree) tip[std::size_t(v)] = tip[std::size_t(v)] || d == 1;
  }

  Count opened, closed;
  std::vector<Count> swallowed(frame.cracks.size());
  for (int pass = 0; pass < 6; ++pass) {
    std::vector<Index> candidates;  // everything below asks for a crossing that is near
    for (std::size_t e = 0; e < mesh.edges.size(); ++e)
      if (crossed(mesh, signs, Index(e)))
        for (const Index v : mesh.edges[e])
          if (reach(mesh, signs, Index(e), v) < narrow) candidates.push_back(v);
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    bool changed = false;
    const auto turn = [&](Index v) {
      signs.inside[std::size_t(v)] = !signs.inside[std::size_t(v)];
      signs.magnitude[std::size_t(v)] = -1;
      turned[std::size_t(v)] = changed = true;
    };
    for (const Index v : candidates) {
      const std::size_t i = std::size_t(v);
      if (turned[i] || (solid[i] && signs.inside[i])) continue;
      const Around around = look(mesh, signs, ring(mesh, star, v), v);
      if (around.runs == 0) continue;  // its neighbors have turned
      const Vec2& x = mesh.points[i];
      const bool inside = signs.inside[i];
      if (inside && crack_of[i] != none && around.nearest < near && (around.runs == 1 || around.thickness < narrow)) {
        swallowed[std::size_t(crack_of[i])].add(x);
        turn(v);
      } else if (around.runs > 1 && around.thickness < narrow && (inside || crack_of[i] == none)) {
        (inside ? opened : closed).add(x);
        turn(v);
      } else if (around.alone && around.farthest < narrow && (inside || crack_of[i] == none)) {
        turn(v);
      } else if (around.at_first > 0 && around.at_last > 0 && around.at_first + around.at_last < narrow) {
        (inside ? opened : closed).add(x);  // contact with the frame's boundary, or a mouth in it
        turn(v);
      } else if (inside && rim.corner[i] && std::max(around.at_first, around.at_last) > 0 &&
                 std::max(around.at_first, around.at_last) < near) {
        turn(v);  // no side shorter than this
      }
    }
    if (!changed) break;
  }
  // What stays keeps clear: cracks more than the rest, and sides of arcs by more than the arc lies off its chords.
  std::fill(signs.clear.begin(), signs.clear.end(), near / 4);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (signs.inside[v] && (crack_of[v] != none || in_region[v]))
      signs.clear[v] = tip[v] || in_region[v] ? near : near / 2;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (rim.strand[e] == none) continue;
    const Strand& strand = rim.drawing.strands[std::size_t(rim.strand[e])];
    if (!strand.arc) continue;
    const auto& [a, b] = mesh.edges[e];
    const Vec2 middle = (mesh.points[std::size_t(a)] + mesh.points[std::size_t(b)]) / 2;
    const double off = (onto(*strand.arc, middle) - middle).norm();
    for (const Index v : mesh.edges[e]) signs.clear[std::size_t(v)] = std::max(signs.clear[std::size_t(v)], 2 * off);
  }
  if (opened.times > 0)
    notes.push_back(fmt::format("opened necks of material thinner than {:.3g} {}", narrow, opened.where()));
  if (closed.times > 0) notes.push_back(fmt::format("closed gaps narrower than {:.3g} {}", narrow, closed.where()));
  for (std::size_t c = 0; c < frame.cracks.size(); ++c)
    if (swallowed[c].times > 2)
      notes.push_back(fmt::format("the zero line runs along crack '{}' {}: that part lies in the void",
                                  frame.cracks[c].name, swallowed[c].where()));
}

}  // namespace kerf
