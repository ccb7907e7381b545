// The program as a user meets it: exit codes, messages, files. The words of case-file errors are tested in tests/cases.

#include "tests/support/folder.hpp"
#include "tests/support/running.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace kerf::cli_test {

namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code = -1;
  std::string out, error;
};

std::string read_all(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

const std::string square = R"(title = "Square"
[domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 100
poisson = 0.3
[mesh]
size = 0.2
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "top"
traction = [0, 1]
)";

/// Every test works in a folder of its own.
class Cli : public kerf::test::InFolder {
 protected:
  void SetUp() override {
    write("a.toml", square);
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }

  Outcome kerf(const std::string& arguments) const {
    return shell("'" KERF_PROGRAM "' " + arguments);
  }
  Outcome shell(const std::string& line) const {
    const std::string command =
        "cd '" + folder.string() + "' && (" + line + ") 2>'" + (folder / "stderr").string() + "'";
    Outcome outcome;
    FILE* pipe = popen(command.c_str(), "r");
    if (!pipe) return outcome;
    std::array<char, 4096> buffer;
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
      outcome.out.append(buffer.data(), count);
    const int status = pclose(pipe);
    if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
    outcome.error = read_all(folder / "stderr");
    return outcome;
  }

  /// With a signal as soon as the condition holds, which it must while the program runs.
  template <class Condition>
  Outcome stopped(std::vector<std::string> words, int signal, Condition&& holds) const {
    words.insert(words.begin(), KERF_PROGRAM);
    kerf::test::Running program(folder, words);
    program.give_way();
    EXPECT_TRUE(program.reaches(holds));
    program.signal(signal);
    return {program.code(), text("stdout"), text("stderr")};
  }

  /// One message "kerf: ..." on stderr, nothing else there, and the exit code.
  void expect_failure(const std::string& arguments, int code, const std::string& words) const {
    const Outcome o = kerf(arguments + (arguments.rfind("run", 0) == 0 ? " --log-level off" : ""));
    EXPECT_EQ(o.code, code) << arguments << "\n" << o.error;
    EXPECT_EQ(o.error.rfind("kerf: ", 0), 0u) << o.error;
    EXPECT_EQ(std::count(o.error.begin(), o.error.end(), '\n'), 1) << o.error;
    EXPECT_NE(o.error.find(words), std::string::npos) << o.error;
  }
};

TEST_F(Cli, VersionAndHelp) {
  const Outcome version = kerf("--version");
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out.rfind("kerf " KERF_VERSION "\ncompiler   ", 0), 0u) << version.out;
  for (const char* said : {"\nlibraries  Eigen 3.", "SuiteSparse ", "CGAL ", "NLopt ", "Cairo 1.", "\nBLAS       /",
                           "\nmodules    kerf_vtk.so (VTK 9."})
    EXPECT_NE(version.out.find(said), std::string::npos) << said << " is missing in\n" << version.out;
  EXPECT_EQ(version.out.find(" ,"), std::string::npos) << "a library without a version in\n" << version.out;
  EXPECT_EQ(version.error, "");

  const Outcome help = kerf("--help");
  EXPECT_EQ(help.code, 0);
  for (const char* command : {"run", "solve", "map", "check", "validate", "optimize", "init", "bench"})
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
  const Outcome run = kerf("run --help");
  EXPECT_EQ(run.code, 0);
  for (const char* option : {"--output", "--set", "--threads", "--quiet", "--log-level", "--force"})
    EXPECT_NE(run.out.find(option), std::string::npos) << option;

  const Outcome alone = kerf("");
  EXPECT_EQ(alone.code, 2);
  EXPECT_EQ(alone.out, help.out);
}

TEST_F(Cli, WrongUsage) {
  expect_failure("rnu a.toml", 2, "unknown command \"rnu\"; did you mean \"run\"?");
  expect_failure("run", 2, "CASE is required");
  expect_failure("run a.toml --bogus", 2, "--bogus");
  expect_failure("run a.toml b.toml", 2, "b.toml");
  expect_failure("run a.toml --threads 0", 2, "--threads");
  expect_failure("run a.toml --threads 257", 2, "--threads");
  expect_failure("run a.toml --threads two", 2, "--threads");
  expect_failure("solve a.toml --log-level loud", 2, "loud");
  expect_failure("solve a.toml --set", 2, "--set");
  expect_failure("run a.toml --set mesh.size", 2, "--set \"mesh.size\": a value is missing");
  expect_failure("run a.toml --set mesh.sise=1", 2, "--set mesh.sise: unknown key \"sise\"");
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST_F(Cli, InitWritesCasesThatRun) {
  const Outcome list = kerf("init --list");
  EXPECT_EQ(list.code, 0);
  for (const char* name : {"plate", "cracked", "optimize", "holes", "inverse"}) {
    EXPECT_NE(list.out.find(name), std::string::npos);
    const Outcome wrote = kerf(std::string("init ") + name);
    EXPECT_EQ(wrote.code, 0) << wrote.error;
    EXPECT_EQ(kerf(std::string("check ") + name + ".toml").code, 0) << name;
    expect_failure(std::string("init ") + name, 5, "use --force");
  }
  EXPECT_EQ(kerf("init plate --force -o other.toml").code, 0);
  EXPECT_EQ(read_all(folder / "other.toml"), read_all(folder / "plate.toml"));
  EXPECT_EQ(kerf("run plate.toml -o out --set mesh.size=0.2 --quiet").code, 0);
  EXPECT_EQ(kerf("optimize inverse.toml -o inv --set mesh.size=0.15 --set optimize.max_iterations=3 --quiet").code, 0);
  const auto found = nlohmann::json::parse(read_all(folder / "inv" / "result.json"))["optimize"]["identified"];
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(found[0]["position_error"].get<double>(), 0.1);
  EXPECT_TRUE(fs::exists(folder / "inv" / "measured.csv"));
  expect_failure("init", 2, "which template? known: plate, cracked");
  expect_failure("init plat", 2, "unknown template \"plat\"; did you mean \"plate\"?");
  expect_failure("init plate -o no/such/folder/a.toml", 5, "cannot write");
}

TEST_F(Cli, BenchListsItsNames) {
  const Outcome o = kerf("bench --list");
  EXPECT_EQ(o.code, 0);
  for (const char* word : {"state", "map", "closing-crack", "cantilever", "bdms"})
    EXPECT_NE(o.out.find(word), std::string::npos) << word;
}

TEST_F(Cli, FindsTheBenchesBesideItselfOrOnThePath) {
  fs::copy_file(KERF_PROGRAM, folder / "kerf");
  const Outcome none = shell("PATH=/usr/bin ./kerf bench --list");
  EXPECT_EQ(none.code, 5);
  EXPECT_EQ(none.out, "");
  EXPECT_EQ(none.error,
            "kerf: the benches are not installed: there is no program kerf-bench beside kerf or on the PATH\n");
  fs::create_directory(folder / "bin");
  write("bin/kerf-bench", "#!/bin/sh\necho on the path: $*\nexit 7\n");
  fs::permissions(folder / "bin" / "kerf-bench", fs::perms::owner_all);
  const Outcome path = shell("PATH=\"$PWD/bin:/usr/bin\" ./kerf bench state --quick");
  EXPECT_EQ(path.code, 7);
  EXPECT_EQ(path.out, "on the path: state --quick\n");
  write("kerf-bench", "#!/bin/sh\necho beside\n");
  fs::permissions(folder / "kerf-bench", fs::perms::owner_all);
  EXPECT_EQ(shell("PATH=\"$PWD/bin:/usr/bin\" ./kerf bench").out, "beside\n");
}

TEST_F(Cli, BenchNamesWhatWasMeant) {
  expect_failure("bench", 2, "which bench? known: state, map");
  expect_failure("bench sttae", 2, "unknown bench \"sttae\"; did you mean \"state\"?");
  expect_failure("bench state --case opencrack", 2, "unknown case \"opencrack\"; did you mean \"open-crack\"?");
  expect_failure("bench state --element bdsm", 2, "unknown element \"bdsm\"; did you mean \"bdms\"?");
  expect_failure("bench state --case cantilever", 2, "unknown case \"cantilever\"");
  expect_failure("bench state --large", 2, "--large belongs to kerf bench map and limit");
  expect_failure("bench map --case cook-stress", 2, "unknown case \"cook-stress\"");
  expect_failure("bench map --quick --peers nowhere", 5, "nowhere holds no peer scripts (slit.idp");
  expect_failure("bench state --seconds 0", 2, "--seconds");
  expect_failure("bench state --quick --case smooth --peers nowhere", 5, "nowhere holds no peer scripts");
  EXPECT_FALSE(fs::exists(folder / "out" / "bench_state" / "state.json"));
}

TEST_F(Cli, BenchKeepsOldResultsUnlessForced) {
  const std::string command = "bench state --quick --case smooth --case open-crack --quiet -o b";
  EXPECT_EQ(kerf(command).code, 0);
  EXPECT_TRUE(fs::exists(folder / "b" / "state.json"));
  EXPECT_TRUE(fs::exists(folder / "b" / "error_time_smooth_nu0.3.png"));
  EXPECT_TRUE(fs::exists(folder / "b" / "error_time_open-crack_nu0.3.png"));
  expect_failure(command, 5, "--force");
  EXPECT_EQ(kerf(command + " --force").code, 0);
}

struct Broken {
  const char* name;
  const char* added;  // to the square; empty when `from` is replaced
  const char* from;   // first occurrence in the square ...
  const char* to;     // ... becomes this
  int code;
  const char* words;
};
void PrintTo(const Broken& b, std::ostream* out) {
  *out << b.name;
}

class BrokenCase : public Cli, public testing::WithParamInterface<Broken> {};

TEST_P(BrokenCase, EndsWithOneMessage) {
  const Broken& p = GetParam();
  std::string text = square + p.added;
  if (*p.from) {
    const std::size_t at = text.find(p.from);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, std::string(p.from).size(), p.to);
  }
  write("b.toml", text);
  expect_failure("run b.toml", p.code, p.words);
  if (p.code == 3) {
    EXPECT_FALSE(fs::exists(folder / "out/b/result.json"));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cli, BrokenCase,
    testing::Values(
        Broken{"syntax", "[mesh", "", "", 2, "b.toml:16:6: a header ends with its bracket"},
        Broken{"duplicate", "traction = [0, 1]", "", "", 2, "b.toml:16:"},
        Broken{"unknown_key", "", "young", "youg", 2,
               "b.toml:6:1: unknown key \"youg\" in [material]; did you mean \"young\"?"},
        Broken{"type", "", "100", "\"100\"", 2, "b.toml:6:9: young in [material] must be a number"},
        Broken{"range", "", "0.3", "0.7", 2, "b.toml:7:11: poisson in [material] must be above -1 and at most 0.5"},
        Broken{"missing", "", "young = 100", "", 2, "b.toml:5:1: missing key \"young\" in [material]"},
        Broken{"label", "", "on = \"top\"", "on = \"tpo\"", 2, "b.toml:14:6: on in [[boundary]]: there is no label"},
        Broken{"expression", "", "[0, 1]\n", "[0, \"1 + z\"]\n", 2, "unknown name \"z\""},
        Broken{"not_finite", "", "traction = [0, 1]", "traction = [0, \"log(x - 2)\"]", 2, "is not finite"},
        Broken{"no_design", "[optimize]\nmethod = \"mma\"", "", "", 2, "b.toml:16:1: [optimize] needs [functional]"},
        Broken{"validate", "[validate]\npoints = [[0, 0]]", "", "", 2,
               "b.toml:16:1: missing key \"radii\" in [validate]"},
        Broken{"conflict", "[[boundary]]\non = \"top\"\ntraction = [0, 1]", "", "", 2, "b.toml:18:12: label \"top\""},
        Broken{"crossing_outline", "", "[1, 0], [1, 1]", "[1, 1], [1, 0]", 3, "outline"},
        Broken{"crack_outside", "[[crack]]\nname = \"c\"\npath = [[0.5, 0.5], [2, 0.5]]", "", "", 3, "crack 'c'"},
        Broken{"hole_outside", "[[hole]]\nname = \"h\"\ncircle = { center = [1, 1], radius = 0.1 }", "", "", 3, "'h'"},
        Broken{"too_fine", "", "size = 0.2", "size = 1e-9", 3, "mesh.size"},
        Broken{"not_supported_body", "", "displacement = [0, 0]", "traction = [0, 0]", 4, "translation"},
        Broken{"piece_cut_off", "[[crack]]\nname = \"c\"\npath = [[0, 0.5], [1, 0.5]]", "", "", 4,
               "contact does not hold the body"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_F(Cli, FilesThatCannotBeRead) {
  expect_failure("run missing.toml", 5, "missing.toml: no such file");
  expect_failure("run .", 5, "is a directory");
  expect_failure("check /dev/null", 5, "is not a regular file");
  write("c.toml", square + "[[probe]]\nname = \"p\"\nfile = \"p.csv\"\n");
  expect_failure("run c.toml", 5, "c.toml:18:8: file in [[probe]]: p.csv: no such file");
}

TEST_F(Cli, FoldersThatCannotBeWritten) {
  write("file", "");
  expect_failure("run a.toml -o file", 5, "file is not a folder");
  expect_failure("run a.toml -o file/below", 5, "file/below");
}

TEST_F(Cli, RunWritesItsResults) {
  const Outcome o = kerf("run a.toml");
  ASSERT_EQ(o.code, 0) << o.error;
  EXPECT_NE(o.out.find("Square"), std::string::npos);
  EXPECT_NE(o.out.find("results in out/a\n"), std::string::npos);
  EXPECT_NE(o.error.find("mesh"), std::string::npos);  // the log
  const auto result = nlohmann::json::parse(read_all(folder / "out/a/result.json"));
  EXPECT_EQ(result.at("schema"), 1);
  EXPECT_EQ(result.at("case"), "a");
  EXPECT_EQ(result.at("status"), "ok");
  EXPECT_FALSE(result.contains("contact"));
  EXPECT_FALSE(result.contains("map"));
  EXPECT_TRUE(fs::exists(folder / "out/a/state.vtu"));
  EXPECT_TRUE(fs::exists(folder / "out/a/report.html"));
}

TEST_F(Cli, QuietSaysNothing) {
  const Outcome o = kerf("solve a.toml --quiet");
  EXPECT_EQ(o.code, 0);
  EXPECT_EQ(o.out, "");
  EXPECT_EQ(o.error, "");
}

TEST_F(Cli, OldResultsAreKeptUnlessForced) {
  ASSERT_EQ(kerf("solve a.toml -o r --quiet").code, 0);
  const std::string old = read_all(folder / "r/result.json");
  expect_failure("run a.toml -o r", 5, "r already holds results; use --force to overwrite");
  EXPECT_EQ(read_all(folder / "r/result.json"), old);
  ASSERT_EQ(kerf("solve a.toml -o r --quiet --force --set mesh.size=0.5").code, 0);
  EXPECT_NE(read_all(folder / "r/result.json"), old);
  // With --force an old result goes away even if the new run fails before it has one.
  expect_failure("run a.toml -o r --force --set mesh.size=1e-9", 3, "mesh.size");
  EXPECT_FALSE(fs::exists(folder / "r/result.json"));
}

TEST_F(Cli, SetChangesTheCase) {
  const auto triangles = [&](const std::string& arguments) {
    EXPECT_EQ(kerf("solve a.toml --quiet --force -o r " + arguments).code, 0) << arguments;
    return nlohmann::json::parse(read_all(folder / "r/result.json")).at("mesh").at("triangles").get<int>();
  };
  EXPECT_GT(triangles("--set mesh.size=0.1"), 2 * triangles(""));
  EXPECT_EQ(triangles("--set mesh.size=0.1 --set mesh.size=0.2"), triangles(""));
  EXPECT_GT(triangles("--set 'domain.outline=[[0, 0], [3, 0], [3, 1], [0, 1]]' --threads 2"), 2 * triangles(""));
}

TEST_F(Cli, CheckSolvesNothing) {
  write("c.toml", square +
                      "[[crack]]\nname = \"c\"\npath = [[0, 0.5], [0.5, 0.5]]\n"
                      "[[probe]]\nname = \"p\"\npoints = [[0.2, 0.2], [3, 3]]\n");
  const Outcome o = kerf("check c.toml");
  EXPECT_EQ(o.code, 0);
  EXPECT_EQ(o.error, "");
  EXPECT_FALSE(fs::exists(folder / "out/c/result.json"));
  EXPECT_TRUE(fs::exists(folder / "out/c/check.png"));
  EXPECT_NE(o.out.find("picture in out/c/check.png"), std::string::npos);
  EXPECT_EQ(kerf("check c.toml -o none --set output.png=false").code, 0);
  EXPECT_FALSE(fs::exists(folder / "none"));
  for (const char* words : {"Square", "(0, 0) to (1, 1), area 1, 0 holes", "c: unilateral, length 0.5",
                            "(0, 0.5) on left to (0.5, 0.5) interior", "displacement", "traction", "free",
                            "probe \"p\": 1 of 2 points lie outside the body, the first at ("})
    EXPECT_NE(o.out.find(words), std::string::npos) << words << "\n" << o.out;
}

TEST_F(Cli, CheckNamesEveryCondition) {
  write("c.toml", square +
                      "[[boundary]]\non = \"left\"\ndisplacement_x = 0\ntraction = [0, 1]\n"
                      "[[boundary]]\non = \"right\"\ndisplacement_normal = 0\n");
  const Outcome o = kerf("check c.toml");
  EXPECT_NE(o.out.find("roller in x + traction\n"), std::string::npos) << o.out;
  EXPECT_NE(o.out.find("roller, normal\n"), std::string::npos) << o.out;
}

TEST_F(Cli, RegionsAreCheckedAndWritten) {
  const std::string region =
      "[[region]]\nname = \"stiff\"\npolygon = [[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]]\n"
      "young = 10\npoisson = 0.2\n";
  write("c.toml", square + region);
  const Outcome o = kerf("check c.toml");
  EXPECT_NE(o.out.find("region    stiff: young 10, poisson 0.2, area 0.04, "), std::string::npos) << o.out;
  EXPECT_EQ(kerf("solve c.toml --quiet -o r").code, 0);
  EXPECT_NE(read_all(folder / "r/state.vtu").find("Name=\"region\""), std::string::npos);
  EXPECT_EQ(kerf("solve a.toml --quiet -o s").code, 0);
  EXPECT_EQ(read_all(folder / "s/state.vtu").find("Name=\"region\""), std::string::npos);
  write("d.toml", square + region + "[[crack]]\nname = \"c\"\npath = [[0.2, 0.5], [0.5, 0.5]]\n");
  EXPECT_EQ(kerf("solve d.toml --quiet -o d").code, 0);  // a crack may cross a border
}

TEST_F(Cli, FirstInterruptStopsCleanly) {
  // Seconds of work: the signal comes when its log shows that the first phase has begun.
  const Outcome o = stopped({"solve", "a.toml", "--set", "mesh.size=0.006"}, SIGINT,
                            [this] { return text("stderr").find("mesh") != std::string::npos; });
  EXPECT_EQ(o.code, 4) << o.error;
  EXPECT_NE(o.error.find("kerf: stopped"), std::string::npos) << o.error;
  EXPECT_FALSE(fs::exists(folder / "out/a/result.json"));
}

TEST_F(Cli, UnitsAreSaidEverywhere) {
  write("u.toml", "[units]\nlength = \"mm\"\nstress = \"MPa\"\n" + square.substr(square.find("[domain]")) +
                      "[output]\nvtk = false\n");
  const Outcome o = kerf("run u.toml -o u");
  EXPECT_EQ(o.code, 0) << o.error;
  for (const char* words : {"units       mm and MPa", " N/mm", " mm²", "max von Mises stress", " MPa at ",
                            "young = 100 MPa is that of soft plastics or rubber; steel has 2.1e+05 MPa"})
    EXPECT_NE(o.out.find(words), std::string::npos) << words << "\n" << o.out;
  const std::string json = read_all(folder / "u" / "result.json"), page = read_all(folder / "u" / "report.html");
  for (const char* words : {"\"length\": \"mm\"", "\"force_per_thickness\": \"N/mm\"", "\"K\": \"MPa √mm\"",
                            "\"functional\": \"N mm/mm\"", "\"topological_derivative\": \"MPa\""})
    EXPECT_NE(json.find(words), std::string::npos) << words << "\n" << json;
  EXPECT_NE(page.find(" N mm/mm"), std::string::npos);
  const Outcome plate = kerf("solve u.toml -o p --set 'material.state=\"plane stress\"' --set material.thickness=5");
  EXPECT_NE(plate.out.find("plate       thickness 5 mm"), std::string::npos) << plate.out << plate.error;
  EXPECT_NE(plate.out.find("force (0, 5) N\n"), std::string::npos) << plate.out;
  expect_failure("check u.toml --set material.thickness=5", 2, "plane stress");
  expect_failure("check u.toml --set units.stress='\"MPA\"'", 2, "\"MPa\"");
  expect_failure("check a.toml --set units.length='\"mm\"'", 2, "stress");
}

TEST_F(Cli, ReportMakesThePageAgain) {
  EXPECT_EQ(kerf("solve a.toml -o out --set output.vtk=false").code, 0);
  const std::string before = read_all(folder / "out/report.html");
  fs::remove(folder / "out/report.html");
  const Outcome o = kerf("report out");
  EXPECT_EQ(o.code, 0) << o.error;
  EXPECT_EQ(o.out, "wrote out/report.html\n");
  const std::string again = read_all(folder / "out/report.html");
  const std::size_t end = before.find("<div class=\"key\">");  // then comes the time
  EXPECT_EQ(again.substr(0, end), before.substr(0, end));
  EXPECT_NE(again.find("data-array=\"von_mises\""), std::string::npos);
  EXPECT_EQ(kerf("report out --quiet").out, "");
  EXPECT_EQ(read_all(folder / "out/report.html"), again) << "the same files, the same bytes";
  fs::remove(folder / "out/report.bin");
  EXPECT_EQ(kerf("report out").code, 0) << "without what is drawn: the words and the tables";
  EXPECT_EQ(read_all(folder / "out/report.html").find("data-array=\"von_mises\""), std::string::npos);
  expect_failure("report nowhere", 5, "nowhere is no folder");
  expect_failure("report .", 5, "holds no result.json");
  std::ofstream(folder / "out/result.json") << "{";
  expect_failure("report out", 5, "result.json is damaged");
}

TEST_F(Cli, AStopInAValidationLeavesTheStateAndWhatWasValidated) {
  const Outcome o = stopped({"run", "a.toml", "--set", "mesh.size=0.012", "--set", "output.png=false", "--set",
                             "validate={points=[[0.3,0.5],[0.7,0.5]],radii=[0.04,0.02,0.01,0.005]}"},
                            SIGINT, [this] { return text("stderr").find("validate") != std::string::npos; });
  EXPECT_EQ(o.code, 4) << o.error;
  EXPECT_NE(o.error.find("kerf: stopped in "), std::string::npos) << o.error;
  EXPECT_NE(o.error.find("what was done before is in out/a"), std::string::npos) << o.error;
  EXPECT_FALSE(fs::exists(folder / "out/a/result.json"));
  for (const char* left : {"case.toml", "state.vtu"}) EXPECT_TRUE(fs::exists(folder / "out/a" / left)) << left;
}

TEST_F(Cli, SaysBeforehandWhatARunTakesAndRefusesWhatIsTooMuch) {
  const std::string run = "solve a.toml --set mesh.size=0.03 -o r ";
  const Outcome told = kerf(run + "--dry-run");
  EXPECT_EQ(told.code, 0) << told.error;
  EXPECT_FALSE(fs::exists(folder / "r"));
  // Not so short that a busy machine needs it to read the case; the run would take a minute.
  for (const std::string limit : {"--max-memory 20MB", "--set mesh.size=0.002 --max-seconds 5"}) {
    const Outcome o = kerf(run + limit + " --log-level off");
    EXPECT_EQ(o.code, 4) << o.error;
    EXPECT_NE(o.error.find("allowed: "), std::string::npos) << o.error;
    EXPECT_NE(o.error.find("mesh.size = 0."), std::string::npos) << o.error;
    EXPECT_FALSE(fs::exists(folder / "r"));
  }
  expect_failure(run + "--max-memory 20", 2, "write a number with its unit");
  EXPECT_EQ(kerf(run + "--max-memory 1GB --max-seconds 1000 --quiet").code, 0);
  const auto result = nlohmann::json::parse(read_all(folder / "r/result.json"));
  EXPECT_EQ(told.out.find(std::to_string(result["mesh"]["triangles"].get<int>()) + " triangles, "), 0u) << told.out;
  const double said = std::stod(told.out.substr(told.out.find(", ") + 2)), peak = result["peak_memory_mb"];
  EXPECT_LT(said, 1.5 * peak);
  EXPECT_GT(said, peak / 1.5);
}

TEST_F(Cli, AStoppedForecastLeavesNothingBehind) {
  fs::create_directory(folder / "scratch");
  setenv("TMPDIR", (folder / "scratch").c_str(), 1);
  const Outcome o = stopped({"run", "a.toml", "--dry-run", "--set", "mesh.size=0.004", "--set",
                             "validate={points=[[0.3,0.5],[0.7,0.5]],radii=[0.04,0.02,0.01,0.005]}"},
                            SIGTERM, [this] { return !fs::is_empty(folder / "scratch"); });
  unsetenv("TMPDIR");
  EXPECT_EQ(o.code, 4) << o.error;
  EXPECT_NE(o.error.find("kerf: stopped before it was known what the run takes"), std::string::npos) << o.error;
  EXPECT_TRUE(fs::is_empty(folder / "scratch"));
}

TEST_F(Cli, GoesWithoutTheModuleOfVtkUnlessItIsAskedFor) {
  fs::create_directory(folder / "bin");
  fs::copy_file(KERF_PROGRAM, folder / "bin/kerf");
  const Outcome o = shell("bin/kerf solve a.toml");
  EXPECT_EQ(o.code, 0) << o.error;
  EXPECT_NE(o.out.find("no files for ParaView: cannot load the VTK module"), std::string::npos) << o.out;
  EXPECT_FALSE(fs::exists(folder / "out/a/state.vtu"));
  EXPECT_TRUE(fs::exists(folder / "out/a/mesh.png"));
  EXPECT_EQ(shell("bin/kerf solve a.toml -o asked --set output.vtk=true").code, 5);
}

TEST_F(Cli, FullDiskOfStandardOutputIsReported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP();
  const Outcome o = kerf("check a.toml >/dev/full");
  EXPECT_EQ(o.code, 5);
  EXPECT_EQ(o.error, "kerf: cannot write to standard output\n");
}

}  // namespace
}  // namespace kerf::cli_test
