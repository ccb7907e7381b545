#include "io/design.hpp"

#include "geometry/arc_chain.hpp"
#include "geometry/plane.hpp"
#include "kerf/mesher.hpp"
#include "optimize/curves.hpp"
#include "tests/io/case/case_files.hpp"
#include "tests/optimize/curves.hpp"

#include <gtest/gtest.h>

using namespace kerf;

namespace {

const std::string loaded = square + R"([[hole]]
name = "bore"
circle = { center = [0.5, 0.5], radius = 0.1 }
[[crack]]
name = "c"
path = [[1.2, 0.3], [1.5, 0.4]]
contact = "open"
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = ["right", "hole:bore"]
traction = ["p * y", 0]
[define]
q = "0.5"
p = "2 * q"
only_here = "3"
[functional]
kind = "compliance"
[mesh]
size = 0.2
[[region]]
name = "pad"
circle = { center = [1.9, 0.5], radius = 0.2 }
[optimize]
frozen = ["pad"]
volume = { at_most = 0.5 }
[[optimize.bound]]
kind = "boundary_tracking"
on = "top"
target = ["only_here", "0"]
at_most = 100
)";

/// A body with every kind of side: a hole of arcs, the frame's own hole, a crack.
Shape designed(const Case& c) {
  Shape shape = c.shape;
  shape.labels.push_back("design");
  const auto label = Index(shape.labels.size()) - 1;
  ArcChain chain{{}, true};
  for (int k = 0; k < 4; ++k)
    chain.knots.push_back({Vec2(1.1 + 0.2 * std::cos(-1.7 * k), 0.7 + 0.11 * std::sin(-1.7 * k)), -1.6 * k - pi / 2});
  shape.holes.push_back({"design 2", sides(chain, label)});
  Arc corner{{1.8, 0.2}, 0.2 * Mat2::Identity(), -pi / 2, 0};
  shape.outline.sides[1].start = {1.8, 0};
  shape.outline.sides[1].label = label;
  shape.outline.sides[1].arc = corner;
  shape.outline.sides.insert(shape.outline.sides.begin() + 2, {{2, 0.2}, 1, std::nullopt});
  return shape;
}

}  // namespace

TEST(DesignFile, ComesBackAsTheSameBodyUnderTheSameLoads) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", loaded), std::vector<std::string>{"mesh.size=0.25"});
  const Shape shape = designed(c);
  ASSERT_FALSE(find_problem(shape)) << *find_problem(shape);
  const std::string file = design_case(c, {shape, c.scene.laws, {}, {"J = 1"}}, folder.path);
  EXPECT_TRUE(file.starts_with("# J = 1\n"));
  const Case back = read_case(folder.write("design.toml", file));
  EXPECT_FALSE(back.optimize);
  EXPECT_EQ(back.sizing.size, 0.25);
  ASSERT_EQ(back.shape.holes.size(), 2u);
  EXPECT_EQ(back.shape.holes[1].name, "design_2");
  ASSERT_EQ(back.shape.outline.sides.size(), shape.outline.sides.size());
  const auto same = [&](const Loop& a, const Loop& b) {
    ASSERT_EQ(a.sides.size(), b.sides.size());
    for (std::size_t i = 0; i < a.sides.size(); ++i) {
      EXPECT_EQ(a.sides[i].start, b.sides[i].start);
      EXPECT_EQ(shape.labels[std::size_t(a.sides[i].label)], back.shape.labels[std::size_t(b.sides[i].label)]);
      ASSERT_EQ(a.sides[i].arc.has_value(), b.sides[i].arc.has_value());
      if (!a.sides[i].arc) continue;
      EXPECT_LT((at(*a.sides[i].arc, a.sides[i].arc->to) - at(*b.sides[i].arc, b.sides[i].arc->to)).norm(), 1e-14);
      EXPECT_NEAR(a.sides[i].arc->to - a.sides[i].arc->from, b.sides[i].arc->to - b.sides[i].arc->from, 1e-12);
    }
  };
  same(shape.outline, back.shape.outline);
  for (const std::size_t h : {0u, 1u}) same(shape.holes[h], back.shape.holes[h]);
  EXPECT_EQ(back.shape.cracks[0].points, shape.cracks[0].points);
  EXPECT_EQ(back.scene.laws[0].kind, CrackLaw::Kind::Open);
  EXPECT_NEAR(area(back.shape), area(shape), 1e-14);
  ASSERT_EQ(back.scene.tractions.size(), c.scene.tractions.size());
  EXPECT_EQ(back.scene.tractions[0].value({2, 0.7}, {1, 0}), Vec2(0.7, 0));
}

TEST(DesignFile, ItsStateHasTheJThatTheCurvesEndWith) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", R"([domain]
outline = [[0, 0], [2, 0], [2, 2], [0, 2]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1
poisson = 0.3
state = "plane stress"
[[boundary]]
on = "bottom"
displacement_y = 0
[[boundary]]
on = "left"
displacement_x = 0
[[boundary]]
on = "right"
traction = [2, 0]
[functional]
kind = "compliance"
[mesh]
size = 0.15
[optimize]
volume = { at_most = 0.95 }
)"));
  const Problem p{
      .frame = c.shape, .scene = c.scene, .sizing = c.sizing, .element = c.element, .objective = c.functional};
  const FinishedCurves f = finish_curves(p, *c.optimize, scenes::quarter_hole(p, 0.5, 9), {.evaluations = 3}, {});
  const Case back = read_case(folder.write("design.toml", design_case(c, {f.shape, {}, {}, {}}, folder.path)));
  const Model model = prepare(triangulate(back.shape, back.sizing), back.element, back.scene, 1);
  const State state = solve(model);
  EXPECT_NEAR(analyze(back.functional, model, state, true).value, f.J, 1e-10 * f.J);
}

TEST(DesignFile, LoadCasesKeepTheirTables) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", square + R"([[boundary]]
on = "left"
displacement = [0, 0]
[[load_case]]
name = "one"
[[load_case.boundary]]
on = "right"
traction = [0, -1]
[functional]
kind = "compliance"
[optimize]
volume = { at_most = 0.5 }
start = { holes = [2, 2], radius = 0.1 }
)"));
  const std::string file = design_case(c, {c.shape, {}, {}, {}}, folder.path);
  EXPECT_NE(file.find("# kerf solve computes the first load case"), std::string::npos);
  const Case back = read_case(folder.write("design.toml", file));
  ASSERT_TRUE(back.optimize);
  EXPECT_EQ(back.optimize->load_cases.size(), 1u);
  EXPECT_FALSE(back.optimize->level_set.start);
}

TEST(DesignFile, FilesOfDataAreFoundFromItsFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path / "out");
  folder.write("data.csv", "x,y,u_x,u_y\n0,1,0,0\n2,1,0,0.1\n");
  const Case c = read_case(folder.write("a.toml", square + R"([[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "bottom"
traction = [0, -1]
[functional]
kind = "misfit"
on = "top"
measured = "data.csv"
)"));
  const std::string file = design_case(c, {c.shape, {}, {}, {}}, folder.path / "out");
  EXPECT_NE(file.find("measured = \"../data.csv\""), std::string::npos) << file;
  EXPECT_NO_THROW(read_case(folder.write("out/design.toml", file)));
}

TEST(HoleOutline, MayHaveArcsAndLabels) {
  const std::string hole = R"([[hole]]
name = "h"
outline = [[0.5, 0.5], { arc_to = [0.9, 0.5], center = [0.7, 0.5] }]
)";
  const Case c = read(square + hole);
  ASSERT_EQ(c.shape.holes.size(), 1u);
  EXPECT_EQ(c.shape.labels.back(), "hole:h");
  EXPECT_NEAR(area(c.shape), 2 - pi * 0.04 / 2, 1e-12);
  EXPECT_EQ(read(square + hole + "sides = \"rim\"\n").shape.labels.back(), "rim");
  EXPECT_EQ(read(square + hole + "sides = [\"top\", \"hole:h\"]\n").shape.holes[0].sides[0].label, 2);
  EXPECT_NE(error(square + hole + "sides = [\"top\"]\n").find("has 1 labels for the 2 edges"), std::string::npos);
}

TEST(StartDesign, IsABodyInsideTheFrame) {
  const std::string start = square + R"([[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [0, -1]
[functional]
kind = "compliance"
[optimize]
volume = { at_most = 0.5 }
min_radius = 0.05
start = { design = "design.toml" }
)";
  const TemporaryFolder folder;
  const auto message = [&] {
    try {
      read_case(folder.path / "a.toml");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  folder.write("a.toml", start);
  EXPECT_NE(message().find("a.toml:18:20: design in start in [optimize] = \"design.toml\""), std::string::npos)
      << message();
  folder.write("design.toml", "title = 3");
  EXPECT_NE(message().find("a.toml:18:20"), std::string::npos);
  EXPECT_NE(message().find("design.toml:1:"), std::string::npos);
  std::string body = square;
  body.replace(body.find("[2, 1]"), 6, "[2, 1.1]");
  folder.write("design.toml", body);
  EXPECT_NE(message().find("reaches out of this one"), std::string::npos) << message();
  body = square;
  body.replace(body.find("[2, 1]"), 6, "[2, 0.9]");
  folder.write("design.toml", body);
  const Case c = read_case(folder.path / "a.toml");
  ASSERT_TRUE(c.optimize->level_set.start_design);
  EXPECT_NEAR(area(*c.optimize->level_set.start_design), 1.9, 1e-12);
  EXPECT_EQ(c.optimize->level_set.min_radius, 0.05);
  body.replace(body.find("[2, 0.9]"), 8, "[2, 0.8]");
  folder.write("design.toml", body);
  EXPECT_NE(read_case(folder.path / "a.toml").fingerprint, c.fingerprint);
}
