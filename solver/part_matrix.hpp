#pragma once
// What a process has of the system of a divided body: the sum of its own condensed triangles.

#include "kerf/types.hpp"

#include <string_view>
#include <vector>

namespace kerf {

/// K_p, assembled from the triangles of a process, onto the unknowns that these see.
struct PartMatrix {
  Index rows = 0;
  std::vector<Index> number;          // of its rows among all
  std::vector<Index> start, columns;  // K_p, both triangles, sorted
  std::vector<double> values;
  std::vector<double>
      shear;  // per row the shear moduli of its triangles: the size of K_p where nothing is incompressible
  // For each row that other parts may share those of its own edge and of edges that meet it on one side of all cracks.
  std::vector<Index> near_start, near_rows;
  Index owned = 0;  // unknowns
};
/// Condenses the triangles of a packed part (solver/system/parted.hpp packs them).
PartMatrix condensed_part(std::string_view packed);
/// Of K_p.
double largest_diagonal(const PartMatrix& part);

}  // namespace kerf
