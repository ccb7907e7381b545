#include "solver/system/sparse.hpp"

namespace kerf {

// Column j gives to the rows below it and takes from them, for the upper triangle.
Eigen::VectorXd multiply(const LowerTriangle& a, const Eigen::VectorXd& x) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(a.size);
  for (Index j = 0; j < a.size; ++j) {
    const double xj = x[j];
    double sum = 0;
    for (Index p = a.start[j]; p < a.start[j + 1]; ++p) {
      const Index i = a.rows[p];
      const double value = a.values[p];
      y[i] += value * xj;
      if (i != j) sum += value * x[i];
    }
    y[j] += sum;
  }
  return y;
}

}  // namespace kerf
