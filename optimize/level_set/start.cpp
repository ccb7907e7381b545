// Discs of a start: columns of rows, every second one shifted by half a row, and random ones from the bits of mt19937.

#include "optimize/level_set/start.hpp"

#include <random>

namespace kerf {

// In columns that begin on a half row the first and last discs lie within the box, in the others on its border.
std::vector<Disc> start_discs(const StartHoles& start, const Vec2& low, const Vec2& high) {
  std::vector<Disc> discs;
  const Vec2 size = high - low;
  for (int i = 0; i < start.columns; ++i) {
    const double shift = i % 2 == 0 ? 0.5 : 0;  // of a row
    for (int k = 0; k < start.rows + (shift == 0 ? 1 : 0); ++k)
      discs.push_back(
          {low + Vec2((i + 0.5) / start.columns, (k + shift) / start.rows).cwiseProduct(size), start.radius});
  }
  std::mt19937 bits(start.seed);  // its bits are fixed by the standard, those of the distributions are not
  const auto uniform = [&bits] { return (static_cast<double>(bits()) + 0.5) / 4294967296.0; };
  for (int i = 0; i < start.random; ++i) {
    const double x = uniform(), y = uniform();
    discs.push_back({low + Vec2(x, y).cwiseProduct(size), start.radius});
  }
  return discs;
}

}  // namespace kerf
