// What a half disc of material on a free edge brings, by bodies that have one.

#include "tests/truth/scene.hpp"

#include "topo/bump.hpp"

#include <fmt/core.h>

#include <cmath>

namespace kerf::bump_test {
namespace {

// The right half of a large square with the half disc on its top, pulled on the right: mirror images on both axes.
constexpr const char* square = R"(
[domain]
outline = [[0, -{0}], [{0}, -{0}], [{0}, 0], [1, 0], {{ arc_to = [0, 1], center = [0, 0] }}]
sides = ["below", "right", "top", "bump", "middle"]
[material]
young = 2
poisson = {1}
state = "{2}"
[[boundary]]
on = "right"
traction = [1, 0]
[[boundary]]
on = "middle"
displacement_x = 0
[[boundary]]
on = "below"
displacement_y = 0
[functional]
kind = "compliance"
[solver]
element = "afw"
degree = 2
[mesh]
size = {3}
adapt = {{ error = 3e-3, max_triangles = 6000 }}
)";

TEST_F(Truth, HalfDiscsOnFreeEdgesBringTheirShareOfALayer) {
  struct Plane {
    const char* state;
    double poisson, modulus;
  };
  for (const Plane& plane : {Plane{"plane stress", 0.3, 2}, Plane{"plane strain", 0.45, 2 / (1 - 0.45 * 0.45)}}) {
    constexpr double half = 12;
    const auto result = run_scene(fmt::format(square, half, plane.poisson, plane.state, half / 8));
    // The square alone has a uniform stress; a layer takes 1/modulus per area from the compliance.
    const double alone = half * half / plane.modulus, layer = 0.25 * M_PI / plane.modulus;
    const double value = result["functional"]["value"];
    EXPECT_NEAR((alone - value) / layer, bump_share, 2e-3) << plane.state;
  }
}

}  // namespace
}  // namespace kerf::bump_test
