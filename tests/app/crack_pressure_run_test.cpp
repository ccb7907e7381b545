// A pressure in a crack, from the case file to what kerf says and writes.

#include "app/run.hpp"
#include "tests/io/case/case_files.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <sstream>

namespace kerf::crack_pressure_run_test {
namespace {

const std::string pressed = square + R"([units]
length = "mm"
stress = "MPa"
[[crack]]
name = "c"
path = [[0.5, 0.5], [1.5, 0.5]]
pressure = "0.01 * x"
[[boundary]]
on = "bottom"
displacement = [0, 0]
[mesh]
size = 0.25
crack_tip_size = 0.05
)";

std::string content(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

TEST(CrackPressureRun, CheckSaysAndDrawsIt) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write("a.toml", pressed);
  const std::string said = check(read_case(path), folder.path / "out");
  EXPECT_NE(said.find("crack     c: unilateral, pressure 0.00"), std::string::npos) << said;
  EXPECT_NE(said.find(" to 0.01"), std::string::npos) << said;
  EXPECT_NE(said.find(" MPa, length 1"), std::string::npos) << said;
  EXPECT_EQ(said.find("nothing acts"), std::string::npos) << said;
  EXPECT_TRUE(std::filesystem::exists(folder.path / "out" / "check.png"));
}

TEST(CrackPressureRun, ResultsTellFluidFromContact) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", pressed), std::vector<std::string>{"output.vtk=false"});
  const std::filesystem::path out = folder.path / "out";
  run(c, Job::Solve, {.folder = out, .threads = 1});
  const nlohmann::json r = nlohmann::json::parse(content(out / "result.json")), &crack = r["cracks"][0];
  EXPECT_NEAR(crack["fluid_pressure"].get<double>(), 0.015, 5e-4);
  EXPECT_EQ(crack["max_pressure"], 0);  // open all along
  EXPECT_GT(crack["max_opening"].get<double>(), 0);
  // Clapeyron; the opening times the pressure.
  const double work = r["state"]["compliance"];
  EXPECT_NEAR(work, -2 * r["state"]["energy"].get<double>(), 1e-9 * work);
  std::stringstream rows(content(out / "crack_c.csv"));
  std::string line;
  std::getline(rows, line);
  EXPECT_EQ(line, "s,x,y,jump_n,jump_t,sigma_n,sigma_t,status,fluid_pressure");
  while (std::getline(rows, line)) {
    std::vector<std::string> cells;
    std::stringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), 9u);
    EXPECT_EQ(cells[7], "open");
    EXPECT_NEAR(std::stod(cells[8]), 0.01 * std::stod(cells[1]), 1e-15);
    EXPECT_NEAR(std::stod(cells[5]), -std::stod(cells[8]), 1e-15);
  }
  EXPECT_NE(content(out / "report.html").find("fluid pressure"), std::string::npos);
}

TEST(CrackPressureRun, WhatNoRuleResolvesIsNamed) {
  const TemporaryFolder folder;
  const Case c =
      read_case(folder.write("a.toml", pressed), std::vector<std::string>{"crack[0].pressure=\"0.001/abs(x-1.03)\""});
  const std::string said = check(c);
  EXPECT_NE(said.find("note: the pressure in crack \"c\" is not resolved near (1.03, 0.5)"), std::string::npos) << said;
}

TEST(CrackPressureRun, LevelSetsRefuseIt) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", pressed + R"([functional]
kind = "compliance"
[optimize]
volume = { at_most = 0.5 }
)"));
  try {
    check(c);
    ADD_FAILURE() << "not refused";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("crack \"c\" carries a pressure: a level set would cut it away"),
              std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace kerf::crack_pressure_run_test
