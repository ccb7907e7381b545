#pragma once
// Solves with a factor that is kept in single precision.

#include "solver/factor.hpp"

#include <memory>

namespace kerf {

/// Half the memory of a Factor: K = L L' is found in double precision and rounded to single when it is stored;
/// conjugate gradients on K with it for a preconditioner give back the digits [theory: E.32]. The factor of what is
/// left on the last `contact_rows` rows stays in double precision. Nothing where that does not pay, tried on `b`:
/// bodies thousands of times as long as wide. Throws std::bad_alloc.
std::unique_ptr<LeadingSolver> rounded(std::shared_ptr<const LowerTriangle> K, Index contact_rows,
                                       const Eigen::VectorXd& b, int threads);

}  // namespace kerf
