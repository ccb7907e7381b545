#pragma once
// What the exact fields are compared with and on: the tables of data, the meshes of elements.json.
// nlohmann-json lives in exact.cpp.

#include "tests/support/exact_field.hpp"
#include "tests/support/integral.hpp"

#include <array>
#include <filesystem>
#include <map>

namespace kerf::exact {

struct Row {
  std::string kind;
  Vec2 x;
  int side;
  Vec2 u;
  Mat2 stress;
  double rot, hole, poisson;  // rot = (d1 u2 - d2 u1)/2; poisson in the smooth tables, hole in the others
  Vec2 body;
};
struct Face {
  double s;
  Vec2 x;
  double jump_n, jump_t, sigma_n, sigma_t;
};
struct Table {
  std::vector<Row> rows;
  std::vector<Face> faces = {};
  std::map<std::string, double> scalars;                   // K, closure_point, ...
  std::vector<std::map<std::string, double>> per_nu = {};  // smooth tables: norms per Poisson's ratio
  double energy = 0;                                       // of [-2, 2]^2
  std::array<double, 4> work = {};                         // of the tractions on its bottom, right, top, left
};
Table read_table(const std::filesystem::path& folder, const std::string& id);

struct ElementRow {
  std::string element, bc, crack_case;  // bc "D" in the crack cases
  double poisson = 0.3;
  int n = 0;
  std::map<std::string, double> value;
  std::vector<std::vector<double>> jump_n_legendre, sigma_nn_legendre;  // per crack edge, on coarse meshes only
};
/// Section "smooth" or "crack" of elements.json.
std::vector<ElementRow> read_elements(const std::filesystem::path& file, const std::string& section);

/// `mesh_smooth` and `mesh_crack` of elements.json; labels 0 bottom, 1 right, 2 top, 3 left. Interior vertices off the
/// crack move by up to `jiggle` cells in x and in y. Crack 0 runs from (-1, 0) to (1, 0) before the turn; n = 4, 8, ...
Mesh unit_square_mesh(int n, double jiggle = 0, unsigned seed = 1);
Mesh crack_mesh(int n, double angle = 0, double jiggle = 0, unsigned seed = 1);

}  // namespace kerf::exact
