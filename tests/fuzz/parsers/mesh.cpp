// Meshes of gmsh (.msh 2.2 and 4.1, text and binary): a mesh that is one body, within whose own sizes all indices lie,
// and which is the same when it is written and read again; or an Error.

#include "kerf/mesh_file.hpp"
#include "tests/fuzz/parsers/promise.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kerf;
  parsers::promise([&] {
    const MeshFileRequest request{.materials = {"core", ""}, .masks = {"mask"}, .sides = {{{0, 0}, "side", "here: "}}};
    const std::string_view bytes = parsers::text(data, size);
    const bool asks = !bytes.empty() && bytes.back() == '?';
    const MeshFile file = parse_mesh("a.msh", bytes, asks ? request : MeshFileRequest{});
    const auto points = static_cast<Index>(file.mesh.points.size());
    for (const auto& t : file.mesh.triangles)
      for (const Index v : t) parsers::require(v >= 0 && v < points, "corners of a triangle are points");
    for (const auto& e : file.mesh.edges)
      for (const Index v : e) parsers::require(v >= 0 && v < points, "ends of an edge are points");
    if (!asks) {
      const std::string written = msh_text(file.mesh, file.shape);
      parsers::promise([&] {
        const MeshFile again = parse_mesh("b.msh", written);
        parsers::require(again.mesh.triangles.size() == file.mesh.triangles.size(),
                         "the mesh written is the mesh read");
      });
    }
  });
  return 0;
}
