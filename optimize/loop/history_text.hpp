#pragma once
// Rows of a history in a checkpoint.

#include "kerf/optimize.hpp"
#include "optimize/checkpoint.hpp"

namespace kerf {

/// With the separator between those that are not empty.
std::string join(const std::vector<std::string>& parts, const std::string& separator = "; ");
std::vector<std::string> split_lines(const std::string& text);

/// Under the keys "rows" and "notes", bit for bit.
void write_rows(Checkpoint& c, const std::vector<Iteration>& rows);
std::vector<Iteration> read_rows(const Checkpoint& c);

}  // namespace kerf
