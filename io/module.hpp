#pragma once
// Files that belong to kerf and lie beside it. Some are parts of it that are loaded when they are first needed, because
// they bring a hundred libraries.

#include <filesystem>
#include <initializer_list>
#include <string>

namespace kerf {

/// The file `name` of kerf: beside the program (build tree), in ../lib/kerf (installed), beside the library that this
/// is part of (Python), or in `folder`, where it was built or installed (programs of others). Empty: it is nowhere.
std::filesystem::path find_beside(const char* name, const std::filesystem::path& folder = {});

/// A program of the system, from the PATH; parts of it that are no absolute paths do not count. Empty: there is none.
std::filesystem::path find_program(const char* name);

/// The shared object `name` with these functions, from the same places: absolute paths alone, never the folder where
/// the user stands. It stays loaded until the program ends. A null handle: `reason` says why there is none.
struct LoadedModule {
  void* handle = nullptr;
  std::string reason = {};
};
LoadedModule load_module(const char* name, const std::filesystem::path& folder,
                         std::initializer_list<const char*> functions);

}  // namespace kerf
