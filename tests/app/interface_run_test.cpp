// Interfaces from case file to files.

#include "app/run.hpp"
#include "tests/support/sample.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace kerf::interface_run_test {
namespace {

using nlohmann::json;

json solved(const test::Folder& folder, const std::string& text, Job job = Job::Solve) {
  std::ofstream(folder.path / "a.toml") << text;
  run(read_case(folder.path / "a.toml"), job, {.folder = folder.path / "out", .threads = 1});
  return json::parse(std::ifstream(folder.path / "out/result.json"));
}

/// A disc pressed into a disc that is held outside: the pressure is 1/86 with u(2) = 0 by Lame.
const char* const fitted = R"(
[domain]
outline = [{ arc_to = [2, 0], center = [0, 0] }, { arc_to = [-2, 0], center = [0, 0] }]
sides = ["rim", "rim"]
[[region]]
name = "disc"
circle = { center = [0, 0], radius = 1 }
young = 2
poisson = 0.3
[[interface]]
name = "fit"
between = ["body", "disc"]
gap = -0.01
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "rim"
displacement = [0, 0]
[mesh]
size = 0.3
)";

TEST(InterfaceRun, WritesAClosedCurve) {
  const test::Folder folder;
  std::ofstream(folder.path / "b.toml") << fitted;
  const std::string checked = check(read_case(folder.path / "b.toml"), folder.path / "check");
  EXPECT_NE(checked.find("interface fit: unilateral, gap -0.01, length 6.28319"), std::string::npos) << checked;
  EXPECT_NE(checked.find(", closed\n"), std::string::npos) << checked;
  const json r = solved(folder, fitted + std::string("curved = true\n"));
  EXPECT_EQ(r["status"], "ok");
  ASSERT_EQ(r["cracks"].size(), 1u);
  const json& fit = r["cracks"][0];
  EXPECT_EQ(fit["name"], "fit");
  EXPECT_TRUE(fit["tips"].empty());
  EXPECT_TRUE(fit["transitions"].empty());
  EXPECT_NEAR(fit["length"].get<double>(), 2 * pi, 1e-4);
  EXPECT_NEAR(fit["max_pressure"].get<double>(), 1 / 86.0, 0.02 / 86);
  std::ifstream rows(folder.path / "out/crack_fit.csv");
  std::string line;
  std::getline(rows, line);
  double turned = 0, before = nan;
  while (std::getline(rows, line)) {
    double s, x, y;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &s, &x, &y), 3);
    const double t = std::atan2(y, x);
    if (std::isfinite(before)) turned += std::remainder(t - before, 2 * pi);
    before = t;
  }
  EXPECT_NEAR(std::abs(turned), 2 * pi, 0.3);
}

TEST(InterfaceRun, HasMapsAndValidationsThatHold) {
  const test::Folder folder;
  const json r = solved(folder, std::string(fitted) + R"([map]
[validate]
points = [[1.5, 0]]
radii = { largest = 0.08, ratio = 0.5, count = 3 }
[output]
vtk = false
png = false
html = false
)",
                        Job::Validate);
  EXPECT_EQ(r["validate"][0]["verdict"], "holds") << r["validate"][0].dump(1);
}

// NAFEMS CGS-4 with the block as a region: (0.3 + 0.1)/(1 - 0.03) by statics.
TEST(InterfaceRun, PushesABlockUphill) {
  const test::Folder folder;
  const json r = solved(folder, R"([domain]
outline = [[0, -1], [8, -1], [8, 0.8], [6, 0.6], [6, 2.6], [2, 2.6], [2, 0.2], [0, 0]]
sides   = ["bottom", "right", "slope", "front", "top", "pushed", "slope", "left"]
[[region]]
name    = "block"
polygon = [[2, 0.2], [6, 0.6], [6, 2.6], [2, 2.6]]
young   = 500
poisson = 0.2
[[interface]]
name     = "joint"
between  = ["block", "body"]
friction = 0.3
[material]
young   = 1000
poisson = 0.3
[[boundary]]
on           = "bottom"
displacement = [0, 0]
[[boundary]]
on             = "pushed"
displacement_x = 0.1
[body]
force = [0, -1]
[mesh]
size = 0.8
)");
  EXPECT_NEAR(r["state"]["resultants"]["reactions"][1]["force"][0].get<double>() / 8.8, 0.4 / 0.97, 1e-6);
}

// Bonded layers between smooth walls: every layer is pressed as it were alone, and the energy is known.
TEST(InterfaceRun, ReportsWhatActsAcrossABondedOne) {
  const test::Folder folder;
  const json r = solved(folder, R"([domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "wall", "top", "wall"]
[[region]]
name = "upper"
polygon = [[0, 0.4], [2, 0.4], [2, 1], [0, 1]]
young = 4
poisson = 0.3
[[interface]]
name = "joint"
between = ["upper", "body"]
contact = false
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "bottom"
displacement_y = 0
[[boundary]]
on = "wall"
displacement_x = 0
[[boundary]]
on = "top"
traction = [0, -0.1]
[mesh]
size = 0.2
[output]
vtk = false
png = false
html = false
)");
  const double modulus = 0.7 / (1.3 * 0.4), exact = -0.5 * 0.01 * (0.8 / modulus + 1.2 / (4 * modulus));
  EXPECT_NEAR(r["state"]["energy"].get<double>(), exact, 1e-13);
  EXPECT_LE(r["state"]["energy_bounds"][0].get<double>(), exact);
  EXPECT_GE(r["state"]["energy_bounds"][1].get<double>(), exact);
  EXPECT_NEAR(r["cracks"][0]["max_pressure"].get<double>(), 0.1, 1e-12);
  EXPECT_EQ(r["cracks"][0]["max_opening"].get<double>(), 0);
  EXPECT_TRUE(r["cracks"][0]["tips"].empty());
}

TEST(InterfaceRun, IsRefusedByOptimizations) {
  const test::Folder folder;
  try {
    solved(folder,
           std::string(fitted) +
               "[functional]\nkind = \"compliance\"\n[optimize]\nmethod = \"level-set\"\nvolume = { at_most = 0.5 }\n",
           Job::Optimize);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("[optimize] moves nothing next to interface \"fit\""), std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace kerf::interface_run_test
