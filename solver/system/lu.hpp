#pragma once
// A factorized sparse symmetric matrix that need not be definite. UMFPACK lives in lu.cpp and nowhere else.

#include "solver/system/sparse.hpp"

#include <memory>

namespace kerf {

/// P A Q = L U by UMFPACK with its own order, on one thread. Throws Error(Numerics) when the matrix is singular or
/// memory runs out.
class Lu {
 public:
  explicit Lu(const LowerTriangle& lower);
  ~Lu();
  Lu(Lu&&) noexcept;
  Lu& operator=(Lu&&) noexcept;

  /// Two steps of iterative refinement at most.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
