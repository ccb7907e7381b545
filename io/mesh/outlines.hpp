#pragma once
// From edges to what is drawn: loops around triangles, their straight sides, paths of cracks.

#include "kerf/mesh.hpp"
#include "kerf/shape.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace kerf {

/// An edge of a triangle, from a to b, the triangle on its left.
struct HalfEdge {
  Index a, b, edge, triangle;
};
using RimLoop = std::vector<HalfEdge>;
using RimLoops = std::vector<RimLoop>;

/// The loops around the triangles of a set, these on the left: first the one that encloses most, the others in the
/// order of their first triangles.
RimLoops trace(const Mesh& mesh, const std::function<bool(Index triangle)>& in_set);

double signed_area(const Mesh& mesh, const RimLoop& loop);

/// Straight sides, as long as they can be within the tolerance and one label (of edges).
std::vector<Side> sides_of(const Mesh& mesh, const RimLoop& loop, const std::vector<Index>& label, double tolerance);

/// Edges put in order from end to end, `along`: whether a line of the file runs from the smaller vertex to the larger;
/// the path begins where its first line does. `why`: what makes them no path, in words, or empty.
std::vector<CrackEdge> path_of(const Mesh& mesh, const std::vector<std::pair<Index, bool>>& along, std::string& why);

/// The vertices of a path.
std::vector<Vec2> points_of(const Mesh& mesh, const std::vector<CrackEdge>& path);

/// Which of the points of an open line are its ends and corners: the others lie within the tolerance of what is left.
std::vector<std::size_t> corner_places(const std::vector<Vec2>& line, double tolerance);

}  // namespace kerf
