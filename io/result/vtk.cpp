#include "kerf/vtk.hpp"

#include "io/files.hpp"
#include "io/module.hpp"
#include "io/result/vtk_module.hpp"

#include <dlfcn.h>
#include <fmt/core.h>

#include <climits>

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

void write_vtu(const std::filesystem::path& path, std::span<const Vec2> points,
               std::span<const std::array<Index, 3>> triangles, std::span<const NamedField> fields) {
  check(fields, points.size(), triangles.size());
  if (triangles.size() > INT_MAX / 3) throw std::invalid_argument("more triangles than 32-bit numbers can name");
  for (const auto& triangle : triangles) {
    for (const Index p : triangle) {
      if (p < 0 || static_cast<std::size_t>(p) >= points.size()) {
        throw std::invalid_argument(fmt::format("a triangle names point {} of {}", p, points.size()));
      }
    }
  }
  static_assert(sizeof(Vec2) == 2 * sizeof(double) && sizeof(std::array<Index, 3>) == 3 * sizeof(std::int32_t));
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
