#pragma once
// Elimination in a dense front, by kernels of our own [theory: E.28].

#include "kerf/types.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace kerf {

/// A symmetric matrix in two parts, columns from the diagonal down: those to be eliminated, then what they leave.
struct FrontMatrix {
  Index height, width;
  double* panel;  // height x width
  double* rest;   // (height - width)^2

  /// Where row 0 of a column would be.
  double* column(Index k) const {
    return k < width ? panel + std::int64_t{k} * height
                     : rest + std::int64_t{k - width} * (height - width) - width;
  }
};

/// Bodies 0 .. count - 1 in any order, or at once.
using Each = std::function<void(Index count, const std::function<void(Index)>& body)>;

/// Numbers that the elimination of a front so high needs beside it.
std::size_t packed_size(Index height);

/// The Cholesky factor of the first columns in their place, and the others less what follows from them. Above the
/// diagonal `rest` is void after it. `packed`: memory of packed_size. Each sum has one order, whatever `each` does.
/// Returns whether all pivots are positive.
bool eliminate(const FrontMatrix& f, double* packed, const Each& each);

}  // namespace kerf
