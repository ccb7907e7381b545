#pragma once
// Address space before it is taken.

#include <cstddef>

namespace kerf {

/// Whether so many bytes can be had at once now. For libraries that use what malloc gave without looking, or ask for it
/// for ever.
bool has_address_space(std::size_t bytes);

}  // namespace kerf
