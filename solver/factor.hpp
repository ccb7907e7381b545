#pragma once
// A factorized sparse symmetric matrix. CHOLMOD lives in factor.cpp and nowhere else.

#include "solver/system/lu.hpp"

#include <memory>
#include <vector>

namespace kerf {

/// Fill-reducing order of the nodes of an undirected graph (nested dissection, METIS), postordered. `start` and
/// `neighbors` list the neighbors of each node, both directions, without the node itself. Returns order[k] = node
/// k-th to be eliminated.
std::vector<Index> dissection(const std::vector<Index>& start, const std::vector<Index>& neighbors);

/// Gives what was freed back to the system: the ordering leaves holes that no later block fits into.
void return_freed_memory();

/// P' K P = L L' by CHOLMOD (supernodal), in the order in which K comes; the last `trailing` columns stay last, so that
/// the trailing block of L is the Cholesky factor of the Schur complement onto them. A matrix that is not definite goes
/// to UMFPACK, without trailing columns.
class Factor {
 public:
  /// Runs on one thread: OpenBLAS with two gives other bits. Throws Error(Numerics) naming the first bad column when K
  /// is not positive definite (Error::what says "column N"), or when memory runs out.
  /// `kept` further columns before the trailing ones stay there.
  Factor(const LowerTriangle& lower, Index trailing, bool definite = true, Index kept = 0);
  ~Factor();
  Factor(Factor&&) noexcept;
  Factor& operator=(Factor&&) noexcept;

  /// S = D - B K^-1 B' on the trailing columns, dense: read off the factor.
  Eigen::MatrixXd schur_complement() const;

  /// Halves of a solve: y = L^-1 P' b, x = P L^-T y. The tail of y belongs to the trailing columns (in K's order):
  /// tail = (factor of S)^-1 (condensed right-hand side).
  Eigen::VectorXd forward(const Eigen::VectorXd& b) const;
  Eigen::VectorXd backward(const Eigen::VectorXd& y) const;
  Eigen::MatrixXd backward(const Eigen::MatrixXd& y) const;  // column by column, at less than their price
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

  /// Lower triangular trailing block of L.
  const Eigen::MatrixXd& trailing_factor() const;
  /// The same for the kept and the trailing columns together, and their Schur complement.
  const Eigen::MatrixXd& kept_factor() const;
  Eigen::MatrixXd kept_complement() const;

  double entries() const;  // nonzeros of L
  double flops() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
