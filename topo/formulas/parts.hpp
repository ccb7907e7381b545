#pragma once
// A plane tensor by its mean and its deviator.

#include "kerf/types.hpp"

namespace kerf {

/// s = mean I + [[x, y], [y, -x]], of the symmetric part.
struct PlaneParts {
  double mean, x, y;
};
inline PlaneParts split(const Mat2& s) {
  return {0.5 * s.trace(), 0.5 * (s(0, 0) - s(1, 1)), 0.5 * (s(0, 1) + s(1, 0))};
}

inline Mat2 symmetric_part(const Mat2& s) {
  return 0.5 * (s + s.transpose());
}

}  // namespace kerf
