#pragma once
// The report of an inspection on one page.

#include "io/result.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace kerf {

/// Of a result with edge cracks. `picture`: bytes of a PNG, or nothing.
std::string inspection_page(const Result& result, const std::string& case_text, std::string_view picture);

/// Throws Error(Files) naming the path.
void write_inspection(const std::filesystem::path& path, const Result& result, const std::string& case_text,
                      std::string_view picture);

}  // namespace kerf
