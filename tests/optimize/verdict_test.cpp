// What readings say of a model: too few of them, the wrong model, the right one, a mesh that is too coarse. Data come
// from another element on another mesh.

#include "tests/optimize/inverse.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::verdict_test {
namespace {

using Eigen::VectorXd;
using inverse::Plate;

OptimizeRequest request(const Design& design) {
  return {
      .method = OptimizeMethod::Slsqp, .max_iterations = 40, .tolerance = 0.01, .min_distance = 0.02, .design = design};
}

Plate one_hole() {
  Plate plate;
  plate.holes = {{{0.62, 0.57}, 0.1}};
  plate.noise = 0.01;
  plate.size = 0.1;
  return plate;
}

struct Judged {
  LeastSquares fit;
  OptimizeResult result;
};
Judged judged(const Plate& plate, const Design& design, const VectorXd& start, const Readings& readings) {
  const Problem p = plate.frame();
  const OptimizeRequest r = request(design);
  Judged j{least_squares(p, r, start, readings), {}};
  judge_fit(p, r, j.fit, j.result);
  EXPECT_EQ(j.result.stopped.rfind(std::string(word(j.result.ending)) + ": ", 0), 0u) << j.result.stopped;
  return j;
}

// chi2 of the right model lies where the noise says: of 20 seeds none is refuted, and 95 % intervals hold.
TEST(Verdict, TheRightModelIsOptimal) {
  const Plate plate = one_hole();
  Synthetic truth = plate.truth();
  truth.noise = 0;
  const Measurement exact = measure(truth);
  const Readings readings = readings_of(exact, truth);
  constexpr int seeds = 20;
  int inside = 0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    Readings noisy = readings;
    noisy.noise = plate.noise * exact.scale;
    const std::vector<double> numbers = normal_numbers(seed, 2 * noisy.at.size());
    for (std::size_t i = 0; i < noisy.at.size(); ++i)
      noisy.displacement[i] += noisy.noise * Vec2(numbers[2 * i], numbers[2 * i + 1]);
    const Judged j = judged(plate, {{plate.circle("h")}}, Eigen::Vector3d(0.62, 0.57, 0.1), noisy);
    EXPECT_EQ(j.fit.verdict, FitVerdict::Explained) << j.result.stopped;
    EXPECT_EQ(j.result.ending, Ending::Optimal) << j.result.stopped;
    EXPECT_EQ(rank_of(j.fit), 3);
    const double chi = j.fit.end / (noisy.noise * noisy.noise);
    inside += j.fit.expected[0] <= chi && chi <= j.fit.expected[1];
    for (Eigen::Index i = 0; i < 3; ++i) EXPECT_GT(deviation_of(j.fit, i), 0);
    if (seed > 8) continue;
    noisy.noise = 0;
    const Judged unknown = judged(plate, {{plate.circle("h")}}, j.fit.variables, noisy);
    EXPECT_EQ(unknown.fit.verdict, FitVerdict::Untested) << unknown.result.stopped;
    EXPECT_EQ(unknown.result.ending, Ending::Optimal) << unknown.result.stopped;
  }
  EXPECT_GE(inside, 16);  // fewer of 20 happen once in 400 times
}

// One hole for the data of two, and a hole for those of a crack.
TEST(Verdict, TheWrongModelIsRefuted) {
  Plate two = one_hole();
  two.holes = {{{0.3, 0.65}, 0.1}, {{0.7, 0.4}, 0.12}};
  Plate crack = one_hole();
  crack.holes.clear();
  crack.cracks = {{Vec2(0.35, 0.45), Vec2(0.7, 0.55)}};
  crack.noise = 0.003;
  for (const Plate& plate : {two, crack}) {
    const Synthetic truth = plate.truth();
    Readings readings = readings_of(measure(truth), truth);
    for (const bool known : {true, false}) {
      if (!known) readings.noise = 0;
      const Judged j = judged(plate, {{plate.circle("h")}}, Eigen::Vector3d(0.5, 0.5, 0.1), readings);
      EXPECT_EQ(j.fit.verdict, FitVerdict::Unexplained) << known << j.result.stopped;
      EXPECT_EQ(j.result.ending, Ending::Unexplained) << j.result.stopped;
      EXPECT_TRUE(j.fit.ellipses.empty());
      for (Eigen::Index i = 0; i < 3; ++i) EXPECT_TRUE(std::isnan(deviation_of(j.fit, i)));
      EXPECT_EQ(j.result.stopped.rfind("the model does not explain the readings: chi^2/N ", 0), 0u);
    }
  }
}

// As many sensors as there are, two components each, fix that many combinations at most: the rest is told as open.
TEST(Verdict, FewReadingsFixFewUnknowns) {
  const Plate plate = one_hole();
  const Synthetic truth = plate.truth();
  const Readings all = readings_of(measure(truth), truth);
  for (const std::size_t sensors : {1u, 2u, 12u}) {
    Readings few{.label = all.label, .at = {}, .displacement = {}, .noise = 0.1 * all.noise};
    for (std::size_t i = 0; i < sensors; ++i) {
      const std::size_t k = (2 * i + 1) * all.at.size() / (2 * sensors);
      few.at.push_back(all.at[k]);
      few.displacement.push_back(all.displacement[k]);
    }
    for (const bool known : {true, false}) {
      if (!known) few.noise = 0;
      Drawn other = plate.circle("other");
      for (VectorXd* v : {&other.lower, &other.upper, &other.start}) *v = Eigen::Vector3d(0.3, 0.3, 0.06);
      other.lower[2] = 0.03, other.upper[2] = 0.1;
      const Judged j =
          judged(plate, {{plate.circle("h"), other}}, (VectorXd(6) << 0.6, 0.6, 0.09, 0.3, 0.3, 0.06).finished(), few);
      ASSERT_EQ(j.fit.combinations.size(), 4u);
      EXPECT_LE(rank_of(j.fit), static_cast<int>(2 * sensors)) << j.result.stopped;
      for (const Combination& c : j.fit.combinations) EXPECT_NEAR(c.weights.norm(), 1, 1e-12);
      if (2 * sensors >= 4) continue;
      EXPECT_EQ(j.result.ending, Ending::Undetermined) << j.result.stopped;
      EXPECT_EQ(j.result.stopped.rfind("not enough readings: 2 readings fix ", 0), 0u) << j.result.stopped;
      // No variable is said to be surer than its box where it takes part in what is open.
      const Combination& open = j.fit.combinations.back();
      EXPECT_FALSE(open.fixed);
      for (Eigen::Index i = 0; i < 6; ++i)
        EXPECT_TRUE(std::abs(open.weights[i]) <= 0.1 || std::isnan(deviation_of(j.fit, i))) << i;
      EXPECT_EQ(in_words(j.fit, variable_names({{plate.circle("h"), other}})).size() > 4, true);
    }
  }
}

// The truth is the model; what chi2 is too large by is the mesh.
TEST(Verdict, ACoarseMeshIsNotAWrongModel) {
  Plate plate = one_hole();
  plate.size = 0.25;
  plate.noise = 1e-5;
  Synthetic truth = plate.truth();
  truth.spacing = 0.1;
  const Readings readings = readings_of(measure(truth), truth);
  const Judged j = judged(plate, {{plate.circle("h")}}, Eigen::Vector3d(0.6, 0.6, 0.1), readings);
  EXPECT_GT(j.fit.end / (readings.noise * readings.noise), j.fit.most);
  EXPECT_EQ(j.fit.verdict, FitVerdict::Coarse) << j.result.stopped;
  EXPECT_EQ(j.result.ending, Ending::Stalled) << j.result.stopped;
}

// A crack's data are told from a hole's, and the table has every mixture that was tried.
TEST(Count, TellsACrackFromAHole) {
  Plate plate = one_hole();
  plate.holes.clear();
  plate.cracks = {{Vec2(0.4, 0.45), Vec2(0.65, 0.55)}};
  plate.true_size = 0.06;
  const Synthetic truth = plate.truth();
  const Measurement data = measure(truth);
  Problem p = plate.frame();
  p.objective = with_measured(p.objective, 1, data.field);
  const Count count = count_defects(p, request({{plate.circle("h"), plate.crack("c")}}), readings_of(data, truth), 1);
  ASSERT_EQ(count.tried.size(), 3u);
  EXPECT_EQ(count.tried[count.chosen].of, (std::vector<int>{0, 1})) << in_words(count);
  EXPECT_EQ(count.tried[1].of, (std::vector<int>{1, 0}));
  EXPECT_EQ(count.tried[1].variables, 3);
  EXPECT_EQ(count.tried[2].variables, 4);
  for (const Counted& one : count.tried) EXPECT_TRUE(std::isfinite(one.aicc));
  EXPECT_LT(count.tried[2].aicc, count.tried[1].aicc);
  EXPECT_EQ(in_words(count).rfind("1 crack 'c' by the criterion of Bayes and Schwarz: 0: ", 0), 0u);
  EXPECT_EQ(table_in_words(count).size(), 3u);
}

// Three unknowns of two readings: not a fit, however small its sum.
TEST(Count, NeedsMoreReadingsThanUnknowns) {
  const Plate plate = one_hole();
  const Synthetic truth = plate.truth();
  const Measurement data = measure(truth);
  Problem p = plate.frame();
  p.objective = with_measured(p.objective, 1, data.field);
  const Readings all = readings_of(data, truth);
  const Readings one{.label = 1, .at = {all.at[20]}, .displacement = {all.displacement[20]}};
  const Count count = count_defects(p, request({{plate.circle("h")}}), one, 2);
  EXPECT_EQ(count.tried[count.chosen].count, 0);
  EXPECT_EQ(count.tried[1].failure, "2 readings for 3 unknowns");
}

}  // namespace
}  // namespace kerf::verdict_test
