#pragma once
// Bodies side by side as a PNG, those of a row to the same scale.

#include "kerf/types.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace kerf {

using Polyline = std::vector<Vec2>;

struct GalleryPanel {
  std::string title, caption;
  std::vector<Polyline> body;             // closed loops, material where an odd number of them lies around
  std::vector<Polyline> frame;            // thin closed lines: what the body could have filled
  std::vector<Polyline> supports, loads;  // strong lines along the boundary
  bool accent = false;                    // a color of its own
};

struct GalleryRow {
  std::string title;
  std::vector<GalleryPanel> panels;
  double scale = 1;  // against the other rows
};

struct Gallery {
  std::string title, subtitle;
  std::vector<GalleryRow> rows;
};

/// Panels follow one another from the left, on as many lines as they need. Throws Error(Files) naming the path.
void draw(const std::filesystem::path& path, const Gallery& gallery);

}  // namespace kerf
