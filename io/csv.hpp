#pragma once
// Cells of comma-separated tables.

#include <fmt/format.h>

#include <string>

namespace kerf {

/// The shortest text that reads back to the same bits; nothing for what is not finite.
void append_cell(fmt::memory_buffer& out, double value);

/// In quotes where the text needs them.
std::string csv_text(const std::string& text);

}  // namespace kerf
