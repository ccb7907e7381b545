// The distribution of chi-square by the incomplete gamma function,
//   P(a, z) = 1/Gamma(a) int_0^z t^(a-1) e^-t dt,   a = freedom/2, z = x/2,
// by its series z^a e^-z sum_n z^n / Gamma(a + n + 1) for z < a + 1, where terms fall, and else by the continued
// fraction of 1 - P [Abramowitz, Stegun 1964, 6.5.29 and 6.5.31]. Quantiles by bisection, which needs no derivative and
// ends at neighboring numbers.

#include "base/chi_square.hpp"

#include <cmath>

namespace kerf {

namespace {

constexpr int most_terms = 10000;
constexpr double last_digit = 1e-16;

/// z^a e^-z / Gamma(a).
double gamma_density(double a, double z) {
  return std::exp(a * std::log(z) - z - std::lgamma(a));
}

double gamma_series(double a, double z) {
  double term = 1 / a, sum = term;
  for (int n = 1; n < most_terms && term > last_digit * sum; ++n) sum += term *= z / (a + n);
  return sum * gamma_density(a, z);
}

// Lentz's way: b0 = z + 1 - a, then numerators n (a - n) and denominators that grow by 2.
double gamma_fraction(double a, double z) {
  constexpr double tiny = 1e-300;
  double b = z + 1 - a, c = 1 / tiny, d = 1 / b, value = d;
  for (int n = 1; n < most_terms; ++n) {
    const double numerator = n * (a - n);
    b += 2;
    d = 1 / (numerator * d + b);
    c = b + numerator / c;
    value *= c * d;
    if (std::abs(c * d - 1) < last_digit) break;
  }
  return value * gamma_density(a, z);
}

}  // namespace

double chi_square_below(double x, double freedom) {
  if (!(x > 0)) return 0;
  const double a = 0.5 * freedom, z = 0.5 * x;
  return z < a + 1 ? gamma_series(a, z) : 1 - gamma_fraction(a, z);
}

double chi_square_quantile(double p, double freedom) {
  double low = 0, high = freedom;
  while (chi_square_below(high, freedom) < p) high *= 2;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (chi_square_below(middle, freedom) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace kerf
