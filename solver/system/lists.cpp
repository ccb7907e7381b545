// Counting sort of items by their keys into one array.

#include "solver/system/lists.hpp"

#include <numeric>

namespace kerf {

Lists file_under(Index count, const std::vector<Index>& key) {
  Lists lists;
  lists.start.assign(count + 1, 0);
  for (const Index k : key)
    if (k != none) ++lists.start[k + 1];
  std::partial_sum(lists.start.begin(), lists.start.end(), lists.start.begin());
  lists.items.resize(lists.start.back());
  std::vector<Index> next(lists.start.begin(), lists.start.end() - 1);
  for (Index i = 0; i < static_cast<Index>(key.size()); ++i)
    if (key[i] != none) lists.items[next[key[i]]++] = i;
  return lists;
}

}  // namespace kerf
