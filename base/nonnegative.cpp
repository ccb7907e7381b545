// min |A x - b| over x >= 0 by the active set of [Lawson, Hanson 1974]: the column of steepest descent enters, columns
// whose factor would turn negative leave, and the residual falls with each change.

#include "base/nonnegative.hpp"

#include "base/dense.hpp"

#include <algorithm>
#include <vector>

namespace kerf {

// Columns are compared by their slopes per length, with 1e-14 of |b| for nothing. Rounding could let the same column
// enter again and again, hence the bound on the steps.
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  const Eigen::Index n = A.cols();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> passive;
  std::vector<bool> is_passive(static_cast<std::size_t>(n), false);
  const Eigen::VectorXd size = A.colwise().norm();
  const double small = 1e-14 * b.norm();
  for (Eigen::Index iteration = 0; iteration < 3 * n + 10; ++iteration) {
    const Eigen::VectorXd slope = transposed_multiply(A, b - multiply(A, x));
    Eigen::Index enters = -1;
    double most = 0;
    for (Eigen::Index j = 0; j < n; ++j)
      if (!is_passive[static_cast<std::size_t>(j)] && size[j] > 0 && slope[j] / size[j] > std::max(most, small)) {
        most = slope[j] / size[j];
        enters = j;
      }
    if (enters < 0) break;
    passive.push_back(enters);
    is_passive[static_cast<std::size_t>(enters)] = true;
    while (!passive.empty()) {
      const Eigen::VectorXd z = solve_least_squares(A(Eigen::all, passive), b);
      double share = 1;
      Eigen::Index leaves = -1;
      for (std::size_t k = 0; k < passive.size(); ++k) {
        const double from = x[passive[k]], to = z[static_cast<Eigen::Index>(k)];
        if (to <= 0 && (leaves < 0 || from / (from - to) < share)) {
          share = from - to > 0 ? from / (from - to) : 0;
          leaves = static_cast<Eigen::Index>(k);
        }
      }
      for (std::size_t k = 0; k < passive.size(); ++k)
        x[passive[k]] += share * (z[static_cast<Eigen::Index>(k)] - x[passive[k]]);
      if (leaves < 0) break;
      std::vector<Eigen::Index> stay;
      for (std::size_t k = 0; k < passive.size(); ++k) {
        const Eigen::Index j = passive[k];
        if (static_cast<Eigen::Index>(k) != leaves && x[j] > 0)
          stay.push_back(j);
        else {
          x[j] = 0;
          is_passive[static_cast<std::size_t>(j)] = false;
        }
      }
      passive = std::move(stay);
    }
  }
  return x;
}

}  // namespace kerf
