// A bar under tension, through the program: its energy in closed form lies in the bounds.

#include "tests/truth/scene.hpp"

namespace kerf::bar_test {
namespace {

// A bar of length L under tension p on rollers: energy -p^2 L h (1 - nu^2)/(2 E) in plane strain.
TEST_F(Truth, ABarUnderTension) {
  const nlohmann::json r = run_scene(R"(
[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 3.0
poisson = 0.25
[[boundary]]
on = "left"
displacement_x = 0
[[boundary]]
on = "bottom"
displacement_y = 0
[[boundary]]
on = "right"
traction = [0.7, 0]
[mesh]
size = 0.3
)");
  const double energy = -0.49 * 2 * (1 - 0.0625) / (2 * 3.0);
  EXPECT_NEAR(r["state"]["energy"], energy, 1e-12);
  EXPECT_LE(r["state"]["energy_bounds"][0], energy + 1e-12);
  EXPECT_GE(r["state"]["energy_bounds"][1], energy - 1e-12);
}

}  // namespace
}  // namespace kerf::bar_test
