// The chi-square distribution against closed forms for an even number of degrees and for one, and by simulation.

#include "base/chi_square.hpp"
#include "kerf/inverse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace kerf::chi_square_test {
namespace {

// For 2 m degrees 1 - P = e^-z sum_{k < m} z^k / k!, z = x/2; for one P = erf sqrt z.
TEST(ChiSquare, ClosedForms) {
  for (const double x : {1e-6, 0.1, 0.7, 1.0, 3.0, 10.0, 47.0, 120.0}) {
    const double z = x / 2;
    EXPECT_NEAR(chi_square_below(x, 1), std::erf(std::sqrt(z)), 1e-13) << x;
    double term = std::exp(-z), above = 0;
    for (int m = 1; m <= 40; ++m) {
      above += term;
      term *= z / m;
      EXPECT_NEAR(chi_square_below(x, 2 * m), 1 - above, 2e-13) << x << " with " << 2 * m;
    }
  }
  EXPECT_EQ(chi_square_below(0, 3), 0);
  EXPECT_EQ(chi_square_below(-1, 3), 0);
}

TEST(ChiSquare, QuantilesAreTheInverse) {
  EXPECT_NEAR(chi_square_quantile(0.95, 2), -2 * std::log(0.05), 1e-12);
  EXPECT_NEAR(chi_square_quantile(0.999, 1), 10.827566170662733, 1e-9);  // 3.2905^2
  for (const double freedom : {1.0, 2.0, 7.0, 100.0, 5000.0})
    for (const double p : {1e-6, 0.025, 0.5, 0.975, 0.999})
      EXPECT_NEAR(chi_square_below(chi_square_quantile(p, freedom), freedom), p, 1e-11) << freedom;
}

// Of 4000 sums of 12 squares as many lie below as should, to 4 deviations of their number.
TEST(ChiSquare, SumsOfSquaresOfNormalNumbers) {
  constexpr std::size_t sums = 4000, freedom = 12;
  const std::vector<double> z = normal_numbers(5, sums * freedom);
  for (const double p : {0.025, 0.5, 0.975, 0.999}) {
    const double limit = chi_square_quantile(p, freedom);
    double below = 0;
    for (std::size_t i = 0; i < sums; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < freedom; ++k) sum += std::pow(z[i * freedom + k], 2);
      below += sum <= limit;
    }
    EXPECT_NEAR(below / sums, p, 4 * std::sqrt(p * (1 - p) / sums)) << p;
  }
}

}  // namespace
}  // namespace kerf::chi_square_test
