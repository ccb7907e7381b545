#pragma once
// A body on square cells: how much of every cell lies in it, what holds and what loads it. In units of its own (lengths
// in cells, the stiffest material 1, the largest nodal force 1), rounded, so that the units of the body change no bit.

#include "optimize/level_set/background.hpp"

namespace kerf {

/// Nodes and cells are counted row by row from the low left corner: cell (i, j) is i + columns * j.
struct Lattice {
  Vec2 origin = Vec2::Zero();  // low left corner, in the body's units
  double cell = 0;             // edge of a cell, in the body's units
  Index columns = 0, rows = 0;
  Eigen::VectorXd part;        // per cell: share of it in the body
  Eigen::VectorXd mu, lambda;  // per cell, times the share: moduli of the plane material
  std::vector<Index> cells;    // with a share in the body
  std::vector<Index> inside;   // per cell: nearest one of `cells`
  std::vector<char> solid;     // per cell: it stays solid
  struct Spring {              // of a support, between two unknowns: 2 node + component
    Index first, second;
    double stiffness;
  };
  std::vector<Spring> springs;   // both orders of first and second
  Eigen::MatrixXd force;         // per unknown and load case: of tractions
  std::vector<Points> body;      // per load case and cell: body force on all of its part at density 1; or empty
  double compliance_unit = 1;    // of force . displacement, in the body's units
  double force_unit = 1;         // of nodal forces; stresses are multiples of it over the cell
  std::optional<Mirror> mirror;  // in cells

  Index nodes() const {
    return (columns + 1) * (rows + 1);
  }
  std::array<Index, 4> corners(Index c) const {  // counter-clockwise
    const Index low = c % columns + (columns + 1) * (c / columns);
    return {low, low + 1, low + columns + 2, low + columns + 1};
  }
  Vec2 center(Index c) const {  // in cells
    return {c % columns + 0.5, c / columns + 0.5};
  }
};

/// Of the frame with the supports and load cases of an optimization, with about that many cells inside: such that sides
/// parallel to the axes lie on lines of the lattice where that can be. What stays solid: closed areas, cells along
/// labels, discs. `cracks`: those that are not bonded become lines of weak cells; otherwise there are none.
Lattice make_lattice(const Problem& p, const OptimizeRequest& r, double cells, bool cracks = false);

/// Whether a frame has cracks that a lattice can draw.
bool has_cracks(const Problem& p);

/// Why the supports do not hold the body in place, or cannot be put on a lattice; or nothing.
std::optional<std::string> unsupported(const Lattice& lattice);

}  // namespace kerf
