#pragma once
// Parts of kerf that are loaded when they are first needed, because they bring a hundred libraries.

#include <filesystem>
#include <initializer_list>
#include <string>

namespace kerf {

/// The shared object `name` with these functions: beside the program (build tree), in ../lib/kerf (installed), beside the
/// library that this is part of (Python), or in `folder`, where it was built or installed (programs of others). It stays
/// loaded until the program ends. A null handle: `reason` says why there is none.
struct LoadedModule {
  void* handle = nullptr;
  std::string reason = {};
};
LoadedModule load_module(const char* name, const std::filesystem::path& folder,
                         std::initializer_list<const char*> functions);

}  // namespace kerf
