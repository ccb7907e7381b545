#pragma once
// Files of a final design: a case of its own, and drawings.

#include "kerf/case_file.hpp"

namespace kerf {

/// What a design is made of besides the case that it comes from.
struct DesignFile {
  const Shape& shape;
  std::span<const CrackLaw> laws;     // per crack of the shape
  std::span<const Elastic> regions;   // per region of the shape
  std::vector<std::string> comments;  // lines at the top
};

/// A case file for `kerf solve`: the body of the design with the case's materials, conditions, loads, functional, mesh
/// and solver, numbers with 17 digits. [optimize] and what only it needs are left out, but for load cases, which need
/// it. `folder`: where the file will lie; names of other files are made relative to it. What it cannot say is said in
/// its comments.
std::string design_case(const Case& c, const DesignFile& design, const std::filesystem::path& folder);

/// Outline, holes, cracks and frozen loops with circular arcs as arcs; ellipses within 1e-4 of the extent as arcs.
std::string design_svg(const Shape& shape, std::span<const Loop> frozen, const std::string& title);

/// The same as DXF (AC1015): LWPOLYLINE with bulges on the layers outline, holes, cracks and frozen.
std::string design_dxf(const Shape& shape, std::span<const Loop> frozen);

}  // namespace kerf
