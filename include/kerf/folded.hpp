#pragma once
// What a mesh with curved edges may fail by.

#include "kerf/types.hpp"

namespace kerf {

/// A curved edge folds the triangle beside it.
struct FoldedTriangle : Error {
  explicit FoldedTriangle(const std::string& what) : Error(Fault::Numerics, what) {}
};

}  // namespace kerf
