#pragma once
// Displacements measured at points along the boundary, as a field.

#include "io/case/fields.hpp"
#include "kerf/scene.hpp"
#include "kerf/shape.hpp"

#include <filesystem>

namespace kerf {

/// From a table with the columns x,y,u_x,u_y: linear along the polyline through its points in the order of the file,
/// taken at the nearest place of it. Throws Error(Usage), here for the shape's edges of that label and later for any
/// point asked for, where the data are further away than 1 % of the extent of the body.
BoundaryField read_measured(const std::filesystem::path& path, const Value& field, const Shape& shape, Index label);

}  // namespace kerf
