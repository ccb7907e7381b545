// The methods for contact and friction on matrices: the conditions of optimality themselves, enumeration of all
// statuses, single points by hand, and each other.

#include "solver/contact/contact.hpp"
#include "solver/contact/law.hpp"

#include "kerf/model.hpp"
#include "kerf/stop.hpp"
#include "solver/system.hpp"
#include "tests/support/exact.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <cmath>
#include <limits>
#include <random>

namespace kerf::contact_test {
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
  explicit Random(unsigned seed) : engine(seed) {}
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
  const auto entry = [](double distance) { return -1 / (pi * (distance * distance - 0.25)); };
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
  if (p.r.size() == 0) return 0;
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
  if (a.jump.size() == 0) return 0;
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
    EXPECT_LE(difference(*c, dual), tolerance) << which;
  }
}

TEST(Contact, RandomProblemsSatisfyTheOptimalityConditions) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const Index n = 1 + static_cast<Index>(seed % 40);
    const Problem p{random.definite(n, 1e-3), random.vector(n), normal_points(n)};
    const Contact c = dual_qp(p.S, p.r, p.points);
    EXPECT_TRUE(c.converged) << seed;
    EXPECT_LT(violation(p, c), 1e-12) << seed;
    EXPECT_LT(c.kkt, 1e-12) << seed;
  }
}

TEST(Contact, AllMethodsFindWhatEnumerationFinds) {
  for (unsigned seed = 0; seed < 240; ++seed) {
    Random random(seed);
    const bool slip = seed % 2 == 1;
    const Index n = 1 + static_cast<Index>(seed / 2 % (seed < 16 ? 4 : 3)), rows = slip ? 2 * n : n;
    const Problem p{random.definite(rows, 0.2), random.vector(rows),
                    slip ? pairs(n, 1.5 * random.uniform(), 0) : normal_points(n)};
    const Eigen::VectorXd jump = by_enumeration(p);
    EXPECT_LT((dual_qp(p.S, p.r, p.points).jump - jump).norm(), 1e-11 * (1 + jump.norm())) << seed;
    expect_all_agree(p, 1e-9, std::to_string(seed));
  }
}

TEST(Contact, ExchangesThatCycleGiveWayToDescent) {
  // Twelve jumps that hang together through six numbers: every tenth problem cycles.
  int frictionless = 0, tresca = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    Random random(seed);
    const bool slip = seed % 2 == 1;
    const Eigen::MatrixXd a = random.matrix(12, 6);
    const Problem p{a * a.transpose() + 1e-2 * Eigen::MatrixXd::Identity(12, 12), random.vector(12),
                    slip ? pairs(6, 0.1, 0) : normal_points(12)};
    const Contact c = dual_qp(p.S, p.r, p.points);
    if (c.iterations > 11) ++(slip ? tresca : frictionless);
    EXPECT_TRUE(c.converged) << seed;
    EXPECT_LT(c.iterations, 60) << seed;
    EXPECT_LT(violation(p, c), 1e-11) << seed;
    if (c.iterations <= 11) continue;
    int calls = 0;
    const Contact sets = active_set(eliminated(p, calls), p.points);
    EXPECT_LT(difference(sets, c), 1e-10) << seed;
    EXPECT_EQ(calls, sets.iterations + 1) << seed;
  }
  EXPECT_GT(frictionless, 20) << "the test has lost its point: hardly any problem cycles any more";
  EXPECT_GT(tresca, 20) << "the test has lost its point: hardly any problem cycles any more";
}

TEST(Contact, AllMethodsAgreeOnCracks) {
  for (const Index n : {20, 80}) {
    expect_all_agree(crack(n, 0, 0, 0, false), 1e-9, "frictionless " + std::to_string(n));
    for (const double friction : {0.0, 0.3, 2.0})
      for (const double slip_bound : {0.0, 0.03})
        for (const double coupling : {0.0, 0.4}) {
          const std::string which = fmt::format("{} {} {} {}", n, friction, slip_bound, coupling);
          expect_all_agree(crack(n, coupling, slip_bound, friction), 1e-9, which);
        }
  }
}

TEST(Contact, CoulombIsTrescaWithItsOwnLimits) {
  const Problem p = crack(60, 0.4, 0.01, 0.6);
  const Contact coulomb = dual_qp(p.S, p.r, p.points);
  Problem tresca = p;
  for (ContactPoint& q : tresca.points) {
    q.slip_bound += q.friction * coulomb.force[q.normal];
    q.friction = 0;
  }
  const Contact given = dual_qp(tresca.S, tresca.r, tresca.points);
  EXPECT_LT(difference(coulomb, given), 1e-12);
  EXPECT_EQ(coulomb.motion, given.motion);
}

TEST(Contact, CoulombOnRandomMatricesEndsInASolution) {
  // Friction up to 2 against a coupling as strong as the diagonal: beyond every theorem on uniqueness.
  int fixed_points = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    Random random(seed);
    const Index n = 1 + static_cast<Index>(seed % 12);
    const Problem p{random.definite(2 * n, 1e-2), random.vector(2 * n),
                    pairs(n, 0.3 * random.uniform(), 2 * random.uniform())};
    const Contact c = dual_qp(p.S, p.r, p.points);
    if (c.iterations > 11) ++fixed_points;
    EXPECT_TRUE(c.converged) << seed;
    EXPECT_LT(violation(p, c), 1e-11) << seed;
  }
  EXPECT_GT(fixed_points, 20) << "the test has lost its point: the exchanges always settle";
}

TEST(Contact, OnePointByHand) {
  const Eigen::Matrix2d S = (Eigen::Matrix2d() << 2, 0, 0, 4).finished();
  const auto solve = [&](double normal, double shear, double slip_bound, double friction) {
    Problem p{S, Eigen::Vector2d(normal, shear), pairs(1, slip_bound, friction)};
    expect_all_agree(p, 1e-11, fmt::format("{} {} {} {}", normal, shear, slip_bound, friction));
    return dual_qp(p.S, p.r, p.points);
  };
  const Contact forward = solve(-3, 2, 0.5, 0.25);  // limit 1.25
  EXPECT_EQ(forward.motion, (std::vector<Motion>{Motion::Held, Motion::Forward}));
  EXPECT_NEAR(forward.jump[1], 0.75 / 4, 1e-15);
  EXPECT_NEAR(forward.force[0], 3, 1e-15);
  EXPECT_NEAR(forward.force[1], -1.25, 1e-15);
  const Contact backward = solve(-3, -2, 0.5, 0.25);
  EXPECT_EQ(backward.motion, (std::vector<Motion>{Motion::Held, Motion::Backward}));
  EXPECT_NEAR(backward.jump[1], -0.75 / 4, 1e-15);
  EXPECT_NEAR(backward.force[1], 1.25, 1e-15);
  const Contact stick = solve(-3, 1, 0.5, 0.25);
  EXPECT_EQ(stick.motion, (std::vector<Motion>{Motion::Held, Motion::Held}));
  EXPECT_NEAR(stick.force[1], -1, 1e-15);
  const Contact open = solve(3, 2, 0, 0.25);
  EXPECT_NEAR(open.jump[0], 1.5, 1e-15);
  EXPECT_NEAR(open.jump[1], 0.5, 1e-15);
  EXPECT_EQ(open.force.norm(), 0);
  const Contact cohesive = solve(3, 2, 0.5, 0);
  EXPECT_NEAR(cohesive.jump[1], 1.5 / 4, 1e-15);
  EXPECT_NEAR(cohesive.force[1], -0.5, 1e-15);
}

TEST(Contact, AllOpenAllClosedAndNoLoad) {
  const Eigen::MatrixXd S = 2 * Eigen::MatrixXd::Identity(3, 3);
  const Unilateral open = solve_unilateral(S, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(open.closed, std::vector<bool>({false, false, false}));
  EXPECT_LT((open.jump - Eigen::Vector3d(0.5, 1, 1.5)).norm(), 1e-15);
  const Unilateral closed = solve_unilateral(S, Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ(closed.closed, std::vector<bool>({true, true, true}));
  EXPECT_EQ(closed.jump.norm(), 0);
  EXPECT_LT((closed.force - Eigen::Vector3d(1, 2, 3)).norm(), 1e-15);
  const Problem idle{Eigen::MatrixXd::Identity(4, 4), Eigen::VectorXd::Zero(4), pairs(2, 0.1, 0.3)};
  expect_all_agree(idle, 0, "idle");
  const Problem none_at_all{Eigen::MatrixXd(0, 0), Eigen::VectorXd(0), {}};
  expect_all_agree(none_at_all, 0, "no rows");
}

TEST(Contact, BiactivePointsDoNotDisturb) {
  // The pressure taken out of the load: the closed part has no gap and no pressure.
  Problem p = crack(30, 0, 0, 0, false);
  const Contact c = dual_qp(p.S, p.r, p.points);
  for (Index i = 0; i < 30; ++i)
    if (c.motion[i] == Motion::Held)
      p.r += p.S * Eigen::VectorXd::Unit(30, i) * 0 + c.force[i] * Eigen::VectorXd::Unit(30, i);
  expect_all_agree(p, 1e-9, "biactive");
  EXPECT_LT(difference(dual_qp(p.S, p.r, p.points), c), 1e-13);
}

TEST(Contact, UnitsDoNotMatter) {
  const Problem p = crack(40, 0.3, 0.02, 0.4);
  const Contact c = dual_qp(p.S, p.r, p.points);
  for (const double stiffness : {1e-20, 1e20})
    for (const double load : {1e-20, 1e20}) {
      Problem scaled{stiffness * p.S, load * p.r, p.points};
      for (ContactPoint& q : scaled.points) q.slip_bound *= load;
      expect_all_agree(scaled, 1e-9, fmt::format("{} {}", stiffness, load));
      const Contact d = dual_qp(scaled.S, scaled.r, scaled.points);
      EXPECT_EQ(c.motion, d.motion);
      EXPECT_LT((stiffness / load * d.jump - c.jump).norm(), 1e-12 * c.jump.norm());
    }
}

TEST(Contact, NearlySingularMatricesLoseWhatRoundingTakes) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    Random random(seed);
    const Index n = 12;
    const Eigen::MatrixXd q = random.matrix(n, n).householderQr().householderQ();
    const Eigen::VectorXd decay = Eigen::VectorXd::LinSpaced(n, 0, -12);
    const Eigen::VectorXd spectrum = decay.unaryExpr([](double e) { return std::pow(10, e); });
    const Eigen::MatrixXd S = q * spectrum.asDiagonal() * q.transpose();
    const Problem p{0.5 * (S + S.transpose()), random.vector(n),
                    seed % 2 == 1 ? pairs(n / 2, 0.3, seed % 4 == 1 ? 0 : 0.3) : normal_points(n)};
    const Contact c = dual_qp(p.S, p.r, p.points);
    const double rounding = (p.S.cwiseAbs() * c.jump.cwiseAbs()).maxCoeff() / p.r.cwiseAbs().maxCoeff() *
                            std::numeric_limits<double>::epsilon();
    EXPECT_TRUE(c.converged) << seed;
    EXPECT_LT(c.iterations, 200) << seed;
    EXPECT_LT(violation(p, c), 2 * rounding + 1e-14) << seed;
  }
}

TEST(Contact, AllMethodsAgreeOnAFactorizedBody) {
  const auto field = exact::crack_case("III");
  Scene scene;
  scene.material = field.material;
  scene.laws.resize(1);
  for (Index label = 0; label < 4; ++label)
    scene.supports.push_back({label, false, true, true, [&](const Vec2& x, const Vec2&) {
                                return field.displacement(x, exact::side_of(field, x));
                              }});
  const Model m = prepare(exact::crack_mesh(32), element("bdms"), scene, 1);
  const Problem p{m.inner->factor->contact_complement(),
                  m.inner->factor->contact_factor().triangularView<Eigen::Lower>() *
                      m.inner->factor->forward(m.inner->system.F).tail(m.inner->ordering.contact_rows),
                  normal_points(m.inner->ordering.contact_rows)};
  expect_all_agree(p, 1e-10, "case III");
  const Contact c = dual_qp(p.S, p.r, p.points);
  EXPECT_LE(c.iterations, 4);
  const State s = solve(m);
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    if (m.inner->skeleton.bounded[u]) {
      EXPECT_NEAR(s.skeleton[u], c.jump[m.inner->ordering.row[u] - m.inner->ordering.leading()],
                  1e-11 * c.jump.maxCoeff());
    }
}

TEST(Contact, ABudgetEndsTheSearch) {
  const Problem p = crack(80, 0.4, 0, 0.3);
  int calls = 0;
  Eliminated system = eliminated(p, calls);
  system.most_iterations = 2;
  const Contact c = active_set(system, p.points);
  EXPECT_FALSE(c.converged);
  EXPECT_EQ(c.iterations, 3);  // and one to answer for the last set
  EXPECT_GT(c.kkt, 1e-6);
  const Problem indefinite{Eigen::Vector2d(1, -1).asDiagonal(), Eigen::Vector2d(1, 1), normal_points(2)};
  EXPECT_FALSE(dual_qp(indefinite.S, indefinite.r, indefinite.points).converged);
  EXPECT_FALSE(uzawa(indefinite.S, indefinite.r, indefinite.points).converged);
}

TEST(Contact, AllMethodsStopWhenAsked) {
  const Problem p = crack(80, 0.4, 0.01, 0.3);
  int calls = 0;
  const Eliminated system = eliminated(p, calls);
  request_stop();
  EXPECT_THROW(dual_qp(p.S, p.r, p.points), Stopped);
  EXPECT_THROW(uzawa(p.S, p.r, p.points), Stopped);
  EXPECT_THROW(active_set(system, p.points), Stopped);
  EXPECT_THROW(interior_set(p.S, p.r, p.points), Stopped);
  forget_stop();
  EXPECT_TRUE(dual_qp(p.S, p.r, p.points).converged);
}

TEST(Contact, TheSolutionIsItsOwnGuess) {
  const Problem p = crack(80, 0.4, 0.01, 0.3);
  const Contact c = dual_qp(p.S, p.r, p.points), again = dual_qp(p.S, p.r, p.points, c.motion);
  EXPECT_LE(again.iterations, 2);
  EXPECT_EQ(again.motion, c.motion);
  EXPECT_LT(difference(again, c), 1e-13);
}

// A beam above a foundation that is pressed and pulled in turn: its matrix has the condition 1e10, and exchanges take
// many sets. What the set says is optimal: forces press, jumps open.
TEST(InteriorSet, IsOptimalForABeam) {
  const Index n = 120;
  Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(n + 2, n);
  for (Index i = 0; i < n; ++i) {
    curvature(i, i) = 1;
    curvature(i + 1, i) = -2;
    curvature(i + 2, i) = 1;
  }
  const Eigen::MatrixXd S = 1e4 * curvature.transpose() * curvature + 1e-3 * Eigen::MatrixXd::Identity(n, n);
  const Eigen::VectorXd r =
      Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return std::sin(0.31 * double(i)) - 0.2; });
  const std::vector<Motion> set = interior_set(S, r, normal_points(n));
  std::vector<Index> moving;
  for (Index i = 0; i < n; ++i)
    if (set[i] != Motion::Held) moving.push_back(i);
  ASSERT_FALSE(moving.empty());
  ASSERT_LT(moving.size(), static_cast<std::size_t>(n));
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(n);
  const Eigen::VectorXd load = r(moving), moved = S(moving, moving).llt().solve(load);
  jump(moving) = moved;
  EXPECT_GE(moved.minCoeff(), 0);
  const Eigen::VectorXd force = S * jump - r;
  for (Index i = 0; i < n; ++i) EXPECT_GE(set[i] == Motion::Held ? force[i] : 0.0, 0) << i;
  const Contact c = dual_qp(S, r, normal_points(n));
  EXPECT_TRUE(c.converged);
  EXPECT_EQ(c.motion, set);
}

TEST(InteriorSet, KnowsSlipBoundsAndFreeRows) {
  Random random(5);
  const Index n = 20;
  const Eigen::MatrixXd S = random.definite(2 * n, 0.1);
  const Eigen::VectorXd r = random.vector(2 * n);
  for (const double bound : {0.0, 0.3}) {
    const std::vector<ContactPoint> points = pairs(n, bound, 0);
    const std::vector<Motion> set = interior_set(S, r, points);
    std::vector<Index> moving;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(2 * n), jump = Eigen::VectorXd::Zero(2 * n);
    for (Index i = 0; i < 2 * n; ++i) {
      if (set[i] == Motion::Held) continue;
      moving.push_back(i);
      if (i >= n) force[i] = -static_cast<double>(set[i]) * bound;
    }
    const Eigen::VectorXd load = r(moving) + force(moving), moved = S(moving, moving).llt().solve(load);
    jump(moving) = moved;
    EXPECT_LT(optimality(points, jump, S * jump - r, r.cwiseAbs().maxCoeff()), 1e-11) << bound;
  }
}

}  // namespace
}  // namespace kerf::contact_test
