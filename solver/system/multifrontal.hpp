#pragma once
// The numeric phase of a sparse Cholesky factorization, and substitutions, on a symbolic analysis that is given
// [theory: E.28, E.29].

#include "solver/system/sparse.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace kerf {

/// Columns first[s] .. first[s + 1] of L have the rows rows[rows_start[s]] .. rows[rows_start[s + 1]], increasing,
/// their own before all others; their values are dense by columns from values_start[s] on: CHOLMOD's arrays, only
/// looked at.
struct Supernodes {
  Index count = 0;
  const Index *first = nullptr, *rows_start = nullptr, *values_start = nullptr, *rows = nullptr;
};

/// L L' = K, multifrontal [Duff, Reid 1983]: a front per supernode, which hands what it leaves of its other rows to its
/// parent in the tree of elimination. The tree is cut by work, never by the number of threads: subtrees that hold less
/// than a 64th of it run side by side, the fronts above them one after the other in tiles. Each sum has one order, so
/// that the bits are the same for any number of threads.
class Multifrontal {
 public:
  explicit Multifrontal(const Supernodes& supernodes);

  /// L into `values`. Returns false when a pivot is not positive: `values` are void then. Throws std::bad_alloc.
  bool factorize(const LowerTriangle& K, double* values, int threads) const;

  /// x <- L^-1 x, and x <- L^-T x, of columns of the size of L; cut as the factorization is, with the same bits for any
  /// number of threads.
  void forward(const double* values, Eigen::Ref<Eigen::MatrixXd> x, int threads) const;
  /// `marked`: backwards on the columns of these fronts alone, the others stay as they are.
  void backward(const double* values, Eigen::Ref<Eigen::MatrixXd> x, int threads,
                const std::vector<bool>* marked = nullptr) const;
  /// Marks the fronts that have these columns, and all above them: what a substitution backwards needs for them.
  std::vector<bool> fronts_above(const std::vector<Index>& columns) const;

 private:
  template <typename Values>
  struct FrontOf {
    Index first, width, height;  // columns; all rows
    const Index* rows;
    Values* panel;
    Index rest() const {
      return height - width;
    }
    std::size_t rest_size() const {
      return static_cast<std::size_t>(rest()) * static_cast<std::size_t>(rest());
    }
  };
  using Front = FrontOf<double>;
  struct Arena;
  struct Run;
  struct Substitution;
  /// Fronts sequence_[begin] .. sequence_[end - 1]: a subtree, or one front above them.
  struct Unit {
    Index begin, end;
    bool subtree;
    double work;
  };

  template <typename Values>
  FrontOf<Values> front(Index s, Values* values) const {
    return {s_.first[s], s_.first[s + 1] - s_.first[s], s_.rows_start[s + 1] - s_.rows_start[s],
            s_.rows + s_.rows_start[s], values + s_.values_start[s]};
  }
  int threads_worth(int threads) const;  // of a substitution
  void order_depth_first();
  void cut();

  Supernodes s_;
  std::vector<Index> parent_, first_child_, next_;  // next_: the next child of the same parent, increasing
  std::vector<Index> sequence_;                     // children before parents, subtrees together
  std::vector<Unit> units_;
  Index columns_ = 0;
  double work_ = 0;                              // flops, and what a front costs besides
  std::int64_t entries_ = 0;                     // of the fronts' panels
  std::size_t subtree_room_ = 0, top_room_ = 0;  // doubles on the stacks of what fronts leave
};

}  // namespace kerf
