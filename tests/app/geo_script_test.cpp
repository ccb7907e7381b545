// A geometry of gmsh is a program. From a stranger it may draw, but not start programs or write files.

#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace kerf::geo_script_test {

namespace {

namespace fs = std::filesystem;

class GeoScript : public kerf::test::InFolder {
 protected:
  void SetUp() override {
#ifndef KERF_WITH_GMSH
    GTEST_SKIP() << "built without gmsh";
#endif
    fs::create_directory(folder / "home");
    fs::create_directory(folder / "tmp");
    std::ofstream(folder / "a.toml") << R"([domain]
file = "a.geo"
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "left"
displacement = [0, 0]
[mesh]
size = 0.5
mesher = "gmsh"
[output]
png = false
)";
  }
  /// kerf check of a square with these lines of script, started by `by`; true when it went through.
  bool check(const std::string& script, const std::string& by = "") const {
    std::ofstream(folder / "a.geo") << "lc = 0.5;\nPoint(1) = {0, 0, 0, lc}; Point(2) = {1, 0, 0, lc};\n"
                                       "Point(3) = {1, 1, 0, lc}; Point(4) = {0, 1, 0, lc};\n"
                                       "Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};\n"
                                       "Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};\n"
                                       "Physical Curve(\"left\") = {4}; Physical Surface(\"body\") = {1};\n"
                                    << script;
    const std::string command = "cd '" + folder.string() + "' && HOME='" + (folder / "home").string() + "' TMPDIR='" +
                                (folder / "tmp").string() + "' " + by +
                                " '" KERF_PROGRAM "' check a.toml -o out >out.txt 2>&1";
    return std::system(command.c_str()) == 0;
  }
  void expect_nothing_written(const std::string& script) const {
    check(script);
    EXPECT_FALSE(fs::exists(folder / "written")) << script;
    EXPECT_TRUE(fs::exists(folder / "kept")) << script;
    EXPECT_TRUE(fs::is_empty(folder / "home")) << script;
    EXPECT_TRUE(fs::is_empty(folder / "tmp")) << script;
  }
};

// While it makes the mesh gmsh writes what it did into the folder where one stands, under names that a script knows.
TEST_F(GeoScript, LeavesNothingOfTheMesher) {
  for (const char* script :
       {"Recombine Surface{1}; General.Verbosity = 99;\n", "Mesh.Algorithm = 8; Recombine Surface{1};\n",
        "Mesh.Algorithm = 9; Recombine Surface{1}; General.Verbosity = 99;\n", "Mesh.SaveParametric = 1;\n"}) {
    std::ofstream(folder / "kept") << "kept";
    for (const char* name : {"recombine_0before.msh", "recombine_1raw.msh", "bgm-1.pos", "cross-1.pos"})
      if (!fs::is_symlink(folder / name)) fs::create_symlink("kept", folder / name);
    const auto count = [&] { return std::distance(fs::directory_iterator(folder), {}); };
    check(script);
    const auto before = count();
    check(script);
    EXPECT_EQ(count(), before) << script;
    EXPECT_EQ(fs::file_size(folder / "kept"), 4u) << script;
    EXPECT_TRUE(fs::is_empty(folder / "tmp")) << script;
  }
}

// Ended while gmsh draws, by a signal that nothing answers before a run has begun.
TEST_F(GeoScript, LeavesNoFileWhenItIsEnded) {
  for (const char* signal : {"TERM", "INT", "HUP"}) {
    EXPECT_FALSE(check("For i In {1:1000000000}\n x = i;\nEndFor\n", "timeout -s " + std::string(signal) + " 1"));
    EXPECT_TRUE(fs::is_empty(folder / "tmp")) << signal;
  }
}

TEST_F(GeoScript, DrawsButStartsNoProgramsAndWritesNoFiles) {
  ASSERT_TRUE(check(""));
  std::ofstream(folder / "kept") << "kept";
  const std::string touch = "touch " + (folder / "written").string();
  for (const std::string& script : {
           "SystemCall \"" + touch + "\";\n",
           "NonBlockingSystemCall \"" + touch + "\";\n",
           "Field[1] = ExternalProcess;\nField[1].CommandLine = \"" + touch + "\";\nBackground Field = 1;\n",
           std::string("OnelabRun(\"x\", \"") + touch + "\");\n",
           std::string("Printf(\"x\") > \"written\";\n"),
           std::string("Printf(\"x\") >> \"written\";\n"),
           std::string("Save \"written\";\n"),
           std::string("Print \"written\";\n"),
           std::string("Mesh 2;\nSave \"written.msh\";\nCreateDir \"written\";\n"),
           std::string("General.SaveOptions = 1;\nGeneral.SaveSession = 1;\n"),
       })
    expect_nothing_written(script);
  EXPECT_TRUE(check("Printf(\"it still draws\");\n"));
}

}  // namespace
}  // namespace kerf::geo_script_test
