#pragma once
// What a mesh with curved edges may fail by.

#include "kerf/types.hpp"

namespace kerf {

/// A curved edge folds the triangle beside it, in whose middle that is.
struct FoldedTriangle : Error {
  explicit FoldedTriangle(const Vec2& at);
};

}  // namespace kerf
