// Gaps and pieces from case file to files.

#include "app/run.hpp"
#include "tests/support/sample.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace kerf::crack_gap_run_test {
namespace {

/// A block that lies on another one with rounded feet.
const char* const blocks = R"(
[domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["bottom", "side", "top", "side"]
[[crack]]
name = "joint"
path = [[-1, 0], [1, 0]]
gap = "0.02 * x^2"
[material]
young = 1.0
poisson = 0.3
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "top"
traction = [0, PULL]
[mesh]
size = 0.2
)";

std::string pressed(const std::string& traction) {
  std::string text = blocks;
  return text.replace(text.find("PULL"), 4, traction);
}

TEST(CrackGapRun, FilesTellGapFromJump) {
  const test::Folder folder;
  std::ofstream(folder.path / "a.toml") << pressed("-0.005");
  const Case c = read_case(folder.path / "a.toml");
  EXPECT_NE(check(c, folder.path / "check").find("crack     joint: unilateral, gap "), std::string::npos);
  run(c, Job::Solve, {.folder = folder.path / "out", .threads = 1});
  const auto r = nlohmann::json::parse(std::ifstream(folder.path / "out/result.json"));
  EXPECT_EQ(r["status"], "ok");
  EXPECT_NE(r["state"]["notes"].dump().find("1 piece of the body is held by contact alone"), std::string::npos);
  EXPECT_TRUE(r["state"]["energy_bounds"].is_null());
  EXPECT_NE(r["state"]["notes"].dump().find("no bounds of the energy"), std::string::npos) << r["state"]["notes"];
  std::ifstream rows(folder.path / "out/crack_joint.csv");
  std::string line;
  std::getline(rows, line);
  EXPECT_EQ(line, "s,x,y,jump_n,jump_t,sigma_n,sigma_t,status,gap");
  double force = 0, widest = 0;
  unsigned open = 0, closed = 0;
  while (std::getline(rows, line)) {
    double s, x, y, jump_n, jump_t, sigma_n, sigma_t, gap;
    char status[8];
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%7[a-z],%lf", &s, &x, &y, &jump_n, &jump_t,
                          &sigma_n, &sigma_t, status, &gap),
              9);
    EXPECT_NEAR(gap, 0.02 * x * x, 1e-14);
    EXPECT_GE(jump_n + gap, -1e-10);
    widest = std::max(widest, jump_n + gap);
    const bool touches = std::string(status) == "closed";
    EXPECT_TRUE(!touches || std::abs(jump_n + gap) < 1e-10) << line;
    ++(touches ? closed : open);
    force -= sigma_n;
  }
  EXPECT_GT(open, 2u);
  EXPECT_GT(closed, 2u);
  EXPECT_GT(force, 0);
  EXPECT_NEAR(r["cracks"][0]["max_opening"].get<double>(), widest, 1e-12);
}

TEST(CrackGapRun, SaysWhatNothingHolds) {
  const test::Folder folder;
  std::ofstream(folder.path / "a.toml") << pressed("0.005");
  try {
    run(read_case(folder.path / "a.toml"), Job::Solve, {.folder = folder.path / "out", .threads = 1});
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("contact does not hold the body: the piece around"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("is free to make a translation along (0, 1)"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace kerf::crack_gap_run_test
