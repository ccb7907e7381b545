#pragma once
// Segments filed in square cells, to be found by what is near them.

#include "kerf/types.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace kerf {

/// What lies beyond the box around all segments counts to the cells at its rim.
struct Cells {
  Vec2 low;
  double width;  // of a cell
  int columns, rows;
  std::vector<Index> start, listed;  // cell i lists the segments listed[start[i]] ... listed[start[i + 1] - 1]

  int column(double x) const {
    return int(std::clamp((x - low.x()) / width, 0.0, columns - 1.0));
  }
  int row(double y) const {
    return int(std::clamp((y - low.y()) / width, 0.0, rows - 1.0));
  }
  std::span<const Index> at(int column, int row) const {
    const std::size_t cell = std::size_t(row) * std::size_t(columns) + std::size_t(column);
    return {listed.data() + start[cell], listed.data() + start[cell + 1]};
  }
};

/// Each segment in every cell that its box, widened by the margin, meets. Cells of the wanted width, wider ones if
/// there were more than `most` in a row.
Cells file(std::span<const std::array<Vec2, 2>> segments, double width, double margin, int most);

}  // namespace kerf
