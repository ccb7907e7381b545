#include "tests/io/case/case_files.hpp"

namespace kerf {
namespace {

TEST(Override, ReplacesAndAdds) {
  const std::string text = square +
                           "[[crack]]\nname = 'c'\npath = [[0.5, 0.5], [1, 0.5]]\n"
                           "[[boundary]]\non = 'top'\ntraction = ['r', 0]\n[define]\nr = 'x'\n";
  const Case c = read(text, {"mesh.size=0.02", "crack[0].contact=\"open\"", "crack[0].path[1]=[1.5, 0.5]",
                             "boundary[0].traction = [0, \"s\"]", "define.s=\"2*r\"", "title='new'"});
  EXPECT_EQ(c.title, "new");
  EXPECT_EQ(c.sizing.size, 0.02);
  EXPECT_EQ(c.scene.laws[0].kind, CrackLaw::Kind::Open);
  EXPECT_EQ(c.shape.cracks[0].points[1], Vec2(1.5, 0.5));
  EXPECT_EQ(c.scene.tractions.at(0).value({3, 0}, {0, 1}), Vec2(0, 6));
}

TEST(Override, IsCheckedLikeTheFile) {
  EXPECT_EQ(error(square, {"mesh.sise=1"}), "--set mesh.sise: unknown key \"sise\" in [mesh]; did you mean \"size\"?");
  EXPECT_EQ(error(square, {"mesh.size=-1"}), "--set mesh.size: size in [mesh] must be positive, not -1");
  EXPECT_EQ(error(square, {"material.young=\"a\""}),
            "--set material.young: young in [material] must be a number, not \"a\"");
}

TEST(Override, BadOnesAreNamed) {
  EXPECT_EQ(error(square, {"mesh.size"}), "--set \"mesh.size\": a value is missing; write key=value");
  EXPECT_EQ(error(square, {"solver.element=bdms"}),
            "--set solver.element: \"bdms\" is not a TOML value; a string needs its own quotes: --set "
            "'solver.element=\"bdms\"'");
  EXPECT_EQ(error(square, {"mesh.size=1\nmaterial=2"}).find("--set mesh.size: "), 0u);
  EXPECT_EQ(error(square, {"crack[0].name='c'"}), "--set crack[0].name: an index into what is no list");
  EXPECT_EQ(error(square, {"domain.sides[4]='c'"}),
            "--set domain.sides[4]: there is no [4]; the list has 4 entries, counted from 0");
  EXPECT_EQ(error(square, {"domain.sides.a='c'"}),
            "--set domain.sides.a: \"a\" needs an index before it, counted from 0: [0].a");
  EXPECT_EQ(error(square, {"material.young.a=1"}),
            "--set material.young.a: \"a\" would lie inside a value that is no table");
  for (const char* bad :
       {"=1", "a..b=1", "[0]=1", "a[=1", "a[x]=1", "a b=1", ".a=1", "a.=1", "a[0=1", "a[99999999999999999999]=1"})
    EXPECT_NE(error(square, {bad}).find("is not the path of a key"), std::string::npos) << bad;
}

}  // namespace
}  // namespace kerf
