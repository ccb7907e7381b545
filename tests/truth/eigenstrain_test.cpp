// Eigenstrains against closed forms, bodies without one, and energies of bodies with a longer crack.

#include "tests/truth/scene.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kerf::eigenstrain_test {
namespace {

constexpr const char* rectangle = R"toml(
[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 10
poisson = 0.3
state = "{1}"
eigenstrain = {2}
[solver]
element = "{0}"
backend = "{3}"
[mesh]
size = 0.25
)toml";

// A temperature that is linear in x leaves no stress in a body that nothing holds.
TEST_F(Truth, CompatibleEigenstrainsStrainWithoutStress) {
  for (const char* element : {"bdms", "bdms-c", "peers", "afw"})
    for (const char* backend : {"cholmod", "umfpack"}) {
      const auto uniform = run_scene(fmt::format(rectangle, element, "plane stress", "[0.01, -0.02, 0.005]", backend));
      EXPECT_LT(uniform["state"]["energy"], 1e-28) << element << backend;
      // e x less the mean rotation about the middle, at a corner; the mean is that of displacements per triangle.
      EXPECT_NEAR(uniform["state"]["max_displacement"]["value"], std::hypot(0.014, 0.008), 1e-4) << element << backend;
      // The rotation is not linear in all elements: the stress of the others errs by order h.
      if (element != std::string("bdms") && element != std::string("bdms-c")) continue;
      const auto linear =
          run_scene(fmt::format(rectangle, element, "plane stress", "[\"0.01*x\", \"0.01*x\", 0]", backend));
      EXPECT_LT(linear["state"]["energy"], 1e-28) << element << backend;
    }
}

// Held all around nothing moves: the stress is -C e, with the law of three dimensions.
TEST_F(Truth, AHeldBodyIsStressedByItsEigenstrain) {
  const std::string held = R"toml(
[[boundary]]
on = ["bottom", "right", "top", "left"]
displacement = [0, 0]
)toml";
  const double young = 10, nu = 0.3, mu = young / 2.6, lambda = 2 * mu * nu / (1 - 2 * nu);
  const double e11 = 0.01, e22 = 0.02, e12 = 0.005, e33 = 0.03;
  const auto result =
      run_scene(fmt::format(rectangle, "bdms", "plane strain", "[0.01, 0.02, 0.005, 0.03]", "cholmod") + held);
  const double trace = e11 + e22 + e33;
  const double s11 = -2 * mu * e11 - lambda * trace, s22 = -2 * mu * e22 - lambda * trace,
               s33 = -2 * mu * e33 - lambda * trace, s12 = -2 * mu * e12;
  const double mises =
      std::sqrt(0.5 * (std::pow(s11 - s22, 2) + std::pow(s22 - s33, 2) + std::pow(s33 - s11, 2)) + 3 * s12 * s12);
  EXPECT_NEAR(result["state"]["max_von_mises"]["value"], mises, 1e-10 * mises);
  // In the plane problem: 1/2 (C e, e) with the strains that nu e33 is in.
  const double p11 = e11 + nu * e33, p22 = e22 + nu * e33;
  const double energy = 2 * (mu * (p11 * p11 + p22 * p22 + 2 * e12 * e12) + 0.5 * lambda * std::pow(p11 + p22, 2));
  EXPECT_NEAR(result["state"]["energy"], energy, 1e-11 * energy);
  EXPECT_LE(result["state"]["energy_bounds"][0], energy * (1 + 1e-12));
  EXPECT_GE(result["state"]["energy_bounds"][1], energy * (1 - 1e-12));
  EXPECT_NEAR(result["state"]["energy_bounds"][0], energy, 1e-9 * energy);
}

// A disc too large by e for the hole in a ring of its own material, plane stress: a pressure E e (1 - a^2/b^2)/2
// between them (Lame), and the energy of both.
TEST_F(Truth, AMisfitDiscPressesOnItsRing) {
  const double young = 10, a = 1, b = 2, e = 0.01, pressure = 0.5 * young * e * (1 - a * a / (b * b));
  constexpr const char* body = R"toml(
[domain]
outline = [{{ arc_to = [2, 0], center = [0, 0] }}, {{ arc_to = [-2, 0], center = [0, 0] }}]
sides = ["rim", "rim"]
[material]
young = 10
poisson = 0.3
state = "plane stress"
[[region]]
name = "disc"
circle = {{ center = [0, 0], radius = 1 }}
eigenstrain = [0.01, 0.01, 0]
[solver]
degree = 2
[mesh]
size = {}
)toml";
  // Half the pressure times the misfit e a along the rim.
  const double energy = M_PI * a * a * e * pressure;
  const auto result = run_scene(fmt::format(body, 0.15));
  EXPECT_NEAR(result["state"]["energy"], energy, 2e-3 * energy);
  EXPECT_LE(result["state"]["estimated_error"], 0.05);
}

// The ends of a plate held, its crack on the cold side. Less the strain alone, which is compatible, that is the plate
// without heat whose ends are moved.
constexpr const char* plate = R"toml(
[domain]
outline = [[0, -2], [1, -2], [1, 2], [0, 2]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
{3}
[material]
young = 1
poisson = 0.3
{0}
[[boundary]]
on = ["bottom", "top"]
displacement_y = {1}
[mesh]
size = {2}
[solver]
degree = 2
)toml";

TEST_F(Truth, TipsInAHeatedPlateAreThoseOfMovedEnds) {
  for (const char* crack : {"path = [[0, 0], [0.5, 0]]", "path = [[0.2, -0.1], [0.6, 0.3]]"}) {
    const auto heated =
        run_scene(fmt::format(plate, "eigenstrain = [\"2*x - 1\", \"2*x - 1\", 0, \"2*x - 1\"]", "0", 0.2, crack));
    const auto moved = run_scene(fmt::format(plate, "", "\"-1.3*(2*x - 1)*y\"", 0.2, crack));
    const auto &tips = heated["cracks"][0]["tips"], &others = moved["cracks"][0]["tips"];
    ASSERT_EQ(tips.size(), others.size());
    for (std::size_t k = 0; k < tips.size(); ++k)
      for (const char* key : {"K_I", "K_II", "T", "G"})
        EXPECT_NEAR(tips[k][key].get<double>(), others[k][key].get<double>(), 2e-4) << crack << k << key;
    EXPECT_GT(tips.back()["K_I"], 0.02);
  }
}

// A strain that is not compatible, next to the tip: G is what the energy loses per length of crack.
TEST_F(Truth, EnergyReleaseInAHotSpotIsTheSlopeOfTheEnergy) {
  const auto at = [&](double tip) {
    return run_scene(fmt::format(plate, "eigenstrain = [\"exp(-8*((x - 0.6)^2 + (y - 0.2)^2))\", \"0.5*x^3\", \"x*y\"]",
                                 "0", 0.1, fmt::format("path = [[0, 0], [{}, 0]]\ncontact = \"open\"", tip)));
  };
  const double step = 0.02;
  const auto shorter = at(0.5 - step), middle = at(0.5), longer = at(0.5 + step);
  const double slope =
      (longer["state"]["energy"].get<double>() - shorter["state"]["energy"].get<double>()) / (2 * step);
  const auto& tip = middle["cracks"][0]["tips"][0];
  EXPECT_NEAR(tip["G"].get<double>(), -slope, 0.01 * std::abs(slope));
}

// An insulated crack in a flow of heat [theory: H.7].
TEST_F(Truth, AnInsulatedCrackInAFlowOfHeat) {
  const std::string body = R"toml(
[domain]
outline = [[-10, -10], [10, -10], [10, 10], [-10, 10]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[-1, 0], [1, 0]]
contact = "open"
[define]
X = "x^2 - y^2 - 1"
R = "sqrt(X^2 + 4*x^2*y^2)"
flow = "X > 0 ? abs(x)*y/sqrt((R + X)/2) : (y > 0 ? 1 : -1)*sqrt((R - X)/2)"
heat = "max(-sqrt(R), min(sqrt(R), flow))"
[material]
young = 1
poisson = 0.3
state = "plane stress"
eigenstrain = ["heat", "heat", 0]
[mesh]
size = 1
crack_tip_size = 0.05
[solver]
degree = 2
)toml";
  const auto result = run_scene(body);
  const double exact = 0.25 * std::sqrt(M_PI);
  for (const auto& tip : result["cracks"][0]["tips"]) {
    EXPECT_NEAR(std::abs(tip["K_II"].get<double>()), exact, 0.02 * exact);
    EXPECT_NEAR(tip["K_I"].get<double>(), 0, 0.005 * exact);
  }
  // The heat jumps across the crack, along edges: bounds and estimate know that it does not jump in triangles.
  const double lower = result["state"]["energy_bounds"][0], upper = result["state"]["energy_bounds"][1];
  EXPECT_LT(upper - lower, 0.01 * upper);
  EXPECT_LT(result["state"]["estimated_error"], 0.08);
  EXPECT_EQ(result.dump().find("known at sampled points"), std::string::npos);
}

// Held all around, incompressible, and asked to swell: no state. Free at the top it rises by what it swells.
TEST_F(Truth, AnIncompressibleBodySwellsByItsEigenstrain) {
  const std::string body = R"toml(
[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 10
poisson = 0.5
eigenstrain = [0.01, 0.01, 0]
[[boundary]]
on = "bottom"
displacement_y = 0
[[boundary]]
on = ["left", "right"]
displacement_x = 0
[functional]
kind = "boundary_tracking"
on = "top"
target = [0, 0]
[mesh]
size = 0.25
)toml";
  const auto result = run_scene(body);
  // Uniaxial: strain_yy = 0.02, s_xx = -4 mu e; J = 1/2 int |u|^2.
  const double mu = 10.0 / 3, energy = 0.5 * 2 * 0.01 * 4 * mu * 0.01;
  EXPECT_NEAR(result["state"]["energy"], energy, 1e-9 * energy);
  EXPECT_NEAR(result["functional"]["value"], 0.02 * 0.02, 1e-12);
}

// Maps in a body with a hot spot and a crack, against bodies that have the change.
TEST_F(Truth, MapsHoldInABodyWithAnEigenstrain) {
  constexpr const char* body = R"toml(
[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[0.6, 0.3], [1.1, 0.55]]
[material]
young = 2
poisson = 0.3
eigenstrain = ["0.05*exp(-4*((x - 0.6)^2 + (y - 0.5)^2))", "0.03*x*y", "0.02*y^2"]
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [0.02, -0.01]
[functional]
{0}
[map]
perturbation = {1}
[validate]
points = [[1.4, 0.6]]
radii = [0.06, 0.03, 0.015]
[mesh]
size = 0.2
[solver]
degree = 2
)toml";
  const std::pair<const char*, const char*> changes[] = {
      {"kind = \"energy\"", "\"hole\""},
      {"kind = \"compliance\"", "{ young = 0.3, poisson = 0.2 }"},
      {"kind = \"displacement_tracking\"\ntarget = [0, 0]", "\"crack\""},
      {"kind = \"crack_opening\"\ncrack = \"c\"", "\"hole\""}};
  for (const auto& [functional, change] : changes) {
    const auto result = run_scene(fmt::format(body, functional, change), Job::Validate);
    EXPECT_EQ(result["validate"][0]["verdict"], "holds") << functional << change;
  }
}

}  // namespace
}  // namespace kerf::eigenstrain_test
