#include "solver/contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include <cmath>
#include <numbers>
#include <random>

namespace kerf {
namespace {

struct Problem {
  Eigen::MatrixXd S;
  Eigen::VectorXd r;
  std::vector<ContactPoint> points;
};

std::vector<ContactPoint> normal_points(Index n) {
  std::vector<ContactPoint> points(n);
  for (Index i = 0; i < n; ++i) points[i].normal = i;
  return points;
}

// Normal rows first, then the tangential ones.
std::vector<ContactPoint> pairs(Index n, double slip_bound, double friction) {
  std::vector<ContactPoint> points(n);
  for (Index i = 0; i < n; ++i) points[i] = {i, n + i, slip_bound, friction};
  return points;
}

struct Random {
  std::mt19937 engine;
  std::normal_distribution<double> normal;
  explicit Random(unsigned seed) : engine(seed) {
  }
  Eigen::VectorXd vector(Eigen::Index n) {
    return Eigen::VectorXd::NullaryExpr(n, [&] { return normal(engine); });
  }
  Eigen::MatrixXd matrix(Eigen::Index n, Eigen::Index m) {
    return Eigen::MatrixXd::NullaryExpr(n, m, [&] { return normal(engine); });
  }
  Eigen::MatrixXd definite(Eigen::Index n, double shift) {
    const Eigen::MatrixXd a = matrix(n, n);
    return a * a.transpose() + shift * Eigen::MatrixXd::Identity(n, n);
  }
  double uniform() {
    return std::uniform_real_distribution<double>()(engine);
  }
};

// The operator of a crack of n edges of constant jumps in the infinite plane, S_ij ~ 1/(h ((i - j)^2 - 1/4)) times -h,
// for both directions, with a coupling between them as a kink, a second crack or an outer boundary makes it, and loads
// that press the left part and shear.
Problem crack(Index n, double coupling, double slip_bound, double friction, bool friction_rows = true) {
  Problem p;
  const Index rows = friction_rows ? 2 * n : n;
  p.S = Eigen::MatrixXd::Zero(rows, rows);
  p.r = Eigen::VectorXd::Zero(rows);
  const auto entry = [](double distance) { return -1 / (std::numbers::pi * (distance * distance - 0.25)); };
  for (Index i = 0; i < n; ++i) {
    const double x = (i + 0.5) / n;
    p.r[i] = (x - 0.4) / n;
    if (friction_rows) p.r[n + i] = 0.3 * std::cos(2.5 * x) / n;
    for (Index k = 0; k < n; ++k) {
      p.S(i, k) = entry(i - k);
      if (!friction_rows) continue;
      p.S(n + i, n + k) = entry(i - k);
      const double skew = coupling * entry(i - k) * std::sin(3.0 * (i + k) / (2 * n));
      p.S(i, n + k) = skew;
      p.S(n + k, i) = skew;
    }
  }
  p.points = friction_rows ? pairs(n, slip_bound / n, friction) : normal_points(n);
  return p;
}

// S behind a callback: what a sparse system would answer. Counts its calls.
Eliminated eliminated(const Problem& p, int& calls) {
  return {static_cast<Index>(p.r.size()),
          [&p, &calls](const std::vector<Motion>& motion, const Eigen::VectorXd& force) -> Response {
            ++calls;
            std::vector<Index> moving;
            for (Index i = 0; i < p.r.size(); ++i)
              if (motion[i] != Motion::Held) moving.push_back(i);
            Response response{Eigen::VectorXd::Zero(p.r.size()), -p.r};
            if (moving.empty()) return response;
            const Eigen::MatrixXd block = p.S(moving, moving);
            const Eigen::VectorXd load = p.r(moving) + force(moving), value = block.ldlt().solve(load);
            response.jump(moving) = value;
            response.force += p.S * response.jump;
            return response;
          }};
}

// The conditions of optimality themselves, whatever found the point; relative to the load and the largest jump.
double violation(const Problem& p, const Contact& c) {
  const double load = p.r.cwiseAbs().maxCoeff(), jump = std::max(c.jump.cwiseAbs().maxCoeff(), 1e-300);
  if (load == 0) return c.jump.norm() + c.force.norm();
  double worst = (p.S * c.jump - p.r - c.force).cwiseAbs().maxCoeff() / load;
  const auto see = [&](double v) { worst = std::max(worst, v); };
  for (const ContactPoint& q : p.points) {
    const double pn = c.force[q.normal] / load, jn = c.jump[q.normal] / jump;
    see(-pn);
    see(-jn);
    see(std::min(std::abs(pn), std::abs(jn)));
    if (q.tangential == none) continue;
    const double limit = q.slip_bound / load + q.friction * std::max(pn, 0.0), pt = c.force[q.tangential] / load;
    const double jt = c.jump[q.tangential] / jump;
    see(std::abs(pt) - limit);
    see(std::min(std::abs(jt), std::abs(pt + std::copysign(limit, jt))));
  }
  return worst;
}

double difference(const Contact& a, const Contact& b) {
  const double size = std::max(a.jump.cwiseAbs().maxCoeff(), b.jump.cwiseAbs().maxCoeff());
  return size > 0 ? (a.jump - b.jump).cwiseAbs().maxCoeff() / size : 0;
}

// All statuses tried one after another; the one that fits. For fixed limits alone.
Eigen::VectorXd by_enumeration(const Problem& p) {
  const Index n = static_cast<Index>(p.r.size());
  std::vector<double> bound(n, -1);  // slip bound of tangential rows
  for (const ContactPoint& q : p.points)
    if (q.tangential != none) bound[q.tangential] = q.slip_bound;
  int sets = 1;
  for (Index i = 0; i < n; ++i) sets *= 3;
  Eigen::VectorXd best;
  double least = 1e300;
  for (int code = 0; code < sets; ++code) {
    std::vector<int> sign(n);
    std::vector<Index> moving;
    bool possible = true;
    for (Index i = 0, rest = code; i < n; ++i, rest /= 3) {
      sign[i] = rest % 3 - 1;
      if (sign[i] != 0) moving.push_back(i);
      possible = possible && (sign[i] >= 0 || bound[i] >= 0);
    }
    if (!possible) continue;
    Eigen::VectorXd jump = Eigen::VectorXd::Zero(n), known = Eigen::VectorXd::Zero(n);
    for (Index i = 0; i < n; ++i) known[i] = bound[i] >= 0 ? -sign[i] * bound[i] : 0;
    const Eigen::MatrixXd block = p.S(moving, moving);
    const Eigen::VectorXd load = p.r(moving) + known(moving), value = block.ldlt().solve(load);
    jump(moving) = value;
    const Eigen::VectorXd force = p.S * jump - p.r;
    double wrong = 0;
    for (Index i = 0; i < n; ++i) {
      if (sign[i] != 0) wrong = std::max(wrong, -sign[i] * jump[i]);
      if (sign[i] == 0) wrong = std::max(wrong, bound[i] >= 0 ? std::abs(force[i]) - bound[i] : -force[i]);
    }
    if (wrong < least) {
      least = wrong;
      best = jump;
    }
  }
  EXPECT_LT(least, 1e-10);
  return best;
}

void expect_all_agree(const Problem& p, double tolerance, const std::string& which) {
  const Contact dual = dual_qp(p.S, p.r, p.points), steps = uzawa(p.S, p.r, p.points);
  int calls = 0;
  const Contact sets = active_set(eliminated(p, calls), p.points);
  EXPECT_EQ(sets.solves, calls) << which;
  for (const Contact* c : {&dual, &sets, &steps}) {
    EXPECT_TRUE(c->converged) << which;
    EXPECT_LT(violation(p, *c), 1e-11) << which;
    EXPECT_LT(c->kkt, 1e-11) << which;
    EXPECT_LT(difference(*c, dual), tolerance) << which;
  }
}

TEST(Contact, scratch_speed) {
  for (const Index n : {100, 500})
    for (const double f : {0.0, 0.3, 2.0})
      for (const double coupling : {0.0, 0.5}) {
        const Problem p = crack(n, coupling, 0.01, f);
        for (int m = 0; m < 2; ++m) {
          const auto t0 = std::chrono::steady_clock::now();
          const Contact c = m == 0 ? dual_qp(p.S, p.r, p.points) : uzawa(p.S, p.r, p.points);
          const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
          printf("n %d f %g coupling %g method %d: %g s its %d solves %d kkt %g viol %g conv %d\n", n, f, coupling, m, s,
                 c.iterations, c.solves, c.kkt, violation(p, c), c.converged);
        }
      }
}

TEST(Contact, scratch_random) {
  int bad = 0, failed = 0, most = 0;
  for (unsigned seed = 0; seed < 3000; ++seed) {
    Random random(seed);
    const Index n = 1 + seed % 12;
    Problem p{random.definite(2 * n, 1e-2), random.vector(2 * n), pairs(n, 0.3 * random.uniform(), seed % 3 == 0 ? 0 : 2 * random.uniform())};
    const Contact c = dual_qp(p.S, p.r, p.points);
    most = std::max(most, c.iterations);
    if (!c.converged) { ++failed; printf("seed %u n %d f %g its %d kkt %g\n", seed, n, p.points[0].friction, c.iterations, c.kkt); }
    if (violation(p, c) > 1e-10) ++bad;
    int calls=0; const Contact d = active_set(eliminated(p, calls), p.points), u = uzawa(p.S, p.r, p.points);
    static int bu=0, nu=0, ba=0; if (u.converged) { ++nu; if (difference(c,u)>1e-8) printf("uz seed %u n %d diff %g viol %g f %g cviol %g\n", seed, n, difference(c,u), violation(p,u), p.points[0].friction, violation(p,c)); } if (difference(c,d)>1e-9) printf("as %u %g\n", seed, difference(c,d)); if (seed==2999) printf("uzawa conv %d\n", nu);
  }
  printf("bad %d failed %d most %d\n", bad, failed, most);
}

}  // namespace
}  // namespace kerf
