#pragma once
// Where the marks of an axis go and what they say.

#include <string>
#include <vector>

namespace kerf {

struct Ticks {
  std::vector<double> at;
  std::vector<std::string> labels;
  std::string note;  // what every label is to be multiplied by or added to ("×10⁻⁶"); usually empty
};

/// Round numbers (1, 2 or 5 times a power of ten apart) in [low, high], no more than `at_most` >= 2 where two would do.
/// Large and small numbers share one power of ten; an interval far from zero shares an offset.
Ticks ticks(double low, double high, int at_most);

/// Significant digits with a proper minus and a raised exponent: "−1.5×10⁻⁶".
std::string pretty(double value, int digits = 6);

}  // namespace kerf
