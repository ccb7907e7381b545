#pragma once
// A PNG made small, for pages that travel with the sources.

#include <filesystem>

namespace kerf {

/// The picture `from` at `width` pixels, in fewer colors, as `to`. Throws Error(Files) naming the path.
void shrink(const std::filesystem::path& from, const std::filesystem::path& to, int width);

}  // namespace kerf
