#pragma once
// Files that appear under their name complete or not at all. The only place of kerf that writes into a folder, gmsh's
// geometries (io/mesh/gmsh_module.cpp) aside.

#include <filesystem>
#include <string_view>

namespace kerf {

enum class Flush { Buffers, Disk };  // Disk: there after a power cut, too

/// Through "<path>.part" beside it, which is new in any case: what lies there under that name (of a run that was
/// killed, a link or a pipe that somebody put there) is removed, never followed or opened. 0, or what errno says; then
/// nothing is left of it, and what `path` held stays.
[[nodiscard]] int write_whole_file(const std::filesystem::path& path, std::string_view bytes, Flush flush);

}  // namespace kerf
