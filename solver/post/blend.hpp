#pragma once
// Linear blending over a triangle.

#include "solver/recover_stress.hpp"

namespace kerf {

/// Twice the areas that a point of a triangle makes with its edges, each under the number of the corner across: `of`
/// over `whole` are its barycentric coordinates.
struct Shares {
  std::array<double, 3> of;
  double whole;
};
Shares shares_at(const Mesh& mesh, const PointIn& at);

}  // namespace kerf
