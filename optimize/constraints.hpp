#pragma once
// The constraints of an optimization, measured on the design as it is drawn.

#include "kerf/optimize.hpp"

namespace kerf {

/// What is known of a design at the end besides its shape.
struct MeasuredDesign {
  const Shape& shape;
  const Shape* frame = nullptr;         // of a level set: what its keys are measured against; none: of numbers
  double volume_fraction = nan;         // as the loop has it: of designs of numbers
  std::span<const double> bounds = {};  // values of the bounded functionals, as they are judged
};

/// Every constraint that was asked for: volume, bounds, and regions that stay void, and of a level set frozen regions,
/// local thickness of members and gaps, mirror images. Exact for lines and circles: regions to 1e-9 of the size, images
/// to 1e-12.
std::vector<KeptConstraint> constraints_of(const MeasuredDesign& design, const OptimizeRequest& r);

/// How far the void of a design reaches into a region that stays solid, a length: the depth of its free boundary there,
/// and of points of the region that are void. `at`: where.
struct Intrusion {
  double depth = 0;
  Vec2 at = Vec2::Zero();
  double share = 0;  // of the region's area in the frame that is void, by samples
};
Intrusion intrusion(const Shape& design, const Shape& frame, const Loop& frozen);

/// The same of the solid of a design in a region that stays void.
Intrusion solid_in(const Shape& design, const Loop& keep_out);

/// The largest distance of the boundary of a body from its mirror image, and where.
struct Asymmetry {
  double distance = 0;
  Vec2 at = Vec2::Zero();
};
Asymmetry asymmetry(const Shape& body, const Mirror& mirror);

inline constexpr double kept_thickness = 0.98;  // of what was asked

/// What no design may do, whatever it costs: it is not kept, and it is a region that stays solid or void, or the
/// mirror.
bool is_broken(const KeptConstraint& c);

/// Those that are not kept, in words: "conflict: min_feature = 0.2, but a member is 0.12 thick at (1, 2)". `of_shape`:
/// without volume and bounds.
std::string conflicts(const std::vector<KeptConstraint>& all, bool of_shape);

}  // namespace kerf
