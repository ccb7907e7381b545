// `symmetry` of [[boundary]]: what it becomes, and what cannot be a plane of symmetry.
#include "tests/io/case/case_files.hpp"

namespace kerf::symmetry_test {
namespace {

const std::string half = R"([domain]
outline = [[0, 0], [0.5, 0], [2, 0], [2, 1], [0, 1]]
sides = ["face", "ligament", "right", "top", "left"]
[material]
young = 10
poisson = 0.25
[[boundary]]
on = "ligament"
symmetry = true
)";

bool says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

TEST(Symmetry, HoldsTheNormalAloneAndRefinesTheTip) {
  const Case c = read(half);
  ASSERT_EQ(c.scene.supports.size(), 1u);
  EXPECT_TRUE(c.scene.supports[0].normal_frame && c.scene.supports[0].first && !c.scene.supports[0].second);
  EXPECT_EQ(c.planes, std::vector<Index>{1});
  ASSERT_EQ(c.half_tips.size(), 1u);
  EXPECT_EQ(c.half_tips[0], Vec2(0.5, 0));
  // A short side on either side of the tip, of crack_tip_size, by default a hundredth of the size.
  const double tip = std::sqrt(5.0) / 4000;
  ASSERT_EQ(c.shape.outline.sides.size(), 7u);
  EXPECT_NEAR(c.shape.outline.sides[1].start.x(), 0.5 - tip, 1e-12);
  EXPECT_NEAR(c.shape.outline.sides[3].start.x(), 0.5 + tip, 1e-12);
  EXPECT_EQ(read(half, std::vector<std::string>{"mesh.crack_tip_size=0.1"}).shape.outline.sides[1].start.x(), 0.4);
  // What is read again is as it was.
  EXPECT_EQ(read(half + "[[boundary]]\non = \"face\"\ndisplacement = [0, 0]\n").shape.outline.sides.size(), 5u);
}

TEST(Symmetry, ExcludesWhatContradictsIt) {
  for (const char* other : {"displacement = [0, 0]", "displacement_x = 0", "displacement_normal = 0",
                            "traction = [1, 0]", "pressure = 1"}) {
    const std::string said = error(half + "[[boundary]]\non = \"ligament\"\n" + other + "\n");
    EXPECT_TRUE(says(said, "label \"ligament\"") && says(said, "symmetry") && says(said, "keep one of them")) << said;
  }
  EXPECT_TRUE(says(error(half + "[body]\nforce = [0, -1]\n"), "a.toml:9:12: symmetry: the body force has a component"))
      << error(half + "[body]\nforce = [0, -1]\n");
  EXPECT_EQ(read(half + "[body]\nforce = [\"1 + x\", \"-y\"]\n").planes.size(), 1u);  // odd in y
  EXPECT_TRUE(says(error(half, {"material.eigenstrain=[0, 0, 0.01]"}), "symmetry: the eigenstrain shears by"));
  EXPECT_EQ(error(half, {"material.eigenstrain=[0.02, 0.01, 0]"}), "no error");
  const std::vector<std::string> wood{"material.young=[10, 5]", "material.shear=3", "material.state=\"plane stress\""};
  EXPECT_EQ(error(half, wood), "no error");
  std::vector<std::string> turned = wood;
  turned.emplace_back("material.angle=30");
  EXPECT_TRUE(says(error(half, turned), "symmetry: the axes of the material are 30 degrees off the plane"))
      << error(half, turned);
  EXPECT_TRUE(says(error(half, {"boundary[0].symmetry=false"}), "says nothing"));
}

TEST(Symmetry, IsStraight) {
  const std::string disc = R"([domain]
outline = [[1, 0], { arc_to = [-1, 0], center = [0, 0] }]
sides = ["arc", "flat"]
[material]
young = 10
poisson = 0.25
[[boundary]]
on = "arc"
symmetry = true
)";
  EXPECT_TRUE(says(error(disc), "a.toml:9:12: symmetry: \"arc\" is curved at (1, 0)")) << error(disc);
  EXPECT_EQ(error(disc, {"boundary[0].on=\"flat\""}), "no error");
  const std::string chords = R"([domain]
outline = [[0, 0], [1, 0.02], [2, 0], [2, 1], [0, 1]]
sides = ["low", "low", "right", "top", "left"]
[material]
young = 10
poisson = 0.25
[[boundary]]
on = "low"
symmetry = true
)";
  EXPECT_TRUE(says(error(chords), "\"low\" is curved at (1, 0.02)")) << error(chords);
  EXPECT_EQ(error(half, {"boundary[0].on=[\"ligament\", \"right\"]"}), "no error");  // two planes
}

TEST(Symmetry, LetsNoTipGrow) {
  EXPECT_TRUE(says(error(half + "[grow]\nlaw = { kind = \"quasi-static\", toughness = 1 }\n"),
                   "[grow]: the crack that ends at (0.5, 0) lies in a plane of symmetry"));
}

}  // namespace
}  // namespace kerf::symmetry_test
