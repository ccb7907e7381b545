// Every command and every verdict as a user meets them, in a second each, with truths in closed form.

#include "tests/support/folder.hpp"
#include "tests/support/running.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kerf::commands_test {
namespace {

using nlohmann::json;

// A square of Young's modulus 2 in plane stress.
const std::string square = R"([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 2
poisson = 0.3
state = "plane stress"
[mesh]
size = 0.2
)";
// On rollers at the left and at the bottom; the top is pulled by 1: a uniform stress, and the energy -1/2 1^2/E.
const std::string pulled = square + R"([[boundary]]
on = "left"
displacement_x = 0
[[boundary]]
on = "bottom"
displacement_y = 0
[[boundary]]
on = "top"
traction = [0, 1]
)";
// Pressed by 1 from all sides: the energy is -(1 - nu)/E.
const std::string pressed = pulled + R"([[boundary]]
on = "right"
traction = [-1, 0]
)";
const std::string crack = "[[crack]]\nname = \"c\"\npath = [[0.3, 0.5], [0.7, 0.5]]\n";
const std::string no_files = "[output]\nvtk = false\npng = false\nhtml = false\n";

class Commands : public kerf::test::InFolder {
 protected:
  /// The exit code of `kerf WORDS`.
  int kerf(std::vector<std::string> words) const {
    words.insert(words.begin(), KERF_PROGRAM);
    return kerf::test::Running(folder, words).code();
  }
  void write(const std::string& text) const {
    std::ofstream(folder / "a.toml") << text;
  }
  /// result.json of a command on this case, which ends with this code.
  json result(const std::string& command, const std::string& text, const std::vector<std::string>& settings = {},
              int code = 0) const {
    write(text + no_files);
    std::vector<std::string> words = {command, "a.toml", "-o", "out", "--force", "--quiet"};
    for (const std::string& s : settings) words.insert(words.end(), {"--set", s});
    EXPECT_EQ(kerf(words), code) << this->text("stderr");
    return json::parse(std::ifstream(folder / "out" / "result.json"), nullptr, false);
  }
};

TEST_F(Commands, SolveGivesTheStressOfABar) {
  const json r = result("solve", pulled);
  EXPECT_EQ(r["status"], "ok");
  EXPECT_NEAR(r["state"]["energy"], -0.25, 1e-12);
  EXPECT_NEAR(r["state"]["compliance"], 0.5, 1e-12);
  EXPECT_LE(r["state"]["energy_bounds"][0], -0.25 + 1e-12);
  EXPECT_GE(r["state"]["energy_bounds"][1], -0.25 - 1e-12);
  EXPECT_NEAR(r["state"]["max_von_mises"]["value"], 1, 1e-10);
  EXPECT_FALSE(r["state"]["max_von_mises"]["singular"]);
  EXPECT_LT(r["state"]["work_error"], 1e-8);
  for (const char* absent : {"map", "validate", "optimize", "contact"}) EXPECT_FALSE(r.contains(absent)) << absent;
}

// Pressed, the faces touch everywhere and carry the pressure as if they were whole.
TEST_F(Commands, SolveClosesACrackThatIsPressed) {
  const json r = result("solve", pulled + crack, {"boundary[2].traction=[0,-1]"});
  EXPECT_EQ(r["status"], "ok");
  EXPECT_NEAR(r["state"]["energy"], -0.25, 1e-10);
  EXPECT_NEAR(r["contact"]["closed_length"], 0.4, 1e-12);
  EXPECT_NEAR(r["cracks"][0]["max_pressure"], 1, 1e-8);
  EXPECT_NEAR(r["cracks"][0]["tips"][0]["K_I"], 0, 1e-8);
  EXPECT_LT(r["contact"]["kkt"], 1e-8);
}

TEST_F(Commands, SolveNamesASingularPeak) {
  const json r = result("solve", pulled + crack);
  EXPECT_TRUE(r["state"]["max_von_mises"]["singular"]);
  EXPECT_NEAR(std::abs(r["state"]["max_von_mises"]["at"][0].get<double>() - 0.5), 0.2, 0.05);
  EXPECT_TRUE(r["state"]["max_von_mises"]["regular"].is_object());
}

// By a mesh of its own of degree 3.
TEST_F(Commands, SolveReachesTheErrorThatIsAsked) {
  const std::string uneven = pulled + "[solver]\ndegree = 1\n";
  const std::string load = "boundary[2].traction=[0,\"exp(x)\"]";
  const json fine = result("solve", uneven, {load, "solver.degree=3", "mesh.size=0.1"});
  const json r = result("solve", uneven, {load, "mesh.adapt={ error = 0.02, max_triangles = 20000 }"});
  EXPECT_EQ(r["mesh"]["adapt"]["stopped"].get<std::string>().rfind("reached", 0), 0u) << r["mesh"]["adapt"];
  // The energy of the error is at most the square of what is asked.
  EXPECT_NEAR(r["state"]["energy"].get<double>() / fine["state"]["energy"].get<double>(), 1, 0.02 * 0.02);
}

// Few holes of area f soften a plate as E (1 - 3 f) along the pull.
TEST_F(Commands, MapGivesTheCostOfAHoleInABar) {
  const json r = result("map", pulled + "[map]\npoints = [[0.5, 0.5], [0.3, 0.6]]\n");
  ASSERT_EQ(r["map"]["points"].size(), 2u);
  for (const json& p : r["map"]["points"]) EXPECT_NEAR(p["value"], -0.75, 1e-9);
  EXPECT_EQ(r["map"]["perturbation"], "hole");
  EXPECT_FALSE(r.contains("validate"));
}

TEST_F(Commands, ValidateSaysThatItHolds) {
  const json r = result("validate", pulled + "[validate]\npoints = [[0.5, 0.5]]\nradii = [0.08, 0.04, 0.02, 0.01]\n");
  ASSERT_EQ(r["validate"].size(), 1u);
  EXPECT_EQ(r["validate"][0]["verdict"], "holds") << r["validate"][0]["reason"];
  EXPECT_NEAR(r["validate"][0]["coefficient"], -0.75, 1e-9);
  for (const json& row : r["validate"][0]["rows"]) {
    const double radius = row["radius"];
    EXPECT_NEAR(row["difference"].get<double>() / (-0.75 * pi * radius * radius), 1, 30 * radius * radius) << radius;
  }
}

TEST_F(Commands, StrictEndsWith4UnlessTheExpansionHolds) {
  const std::string point = pulled + no_files + "[validate]\npoints = [[0.5, 0.5]]\n";
  write(point + "radii = [0.08, 0.04, 0.02, 0.01]\n");
  EXPECT_EQ(kerf({"validate", "a.toml", "--strict", "-o", "r", "--quiet"}), 0) << text("stderr");
  write(point + "radii = [0.44, 0.4, 0.36]\n");
  EXPECT_EQ(kerf({"validate", "a.toml", "-o", "s", "--quiet"}), 0) << text("stderr");
  EXPECT_EQ(kerf({"validate", "a.toml", "--strict", "-o", "t", "--quiet"}), 4);
  EXPECT_NE(text("stderr").find("does not hold at 1 of 1 points: (0.5, 0.5) out of range"), std::string::npos)
      << text("stderr");
}

// A small crack that is pressed from all sides changes nothing.
TEST_F(Commands, ValidateSaysThatItVanishes) {
  const json r =
      result("validate",
             pressed + "[map]\nperturbation = \"crack\"\n[validate]\npoints = [[0.5, 0.5]]\nradii = [0.08, 0.04]\n",
             {"boundary[2].traction=[0,-1]", "mesh.size=0.4", "solver.degree=1"});
  EXPECT_NEAR(r["state"]["energy"], -0.35, 1e-12);
  EXPECT_EQ(r["validate"][0]["verdict"], "vanishes") << r["validate"][0]["reason"];
  EXPECT_NEAR(r["validate"][0]["coefficient"], 0, 1e-12);
}

TEST_F(Commands, ValidateSaysWhatIsOutOfRange) {
  const json r = result("validate", pulled + "[validate]\npoints = [[0.5, 0.5]]\nradii = [0.44, 0.4, 0.36]\n");
  EXPECT_EQ(r["validate"][0]["verdict"], "out of range") << r["validate"][0]["reason"];
}

/// A hole in the middle takes at least a tenth of the plate.
const std::string drilled = pulled + R"([functional]
kind = "compliance"
[optimize]
method = "mma"
volume = { at_most = 0.9 }
max_iterations = 30
[[optimize.hole]]
circle = { center = [[0.5, 0.5], [0.5, 0.5]], radius = [0.1, 0.3] }
start = { center = [0.5, 0.5], radius = 0.2 }
)";

TEST_F(Commands, OptimizeEndsAtTheOnlyOptimum) {
  const json r = result("optimize", drilled);
  EXPECT_EQ(r["optimize"]["ending"], "optimal") << r["optimize"]["stopped"];
  EXPECT_NEAR(r["optimize"]["variables"][2]["value"], std::sqrt(0.1 / pi), 1e-4);
  EXPECT_NEAR(r["optimize"]["volume_fraction"], 0.9, 1e-4);
  EXPECT_GT(r["optimize"]["objective"],
            0.5 + 3 * 0.1 / 2);  // a hole in a finite plate costs more than in an infinite one
  EXPECT_TRUE(r["optimize"]["feasible"]);
}

TEST_F(Commands, OptimizeSaysWhyItEndsOtherwise) {
  const json used = result("optimize", drilled, {"optimize.max_iterations=1"});
  EXPECT_EQ(used["optimize"]["ending"], "budget used") << used["optimize"]["stopped"];
  const std::string bound = "[[optimize.bound]]\nkind = \"compliance\"\nat_most = 0.4\n";  // the whole plate has 0.5
  const json bad = result("optimize", drilled + bound, {"optimize.max_iterations=3"}, 4);
  EXPECT_EQ(bad["optimize"]["ending"], "infeasible") << bad["optimize"]["stopped"];
  EXPECT_EQ(bad["status"], "infeasible");
}

TEST_F(Commands, RunDoesEveryJobThatTheCaseNames) {
  const json r = result(
      "run", pulled + "[map]\npoints = [[0.5, 0.5]]\n[validate]\npoints = [[0.5, 0.5]]\nradii = [0.04, 0.02, 0.01]\n");
  EXPECT_EQ(r["status"], "ok");
  EXPECT_NEAR(r["map"]["points"][0]["value"], -0.75, 1e-9);
  EXPECT_EQ(r["validate"][0]["verdict"], "holds") << r["validate"][0]["reason"];
  EXPECT_FALSE(r.contains("optimize"));
}

TEST_F(Commands, MeshWritesTheBodyThatIsReadAgain) {
  write(pulled + no_files);
  ASSERT_EQ(kerf({"mesh", "a.toml", "-o", "x.msh"}), 0) << text("stderr");
  const json drawn = result("solve", pulled);
  const std::size_t outline = pulled.find("outline"), end = pulled.find("[material]");
  const json read = result("solve", std::string(pulled).replace(outline, end - outline, "file = \"x.msh\"\n"));
  EXPECT_EQ(read["mesh"]["triangles"], drawn["mesh"]["triangles"]);
  EXPECT_NEAR(read["state"]["area"], 1, 1e-12);
  EXPECT_NEAR(read["state"]["energy"], -0.25, 1e-12);
}

TEST_F(Commands, InitWritesACaseThatIsRight) {
  ASSERT_EQ(kerf({"init", "plate"}), 0) << text("stderr");
  EXPECT_EQ(kerf({"check", "plate.toml"}), 0) << text("stderr");
  EXPECT_EQ(kerf({"init", "plate"}), 5);  // what is there stays
  EXPECT_EQ(kerf({"init", "plat"}), 2);
}

TEST_F(Commands, SweepRunsACasePerValue) {
  write(pulled + no_files);
  ASSERT_EQ(kerf({"sweep", "a.toml", "--over", "material.young=[1, 2, 4]", "-o", "s", "--quiet"}), 0) << text("stderr");
  int found = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "s"))
    if (entry.path().filename() == "result.json") {
      const json r = json::parse(std::ifstream(entry.path()));
      ++found;
      const double young = -0.5 / r["state"]["energy"].get<double>();
      EXPECT_NEAR(std::log2(young), std::round(std::log2(young)), 1e-10);
    }
  EXPECT_EQ(found, 3);
}

TEST_F(Commands, WatchShowsWhatWasSaved) {
  write(pulled);
  kerf::test::Running watch(folder, {KERF_PROGRAM, "watch", "a.toml", "-o", "w"});
  const auto shows = [&](const char* words) {
    return kerf::test::eventually([&] { return text("w/watch.html").find(words) != std::string::npos; });
  };
  ASSERT_TRUE(shows("The case is right, change 1")) << text("stderr");
  EXPECT_TRUE(std::filesystem::exists(folder / "w/check.png"));
  write(pulled + "[mesh2]\n");
  EXPECT_TRUE(shows("a.toml:19:2: unknown key")) << text("w/watch.html");
  write(pulled);
  EXPECT_TRUE(shows("The case is right, change 3")) << text("w/watch.html");
  watch.signal(SIGINT);
  EXPECT_EQ(watch.code(), 0);
}

TEST_F(Commands, HelpIsThatOfTheCommand) {
  ASSERT_EQ(kerf({"sweep", "--help"}), 0);
  const std::string help = text("stdout");
  EXPECT_EQ(kerf({"help", "sweep"}), 0);
  EXPECT_EQ(text("stdout"), help);
  EXPECT_EQ(kerf({"--help"}), 0);
  const std::string all = text("stdout");
  EXPECT_EQ(kerf({"help"}), 0);
  EXPECT_EQ(text("stdout"), all);
  EXPECT_EQ(kerf({"help", "swep"}), 2);
  EXPECT_NE(text("stderr").find("did you mean \"sweep\"?"), std::string::npos) << text("stderr");
}

TEST_F(Commands, ReportComparesTwoRuns) {
  write(pulled + no_files);
  ASSERT_EQ(kerf({"solve", "a.toml", "-o", "one", "--quiet"}), 0) << text("stderr");
  ASSERT_EQ(kerf({"solve", "a.toml", "-o", "two", "--quiet", "--set", "material.young=4"}), 0) << text("stderr");
  ASSERT_EQ(kerf({"report", "one", "two"}), 0) << text("stderr");
  const std::string page = text("two/compare.html");
  EXPECT_NE(page.find("<tr><td>material.young</td><td>2</td><td>4</td><td>+2 (+100 %)</td></tr>"), std::string::npos)
      << page;
  EXPECT_NE(page.find("<tr><td>state.energy</td><td>-0.25</td><td>-0.125</td><td>+0.125 (+50 %)</td></tr>"),
            std::string::npos)
      << page;
  EXPECT_EQ(page.find("time_s"), std::string::npos);
  ASSERT_EQ(kerf({"report", "one", "one", "-o", "same.html"}), 0) << text("stderr");
  EXPECT_NE(text("same.html").find("the cases are the same"), std::string::npos);
  EXPECT_EQ(kerf({"report", "one", "none"}), 5);
  EXPECT_EQ(kerf({"report", "one", "-o", "x.html"}), 2);
}

// A bar with E = 2 under a stress of 1: the reserve against a yield stress of 2.5 is 2.5.
TEST_F(Commands, SolveSaysTheReserve) {
  const json r = result("solve", pulled, {"material.yield=2.5"});
  ASSERT_EQ(r["state"]["reserve"].size(), 1u);
  EXPECT_EQ(r["state"]["reserve"][0]["of"], "yield");
  EXPECT_NEAR(r["state"]["reserve"][0]["factor"], 2.5, 1e-9);
  EXPECT_NEAR(r["state"]["reserve"][0]["value"], 1, 1e-9);
}

// Of each material its own largest stress; a region that says nothing of its strength is not judged. A soft disc in
// tension takes less stress than the plate around it.
TEST_F(Commands, SolveSaysTheReserveOfEachMaterial) {
  const std::string disc =
      "[[region]]\nname = \"soft\"\ncircle = { center = [0.5, 0.5], radius = 0.2 }\nyoung = 0.5\npoisson = 0.3\n";
  const json both = result("solve", pulled + disc + "yield = 1\n", {"material.yield=1"})["state"]["reserve"];
  ASSERT_EQ(both.size(), 2u);
  EXPECT_FALSE(both[0].contains("region"));
  EXPECT_EQ(both[1]["region"], "soft");
  EXPECT_GT(both[0]["value"], 1.2);
  EXPECT_LT(both[1]["value"], 0.9);
  EXPECT_EQ(result("solve", pulled + disc, {"material.yield=1"})["state"]["reserve"].size(), 1u);
}

// K of a tip, its toughness in the region in which it lies; G_c = K_Ic^2/E says the same.
TEST_F(Commands, SolveSaysTheReserveOfATip) {
  const json r = result("solve", pulled + crack, {"material.toughness=3"});
  ASSERT_EQ(r["state"]["reserve"].size(), 2u);
  double least = 1e9;
  for (const json& tip : r["cracks"][0]["tips"])
    least = std::min(least, 3 / std::hypot(tip["K_I"].get<double>(), tip["K_II"].get<double>()));
  EXPECT_NEAR(r["state"]["reserve"][0]["factor"], least, 1e-9);
  EXPECT_EQ(r["state"]["reserve"][0]["crack"], "c");
  const json rate = result("solve", pulled + crack, {"material.release_rate=4.5"});
  EXPECT_NEAR(rate["state"]["reserve"][0]["factor"], least, 1e-3 * least);
}

TEST_F(Commands, SweepShowsTheColumnsThatAreAskedFor) {
  write(pulled + no_files);
  const std::vector<std::string> sweep = {"sweep", "a.toml", "--over", "solver.element=bdms,peers",
                                          "-o",    "s",      "--quiet"};
  ASSERT_EQ(kerf(sweep), 0) << text("stderr");
  const auto head = [&] {
    const std::string table = text("s/sweep.csv");
    return table.substr(0, table.find('\n'));
  };
  EXPECT_NE(head().find(",state.energy"), std::string::npos) << head();
  EXPECT_EQ(head().find("residual"), std::string::npos) << head();
  EXPECT_NE(text("s/sweep.csv").find("\nelement=peers,peers,ok,"), std::string::npos) << text("s/sweep.csv");
  const auto with = [&](const char* columns) {
    std::vector<std::string> words = sweep;
    words.insert(words.end(), {"--collect", "--columns", columns});
    return words;
  };
  EXPECT_EQ(kerf(with("energy,residual")), 0) << text("stderr");
  EXPECT_EQ(head(), "run,solver.element,status,reason,state.residual,state.energy");
  EXPECT_EQ(kerf(with("all")), 0) << text("stderr");
  EXPECT_NE(head().find("state.work_error"), std::string::npos) << head();
  EXPECT_EQ(kerf(with("K_V")), 2);
}

// A hole in a bar: K_t on three meshes tends to a limit that lies beyond the finest value; the energy is of order 2 or
// more.
TEST_F(Commands, SweepOverSizesSaysWhatTheyTendTo) {
  write(pulled + no_files + "[[hole]]\nname = \"h\"\ncircle = { center = [0.5, 0.5], radius = 0.2 }\n");
  ASSERT_EQ(kerf({"sweep", "a.toml", "--over", "mesh.size=auto", "-o", "s", "--set", "solver.degree=1"}), 0)
      << text("stderr");
  EXPECT_NE(text("stdout").find("state.energy"), std::string::npos) << text("stdout");
  const std::string table = text("s/convergence.csv");
  EXPECT_NE(table.find("state.energy,,0.40000000000000002,0.20000000000000001,0.10000000000000001,"), std::string::npos)
      << table;
  EXPECT_NE(text("s/sweep.html").find("<h2>Convergence</h2>"), std::string::npos);
  EXPECT_EQ(kerf({"sweep", "a.toml", "--over", "material.young=auto", "-o", "t"}), 2);
}

// A result.json that is damaged is the failure of its own run, told in its row; the sweep goes on, and mends it.
TEST_F(Commands, ADamagedResultIsTheFailureOfItsRun) {
  write(pulled + no_files);
  const std::vector<std::string> sweep = {"sweep", "a.toml", "--over", "material.young=[1, 2]", "-o", "s", "--quiet"};
  ASSERT_EQ(kerf(sweep), 0) << text("stderr");
  std::filesystem::path result;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "s"))
    if (entry.path().filename() == "result.json") result = entry.path();
  const std::string whole = text(result.lexically_relative(folder));
  std::string renamed = whole;
  renamed.replace(renamed.find("\"status\""), 8, "\"stotus\"");
  std::vector<std::string> collect = sweep;
  collect.push_back("--collect");
  for (const std::string& damaged : {whole.substr(0, whole.size() / 2), renamed, std::string("[]"), std::string(),
                                     "{\"a\":" + std::string(100000, '[')}) {
    std::ofstream(result) << damaged;
    EXPECT_EQ(kerf(collect), 0) << text("stderr");
    const std::string table = text("s/sweep.csv");
    EXPECT_EQ(table.find(",missing,"), std::string::npos) << table;
    EXPECT_NE(table.find(",failed,"), std::string::npos) << table;
    EXPECT_NE(table.find("result.json is damaged"), std::string::npos) << table;
    EXPECT_NE(table.find(",ok,"), std::string::npos) << table;
  }
  EXPECT_EQ(kerf(sweep), 0) << text("stderr");
  EXPECT_EQ(text("s/sweep.csv").find(",failed,"), std::string::npos);
}

}  // namespace
}  // namespace kerf::commands_test
