// Misfits with readings from a file: that of the truth is what is straight between the readings, however they are
// sorted; one that grows as the mesh gets finer is told.

#include "app/run.hpp"
#include "tests/support/folder.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace kerf::measured_run_test {

namespace {

// Pure bending, sigma_xx = y, in plane stress of young 1: u = (x y, -(x^2 + 0.3 y^2) / 2).
const std::string bent = R"([domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["rim", "rim", "rim", "left"]
[material]
young = 1
poisson = 0.3
state = "plane stress"
[[boundary]]
on = "left"
displacement = ["x*y", "-(x^2 + 0.3*y^2)/2"]
[[boundary]]
on = "rim"
traction = ["y*nx", 0]
[functional]
kind = "misfit"
on = "rim"
measured = "readings.csv"
[output]
vtk = false
png = false
html = false
)";

struct Reading {
  double x, y, jump = 0;
  std::string row() const {
    return fmt::format("{},{},{},{}\n", x, y, x * y + jump, -(x * x + 0.3 * y * y) / 2);
  }
};

/// Around the rim, in the middle of steps of 0.05.
std::vector<Reading> around() {
  std::vector<Reading> all;
  for (int i = 0; i < 40; ++i) all.push_back({-0.975 + 0.05 * i, -1});
  for (int i = 0; i < 40; ++i) all.push_back({1, -0.975 + 0.05 * i});
  for (int i = 39; i >= 0; --i) all.push_back({-0.975 + 0.05 * i, 1});
  return all;
}

class MeasuredRun : public kerf::test::InFolder {
 protected:
  Result solved(const std::vector<Reading>& readings, const std::string& size) const {
    std::ofstream file(folder / "readings.csv");
    file << "x,y,u_x,u_y\n";
    for (const Reading& r : readings) file << r.row();
    file.close();
    std::ofstream(folder / "bent.toml") << bent;
    const std::vector<std::string> overrides{"mesh.size=" + size};
    return run(read_case(folder / "bent.toml", overrides), Job::Solve, {.folder = folder / "out"});
  }
  static bool says(const Result& r, const std::string& what) {
    return std::ranges::any_of(r.state->notes,
                               [&](const std::string& note) { return note.find(what) != std::string::npos; });
  }
};

TEST_F(MeasuredRun, TheTruthHasTheMisfitOfWhatIsStraightBetweenReadings) {
  std::vector<Reading> readings = around();
  std::vector<double> values;
  std::mt19937 generator(1);
  for (int order = 0; order < 3; ++order) {
    if (order == 1)
      std::ranges::sort(readings,
                        [](const Reading& a, const Reading& b) { return std::pair(a.x, a.y) < std::pair(b.x, b.y); });
    if (order == 2) std::shuffle(readings.begin(), readings.end(), generator);
    for (const char* size : {"0.25", "0.1"}) {
      const Result r = solved(readings, size);
      values.push_back(r.functional->value);
      EXPECT_GT(values.back(), 0);
      EXPECT_LT(values.back(), 2e-6) << order << ' ' << size;
      EXPECT_TRUE(says(r, "2.5 % of \"rim\" lies beyond the outer readings"));
      EXPECT_FALSE(says(r, "the misfit grows")) << summary(r);
    }
    EXPECT_EQ(values[values.size() - 2], values[0]) << "the same bits in every order";
    EXPECT_EQ(values.back(), values[1]);
  }
}

TEST_F(MeasuredRun, AMisfitThatGrowsOnFinerMeshesIsTold) {
  std::vector<Reading> readings = around();
  for (Reading& r : readings)
    if (r.y == 1 && std::lround(20 * (r.x + 0.975)) % 2 == 0) r.jump = 0.02;  // they scatter
  EXPECT_TRUE(says(solved(readings, "0.1"), "the misfit grows as the mesh gets finer"));
}

}  // namespace

}  // namespace kerf::measured_run_test
