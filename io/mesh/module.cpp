#include "io/module.hpp"

#include <dlfcn.h>

#include <algorithm>
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
  if (Dl_info here{}; dladdr(reinterpret_cast<const void*>(&load_module), &here) != 0 && here.dli_fname)
    places.push_back(std::filesystem::path(here.dli_fname).parent_path() / name);
  if (!folder.empty()) places.push_back(folder / name);
  return places;
}

}  // namespace

std::filesystem::path find_beside(const char* name, const std::filesystem::path& folder) {
  std::error_code unknown;
  for (const auto& place : places_beside(name, folder))
    if (std::filesystem::exists(place, unknown)) return place;
  return {};
}

LoadedModule load_module(const char* name, const std::filesystem::path& folder,
                         std::initializer_list<const char*> functions) {
  std::vector<std::filesystem::path> places = places_beside(name, folder);
  places.insert(places.begin(), name);
  LoadedModule found;
  for (const auto& place : places) {
    void* handle = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) {
      // Of three reasons the one that is not "no such file" says most.
      const std::string why = dlerror();
      if (found.reason.empty() || why.find("cannot open shared object file") == std::string::npos) found.reason = why;
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
