// `kerf bench state` as a whole, on tiny meshes, and the lines of other programs.

#include "bench/command/records.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace kerf::state_test {
namespace {

namespace fs = std::filesystem;

class StateBenchTest : public test::InFolder {};

TEST_F(StateBenchTest, WritesItsFiles) {
  const StateBench bench =
      run_state_bench({{.folder = folder, .cases = {"smooth", "closing-crack"}, .quick = true}, {"bdms"}});
  std::istringstream csv(text("state.csv"));
  std::string line;
  ASSERT_TRUE(std::getline(csv, line));
  EXPECT_EQ(
      line,
      "case,poisson,element,degree,mesh,level,h,triangles,unknowns,condensed_unknowns,mesh_s,assemble_s,factor_s,"
      "solve_s,contact_s,recover_s,work_s,memory_mb,stress_error,displacement_error,contact_iterations,certified");
  std::size_t rows = 0;
  while (std::getline(csv, line)) ++rows;
  EXPECT_EQ(rows, bench.runs.size());
  EXPECT_EQ(rows, 2u * 4 + 2 * 3 * 4);

  const auto json = nlohmann::json::parse(text("state.json"));
  EXPECT_EQ(json["status"], "ok");
  ASSERT_EQ(json["runs"].size(), rows);
  for (const auto& run : json["runs"]) {
    EXPECT_GT(run["stress_error"].get<double>(), 0);
    EXPECT_GT(run["displacement_error"].get<double>(), 0);
    EXPECT_LT(run["stress_error"].get<double>(), 1);
    EXPECT_GT(run["work_s"].get<double>(), 0);
    EXPECT_GT(run["memory_mb"].get<double>(), 1);
    EXPECT_TRUE(run["certified"].get<bool>());
    EXPECT_EQ(run["contact_iterations"].get<int>() > 0, run["case"] == "closing-crack");
  }
  EXPECT_EQ(json["fastest"].size(), 2 * errors_to_reach.size());
  for (const char* name :
       {"error_time_smooth_nu0.3.png", "error_time_closing-crack_nu0.3.png", "stress_step_closing-crack_nu0.3.png",
        "displacement_unknowns_closing-crack_nu0.3.png", "stress_unknowns_closing-crack_nu0.3.png"})
    EXPECT_GT(fs::file_size(folder / name), 1000u) << name;
  EXPECT_NE(summary(bench).find("smooth_nu0.3"), std::string::npos);
}

TEST_F(StateBenchTest, WritesWhatThereIsWhenStopped) {
  int polls = 0;
  const StateBench bench = run_state_bench(
      {{.folder = folder, .cases = {"smooth"}, .quick = true, .stop_asked = [&] { return ++polls > 3; }}, {"bdms"}});
  EXPECT_TRUE(bench.stopped);
  EXPECT_FALSE(bench.runs.empty());
  EXPECT_LT(bench.runs.size(), 6u);
  EXPECT_EQ(nlohmann::json::parse(text("state.json"))["status"], "stopped");
}

TEST_F(StateBenchTest, RefusesAFolderWithoutScripts) {
  EXPECT_THROW(run_peers({.scripts = folder, .work = folder / "work"}), Error);
}

TEST_F(StateBenchTest, FailuresOfOtherProgramsBecomeNotes) {
  std::ofstream(folder / "s1.edp") << "nothing";
  std::ofstream(folder / "FreeFem++") << R"(#!/bin/sh
case "$*" in
  *p3*) echo '{"nt":128,"ndof":9,"err_s":0.01,"t_mesh":0.5,"t_asm":0.25,"t_solve":0.25}' ;;
  *) echo "oops"; exit 3 ;;
esac
)";
  fs::permissions(folder / "FreeFem++", fs::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (folder.string() + ":" + path).c_str(), 1);
  const PeerRuns peers = run_peers({.scripts = folder, .work = folder / "work", .quick = true, .problems = {"smooth"}});
  setenv("PATH", path.c_str(), 1);
  ASSERT_EQ(peers.runs.size(), 3u);  // three Poisson's ratios
  EXPECT_EQ(peers.runs[0].name, "FreeFem++ P3");
  EXPECT_DOUBLE_EQ(peers.runs[0].work, 1);
  int failed = 0;
  for (const std::string& note : peers.notes) failed += note.find("failed (exit 3): oops") != std::string::npos;
  EXPECT_EQ(failed, 3);  // P4

  setenv("PATH", "/nowhere", 1);
  const PeerRuns none = run_peers({.scripts = folder, .work = folder / "work", .quick = true, .problems = {"smooth"}});
  setenv("PATH", path.c_str(), 1);
  EXPECT_TRUE(none.runs.empty());
  ASSERT_FALSE(none.notes.empty());
  EXPECT_EQ(none.notes[0], "FreeFem++ is not installed: its runs are left out");
}

TEST(PeerLine, IsTheLastObjectThatHasAnError) {
  const auto run = read_peer_line(
      "warning: something\n{\"err_s\":0.5}\n"
      "{\"prob\":\"S1\",\"nt\":512,\"ndof\":2178,\"err_s\":2.0e-02,\"t_mesh\":0.001,\"t_asm\":0.01,\"t_solve\":0.02}\n"
      "{\"err_s\":nan}\nbye\n");
  ASSERT_TRUE(run);
  EXPECT_EQ(run->triangles, 512);
  EXPECT_EQ(run->unknowns, 2178);
  EXPECT_DOUBLE_EQ(run->error, 0.02);
  EXPECT_DOUBLE_EQ(run->work, 0.031);
  EXPECT_FALSE(read_peer_line(""));
  EXPECT_FALSE(read_peer_line("{\"err_s\":-1}\n{broken\n[1]\n"));
  EXPECT_EQ(last_line("a\nb\n\n"), "b");
}

}  // namespace
}  // namespace kerf::state_test
