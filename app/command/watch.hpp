#pragma once
// A case that is checked again whenever its file is saved.

#include <filesystem>
#include <span>
#include <string>

namespace kerf {

/// Reads the case whenever its file or a file beside it that it may name has changed, prints what kerf check prints or
/// what is wrong, and keeps both with check.png in `folder`, which is there, as watch.html, a page that loads itself
/// anew every second. Ends when a stop is asked for. Throws Error(Files) where the case is not there to begin with, or
/// the page cannot be written.
void watch_case(const std::filesystem::path& file, std::span<const std::string> overrides,
                const std::filesystem::path& folder);

}  // namespace kerf
