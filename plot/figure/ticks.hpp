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

/// Powers of ten in [low, high], 0 < low < high: every one, or every second, fifth, ... so that no more than `at_most`
/// have labels; with less than two of them their multiples by 2 and 5 as well. `minor`: the other multiples 2 to 9 of
/// powers of ten, or the powers of ten that were passed over.
struct LogTicks {
  Ticks major;
  std::vector<double> minor;
};
LogTicks log_ticks(double low, double high, int at_most);

/// Significant digits with a proper minus and a raised exponent: "−1.5×10⁻⁶".
std::string pretty(double value, int digits = 6);

}  // namespace kerf
