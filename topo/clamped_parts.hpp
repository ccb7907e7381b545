#pragma once
// Maps of clamped holes of a body that processes have in parts: Green's tensor of the body is smooth, and that of the
// mesh before it was divided serves all of them.

#include "kerf/map.hpp"

#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace kerf {

struct GreenOfBody;

/// Of a body on the mesh before it was divided: samples for the map everywhere (theory: T.31), and the tensor at the
/// listed points themselves. Throws Error(Usage) for what has no map of clamped holes, and for functionals that take an
/// integral over the whole body per point.
std::shared_ptr<const GreenOfBody> green_of_body(const Analysis& a, const Functional& j, const MapRequest& r,
                                                 std::span<const Vec2> points);

std::string packed(const GreenOfBody& green);
std::shared_ptr<const GreenOfBody> green_from(std::string_view packed);

/// Maps of `a`, of a part of the body, look there: elsewhere than at these points they interpolate.
void take_green(std::shared_ptr<const GreenOfBody> green, Analysis& a);

}  // namespace kerf
