// Functionals, maps and validations from case file to files.

#include "app/run.hpp"
#include "tests/support/folder.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace kerf::map_run_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const char* const body = R"(
[domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[-0.4, 0], [0.4, 0]]
[material]
young = 1.0
poisson = 0.3
state = "plane strain"
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "top"
traction = [0.1, "x - 0.05"]
[mesh]
size = 0.15
)";

class MapRun : public test::InFolder {
 protected:
  json run_text(const std::string& more, Job job = Job::Run, int threads = 2) {
    std::ofstream(folder / "case.toml") << body << more;
    run(read_case(folder / "case.toml"), job, {.folder = folder / "out", .threads = threads});
    return json::parse(std::ifstream(folder / "out/result.json"));
  }
  std::vector<std::string> lines(const std::string& name) const {
    std::ifstream file(folder / "out" / name);
    std::vector<std::string> all;
    for (std::string line; std::getline(file, line);) all.push_back(line);
    return all;
  }
};

TEST_F(MapRun, ValidationHoldsForATrackingFunctional) {
  const json r = run_text(R"(
[functional]
kind = "displacement_tracking"
target = [0, "0.1 * y"]
[map]
points = [[0.15, 0.45]]
[validate]
points = [[0.15, 0.45], [0.99, 0.99]]
radii = [0.08, 0.04, 0.02, 0.01]
)");
  ASSERT_EQ(r["validate"].size(), 2u);
  const json& v = r["validate"][0];
  EXPECT_EQ(v["verdict"], "holds");
  EXPECT_NEAR(v["order"].get<double>(), 4, 0.3);
  EXPECT_NEAR(v["coefficient"].get<double>() / r["map"]["points"][0]["value"].get<double>(), 1, 0.02);
  ASSERT_EQ(v["rows"].size(), 4u);
  const json& row = v["rows"][0];
  EXPECT_NEAR(row["difference"].get<double>() - row["predicted"].get<double>(), row["remainder"].get<double>(), 1e-15);
  EXPECT_NEAR(row["J"].get<double>() - row["difference"].get<double>(), r["functional"]["value"].get<double>(), 0.01);
  EXPECT_EQ(r["validate"][1]["verdict"], "out of range");
  EXPECT_EQ(lines("validate.csv").size(), 9u);
  EXPECT_TRUE(fs::exists(folder / "out/validate.png"));
}

TEST_F(MapRun, ErrorBarsEncloseTheValues) {
  const json r = run_text("[map]\nbounds = true\npoints = [[0.15, 0.35], [-0.6, 0.3]]\n", Job::Map);
  for (const json& p : r["map"]["points"]) {
    EXPECT_LT(p["lower"].get<double>(), p["value"].get<double>());
    EXPECT_GT(p["upper"].get<double>(), p["value"].get<double>());
    EXPECT_LT(p["upper"].get<double>() - p["lower"].get<double>(), 0.2 * std::abs(p["value"].get<double>()));
  }
  EXPECT_EQ(lines("map.csv")[0], "x,y,topological_derivative,lower,upper,masked");
}

TEST_F(MapRun, SaysHowFarTheFirstTermReaches) {
  const json r = run_text("[map]\nsecond = true\npoints = [[0.15, 0.45], [3, 3]]\n", Job::Map);
  const json& p = r["map"]["points"][0];
  // No farther than the second term says; less where that is not known well, or a feature is near.
  const double by_second = std::sqrt(0.05 * std::abs(p["value"].get<double>() / p["c2"].get<double>()));
  EXPECT_LE(p["valid_radius"].get<double>(), by_second * (1 + 1e-12));
  EXPECT_GT(p["valid_radius"].get<double>(), 0.5 * by_second);
  EXPECT_TRUE(r["map"]["points"][1]["c2"].is_null());
  const std::vector<std::string> rows = lines("map.csv");
  EXPECT_EQ(rows[0], "x,y,topological_derivative,c2,valid_radius,masked");
}

TEST_F(MapRun, TheSecondTermMasksWhereItIsKnown) {
  constexpr double radius = 0.05;
  run_text("[map]\nsecond = true\nradius = 0.05\n", Job::Map);
  unsigned known = 0, masked_by_it = 0;
  double largest = 0;
  for (const bool counting : {false, true})
    for (const std::string& line : lines("map.csv")) {
      double x, y, T, c2, valid;
      int masked;
      if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%d", &x, &y, &T, &c2, &valid, &masked) != 6) continue;
      if (!counting) {
        largest = std::max(largest, std::abs(T));
        continue;
      }
      ++known;
      const bool far_off = std::abs(c2) * radius * radius > 0.05 * std::max(std::abs(T), 0.01 * largest);
      EXPECT_TRUE(masked > 0 || !far_off) << line;
      masked_by_it += far_off;
      const double side = std::min({1 - std::abs(x), 1 - std::abs(y)});
      EXPECT_TRUE(masked > 0 || side > 1.9 * radius) << line;
    }
  EXPECT_GT(known, 50u);
  EXPECT_GT(masked_by_it, 0u);
}

// Held all around and nearly incompressible: T is that of holes below a thousandth of the body.
TEST(HeldMap, SaysThatItsRadiusIsBeyondWhatTheBodyAnswers) {
  const auto notes = [](double poisson, const std::string& map, const std::string& top = "rim") {
    const test::Folder folder;
    std::ofstream(folder.path / "a.toml") << fmt::format(R"toml(
[domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["rim", "rim", "{}", "rim"]
[material]
young = 1
poisson = {}
[[boundary]]
on = "rim"
displacement = ["1e-3 * x", "-1e-3 * y"]
[body]
force = ["10 * sin(pi * x)", "y"]
[mesh]
size = 0.05
[map]
{}
)toml",
                                                         top, poisson, map);
    const Result r = run(read_case(folder.path / "a.toml"), Job::Map, {.folder = folder.path / "out", .threads = 1});
    std::string all;
    for (const std::string& note : r.state->notes) all += note + '\n';
    return all;
  };
  const char* const words = "nearly incompressible and held all around";
  EXPECT_NE(notes(0.499999, "").find(words), std::string::npos) << notes(0.499999, "");
  EXPECT_NE(notes(0.499999, "points = [[0.7, 0.4]]").find(words), std::string::npos);
  EXPECT_EQ(notes(0.499999, "radius = 1e-5").find(words), std::string::npos);
  EXPECT_EQ(notes(0.4999, "radius = 0.6", "free").find(words), std::string::npos);
  EXPECT_EQ(notes(0.3, "").find(words), std::string::npos);
}

TEST_F(MapRun, SaysWhyThereIsNoSecondTerm) {
  const json track = run_text(
      "[functional]\nkind = \"boundary_tracking\"\non = \"top\"\ntarget = [0, 0]\n[map]\nsecond = true\n", Job::Map);
  EXPECT_NE(track["state"]["notes"].dump().find("no c2"), std::string::npos) << track["state"]["notes"];
  EXPECT_EQ(lines("map.csv")[0], "x,y,topological_derivative,c2,valid_radius,masked");
}

TEST_F(MapRun, EveryPerturbationAndFunctionalRuns) {
  for (const char* change : {"\"hole\"", "{ young = 5.0, poisson = 0.2 }", "\"crack\"", "{ aspect = 2.0 }"}) {
    const json r =
        run_text(std::string("[functional]\nkind = \"compliance\"\n[map]\nperturbation = ") + change + "\n", Job::Map);
    EXPECT_EQ(r["status"], "ok") << change;
    EXPECT_TRUE(std::isfinite(r["map"]["max"]["value"].get<double>())) << change;
  }
  for (const char* functional :
       {"kind = \"volume\"", "kind = \"boundary_tracking\"\non = \"top\"\ntarget = [0, 0]",
        "kind = \"displacement\"\non = \"top\"\ndirection = [\"nx\", 1]", "kind = \"stress_power\"\np = 4",
        "kind = \"stress_pnorm\"\np = 5", "kind = \"misfit\"\non = \"top\"\nmeasured = [0, \"0.3 * x\"]",
        "kind = \"energy_release_rate\"\ncrack = \"c\"\ntip = \"end\"", "kind = \"crack_opening\"\ncrack = \"c\"",
        "kind = \"crack_pressure\"\ncrack = \"c\"\ntarget = 0",
        "kind = \"sum\"\nterms = [{ kind = \"compliance\" }, { kind = \"volume\", factor = 2.0 }]"}) {
    const json r = run_text(std::string("[functional]\n") + functional + "\n[map]\npoints = [[-0.6, 0.5]]\n", Job::Map);
    EXPECT_EQ(r["status"], "ok") << functional;
    EXPECT_TRUE(std::isfinite(r["map"]["points"][0]["value"].get<double>())) << functional;
  }
}

TEST_F(MapRun, SameBitsForAnyNumberOfThreads) {
  const std::string more = R"(
[functional]
kind = "displacement_tracking"
target = [0, 0]
[map]
[validate]
points = [[0.15, 0.45], [-0.6, -0.5]]
radii = [0.04, 0.02]
)";
  json one = run_text(more, Job::Run, 1), two = run_text(more, Job::Run, 2);
  EXPECT_EQ(one["map"], two["map"]);
  EXPECT_EQ(one["validate"], two["validate"]);
}

}  // namespace
}  // namespace kerf::map_run_test
