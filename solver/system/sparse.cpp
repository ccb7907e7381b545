#include "solver/system/sparse.hpp"

#include <cmath>

namespace kerf {

namespace {

// Column j gives to the rows below it and takes from them, for the upper triangle.
template <typename Value>
Eigen::VectorXd product(const LowerTriangle& a, const Eigen::VectorXd& x, const Value& value_of) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(a.size);
  for (Index j = 0; j < a.size; ++j) {
    const double xj = x[j];
    double sum = 0;
    for (Index p = a.start[j]; p < a.start[j + 1]; ++p) {
      const Index i = a.rows[p];
      const double value = value_of(a.values[p]);
      y[i] += value * xj;
      if (i != j) sum += value * x[i];
    }
    y[j] += sum;
  }
  return y;
}

}  // namespace

std::vector<EntryPlace> entries_of_last(const LowerTriangle& a, Index rows) {
  std::vector<EntryPlace> all;
  for (Index j = 0; j < a.size; ++j)
    for (Index p = a.start[j]; p < a.start[j + 1]; ++p)
      if (a.rows[p] >= a.size - rows) all.push_back({a.rows[p], j, p});
  return all;
}

Eigen::VectorXd multiply(const LowerTriangle& a, const Eigen::VectorXd& x) {
  return product(a, x, [](double value) { return value; });
}

Eigen::VectorXd multiply_sizes(const LowerTriangle& a, const Eigen::VectorXd& x) {
  return product(a, x.cwiseAbs(), [](double value) { return std::abs(value); });
}

}  // namespace kerf
