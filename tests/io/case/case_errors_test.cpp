// Case files with a mistake against the whole message: its line, its column, what is wrong and what helps.

#include "tests/io/case/case_files.hpp"

namespace kerf::case_errors_test {
namespace {

struct Wrong {
  const char* after;  // lines appended to the square, the first of which is line 7
  const char* message;
};
void PrintTo(const Wrong& w, std::ostream* out) {
  *out << w.message;
}
class WrongCase : public testing::TestWithParam<Wrong> {};

TEST_P(WrongCase, SaysWhereAndWhat) {
  EXPECT_EQ(error(square + GetParam().after), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Unknown, WrongCase,
    testing::Values(
        Wrong{"youg = 1", "a.toml:7:1: unknown key \"youg\" in [material]; did you mean \"young\"?"},
        Wrong{"density = 1",
              "a.toml:7:1: unknown key \"density\" in [material]; known: young, poisson, shear, angle, thickness, "
              "yield, toughness, release_rate, "
              "eigenstrain, state"},
        Wrong{"[mehs]\nsize = 1", "a.toml:7:2: unknown key \"mehs\"; did you mean \"mesh\"?"},
        Wrong{"[mesh]\n  szie = 1", "a.toml:8:3: unknown key \"szie\" in [mesh]; did you mean \"size\"?"},
        Wrong{"[[hole]]\nname = 'h'\ncircle = { center = [1, 0.5], raduis = 0.1 }",
              "a.toml:9:31: unknown key \"raduis\" in circle in [[hole]]; did you mean \"radius\"?"},
        Wrong{"[[boundary]]\non = 'topp'\npressure = 1",
              "a.toml:8:6: on in [[boundary]]: there is no label \"topp\"; did you mean \"top\"?"},
        Wrong{"[solver]\nelement = 'bmds'",
              "a.toml:8:11: unknown element in [solver] \"bmds\"; did you mean \"bdms\"?"},
        Wrong{"[define]\nr = 'x'", "a.toml:8:1: unused key \"r\" in [define]; use it in an expression or remove it"},
        Wrong{"[define]\nr = 'x'\ns = 'r'\nt = 'r'\n[body]\nforce = ['t', 0]",
              "a.toml:9:1: unused key \"s\" in [define]; use it in an expression or remove it"}));

INSTANTIATE_TEST_SUITE_P(
    Eigenstrains, WrongCase,
    testing::Values(
        Wrong{"eigenstrain = [1e-3, 1e-3]",
              "a.toml:7:15: eigenstrain in [material] has 2 entries; give [xx, yy, xy], in plane strain also [xx, yy, "
              "xy, "
              "zz]"},
        Wrong{"eigenstrain = 1e-3", "a.toml:7:15: eigenstrain in [material] must be a list, not 0.001"},
        Wrong{"eigenstrain = ['1e-3*T', 0, 0]",
              "a.toml:7:16: entry 1 of eigenstrain in [material]: expression \"1e-3*T\", column 6: unknown name \"T\"; "
              "known: x, "
              "y, pi, E, nu"},
        Wrong{"[functional]\nkind = 'misfit'\non = 'top'\nmeasured = 'synthetic'\n[[synthetic.region]]\nname = 's'\n"
              "circle = { center = [1, 0.5], radius = 0.1 }\nyoung = 2\npoisson = 0.3\neigenstrain = [1, 1, 0]",
              "a.toml:16:15: eigenstrain in [[synthetic.region]]: the true body has the eigenstrain of the case; leave "
              "it "
              "out"}));

INSTANTIATE_TEST_SUITE_P(
    NotToml, WrongCase,
    testing::Values(
        Wrong{"young = 2", "a.toml:7:9: young stands twice"},
        Wrong{"[material]",
              "a.toml:7:1: [material] stands twice; put its keys together ([[material]] begins one more where "
              "there may be several)"},
        Wrong{"a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a = 1",
              "a.toml:1:1: a dotted key has more than 32 parts"}));

// What people write who know other formats, and what is said of it; the place stays that of the parser.
INSTANTIATE_TEST_SUITE_P(
    PlainWords, WrongCase,
    testing::Values(
        Wrong{"[mesh]\nsize = 0,02", "a.toml:8:9: \"0,02\": a decimal comma? write 0.02"},
        Wrong{"[mesh]\nsize = 1,5e-3  # mm", "a.toml:8:9: \"1,5e-3\": a decimal comma? write 1.5e-3"},
        Wrong{"[mesh]\nsize = .2", "a.toml:8:8: a number needs a digit before its point: 0.2"},
        Wrong{"[mesh]\nsize = 1.", "a.toml:8:10: a number needs a digit after its point: 1.0"},
        Wrong{"[mesh]\nsize = 1/40",
              "a.toml:8:9: \"1/40\" is no number; an expression needs quotes, a number stands alone (no unit)"},
        Wrong{
            "[mesh]\nsize = 0.2 mm",
            "a.toml:8:12: \"mm\" after the value: text needs quotes, a number stands alone (no unit, no spaces in it)"},
        Wrong{"[mesh]\nsize = 0.2 // fine", "a.toml:8:12: a comment begins with #"},
        Wrong{"[mesh]\nsize: 0.2", "a.toml:8:5: a key and its value are joined by =, not by a colon"},
        Wrong{"[mesh]\nsize == 0.2", "a.toml:8:7: one = is enough: key = value"},
        Wrong{"[mesh]\nsize =", "a.toml:8:7: a value is missing"},
        Wrong{"[mesh", "a.toml:7:6: a header ends with its bracket: [mesh], [[crack]]"},
        Wrong{"[[material]]", "a.toml:7:1: both [material] and [[material]]: use one of them"},
        Wrong{"[solver]\nelement = peers", "a.toml:8:11: text needs quotes: \"peers\""},
        Wrong{"[solver]\nelement = “peers”", "a.toml:8:11: “ is no quotation mark of TOML; write \"...\""},
        Wrong{"[solver]\nelement = \"peers",
              "a.toml:8:17: the text does not end on its line: its second quotation mark is "
              "missing"},
        Wrong{"[body]\nforce = (0, 1)", "a.toml:8:9: a list stands in brackets: [0, 1]"},
        Wrong{"[body]\nforce = [0, x]", "a.toml:8:13: text needs quotes: \"x\""},
        Wrong{"[body]\nforce = [0 1]", "a.toml:8:12: entries of a list are separated by commas"},
        Wrong{"[body]\nforce = [0; 1]",
              "a.toml:8:11: entries of a list are separated by commas; at the end of a line stands nothing"},
        Wrong{"[body]\nforce = [0, 1]]", "a.toml:8:15: one ] too many"},
        Wrong{"[output]\nvtk = False", "a.toml:8:7: true and false are written in small letters"},
        Wrong{"[mesh]\nadapt = { error = 1e-3,\n max_triangles = 5 }",
              "a.toml:8:24: a table in braces stands on one line; use [header] for a long one"},
        Wrong{"% mesh", "a.toml:7:1: a line begins with a key, a [table], or # for a comment"}));

INSTANTIATE_TEST_SUITE_P(
    Types, WrongCase,
    testing::Values(
        Wrong{"state = 1", "a.toml:7:9: state in [material] must be a string, not 1"},
        Wrong{"[mesh]\nsize = '0.1'", "a.toml:8:8: size in [mesh] must be a number, not \"0.1\""},
        Wrong{"[mesh]\nsize = nan", "a.toml:8:8: size in [mesh] must be a finite number, not nan"},
        Wrong{"[output]\nvtk = 1", "a.toml:8:7: vtk in [output] must be true or false, not 1"},
        Wrong{"[crack]\nname = 'c'", "a.toml:7:1: \"crack\" may appear several times; write [[crack]]"},
        Wrong{"[[mesh]]\nsize = 1", "a.toml:7:1: there is only one [mesh]; write [mesh] instead of [[mesh]]"},
        Wrong{"[[boundary]]\non = 'top'\ntraction = 1",
              "a.toml:9:12: traction in [[boundary]] must be a pair [x, y], not 1"},
        Wrong{"[[boundary]]\non = 'top'\ntraction = [1, true]",
              "a.toml:9:16: entry 2 of traction in [[boundary]] must be a number or an expression in a string, \"1 + "
              "x\""},
        Wrong{"[[crack]]\nname = 'c'\npath = [[0, 0], [1]]",
              "a.toml:9:17: entry 2 of path in [[crack]] must be a pair [x, y], not a list of 1"},
        Wrong{"[[crack]]\nname = 'c/d'\npath = [[0, 0], [1, 1]]",
              "a.toml:8:8: name in [[crack]] must be a name of letters, digits, _ . or - (1 to 100), not \"c/d\""}));

INSTANTIATE_TEST_SUITE_P(
    Values, WrongCase,
    testing::Values(
        Wrong{"[mesh]\nsize = 0", "a.toml:8:8: size in [mesh] must be positive, not 0"},
        Wrong{"[mesh]\nmin_angle = 40", "a.toml:8:13: min_angle in [mesh] must be between 0 and 30, not 40"},
        Wrong{"[[hole]]\nname = 'h'\ncircle = { center = [1, 0.5], radius = -1 }",
              "a.toml:9:40: radius in circle in [[hole]] must be positive, not -1"},
        Wrong{"[[hole]]\nname = 'h'\npolygon = [[1, 1], [2, 2]]",
              "a.toml:9:11: polygon in [[hole]] must be a list of at least 3, not a list of 2"},
        Wrong{"[mesh]\nsize = 1e999", "a.toml:8:13: \"1e999\" is beyond the range of numbers, 1e-308 to 1e308"},
        Wrong{"[mesh]\nsize = -1_0.0e+9_99",
              "a.toml:8:20: \"-1_0.0e+9_99\" is beyond the range of numbers, 1e-308 to 1e308"},
        Wrong{"[mesh]\nsize = 99999999999999999999",
              "a.toml:8:28: \"99999999999999999999\" is too large for a whole number; with a point, "
              "99999999999999999999.0, it "
              "is any number"},
        Wrong{
            "[[hole]]\nname = 'h'\noutline = [[1, 0.5], { arc_to = [1, 0.5], center = [1, 0.4] }, [1.2, 0.5]]",
            "a.toml:9:22: entry 2 of outline in [[hole]]: the arc begins and ends at the same point; split a full turn "
            "into two arcs, or use a [[hole]]"},
        Wrong{"[[hole]]\nname = 'h'\noutline = [[1, 0.5], { arc_to = [1, 0.5], center = [1, 0.5] }, [1.2, 0.5]]",
              "a.toml:9:22: entry 2 of outline in [[hole]]: the center must have the same distance to both ends of the "
              "arc, not 0 to (1, 0.5) and 0 to (1, 0.5)"},
        Wrong{"[[crack]]\nname = 'c'\narc = { center = [1, 0.5], radius = 0.1, from_deg = 20, to_deg = 20 }",
              "a.toml:9:7: arc in [[crack]] runs from 20 to 20 degrees; an arc turns by more than 0 and less than 360"},
        Wrong{"[validate]\nradii = { largest = 0.1, ratio = 0, count = 3 }",
              "a.toml:8:34: ratio in radii in [validate] must lie between 0 and 1, not 0"},
        Wrong{"[[crack]]\nname = 'c'\npath = [[1, 1], [2, 2]]\nfriction = -1",
              "a.toml:10:12: friction in [[crack]] must not be negative"},
        Wrong{"[[probe]]\nname = 'p'\nfrom = [0, 0]\nto = [1, 1]\ncount = 1",
              "a.toml:11:9: count in [[probe]] must be between 2 and 1000000, not 1"},
        Wrong{"[[probe]]\nname = 'p'\nfrom = [0, 0]\nto = [1, 1]\ncount = 2.5",
              "a.toml:11:9: count in [[probe]] must be a whole number, not 2.5"},
        Wrong{"[[probe]]\nname = 'p'\nfrom = [0, 0]\nto = [1, 1]\ncount = 201\nbounds = true",
              "a.toml:12:10: bounds in [[probe]] is for 200 points at most, not 201"},
        Wrong{"[[bounds.disc]]\ncenter = [1, 0.5]\nradius = 0",
              "a.toml:9:10: radius in [[bounds.disc]] must be positive, not 0"},
        Wrong{"[[bounds.line]]\nfrom = [1, 0.5]\nto = [1, 0.5]",
              "a.toml:9:6: to in [[bounds.line]] is where the line begins; it must have a length"},
        Wrong{"[bounds]\ndisplacements = ['topp']",
              "a.toml:8:18: entry 1 of displacements in [bounds]: there is no label \"topp\"; did you mean \"top\"?"},
        Wrong{"[bounds]\nreactions = 'top'",
              "a.toml:8:13: reactions in [bounds]: label \"top\" has no displacement, and so no force of a support"},
        Wrong{"[[boundary]]\non = 'top'\ntraction = [0, '1 +']",
              "a.toml:9:16: entry 2 of traction in [[boundary]]: expression \"1 +\", column 4: the expression ends too "
              "early; a value is missing"},
        Wrong{"[define]\nr = 's'\ns = 'x'",
              "a.toml:8:1: r in [define]: expression \"s\", column 1: \"s\" is defined here or later; a definition may "
              "use only those before it"},
        Wrong{"[body]\nforce = [0, 'nx']",
              "a.toml:8:13: entry 2 of force in [body]: expression \"nx\", column 1: \"nx\" has no meaning here: there "
              "is no normal inside the body"}));

INSTANTIATE_TEST_SUITE_P(
    Missing, WrongCase,
    testing::Values(
        Wrong{"[[hole]]\nname = 'h'", "a.toml:7:1: [[hole]] needs one of circle, ellipse, polygon, outline"},
        Wrong{"[[hole]]\nname = 'h'\ncircle = { radius = 1 }",
              "a.toml:9:10: missing key \"center\" in circle in [[hole]]; add it"},
        Wrong{"[[crack]]\nname = 'c'", "a.toml:7:1: [[crack]] needs one of path, arc"},
        Wrong{"[[boundary]]\npressure = 1", "a.toml:7:1: [[boundary]] needs one of on, at"},
        Wrong{"[[boundary]]\non = 'top'",
              "a.toml:7:1: [[boundary]] prescribes nothing; give traction, pressure or displacement, displacement_x, "
              "displacement_y, displacement_normal, symmetry"},
        Wrong{"[functional]", "a.toml:7:1: missing key \"kind\" in [functional]; add it"}));

INSTANTIATE_TEST_SUITE_P(
    Conflicts, WrongCase,
    testing::Values(
        Wrong{
            "[[boundary]]\non = 'top'\npressure = 1\ntraction = [0, 0]",
            "a.toml:9:12: label \"top\": pressure conflicts with traction (the other is at a.toml:10:12); keep one of "
            "them"},
        Wrong{"[[boundary]]\non = 'top'\ntraction = [1, 0]\n[[boundary]]\non = ['left', 'top']\ntraction = [0, 0]",
              "a.toml:12:12: label \"top\": two conditions traction (the other is at a.toml:9:12); keep one of them"},
        Wrong{"[[boundary]]\non = 'top'\ndisplacement = [1, 0]\n[[boundary]]\non = 'top'\ndisplacement_x = 0",
              "a.toml:12:18: label \"top\": displacement_x conflicts with displacement (the other is at a.toml:9:16); "
              "keep one of them"},
        Wrong{"[[boundary]]\non = 'top'\ndisplacement_x = 0\n[[boundary]]\non = 'top'\ndisplacement_x = 0",
              "a.toml:12:18: label \"top\": two conditions displacement_x (the other is at a.toml:9:18); keep one of "
              "them"},
        Wrong{"[[boundary]]\non = 'top'\ndisplacement_x = 0\ndisplacement_normal = 0",
              "a.toml:10:23: label \"top\": displacement_normal conflicts with displacement_x (the other is at "
              "a.toml:9:18); keep one of them"},
        Wrong{"[[boundary]]\non = 'top'\ndisplacement_x = 0\ndisplacement_y = 0\ntraction = [0, 0]",
              "a.toml:10:18: label \"top\": traction conflicts with the displacement, of which both components are "
              "prescribed (the other is at a.toml:11:12); keep one of them"},
        Wrong{
            "[[boundary]]\non = 'top'\ndisplacement_x = 0\ntraction = [1, 0]",
            "a.toml:10:12: label \"top\": component x of the traction must be 0, because displacement_x is prescribed "
            "there (at a.toml:9:18)"},
        Wrong{"[[boundary]]\non = 'top'\ndisplacement_x = 0\ndisplacement_y = 0\n[[boundary]]\non = 'top'\ntraction = "
              "[0, 0]",
              "a.toml:13:12: label \"top\": traction conflicts with the displacement, of which both components are "
              "prescribed (the other is at a.toml:9:18); keep one of them"},
        Wrong{
            "[[boundary]]\non = 'top'\ndisplacement_y = 0\ntraction = [0, 1]",
            "a.toml:10:12: label \"top\": component y of the traction must be 0, because displacement_y is prescribed "
            "there (at a.toml:9:18)"},
        Wrong{"[[boundary]]\non = ['top', 'top']\npressure = 1",
              "a.toml:8:14: entry 2 of on in [[boundary]]: label \"top\" appears twice"},
        Wrong{"[[crack]]\nname = 'c'\npath = [[0.1, 0.1], [0.2, 0.1]]\n[[crack]]\nname = 'c'\npath = [[0, 0], [1, 1]]",
              "a.toml:11:8: name in [[crack]]: the name \"c\" is taken; give each its own"},
        Wrong{"[[crack]]\nname = 'c'\narc = { center = [0, 0] }",
              "a.toml:9:7: missing key \"from_deg\" in arc in [[crack]]; add it"},
        Wrong{
            "[[crack]]\nname = 'c'\narc = { center = [0, 0], radius = 1, from_deg = 10, to_deg = 370 }",
            "a.toml:9:7: arc in [[crack]] runs from 10 to 370 degrees; an arc turns by more than 0 and less than 360"},
        Wrong{"[[crack]]\nname = 'c'\npath = [[0, 0], [1, 1]]\narc = {}",
              "a.toml:10:7: [[crack]] has both path and arc; keep one"},
        Wrong{"[[probe]]\nname = 'p'\npoints = [[0, 0]]\nfile = 'a'",
              "a.toml:10:8: [[probe]] has both points and file; keep one"}));

INSTANTIATE_TEST_SUITE_P(
    Regions, WrongCase,
    testing::Values(
        Wrong{"[[region]]\nname = 'r'\nyoung = 1\npoisson = 0.3",
              "a.toml:7:1: [[region]] needs one of circle, ellipse, polygon, outline"},
        Wrong{"[[region]]\nname = 'r'\ncircle = { center = [1, 0.5], radius = 0.1 }\npoisson = 0.3",
              "a.toml:7:1: missing key \"young\" in [[region]]; add it"},
        Wrong{"[[region]]\nname = 'r'\ncircle = { center = [1, 0.5], radius = 0.1 }\nyoung = -1\npoisson = 0.3",
              "a.toml:10:9: young in [[region]] must be positive, not -1"},
        Wrong{"[[region]]\nname = 'r'\ncircle = { center = [1, 0.5], radius = 0.1 }\nyoung = 1\npoisson = 0.6",
              "a.toml:11:11: poisson in [[region]] must be above -1 and at most 0.5, not 0.6"},
        Wrong{"[[region]]\nname = 'r'\ncircle = { center = [1, 0.5], radius = 0.1 }\nyoung = 1e-320\npoisson = 0.3",
              "a.toml:7:1: [[region]]: young = 1e-320 is out of range; choose other units"},
        Wrong{"[[region]]\nname = 'r'\nstate = 'plane stress'",
              "a.toml:9:1: unknown key \"state\" in [[region]]; known: name, circle, ellipse, polygon, outline, young, "
              "poisson, "
              "shear, angle, yield, toughness, release_rate, eigenstrain"},
        Wrong{"[[region]]\nname = '../r'",
              "a.toml:8:8: name in [[region]] must be a name of letters, digits, _ . or - (1 to 100), not \"../r\""},
        Wrong{"[[region]]\nname = 'r'\npolygon = [[1, 0.2], [1.2, 0.2], [1.2, 0.4]]\nyoung = 1\npoisson = 0\n"
              "[[region]]\nname = 'r'",
              "a.toml:13:8: name in [[region]]: the name \"r\" is taken; give each its own"}));

INSTANTIATE_TEST_SUITE_P(
    NotYet, WrongCase,
    testing::Values(
        Wrong{"[[crack]]\nname = 'c'\npath = [[1, 0.2], [1, 0.4]]\nfriction = -0.3",
              "a.toml:10:12: friction in [[crack]] must not be negative"},
        Wrong{"[[crack]]\nname = 'c'\npath = [[1, 0.2], [1, 0.4]]\ncontact = 'open'\ntresca = 1",
              "a.toml:11:10: tresca in [[crack]] needs contact = \"unilateral\", not \"open\""},
        Wrong{"[mesh]\nadapt = { error = 0 }", "a.toml:8:19: error in [adapt] must be positive, not 0"},
        Wrong{"[solver]\nelement = 'affw'", "a.toml:8:11: unknown element in [solver] \"affw\"; did you mean \"afw\"?"},
        Wrong{"[solver]\ndegree = 5", "a.toml:8:10: element \"bdms\" has no degree 5; it has 1, 2, 3, 4"},
        Wrong{"[solver]\nelement = 'peers'\ndegree = 2", "a.toml:9:10: element \"peers\" has no degree 2; it has 1"}));

TEST(Case, DomainErrors) {
  const std::string material = "[material]\nyoung = 1\npoisson = 0.3\n";
  EXPECT_EQ(error(""), "a.toml:1:1: missing table [domain]; add it");
  EXPECT_EQ(error("[domain]\nsides = ['a', 'b']\n" + material), "a.toml:1:1: [domain] needs one of outline, file");
  EXPECT_EQ(error("[domain]\noutline = [[0, 0], [1, 0], [0, 1]]\nfile = 'plate.msh'\n" + material),
            "a.toml:3:8: [domain] has both outline and file; keep one");
  EXPECT_EQ(error("[domain]\noutline = [[0, 0], [1, 0]]\nsides = ['a', 'b']\n" + material),
            "a.toml:2:11: outline in [domain] has 2 vertices; a body needs at least 3, or 2 with an arc");
  EXPECT_EQ(error("[domain]\noutline = [[0, 0], [1, 0], [0, 1]]\nsides = ['a', 'b']\n" + material),
            "a.toml:3:9: sides in [domain] has 2 labels for the 3 edges of the outline; give one per edge");
  EXPECT_EQ(error("[domain]\noutline = [[0, 0], [1, 0], { arc_to = [0, 1], center = [0, 0.5] }]\nsides = ['a', 'b', "
                  "'c']\n" +
                  material),
            "a.toml:2:28: entry 3 of outline in [domain]: the center must have the same distance to both ends of the "
            "arc, not 1.11803399 to (1, 0) and 0.5 to (0, 1)");
  EXPECT_EQ(error("[domain]\noutline = [[0, 0], [1, 0], [0, 1]]\nsides = ['a', 'b', 'c']\n"),
            "a.toml:1:1: missing table [material]; add it");
}

TEST(Case, MaterialRanges) {
  const auto material = [](const std::string& lines) { return error(square.substr(0, square.find("young")) + lines); };
  EXPECT_EQ(material("poisson = 0.3"), "a.toml:4:1: missing key \"young\" in [material]; add it");
  EXPECT_EQ(material("young = 0\npoisson = 0.3"), "a.toml:5:9: young in [material] must be positive, not 0");
  EXPECT_EQ(material("young = inf\npoisson = 0.3"), "a.toml:5:9: young in [material] must be a finite number, not inf");
  EXPECT_EQ(material("young = 1e-310\npoisson = 0.3"),
            "a.toml:4:1: [material]: young = 1e-310 is out of range; choose other units");
  EXPECT_EQ(material("young = 1\npoisson = 0.51"),
            "a.toml:6:11: poisson in [material] must be above -1 and at most 0.5, not 0.51");
  EXPECT_EQ(material("young = 1\npoisson = -1"),
            "a.toml:6:11: poisson in [material] must be above -1 and at most 0.5, not -1");
  EXPECT_EQ(material("young = 1\npoisson = 0.5"), "no error");
  EXPECT_EQ(material("young = 1\npoisson = 0.5\nstate = 'plane stress'"), "no error");
  EXPECT_EQ(material("young = 1\npoisson = 0.5\nstate = 'plain stress'"),
            "a.toml:7:9: unknown state in [material] \"plain stress\"; did you mean \"plane stress\"?");
  EXPECT_EQ(material("young = 1\npoisson = 0.3\nshear = 1"),
            "a.toml:7:9: shear in [material] goes with an orthotropic material, young = [E1, E2]; leave it out");
  EXPECT_EQ(material("young = 1\npoisson = 0.3\nangle = 1"),
            "a.toml:7:9: angle in [material] goes with an orthotropic material, young = [E1, E2]; leave it out");
  EXPECT_EQ(material("young = [1, 2]\npoisson = 0.3"), "a.toml:4:1: missing key \"shear\" in [material]; add it");
  const std::string orthotropic = "poisson = 0.3\nshear = 1\nstate = 'plane stress'\n";
  EXPECT_EQ(material(orthotropic + "young = [1, -2]"),
            "a.toml:8:13: entry 2 of young in [material] must be positive, not -2");
  EXPECT_EQ(material(orthotropic + "young = [1, 20]"),
            "a.toml:8:9: [material]: these constants belong to no material: poisson^2 must be less than E1/E2, or some "
            "stress would do no work; it is 0.09, E1/E2 is 0.05");
  EXPECT_EQ(material("young = [1, 2]\npoisson = 0.3\nshear = 1"),
            "a.toml:5:9: [material]: young = [E1, E2] are constants in the plane, and plane strain needs those across "
            "it, for which there are no keys; write state = \"plane stress\" in [material]");
}

}  // namespace
}  // namespace kerf::case_errors_test
