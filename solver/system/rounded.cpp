// A factor in single precision as the preconditioner of conjugate gradients on K itself. K = L L' is made in double
// precision and rounded when it is stored, L~_ij = L_ij (1 + d), |d| <= 2^-24: half the memory. On the rows I that no
// contact law acts on conjugate gradients [Polak, Ribiere 1969] end when
//   r' (L~_II L~_II')^-1 r <= 1e-28 b' (L~_II L~_II')^-1 b   [theory: E.32],
// after three or four steps for most bodies. The rows in contact come last, so that L~_II is the first part of L~; the
// factor of S on them stays in double precision, and (E.31) does the rest. Tried on the loads first: more than twelve
// steps, as in strips thousands of times as long as wide, and the factor is made in double precision instead. Derived
// in docs/theory/elements.md, section The factor.

#include "solver/system/rounded.hpp"

#include "kerf/stop.hpp"
#include "solver/system/symbolic.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

namespace kerf {

namespace {

class Rounded : public LeadingSolver {
 public:
  Rounded(std::shared_ptr<const LowerTriangle> K, Index contact_rows, int threads)
      : K_(std::move(K)),
        leading_(K_->size - contact_rows),
        numeric_(analyze_pattern(*K_).supernodes),
        threads_(threads) {
    contact_factor_.setZero(contact_rows, contact_rows);
  }
  /// Whether all pivots are positive.
  bool factorize() {
    check_stop();
    values_.reset(new float[static_cast<std::size_t>(numeric_.entries())]);
    return numeric_.factorize(*K_, values_.get(), contact_factor_, threads_);
  }

  // Counts are guarded: many solves run at once.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const override {
    const Solved found = iterate(b, most_);
    const std::scoped_lock lock(counting_);
    ++effort_.solves;
    effort_.iterations = std::max(effort_.iterations, found.steps);
    return found.x;
  }
  SolverEffort effort() const override {
    const std::scoped_lock lock(counting_);
    return effort_;
  }
  const Eigen::MatrixXd& contact_factor() const override {
    return contact_factor_;
  }
  /// Whether a few steps solve for b.
  bool pays(const Eigen::VectorXd& b) const {
    return iterate(b, few_).left <= enough_;
  }

 private:
  static constexpr int most_ = 60, few_ = 12;
  static constexpr double enough_ = 1e-28;  // squares of the norm of the energy

  struct Solved {
    Eigen::VectorXd x;
    int steps = 0;
    double left = 0;  // of the error, relative
  };

  // [Polak, Ribiere 1969]; r'z is the square of the error in the norm of the energy.
  Solved iterate(const Eigen::VectorXd& b, int most) const {
    Solved s{Eigen::VectorXd::Zero(leading_)};
    Eigen::VectorXd r = b, z = precondition(r), p = z, last;
    double error = r.dot(z);
    const double whole = error;
    for (; s.steps < most && error > enough_ * whole; ++s.steps) {
      check_stop();
      const Eigen::VectorXd force = times(p);
      const double share = r.dot(p) / force.dot(p);
      if (!std::isfinite(share)) break;
      s.x += share * p;
      last = r;
      r -= share * force;
      z = precondition(r);
      const double next = r.dot(z);
      p = z + (next - last.dot(z)) / error * p;
      error = next;
    }
    s.left = whole > 0 ? error / whole : 0;
    return s;
  }

  Eigen::VectorXd whole(const Eigen::VectorXd& leading) const {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(K_->size);
    all.head(leading_) = leading;
    return all;
  }
  Eigen::VectorXd times(const Eigen::VectorXd& x) const {
    return multiply(*K_, whole(x)).head(leading_);
  }
  /// The rows in contact come last: without their share in between, L is the factor of the leading rows.
  Eigen::VectorXd precondition(const Eigen::VectorXd& r) const {
    Eigen::VectorXd x = whole(r);
    numeric_.forward(values_.get(), x, threads_);
    x.tail(x.size() - leading_).setZero();
    numeric_.backward(values_.get(), x, threads_);
    return x.head(leading_);
  }

  std::shared_ptr<const LowerTriangle> K_;
  Eigen::Index leading_;
  Multifrontal numeric_;
  std::unique_ptr<float[]> values_;
  Eigen::MatrixXd contact_factor_;
  int threads_;
  mutable std::mutex counting_;
  mutable SolverEffort effort_{.parts = 1};
};

}  // namespace

// Without loads on the leading rows 1 on each of them stands in for the trial.
std::unique_ptr<LeadingSolver> rounded(std::shared_ptr<const LowerTriangle> K, Index contact_rows,
                                       const Eigen::VectorXd& b, int threads) {
  use_one_thread();
  const Eigen::Index leading = K->size - contact_rows;
  auto solver = std::make_unique<Rounded>(std::move(K), contact_rows, threads);
  if (!solver->factorize()) return nullptr;
  const Eigen::VectorXd load = b.head(leading);
  return solver->pays(load.isZero(0) ? Eigen::VectorXd::Ones(leading).eval() : load) ? std::move(solver) : nullptr;
}

}  // namespace kerf
