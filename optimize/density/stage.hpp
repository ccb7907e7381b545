#pragma once
// A problem as a lattice knows it.

#include "optimize/density/density.hpp"
#include "optimize/density/simp.hpp"

namespace kerf {

/// The problem in the units of its lattice.
struct DensityStage {
  Lattice lattice;
  LatticeGoal goal;
  bool surrogate = false;  // the compliance instead of functionals that the lattice does not know
};
/// With about that many cells in the body; `cracks`: as lines of weak cells.
DensityStage density_stage(const Problem& p, const OptimizeRequest& r, double cells, bool cracks = false);

/// Why a lattice would answer wrongly, or has no minimum; or nothing.
std::optional<std::string> no_stage(const Problem& p, const OptimizeRequest& r, const DensityStage& s);

/// With 2.5 cells across the thinnest member that is asked for.
double density_cells(const Problem& p, const OptimizeRequest& r);

/// Cells outside the body have the density of the nearest one inside, for interpolation.
DensityDesign on_all_cells(const Lattice& l, const Densities& found);

}  // namespace kerf
