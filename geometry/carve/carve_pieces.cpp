// Which pieces of the negative set are the body, and which of its holes stay.

#include "geometry/carve/contour.hpp"

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

std::string text(const Vec2& x) {
  return fmt::format("({:.4g}, {:.4g})", x.x(), x.y());
}

std::string names(const Shape& frame, const std::vector<Index>& labels) {
  std::string list;
  for (const Index l : labels) list += fmt::format("{}'{}'", list.empty() ? "" : ", ", frame.labels[std::size_t(l)]);
  return list;
}

struct Lump {
  Vec2 at;  // a point of it
  double area = 0;
  std::set<Index> labels;  // of those to keep
};

bool has(const std::vector<Index>& list, Index i) {
  return std::ranges::find(list, i) != list.end();
}

void fill_holes(const Mesh& mesh, const Carving& how, Signs& signs, std::vector<std::string>& notes) {
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
bool drop_behind_cracks(const Shape& frame, const Mesh& mesh, const Carving& how, Signs& signs,
                        std::vector<std::string>& notes) {
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

/// The one connected body; the rest is dropped.
void choose_body(const Shape& frame, const Mesh& mesh, const Carving& how, Signs& signs,
                 std::vector<std::string>& notes) {
  Sets sets(mesh.points.size());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& [a, b] = mesh.edges[e];
    if (signs.inside[std::size_t(a)] && signs.inside[std::size_t(b)]) sets.join(a, b);
  }
  std::vector<Index> number(mesh.points.size(), none);
  std::vector<Lump> pieces;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    if (!signs.inside[v]) continue;
    Index& n = number[std::size_t(sets.of(Index(v)))];
    if (n == none) {
      n = Index(pieces.size());
      pieces.push_back({mesh.points[v]});
    }
  }
  if (pieces.empty()) throw Error(Fault::Geometry, "no material is left: the function is negative nowhere");
  const auto piece_of = [&](Index v) { return std::size_t(number[std::size_t(sets.of(v))]); };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const Index v : mesh.triangles[t])
      if (signs.inside[std::size_t(v)]) {
        pieces[piece_of(v)].area += inside_area(mesh, signs, Index(t));
        break;
      }
  std::set<Index> present;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (has(how.keep, mesh.label[e]) || has(how.holding, mesh.label[e]))
      for (const Index v : mesh.edges[e])
        if (signs.inside[std::size_t(v)]) {
          pieces[piece_of(v)].labels.insert(mesh.label[e]);
          present.insert(mesh.label[e]);
        }
  std::vector<Index> lost;
  for (const Index l : how.keep)
    if (!present.contains(l)) lost.push_back(l);
  if (!lost.empty())
    throw Error(Fault::Geometry, fmt::format("the boundary {} has lost its material", names(frame, lost)));

  const auto loads = [&](const Lump& p) {
    return std::count_if(p.labels.begin(), p.labels.end(), [&](Index l) { return !has(how.holding, l); });
  };
  const auto held = [&](const Lump& p) {
    return std::any_of(p.labels.begin(), p.labels.end(), [&](Index l) { return has(how.holding, l); });
  };
  // The body: what is held and bears most loads, then the largest.
  std::size_t body = 0;
  for (std::size_t p = 1; p < pieces.size(); ++p) {
    const Lump &a = pieces[p], &b = pieces[body];
    if (std::tuple(held(a), loads(a), a.labels.size(), a.area) > std::tuple(held(b), loads(b), b.labels.size(), b.area))
      body = p;
  }
  const Lump& main = pieces[body];
  if (!how.holding.empty() && !held(main))
    throw Error(Fault::Geometry,
                fmt::format("no support is left: the boundary {} has lost its material", names(frame, how.holding)));
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Lump& piece = pieces[p];
    if (p == body) continue;
    std::vector<Index> needed, supports;
    for (const Index l : piece.labels)
      if (!main.labels.contains(l)) (has(how.holding, l) ? supports : needed).push_back(l);
    const std::string at = text(piece.at);
    if (!needed.empty() && !how.holding.empty() && !held(piece))
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
                      piece.area, at, names(frame, supports)));
    else
      notes.push_back(fmt::format("dropped an island of area {:.3g} at {}", piece.area, at));
  }
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (signs.inside[v] && piece_of(Index(v)) != body) signs.inside[v] = 0;
}

}  // namespace

void choose_pieces(const Shape& frame, const Mesh& mesh, const Carving& how, Signs& signs,
                   std::vector<std::string>& notes) {
  fill_holes(mesh, how, signs, notes);
  do choose_body(frame, mesh, how, signs, notes);
  while (drop_behind_cracks(frame, mesh, how, signs, notes));
}

}  // namespace kerf
