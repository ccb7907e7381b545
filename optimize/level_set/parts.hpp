#pragma once
// Connected parts of the material of a level set.

#include "optimize/level_set/background.hpp"

#include <span>

namespace kerf {

std::span<const Index> neighbors(const BackgroundMesh& b, Index v);

struct MaterialParts {
  std::vector<Index> of;     // per vertex its part; none in the void
  std::vector<Index> first;  // per part one of its vertices
};
/// Vertices with phi < 0 that hang together; with `kind` (per vertex) through vertices of their own kind.
MaterialParts material_parts(const BackgroundMesh& b, const Eigen::VectorXd& phi, std::span<const char> kind);

/// Per vertex, whether it lies on an edge with one of the labels.
std::vector<char> vertices_on(const BackgroundMesh& b, std::span<const Index> labels);

/// Makes parts void. `gone`: per part.
void empty_parts(const BackgroundMesh& b, const MaterialParts& parts, const std::vector<char>& gone,
                 Eigen::VectorXd& phi);

/// Pieces of material that touch none of the labels turned into void, so that they do not count as area; without labels
/// all but the largest piece.
void drop_islands(const BackgroundMesh& b, std::span<const Index> labels, Eigen::VectorXd& phi);

}  // namespace kerf
