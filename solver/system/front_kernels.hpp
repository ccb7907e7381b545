#pragma once
// Elimination in a dense front, by kernels of our own [theory: E.28].

#include "kerf/types.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace kerf {

/// A symmetric matrix of n rows, its columns one after the other from the diagonal down.
struct LowerHalf {
  static std::size_t size(Index n) {
    return static_cast<std::size_t>(n) * static_cast<std::size_t>(n + 1) / 2;
  }
  /// Where a column begins, on the diagonal, and where its row 0 would be.
  static std::int64_t start(Index n, Index column) {
    return place(n, column) + column;
  }
  static std::int64_t place(Index n, Index column) {
    return std::int64_t{column} * (2 * std::int64_t{n} - column - 1) / 2;
  }
};

/// A symmetric matrix in two parts, columns from the diagonal down: those to be eliminated, then what they leave.
struct FrontMatrix {
  Index height, width;
  double* panel;        // height x width
  double* rest;         // LowerHalf of height - width rows
  bool square = false;  // `rest` has all of its rows and columns, void above the diagonal

  /// Where row 0 of a column would be.
  double* column(Index k) const {
    if (k < width) return panel + std::int64_t{k} * height;
    const Index n = height - width, j = k - width;
    return rest + (square ? std::int64_t{j} * n : LowerHalf::place(n, j)) - width;
  }
};

/// Bodies 0 .. count - 1 in any order, or at once.
using Each = std::function<void(Index count, const std::function<void(Index)>& body)>;

/// Numbers that the elimination of a front so high needs beside it.
std::size_t packed_size(Index height);

/// The Cholesky factor of the first columns in their place, and the others less what follows from them. `packed`:
/// memory of packed_size. Each sum has one order, whatever `each` does. Returns whether all pivots are positive.
bool eliminate(const FrontMatrix& f, double* packed, const Each& each);

}  // namespace kerf
