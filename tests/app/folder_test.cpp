// What a run may write into, and what it leaves alone: folders that strangers packed, files that no run of kerf wrote,
// names that a shell would take for commands.

#include "tests/support/folder.hpp"
#include "tests/support/running.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace kerf::folder_test {
namespace {

namespace fs = std::filesystem;

const std::string square = R"([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 100
poisson = 0.3
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "top"
traction = [0, 1]
[mesh]
size = 0.5
[output]
vtk = false
png = false
html = false
)";

class ResultFolder : public test::InFolder {
 protected:
  void write(const fs::path& name, const std::string& text) const {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << text;
  }
  std::string read(const fs::path& name) const {
    std::stringstream all;
    all << std::ifstream(folder / name).rdbuf();
    return all.str();
  }
  /// The exit code; what it says is in "said".
  int run(const std::string& command) const {
    const int status = std::system(("cd '" + folder.string() + "' && (" + command + ") >said 2>&1").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  int kerf(const std::string& arguments) const {
    return run("'" KERF_PROGRAM "' " + arguments);
  }
};

// Of every folder beneath that of the results, whatever it links to.
TEST_F(ResultFolder, LinksInItAreNotFollowed) {
  write("home/.profile", "mine\n");
  write(".profile", "x,y\n0.5,0.5\n");
  write("a.toml", square + "[[probe]]\nname = \"p\"\nfile = \".profile\"\n");
  for (const char* to : {"../home", "../nothing", "/"}) {
    fs::remove_all(folder / "out");
    fs::create_directories(folder / "out");
    fs::create_directory_symlink(to, folder / "out/input");
    EXPECT_EQ(kerf("solve a.toml -o out"), 5) << to;
    EXPECT_NE(read("said").find("is a link"), std::string::npos) << read("said");
    EXPECT_EQ(read("home/.profile"), "mine\n");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / "home"), {}), 1);
  }
  fs::remove(folder / "out/input");
  EXPECT_EQ(kerf("solve a.toml -o out --force"), 0) << read("said");
  EXPECT_EQ(read("out/input/1_.profile"), "x,y\n0.5,0.5\n");
}

// The folder itself is the word of the user.
TEST_F(ResultFolder, MayBeALinkItself) {
  write("a.toml", square);
  fs::create_directories(folder / "disk");
  fs::create_directory_symlink("disk", folder / "out");
  EXPECT_EQ(kerf("solve a.toml -o out"), 0) << read("said");
  EXPECT_TRUE(fs::exists(folder / "disk/result.json"));
}

TEST_F(ResultFolder, RunsOfASweepGoIntoFoldersOfTheirOwn) {
  write("a.toml", square);
  write("victim", "mine\n");
  write("far/kept", "mine\n");
  fs::create_directories(folder / "sw/size=0.5");
  fs::create_symlink("../../victim", folder / "sw/size=0.5/run.log");
  EXPECT_EQ(kerf("sweep a.toml --over 'mesh.size=[0.5]' -o sw --quiet"), 0) << read("said");
  EXPECT_EQ(read("victim"), "mine\n");
  fs::remove_all(folder / "sw");
  fs::create_directories(folder / "sw/size=0.5");
  ASSERT_EQ(mkfifo((folder / "sw/size=0.5/run.log").c_str(), 0600), 0);
  EXPECT_EQ(kerf("sweep a.toml --over 'mesh.size=[0.5]' -o sw --quiet"), 0) << read("said");
  fs::remove_all(folder / "sw");
  fs::create_directories(folder / "sw");
  fs::create_directory_symlink("../far", folder / "sw/size=0.5");
  EXPECT_EQ(kerf("sweep a.toml --over 'mesh.size=[0.5]' -o sw --quiet"), 5) << read("said");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "far"), {}), 1);
}

TEST_F(ResultFolder, FilesThatNoRunWroteStay) {
  for (const char* name : {"measured.csv", "history.csv", "design.svg", "crack_c.csv", "probe_p.csv", "checkpoint.bin",
                           "result.json", "case.toml", "state_0001.vtu"})
    for (const char* force : {"", " --force", " --resume"}) {
      fs::remove_all(folder / "here");
      write("here/a.toml", square + "[optimize]\nvolume = { at_most = 0.5 }\n[functional]\nkind = \"compliance\"\n");
      write(fs::path("here") / name, "mine\n");
      EXPECT_EQ(kerf(std::string("optimize here/a.toml -o here") + force), 5) << name << force;
      EXPECT_NE(read("said").find(std::string(name)), std::string::npos) << name << force << read("said");
      EXPECT_EQ(read(fs::path("here") / name), "mine\n") << name << force;
    }
}

TEST_F(ResultFolder, ResultsAndUnfinishedOptimizationsAskForForce) {
  write("a.toml",
        square + "[optimize]\nvolume = { at_most = 0.5 }\nmax_iterations = 1\n[functional]\nkind = \"compliance\"\n");
  ASSERT_EQ(kerf("optimize a.toml -o out --quiet"), 0) << read("said");
  EXPECT_EQ(kerf("solve a.toml -o out"), 5);
  EXPECT_NE(read("said").find("out already holds results; use --force to overwrite"), std::string::npos);
  fs::remove(folder / "out/result.json");  // as where it was killed
  EXPECT_EQ(kerf("optimize a.toml -o out"), 5);
  EXPECT_NE(read("said").find("--resume goes on with it, --force begins anew"), std::string::npos) << read("said");
  EXPECT_EQ(kerf("optimize a.toml -o out --resume --quiet"), 0) << read("said");
  EXPECT_EQ(kerf("solve a.toml -o out --force --quiet"), 0) << read("said");
}

TEST_F(ResultFolder, FaultsOfTheFileSystemAreSentences) {
  write("a.toml", square);
  EXPECT_EQ(run("TMPDIR=/nowhere '" KERF_PROGRAM "' solve a.toml --max-seconds 100"), 5);
  EXPECT_EQ(read("said"), "kerf: cannot use the folder for temporary files (TMPDIR): No such file or directory\n");
}

// Titles and overrides stand in comments of what is written: they end no line of it.
TEST_F(ResultFolder, TitlesWriteNoLines) {
  write("a.toml",
        "title = \"x\\n[material]\\nyoung = 7\\r[evil]\\u0001\\u2028\"\n" + square +
            "[optimize]\nvolume = { at_most = 0.5 }\nmax_iterations = 1\n[functional]\nkind = \"compliance\"\n");
  ASSERT_EQ(kerf("optimize a.toml -o out --quiet --set \"solver.degree=1\n#\n\""), 0) << read("said");
  for (const char* name : {"out/design.toml", "out/case.toml"}) {
    std::ifstream in(folder / name);
    std::string line;
    while (std::getline(in, line) && !line.starts_with("title = ")) EXPECT_TRUE(line.starts_with('#')) << line;
    EXPECT_EQ(kerf(std::string("check ") + name), 0) << read("said");
  }
}

// Started as a scheduler would, with the program of this build in front of the PATH.
TEST_F(ResultFolder, ScriptsOfSweepsRunNoNames) {
  for (const std::string name : {"$(touch PWNED)", "a'b; touch PWNED #", "`touch PWNED`", "two words"}) {
    const fs::path place = folder / name;
    write(fs::path(name) / (name + ".toml"), square);
    std::ofstream(folder / "start.sh") << R"sh(set -e
PATH=$(dirname "$1"):$PATH
cd "$2"
"$1" sweep "$3.toml" --over 'mesh.size=[0.5]' --over 'title=["$(touch PWNED)", "a b"]' -o sw --write slurm
cd sw
SLURM_ARRAY_TASK_ID=1 bash sweep.sbatch
SLURM_ARRAY_TASK_ID=2 bash sweep.sbatch
)sh";
    std::string quoted;
    for (const char c : name) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    EXPECT_EQ(run("bash start.sh '" KERF_PROGRAM "' '" + quoted + "' '" + quoted + "'"), 0) << name << read("said");
    int done = 0;
    for (const auto& entry : fs::recursive_directory_iterator(place)) {
      EXPECT_NE(entry.path().filename(), "PWNED") << entry.path();
      done += entry.path().filename() == "result.json";
    }
    EXPECT_EQ(done, 2) << name;
  }
}

TEST_F(ResultFolder, CasesOfStrangersStayInTheirs) {
  write("p.csv", "x,y\n0.5,0.5\n");
  write("case/sub/p.csv", "x,y\n0.5,0.5\n");
  write("case/a.geo", "Point(1) = {0, 0, 0, 1};\n");
  fs::create_symlink("../p.csv", folder / "case/link.csv");
  fs::create_directory_symlink("..", folder / "case/up");
  const auto probe = [&](const std::string& file) {
    return square + "[[probe]]\nname = \"p\"\nfile = \"" + file + "\"\n";
  };
  write("case/far.toml", probe("../p.csv"));
  const auto start = [&](const std::string& design) {
    return square +
           "[functional]\nkind = \"compliance\"\n[optimize]\nvolume = { at_most = 0.5 }\nstart = { design = \"" +
           design + "\" }\n";
  };
  for (const auto& [text, says] : {std::pair<std::string, std::string>{probe("../p.csv"), "leads out of"},
                                   {probe((folder / "p.csv").string()), "leads out of"},
                                   {probe("sub/../../p.csv"), "leads out of"},
                                   {probe("link.csv"), "is a link"},
                                   {probe("up/p.csv"), "beneath one"},
                                   {probe("sub"), "no regular file"},
                                   {start("far.toml"), "leads out of"},
                                   {square + "[solver]\nbackend = \"petsc\"\npetsc = \"-ksp_view\"\n", "solver.petsc"},
                                   {"[domain]\nfile = \"a.geo\"\n", "is a script"},
                                   {"[domain]\nfile = \"a.GEO\"\n", "is a script"}}) {
    write("case/a.toml", text);
    EXPECT_EQ(kerf("solve case/a.toml -o out --force --untrusted"), 2) << text << read("said");
    EXPECT_NE(read("said").find(says), std::string::npos) << text << read("said");
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
  write("case/a.toml", probe("sub/p.csv"));
  EXPECT_EQ(kerf("solve case/a.toml -o out --untrusted --quiet"), 0) << read("said");
  EXPECT_EQ(kerf("check case/a.toml --untrusted --set probe[0].file=../p.csv"), 2) << read("said");
}

// Neither modules nor libraries come from the folder where the user stands.
TEST_F(ResultFolder, NoCodeComesFromWhereTheUserStands) {
  for (const char* name : {"kerf_vtk.so", "kerf_gmsh.so", "kerf_petsc.so", "kerf-bench", "libfmt.so.9", "libz.so.1"}) {
    write(name, "no library\n");
    fs::permissions(folder / name, fs::perms::owner_all);
  }
  std::string with_files = square;
  with_files.replace(with_files.find("vtk = false"), 11, "vtk = true ");
  write("a.toml", with_files);
  EXPECT_EQ(kerf("solve a.toml -o out --quiet"), 0) << read("said");
  EXPECT_TRUE(fs::exists(folder / "out/state.vtu")) << read("said");
  EXPECT_EQ(kerf("--version"), 0);
  EXPECT_EQ(read("said").find("no library"), std::string::npos) << read("said");
}

}  // namespace
}  // namespace kerf::folder_test
