#pragma once
// From the cells of a mesh to a body.

#include "io/mesh/raw.hpp"
#include "kerf/mesh_file.hpp"

namespace kerf {

/// Throws as read_mesh does. With RawMesh::curves the sides of the shape follow them.
MeshFile make_body(const RawMesh& raw, const MeshFileRequest& request);

}  // namespace kerf
