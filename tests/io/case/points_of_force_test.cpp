// [[load]], and [[boundary]] with `at`: the edges that are drawn, what acts on them, and what is refused.
#include "tests/io/case/case_files.hpp"

namespace kerf::points_of_force_test {
namespace {

const std::string beam = square + R"([[load]]
at = [1, 1]
force = [0, -3]
width = 0.1
[[boundary]]
at = [0.2, 0]
displacement_y = 0
width = 0.2
[[boundary]]
at = [1.8, 0]
displacement_y = 0
name = "roller"
)";

bool says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

/// The ends of the sides with a label, in the order of the loop.
std::vector<std::array<Vec2, 2>> sides_of(const Loop& loop, Index label) {
  std::vector<std::array<Vec2, 2>> found;
  for (std::size_t i = 0; i < loop.sides.size(); ++i)
    if (loop.sides[i].label == label)
      found.push_back({loop.sides[i].start, loop.sides[(i + 1) % loop.sides.size()].start});
  return found;
}

TEST(PointsOfForce, AreEdgesWithLabelsAndConditions) {
  const Case c = read(beam);
  ASSERT_EQ(c.patches.size(), 3u);
  EXPECT_EQ(c.shape.labels,
            (std::vector<std::string>{"bottom", "right", "top", "left", "load-1", "support-1", "roller"}));
  const auto load = sides_of(c.shape.outline, 4);
  ASSERT_EQ(load.size(), 1u);
  EXPECT_NEAR((load[0][0] - Vec2(1.05, 1)).norm() + (load[0][1] - Vec2(0.95, 1)).norm(), 0, 1e-12);
  ASSERT_EQ(c.scene.tractions.size(), 1u);
  EXPECT_NEAR((c.scene.tractions[0].value({1, 1}, {0, 1}) - Vec2(0, -30)).norm(), 0, 1e-12);
  EXPECT_EQ(c.scene.supports.size(), 2u);
  EXPECT_FALSE(c.patches[2].given);
  const auto roller = sides_of(c.shape.outline, 6);
  ASSERT_EQ(roller.size(), 1u);
  EXPECT_NEAR((roller[0][1] - roller[0][0]).norm(), 1e-3 * std::sqrt(5.0), 1e-12);  // of the diagonal
  EXPECT_NEAR(area(c.shape), 2, 1e-12);
}

TEST(PointsOfForce, KeepWhatActsOnTheirSide) {
  const Case c =
      read(beam + "[[boundary]]\non = \"top\"\ntraction = [0, -1]\n[[boundary]]\non = \"bottom\"\npressure = 2\n");
  Vec2 on_load = Vec2::Zero();
  for (const Traction& t : c.scene.tractions)
    if (t.label == 4) on_load += t.value({1, 1}, {0, 1});
  EXPECT_NEAR((on_load - Vec2(0, -31)).norm(), 0, 1e-12);
  // Of the pressure beside a roller in y nothing is left to do work.
  EXPECT_EQ(error(beam + "[[boundary]]\non = \"top\"\ndisplacement_y = 0\n"),
            "a.toml:9:9: force in [[load]]: component y must be 0, because displacement_y is prescribed there (at "
            "a.toml:21:18)");
}

TEST(PointsOfForce, LieOnArcsAsWell) {
  const std::string plate = square + "[[hole]]\nname = \"h\"\ncircle = { center = [1, 0.5], radius = 0.25 }\n";
  // Across the place where the circle begins, and away from it.
  for (const char* at : {"[1.25, 0.5]", "[1, 0.75]"}) {
    const Case c = read(plate + "[[load]]\nat = " + at + "\nforce = [1, 0]\nwidth = 0.1\n");
    const Loop& hole = c.shape.holes[0];
    double length = 0;
    for (const Side& side : hole.sides)
      if (side.label == 5) length += 0.25 * std::abs(side.arc->to - side.arc->from);
    EXPECT_NEAR(length, 0.1, 1e-9);
    EXPECT_EQ(hole.sides[0].label, 4);  // what the hole is known by
    EXPECT_EQ(find_problem(c.shape), std::nullopt);
    EXPECT_NEAR(area(c.shape), 2 - pi / 16, 1e-9);
  }
}

TEST(PointsOfForce, TakeHalfAtAPlaneOfSymmetry) {
  const std::string half = square + "[[boundary]]\non = \"left\"\nsymmetry = true\n";
  const Case c = read(half + "[[load]]\nat = [0, 1]\nforce = [0, -1]\nwidth = 0.1\n");
  const auto load = sides_of(c.shape.outline, 4);
  ASSERT_EQ(load.size(), 1u);
  EXPECT_NEAR((load[0][0] - Vec2(0.05, 1)).norm() + (load[0][1] - Vec2(0, 1)).norm(), 0, 1e-12);
  EXPECT_NEAR(c.scene.tractions[0].value({0, 1}, {0, 1}).y(), -20, 1e-12);  // the force on the half
  EXPECT_TRUE(c.patches[0].at_plane);
  EXPECT_TRUE(says(error(half + "[[load]]\nat = [0, 0.5]\nforce = [0, -1]\n"), "a plane of symmetry"));
}

TEST(PointsOfForce, AreRefusedWithTheirPlace) {
  const auto at = [](const std::string& keys) { return error(square + "[[load]]\nforce = [0, -1]\n" + keys); };
  EXPECT_EQ(at("at = [1, 0.9]\n"),
            "a.toml:9:6: at in [[load]]: (1, 0.9) lies 0.1 from the boundary, farther than half the width; the nearest "
            "point of it is (1, 1)");
  EXPECT_EQ(at("at = [0.04, 1]\nwidth = 0.1\n"),
            "a.toml:10:9: width in [[load]]: an edge 0.1 wide around (0.04, 1) passes the corner at (0, 1), 0.04 "
            "away; make it no wider than 0.08, or move it by 0.01 along the side");
  EXPECT_TRUE(says(at("at = [0, 0]\nwidth = 0.1\n"), "(0, 0) is a corner; move it by 0.05, half the width"));
  EXPECT_TRUE(says(at("at = [1, 0]\nwidth = 1e-12\n"), "is lost in the rounding of a body of 2.24"));
  EXPECT_TRUE(says(at("at = [0.5, 0]\nwidth = 1\n[[load]]\nat = [1.2, 0]\nforce = [0, 1]\nwidth = 0.5\n"),
                   "a.toml:14:9: width in [[load]]: it overlaps with \"load-1\" around (0.5, 0), which is 1 wide"));
  EXPECT_TRUE(says(at(""), "missing key \"at\""));
  EXPECT_TRUE(says(error(square + "[[load]]\nat = [1, 1]\n"), "missing key \"force\""));
  EXPECT_TRUE(
      says(error(square + "[[load]]\nat = [1, 1]\nforce = [0, \"x\"]\n"), "a force is one number per component"));
  EXPECT_TRUE(says(error(square + "[[load]]\nat = [1, 1]\nforce = [0, 1]\nname = \"top\"\n"),
                   "there is a label \"top\" already"));
  EXPECT_TRUE(says(error(square + "[[boundary]]\nat = [1, 1]\non = \"top\"\ndisplacement_y = 0\n"), "on"));
  EXPECT_TRUE(says(error(square + "[[boundary]]\nat = [1, 1]\nsymmetry = true\n"), "symmetry"));
  EXPECT_TRUE(
      says(error("[domain]\noutline = [[0, 0], [1, 0], [2, 0], [2, 1], [0, 1]]\nsides = [\"a\", \"b\", \"c\", \"d\", "
                 "\"e\"]\n[material]\nyoung = 1\npoisson = 0\n[[load]]\nat = [1, 0]\nforce = [0, 1]\n"),
           "it lies on \"a\" and on \"b\""));
}

TEST(PointsOfForce, AreNamedByLoadCases) {
  const std::string two = square + R"([[boundary]]
on = "bottom"
displacement = [0, 0]
[[load]]
at = [1, 1]
name = "punch"
[[load_case]]
name = "down"
boundary = [{ on = "punch", traction = [0, -1] }]
[[load_case]]
name = "along"
boundary = [{ on = "punch", traction = [1, 0] }]
[functional]
kind = "compliance"
[optimize]
volume = { at_most = 0.9 }
)";
  EXPECT_EQ(read(two).optimize->load_cases.size(), 2u);
  EXPECT_TRUE(says(error(two, {"load[0].force=[0, 1]"}), "with [[load_case]] all loads belong to load cases"));
}

}  // namespace
}  // namespace kerf::points_of_force_test
