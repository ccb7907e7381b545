// Meshes that gmsh, FreeFEM and meshio wrote (tests/data/meshes/README.md), read as bodies, written, and read again.

#include "io/mesh/outlines.hpp"
#include "kerf/mesher.hpp"
#include "tests/io/mesh/meshes.hpp"
#include "tests/support/folder.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

namespace kerf::read_mesh_test {
namespace {

using namespace meshes;

double area_of(const Mesh& mesh, Index region = -2) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (region == -2 || region_of(mesh, Index(t)) == region) sum += area(mesh, Index(t));
  return sum;
}

double length_of(const Mesh& mesh, const MeshFile& body, const std::string& label) {
  double sum = 0;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] != none && body.shape.labels[std::size_t(mesh.label[e])] == label) sum += length(mesh, Index(e));
  return sum;
}

void expect_equal(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t p = 0; p < a.points.size(); ++p) EXPECT_EQ(a.points[p], b.points[p]);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.edges_of, b.edges_of);
  EXPECT_EQ(a.sides, b.sides);
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.crack, b.crack);
  EXPECT_EQ(a.region, b.region);
  ASSERT_EQ(a.cracks.size(), b.cracks.size());
  for (std::size_t c = 0; c < a.cracks.size(); ++c) {
    ASSERT_EQ(a.cracks[c].size(), b.cracks[c].size());
    for (std::size_t k = 0; k < a.cracks[c].size(); ++k) {
      EXPECT_EQ(a.cracks[c][k].edge, b.cracks[c][k].edge);
      EXPECT_EQ(a.cracks[c][k].forward, b.cracks[c][k].forward);
    }
  }
}

// plate.geo of the README: a plate [-2, 2] x [-1, 1] with a circular hole, a crack and a stiff square.
TEST(ReadMesh, KnowsSidesCracksAndRegionsInEveryFormatOfGmsh) {
  for (const char* name : {"gmsh22", "gmsh22_binary", "gmsh41", "gmsh41_binary", "gmsh_crack"}) {
    SCOPED_TRACE(name);
    const MeshFile body = read_mesh(file(name), {.materials = {"stiff"}});
    const Mesh& mesh = body.mesh;
    EXPECT_EQ(mesh.triangles.size(), 554u);
    EXPECT_EQ(body.surfaces, (std::vector<std::string>{"body", "stiff"}));
    EXPECT_EQ(body.shape.labels.size(), 5u);
    for (const auto& [label, along] : {std::pair{"bottom", 4.0}, {"right", 2.0}, {"top", 4.0}, {"left", 2.0}})
      EXPECT_NEAR(length_of(mesh, body, label), along, 1e-14) << label;
    // Chords of the circle of radius 0.3.
    EXPECT_NEAR(length_of(mesh, body, "hole:h"), 2 * pi * 0.3, 0.03);
    EXPECT_EQ(body.shape.outline.sides.size(), 4u);
    ASSERT_EQ(body.shape.holes.size(), 1u);
    EXPECT_EQ(body.shape.holes[0].name, "h");
    ASSERT_EQ(body.shape.cracks.size(), 1u);
    EXPECT_EQ(body.shape.cracks[0].name, "c");
    ASSERT_EQ(body.shape.cracks[0].points.size(), 2u);
    EXPECT_LT((body.shape.cracks[0].points[0] - Vec2(-0.8, 0)).norm(), 1e-14);
    EXPECT_LT((body.shape.cracks[0].points[1] - Vec2(0.4, 0.1)).norm(), 1e-14);
    EXPECT_EQ(mesh.cracks[0].size(), 14u);
    ASSERT_EQ(body.shape.regions.size(), 1u);
    EXPECT_EQ(body.shape.regions[0].sides.size(), 4u);
    EXPECT_NEAR(area_of(mesh, 0), 0.16, 1e-14);
    EXPECT_NEAR(area_of(mesh), area(body.shape), 1e-13);
    EXPECT_EQ(find_problem(body.shape), std::nullopt);
    EXPECT_TRUE(body.notes.empty());
  }
}

TEST(ReadMesh, GluesFacesThatTheCrackPluginDoubled) {
  const MeshFile glued = read_mesh(file("gmsh_crack")), whole = read_mesh(file("gmsh41"));
  EXPECT_EQ(glued.mesh.points.size(), whole.mesh.points.size());
  EXPECT_EQ(glued.mesh.edges.size(), whole.mesh.edges.size());
  // Without the curve's name nobody says what the doubled faces are.
  std::string bytes = text(file("gmsh_crack"));
  bytes.replace(bytes.find("crack:c"), 7, "slit___");
  EXPECT_NE(complaint(bytes).find("have nodes of their own there"), std::string::npos) << complaint(bytes);
}

// As the plugin makes it with an open boundary: node 10 is node 4 for what lies above the crack from 4 to 5.
TEST(ReadMesh, GluesFacesThatAreOpenAtTheRim) {
  Square s;
  s.names = "5\n1 1 \"bottom\"\n1 2 \"right\"\n1 3 \"top\"\n1 4 \"left\"\n1 5 \"crack:c\"\n";
  s.nodes.push_back("10 0 1 0");
  s.elements[6] = "7 1 2 4 4 7 10";
  s.elements[12] = "15 2 2 0 1 10 5 8";
  s.elements[13] = "16 2 2 0 1 10 8 7";
  s.elements.push_back("20 1 2 5 5 4 5");
  const MeshFile body = parse_mesh("a.msh", s.text());
  EXPECT_EQ(body.mesh.points.size(), 9u);
  ASSERT_EQ(body.mesh.cracks.size(), 1u);
  EXPECT_EQ(body.mesh.cracks[0].size(), 1u);
  EXPECT_EQ(body.shape.cracks[0].points, (std::vector<Vec2>{{0, 1}, {1, 1}}));
  EXPECT_EQ(find_problem(body.shape), std::nullopt);
}

TEST(ReadMesh, NumbersOfFreeFemAreLabels) {
  const MeshFile body = read_mesh(file("freefem"));
  EXPECT_EQ(body.mesh.triangles.size(), 500u);
  EXPECT_EQ(body.shape.labels.size(), 5u);
  for (const auto& [label, along] : {std::pair{"1", 4.0}, {"2", 2.0}, {"3", 4.0}, {"4", 2.0}})
    EXPECT_NEAR(length_of(body.mesh, body, label), along, 1e-12);
  EXPECT_EQ(body.shape.outline.sides.size(), 4u);
  EXPECT_EQ(body.shape.holes.size(), 1u);
  ASSERT_EQ(body.notes.size(), 1u);  // the circle inside
  EXPECT_EQ(find_problem(body.shape), std::nullopt);
}

TEST(ReadMesh, ReadingWritingReadingChangesNoBit) {
  for (const std::string& name : committed)
    for (const MshVersion version : {MshVersion::V4, MshVersion::V2}) {
      SCOPED_TRACE(name);
      const MeshFileRequest request{.materials = {"stiff"}};
      const MeshFile first = read_mesh(file(name), request);
      const std::string written = msh_text(first.mesh, first.shape, version);
      const MeshFile second = parse_mesh("b.msh", written, request);
      expect_equal(first.mesh, second.mesh);
      EXPECT_EQ(first.shape.labels, second.shape.labels);
      EXPECT_EQ(msh_text(second.mesh, second.shape, version), written);
    }
}

TEST(ReadMesh, SidesGetNamesFromPointsNearThem) {
  Square s;
  for (int k = 0; k < 8; ++k) s.elements.erase(s.elements.begin());
  EXPECT_NE(complaint(s.text()).find("no physical curve lies on the rim"), std::string::npos);
  const MeshFileRequest request{.sides = {{{1, -0.2}, "low", "c.toml:3:8: "}, {{2.1, 0.9}, "right", "c.toml:6:8: "}}};
  const MeshFile body = parse_mesh("a.msh", s.text(), request);
  EXPECT_EQ(body.shape.labels, (std::vector<std::string>{"low", "right", "unnamed"}));
  EXPECT_EQ(length_of(body.mesh, body, "low"), 2);
  EXPECT_EQ(length_of(body.mesh, body, "unnamed"), 4);
  EXPECT_EQ(
      complaint(s.text(), {.sides = {{{2, 2}, "corner", "c.toml:3:8: "}}}, Fault::Usage),
      "c.toml:3:8: near = [2, 2] is as near to another side, at (1.5, 2); choose a point in the middle of the side");
}

// Fibres in two places, a ring around body material, and a half that touches the rim.
TEST(ReadMesh, RegionsInSeveralPiecesAndEnclosedBodyAreRegionsOfTheirOwn) {
  Square s;
  s.names = "6\n1 1 \"bottom\"\n1 2 \"right\"\n1 3 \"top\"\n1 4 \"left\"\n2 7 \"fibres\"\n2 8 \"body\"\n";
  for (std::size_t t = 8; t < 16; ++t) {
    std::string& e = s.elements[t];
    e.replace(e.find("2 2 0"), 5, t == 8 || t == 15 ? "2 2 7" : "2 2 8");
  }
  const MeshFile body = parse_mesh("a.msh", s.text(), {.materials = {"fibres"}});
  ASSERT_EQ(body.shape.regions.size(), 2u);
  EXPECT_EQ(body.shape.regions[0].name, "fibres");
  EXPECT_EQ(body.shape.regions[1].name, "fibres.2");
  EXPECT_EQ(body.material, (std::vector<Index>{0, 0}));
  EXPECT_EQ(body.mesh.region, (std::vector<Index>{0, none, none, none, none, none, none, 1}));
  EXPECT_EQ(find_problem(body.shape), std::nullopt);  // they touch the outline, and can be drawn anew
  const MeshFile rest = parse_mesh("a.msh", s.text(), {.materials = {"body"}});
  EXPECT_EQ(rest.shape.regions.size(), 2u);
}

TEST(ReadMesh, CurvesInsideThatAreNoCracksAreLeftOutWithANote) {
  Square s;
  s.names = "5\n1 1 \"bottom\"\n1 2 \"right\"\n1 3 \"top\"\n1 4 \"left\"\n1 5 \"weld\"\n";
  s.elements.push_back("20 1 2 5 5 4 5");
  const MeshFile body = parse_mesh("a.msh", s.text());
  ASSERT_EQ(body.notes.size(), 1u);
  EXPECT_EQ(body.notes[0],
            "physical curve \"weld\" lies inside the body and is not named crack:<name>: it means nothing "
            "there");
  s.names.replace(s.names.find("weld"), 4, "crack:w");
  EXPECT_EQ(parse_mesh("a.msh", s.text()).shape.cracks.size(), 1u);
}

/// A drawn body [0, 4] x [0, 2] and its mesh.
struct DrawnPlate {
  Shape shape;
  DrawnPlate() {
    shape.labels = {"rim"};
    shape.outline = polygon("outline", {{0, 0}, {4, 0}, {4, 2}, {0, 2}}, 0);
  }
  MeshFile read(const MeshFileRequest& request) const {
    return parse_mesh("a.msh", msh_text(triangulate(shape, {.size = 0.3}), shape), request);
  }
};

// Only what ends in a number, behind the name of another region, is a piece of that one.
TEST(ReadMesh, NamesOfRegionsArePiecesOnlyOfOthers) {
  DrawnPlate plate;
  const std::vector<std::string> names = {"b", "b.2", "c.2", "d.", "b.e", "body"};
  for (std::size_t k = 0; k < names.size(); ++k)
    plate.shape.regions.push_back(circle(names[k], {0.5 + 0.5 * double(k), 1}, 0.2, none));
  const MeshFile read = plate.read({.materials = {"b"}});
  EXPECT_EQ(read.surfaces, (std::vector<std::string>{"b", "b.e", "body", "body_", "c.2", "d."}));
  ASSERT_EQ(read.shape.regions.size(), 2u);
  EXPECT_EQ(read.shape.regions[1].name, "b.2");
  const test::Folder folder;
  write_mesh(folder.path / "a.msh", triangulate(plate.shape, {.size = 0.3}), plate.shape);
  EXPECT_EQ(read_mesh(folder.path / "a.msh").surfaces, read.surfaces);
}

TEST(ReadMesh, ASurfaceIsWrittenAsOneBlock) {
  DrawnPlate plate;
  for (const double x : {0.6, 1.8, 3.0})
    plate.shape.regions.push_back(circle(x < 1 ? "a" : x < 2 ? "b" : "c", {x, 1}, 0.3, none));
  const Mesh mesh = triangulate(plate.shape, {.size = 0.2});
  const std::string written = msh_text(mesh, plate.shape, MshVersion::V4);
  std::istringstream rest(written.substr(written.find("$Elements") + 9));
  std::size_t blocks = 0, cells = 0, first = 0, last = 0;
  rest >> blocks >> cells >> first >> last;
  std::set<std::pair<int, int>> seen;
  std::size_t count = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    int dimension = 0, entity = 0, type = 0;
    std::size_t n = 0;
    rest >> dimension >> entity >> type >> n;
    EXPECT_TRUE(seen.insert({dimension, entity}).second) << dimension << " " << entity << " has a second block";
    count += n;
    for (std::string line; n > 0 && std::getline(rest >> std::ws, line); --n) {
    }
  }
  EXPECT_EQ(count, cells);
  EXPECT_EQ(std::ranges::count_if(seen, [](const auto& of) { return of.first == 2; }), 4) << "three discs and the rest";
  const MeshFile read = parse_mesh("a.msh", written, {});
  EXPECT_EQ(read.mesh.triangles.size(), mesh.triangles.size());
}

TEST(ReadMesh, WhatARingEnclosesIsARegionOfTheBodysMaterial) {
  DrawnPlate plate;
  plate.shape.regions = {circle("ring", {2, 1}, 0.6, none), circle("core", {2, 1}, 0.3, none)};
  const MeshFile read = plate.read({.materials = {"ring"}});
  ASSERT_EQ(read.shape.regions.size(), 2u);
  EXPECT_EQ(read.shape.regions[0].name, "ring");
  EXPECT_EQ(read.shape.regions[1].name, "enclosed");
  EXPECT_EQ(read.material, (std::vector<Index>{0, none}));
  EXPECT_NEAR(area_of(read.mesh, 1), pi * 0.09, 1e-9) << "the polygon has the area of its circle";
}

TEST(ReadMesh, HolesOfOneLabelHaveNamesOfTheirOwn) {
  DrawnPlate plate;
  for (const double x : {1.0, 2.0, 3.0}) plate.shape.holes.push_back(circle("", {x, 1}, 0.2, 0));
  const MeshFile read = plate.read({});
  ASSERT_EQ(read.shape.holes.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(read.shape.holes[k].name, (std::vector<std::string>{"rim", "rim_2", "rim_3"})[k]);
}

TEST(ReadMesh, LinesThatSayNothingNewAreReadOver) {
  Square s;
  const std::string before = msh_text(parse_mesh("a.msh", s.text()).mesh, parse_mesh("a.msh", s.text()).shape);
  s.elements.push_back("20 1 2 0 0 1 9");  // no edge, and in no group
  s.elements.push_back("21 1 2 1 1 1 2");  // the first edge of the bottom once more
  const MeshFile read = parse_mesh("a.msh", s.text());
  EXPECT_EQ(msh_text(read.mesh, read.shape), before);
}

// Left and right of a crack follow from how its lines run.
TEST(ReadMesh, CracksRunAsTheirLinesDo) {
  Square s;
  s.names = "5\n1 1 \"bottom\"\n1 2 \"right\"\n1 3 \"top\"\n1 4 \"left\"\n1 5 \"crack:c\"\n";
  s.elements.push_back("20 1 2 5 5 4 5");
  s.elements.push_back("21 1 2 5 5 5 6");
  EXPECT_EQ(parse_mesh("a.msh", s.text()).shape.cracks[0].points, (std::vector<Vec2>{{0, 1}, {2, 1}}));
  s.elements[16] = "20 1 2 5 5 5 4";
  s.elements[17] = "21 1 2 5 5 6 5";
  const MeshFile back = parse_mesh("a.msh", s.text());
  EXPECT_EQ(back.shape.cracks[0].points, (std::vector<Vec2>{{2, 1}, {0, 1}}));
  EXPECT_EQ(points_of(back.mesh, back.mesh.cracks[0]), (std::vector<Vec2>{{2, 1}, {1, 1}, {0, 1}}));
}

}  // namespace
}  // namespace kerf::read_mesh_test
