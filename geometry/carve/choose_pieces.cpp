// Which pieces of the negative set are the body, and which of its holes stay.
// Connectedness is that of vertices inside by edges (union-find). The body is the piece that is held, bears most loads,
// has most labels, and is the largest, in this order. A piece that bears a load and is not connected with it is an
// error; one with a support alone or with nothing is dropped with a note. Holes smaller than `least_area` that do not
// touch the frame's boundary are filled. What hangs on the body by cracks alone and bears no label is dropped, which
// may disconnect more: hence the loop.

#include "geometry/carve/signs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace kerf {

namespace {

/// Sets that are joined pair by pair.
struct Sets {
  std::vector<Index> parent;
  explicit Sets(std::size_t n) : parent(n) {
    std::iota(parent.begin(), parent.end(), 0);
  }
  Index of(Index i) {
    while (parent[std::size_t(i)] != i) i = parent[std::size_t(i)] = parent[std::size_t(parent[std::size_t(i)])];
    return i;
  }
  void join(Index i, Index j) {
    i = of(i), j = of(j);
    if (i != j) parent[std::size_t(std::max(i, j))] = std::min(i, j);
  }
};

std::string names(const Shape& frame, const std::vector<Index>& labels) {
  std::string list;
  for (const Index l : labels) list += fmt::format("{}'{}'", list.empty() ? "" : ", ", frame.labels[std::size_t(l)]);
  return list;
}

/// A hole is a connected set of vertices outside; the area is that of the parts of triangles outside, each counted
/// once.
void fill_holes(const Block& block, Signs& signs, std::vector<std::string>& notes) {
  const auto& [frame, mesh, rim, how] = block;
  if (!(how.least_area > 0)) return;
  Sets sets(mesh.points.size());
  std::vector<bool> fixed(mesh.points.size(), false);  // on the frame's boundary
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& [a, b] = mesh.edges[e];
    if (!signs.inside[std::size_t(a)] && !signs.inside[std::size_t(b)]) sets.join(a, b);
    if (mesh.sides[e][0] == none || mesh.sides[e][1] == none) fixed[std::size_t(a)] = fixed[std::size_t(b)] = true;
  }
  std::vector<double> area(mesh.points.size(), 0);
  std::vector<bool> open(mesh.points.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const Index v : mesh.triangles[t])
      if (!signs.inside[std::size_t(v)]) {
        area[std::size_t(sets.of(v))] += kerf::area(mesh, Index(t)) - inside_area(mesh, signs, Index(t));
        break;
      }
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (!signs.inside[v] && fixed[v]) open[std::size_t(sets.of(Index(v)))] = true;
  std::vector<Index> filled;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const Index r = sets.of(Index(v));
    if (signs.inside[v] || open[std::size_t(r)] || area[std::size_t(r)] >= how.least_area) continue;
    if (r == Index(v))
      notes.push_back(fmt::format("filled a hole of area {:.3g} at {}, smaller than {:.3g}", area[v],
                                  text(mesh.points[v]), how.least_area));
    filled.push_back(Index(v));
  }
  for (const Index v : filled) signs.inside[std::size_t(v)] = 1;
}

/// Material that is connected when cracks do not connect, per triangle; none where there is no material.
std::vector<Index> apart_at_cracks(const Mesh& mesh, const Signs& signs) {
  Sets sets(mesh.triangles.size());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& [left, right] = mesh.sides[e];
    if (left == none || right == none || mesh.crack[e] != none) continue;
    const auto& [a, b] = mesh.edges[e];
    if (signs.inside[std::size_t(a)] || signs.inside[std::size_t(b)]) sets.join(left, right);
  }
  std::vector<Index> piece(mesh.triangles.size(), none);
  for (std::size_t t = 0; t < piece.size(); ++t)
    for (const Index v : mesh.triangles[t])
      if (signs.inside[std::size_t(v)]) piece[t] = sets.of(Index(t));
  return piece;
}

/// Drops what only cracks connect with the rest and bears no label. Whether there was any.
bool drop_behind_cracks(const Block& block, Signs& signs, std::vector<std::string>& notes) {
  const auto& [frame, mesh, rim, how] = block;
  if (how.keep.empty() || mesh.cracks.empty()) return false;
  const std::vector<Index> piece = apart_at_cracks(mesh, signs);
  std::vector<bool> wanted(mesh.triangles.size(), false), behind(mesh.triangles.size(), false);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (!has(how.keep, mesh.label[e]) && !has(how.holding, mesh.label[e])) continue;
    const Index t = mesh.sides[e][0] == none ? mesh.sides[e][1] : mesh.sides[e][0];
    const auto& [a, b] = mesh.edges[e];
    if (signs.inside[std::size_t(a)] || signs.inside[std::size_t(b)]) wanted[std::size_t(piece[std::size_t(t)])] = true;
  }
  std::set<Index> dropped;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.crack[e] == none) continue;
    for (const Index t : mesh.sides[e]) {
      if (t == none || piece[std::size_t(t)] == none || wanted[std::size_t(piece[std::size_t(t)])]) continue;
      behind[std::size_t(piece[std::size_t(t)])] = true;
      if (dropped.insert(piece[std::size_t(t)]).second)
        notes.push_back(fmt::format("dropped the piece of material at {} that only crack '{}' connects with the rest",
                                    text(centroid(mesh, t)), frame.cracks[std::size_t(mesh.crack[e])].name));
    }
  }
  if (dropped.empty()) return false;
  for (std::size_t t = 0; t < piece.size(); ++t)
    if (piece[t] != none && behind[std::size_t(piece[t])])
      for (const Index v : mesh.triangles[t]) {
        if (signs.inside[std::size_t(v)]) signs.magnitude[std::size_t(v)] = -1;
        signs.inside[std::size_t(v)] = 0;
      }
  return true;
}

/// A connected piece of material.
struct Lump {
  Vec2 at;  // a point of it
  double area = 0;
  std::set<Index> labels = {};  // of those to keep and those that hold
};

struct Lumps {
  std::vector<Lump> all;
  std::vector<Index> of;  // per vertex, none in the void
};

/// Every triangle with material belongs to one lump, as its inside vertices are joined by its edges.
Lumps find_lumps(const Block& block, const Signs& signs) {
  const Mesh& mesh = block.mesh;
  Sets sets(mesh.points.size());
  for (const auto& [a, b] : mesh.edges)
    if (signs.inside[std::size_t(a)] && signs.inside[std::size_t(b)]) sets.join(a, b);
  Lumps lumps{{}, std::vector<Index>(mesh.points.size(), none)};
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    if (!signs.inside[v]) continue;
    Index& n = lumps.of[std::size_t(sets.of(Index(v)))];
    if (n == none) {
      n = Index(lumps.all.size());
      lumps.all.push_back({mesh.points[v]});
    }
    lumps.of[v] = n;
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const Index v : mesh.triangles[t])
      if (signs.inside[std::size_t(v)]) {
        lumps.all[std::size_t(lumps.of[std::size_t(v)])].area += inside_area(mesh, signs, Index(t));
        break;
      }
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (has(block.how.keep, mesh.label[e]) || has(block.how.holding, mesh.label[e]))
      for (const Index v : mesh.edges[e])
        if (signs.inside[std::size_t(v)]) lumps.all[std::size_t(lumps.of[std::size_t(v)])].labels.insert(mesh.label[e]);
  return lumps;
}

void require_labels(const Block& block, const Lumps& lumps) {
  std::vector<Index> lost;
  for (const Index l : block.how.keep)
    if (std::ranges::none_of(lumps.all, [&](const Lump& lump) { return lump.labels.contains(l); })) lost.push_back(l);
  if (!lost.empty())
    throw Error(Fault::Geometry, fmt::format("the boundary {} has lost its material", names(block.frame, lost)));
}

bool held(const Lump& lump, const Carving& how) {
  return std::ranges::any_of(lump.labels, [&](Index l) { return has(how.holding, l); });
}

/// What is held and bears most loads, then the largest.
std::size_t choose_body(const Block& block, const std::vector<Lump>& lumps) {
  const auto rank = [&](const Lump& lump) {
    const auto loads = std::ranges::count_if(lump.labels, [&](Index l) { return !has(block.how.holding, l); });
    return std::tuple(held(lump, block.how), loads, lump.labels.size(), lump.area);
  };
  std::size_t body = 0;
  for (std::size_t p = 1; p < lumps.size(); ++p)
    if (rank(lumps[p]) > rank(lumps[body])) body = p;
  if (!block.how.holding.empty() && !held(lumps[body], block.how))
    throw Error(Fault::Geometry, fmt::format("no support is left: the boundary {} has lost its material",
                                             names(block.frame, block.how.holding)));
  return body;
}

/// Says that a lump is dropped. Throws where the body cannot do without it.
void part_with(const Block& block, const Lump& lump, const Lump& body, std::vector<std::string>& notes) {
  const auto& [frame, mesh, rim, how] = block;
  std::vector<Index> needed, supports;
  for (const Index l : lump.labels)
    if (!body.labels.contains(l)) (has(how.holding, l) ? supports : needed).push_back(l);
  const std::string at = text(lump.at);
  if (!needed.empty() && !how.holding.empty() && !held(lump, how))
    throw Error(Fault::Geometry,
                fmt::format("the load on {} is cut off from the supports: the piece of material at {} that bears it "
                            "touches none",
                            names(frame, needed), at));
  if (!needed.empty())
    throw Error(Fault::Geometry,
                fmt::format("the body falls apart: the piece of material at {} with the boundary {} is not connected "
                            "with the rest",
                            at, names(frame, needed)));
  if (!supports.empty())
    notes.push_back(
        fmt::format("dropped a piece of material of area {:.3g} at {} that bears no load, and with it the "
                    "support on {}",
                    lump.area, at, names(frame, supports)));
  else
    notes.push_back(fmt::format("dropped an island of area {:.3g} at {}", lump.area, at));
}

/// The one connected body; the rest is dropped.
void keep_body(const Block& block, Signs& signs, std::vector<std::string>& notes) {
  const Lumps lumps = find_lumps(block, signs);
  if (lumps.all.empty()) throw Error(Fault::Geometry, "no material is left: the function is negative nowhere");
  require_labels(block, lumps);
  const std::size_t body = choose_body(block, lumps.all);
  for (std::size_t p = 0; p < lumps.all.size(); ++p)
    if (p != body) part_with(block, lumps.all[p], lumps.all[body], notes);
  for (std::size_t v = 0; v < lumps.of.size(); ++v)
    if (signs.inside[v] && lumps.of[v] != Index(body)) signs.inside[v] = 0;
}

}  // namespace

void choose_pieces(const Block& block, Signs& signs, std::vector<std::string>& notes) {
  fill_holes(block, signs, notes);
  do keep_body(block, signs, notes);
  while (drop_behind_cracks(block, signs, notes));
}

}  // namespace kerf
