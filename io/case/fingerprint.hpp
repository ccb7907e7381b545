#pragma once
// Whether two case files ask for the same optimization.

#include "io/case/reader.hpp"

namespace kerf {

/// 16 hexadecimal digits that depend on what the document says, overrides included, and on the files of measured data
/// in `folder`; not on its layout, the order of keys, title, probes, output and optimize.max_iterations.
std::string fingerprint(const Node& document, const std::filesystem::path& folder);

}  // namespace kerf
