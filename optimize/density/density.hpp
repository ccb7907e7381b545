#pragma once
// The coarse density stage: where material should be at all, on a lattice and within a second, for the level set to
// begin with.

#include "kerf/optimize.hpp"

namespace kerf {

/// A density on a lattice over the frame's bounding box: what a coarse run ends with.
struct DensityDesign {
  Vec2 origin = Vec2::Zero();  // low left corner
  double cell = 0;             // edge of a cell
  Index columns = 0, rows = 0;
  Eigen::VectorXd density;     // per cell, row by row from the low left corner, 0 to 1; those outside of the frame as
                               // the nearest inside
  double compliance = 0;       // J (and the price of area) of the design made black and white at `volume_fraction`, by
                               // the lattice: comparable between the designs of a problem
  double volume_fraction = 0;  // the one wanted; less where less is better or bounds on the compliance allow it
  double filter = 0;           // radius in cells
  int steps = 0;
  std::string name;  // "density, filter 1.4"; "density of the compliance, ..." where J is something else
};

/// Edge of the lattice's cells where no finer members are asked for.
double lattice_cell(const Shape& frame);

/// At a place: bilinear between the centers of cells.
double density_at(const DensityDesign& d, const Vec2& x);

/// Why there is no density stage for a problem, or nothing.
std::optional<std::string> no_density_stage(const Problem& p, const OptimizeRequest& r);

/// A design per way of filtering, best first (those that keep the bounds before those that do not). What the lattice
/// does not know (norms of stresses, energy release rates, tracking) gets designs of least compliance instead, if the
/// area is bounded. Of a frame with cracks one design takes them for lines of weak cells, one leaves them out; both are
/// judged with them. p.threads run them side by side; the same bits for any number of threads.
/// Throws Error(Usage) where there is no density stage, Error(Numerics) when the lattice cannot be solved.
std::vector<DensityDesign> density_designs(const Problem& p, const OptimizeRequest& r);

}  // namespace kerf
