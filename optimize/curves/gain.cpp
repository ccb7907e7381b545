// What a quadratic model of the Lagrangian promises beyond a design, without any limit on the step [theory: K.7]. Rows
// of constraints enter the program where its step violates them: of the many that the geometry has few matter.

#include "optimize/curves/gain.hpp"

#include "base/dense.hpp"
#include "optimize/curves/quadratic.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace kerf {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double model_gain(const Eigen::LLT<MatrixXd>& H, const VectorXd& g, const MatrixXd& A, const VectorXd& b) {
  constexpr int most_rounds = 20;
  constexpr double small = 1e-9;  // of the largest change of a row
  const VectorXd room = b.cwiseMax(0.0);
  std::vector<Eigen::Index> rows;
  std::vector<bool> used(std::size_t(room.size()), false);
  VectorXd step = quadratic_step(H, g, MatrixXd(0, g.size()), VectorXd(0)).step;
  for (int round = 0; round < most_rounds; ++round) {
    const std::size_t had = rows.size();
    const VectorXd there = multiply(A, step);
    const double least = small * (there.size() > 0 ? there.cwiseAbs().maxCoeff() : 0);
    for (Eigen::Index k = 0; k < there.size(); ++k)
      if (!used[std::size_t(k)] && there[k] > room[k] + least) rows.push_back(k), used[std::size_t(k)] = true;
    if (rows.size() == had) break;
    step = quadratic_step(H, g, A(rows, Eigen::all), room(rows)).step;
  }
  const VectorXd across = H.matrixL().transpose() * step;
  return std::max(0.0, -g.dot(step) - 0.5 * across.squaredNorm());
}

}  // namespace kerf
