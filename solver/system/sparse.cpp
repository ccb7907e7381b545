#include "solver/system/sparse.hpp"

#include <cmath>

namespace kerf {

namespace {

// Column j gives to the rows below it and takes from them, for the upper triangle.
template <typename Entry>
Eigen::VectorXd product(const LowerTriangle& a, const Eigen::VectorXd& x, Entry entry) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(a.size);
  for (Index j = 0; j < a.size; ++j) {
    const double xj = entry(x[j]);
    double sum = 0;
    for (Index p = a.start[j]; p < a.start[j + 1]; ++p) {
      const Index i = a.rows[p];
      const double value = entry(a.values[p]);
      y[i] += value * xj;
      if (i != j) sum += value * entry(x[i]);
    }
    y[j] += sum;
  }
  return y;
}

}  // namespace

Eigen::VectorXd multiply(const LowerTriangle& a, const Eigen::VectorXd& x) {
  return product(a, x, [](double v) { return v; });
}

Eigen::VectorXd multiply_absolute(const LowerTriangle& a, const Eigen::VectorXd& x) {
  return product(a, x, [](double v) { return std::abs(v); });
}

}  // namespace kerf
