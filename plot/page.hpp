#pragma once
// The report page.

#include "io/result.hpp"

namespace kerf {

/// One self-contained page: numbers, tables, and the given PNG files embedded; validate.png, evolution.png and
/// history.png in the sections of their own. Opens without a network.
void write_page(const std::filesystem::path& path, const Result& result,
                const std::vector<std::pair<std::string, std::filesystem::path>>& pictures);

}  // namespace kerf
