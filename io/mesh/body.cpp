// From the cells of a mesh file to a body: its cells checked against each other, its rim, cracks and regions. Lines of
// the file mark edges of triangles: on the rim a physical curve is a label, inside one named crack:<name> is a crack,
// any other one means nothing and is noted. Triangles on both sides of an edge that have nodes of their own there must
// have a crack on it: without one the body would have a cut that nobody named. Physical surfaces are regions and masks;
// each connected piece of one is a region of its own, and triangles of the body's own material that other regions
// enclose are one called "enclosed". Labels and cracks are numbered in an order that does not depend on the order of
// the lines: labels along the outline and the holes, cracks by their physical tags. Sides are drawn from the edges
// (curves.cpp), so that the shape and the mesh are the same body.

#include "io/mesh/body.hpp"
#include "geometry/plane.hpp"
#include "geometry/topology.hpp"
#include "io/files.hpp"
#include "io/mesh/curves.hpp"
#include "io/mesh/second_order.hpp"
#include "io/mesh/welded.hpp"
#include "io/words.hpp"
#include "kerf/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace kerf {

namespace {

constexpr std::string_view crack_prefix = "crack:";

std::string safe(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '.' && c != '-') c = '_';
  return name.substr(0, 100);
}

/// Labels keep the prefix of holes.
std::string safe_label(const std::string& name) {
  constexpr std::string_view hole = "hole:";
  return name.starts_with(hole) ? std::string(hole) + safe(name.substr(hole.size())) : safe(name);
}

/// What the lines of a mesh say of its edges.
struct EdgeMarks {
  std::vector<Index> label, crack;  // per edge; labels in the order of `labels`
  std::vector<std::int32_t> entity;
  std::vector<std::string> labels, cracks;
  std::vector<std::vector<std::pair<Index, bool>>> crack_edges;  // with whether the line runs along the edge
};

class BodyMaker {
 public:
  BodyMaker(const RawMesh& raw, const MeshFileRequest& request) : raw_(raw), request_(request) {}

  MeshFile make() {
    welded_ = weld(raw_);
    check_rim(raw_, welded_);
    read_lines();
    check_doubled();
    follow_curves();
    RimLoops rim = trace(welded_.mesh, [](Index) { return true; });
    name_sides(rim);
    rename_labels(rim);
    draw_rim(rim);
    draw_cracks();
    draw_regions(rim);
    Mesh& mesh = welded_.mesh;
    mesh.label = marks_.label;
    mesh.crack = marks_.crack;
    out_.mesh = std::move(mesh);
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(Fault::Geometry, fmt::format("{}: {}", raw_.file, what));
  }

  std::string at(const Vec2& x) const {
    return fmt::format("({:.6g}, {:.6g})", x.x() + 0.0, x.y() + 0.0);
  }
  Vec2 middle(Index edge) const {
    const auto& [a, b] = welded_.mesh.edges[std::size_t(edge)];
    return (welded_.mesh.points[std::size_t(a)] + welded_.mesh.points[std::size_t(b)]) / 2;
  }
  bool on_rim(Index edge) const {
    const auto& [left, right] = welded_.mesh.sides[std::size_t(edge)];
    return left == none || right == none;
  }

  /// Between two nodes of the file, or none.
  Index edge_between(Index a, Index b) const {
    const auto ends = std::minmax(welded_.vertex[std::size_t(a)], welded_.vertex[std::size_t(b)]);
    if (ends.first == none) return none;
    const std::array<Index, 2> wanted{ends.first, ends.second};
    const auto& edges = welded_.mesh.edges;
    const auto found = std::lower_bound(edges.begin(), edges.end(), wanted);
    return found != edges.end() && *found == wanted ? Index(found - edges.begin()) : none;
  }

  static Index number(std::vector<std::string>& names, const std::string& name) {
    const auto k = Index(std::find(names.begin(), names.end(), name) - names.begin());
    if (std::size_t(k) == names.size()) names.push_back(name);
    return k;
  }

  void read_lines() {
    const std::size_t n = welded_.mesh.edges.size();
    marks_.label.assign(n, none);
    marks_.crack.assign(n, none);
    marks_.entity.assign(n, none);
    // Cracks in the order of their physical tags, whatever the order of the lines.
    for (const auto& [group, name] : raw_.names)
      if (group.first == 1 && name.starts_with(crack_prefix)) crack_number(name);
    std::set<std::string> inside;
    for (const RawLine& line : raw_.lines) {
      const Index e = edge_between(line.v[0], line.v[1]);
      const auto& groups = raw_.groups[std::size_t(line.groups)];
      if (e == none) {
        if (!groups.empty())
          fail(fmt::format("element {} of physical curve {}, at {}, is no edge of a triangle", line.tag,
                           quote(group_name(raw_, 1, groups.front())), at(raw_.points[std::size_t(line.v[0])])));
        continue;
      }
      marks_.entity[std::size_t(e)] = line.entity;
      for (const std::int32_t group : groups) mark(line, e, group_name(raw_, 1, group), inside);
    }
    for (const std::string& name : inside)
      out_.notes.push_back(
          fmt::format("physical curve {} lies inside the body and is not named crack:<name>: it means "
                      "nothing there",
                      quote(name)));
  }

  Index crack_number(const std::string& name) {
    const std::string own = name.substr(crack_prefix.size());
    if (!is_safe_name(own))
      fail(fmt::format("physical curve {}: after crack: a name of letters, digits, _ . or - is needed", quote(name)));
    const Index k = number(marks_.cracks, own);
    marks_.crack_edges.resize(marks_.cracks.size());
    return k;
  }

  void mark(const RawLine& line, Index e, const std::string& name, std::set<std::string>& inside) {
    if (name.starts_with(crack_prefix)) {
      if (on_rim(e))
        fail(fmt::format("element {} of physical curve {}, at {}, lies on the rim of the body; a crack lies inside",
                         line.tag, quote(name), at(middle(e))));
      const Index k = crack_number(name);
      Index& crack = marks_.crack[std::size_t(e)];
      if (crack != none && crack != k)
        fail(fmt::format("the edge at {} belongs to the cracks {} and {}; to one at most", at(middle(e)),
                         quote(marks_.cracks[std::size_t(crack)]), quote(marks_.cracks[std::size_t(k)])));
      if (crack == none)
        marks_.crack_edges[std::size_t(k)].emplace_back(
            e, welded_.vertex[std::size_t(line.v[0])] == welded_.mesh.edges[std::size_t(e)][0]);
      crack = k;
      return;
    }
    if (!on_rim(e)) {
      inside.insert(name);
      return;
    }
    const Index k = number(marks_.labels, safe_label(name));
    Index& label = marks_.label[std::size_t(e)];
    if (label != none && label != k)
      fail(fmt::format("the edge at {} belongs to the physical curves {} and {}; a side has one label", at(middle(e)),
                       quote(marks_.labels[std::size_t(label)]), quote(marks_.labels[std::size_t(k)])));
    label = k;
  }

  /// Faces that do not share their nodes are a crack, and must be called so.
  void check_doubled() const {
    for (std::size_t e = 0; e < welded_.doubled.size(); ++e)
      if (welded_.doubled[e] && marks_.crack[e] == none)
        fail(
            fmt::format("the triangles on both sides of the edge at {} have nodes of their own there, but no physical "
                        "curve crack:<name> has that edge",
                        at(middle(Index(e)))));
  }

  /// The nodes in the middle of edges; triangles on both sides of one must agree on it.
  std::vector<Vec2> middles() const {
    std::vector<Vec2> found(welded_.mesh.edges.size(), Vec2::Constant(nan));
    for (const RawTriangle& t : raw_.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        if (t.middle[i] == none) continue;
        const Index e = edge_between(t.v[i], t.v[(i + 1) % 3]);
        const Vec2& own = raw_.points[std::size_t(t.middle[i])];
        Vec2& x = found[std::size_t(e)];
        if (x.allFinite() && (x - own).norm() > 1e-9 * welded_.extent)
          fail(
              fmt::format("element {} has its node in the middle of the edge at {} elsewhere than its neighbor there, "
                          "at {}: faces must lie on each other",
                          t.tag, at(own), at(x)));
        if (!x.allFinite()) x = own;
      }
    return found;
  }

  /// An edge turns by less than a third of a turn, and its middle lies between its ends.
  void check_middle(Index e, const Vec2& x) const {
    if (!x.allFinite()) return;
    const auto& [a, b] = welded_.mesh.edges[std::size_t(e)];
    const Vec2 &p = welded_.mesh.points[std::size_t(a)], chord = welded_.mesh.points[std::size_t(b)] - p;
    const double along = (x - p).dot(chord) / chord.squaredNorm(),
                 off = std::abs(cross(chord, x - p)) / chord.squaredNorm();
    constexpr double highest = 0.288675;  // tan(30 degrees)/2
    if (!(along > 0 && along < 1 && off < highest))
      fail(
          fmt::format("the edge at {} has its node in the middle at {}, off its chord by {:.2g} of its length; an edge "
                      "turns by less than 120 degrees, off by 0.29, and its middle lies between its ends: a finer mesh "
                      "is needed",
                      at(middle(e)), at(x), off));
  }

  /// Edges of the rim, of cracks and between materials are bent as the nodes in their middle say.
  void follow_curves() {
    if (std::none_of(raw_.triangles.begin(), raw_.triangles.end(),
                     [](const RawTriangle& t) { return t.middle[0] != none; }))
      return;
    MiddleNodes nodes{middles(), std::vector<Index>(welded_.mesh.edges.size(), none)};
    const std::vector<Index> material = surface_of(request_.materials);
    constexpr Index rim = 0, between = 1, first_crack = 2;
    for (std::size_t e = 0; e < nodes.chain.size(); ++e) {
      const auto& [left, right] = welded_.mesh.sides[e];
      nodes.chain[e] = on_rim(Index(e))                                              ? rim
                       : marks_.crack[e] != none                                     ? first_crack + marks_.crack[e]
                       : material[std::size_t(left)] != material[std::size_t(right)] ? between
                                                                                     : none;
      if (nodes.chain[e] != none) check_middle(Index(e), nodes.at[e]);
    }
    curve_ = bend(welded_.mesh, nodes, welded_.extent);
  }

  /// The half edges around half edge k of a loop that belong to the same side: of the same curve of the geometry;
  /// without one, as long as the rim turns by less than 30 degrees.
  std::vector<std::size_t> side_around(const RimLoop& loop, std::size_t k) const {
    const std::size_t n = loop.size();
    const auto direction = [&](std::size_t i) {
      return (welded_.mesh.points[std::size_t(loop[i].b)] - welded_.mesh.points[std::size_t(loop[i].a)]).normalized();
    };
    const auto together = [&](std::size_t i, std::size_t j) {
      const std::size_t e = std::size_t(loop[i].edge), f = std::size_t(loop[j].edge);
      if (marks_.label[e] != marks_.label[f] || marks_.entity[e] != marks_.entity[f]) return false;
      return marks_.entity[e] > 0 || direction(i).dot(direction(j)) > std::sqrt(0.75);
    };
    std::vector<std::size_t> side{k};
    for (std::size_t i = k; side.size() < n && together(i, (i + 1) % n); i = (i + 1) % n) side.push_back((i + 1) % n);
    for (std::size_t i = k; side.size() < n && together(i, (i + n - 1) % n); i = (i + n - 1) % n)
      side.push_back((i + n - 1) % n);
    return side;
  }

  void name_sides(const RimLoops& rim) {
    struct Named {
      Index edge, label;
      const NamedSide* by;
    };
    std::vector<Named> named;
    for (const NamedSide& wanted : request_.sides) {
      double least = infinity;
      std::pair<std::size_t, std::size_t> nearest;
      for (std::size_t l = 0; l < rim.size(); ++l)
        for (std::size_t k = 0; k < rim[l].size(); ++k)
          if (const double d = rim_distance(rim[l][k], wanted.near); d < least) least = d, nearest = {l, k};
      const std::vector<std::size_t> side = side_around(rim[nearest.first], nearest.second);
      std::set<std::pair<std::size_t, std::size_t>> own;
      for (const std::size_t k : side) own.emplace(nearest.first, k);
      for (std::size_t l = 0; l < rim.size(); ++l)
        for (std::size_t k = 0; k < rim[l].size(); ++k)
          if (!own.contains({l, k}) && rim_distance(rim[l][k], wanted.near) <= least + 1e-9 * welded_.extent)
            throw Error(Fault::Usage,
                        fmt::format("{}near = [{:.9g}, {:.9g}] is as near to another side, at {}; choose a "
                                    "point in the middle of the side",
                                    wanted.place, wanted.near.x(), wanted.near.y(), at(middle(rim[l][k].edge))));
      const Index label = number(marks_.labels, wanted.name);
      for (const std::size_t k : side) named.push_back({rim[nearest.first][k].edge, label, &wanted});
    }
    std::map<Index, Index> before;
    for (const auto& [edge, label, by] : named) {
      const auto [place, fresh] = before.emplace(edge, label);
      if (!fresh && place->second != label)
        throw Error(Fault::Usage, fmt::format("{}the side at {} gets the names {} and {}", by->place, at(middle(edge)),
                                              quote(marks_.labels[std::size_t(place->second)]),
                                              quote(marks_.labels[std::size_t(label)])));
      marks_.label[std::size_t(edge)] = label;
    }
  }

  double rim_distance(const HalfEdge& h, const Vec2& x) const {
    return distance(x, welded_.mesh.points[std::size_t(h.a)], welded_.mesh.points[std::size_t(h.b)]);
  }

  /// Labels in the order in which they appear along the outline and the holes.
  void rename_labels(const RimLoops& rim) {
    bool any = false;
    for (const Index label : marks_.label) any = any || label != none;
    if (!any)
      fail(
          "no physical curve lies on the rim: nothing can be supported or loaded; name its sides as physical curves, "
          "or "
          "with [[domain.side]]");
    std::vector<Index> renamed(marks_.labels.size(), none);
    for (const RimLoop& loop : rim)
      for (const HalfEdge& h : loop) {
        Index& label = marks_.label[std::size_t(h.edge)];
        if (label == none) {
          label = number(out_.shape.labels, std::string(unnamed_side));
          continue;
        }
        Index& to = renamed[std::size_t(label)];
        if (to == none) to = number(out_.shape.labels, marks_.labels[std::size_t(label)]);
        label = to;
      }
  }

  std::string hole_name(const Loop& loop, std::set<std::string>& used) const {
    std::set<Index> labels;
    for (const Side& side : loop.sides) labels.insert(side.label);
    std::string name = "hole";
    if (labels.size() == 1) {
      name = out_.shape.labels[std::size_t(*labels.begin())];
      if (name.starts_with("hole:")) name = name.substr(5);
    }
    const std::string first = name;
    for (int k = 2; !used.insert(name).second; ++k) name = fmt::format("{}_{}", first, k);
    return name;
  }

  void draw_rim(const RimLoops& rim) {
    std::set<std::string> used;
    for (std::size_t l = 0; l < rim.size(); ++l) {
      const bool outer = signed_area(welded_.mesh, rim[l]) > 0;
      if (outer != (l == 0)) fail(fmt::format("triangles overlap near {}", at(middle(rim[l].front().edge))));
      Loop loop{outer ? "outline" : "", drawn_sides(welded_.mesh, rim[l], marks_.label, on_curves())};
      if (outer) {
        out_.shape.outline = std::move(loop);
        continue;
      }
      loop.name = hole_name(loop, used);
      out_.shape.holes.push_back(std::move(loop));
    }
  }

  OnCurves on_curves() const {
    return {raw_.curves, marks_.entity, welded_.extent, curve_};
  }

  void draw_cracks() {
    Mesh& mesh = welded_.mesh;
    mesh.cracks.resize(marks_.cracks.size());
    for (std::size_t k = 0; k < marks_.cracks.size(); ++k) {
      const std::string& name = marks_.cracks[k];
      if (marks_.crack_edges[k].empty()) fail(fmt::format("physical curve crack:{} has no edge in the mesh", name));
      std::string why;
      mesh.cracks[k] = path_of(mesh, marks_.crack_edges[k], why);
      if (!why.empty()) fail(fmt::format("crack {} {}", quote(name), why));
      Crack crack = drawn_crack(mesh, mesh.cracks[k], on_curves());
      crack.name = name;
      out_.shape.cracks.push_back(std::move(crack));
    }
  }

  /// Per triangle which of the names its surface has, or none.
  std::vector<Index> surface_of(const std::vector<std::string>& names) const {
    std::vector<Index> of_set(raw_.groups.size(), none);
    for (std::size_t s = 0; s < raw_.groups.size(); ++s)
      for (const std::int32_t group : raw_.groups[s]) {
        const auto found = std::find(names.begin(), names.end(), safe(group_name(raw_, 2, group)));
        if (found == names.end()) continue;
        const Index k = Index(found - names.begin());
        if (of_set[s] != none && of_set[s] != k)
          for (const RawTriangle& t : raw_.triangles)
            if (std::size_t(t.groups) == s)
              fail(fmt::format("element {} at {} lies in the regions {} and {}", t.tag,
                               at(raw_.points[std::size_t(t.v[0])]), quote(names[std::size_t(of_set[s])]),
                               quote(*found)));
        of_set[s] = k;
      }
    std::vector<Index> out;
    for (const RawTriangle& t : raw_.triangles) out.push_back(of_set[std::size_t(t.groups)]);
    return out;
  }

  /// Connected pieces of triangles with the same number.
  std::vector<Index> pieces_of(const std::vector<Index>& of) const {
    const Mesh& mesh = welded_.mesh;
    std::vector<bool> cut(mesh.edges.size());
    for (std::size_t e = 0; e < cut.size(); ++e) {
      const auto& [left, right] = mesh.sides[e];
      cut[e] = left != none && right != none && of[std::size_t(left)] != of[std::size_t(right)];
    }
    return pieces(mesh, cut);
  }

  std::vector<Side> outline_of(const std::vector<Index>& piece, Index p) const {
    const RimLoops loops = trace(welded_.mesh, [&](Index t) { return piece[std::size_t(t)] == p; });
    const std::vector<Index> no_labels(welded_.mesh.edges.size(), none);
    return drawn_sides(welded_.mesh, loops.front(), no_labels, on_curves());
  }

  void draw_regions(const RimLoops& rim) {
    std::set<std::string> surfaces;
    for (const RawTriangle& t : raw_.triangles)
      for (const std::int32_t group : raw_.groups[std::size_t(t.groups)])
        surfaces.insert(safe(group_name(raw_, 2, group)));
    out_.surfaces.assign(surfaces.begin(), surfaces.end());
    if (!request_.masks.empty()) draw_masks();
    const std::vector<Index> material = surface_of(request_.materials);
    if (std::all_of(material.begin(), material.end(), [](Index m) { return m == none; })) return;
    const std::vector<Index> piece = pieces_of(material);
    // Of the body's own material, what reaches its outline is the body; what others enclose is a region like them.
    std::vector<Index> first(std::size_t(*std::max_element(piece.begin(), piece.end())) + 1, none);
    std::vector<bool> outer(first.size(), false);
    for (std::size_t t = piece.size(); t-- > 0;) first[std::size_t(piece[t])] = Index(t);
    for (const HalfEdge& h : rim.front()) outer[std::size_t(piece[std::size_t(h.triangle)])] = true;
    std::vector<Index> region(first.size(), none);
    const Index body = Index(request_.materials.size());
    for (Index m = 0; m <= body; ++m) {
      int number = 0;
      for (std::size_t p = 0; p < first.size(); ++p) {
        const Index own = material[std::size_t(first[p])];
        if (own != (m == body ? none : m) || (own == none && outer[p])) continue;
        region[p] = Index(out_.shape.regions.size());
        const std::string name = m == body ? "enclosed" : request_.materials[std::size_t(m)];
        out_.shape.regions.push_back(
            {++number == 1 ? name : fmt::format("{}.{}", name, number), outline_of(piece, Index(p))});
        out_.material.push_back(own);
      }
    }
    for (const Index p : piece) welded_.mesh.region.push_back(region[std::size_t(p)]);
  }

  void draw_masks() {
    const std::vector<Index> mask = surface_of(request_.masks), piece = pieces_of(mask);
    std::set<Index> drawn;
    for (std::size_t t = 0; t < mask.size(); ++t)
      if (mask[t] != none && drawn.insert(piece[t]).second)
        out_.masks.push_back({request_.masks[std::size_t(mask[t])], outline_of(piece, piece[t])});
  }

  const RawMesh& raw_;
  const MeshFileRequest& request_;
  Welded welded_;
  EdgeMarks marks_;
  std::vector<Index> curve_;  // of edges that are bent
  MeshFile out_;
};

}  // namespace

MeshFile make_body(const RawMesh& raw, const MeshFileRequest& request) {
  return BodyMaker(raw, request).make();
}

MeshFile parse_mesh(std::string name, std::string_view bytes, const MeshFileRequest& request) {
  return make_body(parse_msh(std::move(name), bytes), request);
}

MeshFile read_mesh(const std::filesystem::path& path, const MeshFileRequest& request) {
  return make_body(read_msh(path), request);
}

}  // namespace kerf
