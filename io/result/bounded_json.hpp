#pragma once
// result.json, which may be anybody's, as JSON.

#include "kerf/types.hpp"

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace kerf {

/// An object, of bounded length, of objects of at most 2,000 members, and with lists and objects within each other at
/// most so deep that whoever walks through it may recurse. Throws Error(Files) naming the path.
nlohmann::ordered_json read_json(const std::filesystem::path& path);

/// For a result that is none, or not whole.
Error damaged_result(const std::filesystem::path& path);

}  // namespace kerf
