#pragma once
// Where a small change is too close to something else.

#include "kerf/functional.hpp"
#include "kerf/state.hpp"

namespace kerf {

/// Per point whether it lies nearer than `clear` to the boundary, a crack or another material, or within `radius` of
/// the ring of a functional.
std::vector<bool> too_close(const Model& model, const Functional& j, std::span<const Vec2> points, double clear,
                            double radius);

/// The same in numbers: distance less `clear`, negative for what is too close; at most `reach` - `clear`.
struct MaskReach {
  double clear, radius, reach;
};
std::vector<double> margins(const Model& model, const Functional& j, std::span<const Vec2> points, const MaskReach& c);

}  // namespace kerf
