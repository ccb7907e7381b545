// kerf check names everything of [optimize] that can be known before anything is solved, with its place.

#include "app/run.hpp"
#include "tests/io/case/case_files.hpp"

namespace kerf::check_optimize_test {
namespace {

// Lines 1 to 14: supported on the left, pulled on the right, as stiff as can be.
const std::string plate = square + R"([[boundary]]
on = "left"
displacement = [0, 0]
[functional]
kind = "compliance"
[[boundary]]
on = "right"
)";
const std::string pulled = plate + "traction = [1, 0]\n";
const std::string volume = "[optimize]\nvolume = { at_most = 0.5 }\n";
const std::string mma = "[optimize]\nmethod = \"mma\"\nvolume = { at_most = 0.95 }\n";
const std::string hole = "[[optimize.hole]]\ncircle = { center = [[0.3, 1.7], [0.3, 0.7]], radius = [0.05, 0.2] }\n";

std::string checked(const std::string& text) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write("a.toml", text);
  try {
    check(read_case(path));
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage) << e.what();
    std::string message = e.what();
    const std::string prefix = folder.path.string() + "/";
    for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
    return message;
  }
  return "nothing";
}

struct Refused {
  std::string text;
  std::vector<std::string> lines;  // what every line of the message begins with
};
void PrintTo(const Refused& r, std::ostream* out) {
  *out << r.text;
}
class CheckOfOptimize : public testing::TestWithParam<Refused> {};

TEST_P(CheckOfOptimize, SaysWhereAndWhat) {
  const std::string message = checked(GetParam().text);
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin <= message.size();) {
    const std::size_t end = std::min(message.find('\n', begin), message.size());
    lines.push_back(message.substr(begin, end - begin));
    begin = end + 1;
  }
  ASSERT_EQ(lines.size(), GetParam().lines.size()) << message;
  for (std::size_t i = 0; i < lines.size(); ++i)
    EXPECT_TRUE(lines[i].starts_with(GetParam().lines[i])) << lines[i] << "\nand not\n" << GetParam().lines[i];
}

const std::string slit = "[[crack]]\nname = \"c\"\npath = [[0.8, 0.5], [1.2, 0.5]]\n";

INSTANTIATE_TEST_SUITE_P(
    LevelSet, CheckOfOptimize,
    testing::Values(
        Refused{pulled + volume, {"nothing"}},
        Refused{pulled + volume + "ersatz = 1e-3",
                {"a.toml:17:10: ersatz in [optimize]: a weak phase is moved by the "
                 "fixed point only; add move = \"fixed-point\""}},
        Refused{pulled +
                    "[[region]]\nname = \"r\"\ncircle = { center = [1, 0.5], radius = 0.1 }\nyoung = 3\npoisson = "
                    "0.3\n" +
                    volume + "move = \"fixed-point\"\nersatz = 1e-3",
                {"a.toml:23:10: ersatz in [optimize] does not go with [[region]]"}},
        Refused{pulled + slit + "friction = 0.3\n" + volume, {"nothing"}},
        Refused{pulled + "[solver]\nelement = \"p2\"\n" + volume,
                {"a.toml:16:11: element \"p2\" has no derivatives by the shape"}},
        Refused{pulled + "[solver]\nelement = \"arnold-winther\"\n" + volume,
                {"a.toml:16:11: element \"arnold-winther\" has no derivatives by the shape"}},
        Refused{plate + "traction = [0, 0]\n" + volume, {"a.toml:7:1: [optimize]: nothing acts on the body"}},
        Refused{plate + "pressure = \"0*x\"\n" + volume, {"a.toml:7:1: [optimize]: nothing acts on the body"}},
        Refused{plate + "traction = [\"y - 2\", 0]\n" + volume, {"nothing"}},
        Refused{plate + "displacement_x = 0\n" + volume, {"a.toml:15:1: [optimize]: nothing acts on the body"}},
        Refused{plate + "displacement_x = 0.1\n" + volume, {"nothing"}},
        Refused{plate + "displacement_x = 0\n[body]\nforce = [0, 0]\n" + volume,
                {"a.toml:16:9: [optimize]: nothing acts on the body"}},
        Refused{plate + "displacement_y = 0\n" + volume +
                    "[[load_case]]\nname = \"a\"\n[[load_case.boundary]]\non = \"top\"\npressure = 1\n"
                    "[[load_case]]\nname = \"b\"\n[[load_case.boundary]]\non = \"top\"\npressure = 0\n",
                {"a.toml:22:1: [[load_case]] \"b\": nothing acts on the body"}},
        Refused{pulled + "[optimize]\nvolume = { at_most = 1 }",
                {"a.toml:15:1: [optimize]: volume.at_most = 1 leaves the full body"}},
        Refused{pulled + volume + "start = { holes = [4, 2], radius = 0.6 }",
                {"a.toml:17:9: start in [optimize]: the holes leave no body to begin with; use fewer or smaller ones"}},
        Refused{pulled + volume + "start = { holes = [1, 1], radius = 0.6 }",
                {"a.toml:17:9: start in [optimize]: the holes cut the loads off from the supports"}},
        Refused{pulled + volume + "start = { random = 500, radius = 0.4 }",
                {"a.toml:17:9: start in [optimize]: the holes leave no body"}},
        Refused{pulled + volume + "start = { holes = [4, 2], radius = 0.1 }", {"nothing"}},
        Refused{
            pulled + volume + "min_feature = 1.2",
            {"a.toml:17:15: min_feature in [optimize] = 1.2 is more than the body is wide anywhere (1.03 at most)"}},
        Refused{pulled + volume + "nucleate = { fraction = 0.7 }",
                {"a.toml:17:25: fraction in nucleate in [optimize] = 0.7 is the share of the area"}},
        Refused{pulled + volume + "symmetry = { x = 0.7 }",
                {"a.toml:17:12: symmetry in [optimize]: the body is not its own mirror image"}},
        Refused{pulled + volume +
                    "frozen = [\"pad\"]\n[[region]]\nname = \"pad\"\npolygon = [[0, 0], [1.2, 0], [1.2, "
                    "1], [0, 1]]",
                {"a.toml:16:22: at_most in volume in [optimize] = 0.5 is less than the share of the body that is "
                 "frozen, at least 0.57"}},
        Refused{pulled + volume +
                    "frozen = [\"a\", \"b\"]\n[[region]]\nname = \"a\"\npolygon = [[-1, -1], [1.2, -1], "
                    "[1.2, 2], [-1, 2]]\n[[region]]\nname = \"b\"\npolygon = [[1, -1], [3, -1], [3, 2], "
                    "[1, 2]]",
                {"a.toml:17:10: frozen in [optimize]: the regions together cover the whole body"}},
        Refused{pulled + volume +
                    "frozen = [\"pad\"]\n[[region]]\nname = \"pad\"\ncircle = { center = [3, 3], radius "
                    "= 0.1 }",
                {"a.toml:17:11: entry 1 of frozen in [optimize]: region \"pad\" lies outside the body"}},
        Refused{square +
                    "[functional]\nkind = \"displacement_tracking\"\ntarget = [0, 0]\n[[boundary]]\non = "
                    "\"right\"\ntraction = [1, 0]\n" +
                    volume,
                {"a.toml:7:1: [functional]: \"displacement_tracking\" sees rigid motions, and nothing supports"}},
        Refused{square + "[functional]\nkind = \"displacement_tracking\"\ntarget = [0, 0]\n[[boundary]]\non = "
                         "\"left\"\ndisplacement = [0, 0]\n[[boundary]]\non = \"right\"\ntraction = [1, 0]\n[optimize]",
                {"a.toml:16:1: [optimize]: a level set needs something that says how much material"}},
        Refused{square +
                    "[functional]\nkind = \"compliance\"\n[[boundary]]\non = [\"left\", \"right\", \"top\", "
                    "\"bottom\"]\ntraction = [\"nx\", \"ny\"]\n" +
                    volume + "nucleate = false",
                {"a.toml:14:12: nucleate in [optimize] = false: no side of the body is free of loads"}},
        // All that is wrong at once.
        Refused{pulled + slit + "pressure = 0.3\n[solver]\nelement = \"p2\"\n" + volume +
                    "ersatz = 1e-3\nstart = { holes = [4, 2], radius = 0.6 }",
                {"a.toml:18:12: crack \"c\" carries a pressure", "a.toml:20:11: element \"p2\" has no derivatives",
                 "a.toml:23:10: ersatz in [optimize]", "a.toml:24:9: start in [optimize]"}}));

INSTANTIATE_TEST_SUITE_P(
    Drawn, CheckOfOptimize,
    testing::Values(
        Refused{pulled + mma + hole, {"nothing"}},
        Refused{pulled + "[solver]\nelement = \"p2\"\n" + mma + hole,
                {"a.toml:16:11: method \"mma\" needs derivatives: element \"p2\" has no"}},
        Refused{pulled + "[solver]\nelement = \"p2\"\n[optimize]\nmethod = \"cobyla\"\n" + hole, {"nothing"}},
        Refused{pulled + "[solver]\nelement = \"p2\"\n[optimize]\nmethod = \"cobyla\"\n[[optimize.crack]]\npath = "
                         "[[[0.5, 0.9], 0.5], [[1.1, 1.5], 0.5]]",
                {"a.toml:16:11: [[optimize.crack]]: element \"p2\" cannot do contact on cracks"}},
        Refused{pulled + "[solver]\nelement = \"p2\"\n[optimize]\nmethod = \"cobyla\"\n" + hole + "start = \"map\"",
                {"a.toml:16:11: start = \"map\": element \"p2\" has no adjoint"}},
        Refused{pulled + slit +
                    "friction = 0.3\n[optimize]\nmethod = \"mma\"\n[[optimize.hole]]\ncircle = { center = [[0.2, 0.4], "
                    "0.5], "
                    "radius = [0.05, 0.1] }\n",
                {"nothing"}},
        Refused{pulled + slit + "friction = 0.3\n" + mma + hole + "start = \"map\"",
                {"a.toml:18:12: crack \"c\" slides against friction, and what begins where a map finds it"}},
        Refused{pulled + mma + "[[optimize.hole]]\ncircle = { center = [[3, 4], [3, 4]], radius = [0.05, 0.2] }\n",
                {"a.toml:19:21: center in circle in [[optimize.hole]]: nowhere in its box is there room"}},
        Refused{pulled + mma + hole +
                    "[[optimize.hole]]\nellipse = { center = [[0.3, 1.7], [-0.5, -0.1]], semi_axes = "
                    "[[0.05, 0.2], 0.1] }\n",
                {"a.toml:21:22: center in ellipse in [[optimize.hole]]: nowhere in its box is there room"}},
        Refused{
            pulled + mma + "[[optimize.hole]]\ncircle = { center = [[0.3, 1.7], [0.3, 0.7]], radius = [0.6, 0.8] }\n",
            {"a.toml:19:21: center in circle in [[optimize.hole]]: nowhere in its box is there room in the body "
             "for a radius of 0.6"}},
        Refused{pulled + "[[hole]]\nname = \"h\"\ncircle = { center = [1, 0.5], radius = 0.3 }\n" + mma +
                    "[[optimize.hole]]\ncircle = { center = [[0.9, 1.1], [0.4, 0.6]], radius = [0.05, 0.1] }\n",
                {"a.toml:22:21: center in circle in [[optimize.hole]]: nowhere in its box is there room"}},
        Refused{pulled + mma + "[[optimize.crack]]\npath = [[[0.5, 0.9], 0.5], [[2.1, 2.5], 0.5]]",
                {"a.toml:19:8: path in [[optimize.crack]]: the box of point 2 lies outside the body"}},
        Refused{pulled + mma +
                    "[[optimize.region]]\ncircle = { center = [[5, 6], 0.5], radius = 0.1 }\nyoung = [1, "
                    "9]\npoisson = 0.3",
                {"a.toml:19:21: center in circle in [[optimize.region]]: nowhere in its box"}},
        Refused{pulled + "[optimize]\nmethod = \"mma\"\nvolume = { at_most = 0.5 }\n" + hole,
                {"a.toml:17:22: at_most in volume in [optimize] = 0.5: the largest holes that the boxes allow leave "
                 "0.9372 of the area"}},
        Refused{pulled + "[optimize]\nmethod = \"mma\"\n" + hole + "[[optimize.bound]]\nkind = \"volume\"\nat_most = 1",
                {"a.toml:21:11: at_most in [[optimize.bound]] = 1: the largest holes that the boxes allow leave an "
                 "area of 1.874"}},
        // Two discs that must overlap: their boxes are too small.
        Refused{pulled + mma +
                    "[[optimize.hole]]\ncircle = { center = [[0.9, 1.1], 0.5], radius = 0.2 }\n"
                    "[[optimize.hole]]\ncircle = { center = [[0.9, 1.1], 0.5], radius = 0.2 }\n",
                {"a.toml:15:1: [optimize]: the design cannot be drawn where it starts, and nowhere near is one that "
                 "can: hole"}},
        // Two that overlap at first and need not.
        Refused{pulled + mma +
                    "[[optimize.hole]]\ncircle = { center = [[0.3, 1.7], 0.5], radius = 0.2 }\n"
                    "[[optimize.hole]]\ncircle = { center = [[0.3, 1.7], 0.5], radius = 0.2 }\n",
                {"nothing"}},
        Refused{pulled + "[[hole]]\nname = \"h\"\ncircle = { center = [1, 0.5], radius = 0.3 }\n" + mma +
                    "min_distance = 0.5\n[[optimize.hole]]\ncircle = { center = [[0.3, 1.7], 0.5], radius = [0.05, "
                    "0.2] }\nstart = { center = [0.4, 0.5] }\n",
                {"a.toml:18:1: [optimize]: the design cannot be drawn where it starts"}},
        Refused{square + slit +
                    "[[boundary]]\non = \"left\"\ndisplacement = [0, 0]\n[[boundary]]\non = "
                    "\"right\"\ntraction = [0, 1]\n[functional]\nkind = \"energy_release_rate\"\ncrack = "
                    "\"c\"\ntip = \"end\"\nring = [0.06, 0.2]\n[optimize]\nmethod = "
                    "\"mma\"\n[[optimize.crack]]\npath = [[[1.2, 1.3], 0.6], [[1.2, 1.4], 0.9]]\nstart = { "
                    "path = [[1.25, 0.6], [1.3, 0.9]] }",
                {"a.toml:24:8: crack 'crack_1' moves with the design, and the ring of \"energy_release_rate\""}}));

/// What the loops say without a case file is the same.
TEST(RefusedByTheLoops, InTheSameWords) {
  const Case c = read(pulled + volume + "ersatz = 1e-3");
  try {
    optimize_level_set(problem_of(c), *c.optimize, {}, {});
    ADD_FAILURE() << "not refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    EXPECT_EQ("a.toml:17:10: " + std::string(e.what()), checked(pulled + volume + "ersatz = 1e-3"));
  }
}

}  // namespace
}  // namespace kerf::check_optimize_test
