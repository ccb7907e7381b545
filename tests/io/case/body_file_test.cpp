// [domain] file: what the case says of a mesh, and what it must not say.

#include "kerf/mesher.hpp"
#include "tests/io/case/case_files.hpp"
#include "tests/io/mesh/meshes.hpp"

namespace kerf::body_file_test {
namespace {

const std::string material = "[material]\nyoung = 1\npoisson = 0.3\n";

std::string plate(const std::string& rest = "", const std::string& mesh = "gmsh41") {
  return "[domain]\nfile = \"" + meshes::file(mesh).string() + "\"\n" + rest + material;
}

TEST(BodyFile, TheMeshIsTheCase) {
  const Case c =
      read(plate("[[region]]\nname = 'stiff'\nyoung = 10\npoisson = 0.2\n[[crack]]\nname = 'c'\ncontact = "
                 "'open'\n[[boundary]]\non = 'left'\ndisplacement = [0, 0]\n"));
  ASSERT_TRUE(c.mesh);
  EXPECT_EQ(c.mesh->triangles.size(), 554u);
  EXPECT_EQ(c.shape.labels.size(), 5u);
  ASSERT_EQ(c.scene.laws.size(), 1u);
  EXPECT_EQ(c.scene.laws[0].kind, CrackLaw::Kind::Open);
  ASSERT_EQ(c.regions.size(), 1u);
  EXPECT_EQ(c.regions[0].young, 10);
  EXPECT_EQ(c.scene.regions.size(), 1u);
  EXPECT_EQ(c.scene.supports.size(), 1u);
  // The edges of 554 equilateral triangles of that area.
  EXPECT_NEAR(c.sizing.size, std::sqrt(4 / std::sqrt(3.0) * area(c.shape) / 554), 1e-12);
  EXPECT_EQ(read(plate("", "freefem")).scene.laws.size(), 0u);
  EXPECT_EQ(read(plate()).scene.laws[0].kind, CrackLaw::Kind::Unilateral);
  EXPECT_TRUE(read(plate()).regions.empty());  // the surface is there, its material is the body's
  EXPECT_EQ(read(plate("[mesh]\nsize = 0.3\n")).sizing.size, 0.3);
}

TEST(BodyFile, ItsCracksTakeAPressure) {
  const Case c = read(plate("[[crack]]\nname = 'c'\npressure = 'x + 2'\n"));
  ASSERT_TRUE(has_pressure(c.scene.laws.at(0)));
  EXPECT_EQ(c.scene.laws[0].pressure({1, 0}, {0, 1}), Vec2(3, 0));
}

TEST(BodyFile, NamesThatTheMeshDoesNotHave) {
  EXPECT_EQ(error(plate("[[region]]\nname = 'soft'\nyoung = 1\npoisson = 0.3\n")).substr(0, 72),
            "a.toml:4:8: name in [[region]]: there is no physical surface \"soft\" in \"");
  EXPECT_EQ(error(plate("[[crack]]\nname = 'd'\n")),
            "a.toml:4:8: name in [[crack]]: there is no physical curve \"crack:d\" in domain.file; known: c");
  EXPECT_EQ(error(plate("[[crack]]\nname = 'c'\n[[crack]]\nname = 'c'\n")),
            "a.toml:6:8: name in [[crack]]: the name \"c\" is taken; give each its own");
  EXPECT_EQ(error(plate("[[boundary]]\non = 'lef'\npressure = 1\n")).substr(0, 11), "a.toml:4:6:");
  EXPECT_EQ(error(plate("[[region]]\nname = 'stiff'\nyoung = 1\n")),
            "a.toml:3:1: missing key \"poisson\" in [[region]]; add it");
}

TEST(BodyFile, NothingIsDrawnIntoAMesh) {
  EXPECT_EQ(error(plate("[[hole]]\nname = 'h'\ncircle = { center = [0, 0], radius = 0.1 }\n")),
            "a.toml:3:1: [[hole]]: the mesh of domain.file is taken as it is; mesh the hole there");
  EXPECT_EQ(error(plate("[[crack]]\nname = 'd'\npath = [[0, 0], [1, 0]]\n")).substr(0, 23), "a.toml:3:1: [[crack]]: ");
  EXPECT_EQ(
      error(plate("[[region]]\nname = 'd'\ncircle = { center = [0, 0], radius = 0.1 }\nyoung = 1\npoisson = 0.3\n"))
          .substr(0, 24),
      "a.toml:3:1: [[region]]: ");
  EXPECT_EQ(error(plate("[mesh]\nmesher = 'gmsh'\n")).substr(0, 33), "a.toml:4:10: mesher in [mesh]: \"/");
  EXPECT_EQ(error(plate("sides = ['a']\n")), "a.toml:3:1: unknown key \"sides\" in [domain]; did you mean \"side\"?");
  EXPECT_EQ(error(square + "[mesh]\nmesher = 'kerf'\n"),
            "a.toml:8:10: mesher in [mesh] goes with a geometry in "
            "domain.file");
}

TEST(BodyFile, FilesThatCannotBe) {
  EXPECT_EQ(
      error("[domain]\nfile = 'plate.stl'\n" + material),
      "a.toml:2:8: file in [domain] = \"plate.stl\": a mesh ends in .msh, a geometry in .geo, .step, .stp, .brep, "
      ".iges or .igs");
  EXPECT_EQ(error("[domain]\nfile = 'plate.msh'\n" + material, {}, Fault::Files),
            "cannot read 'plate.msh': No such file or directory");
  const TemporaryFolder folder;
  folder.write("bad.msh", "$MeshFormat\n3 0 8\n");
  try {
    read_case(folder.write("a.toml", "[domain]\nfile = 'bad.msh'\n" + material));
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Geometry);
  }
}

TEST(BodyFile, SidesGetNames) {
  const Case c = read(plate("[[domain.side]]\nnear = [-0.5, -1.1]\nname = 'floor'\n"));
  EXPECT_NE(std::find(c.shape.labels.begin(), c.shape.labels.end(), "floor"), c.shape.labels.end());
  EXPECT_EQ(std::find(c.shape.labels.begin(), c.shape.labels.end(), "bottom"), c.shape.labels.end());
  EXPECT_EQ(error(plate("[[domain.side]]\nnear = [2, 1]\nname = 'corner'\n")).substr(0, 43),
            "a.toml:4:8: near = [2, 1] is as near to ano");
}

/// A case of a drawn body [0, 4] x [0, 2], meshed before.
Case meshed(const TemporaryFolder& folder, const Shape& body, const std::string& rest) {
  write_mesh(folder.path / "a.msh", triangulate(body, {.size = 0.25}), body);
  return read_case(folder.write("a.toml", "[domain]\nfile = 'a.msh'\n" + material + rest));
}

Shape drawn_plate() {
  Shape shape;
  shape.labels = {"rim"};
  shape.outline = polygon("outline", {{0, 0}, {4, 0}, {4, 2}, {0, 2}}, 0);
  return shape;
}

// Chords stand for a curve where there are many of them and their kinks are small.
TEST(BodyFile, NormalsOfCurvedCracksAreThoseOfTheCurve) {
  const Vec2 center(2, 0.5);
  Shape body = drawn_plate();
  body.cracks = {arc_crack("bow", center, 1, 0.4, 1.6), {"straight", {{0.5, 0.5}, {0.5, 1.5}}, {}}, {"sharp", {}, {}}};
  for (int k = 0; k < 6; ++k)  // a saw
    body.cracks[2].points.push_back({3.2 + 0.1 * k, 0.3 + 0.05 * (k % 2)});
  const TemporaryFolder folder;
  const Case c = meshed(folder, body, "[[crack]]\nname = 'bow'\ncontact = 'open'\n");
  ASSERT_EQ(c.scene.laws.size(), 3u);
  EXPECT_EQ(c.scene.laws[0].kind, CrackLaw::Kind::Open);
  ASSERT_TRUE(c.scene.laws[0].normal);
  EXPECT_FALSE(c.scene.laws[1].normal);
  EXPECT_FALSE(c.scene.laws[2].normal);
  for (int k = 0; k <= 40; ++k) {
    const double t = 0.4 + 1.2 * k / 40;
    const Vec2 outward(std::cos(t), std::sin(t));
    EXPECT_LT((c.scene.laws[0].normal(center + outward) - outward).norm(), 2e-3) << t;
  }
}

// What others enclose is made of what the body is, with its eigenstrain.
TEST(BodyFile, EnclosedPartsAreMadeOfWhatTheBodyIs) {
  Shape body = drawn_plate();
  body.regions = {circle("ring", {2, 1}, 0.6, none), circle("core", {2, 1}, 0.3, none)};
  const TemporaryFolder folder;
  const Case c =
      meshed(folder, body, "eigenstrain = [1e-3, 0, 0]\n[[region]]\nname = 'ring'\nyoung = 5\npoisson = 0.25\n");
  ASSERT_EQ(c.regions.size(), 2u);
  EXPECT_EQ(c.regions[0].young, 5);
  EXPECT_EQ(c.regions[1].young, 1);
  EXPECT_EQ(c.regions[1].poisson, 0.3);
  EXPECT_EQ(c.scene.regions[1].mu, c.scene.material.mu);
  ASSERT_EQ(c.scene.eigenstrain.size(), 3u);
  EXPECT_FALSE(c.scene.eigenstrain[1]);
  EXPECT_EQ(c.scene.eigenstrain[2].normal({2, 1}), Vec2(1e-3, 0));
}

TEST(BodyFile, SaysWhenThereIsNothingToName) {
  const TemporaryFolder folder;
  const auto wrong = [&](const std::string& rest) {
    try {
      meshes::Square s;
      folder.write("a.msh", s.text());
      read_case(folder.write("a.toml", "[domain]\nfile = 'a.msh'\n" + material + rest));
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Usage);
      return std::string(e.what()).substr(folder.path.string().size() + 1);
    }
    return std::string("no error");
  };
  EXPECT_EQ(wrong("[[region]]\nname = 'r'\nyoung = 1\npoisson = 0.3\n"),
            "a.toml:7:8: name in [[region]]: there is no physical surface \"r\" in \"a.msh\"; it has none");
  EXPECT_EQ(wrong("[[crack]]\nname = 'c'\n"),
            "a.toml:7:8: name in [[crack]]: there is no physical curve \"crack:c\" in domain.file; it has no cracks");
  EXPECT_EQ(wrong("[[interface]]\nname = 'i'\nbetween = ['a', 'b']\n").substr(0, 86),
            "a.toml:6:1: [[interface]] goes with a body that is drawn in the case; in a file name t");
}

TEST(BodyFile, FrozenSurfacesAreMasks) {
  const Case c =
      read(plate("[[region]]\nname = 'stiff'\n[functional]\nkind = 'compliance'\n[[boundary]]\non = "
                 "'right'\ntraction = [1, 0]\n[optimize]\nvolume = { at_most = 0.8 }\nfrozen = ['stiff']\n"));
  EXPECT_TRUE(c.regions.empty());
  ASSERT_EQ(c.optimize->level_set.frozen.size(), 1u);
  EXPECT_EQ(c.optimize->level_set.frozen[0].sides.size(), 4u);
}

}  // namespace
}  // namespace kerf::body_file_test
