#pragma once
// Taylor coefficients of a solved field at a point.

#include "kerf/state.hpp"
#include "topo/formulas/second_term.hpp"

#include <Eigen/Cholesky>

namespace kerf {

/// The nearest state of Kolosov's potentials of degree 6 to the element's own stress over a disc, in the mean of
/// squares with the weight (1 - r^2/radius^2)^2: nearly Fourier means over circles. Averages the error of
/// the element over the disc.
class TaylorFit {
 public:
  /// x in triangle t; no feature lies in the disc.
  TaylorFit(const Model& m, const Vec2& x, Index t, double radius);

  /// Too few triangles to tell the coefficients from the error of the element.
  bool coarse() const;
  const std::vector<Index>& triangles() const {
    return use_;
  }
  TaylorField of(const Field& s) const;

 private:
  const Model& m_;
  Vec2 at_;
  double radius_;
  std::vector<Index> use_;
  Eigen::LDLT<Eigen::MatrixXd> fit_;
};

}  // namespace kerf
