#pragma once
// The inside of a part eliminated exactly: its factor, and what is left of the rows that the part shares.

#include "kerf/model.hpp"
#include "solver/part_matrix.hpp"
#include "solver/system/multifrontal.hpp"

#include <memory>
#include <span>

namespace kerf {

/// K_p with rows I inside and rows G that it shares, P' K_p P = [K_II K_IG; K_GI K_GG], K_II = L L' [theory: E.35].
class Inside {
 public:
  /// `shared`: rows of the part, in the order of S. Nothing stays of the part: its matrix exists once at a time. `S`:
  /// the lower half of K_GG - K_GI K_II^-1 K_IG, above it what has no meaning. Throws LostDefiniteness when K_II is not
  /// positive definite, std::bad_alloc.
  /// `precision`: in which L is kept; all is computed in double precision, S and what follows from L.
  Inside(PartMatrix& part, std::span<const Index> shared, int threads, Precision precision, Eigen::MatrixXd& S);

  /// (L^-1 b_I, b_G - K_GI K_II^-1 b_I) of b in rows of the part.
  Eigen::VectorXd forward(const Eigen::VectorXd& b) const;
  /// x in rows of the part, of (L^-1 b_I, x_G).
  Eigen::VectorXd backward(Eigen::VectorXd y) const;

 private:
  bool factorize(const LowerTriangle& lower, Eigen::MatrixXd& S);

  std::vector<Index> order_;  // order_[k] is the k-th row to be eliminated; those that are shared are the last
  std::unique_ptr<Multifrontal> numeric_;
  std::unique_ptr<double[]> values_;  // L
  std::unique_ptr<float[]> rounded_;  // or this
  int threads_;
};

}  // namespace kerf
