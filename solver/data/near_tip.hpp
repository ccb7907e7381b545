#pragma once
// Integrals along the faces of a crack whose integrand is singular like 1/sqrt(r) at the tip.

#include "kerf/field.hpp"
#include "solver/data/known.hpp"

#include <functional>
#include <vector>

namespace kerf {

/// int_0^l p w dr/sqrt(r) of the first component of p along a straight face, r from its end a, l to its end b. `w` is
/// analytic in sqrt(r) but at `breaks`. Of p that grows like a power above -1/2 of r at a, too [theory: D.5].
Known over_face(const BoundaryField& p, const EdgeLine& face, std::vector<double> breaks,
                const std::function<double(double r)>& w);

}  // namespace kerf
