#pragma once
// What a series of finite radii says about an expansion, and what a change drawn on another mesh adds.

#include "kerf/validate.hpp"

namespace kerf {

/// Orders, fit and the verdict of the series alone, from rows with J, difference and predicted filled in (NaN: not
/// computed), `coefficient`, `size`, `plateau` and `modes`. `scale` per row: f(eps); `clear` is the distance to the
/// next feature. Where the verdict is Holds or Fails, `drawn.radius` is the radius to draw, `drawn.rest` what the
/// series says beyond T there, and `drawn.apart` what it says of T. [theory: V.7, V.8]
void judge(Validation& v, const Perturbation& p, const std::vector<double>& scale, double clear);

/// What neither holds nor vanishes is out of range where the smallest radius computed is no small part of the radius at
/// which the body answers by as much stress as there was (SecondOrders::answer_radius; NaN: not known), and that is far
/// smaller than `clear`, the distance to the next feature: the series has not begun there. [theory: V.11]
void withdraw(Validation& v, double answer_radius, double clear);

/// The verdict with `on_mesh` and `drawn` filled in but for its intercept; `area` of what was drawn, `clamped`: no
/// series. [theory: V.9]
void conclude(Validation& v, double area, bool clamped);

}  // namespace kerf
