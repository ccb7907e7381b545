#pragma once
// Lines on two logarithmic axes as a PNG for a paper: errors against times, sizes, counts. Or values on a linear one.

#include "kerf/types.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace kerf {

struct Series {
  std::string name;
  std::vector<Vec2> points;  // joined in this order; what is not finite and positive on a logarithmic axis is left out
  bool dashed = false, dotted = false;
  std::size_t style = 0;       // color and marker
  bool marked_at_end = false;  // no markers but at the last point
};

/// A thin line of y ~ x^exponent in a corner away from the data.
struct Slope {
  double exponent;
  std::string name;
};

struct Chart {
  std::string title, subtitle, x_label, y_label;
  std::vector<Series> series;  // named in the legend unless they have no points to draw
  std::vector<Slope> slopes;
  bool linear_y = false;
};

/// Throws Error(Files) naming the path.
void draw(const std::filesystem::path& path, const Chart& chart);

}  // namespace kerf
