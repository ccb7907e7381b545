// kill -9 at any moment: the folder says of no unfinished run that it is ok, and the next run goes through.

#include "tests/faults/faults.hpp"
#include "tests/support/running.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <functional>

namespace kerf::fuzz {
namespace {

namespace fs = std::filesystem;

class Kill : public Faults {
 protected:
  void SetUp() override {
    Faults::SetUp();
    std::ofstream(folder / "case.toml") << small_case() << "[[probe]]\nname = \"q\"\npoints = [[0.3, 0.2]]\n";
  }
  test::Running start(std::vector<std::string> words) const {
    words.insert(words.begin(), KERF_PROGRAM);
    words.insert(words.end(), {"--threads", "1", "--quiet"});
    return {folder, words};
  }
  nlohmann::json result(const std::string& name) const {
    std::ifstream in(folder / name / "result.json");
    if (!in) return nullptr;
    nlohmann::json r = nlohmann::json::parse(in, nullptr, false);
    EXPECT_TRUE(r.is_object()) << name << ": result.json is cut off";
    if (!r.is_object()) return nullptr;
    r.erase("time_s");
    r.erase("peak_memory_mb");
    return r;
  }
  /// Kills the command at `times` moments of its length; after each a run with `again` must give the same numbers.
  void expect_survives(const std::string& command, const std::vector<std::string>& more, const char* again, int times) {
    std::vector<std::string> words = {command, "case.toml", "-o", "whole"};
    words.insert(words.end(), more.begin(), more.end());
    double length = 0;  // in processor time, which a busy machine does not change
    test::Running undisturbed = start(words);
    while (!undisturbed.ended()) length = std::max(length, undisturbed.processor_seconds()), usleep(100);
    ASSERT_EQ(undisturbed.code(), 0) << command;
    const nlohmann::json whole = result("whole");
    ASSERT_EQ(whole["status"], "ok");
    words[3] = "cut";
    fuzz::Dice dice(15, std::hash<std::string>{}(command));
    for (int k = 0; k < times; ++k) {
      std::vector<std::string> these = words;
      if (k > 0) these.emplace_back(again);
      const double at = length * dice.between(0, 1);
      test::Running program = start(these);
      program.reaches([&] { return program.processor_seconds() >= at; });
      program.signal(SIGKILL);
      const int code = program.code();
      SCOPED_TRACE(command + " killed after " + std::to_string(at) + " s of " + std::to_string(length));
      const nlohmann::json left = result("cut");
      EXPECT_TRUE(code == 0 || code == 128 + SIGKILL) << code;
      if (code != 0 && !left.is_null()) {
        // Only the page could have been missing: then the numbers are all there.
        EXPECT_TRUE(left["status"] != "ok" || left == whole) << left.dump().substr(0, 200);
      }
    }
    words.emplace_back(again);
    ASSERT_EQ(start(words).code(), 0) << command << " after the kills";
    EXPECT_EQ(result("cut"), whole);
    for (const auto& entry : fs::recursive_directory_iterator(folder / "cut"))
      EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
};

TEST_F(Kill, Map) {
  expect_survives("map", {}, "--force", 8);
}
TEST_F(Kill, Validate) {
  expect_survives("validate", {}, "--force", 8);
}
TEST_F(Kill, Adapt) {
  expect_survives("solve", {"--set", "mesh.adapt={ error = 0.03, max_triangles = 3000 }"}, "--force", 8);
}
TEST_F(Kill, OptimizeGoesOn) {
  expect_survives("optimize", {"--set", "mesh.size=0.4"}, "--resume", 6);
}

}  // namespace
}  // namespace kerf::fuzz
