#pragma once
// Densities and their derivatives averaged over discs.

#include "optimize/density/lattice.hpp"

namespace kerf {

/// Weights that fall linearly from a cell's center to a radius (in cells), times the shares of cells in the body.
/// Vectors have a number per cell of the lattice; cells outside of the body stay 0.
class LatticeFilter {
 public:
  LatticeFilter(const Lattice& lattice, double radius);

  Eigen::VectorXd average(const Eigen::VectorXd& x) const;
  /// The transpose of `average`: derivatives by the averages become derivatives by what was averaged.
  Eigen::VectorXd pull_back(const Eigen::VectorXd& derivative) const;
  /// Derivatives weighted by density and averaged, without a function of which they would be exact [Sigmund 1997].
  Eigen::VectorXd smooth_derivative(const Eigen::VectorXd& x, const Eigen::VectorXd& derivative) const;

 private:
  const Lattice& l_;
  std::vector<Index> start_, cell_;  // per cell of the body: those nearby
  std::vector<double> weight_;       // sums to 1 per cell
};

/// The mean of a function and its mirror image, where the image of a cell lies in the body.
class LatticeMirror {
 public:
  explicit LatticeMirror(const Lattice& lattice);
  Eigen::VectorXd symmetrized(const Eigen::VectorXd& x) const;

 private:
  const Lattice& l_;
  std::vector<std::array<std::pair<Index, double>, 4>> image_;  // per cell of the body; empty without a mirror
};

/// Bilinear between the centers of cells, constant beyond those at the border: four cells and their weights.
std::array<std::pair<Index, double>, 4> between_centers(Index columns, Index rows, const Vec2& x);

}  // namespace kerf
