#pragma once
// Integrals over triangles and meshes that stay accurate at the tips of an exact field.

#include "kerf/model.hpp"
#include "kerf/state.hpp"
#include "tests/support/exact_field.hpp"

namespace kerf::exact {

using Triangle = std::array<Vec2, 3>;
/// Weights sum to the area. Points lie strictly inside: collapsed Gauss, or 12 x 12 in (r^1/2, angle) about a singular
/// vertex (-1: none).
struct Cubature {
  Points x;
  Eigen::VectorXd w;
};
Cubature cubature(const Triangle& triangle, int singular_vertex, int per_direction = 8);
/// The vertex of triangle t at which a tip of the field lies, or -1.
int singular_vertex(const Mesh& mesh, const ExactField& field, Index t);

double integrate(const Triangle& triangle, int singular_vertex, const std::function<double(const Vec2& x)>& f);
double l2_error_squared(const Triangle& triangle, int singular_vertex,
                        const std::function<Mat2(const Vec2&)>& difference);
/// Over a mesh; singular at the tips of the field, `side` is that of the triangle.
double integrate(const Mesh& mesh, const ExactField& field,
                 const std::function<double(Index triangle, int side, const Vec2& x)>& f);
/// L2 norm of field.stress - stress.
double stress_error(const Mesh& mesh, const ExactField& field, const std::function<Mat2(Index, const Vec2& x)>& stress);
double stress_error(const Model& model, const State& state, const ExactField& field);

}  // namespace kerf::exact
