// Fields on triangles (.vtu), in parts (.pvtu) and along lines (.vtp), by VTK, which is loaded as a module when it is
// needed. The module gets plain C data and gives back bytes, which are written here: exceptions do not pass through
// VTK. Triangles with a curved edge become quadratic ones: three more points in the middles of their edges, on the arc
// where there is one; values there are the means of the ends. A .pvtu only names its pieces and their arrays, and is
// text. Counts are checked against the 32-bit numbers that cells are written with.

#include "kerf/vtk.hpp"

#include "geometry/plane.hpp"
#include "io/files.hpp"
#include "io/module.hpp"
#include "io/result/vtk_module.hpp"

#include <dlfcn.h>
#include <fmt/core.h>

#include <algorithm>
#include <climits>
#include <map>

namespace kerf {

namespace {

struct Module {
  KerfVtkWriter triangles, lines;
};

Module load() {
  const LoadedModule found =
      load_module("kerf_vtk.so", KERF_VTK_FOLDER, {"kerf_vtk_write_triangles", "kerf_vtk_write_lines"});
  if (!found.handle)
    throw Error(
        Fault::Files,
        fmt::format(
            "cannot load the VTK module kerf_vtk.so ({}); put it beside the program or into ../lib/kerf, "
            "install VTK's library (libvtk9.1 on Debian 12, libvtk9.3 on Debian 13; the package kerf-vtk brings "
            "both), or switch VTK files off with [output] vtk = false",
            found.reason));
  const auto find = [&](const char* name) { return reinterpret_cast<KerfVtkWriter>(dlsym(found.handle, name)); };
  return {find("kerf_vtk_write_triangles"), find("kerf_vtk_write_lines")};
}

const Module& loaded() {
  static const Module module = load();  // tried again after a failure
  return module;
}

void check(std::span<const NamedField> fields, std::size_t points, std::size_t cells) {
  for (const NamedField& field : fields) {
    const std::size_t wanted = field.per_cell ? cells : points;
    if (field.values.rows() == 0 || static_cast<std::size_t>(field.values.cols()) != wanted) {
      throw std::invalid_argument(fmt::format("field '{}' has {} x {} values; {} columns would be right", field.name,
                                              field.values.rows(), field.values.cols(), wanted));
    }
  }
}

std::vector<KerfVtkField> plain(std::span<const NamedField> fields) {
  std::vector<KerfVtkField> out;
  for (const NamedField& field : fields) {
    out.push_back({field.name.c_str(), field.per_cell, static_cast<int>(field.values.rows()), field.values.cols(),
                   field.values.data()});
  }
  return out;
}

void write(const std::filesystem::path& path, KerfVtkWriter writer, const KerfVtkData& data) {
  struct Target {
    const std::filesystem::path& path;
    std::exception_ptr failure;
  } target{path, nullptr};
  const auto sink = [](void* to, const char* bytes, std::int64_t count) {
    auto& file = *static_cast<Target*>(to);
    try {
      write_file(file.path, {bytes, static_cast<std::size_t>(count)});
    } catch (...) {  // carried past VTK's frames by hand
      file.failure = std::current_exception();
    }
  };
  if (!writer(&data, sink, &target)) {
    throw Error(Fault::Files, fmt::format("VTK cannot write '{}'; is there enough memory?", path.string()));
  }
  if (target.failure) std::rethrow_exception(target.failure);
}

}  // namespace

void require_vtk() {
  loaded();
}

MiddlePoints middle_points(const Mesh& mesh, std::span<const std::array<Index, 3>> triangles) {
  MiddlePoints out;
  if (mesh.arc.empty()) return out;
  out.of.assign(triangles.size(), {none, none, none});
  std::map<std::pair<Index, Index>, Index> number;  // of its ends
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& edges = mesh.edges_of[t];
    if (std::ranges::all_of(edges, [&](Index e) { return mesh.arc[std::size_t(e)] == none; })) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = triangles[t][i], b = triangles[t][(i + 1) % 3];
      const auto [place, fresh] = number.emplace(std::minmax(a, b), Index(out.at.size()));
      out.of[t][i] = place->second;
      if (!fresh) continue;
      const auto e = std::size_t(edges[(i + 2) % 3]);
      const auto& [from, to] = mesh.edges[e];
      const Arc* arc = mesh.arc[e] == none ? nullptr : &mesh.arcs[std::size_t(mesh.arc[e])];
      out.at.push_back(arc ? at(*arc, (arc->from + arc->to) / 2)
                           : Vec2((mesh.points[std::size_t(from)] + mesh.points[std::size_t(to)]) / 2));
      out.between.push_back({a, b});
    }
  }
  return out;
}

namespace {

/// With the means of the ends of edges behind the values at points.
std::vector<NamedField> extended(std::span<const NamedField> fields, const MiddlePoints& middle) {
  std::vector<NamedField> out(fields.begin(), fields.end());
  for (NamedField& field : out) {
    if (field.per_cell) continue;
    const Eigen::Index n = field.values.cols();
    field.values.conservativeResize(Eigen::NoChange, n + Eigen::Index(middle.at.size()));
    for (std::size_t k = 0; k < middle.at.size(); ++k) {
      const auto& [a, b] = middle.between[k];
      field.values.col(n + Eigen::Index(k)) = (field.values.col(a) + field.values.col(b)) / 2;
    }
  }
  return out;
}

/// The entries of all cells, and where they end.
struct Cells {
  std::vector<std::int32_t> entries, ends;
};
Cells cells_of(std::span<const std::array<Index, 3>> triangles, const MiddlePoints& middle, std::size_t points) {
  Cells out;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    out.entries.insert(out.entries.end(), triangles[t].begin(), triangles[t].end());
    if (middle.of[t][0] != none)
      for (const Index k : middle.of[t]) out.entries.push_back(Index(points) + k);
    out.ends.push_back(std::int32_t(out.entries.size()));
  }
  return out;
}

void write_quadratic(const std::filesystem::path& path, std::span<const Vec2> corners,
                     std::span<const std::array<Index, 3>> triangles, std::span<const NamedField> fields,
                     const MiddlePoints& middle) {
  std::vector<Vec2> points(corners.begin(), corners.end());
  points.insert(points.end(), middle.at.begin(), middle.at.end());
  const std::vector<NamedField> values = extended(fields, middle);
  const std::vector<KerfVtkField> list = plain(values);
  const Cells cells = cells_of(triangles, middle, corners.size());
  KerfVtkData data{};
  data.points = static_cast<std::int64_t>(points.size());
  data.xy = points.front().data();
  data.cells = static_cast<std::int64_t>(triangles.size());
  data.entries = cells.entries.data();
  data.cell_ends = cells.ends.data();
  data.fields = static_cast<std::int64_t>(list.size());
  data.field = list.data();
  write(path, loaded().triangles, data);
}

}  // namespace

void write_vtu(const std::filesystem::path& path, std::span<const Vec2> points,
               std::span<const std::array<Index, 3>> triangles, std::span<const NamedField> fields,
               const MiddlePoints& middle) {
  check(fields, points.size(), triangles.size());
  if (triangles.size() > INT_MAX / (middle.of.empty() ? 3 : 6))
    throw std::invalid_argument("more triangles than 32-bit numbers can name");
  for (const auto& triangle : triangles) {
    for (const Index p : triangle) {
      if (p < 0 || static_cast<std::size_t>(p) >= points.size()) {
        throw std::invalid_argument(fmt::format("a triangle names point {} of {}", p, points.size()));
      }
    }
  }
  static_assert(sizeof(Vec2) == 2 * sizeof(double) && sizeof(std::array<Index, 3>) == 3 * sizeof(std::int32_t));
  if (!middle.of.empty()) return write_quadratic(path, points, triangles, fields, middle);
  const std::vector<KerfVtkField> list = plain(fields);
  KerfVtkData data{};
  data.points = static_cast<std::int64_t>(points.size());
  data.xy = points.empty() ? nullptr : points.front().data();
  data.cells = static_cast<std::int64_t>(triangles.size());
  data.entries = triangles.empty() ? nullptr : triangles.front().data();
  data.fields = static_cast<std::int64_t>(list.size());
  data.field = list.data();
  write(path, loaded().triangles, data);
}

void write_pvtu(const std::filesystem::path& path, std::span<const std::string> pieces,
                std::span<const NamedField> fields) {
  constexpr std::array<const char*, 4> tensor{"xx", "yy", "xy", "yx"};
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n  <PUnstructuredGrid GhostLevel=\"0\">\n";
  for (const bool per_cell : {false, true}) {
    text += fmt::format("    <{}>\n", per_cell ? "PCellData" : "PPointData");
    for (const NamedField& field : fields) {
      if (field.per_cell != per_cell) continue;
      const Eigen::Index components = field.values.rows();  // two become three, as in the pieces
      text += fmt::format("      <PDataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\"", field.name,
                          components == 2 ? 3 : components);
      for (Eigen::Index k = 0; components > 2 && k < components; ++k)
        text += fmt::format(" ComponentName{}=\"{}\"", k, tensor.at(static_cast<std::size_t>(k)));
      text += "/>\n";
    }
    text += fmt::format("    </{}>\n", per_cell ? "PCellData" : "PPointData");
  }
  text += "    <PPoints>\n      <PDataArray type=\"Float64\" NumberOfComponents=\"3\"/>\n    </PPoints>\n";
  for (const std::string& piece : pieces) text += fmt::format("    <Piece Source=\"{}\"/>\n", piece);
  write_file(path, text + "  </PUnstructuredGrid>\n</VTKFile>\n");
}

void write_vtp(const std::filesystem::path& path, std::span<const std::vector<Vec2>> lines,
               std::span<const NamedField> fields) {
  std::vector<Vec2> points;
  std::vector<std::int32_t> entries, ends;
  for (const auto& line : lines) {
    for (const Vec2& point : line) {
      entries.push_back(static_cast<std::int32_t>(points.size()));
      points.push_back(point);
    }
    ends.push_back(static_cast<std::int32_t>(points.size()));
  }
  check(fields, points.size(), lines.size());
  const std::vector<KerfVtkField> list = plain(fields);
  KerfVtkData data{};
  data.points = static_cast<std::int64_t>(points.size());
  data.xy = points.empty() ? nullptr : points.front().data();
  data.cells = static_cast<std::int64_t>(lines.size());
  data.entries = entries.data();
  data.cell_ends = ends.data();
  data.fields = static_cast<std::int64_t>(list.size());
  data.field = list.data();
  write(path, loaded().lines, data);
}

}  // namespace kerf
