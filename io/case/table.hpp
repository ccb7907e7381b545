#pragma once
// Comma-separated tables that a case file refers to.

#include "io/case/fields.hpp"

#include <filesystem>

namespace kerf {

/// A file whose first line names its columns; those in `wanted` are taken, in that order, others are left alone. At
/// least one row. Throws Error(Files) naming the place of `field` when the file cannot be read, Error(Usage) naming the
/// line in the file.
std::vector<std::vector<double>> read_table(const std::filesystem::path& path, const Value& field,
                                            const std::vector<std::string>& wanted);

}  // namespace kerf
