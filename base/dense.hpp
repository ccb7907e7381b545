#pragma once
// Dense linear algebra on matrices whose sizes are known at run time only. Eigen's products and decompositions are
// templates that cost seconds in every file that uses them: here they are compiled once, in dense.cpp.
//
// Columns of a right-hand side are separate problems. Vectors have functions of their own, as Eigen has other kernels
// for them. The kernels of a, of its transpose and of a copy of its transpose round differently, too: choose the
// function, do not transpose an argument. Sizes are checked by Eigen's assertions. No function throws but for want of
// memory.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/QR>

namespace kerf {

/// A matrix or a block of one, by columns. Anything else, as a transposed matrix or a sum, is evaluated into a copy.
/// Sizes known at compile time have kernels of their own: such matrices do not fit here.
struct ConstMatrix : Eigen::Ref<const Eigen::MatrixXd> {
  template <class Derived>
  requires(Derived::RowsAtCompileTime == Eigen::Dynamic && Derived::ColsAtCompileTime == Eigen::Dynamic)
      ConstMatrix(const Eigen::DenseBase<Derived>& m)
      : Ref(m) {}
};
/// The same of what is a column by its type.
struct ConstVector : Eigen::Ref<const Eigen::VectorXd> {
  template <class Derived>
  requires(Derived::RowsAtCompileTime == Eigen::Dynamic && Derived::ColsAtCompileTime == 1)
      ConstVector(const Eigen::DenseBase<Derived>& v)
      : Ref(v) {}
};

/// a b: m x k times k x n.
Eigen::MatrixXd multiply(const ConstMatrix& a, const ConstMatrix& b);
Eigen::VectorXd multiply(const ConstMatrix& a, const ConstVector& x);
/// (a b) c.
Eigen::MatrixXd multiply(const ConstMatrix& a, const ConstMatrix& b, const ConstMatrix& c);
/// a' b: k x m transposed, times k x n.
Eigen::MatrixXd transposed_multiply(const ConstMatrix& a, const ConstMatrix& b);
Eigen::VectorXd transposed_multiply(const ConstMatrix& a, const ConstVector& x);
/// a b': m x k times n x k transposed.
Eigen::MatrixXd multiply_transposed(const ConstMatrix& a, const ConstMatrix& b);

/// a^-1 of a square matrix by LU with row pivots; infinite or not a number if a is singular.
Eigen::MatrixXd inverse(const ConstMatrix& a);

/// Symmetric positive definite a = L L', of which the lower half is read. info() says whether it is definite.
Eigen::LLT<Eigen::MatrixXd> cholesky(const ConstMatrix& a);
Eigen::MatrixXd solve(const Eigen::LLT<Eigen::MatrixXd>& a, const ConstMatrix& b);
Eigen::VectorXd solve(const Eigen::LLT<Eigen::MatrixXd>& a, const ConstVector& b);
/// b a^-1.
Eigen::MatrixXd solve_from_right(const ConstMatrix& b, const Eigen::LLT<Eigen::MatrixXd>& a);
/// L^-1 b, L^-T b, and b L^-T.
Eigen::MatrixXd solve_lower(const Eigen::LLT<Eigen::MatrixXd>& a, const ConstMatrix& b);
Eigen::VectorXd solve_lower(const Eigen::LLT<Eigen::MatrixXd>& a, const ConstVector& b);
Eigen::MatrixXd solve_upper(const Eigen::LLT<Eigen::MatrixXd>& a, const ConstMatrix& b);
Eigen::MatrixXd solve_upper_from_right(const ConstMatrix& b, const Eigen::LLT<Eigen::MatrixXd>& a);
/// a^-1 b by Cholesky factors; numbers without meaning if a is not definite.
Eigen::MatrixXd solve_spd(const ConstMatrix& a, const ConstMatrix& b);
Eigen::VectorXd solve_spd(const ConstMatrix& a, const ConstVector& b);
/// a^-1 b of a symmetric a, possibly indefinite, by L D L' with diagonal pivots; what is zero in D counts as infinite.
Eigen::MatrixXd solve_symmetric(const ConstMatrix& a, const ConstMatrix& b);
Eigen::VectorXd solve_symmetric(const ConstMatrix& a, const ConstVector& b);

/// Square a by LU with row pivots.
Eigen::PartialPivLU<Eigen::MatrixXd> lu(const ConstMatrix& a);
Eigen::MatrixXd solve(const Eigen::PartialPivLU<Eigen::MatrixXd>& a, const ConstMatrix& b);
Eigen::VectorXd solve(const Eigen::PartialPivLU<Eigen::MatrixXd>& a, const ConstVector& b);
/// a^-1 b; infinite or not a number if a is singular.
Eigen::MatrixXd solve_lu(const ConstMatrix& a, const ConstMatrix& b);
Eigen::VectorXd solve_lu(const ConstMatrix& a, const ConstVector& b);

/// a = Q R with as many columns of Q as a has; a has at least as many rows.
struct ThinQr {
  Eigen::MatrixXd Q, R;
};
ThinQr thin_qr(const ConstMatrix& a);
/// a P = Q R, the longest remaining column next. Pivots below `threshold` times the largest do not count in rank();
/// Eigen's own threshold if it is negative.
Eigen::ColPivHouseholderQR<Eigen::MatrixXd> pivoted_qr(const ConstMatrix& a, double threshold = -1);
/// The first `columns` columns of Q: with the rank, an orthonormal basis of the range. All of Q, which is square.
Eigen::MatrixXd orthonormal(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& a, Eigen::Index columns);
Eigen::MatrixXd full_q(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& a);
/// R^-T b for the upper triangle R of r.
Eigen::MatrixXd solve_upper_transposed(const ConstMatrix& r, const ConstMatrix& b);
/// Orthonormal bases of what is orthogonal to the columns of a, which are independent, and of { x : a x = 0 }.
Eigen::MatrixXd orthogonal_complement(const ConstMatrix& a);
Eigen::MatrixXd null_space(const ConstMatrix& a);
/// x of least |a x - b|; zero where columns depend on others.
Eigen::VectorXd solve(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd>& a, const ConstVector& b);
Eigen::VectorXd solve_least_squares(const ConstMatrix& a, const ConstVector& b);
/// Of these the x of least norm, by a complete orthogonal decomposition; `threshold` as of pivoted_qr.
Eigen::MatrixXd solve_least_norm(const ConstMatrix& a, const ConstMatrix& b, double threshold = -1);
Eigen::VectorXd solve_least_norm(const ConstMatrix& a, const ConstVector& b);
/// The pseudo-inverse, in the same way.
Eigen::MatrixXd pseudo_inverse(const ConstMatrix& a);

/// Of a symmetric matrix, of which the lower half is read: values in rising order, the vectors as columns.
struct Eigenpairs {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
Eigenpairs eigenpairs(const ConstMatrix& a);
/// Of a x = lambda b x, b symmetric positive definite; the vectors are orthonormal in b.
Eigenpairs eigenpairs(const ConstMatrix& a, const ConstMatrix& b);

}  // namespace kerf
