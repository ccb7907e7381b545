// Modules (shared libraries) and files beside the program: found from the program's own place, never from the folder
// where the user stands, and checked for the functions that they must have.

#include "io/module.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <system_error>
#include <vector>

namespace kerf {

namespace {

std::vector<std::filesystem::path> places_beside(const char* name, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> places;
  std::error_code code;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", code);
  if (!code) {
    places.push_back(program.parent_path() / name);
    places.push_back(program.parent_path().parent_path() / "lib" / "kerf" / name);
  }
  // Of a program this is argv[0], a name without a folder or one that somebody chose.
  if (Dl_info here{}; dladdr(reinterpret_cast<const void*>(&load_module), &here) != 0 && here.dli_fname)
    places.push_back(std::filesystem::path(here.dli_fname).parent_path() / name);
  places.push_back(folder / name);
  std::erase_if(places, [](const auto& place) { return !place.is_absolute(); });  // nothing from where the user stands
  return places;
}

}  // namespace

std::filesystem::path find_beside(const char* name, const std::filesystem::path& folder) {
  std::error_code unknown;
  for (const auto& place : places_beside(name, folder))
    if (std::filesystem::exists(place, unknown)) return place;
  return {};
}

std::filesystem::path find_program(const char* name) {
  const char* path = std::getenv("PATH");
  std::istringstream parts(path ? path : "");
  for (std::string part; std::getline(parts, part, ':');) {
    const std::filesystem::path place = std::filesystem::path(part) / name;
    if (place.is_absolute() && access(place.c_str(), X_OK) == 0) return place;
  }
  return {};
}

LoadedModule load_module(const char* name, const std::filesystem::path& folder,
                         std::initializer_list<const char*> functions) {
  LoadedModule found{.reason = std::string(name) + " is not beside the program"};
  for (const auto& place : places_beside(name, folder)) {
    if (std::error_code none; !std::filesystem::exists(place, none)) continue;
    void* handle = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) {
      found.reason = dlerror();
      continue;
    }
    if (std::all_of(functions.begin(), functions.end(), [&](const char* f) { return dlsym(handle, f); })) {
      found.handle = handle;
      return found;
    }
    found.reason = place.string() + " is not the module " + name + " of this program";
    dlclose(handle);
  }
  return found;
}

}  // namespace kerf
