#pragma once
// Groups of numbers as bars from zero, as a PNG.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace kerf {

struct Bar {
  std::string name;
  double value = 0;  // not below zero; what is not finite is left out
  std::string text;  // beside the bar
  std::size_t style = 0;
};

struct BarGroup {
  std::string title;
  std::vector<Bar> bars;
};

struct BarChart {
  std::string title, subtitle, x_label;
  std::vector<BarGroup> groups;
};

/// Throws Error(Files) naming the path.
void draw(const std::filesystem::path& path, const BarChart& chart);

}  // namespace kerf
