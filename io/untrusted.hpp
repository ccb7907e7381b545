#pragma once
// Cases of strangers: what they may name.

#include <filesystem>
#include <span>
#include <string>

namespace kerf {

/// Of kerf --untrusted. Throws Error(Usage), as file:line:column, where a case or a design that it names asks for more
/// than regular files within its own folder, which no link leads to, no script of gmsh among them, and no options of
/// PETSc.
void require_own_files(const std::filesystem::path& case_file, std::span<const std::string> overrides);

}  // namespace kerf
