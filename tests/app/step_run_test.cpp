// A history of loads from case file to files.

#include "app/run.hpp"
#include "tests/support/sample.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace kerf::step_run_test {
namespace {

/// Two halves of a square under the pressure 0.1, sheared back and forth: a spring of stiffness 0.5 and a block.
const char* const block = R"(
[domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "side", "top", "side"]
[[crack]]
name = "joint"
path = [[0, 0.5], [1, 0.5]]
friction = 0.3
[material]
young = 1.0
poisson = 0
[define]
shift = 0
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "side"
displacement_y = "-0.1 * y"
[[boundary]]
on = "top"
displacement = ["shift", "-0.1 * y"]
[mesh]
size = 0.3
[[step]]
name = "forth"
define = { shift = 0.1 }
substeps = 5
[[step]]
name = "back"
define = { shift = 0 }
[output]
vtk = false
png = false
html = false
)";

Case written(const test::Folder& folder, const std::string& more = {}) {
  std::ofstream(folder.path / "a.toml") << block + more;
  return read_case(folder.path / "a.toml");
}

TEST(StepRun, FilesTellTheHistory) {
  const test::Folder folder;
  run(written(folder), Job::Solve, {.folder = folder.path / "out", .threads = 1});
  const auto r = nlohmann::json::parse(std::ifstream(folder.path / "out/result.json"));
  EXPECT_EQ(r["status"], "ok") << r;
  ASSERT_EQ(r["steps"].size(), 6U);
  const auto& forth = r["steps"][4];
  EXPECT_EQ(forth["name"], "forth");
  EXPECT_EQ(forth["part"], 5);
  EXPECT_NEAR(forth["define"]["shift"].get<double>(), 0.1, 1e-15);
  EXPECT_NEAR(forth["slip_length"].get<double>(), 1, 1e-12);
  // It slides from 0.06 on, at the shear 0.03.
  EXPECT_NEAR(forth["dissipation"].get<double>(), 0.03 * 0.04, 1e-14);
  EXPECT_NEAR(forth["imbalance"].get<double>(), 0, 1e-14);
  const auto& back = r["steps"][5];
  EXPECT_NEAR(back["stick_length"].get<double>(), 1, 1e-12);
  EXPECT_NEAR(back["dissipation"].get<double>(), 0.03 * 0.04, 1e-14);
  // What stays locked in: the shear 0.5 (0 - 0.04), beside the pressure.
  const double locked = 0.02 * 0.02 / (2 * 0.5), pressed = 0.1 * 0.1 / 2;
  EXPECT_NEAR(back["strain_energy"].get<double>(), locked + pressed, 1e-13);
  std::ifstream rows(folder.path / "out/steps.csv");
  std::string line;
  std::getline(rows, line);
  EXPECT_TRUE(line.starts_with("step,shift,energy,strain_energy,work,dissipation,imbalance,open_length")) << line;
  int count = 0;
  while (std::getline(rows, line)) ++count;
  EXPECT_EQ(count, 6);
}

TEST(StepRun, RefusesWhatIsNotKnownOfAHistory) {
  const auto said = [](const std::string& more, Job job) -> std::string {
    const test::Folder folder;
    try {
      run(written(folder, more), job, {.folder = folder.path / "out", .threads = 1});
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Usage);
      return e.what();
    }
    return "no refusal";
  };
  EXPECT_NE(said("[map]\n", Job::Run).find("[[step]] goes with kerf solve: a map ([map]) is not known for a history"),
            std::string::npos);
  EXPECT_NE(said("", Job::Map).find("[[step]] goes with kerf solve"), std::string::npos);
  EXPECT_NE(said("[validate]\npoints = [[0.5, 0.2]]\nradii = [0.05]\n", Job::Validate).find("a validation"),
            std::string::npos);
  EXPECT_NE(said("[solver]\nbackend = \"umfpack\"\n", Job::Solve).find("umfpack"), std::string::npos);
  EXPECT_NE(said("[solver]\nelement = \"p2\"\n", Job::Solve).find("element = \"p2\""), std::string::npos);
}

}  // namespace
}  // namespace kerf::step_run_test
