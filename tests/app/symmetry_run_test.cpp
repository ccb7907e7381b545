// Half models and forces at points, from the case file to what kerf says and writes: against the whole body with a
// crack, and against the body with edges of half the width.

#include "app/run.hpp"
#include "tests/io/case/case_files.hpp"

#include <nlohmann/json.hpp>

#include <sstream>

namespace kerf::symmetry_run_test {
namespace {

const std::string same = R"([material]
young = 200
poisson = 0.3
state = "plane stress"
[mesh]
size = 0.25
crack_tip_size = 0.005
[output]
vtk = false
png = false
html = false
)";
// Three-point bending, a = 0.4, S = 4.
const std::string half = same + R"([domain]
outline = [[0, 0], [2.2, 0], [2.2, 1], [0, 1], [0, 0.4]]
sides = ["bottom", "end", "top", "ligament", "face"]
[[boundary]]
on = "ligament"
symmetry = true
[[load]]
at = [0, 1]
force = [0, -1]
width = 0.04
[[boundary]]
at = [2, 0]
displacement_y = 0
width = 0.04
)";
const std::string whole = same + R"([domain]
outline = [[-2.2, 0], [2.2, 0], [2.2, 1], [-2.2, 1]]
sides = ["bottom", "end", "top", "end"]
[[crack]]
name = "c"
path = [[0, 0], [0, 0.4]]
contact = "open"
[[load]]
at = [0, 1]
force = [0, -2]
width = 0.04
[[boundary]]
at = [2, 0]
displacement_y = 0
width = 0.04
[[boundary]]
at = [-2, 0]
displacement_y = 0
width = 0.04
)";

using Json = nlohmann::json;

Json solved(const std::string& text, const std::vector<std::string>& overrides = {}, Job job = Job::Solve) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", text), overrides);
  run(c, job, {.folder = folder.path / "out", .threads = 1});
  std::ostringstream out;
  out << std::ifstream(folder.path / "out" / "result.json").rdbuf();
  return Json::parse(out.str());
}

bool has_note(const Json& r, const std::string& part) {
  for (const Json& note : r["state"]["notes"])
    if (note.get<std::string>().find(part) != std::string::npos) return true;
  return false;
}

// f of ASTM E399 for a/W = 0.4, K = P S/(B W^1.5) f with P = 2, S = 4; error 0.5 %, and 0.6 % to other sources.
TEST(SymmetryRun, HalfABarHasTheCrackOfTheWhole) {
  const Json r = solved(half), twin = solved(whole);
  ASSERT_EQ(r["cracks"].size(), 1u);
  const Json &crack = r["cracks"][0], &tip = crack["tips"][0], &of_twin = twin["cracks"][0]["tips"][0];
  EXPECT_EQ(crack["name"], "face");
  EXPECT_EQ(crack["half"], true);
  EXPECT_EQ(tip["K_II"], 0);
  const double K = tip["K_I"], K_twin = of_twin["K_I"];
  EXPECT_NEAR(K, K_twin, 2e-3 * K_twin);
  constexpr double of_width = 1 - 0.04 / 8;  // the moment of a load spread over w is P/4 (S - w/2)
  EXPECT_NEAR(K, of_width * 8 * 1.98182, 0.012 * K);
  EXPECT_NEAR(tip["T"].get<double>(), of_twin["T"], 0.02 * K);
  EXPECT_NEAR(tip["G"].get<double>(), of_twin["G"], 4e-3 * of_twin["G"].get<double>());
  EXPECT_NEAR(crack["max_opening"].get<double>(), twin["cracks"][0]["max_opening"],
              0.03 * crack["max_opening"].get<double>());
  EXPECT_NEAR(2 * r["state"]["compliance"].get<double>(), twin["state"]["compliance"],
              2e-3 * twin["state"]["compliance"].get<double>());
  ASSERT_TRUE(tip.contains("margin"));
  EXPECT_LT(tip["margin"]["K_I"].get<double>(), 0.02 * K);
}

TEST(SymmetryRun, SaysWhatTheWidthOfAPointChanges) {
  // Narrow ones: what a wide load takes from the bending moment is no part of it.
  const Json wide = solved(half, {"load[0].width=0.008", "boundary[1].width=0.008"}),
             narrow = solved(half, {"load[0].width=0.004", "boundary[1].width=0.004"});
  const Json& patches = wide["state"]["resultants"]["patches"];
  ASSERT_EQ(patches.size(), 2u);
  EXPECT_EQ(patches[0]["on"], "load-1");
  EXPECT_NEAR(patches[0]["mean_stress"].get<double>(), 1 / 0.004, 1e-9);  // half of the edge is there
  EXPECT_NEAR(patches[1]["force"][1].get<double>(), 1, 1e-6);
  double predicted = 0;
  for (const Json& p : patches) predicted += p["displacement_change"].get<double>();  // both forces are 1
  const double change = narrow["state"]["compliance"].get<double>() - wide["state"]["compliance"].get<double>();
  EXPECT_NEAR(change, predicted, 0.1 * predicted);
  EXPECT_TRUE(has_note(wide, "\"load-1\" at (0, 1): the force (0, -1) acts on an edge 0.008 wide, of which a plane"));
  EXPECT_TRUE(has_note(wide, "half that width would move it locally by"));
}

TEST(SymmetryRun, SaysThatAFacePassesThroughThePlane) {
  const Json r = solved(half, {"load[0].force=[0, 1]"});
  EXPECT_LT(r["cracks"][0]["tips"][0]["K_I"].get<double>(), 0);
  EXPECT_TRUE(has_note(r, "\"face\", the face of a crack in a plane of symmetry, passes through that plane"));
}

// A hole in the half is two in the whole: the map is the same, and nothing is said close to the plane.
TEST(SymmetryRun, MapsAndValidationsAreThoseOfTheHalf) {
  const std::string jobs =
      "[functional]\nkind = \"compliance\"\n[map]\npoints = [[0.6, 0.5], [0.02, 0.7]]\nradius = 0.05\n"
      "[validate]\npoints = [[0.6, 0.5]]\nradii = [0.08, 0.04, 0.02, 0.01]\n";
  const Json r = solved(half + jobs, {}, Job::Run), twin = solved(whole + jobs, {}, Job::Map);
  const Json &points = r["map"]["points"], &of_twin = twin["map"]["points"];
  const double T = points[0]["value"], T_twin = of_twin[0]["value"];
  EXPECT_NEAR(T, T_twin, 0.01 * std::abs(T_twin));
  EXPECT_EQ(r["validate"][0]["verdict"], "holds");
  EXPECT_EQ(points[0]["masked"], false);
  EXPECT_EQ(points[1]["masked"], true);
}

TEST(SymmetryRun, CheckNamesPlaneAndTip) {
  const TemporaryFolder folder;
  const std::string said = check(read_case(folder.write("a.toml", half)));
  EXPECT_NE(said.find("tip       (0, 0.4), of a crack in a plane of symmetry"), std::string::npos) << said;
  EXPECT_NE(said.find("symmetry\n"), std::string::npos) << said;
  EXPECT_NE(said.find("load-1"), std::string::npos) << said;
}

}  // namespace
}  // namespace kerf::symmetry_run_test
