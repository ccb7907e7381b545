// Where a search begins. Of one hole, through noise, and of a crack that opens: inverse_test.cpp, which goes on from
// there.

#include "kerf/inverse.hpp"

#include "kerf/analysis.hpp"
#include "kerf/element.hpp"
#include "tests/optimize/inverse.hpp"
#include "topo/responses.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::initial_guess_test {
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

// What lies in the body already is kept clear of, and what is fixed stays.
TEST(InitialGuess, KnowsTheCracksOfTheFrame) {
  Plate plate;
  plate.size = 0.12;
  plate.true_size = 0.06;
  Problem p = plate.frame();
  p.frame.cracks = {{"known", {Vec2(0.3, 0.3), Vec2(0.3, 0.6)}, {}}};
  p.scene.laws.emplace_back();
  Synthetic truth = plate.truth();
  truth.element = afw(1);
  truth.true_shape.cracks = p.frame.cracks;
  truth.true_scene.laws = p.scene.laws;
  truth.true_shape.labels.push_back("hole");
  truth.true_shape.holes = {kerf::circle("true", {0.42, 0.45}, 0.09, 3)};
  p.objective = with_measured(std::move(p.objective), 1, measure(truth).field);
  Drawn d = plate.circle("h");
  d.lower[0] = d.upper[0] = d.start[0] = 0.42;
  const InitialGuess found = initial_guess(p, {{d}}, 0.05);
  const Guess& g = found.guesses.at(0);
  EXPECT_EQ(g.at.x(), 0.42);
  EXPECT_NEAR(g.at.y(), 0.45, 0.03);
  EXPECT_LE(g.size, 0.12 - 0.05 + 1e-12);  // the crack is 0.12 away
  EXPECT_GT(g.size, 0.06);
}

// Things that may not overlap and explain the same hole.
TEST(InitialGuess, ShareTheRoomThatThereIs) {
  Plate plate;
  plate.size = 0.12;
  plate.true_size = 0.06;
  plate.holes = {{{0.5, 0.5}, 0.15}};
  const Problem p = plate.problem();
  Design d{{plate.circle("a"), plate.circle("b"), plate.circle("c")}};
  for (Drawn& one : d.drawn) {
    one.lower.head<2>().setConstant(0.38);
    one.upper.head<2>().setConstant(0.62);
  }
  const double clear = 0.02;
  const InitialGuess found = initial_guess(p, d, clear);
  ASSERT_EQ(found.guesses.size(), 3u);
  double area = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    area += pi * std::pow(found.guesses[i].size, 2);
    for (std::size_t k = i + 1; k < 3; ++k)
      EXPECT_GE((found.guesses[i].at - found.guesses[k].at).norm(),
                found.guesses[i].size + found.guesses[k].size + clear - 1e-9);
  }
  EXPECT_GE(area, 3 * pi * 0.03 * 0.03);
  EXPECT_FALSE(find_problem(body_of(found.design, start_of(found.design), p).shape));
  EXPECT_GT(found.explained, 0);
}

// A hole on the crack: nothing can be drawn, and the expansion has the last word.
TEST(InitialGuess, GuessesWhatCannotBeDrawn) {
  Plate plate;
  plate.size = 0.15;
  plate.true_size = 0.06;
  plate.cracks = {{Vec2(0.4, 0.5), Vec2(0.6, 0.5)}};
  const Problem p = plate.problem();
  Drawn crack = plate.crack("c"), hole = plate.circle("h");
  crack.lower << 0.4, 0.5, 0.6, 0.5;
  crack.upper = crack.start = crack.lower;
  hole.lower << 0.55, 0.5, 0.01;
  hole.upper << 0.55, 0.5, 0.1;
  hole.start = hole.lower;
  const InitialGuess found = initial_guess(p, {{crack, hole}}, 0.02);
  EXPECT_TRUE(find_problem(body_of(found.design, start_of(found.design), p).shape));
  EXPECT_EQ(found.solves, 1 + 2 * 25);  // the body without them, and what its 25 hats read each way
  EXPECT_GT(found.explained, 0.5);
  EXPECT_LE(found.explained, 1);
}

// A hole, a stiff and a soft inclusion look for their places in the same boxes.
TEST(InitialGuess, TellsKindsApart) {
  Plate plate;
  plate.size = 0.12;
  plate.true_size = 0.06;
  plate.holes = {{{0.3, 0.7}, 0.08}};
  plate.inclusions = {{{0.7, 0.65}, 0.1}};
  plate.inclusion_young = 6;
  const Problem p = plate.problem();
  Drawn other = plate.region("s", 6, 6);
  other.poisson = 0.1;
  for (const bool stiff_first : {true, false}) {
    Design d{{plate.region("r", 6, 6), plate.circle("h")}};
    if (!stiff_first) std::swap(d.drawn[0], d.drawn[1]);
    const InitialGuess found = initial_guess(p, d, 0.02);
    EXPECT_LT((found.guesses[stiff_first ? 0 : 1].at - Vec2(0.7, 0.65)).norm(), 0.03);
    EXPECT_LT((found.guesses[stiff_first ? 1 : 0].at - Vec2(0.3, 0.7)).norm(), 0.03);
  }
  const InitialGuess more = initial_guess(p, {{plate.region("r", 6, 6), other, plate.region("t", 0.1, 0.1)}}, 0.02);
  EXPECT_LT((more.guesses[2].at - Vec2(0.3, 0.7)).norm(), 0.05);  // the soft one is taken for the hole
}

TEST(InitialGuess, NeedsTheLabelOfTheMisfit) {
  const Plate plate;
  Problem p = plate.frame();
  p.objective.terms[0].measured->label = 5;
  try {
    initial_guess(p, {{plate.circle("h")}}, 0.02);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    EXPECT_STREQ(e.what(), "start = \"map\": nothing of the boundary has the label of the misfit");
  }
}

// What makes the plate most compliant is a crack across the larger pull, which is upwards.
TEST(InitialGuess, TurnsACrackByTheMap) {
  Plate plate;
  plate.size = 0.1;
  Problem p = plate.frame();
  p.objective = {"compliance", {compliance()}};
  p.objective.terms[0].factor = -1;
  Drawn crack = plate.crack("c");
  const InitialGuess found = initial_guess(p, {{crack}}, 0.02);
  EXPECT_LT(std::abs(found.guesses.at(0).angle), pi / 12);
  for (auto* v : {&crack.lower, &crack.upper, &crack.start}) v->array() += 3;
  try {
    initial_guess(p, {{crack}}, 0.02);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    EXPECT_NE(std::string(e.what()).find("of crack 'c': nowhere in its box"), std::string::npos) << e.what();
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
}  // namespace kerf::initial_guess_test
