#pragma once
// What a function says at the vertices of a mesh, and where it changes its sign between them.

#include "geometry/carve/rim.hpp"

namespace kerf {

/// Throws std::invalid_argument unless the function has a finite value at each vertex of the mesh.
void require_fit(const Mesh& mesh, const Eigen::VectorXd& phi);

/// An edge whose ends have two signs is crossed.
struct Signs {
  std::vector<char> inside;
  std::vector<double> magnitude;  // of the function; -1 where the sign was turned: crossed as near as can be
  std::vector<double> clear;      // per vertex, how far crossings keep away from it (on short edges less)
};
Signs signs_of(const Mesh& mesh, const Eigen::VectorXd& phi);

inline bool crossed(const Mesh& mesh, const Signs& signs, Index edge) {
  const auto& [a, b] = mesh.edges[std::size_t(edge)];
  return signs.inside[std::size_t(a)] != signs.inside[std::size_t(b)];
}

/// Where a crossed edge is crossed: the part of its length from edges[e][0]. With and without keeping clear.
double exact_crossing(const Mesh& mesh, const Signs& signs, Index edge);
double crossing(const Mesh& mesh, const Signs& signs, Index edge);

/// Area inside, with crossings where crossing() says.
double inside_area(const Mesh& mesh, const Signs& signs, Index triangle);

/// The place of a crossing. On curved strands and cracks it lies on the curve.
Vec2 place(const Block& block, const Signs& signs, Index edge);

/// Turns signs within the tolerance until boundaries keep apart: necks, slits, cracks that the zero line nearly
/// reaches. Throws Error(Geometry) where the zero line reaches a region.
void clean(const Block& block, Signs& signs, std::vector<std::string>& notes);

/// Drops the pieces of material that are not wanted, fills small holes. Throws Error(Geometry).
void choose_pieces(const Block& block, Signs& signs, std::vector<std::string>& notes);

}  // namespace kerf
