// Conjugate gradients [Hestenes, Stiefel 1952] on vectors that processes share, for one matrix A and many right-hand
// sides. Every direction p is made conjugate to all before it, those of earlier right-hand sides included,
//   p = z - P (P'A z),   P'A P = I,   x <- x + (p.r/p.A p) p,
// and a solve begins with x = P P'b. What rounding and a few eigenvalues far from the others cost is paid once, at the
// price of the memory of P and A P [theory: E.36]. A product over processes counts each row where it is `counted`; sums
// have the same bits on all, so that all take the same steps. docs/theory/elements.md, section Solving in parts.

#include "solver/system/gradients.hpp"

#include "kerf/stop.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace kerf {

namespace {

using Eigen::VectorXd;

/// Of the Lanczos matrix that steps and quotients of conjugate gradients make.
double condition_of(const std::vector<double>& alpha, const std::vector<double>& beta) {
  const auto n = static_cast<Eigen::Index>(alpha.size());
  if (n < 2) return 1;
  VectorXd diagonal(n), beside(n - 1);
  for (Eigen::Index j = 0; j < n; ++j) {
    diagonal[j] = 1 / alpha[j] + (j > 0 ? beta[j - 1] / alpha[j - 1] : 0);
    if (j + 1 < n) beside[j] = std::sqrt(beta[j]) / alpha[j];
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> lanczos;
  lanczos.computeFromTridiagonal(diagonal, beside, Eigen::EigenvaluesOnly);
  const VectorXd& values = lanczos.eigenvalues();
  return lanczos.info() == Eigen::Success && values[0] > 0 ? values[n - 1] / values[0] : 0;
}

}  // namespace

void SharedGradients::keep(const VectorXd& p, const VectorXd& Ap, double size) {
  constexpr Eigen::Index more = 32;
  if (count_ == p_.cols()) {
    p_.conservativeResize(p.size(), count_ + more);
    Ap_.conservativeResize(p.size(), count_ + more);
  }
  p_.col(count_) = p / size;
  Ap_.col(count_) = Ap / size;
  ++count_;
}

// A start from the kept directions, x = P P'b with P'A P = I, is the solution on their span. r.z estimates the squared
// error in the norm of the energy. Directions of steps in which rounding let nothing shrink are dropped again.
std::unique_ptr<SharedIteration> Communicator::iteration(SharedSystem system) {
  return std::make_unique<SharedGradients>(*this, std::move(system));
}

SharedSolved SharedGradients::solve(const VectorXd& b) {
  constexpr Eigen::Index most_kept = 128;  // between solves
  if (count_ > most_kept) count_ = 0;
  SharedSolved s{.x = VectorXd::Zero(b.size())};
  VectorXd r = b, shares = p_.leftCols(count_).transpose() * counted_.cwiseProduct(b);
  peers_.sum({shares.data(), static_cast<std::size_t>(count_)});
  s.x += p_.leftCols(count_) * shares;
  r -= Ap_.leftCols(count_) * shares;
  std::vector<double> alpha, beta;
  double energy = shares.squaredNorm(), before = 0;  // that x has, at least
  constexpr int patience = 6;                        // iterations without such a gain: rounding has ended it
  constexpr double gain = 0.1;
  double best = infinity;
  int without = 0;
  std::size_t useful = 0;
  while (true) {
    check_stop();
    VectorXd z = system_.precondition(r);
    shares.resize(count_ + 1);
    shares.head(count_) = Ap_.leftCols(count_).transpose() * counted_.cwiseProduct(z);
    shares[count_] = counted_.cwiseProduct(r).dot(z);
    peers_.sum({shares.data(), static_cast<std::size_t>(count_ + 1)});
    const double error = shares[count_];
    s.left = error > 0 ? std::sqrt(error / (energy + error)) : error == 0 ? 0 : infinity;
    without = error > gain * best ? without + 1 : 0;
    if (without == 0) best = error, useful = alpha.size();
    if (!(error > 0) || s.left <= tolerance || s.iterations == most || (s.left <= enough && without == patience)) break;
    if (s.iterations > 0) beta.push_back(error / before);
    VectorXd p = z - p_.leftCols(count_) * shares.head(count_);
    VectorXd again = Ap_.leftCols(count_).transpose() * counted_.cwiseProduct(p);  // for rounding
    peers_.sum({again.data(), static_cast<std::size_t>(count_)});
    p -= p_.leftCols(count_) * again;
    const VectorXd Ap = system_.multiply(p);
    std::array<double, 2> products{counted_.cwiseProduct(p).dot(Ap), counted_.cwiseProduct(p).dot(r)};
    peers_.sum(products);
    if (!(products[0] > 0)) break;
    const double step = products[1] / products[0];
    s.x += step * p;
    r -= step * Ap;
    keep(p, Ap, std::sqrt(products[0]));
    alpha.push_back(error / products[0]);
    energy += step * products[1];
    before = error;
    ++s.iterations;
  }
  if (without == patience) {  // what rounding makes says nothing
    count_ -= static_cast<Eigen::Index>(alpha.size() - useful);
    alpha.resize(useful);
  }
  s.condition = condition_of(alpha, beta);
  s.failed = !(s.left <= enough);
  return s;
}

}  // namespace kerf
