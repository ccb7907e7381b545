#pragma once
// Rules for powers that are singular at an end.

#include "base/quadrature.hpp"

namespace kerf {

/// Gauss points for the weight s^exponent on [0, 1], exponent > -1 [Golub, Welsch 1969].
EdgeRule gauss_jacobi(double exponent, int points);

}  // namespace kerf
