#pragma once
// Where the regions of a shape meet, and cracks along their borders: interfaces.

#include "kerf/shape.hpp"

namespace kerf {

/// The curves along which two regions of the shape meet, or a region and what lies outside all regions (`none`), as
/// cracks without names: polylines and arcs, the region on their left, closed where the border is (the last point is
/// the first, or the arc a full turn). They end on the outline, on holes, and where a third region comes in.
std::vector<Crack> seams(const Shape& shape, Index region, Index other);

/// Whether regions share sides, or parts of them, with each other, the outline or holes.
bool regions_touch(const Shape& shape);

/// The first crack that crosses or ends on the border of a region, or none.
Index crack_on_border(const Shape& shape);

/// Per crack of the shape, whether it is made of sides of regions, from corner to corner inside the body.
std::vector<bool> along_regions(const Shape& shape);

}  // namespace kerf
