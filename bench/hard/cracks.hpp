#pragma once
// Bodies with cracks that several families use.

#include "bench/hard/fields.hpp"

namespace kerf {

/// "[[crack]]"; `more`: further lines.
std::string crack(const std::string& name, const std::vector<Vec2>& path, const std::string& more = {});

/// One cell of a row of collinear cracks, spacing 2, under tension 1 across them [Westergaard 1939]: rollers on
/// the sides, K = sqrt(2 tan(pi a/2)). `mouths`: the cracks are cut in the middle, so that two tips face each other
/// across 2 (1 - half).
struct Cell {
  double half = 0.5;  // length of a crack
  bool mouths = false;
  double angle = 0, size = 0.25;  // turned by; of the mesh
  std::string mesh = {};          // more lines of [mesh]
};
HardCase collinear_cell(const Cell& cell);
/// The worst K_I of all tips, relative; infinite where one is missing.
double collinear_error(const Compared& c, double half);

/// A plate in the exact stress s22 = load x, all else 0 (in the frame), that no crack of it disturbs: of four cracks
/// those along y, the given share, touch without pressing, those along x lie where they are pressed.
HardCase touching(double share, const Placed& placed = {});
Eigen::Vector3d touching_stress(const Placed& placed, const Vec2& x);  // 11, 22, 12

/// The largest difference of K between all tips and those of the reference, over the largest K.
double tip_error(const Compared& c);

/// A square plate, -1 to 1, under tensions across x and y, held by them alone.
struct Tensions {
  double x = 0, y = 1;
};
HardCase plate(const std::string& cracks, const Tensions& tensions, double size, const std::string& solver = {});
/// Lines that make of it a finer computation with another element.
inline constexpr const char* other_element = "[solver]\nelement = \"afw\"\ndegree = 3\n";

}  // namespace kerf
