// Cubics through points, monotone where the points are.

#include "growth/numeric/cubic.hpp"

#include <algorithm>
#include <cmath>

namespace kerf::growth {

namespace {

// The slope at x[at] of the polynomial through x[first .. last].
double slope_of_polynomial(std::span<const double> x, std::span<const double> y, int first, int last, int at) {
  double slope = 0;
  for (int j = first; j <= last; ++j) {
    if (j == at) continue;
    // l_j'(x_at) = w_j/(w_at (x_at - x_j)) by barycentric weights, and the sum of all l' is 0.
    double ratio = 1;
    for (int k = first; k <= last; ++k)
      if (k != j && k != at) ratio *= (x[at] - x[k]) / (x[j] - x[k]);
    slope += ratio * (y[j] - y[at]) / (x[j] - x[at]);
  }
  return slope;
}

double cut(double slope, double before, double after) {
  const double most = 3 * std::min(std::abs(before), std::abs(after));
  if (before * after > 0 && slope * before < 0) return 0;
  return std::clamp(slope, -most, most);
}

}  // namespace

MonotoneCubic::MonotoneCubic(std::span<const double> x, std::span<const double> y)
    : x_(x.begin(), x.end()), y_(y.begin(), y.end()), slope_(x.size(), 0) {
  const int n = static_cast<int>(x.size());
  if (n < 2) return;
  const auto secant = [&](int i) { return (y[i + 1] - y[i]) / (x[i + 1] - x[i]); };
  for (int i = 0; i < n; ++i) {
    const int first = std::clamp(i - 2, 0, std::max(0, n - 5)), last = std::min(first + 4, n - 1);
    const double slope = slope_of_polynomial(x, y, first, last, i);
    slope_[i] = cut(slope, secant(std::max(i - 1, 0)), secant(std::min(i, n - 2)));
  }
}

double MonotoneCubic::operator()(double x) const {
  if (x <= x_.front()) return y_.front();
  if (x >= x_.back()) return y_.back();
  const auto i = std::upper_bound(x_.begin(), x_.end(), x) - x_.begin() - 1;
  const double h = x_[i + 1] - x_[i], t = (x - x_[i]) / h, rise = y_[i + 1] - y_[i];
  const double bend = h * slope_[i] - rise, other = rise - h * slope_[i + 1];
  return y_[i] + t * rise + t * (1 - t) * ((1 - t) * bend + t * other);
}

std::vector<std::size_t> every_second(std::size_t n) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i + 1 < n; i += 2) kept.push_back(i);
  if (n % 2 == 0 && kept.size() > 1) kept.pop_back();
  kept.push_back(n - 1);
  return kept;
}

}  // namespace kerf::growth
