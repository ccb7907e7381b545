#pragma once
// Where the data of an expansion jump.

#include "kerf/functional.hpp"
#include "kerf/model.hpp"

#include <utility>
#include <vector>

namespace kerf {

/// Segments along the lines across which the densities of J (weights, targets), the body force or an eigenstrain within
/// a region jump: from crossing to crossing of the edges of the mesh, each crossing found by bisection of quarters of
/// an edge. What lies between two samples, a quarter of an edge apart, is not seen. A crossing that has no other in its
/// triangles is a segment of no length.
std::vector<std::pair<Vec2, Vec2>> jumps_of_data(const Model& m, const Functional& j);

}  // namespace kerf
