#pragma once
// The designs that numbers draw, for optimizers that are not kerf's: J, constraints, and their exact derivatives.

#include "kerf/optimize.hpp"

#include <memory>
#include <string>
#include <vector>

namespace kerf {

/// What is known of a design. Constraints are to be at most 0, and relative: 1 is a large violation.
struct DesignValues {
  double value = nan;           // what is minimized: J, weighted over load cases, and the price of the area
  Eigen::VectorXd gradient;     // by the variables; empty where it was not asked for
  Eigen::VectorXd constraints;  // volume, bounds, then those that keep it meshable
  Eigen::MatrixXd jacobian;     // constraints x variables; empty where it was not asked for
  double objective = nan, volume_fraction = nan;
  std::vector<double> bounds;  // of the bounded functionals, the worst load case
  int triangles = 0;
  std::string failure = {};  // why the body cannot be drawn, meshed or solved; the values are then not numbers
};

/// Designs evaluated one after the other. The mesh of an earlier design is moved along, so that values are smooth in
/// the variables and derivatives exact; where it would suffer it is made anew, which shifts values by what it errs.
class DesignSpace {
 public:
  /// Throws Error(Usage) for what cannot be optimized so: a level set, a start that is read off a map.
  DesignSpace(Problem problem, OptimizeRequest request);
  ~DesignSpace();
  DesignSpace(const DesignSpace&) = delete;
  DesignSpace& operator=(const DesignSpace&) = delete;

  const std::vector<std::string>& names() const;        // of the variables: "h.x", "h.y", "h.radius"
  const std::vector<std::string>& constraints() const;  // what is wrong when it is violated, in words
  const Eigen::VectorXd& lower() const;
  const Eigen::VectorXd& upper() const;
  const Eigen::VectorXd& start() const;
  /// Throws Error(Usage) where x has another length, is not finite or lies outside of its bounds (by more than
  /// rounding), or where derivatives are asked for and the element has none.
  DesignValues evaluate(const Eigen::VectorXd& x, bool gradients);
  /// From now on meshes are made anew.
  void forget_meshes();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
