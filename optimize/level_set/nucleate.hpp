#pragma once
// Where new holes lower J, how large they are cut, and what was drawn of them.

#include "optimize/level_set/background.hpp"
#include "optimize/level_set/hole_terms.hpp"

namespace kerf {

struct Nucleation {
  double multiplier = 0;       // price of area: holes where T < multiplier
  double area = 0;             // of all new holes
  double least = 0, most = 0;  // radius
  bool resolved = true;        // only where the mesh resolves the second term, if there is one
};

/// T at the centroids of a mesh, and both terms at points of it.
struct HolesIn {
  const Mesh& mesh;
  const Eigen::VectorXd& T;
  std::function<HoleTerms(const Vec2& x)> terms;
};

/// Discs at the least T first, each of the radius that gains most, but at most a third of the distance to the boundary,
/// to what is frozen and to the other discs, where the expansion still ranks points; none where that is too small or
/// the mesh does not resolve the second term. Where the design is its own mirror image, so are the discs. `distance` as
/// by signed_distance.
std::vector<Disc> places_to_nucleate(const BackgroundMesh& background, const Eigen::VectorXd& distance,
                                     const HolesIn& body, const Nucleation& how);

/// What a shape has of discs that were cut: centroid and radius of the hole drawn around the center of each, or in the
/// note why it is none of its own.
std::vector<NucleatedHole> drawn_holes(std::span<const Disc> discs, const Shape& shape);

}  // namespace kerf
