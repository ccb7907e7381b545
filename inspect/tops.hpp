#pragma once
// The worst of many places: tops, none of which lies beside a worse place.

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace kerf::inspect {

/// Places with K > 0 by falling K, ten at most. A place beside a worse one is no top, nor is one beside that. `beside`
/// says of two places whether they are neighbors.
template <class Beside>
std::vector<std::size_t> tops_of(const std::vector<double>& K, const Beside& beside) {
  constexpr std::size_t most = 10;
  std::vector<std::size_t> order(K.size()), tops;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !(K[i] > 0); });
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return K[a] > K[b]; });
  for (std::size_t n = 0; n < order.size() && tops.size() < most; ++n)
    if (std::none_of(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n),
                     [&](std::size_t k) { return beside(k, order[n]); }))
      tops.push_back(order[n]);
  return tops;
}

}  // namespace kerf::inspect
