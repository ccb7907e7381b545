#pragma once
// Files that appear under their name complete or not at all. The only place of kerf that writes into a folder, gmsh's
// geometries (io/mesh/gmsh_module.cpp) aside: names are looked up from folders that were opened, never through a link.

#include <filesystem>
#include <string_view>

namespace kerf {

enum class Flush { Buffers, Disk };  // Disk: there after a power cut, too

/// Through "<path>.part" beside it, which is new in any case: what lies there under that name (of a run that was
/// killed, a link or a pipe that somebody put there) is removed, never followed or opened. 0, or what errno says; then
/// nothing is left of it, and what `path` held stays.
[[nodiscard]] int write_whole_file(const std::filesystem::path& path, std::string_view bytes, Flush flush);

/// The same of `name` beneath a folder. Folders in the name are made where they are missing; one that is a link is no
/// folder (ENOTDIR), and no name leads out (EINVAL). The folder itself is the word of the user and may be a link.
[[nodiscard]] int write_whole_file(const std::filesystem::path& folder, const std::filesystem::path& name,
                                   std::string_view bytes, Flush flush);

/// A folder of that name beneath another, made where it is missing. 0, or what errno says.
[[nodiscard]] int make_folder_beneath(const std::filesystem::path& folder, const std::filesystem::path& name);

/// An empty file to write into as one goes on, in place of what lies there under the name: a descriptor, or -errno.
[[nodiscard]] int new_file(const std::filesystem::path& folder, const std::filesystem::path& name);

}  // namespace kerf
