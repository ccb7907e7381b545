#pragma once
// The case as it was run, to lie beside its results.

#include "kerf/case_file.hpp"

namespace kerf {

/// A case file with its overrides, numbers with all their digits; what it names in other files lies in the folder
/// input beside it. Read alone it gives the same case.
struct KeptCase {
  std::string text;
  std::vector<std::pair<std::string, std::string>> files;  // name under the folder of the case, contents
};

/// `head`: lines of its comment. Throws Error(Files) where a file that the case names cannot be read any more.
KeptCase keep(const Case& c, const std::vector<std::string>& head);

/// The same of a file that is not read as a case: keys may be wrong, and geometries are only copied.
KeptCase keep_file(const std::filesystem::path& path, std::span<const std::string> overrides);

}  // namespace kerf
