// Optimizations as a user runs them: files, interruptions, resumption.

#include "tests/support/folder.hpp"
#include "tests/support/running.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace kerf::optimize_run_test {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string read_all(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

const std::string level_set = R"(title = "Cantilever"
[domain]
outline = [[0, 0], [2, 0], [2, 0.3], [2, 0.7], [2, 1], [0, 1]]
sides = ["bottom", "right", "load", "right", "top", "left"]
[[crack]]
name = "c"
path = [[0.5, 0.7], [0.8, 0.8]]
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "load"
traction = [0, -1]
[mesh]
size = 0.12
crack_tip_size = 0.03
[functional]
kind = "compliance"
[optimize]
volume = { at_most = 0.85 }
max_iterations = 12
nucleate = { every = 3, fraction = 0.03 }
)";

const std::string parameters = R"(title = "Plate"
[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "left"
displacement = [0, 0]
[mesh]
size = 0.15
[functional]
kind = "compliance"
[optimize]
method = "mma"
volume = { at_most = 0.93 }
max_iterations = 8
[[optimize.bound]]
kind = "stress_pnorm"
p = 6
at_most = 30
[[optimize.hole]]
circle = { center = [[0.8, 1.2], [0.3, 0.7]], radius = [0.1, 0.25] }
[[load_case]]
name = "pull"
[[load_case.boundary]]
on = "right"
traction = [1, 0]
[[load_case]]
name = "shear"
weight = 0.5
[[load_case.boundary]]
on = "right"
traction = [0, 1]
)";

// Feasible after one iteration.
const std::string small_change = [] {
  std::string text = level_set;
  text.replace(text.find("0.85"), 4, "0.98");
  return text + "[output]\npng = false\n";
}();

class Optimize : public kerf::test::InFolder {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }

  int kerf(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), KERF_PROGRAM);
    return kerf::test::Running(folder, arguments).code();
  }
  std::string error() const {
    return read_all(folder / "stderr");
  }

  /// Sends a signal as soon as a file is there (or the program has ended).
  int interrupt(std::vector<std::string> arguments, const fs::path& at, int signal) const {
    arguments.insert(arguments.begin(), KERF_PROGRAM);
    kerf::test::Running program(folder, arguments);
    program.give_way();
    program.reaches([&] { return fs::exists(at); });
    program.signal(signal);
    return program.code();
  }

  json result(const std::string& name) const {
    json r = json::parse(read_all(folder / name / "result.json"));
    r.erase("time_s");
    r.erase("peak_memory_mb");
    return r;
  }

  /// Steps that were refused have none.
  std::vector<std::string> designs(const std::string& name) const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder / name))
      if (const std::string file = entry.path().filename(); file.starts_with("design_") && file.ends_with(".vtu"))
        all.push_back(file);
    std::sort(all.begin(), all.end());
    return all;
  }

  void expect_same_results(const std::string& a, const std::string& b) const {
    EXPECT_EQ(read_all(folder / a / "history.csv"), read_all(folder / b / "history.csv"));
    EXPECT_EQ(read_all(folder / a / "optimize.pvd"), read_all(folder / b / "optimize.pvd"));
    EXPECT_EQ(result(a), result(b));
    const auto contents = [&](const std::string& name) {
      std::map<std::string, std::string> all;
      for (const auto& entry : fs::directory_iterator(folder / name))
        if (entry.path().extension() == ".vtu") all[entry.path().filename()] = read_all(entry.path());
      return all;
    };
    const auto of_a = contents(a), of_b = contents(b);
    ASSERT_EQ(of_a.size(), of_b.size());
    for (const auto& [name, bytes] : of_a) EXPECT_TRUE(of_b.count(name) && of_b.at(name) == bytes) << name;
  }
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST_F(Optimize, LeavesWhatTheInterfacePromises) {
  write("a.toml", level_set);
  ASSERT_EQ(kerf({"optimize", "a.toml", "-o", "out", "--threads", "1"}), 0) << error();
  const json r = result("out");
  EXPECT_EQ(r["status"], "ok");
  const json& o = r["optimize"];
  EXPECT_EQ(o["method"], "level-set");
  EXPECT_TRUE(o["feasible"]);
  EXPECT_NEAR(o["volume_fraction"].get<double>(), 0.85, 1e-3);
  EXPECT_GE(o["iterations"].get<int>(), 8);
  EXPECT_GE(o["state_solves"].get<int>(), o["iterations"].get<int>());
  // The state is that of the design: another mesh of it gives nearly the objective.
  EXPECT_NEAR(r["state"]["area"].get<double>(), 2 * 0.85, 1e-2);
  EXPECT_NEAR(r["state"]["compliance"].get<double>() / o["objective"].get<double>(), 1, 0.02);
  EXPECT_EQ(r["functional"]["value"], o["objective"]);
  EXPECT_FALSE(r.contains("map"));

  const std::vector<std::string> history = lines_of(read_all(folder / "out/history.csv"));
  // The header, then the start and every iteration; those that were not refused have a design.
  EXPECT_EQ(history.size(), o["iterations"].get<std::size_t>() + 2);
  EXPECT_EQ(
      history[0],
      "iteration,objective,merit,volume_fraction,violation,step,optimality,holes,triangles,state_solves,accepted,note");
  const std::string pvd = read_all(folder / "out/optimize.pvd");
  for (std::size_t k = 0; k + 1 < history.size(); ++k) {
    EXPECT_TRUE(history[k + 1].starts_with(std::to_string(k) + ","));
    std::vector<std::string> cells;
    std::istringstream line(history[k + 1]);
    for (std::string cell; std::getline(line, cell, ',');) cells.push_back(cell);
    std::string name = std::to_string(k);
    name = "design_" + std::string(4 - name.size(), '0') + name + ".vtu";
    const bool accepted = cells.at(10) == "1";
    EXPECT_EQ(fs::exists(folder / "out" / name), accepted) << name;
    EXPECT_EQ(pvd.find("timestep=\"" + std::to_string(k) + "\"") != std::string::npos, accepted);
    EXPECT_EQ(pvd.find("file=\"" + name + "\"") != std::string::npos, accepted);
  }
  for (const char* name : {"state.vtu", "checkpoint.bin", "report.html", "mesh.png", "von_mises.png", "design.png",
                           "evolution.png", "history.png", "optimality.png"})
    EXPECT_TRUE(fs::exists(folder / "out" / name)) << name;
  EXPECT_NE(read_all(folder / "out/report.html").find("<h2>Optimization</h2>"), std::string::npos);
  EXPECT_NE(read_all(folder / "stdout").find("optimize    level-set ended"), std::string::npos);
  EXPECT_NE(error().find("optimize 1: J "), std::string::npos);
  EXPECT_NE(error().find(" left"), std::string::npos);

  // Other settings of output, other threads: the same. Without VTK no designs; what an earlier run left is gone.
  ASSERT_EQ(kerf({"optimize", "a.toml", "-o", "out", "--force", "--set", "output.vtk=false", "--set",
                  "output.png=false", "--threads", "2"}),
            0)
      << error();
  EXPECT_EQ(lines_of(read_all(folder / "out/history.csv")), history);
  EXPECT_FALSE(fs::exists(folder / "out/design_0000.vtu"));
  EXPECT_FALSE(fs::exists(folder / "out/optimize.pvd"));
  EXPECT_FALSE(fs::exists(folder / "out/evolution.png"));
}

TEST_F(Optimize, RunDoesTheOtherJobsOnTheBodyBefore) {
  write("a.toml", parameters + "[map]\npoints = [[0.3, 0.3]]\n[[probe]]\nname = 'p'\npoints = [[0.1, 0.1]]\n");
  ASSERT_EQ(kerf({"run", "a.toml", "-o", "out", "--set", "optimize.max_iterations=3", "--set",
                  "optimize.volume.at_most=0.97"}),
            0)
      << error();
  const json r = result("out");
  EXPECT_TRUE(r.contains("map"));
  EXPECT_TRUE(r.contains("optimize"));
  EXPECT_EQ(r["optimize"]["method"], "mma");
  EXPECT_EQ(r["optimize"]["bounds"][0]["name"], "stress_pnorm");
  EXPECT_EQ(r["optimize"]["variables"][2]["name"], "hole_1.radius");
  EXPECT_NEAR(r["state"]["area"].get<double>(), 2, 1e-12);
  EXPECT_LT(r["optimize"]["volume_fraction"].get<double>(), 0.98);
  for (const char* name : {"map.vtu", "design.png", "design_0000.vtu"})
    EXPECT_TRUE(fs::exists(folder / "out" / name)) << name;
  EXPECT_TRUE(fs::exists(folder / "out/probe_p.csv"));
  EXPECT_NE(r["optimize"]["notes"].dump().find("before the optimization"), std::string::npos);

  // Without the optimization: the body before, under the first load case.
  ASSERT_EQ(kerf({"solve", "a.toml", "-o", "solve"}), 0) << error();
  EXPECT_NEAR(result("solve")["state"]["area"].get<double>(), 2, 1e-12);
  EXPECT_GT(result("solve")["state"]["compliance"].get<double>(), 1.5);
  EXPECT_LT(result("solve")["state"]["compliance"].get<double>(), 2);
}

// What bounds are judged by on the finer mesh: the square of the stress by its interval, an estimate beside the curved
// edges of the hole.
TEST_F(Optimize, UpperEndsOfIntervalsAreWritten) {
  write("a.toml", parameters + "[output]\npng = false\n");
  const std::string least = "optimize.max_iterations=1", much = "optimize.volume.at_most=0.97";
  ASSERT_EQ(kerf({"optimize", "a.toml", "-o", "sixth", "--set", least, "--set", much}), 0) << error();
  const json sixth = result("sixth")["optimize"]["finer"]["bounds"][0];
  EXPECT_FALSE(sixth.contains("upper"));
  EXPECT_NE(sixth["note"].get<std::string>().find("to the power 6"), std::string::npos) << sixth;
  ASSERT_EQ(
      kerf({"optimize", "a.toml", "-o", "square", "--set", least, "--set", much, "--set", "optimize.bound[0].p=2"}), 0)
      << error();
  const json r = result("square"), square = r["optimize"]["finer"]["bounds"][0];
  EXPECT_EQ(square["name"], "stress_pnorm");
  EXPECT_LT(square["lower"].get<double>(), square["upper"].get<double>());
  EXPECT_NEAR(square["value"].get<double>(), square["upper"].get<double>(), 0.2 * square["value"].get<double>());
  EXPECT_FALSE(square["guaranteed"].get<bool>());
  EXPECT_NE(square["note"].get<std::string>().find("what arcs have beyond"), std::string::npos) << square;
  EXPECT_NE(r["optimize"]["stopped"].get<std::string>().find("of what is allowed is estimated"), std::string::npos);
  const fs::path page = folder / "square/report.html";
  ASSERT_EQ(kerf({"report", "square"}), 0) << error();  // from what result.json says
  std::ifstream in(page);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  EXPECT_NE(text.find("estimated at most"), std::string::npos);
}

TEST_F(Optimize, KillsChangeNothing) {
  for (const auto& [name, text] : {std::pair("l", &level_set), std::pair("p", &parameters)}) {
    const std::string file = std::string(name) + ".toml", whole = std::string(name) + "_whole",
                      cut = std::string(name) + "_cut";
    write(file, *text + "[output]\npng = false\n");
    ASSERT_EQ(kerf({"optimize", file, "-o", whole, "--quiet"}), 0) << error();
    // Killed when the first designs appear, somewhere later, in the end.
    bool resumed = false;
    const std::vector<std::string> all = designs(whole);
    ASSERT_GE(all.size(), 4U);
    for (const std::string& at : {all[0], all[1], all[3], std::string("state.vtu")}) {
      std::vector<std::string> arguments = {"optimize", file, "-o", cut, "--quiet"};
      if (resumed) arguments.emplace_back("--resume");
      const int code = interrupt(arguments, folder / cut / at, SIGKILL);
      // Little is left to do after the state is written: the run may end before the kill comes.
      EXPECT_TRUE(code == 128 + SIGKILL || (code == 0 && at == "state.vtu")) << at << error();
      resumed = true;
    }
    ASSERT_EQ(kerf({"optimize", file, "-o", cut, "--quiet", "--resume"}), 0) << error();
    expect_same_results(whole, cut);
    // Resumed at its end it ends again.
    ASSERT_EQ(kerf({"optimize", file, "-o", cut, "--quiet", "--resume"}), 0) << error();
    expect_same_results(whole, cut);
  }
}

TEST_F(Optimize, AStopAskedForIsCleanAndChangesNothing) {
  for (const auto& [name, text] : {std::pair("l", &level_set), std::pair("p", &parameters)}) {
    const std::string file = std::string(name) + ".toml", whole = std::string(name) + "_whole",
                      cut = std::string(name) + "_cut";
    write(file, *text);
    ASSERT_EQ(kerf({"optimize", file, "-o", whole, "--quiet", "--set", "output.png=false"}), 0) << error();
    EXPECT_EQ(interrupt({"optimize", file, "-o", cut, "--quiet"}, folder / cut / designs(whole).at(1), SIGINT), 4);
    EXPECT_NE(error().find("stopped after iteration"), std::string::npos) << error();
    EXPECT_FALSE(fs::exists(folder / cut / "result.json"));
    for (const char* left : {"history.csv", "optimize.pvd", "checkpoint.bin", "history.png", "evolution.png"})
      EXPECT_TRUE(fs::exists(folder / cut / left)) << left;
    ASSERT_EQ(kerf({"optimize", file, "-o", cut, "--quiet", "--resume", "--set", "output.png=false"}), 0) << error();
    expect_same_results(whole, cut);
  }
}

TEST_F(Optimize, AFinishedRunGoesOnForMoreIterations) {
  write("a.toml", small_change);
  ASSERT_EQ(kerf({"optimize", "a.toml", "-o", "out", "--quiet", "--set", "optimize.max_iterations=4"}), 0) << error();
  const std::vector<std::string> before = lines_of(read_all(folder / "out/history.csv"));
  ASSERT_EQ(kerf({"optimize", "a.toml", "-o", "out", "--quiet", "--resume", "--set", "optimize.max_iterations=6"}), 0)
      << error();
  const std::vector<std::string> after = lines_of(read_all(folder / "out/history.csv"));
  ASSERT_GT(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(after[i], before[i]);
}

TEST_F(Optimize, OtherCasesAreNotResumed) {
  write("a.toml", small_change);
  // Nothing there yet: it begins.
  ASSERT_EQ(kerf({"optimize", "a.toml", "-o", "out", "--quiet", "--resume", "--set", "optimize.max_iterations=2"}), 0)
      << error();
  const std::string history = read_all(folder / "out/history.csv");
  EXPECT_EQ(kerf({"optimize", "a.toml", "-o", "out", "--quiet", "--resume", "--set", "material.young=2"}), 2);
  EXPECT_NE(error().find("belongs to another case"), std::string::npos) << error();
  EXPECT_TRUE(fs::exists(folder / "out/result.json"));
  EXPECT_EQ(read_all(folder / "out/history.csv"), history);
  // The case that lies in the folder is the same one.
  EXPECT_EQ(kerf({"optimize", "out/case.toml", "-o", "out", "--quiet", "--resume"}), 0) << error();

  // A damaged checkpoint is named.
  const std::string bytes = read_all(folder / "out/checkpoint.bin");
  std::ofstream(folder / "out/checkpoint.bin", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  EXPECT_EQ(kerf({"optimize", "a.toml", "-o", "out", "--quiet", "--resume"}), 5);
  EXPECT_NE(error().find("checkpoint.bin' is cut off"), std::string::npos) << error();

  // Without --resume it is replaced.
  EXPECT_EQ(kerf({"optimize", "a.toml", "-o", "out", "--quiet"}), 5);  // --force is missing
  std::ofstream(folder / "out/design_0007.vtu") << "of an earlier run";
  ASSERT_EQ(kerf({"optimize", "a.toml", "-o", "out", "--quiet", "--force", "--set", "optimize.max_iterations=1"}), 0)
      << error();
  EXPECT_FALSE(fs::exists(folder / "out/design_0007.vtu"));
}

TEST_F(Optimize, WhatCannotBeDoneIsSaid) {
  write("plain.toml", level_set.substr(0, level_set.find("[optimize]")));
  EXPECT_EQ(kerf({"optimize", "plain.toml"}), 2);
  EXPECT_NE(error().find("no table [optimize]"), std::string::npos) << error();
  EXPECT_EQ(kerf({"run", "plain.toml", "--resume"}), 2);
  EXPECT_NE(error().find("nothing to resume"), std::string::npos) << error();
  EXPECT_EQ(kerf({"solve", "plain.toml", "--resume"}), 2);
  write("a.toml", level_set);
  EXPECT_EQ(kerf({"optimize", "a.toml", "--set", "solver.element='p2'", "--set", "crack[0].contact='open'"}), 2);
  EXPECT_NE(error().find("derivatives"), std::string::npos) << error();
  EXPECT_EQ(kerf({"optimize", "a.toml", "--set", "crack[0].pressure=0.3"}), 2);
  EXPECT_NE(error().find("carries a pressure"), std::string::npos) << error();

  // A bound that no design meets: the end is called infeasible, and everything is there.
  write("p.toml", parameters);
  EXPECT_EQ(kerf({"optimize", "p.toml", "-o", "bad", "--set", "optimize.bound[0].at_most=0.5", "--set",
                  "optimize.max_iterations=3"}),
            4);
  EXPECT_EQ(result("bad")["status"], "infeasible");
  EXPECT_FALSE(result("bad")["optimize"]["feasible"].get<bool>());
  EXPECT_TRUE(fs::exists(folder / "bad/report.html"));
}

// An inverse problem: how many, where, how sure.
TEST_F(Optimize, ReadingsAreFittedAndCounted) {
  write("a.toml", R"([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "m", "m", "m"]
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "m"
traction = ["0.5*nx", "ny"]
[mesh]
size = 0.1
[functional]
kind = "misfit"
on = "m"
measured = "synthetic"
[synthetic]
element = "p2"
noise = 0.01
spacing = 0.05
[[synthetic.hole]]
name = "true"
circle = { center = [0.6, 0.55], radius = 0.12 }
[optimize]
method = "mma"
max_iterations = 15
tolerance = 0.05
defects = { at_most = 2 }
[[optimize.hole]]
name = "h"
circle = { center = [[0.2, 0.8], [0.2, 0.8]], radius = [0.05, 0.2] }
start = "map"
)");
  ASSERT_EQ(kerf({"optimize", "a.toml"}), 0) << error();
  const json optimize = result("out/a")["optimize"];
  EXPECT_EQ(optimize["defects"]["count"], 1);
  EXPECT_GE(optimize["defects"]["tried"].size(), 2u);
  const json& fit = optimize["least_squares"];
  EXPECT_LE(fit["end"].get<double>(), fit["start"].get<double>());
  ASSERT_EQ(fit["variables"].size(), 3u);
  EXPECT_EQ(fit["variables"][0]["name"], "h.x");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(optimize["variables"][i]["value"], fit["variables"][i]["value"]);
    const double truth[] = {0.6, 0.55, 0.12};
    EXPECT_LT(std::abs(fit["variables"][i]["value"].get<double>() - truth[i]),
              4 * fit["variables"][i]["deviation"].get<double>());
  }
  EXPECT_EQ(fit["ellipses"][0]["name"], "hole 'h'");
  EXPECT_TRUE(fs::exists(folder / "out/a/found.png"));
}

}  // namespace
}  // namespace kerf::optimize_run_test
