#pragma once
// The numeric phase of a sparse Cholesky factorization, and substitutions, on a symbolic analysis that is given
// [theory: E.28, E.29].

#include "solver/system/sparse.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace kerf {

/// Columns first[s] .. first[s + 1] of L have the rows rows[rows_start[s]] .. rows[rows_start[s + 1]], increasing,
/// their own before all others.
struct Supernodes {
  std::vector<Index> first{0}, rows_start{0}, rows;
  Index count() const {
    return static_cast<Index>(first.size()) - 1;
  }
};

/// The columns of L in a supernode, dense and eight by eight: each eight from their first row on, so that little of
/// what is above the diagonal takes memory.
template <typename Scalar>
struct FrontPanel {
  static constexpr Index together = 8;
  const Scalar* values;
  Index height, width;

  /// Where row 0 of column k would be: rows from k on are there.
  /// Columns before c = 8 floor(k/8) take sum over their eights of 8 (height - first row).
  static std::int64_t place(Index height, Index k) {
    const std::int64_t c = k / together * together;
    return c * height - c * (c - together) / 2 + (k - c) * (height - c) - c;
  }
  static std::int64_t size(Index height, Index width) {
    const std::int64_t c = width / together * together;
    return c * height - c * (c - together) / 2 + (width - c) * (height - c);
  }
  const Scalar* column(Index k) const {
    return values + place(height, k);
  }
  /// Rows from one column of the same eight to the next.
  Index apart(Index k) const {
    return height - k / together * together;
  }
};

/// L L' = K, multifrontal [Duff, Reid 1983]: a front per supernode, which hands what it leaves of its other rows to its
/// parent in the tree of elimination. The tree is cut by work, never by the number of threads: subtrees that hold less
/// than a 64th of it run side by side, the fronts above them one after the other in tiles. Each sum has one order, so
/// that the bits are the same for any number of threads.
class Multifrontal {
 public:
  /// The last `kept` columns are not eliminated.
  explicit Multifrontal(Supernodes supernodes, Index kept = 0);

  /// Numbers that L takes.
  std::int64_t entries() const {
    return place_.back();
  }
  /// L into `values`, and its last rows and columns, as many as `last` has, into `last`; of columns that are kept the
  /// lower half of their Schur complement. Returns false when a pivot is not positive: `values` are void then. Throws
  /// std::bad_alloc.
  /// All is computed in double precision; L is rounded to that of Scalar, double or float, when it is stored.
  template <typename Scalar>
  bool factorize(const LowerTriangle& K, Scalar* values, Eigen::MatrixXd& last, int threads) const;

  /// x <- L^-1 x, and x <- L^-T x, of columns of the size of L; cut as the factorization is, with the same bits for any
  /// number of threads. The block of L of columns that are kept counts as 1.
  template <typename Scalar>
  void forward(const Scalar* values, Eigen::Ref<Eigen::MatrixXd> x, int threads) const;
  /// `marked`: backwards on the columns of these fronts alone, the others stay as they are.
  template <typename Scalar>
  void backward(const Scalar* values, Eigen::Ref<Eigen::MatrixXd> x, int threads,
                const std::vector<bool>* marked = nullptr) const;
  /// Marks the fronts that have these columns, and all above them: what a substitution backwards needs for them.
  std::vector<bool> fronts_above(const std::vector<Index>& columns) const;

  const Supernodes& supernodes() const {
    return s_;
  }
  Index parent(Index supernode) const {
    return parent_[static_cast<std::size_t>(supernode)];
  }
  FrontPanel<double> panel(Index s, const double* values) const {
    const Front f = front(s);
    return {values + place_[static_cast<std::size_t>(s)], f.height, f.width};
  }

 private:
  struct Front {
    Index first, width, height;  // columns; all rows
    const Index* rows;
    Index rest() const {
      return height - width;
    }
    std::size_t rest_size() const {
      return static_cast<std::size_t>(rest()) * static_cast<std::size_t>(rest() + 1) / 2;
    }
  };
  struct Arena;
  template <typename Scalar>
  struct Run;
  template <typename Scalar>
  struct Substitution;
  /// Fronts sequence_[begin] .. sequence_[end - 1]: a subtree, or one front above them.
  struct Unit {
    Index begin, end;
    bool subtree;
    double work;
  };

  Front front(Index s) const {
    const auto k = static_cast<std::size_t>(s);
    return {s_.first[k], s_.first[k + 1] - s_.first[k], s_.rows_start[k + 1] - s_.rows_start[k],
            s_.rows.data() + s_.rows_start[k]};
  }
  int threads_worth(int threads) const;  // of a substitution
  /// Whether the front sees all columns that are kept and nothing is above it: it leaves its rest where theirs goes.
  bool leaves_all(Index s) const {
    return kept_ > 0 && parent_[static_cast<std::size_t>(s)] == none && front(s).rest() == kept_;
  }
  void order_depth_first();
  void cut();

  Supernodes s_;
  std::vector<Index> parent_, first_child_, next_;  // next_: the next child of the same parent, increasing
  std::vector<Index> sequence_;                     // children before parents, subtrees together
  std::vector<Unit> units_;
  Index columns_ = 0, kept_ = 0;        // of these the last
  double work_ = 0;                     // flops, and what a front costs besides
  std::vector<std::int64_t> place_{0};  // of the fronts' panels in memory
  struct Room {                         // doubles: stack of what fronts leave, largest panel; highest front
    std::size_t stack = 0, panel = 0;
    Index height = 0;
  };
  Room subtree_room_, top_room_;
};

}  // namespace kerf
