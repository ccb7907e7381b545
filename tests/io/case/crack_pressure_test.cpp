// The key `pressure` of [[crack]].
#include "io/design.hpp"
#include "tests/io/case/case_files.hpp"

namespace kerf::crack_pressure_test {
namespace {

const std::string cracked = square + R"([[crack]]
name = "c"
path = [[0.5, 0.5], [1, 0.5]]
)";

TEST(CrackPressure, IsANumberOrAnExpression) {
  const Case number = read(cracked + "pressure = 0.5\n");
  ASSERT_TRUE(has_pressure(number.scene.laws[0]));
  EXPECT_EQ(number.scene.laws[0].pressure({0.7, 0.5}, {0, 1}), Vec2(0.5, 0));
  const Case suction = read(cracked + "pressure = -2\ncontact = \"open\"\n");
  EXPECT_EQ(suction.scene.laws[0].pressure({0.7, 0.5}, {0, 1}), Vec2(-2, 0));
  const Case formula = read(cracked + "pressure = \"deep * x\"\nfriction = 0.3\n[define]\ndeep = \"1 - y\"\n");
  EXPECT_EQ(formula.scene.laws[0].pressure({0.7, 0.5}, {0, 1}), Vec2(0.35, 0));
  EXPECT_EQ(formula.scene.laws[0].friction, 0.3);
  ASSERT_TRUE(formula.scene.laws[0].pressure.known());
  EXPECT_EQ(formula.scene.laws[0].pressure.known()->degree(), 2);
  EXPECT_FALSE(has_pressure(read(cracked).scene.laws[0]));
}

TEST(CrackPressure, IsRefusedByNameWhereItHasNoMeaning) {
  EXPECT_EQ(error(cracked + "contact = \"bonded\"\npressure = 1\n"),
            "a.toml:11:12: pressure in [[crack]]: crack \"c\" is bonded and has no faces for a pressure; change its "
            "contact, or leave the pressure out");
  EXPECT_NE(error(cracked + "pressure = \"nx\"\n").find("a.toml:10:12: pressure in [[crack]]: "), std::string::npos);
  EXPECT_NE(error(cracked + R"(pressure = 1
[functional]
kind = "energy_release_rate"
crack = "c"
tip = "end"
)")
                .find("the faces of crack \"c\" carry a pressure, whose work energy_release_rate does not count"),
            std::string::npos);
  EXPECT_NE(error(cracked + R"(pressure = 1
[[boundary]]
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
)")
                .find("a.toml:10:12: pressure in [[crack]]: with [[load_case]] all loads belong to load cases"),
            std::string::npos);
  EXPECT_NE(error(square + R"([[boundary]]
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
[[synthetic.crack]]
name = "s"
path = [[0.5, 0.5], [1, 0.5]]
pressure = 1
)")
                .find("a crack that is to be found carries no load; leave the pressure out"),
            std::string::npos);
}

TEST(CrackPressure, StaysInTheFileOfADesign) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", cracked + "pressure = \"deep\"\n[define]\ndeep = \"1 - y\"\n"));
  const Case back =
      read_case(folder.write("design.toml", design_case(c, {c.shape, c.scene.laws, {}, {}}, folder.path)));
  ASSERT_TRUE(has_pressure(back.scene.laws[0]));
  EXPECT_EQ(back.scene.laws[0].pressure({0.7, 0.5}, {0, 1}), Vec2(0.5, 0));
}

}  // namespace
}  // namespace kerf::crack_pressure_test
