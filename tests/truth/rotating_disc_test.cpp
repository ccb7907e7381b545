// A disc that nothing holds under a radial body force, as in a centrifuge: s_r = (3 + nu)/8 (1 - r^2), and
// u_r = (1 - nu)/8 r (3 + nu - (1 + nu) r^2) in plane stress [closed form by the radial equation of equilibrium].

#include "tests/truth/scene.hpp"

namespace kerf::rotating_disc_test {
namespace {

class RotatingDisc : public Truth {};

// Before: exit 4 on some meshes, "the loads do not balance": the force works on the free rotation by rounding alone,
// and was measured against the sum of the absolute values of that rounding.
TEST_F(RotatingDisc, NeedsNoSupport) {
  for (const char* size : {"0.2", "0.1"}) {
    SCOPED_TRACE(size);
    const nlohmann::json r = run_scene(std::string(R"(
[domain]
outline = [{ arc_to = [-1, 0], center = [0, 0] }, { arc_to = [1, 0], center = [0, 0] }]
sides = ["rim", "rim"]
[material]
young = 1
poisson = 0.3
state = "plane stress"
[body]
force = ["x", "y"]
[solver]
degree = 2
[mesh]
size = )") + size + "\n");
    // The work of the body force: 2 pi int u_r r^2 dr.
    const double work = 2 * pi * 0.7 / 8 * (3.3 / 4 - 1.3 / 6);
    EXPECT_NEAR(r["state"]["compliance"].get<double>(), work, 2e-3 * work);
    EXPECT_NEAR(r["state"]["max_von_mises"]["value"].get<double>(), 3.3 / 8, 2e-3);
  }
}

}  // namespace
}  // namespace kerf::rotating_disc_test
