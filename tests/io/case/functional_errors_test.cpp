// Functionals, maps and jobs with a mistake against the whole message, with line and column.

#include "tests/io/case/case_files.hpp"

namespace kerf::functional_errors_test {
namespace {

// Lines 7 to 17 after the square: two cracks and a held left side.
const std::string plate = square + R"([[crack]]
name = "c"
path = [[0.5, 0.5], [1.0, 0.5]]
[[crack]]
name = "stuck"
path = [[1.5, 0.5], [1.75, 0.5]]
contact = "bonded"
[[boundary]]
on = "left"
displacement = [0, 0]
)";

struct Wrong {
  const char* lines;  // appended to the plate, the first of which is line 17
  const char* message;
};
void PrintTo(const Wrong& w, std::ostream* out) {
  *out << w.message;
}
class WrongJob : public testing::TestWithParam<Wrong> {};

TEST_P(WrongJob, SaysWhereAndWhat) {
  EXPECT_EQ(error(plate + GetParam().lines), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Keys, WrongJob,
    testing::Values(
        Wrong{"[functional]\nkind = 'energi'",
              "a.toml:18:8: unknown kind in [functional] \"energi\"; did you mean \"energy\"?"},
        Wrong{"[functional]\nkind = 'energy'\nweight = '1'",
              "a.toml:19:1: \"weight\" in [functional] does not go with kind = \"energy\", which takes no other key"},
        Wrong{
            "[functional]\nkind = 'stress_power'\np = 4\ntarget = [0, 0]",
            "a.toml:20:1: \"target\" in [functional] does not go with kind = \"stress_power\", which takes p, weight"},
        Wrong{"[functional]\nkind = 'displacement_tracking'\ntraget = [0, 0]",
              "a.toml:19:1: unknown key \"traget\" in [functional]; did you mean \"target\"?"},
        Wrong{"[functional]\nkind = 'stress_pnorm'",
              "a.toml:17:1: kind = \"stress_pnorm\" in [functional] needs the key \"p\"; add it"},
        Wrong{"[functional]\nkind = 'energy'\nfactor = 2",
              "a.toml:19:1: unknown key \"factor\" in [functional]; known: kind"},
        Wrong{"[map]\nbuonds = true", "a.toml:18:1: unknown key \"buonds\" in [map]; did you mean \"bounds\"?"},
        Wrong{"[validate]\npoints = [[1, 0.2]]\nradius = 0.1",
              "a.toml:19:1: unknown key \"radius\" in [validate]; did you mean \"radii\"?"},
        Wrong{"[valdate]", "a.toml:17:2: unknown key \"valdate\"; did you mean \"validate\"?"}));

INSTANTIATE_TEST_SUITE_P(
    Values, WrongJob,
    testing::Values(
        Wrong{"[functional]\nkind = 'stress_power'\np = 1",
              "a.toml:19:5: p in [functional] must be between 2 and 100, not 1"},
        Wrong{
            "[functional]\nkind = 'displacement_tracking'\ntarget = ['nx', 0]",
            "a.toml:19:11: entry 1 of target in [functional]: expression \"nx\", column 1: \"nx\" has no meaning here: "
            "there is no normal inside the body"},
        Wrong{"[functional]\nkind = 'displacement_tracking'\ntarget = 0",
              "a.toml:19:10: target in [functional] must be a pair [x, y], not 0"},
        Wrong{"[functional]\nkind = 'stress_power'\np = 2\nweight = true",
              "a.toml:20:10: weight in [functional] must be a number or an expression in a string, \"1 + x\""}));

INSTANTIATE_TEST_SUITE_P(
    Labels, WrongJob,
    testing::Values(
        Wrong{"[functional]\nkind = 'boundary_tracking'\non = 'rigth'\ntarget = [0, 0]",
              "a.toml:19:6: on in [functional]: there is no label \"rigth\"; did you mean \"right\"?"},
        Wrong{"[functional]\nkind = 'boundary_tracking'\non = ['top', 'top']\ntarget = [0, 0]",
              "a.toml:19:14: entry 2 of on in [functional]: label \"top\" appears twice"},
        Wrong{"[functional]\nkind = 'misfit'\non = 'left'\nmeasured = [0, 0]",
              "a.toml:19:6: on in [functional]: a displacement is prescribed on label \"left\" already; measure where "
              "the body is loaded or free"},
        Wrong{"[functional]\nkind = 'misfit'\non = ['top', 'right']\nmeasured = [0, 0]",
              "a.toml:19:6: on in [functional]: a misfit compares along one label; give the sides measured on the same "
              "label"},
        Wrong{"[functional]\nkind = 'misfit'\non = 'top'\nmeasured = 1",
              "a.toml:20:12: measured in [functional] must be a file with the columns x,y,u_x,u_y, two expressions "
              "[u_x, u_y], or \"synthetic\""}));

INSTANTIATE_TEST_SUITE_P(
    Cracks, WrongJob,
    testing::Values(
        Wrong{"[functional]\nkind = 'crack_opening'\ncrack = 'stuk'",
              "a.toml:19:9: crack in [functional]: there is no crack \"stuk\"; did you mean \"stuck\"?"},
        Wrong{
            "[functional]\nkind = 'crack_opening'\ncrack = 'stuck'",
            "a.toml:19:9: crack in [functional]: crack \"stuck\" is bonded and has no faces; choose another or change "
            "its contact"},
        Wrong{"[functional]\nkind = 'energy_release_rate'\ncrack = 'c'",
              "a.toml:17:1: kind = \"energy_release_rate\" in [functional] needs the key \"tip\"; add it"},
        Wrong{"[functional]\nkind = 'energy_release_rate'\ncrack = 'c'\ntip = 'strat'",
              "a.toml:20:7: unknown tip in [functional] \"strat\"; did you mean \"start\"?"},
        Wrong{"[functional]\nkind = 'energy_release_rate'\ncrack = 'c'\ntip = 'end'\nring = [0.1, 0.05]",
              "a.toml:21:8: ring in [functional]: the outer radius 0.05 must be larger than the inner one 0.1"},
        Wrong{"[functional]\nkind = 'energy_release_rate'\ncrack = 'c'\ntip = 'end'\nring = [0.1]",
              "a.toml:21:8: ring in [functional] must be two radii [inner, outer]"},
        Wrong{"[functional]\nkind = 'energy_release_rate'\ncrack = 'c'\ntip = 'end'\nring = [0, 0.1]",
              "a.toml:21:9: entry 1 of ring in [functional] must be positive, not 0"},
        Wrong{
            "[functional]\nkind = 'energy_release_rate'\ncrack = 'c'\ntip = 'end'\nring = [0.1, 0.6]",
            "a.toml:21:8: ring in [functional]: the outline is only 0.5 from the end of crack \"c\"; the outer radius "
            "must be smaller"},
        Wrong{"[functional]\nkind = 'stress_intensity'\ncrack = 'c'\ntip = 'end'\nmode = 'III'",
              "a.toml:21:8: unknown mode in [functional] \"III\"; did you mean \"II\"?"},
        Wrong{"[functional]\nkind = 'energy_release_rate'\ncrack = 'c'\ntip = 'end'\nmode = 'I'",
              "a.toml:21:1: \"mode\" in [functional] does not go with kind = \"energy_release_rate\", which takes "
              "crack, tip, ring"}));

INSTANTIATE_TEST_SUITE_P(
    Sums, WrongJob,
    testing::Values(
        Wrong{"[functional]\nkind = 'sum'\nterms = []",
              "a.toml:19:9: terms in [functional] must be a list of at least 1, not a list of 0"},
        Wrong{"[functional]\nkind = 'sum'\nterms = [{ kind = 'sum', terms = [] }]",
              "a.toml:19:10: entry 1 of terms in [functional]: a sum cannot hold a sum; list its terms here"},
        Wrong{"[functional]\nkind = 'sum'\nterms = [{ kind = 'volume', factor = 0 }]",
              "a.toml:19:38: factor in entry 1 of terms in [functional] is 0; leave the term out"},
        Wrong{"[functional]\nkind = 'sum'\nterms = [{ kind = 'volume' }, { kind = 'energy', p = 2 }]",
              "a.toml:19:50: \"p\" in entry 2 of terms in [functional] does not go with kind = \"energy\", which takes "
              "factor"},
        Wrong{"[functional]\nkind = 'sum'\nterms = [{ kind = 'volume', fcator = 2 }]",
              "a.toml:19:29: unknown key \"fcator\" in entry 1 of terms in [functional]; did you mean \"factor\"?"},
        Wrong{"[functional]\nkind = 'sum'\nterms = [{ kind = 'misfit', on = 'top', measured = [0, 0] },\n { kind = "
              "'misfit', on = 'right', measured = [0, 0] }]",
              "a.toml:20:2: entry 2 of terms in [functional]: there is room for one misfit (the other is at "
              "a.toml:19:10)"}));

INSTANTIATE_TEST_SUITE_P(
    Perturbations, WrongJob,
    testing::Values(
        Wrong{"[map]\nperturbation = 'clamped-hole'",
              "a.toml:18:16: unknown perturbation in [map] \"clamped-hole\"; did you mean \"clamped_hole\"?"},
        Wrong{"[map]\nperturbation = 3",
              "a.toml:18:16: perturbation in [map] must be \"hole\", \"clamped_hole\", \"crack\", { young = ..., "
              "poisson = ... } or { aspect = ... }"},
        Wrong{"[map]\nperturbation = { young = 2, poison = 0.3 }",
              "a.toml:18:29: unknown key \"poison\" in perturbation in [map]; did you mean \"poisson\"?"},
        Wrong{"[map]\nperturbation = { young = 2 }",
              "a.toml:18:16: missing key \"poisson\" in perturbation in [map]; add it"},
        Wrong{"[map]\nperturbation = { young = 2, aspect = 2 }",
              "a.toml:18:38: perturbation in [map] has both young and aspect; keep one"},
        Wrong{"[map]\nperturbation = { young = 2, poisson = 0.2, eigenstrain = [0.01, 0.01, 0] }",
              "a.toml:18:58: perturbation in [map]: an inclusion has the eigenstrain of its place, none of its own; it "
              "may be \"hole\", \"clamped_hole\", \"crack\", { young = ..., poisson = ... } or { aspect = ... }"},
        Wrong{"[map]\nperturbation = { pressure = 0.1 }",
              "a.toml:18:29: perturbation in [map]: the rim of a hole is free of loads; it may be "
              "\"hole\", \"clamped_hole\", \"crack\", { young = ..., poisson = ... } or { aspect = ... }"},
        Wrong{"[map]\nperturbation = {}", "a.toml:18:16: perturbation in [map] needs one of young, aspect"},
        Wrong{"[map]\nperturbation = { young = 2, poisson = 0.6 }",
              "a.toml:18:39: poisson in perturbation in [map] must be above -1 and at most 0.5, not 0.6"},
        Wrong{"[map]\nperturbation = { young = 1e-310, poisson = 0.3 }",
              "a.toml:18:16: perturbation in [map]: young = 1e-310 is out of range; choose other units"},
        Wrong{"[map]\nperturbation = { aspect = 0.5 }",
              "a.toml:18:27: aspect in perturbation in [map] must be between 1 and 100, not 0.5"},
        Wrong{"[map]\nradius = 3",
              "a.toml:18:10: radius in [map] = 3 must be smaller than the body, whose diagonal is "
              "2.23607"},
        Wrong{"[map]\nradius = -1", "a.toml:18:10: radius in [map] must be positive, not -1"},
        Wrong{"[map]\npoints = []",
              "a.toml:18:10: points in [map] is empty; leave it out for a map everywhere in the body"},
        Wrong{"[map]\nbounds = 1", "a.toml:18:10: bounds in [map] must be true or false, not 1"}));

INSTANTIATE_TEST_SUITE_P(
    Validations, WrongJob,
    testing::Values(
        Wrong{"[validate]\npoints = [[1, 0.2]]", "a.toml:17:1: missing key \"radii\" in [validate]; add it"},
        Wrong{"[validate]\npoints = []\nradii = [0.1]",
              "a.toml:18:10: points in [validate] must be a list of at least 1, not a list of 0"},
        Wrong{"[validate]\npoints = [[1, 0.2], [1, 0.2]]\nradii = [0.1]",
              "a.toml:18:21: entry 2 of points in [validate] appears twice"},
        Wrong{
            "[validate]\npoints = [[1, 0.2]]\nradii = 0.1",
            "a.toml:19:9: radii in [validate] must be a list of radii or { largest = ..., ratio = ..., count = ... }"},
        Wrong{"[validate]\npoints = [[1, 0.2]]\nradii = [0.1, 0.05, 0.1]",
              "a.toml:19:21: entry 3 of radii in [validate]: the radius 0.1 appears twice"},
        Wrong{"[validate]\npoints = [[1, 0.2]]\nradii = [0.1, 0]",
              "a.toml:19:15: entry 2 of radii in [validate] must be positive, not 0"},
        Wrong{"[validate]\npoints = [[1, 0.2]]\nradii = { largest = 0.1, ratio = 1, count = 4 }",
              "a.toml:19:34: ratio in radii in [validate] must lie between 0 and 1, not 1"},
        Wrong{"[validate]\npoints = [[1, 0.2]]\nradii = { largest = 0.1, ratio = 0.5 }",
              "a.toml:19:9: missing key \"count\" in radii in [validate]; add it"},
        Wrong{"[validate]\npoints = [[1, 0.2]]\nradii = { largest = 0.1, ratio = 0.1, count = 30 }",
              "a.toml:19:47: count in radii in [validate]: the last of 30 radii is 1e-30, too small to mesh; choose a "
              "smaller count or a larger ratio"},
        Wrong{"[validate]\npoints = [[1, 0.2]]\nradii = { largest = 0.1, ratio = 0.5, cuont = 4 }",
              "a.toml:19:39: unknown key \"cuont\" in radii in [validate]; did you mean \"count\"?"}));

TEST(Functional, StressIntensityOfFacesThatDoOtherWork) {
  const auto of = [](const std::string& crack) {
    return error(square + "[[crack]]\nname = 'm'\n" + crack +
                 "\n[functional]\nkind = 'stress_intensity'\ncrack = 'm'\ntip = 'start'");
  };
  const std::string path = "path = [[0.5, 0.5], [1, 0.5]]\n",
                    end = "; kerf solve gives K and G of its tips, or use another functional";
  EXPECT_EQ(of(path + "friction = 0.3"),
            "a.toml:11:1: [functional]: the faces of crack \"m\" have friction, whose work "
            "stress_intensity does not count" +
                end);
  EXPECT_EQ(of(path + "pressure = 1"),
            "a.toml:11:1: [functional]: the faces of crack \"m\" carry a pressure, whose "
            "work stress_intensity does not count" +
                end);
  EXPECT_EQ(of("arc = { center = [1, 0.5], radius = 0.2, from_deg = 0, to_deg = 90 }"),
            "a.toml:10:1: [functional]: crack \"m\" is an arc, and stress_intensity takes a straight one" + end);
}

TEST(Functional, CracksWithoutPressureAndTipsThatAreNone) {
  EXPECT_EQ(error(square + "[[crack]]\nname = 'm'\npath = [[0, 0.5], [1, 0.5]]\ncontact = 'open'\n"
                           "[functional]\nkind = 'crack_pressure'\ncrack = 'm'\ntarget = 1"),
            "a.toml:13:9: crack in [functional]: crack \"m\" has contact = \"open\" and no pressure; contact = "
            "\"unilateral\" has");
  EXPECT_EQ(error(square + "[[crack]]\nname = 'm'\npath = [[0, 0.5], [1, 0.5]]\n"
                           "[functional]\nkind = 'energy_release_rate'\ncrack = 'm'\ntip = 'start'"),
            "a.toml:13:7: tip in [functional]: the start of crack \"m\" lies on the outline: there is no tip");
  EXPECT_EQ(error(square + "[functional]\nkind = 'crack_opening'\ncrack = 'm'"),
            "a.toml:9:9: crack in [functional]: there is no crack \"m\"; the case has none");
}

}  // namespace
}  // namespace kerf::functional_errors_test
