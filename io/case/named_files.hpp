#pragma once
// Where a case names other files. A key that does so has its line here and nowhere else.

#include "io/case/reader.hpp"

#include <functional>

namespace kerf {

/// Whether the text under this key ("functional.measured", "probe[].file") is the name of a file, relative to the case.
bool names_file(std::string_view key, const std::string& text);

/// Every such text of a document.
void for_each_file(Node& document, const std::function<void(Node& name)>& see);

}  // namespace kerf
