#include "solver/sparse.hpp"

namespace kerf {

Eigen::VectorXd multiply(const LowerTriangle& a, const Eigen::VectorXd& x) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(a.size);
  for (Index j = 0; j < a.size; ++j) {
    const double xj = x[j];
    double sum = 0;
    for (Index p = a.start[j]; p < a.start[j + 1]; ++p) {
      const Index i = a.rows[p];
      y[i] += a.values[p] * xj;
      if (i != j) sum += a.values[p] * x[i];
    }
    y[j] += sum;
  }
  return y;
}

}  // namespace kerf
