#pragma once
// Free elliptic holes in an orthotropic plane.

#include "topo/formulas/axes.hpp"

namespace kerf {

/// H(s, t) = t : (mean strain of the hole under s) [Lekhnitskii 1968; Tsukrov, Kachanov 2000; theory: O.16]. `shape`:
/// with the columns e of the longer and f of the shorter axis e e'/aspect + f f' aspect; I for a circle. s, t
/// symmetric.
double orthotropic_hole_form(const Material& m, const Mat2& shape, const Mat2& s, const Mat2& t);

/// The sum of factor s L^-1 t, which takes the part of `squares` for ellipses.
PlaneParts orthotropic_squares(const Material& m, std::span<const Product> products);

}  // namespace kerf
