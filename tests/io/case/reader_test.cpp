// Values from the command line, marks of encoding and limits of the file, against the case they give or the whole
// message.

#include "tests/io/case/case_files.hpp"

namespace kerf::reader_test {
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

TEST(Override, NeedsNoQuotesThatTheShellEats) {
  const Case c =
      read(square + "[[boundary]]\non = 'top'\ntraction = [0, 1]\n",
           {"solver.element=peers", "title=A plate, new", "mesh.size=.5", "material.young=2.", "boundary[0].on=right"});
  EXPECT_EQ(c.element.name, "peers");
  EXPECT_EQ(c.title, "A plate, new");
  EXPECT_EQ(c.sizing.size, 0.5);
  EXPECT_EQ(c.young, 2);
  EXPECT_EQ(c.scene.tractions.at(0).label, 1);
  EXPECT_EQ(error(square, {"solver.element=peeers"}),
            "--set solver.element: unknown element in [solver] \"peeers\"; did you mean \"peers\"?");
}

TEST(MarksOfEncoding, AreReadOver) {
  const std::string mark = "\xef\xbb\xbf";
  EXPECT_EQ(read(mark + square).young, 10);
  EXPECT_EQ(error(mark + "a = 1\n" + square).substr(0, 12), "a.toml:1:1: ");
  const TemporaryFolder folder;
  folder.write("p.csv", mark + "x,y\r\n0.5,0.25\r\n");
  const Case c = read_case(folder.write("a.toml", square + "[[probe]]\nname = 'p'\nfile = 'p.csv'\n"));
  ASSERT_EQ(c.probes.at(0).points.size(), 1u);
  EXPECT_EQ(c.probes[0].points[0], Vec2(0.5, 0.25));
  EXPECT_NE(error(std::string("\xff\xfe[\0", 4)).find("a.toml:1:1: the file is UTF-16; save it as UTF-8"),
            std::string::npos);
}

// They stand in messages as they are.
TEST(KeysAndNamesOfFiles, HaveNoControlCharacters) {
  for (const char* odd : {"\\u001b[2J", "\\u0000", "\\n", "\\u007f"}) {
    const std::string text = std::string("\"a") + odd + "b\"";
    EXPECT_NE(error(square + "[define]\n" + text + " = '1'\n").find("a.toml:8:1: the key \"a "), std::string::npos)
        << error(square + "[define]\n" + text + " = '1'\n");
    const std::string probe = square + "[[probe]]\nname = 'p'\nfile = " + text + "\n";
    EXPECT_NE(error(probe).find("a.toml:9:8: the name of a file \"a "), std::string::npos) << error(probe);
  }
}

// Dots in texts are no parts of a key, however the text is quoted; those behind it are.
TEST(DottedKeys, AreCountedOutsideTexts) {
  std::string dots = "a";
  for (int k = 0; k < 60; ++k) dots += ".a";
  for (const std::string& quotes :
       {std::string(1, '"'), std::string(1, '\''), std::string(3, '"'), std::string(3, '\'')}) {
    EXPECT_EQ(read("title = " + quotes + dots + quotes + "\n" + square).title, dots);
    EXPECT_EQ(error("title = " + quotes + "b" + quotes + "\n" + dots + " = 1\n" + square),
              "a.toml:1:1: a dotted key has more than 32 parts");
  }
  EXPECT_EQ(read("title = \"\"\"\n\"" + dots + "\\\"\"\" # " + dots + "\"\"\" # " + dots + "\n" + square).title,
            "\"" + dots + "\"\"\" # " + dots);
  for (const char* open : {"\"\"\"", "\"\"\"a\\", "\'\'\'"})
    EXPECT_NE(error("title = " + std::string(open)).find("the text does not end"), std::string::npos)
        << error("title = " + std::string(open));
}

TEST(Tables, SayWhatOtherCountriesWrite) {
  const auto said = [](const std::string& table) -> std::string {
    const TemporaryFolder folder;
    folder.write("p.csv", table);
    try {
      read_case(folder.write("a.toml", square + "[[probe]]\nname = 'p'\nfile = 'p.csv'\n"));
    } catch (const Error& e) {
      return std::string(e.what()).substr(folder.path.string().size() + 1);
    }
    return "";
  };
  EXPECT_EQ(said("x;y\n0,5;1\n"), "p.csv:1:1: cells are separated by commas here, and numbers have points: 0.5,1");
  EXPECT_EQ(said("x,y\n0,5,1,5\n"), "p.csv:2:1: 4 cells instead of 2; decimal commas? write points: 0.5,1");
}

TEST(Override, IsCheckedLikeTheFile) {
  EXPECT_EQ(error(square, {"mesh.sise=1"}), "--set mesh.sise: unknown key \"sise\" in [mesh]; did you mean \"size\"?");
  EXPECT_EQ(error(square, {"mesh.size=-1"}), "--set mesh.size: size in [mesh] must be positive, not -1");
  EXPECT_EQ(error(square, {"material.young=\"a\""}),
            "--set material.young: young in [material] must be a number, not \"a\"");
}

TEST(Override, BadOnesAreNamed) {
  EXPECT_EQ(error(square, {"mesh.size"}), "--set \"mesh.size\": a value is missing; write key=value");
  EXPECT_EQ(error(square, {"mesh.size=0,02"}), "--set mesh.size: \"0,02\": a decimal comma? write 0.02");
  EXPECT_EQ(error(square, {"mesh.size="}), "--set mesh.size: \"\" is no value; write a number, a word, or '[1, 2]'");
  EXPECT_EQ(error(square, {"mesh.size=5mm"}), "--set mesh.size: size in [mesh] must be a number, not \"5mm\"");
  EXPECT_EQ(error(square, {"mesh.size=1\nmaterial=2"}).find("--set mesh.size: "), 0u);
  EXPECT_EQ(error(square, {"crack[0].name='c'"}), "--set crack[0].name: an index into what is no list");
  EXPECT_EQ(error(square, {"domain.sides[4]='c'"}),
            "--set domain.sides[4]: there is no [4]; the list has 4 entries, counted from 0");
  EXPECT_EQ(error(square, {"domain.sides.a='c'"}),
            "--set domain.sides.a: \"a\" needs an index before it, counted from 0: [0].a");
  const std::string cracked = square + "[[crack]]\nname = 'c'\npath = [[0.5, 0.5], [1, 0.5]]\n";
  EXPECT_EQ(error(cracked, {"crack.d.contact=open"}),
            "--set crack.d.contact: \"d\" needs an index before it, counted from 0: [0].d; or a name: c");
  EXPECT_EQ(error(cracked, {"crack.c.friction=-1"}).find("--set crack.c.friction: "), 0u);
  EXPECT_EQ(error(square + "[[crack]]\nname = 3\npath = [[0.5, 0.5], [1, 0.5]]\n", {"crack.c.friction=1"}),
            "--set crack.c.friction: \"c\" needs an index before it, counted from 0: [0].c");
  EXPECT_EQ(error(square, {"material.young.a=1"}),
            "--set material.young.a: \"a\" would lie inside a value that is no table");
  for (const char* bad :
       {"=1", "a..b=1", "[0]=1", "a[=1", "a[x]=1", "a b=1", ".a=1", "a.=1", "a[0=1", "a[99999999999999999999]=1"})
    EXPECT_NE(error(square, {bad}).find("is not the path of a key"), std::string::npos) << bad;
}

}  // namespace
}  // namespace kerf::reader_test
