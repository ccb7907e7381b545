#pragma once
// The mesh of a case, for who wants no more of it.

#include "kerf/case_file.hpp"

namespace kerf {

/// That of `kerf mesh`, with which a run begins: of the body, or the one that it comes with, divided as mesh.refine
/// asks. A run may mesh anew at the ends of contact and where mesh.adapt asks. Throws Error(Geometry).
Mesh mesh_of_run(Case c);

}  // namespace kerf
