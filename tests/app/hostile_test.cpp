// What a machine or a stranger may do to a run: too little memory, pipes and links in the folder, a full disk, a second
// run, numbers beyond all range. Inputs that once hung, filled the memory or passed in silence.

#include "io/files.hpp"
#include "tests/support/running.hpp"
#include "tests/support/sample.hpp"

#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <fcntl.h>
#include <unistd.h>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace kerf::hostile_test {
namespace {

namespace fs = std::filesystem;

const std::string small = R"([domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[0.8, 0.5], [1.2, 0.6]]
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [0, 0.1]
[mesh]
size = 0.2
)";

class Hostile : public testing::Test {
 protected:
  Hostile() {
    write("a.toml", small);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }
  /// The exit code, or 128 and the signal. `limits`: of the shell, before kerf starts.
  int run(const std::string& arguments, const std::string& limits = "") const {
    const std::string line = "cd '" + folder.string() + "' && { " + limits + (limits.empty() ? "" : "; ") +
                             "exec timeout -s KILL 60 '" KERF_PROGRAM "' " + arguments + "; } >stdout 2>stderr";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  std::string error() const {
    return read_file(folder / "stderr");
  }
  nlohmann::json result(const std::string& name) const {
    return nlohmann::json::parse(read_file(folder / name / "result.json"), nullptr, false);
  }

  const test::Folder made;
  const fs::path folder = made.path;
};

#ifdef __SANITIZE_ADDRESS__
constexpr bool sanitized = true;  // takes terabytes of address space for itself
#else
constexpr bool sanitized = false;
#endif

// OpenBLAS asks for 128 MB of address space again and again until it gets them.
TEST_F(Hostile, EveryLimitOfTheAddressSpaceEndsSoonAndInWords) {
  if (sanitized) GTEST_SKIP() << "AddressSanitizer cannot run with a limit";
  int solved = 0;
  for (int k = 0; k < 30; ++k) {
    const int megabytes = 85 + k * 35;
    const int code = run("solve a.toml -o out --force --quiet --threads " + std::to_string(1 + k % 3),
                         "ulimit -v " + std::to_string(megabytes * 1000));
    EXPECT_TRUE(code == 0 || code == 4 || code == 5) << megabytes << " MB: " << code << " " << error();
    EXPECT_EQ(code != 0, error().find("kerf: ") == 0) << megabytes << " MB: " << error();
    EXPECT_EQ(error().find("unexpected"), std::string::npos) << error();
    solved += code == 0;
  }
  EXPECT_GT(solved, 0);
}

TEST_F(Hostile, FilesInTheFolderAreNeitherFollowedNorWaitedFor) {
  write("victim", "mine");
  ASSERT_EQ(run("solve a.toml -o out --quiet"), 0) << error();
  fs::create_symlink("../victim", folder / "out" / "result.json.part");
  fs::remove(folder / "out" / "crack_c.csv");
  fs::create_symlink("../victim", folder / "out" / "crack_c.csv");
  ASSERT_EQ(mkfifo((folder / "out" / "state.vtu.part").c_str(), 0600), 0);
  ASSERT_EQ(run("solve a.toml -o out --force --quiet"), 0) << error();
  EXPECT_EQ(read_file(folder / "victim"), "mine");
  EXPECT_EQ(result("out").value("status", ""), "ok");
  EXPECT_FALSE(fs::is_symlink(folder / "out" / "crack_c.csv"));
  for (const auto& entry : fs::directory_iterator(folder / "out")) EXPECT_NE(entry.path().extension(), ".part");
}

TEST_F(Hostile, ASecondRunInTheFolderIsRefused) {
  ASSERT_EQ(run("solve a.toml -o out --quiet"), 0) << error();
  const int other = open((folder / "out").c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(flock(other, LOCK_EX | LOCK_NB), 0);
  EXPECT_EQ(run("solve a.toml -o out --force --quiet"), 5);
  EXPECT_NE(error().find("another kerf is writing into 'out'"), std::string::npos) << error();
  EXPECT_EQ(result("out").value("status", ""), "ok") << "what the first run wrote stays";
  close(other);
  EXPECT_EQ(run("solve a.toml -o out --force --quiet"), 0) << error();
}

// The limit stands between the size of result.json and that of the page.
TEST_F(Hostile, AFileThatCannotBeWrittenLeavesTheResult) {
  write("a.toml", small + "[output]\nvtk = false\npng = false\n");
  ASSERT_EQ(run("solve a.toml -o out --quiet"), 0) << error();
  const auto page = fs::file_size(folder / "out" / "report.html");
  std::uintmax_t others = 0;
  for (const auto& entry : fs::directory_iterator(folder / "out"))
    if (entry.path().filename() != "report.html") others = std::max(others, entry.file_size());
  ASSERT_LT(others + 2048, page);
  EXPECT_EQ(run("solve a.toml -o full --quiet", "ulimit -f " + std::to_string((others + 511) / 512 + 2)), 5);
  EXPECT_NE(error().find("report.html"), std::string::npos) << error();
  EXPECT_EQ(result("full").value("status", ""), "ok");
  EXPECT_FALSE(fs::exists(folder / "full" / "report.html"));
  EXPECT_FALSE(fs::exists(folder / "full" / "report.html.part"));
}

TEST_F(Hostile, HangingUpStopsCleanly) {
  write("a.toml", small +
                      "[optimize]\nmethod = \"level-set\"\nvolume = { at_most = 0.5 }\nmax_iterations = 10000\n"
                      "[functional]\nkind = \"compliance\"\n");
  test::Running program(folder, {KERF_PROGRAM, "optimize", "a.toml", "-o", "out", "--quiet"});
  EXPECT_TRUE(program.reaches([this] { return fs::exists(folder / "out" / "checkpoint.bin"); }));
  program.signal(SIGHUP);
  EXPECT_EQ(program.code(), 4) << error();
  EXPECT_NE(error().find("stopped"), std::string::npos) << error();
  EXPECT_FALSE(fs::exists(folder / "out" / "result.json"));
}

TEST_F(Hostile, AnEnergyBeyondAllNumbersIsNoResult) {
  for (const auto& [traction, word] : {std::pair{"1e200", "too large"}, std::pair{"1e-200", "too small"}}) {
    std::string text = small;
    text.replace(text.find("[0, 0.1]"), 8, std::string("[0, ") + traction + "]");
    write("a.toml", text);
    EXPECT_EQ(run("solve a.toml -o out --force --quiet"), 4) << traction;
    EXPECT_NE(error().find(word), std::string::npos) << error();
    EXPECT_EQ(result("out").value("status", ""), "failed");
  }
}

// Nothing but the last digits of what is prescribed makes stresses then, and those digits are no load.
TEST_F(Hostile, ABodyMovedAsAWholeIsSolved) {
  for (const char* moved : {"[1, 0.3]", "[1e-3, 1e3]", "[\"1 - 0.01*y\", \"0.3 + 0.01*x\"]"}) {
    std::string text = small.substr(0, small.find("[[boundary]]\non = \"right\"")) + "[mesh]\nsize = 0.2\n";
    text.replace(text.find("[0, 0]\n"), 6, moved);
    write("a.toml", text);
    EXPECT_EQ(run("solve a.toml -o out --force --quiet"), 0) << moved << "\n" << text << error();
    EXPECT_LT(std::abs(result("out")["state"].value("energy", 1.0)), 1e-20) << moved;
  }
}

// It took 17 GB and 100 s until it ran out of memory.
TEST_F(Hostile, OptimizationLooksAtTheGeometryFirst) {
  std::string text = small;
  text.replace(text.find("path = "), std::string_view("path = [[0.8, 0.5], [1.2, 0.6]]").size(),
               "arc = { center = [0.5, 0.5], radius = 1e7, from_deg = 10, to_deg = 200 }");
  write("a.toml", text +
                      "[functional]\nkind = \"compliance\"\n[optimize]\nmethod = \"mma\"\nvolume = { at_most = 0.9 }\n"
                      "[[optimize.hole]]\ncircle = { center = [[0.1, 0.9], [0.1, 0.9]], radius = [0.02, 0.2] }\n");
  EXPECT_EQ(run("optimize a.toml -o out --quiet"), 3) << error();
  EXPECT_NE(error().find("too flat"), std::string::npos) << error();
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
}  // namespace kerf::hostile_test
