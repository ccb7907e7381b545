#pragma once
// Geometries meshed by gmsh, through a module that is loaded when it is first needed.

#include "io/mesh/raw.hpp"
#include "io/mesh_source.hpp"

namespace kerf {

/// The mesh that gmsh makes of a geometry: as it is to be kept, or a coarse one of its outline together with its
/// curves. Throws Error(Files) without gmsh or without the file, Error(Geometry) with gmsh's words.
RawMesh mesh_geometry(const BodySource& source);

}  // namespace kerf
