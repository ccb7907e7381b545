// [[step]]: values of [define] along a history.
#include "tests/io/case/case_files.hpp"

namespace kerf::step_test {
namespace {

const std::string sheared = square + R"([define]
press = 0
shear = 0.5
[[boundary]]
on = "top"
traction = ["shear", "-press"]
)";

TEST(Steps, AreScenesOnStraightLinesBetweenValues) {
  const Case c = read(sheared + R"([[step]]
name = "press"
define = { press = 2, shear = 0 }
[[step]]
name = "shear"
define = { shear = 0.9 }
substeps = 3
)");
  ASSERT_EQ(c.steps.size(), 4U);
  const auto traction = [&](std::size_t k) { return c.steps[k].scene.tractions[0].value({1, 2}, {0, 1}); };
  EXPECT_EQ(traction(0), Vec2(0, -2));
  EXPECT_NEAR((traction(1) - Vec2(0.3, -2)).norm(), 0, 1e-15);
  EXPECT_NEAR((traction(2) - Vec2(0.6, -2)).norm(), 0, 1e-15);
  EXPECT_EQ(traction(3), Vec2(0.9, -2));
  EXPECT_EQ(c.scene.tractions[0].value({1, 2}, {0, 1}), Vec2(0.9, -2));
  EXPECT_EQ(c.steps[1].name, "shear");
  EXPECT_EQ(c.steps[1].part, 1);
  EXPECT_EQ(c.steps[1].parts, 3);
  ASSERT_EQ(c.steps[2].values.size(), 2U);
  EXPECT_EQ(c.steps[2].values[0].first, "press");
  EXPECT_EQ(c.steps[2].values[0].second, 2);
  EXPECT_TRUE(read(sheared).steps.empty());
}

TEST(Steps, RefuseWhatTheyCannotChange) {
  const auto step = [](const std::string& define) {
    return error(sheared + "[[step]]\nname = \"a\"\ndefine = { " + define + " }\n");
  };
  EXPECT_NE(step("pres = 1").find("[define] has no name \"pres\"; did you mean \"press\""), std::string::npos)
      << step("pres = 1");
  EXPECT_NE(step("").find("changes nothing"), std::string::npos);
  EXPECT_NE(step("press = \"x\"").find("press"), std::string::npos);
  EXPECT_NE(error(sheared + "[[step]]\nname = \"a\"\n").find("missing key \"define\" in [[step]]"), std::string::npos);
  EXPECT_NE(error(sheared + "[[step]]\nname = \"a\"\ndefine = { press = 1 }\nsubsteps = 0\n").find("substeps"),
            std::string::npos);
  EXPECT_NE(error(sheared + "[[step]]\nname = \"a\"\ndefine = { press = 1 }\n[[step]]\nname = \"a\"\ndefine = { press "
                            "= 2 }\n")
                .find("\"a\""),
            std::string::npos);
  EXPECT_NE(error(square + "[define]\nload = \"1 + x\"\n[[boundary]]\non = \"top\"\ntraction = [0, \"load\"]\n"
                           "[[step]]\nname = \"a\"\ndefine = { load = 1 }\n")
                .find("\"load\" in [define] is an expression; steps change numbers alone"),
            std::string::npos);
}

}  // namespace
}  // namespace kerf::step_test
