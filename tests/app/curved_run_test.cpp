// Curved edges, from the case file to what kerf writes.

#include "app/run.hpp"
#include "tests/io/case/case_files.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <sstream>

namespace kerf::curved_run_test {
namespace {

// A ring of radii 1 and 2 under the pressure 1 inside, plane strain.
const std::string ring = R"([domain]
outline = [{ arc_to = [-2, 0], center = [0, 0] }, { arc_to = [2, 0], center = [0, 0] }]
sides = ["outer", "outer"]
[[hole]]
name = "h"
circle = { center = [0, 0], radius = 1 }
[material]
young = 1.0
poisson = 0.3
[[boundary]]
on = "hole:h"
pressure = 1
[mesh]
size = 0.4
curved = true
[solver]
degree = 3
[[probe]]
name = "at"
points = [[1, 0], [0, -1], [1.5, 0], [0, 2]]
[output]
vtk = false
png = false
html = false
)";

nlohmann::json result_of(const TemporaryFolder& folder, const std::string& text, Job job = Job::Solve,
                         const std::vector<std::string>& set = {}) {
  const Case c = read_case(folder.write("a.toml", text), set);
  run(c, job, {.folder = folder.path / "out", .threads = 1});
  return nlohmann::json::parse(std::ifstream(folder.path / "out" / "result.json"));
}

/// Columns s_xx, s_yy of a probe.
std::vector<std::array<double, 2>> stresses(const TemporaryFolder& folder) {
  std::ifstream file(folder.path / "out" / "probe_at.csv");
  std::string line, cell;
  std::getline(file, line);
  std::vector<std::string> heads;
  for (std::istringstream row(line); std::getline(row, cell, ',');) heads.push_back(cell);
  const auto xx = std::ranges::find(heads, "s_xx") - heads.begin(),
             yy = std::ranges::find(heads, "s_yy") - heads.begin();
  std::vector<std::array<double, 2>> all;
  while (std::getline(file, line)) {
    std::vector<std::string> cells;
    for (std::istringstream row(line); std::getline(row, cell, ',');) cells.push_back(cell);
    all.push_back(
        {std::stod(cells.at(static_cast<std::size_t>(xx))), std::stod(cells.at(static_cast<std::size_t>(yy)))});
  }
  return all;
}

// Lame: s_r = A - B/r^2, s_t = A + B/r^2, A = 1/3, B = 4/3, also at points on the rims.
TEST(CurvedRun, StressAtTheRimIsThatOfTheCircle) {
  const TemporaryFolder folder;
  const nlohmann::json result = result_of(folder, ring);
  EXPECT_EQ(result["status"], "ok");
  const auto at = stresses(folder);
  constexpr double A = 1.0 / 3, B = 4.0 / 3, close = 2e-3;
  EXPECT_NEAR(at[0][0], -1, close);
  EXPECT_NEAR(at[0][1], A + B, close);
  EXPECT_NEAR(at[1][0], A + B, close);
  EXPECT_NEAR(at[1][1], -1, close);
  EXPECT_NEAR(at[2][0], A - B / 2.25, close);
  EXPECT_NEAR(at[3][1], 0, close);
  // E = -pi u_r(1), u_r(1) = 1.3 (0.4 A + B); the interval is that of the ring, not of a polygon
  const double energy = -pi * 1.3 * (0.4 * A + B);
  const nlohmann::json& state = result["state"];
  EXPECT_NEAR(state["energy"].get<double>(), energy, 1e-4);
  EXPECT_LE(state["energy_bounds"][0].get<double>(), energy);
  EXPECT_GE(state["energy_bounds"][1].get<double>(), energy);
  EXPECT_EQ(state["energy_bounds_of"], "body");
  EXPECT_LT(result["state"]["estimated_error"].get<double>(), 5e-3);
}

// T of a hole for the energy from the stress there; a map does not mind curved edges.
TEST(CurvedRun, MapsAgreeWithTheStress) {
  const TemporaryFolder folder;
  const nlohmann::json result = result_of(folder, ring + "[map]\npoints = [[1.5, 0]]\n", Job::Map);
  const double r = 1.0 / 3 - 4.0 / 3 / 2.25, t = 1.0 / 3 + 4.0 / 3 / 2.25, trace = r + t;
  const double mu = 1 / 2.6, kappa = 3 - 4 * 0.3, deviator = (t - r) * (t - r);
  const double expected = -(kappa + 1) / (16 * mu) * (trace * trace + 2 * deviator);
  EXPECT_NEAR(result["map"]["points"][0]["value"].get<double>(), expected, 2e-3 * std::abs(expected));
}

// A quarter of a disc under its own weight, pulled at the rim: loads and reactions are those of the curved body.
TEST(CurvedRun, LoadsAndReactionsAreInEquilibrium) {
  const TemporaryFolder folder;
  const std::string quarter = R"([domain]
outline = [[0, 0], [2, 0], { arc_to = [0, 2], center = [0, 0] }]
sides = ["bottom", "rim", "left"]
[material]
young = 1.0
poisson = 0.3
[body]
force = [0, -1]
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "rim"
traction = ["0.1*nx", "0.2*ny"]
[mesh]
size = 0.5
curved = true
[solver]
degree = 2
[output]
vtk = false
png = false
html = false
)";
  const nlohmann::json all = result_of(folder, quarter)["state"]["resultants"];
  constexpr double close = 2e-6, rounding = 1e-10;  // the area of arcs of degree 3
  EXPECT_NEAR(all["body"]["force"][1].get<double>(), -pi, close);
  EXPECT_NEAR(all["body"]["moment"].get<double>(), -8.0 / 3, 2 * close);
  EXPECT_NEAR(all["balance"]["force"][0].get<double>(), 0, rounding);
  EXPECT_NEAR(all["balance"]["force"][1].get<double>(), 0, rounding);
  EXPECT_NEAR(all["balance"]["moment"].get<double>(), 0, close);
  const std::string said = check(read_case(folder.write("b.toml", quarter)), {});
  EXPECT_NE(said.find("area 3.14159"), std::string::npos) << said;
  EXPECT_NE(said.find("force (0, -3.14159)"), std::string::npos) << said;
}

std::string refusal_of(const std::string& text, Job job = Job::Solve, const std::vector<std::string>& set = {}) {
  const TemporaryFolder folder;
  try {
    result_of(folder, text, job, set);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(CurvedRun, WhatCannotBeCurvedIsNamed) {
  const std::string comm = refusal_of(ring, Job::Solve, {"solver.element=\"peers\"", "solver.degree=1"});
  EXPECT_NE(comm.find("curved"), std::string::npos) << comm;
  EXPECT_NE(comm.find("bdms"), std::string::npos) << comm;
  const std::string saddle = refusal_of(ring, Job::Solve, {"solver.backend=\"umfpack\""});
  EXPECT_NE(saddle.find("curved"), std::string::npos) << saddle;
}

}  // namespace
}  // namespace kerf::curved_run_test
