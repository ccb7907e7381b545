// What a file is by its ending, and the body in it: a mesh directly, a geometry by gmsh.

#include "io/mesh/body.hpp"
#include "io/mesh/gmsh.hpp"
#include "io/mesh_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace kerf {

namespace {

std::string extension(const std::filesystem::path& path) {
  std::string out = path.extension().string();
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& path) {
  return extension(path) == ".msh";
}

bool is_geometry_file(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 6> known{".geo", ".step", ".stp", ".brep", ".iges", ".igs"};
  return std::find(known.begin(), known.end(), extension(path)) != known.end();
}

MeshFile read_body(const BodySource& source, const MeshFileRequest& request) {
  if (is_mesh_file(source.path)) return read_mesh(source.path, request);
  return make_body(mesh_geometry(source), request);
}

}  // namespace kerf
