// K of cracks at a free boundary. Truths from outside: Koiter's number, a table of another code (dislocations of
// piecewise polynomials, five digits), the disc (the derivative of its closed form by R. D. Gregory), holes.

#include "inspect/mouth.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::inspect::mouth_test {
namespace {

constexpr double degree = pi / 180, koiter = 1.1215222552;

TEST(Mouth, ANormalCrackHasKoitersNumber) {
  const OpenMouth m = open_mouth(pi / 2);
  EXPECT_NEAR(m.K[0][0].straight[0], koiter, 1e-7);
  EXPECT_NEAR(m.K[1][1].straight[0], koiter, 1e-7);  // shear has the same one
  EXPECT_NEAR(m.K[0][0].straight[1], 0.682862884, 1e-7);
  EXPECT_NEAR(m.K[0][0].straight[2], 0.525488418, 1e-7);
  EXPECT_NEAR(m.K[0][1].straight[0], 0, 1e-12);
  EXPECT_NEAR(m.K[1][0].straight[0], 0, 1e-12);
}

// Of a disc F (1 - a/D)^(-3/2), whose slope is 3/4 per curvature; of a crack at a hole -0.8411, found there by
// extrapolation from a/R = 0.002, 0.005, 0.01.
TEST(Mouth, CurvatureIsThatOfTheDisc) {
  const OpenMouth m = open_mouth(pi / 2);
  EXPECT_NEAR(m.K[0][0].curved[0], 0.75 * koiter, 2e-5);
  EXPECT_NEAR(m.K[1][1].curved[0], 0.15828, 2e-5);
}

struct Row {
  double beta, N_I, N_II, T_I, T_II, xN_I, xN_II, xT_I, xT_II;
};
// A crack that leans so that tension makes K_II > 0: the mirror image of an angle below 90 degrees.
constexpr Row table[] = {{80, 1.138230, -.076303, -.035980, 1.126101, .689254, -.025770, -.015398, .684808},
                         {70, 1.191475, -.161046, -.073197, 1.140392, .709595, -.054308, -.031427, .690898},
                         {60, 1.292136, -.265602, -.113166, 1.166250, .747929, -.089354, -.048858, .701993},
                         {45, 1.593363, -.507210, -.183543, 1.236192, .861775, -.169845, -.080289, .732437},
                         {30, 2.338762, -1.040631, -.282347, 1.377090, 1.139018, -.346838, -.126044, .795281}};

TEST(Mouth, LeaningCracksAgreeWithATable) {
  for (const Row& row : table) {
    const OpenMouth m = open_mouth((180 - row.beta) * degree);
    const double near = row.beta > 40 ? 1e-5 : 3e-4;
    EXPECT_NEAR(m.K[0][0].straight[0], row.N_I, near) << row.beta;
    EXPECT_NEAR(m.K[1][0].straight[0], row.N_II, near) << row.beta;
    EXPECT_NEAR(m.K[0][1].straight[0], row.T_I, near) << row.beta;
    EXPECT_NEAR(m.K[1][1].straight[0], row.T_II, near) << row.beta;
    EXPECT_NEAR(m.K[0][0].straight[1], row.xN_I, near) << row.beta;
    EXPECT_NEAR(m.K[1][0].straight[1], row.xN_II, near) << row.beta;
    EXPECT_NEAR(m.K[0][1].straight[1], row.xT_I, near) << row.beta;
    EXPECT_NEAR(m.K[1][1].straight[1], row.xT_II, near) << row.beta;
  }
}

// K_II of closed faces under compression along the boundary, by the same table; with friction 0.3, too.
TEST(Mouth, ClosedFacesAgreeWithATable) {
  struct Closed {
    double beta, smooth, rough;
  };
  for (const Closed& row : {Closed{70, .353657, .06308},
                            {60, .468677, .22865},
                            {50, .525948, .34176},
                            {45, .532195, .37544},
                            {40, .523965, .39335},
                            {30, .467371, .38327}}) {
    const double beta = row.beta * degree, N = -std::pow(std::sin(beta), 2), T = std::sin(beta) * std::cos(beta);
    EXPECT_NEAR(T * sliding_mouth(beta, 0).straight[0], row.smooth, 1e-5) << row.beta;
    EXPECT_NEAR((T + 0.3 * N) * sliding_mouth(beta, 0.3).straight[0], row.rough, 1e-5) << row.beta;
  }
}

TEST(Mouth, TheMirrorImageHasTheOppositeShear) {
  const OpenMouth m = open_mouth(50 * degree), mirrored = open_mouth(130 * degree);
  for (std::size_t mode = 0; mode < 2; ++mode)
    for (std::size_t load = 0; load < 2; ++load) {
      const double sign = mode == load ? 1 : -1;
      EXPECT_NEAR(m.K[mode][load].straight[0], sign * mirrored.K[mode][load].straight[0], 1e-9);
      EXPECT_NEAR(m.K[mode][load].curved[0], sign * mirrored.K[mode][load].curved[0], 1e-6);
    }
  EXPECT_NEAR(sliding_mouth(50 * degree, 0.3).straight[0], sliding_mouth(130 * degree, -0.3).straight[0], 1e-9);
}

TEST(Mouth, InterpolationKeepsFourDigits) {
  const Mouths all(0.3);
  for (const double beta : {30., 37., 52., 64., 81., 90., 107., 133., 150.}) {
    const OpenMouth m = open_mouth(beta * degree), found = all.open(beta * degree);
    for (std::size_t mode = 0; mode < 2; ++mode)
      for (std::size_t load = 0; load < 2; ++load) {
        EXPECT_NEAR(found.K[mode][load].straight[0], m.K[mode][load].straight[0], 2e-5) << beta;
        EXPECT_NEAR(found.K[mode][load].curved[0], m.K[mode][load].curved[0], 2e-3) << beta;
      }
    for (const double sense : {1., -1.})
      EXPECT_NEAR(all.sliding(beta * degree, sense).straight[0], sliding_mouth(beta * degree, sense * 0.3).straight[0],
                  1e-5)
          << beta;
  }
}

TEST(Mouth, RefusesAnglesThatLeaveTheBody) {
  for (const double beta : {0., pi, -1., nan}) EXPECT_THROW(open_mouth(beta), Error);
}

}  // namespace
}  // namespace kerf::inspect::mouth_test
