// Orthotropic bodies as case files: against closed forms and bodies that are the same by another name, and every job,
// change and functional either works or is refused by name.

#include "tests/truth/scene.hpp"

#include <fmt/core.h>

#include <cmath>

namespace kerf::orthotropic_test {
namespace {

using nlohmann::json;

const std::string wood = R"(
[material]
young = [10, 1]
poisson = 0.4
shear = 0.6
angle = 30
state = "plane stress"
)";

const std::string plate = R"(
[domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["bottom", "right", "top", "left"]
[[boundary]]
on = "top"
traction = ["0.2", "1 + 0.5*x"]
[[boundary]]
on = "bottom"
displacement = [0, 0]
[mesh]
size = 0.3
)";

const std::string crack = R"(
[[crack]]
name = "c"
path = [[-0.4, 0], [0.4, 0]]
)";

/// The largest stress along the rim of a round hole in an infinite plate, pulled by 1 at the angle to axis 1
/// [Lekhnitskii 1968]: 1 + sqrt(2 (sqrt(E1/E2) - nu12) + E1/G12) along the axis.
double largest_on_rim(double first, double second, double nu, double shear, double angle) {
  const double k = std::sqrt(first / second), n = std::sqrt(2 * (k - nu) + first / shear);
  const double c = std::cos(angle), s = std::sin(angle);
  double most = 0;
  for (int i = 0; i < 3600; ++i) {
    const double at = i * pi / 3600, x = std::cos(at), y = std::sin(at);
    const double soft = std::pow(y, 4) + (first / shear - 2 * nu) * x * x * y * y + std::pow(x, 4) * first / second;
    const double stress = ((-c * c + (k + n) * s * s) * k * x * x + ((1 + n) * c * c - k * s * s) * y * y -
                           n * (1 + k + n) * s * c * x * y) /
                          soft;
    most = std::max(most, std::abs(stress));
  }
  return most;
}

TEST_F(Truth, OrthotropicHoleHasLekhnitskiisFactor) {
  const std::string holed = R"(
[domain]
outline = [[-80, -80], [80, -80], [80, 80], [-80, 80]]
sides = ["bottom", "right", "top", "left"]
[[hole]]
name = "h"
circle = { center = [0, 0], radius = 1 }
[[boundary]]
on = "top"
traction = [0, 1]
[[boundary]]
on = "bottom"
traction = [0, -1]
[mesh]
size = 16
[solver]
degree = 2
)";
  const auto factor = [&](const std::string& angle) {
    const json r = run_scene(wood + holed, Job::Solve, {angle, "mesh.adapt={error=3e-5}"});
    return r["state"]["max_von_mises"]["value"].get<double>();
  };
  for (const double angle : {90., 0., 30.})
    EXPECT_NEAR(
        factor(fmt::format("material.angle={}", angle)) / largest_on_rim(10, 1, 0.4, 0.6, (90 - angle) * pi / 180), 1,
        0.02)  // the hole is a polygon
        << angle;
}

// Constants that are those of an isotropic material give its answer, in all jobs.
TEST_F(Truth, OrthotropicConstantsMayBeIsotropic) {
  const std::string rest = plate + crack + "[map]\npoints = [[0.2, 0.5]]\nperturbation = \"crack\"\n";
  const json same = run_scene(rest + "[material]\nyoung = 2\npoisson = 0.25\nstate = \"plane stress\"\n", Job::Map);
  const json r = run_scene(
      rest + "[material]\nyoung = [2, 2]\npoisson = 0.25\nshear = 0.8\nangle = 20\nstate = \"plane stress\"\n",
      Job::Map);
  const auto near = [](const json& a, const json& b) { EXPECT_NEAR(a.get<double>() / b.get<double>(), 1, 1e-9); };
  near(r["state"]["energy"], same["state"]["energy"]);
  near(r["cracks"][0]["tips"][0]["K_I"], same["cracks"][0]["tips"][0]["K_I"]);
  near(r["cracks"][0]["tips"][0]["G"], same["cracks"][0]["tips"][0]["G"]);
  near(r["map"]["points"][0]["value"], same["map"]["points"][0]["value"]);
}

// A quarter turn of body, loads and material; and the axes exchanged: E2, E1, nu21 at 90 degrees more.
TEST_F(Truth, OrthotropicBodiesTurn) {
  const std::string turned = R"(
[domain]
outline = [[1, -1], [1, 1], [-1, 1], [-1, -1]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[0, -0.4], [0, 0.4]]
[[boundary]]
on = "top"
traction = ["-1 - 0.5*y", "0.2"]
[[boundary]]
on = "bottom"
displacement = [0, 0]
[mesh]
size = 0.3
)";
  const json r = run_scene(wood + plate + crack), q = run_scene(wood + turned, Job::Solve, {"material.angle=120"}),
             x = run_scene(wood + plate + crack, Job::Solve,
                           {"material.young=[1, 10]", "material.poisson=0.04", "material.angle=-60"});
  const double energy = r["state"]["energy"].get<double>();
  EXPECT_NEAR(x["state"]["energy"].get<double>() / energy, 1, 1e-10);
  EXPECT_NEAR(q["state"]["energy"].get<double>() / energy, 1, 1e-2);  // of another mesh
  for (std::size_t tip = 0; tip < 2; ++tip) {
    const auto value = [&](const json& of, const char* name) {
      return of["cracks"][0]["tips"][tip][name].get<double>();
    };
    const double size = std::hypot(value(r, "K_I"), value(r, "K_II"));
    for (const char* name : {"K_I", "K_II"}) {
      EXPECT_NEAR(value(x, name), value(r, name), 1e-9 * size);
      EXPECT_NEAR(value(q, name), value(r, name), 0.02 * size);
    }
  }
}

// A strip that is pulled, half of it orthotropic: the works of both halves by hand.
TEST_F(Truth, OrthotropicRegions) {
  const json r = run_scene(R"(
[domain]
outline = [[0, 0], [4, 0], [4, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[[region]]
name = "fiber"
polygon = [[1, 0.25], [3, 0.25], [3, 0.75], [1, 0.75]]
young = [8, 2]
poisson = 0.3
shear = 1
[material]
young = 2
poisson = 0.075
state = "plane stress"
[[boundary]]
on = ["left", "right"]
traction = ["0", "ny"]
[[boundary]]
on = ["bottom", "top"]
traction = ["0", "ny"]
[mesh]
size = 0.3
)");
  // s_yy = 1 everywhere: e_yy = 1/2 in both, and e_xx = -0.0375 in both as well.
  EXPECT_NEAR(r["state"]["compliance"].get<double>(), 4 * 0.5, 1e-9);
}

// What is asked of an orthotropic body, and what it answers: numbers, or a sentence that names what is not known.
TEST_F(Truth, OrthotropicBodiesAnswerOrRefuseByName) {
  const auto refused = [&](const std::string& what, Job job, const std::string& text, const std::string& named) {
    SCOPED_TRACE(what);
    for (const bool region : {false, true}) {
      const std::string material =
          region
              ? "[material]\nyoung = 1\npoisson = 0.3\nstate = \"plane stress\"\n[[region]]\nname = \"r\"\ncircle = { "
                "center = [0.5, 0.6], radius = 0.2 }\nyoung = [10, 1]\npoisson = 0.3\nshear = 1\n"
              : wood;
      try {
        run_scene(material + plate + text, job);
        ADD_FAILURE() << "not refused";
      } catch (const Error& e) {
        EXPECT_EQ(e.fault, Fault::Usage) << e.what();
        EXPECT_NE(std::string(e.what()).find("orthotropic"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find(named), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("scene.toml:"), std::string::npos) << e.what();
      }
    }
  };
  const std::string points = "points = [[-0.5, 0.4]]\n", radii = "[validate]\n" + points + "radii = [0.1, 0.05]\n";
  for (const auto& [change, named] :
       {std::pair("\"clamped_hole\"", "clamped_hole"), std::pair("{ young = 2, poisson = 0.3 }", "inclusion"),
        std::pair("\"crack\"", "crack")}) {
    const std::string map = fmt::format("[map]\n{}perturbation = {}\nradius = 0.05\n", points, change);
    refused(change, Job::Map, map, named);
    refused(change, Job::Validate, map + radii, named);
    refused(change, Job::Run, map + radii, named);
  }
  for (const char* kind : {"stress_power", "stress_pnorm"}) {
    const std::string j = fmt::format("[functional]\nkind = \"{}\"\np = 2\n", kind);
    refused(kind, Job::Map, j + "[map]\n" + points, kind);
    refused(kind, Job::Validate, j + radii, kind);
  }
  const std::string at_most = "volume = { at_most = 0.5 }\nmax_iterations = 2\n";
  refused("level set", Job::Optimize,
          "[functional]\nkind = \"compliance\"\n[optimize]\nmethod = \"level-set\"\n" + at_most, "isotropic");
  for (const char* method : {"mma", "slsqp", "ccsaq", "cobyla"})
    refused(method, Job::Optimize,
            fmt::format("[functional]\nkind = \"compliance\"\n[optimize]\nmethod = \"{}\"\n{}[[optimize.hole]]\n"
                        "circle = {{ center = [[-0.6, -0.2], [-0.5, 0.5]], radius = [0.1, 0.2] }}\n",
                        method, at_most),
            "isotropic");
}

TEST_F(Truth, OrthotropicBodiesHaveTheOtherFunctionals) {
  const std::string points = "[map]\npoints = [[-0.5, 0.5]]\n";
  const auto value = [&](const std::string& text) {
    const json r = run_scene(wood + plate + crack + text + points, Job::Map, {"mesh.size=0.15"});
    EXPECT_EQ(r["status"], "ok");
    return r["map"]["points"][0]["value"].get<double>();
  };
  const double energy = value(""), compliance = value("[functional]\nkind = \"compliance\"\n");
  EXPECT_NEAR(compliance, -2 * energy, 1e-9 * std::abs(energy));
  for (const char* j :
       {"kind = \"volume\"", "kind = \"displacement_tracking\"\ntarget = [\"0\", \"0\"]",
        "kind = \"boundary_tracking\"\non = \"top\"\ntarget = [\"0\", \"0\"]",
        "kind = \"energy_release_rate\"\ncrack = \"c\"\ntip = \"end\"\nring = [0.1, 0.3]",
        "kind = \"crack_opening\"\ncrack = \"c\"", "kind = \"misfit\"\non = \"top\"\nmeasured = [\"0.1\", \"x\"]"})
    EXPECT_TRUE(std::isfinite(value(fmt::format("[functional]\n{}\n", j)))) << j;
}

// In one material the power at the tip stays 1/2 under friction, which does not push faces on (K to .1 %).
TEST_F(Truth, FrictionInOrthotropicBodiesHoldsFacesBack) {
  const json sliding = run_scene(wood + plate + crack), held = run_scene(wood + plate + crack + "friction = 0.3\n");
  EXPECT_EQ(held["status"], "ok");
  for (int tip = 0; tip < 2; ++tip) {
    const auto K_II = [&](const json& r) { return r["cracks"][0]["tips"][tip]["K_II"].get<double>(); };
    EXPECT_LE(std::abs(K_II(held)), std::abs(K_II(sliding)) * 1.002);
  }
}

TEST_F(Truth, OrthotropicConstantsAreChecked) {
  const auto words = [&](const std::vector<std::string>& overrides) -> std::string {
    try {
      run_scene(wood + plate, Job::Solve, overrides);
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Usage);
      return e.what();
    }
    return "";
  };
  EXPECT_NE(words({"material.poisson=4"}).find("E1/E2"), std::string::npos);
  EXPECT_NE(words({"material.poisson=4"}).find("scene.toml:3:"), std::string::npos);
  EXPECT_NE(words({"material.young=[1, -1]"}).find("young"), std::string::npos);
  EXPECT_NE(words({"material.young=[1, 2, 3]"}).find("young"), std::string::npos);
  EXPECT_NE(words({"material.young=1"}).find("shear"), std::string::npos);
  EXPECT_NE(words({"material.state='plane strain'"}).find("plane stress"), std::string::npos);
  EXPECT_EQ(words({"material.poisson=1.5"}), "");
}

}  // namespace
}  // namespace kerf::orthotropic_test
