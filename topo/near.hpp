#pragma once
// What lies nearest to a place, of what the mask of a map keeps clear of.

#include "kerf/functional.hpp"
#include "kerf/state.hpp"

namespace kerf {

/// Material: another one, or a jump of the data.
enum class Near : unsigned char { Nothing, Boundary, Crack, Material, Ring };

/// Per point, of what is nearer than `reach`; of the rings of functionals less `radius`.
std::vector<Near> nearest(const Model& model, const Functional& j, std::span<const Vec2> points, double reach,
                          double radius);

}  // namespace kerf
