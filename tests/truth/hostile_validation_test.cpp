// Validations of right formulas that were called wrong, and of what no series can say.

#include "tests/truth/scene.hpp"

namespace kerf::hostile_validation_test {
namespace {

const std::string square = R"toml(
[domain]
outline = [[-1,-1],[1,-1],[1,1],[-1,1]]
sides = ["b","r","t","l"]
[material]
young = 1.0
poisson = 0.3
state = "plane strain"
[mesh]
size = 0.1
[solver]
degree = 1
)toml";
const std::string pulled = R"toml(
[[boundary]]
on = "b"
displacement_y = 0
[[boundary]]
on = "l"
displacement_x = 0
[[boundary]]
on = "t"
traction = ["0.4*(1-x*x)","1+0.3*x"]
)toml";

class HostileValidation : public Truth {
 protected:
  nlohmann::json first(const std::string& text) {
    return run_scene(square + text, Job::Validate)["validate"][0];
  }
};

// The integral of the third power of the stress converges like the root of the edges at a tip.
TEST_F(HostileValidation, SmallCracksUnderPowersOfTheStressHold) {
  for (const char* p : {"2.5", "3"}) {
    const auto v = first(std::string(R"toml(
[[boundary]]
on = ["b","r","t","l"]
traction = ["0.3*nx+0.2*ny","0.2*nx+1*ny"]
[functional]
kind = "stress_power"
p = )toml") + p + R"toml(
[map]
perturbation = "crack"
[validate]
points = [[0,0]]
radii = [0.16,0.08,0.04]
)toml");
    EXPECT_EQ(v["verdict"], "holds") << p << v["reason"];
  }
}

// A weight that jumps 1e-4 from the point: radii that reach across it say nothing, small ones do.
TEST_F(HostileValidation, RadiiKeepAwayFromJumpsOfTheWeight) {
  const std::string text = pulled + R"toml(
[functional]
kind = "displacement_tracking"
target = [0.5,-3]
weight = "x > 0.1501 ? 1 : 0"
[map]
perturbation = "hole"
[validate]
points = [[0.15,0.45]]
)toml";
  const auto across = first(text + "radii = [0.08,0.04,0.02,0.01,0.005]\n");
  EXPECT_EQ(across["verdict"], "out of range");
  EXPECT_NE(across["reason"].get<std::string>().find("jump of the data"), std::string::npos) << across["reason"];
  const auto beside = first(text + "radii = [2e-5,1e-5,5e-6]\n");
  EXPECT_EQ(beside["verdict"], "holds") << beside["reason"];
}

TEST_F(HostileValidation, AnInclusionOfWhatLiesThereVanishes) {
  const auto v = first(pulled + R"toml(
[functional]
kind = "energy"
[map]
perturbation = { young = 1.0, poisson = 0.3 }
[validate]
points = [[0.15,0.45]]
radii = [0.08,0.04,0.02]
)toml");
  EXPECT_EQ(v["verdict"], "vanishes") << v["reason"];
}

TEST_F(HostileValidation, ThePressureOfACrackThatOverlapsAtItsTipIsRefused) {
  const std::string text = square + pulled + R"toml(
[[crack]]
name = "c"
path = [[-0.4,0],[0.4,0]]
gap = GAP
[functional]
kind = "crack_pressure"
crack = "c"
target = 0.1
[map]
perturbation = "hole"
points = [[0.15,0.45]]
)toml";
  const auto with = [&](const std::string& gap) {
    std::string t = text;
    return t.replace(t.find("GAP"), 3, gap);
  };
  const std::string moves = R"toml(
[optimize]
method = "slsqp"
max_iterations = 2
[[optimize.hole]]
circle = { center = [[0.1,0.3],[0.4,0.6]], radius = 0.1 }
start = { center = [0.2,0.5] }
)toml";
  const std::string overlaps = with("\"-0.05+0.02*x\"");
  for (const auto& [scene, job] :
       {std::pair{overlaps, Job::Solve}, {overlaps, Job::Map}, {overlaps + moves, Job::Optimize}})
    try {
      run_scene(scene, job);
      ADD_FAILURE() << "not refused";
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("is infinite: the faces of the crack overlap at its tip"), std::string::npos)
          << e.what();
    }
  EXPECT_EQ(run_scene(with("\"0.1*(0.16-x^2)\""), Job::Map)["status"], "ok");
}

// It closes the open end of the crack by as much as there was: the prediction was off by a factor of two.
TEST_F(HostileValidation, TheOpeningOfACrackWhoseContactAClampedHoleMovesIsRefused) {
  const auto said = [&](const std::string& law, const std::string& points) -> std::string {
    try {
      return run_scene(square + R"toml(
[[boundary]]
on = "b"
displacement_y = 0
[[boundary]]
on = "l"
displacement_x = 0
[[boundary]]
on = "t"
traction = [0.1,"0.2+1.5*x"]
[[crack]]
name = "c"
path = [[-0.5,-0.1],[0.1,0.05]]
)toml" + law +
                           "[functional]\nkind = \"crack_opening\"\ncrack = \"c\"\n[map]\nperturbation = "
                           "\"clamped_hole\"\nradius = 0.02\n" +
                           points,
                       Job::Map)["status"];
    } catch (const Error& e) {
      return e.what();
    }
  };
  const std::string beside = "points = [[-0.15,0.16]]\n";
  EXPECT_NE(said("", beside).find("at (-0.15, 0.16) parts or closes the faces along"), std::string::npos)
      << said("", beside);
  EXPECT_NE(said("", "").find("list the points"), std::string::npos) << said("", "");
  EXPECT_EQ(said("contact = \"open\"\n", beside), "ok");
}

// A disc pressed in, free to turn: the side of the body does not see it, the disc does.
TEST_F(HostileValidation, AFunctionalThatDoesNotSeeTheLoosePieceIsMapped) {
  const std::string text = square + pulled + R"toml(
[[region]]
name = "d"
circle = { center = [0,0], radius = 0.5 }
young = 3.0
poisson = 0.25
[[interface]]
name = "i"
between = ["d","body"]
gap = -0.05
)toml";
  EXPECT_EQ(run_scene(text + "[functional]\nkind = \"boundary_tracking\"\non = \"t\"\ntarget = [0, 1]\n[map]\npoints = "
                             "[[0.15, 0.76]]\n",
                      Job::Map)["status"],
            "ok");
  try {
    run_scene(
        text + "[functional]\nkind = \"displacement_tracking\"\ntarget = [0, 1]\n[map]\npoints = [[0.15, 0.76]]\n",
        Job::Map);
    ADD_FAILURE() << "not refused";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("sees rigid motions"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace kerf::hostile_validation_test
