// Geometries through gmsh: outlines that kerf meshes, meshes of gmsh that are kept, designs as STEP. Skipped where the
// module was not built.

#include "io/files.hpp"
#include "io/mesh_source.hpp"
#include "kerf/mesher.hpp"
#include "tests/io/case/case_files.hpp"
#include "tests/io/mesh/meshes.hpp"

#include <cmath>
#include <set>

namespace kerf::geometry_test {
namespace {

class Geometry : public testing::Test {
 protected:
  void SetUp() override {
#ifdef KERF_WITH_GMSH
    ASSERT_TRUE(has_gmsh());
#else
    if (!has_gmsh()) GTEST_SKIP() << "built without gmsh";
#endif
  }
  static std::filesystem::path geometry(const std::string& name) {
    return std::filesystem::path(KERF_TEST_DATA) / "meshes" / name;
  }
  static MeshFile outline(const std::string& name, const MeshFileRequest& request = {}) {
    return read_body({.path = geometry(name), .keep_mesh = false}, request);
  }
  /// What reading a .geo with this text says.
  std::string complaint(const std::string& text) {
    const auto path = folder.write("a.geo", text);
    try {
      read_body({.path = path, .keep_mesh = false}, {});
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Geometry);
      return std::string(e.what()).substr(path.string().size());
    }
    return "no complaint";
  }
  TemporaryFolder folder;
};

TEST_F(Geometry, ArcsOfAGeoStayArcs) {
  const MeshFile body = outline("plate.geo", {.materials = {"stiff"}});
  EXPECT_NEAR(area(body.shape), 8 - pi * 0.09, 1e-13);
  EXPECT_EQ(body.shape.outline.sides.size(), 4u);
  ASSERT_EQ(body.shape.holes.size(), 1u);
  EXPECT_EQ(body.shape.holes[0].sides.size(), 4u);
  for (const Side& side : body.shape.holes[0].sides) {
    ASSERT_TRUE(side.arc);
    EXPECT_LT((side.arc->center - Vec2(1.2, 0.2)).norm(), 1e-13);
    EXPECT_EQ(body.shape.labels[std::size_t(side.label)], "hole:h");
  }
  ASSERT_EQ(body.shape.cracks.size(), 1u);
  EXPECT_LT((body.shape.cracks[0].points[0] - Vec2(-0.8, 0)).norm(), 1e-14);
  EXPECT_EQ(body.shape.regions.size(), 1u);
  EXPECT_EQ(body.material, std::vector<Index>{0});
  EXPECT_EQ(find_problem(body.shape), std::nullopt);
}

TEST_F(Geometry, TheMeshOfGmshIsKeptWhenAskedFor) {
  const MeshFile body = read_body({.path = geometry("plate.geo")}, {.materials = {"stiff"}});
  const MeshFile saved = read_mesh(meshes::file("gmsh41_binary"), {.materials = {"stiff"}});
  EXPECT_EQ(body.mesh.triangles.size(), saved.mesh.triangles.size());
  EXPECT_EQ(body.shape.labels, saved.shape.labels);
  EXPECT_GT(read_body({.path = geometry("plate.geo"), .size = 0.1}, {}).mesh.triangles.size(),
            2 * body.mesh.triangles.size());
}

// A plate 4 x 2 with a round hole (radius 0.4) and an elliptic one (0.5, 0.25).
TEST_F(Geometry, StepAndBrepGetTheirLabelsFromPoints) {
  const MeshFileRequest request{
      .sides = {{{0, 1}, "left", ""}, {{4, 1}, "right", ""}, {{1.4, 1}, "round", ""}, {{3, 1.25}, "oval", ""}}};
  for (const char* name : {"holes.step", "holes.brep"}) {
    SCOPED_TRACE(name);
    const MeshFile body = outline(name, request);
    EXPECT_NEAR(area(body.shape), 8 - pi * 0.16 - pi * 0.125, 1e-4);
    ASSERT_EQ(body.shape.holes.size(), 2u);
    std::set<std::string> labels(body.shape.labels.begin(), body.shape.labels.end());
    EXPECT_EQ(labels, (std::set<std::string>{"left", "right", "round", "oval", "unnamed"}));
    for (const Loop& hole : body.shape.holes)
      for (const Side& side : hole.sides) {
        ASSERT_TRUE(side.arc);
        // On its curve: the ellipse within what the chain may be off.
        for (int k = 0; k <= 10; ++k) {
          const double t = side.arc->from + (side.arc->to - side.arc->from) * k / 10;
          const Vec2 x = side.arc->center + side.arc->axes * Vec2(std::cos(t), std::sin(t));
          if (hole.name == "round") {
            EXPECT_NEAR((x - Vec2(1, 1)).norm(), 0.4, 1e-12);
          } else {
            const Vec2 d((x.x() - 3) / 0.5, (x.y() - 1) / 0.25);
            EXPECT_NEAR(d.norm(), 1, 5e-5 * std::sqrt(20.0) / 0.25);
          }
        }
      }
    EXPECT_EQ(find_problem(body.shape), std::nullopt);
    EXPECT_GT(triangulate(body.shape, {.size = 0.2}).triangles.size(), 100u);
  }
}

TEST_F(Geometry, SplinesBecomeArcsNearThem) {
  // A cubic Bezier curve from (0, 0) to (1, 0): the area below it is 3/10 (y1 + y2) with these control points.
  folder.write("b.geo",
               "Point(1) = {0, 0, 0}; Point(2) = {0, -1, 0}; Point(3) = {1, -1, 0}; Point(4) = {1, 0, 0};\n"
               "Bezier(1) = {1, 2, 3, 4}; Line(2) = {4, 1}; Curve Loop(1) = {1, 2}; Plane Surface(1) = {1};\n"
               "Physical Curve(\"arc\") = {1}; Physical Curve(\"top\") = {2};\n");
  const MeshFile body = read_body({.path = folder.path / "b.geo", .keep_mesh = false}, {});
  EXPECT_NEAR(area(body.shape), 0.6, 5e-5);
  EXPECT_LT(body.shape.outline.sides.size(), 40u);
}

TEST_F(Geometry, ArcsAsCracksKeepTheirNormals) {
  const auto path = folder.write("c.geo",
                                 "SetFactory(\"OpenCASCADE\"); Rectangle(1) = {-2, -2, 0, 4, 4};\n"
                                 "Point(11) = {1, 0, 0}; Point(12) = {0, 0, 0}; Point(13) = {0, 1, 0};\n"
                                 "Circle(20) = {11, 12, 13}; Curve{20} In Surface{1};\n"
                                 "Physical Curve(\"rim\") = {1, 2, 3, 4}; Physical Curve(\"crack:c\") = {20};\n");
  folder.write(
      "c.toml",
      "[domain]\nfile = 'c.geo'\n[[crack]]\nname = 'c'\n[[crack]]\nname = 'drawn'\npath = [[-1, -1], [-1, -0.5]]\n"
      "[material]\nyoung = 1\npoisson = 0.3\n");
  const Case c = read_case(folder.path / "c.toml");
  EXPECT_FALSE(c.mesh);
  ASSERT_EQ(c.shape.cracks.size(), 2u);
  ASSERT_TRUE(c.shape.cracks[0].arc);
  EXPECT_NEAR(path_length(c.shape.cracks[0]), pi / 2, 1e-12);
  ASSERT_TRUE(c.scene.laws[0].normal);
  EXPECT_LT((c.scene.laws[0].normal({2, 0}) - Vec2(1, 0)).norm(), 1e-12);
  EXPECT_EQ(c.shape.cracks[1].name, "drawn");
}

TEST_F(Geometry, RegionsThatTouchAreMeshedByBoth) {
  const auto path =
      folder.write("t.geo",
                   "SetFactory(\"OpenCASCADE\"); Rectangle(1) = {0, 0, 0, 1, 1}; Rectangle(2) = {1, 0, 0, 1, "
                   "1}; Coherence;\nPhysical Surface(\"stiff\") = {2}; Physical Curve(\"left\") = {4};\n");
  const std::string text =
      "[domain]\nfile = 't.geo'\n[[region]]\nname = 'stiff'\nyoung = 2\npoisson = 0.3\n[material]\n"
      "young = 1\npoisson = 0.3\n";
  const Case own = read_case(folder.write("t.toml", text));
  EXPECT_FALSE(own.mesh);
  const Mesh mesh = triangulate(own.shape, own.sizing);
  double stiff = 0;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t)
    if (region_of(mesh, t) == 0) stiff += area(mesh, t);
  EXPECT_NEAR(stiff, 1, 1e-12);
  EXPECT_TRUE(read_case(folder.write("k.toml", text + "[mesh]\nmesher = 'gmsh'\n")).mesh);
}

TEST_F(Geometry, BadGeometriesAreRefusedInGmshsWords) {
  EXPECT_NE(complaint("Point(1) = {0, 0, 0};\nLine(1) = {1, 7};\n").find(": gmsh: "), std::string::npos);
  EXPECT_EQ(complaint("Point(1) = {0, 0, 0};\n"), ": gmsh: it holds no surface; a plane body is one or more faces");
  EXPECT_EQ(complaint("SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 1, 1, 1};\n"),
            ": gmsh: it holds a solid; a plane body is one or more faces in the plane z = 0");
  EXPECT_NE(complaint("SetFactory(\"OpenCASCADE\"); Rectangle(1) = {0, 0, 1, 1, 1};\nPhysical Curve(\"a\") = {1};\n")
                .find("lies out of the plane z = 0"),
            std::string::npos);
  EXPECT_NE(complaint("this is no geometry {").find(": gmsh: "), std::string::npos);
  try {
    read_body({.path = folder.path / "none.step"}, {});
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Files);
  }
}

TEST_F(Geometry, DesignsGoToStepAndComeBack) {
  Shape shape;
  shape.labels = {"rim", "hole:a", "hole:b"};
  shape.outline = polygon("outline", {{0, 0}, {3, 0}, {3, 2}, {0, 2}}, 0);
  shape.holes = {circle("a", {1, 1}, 0.3, 1), polygon("b", {{2, 0.5}, {2.5, 0.5}, {2.5, 1.5}}, 2)};
  shape.outline.sides[1].arc = Arc{{3, 1}, Mat2::Identity(), -pi / 2, pi / 2};  // a round end
  write_file(folder.path / "d.step", step_file(shape));
  const MeshFile back = read_body({.path = folder.path / "d.step", .keep_mesh = false},
                                  {.sides = {{{0, 1}, "left", ""}, {{1.15, 1.26}, "a", ""}}});
  EXPECT_NEAR(area(back.shape), area(shape), 1e-11);
  EXPECT_EQ(back.shape.holes.size(), 2u);
}

}  // namespace
}  // namespace kerf::geometry_test
