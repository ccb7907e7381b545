// Orthotropy, pressure in cracks and eigenstrains together, against bodies that have one of them less.

#include "tests/truth/scene.hpp"

#include <fmt/format.h>

namespace kerf::combined_test {
namespace {

// Crack, material, eigenstrain; what acts on the sides, vertical displacement of the ends (or nothing).
std::string plate(const std::string& crack, const std::string& material, const std::string& outside) {
  return fmt::format(R"toml(
[domain]
outline = [[0, -2], [1, -2], [1, 2], [0, 2]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[0.3, -0.1], [0.7, 0.2]]
contact = "open"
{}
[material]
poisson = 0.2
state = "plane stress"
{}
{}
[mesh]
size = 0.15
[solver]
degree = 2
)toml",
                     crack, material, outside);
}

constexpr const char* orthotropic = "young = [4, 1]\nshear = 0.6\nangle = 25";
constexpr const char* isotropic = "young = 1";

const auto held = [](const std::string& y) {
  return "[[boundary]]\non = [\"bottom\", \"top\"]\ndisplacement_y = " + y;
};

class Combined : public Truth {
 protected:
  nlohmann::json tips(const std::string& scene) {
    const auto result = run_scene(scene);
    EXPECT_LT(result["state"]["energy_bounds"][0], result["state"]["energy_bounds"][1]);
    return result["cracks"][0]["tips"];
  }
  static void expect_equal(const nlohmann::json& a, const nlohmann::json& b, double tolerance) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
      for (const char* key : {"K_I", "K_II", "T", "G"})
        EXPECT_NEAR(a[k][key].get<double>(), b[k][key].get<double>(), tolerance) << k << key;
  }
};

// A fluid in the crack is a pull on all sides, but for a uniform pressure.
TEST_F(Combined, PressureInAnOrthotropicBody) {
  const auto pressed = tips(plate("pressure = 1", orthotropic, ""));
  const auto pulled =
      tips(plate("", orthotropic, "[[boundary]]\non = [\"bottom\", \"right\", \"top\", \"left\"]\npressure = -1"));
  EXPECT_GT(pressed[0]["K_I"], 0.5);
  expect_equal(pressed, pulled, 1e-6);
}

// A linear eigenstrain between held ends is a body without one whose ends are moved.
TEST_F(Combined, HeatInAnOrthotropicBody) {
  const auto heated =
      tips(plate("", std::string(orthotropic) + "\neigenstrain = [\"0.5*(1 - 2*x)\", \"1 - 2*x\", 0]", held("0")));
  const auto moved = tips(plate("", orthotropic, held("\"-(1 - 2*x)*y\"")));
  EXPECT_GT(std::abs(heated[0]["K_I"].get<double>()), 0.01);
  expect_equal(heated, moved, 2e-4);
}

// An open crack is linear in what acts.
TEST_F(Combined, PressureAndHeatAddUp) {
  const std::string heat = "\neigenstrain = [\"exp(-4*(x^2 + y^2))\", \"x*y\", \"0.3*x^2\"]";
  for (const std::string material : {isotropic, orthotropic}) {
    const auto both = tips(plate("pressure = \"1 + x\"", material + heat, held("0"))),
               hot = tips(plate("", material + heat, held("0"))),
               pressed = tips(plate("pressure = \"1 + x\"", material, held("0")));
    for (std::size_t k = 0; k < both.size(); ++k)
      for (const char* key : {"K_I", "K_II", "T"})
        EXPECT_NEAR(both[k][key].get<double>(), hot[k][key].get<double>() + pressed[k][key].get<double>(), 1e-9)
            << material << k << key;
  }
}

}  // namespace
}  // namespace kerf::combined_test
