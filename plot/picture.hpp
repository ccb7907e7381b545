#pragma once
// A field on triangles as a PNG one would show to a colleague. Cairo is included by pen.hpp alone.

#include "kerf/types.hpp"
#include "kerf/units.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace kerf {

enum class Scale {
  Linear,     // viridis-like, from the clipped minimum to the clipped maximum
  Diverging,  // blue - white - red, symmetric about 0
};

/// A line over everything else.
struct Trace {
  std::vector<Vec2> line;
  std::uint32_t rgb = 0;
  double width = 3;
  bool dashed = false;
};

struct Picture {
  std::string title, subtitle;
  std::vector<Vec2> points;                     // where to draw (displaced already, if at all)
  std::vector<std::array<Index, 3>> triangles;  // into `points`
  Eigen::Matrix3Xd values;                      // per triangle its three corner values; no columns: mesh only
  Eigen::Matrix3Xd margin;                      // like `values`: gray where it is negative; no columns: nowhere
  std::string value_label;                      // beside the color bar
  std::optional<Dimension> dimension = {};      // of the values
  Units units = {};
  Scale scale = Scale::Linear;
  double clip = 0.005;  // share of the area whose values may lie beyond each end of the color bar
  std::optional<std::array<double, 2>> range = {};  // what lies beyond has the color of its end
  bool edges = false;                               // draw the edges of the triangles
  std::vector<std::vector<Vec2>> outlines;          // thin dark lines: boundary
  std::vector<std::vector<Vec2>> interfaces;        // thin colored lines: between materials
  std::vector<std::vector<Vec2>> cracks;            // strong lines; one per face when displaced
  std::vector<std::pair<Vec2, std::string>> marks;  // small labeled crosses
  std::vector<std::pair<Vec2, std::string>> names;  // the same without crosses

  // Of a drawing of the body without values.
  bool solid = false;                                // one color, no triangles; cracks red
  std::uint32_t color = 0x2f3d4c;                    // that one
  std::vector<std::vector<Vec2>> supports, rollers;  // the body to the left; all or one component held
  std::vector<std::array<Vec2, 2>> arrows;           // loads: from, to
  std::vector<Trace> traces;
};

/// Bytes that its points, triangles and values take.
std::size_t held(const Picture& picture);

/// Throws Error(Files) naming the path. Values that are not finite are drawn in gray.
void draw(const std::filesystem::path& path, const Picture& picture);

}  // namespace kerf
