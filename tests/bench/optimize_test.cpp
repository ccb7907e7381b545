// `kerf bench optimize`: the judge of designs, other programs' designs, and a run as a whole on coarse meshes.

#include "bench/optimize/optimize.hpp"

#include "bench/command/records.hpp"
#include "bench/optimize/optimize_peers.hpp"
#include "optimize/refuse.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

namespace kerf::optimize_test {
namespace {

namespace fs = std::filesystem;

class OptimizeBenchTest : public test::InFolder {};

/// A scenario from a folder that is gone afterwards.
OptimizeProblem problem_named(const std::string& name) {
  const test::Folder folder;
  return read_problem(name, folder.path);
}

/// The design y -> |y - 1/2| of the cantilever: a beam along its axis.
GridField beam() {
  GridField f{.columns = 41, .rows = 21};
  for (int j = 0; j < f.rows; ++j)
    for (int i = 0; i < f.columns; ++i) f.value.push_back(std::abs(j / 20.0 - 0.5));
  return f;
}

TEST(Judge, CutsAFieldWhereTheAreaIsRight) {
  const OptimizeProblem p = problem_named("cantilever");
  const Mesh background = triangulate(p.problem.frame, {.size = 0.03});
  const Shape shape = shape_of(p, 0.4, beam(), background);
  EXPECT_NEAR(volume_fraction(p, shape), 0.4, 1e-5);
  EXPECT_TRUE(shape.holes.empty());
  // A beam of height 0.4 and length 2: bending 500, shear 15.6 by Timoshenko; the clamped end takes a little of it.
  const Judged j = judge(p, shape, {0.05, 4000});
  EXPECT_NEAR(j.compliance, 515.6, 0.01 * 515.6);
  EXPECT_LE(j.least, j.compliance);
  EXPECT_GE(j.most * (1 + 1e-9), j.compliance);
  EXPECT_LT(j.most - j.least, 0.01 * j.compliance);
}

TEST(Judge, KnowsTheFullCantilever) {
  const OptimizeProblem p = problem_named("cantilever");
  const Judged j = judge(p, p.problem.frame, {0.05, 6000});
  EXPECT_NEAR(j.compliance, 38.824, 0.02);  // the peers' recheck.py
  EXPECT_DOUBLE_EQ(j.volume, 1);
}

/// Both arms of the L thinned evenly: the field knows nothing of the notch, which stays empty.
TEST(Judge, CutsAFieldInAFrameThatIsNotConvex) {
  const OptimizeProblem p = problem_named("lbracket");
  GridField arms{.columns = 51, .rows = 51, .value = {}};
  for (int j = 0; j < arms.rows; ++j)
    for (int i = 0; i < arms.columns; ++i)
      arms.value.push_back(std::min(std::abs(i / 50.0 - 0.2), std::abs(j / 50.0 - 0.2)));
  const Shape shape = shape_of(p, 0.5, arms, triangulate(p.problem.frame, {.size = 0.01}));
  EXPECT_NEAR(volume_fraction(p, shape), 0.5, 1e-5);
  EXPECT_FALSE(find_problem(shape));
  for (const Side& side : shape.outline.sides)
    EXPECT_FALSE(side.start.x() > 0.4 + 1e-9 && side.start.y() > 0.4 + 1e-9) << side.start.transpose();
}

TEST(Judge, RefusesAFieldWithoutABody) {
  const OptimizeProblem p = problem_named("cantilever");
  const Mesh background = triangulate(p.problem.frame, {.size = 0.1});
  GridField constant{.columns = 2, .rows = 2, .value = {1, 1, 1, 1}};
  EXPECT_THROW(shape_of(p, 0.4, constant, background), Error);
  GridField right{.columns = 3, .rows = 2, .value = {1, 1, 0, 1, 1, 0}};  // the support loses its material
  EXPECT_THROW(shape_of(p, 0.4, right, background), Error);
}

/// A plate that fills its frame bears each load case alone: J is the sum of what each of them takes.
TEST(Judge, AddsLoadCasesByTheirWeights) {
  OptimizeProblem p = problem_named("twoload");
  const double both = judge(p, p.problem.frame, {0.05, 3000}).compliance;
  p.request.load_cases[0].weight = 2;
  p.request.load_cases[1].weight = 0;
  // The loads are mirror images of one another.
  EXPECT_NEAR(judge(p, p.problem.frame, {0.05, 3000}).compliance, both, 1e-3 * both);
}

/// A bar 1 x 1 under its own weight alone, held below on rollers and at one corner: with nu = 0 it takes
/// g^2 / (3 E) by hand; E = 1, g = 1.
TEST(Judge, KnowsABarUnderItsOwnWeight) {
  OptimizeProblem p = problem_named("selfonly");
  Shape& bar = p.problem.frame;
  bar.labels = {"corner", "below", "free"};
  bar.outline.sides = {{{0, 0}, 0}, {{0.01, 0}, 1}, {{1, 0}, 2}, {{1, 1}, 2}, {{0, 1}, 2}};
  p.problem.scene.material = plane_stress(1, 0);
  const Support held = p.problem.scene.supports.front();
  p.problem.scene.supports = {{0, false, true, true, held.value}, {1, false, false, true, held.value}};
  p.problem.scene.tractions.clear();
  const Judged j = judge(p, bar, {0.1, 2000});
  EXPECT_NEAR(j.compliance, 1.0 / 3, 1e-3 / 3);
}

TEST(Problems, AreThoseOfThePeers) {
  const auto load_in_all = [](const OptimizeProblem& p, const Scene& scene) {
    double sum = 0;
    const auto& sides = p.problem.frame.outline.sides;
    for (const Traction& t : scene.tractions)
      for (std::size_t i = 0; i < sides.size(); ++i)
        if (sides[i].label == t.label)
          sum += (sides[(i + 1) % sides.size()].start - sides[i].start).norm() * t.value({0, 0}, {1, 0}).norm();
    return sum;
  };
  int densities = 0;
  for (const std::string& name : scenario_names()) {
    const OptimizeProblem p = problem_named(name);
    EXPECT_FALSE(find_problem(p.problem.frame)) << name;
    EXPECT_TRUE(find_wrong(p.problem, p.request).empty()) << name;
    if (!has_density(p)) continue;
    ++densities;
    for (const auto& [weight, scene] : loaded_scenes(p)) EXPECT_NEAR(load_in_all(p, scene), 1, 1e-12) << name;
  }
  EXPECT_EQ(densities, 9);
  EXPECT_NEAR(frame_area(problem_named("lbracket")), 0.64, 1e-12);
  EXPECT_DOUBLE_EQ(problem_named(published_name).request.volume_penalty, 100);
  EXPECT_THROW(problem_named("nothing"), std::invalid_argument);
  EXPECT_THROW(request_from(problem_named("cantilever"), "empty"), std::invalid_argument);
  EXPECT_EQ(request_from(problem_named("mbb"), "few holes").level_set.start->columns, 9);
}

/// What the density script reads: sides of labels, weights, constants of plane stress.
TEST(Problems, AreWrittenForTheDensityScript) {
  const auto j = nlohmann::json::parse(density_scenario(problem_named("threeload"), 0.35));
  EXPECT_EQ(j["outline"].size(), 12u);
  EXPECT_EQ(j["loads"].size(), 3u);
  EXPECT_EQ(j["supports"][1]["x"], false);
  EXPECT_EQ(j["supports"][1]["segments"][0][0][0], 2.9);
  EXPECT_EQ(j["loads"][0]["tractions"][0]["traction"][1], -10);
  EXPECT_NEAR(j["mu"].get<double>(), 1 / 2.6, 1e-15);
}

/// The script's first state of all densities 1 is the full body, of bilinear squares. The ends of the load lie between
/// points of the lattice.
TEST_F(OptimizeBenchTest, RunsItsOwnDensityScript) {
  const OptimizeProblem p = problem_named("cantilever");
  const DesignPeers all = run_simp(p, 1, 50, {.work = folder / "peers", .quick = true});
  if (all.runs.empty() && all.notes.empty()) GTEST_SKIP() << "no numpy and scipy";
  ASSERT_EQ(all.runs.size(), 1u) << all.notes.front();
  const PeerSnapshot& first = all.runs[0].snapshots.front();
  EXPECT_EQ(first.field.columns, 101);
  EXPECT_EQ(first.field.rows, 51);
  EXPECT_NEAR(first.objective, 38.824, 0.02 * 38.824);  // the peers' recheck.py
}

TEST(Snapshots, AreReadUntilTheyBreakOff) {
  const auto all =
      read_snapshots("1 80.5 0.25 1 2 2\n-1 0\n 1 2e-3\n2 79 0.5 2 3 2\n1 2 3\n4 5 6\n3 78 0.7 3 3 2\n1 2 3\n4");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].field.value, (std::vector<double>{-1, 0, 1, 2e-3}));
  EXPECT_EQ(all[1].iteration, 2);
  EXPECT_DOUBLE_EQ(all[1].objective, 79);
  EXPECT_EQ(all[1].field.columns, 3);
  EXPECT_TRUE(read_snapshots("").empty());
  EXPECT_TRUE(read_snapshots("1 nan 1 1 2 2 0 0 0 0\nx").size() <= 1);
}

TEST(Snapshots, TracedScriptsSayWhenTheyHaveChanged) {
  EXPECT_FALSE(traced_tdopt("nothing"));
  const auto script = traced_tdopt("a\n  Jold = J;\nb\n");
  ASSERT_TRUE(script);
  EXPECT_NE(script->find("trace.txt"), std::string::npos);
  EXPECT_FALSE(traced_tdopt("  Jold = J;\n  Jold = J;\n"));
}

TEST_F(OptimizeBenchTest, WritesItsFiles) {
  fs::create_directories(folder / "scripts");
  fs::create_directories(folder / "bin");
  std::ofstream(folder / "scripts" / "tdopt.edp") << "x\n  Jold = J;\n";
  {
    std::ofstream program(folder / "bin" / "FreeFem++");
    program << "#!/bin/sh\ncat > trace.txt <<END\n3 510 0.5 3 41 21\n";
    for (const double value : beam().value) program << value << '\n';
    program << "END\n";
  }
  fs::permissions(folder / "bin" / "FreeFem++", fs::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", ((folder / "bin").string() + ":" + path).c_str(), 1);
  const OptimizeBench bench = run_optimize_bench({.folder = folder / "out",
                                                  .cases = {"cantilever", "remesh", "random"},
                                                  .quick = true,
                                                  .peers = folder / "scripts"});
  setenv("PATH", path.c_str(), 1);
  ASSERT_GE(bench.runs.size(), 2u) << summary(bench);
  const DesignRun& own = bench.runs[0];
  const auto found = std::ranges::find_if(bench.runs, [](const DesignRun& r) { return r.tool.starts_with("Free"); });
  ASSERT_NE(found, bench.runs.end());
  const DesignRun& peer = *found;
  EXPECT_TRUE(own.own);
  EXPECT_NEAR(own.last.volume, 0.4, 1e-4);
  // A few iterations from one start: how good the design is hangs on the last digit, but it is far better than a beam
  // of its area, and the judge sees what the run saw.
  EXPECT_GT(own.last.compliance, 38.824);  // the full body
  EXPECT_LT(own.last.compliance, 0.5 * peer.last.compliance);
  EXPECT_NEAR(own.last.compliance, own.own_value, 0.05 * own.own_value);
  EXPECT_LE(own.last.least, own.last.compliance);
  ASSERT_FALSE(own.curve.empty());
  EXPECT_LE(own.near.value, 1.01 * own.curve.back().value);
  EXPECT_LE(own.near.state_solves, own.state_solves);
  EXPECT_EQ(peer.state_solves, 3);
  EXPECT_NEAR(peer.last.compliance, 515.6, 0.01 * 515.6);
  ASSERT_TRUE(bench.remeshing);
  EXPECT_GT(bench.remeshing->share(), 0);
  EXPECT_LT(bench.remeshing->share(), 1);
  ASSERT_TRUE(bench.random);
  EXPECT_EQ(bench.random->count, 10);
  EXPECT_TRUE(bench.random->failures.empty()) << bench.random->failures.front();

  const auto json = nlohmann::json::parse(text("out/optimize.json"));
  EXPECT_EQ(json["status"], "ok");
  ASSERT_EQ(json["runs"].size(), bench.runs.size());
  EXPECT_EQ(json["runs"][0]["value"].get<double>(), own.value);
  EXPECT_GE(json["runs"][0]["over_best_known"].get<double>(), own.value / peer.value);
  EXPECT_EQ(json["random_designs"]["meshed"].get<int>(), bench.random->meshed);
  const std::string csv = text("out/optimize.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "case,tool,variant,iterations,state_solves,cpu_s,own_value,value,over_best_peer,over_best_known,compliance,"
            "compliance_least,compliance_most,volume,triangles,near_iterations,near_state_solves,near_cpu_s,"
            "simp_50_cpu_s,shape_residual,hole_margin,finer_objective,finer_change,ending,feasible,stopped");
  EXPECT_NE(csv.find("\"FreeFem++ level set, n = 20\""), std::string::npos);
  for (const char* name : {"optimize_cantilever.png", "optimize_designs.png", "optimize_compliance.png"})
    EXPECT_GT(fs::file_size(folder / "out" / name), 1000u) << name;
  EXPECT_NE(summary(bench).find("kerf with default settings"), std::string::npos);
}

TEST(Spreads, LeaveOutDesignsThatBreakTheirBounds) {
  const Spread spread{.problem = "x",
                      .runs = {{.start = "full", .value = 10.1, .feasible = true},
                               {.start = "holes", .value = 10, .feasible = true},
                               {.start = "random 1", .value = 10.4, .feasible = true},
                               {.start = "random 2", .value = 9, .feasible = false},
                               {.start = "full", .loads = 1 + 1e-12, .value = 10.1 * 1.001, .feasible = true}},
                      .failures = {}};
  const SpreadSummary s = summarize(spread);
  EXPECT_EQ(s.count, 4);
  EXPECT_EQ(s.infeasible, 1);
  EXPECT_DOUBLE_EQ(s.least, 10);
  EXPECT_DOUBLE_EQ(s.most, 10.4);
  EXPECT_DOUBLE_EQ(s.usual, 10.1);
  EXPECT_NEAR(s.rounding, 1e-3, 1e-12);
}

TEST_F(OptimizeBenchTest, RefusesAFolderWithoutScripts) {
  EXPECT_THROW(run_optimize_bench({.folder = folder / "out", .quick = true, .peers = folder}), Error);
}

}  // namespace
}  // namespace kerf::optimize_test
