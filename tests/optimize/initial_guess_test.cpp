#include "kerf/inverse.hpp"

#include "kerf/analysis.hpp"
#include "kerf/element.hpp"
#include "tests/optimize/inverse.hpp"
#include "topo/responses.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf {
namespace {

using inverse::Plate;

// The topological derivative of a reading against the reading itself with a small hole.
TEST(Responses, AreTheDerivativesOfReadings) {
  const Plate plate;
  const Term reading{.kind = "reading", .label = 1, .on_boundary = [](const Vec2& x, const Vec2&, const Vec2& u) {
                       Density d;
                       d.by_displacement = Vec2(x.y(), 1 - x.x());
                       d.value = d.by_displacement.dot(u);
                       return d;
                     }};
  const auto model_of = [&](const Shape& shape) {
    return prepare(triangulate(shape, {.size = 0.03}), element("bdms"), plate.problem().scene, 1);
  };
  const Model m = model_of(plate.problem().frame);
  const State s = solve(m);
  const Responses r = responses(m, s, std::span(&reading, 1));
  const Vec2 at(0.55, 0.4);
  const double T = derivatives(response_at(r, at).value(), {}, 0)[0];
  Shape holed = plate.problem().frame;
  constexpr double radius = 0.04;
  holed.labels.push_back("hole:h");
  holed.holes = {circle("h", at, radius, 2)};
  const Model with = model_of(holed);
  const State changed = solve(with);
  const double before = analyze({"reading", {reading}}, m, s, true).value,
               after = analyze({"reading", {reading}}, with, changed, true).value;
  EXPECT_NEAR(r.value[0], before, 1e-12);
  EXPECT_NEAR((after - before) / (pi * radius * radius), T, 0.05 * std::abs(T));
  EXPECT_FALSE(response_at(r, {2, 2}).has_value());
}

TEST(InitialGuess, FindsAHole) {
  Plate plate;
  plate.holes = {{{0.62, 0.57}, 0.08}};
  const Problem p = plate.problem();
  Design d;
  d.drawn = {plate.circle("h")};
  const InitialGuess found = initial_guess(p, d, 0.02);
  ASSERT_EQ(found.guesses.size(), 1u);
  EXPECT_LT((found.guesses[0].at - Vec2(0.62, 0.57)).norm(), 0.002);
  EXPECT_NEAR(found.guesses[0].size, 0.08, 0.001);
  EXPECT_EQ(found.design.drawn[0].start,
            Eigen::Vector3d(found.guesses[0].at.x(), found.guesses[0].at.y(), found.guesses[0].size));
  EXPECT_GT(found.explained, 0.99);
}

TEST(InitialGuess, IsSaidInWords) {
  const Plate plate;
  const Design d{{plate.circle("h"), plate.crack("c"), plate.region("r", 0.2, 20)}};
  EXPECT_EQ(in_words({.drawn = 0, .at = {0.62, 0.57}, .size = 0.08}, d), "hole 'h' at (0.62, 0.57), radius 0.08");
  EXPECT_EQ(in_words({.drawn = 1, .at = {0.5, 0.25}, .size = 0.1, .angle = 0.5236}, d),
            "crack 'c' at (0.5, 0.25), half its length 0.1, 30 degrees");
  EXPECT_EQ(in_words({.drawn = 2, .at = {0.5, 0.25}, .size = 0.1, .young = 4}, d),
            "region 'r' at (0.5, 0.25), radius 0.1, young 4");
}

TEST(InitialGuess, FindsTwoHoles) {
  Plate plate;
  plate.holes = {{{0.3, 0.65}, 0.07}, {{0.7, 0.4}, 0.09}};
  const Problem p = plate.problem();
  Design d;
  d.drawn = {plate.circle("a"), plate.circle("b")};
  const InitialGuess found = initial_guess(p, d, 0.02);
  ASSERT_EQ(found.guesses.size(), 2u);
  const bool swapped = found.guesses[0].at.x() > 0.5;
  const Guess &a = found.guesses[swapped ? 1 : 0], &b = found.guesses[swapped ? 0 : 1];
  EXPECT_LT((a.at - Vec2(0.3, 0.65)).norm(), 0.002);
  EXPECT_LT((b.at - Vec2(0.7, 0.4)).norm(), 0.002);
  EXPECT_NEAR(a.size, 0.07, 0.001);
  EXPECT_NEAR(b.size, 0.09, 0.001);
}

// Of an inclusion of unknown stiffness it tells the place and whether it is stiff or soft: small and stiff or large and
// less so are nearly the same from afar.
TEST(InitialGuess, FindsAnInclusion) {
  Plate plate;
  plate.inclusions = {{{0.4, 0.6}, 0.1}};
  plate.inclusion_young = 5;
  const Problem p = plate.problem();
  const InitialGuess known = initial_guess(p, {{plate.region("r", 5, 5)}}, 0.02);
  EXPECT_LT((known.guesses[0].at - Vec2(0.4, 0.6)).norm(), 0.005);
  EXPECT_NEAR(known.guesses[0].size, 0.1, 0.002);
  const InitialGuess found = initial_guess(p, {{plate.region("r", 0.2, 20)}}, 0.02);
  EXPECT_LT((found.guesses[0].at - Vec2(0.4, 0.6)).norm(), 0.01);
  EXPECT_GT(found.guesses[0].young, 1.5);
  EXPECT_NEAR(found.guesses[0].size, 0.1, 0.05);
  EXPECT_GT(found.explained, 0.999);
}

TEST(InitialGuess, FindsACrackThatOpens) {
  Plate plate;
  plate.cracks = {{Vec2(0.45, 0.45), Vec2(0.62, 0.52)}};
  const Problem p = plate.problem();
  Design d;
  d.drawn = {plate.crack("c")};
  const InitialGuess found = initial_guess(p, d, 0.02);
  const Eigen::Vector4d start = found.design.drawn[0].start;
  EXPECT_LT((start - Eigen::Vector4d(0.45, 0.45, 0.62, 0.52)).norm(), 0.002);
}

// Noise of 1 %.
TEST(InitialGuess, StandsNoise) {
  Plate plate;
  plate.holes = {{{0.62, 0.57}, 0.08}};
  plate.noise = 0.01;
  Design d;
  d.drawn = {plate.circle("h")};
  const InitialGuess found = initial_guess(plate.problem(), d, 0.02);
  EXPECT_LT((found.guesses[0].at - Vec2(0.62, 0.57)).norm(), 0.02);
}

TEST(InitialGuess, LeavesWhatIsGivenAndSaysWhereThereIsNoRoom) {
  Plate plate;
  plate.holes = {{{0.62, 0.57}, 0.08}};
  const Problem p = plate.problem();
  Design d;
  d.drawn = {plate.circle("h")};
  d.drawn[0].from_map = false;
  EXPECT_FALSE(wants_map(d));
  EXPECT_EQ(initial_guess(p, d, 0.02).design.drawn[0].start, d.drawn[0].start);
  d.drawn[0].from_map = true;
  d.drawn[0].lower.head<2>() << 0.001, 0.001;
  d.drawn[0].upper.head<2>() << 0.002, 0.002;
  try {
    initial_guess(p, d, 0.02);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    EXPECT_NE(std::string(e.what()).find("hole 'h'"), std::string::npos) << e.what();
  }
}

// Without a misfit: the most negative values of the map, apart from one another.
TEST(InitialGuess, ReadsAMapWithoutAMisfit) {
  const Plate plate;
  Problem p = plate.problem();
  p.objective = {"compliance", {compliance(), volume()}};
  p.objective.terms[1].factor = 100;
  Design d;
  d.drawn = {plate.circle("a"), plate.circle("b")};
  const InitialGuess found = initial_guess(p, d, 0.02);
  ASSERT_EQ(found.guesses.size(), 2u);
  EXPECT_GE((found.guesses[0].at - found.guesses[1].at).norm(), 2 * d.drawn[0].start[2] + 0.02);
  EXPECT_TRUE(std::isnan(found.explained));
  for (const Guess& g : found.guesses) EXPECT_EQ(g.size, d.drawn[0].start[2]);
}

}  // namespace
}  // namespace kerf
