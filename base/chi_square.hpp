#pragma once
// The chi-square distribution: how large the sum of squares of independent standard normal numbers may be.

namespace kerf {

/// P(X <= x) where X is the sum of `freedom` squares; freedom > 0, 0 for x <= 0. To about 1e-14.
double chi_square_below(double x, double freedom);

/// The x that X stays below with probability p, 0 < p < 1: chi_square_below(x, freedom) = p.
double chi_square_quantile(double p, double freedom);

}  // namespace kerf
