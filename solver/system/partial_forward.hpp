#pragma once
// L^-1 P w for sparse columns w, on the way from their rows to the root of the tree of elimination alone.

#include "solver/factor.hpp"

#include <map>
#include <utility>
#include <vector>

namespace kerf {

/// Columns w that enter one batch after the other, as y = L^-1 P w: nothing outside the way to the root, so that many
/// cost less than a few solves. The factor must outlive this.
class PartialForward {
 public:
  using Column = std::vector<std::pair<Index, double>>;  // rows of the matrix and values

  explicit PartialForward(const Factor& factor);

  /// Numbered on from those that are there. Their products with all: entry (i, k) is that of column i, of all, with the
  /// k-th new one.
  Eigen::MatrixXd add(const std::vector<Column>& columns);

  Index count() const {
    return count_;
  }
  Eigen::VectorXd products(const Eigen::VectorXd& y) const;  // with each column; y as Factor::forward has it
  void subtract(const Eigen::VectorXd& share, Eigen::VectorXd& y) const;  // y -= sum of share_k times column k

 private:
  struct Block {               // of a supernode
    std::vector<Index> which;  // columns that pass it, increasing
    Eigen::MatrixXd values;    // its rows x these
  };
  void enter(const std::vector<Column>& columns);
  void pass_on(Index supernode, Eigen::Index first_new);

  Factor::Columns l_;
  std::vector<Index> place_, supernode_of_;  // of each row of K; of each place
  std::map<Index, Block> blocks_;
  Index count_ = 0;
};

}  // namespace kerf
