#pragma once
// A factorized sparse symmetric matrix.

#include "kerf/types.hpp"
#include "solver/effort.hpp"
#include "solver/system/lu.hpp"
#include "solver/system/multifrontal.hpp"

#include <memory>
#include <span>
#include <vector>

namespace kerf {

/// Fill-reducing order of the nodes of an undirected graph (nested dissection, METIS), postordered. `start` and
/// `neighbors` list the neighbors of each node, both directions, without the node itself. Returns order[k] = node
/// k-th to be eliminated. The same for any number of threads, in every program.
std::vector<Index> dissection(const std::vector<Index>& start, const std::vector<Index>& neighbors, int threads = 1);

/// The BLAS and OpenMP on one thread each, from here on: processes and threads of kerf share the cores themselves.
void use_one_thread();

/// Solves with the rows of a matrix that no contact law acts on, by other means than a factor.
class LeadingSolver {
 public:
  virtual ~LeadingSolver() = default;
  virtual Eigen::VectorXd solve(const Eigen::VectorXd& b) const = 0;
  virtual SolverEffort effort() const = 0;
  /// The lower Cholesky factor of S.
  virtual const Eigen::MatrixXd& contact_factor() const = 0;
};

/// P' K P = L L' by CHOLMOD's analysis and a numeric phase of our own, in the order in which K comes: rows
/// in contact last, before them those of an interface. The last block of L is the Cholesky factor of the Schur
/// complement S = D - B K^-1 B' onto its rows. A matrix that is not definite goes to UMFPACK, without such rows.
class Factor {
 public:
  /// The same bits for any number of threads. Throws LostDefiniteness when K is not positive definite, std::bad_alloc
  /// when memory runs out.
  Factor(const LowerTriangle& lower, Index contact_rows, bool definite = true, Index interface_rows = 0,
         int threads = 1);
  /// Of a definite matrix whose rows may be eliminated in any order: `sequence[k]` is the k-th. There is no last block.
  Factor(const LowerTriangle& lower, std::span<const Index> sequence, int threads = 1);
  /// Of a definite matrix whose leading rows `leading` solves, two for each solve [theory: E.31]. The halves below are
  /// those of a block elimination, which `backward` undoes.
  Factor(const LowerTriangle& lower, Index contact_rows, std::unique_ptr<LeadingSolver> leading);
  ~Factor();
  Factor(Factor&&) noexcept;
  Factor& operator=(Factor&&) noexcept;

  /// The factor of a definite matrix of the same pattern, in the memory and by the symbolic analysis of this one;
  /// `lower` may be that of the constructor with other values. Throws as the constructor does.
  void refactor(const LowerTriangle& lower);

  /// S onto the rows in contact; onto interface and contact rows together. Dense, read off the factor.
  Eigen::MatrixXd contact_complement() const;
  Eigen::MatrixXd interface_complement() const;
  /// Their Cholesky factors, lower triangular.
  const Eigen::MatrixXd& contact_factor() const;
  const Eigen::MatrixXd& interface_factor() const;

  /// Halves of a solve: y = L^-1 P' b, x = P L^-T y. The tail of y belongs to the rows in contact (in K's
  /// order): tail = (factor of S)^-1 (condensed right-hand side).
  Eigen::VectorXd forward(const Eigen::VectorXd& b) const;
  Eigen::VectorXd backward(const Eigen::VectorXd& y) const;
  Eigen::MatrixXd backward(const Eigen::MatrixXd& y) const;  // column by column, at less than their price
  /// The second half on some rows of a definite matrix, at the price of the fronts that `fronts_above` marks for them;
  /// what stands on the others has no meaning.
  Eigen::VectorXd backward(const Eigen::VectorXd& y, const std::vector<bool>& fronts) const;
  std::vector<bool> fronts_above(const std::vector<Index>& rows) const;
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  double energy(const Eigen::VectorXd& b) const;              // b' K^-1 b
  Eigen::MatrixXd solve_all(const Eigen::MatrixXd& b) const;  // of a definite matrix, column by column

  /// L of a definite matrix as it lies in memory, and its order: place k is that of row order[k].
  struct Columns {
    const Multifrontal& blocks;
    const double* values;
    const std::vector<Index>& order;
  };
  Columns columns() const;

  double entries() const;                // nonzeros of L
  double flops() const;                  // of the factorization; both as if all nodes of a front were of one size
  const LeadingSolver* leading() const;  // null with a factor

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
