#pragma once
// Where a body comes from when it is not drawn in a case: a mesh, or a geometry that gmsh reads.

#include "kerf/mesh_file.hpp"

namespace kerf {

struct BodySource {
  std::filesystem::path path;
  bool keep_mesh = true;  // the mesh of the file, or that of gmsh
  double size = 0;        // of a mesh of gmsh; 0: what the geometry says
};

/// By the extension.
bool is_mesh_file(const std::filesystem::path& path);
bool is_geometry_file(const std::filesystem::path& path);

/// A mesh as read_mesh reads it, a geometry (.geo, .step, .stp, .brep, .iges) with gmsh. Throws as read_mesh does,
/// Error(Geometry) with gmsh's words, Error(Files) when gmsh is needed and cannot be had.
MeshFile read_body(const BodySource& source, const MeshFileRequest& request);

/// Whether the module with gmsh can be loaded; loads it.
bool has_gmsh();

/// A STEP file of the body as one plane face, its arcs exact, parts of ellipses as arcs within 1e-4 of its extent;
/// cracks and regions are left out. Throws Error(Geometry) with gmsh's words, Error(Files) without gmsh or a place for
/// a temporary file.
std::string step_file(const Shape& shape);

}  // namespace kerf
