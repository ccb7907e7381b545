// `kerf bench map` as a whole, on tiny meshes, and what it measures.

#include "bench/measure/map.hpp"

#include "bench/command/records.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace kerf::map_test {
namespace {

namespace fs = std::filesystem;

class MapBenchTest : public test::InFolder {};

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(MapBenchTest, WritesItsFiles) {
  const MapBench bench = run_map_bench({{.folder = folder, .cases = {"closing-crack", "cantilever"}, .quick = true}});
  EXPECT_TRUE(bench.notes.empty()) << bench.notes.front();
  const std::string csv = text("map.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "case,poisson,element,degree,mesh,level,triangles,mesh_s,assemble_s,factor_s,solve_s,contact_s,value_s,"
            "evaluate_s,evaluation_share,adjoint_s,evaluate_dual_s,work_s,memory_mb,value,map_error,certified");
  ASSERT_EQ(bench.sequences.size(), 4u * 2);  // degrees, levels; the cantilever has no exact map
  ASSERT_EQ(bench.sizes.size(), 2u);
  EXPECT_EQ(lines(csv), 1 + 8 + 2u);

  const auto json = nlohmann::json::parse(text("map.json"));
  EXPECT_EQ(json["status"], "ok");
  ASSERT_EQ(json["sequences"].size(), 8u);
  for (const auto& run : json["sequences"]) {
    EXPECT_GT(run["map_error"].get<double>(), 0);
    EXPECT_LT(run["map_error"].get<double>(), 0.2);
  }
  for (const auto& run : json["sizes"]) {
    for (const char* time :
         {"mesh_s", "assemble_s", "factor_s", "solve_s", "evaluate_s", "adjoint_s", "evaluate_dual_s"})
      EXPECT_GT(run[time].get<double>(), 0) << time;
    EXPECT_NEAR(run["triangles"].get<double>(), 1000, 60);
    EXPECT_GT(run["memory_mb"].get<double>(), 1);
    EXPECT_TRUE(run["certified"].get<bool>());
    EXPECT_EQ(run["map_error"].is_null(), run["case"] == "cantilever");
  }
  EXPECT_EQ(json["fastest"].size(), map_errors_to_reach.size());
  EXPECT_TRUE(json["peers"].empty());
  EXPECT_GT(fs::file_size(folder / "map_error_time_closing-crack_nu0.3.png"), 1000u);
  EXPECT_FALSE(fs::exists(folder / "map_error_time_cantilever_nu0.3.png"));
  EXPECT_NE(summary(bench).find("cantilever_nu0.3"), std::string::npos);
}

TEST_F(MapBenchTest, TimesValidations) {
  const MapBench bench = run_map_bench({{.folder = folder, .cases = {"validation"}, .quick = true}});
  EXPECT_TRUE(bench.notes.empty()) << bench.notes.front();
  ASSERT_EQ(bench.validations.size(), 3u);
  for (const ValidationMeasurement& v : bench.validations) {
    EXPECT_EQ(v.points, 1u);
    EXPECT_EQ(v.radii, 2u);
    EXPECT_EQ(v.holds + v.fails + v.out_of_range, 1);
    EXPECT_GT(v.ratio(), 0);
    EXPECT_NEAR(v.triangles, 1000, 60);
  }
  EXPECT_EQ(bench.validations[2].functional, "displacement_tracking");
  EXPECT_EQ(lines(text("validation.csv")), 4u);
  EXPECT_EQ(nlohmann::json::parse(text("map.json"))["validations"].size(), 3u);
}

TEST_F(MapBenchTest, WritesWhatThereIsWhenStopped) {
  int polls = 0;
  const MapBench bench = run_map_bench(
      {{.folder = folder, .cases = {"smooth"}, .quick = true, .stop_asked = [&] { return ++polls > 3; }}});
  EXPECT_TRUE(bench.stopped);
  EXPECT_EQ(bench.sequences.size(), 2u);
  EXPECT_TRUE(bench.sizes.empty());
  EXPECT_EQ(nlohmann::json::parse(text("map.json"))["status"], "stopped");
}

TEST_F(MapBenchTest, RunsOtherPrograms) {
  EXPECT_THROW(run_map_bench({{.folder = folder, .peers = folder}}), Error);
  for (const char* script : {"slit.idp", "common.idp"}) std::ofstream(folder / script) << "nothing";
  // A program that finds kerf's own script beside those of the folder.
  std::ofstream(folder / "FreeFem++") << R"(#!/bin/sh
grep -q err_map map_crack.edp && test -e slit.idp || exit 3
echo '{"nt":128,"ndof":9,"err_map":0.5,"t_mesh":0.5,"t_asm":0.25,"t_solve":0.25,"t_post":0.5}'
)";
  fs::permissions(folder / "FreeFem++", fs::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (folder.string() + ":" + path).c_str(), 1);
  const MapBench bench =
      run_map_bench({{.folder = folder / "out", .cases = {"open-crack"}, .quick = true, .peers = folder}});
  setenv("PATH", path.c_str(), 1);
  ASSERT_EQ(bench.peers.size(), 6u);  // three graded forms, two Poisson's ratios
  EXPECT_DOUBLE_EQ(bench.peers[0].work, 1.5);
  EXPECT_DOUBLE_EQ(bench.peers[0].post, 0.5);
  EXPECT_DOUBLE_EQ(bench.peers[0].error, 0.5);
  EXPECT_GT(bench.peers[0].memory_mb, 0.1);
  ASSERT_EQ(bench.notes.size(), 1u);
  EXPECT_NE(bench.notes[0].find("no tdmap.edp"), std::string::npos);
}

/// The compliance that tdmap.edp prints: 38.8202 on 11,703 triangles, 38.8258 on 101,243 (P2, from below).
TEST(MapMeasure, CantileverIsThatOfThePeers) {
  const BenchProblem p = map_problem("cantilever", 0.3);
  const MapMeasurement m = measure_map(p, element("bdms", 2), Grading::Uniform, 2, 1);
  EXPECT_NEAR(m.value, 38.83, 0.05);
  EXPECT_TRUE(std::isnan(m.error));
}

TEST(MapMeasure, ErrorsFallFast) {
  for (const double nu : {0.3, 0.499999})
    for (const char* name : {"smooth", "open-crack", "closing-crack"}) {
      const BenchProblem p = map_problem(name, nu);
      const Grading grading = p.shape.cracks.empty() ? Grading::Uniform : Grading::Graded;
      const double coarse = measure_map(p, element("bdms"), grading, 2, 1).error,
                   fine = measure_map(p, element("bdms"), grading, 6, 1).error;
      EXPECT_LT(fine, 0.25 * coarse) << name << ' ' << nu;
      EXPECT_LT(fine, 0.02) << name << ' ' << nu;
    }
}

TEST(MapMeasure, LevelsHaveTheTrianglesAskedFor) {
  const BenchProblem p = map_problem("closing-crack", 0.3);
  const double level = level_of(p, Grading::Graded, 1, 3000);
  EXPECT_NEAR(static_cast<double>(bench_mesh(p, Grading::Graded, 1, level).triangles.size()), 3000, 90);
}

}  // namespace
}  // namespace kerf::map_test
