// What a case asks for: how fine, how thick, for which quantity, and where that is written.

#include "tests/io/case/case_files.hpp"
#include "tests/io/mesh/meshes.hpp"

namespace kerf::requests_test {
namespace {

TEST(Request, RefinesForAQuantity) {
  const std::string cracked = square + "[[crack]]\nname = 'c'\npath = [[0.5, 0.5], [1, 0.5]]\ncontact = 'open'\n" +
                              "[[crack]]\nname = 'd'\npath = [[1.5, 0.5], [1.7, 0.5]]\ncontact = 'open'\n[mesh]\n";
  const auto goal = [&](const std::string& keys) {
    return *read(cracked + "adapt = { error = 0.01, " + keys + " }\n").adapt->of;
  };
  const GoalRequest tip = goal("of = 'K_II', crack = 'd', tip = 'start'");
  EXPECT_EQ(tip.quantity, "K_II");
  EXPECT_EQ(tip.crack, 1);
  EXPECT_TRUE(tip.at_start);
  EXPECT_FALSE(goal("of = 'G', crack = 'c', tip = 'end'").at_start);
  const GoalRequest point = goal("of = 's_xy', at = [0.25, 0.75]");
  EXPECT_EQ(point.quantity, "s_xy");
  EXPECT_EQ(point.at, Vec2(0.25, 0.75));
  EXPECT_EQ(goal("of = 'energy'").quantity, "energy");
  EXPECT_FALSE(read(cracked + "adapt = { error = 0.01 }").adapt->of);

  const auto wrong = [&](const std::string& keys) {
    return error(cracked + "adapt = { error = 0.01, " + keys + " }\n");
  };
  EXPECT_EQ(wrong("tip = 'end'"), "a.toml:16:31: tip in [adapt] goes with of, the quantity to bound");
  EXPECT_EQ(wrong("of = 'K_I', crack = 'c', tip = 'end', at = [0, 0]"),
            "a.toml:16:68: at in [adapt] does not go with of = \"K_I\"");
  EXPECT_EQ(wrong("of = 'energy', at = [0, 0]"), "a.toml:16:45: at in [adapt] does not go with of = \"energy\"");
  EXPECT_EQ(wrong("of = 's_xx', crack = 'c', at = [0, 0]"),
            "a.toml:16:46: crack in [adapt] does not go with of = \"s_xx\"");
  EXPECT_EQ(wrong("of = 's_xx'"), "a.toml:16:9: missing key \"at\" in [adapt]; add it");
  EXPECT_EQ(wrong("of = 'K_I', tip = 'end'"), "a.toml:16:9: missing key \"crack\" in [adapt]; add it");
  EXPECT_EQ(wrong("of = 'K_I', crack = 'e', tip = 'end'"),
            "a.toml:16:45: crack in [adapt]: there is no crack \"e\"; known: c, d");
  EXPECT_EQ(error(square + "[mesh]\nadapt = { error = 0.01, of = 'G', crack = 'e', tip = 'end' }"),
            "a.toml:8:43: crack in [adapt]: there is no crack \"e\"; the body has none");
}

TEST(Request, KnowsTheThicknessOfPlates) {
  EXPECT_EQ(read(square + "state = 'plane stress'\nthickness = 0.25\n").thickness, 0.25);
  EXPECT_FALSE(read(square).thickness);
  EXPECT_EQ(error(square + "thickness = 0.25\n"),
            "a.toml:7:13: material.thickness is that of a plate in plane stress; write state = \"plane stress\", or "
            "leave it out");
  EXPECT_EQ(error(square + "state = 'plane stress'\nthickness = 0\n"),
            "a.toml:8:13: thickness in [material] must be positive, not 0");
}

TEST(Request, FindsThePlaceOfEveryKey) {
  const Case c = read(square + "[[crack]]\nname = 'c'\npath = [[0.5, 0.5], [1, 0.5]]\n[mesh]\nsize = 0.1\n");
  const auto place = [&](const std::string& key) {
    const std::string full = place_of(c, key);
    return full.substr(full.rfind("a.toml"));
  };
  EXPECT_EQ(place("mesh.size"), "a.toml:11:8");
  EXPECT_EQ(place("crack[0].path[1]"), "a.toml:9:21");
  EXPECT_EQ(place("domain.sides[2]"), "a.toml:3:29");
  // What there is not stands where the table around it stands.
  EXPECT_EQ(place("crack[0].path[1][0]"), "a.toml:9:21");
  EXPECT_EQ(place("crack[0].arc.radius"), "a.toml:7:1");
  EXPECT_EQ(place("mesh.adapt.error"), "a.toml:10:1");
  EXPECT_EQ(place("optimize.method"), "a.toml:1:1");
}

TEST(Request, IsTheProblemThatAnOptimizationSolves) {
  const Case c = read(square + "state = 'plane stress'\n[mesh]\nsize = 0.1\n[solver]\nelement = 'afw'\n" +
                      "contact = 'uzawa'\n[functional]\nkind = 'volume'\n");
  const Problem p = problem_of(c, 3);
  EXPECT_EQ(p.frame.labels, c.shape.labels);
  EXPECT_EQ(p.scene.material.c, c.scene.material.c);
  EXPECT_EQ(p.sizing.size, 0.1);
  EXPECT_EQ(p.element.name, "afw");
  EXPECT_EQ(p.objective.kind, "volume");
  EXPECT_EQ(p.contact, ContactMethod::Uzawa);
  EXPECT_FALSE(p.plane_strain);
  EXPECT_EQ(p.threads, 3);
}

TEST(Request, CurvedSidesNeedAnElementAndADrawing) {
  EXPECT_EQ(read(square + "[mesh]\nrefine = 2\n").divisions, 2);
  EXPECT_TRUE(read(square + "[mesh]\nrefine = 1\ncurved = true\n").sizing.curved);
  EXPECT_EQ(error(square + "[mesh]\ncurved = 'maybe'\n"),
            "a.toml:8:10: curved in [mesh] is true, false or \"auto\", not \"maybe\"");
  const std::string curved = "[mesh]\ncurved = true\n";
  EXPECT_TRUE(read(square + curved + "[solver]\ndegree = 2\n").sizing.curved);
  EXPECT_EQ(error(square + curved + "[solver]\nelement = 'peers'\n").substr(0, 34),
            "a.toml:8:10: curved in [mesh]: ele");
  const std::string file =
      "[domain]\nfile = '" + meshes::file("gmsh41").string() + "'\n[material]\nyoung = 1\npoisson = 0.3\n";
  EXPECT_EQ(error(file + curved + "[solver]\ndegree = 2\n"),
            "a.toml:7:10: curved in [mesh]: the mesh in domain.file has straight edges; save it with second order "
            "(gmsh: Mesh.ElementOrder = 2), or leave this out");
}

// Edges follow the curves of a body wherever the job can; of the iterations of an optimization never.
TEST(Request, EdgesFollowCurvesByThemselves) {
  const std::string hole = "[[hole]]\nname = 'h'\ncircle = { center = [0.5, 0.5], radius = 0.2 }\n";
  const Case c = read(square + hole);
  EXPECT_TRUE(c.sizing.curved);
  EXPECT_EQ(c.element.degree, 2);
  EXPECT_FALSE(problem_of(c).sizing.curved);
  EXPECT_EQ(problem_of(c).element.degree, 1);
  EXPECT_FALSE(read(square).sizing.curved);
  EXPECT_FALSE(read(square + hole + "[mesh]\ncurved = false\n").sizing.curved);
  const Case divided = read(square + hole + "[mesh]\nrefine = 1\n");
  EXPECT_TRUE(divided.sizing.curved);
  EXPECT_EQ(divided.why_chords, "");
  EXPECT_EQ(read(square + hole + "[solver]\nelement = 'afw'\n").element.degree, 2);
  EXPECT_EQ(read(square + hole + "[solver]\nelement = 'peers'\n").element.degree, 1);
  EXPECT_NE(read(square + hole + "[solver]\nelement = 'peers'\n").why_chords.find("peers"), std::string::npos);
  EXPECT_EQ(problem_of(read(square + hole + "[solver]\ndegree = 3\n")).element.degree, 3);
}

// The arc from the last corner to the first one is the first entry.
TEST(Request, AnOutlineDoesNotEndWhereItBegins) {
  EXPECT_NE(error("[domain]\noutline = [[1, 0], [2, 0], [0, 2], { arc_to = [1, 0], center = [0, 0] }]\n"
                  "sides = ['a', 'b', 'c']\n[material]\nyoung = 1\npoisson = 0.3\n")
                .find("begin the outline with this arc"),
            std::string::npos);
}

}  // namespace
}  // namespace kerf::requests_test
