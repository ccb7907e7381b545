// Nothing silent: what kerf check knows of what a run would refuse, and a sentence for each thing that leads to
// nothing.

#include "tests/support/folder.hpp"
#include "tests/support/running.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace kerf::silence_test {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string read_all(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// On one line, whatever the width of a summary.
std::string unwrapped(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c != ' ' && c != '\n')
      out += c;
    else if (!out.empty() && out.back() != ' ')
      out += ' ';
  return out;
}

const std::string body = R"([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 2
poisson = 0.3
)";
const std::string held = "[[boundary]]\non = \"left\"\ndisplacement = [0, 0]\n";
const std::string pulled = "[[boundary]]\non = \"right\"\ntraction = [1, 0]\n";
const std::string quiet = "[output]\npng = false\nvtk = false\nhtml = false\n";

class Silence : public kerf::test::InFolder {
 protected:
  struct Said {
    int code;
    std::string text;  // of both streams
  };
  Said kerf(const std::string& command, const std::string& text) const {
    std::ofstream(folder / "a.toml", std::ios::binary) << text << quiet;
    const int code = kerf::test::Running(folder, {KERF_PROGRAM, command, (folder / "a.toml").string(), "-o",
                                                  (folder / "out").string(), "--force", "--log-level", "off"})
                         .code();
    return {code, unwrapped(read_all(folder / "stdout") + ' ' + read_all(folder / "stderr"))};
  }
};

#define EXPECT_SAYS(said, words) EXPECT_NE((said).text.find(words), std::string::npos) << (said).text

TEST_F(Silence, CheckRefusesLoadsThatNothingHolds) {
  const std::string up = "[[boundary]]\non = \"right\"\ntraction = [0, 1]\n",
                    down = "[[boundary]]\non = \"left\"\ntraction = [0, -1]\n",
                    roller = "[[boundary]]\non = \"left\"\ndisplacement_x = 0\n";
  for (const std::string& text : {body + pulled, body + up + down, body + roller + up}) {
    const Said run = kerf("solve", text), check = kerf("check", text);
    EXPECT_EQ(run.code, 4) << run.text;
    EXPECT_EQ(check.code, 4) << check.text;
    EXPECT_SAYS(check, "and the loads push it that way");
  }
  const std::string balanced = pulled + "[[boundary]]\non = \"left\"\ntraction = [-1, 0]\n";
  EXPECT_EQ(kerf("check", body + balanced).code, 0);
}

TEST_F(Silence, CheckLooksAtEveryLoadCase) {
  const Said check = kerf("check", body + "[[boundary]]\non = \"left\"\ndisplacement_x = 0\n" +
                                       "[functional]\nkind = \"compliance\"\n[optimize]\nvolume = { at_most = 0.5 }\n"
                                       "[[load_case]]\nname = \"x\"\n[[load_case.boundary]]\non = \"right\"\n"
                                       "traction = [1, 0]\n[[load_case]]\nname = \"y\"\n[[load_case.boundary]]\n"
                                       "on = \"right\"\ntraction = [0, 1]\n");
  EXPECT_EQ(check.code, 4);
  EXPECT_SAYS(check, "load case \"y\": nothing holds the body");
}

TEST_F(Silence, WithoutLoadsItSaysSo) {
  for (const char* command : {"check", "solve"})
    for (const char* load : {"", "[[boundary]]\non = \"right\"\ntraction = [0, \"0 * x\"]\n"}) {
      const Said said = kerf(command, body + held + load);
      EXPECT_EQ(said.code, 0) << said.text;
      EXPECT_SAYS(said, "nothing acts on the body, and its displacements and stresses are 0");
    }
  EXPECT_EQ(kerf("check", body + held + pulled).text.find("nothing acts"), std::string::npos);
}

TEST_F(Silence, AStateWithoutStressIsTold) {
  const Said said = kerf("solve", body + held + "[[boundary]]\non = \"right\"\ntraction = [\"x - 1\", 0]\n");
  EXPECT_SAYS(said, "there is no stress in the body");
}

TEST_F(Silence, AMeshAsCoarseAsTheBodyIsTold) {
  for (const char* command : {"check", "solve"}) {
    const Said said = kerf(command, body + held + pulled + "[mesh]\nsize = 3\n");
    EXPECT_SAYS(said, "mesh.size = 3 is no smaller than the body is wide, 1: the mesh has");
    EXPECT_SAYS(said, "take 0.1 or less");
  }
  EXPECT_EQ(kerf("check", body + held + pulled + "[mesh]\nsize = 0.5\n").text.find("mesh.size"), std::string::npos);
}

TEST_F(Silence, AMapMaskedEverywhereHasNoExtrema) {
  const Said said = kerf("map", body + held + pulled + "[mesh]\nsize = 0.2\n[map]\nradius = 0.4\n");
  EXPECT_SAYS(said, "masked everywhere: at every place a change of radius 0.4 comes too near to something");
  EXPECT_EQ(said.text.find("hole min"), std::string::npos) << said.text;
  const json r = json::parse(std::ifstream(folder / "out" / "result.json"));
  EXPECT_TRUE(r.at("map").at("min").at("value").is_null());
  EXPECT_TRUE(r.at("map").at("max").at("at")[0].is_null());
  EXPECT_NEAR(r.at("map").at("masked_share"), 1, 1e-12);
}

TEST_F(Silence, APointOutsideIsNotTooNear) {
  const Said said = kerf("map", body + held + pulled +
                                    "[mesh]\nsize = 0.2\n[map]\npoints = [[0.5, 0.5], [1.05, 0.5], [7, 7]]\n"
                                    "[[probe]]\nname = \"p\"\npoints = [[0.5, 0.5], [-1, 0]]\n");
  EXPECT_SAYS(said, "map: 2 of 3 points lie outside the body, the first at (1.05, 0.5): there is no value there");
  EXPECT_SAYS(said, "probe \"p\": 1 of 2 points lie outside the body, the first at (-1, 0)");
  EXPECT_SAYS(said, "at (1.05, 0.5) no value: outside the body");
  EXPECT_EQ(said.text.find("no value: too near"), std::string::npos) << said.text;
}

const std::string optimized = body + held + R"([[boundary]]
on = "right"
traction = [0, 1]
[functional]
kind = "compliance"
[mesh]
size = 0.1
[optimize]
volume = { at_most = 0.5 }
max_iterations = 1
)";

TEST_F(Silence, ADesignToBeginWithIsBegunWith) {
  std::ofstream(folder / "design.toml") << body +
                                               "[[hole]]\nname = \"h\"\ncircle = { center = [0.5, 0.5], radius = "
                                               "0.3 }\n" +
                                               held + pulled;
  const std::string text = optimized + "start = { design = \"design.toml\" }\n";
  const Said check = kerf("check", text), run = kerf("optimize", text);
  const std::string share = "the design to begin with takes 0.7";
  EXPECT_SAYS(check, share);
  EXPECT_SAYS(run, share);
  const json r = json::parse(std::ifstream(folder / "out" / "result.json"));
  const std::string history = read_all(folder / "out" / "history.csv");
  EXPECT_NE(history.find("the design given"), std::string::npos) << history;
}

TEST_F(Silence, ACaseDoesNotBeginWithItself) {
  for (const char* command : {"check", "optimize"}) {
    const Said said = kerf(command, optimized + "start = { design = \"a.toml\" }\n");
    EXPECT_EQ(said.code, 2) << said.text;
    EXPECT_SAYS(said, "= \"a.toml\": that is this case itself");
  }
  // Nor does one with another that begins with it: of that one the body alone counts.
  std::ofstream(folder / "b.toml") << optimized << "start = { design = \"a.toml\" }\n";
  EXPECT_EQ(kerf("check", optimized + "start = { design = \"b.toml\" }\n").code, 0);
}

}  // namespace

}  // namespace kerf::silence_test
