// Designs bound by release rates and stresses, judged by what is proved of them.

#include "kerf/analysis.hpp"
#include "kerf/optimize.hpp"
#include "optimize/loop/finish.hpp"
#include "optimize/loop/intervals.hpp"
#include "tests/support/folder.hpp"
#include "tests/topo/validation.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numeric>

namespace kerf::upper_test {
namespace {

using namespace scenes;

constexpr std::array<double, 2> ring{0.04, 0.15};

Functional release_rate_at_the_end(const std::array<double, 2>& r = ring) {
  return {"energy_release_rate", {energy_release_rate({0.3, 0}, {1, 0}, r, {})}};
}

/// [-1, 1]^2, clamped below and pulled, with a crack whose faces may penetrate.
Problem plate_with_crack() {
  Problem p;
  p.frame = cracked_square(0.3);
  p.scene = pulled(plane_strain(1, 0.3), [](const Vec2&) { return Vec2(0, 1); });
  p.scene.laws[0].kind = CrackLaw::Kind::Open;
  p.sizing = {.size = 0.25, .crack_tip_size = 0.02};
  p.objective = {"compliance", {compliance()}};
  return p;
}

/// A slit above the crack, which takes the load off it.
OptimizeRequest slit(double at_most) {
  OptimizeRequest r{.method = OptimizeMethod::Slsqp, .max_iterations = 60};
  Drawn d{Drawn::Kind::Crack, "slit", Eigen::Vector4d(-0.6, 0.3, 0.1, 0.3), Eigen::Vector4d(0, 0.3, 0.7, 0.3),
          Eigen::Vector4d(-0.3, 0.3, 0.3, 0.3)};
  d.law.kind = CrackLaw::Kind::Open;
  r.design.drawn = {d};
  r.bounds = {{"G", release_rate_at_the_end(), at_most}};
  return r;
}

struct Solved {
  Model model;
  State state;
};
Solved solved(const Problem& p, const Shape& shape, const Scene& scene, double size, const Element& element) {
  Sizing sizing = p.sizing;
  sizing.crack_tip_size *= size / sizing.size;
  sizing.size = size;
  Model model = prepare(triangulate(shape, sizing), element, scene, 1);
  State state = solve(model);
  return {std::move(model), std::move(state)};
}

TEST(Upper, TheDesignKeepsItsLimitByWhatIsProvedOfIt) {
  const Problem p = plate_with_crack();
  const OptimizeRequest r = slit(0.8);
  const OptimizeResult found = optimize_parameters(p, r, {}, {});
  EXPECT_EQ(found.ending, Ending::Optimal) << found.stopped;
  EXPECT_TRUE(found.feasible) << found.stopped;
  ASSERT_EQ(found.finer.intervals.size(), 1u);
  const Bounded& G = found.finer.intervals[0];
  EXPECT_TRUE(G.guaranteed) << G.note;
  EXPECT_LE(G.upper, 0.8 * (1 + feasible_violation));
  EXPECT_NE(found.stopped.find("of what is allowed is proved"), std::string::npos) << found.stopped;
  // By another element on a mesh of its own.
  const Solved fine = solved(p, found.shape, found.scene, 0.1, afw(3));
  const double truth = analyze(release_rate_at_the_end({0.05, 0.14}), fine.model, fine.state, true).value;
  EXPECT_LE(truth, G.upper);
  EXPECT_GE(truth, G.lower);
}

/// The most compliant plate whose crack is driven at least so hard: a coarse mesh finds more of it than there is.
struct Driven {
  Problem p = plate_with_crack();
  OptimizeRequest r = slit(-0.9);
  Driven() {
    p.objective.terms[0].factor = -1;
    p.sizing.crack_tip_size = 0.05;
    r.bounds[0].functional.terms[0].factor = -1;
    r.bounds[0].functional.sum = true;
  }
};

// Resumed from before the bounds were made to leave room, and from after, it ends alike.
TEST(Upper, BoundsLeaveRoomForWhatAFinerMeshProvesAlsoResumed) {
  const test::Folder made;
  const Driven d;
  const CheckpointPlace place{made.path / "checkpoint", "case", false};
  const auto leaves_room = [](const Iteration& i) { return i.note.find("leave room") != std::string::npos; };
  int shown = 0;
  std::vector<std::filesystem::path> copies;
  bool room = false;
  const OptimizeResult found = optimize_parameters(
      d.p, d.r,
      [&](const Iterate& i) {
        // What a run leaves that is stopped at the row before.
        if (++shown == 3 || room) {
          copies.push_back(made.path / std::to_string(shown));
          std::filesystem::copy_file(place.path, copies.back());
        }
        room = copies.size() < 2 && leaves_room(i.row);
        return true;
      },
      place);
  EXPECT_TRUE(found.feasible) << found.stopped;
  const Bounded& least = found.finer.intervals.at(0);
  EXPECT_TRUE(least.guaranteed) << least.note;
  EXPECT_LE(least.upper, -0.9 * (1 - feasible_violation));
  EXPECT_GE(least.upper, -0.9 * 1.05);  // and little more than that
  const auto rooms = std::ranges::count_if(found.history, leaves_room);
  EXPECT_GE(rooms, 1);
  EXPECT_LE(rooms, 2);
  EXPECT_LT(found.history.back().bounds[0], -0.9 * (1 + feasible_violation));  // on its own mesh
  ASSERT_EQ(copies.size(), 2u);
  for (const std::filesystem::path& copy : copies) {
    const OptimizeResult resumed = optimize_parameters(d.p, d.r, {}, {copy, "case", true});
    EXPECT_EQ(resumed.variables, found.variables);
    EXPECT_EQ(resumed.stopped, found.stopped);
    EXPECT_EQ(resumed.notes, found.notes);
    EXPECT_EQ(resumed.state_solves, found.state_solves);
    EXPECT_EQ(resumed.finer.intervals[0].upper, found.finer.intervals[0].upper);
    EXPECT_EQ(resumed.history.size(), found.history.size());
  }
}

TEST(Upper, WhatFailsByTheUpperEndAloneIsNoDesign) {
  Problem p = plate_with_crack();
  OptimizeRequest r = slit(1);
  const Shape& shape = p.frame;
  const FinerDesign there = solve_finer(p, r, shape, area(p.frame));
  ASSERT_TRUE(there.intervals[0].guaranteed) << there.intervals[0].note;
  r.bounds[0].at_most = (1 - 2 * feasible_violation) * there.intervals[0].upper;
  const FinerDesign judged = solve_finer(p, r, shape, area(p.frame));
  EXPECT_NEAR(judged.violation, there.intervals[0].upper / r.bounds[0].at_most - 1, 1e-12);
  OptimizeResult result{.finer = judged};
  const Iteration row{.volume_fraction = 1, .bounds = {0.9 * r.bounds[0].at_most}};
  result.finer.bounds = row.bounds;  // what was computed keeps the bound
  judge(result, r, {.row = row, .residual = 0, .asked = 1e-3, .kind = "KKT residual", .why = "done"});
  EXPECT_FALSE(result.feasible);
  EXPECT_EQ(result.ending, Ending::Infeasible);
  EXPECT_EQ(result.stopped.rfind(fmt::format("infeasible: G: at most {:.4f} of what is allowed is proved on a mesh",
                                             judged.intervals[0].upper / r.bounds[0].at_most),
                                 0),
            0u)
      << result.stopped;
}

TEST(Upper, AnIntervalThatIsNotGuaranteedNeverMakesABoundLooser) {
  FinerDesign d;
  d.bounds = {1, 1, 1, 1};
  d.intervals = {
      {0.8, 0.7, 0.9, true, ""}, {0.8, 0.7, 0.9, false, "why"}, {1, 0.9, 1.1, false, "why"}, {nan, nan, nan}};
  EXPECT_EQ(judged_by(d), (std::vector<double>{0.9, 1, 1.1, 1}));
}

// Each note names what stands in the way.
TEST(Upper, WhatHasNoIntervalSaysWhy) {
  const Problem p = plate_with_crack();
  const auto interval = [](const Problem& of, const Functional& j) {
    OptimizeRequest r;
    r.bounds = {{"j", j, 1}};
    std::vector<Index> cracks(of.frame.cracks.size());
    std::iota(cracks.begin(), cracks.end(), Index{0});
    return intervals_of(evaluate_design(of, r, of.frame, cracks), 1).front();
  };
  const auto expect_note = [](const Bounded& b, const std::string& word) {
    EXPECT_FALSE(b.guaranteed) << word;
    EXPECT_NE(b.note.find(word), std::string::npos) << b.note;
  };
  EXPECT_EQ(interval(p, {"compliance", {compliance()}}).note, "");
  EXPECT_TRUE(std::isnan(interval(p, {"compliance", {compliance()}}).upper));
  expect_note(interval(p, {"", {stress_pnorm(3, {}, true)}}), "to the power 3");
  expect_note(interval(p, {"",
                           {stress_power(
                               2, [](const Vec2&) { return 2.0; }, true)}}),
              "weight");
  expect_note(interval(p, {"", {energy_release_rate({0.3, 0}, {1, 0.1}, ring, {})}}), "along no crack");
  const auto intensity = [&](TipQuantity quantity) {
    return interval(p, {"", {stress_intensity({quantity, {1, 0}}, {0.3, 0}, ring, {})}});
  };
  expect_note(intensity(TipQuantity::Equivalent), "the equivalent K has none");
  expect_note(interval(p, {"", {energy_release_rate({0.3, 0}, {1, 0}, ring, {}), compliance()}}), "compliance");
  Problem touching = p;
  touching.scene.laws[0].kind = CrackLaw::Kind::Unilateral;
  const Bounded open = interval(touching, release_rate_at_the_end()), free = interval(p, release_rate_at_the_end());
  expect_note(open, "open everywhere");
  EXPECT_NEAR(open.upper, free.upper, 1e-9);
  touching.scene.tractions[0].value = [](const Vec2&, const Vec2&) { return Vec2(0.3, -1); };
  expect_note(interval(touching, release_rate_at_the_end()), "contact");
  Problem holed = p;
  holed.frame.holes = {circle("h", {0.7, 0.7}, 0.15, 0)};
  expect_note(interval(holed, release_rate_at_the_end()), "polygon");
  EXPECT_TRUE(std::isfinite(interval(holed, release_rate_at_the_end()).upper));
  holed.scene.laws[0].kind = CrackLaw::Kind::Unilateral;  // both reasons
  expect_note(interval(holed, release_rate_at_the_end()), "open everywhere");
  expect_note(interval(holed, release_rate_at_the_end()), "polygon");
}

// G of both tips and the area, with signs; the worst of two load cases, of which one pulls half as much.
TEST(Upper, SumsAndLoadCases) {
  Problem p = plate_with_crack();
  const Term left = energy_release_rate({-0.3, 0}, {-1, 0}, ring, {}), right = release_rate_at_the_end().terms[0];
  Term both = left, less = right, whole = volume();
  both.factor = 2;
  less.factor = -0.5;
  whole.factor = 0.1;
  OptimizeRequest r;
  for (const std::vector<Term>& terms : {std::vector{left}, {right}, {both, less, whole}})
    r.bounds.push_back({"j", {"sum", terms, true}, 1});
  const std::vector<Bounded> one = intervals_of(evaluate_design(p, r, p.frame, {0}), 1);
  EXPECT_NEAR(one[2].upper, 2 * one[0].upper - 0.5 * one[1].lower + 0.4, 1e-12);
  EXPECT_NEAR(one[2].lower, 2 * one[0].lower - 0.5 * one[1].upper + 0.4, 1e-12);
  EXPECT_TRUE(one[2].guaranteed);
  LoadCase half{"half", 1, p.scene.tractions, {}}, full{"full", 1, p.scene.tractions, {}};
  half.tractions[0].value = [](const Vec2&, const Vec2&) { return Vec2(0, 0.5); };
  p.scene.tractions.clear();
  r.load_cases = {half, full};
  const std::vector<Bounded> two = intervals_of(evaluate_design(p, r, p.frame, {0}), 1);
  EXPECT_NEAR(two[0].upper, one[0].upper, 1e-9);
  EXPECT_NEAR(two[0].lower, one[0].lower, 1e-9);
}

}  // namespace
}  // namespace kerf::upper_test
