#pragma once
// Facts of a key that the documents say and the reader does not need: its unit, and what refuses it.

#include "io/case/keys.hpp"

#include <string_view>

namespace kerf {

/// Whether a value of the key holds numbers.
bool is_numeric(const Key& key);

/// "length", "stress"; "none" for a pure number; empty where no row says it, or where the key holds no numbers.
std::string_view unit_of(const Key& key);

/// Jobs, elements and other keys that refuse the key or its value; empty: none beyond the rules of keys.hpp.
std::string_view refused_with(const Key& key);

}  // namespace kerf
