// `kerf bench limit`: that its numbers are what they say; not how fast anything is.

#include "bench/measure/limit.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace kerf::limit_test {
namespace {

class LimitBenchTest : public test::InFolder {};

TEST_F(LimitBenchTest, WritesItsFiles) {
  const LimitBench bench = run_limit_bench({.folder = folder, .quick = true}, false);
  ASSERT_EQ(bench.rows.size(), 4u);  // two meshes, one thread and two
  for (const LimitRow& row : bench.rows) {
    EXPECT_TRUE(row.certified);
    EXPECT_GT(row.factor_flops, 1e6);
    EXPECT_GT(row.dgemm_rate, 1e8);
    for (const LimitPhase& phase : row.phases) EXPECT_GE(phase.wall_s, 0) << phase.name;
  }
  EXPECT_EQ(bench.rows[0].triangles, bench.rows[1].triangles);
  EXPECT_EQ(bench.rows[0].factor_flops, bench.rows[1].factor_flops);
  EXPECT_GT(bench.rows[2].factor_flops, bench.rows[0].factor_flops);
  const auto json = nlohmann::json::parse(text("limit.json"));
  EXPECT_EQ(json["status"], "ok");
  ASSERT_EQ(json["rows"].size(), 4u);
  EXPECT_EQ(json["rows"][3]["threads"], 2);
  double sum = 0;
  for (const auto& phase : json["rows"][0]["phases"]) sum += phase["wall_s"].get<double>();
  EXPECT_NEAR(json["rows"][0]["wall_s"].get<double>(), sum, 1e-9);
  EXPECT_NE(text("limit.csv").find(",2,factor,"), std::string::npos);
  EXPECT_NE(summary(bench).find("growth: time ~ n^"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder / "limit.png"));
}

TEST(LimitBench, GrowthIsTheExponent) {
  LimitBench bench;
  for (const Index n : {1000, 4000, 16000})
    for (const int threads : {1, 2})
      bench.rows.push_back(
          {.triangles = n, .threads = threads, .phases = {{"a", 1e-6 * std::pow(n, threads == 1 ? 1.5 : 1.25), 0}}});
  EXPECT_NEAR(growth_exponent(bench, 1, &LimitRow::wall), 1.5, 1e-12);
  EXPECT_NEAR(growth_exponent(bench, 2, &LimitRow::wall), 1.25, 1e-12);
  EXPECT_TRUE(std::isnan(growth_exponent(bench, 3, &LimitRow::wall)));
}

TEST_F(LimitBenchTest, WritesWhatThereIsWhenStopped) {
  int polls = 0;
  const LimitBench bench =
      run_limit_bench({.folder = folder, .quick = true, .stop_asked = [&] { return polls++ > 0; }}, false);
  EXPECT_TRUE(bench.stopped);
  EXPECT_LE(bench.rows.size(), 1u);
  EXPECT_EQ(nlohmann::json::parse(text("limit.json"))["status"], "stopped");
}

}  // namespace
}  // namespace kerf::limit_test
