// Case files of designs, read again: the same body under the same loads, and the J of the curves.

#include "io/design.hpp"

#include "geometry/arc_chain.hpp"
#include "geometry/plane.hpp"
#include "kerf/mesher.hpp"
#include "optimize/curves.hpp"
#include "tests/io/case/case_files.hpp"
#include "tests/optimize/curves.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

namespace kerf::design_file_test {

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
  const Problem p = problem_of(c);
  const FinishedCurves f = finish_curves(p, *c.optimize, scenes::quarter_hole(p, 0.5, 9), {.evaluations = 3}, {});
  const Case back = read_case(folder.write("design.toml", design_case(c, {f.shape, {}, {}, {}}, folder.path)));
  const Model model = prepare(triangulate(back.shape, p.sizing), p.element, back.scene, 1);
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

// Whole ellipses, arcs of cracks, regions of every form, and what holds between the faces of cracks.
TEST(DesignFile, FormsMaterialsAndLawsComeBack) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", square + R"([[hole]]
name = "egg"
ellipse = { center = [0.4, 0.6], semi_axes = [0.2, 0.1], angle_deg = 30 }
[[hole]]
name = "rim"
circle = { center = [1.7, 0.7], radius = 0.05 }
sides = "glued"
[[crack]]
name = "bow"
arc = { center = [1, 0.5], radius = 0.25, from_deg = 100, to_deg = 10 }
friction = 0.25
gap = "g * x"
[define]
g = "1e-3"
[[crack]]
name = "slit"
path = [[1.4, 0.2], [1.5, 0.3]]
tresca = 2
[[region]]
name = "disc"
circle = { center = [0.9, 0.5], radius = 0.05 }
young = 20
poisson = 0.125
[[region]]
name = "oval"
ellipse = { center = [0.2, 0.2], semi_axes = [0.1, 0.05] }
young = 30
poisson = 0.25
[[region]]
name = "wedge"
polygon = [[1.6, 0.1], [1.8, 0.1], [1.7, 0.2]]
young = 40
poisson = 0.375
[[region]]
name = "half"
outline = [[0.6, 0.15], { arc_to = [0.8, 0.15], center = [0.7, 0.15] }]
young = 50
poisson = 0.5
[[boundary]]
on = "glued"
pressure = 1
)"));
  ASSERT_FALSE(find_problem(c.shape)) << *find_problem(c.shape);
  const std::string file = design_case(c, {c.shape, c.scene.laws, c.regions, {}}, folder.path);
  EXPECT_NE(file.find("# where contact ends kerf solve makes the mesh finer"), std::string::npos);
  const Case back = read_case(folder.write("design.toml", file));
  EXPECT_EQ(back.title, "a (design)");
  EXPECT_EQ(back.shape.labels, c.shape.labels);
  const auto same_arc = [](const Arc& a, const Arc& b) {
    EXPECT_EQ(a.center, b.center);
    EXPECT_LT((a.axes - b.axes).norm(), 1e-15);
    EXPECT_NEAR(a.to, b.to, 1e-15);
  };
  same_arc(*c.shape.holes[0].sides[0].arc, *back.shape.holes[0].sides[0].arc);
  same_arc(*c.shape.cracks[0].arc, *back.shape.cracks[0].arc);
  EXPECT_EQ(back.shape.cracks[1].points, c.shape.cracks[1].points);
  ASSERT_EQ(back.shape.regions.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    const Loop &was = c.shape.regions[k], &is = back.shape.regions[k];
    EXPECT_EQ(is.name, was.name);
    EXPECT_EQ(is.sides.size(), was.sides.size());
    EXPECT_EQ(back.regions[k].young, c.regions[k].young);
    EXPECT_EQ(back.regions[k].poisson, c.regions[k].poisson);
  }
  same_arc(*c.shape.regions[0].sides[0].arc, *back.shape.regions[0].sides[0].arc);  // from left to right
  EXPECT_NEAR(area({back.shape.regions[1]}), pi * 0.01 / 2, 1e-12);
  EXPECT_EQ(back.scene.laws[0].friction, 0.25);
  EXPECT_EQ(back.scene.laws[1].slip_bound, 2);
  EXPECT_EQ(back.scene.laws[0].gap({0.5, 0}, {0, 1}).x(), 5e-4);
  EXPECT_FALSE(has_gap(back.scene.laws[1]));
  EXPECT_EQ(back.scene.tractions.at(0).label, c.scene.tractions.at(0).label);
}

TEST(DesignFile, LoadCasesOfDrawnDesignsCanBeSolved) {
  const TemporaryFolder folder;
  const std::string loads = square + R"([[boundary]]
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
method = "mma"
)";
  const std::string hole = "[[optimize.hole]]\ncircle = { center = [[0.5, 1.5], 0.5], radius = 0.1 }\n";
  for (const std::string& rest :
       {std::string(), std::string("least_squares = false\n"), std::string("volume = { at_most = 1 }\n"),
        std::string("volume = { at_most = 0.75 }\nstarts = 2\nmin_distance = 0.01\n")}) {
    const Case c = read_case(folder.write("a.toml", loads + rest + hole));
    const std::string file = design_case(c, {c.shape, {}, {}, {}}, folder.path);
    EXPECT_NO_THROW(read_case(folder.write("design.toml", file))) << file;
  }
}

TEST(DesignFile, SaysWhatItCannot) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", loaded));
  const std::string polygons = "# its curved sides are polygons", piece = "# crack c.2 is a piece of another one";
  Shape shape = c.shape;
  const auto file = [&] {
    return design_case(c, {shape, std::vector<CrackLaw>(shape.cracks.size(), c.scene.laws[0]), {}, {}}, folder.path);
  };
  EXPECT_EQ(file().find(polygons), std::string::npos);
  EXPECT_EQ(file().find(piece), std::string::npos);
  shape.cracks.push_back({"new", {{1.4, 0.8}, {1.5, 0.8}}, {}});
  EXPECT_EQ(file().find("is a piece of another one"), std::string::npos);
  shape.cracks.push_back({"c.2", {{1.6, 0.3}, {1.7, 0.4}}, {}});
  for (Side& side : shape.outline.sides) side.smooth = true;
  EXPECT_NE(file().find(polygons), std::string::npos);
  EXPECT_NE(file().find(piece), std::string::npos);
  // Where the curves themselves are drawn, polygons beside them are meant.
  shape.holes[0].sides[0].smooth = true;
  EXPECT_EQ(file().find(polygons), std::string::npos);
  for (Side& side : shape.outline.sides) side.smooth = false;
  shape.holes.push_back(polygon("h", {{1.1, 0.6}, {1.2, 0.6}, {1.1, 0.7}}, 0));
  for (Side& side : shape.holes[1].sides) side.smooth = true;
  EXPECT_EQ(file().find(polygons), std::string::npos);
  shape.holes[0].sides[0].smooth = false;
  EXPECT_NE(file().find(polygons), std::string::npos);
  shape.outline.sides[0].arc = Arc{{1, 0}, Mat2::Identity(), -pi, 0};
  shape.outline.sides[0].smooth = true;
  EXPECT_EQ(file().find(polygons), std::string::npos);
}

// A level set may join holes to each other and to the outline: the loop then has parts of all of them.
TEST(DesignFile, LabelsOfHolesOnOtherLoops) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", loaded));
  Shape shape = c.shape;
  shape.labels.push_back("design");
  const auto design = Index(shape.labels.size()) - 1, bore = design - 1;
  ASSERT_EQ(shape.labels[std::size_t(bore)], "hole:bore");
  shape.holes = {polygon("other", {{0.8, 0.2}, {0.9, 0.2}, {0.8, 0.3}}, design),
                 circle("third", {1.5, 0.8}, 0.1, bore)};
  shape.holes[0].sides[1].label = bore;
  shape.outline.sides[0].label = bore;
  for (const char* name : {"hole:bore", "bore"}) {
    std::string text = design_case(c, {shape, c.scene.laws, {}, {}}, folder.path);
    const std::string on = "\"hole:bore\"]\ntraction";
    ASSERT_NE(text.find(on), std::string::npos) << text;
    text.replace(text.find(on), 11, fmt::format("\"{}\"", name));
    const Case back = read_case(folder.write("design.toml", text));
    const auto named = [&](const Side& side) { return back.shape.labels[std::size_t(side.label)]; };
    EXPECT_EQ(named(back.shape.outline.sides[0]), "hole:bore");
    EXPECT_EQ(named(back.shape.outline.sides[1]), "right");
    EXPECT_EQ(named(back.shape.holes[0].sides[0]), "design");
    EXPECT_EQ(named(back.shape.holes[0].sides[1]), "hole:bore");
    EXPECT_EQ(named(back.shape.holes[1].sides[0]), "hole:bore");
    ASSERT_EQ(back.scene.tractions.size(), 2u);
    std::set<std::string> loaded_labels;
    for (const Traction& t : back.scene.tractions) loaded_labels.insert(back.shape.labels[std::size_t(t.label)]);
    EXPECT_EQ(loaded_labels, (std::set<std::string>{"right", "hole:bore"})) << name;
  }
}

// The true body must not be drawn into the one that was found: the data are read that were made up from it.
TEST(DesignFile, MadeUpDataAreThoseBesideIt) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", square + R"([[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [1, 0]
[functional]
kind = "misfit"
on = "top"
measured = "synthetic"
[synthetic]
element = "p2"
[[synthetic.hole]]
name = "h"
circle = { center = [1, 0.5], radius = 0.1 }
[optimize]
method = "mma"
[[optimize.hole]]
name = "h"
circle = { center = [[0.5, 1.5], 0.5], radius = 0.1 }
)"));
  Shape found = c.shape;
  found.labels.push_back("hole:h");
  found.holes.push_back(circle("h", {1.02, 0.5}, 0.1, Index(found.labels.size()) - 1));
  folder.write("measured.csv", "x,y,u_x,u_y\n0,1,0,0\n2,1,0.25,0\n");
  const std::string file = design_case(c, {found, {}, {}, {}}, folder.path);
  EXPECT_TRUE(file.starts_with("# its data are measured.csv")) << file;
  const Case back = read_case(folder.write("design.toml", file));
  EXPECT_FALSE(back.synthetic);
  ASSERT_TRUE(back.functional.terms.at(0).measured);
  EXPECT_EQ(back.functional.terms[0].measured->value({1, 1}, {0, 1}), Vec2(0.125, 0));
}

// What lies between the faces of a crack does so between those of its pieces.
TEST(DesignFile, PiecesOfACrackKeepItsGap) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", square + R"([[crack]]
name = "c.d"
path = [[0.5, 0.5], [1.5, 0.5]]
gap = "k * x"
[define]
k = "0.5"
)"));
  Shape shape = c.shape;
  shape.cracks = {{"c.d", {{0.5, 0.5}, {0.75, 0.5}}, {}},
                  {"c.d.2", {{1, 0.5}, {1.5, 0.5}}, {}},
                  {"new", {{1, 0.75}, {1.5, 0.75}}, {}}};
  const std::vector<CrackLaw> laws(3, c.scene.laws[0]);
  const Case back = read_case(folder.write("design.toml", design_case(c, {shape, laws, {}, {}}, folder.path)));
  ASSERT_EQ(back.scene.laws.size(), 3u);
  EXPECT_EQ(back.scene.laws[0].gap({0.5, 0.5}, {0, 1}).x(), 0.25);
  EXPECT_EQ(back.scene.laws[1].gap({1, 0.5}, {0, 1}).x(), 0.5);
  EXPECT_FALSE(has_gap(back.scene.laws[2]));
  // Without the crack nothing uses k any more.
  shape.cracks.resize(0);
  const std::string none_left = design_case(c, {shape, {}, {}, {}}, folder.path);
  EXPECT_TRUE(read_case(folder.write("design.toml", none_left)).shape.cracks.empty());
}

// Names that two parts of a body share, or that no case may have, become names of their own.
TEST(DesignFile, EveryPartHasANameOfItsOwn) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", loaded));
  Shape shape = c.shape;
  shape.labels.push_back("hole:a b");
  const auto label = Index(shape.labels.size()) - 1;
  shape.holes = {polygon("a b", {{0.2, 0.2}, {0.3, 0.2}, {0.2, 0.3}}, label),
                 polygon("a_b", {{0.5, 0.2}, {0.6, 0.2}, {0.5, 0.3}}, label),
                 polygon("a/b", {{0.8, 0.2}, {0.9, 0.2}, {0.8, 0.3}}, label)};
  shape.labels.back() = "other";
  shape.cracks.push_back({"c", {{1.6, 0.3}, {1.7, 0.4}}, {}});
  const std::vector<CrackLaw> laws(2, c.scene.laws[0]);
  std::string text = design_case(c, {shape, laws, {}, {}}, folder.path);
  const std::string gone = "\"hole:bore\"";  // the condition on the hole that the design has no more
  text.replace(text.find(gone), gone.size(), "\"other\"");
  const Case back = read_case(folder.write("design.toml", text));
  std::vector<std::string> names;
  for (const Loop& hole : back.shape.holes) names.push_back(hole.name);
  for (const Crack& crack : back.shape.cracks) names.push_back(crack.name);
  EXPECT_EQ(names, (std::vector<std::string>{"a_b", "a_b_2", "a_b_3", "c", "c_2"}));
  for (const Loop& hole : back.shape.holes) EXPECT_EQ(back.shape.labels[std::size_t(hole.sides[0].label)], "other");
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

}  // namespace kerf::design_file_test
