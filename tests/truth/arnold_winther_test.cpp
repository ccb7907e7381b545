// The element of the original work on the bodies that it was refused for.

#include "tests/truth/scene.hpp"

namespace kerf::arnold_winther_test {
namespace {

using nlohmann::json;

// Cook's membrane, whose shear ends at free corners, for five materials: against bdms 3 on a finer mesh.
TEST_F(Truth, ArnoldWintherBearsCooksMembrane) {
  const std::string cook = R"(
[domain]
outline = [[0, 0], [48, 44], [48, 60], [0, 44]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1e3
poisson = 0.3
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [0, 0.0625]
[mesh]
size = 6
)";
  for (const char* nu : {"0", "0.3", "0.49", "0.4999", "0.5"}) {
    const std::string poisson = std::string("material.poisson=") + nu;
    const json r = run_scene(cook, Job::Solve, {poisson, "solver.element='arnold-winther'"});
    const json truth = run_scene(cook, Job::Solve, {poisson, "solver.degree=3", "mesh.size=3"});
    EXPECT_EQ(r["status"], "ok") << nu;
    EXPECT_NEAR(r["state"]["compliance"].get<double>() / truth["state"]["compliance"].get<double>(), 1, 2e-3) << nu;
    EXPECT_NEAR(-2 * r["state"]["energy"].get<double>(), r["state"]["compliance"].get<double>(),
                1e-8 * r["state"]["compliance"].get<double>())
        << nu;
    EXPECT_NE(r["state"]["notes"].dump().find("no symmetric stress"), std::string::npos) << nu;
  }
}

TEST_F(Truth, ArnoldWintherBearsCracks) {
  const std::string cracked = R"(
[domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[-0.5, 0.0], [0.5, 0.1]]
[material]
young = 1000
poisson = 0.3
[[boundary]]
on = "top"
traction = [0.3, 1]
[[boundary]]
on = "bottom"
displacement = [0, 0]
[mesh]
size = 0.25
)";
  const json r = run_scene(cracked, Job::Solve, {"solver.element='arnold-winther'"});
  const json truth = run_scene(cracked, Job::Solve, {"solver.degree=2", "mesh.size=0.12", "solver.backend='umfpack'"});
  EXPECT_EQ(r["status"], "ok");
  EXPECT_NEAR(r["state"]["energy"].get<double>() / truth["state"]["energy"].get<double>(), 1, 1e-3);
  for (const int tip : {0, 1})
    for (const char* K : {"K_I", "K_II"})
      EXPECT_NEAR(r["cracks"][0]["tips"][tip][K].get<double>() / truth["cracks"][0]["tips"][tip][K].get<double>(), 1,
                  2e-3)
          << tip << K;
}

}  // namespace
}  // namespace kerf::arnold_winther_test
