// A path through the inside of the admissible jumps and forces, for contact problems on which exchanges take long. The
// jump of a row is j = a - b with a, b >= 0 (b = 0 of a normal row), its force has l <= p <= u, and
//   S j - r = p,   a (p - l) = mu,   b (u - p) = mu,   mu -> 0   [theory: C.34].
// Newton's method with prediction and correction [Mehrotra 1992] eliminates a, b, p: with ease = a/(p - l) + b/(u - p)
// a step solves (S + diag(1/ease)) dj = r - S j + p + rest/ease, one dense Cholesky factor for both halves, and dp =
// (rest - dj)/ease. Ten to twenty steps, whatever the condition of S. The result is a set, which the exchanges of
// contact.cpp settle to the last row. Limits are given: no friction that follows the pressure. Derived in
// docs/theory/contact.md, section Algorithms.

#include "solver/contact/contact.hpp"

#include "base/dense.hpp"
#include "kerf/stop.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// The products that end at 0: a (p - low) of a point's force p and the part a of its jump that goes forward, and b
// (high - p) of the part that goes backward; the jump is a - b.
struct Row {
  double low = 0, high = infinity;
  double a = 0, b = 0, p = 0;
  bool bounded = false;  // by `high`
  bool is_free = true;   // no force
  double jump() const {
    return a - b;
  }
  /// p moves by (rest - jump's step) / ease
  double ease() const {
    return a / (p - low) + (bounded ? b / (high - p) : 0);
  }
};

class Interior {
 public:
  // The start: forces in the middle of their interval, or as large as the load, jumps as large as the load alone would
  // make them. Tangential rows without a slip bound have no force and are free.
  Interior(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const std::vector<ContactPoint>& points)
      : S_(S), r_(r), rows_(static_cast<std::size_t>(r.size())), x_(Eigen::VectorXd::Zero(r.size())) {
    const double load = r.cwiseAbs().maxCoeff();
    const auto begin = [&](Index i, double high) {
      Row& row = rows_[static_cast<std::size_t>(i)];
      row.is_free = false;
      row.bounded = std::isfinite(high);
      row.high = high;
      row.low = row.bounded ? -high : 0;
      row.p = row.bounded ? 0 : load;
      row.a = load / S(i, i);
      row.b = row.bounded ? row.a : 0;
      x_[i] = row.jump();
    };
    for (const ContactPoint& p : points) {
      begin(p.normal, infinity);
      if (p.tangential != none && p.slip_bound > 0) begin(p.tangential, p.slip_bound);
    }
  }

  // It ends when the set has not changed in two steps, once products have fallen to 1e-4 of the first: before that the
  // set says nothing.
  std::vector<Motion> operator()() {
    constexpr int most = 60, enough = 2;  // steps; of them without a change of the set
    constexpr double begun = 1e-4;        // of the first mean product
    std::vector<Motion> set = motions();
    const double first = mean_product();
    for (int step = 0, same = 0; step < most && same < enough; ++step) {
      if (!advance()) break;
      std::vector<Motion> next = motions();
      same = next == set && mean_product() < begun * first ? same + 1 : 0;
      set = std::move(next);
    }
    return set;
  }

 private:
  // mu, the mean of all products that are to vanish.
  double mean_product() const {
    double sum = 0;
    int count = 0;
    for (const Row& row : rows_) {
      if (row.is_free) continue;
      sum += row.a * (row.p - row.low) + (row.bounded ? row.b * (row.high - row.p) : 0);
      count += row.bounded ? 2 : 1;
    }
    return count > 0 ? sum / count : 0;
  }

  struct Step {
    Eigen::VectorXd x, p;
    std::vector<double> a, b;
  };

  /// Newton's step for products `target`, `more` what products of an earlier step leave [Mehrotra 1992].
  Step newton(const Eigen::LLT<Eigen::MatrixXd>& factor, double target, const Step* before) const {
    const auto n = rows_.size();
    Eigen::VectorXd rest(r_.size()), right = r_ - S_ * x_;
    std::vector<double> wa(n, 0), wb(n, 0);
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const Row& row = rows_[k];
      if (row.is_free) continue;
      wa[k] = target - (before ? before->a[k] * before->p[i] : 0);
      wb[k] = target + (before ? before->b[k] * before->p[i] : 0);
      rest[i] = wa[k] / (row.p - row.low) - row.a - (row.bounded ? wb[k] / (row.high - row.p) - row.b : 0);
      right[i] += row.p + rest[i] / row.ease();
    }
    Step s{kerf::solve(factor, right), Eigen::VectorXd::Zero(r_.size()), std::vector<double>(n, 0),
           std::vector<double>(n, 0)};
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const Row& row = rows_[k];
      if (row.is_free) continue;
      s.p[i] = (rest[i] - s.x[i]) / row.ease();
      s.a[k] = (wa[k] - row.a * s.p[i]) / (row.p - row.low) - row.a;
      if (row.bounded) s.b[k] = (wb[k] + row.b * s.p[i]) / (row.high - row.p) - row.b;
    }
    return s;
  }

  /// The share of a step that stays inside.
  double reach(const Step& s) const {
    double share = 1;
    const auto stay = [&](double value, double change) {
      if (change < 0) share = std::min(share, -value / change);
    };
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const Row& row = rows_[k];
      if (row.is_free) continue;
      const double dp = s.p[static_cast<Eigen::Index>(k)];
      stay(row.a, s.a[k]);
      stay(row.p - row.low, dp);
      if (!row.bounded) continue;
      stay(row.b, s.b[k]);
      stay(row.high - row.p, -dp);
    }
    return share;
  }

  void move(const Step& s, double share) {
    x_ += share * s.x;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      rows_[k].a += share * s.a[k];
      rows_[k].b += share * s.b[k];
      rows_[k].p += share * s.p[static_cast<Eigen::Index>(k)];
    }
  }

  // The prediction aims at mu = 0; the cube of what it could reach of that is the share of mu that the correction aims
  // at. Steps end at 0.995 of the way to the nearest bound.
  bool advance() {
    check_stop();
    Eigen::MatrixXd raised = S_;
    for (std::size_t k = 0; k < rows_.size(); ++k)
      if (!rows_[k].is_free) raised.diagonal()[static_cast<Eigen::Index>(k)] += 1 / rows_[k].ease();
    const Eigen::LLT<Eigen::MatrixXd> factor = cholesky(raised);
    if (factor.info() != Eigen::Success) return false;
    const double now = mean_product();
    const Step straight = newton(factor, 0, nullptr);
    if (!straight.x.allFinite()) return false;
    Interior tried = Interior(*this);
    tried.move(straight, reach(straight));
    const double centering = std::pow(tried.mean_product() / now, 3);
    const Step step = newton(factor, centering * now, &straight);
    if (!step.x.allFinite()) return false;
    constexpr double inside = 0.995;
    move(step, std::min(1.0, inside * reach(step)));
    return true;
  }

  // A row moves where its part of the jump times S_ii, a force, is larger than the distance of its force from the
  // limit: of the two factors of a product the one that stays.
  std::vector<Motion> motions() const {
    std::vector<Motion> motion(rows_.size(), Motion::Forward);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const Row& row = rows_[k];
      const auto i = static_cast<Eigen::Index>(k);
      if (row.is_free) {
        motion[k] = x_[i] < 0 ? Motion::Backward : Motion::Forward;
      } else if (row.bounded) {
        const double forward = row.a * S_(i, i) - (row.p - row.low), backward = row.b * S_(i, i) - (row.high - row.p);
        motion[k] = std::max(forward, backward) < 0 ? Motion::Held
                    : forward > backward            ? Motion::Forward
                                                    : Motion::Backward;
      } else if (row.a * S_(i, i) < row.p) {
        motion[k] = Motion::Held;
      }
    }
    return motion;
  }

  const Eigen::MatrixXd& S_;
  const Eigen::VectorXd& r_;
  std::vector<Row> rows_;
  Eigen::VectorXd x_;
};

}  // namespace

std::vector<Motion> interior_set(const Eigen::MatrixXd& S, const Eigen::VectorXd& r,
                                 const std::vector<ContactPoint>& points) {
  return Interior(S, r, points)();
}

}  // namespace kerf
