#pragma once
// Taylor models: a polynomial in the place over a box, and an interval that holds what it leaves of a function
// [Makino, Berz 2003]. The polynomial knows that two terms cancel, of which intervals know their widths alone.

#include "io/case/taylor.hpp"

#include <array>
#include <functional>

namespace kerf {

inline constexpr int model_degree = 7;  // at most

/// f = sum_kj c[k (k+1)/2 + j] u^(k-j) v^j + rest where the box is |u|, |v| <= 1. No polynomial: c[0] alone.
struct TaylorModel {
  Interval range = whole_line;  // of f
  std::array<double, (model_degree + 1) * (model_degree + 2) / 2> c{};
  int degree = 0;  // of the polynomial
  Interval rest = whole_line;
};

/// Arithmetic up to a degree. What is not smooth is the constant in the middle of its range.
class ModelArithmetic {
 public:
  explicit ModelArithmetic(int degree) : degree_(degree) {}

  TaylorModel range(const Interval& value) const;
  /// The coordinate of this axis, 0 or 1, over its side of the box.
  TaylorModel coordinate(int axis, const Interval& over) const;
  TaylorModel add(const TaylorModel& a, const TaylorModel& b) const;
  TaylorModel negate(const TaylorModel& a) const;
  TaylorModel subtract(const TaylorModel& a, const TaylorModel& b) const;
  TaylorModel multiply(const TaylorModel& a, const TaylorModel& b) const;
  TaylorModel square(const TaylorModel& a) const;
  TaylorModel divide(const TaylorModel& a, const TaylorModel& b) const;
  TaylorModel power(const TaylorModel& a, int n) const;
  /// Of a smooth function of one number, given by its Taylor coefficients: by its own polynomial about the middle of a
  /// and Lagrange's remainder.
  using Function = std::function<Taylor(const Taylor&, const TaylorArithmetic&)>;
  TaylorModel compose(const TaylorModel& a, const Function& f) const;
  TaylorModel arc_tangent(const TaylorModel& y, const TaylorModel& x) const;
  /// Kinks leave what their branches may differ by: |a|, the least of two, and one of two.
  TaylorModel absolute(const TaylorModel& a) const;
  TaylorModel least(const TaylorModel& a, const TaylorModel& b) const;
  TaylorModel either(const TaylorModel& a, const TaylorModel& b) const;

 private:
  TaylorModel finished(TaylorModel m, const Interval& range) const;
  int degree_;
};

}  // namespace kerf
