// [[interface]]: keys, and what is refused by name.
#include "tests/io/case/case_files.hpp"

namespace kerf::interface_test {
namespace {

const std::string layered = R"([domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[[region]]
name = "upper"
polygon = [[0, 0.5], [2, 0.5], [2, 1], [0, 1]]
young = 2
poisson = 0.3
[[region]]
name = "disc"
circle = { center = [1, 0.25], radius = 0.1 }
young = 2
poisson = 0.3
[material]
young = 1
poisson = 0.3
[[interface]]
name = "joint"
)";

TEST(InterfaceCase, IsACrackInContact) {
  const Case c = read(layered + R"(between = ["body", "upper"]
friction = 0.2
gap = "-a * x"
[[interface]]
name = "pin"
between = ["disc", "body"]
contact = false
[define]
a = "0.01"
)");
  ASSERT_EQ(c.shape.cracks.size(), 2u);
  EXPECT_EQ(c.shape.cracks[0].name, "joint");
  EXPECT_EQ(c.shape.cracks[0].points.size(), 2u);
  EXPECT_TRUE(c.shape.cracks[1].arc);
  EXPECT_EQ(c.scene.laws[0].kind, CrackLaw::Kind::Unilateral);
  EXPECT_EQ(c.scene.laws[0].friction, 0.2);
  EXPECT_NEAR(c.scene.laws[0].gap({0.5, 0.5}, {0, 1}).x(), -0.005, 1e-15);
  EXPECT_FALSE(c.scene.laws[0].normal);
  EXPECT_EQ(c.scene.laws[1].kind, CrackLaw::Kind::Bonded);
  EXPECT_FALSE(has_gap(c.scene.laws[1]));
  EXPECT_LT((c.scene.laws[1].normal({1, 0.34}) - Vec2(0, 1)).norm(), 1e-12);
}

TEST(InterfaceCase, NumbersItsParts) {
  const Case c = read(layered + R"(between = ["strip", "body"]
gap = 0.1
[[region]]
name = "strip"
polygon = [[0.4, 0], [0.6, 0], [0.6, 0.5], [0.4, 0.5]]
young = 2
poisson = 0.3
[[interface]]
name = "top"
between = ["strip", "upper"]
)");
  ASSERT_EQ(c.shape.cracks.size(), 3u);
  EXPECT_EQ(c.shape.cracks[0].name, "joint");
  EXPECT_EQ(c.shape.cracks[1].name, "joint.2");
  EXPECT_TRUE(has_gap(c.scene.laws[0]) && has_gap(c.scene.laws[1]));
  EXPECT_FALSE(has_gap(c.scene.laws[2]));
}

// Outwards of the region, as the level of its ellipse grows.
TEST(InterfaceCase, KnowsTheNormalOfAnEllipse) {
  const Case c = read(layered + R"(between = ["oval", "body"]
[[region]]
name = "oval"
ellipse = { center = [0.5, 0.25], semi_axes = [0.2, 0.1], angle_deg = 90 }
young = 2
poisson = 0.3
)");
  ASSERT_EQ(c.scene.laws.size(), 1u);
  for (const double t : {0.0, 0.7, 2.0, 4.0}) {
    const Vec2 x(0.5 - 0.1 * std::sin(t), 0.25 + 0.2 * std::cos(t));
    const Vec2 outward = Vec2(-std::sin(t) / 0.1, std::cos(t) / 0.2).normalized();
    EXPECT_LT((c.scene.laws[0].normal(x) - outward).norm(), 1e-12) << t;
  }
}

TEST(InterfaceCase, SaysWhatIsWrong) {
  const auto wrong = [](const std::string& rest) { return error(layered + rest); };
  EXPECT_EQ(
      wrong("between = [\"uper\", \"body\"]\n"),
      "a.toml:19:12: entry 1 of between in [[interface]]: there is no [[region]] \"uper\"; did you mean \"upper\"?");
  EXPECT_NE(wrong("between = [\"upper\"]\n").find("has 1 entries; an interface lies between two regions"),
            std::string::npos);
  EXPECT_NE(wrong("between = [\"upper\", \"upper\"]\n").find("names \"upper\" twice"), std::string::npos);
  EXPECT_NE(wrong("between = [\"upper\", \"disc\"]\n")
                .find("\"upper\" and \"disc\" have no border in common inside the body; \"upper\" meets \"body\""),
            std::string::npos);
  const std::string twice =
      "between = [\"upper\", \"body\"]\n[[interface]]\nname = \"again\"\nbetween = [\"body\", \"upper\"]\n";
  EXPECT_NE(wrong(twice).find("interface \"joint\" lies between \"upper\" and \"body\" already"), std::string::npos);
  const std::string bonded = "between = [\"upper\", \"body\"]\ncontact = false\n";
  EXPECT_NE(wrong(bonded + "friction = 0.1\n").find("a bonded interface does not slide"), std::string::npos);
  EXPECT_EQ(wrong(bonded + "friction = 0\n"), "no error");
  EXPECT_EQ(wrong("between = [\"body\", \"upper\"]\n[[region]]\nname = \"body\"\n"
                  "circle = { center = [1.5, 0.25], radius = 0.1 }\nyoung = 1\npoisson = 0.3\n"),
            "a.toml:19:12: entry 1 of between in [[interface]]: \"body\" is what lies outside all regions, and a "
            "[[region]] has that name, too; give the region another one");
  EXPECT_NE(wrong(bonded + "gap = 0.1\n").find("the faces of a bonded interface are one"), std::string::npos);
  EXPECT_NE(wrong("between = [\"upper\", \"body\"]\n[[crack]]\nname = \"joint\"\npath = [[0.5, 0.8], [1, 0.8]]\n")
                .find("name in [[interface]]"),
            std::string::npos);
}

}  // namespace
}  // namespace kerf::interface_test
