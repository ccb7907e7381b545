#pragma once
// K x = F beyond the rounding of the assembled matrix: its factor as the preconditioner of conjugate gradients whose
// products run triangle by triangle [theory: E.19].

#include "solver/system/penalty.hpp"

namespace kerf {

/// The share of the energy x'K x that the rounding of K may take, as 4 eps sum K_ii x_i^2 / x'K x; a tenth of it in
/// slender bodies [theory: E.17].
double growth(const Model& m, const Eigen::VectorXd& x, double energy);
inline constexpr double most_growth = 5e-8;

class Refinement {
 public:
  /// Condenses every triangle and keeps what it gives.
  explicit Refinement(const Condensation& condensed) : condensed_(condensed), product_(condensed.m) {}

  /// F - K x per row; the other unknowns have the values `prescribed`, whose share is not in F.
  Eigen::VectorXd rest(const Eigen::VectorXd& F, const std::vector<double>& prescribed, const PenaltyIterate& s) const;

  /// Moves x on the rows that s.motion does not hold, until their rest is rounding. Returns the number of steps.
  int solve(const Eigen::VectorXd& F, const std::vector<double>& prescribed, PenaltyIterate& s) const;

 private:
  const Condensation& condensed_;
  Elementwise product_;
};

}  // namespace kerf
