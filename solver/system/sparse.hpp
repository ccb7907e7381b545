#pragma once
// The lower triangle of a sparse symmetric matrix, by columns. (Eigen 3.4's SparseMatrix copies where it should move.)

#include "kerf/types.hpp"

#include <span>
#include <vector>

namespace kerf {

struct LowerTriangle {
  Index size = 0;
  std::vector<Index> start;    // per column, one more at the end
  std::vector<Index> rows;     // sorted in each column, the diagonal first
  std::vector<double> values;  // same shape
};

/// Entries in the last rows, column by column, and where their values are.
struct EntryPlace {
  Index row, column, at;
};
std::vector<EntryPlace> entries_of_last(const LowerTriangle& a, Index rows);

/// The matrix with rows and columns in another order: order[k] is the k-th. The rows of a column are not sorted then.
/// Of a pattern, which has no values, the pattern.
LowerTriangle reordered(const LowerTriangle& a, std::span<const Index> order);

/// The whole symmetric matrix times x.
Eigen::VectorXd multiply(const LowerTriangle& a, const Eigen::VectorXd& x);
/// |a| |x|: a product's rounding error is a unit in the last place of this.
Eigen::VectorXd multiply_sizes(const LowerTriangle& a, const Eigen::VectorXd& x);

}  // namespace kerf
