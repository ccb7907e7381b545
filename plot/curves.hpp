#pragma once
// Quantities against a common axis as a PNG: panels below one another.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kerf {

struct Curve {
  std::string name;                  // in the legend of its panel; empty: not there
  std::vector<double> values;        // one per place on the axis; what is not finite makes a gap
  std::optional<double> limit = {};  // a dashed line of the same color
};

struct Panel {
  std::string label;
  std::vector<Curve> curves;
  bool logarithmic = false;  // then what is not positive makes a gap
  double share = 1;          // of the height
};

struct Curves {
  std::string title, subtitle, x_label;
  std::vector<double> x;  // ascending
  std::vector<Panel> panels;
  std::vector<double> upper;  // a second scale along the upper edge: what belongs to each x; empty: none
  std::string upper_label;
};

/// Throws Error(Files) naming the path.
void draw(const std::filesystem::path& path, const Curves& curves);

/// Positive, and the largest more than thirty times the smallest.
bool wants_logarithm(const std::vector<double>& values);

}  // namespace kerf
