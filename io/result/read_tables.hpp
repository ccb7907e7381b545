#pragma once
// The tables of a run, read back.

#include "io/result.hpp"

namespace kerf {

/// The rows of crack_<name>.csv; none where the file is not there. Throws Error(Files) where it is no such table.
void read_crack_rows(const std::filesystem::path& path, CrackResult& crack);

/// The rows of history.csv; none where the file is not there.
std::vector<Iteration> read_history(const std::filesystem::path& path, const OptimizeNames& names);

}  // namespace kerf
