#pragma once
// Adaptive integration: the piece with the largest error is cut.

#include "solver/data/known.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace kerf {

/// A piece of a domain in one or two coordinates, which are those of one of its `whole` parts.
struct IntegrationPiece {
  std::size_t whole = 0;
  std::array<double, 2> from{0, 0}, to{1, 1};
  double value = 0, error = 0, size = 0;
  bool sampled = false;
};

/// Cuts the piece with the largest error, until their sum is small beside the sum of the sizes.
/// `most`: evaluations, whatever is left then.
template <typename Evaluate, typename Cut>
Known refined(std::vector<IntegrationPiece> pieces, int most, const Evaluate& evaluate, const Cut& cut) {
  constexpr double tolerance = 1e-10;
  for (IntegrationPiece& p : pieces) evaluate(p);
  int evaluations = static_cast<int>(pieces.size());
  const auto smaller = [](const IntegrationPiece& a, const IntegrationPiece& b) { return a.error < b.error; };
  std::make_heap(pieces.begin(), pieces.end(), smaller);
  for (;;) {
    Known known;
    double size = 0;
    for (const IntegrationPiece& p : pieces) {
      known.value += p.value;
      known.error += p.error;
      size += p.size;
      known.sampled = known.sampled || p.sampled;
    }
    if (evaluations >= most || !(known.error > tolerance * size)) return known;
    // A tenth of them at once: the sums cost as much as the pieces.
    const std::size_t batch = 1 + pieces.size() / 10;
    std::vector<IntegrationPiece> worst;
    for (std::size_t i = 0; i < batch; ++i) {
      std::pop_heap(pieces.begin(), pieces.end(), smaller);
      worst.push_back(pieces.back());
      pieces.pop_back();
    }
    for (const IntegrationPiece& p : worst)
      for (IntegrationPiece part : cut(p)) {
        evaluate(part);
        ++evaluations;
        pieces.push_back(part);
        std::push_heap(pieces.begin(), pieces.end(), smaller);
      }
  }
}

}  // namespace kerf
