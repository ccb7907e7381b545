// Inclusions that keep the eigenstrain of their place, against the regions that a person draws with that eigenstrain:
// in plane strain the part of it that is across the plane acts through their own Poisson's ratio.

#include "tests/truth/scene.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kerf::inclusion_strain_test {
namespace {

struct Made {
  const char* name;
  const char* functional;
};

class InclusionStrain : public Truth {
 protected:
  // T of the map at the place, and the series of drawn regions: (J(eps) - J(0)) / (pi eps^2) at eps -> 0.
  void compare(const std::string& body, const char* young, const char* poisson, const char* strain,
               const std::string& functional) {
    const std::string text = fmt::format(fmt::runtime(body), strain) + "\n[functional]\n" + functional;
    const auto map =
        run_scene(text + fmt::format("\n[map]\nperturbation = {{ young = {}, poisson = {} }}\npoints = [[0.1, 0.2]]\n",
                                     young, poisson),
                  Job::Map);
    const double T = map["map"]["points"][0]["value"];
    std::vector<double> quotient;
    for (const double eps : {0.1, 0.05}) {
      // With the same lines in both meshes.
      const auto J = [&](const std::string& what) -> double {
        return run_scene(text + fmt::format("\n[[region]]\nname = \"i\"\ncircle = {{ center = [0.1, 0.2], radius = {} "
                                            "}}\n{}\neigenstrain = {}\n",
                                            eps, what, strain))["functional"]["value"];
      };
      quotient.push_back((J(fmt::format("young = {}\npoisson = {}", young, poisson)) - J("")) / (pi * eps * eps));
    }
    const double drawn = (4 * quotient[1] - quotient[0]) / 3;
    EXPECT_NEAR(T, drawn, 0.003 * std::abs(drawn)) << functional << young << ' ' << poisson;
  }
};

// Slid between walls, free on top; a shear on top so that the trace is not all.
constexpr const char* held = R"toml(
[domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["b", "r", "t", "l"]
[material]
young = 1.0
poisson = 0.3
state = "plane strain"
eigenstrain = {}
[[boundary]]
on = "b"
displacement_y = 0
[[boundary]]
on = "l"
displacement_x = 0
[[boundary]]
on = "r"
displacement_x = 0.02
[[boundary]]
on = "t"
traction = [0.01, "0.02*x"]
[mesh]
size = 0.1
[solver]
degree = 2
)toml";

TEST_F(InclusionStrain, AcrossThePlaneActsThroughItsOwnPoissonsRatio) {
  for (const char* functional :
       {"kind = \"energy\"", "kind = \"compliance\"", "kind = \"displacement\"\non = \"t\"\ndirection = [0, 1]",
        "kind = \"displacement_tracking\"\ntarget = [\"0.1*x\", 0.2]",
        "kind = \"misfit\"\non = \"t\"\nmeasured = [\"0.01*x\", \"0.05 + 0.01*x\"]"})
    compare(held, "1.0", "0.15", "[0.01, 0.01, 0, 0.01]", functional);
  // Soft, stiff, and one that keeps its volume; an eigenstrain that is not uniform.
  for (const auto& [young, poisson] : {std::pair{"0.2", "0.05"}, {"9.0", "0.45"}, {"0.5", "0.4999"}})
    compare(held, young, poisson, "[0.004, -0.01, 0.003, \"0.03 + 0.02*x - 0.01*y^2\"]",
            "kind = \"displacement\"\non = \"t\"\ndirection = [0, 1]");
}

// The case that was wrong, and said that it holds.
TEST_F(InclusionStrain, AHeatedInclusionBetweenWalls) {
  const auto result = run_scene(R"toml(
[domain]
outline = [[-1,-1],[1,-1],[1,1],[-1,1]]
sides = ["b","r","t","l"]
[material]
young = 1.0
poisson = 0.3
state = "plane strain"
eigenstrain = [0.01,0.01,0,0.01]
[[boundary]]
on = "b"
displacement_y = 0
[[boundary]]
on = "l"
displacement_x = 0
[[boundary]]
on = "r"
displacement_x = 0
[mesh]
size = 0.1
[solver]
degree = 2
[functional]
kind = "displacement"
on = "t"
direction = [0,1]
[map]
perturbation = { young = 1.0, poisson = 0.15 }
[validate]
points = [[0.1,0.2]]
radii = [0.16,0.08,0.04,0.02,0.01]
)toml",
                                Job::Validate)["validate"][0];
  EXPECT_EQ(result["verdict"], "holds") << result["reason"];
  EXPECT_NEAR(result["coefficient"], -0.005006, 2e-6);  // of the region drawn with that eigenstrain
}

}  // namespace
}  // namespace kerf::inclusion_strain_test
