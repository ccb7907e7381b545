// Incompressible bodies with regions of other moduli: the stress that an eigenstrain in the softer material keeps as it
// is, in closed form, and the saddle point, which needs no penalty.

#include "tests/truth/scene.hpp"

#include <fmt/format.h>

#include <sstream>

namespace kerf::contrast_test {
namespace {

using nlohmann::json;

class Contrast : public Truth {
 protected:
  /// s11, s22, s12 at a point of the probe "p".
  std::vector<double> stress(int row) const {
    std::ifstream file(folder / "out" / "probe_p.csv");
    std::string line, cell;
    for (int i = 0; i <= row + 1; ++i) std::getline(file, line);
    std::istringstream cells(line);
    std::vector<double> values;
    while (std::getline(cells, cell, ',')) values.push_back(std::atof(cell.c_str()));
    return {values.begin() + 4, values.begin() + 7};
  }
};

constexpr const char* body = R"(
[domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["held", "loaded", "loaded", "held"]
[material]
young = 1
poisson = 0.5
{body}
[[region]]
name = "r"
polygon = [[0.3, 0.25], [0.7, 0.3], [0.65, 0.7], [0.35, 0.6]]
young = {ratio}
poisson = 0.5
{region}
[[boundary]]
on = "held"
displacement = {displacement}
[[boundary]]
on = "loaded"
traction = ["(0.5*x + 0.25)*nx - 0.5*y*ny", "-0.5*y*nx + (1.5*x + 0.75)*ny"]
[[probe]]
name = "p"
points = [[0.15, 0.2], [0.5, 0.45]]
[mesh]
size = 0.15
)";

// Turned by 1, so that a stiff region strains far less than it moves. 2 mu u = kappa phi - z conj(phi') - conj(psi),
// phi = (z^2 + z)/4, psi = z/4, kappa = 1; mu of the stiffer material.
TEST_F(Contrast, KeepsALinearStress) {
  for (const double ratio : {1e-8, 1e-3, 1e6, 1e10}) {
    const double stiff = std::max(1.0, ratio), soft = std::min(1.0, ratio);
    const std::string f = fmt::format("{:.17g}", 1.5 * (1 / stiff - 1 / soft)), u = fmt::format("{:.17g}", 1.5 / stiff);
    const std::string strain =
        fmt::format("eigenstrain = [\"{0}*(-0.5*x - 0.25)\", \"{0}*(0.5*x + 0.25)\", \"-0.5*{0}*y\"]", f);
    run_scene(fmt::format(fmt::runtime(body), fmt::arg("body", ratio > 1 ? strain : ""),
                          fmt::arg("region", ratio > 1 ? "" : strain), fmt::arg("ratio", ratio),
                          fmt::arg("displacement", fmt::format("[\"0.25*{0}*(-x^2 - 3*y^2 - x) - y\", "
                                                               "\"0.25*{0}*(2*x*y + y) + x\"]",
                                                               u))));
    const std::vector<double> outside = stress(0), inside = stress(1);
    const double limit = std::max(1e-10, 1e-16 / ratio);
    EXPECT_NEAR(outside[0], 0.5 * 0.15 + 0.25, limit) << ratio;
    EXPECT_NEAR(outside[1], 1.5 * 0.15 + 0.75, limit) << ratio;
    EXPECT_NEAR(outside[2], -0.5 * 0.2, limit) << ratio;
    EXPECT_NEAR(inside[0], 0.5 * 0.5 + 0.25, limit) << ratio;
    EXPECT_NEAR(inside[1], 1.5 * 0.5 + 0.75, limit) << ratio;
    EXPECT_NEAR(inside[2], -0.5 * 0.45, limit) << ratio;
  }
}

// Two soft regions, one in a stiff one, one in the body: a pressure of its own in each. The saddle point is as good as
// rounding times the contrast, its energy better.
TEST_F(Contrast, AgreesWithTheSaddlePoint) {
  const std::string scene = R"(
[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1
poisson = 0.5
[[region]]
name = "shell"
polygon = [[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]]
young = 1e4
poisson = 0.5
[[region]]
name = "core"
polygon = [[0.35, 0.35], [0.6, 0.35], [0.6, 0.6], [0.35, 0.6]]
young = 1e-2
poisson = 0.5
[[region]]
name = "other"
polygon = [[1.3, 0.3], [1.7, 0.4], [1.4, 0.7]]
young = 1e-4
poisson = 0.5
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [1, "y"]
[mesh]
size = 0.2
)";
  const json r = run_scene(scene), truth = run_scene(scene, Job::Solve, {"solver.backend='umfpack'"});
  EXPECT_EQ(r["status"], "ok");
  const double energy = truth["state"]["energy"];
  EXPECT_NEAR(r["state"]["energy"].get<double>(), energy, 1e-10 * std::abs(energy));
  EXPECT_LT(r["state"]["residual"].get<double>(), 1e-9);
}

// Wholly enclosed: one pressure per piece, and the mean of all is 0.
TEST_F(Contrast, LeavesNoLevelOfPressure) {
  const std::string scene = R"(
[domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["o", "o", "o", "o"]
[material]
young = 1
poisson = 0.5
[[region]]
name = "r"
polygon = [[0.3, 0.25], [0.7, 0.3], [0.65, 0.7], [0.3, 0.6]]
young = 1
poisson = 0.5
[[boundary]]
on = "o"
displacement = ["x*x - y", "-2*x*y + 3*x"]
[[probe]]
name = "p"
points = [[0.1, 0.1], [0.5, 0.5]]
[mesh]
size = 0.15
)";
  for (const char* ratio : {"region[0].young=1e-4", "region[0].young=1e4"}) {
    run_scene(scene, Job::Solve, {ratio});
    const std::vector<double> outside = stress(0), inside = stress(1);
    run_scene(scene, Job::Solve, {ratio, "solver.backend='umfpack'"});
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(outside[i], stress(0)[i], 1e-8) << ratio;
      EXPECT_NEAR(inside[i], stress(1)[i], 1e-8) << ratio;
    }
  }
}

// Adjoints go through the same iteration: the map of a body with a stiff region tends to that with a rigid one.
TEST_F(Contrast, MapsTendToThoseOfARigidRegion) {
  const std::string scene = fmt::format(fmt::runtime(body), fmt::arg("body", ""), fmt::arg("region", ""),
                                        fmt::arg("ratio", 1e8), fmt::arg("displacement", "[0, 0]")) +
                            "[functional]\nkind = \"displacement_tracking\"\ntarget = [0, 0]\n"
                            "[map]\nperturbation = \"hole\"\npoints = [[0.15, 0.2], [0.8, 0.8], [0.5, 0.15]]\n";
  const json stiff = run_scene(scene, Job::Map), softer = run_scene(scene, Job::Map, {"region[0].young=1e3"}),
             softest = run_scene(scene, Job::Map, {"region[0].young=5e2"});
  for (int i = 0; i < 3; ++i) {
    const auto value = [i](const json& r) { return r["map"]["points"][i]["value"].get<double>(); };
    // Linear in 1/young: extrapolated to 0 with an error of the order of its square.
    EXPECT_NEAR(value(stiff), 2 * value(softer) - value(softest), 2e-5 * std::abs(value(stiff))) << i;
  }
}

}  // namespace
}  // namespace kerf::contrast_test
