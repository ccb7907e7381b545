#pragma once
// Which way something with an orientation lies.

#include "kerf/perturbation.hpp"
#include "topo/formulas/parts.hpp"

#include <functional>

namespace kerf {

/// The same direction in [0, pi).
double in_half_turn(double angle);

/// M = sum factor (s t symmetrized), e.M e = sum factor (s e).(t e) for every unit vector e.
PlaneParts squares(std::span<const Product> products);

/// Where e.M e is largest, in [0, pi); it is least across.
double axis(const PlaneParts& m);

/// Where f is largest over half a turn, by this many samples and golden sections beside the best.
double largest_over_angles(const std::function<double(double angle)>& f, int samples);

}  // namespace kerf
