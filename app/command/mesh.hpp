#pragma once
// `kerf mesh`: the mesh of a case as a file for other programs.

#include "kerf/case_file.hpp"

namespace kerf {

/// Meshes the body, or takes the mesh that it comes with, and writes it: .msh with physical groups (`format` "4.1" or
/// "2.2"), .vtu with a field per group. Returns what to print. Throws Error(Usage) for another ending,
/// Error(Geometry | Files).
std::string write_mesh_of(const Case& c, const std::filesystem::path& path, const std::string& format);

/// Throws as write_mesh_of does for an ending that it does not know.
void require_mesh_ending(const std::filesystem::path& path);

}  // namespace kerf
