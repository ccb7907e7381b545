// `kerf bench optimize`: the judge of designs, other programs' designs, and a run as a whole on coarse meshes.

#include "bench/optimize.hpp"

#include "bench/optimize_peers.hpp"
#include "bench/records.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

namespace kerf {
namespace {

namespace fs = std::filesystem;

class OptimizeBenchTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "kerf-bench-XXXXXX").string();
    folder = mkdtemp(name.data());
  }
  void TearDown() override {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  std::string text(const fs::path& name) const {
    std::ifstream file(folder / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  fs::path folder;
};

const OptimizeProblem& problem_named(const std::string& name) {
  for (const OptimizeProblem& p : optimize_problems())
    if (p.name == name) return p;
  throw std::invalid_argument(name);
}

/// The design y -> |y - 1/2| of the cantilever: a beam along its axis.
GridField beam() {
  GridField f{.columns = 41, .rows = 21};
  for (int j = 0; j < f.rows; ++j)
    for (int i = 0; i < f.columns; ++i) f.value.push_back(std::abs(j / 20.0 - 0.5));
  return f;
}

TEST(Judge, CutsAFieldWhereTheAreaIsRight) {
  const OptimizeProblem& p = problem_named("cantilever");
  const Mesh background = triangulate(p.problem.frame, {.size = 0.03});
  const Shape shape = shape_of(p, beam(), background);
  EXPECT_NEAR(volume_fraction(p, shape), 0.4, 1e-5);
  EXPECT_TRUE(shape.holes.empty());
  // A beam of height 0.4 and length 2: bending 500, shear 15.6 by Timoshenko; the clamped end takes a little of it.
  const Judged j = judge(p, shape, 0.05, 4000);
  EXPECT_NEAR(j.compliance, 515.6, 0.01 * 515.6);
  EXPECT_LE(j.least, j.compliance);
  EXPECT_GE(j.most * (1 + 1e-9), j.compliance);
  EXPECT_LT(j.most - j.least, 0.01 * j.compliance);
}

TEST(Judge, KnowsTheFullCantilever) {
  const OptimizeProblem& p = problem_named("cantilever");
  const Judged j = judge(p, p.problem.frame, 0.05, 6000);
  EXPECT_NEAR(j.compliance, 38.824, 0.02);  // the peers' recheck.py
  EXPECT_DOUBLE_EQ(j.volume, 1);
}

TEST(Judge, RefusesAFieldWithoutABody) {
  const OptimizeProblem& p = problem_named("cantilever");
  const Mesh background = triangulate(p.problem.frame, {.size = 0.1});
  GridField constant{.columns = 2, .rows = 2, .value = {1, 1, 1, 1}};
  EXPECT_THROW(shape_of(p, constant, background), Error);
  GridField right{.columns = 3, .rows = 2, .value = {1, 1, 0, 1, 1, 0}};  // the support loses its material
  EXPECT_THROW(shape_of(p, right, background), Error);
}

TEST(Problems, AreThoseOfThePeers) {
  const auto near_load = [](const OptimizeProblem& p) {
    double sum = 0;
    const auto& sides = p.problem.frame.outline.sides;
    for (const Traction& t : p.problem.scene.tractions)
      for (std::size_t i = 0; i < sides.size(); ++i)
        if (sides[i].label == t.label)
          sum += (sides[(i + 1) % sides.size()].start - sides[i].start).norm() * t.value({0, 0}, {1, 0}).y();
    return sum;
  };
  for (const OptimizeProblem& p : optimize_problems()) {
    EXPECT_NEAR(near_load(p), -1, 1e-12) << p.name;
    EXPECT_FALSE(find_problem(p.problem.frame)) << p.name;
    for (const std::string& start : optimize_starts())
      EXPECT_DOUBLE_EQ(level_set_request(p, start).volume_at_most.value(), 0.4);
  }
  EXPECT_NEAR(frame_area(problem_named("lbracket")), 0.64, 1e-12);
  EXPECT_NEAR(near_load(published_problem()), -1, 1e-12);
  EXPECT_DOUBLE_EQ(level_set_request(published_problem(), "full").volume_penalty, 100);
  EXPECT_THROW(level_set_request(published_problem(), "empty"), std::invalid_argument);
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
  ASSERT_EQ(bench.runs.size(), 2u) << summary(bench);
  const DesignRun &own = bench.runs[0], &peer = bench.runs[1];
  EXPECT_TRUE(own.own);
  EXPECT_NEAR(own.last.volume, 0.4, 1e-4);
  // A few iterations from one start: how good the design is hangs on the last digit, but it is far better than a beam
  // of its area, and the judge sees what the run saw.
  EXPECT_GT(own.last.compliance, 38.824);  // the full body
  EXPECT_LT(own.last.compliance, 0.5 * peer.last.compliance);
  EXPECT_NEAR(own.last.compliance, own.own_compliance, 0.05 * own.own_compliance);
  EXPECT_LE(own.last.least, own.last.compliance);
  ASSERT_FALSE(own.curve.empty());
  EXPECT_LE(own.near.compliance, 1.01 * own.curve.back().compliance);
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
  ASSERT_EQ(json["runs"].size(), 2u);
  EXPECT_EQ(json["runs"][1]["compliance"].get<double>(), peer.last.compliance);
  EXPECT_EQ(json["random_designs"]["meshed"].get<int>(), bench.random->meshed);
  const std::string csv = text("out/optimize.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "case,tool,start,iterations,state_solves,cpu_s,own_compliance,compliance,compliance_least,"
            "compliance_most,volume,triangles,near_iterations,near_state_solves,near_cpu_s,stopped");
  EXPECT_NE(csv.find("\"FreeFem++ level set, n = 20\""), std::string::npos);
  for (const char* name : {"optimize_cantilever.png", "optimize_designs.png", "optimize_compliance.png"})
    EXPECT_GT(fs::file_size(folder / "out" / name), 1000u) << name;
  EXPECT_NE(summary(bench).find("kerf, from regular holes"), std::string::npos);
}

TEST_F(OptimizeBenchTest, RefusesAFolderWithoutScripts) {
  EXPECT_THROW(run_optimize_bench({.folder = folder / "out", .quick = true, .peers = folder}), Error);
}

}  // namespace
}  // namespace kerf
