// Largest values: facts of the body, or of the mesh.

#include "tests/truth/scene.hpp"

#include <cmath>
#include <sstream>

namespace kerf::peaks_test {
namespace {

using nlohmann::json;

// Kirsch's plate: |stress| = 3 p at the top of the hole, where the stress is uniaxial.
TEST_F(Truth, ThePeakAtAHoleIsNotSingular) {
  const json r = run_scene(R"(
[domain]
outline = [[-4, -4], [4, -4], [4, 4], [-4, 4]]
sides = ["bottom", "right", "top", "left"]
[[hole]]
name = "h"
circle = { center = [0, 0], radius = 0.2 }
[material]
young = 1000
poisson = 0.3
state = "plane stress"
[[boundary]]
on = "right"
traction = [1, 0]
[[boundary]]
on = "left"
traction = [-1, 0]
[mesh]
size = 0.3
)");
  const json& peak = r["state"]["max_von_mises"];
  EXPECT_NEAR(peak["value"], 3, 0.1);
  EXPECT_NEAR(peak["at"][0], 0, 0.05);
  EXPECT_NEAR(std::abs(peak["at"][1].get<double>()), 0.2, 0.01);
  EXPECT_FALSE(peak["singular"].get<bool>());
  EXPECT_FALSE(peak.contains("regular"));
}

const char* const kinked = R"(
[domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[-0.5, 0.1], [0, -0.1], [0.5, 0.1]]
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "top"
traction = [0, -1]
[[boundary]]
on = "bottom"
displacement = [0, 0]
)";

// At tips every finer mesh shows more, at a kink another value: only the largest regular value is a fact.
TEST_F(Truth, PeaksAtTipsAndKinksAreSingularAndTheRegularOnesSettle) {
  std::vector<double> peak, pressure, stress;
  for (const char* tip : {"0.004", "0.0005"}) {
    const std::vector<std::string> sizes = {"mesh.size=0.06", std::string("mesh.crack_tip_size=") + tip};
    const json pressed = run_scene(kinked, Job::Solve, sizes)["cracks"][0]["pressure_peak"];
    EXPECT_TRUE(pressed["singular"].get<bool>());
    pressure.push_back(pressed["regular"]["value"]);
    const json pulled =
        run_scene(kinked, Job::Solve, {sizes[0], sizes[1], "boundary[0].traction=[0, 1]"})["state"]["max_von_mises"];
    EXPECT_TRUE(pulled["singular"].get<bool>());
    peak.push_back(pulled["value"]);
    stress.push_back(pulled["regular"]["value"]);
  }
  EXPECT_GT(peak[1], 1.5 * peak[0]);
  EXPECT_NEAR(pressure[1], pressure[0], 0.05 * pressure[0]);
  EXPECT_NEAR(stress[1], stress[0], 0.05 * stress[0]);
}

// Steel with Young's modulus in GPa and loads in MPa.
TEST_F(Truth, StrainsThatAreNotSmallAreSaid) {
  const std::string bar = R"(
[domain]
outline = [[0, 0], [100, 0], [100, 10], [0, 10]]
sides = ["bottom", "right", "top", "left"]
[material]
poisson = 0.3
young = 210
[[boundary]]
on = "left"
displacement_x = 0
[[boundary]]
on = "bottom"
displacement_y = 0
[[boundary]]
on = "right"
traction = [50, 0]
[mesh]
size = 5
)";
  const auto notes = [&](const std::vector<std::string>& overrides) {
    const json r = run_scene(bar, Job::Solve, overrides);
    return r["state"].contains("notes") ? r["state"]["notes"].dump() : std::string();
  };
  const std::string said = notes({});
  EXPECT_NE(said.find("strains reach 0.22"), std::string::npos) << said;  // 50/210 (1 - nu^2)
  EXPECT_NE(said.find("displacements reach 0.2"), std::string::npos) << said;
  EXPECT_EQ(notes({"material.young=210e3"}), "");
}

// Table, file and picture of a map speak of one maximum.
TEST_F(Truth, AMapHasOneMaximum) {
  const json r =
      run_scene(std::string(kinked) + "[mesh]\nsize = 0.1\n[functional]\nkind = \"energy\"\n[map]\n", Job::Map);
  std::ifstream file(folder / "out" / "map.csv");
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "x,y,topological_derivative,masked");
  double most = -1e300, all = -1e300;
  while (std::getline(file, line)) {
    std::istringstream row(line);
    double x, y, T, masked;
    char comma;
    row >> x >> comma >> y >> comma >> T >> comma >> masked;
    all = std::max(all, T);
    if (masked == 0) most = std::max(most, T);
  }
  EXPECT_EQ(r["map"]["max"]["value"].get<double>(), most);
  EXPECT_GT(all, 2 * most);  // at the kink and the tips
}

}  // namespace
}  // namespace kerf::peaks_test
