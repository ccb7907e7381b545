// `kerf bench hard`: a few values of every knob. A row that loses more digits than its family may, or that is refused
// where there was an answer, fails here.

#include "bench/hard.hpp"
#include "bench/hard/family.hpp"
#include "kerf/types.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

namespace kerf::hard_test {
namespace {

namespace fs = std::filesystem;

class HardBenchTest : public test::InFolder {};

class HardFamilyTest : public HardBenchTest, public testing::WithParamInterface<std::string> {};

TEST_P(HardFamilyTest, LosesNoMoreDigitsThanItMay) {
  const HardBench bench = run_hard_bench({.folder = folder, .cases = {GetParam()}, .quick = true});
  ASSERT_FALSE(bench.rows.empty());
  for (const HardRow& row : bench.rows)
    EXPECT_FALSE(is_failure(row.verdict))
        << row.family << " " << row.label << ": " << name_of(row.verdict) << ", error " << row.error << ", allowed "
        << row.allowed << ", exit " << row.exit << " " << row.said;
}

INSTANTIATE_TEST_SUITE_P(Quick, HardFamilyTest, testing::ValuesIn(hard_case_names()), [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_F(HardBenchTest, WritesItsFiles) {
  const HardBench bench = run_hard_bench({.folder = folder, .cases = {"poisson", "shift"}, .quick = true});
  EXPECT_EQ(failures(bench), 0u);
  const auto json = nlohmann::json::parse(text("hard.json"));
  EXPECT_EQ(json["status"], "ok");
  ASSERT_EQ(json["rows"].size(), bench.rows.size());
  for (const auto& row : json["rows"]) {
    EXPECT_LE(row["error"].get<double>(), row["allowed"].get<double>());
    EXPECT_GT(row["seconds"].get<double>(), 0);
    EXPECT_EQ(row["exit"], 0);
  }
  EXPECT_NE(text("hard.md").find("## `poisson`"), std::string::npos);
  EXPECT_NE(text("hard.csv").find("shift,1e+05"), std::string::npos);
  EXPECT_GT(fs::file_size(folder / "hard.png"), 1000u);
  // Each row can be run again by itself.
  EXPECT_TRUE(fs::exists(folder / "cases" / "poisson_0.5.toml"));
  EXPECT_NE(summary(bench).find("held"), std::string::npos);
}

TEST_F(HardBenchTest, WritesWhatThereIsWhenStopped) {
  int polls = 0;
  const HardBench bench = run_hard_bench(
      {.folder = folder, .cases = {"poisson"}, .quick = true, .stop_asked = [&] { return ++polls > 2; }});
  EXPECT_TRUE(bench.stopped);
  EXPECT_LT(bench.rows.size(), 4u);
  EXPECT_EQ(nlohmann::json::parse(text("hard.json"))["status"], "stopped");
}

// A limit below the error of the mesh, and a refusal where an answer is on record, must be seen.
TEST_F(HardBenchTest, SeesRegressions) {
  HardFamily family;
  for (const HardFamily& f : hard_families())
    if (f.name == "rotation") family = f;
  family.quick = {30};
  family.floor = 1e-12;
  family.digits = [](double) { return -2.0; };
  HardBench bench;
  run_hard_family(family, {.folder = folder, .quick = true}, bench);
  ASSERT_EQ(bench.rows.size(), 1u);
  EXPECT_TRUE(is_failure(bench.rows[0].verdict));

  for (const HardFamily& f : hard_families())
    if (f.name == "shift") family = f;
  family.quick = {1e6};
  family.record = {};
  bench.rows.clear();
  run_hard_family(family, {.folder = folder, .quick = true}, bench);
  EXPECT_EQ(bench.rows[0].exit, 3);
  EXPECT_EQ(bench.rows[0].verdict, HardVerdict::Regressed);
}

TEST(HardFamilies, SayWhatTheyAre) {
  std::set<std::string> names;
  for (const HardFamily& f : hard_families()) {
    EXPECT_TRUE(names.insert(f.name).second) << f.name;
    EXPECT_FALSE(f.truth.empty() || f.limit.empty() || f.knob.empty() || f.title.empty()) << f.name;
    EXPECT_EQ(static_cast<bool>(f.record), !f.why.empty()) << f.name;
    for (const double value : f.quick)
      EXPECT_NE(std::find(f.values.begin(), f.values.end(), value), f.values.end()) << f.name << " " << value;
  }
}

}  // namespace
}  // namespace kerf::hard_test
