#pragma once
// `kerf bench hard` as a page and a picture.

#include "bench/hard.hpp"

namespace kerf {

/// Markdown: a table of the families, and one of all rows.
std::string hard_page(const HardBench& bench);

/// Small multiples: the error of each family against its knob.
void draw_hard_plot(const std::filesystem::path& path, const HardBench& bench);

}  // namespace kerf
