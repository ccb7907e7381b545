// Bodies that a design begins with, and holes drawn as outlines, which designs are made of.

#include "geometry/plane.hpp"
#include "tests/io/case/case_files.hpp"

namespace kerf::start_design_test {

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
  // The hole goes by its name, too.
  const Case named = read(square + hole + "sides = \"rim\"\n[[boundary]]\non = \"h\"\npressure = 1\n");
  EXPECT_EQ(named.shape.labels[std::size_t(named.scene.tractions.at(0).label)], "rim");
  // A part of another hole may be joined to this one; what is no name stays none.
  const Shape joined = read(square + hole + "sides = [\"hole:bore\", \"rim\"]\n").shape;
  EXPECT_EQ(joined.labels[std::size_t(joined.holes[0].sides[0].label)], "hole:bore");
  for (const char* sides : {"\"hole:\"", "\"a b\"", "[\"top\", \"hole:a/b\"]"})
    EXPECT_NE(error(square + hole + "sides = " + sides + "\n").find("must be a name of letters"), std::string::npos);
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

}  // namespace kerf::start_design_test
