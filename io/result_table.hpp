#pragma once
// result.json as one row of a table.

#include <filesystem>
#include <string>
#include <vector>

namespace kerf {

/// "state.energy" "-0.65": numbers as they stand in the file, words as they are, nothing for null.
struct Leaf {
  std::string name, value;
  bool is_number = false;
};

/// Of a result.json, in its order: numbers and words with their paths, entries of lists by their name or number. Left
/// out: lists of numbers longer than a point, what is no result (schema, version, notes) and all times but the total.
/// Throws Error(Files) when it cannot be read.
std::vector<Leaf> leaves_of_result(const std::filesystem::path& path);

}  // namespace kerf
