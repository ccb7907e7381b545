// What the reader makes of every section of a case file, against the values written there; all files of the folder of
// cases read.

#include "tests/io/case/case_files.hpp"

#include "geometry/plane.hpp"

#include <cmath>
#include <sstream>

namespace kerf::case_test {
namespace {

namespace fs = std::filesystem;

TEST(Case, EveryCaseOfTheFolderReads) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(KERF_CASES)) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    Case c;
    ASSERT_NO_THROW(c = read_case(entry.path())) << entry.path();
    EXPECT_EQ(c.name, entry.path().stem().string());
    EXPECT_EQ(find_problem(c.shape), std::nullopt) << entry.path();
    EXPECT_EQ(c.scene.laws.size(), c.shape.cracks.size());
  }
  EXPECT_GE(count, 9);
}

TEST(Case, Defaults) {
  const Case c = read(square);
  EXPECT_EQ(c.name, "a");
  EXPECT_EQ(c.title, "a");
  EXPECT_EQ(c.element.name, "bdms");
  EXPECT_EQ(c.contact, ContactMethod::DualQp);
  EXPECT_EQ(c.functional.kind, "energy");
  ASSERT_EQ(c.functional.terms.size(), 1u);
  EXPECT_TRUE(c.functional.terms[0].energy);
  EXPECT_FALSE(c.map);
  EXPECT_FALSE(c.validate);
  EXPECT_EQ(c.map_request.perturbation.kind, Perturbation::Kind::Hole);
  EXPECT_DOUBLE_EQ(c.map_request.radius, 0.005 * std::sqrt(5.0));
  EXPECT_FALSE(c.map_request.bounds);
  EXPECT_FALSE(c.scene.body);
  EXPECT_TRUE(c.plane_strain && c.output.vtk && c.output.png && c.output.html);
  EXPECT_EQ(c.sizing.size, 0);
  EXPECT_EQ(c.shape.labels, (std::vector<std::string>{"bottom", "right", "top", "left"}));
  EXPECT_EQ(c.scene.material.mu, plane_strain(10, 0.25).mu);
}

TEST(Case, ReadsEverySection) {
  const Case c = read(R"(title = "All"
[domain]
outline = [[0, 0], [2.0, 0], [2, 1], [0, 1]]
sides = ["a", "b", "a", "b"]
[[hole]]
name = "h"
ellipse = { center = [0.5, 0.5], semi_axes = [0.2, 0.1], angle_deg = 90 }
[[hole]]
name = "p"
polygon = [[1.2, 0.2], [1.4, 0.2], [1.3, 0.4]]
[[crack]]
name = "c"
path = [[1, 0.5], [1.2, 0.6], [1.4, 0.6]]
contact = "open"
friction = 0
[[crack]]
name = "d"
path = [[1.6, 0.5], [1.8, 0.5]]
contact = "bonded"
[[crack]]
name = "e"
path = [[1.6, 0.7], [1.8, 0.7]]
[material]
young = 10
poisson = 0.5
state = "plane stress"
[[boundary]]
on = ["a", "hole:h"]
traction = ["s*nx", 1]
[[boundary]]
on = "p"
pressure = "2 + x"
[[boundary]]
on = "b"
displacement_normal = 0.125
[body]
force = [0, "-rho*y"]
[define]
rho = 3
s = "rho + nu*E"
[mesh]
size = 0.1
crack_tip_size = 0.01
min_angle = 20
[solver]
element = "bdms"
degree = 1
contact = "dual-qp"
backend = "cholmod"
[functional]
kind = "energy"
[map]
perturbation = "hole"
points = [[0.1, 0.1], [1, 0.1]]
bounds = false
[[probe]]
name = "line"
from = [0, 0]
to = [1, 1]
count = 5.0
[output]
vtk = false
png = true
html = false
)");
  EXPECT_EQ(c.title, "All");
  EXPECT_EQ(c.shape.labels, (std::vector<std::string>{"a", "b", "hole:h", "hole:p"}));
  ASSERT_EQ(c.shape.holes.size(), 2u);
  const Arc& rim = *c.shape.holes[0].sides.at(0).arc;
  EXPECT_NEAR((rim.axes - Mat2{{0, -0.1}, {0.2, 0}}).norm(), 0, 1e-15);
  EXPECT_EQ(c.shape.holes[1].sides.size(), 3u);
  ASSERT_EQ(c.scene.laws.size(), 3u);
  EXPECT_EQ(c.scene.laws[0].kind, CrackLaw::Kind::Open);
  EXPECT_EQ(c.scene.laws[1].kind, CrackLaw::Kind::Bonded);
  EXPECT_EQ(c.scene.laws[2].kind, CrackLaw::Kind::Unilateral);
  EXPECT_EQ(c.scene.material.c, plane_stress(10, 0.5).c);
  EXPECT_FALSE(c.plane_strain);

  ASSERT_EQ(c.scene.tractions.size(), 3u);  // in the order of the labels
  EXPECT_EQ(c.scene.tractions[0].label, 0);
  EXPECT_EQ(c.scene.tractions[1].label, 2);
  EXPECT_EQ(c.scene.tractions[1].value({0, 0}, {0.5, 0}), Vec2(4, 1));
  EXPECT_EQ(c.scene.tractions[2].label, 3);
  EXPECT_EQ(c.scene.tractions[2].value({1, 0}, {0, 1}), Vec2(0, -3));
  ASSERT_EQ(c.scene.supports.size(), 1u);
  EXPECT_TRUE(c.scene.supports[0].normal_frame && c.scene.supports[0].first && !c.scene.supports[0].second);
  EXPECT_EQ(c.scene.supports[0].value({0, 0}, {1, 0}), Vec2(0.125, 0));
  EXPECT_EQ(c.scene.body({0, 2}), Vec2(0, -6));

  EXPECT_EQ(c.sizing.size, 0.1);
  EXPECT_EQ(c.sizing.crack_tip_size, 0.01);
  EXPECT_EQ(c.sizing.min_angle_deg, 20);
  ASSERT_TRUE(c.map);
  EXPECT_EQ(c.map->points.at(1), Vec2(1, 0.1));
  ASSERT_EQ(c.probes.size(), 1u);
  EXPECT_EQ(c.probes[0].points.size(), 5u);
  EXPECT_EQ(c.probes[0].points[1], Vec2(0.25, 0.25));
  EXPECT_TRUE(!c.output.vtk && c.output.png && !c.output.html);
}

TEST(Case, BoundsOfMeans) {
  const Case c = read(square + R"([[boundary]]
on = "left"
displacement = [0, 0]
[bounds]
tips = false
displacements = ["top", "right"]
reactions = "left"
compliance = true
disc = [{ center = [1, 0.5], radius = 0.125 }]
[[bounds.line]]
from = [0.5, 0.5]
to = [1.5, 0.25]
[[probe]]
name = "p"
points = [[1, 0.5]]
bounds = true
)");
  const BoundsRequest& b = *c.bounds;
  EXPECT_EQ(b.displacements, (std::vector<Index>{2, 1}));
  EXPECT_EQ(b.reactions, (std::vector<Index>{3}));
  EXPECT_TRUE(b.compliance && !b.tips && b.points.empty());
  ASSERT_EQ(b.discs.size(), 1u);
  EXPECT_EQ(b.discs[0].center, Vec2(1, 0.5));
  EXPECT_EQ(b.discs[0].radius, 0.125);
  ASSERT_EQ(b.lines.size(), 1u);
  EXPECT_EQ(b.lines[0].from, Vec2(0.5, 0.5));
  EXPECT_EQ(b.lines[0].to, Vec2(1.5, 0.25));
  EXPECT_TRUE(c.probes[0].bounds);
}

TEST(Case, ComponentsCombineAndRollersCarryTheRest) {
  const Case both = read(square +
                         "[[boundary]]\non = 'left'\ndisplacement_x = 1\n"
                         "[[boundary]]\non = 'left'\ndisplacement_y = 'y'\n");
  ASSERT_EQ(both.scene.supports.size(), 1u);
  const Support& s = both.scene.supports[0];
  EXPECT_TRUE(s.first && s.second && !s.normal_frame);
  EXPECT_EQ(s.value({0, 0.5}, {-1, 0}), Vec2(1, 0.5));

  const Case roller = read(square + "[[boundary]]\non = 'bottom'\ndisplacement_y = 2\ntraction = ['1 + x', 0]\n");
  EXPECT_TRUE(!roller.scene.supports.at(0).first && roller.scene.supports[0].second);
  EXPECT_EQ(roller.scene.supports[0].value({0, 0}, {0, -1}), Vec2(0, 2));
  EXPECT_EQ(roller.scene.tractions.at(0).value({1, 0}, {0, -1}), Vec2(2, 0));

  // A load on a normal roller keeps its tangential part alone.
  const Case normal = read(square + "[[boundary]]\non = 'bottom'\ndisplacement_normal = 0\ntraction = [3, 4]\n");
  EXPECT_EQ(normal.scene.tractions.at(0).value({1, 0}, {0, -1}), Vec2(3, 0));
}

TEST(Case, BareHoleNameMeansTheHoleUnlessASideHasIt) {
  const std::string hole =
      "[[hole]]\nname = 'top'\ncircle = { center = [1, 0.5], radius = 0.1 }\n"
      "[[hole]]\nname = 'h'\ncircle = { center = [0.5, 0.5], radius = 0.1 }\n";
  const Case c = read(square + hole + "[[boundary]]\non = ['top', 'h', 'hole:top']\npressure = 1\n");
  std::vector<Index> labels;
  for (const Traction& t : c.scene.tractions) labels.push_back(t.label);
  EXPECT_EQ(labels, (std::vector<Index>{2, 4, 5}));
}

// A stadium: the arc at entry 2 makes edge 1 round, the first entry the last edge.
TEST(Case, ArcsOfTheOutline) {
  const Case c = read(R"([domain]
outline = [{ arc_to = [0, 0], center = [0, 0.5] }, [2, 0], { arc_to = [2, 1], center = [2, 0.5] }, [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1
poisson = 0
)");
  const auto& sides = c.shape.outline.sides;
  ASSERT_EQ(sides.size(), 4u);
  EXPECT_FALSE(sides[0].arc || sides[2].arc);
  ASSERT_TRUE(sides[1].arc && sides[3].arc);
  for (const std::size_t k : {1u, 3u}) {
    const Arc& arc = *sides[k].arc;
    EXPECT_NEAR((at(arc, arc.from) - sides[k].start).norm(), 0, 1e-15);
    EXPECT_NEAR((at(arc, arc.to) - sides[(k + 1) % 4].start).norm(), 0, 1e-15);
    EXPECT_NEAR(arc.to - arc.from, M_PI, 1e-14);  // half a turn runs counter-clockwise
  }
  EXPECT_NEAR(at(*sides[1].arc, 0.5 * (sides[1].arc->from + sides[1].arc->to)).x(), 2.5, 1e-15);
  EXPECT_EQ(sides[1].label, 1);
}

TEST(Case, DiscOfTwoArcs) {
  const Case c = read(R"([domain]
outline = [{ arc_to = [1, 0], center = [0, 0] }, { arc_to = [-1, 0], center = [0, 0] }]
sides = ["upper", "lower"]
[material]
young = 1
poisson = 0
)");
  EXPECT_EQ(find_problem(c.shape), std::nullopt);
  ASSERT_EQ(c.shape.outline.sides.size(), 2u);
  for (const Side& side : c.shape.outline.sides) EXPECT_NEAR(side.arc->to - side.arc->from, M_PI, 1e-14);
}

TEST(Case, ArcCracks) {
  const Case c =
      read(square + "[[crack]]\nname = 'c'\narc = { center = [1, 0.5], radius = 0.25, from_deg = 90, to_deg = -30 }\n");
  const Crack& crack = c.shape.cracks.at(0);
  ASSERT_TRUE(crack.arc);
  EXPECT_NEAR((crack.points.at(0) - Vec2(1, 0.75)).norm(), 0, 1e-15);
  EXPECT_NEAR((crack.points.at(1) - Vec2(1 + 0.125 * std::sqrt(3.0), 0.375)).norm(), 0, 1e-15);
  EXPECT_NEAR(path_length(crack), 0.25 * 2 * M_PI / 3, 1e-15);
}

TEST(Case, ArcTakesTheShorterWayAndExactEnds) {
  const Case c = read(R"([domain]
outline = [[0, 0], [2, 0], [2, 1.0000005], { arc_to = [1, 2], center = [1, 1] }, [0, 2]]
sides = ["a", "a", "round", "a", "a"]
[material]
young = 1
poisson = 0
)");
  const Side& side = c.shape.outline.sides[2];
  ASSERT_TRUE(side.arc);
  EXPECT_NEAR(side.arc->to - side.arc->from, M_PI / 2, 1e-6);
  EXPECT_NEAR((at(*side.arc, side.arc->from) - Vec2(2, 1.0000005)).norm(), 0, 1e-15);
  EXPECT_NEAR((at(*side.arc, side.arc->to) - Vec2(1, 2)).norm(), 0, 1e-15);
}

// [reference/exact, case 5 in the Westergaard form]
TEST(Case, PartlyClosedHasTheExactDisplacement) {
  const Case c = read_case(fs::path(KERF_CASES) / "partly_closed.toml");
  ASSERT_EQ(c.scene.supports.size(), 1u);
  std::ifstream table(fs::path(KERF_TEST_DATA) / "exact" / "c05_partial_linear_w.csv");
  ASSERT_TRUE(table);
  std::string line, cell;
  std::getline(table, line);
  ASSERT_EQ(line.rfind("kind,x,y,side,ux,uy", 0), 0u);
  int count = 0;
  while (std::getline(table, line)) {
    std::stringstream cells(line);
    std::getline(cells, cell, ',');
    if (cell != "bulk") continue;
    double row[5];
    for (double& value : row) {
      std::getline(cells, cell, ',');
      value = std::stod(cell);
    }
    const Vec2 exact(row[3], row[4]), u = c.scene.supports[0].value({row[0], row[1]}, {1, 0});
    EXPECT_LT((u - exact).norm(), 1e-9 * exact.norm()) << line;
    ++count;
  }
  EXPECT_GE(count, 18);
}

TEST(Case, ProbesFromFiles) {
  const TemporaryFolder folder;
  const std::string text = square + "[[probe]]\nname = 'p'\nfile = 'p.csv'\n";
  const fs::path path = folder.write("a.toml", text);
  const auto message = [&](Fault fault) {
    try {
      read_case(path);
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, fault);
      return std::string(e.what()).substr(folder.path.string().size() + 1);
    }
    return std::string("no error");
  };
  EXPECT_EQ(message(Fault::Files),
            "a.toml:9:8: file in [[probe]]: " + (folder.path / "p.csv").string() + ": no such file");
  folder.write("p.csv", "x,y\n0,1\r\n\n 0.5 , 1e-1\n");
  EXPECT_EQ(read_case(path).probes.at(0).points, (std::vector<Vec2>{{0, 1}, {0.5, 0.1}}));
  folder.write("p.csv", "name,\"y\",\"x\"\nq,1,2\n");
  EXPECT_EQ(read_case(path).probes.at(0).points, (std::vector<Vec2>{{2, 1}}));
  folder.write("p.csv", "0,1\n");
  EXPECT_EQ(message(Fault::Usage), "p.csv:1:1: the first line must name the columns, x,y among them");
  folder.write("p.csv", "x,y\n0,1\n0,1,2\n");
  EXPECT_EQ(message(Fault::Usage), "p.csv:3:1: 3 cells instead of 2");
  folder.write("p.csv", "x,y\n0,nan\n");
  EXPECT_EQ(message(Fault::Usage), "p.csv:2:1: \"nan\" is not a finite number");
  folder.write("p.csv", "x,y\n");
  EXPECT_NE(message(Fault::Usage).find("there is no point"), std::string::npos);
}

TEST(Case, ExpressionErrorAtRunTimeNamesTheFile) {
  const Case c = read(square + "[[boundary]]\non = 'left'\ntraction = ['log(x)', 0]\n");
  try {
    c.scene.tractions.at(0).value({-1, 0}, {-1, 0});
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("a.toml:9:13: entry 1 of traction in [[boundary]]: expression \"log(x)\" is "
                                         "not finite"),
              std::string::npos)
        << e.what();
  }
}

TEST(Case, UnreadableFiles) {
  const TemporaryFolder folder;
  for (const fs::path& path : {folder.path, folder.path / "missing.toml", fs::path("/dev/null")}) {
    try {
      read_case(path);
      FAIL() << path;
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Files) << path;
      EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos);
    }
  }
}

TEST(Regions, WithAnEigenstrainMayBeMadeOfWhatTheBodyIs) {
  const Case c = read(square + R"(
eigenstrain = ["1e-3*x", 0, 0, "2e-3*x"]
[[region]]
name = "plug"
circle = { center = [1, 0.5], radius = 0.2 }
eigenstrain = [1e-3, 2e-3, 5e-4]
[[region]]
name = "other"
circle = { center = [1.6, 0.5], radius = 0.1 }
young = 1
poisson = 0.3
)");
  EXPECT_EQ(c.regions[0].young, 10);
  ASSERT_EQ(c.scene.eigenstrain.size(), 3u);
  // In plane strain zz acts through Poisson's ratio.
  const Eigenstrain &body = c.scene.eigenstrain[0], &plug = c.scene.eigenstrain[1];
  EXPECT_TRUE(body.out_of_plane);
  EXPECT_NEAR(body.normal({2, 0}).x(), 2e-3 + 0.25 * 4e-3, 1e-17);
  EXPECT_NEAR(body.normal({2, 0}).y(), 0.25 * 4e-3, 1e-17);
  EXPECT_EQ(body.shear({2, 0}), Vec2(0, 4e-3));
  EXPECT_EQ(body.normal.known()->degree(), 1);
  EXPECT_FALSE(plug.out_of_plane);
  EXPECT_EQ(plug.normal({0, 0}), Vec2(1e-3, 2e-3));
  EXPECT_EQ(plug.shear({0, 0}), Vec2(5e-4, 0));
  EXPECT_FALSE(c.scene.eigenstrain[2]);
  const Case plate = read(square + "state = 'plane stress'\neigenstrain = [1, 1, 0, 5]\n");
  EXPECT_FALSE(plate.scene.eigenstrain[0].out_of_plane);
  EXPECT_EQ(plate.scene.eigenstrain[0].normal({0, 0}), Vec2(1, 1));
}

TEST(Regions, HaveTheirOwnMaterialInTheSharedPlaneState) {
  const std::string regions = R"(
[[region]]
name = "stiff"
circle = { center = [0.5, 0.5], radius = 0.2 }
young = 30
poisson = 0.5
[[region]]
name = "soft"
polygon = [[1.2, 0.2], [1.6, 0.2], [1.6, 0.6]]
young = 0.5
poisson = 0
)";
  const Case c = read(square + regions);
  ASSERT_EQ(c.shape.regions.size(), 2u);
  EXPECT_EQ(c.shape.regions[0].name, "stiff");
  EXPECT_TRUE(c.shape.regions[0].sides[0].arc);
  EXPECT_EQ(c.shape.regions[1].sides.size(), 3u);
  EXPECT_EQ(c.shape.regions[1].sides[0].label, none);
  EXPECT_EQ(c.shape.labels.size(), 4u);
  ASSERT_EQ(c.scene.regions.size(), 2u);
  EXPECT_DOUBLE_EQ(c.scene.regions[0].mu, 10);
  EXPECT_EQ(c.scene.regions[0].c, 0);
  EXPECT_EQ(c.regions[1].young, 0.5);
  const Case stress = read(square + "state = 'plane stress'" + regions);
  EXPECT_DOUBLE_EQ(stress.scene.regions[0].c, plane_stress(30, 0.5).c);
}

}  // namespace
}  // namespace kerf::case_test
