#pragma once
// Displacements measured at points along the boundary, as a field.

#include "io/case/fields.hpp"
#include "kerf/scene.hpp"
#include "kerf/shape.hpp"

#include <filesystem>

namespace kerf {

struct MeasuredField {
  BoundaryField value;
  std::vector<std::string> notes;  // what of the label was not covered, what of the file was not used
};

/// From a table with the columns x,y,u_x,u_y in any order of its lines. Each reading belongs to the nearest place of
/// the boundary; between corners (turns of more than 0.3) and mouths of cracks the field is linear in the arc length
/// from reading to reading, and goes on straight beyond the outer ones. A stretch between corners with less than two
/// readings goes with the one beside it. Throws Error(Usage) where the outer readings are further from the end of a
/// stretch of the label than 1 % of the extent of the body and the largest spacing of its readings, where the boundary
/// leaves the straight line between neighbors by more than that 1 %, and later for points further from the boundary.
MeasuredField read_measured(const std::filesystem::path& path, const Value& field, const Shape& shape, Index label);

}  // namespace kerf
