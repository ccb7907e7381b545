#pragma once
// A result from the files of its folder.

#include "io/result.hpp"

namespace kerf {

/// What result.json, history.csv and crack_<name>.csv say; nothing that stands in none of them. Throws Error(Files)
/// naming the file: it is not there, or it is none that kerf has written.
Result read_result(const std::filesystem::path& folder);

}  // namespace kerf
