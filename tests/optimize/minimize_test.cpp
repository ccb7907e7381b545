// The methods for nonlinear programs against minima known by hand, with every way that a trial may fail; what is said
// of the end must be so.

#include "optimize/parametric/minimize.hpp"

#include "base/nonnegative.hpp"
#include "kerf/types.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::minimize_test {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

/// min sqrt(y) such that y >= (a x + b)^3 for (a, b) = (2, 0) and (-1, 1): x = 1/3, y = 8/27, f = sqrt(8/27).
Program tutorial() {
  Program p;
  p.lower = Vector2d(-5, 1e-3);
  p.upper = Vector2d(5, 10);
  p.constraints = 2;
  p.evaluate = [](const VectorXd& x, bool gradients) {
    Evaluation e{x, VectorXd(3), Eigen::MatrixXd(2, gradients ? 3 : 0)};
    e.values[0] = std::sqrt(x[1]);
    if (gradients) e.gradients.col(0) << 0, 0.5 / e.values[0];
    const double a[] = {2, -1}, b[] = {0, 1};
    for (int j = 0; j < 2; ++j) {
      const double s = a[j] * x[0] + b[j];
      e.values[1 + j] = s * s * s - x[1];
      if (gradients) e.gradients.col(1 + j) << 3 * a[j] * s * s, -1;
    }
    return e;
  };
  return p;
}

const std::vector<Vector2d> starts = {{1.234, 5.678}, {0, 1},  {1, 9},  {-1, 9},   {0.333, 0.297},
                                      {2, 0.5},       {-2, 1}, {-4, 4}, {4.5, 0.1}};

TEST(Minimize, EveryMethodEndsAtTheMinimumOfTheTutorialFromNineStarts) {
  const double exact = std::sqrt(8.0 / 27);
  for (const OptimizeMethod method : nlopt_methods)
    for (const Vector2d& start : starts) {
      const Minimum m = minimize(tutorial(), start, method, {.evaluations = 600, .kkt = 1e-6});
      EXPECT_TRUE(m.feasible) << word(method) << " from " << start.transpose() << ": " << m.reason;
      EXPECT_NEAR(m.best.values[0], exact, 1e-5) << word(method) << " from " << start.transpose() << ": " << m.reason;
      EXPECT_TRUE(m.converged) << word(method) << " from " << start.transpose() << ": " << m.reason;
      EXPECT_LE(m.kkt, 1e-6);
      EXPECT_NEAR(m.best.x[0], 1.0 / 3, 1e-4);
    }
}

TEST(Minimize, NloptsWrongSuccessesAreNoted) {
  int wrong = 0;
  for (const OptimizeMethod method : {OptimizeMethod::Ccsaq, OptimizeMethod::Slsqp})
    for (const Vector2d& start : starts)
      wrong += static_cast<int>(!minimize(tutorial(), start, method, {.evaluations = 600, .kkt = 1e-6}).notes.empty());
  EXPECT_GE(wrong, 1);
}

TEST(Minimize, KktResidualIsSmallAtTheMinimumOnly) {
  const Program p = tutorial();
  const auto residual = [&](const Vector2d& x) {
    const Evaluation e = p.evaluate(x, true);
    return kkt_residual(e, p.lower, p.upper, scale_of(e, p.lower, p.upper));
  };
  EXPECT_LT(residual({1.0 / 3, 8.0 / 27}), 1e-12);
  EXPECT_GT(residual({0.5, 1}), 0.01);        // on one constraint
  EXPECT_GT(residual({1.0 / 3, 0.5}), 0.01);  // above both
  EXPECT_GT(residual({1.0, 8}), 0.1);         // on one constraint, far up
}

TEST(Minimize, BoundsAndFixedVariablesCarryMultipliers) {
  Program p;
  p.lower = Eigen::Vector3d(0, 0, 2);
  p.upper = Eigen::Vector3d(1, 1, 2);
  p.evaluate = [](const VectorXd& x, bool) {
    Evaluation e{x, VectorXd(1), Eigen::MatrixXd(3, 1)};
    e.values[0] = std::pow(x[0] - 2, 2) + std::pow(x[1] + 1, 2) + x[2];  // at (1, 0, 2)
    e.gradients.col(0) << 2 * (x[0] - 2), 2 * (x[1] + 1), 1;
    return e;
  };
  for (const OptimizeMethod method : nlopt_methods) {
    const Minimum m = minimize(p, Eigen::Vector3d(0.3, 0.6, 2), method, {.evaluations = 300, .kkt = 1e-4});
    EXPECT_TRUE(m.converged) << word(method) << ": " << m.reason;
    EXPECT_NEAR((m.best.x - Eigen::Vector3d(1, 0, 2)).norm(), 0, 1e-4) << word(method);
  }
  p.lower = p.upper = Eigen::Vector3d(0.5, 0.5, 2);
  const Minimum m = minimize(p, p.lower, OptimizeMethod::Mma, {});
  EXPECT_TRUE(m.converged);
  EXPECT_EQ(m.evaluations, 1);
  EXPECT_EQ(m.reason, "no variable is free");
}

TEST(Minimize, AnInfeasibleEndIsCalledInfeasible) {
  Program p;
  p.lower = VectorXd::Zero(1);
  p.upper = VectorXd::Ones(1);
  p.constraints = 2;
  p.evaluate = [](const VectorXd& x, bool gradients) {
    Evaluation e{x, VectorXd(3), Eigen::MatrixXd(1, gradients ? 3 : 0)};
    e.values << x[0], 0.7 - x[0], x[0] - 0.3;  // least violation 0.2 at 0.5
    if (gradients) e.gradients << 1, -1, 1;
    return e;
  };
  for (const OptimizeMethod method : nlopt_methods) {
    const Minimum m = minimize(p, VectorXd::Constant(1, 0.9), method, {.evaluations = 200});
    EXPECT_FALSE(m.feasible) << word(method);
    EXPECT_FALSE(m.converged) << word(method);
    EXPECT_EQ(m.reason.rfind("constraints are violated", 0), 0u) << word(method) << ": " << m.reason;
    EXPECT_GE(m.violation, 0.2 - 1e-9);
    EXPECT_LE(m.violation, 0.201) << word(method);
  }
}

/// x + y on a disc about (0.8, 0.2): least at (0.8, 0.2) - 0.1 (1, 1) / sqrt(2).
Program on_a_disc() {
  Program p;
  p.lower = Vector2d(0, 0);
  p.upper = Vector2d(1, 1);
  p.constraints = 1;
  p.evaluate = [](const VectorXd& x, bool gradients) {
    const Vector2d d = x - Vector2d(0.8, 0.2);
    Evaluation e{x, VectorXd(2), Eigen::MatrixXd(2, gradients ? 2 : 0)};
    e.values << x[0] + x[1], d.norm() - 0.1;
    if (gradients) {
      e.gradients.col(0) << 1, 1;
      e.gradients.col(1) = d.normalized();
    }
    return e;
  };
  return p;
}

TEST(Minimize, FeasibilityIsRestoredWhereNloptGivesUp) {
  const Program p = on_a_disc();  // started far from it
  for (const OptimizeMethod method : nlopt_methods) {
    const Minimum m = minimize(p, Vector2d(0.05, 0.95), method, {.evaluations = 300, .kkt = 1e-4});
    EXPECT_TRUE(m.converged) << word(method) << ": " << m.reason;
    EXPECT_NEAR(m.best.values[0], 1 - 0.1 * std::sqrt(2.0), 1e-4) << word(method) << ": " << m.reason;
  }
}

TEST(Minimize, ExceptionsComeThroughNlopt) {
  for (const OptimizeMethod method : nlopt_methods) {
    Program p = tutorial();
    int calls = 0;
    p.evaluate = [&calls, inner = p.evaluate](const VectorXd& x, bool gradients) {
      if (++calls == 4) throw Error(Fault::Numerics, "the fourth");
      return inner(x, gradients);
    };
    try {
      minimize(p, starts[0], method, {.kkt = 1e-6});
      ADD_FAILURE() << word(method);
    } catch (const Error& error) {
      EXPECT_STREQ(error.what(), "the fourth");
      EXPECT_EQ(error.fault, Fault::Numerics);
    }
    EXPECT_EQ(calls, 4);
  }
}

TEST(Minimize, StopsWhenAskedAndWhenEvaluationsAreUsed) {
  for (const OptimizeMethod method : nlopt_methods) {
    Program p = tutorial();
    int calls = 0;
    p.see = [&calls](const Evaluation&, double) { return ++calls < 3; };
    const Minimum asked = minimize(p, starts[0], method, {.kkt = 1e-6});
    EXPECT_TRUE(asked.asked_to_stop);
    EXPECT_EQ(asked.evaluations, 3);
    p.see = nullptr;
    const Minimum used = minimize(p, starts[0], method, {.evaluations = 5, .kkt = 1e-6});
    EXPECT_EQ(used.evaluations, 5);
    EXPECT_FALSE(used.converged);
    EXPECT_NE(used.reason.find("evaluations are used"), std::string::npos);
  }
}

TEST(Minimize, ARunRepeatsBitForBitFromRememberedEvaluations) {
  for (const OptimizeMethod method : nlopt_methods) {
    Program p = tutorial();
    std::vector<Evaluation> all;
    p.see = [&all](const Evaluation& e, double) {
      all.push_back(e);
      return true;
    };
    const Stop stop{.evaluations = 400, .kkt = 1e-6};
    const Minimum whole = minimize(p, starts[2], method, stop);
    p.see = nullptr;
    std::size_t next = 0;
    p.evaluate = [&](const VectorXd& x, bool) {
      EXPECT_EQ(all[next].x, x) << word(method);
      return all[next++];
    };
    const Minimum again = minimize(p, starts[2], method, stop);
    EXPECT_EQ(next, all.size()) << word(method);
    EXPECT_EQ(again.best.x, whole.best.x) << word(method);
    EXPECT_EQ(again.best.values, whole.best.values) << word(method);
    EXPECT_EQ(again.reason, whole.reason) << word(method);
  }
}

/// (x - 2)^2 + (y - 1/2)^2 in the unit square, where nothing is known for x > 0.6 (`known`: but a constraint there).
Program with_a_wall(bool known) {
  Program p;
  p.lower = Vector2d(0, 0);
  p.upper = Vector2d(1, 1);
  p.constraints = 1;
  p.evaluate = [known](const VectorXd& x, bool gradients) {
    Evaluation e{x, VectorXd(2), Eigen::MatrixXd(2, gradients ? 2 : 0)};
    e.values << std::pow(x[0] - 2, 2) + std::pow(x[1] - 0.5, 2), (known ? x[0] - 0.6 : -1.0);
    if (gradients) {
      e.gradients.col(0) << 2 * (x[0] - 2), 2 * (x[1] - 0.5);
      e.gradients.col(1) << (known ? 1.0 : 0.0), 0;
    }
    if (x[0] > 0.6 + 1e-9) {
      e.failure = "there is a wall";
      e.values[0] = std::nan("");
    }
    return e;
  };
  return p;
}

TEST(Minimize, FailedTrialsAreAnsweredByTheConstraintsOrByTheirNeighbors) {
  for (const OptimizeMethod method : nlopt_methods) {
    const Minimum m = minimize(with_a_wall(true), Vector2d(0.1, 0.9), method, {.evaluations = 200, .kkt = 1e-4});
    EXPECT_TRUE(m.feasible) << word(method) << ": " << m.reason;
    EXPECT_NEAR(m.best.x[0], 0.6, 1e-3) << word(method) << ": " << m.reason;
    EXPECT_NEAR(m.best.x[1], 0.5, 1e-2) << word(method) << ": " << m.reason;
    // Without a constraint: it comes close, is no minimum, and says so.
    const Minimum n = minimize(with_a_wall(false), Vector2d(0.1, 0.9), method, {.evaluations = 200, .kkt = 1e-4});
    EXPECT_LE(n.best.x[0], 0.6 + 1e-9);
    EXPECT_GT(n.best.x[0], 0.5) << word(method) << ": " << n.reason;
    EXPECT_FALSE(n.converged);
    ASSERT_EQ(n.failure.size(), 1u) << word(method);
    EXPECT_EQ(n.failure[0], "there is a wall");
  }
}

// Nothing at all is known of a failed trial, not even the constraint.
TEST(Minimize, FailedTrialsMayTellNothing) {
  for (const OptimizeMethod method : nlopt_methods) {
    Program p = with_a_wall(false);
    p.evaluate = [inner = p.evaluate](const VectorXd& x, bool gradients) {
      Evaluation e = inner(x, gradients);
      return e.failure.empty() ? e : Evaluation{x, {}, {}, e.failure};
    };
    const Minimum m = minimize(p, Vector2d(0.1, 0.9), method, {.evaluations = 200, .kkt = 1e-4});
    EXPECT_TRUE(m.feasible) << word(method) << ": " << m.reason;
    EXPECT_LE(m.best.x[0], 0.6 + 1e-6) << word(method) << ": " << m.reason;
    EXPECT_GT(m.best.x[0], 0.5) << word(method) << ": " << m.reason;
    EXPECT_EQ(m.failure, std::vector<std::string>{"there is a wall"});
  }
}

// Values that cobyla can do with, and derivatives that nobody can compute.
TEST(Minimize, DerivativesThatFailEverywhereAreNoOptimum) {
  Program p = tutorial();
  p.evaluate = [inner = p.evaluate](const VectorXd& x, bool gradients) {
    return gradients ? Evaluation{x, {}, {}, "no derivative"} : inner(x, false);
  };
  const Minimum m = minimize(p, starts[0], OptimizeMethod::Cobyla, {.evaluations = 600});
  EXPECT_FALSE(m.converged);
  EXPECT_TRUE(m.feasible);
  EXPECT_NEAR(m.best.values[0], std::sqrt(8.0 / 27), 1e-3) << m.reason;
  EXPECT_EQ(m.failure, std::vector<std::string>{"no derivative"});
  EXPECT_TRUE(std::isnan(m.kkt));
}

// Wherever it is made to stop, what it says of the best point is so.
TEST(Minimize, WhatIsSaidOfTheEndIsSo) {
  std::vector<Stop> stops;
  for (const int evaluations : {1, 2, 4, 8, 12, 16, 24, 32, 48, 200})
    stops.push_back({.evaluations = evaluations, .kkt = 1e-4});
  for (const double loose : {0.5, 0.1, 1e-2, 1e-3}) {
    stops.push_back({.kkt = 1e-5, .value = loose});
    stops.push_back({.kkt = 1e-5, .step = loose, .simplex = 0.02});
  }
  for (const bool gradients : {true, false})
    for (const OptimizeMethod method : nlopt_methods)
      for (const Vector2d& start : {Vector2d(0.05, 0.95), Vector2d(0.8, 0.2), Vector2d(0.9, 0.6)})
        for (const Stop& stop : stops) {
          if (!gradients && method != OptimizeMethod::Cobyla) continue;
          Program p = on_a_disc();
          p.gradients = gradients;
          int calls = 0;
          double least = infinity, violation = infinity;
          p.see = [&](const Evaluation& e, double) {
            ++calls;
            violation = std::min(violation, std::max(0.0, e.values[1]));
            if (e.values[1] <= stop.feasibility) least = std::min(least, e.values[0]);
            return true;
          };
          const Minimum m = minimize(p, start, method, stop);
          const std::string what = std::string(word(method)) + ": " + m.reason;
          EXPECT_EQ(m.evaluations, calls) << what;
          EXPECT_LE(m.evaluations, stop.evaluations) << what;
          EXPECT_EQ(m.violation, std::max(0.0, m.best.values[1])) << what;
          EXPECT_EQ(m.feasible, m.violation <= stop.feasibility) << what;
          EXPECT_EQ(m.feasible, std::isfinite(least)) << what;
          if (m.feasible && !m.converged) {
            EXPECT_EQ(m.best.values[0], least) << what;
          }
          if (!m.feasible) {
            EXPECT_EQ(m.violation, violation) << what;
            EXPECT_EQ(m.reason.rfind("constraints are violated", 0), 0u) << what;
          }
          if (m.converged && gradients) {
            EXPECT_LE(m.kkt, stop.kkt) << what;
            EXPECT_NEAR(m.best.values[0], 1 - 0.1 * std::sqrt(2.0), 1e-3) << what;
          }
          EXPECT_FALSE(m.asked_to_stop);
        }
}

TEST(Minimize, NothingFreeIsJudgedAsItIs) {
  Program p = on_a_disc();
  p.lower = p.upper = Vector2d(0.8, 0.5);
  const Minimum m = minimize(p, p.lower, OptimizeMethod::Slsqp, {});
  EXPECT_FALSE(m.converged);
  EXPECT_EQ(m.reason, "constraints are violated by 0.2: no variable is free");
  p.see = [](const Evaluation&, double) { return false; };
  const Minimum asked = minimize(p, p.lower, OptimizeMethod::Slsqp, {});
  EXPECT_TRUE(asked.asked_to_stop);
  EXPECT_EQ(asked.reason, "constraints are violated by 0.2: told to stop");
}

TEST(Minimize, SaysWhatIsWrongWithTheQuestion) {
  const Program p = tutorial();
  EXPECT_THROW(minimize(p, starts[0], OptimizeMethod::LevelSet, {}), Error);
  EXPECT_THROW(minimize(p, Vector2d(7, 1), OptimizeMethod::Mma, {}), Error);
  Program blind = p;
  blind.gradients = false;
  EXPECT_THROW(minimize(blind, starts[0], OptimizeMethod::Mma, {}), Error);
  blind.evaluate = [inner = p.evaluate](const VectorXd& x, bool gradients) {
    EXPECT_FALSE(gradients);
    return inner(x, false);
  };
  const Minimum m = minimize(blind, starts[0], OptimizeMethod::Cobyla, {.evaluations = 600});
  EXPECT_TRUE(m.converged) << m.reason;
  EXPECT_TRUE(std::isnan(m.kkt));
  EXPECT_NEAR(m.best.values[0], std::sqrt(8.0 / 27), 1e-3);
}

TEST(Minimize, QuestionsWithoutAnAnswerAreErrors) {
  const auto fault = [](const Program& p, const VectorXd& start) {
    try {
      minimize(p, start, OptimizeMethod::Mma, {});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string bounds = "every variable needs a finite lower and upper bound, the lower one first";
  Program p = tutorial();
  EXPECT_EQ(fault(p, VectorXd::Zero(3)), bounds);
  p.upper[0] = infinity;
  EXPECT_EQ(fault(p, starts[0]), bounds);
  p = tutorial();
  p.lower[0] = -infinity;
  EXPECT_EQ(fault(p, starts[0]), bounds);
  p.lower[0] = 6;
  EXPECT_EQ(fault(p, starts[0]), bounds);
  p.lower = VectorXd::Zero(1);
  EXPECT_EQ(fault(p, starts[0]), bounds);
  p = tutorial();
  EXPECT_EQ(fault(p, Vector2d(0, 20)), "the start of variable 2 is 20; it has to lie between 0.001 and 10");
  // Values that are no numbers, too few of them, slopes that are none, and a start that cannot be evaluated.
  for (const int wrong : {0, 1, 2}) {
    p.evaluate = [wrong](const VectorXd& x, bool gradients) {
      Evaluation e = tutorial().evaluate(x, gradients);
      if (wrong == 0) e.values[1] = nan;
      if (wrong == 1) e.values.conservativeResize(2);
      if (wrong == 2) e.gradients(0, 0) = infinity;
      return e;
    };
    EXPECT_EQ(fault(p, starts[0]), "the functionals are not finite at a design");
  }
  p.evaluate = [](const VectorXd& x, bool) { return Evaluation{x, {}, {}, "it is torn"}; };
  EXPECT_EQ(fault(p, starts[0]), "the start of the design cannot be evaluated: it is torn");
}

TEST(Minimize, WithoutGradientsViolationsAreMinimizedAndTold) {
  Program p;
  p.lower = VectorXd::Zero(1);
  p.upper = VectorXd::Ones(1);
  p.constraints = 2;
  p.gradients = false;
  p.evaluate = [](const VectorXd& x, bool) {
    Evaluation e{x, VectorXd(3), Eigen::MatrixXd(1, 0)};
    e.values << x[0], 0.7 - x[0], x[0] - 0.3;  // least violation 0.2 at 0.5
    return e;
  };
  const Minimum m = minimize(p, VectorXd::Constant(1, 0.9), OptimizeMethod::Cobyla, {.evaluations = 300});
  EXPECT_FALSE(m.feasible);
  EXPECT_FALSE(m.converged);
  EXPECT_NEAR(m.violation, 0.2, 2e-3);
  EXPECT_TRUE(std::isnan(m.kkt));
}

TEST(Minimize, NothingToGainIsConverged) {
  Program p;
  p.lower = Vector2d(0, 0);
  p.upper = Vector2d(1, 1);
  p.evaluate = [](const VectorXd& x, bool) { return Evaluation{x, VectorXd::Zero(1), Eigen::MatrixXd::Zero(2, 1)}; };
  bool go_on = true;
  p.see = [&](const Evaluation&, double) { return go_on; };
  const Minimum m = minimize(p, Vector2d(0.2, 0.3), OptimizeMethod::Mma, {});
  EXPECT_TRUE(m.converged);
  EXPECT_EQ(m.kkt, 0);
  EXPECT_EQ(m.evaluations, 1);
  go_on = false;  // whoever looks on comes first
  const Minimum stopped = minimize(p, Vector2d(0.2, 0.3), OptimizeMethod::Mma, {});
  EXPECT_TRUE(stopped.asked_to_stop);
  EXPECT_FALSE(stopped.converged);
}

TEST(NonnegativeLeastSquares, AgreesWithTheOptimalityConditions) {
  for (unsigned seed = 1; seed < 30; ++seed) {
    std::srand(seed);
    const Eigen::MatrixXd A = Eigen::MatrixXd::Random(7, 5);
    const VectorXd b = VectorXd::Random(7);
    const VectorXd x = nonnegative_least_squares(A, b), slope = A.transpose() * (A * x - b);
    for (int i = 0; i < 5; ++i) {
      EXPECT_GE(x[i], 0);
      EXPECT_GE(slope[i], -1e-13);
      EXPECT_LT(std::abs(x[i] * slope[i]), 1e-13);
    }
  }
}

}  // namespace
}  // namespace kerf::minimize_test
