#pragma once
// Meshes of gmsh, read as bodies and written.

#include "kerf/mesh.hpp"
#include "kerf/shape.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// A name for the side of the boundary that is nearest to a point. `place`: what messages about it begin with.
struct NamedSide {
  Vec2 near;
  std::string name, place;
};

/// What is looked for in a mesh.
struct MeshFileRequest {
  std::vector<std::string> materials;  // physical surfaces of another material than the body
  std::vector<std::string> masks;      // physical surfaces whose outline is asked for
  std::vector<NamedSide> sides;
};

/// A mesh as it stands in a file, and the shape that it fills: straight sides between the corners of the mesh where its
/// boundary turns, arcs where it follows a curve. Labels, cracks and regions are numbered alike in both.
struct MeshFile {
  Mesh mesh;
  Shape shape;
  std::vector<Index> material;  // per region: of MeshFileRequest::materials, or none (the body's, enclosed by others)
  std::vector<Loop> masks;      // by name; a surface in several pieces has several
  std::vector<std::string> surfaces;  // names of all physical surfaces
  std::vector<std::string> notes;
};

/// The name of the sides that no physical curve has.
inline constexpr std::string_view unnamed_side = "unnamed";

/// Formats 2.x and 4.1 of gmsh, text or binary. Physical curves on the rim are labels; those named crack:<name> inside
/// are cracks, along which nodes may be doubled (gmsh's plugin Crack), and which must be simple paths; other curves
/// inside are left out with a note. A physical group without a name goes by its number; characters that names of kerf
/// cannot have become _. Of second order, edges of the rim, of cracks and between materials follow the curves of their
/// nodes. Throws Error(Geometry) naming file, element or node and point for what is no plane mesh of
/// triangles that meet edge to edge and make up one body; Error(Files) for what cannot be read; Error(Usage) for a
/// named side that is none.
MeshFile read_mesh(const std::filesystem::path& path, const MeshFileRequest& request = {});
/// The same of a file's content; `name` in messages.
MeshFile parse_mesh(std::string name, std::string_view bytes, const MeshFileRequest& request = {});

/// Formats of gmsh, as text.
enum class MshVersion { V4, V2 };  // 4.1, 2.2

/// A mesh with physical groups: labels, crack:<name> per crack, surfaces by the names of the regions and "body".
/// With curved edges of second order, their middles on the curves. read_mesh gives the same mesh, bit for bit with
/// straight edges, if that came from it. `shape`: what the numbers of the mesh count into.
/// Throws Error(Files) naming the path.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh, const Shape& shape,
                MshVersion version = MshVersion::V4);
/// What would stand in the file.
std::string msh_text(const Mesh& mesh, const Shape& shape, MshVersion version = MshVersion::V4);

}  // namespace kerf
