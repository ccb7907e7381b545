#pragma once
// Meshes whose triangles are divided (kerf/mesh.hpp refine), known before any is.

#include "kerf/element.hpp"
#include "kerf/mesh.hpp"

namespace kerf {

/// Throws FoldedTriangle where a curved edge folds a triangle beside it, of the mesh or of one that it is divided into.
void check_division(const Mesh& mesh, const Element& e, int divisions);

}  // namespace kerf
