// gmsh in a process of its own that ends in other ways than it should, and curves that are hard to draw.

#include "io/mesh_source.hpp"
#include "tests/io/case/case_files.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <set>
#include <thread>

namespace kerf::geometry_ending_test {
namespace {

class GeometryEnding : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_gmsh()) GTEST_SKIP() << "built without gmsh";
  }
  MeshFile outline(const std::string& text) const {
    return read_body({.path = folder.write("a.geo", text), .keep_mesh = false}, {});
  }
  /// What is said of this script, without the path.
  std::string complaint(const std::string& text, Fault fault = Fault::Geometry) const {
    try {
      outline(text);
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, fault) << e.what();
      const std::string message = e.what(), path = (folder.path / "a.geo").string();
      return message.starts_with(path) ? message.substr(path.size()) : message;
    }
    return "no complaint";
  }
  TemporaryFolder folder;
};

const std::string endless = "For i In {1:1000000000}\n x = i;\nEndFor\n";
const std::string unit_square =
    "SetFactory(\"OpenCASCADE\"); Rectangle(1) = {0, 0, 0, 1, 1}; Physical Curve(\"rim\") = {1, 2, 3, 4};\n";

/// Ends the processes that this thread starts, with a signal.
class Ender {
 public:
  explicit Ender(int signal)
      : thread_([this, signal] {
          while (!stop_) {
            std::ifstream children(fmt::format("/proc/self/task/{0}/children", own_));
            for (pid_t child = 0; children >> child;) {
              ended_.insert(child);
              kill(child, signal);  // again, should it come before the child can take it
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
          }
        }) {}
  ~Ender() {
    stop();
  }
  /// How many there were.
  std::size_t stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    return ended_.size();
  }

 private:
  const pid_t own_ = gettid();
  std::set<pid_t> ended_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

// Finer chords may help where gmsh fails, and do not where it never ends.
TEST_F(GeometryEnding, SignalsAreTold) {
  for (const auto& [signal, says, tries] : {std::tuple(SIGALRM, ": gmsh: it did not end within 5 minutes", 1u),
                                            std::tuple(SIGKILL, ": gmsh: it crashed (signal 9)", 3u)}) {
    Ender ender(signal);
    EXPECT_EQ(complaint(endless), says);
    EXPECT_EQ(ender.stop(), tries);
  }
}

// A script may end gmsh before there is any mesh.
TEST_F(GeometryEnding, ScriptsThatEndGmshAreTold) {
  EXPECT_EQ(complaint("Exit;\n"), ": gmsh: it ended early");
  EXPECT_EQ(complaint(unit_square + "Exit;\n"), ": gmsh: it ended early");
}

TEST_F(GeometryEnding, TemporaryFilesNeedAFolder) {
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before ? before : "";
  std::vector<std::string> said;
  for (const char* place : {"/nowhere", "/proc"}) {
    setenv("TMPDIR", place, 1);
    said.push_back(complaint(unit_square, Fault::Files));
  }
  before ? setenv("TMPDIR", kept.c_str(), 1) : unsetenv("TMPDIR");
  for (const std::string& message : said)
    EXPECT_EQ(message,
              "cannot make a temporary file: No such file or directory; set TMPDIR to a folder that exists and may be "
              "written to");
  EXPECT_EQ(complaint(unit_square), "no complaint");
}

// gmsh does not look whether its file was written: as on a full disk.
TEST_F(GeometryEnding, StepFilesThatCannotBeWritten) {
  Shape shape;
  shape.labels = {"rim"};
  shape.outline = polygon("outline", {{0, 0}, {1, 0}, {0, 1}}, 0);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  for (const rlim_t most : {rlim_t{0}, rlim_t{2000}}) {
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{most, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    std::string said = "nothing";
    try {
      (void)step_file(shape);
    } catch (const Error& e) {
      said = e.what();
    }
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(said.find("no STEP file: gmsh"), 0u) << said;
  }
  EXPECT_NE(step_file(shape).find("END-ISO-10303-21"), std::string::npos);
}

// Three quarters of a circle are several arcs of one radius, whichever way the curve runs.
TEST_F(GeometryEnding, LongArcsComeInPieces) {
  for (const char* loop : {"{1, 2, 3}", "{-3, -2, -1}"}) {
    const MeshFile body = outline(
        "SetFactory(\"OpenCASCADE\"); Circle(1) = {0, 0, 0, 1, 0, 3 * Pi / 2};\nPoint(9) = {0, 0, 0}; Line(2) = {2, "
        "9}; "
        "Line(3) = {9, 1};\nCurve Loop(1) = " +
        std::string(loop) + "; Plane Surface(1) = {1}; Physical Curve(\"arc\") = {1};\n");
    EXPECT_NEAR(area(body.shape), 0.75 * pi, 1e-12);
    int arcs = 0;
    for (const Side& side : body.shape.outline.sides) {
      if (!side.arc) continue;
      ++arcs;
      EXPECT_NEAR(side.arc->axes.col(0).norm(), 1, 1e-12);
      EXPECT_LE(std::abs(side.arc->to - side.arc->from), 2 * pi / 3 + 1e-9);
    }
    EXPECT_EQ(arcs, 3);
  }
}

// Of a curve that is followed against its own direction.
TEST_F(GeometryEnding, SplinesRunEitherWay) {
  for (const char* loop : {"{1, 2}", "{-1, -2}"}) {
    const MeshFile body = outline(
        "Point(1) = {0, 0, 0}; Point(2) = {0, -1, 0}; Point(3) = {1, -2, 0}; Point(4) = {1, 0, 0};\n"
        "Bezier(1) = {1, 2, 3, 4}; Line(2) = {4, 1};\nCurve Loop(1) = " +
        std::string(loop) + "; Plane Surface(1) = {1}; Physical Curve(\"arc\") = {1};\n");
    EXPECT_NEAR(area(body.shape), 0.3 * (1 + 2), 1e-4) << loop;
  }
}

// A crack along an arc and a spline: its points lie on both curves.
TEST_F(GeometryEnding, CracksAlongSeveralCurves) {
  const MeshFile body = outline(
      "SetFactory(\"OpenCASCADE\"); Rectangle(1) = {-3, -3, 0, 6, 6};\n"
      "Point(11) = {1, 0, 0}; Point(12) = {0, 0, 0}; Point(13) = {0, 1, 0}; Point(14) = {-1, 2, 0}; Point(15) = {-2, "
      "1, 0};\n"
      "Circle(20) = {11, 12, 13}; Bezier(21) = {13, 14, 15}; Curve{20, 21} In Surface{1};\n"
      "Physical Curve(\"rim\") = {1, 2, 3, 4}; Physical Curve(\"crack:c\") = {20, 21};\n");
  ASSERT_EQ(body.shape.cracks.size(), 1u);
  const std::vector<Vec2>& points = body.shape.cracks[0].points;
  EXPECT_FALSE(body.shape.cracks[0].arc);
  EXPECT_GT(points.size(), 10u);
  EXPECT_LT(std::min((points.front() - Vec2(1, 0)).norm(), (points.back() - Vec2(1, 0)).norm()), 1e-12);
  for (const Vec2& x : points) {
    if (x.x() >= 0) {
      EXPECT_NEAR(x.norm(), 1, 1e-9);
      continue;
    }
    const double t = -x.x() / 2;
    EXPECT_NEAR(x.y(), (1 - t) * (1 - t) + 2 * t * (1 - t) * 2 + t * t, 1e-9) << x.transpose();
  }
}

// Regions that are drawn beside those of the file.
TEST_F(GeometryEnding, RegionsMayBeDrawnInto) {
  folder.write("a.geo", unit_square);
  const Case c = read_case(folder.write(
      "a.toml",
      "[domain]\nfile = 'a.geo'\n[material]\nyoung = 1\npoisson = 0.3\n[[region]]\nname = 'disc'\n"
      "circle = { center = [0.5, 0.5], radius = 0.1 }\nyoung = 2\npoisson = 0.25\n[mesh]\nmesher = 'kerf'\n"));
  ASSERT_EQ(c.shape.regions.size(), 1u);
  EXPECT_EQ(c.shape.regions[0].name, "disc");
  EXPECT_EQ(c.regions.at(0).young, 2);
  EXPECT_FALSE(c.mesh);
}

}  // namespace
}  // namespace kerf::geometry_ending_test
