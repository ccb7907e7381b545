#pragma once
// Whole files at once. A file appears under its name complete or not at all.

#include <filesystem>
#include <string>
#include <string_view>

namespace kerf {

/// Through a temporary file beside `path` that is renamed. Throws Error(Files) naming the path and the reason.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// Throws Error(Files) naming the path and the reason.
std::string read_file(const std::filesystem::path& path);

}  // namespace kerf
