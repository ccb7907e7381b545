// K from a stress field, no mesh. Truths from outside: a crack at a circular hole (exact, by dislocations outside the
// circle), the disc, and worst angles under compression.

#include "inspect/expansion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace kerf::inspect::expansion_test {
namespace {

constexpr double degree = pi / 180;

/// Stress (s11, s22, s12) at (x, y) in the frame of the place.
using Field = std::function<Eigen::Vector3d(double x, double y)>;

LocalStress near(const Field& field, double length) {
  Eigen::Matrix<double, 3, samples> values;
  for (int i = 0; i < samples; ++i) {
    const Vec2 x = length * sample_places()[static_cast<std::size_t>(i)];
    values.col(i) = field(x.x(), x.y());
  }
  return fit_stress(values, values.col(0).tail<2>());
}

/// Kirsch: a plate with a hole of radius 1 under the stress `all` all round and `along` x besides; at the rim in the
/// direction `angle`.
Field hole(double all, double along, double angle) {
  return [=](double x, double y) -> Eigen::Vector3d {
    const Vec2 inward(std::cos(angle), std::sin(angle)), tangent(inward.y(), -inward.x());
    const Vec2 at = inward + x * tangent + y * inward;
    const double r2 = at.squaredNorm(), t = std::atan2(at.y(), at.x()), q = 1 / r2;
    const double rr = all * (1 - q) + along / 2 * ((1 - q) + (1 - 4 * q + 3 * q * q) * std::cos(2 * t));
    const double tt = all * (1 + q) + along / 2 * ((1 + q) - (1 + 3 * q * q) * std::cos(2 * t));
    const double rt = -along / 2 * (1 + 2 * q - 3 * q * q) * std::sin(2 * t);
    const Vec2 er = at.normalized(), et(-er.y(), er.x());
    const Mat2 s =
        rr * er * er.transpose() + tt * et * et.transpose() + rt * (er * et.transpose() + et * er.transpose());
    return {tangent.dot(s * tangent), inward.dot(s * inward), tangent.dot(s * inward)};
  };
}

double factor(const Field& field, double length, double curvature) {
  static const Mouths mouths(0);
  return intensity(mouths, near(field, length), {length, curvature}, pi / 2).K_I / std::sqrt(pi * length);
}

TEST(Expansion, OfACrackAtAHole) {
  struct Row {
    double a, all_round, uniaxial, near;
  };
  for (const Row& row : {Row{.002, 2.236973, 3.350027, 1e-4},
                         {.01, 2.213163, 3.293175, 1e-3},
                         {.05, 2.104514, 3.037342, 0.007},
                         {.1, 1.989085, 2.772722, 0.02},
                         {.17, 1.856417, 2.479210, 0.05}}) {
    EXPECT_NEAR(factor(hole(1, 0, 0.3), row.a, -1), row.all_round, row.near * row.all_round) << row.a;

    EXPECT_NEAR(factor(hole(0, 1, pi / 2), row.a, -1), row.uniaxial, row.near * row.uniaxial) << row.a;
  }
}

// At 45 degrees round the rim the stress changes along it, which makes shear grow with depth.
TEST(Expansion, TheStressAlongTheBoundaryTurnsTheCrack) {
  const Mouths mouths(0);
  const LocalStress stress = near(hole(0, 1, 45 * degree), 0.02);
  const double straight = intensity(mouths, stress, {0.02, -1}, pi / 2).K_II;
  EXPECT_GT(std::abs(straight), 0.01 * std::sqrt(pi * 0.02));
  const double beta = worst_angle(mouths, stress, {0.02, -1});
  EXPECT_GT(std::abs(beta - pi / 2), 0.5 * degree);
  // The mirror image turns the other way.
  const LocalStress mirrored = near(hole(0, 1, 135 * degree), 0.02);
  EXPECT_NEAR(worst_angle(mouths, mirrored, {0.02, -1}), pi - beta, 2e-3);
}

// By dislocations outside the circle, with Kirsch's tractions along the crack: at 43.2226 degrees round the rim, at
// 107.091 to it.
TEST(Expansion, OfALeaningCrackAtAHole) {
  struct Row {
    double a, K_I, K_II, near;
  };
  const Mouths mouths(0);
  const double angle = std::atan2(.684834, .728699);
  for (const Row& row :
       {Row{.02, .23762207, .03102997, 1e-3}, {.05, .38788042, .02315589, 5e-3}, {.1, .568294, -.02032068, 0.016}}) {
    const EdgeIntensity k = intensity(mouths, near(hole(0, 1, angle), row.a), {row.a, -1}, 107.091 * degree);
    EXPECT_NEAR(k.K_I, row.K_I, row.near * row.K_I);
    EXPECT_NEAR(k.K_II, row.K_II, row.near * row.K_I);
  }
}

TEST(Expansion, OfADisc) {
  const double R = 1;
  for (const double a : {0.02, 0.1, 0.17})
    EXPECT_NEAR(factor([](double, double) { return Eigen::Vector3d(1, 1, 0); }, a, 1 / R),
                1.1215222552 * std::pow(1 - a / (2 * R), -1.5), 0.53 * a * a + 0.4 * a * a * a);
}

Field uniform(double along) {
  return [along](double, double) { return Eigen::Vector3d(along, 0, 0); };
}

TEST(Expansion, WorstAngles) {
  EXPECT_NEAR(worst_angle(Mouths(0), near(uniform(1), 0.1), {0.1}), pi / 2, 1e-3);
  // The best of a table in steps of 5 degrees.
  struct Row {
    double friction, degrees, F;
  };
  for (const Row& row : {Row{0, 45, .532195}, {0.1, 40, .48061}, {0.3, 35, .39575}}) {
    const Mouths mouths(row.friction);
    const LocalStress stress = near(uniform(-1), 0.1);
    const double root = std::sqrt(pi * 0.1), beta = worst_angle(mouths, stress, {0.1});
    EXPECT_NEAR(std::abs(intensity(mouths, stress, {0.1}, row.degrees * degree).K_II) / root, row.F, 2e-5);
    const EdgeIntensity k = intensity(mouths, stress, {0.1}, beta);
    EXPECT_TRUE(k.closed);
    EXPECT_EQ(k.K_I, 0);
    EXPECT_NEAR(std::min(beta, pi - beta), row.degrees * degree, 2.5 * degree);
    EXPECT_GE(std::abs(k.K_II) / root, row.F - 2e-5);
  }
  const Mouths rough(5);
  EXPECT_EQ(intensity(rough, near(uniform(-1), 0.1), {0.1}, 45 * degree).K_II, 0);  // sticks
}

// A pressure in the crack adds to the load on its faces: both under p alone have Koiter's number.
TEST(Expansion, PressureOpensTheCrack) {
  const Field pressed = [](double, double) { return Eigen::Vector3d(0, -2, 0); };
  const Mouths mouths(0);
  EXPECT_NEAR(intensity(mouths, near(pressed, 0.1), {0.1, 0, 2}, pi / 2).K_I, 1.1215222552 * 2 * std::sqrt(pi * 0.1),
              1e-6);
}

TEST(Expansion, SeesThatAStressIsNotSmooth) {
  EXPECT_LT(near(hole(1, 0, 0), 0.1).rough, 2e-3);
  EXPECT_GT(near([](double x, double y) { return Eigen::Vector3d(1 / std::hypot(x, y + 0.05), 0, 0); }, 1).rough, 0.05);
}

}  // namespace
}  // namespace kerf::inspect::expansion_test
