#pragma once
// Many short lists in one array.

#include "kerf/types.hpp"

#include <span>
#include <vector>

namespace kerf {

/// Items filed under keys 0 .. count - 1.
struct Lists {
  std::vector<Index> start, items;
  std::span<const Index> operator[](Index key) const {
    return {items.data() + start[key], static_cast<std::size_t>(start[key + 1] - start[key])};
  }
};

/// Item i under key[i], nowhere when that is none; each list in increasing order.
Lists file_under(Index count, const std::vector<Index>& key);

}  // namespace kerf
