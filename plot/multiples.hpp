#pragma once
// Small multiples as a PNG: one small chart per family, errors on a common logarithmic axis, values side by side.

#include "kerf/types.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace kerf {

/// What became of a value: a good answer; one that says how bad it is; none, and why; a failure.
enum class MultipleMark { Good, Told, Refused, Bad };

struct MultiplePoint {
  std::string label;                // below the axis
  double value = nan, limit = nan;  // positive; not a number: not drawn
  MultipleMark mark = MultipleMark::Good;
};

struct Multiple {
  std::string title, x_label;
  std::vector<MultiplePoint> points;  // from the left
};

struct Multiples {
  std::string title, subtitle;
  double least = 1e-16, most = 10;  // of the common axis; what lies beyond is drawn at its end
  std::vector<Multiple> panels;
};

/// Throws Error(Files) naming the path.
void draw(const std::filesystem::path& path, const Multiples& multiples);

}  // namespace kerf
