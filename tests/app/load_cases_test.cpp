// Load cases as a user sees them: a row for each, and nothing that hangs on the order of their tables.

#include "tests/support/folder.hpp"
#include "tests/support/running.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace kerf::load_cases_test {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string read_all(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string load_case(const std::string& name, const std::string& weight, const std::string& on,
                      const std::string& traction) {
  return "[[load_case]]\nname = \"" + name + "\"\nweight = " + weight + "\n[[load_case.boundary]]\non = \"" + on +
         "\"\ntraction = " + traction + "\n";
}

const std::string quiet = "[output]\npng = false\nvtk = false\nhtml = false\n";

class LoadCases : public kerf::test::InFolder {
 protected:
  /// The result of `command` on a case.
  json result(const std::string& command, const std::string& name, const std::string& text) const {
    std::ofstream(folder / (name + ".toml"), std::ios::binary) << text;
    const fs::path out = folder / name;
    kerf::test::Running(folder, {KERF_PROGRAM, command, (folder / (name + ".toml")).string(), "-o", out.string(),
                                 "--force", "--log-level", "off"})
        .code();
    std::ifstream file(out / "result.json");
    EXPECT_TRUE(file) << read_all(folder / "stderr");
    return file ? json::parse(file) : json();
  }
};

// A square on rollers: uniform stress under either load, in plane stress of young 2.
const std::string square = R"([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 2
poisson = 0.3
state = "plane stress"
[[boundary]]
on = "left"
displacement_x = 0
[[boundary]]
on = "bottom"
displacement_y = 0
[mesh]
size = 0.5
[functional]
kind = "compliance"
[optimize]
method = "mma"
volume = { at_most = 0.98 }
[[optimize.hole]]
circle = { center = [[0.45, 0.55], [0.45, 0.55]], radius = [0.1, 0.2] }
)";

TEST_F(LoadCases, HaveRowsWithTheirOwnValues) {
  const json r =
      result("solve", "square",
             square + load_case("pull", "3", "right", "[4, 0]") + load_case("crush", "0.5", "top", "[0, -6]") + quiet);
  ASSERT_EQ(r.at("load_cases").size(), 2);
  EXPECT_EQ(r.at("state").at("load_case"), "crush");
  struct Truth {
    const char* name;
    double weight, stress, along, across;  // displacements at the far corner
    const char* held;                      // the label that bears it
  };
  const Truth truths[] = {{"crush", 0.5, 6, -6 / 2., 0.3 * 6 / 2, "bottom"},
                          {"pull", 3, 4, 4 / 2., -0.3 * 4 / 2, "left"}};
  for (std::size_t k = 0; k < 2; ++k) {
    const json& row = r.at("load_cases")[k];
    const Truth& t = truths[k];
    EXPECT_EQ(row.at("name"), t.name);
    EXPECT_EQ(row.at("weight"), t.weight);
    EXPECT_NEAR(row.at("compliance"), t.stress * std::abs(t.along), 1e-9);
    EXPECT_NEAR(row.at("energy"), -0.5 * t.stress * std::abs(t.along), 1e-9);
    EXPECT_NEAR(row.at("max_von_mises").at("value"), t.stress, 1e-9);
    EXPECT_LT(row.at("max_von_mises").at("margin"), 1e-8);
    EXPECT_NEAR(row.at("max_displacement").at("value"), std::hypot(t.along, t.across), 1e-9);
    EXPECT_NEAR(row.at("max_displacement").at("at")[0], 1, 1e-12);
    for (const json& reaction : row.at("reactions")) {
      const bool bears = reaction.at("on") == t.held;
      EXPECT_NEAR(std::hypot(double(reaction.at("force")[0]), double(reaction.at("force")[1])), bears ? t.stress : 0,
                  1e-9);
    }
  }
  bool said = false;
  for (const std::string note : r.at("state").at("notes"))
    said = said || note.find("those of load case \"crush\"") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST_F(LoadCases, AreOnThePageAndInTheSummary) {
  std::ofstream(folder / "square.toml", std::ios::binary) << square + load_case("pull", "3", "right", "[4, 0]") +
                                                                 load_case("crush", "0.5", "top", "[0, -6]") +
                                                                 "[output]\nvtk = false\npng = false\n";
  kerf::test::Running(folder, {KERF_PROGRAM, "solve", (folder / "square.toml").string(), "-o",
                               (folder / "out").string(), "--log-level", "off"})
      .code();
  const std::string summary = read_all(folder / "stdout"), page = read_all(folder / "out" / "report.html");
  EXPECT_NE(summary.find("load case   pull  weight 3  compliance 8"), std::string::npos) << summary;
  EXPECT_NE(summary.find("load case   crush  weight 0.5  compliance 18"), std::string::npos) << summary;
  EXPECT_NE(page.find("<h2>Load cases</h2>"), std::string::npos);
  EXPECT_NE(page.find("Under load case crush."), std::string::npos);
}

/// Without what only the clock says.
json timeless(json r) {
  r.erase("time_s");
  r.erase("peak_memory_mb");
  r.erase("case");
  r.erase("title");
  return r;
}

TEST_F(LoadCases, OfContactDoNotHangOnTheirOrder) {
  std::string cracked = square + "[[crack]]\nname = \"c\"\npath = [[0.3, 0.4], [0.7, 0.5]]\n" + quiet;
  cracked.replace(cracked.find("size = 0.5"), 10, "size = 0.2");
  std::vector<std::string> loads{load_case("a", "0.1", "right", "[1, 0.2]"), load_case("b", "0.2", "top", "[0.1, -1]"),
                                 load_case("c", "0.3", "top", "[0.3, 1]")};
  const json once = timeless(result("solve", "abc", cracked + loads[0] + loads[1] + loads[2]));
  ASSERT_EQ(once.at("load_cases").size(), 3);
  EXPECT_TRUE(once == timeless(result("solve", "bca", cracked + loads[1] + loads[2] + loads[0])));
  // Each is what it is alone.
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(result("solve", "one", cracked + loads[k]).at("load_cases")[0], once.at("load_cases")[k]);
}

TEST_F(LoadCases, WithoutContactAreWhatTheyAreAlone) {
  std::vector<std::string> loads{load_case("a", "0.1", "right", "[1, 0.2]"), load_case("b", "0.2", "top", "[0.1, -1]")};
  const json both = result("solve", "both", square + quiet + loads[0] + loads[1]);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_EQ(result("solve", "one", square + quiet + loads[k]).at("load_cases")[0], both.at("load_cases")[k]);
}

/// Histories and endings of several orders.
class Orders : public LoadCases, public testing::WithParamInterface<const char*> {};

TEST_P(Orders, OfLoadCasesGiveOneOptimization) {
  std::vector<std::string> loads{load_case("a", "0.1", "right", "[1, 0.2]"), load_case("b", "0.7", "top", "[0.1, -1]"),
                                 load_case("c", "0.3", "top", "[0.3, 1]")};
  std::string body = square;
  body.replace(body.find("size = 0.5"), 10, "size = 0.25");
  body.erase(body.find("[optimize]"));
  std::string first;
  json design;
  for (const std::array order : {std::array{0, 1, 2}, std::array{2, 0, 1}, std::array{1, 0, 2}}) {
    std::string text = body + GetParam();
    for (const int k : order) text += loads[static_cast<std::size_t>(k)];
    const json r = timeless(result("optimize", "ordered", text + quiet));
    const std::string history = read_all(folder / "ordered" / "history.csv");
    ASSERT_FALSE(history.empty());
    if (first.empty()) first = history, design = r;
    EXPECT_EQ(history, first);
    EXPECT_TRUE(r == design);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Methods, Orders,
    testing::Values("[optimize]\nmethod = \"mma\"\nvolume = { at_most = 0.98 }\nmax_iterations = 4\n"
                    "[[optimize.hole]]\n"
                    "circle = { center = [[0.45, 0.55], [0.45, 0.55]], radius = [0.1, 0.2] }\n",
                    "[optimize]\nvolume = { at_most = 0.8 }\nmax_iterations = 3\n"));

}  // namespace

}  // namespace kerf::load_cases_test
