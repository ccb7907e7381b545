#pragma once
// Roots and largest values of functions of one variable, by bisection and golden sections: slow, and never wrong where
// a sign changes.

namespace kerf::growth {

/// Where f changes its sign in [low, high], as exactly as doubles say it: f(low) and f(high) have different signs, or
/// the end with the smaller value of |f| is taken. `f(x)`: double.
template <class Function>
double root(const Function& f, double low, double high) {
  const double at_low = f(low), at_high = f(high);
  if (at_low == 0) return low;
  if (at_high == 0) return high;
  if ((at_low > 0) == (at_high > 0)) return (at_low > 0 ? at_low < at_high : at_low > at_high) ? low : high;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) return middle;
    const double value = f(middle);
    if (value == 0) return middle;
    ((value > 0) == (at_low > 0) ? low : high) = middle;
  }
}

/// Where f is largest in [low, high], if it has one maximum there, by golden sections down to `width` [unit of x].
template <class Function>
double maximizer(const Function& f, double low, double high, double width) {
  constexpr double golden = 0.6180339887498949;
  double left = high - golden * (high - low), right = low + golden * (high - low);
  double at_left = f(left), at_right = f(right);
  while (high - low > width) {
    if (at_left < at_right) {
      low = left, left = right, at_left = at_right;
      right = low + golden * (high - low), at_right = f(right);
    } else {
      high = right, right = left, at_right = at_left;
      left = high - golden * (high - low), at_left = f(left);
    }
  }
  return 0.5 * (low + high);
}

}  // namespace kerf::growth
