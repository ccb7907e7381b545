// Edge cracks, from the case file to what kerf says and writes.

#include "app/run.hpp"
#include "io/read_result.hpp"
#include "tests/io/case/case_files.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace kerf::edge_cracks_run_test {
namespace {

const std::string plate = R"([domain]
outline = [[-10, -10], [10, -10], [10, 10], [-10, 10]]
sides = ["bottom", "right", "top", "left"]
[[hole]]
name = "h"
circle = { center = [0, 0], radius = 1 }
[material]
young = 1000
poisson = 0.3
[[boundary]]
on = "top"
traction = [0, 1]
[[boundary]]
on = "bottom"
displacement_y = 0
[mesh]
size = 2
[output]
vtk = false
margins = false
)";
const std::string map = "[map]\nperturbation = \"edge_crack\"\nlength = 0.05\n";
const std::string inspection = "[inspect]\nlaw = { kind = \"paris\", C = 1e-9, m = 3, K_c = 1.5 }\nfactor = 3\n";

std::string refusal(const std::string& more) {
  const TemporaryFolder folder;
  try {
    run(read_case(folder.write("a.toml", plate + more)), Job::Map, {.folder = folder.path / "out", .threads = 1});
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

std::string bytes(const std::filesystem::path& path) {
  return (std::ostringstream() << std::ifstream(path).rdbuf()).str();
}

TEST(EdgeCracksRun, FilesAndResultsThereAndBack) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path / "out";
  const Result r =
      run(read_case(folder.write("a.toml", plate + map + inspection + "[validate]\nradii = [0.1, 0.05]\n")), Job::Run,
          {.folder = out, .threads = 1});
  ASSERT_TRUE(r.edge_cracks);
  EXPECT_FALSE(r.map);
  EXPECT_FALSE(r.validate);
  const EdgeCrackResult& e = *r.edge_cracks;
  ASSERT_GE(e.worst.size(), 2u);
  EXPECT_LE(e.worst.size(), 10u);
  for (std::size_t i = 0; i < 2; ++i) {  // the sides of the hole
    EXPECT_NEAR(std::abs(e.worst[i].crack.at.x()), 1, 0.02);
    EXPECT_NEAR(e.worst[i].crack.K, 3.037 * std::sqrt(pi * 0.05), 0.05);
    EXPECT_EQ(e.worst[i].tolerance.how, inspect::Tolerated::Critical);
  }
  ASSERT_TRUE(e.safe);
  EXPECT_NEAR(e.safe->value, e.worst[0].tolerance.critical_length, 0.01);
  ASSERT_GE(e.drawn.size(), 2u);
  EXPECT_EQ(e.drawn[0].verdict, Verdict::Holds) << e.drawn[0].reason;
  const Result again = read_result(out);
  ASSERT_TRUE(again.edge_cracks);
  ASSERT_EQ(again.edge_cracks->worst.size(), e.worst.size());
  EXPECT_EQ(again.edge_cracks->worst[1].crack.K, e.worst[1].crack.K);
  EXPECT_EQ(again.edge_cracks->worst[1].tolerance.cycles, e.worst[1].tolerance.cycles);
  EXPECT_EQ(again.edge_cracks->drawn[0].rows[1].K_I, e.drawn[0].rows[1].K_I);
  EXPECT_EQ(again.edge_cracks->drawn[0].verdict, e.drawn[0].verdict);
  EXPECT_EQ(summary(again), summary(r));
  const std::string csv = bytes(out / "edge_cracks.csv");
  EXPECT_EQ(std::ranges::count(csv, '\n'), e.places + 1);
  EXPECT_EQ(csv.substr(0, 24), "x,y,direction,angle,K,K_");
  EXPECT_NE(csv.find("support"), std::string::npos);
  EXPECT_NE(bytes(out / "drawn_edge_cracks.csv").find("holds"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(out / "edge_cracks.png"));
  EXPECT_NE(bytes(out / "report.html").find("<h2>Edge cracks</h2>"), std::string::npos);
  EXPECT_NE(summary(r).find("edge cracks of length 0.05"), std::string::npos) << summary(r);
  // Inside the body K is that of half the length.
  ASSERT_FALSE(e.inside.empty());
  EXPECT_NEAR(e.inside[0].K, std::sqrt(pi * 0.025) * 2.5, std::sqrt(pi * 0.025));
  ASSERT_EQ(again.edge_cracks->inside.size(), e.inside.size());
  EXPECT_EQ(again.edge_cracks->inside[0].K, e.inside[0].K);
  EXPECT_EQ(again.edge_cracks->masked_by, e.masked_by);
  const std::string page = bytes(out / "inspect.html");
  for (const char* words : {"damage tolerance", "= &quot;paris&quot;", "Not covered", "data:image/png;base64,",
                            "inspect every", "support "})
    EXPECT_NE(page.find(words), std::string::npos) << words;
  EXPECT_EQ(page.find("<script"), std::string::npos);
}

// The rim of a hole that an optimization draws has a label for cracks on it.
TEST(EdgeCracksRun, MakesAHoleBetterForTheWorstCrack) {
  const TemporaryFolder folder;
  const std::string body = plate.substr(0, plate.find("[[hole]]")) + plate.substr(plate.find("[material]"));
  const Result r = run(read_case(folder.write("a.toml", body + R"([functional]
kind = "worst_edge_crack"
on = "hole:h"
length = 0.1
p = 8
[optimize]
method = "mma"
volume = { at_most = 0.99 }
max_iterations = 4
[[optimize.hole]]
name = "h"
ellipse = { center = [0, 0], semi_axes = [[0.7, 2], [0.7, 2]] }
start = { semi_axes = [1.3, 1.3] }
)")),
                       Job::Optimize, {.folder = folder.path / "out", .threads = 1});
  ASSERT_TRUE(r.optimize);
  ASSERT_TRUE(r.functional);
  EXPECT_EQ(r.functional->kind, "worst_edge_crack");
  // An ellipse along the pull bears it better than a circle.
  EXPECT_LT(r.functional->value, 0.9 * 3 * 1.12 * std::sqrt(pi * 0.1));
}

TEST(EdgeCracksRun, PointsAndAnglesAreThoseAskedFor) {
  const TemporaryFolder folder;
  const Result r =
      run(read_case(folder.write("a.toml", plate + map + "angle = 60\nfriction = 0.2\npoints = [[10, 3], [0, 1]]\n")),
          Job::Map, {.folder = folder.path / "out", .threads = 1});
  ASSERT_TRUE(r.edge_cracks);
  ASSERT_EQ(r.edge_cracks->worst.size(), 2u);
  const inspect::EdgeCrack &side = r.edge_cracks->worst[0].crack, &top = r.edge_cracks->worst[1].crack;
  EXPECT_NEAR(side.at.x(), 10, 1e-9);
  EXPECT_NEAR(side.K_I, 0.920100 * std::sqrt(pi * 0.05), 0.02);
  EXPECT_NEAR(side.angle, pi / 3, 1e-12);
  EXPECT_TRUE(top.closed);
}

TEST(EdgeCracksRun, RefusalsNameWhatIsWrong) {
  EXPECT_NE(refusal("[map]\nperturbation = \"edge_crack\"\n").find("length"), std::string::npos);
  EXPECT_NE(refusal(map + "radius = 0.1\n").find("whose size is length"), std::string::npos);
  EXPECT_NE(refusal(map + "angle = 10\n").find("angle in [map]"), std::string::npos);
  EXPECT_NE(refusal(map + "angle = \"steep\"\n").find("\"worst\" or degrees"), std::string::npos);
  EXPECT_NE(refusal(map + "friction = -1\n").find("friction"), std::string::npos);
  EXPECT_NE(refusal("[map]\nlength = 0.1\n").find("goes with perturbation"), std::string::npos);
  EXPECT_NE(refusal("[map]\nperturbation = \"edge_crack\"\nlength = 50\n").find("smaller than the body"),
            std::string::npos);
  EXPECT_NE(refusal(inspection).find("[inspect] goes with"), std::string::npos);
  EXPECT_NE(refusal(map + "[inspect]\nfactor = 2\n").find("law"), std::string::npos);
  EXPECT_NE(refusal(map + "[inspect]\nlaw = { kind = \"paris\", C = 1, m = 3 }\ncycle = { min = 2 }\n")
                .find("min must be below"),
            std::string::npos);
}

}  // namespace
}  // namespace kerf::edge_cracks_run_test
