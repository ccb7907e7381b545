// Boxes of what is drawn, and where it begins in them.

#include "tests/io/case/case_files.hpp"

namespace kerf::design_variables_test {
namespace {

const std::string plate = square + R"([[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [1, 0]
[functional]
kind = "compliance"
[optimize]
method = "mma"
)";  // 17 lines

std::vector<double> numbers(const Eigen::VectorXd& x) {
  return {x.begin(), x.end()};
}

TEST(DesignVariables, AnEllipseWithoutAnAngleIsNotTurned) {
  const Case c =
      read(plate + "[[optimize.hole]]\nellipse = { center = [1, [0.4, 0.6]], semi_axes = [[0.1, 0.3], 0.1] }\n");
  const Drawn& egg = c.optimize->design.drawn.at(0);
  EXPECT_EQ(numbers(egg.lower), (std::vector<double>{1, 0.4, 0.1, 0.1, 0}));
  EXPECT_EQ(numbers(egg.upper), (std::vector<double>{1, 0.6, 0.3, 0.1, 0}));
  EXPECT_EQ(numbers(egg.start), (std::vector<double>{1, 0.5, 0.2, 0.1, 0}));
}

TEST(DesignVariables, ACrackBeginsWhereItsStartSays) {
  const std::string boxes = "[[optimize.crack]]\npath = [[[0.2, 1], [0.2, 0.8]], [[0.2, 1], [0.2, 0.8]]]\n";
  const Case c = read(plate + boxes + "start = { path = [[0.25, 0.5], [0.75, 0.625]] }\n");
  EXPECT_EQ(numbers(c.optimize->design.drawn.at(0).start), (std::vector<double>{0.25, 0.5, 0.75, 0.625}));
  const auto wrong = [&](const std::string& start) { return error(plate + boxes + start); };
  EXPECT_EQ(wrong("start = { path = [[0.25, 0.5]] }"),
            "a.toml:19:18: path in start in [[optimize.crack]] has 1 points; the path has 2");
  EXPECT_EQ(wrong("start = { path = [[0.25, 0.5], [0.75, 0.9]] }"),
            "a.toml:19:39: entry 2 of entry 2 of path in start in [[optimize.crack]] = 0.9 lies outside its box [0.2, "
            "0.8]");
  EXPECT_EQ(wrong("start = { path = [[0.25, 0.5], [0.25, 0.5]] }"),
            "a.toml:19:9: start in [[optimize.crack]]: points 1 and 2 begin at the same place");
  EXPECT_EQ(
      wrong(""),
      "a.toml:18:8: path in [[optimize.crack]]: points 1 and 2 begin at the same place, the middle of their boxes; "
      "add start = { path = [[x, y], ...] }");
}

}  // namespace
}  // namespace kerf::design_variables_test
