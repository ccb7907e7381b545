// Meshes as files of gmsh, format 2.2 or 4.1 in text, which read_msh.cpp reads back as the same body. Every label,
// crack and region is a physical group and at the same time the one curve or surface (entity) of that number, since
// kerf's meshes have no geometry behind them. Lines of the rim run with the body on their left, those of a crack along
// its path. A mesh with curved edges is written with nodes in the middle of all edges (second order), straight ones in
// the middle of the chord. Numbers have 17 digits. Pieces "fibres.2" of a surface that came in several pieces are again
// one group.

#include "geometry/plane.hpp"
#include "io/files.hpp"
#include "kerf/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>

namespace kerf {

namespace {

/// A physical group, which is also a curve or a surface of its own.
struct Group {
  int dimension;
  std::string name;
};

/// "fibres" of "fibres.2", if that is the name of another region: a surface in several pieces.
std::string surface_name(const Shape& shape, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot + 1 == name.size()) return name;
  if (!std::all_of(name.begin() + static_cast<std::ptrdiff_t>(dot) + 1, name.end(),
                   [](unsigned char c) { return std::isdigit(c); }))
    return name;
  const std::string base = name.substr(0, dot);
  const bool known =
      std::any_of(shape.regions.begin(), shape.regions.end(), [&](const Loop& loop) { return loop.name == base; });
  return known ? base : name;
}

struct Line {
  Index a, b, group, edge;
};

/// Groups by number, lines and the groups of triangles.
struct Cells {
  std::vector<Group> groups;
  std::vector<Line> lines;
  std::vector<Index> of_triangle;
};

Index group_of(std::vector<Group>& groups, int dimension, const std::string& name) {
  const auto found = std::find_if(groups.begin(), groups.end(),
                                  [&](const Group& g) { return g.dimension == dimension && g.name == name; });
  if (found != groups.end()) return Index(found - groups.begin());
  groups.push_back({dimension, name});
  return Index(groups.size() - 1);
}

Cells cells_of(const Mesh& mesh, const Shape& shape) {
  Cells out;
  for (const std::string& label : shape.labels) group_of(out.groups, 1, label);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.label[e] == none) continue;
    auto [a, b] = mesh.edges[e];
    if (mesh.sides[e][0] == none) std::swap(a, b);  // the body on the left
    out.lines.push_back({a, b, mesh.label[e], Index(e)});
  }
  std::stable_sort(out.lines.begin(), out.lines.end(), [](const Line& x, const Line& y) { return x.group < y.group; });
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c) {
    const Index group = group_of(out.groups, 1, "crack:" + shape.cracks[c].name);
    for (const CrackEdge& piece : mesh.cracks[c]) {
      auto [a, b] = mesh.edges[std::size_t(piece.edge)];
      if (!piece.forward) std::swap(a, b);
      out.lines.push_back({a, b, group, piece.edge});
    }
  }
  std::vector<Index> of_region;
  std::string rest = "body";
  while (std::any_of(shape.regions.begin(), shape.regions.end(), [&](const Loop& r) { return r.name == rest; }))
    rest += "_";
  const Index body = group_of(out.groups, 2, rest);
  for (const Loop& region : shape.regions)
    of_region.push_back(group_of(out.groups, 2, surface_name(shape, region.name)));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Index region = region_of(mesh, Index(t));
    out.of_triangle.push_back(region == none ? body : of_region[std::size_t(region)]);
  }
  return out;
}

/// One after the other what has the same group.
template <typename Of, typename Visit>
void each_run(std::size_t n, Of&& of, Visit&& visit) {
  for (std::size_t from = 0; from < n;) {
    std::size_t to = from + 1;
    while (to < n && of(to) == of(from)) ++to;
    visit(from, to, of(from));
    from = to;
  }
}

/// The nodes: the vertices, and with curved edges those in the middle of all edges in their order.
std::vector<Vec2> nodes_of(const Mesh& mesh) {
  std::vector<Vec2> nodes = mesh.points;
  if (mesh.arc.empty()) return nodes;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& [a, b] = mesh.edges[e];
    if (mesh.arc[e] == none) {
      nodes.push_back((mesh.points[std::size_t(a)] + mesh.points[std::size_t(b)]) / 2);
      continue;
    }
    const Arc& arc = mesh.arcs[std::size_t(mesh.arc[e])];
    nodes.push_back(at(arc, (arc.from + arc.to) / 2));
  }
  return nodes;
}

class Writer {
 public:
  Writer(const Mesh& mesh, const Shape& shape)
      : mesh_(mesh), nodes_(nodes_of(mesh)), second_(!mesh.arc.empty()), cells_(cells_of(mesh, shape)) {}

  std::string write(MshVersion version) {
    print("$MeshFormat\n{} 0 8\n$EndMeshFormat\n", version == MshVersion::V2 ? "2.2" : "4.1");
    print("$PhysicalNames\n{}\n", cells_.groups.size());
    for (std::size_t g = 0; g < cells_.groups.size(); ++g)
      print("{} {} \"{}\"\n", cells_.groups[g].dimension, g + 1, cells_.groups[g].name);
    print("$EndPhysicalNames\n");
    version == MshVersion::V2 ? write_2() : write_4();
    return fmt::to_string(text_);
  }

 private:
  template <typename... Arguments>
  void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  /// gmsh's numbers of cells.
  int line_type() const {
    return second_ ? 8 : 1;
  }
  int triangle_type() const {
    return second_ ? 9 : 2;
  }
  std::size_t middle_of(Index edge) const {
    return mesh_.points.size() + std::size_t(edge) + 1;
  }
  std::vector<std::size_t> nodes_on(const Line& line) const {
    std::vector<std::size_t> nodes{std::size_t(line.a) + 1, std::size_t(line.b) + 1};
    if (second_) nodes.push_back(middle_of(line.edge));
    return nodes;
  }
  /// The corners, then the middles from the first to the second and on.
  std::vector<std::size_t> nodes_on(std::size_t triangle) const {
    std::vector<std::size_t> nodes;
    for (const Index v : mesh_.triangles[triangle]) nodes.push_back(std::size_t(v) + 1);
    if (second_)
      for (const std::size_t opposite : {2, 0, 1}) nodes.push_back(middle_of(mesh_.edges_of[triangle][opposite]));
    return nodes;
  }

  void write_2() {
    print("$Nodes\n{}\n", nodes_.size());
    for (std::size_t p = 0; p < nodes_.size(); ++p)
      print("{} {:.17g} {:.17g} 0\n", p + 1, nodes_[p].x(), nodes_[p].y());
    print("$EndNodes\n$Elements\n{}\n", cells_.lines.size() + mesh_.triangles.size());
    std::size_t tag = 0;
    for (const Line& line : cells_.lines)
      print("{} {} 2 {} {} {}\n", ++tag, line_type(), line.group + 1, line.group + 1, fmt::join(nodes_on(line), " "));
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Index group = cells_.of_triangle[t];
      print("{} {} 2 {} {} {}\n", ++tag, triangle_type(), group + 1, group + 1, fmt::join(nodes_on(t), " "));
    }
    print("$EndElements\n");
  }

  void write_4() {
    write_entities();
    print("$Nodes\n1 {0} 1 {0}\n2 {1} 0 {0}\n", nodes_.size(), a_surface() + 1);
    for (std::size_t p = 0; p < nodes_.size(); ++p) print("{}\n", p + 1);
    for (const Vec2& x : nodes_) print("{:.17g} {:.17g} 0\n", x.x(), x.y());
    print("$EndNodes\n");
    const auto line_group = [&](std::size_t i) { return cells_.lines[i].group; };
    const std::vector<std::size_t> triangles = by_surface();
    const auto triangle_group = [&](std::size_t i) { return cells_.of_triangle[triangles[i]]; };
    std::size_t blocks = 0, tag = 0;
    const auto count = [&](std::size_t, std::size_t, Index) { ++blocks; };
    each_run(cells_.lines.size(), line_group, count);
    each_run(mesh_.triangles.size(), triangle_group, count);
    print("$Elements\n{} {} 1 {}\n", blocks, cells_.lines.size() + mesh_.triangles.size(),
          cells_.lines.size() + mesh_.triangles.size());
    each_run(cells_.lines.size(), line_group, [&](std::size_t from, std::size_t to, Index group) {
      print("1 {} {} {}\n", group + 1, line_type(), to - from);
      for (std::size_t i = from; i < to; ++i) print("{} {}\n", ++tag, fmt::join(nodes_on(cells_.lines[i]), " "));
    });
    each_run(mesh_.triangles.size(), triangle_group, [&](std::size_t from, std::size_t to, Index group) {
      print("2 {} {} {}\n", group + 1, triangle_type(), to - from);
      for (std::size_t i = from; i < to; ++i) print("{} {}\n", ++tag, fmt::join(nodes_on(triangles[i]), " "));
    });
    print("$EndElements\n");
  }

  /// The triangles, those of a surface behind one another: a block each, as gmsh writes them. Surfaces come as the mesh
  /// has them first, so that a file read and written again keeps its order.
  std::vector<std::size_t> by_surface() const {
    std::vector<std::size_t> first(cells_.groups.size(), mesh_.triangles.size()), order(mesh_.triangles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto place = [&](std::size_t t) -> std::size_t& { return first[std::size_t(cells_.of_triangle[t])]; };
    for (const std::size_t t : order) place(t) = std::min(place(t), t);
    std::ranges::stable_sort(order, {}, place);
    return order;
  }

  /// Each group is one curve or surface, in the box of the body.
  void write_entities() {
    std::array<std::size_t, 4> count{};
    for (const Group& group : cells_.groups) ++count[std::size_t(group.dimension)];
    print("$Entities\n{}\n", fmt::join(count, " "));
    Vec2 low = mesh_.points.front(), high = low;
    for (const Vec2& x : mesh_.points) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    for (std::size_t g = 0; g < cells_.groups.size(); ++g)
      print("{0} {1:.17g} {2:.17g} 0 {3:.17g} {4:.17g} 0 1 {0} 0\n", g + 1, low.x(), low.y(), high.x(), high.y());
    print("$EndEntities\n");
  }

  std::size_t a_surface() const {
    return std::size_t(
        std::find_if(cells_.groups.begin(), cells_.groups.end(), [](const Group& g) { return g.dimension == 2; }) -
        cells_.groups.begin());
  }

  const Mesh& mesh_;
  std::vector<Vec2> nodes_;
  bool second_;
  Cells cells_;
  fmt::memory_buffer text_;
};

}  // namespace

std::string msh_text(const Mesh& mesh, const Shape& shape, MshVersion version) {
  if (mesh.triangles.empty()) throw std::invalid_argument("there are no triangles to write");
  return Writer(mesh, shape).write(version);
}

void write_mesh(const std::filesystem::path& path, const Mesh& mesh, const Shape& shape, MshVersion version) {
  write_file(path, msh_text(mesh, shape, version));
}

}  // namespace kerf
