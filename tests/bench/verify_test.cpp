// `kerf bench verify`: the validation manual is whole, and its quick half lies within the tolerances of its sources.

#include "bench/verify/records.hpp"

#include "io/files.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

namespace kerf::verify_test {
namespace {

namespace fs = std::filesystem;

class VerifyBenchTest : public test::InFolder {};

/// Source, second check, and a tolerance with its reason for everything that is compared; those that cannot be run say
/// why. read_manual refuses what is missing.
TEST_F(VerifyBenchTest, TheManualIsWhole) {
  std::set<std::string> titles;
  int possible = 0, published = 0;
  for (const std::string& id : manual_ids()) {
    SCOPED_TRACE(id);
    const ManualEntry e = read_manual(id, folder);
    EXPECT_TRUE(titles.insert(e.title).second) << e.title;
    EXPECT_GT(e.source.size(), 40u);
    EXPECT_GT(e.setup.size(), 40u);
    possible += e.impossible.empty();
    bool compared = false;
    for (const ManualValue& v : e.values) {
      if (!v.published || !e.impossible.empty()) continue;
      compared = true;
      EXPECT_GT(v.tolerance, 0) << v.name;
      EXPECT_LE(v.tolerance, v.absolute ? 1 : 0.02) << v.name;
      EXPECT_GT(v.reason.size(), 10u) << v.name;
      published += 1;
    }
    EXPECT_TRUE(compared || !e.impossible.empty());
  }
  EXPECT_GE(possible, 40);
  EXPECT_GE(published, 100);
}

/// What a benchmark lacks is named with its place.
TEST_F(VerifyBenchTest, RefusesWhatIsNotWhole) {
  const std::string head = "title = 'a'\ngroup = 'g'\nsetup = 's'\nsource = 'b'\ncheck = 'c'\ncase = 'x'\n",
                    value = "[[value]]\nname = 'v'\nquantity = 'K'\ntake = { K = '/a' }\n",
                    right = "published = 1\ntolerance = 0.1\nreason = 'r'\n";
  const auto refused = [&](const std::string& text, const std::string& words) {
    write_file(folder / "a.toml", text);
    try {
      read_manual_file(folder / "a.toml");
      ADD_FAILURE() << "accepted: " << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Usage);
      EXPECT_NE(std::string(e.what()).find("a.toml:"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    }
  };
  write_file(folder / "a.toml", head + value + right);
  EXPECT_EQ(read_manual_file(folder / "a.toml").values.front().tolerance, 0.1);
  refused(head.substr(head.find("group")) + value + right, "title is missing");
  refused(head, "at least one value");
  refused(head + "impossible = 'w'\n" + value + right, "either a case, or the reason");
  refused(head + "sorce = 'w'\n" + value + right, "did you mean \"source\"?");
  refused(head + value + "published = 1\nreason = 'r'\n", "published goes with a tolerance");
  refused(head + value + "published = 1\ntolerance = 0.1\n", "reason is missing");
  refused(head + value + right + "absolute = 1\n", "exclude each other");
  refused(head + value + right + "relation = 'more'\n", "at least or at most");
  refused(head + value + right + "run = 'fine'\n", "there is no run \"fine\"");
  refused(head + "[[value]]\nname = 'v'\nquantity = 'K'\ntake = { K = '@fine /a' }\n" + right,
          "there is no run \"fine\"");
  refused(head + "quick = 1\n" + value + right, "quick is true or false");
  const std::string reference = "[[reference]]\nname = 'r'\ntitle = 'R'\n";
  refused(head + value + right + reference, "points is missing");
  refused(head + value + right + reference + "points = [[1]]\n", "points is a list of pairs");
}

/// `kerf bench verify --write docs/validation` was run for the manual as it is.
TEST_F(VerifyBenchTest, ThePagesHaveEveryBenchmark) {
  const fs::path pages = fs::path(KERF_CASES).parent_path() / "docs/validation";
  const std::string index = read_file(pages / "index.md");
  std::uintmax_t pictures = 0;
  for (const std::string& id : manual_ids()) {
    SCOPED_TRACE(id);
    EXPECT_NE(index.find("[" + id + "](" + id + ".md)"), std::string::npos);
    const ManualEntry e = read_manual(id, folder);
    const std::string page = read_file(pages / (id + ".md"));
    EXPECT_NE(page.find(e.source), std::string::npos);
    if (!e.impossible.empty()) continue;
    EXPECT_NE(page.find(e.case_text), std::string::npos);
    const std::uintmax_t bytes = fs::file_size(pages / (id + ".png"));
    EXPECT_LE(bytes, 60u * 1024);
    pictures += bytes;
  }
  EXPECT_LE(pictures, 4u << 20);
}

TEST_F(VerifyBenchTest, TheQuickHalfIsWithinTolerance) {
  const VerifyBench bench = run_verify_bench({{.folder = folder, .quick = true}, {}});
  EXPECT_GE(count(bench, "within"), 30);
  for (const VerifiedEntry& e : bench.entries) {
    EXPECT_EQ(e.verdict, "within") << e.entry.id << ' ' << e.trouble;
    EXPECT_TRUE(e.has_picture) << e.entry.id;
    for (std::size_t k = 0; k < e.values.size(); ++k)
      EXPECT_TRUE(e.values[k].within) << e.entry.id << ", " << e.entry.values[k].name << ": " << e.values[k].measured;
  }
  for (const char* name : {"verify.csv", "verify.json", "index.md", "kirsch.md", "kirsch.png"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
  const auto json = nlohmann::json::parse(read_file(folder / "verify.json"));
  EXPECT_EQ(json["benchmarks"].size(), bench.entries.size());
}

/// A value that is wrong by more than its tolerance is outside, and so is its benchmark.
TEST_F(VerifyBenchTest, SaysWhatIsOutside) {
  VerifyBench bench = run_verify_bench({{.folder = folder, .cases = {"patch-test"}}, {}});
  ASSERT_EQ(bench.entries.size(), 1u);
  const VerifiedEntry& e = bench.entries.front();
  EXPECT_EQ(e.verdict, "within");
  EXPECT_NEAR(e.values.back().measured, 400, 1e-6);
  ManualValue value = e.entry.values.back();
  VerifiedValue found{.measured = 404};
  judge(value, found);
  EXPECT_FALSE(found.within);
  EXPECT_NEAR(found.deviation, 0.01, 1e-12);
  value.relation = ManualValue::Relation::AtLeast;
  judge(value, found);
  EXPECT_TRUE(found.within);
  value.relation = ManualValue::Relation::AtMost;
  judge(value, found);
  EXPECT_FALSE(found.within);
  value.absolute = true;
  value.tolerance = 5;
  judge(value, found);
  EXPECT_TRUE(found.within);
  EXPECT_NEAR(found.deviation, 4, 1e-12);
}

/// What was done before a stop is written.
TEST_F(VerifyBenchTest, StopsBetweenBenchmarks) {
  VerifyOptions options{{.folder = folder, .cases = {"patch-test", "td-crack", "td-hole"}}, {}};
  options.bench.stop_asked = [asked = 0]() mutable { return asked++ > 0; };
  const VerifyBench bench = run_verify_bench(options);
  EXPECT_TRUE(bench.stopped);
  ASSERT_EQ(bench.entries.size(), 1u);
  EXPECT_EQ(bench.entries.front().entry.id, "patch-test");
  const auto json = nlohmann::json::parse(read_file(folder / "verify.json"));
  EXPECT_EQ(json["status"], "stopped");
  EXPECT_EQ(json["benchmarks"].size(), 1u);
}

TEST_F(VerifyBenchTest, ReadsNumbersOfARun) {
  write_file(folder / "result.json", R"({"cracks": [{"tips": [{"K_I": 2.5, "K_II": null}]}]})");
  write_file(folder / "probe_a.csv", "x,y,s_xx\n0,0,3\n1,0,-4\n2,0,1\n");
  EXPECT_EQ(read_number(folder, "/cracks/0/tips/0/K_I"), 2.5);
  EXPECT_EQ(read_number(folder, "probe_a.csv:1:s_xx"), -4);
  EXPECT_EQ(read_number(folder, "probe_a.csv:max:s_xx"), 3);
  EXPECT_EQ(read_number(folder, "probe_a.csv:min:s_xx"), -4);
  write_file(folder / "probe_b.csv", "x,s_xx\n0,\n1,7\n");
  EXPECT_EQ(read_number(folder, "probe_b.csv:1:s_xx"), 7);
  write_file(folder / "growth.csv", "step,tip,x,a\n0,c:end,0,1\n0,d:end,5,1\n1,c:end,1,2\n1,d:end,4,2\n2,d:end,2,4\n");
  EXPECT_EQ(read_number(folder, "growth.csv:last:x"), 2);
  EXPECT_EQ(read_number(folder, "growth.csv:c:end@last:x"), 1);
  EXPECT_EQ(read_number(folder, "growth.csv:d:end@1:x"), 4);
  EXPECT_EQ(read_number(folder, "growth.csv:d:end@a=3:x"), 3);
  EXPECT_EQ(read_number(folder, "growth.csv:d:end@a=4:x"), 2);
  EXPECT_EQ(read_number(folder, "growth.csv:c:end@max:a"), 2);
  for (const char* nothing :
       {"growth.csv:d:end@a=5:x", "growth.csv:e:end@0:x", "growth.csv:c:end@b=1:x", "growth.csv:c:end@2:x",
        "growth.csv:last", "probe_b.csv:0:s_xx", "/cracks/1/tips/0/K_I", "/cracks/0/tips/0/K_II", "probe_a.csv:3:s_xx",
        "probe_a.csv:0:s_yy", "probe_a.csv:one:s_xx", "probe_a.csv"})
    EXPECT_THROW(read_number(folder, nothing), Error) << nothing;
  EXPECT_DOUBLE_EQ(value_of("2*K/sqrt(pi*a)", {{"K", 3}, {"a", 1 / pi}}), 6);
  EXPECT_THROW(value_of("2*L"), Error);
}

/// Two cracks of a body that has grown; b is the image of a but for its last point, which is 0.01 off.
TEST_F(VerifyBenchTest, ReadsPathsOfGrownBodies) {
  write_file(folder / "grown.toml", R"([domain]
outline = [[-2, -2], [2, -2], [2, 2], [-2, 2]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "a"
path = [[-1.5, -1], [-0.5, -1], [0.5, -0.5], [0.5, -0.25]]
[[crack]]
name = "b"
path = [[1.5, 1], [0.5, 1], [-0.5, 0.5], [-0.5, 0.26]]
[material]
young = 1
poisson = 0.3
)");
  const auto at = [&](const std::string& what, const std::vector<ManualReference>& references = {}) {
    return read_number(folder, "path:" + what, references);
  };
  EXPECT_DOUBLE_EQ(at("a:y@x=0"), -0.75);
  EXPECT_DOUBLE_EQ(at("a:x@y=-0.75"), 0);
  EXPECT_DOUBLE_EQ(at("a:s@x=-0.5"), 1);
  EXPECT_DOUBLE_EQ(at("a:length"), 1.25 + std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(at("a:y@end"), -0.25);
  EXPECT_DOUBLE_EQ(at("a:x@start"), -1.5);
  EXPECT_NEAR(at("a:turned:b"), 0.01, 1e-12);
  EXPECT_NEAR(at("b:turned:a"), 0, 1e-12);
  EXPECT_NEAR(at("a:to:r", {{"q", "q", {Vec2(0, 0)}}, {"r", "r", {Vec2(-1, -1), Vec2(0.5, 0.05)}}}), 0.3, 1e-12);
  for (const char* nothing : {"c:length", "a:x@x=2", "a:x@end=1", "a:z@end", "a:s@end", "a:to:r", "a:turned:c", "a"})
    EXPECT_THROW(at(nothing), Error) << nothing;
}

}  // namespace
}  // namespace kerf::verify_test
