// Files of gmsh (.msh), formats 2.x and 4.1, in text and in memory: nodes, lines and triangles of first and second
// order, physical groups. Nothing in a file is trusted. A count is compared with the bytes that are left before
// anything of that size is reserved; tags that stand twice, nodes that are not there, numbers that are not finite and
// cells of other kinds are refused with the line or the byte. Sections that mean nothing here are skipped, not parsed.
// Format 4.1 gives groups to entities (curves, surfaces) and cells to entities; 2.x gives each cell its group. Sets of
// groups are stored once and numbered. Tags become numbers through an array while they are dense, through a hash table
// otherwise. Points must lie in the plane z = 0, up to 1e-9 of the largest coordinate.

#include "io/files.hpp"
#include "io/mesh/bytes.hpp"
#include "io/mesh/raw.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <unordered_map>

namespace kerf {

namespace {

constexpr std::int64_t most_cells = 20'000'000;  // as many as the mesher makes; numbers of edges must fit 32 bits

/// Tags to numbers: an array while tags are dense, a table otherwise.
class Tags {
 public:
  /// False when the tag is there already.
  bool add(std::int64_t tag, Index number) {
    if (tag >= 0 && tag < dense_limit()) {
      if (dense_.size() <= static_cast<std::size_t>(tag)) dense_.resize(static_cast<std::size_t>(tag) + 1, none);
      Index& place = dense_[static_cast<std::size_t>(tag)];
      if (place != none || (!sparse_.empty() && sparse_.contains(tag))) return false;
      place = number;
      ++count_;
      return true;
    }
    ++count_;
    return sparse_.emplace(tag, number).second;
  }
  Index find(std::int64_t tag) const {
    if (tag >= 0 && static_cast<std::size_t>(tag) < dense_.size())
      if (const Index found = dense_[static_cast<std::size_t>(tag)]; found != none) return found;
    const auto found = sparse_.find(tag);
    return found == sparse_.end() ? none : found->second;
  }

 private:
  // The array grows to at most four times the tags that there are: a tag of 2^60 takes no memory.
  std::int64_t dense_limit() const {
    return 4 * count_ + 4096;
  }
  std::int64_t count_ = 0;
  std::vector<Index> dense_;
  std::unordered_map<std::int64_t, Index> sparse_;
};

struct CellKind {
  int type;
  int nodes;              // 0: not read
  std::string_view what;  // why not
};
constexpr CellKind kinds[] = {
    {1, 2, ""},
    {2, 3, ""},
    {8, 3, ""},
    {9, 6, ""},
    {15, 1, ""},
    {3, 0, "a quadrilateral; kerf takes triangles (gmsh: leave out Recombine)"},
    {4, 0, "a tetrahedron; kerf takes plane meshes (gmsh -2)"},
    {5, 0, "a hexahedron; kerf takes plane meshes (gmsh -2)"},
    {6, 0, "a prism; kerf takes plane meshes (gmsh -2)"},
    {7, 0, "a pyramid; kerf takes plane meshes (gmsh -2)"},
    {10, 0, "a quadrilateral of second order; kerf takes triangles (gmsh: leave out Recombine)"},
    {11, 0, "a tetrahedron of second order; kerf takes plane meshes (gmsh -2)"},
    {16, 0, "a quadrilateral of second order; kerf takes triangles (gmsh: leave out Recombine)"},
};

class MshReader {
 public:
  MshReader(std::string name, std::string_view bytes) : in_(name, bytes) {
    mesh_.file = std::move(name);
    mesh_.groups.emplace_back();
    group_sets_[{}] = 0;
  }

  RawMesh read() {
    in_.enter("$MeshFormat");
    if (!in_.skip_blanks() || in_.word() != "$MeshFormat")
      in_.fail("this is no mesh of gmsh: it does not begin with $MeshFormat");
    read_format();
    bool points = false, cells = false;
    while (in_.skip_blanks()) {
      const std::string section(in_.word());
      // The name stands in messages as it is.
      if (section.front() != '$' || section.starts_with("$End") || !is_safe_name(std::string_view(section).substr(1)))
        in_.fail(fmt::format("{} stands where a section should begin", quote(section)));
      in_.enter(section);
      if (section == "$PhysicalNames") {
        read_names();
      } else if (section == "$Entities" && is_4()) {
        read_entities();
      } else if (section == "$PartitionedEntities") {
        in_.fail("the mesh is partitioned; save it as one (gmsh: Mesh.PartitionCreateTopology, UnpartitionMesh)");
      } else if (section == "$Nodes") {
        if (points) in_.fail("$Nodes stands twice");
        points = true;
        is_4() ? read_points_4() : read_points_2();
      } else if (section == "$Elements") {
        if (!points) in_.fail("$Elements stands before $Nodes");
        if (cells) in_.fail("$Elements stands twice");
        cells = true;
        is_4() ? read_cells_4() : read_cells_2();
      } else {
        in_.skip_section();
      }
    }
    if (!points || !cells)
      in_.fail(fmt::format("there is no section {}; the file is cut off, or holds no mesh",
                           points ? "$Elements" : "$Nodes"));
    return std::move(mesh_);
  }

 private:
  bool is_4() const {
    return version_ == 4;
  }

  void begin_data() {
    if (!binary_) return;
    in_.rest_of_line();  // what follows the name, or the count, of the section
    in_.set_binary(true);
  }

  void read_format() {
    const std::string version(in_.word());
    const std::int64_t kind = in_.text_whole(), size = in_.text_whole();
    if (version == "4.1")
      version_ = 4;
    else if (version == "2" || version == "2.0" || version == "2.1" || version == "2.2")
      version_ = 2;
    else
      in_.fail(fmt::format("format {} is not read; save the mesh in format 4.1 or 2.2 (gmsh -format msh41)",
                           quote(version)));
    if (kind != 0 && kind != 1) in_.fail(fmt::format("$MeshFormat: {} is neither 0 (text) nor 1 (binary)", kind));
    if (size != 8) in_.fail(fmt::format("numbers of {} bytes are not read, those of 8 are", size));
    binary_ = kind == 1;
    if (binary_) {
      begin_data();
      const std::int32_t one = in_.whole32();
      if (one == 0x01000000)
        in_.fail("the file was written on a machine with the other byte order; save it as text (gmsh -bin 0)");
      if (one != 1) in_.fail("the mark of the byte order is missing; the file is damaged");
    }
    in_.leave();
  }

  void read_names() {
    const std::int64_t n = in_.count(in_.text_whole(), "names", 6, 6);
    for (std::int64_t k = 0; k < n; ++k) {
      const std::int64_t dimension = in_.text_whole(), tag = in_.text_whole();
      std::string name = in_.quoted();
      if (dimension < 0 || dimension > 3 || tag <= 0 || tag > std::numeric_limits<std::int32_t>::max())
        in_.fail(fmt::format("physical group {} of dimension {} cannot be", tag, dimension));
      if (name.empty()) in_.fail(fmt::format("physical group {} has an empty name", tag));
      if (!mesh_.names.emplace(std::pair(int(dimension), std::int32_t(tag)), std::move(name)).second)
        in_.fail(fmt::format("physical group {} of dimension {} has two names", tag, dimension));
    }
    in_.leave();
  }

  Index group_set(std::vector<std::int32_t> tags) {
    std::sort(tags.begin(), tags.end());
    tags.erase(std::unique(tags.begin(), tags.end()), tags.end());
    const auto [place, fresh] = group_sets_.emplace(tags, static_cast<Index>(mesh_.groups.size()));
    if (fresh) mesh_.groups.push_back(std::move(tags));
    return place->second;
  }

  void read_entities() {
    begin_data();
    std::array<std::int64_t, 4> count;
    for (std::int64_t& n : count) n = in_.count(in_.whole64(), "entities", 6, 12);
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::int64_t k = 0; k < count[std::size_t(dimension)]; ++k) {
        const std::int32_t tag = in_.whole32();
        for (int i = 0; i < (dimension == 0 ? 3 : 6); ++i) in_.real();  // where it lies
        std::vector<std::int32_t> groups;
        const std::int64_t n = in_.count(in_.whole64(), "physical groups", 2, 4);
        for (std::int64_t i = 0; i < n; ++i) {
          const std::int32_t group = in_.whole32();
          if (group == 0 || group == std::numeric_limits<std::int32_t>::min())
            in_.fail(fmt::format("entity {} has the physical group {}, which cannot be", tag, group));
          groups.push_back(std::abs(group));
        }
        if (dimension > 0) {
          const std::int64_t bounds = in_.count(in_.whole64(), "bounding entities", 2, 4);
          for (std::int64_t i = 0; i < bounds; ++i) in_.whole32();
        }
        if (!groups_of_.emplace(std::pair(dimension, tag), group_set(std::move(groups))).second)
          in_.fail(fmt::format("entity {} of dimension {} stands twice", tag, dimension));
      }
    in_.leave();
  }

  void add_point(std::int64_t tag, double x, double y, double z) {
    if (!points_.add(tag, static_cast<Index>(mesh_.points.size()))) in_.fail(fmt::format("node {} stands twice", tag));
    mesh_.points.emplace_back(x, y);
    mesh_.tags.push_back(tag);
    largest_ = std::max({largest_, std::abs(x), std::abs(y)});
    if (std::abs(z) > std::abs(out_of_plane_.z)) out_of_plane_ = {tag, x, y, z};
  }

  void end_points() {
    in_.leave();
    const auto& [tag, x, y, z] = out_of_plane_;
    if (std::abs(z) > 1e-9 * largest_)
      throw Error(Fault::Geometry,
                  fmt::format("{}: node {} at ({:.6g}, {:.6g}, {:.6g}) lies out of the plane z = 0; kerf "
                              "takes plane meshes",
                              mesh_.file, tag, x, y, z));
  }

  void reserve_points(std::int64_t n) {
    if (n > most_cells) in_.fail(fmt::format("{} nodes are too many; at most {} are read", n, most_cells));
    mesh_.points.reserve(std::size_t(n));
    mesh_.tags.reserve(std::size_t(n));
  }

  void read_points_2() {
    const std::int64_t n = in_.count(in_.text_whole(), "nodes", 8, 28);
    reserve_points(n);
    begin_data();
    for (std::int64_t k = 0; k < n; ++k) {
      const std::int32_t tag = in_.whole32();
      const double x = in_.real(), y = in_.real(), z = in_.real();
      add_point(tag, x, y, z);
    }
    end_points();
  }

  void read_points_4() {
    begin_data();
    const std::int64_t blocks = in_.whole64(), n = in_.count(in_.whole64(), "nodes", 8, 32);
    in_.whole64();  // least
    in_.whole64();  // and largest tag
    in_.count(blocks, "blocks", 8, 20);
    reserve_points(n);
    std::vector<std::int64_t> tags;
    for (std::int64_t b = 0; b < blocks; ++b) {
      const std::int32_t dimension = in_.whole32();
      in_.whole32();  // the entity
      const std::int32_t parametric = in_.whole32();
      if (dimension < 0 || dimension > 3 || (parametric != 0 && parametric != 1))
        in_.fail(fmt::format("a block of nodes of dimension {}, parametric {}, cannot be", dimension, parametric));
      tags.resize(std::size_t(in_.count(in_.whole64(), "nodes", 8, 32)));
      if (static_cast<std::int64_t>(mesh_.points.size() + tags.size()) > n)
        in_.fail("there are more nodes than announced");
      for (std::int64_t& tag : tags) tag = in_.whole64();
      for (const std::int64_t tag : tags) {
        const double x = in_.real(), y = in_.real(), z = in_.real();
        for (int i = 0; parametric && i < dimension; ++i) in_.real();
        add_point(tag, x, y, z);
      }
    }
    if (static_cast<std::int64_t>(mesh_.points.size()) != n)
      in_.fail(fmt::format("there are {} nodes, {} are announced", mesh_.points.size(), n));
    end_points();
  }

  int nodes_of(std::int32_t type, std::int64_t tag) const {
    const auto kind =
        std::find_if(std::begin(kinds), std::end(kinds), [&](const CellKind& k) { return k.type == type; });
    if (kind == std::end(kinds))
      in_.fail(
          fmt::format("element {} has the type {} of gmsh, of higher order or unknown; kerf takes lines and triangles "
                      "of first and second order",
                      tag, type));
    return kind->nodes;
  }

  [[noreturn]] void refuse_kind(std::int32_t type, std::int64_t tag, std::int64_t node) const {
    const auto kind =
        std::find_if(std::begin(kinds), std::end(kinds), [&](const CellKind& k) { return k.type == type; });
    const Index p = points_.find(node);
    in_.fail(fmt::format("element {}{} is {}", tag,
                         p == none ? ""
                                   : fmt::format(" at ({:.6g}, {:.6g})", mesh_.points[std::size_t(p)].x(),
                                                 mesh_.points[std::size_t(p)].y()),
                         kind->what));
  }

  // The nodes of a cell are next: `node` reads the tag of one.
  template <typename Read>
  void read_cell(std::int32_t type, std::int64_t tag, std::int32_t entity, Index groups, Read&& node) {
    const int n = nodes_of(type, tag);
    if (n == 0) refuse_kind(type, tag, node());
    if (!cells_.add(tag, 0)) in_.fail(fmt::format("element {} stands twice", tag));
    std::array<Index, 6> v;
    v.fill(none);
    for (int i = 0; i < n; ++i) {
      const std::int64_t wanted = node();
      v[std::size_t(i)] = points_.find(wanted);
      if (v[std::size_t(i)] == none)
        in_.fail(fmt::format("element {} has the node {}, which there is not", tag, wanted));
    }
    if (type == 1 || type == 8) mesh_.lines.push_back({{v[0], v[1]}, tag, entity, groups});
    if (type == 2 || type == 9)
      mesh_.triangles.push_back({{v[0], v[1], v[2]}, tag, entity, groups, {v[3], v[4], v[5]}});
    if (static_cast<std::int64_t>(mesh_.triangles.size()) > most_cells)
      in_.fail(fmt::format("there are more than {} triangles; a coarser mesh is needed", most_cells));
  }

  void read_cell_2(std::int32_t type, std::int32_t tag, std::int32_t tags) {
    if (tags < 0 || tags > 1'000'000) in_.fail(fmt::format("element {} has {} tags, which cannot be", tag, tags));
    std::int32_t group = 0, entity = 0;
    for (std::int32_t i = 0; i < tags; ++i) {
      const std::int32_t value = in_.whole32();
      if (i == 0) group = value;
      if (i == 1) entity = value;
    }
    if (group == std::numeric_limits<std::int32_t>::min())
      in_.fail(fmt::format("element {} has no physical group", tag));
    const Index groups = group == 0 ? 0 : group_set({std::abs(group)});
    read_cell(type, tag, entity, groups, [&] { return std::int64_t{in_.whole32()}; });
  }

  void read_cells_2() {
    const std::int64_t n = in_.count(in_.text_whole(), "elements", 8, 8);
    begin_data();
    for (std::int64_t k = 0; k < n;) {
      if (!in_.binary()) {
        const std::int32_t tag = in_.whole32(), type = in_.whole32(), tags = in_.whole32();
        read_cell_2(type, tag, tags);
        ++k;
        continue;
      }
      const std::int32_t type = in_.whole32(), many = in_.whole32(), tags = in_.whole32();
      if (many <= 0 || many > n - k) in_.fail(fmt::format("a block of {} elements cannot be", many));
      for (std::int32_t i = 0; i < many; ++i) read_cell_2(type, in_.whole32(), tags);
      k += many;
    }
    in_.leave();
  }

  void read_cells_4() {
    begin_data();
    const std::int64_t blocks = in_.whole64(), n = in_.count(in_.whole64(), "elements", 4, 16);
    in_.whole64();
    in_.whole64();
    in_.count(blocks, "blocks", 8, 20);
    std::int64_t found = 0;
    for (std::int64_t b = 0; b < blocks; ++b) {
      const std::int32_t dimension = in_.whole32(), entity = in_.whole32(), type = in_.whole32();
      const std::int64_t many = in_.count(in_.whole64(), "elements", 4, 16);
      const auto groups = groups_of_.find({dimension, entity});
      for (std::int64_t k = 0; k < many; ++k) {
        const std::int64_t tag = in_.whole64();
        read_cell(type, tag, entity, groups == groups_of_.end() ? 0 : groups->second, [&] { return in_.whole64(); });
      }
      found += many;
    }
    if (found != n) in_.fail(fmt::format("there are {} elements, {} are announced", found, n));
    in_.leave();
  }

  struct OutOfPlane {
    std::int64_t tag = 0;
    double x = 0, y = 0, z = 0;
  };

  MeshBytes in_;
  RawMesh mesh_;
  int version_ = 0;
  bool binary_ = false;
  Tags points_, cells_;
  std::map<std::vector<std::int32_t>, Index> group_sets_;
  std::map<std::pair<int, std::int32_t>, Index> groups_of_;
  double largest_ = 0;
  OutOfPlane out_of_plane_;
};

}  // namespace

RawMesh parse_msh(std::string name, std::string_view bytes) {
  static_assert(std::endian::native == std::endian::little, "binary meshes are read as this machine has them");
  return MshReader(std::move(name), bytes).read();
}

RawMesh read_msh(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  return parse_msh(path.string(), bytes);
}

std::string group_name(const RawMesh& mesh, int dimension, std::int32_t tag) {
  const auto found = mesh.names.find({dimension, tag});
  return found == mesh.names.end() ? fmt::format("{}", tag) : found->second;
}

}  // namespace kerf
