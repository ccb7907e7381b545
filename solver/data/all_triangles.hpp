#pragma once
// Data on many triangles.

#include "solver/data.hpp"

#include <functional>
#include <vector>

namespace kerf {

/// As triangle_values on each of these triangles; `size` is the largest of f on all of them. What is left in small ones
/// counts by their share of the area, and the looks at those that one look does not settle are shared out, so that a
/// field of which nothing can be proved costs a few looks per triangle.
std::vector<TriangleValues> triangle_values(const VectorField& f, const std::vector<Index>& which,
                                            const std::function<Triangle(Index)>& cell, const TriangleRule& rule,
                                            double size, const char* what, int threads);

}  // namespace kerf
