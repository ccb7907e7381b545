// Loads that points miss: against the same body with the breaks drawn as vertices.

#include "tests/truth/scene.hpp"

#include <fmt/format.h>

namespace kerf::data_test {
namespace {

struct Body {
  std::string outline = "[[0, 0], [2, 0], [2, 1], [0, 1]]", sides = R"(["bottom", "right", "top", "left"])";
  std::string conditions, mesh = "size = 0.2";
};

std::string scene(const Body& b) {
  return fmt::format(R"(
[domain]
outline = {}
sides = {}
[material]
young = 1000.0
poisson = 0.3
[mesh]
{}
[[boundary]]
on = "left"
displacement = [0, 0]
{}
)",
                     b.outline, b.sides, b.mesh, b.conditions);
}

std::string on(const std::string& label, const std::string& condition) {
  return fmt::format("[[boundary]]\non = \"{}\"\n{}\n", label, condition);
}

class Loads : public Truth {
 protected:
  /// A constant traction on the drawn part of the top from x = a to b.
  nlohmann::json drawn(double a, double b, double value, const std::string& mesh) {
    return run_scene(scene({fmt::format("[[0, 0], [2, 0], [2, 1], [{}, 1], [{}, 1], [0, 1]]", b, a),
                            R"(["bottom", "right", "top", "patch", "top", "left"])",
                            on("patch", fmt::format("traction = [0, {}]", value)), mesh}));
  }
  nlohmann::json written(const std::string& load, const std::string& mesh = "size = 0.2") {
    return run_scene(scene({.conditions = on("top", fmt::format("traction = [0, \"{}\"]", load)), .mesh = mesh}));
  }
  static void expect_bounds(const nlohmann::json& r, double low, double high) {
    ASSERT_TRUE(r["state"]["energy_bounds"].is_array()) << r["state"];
    EXPECT_LE(r["state"]["energy_bounds"][0].get<double>(), low);
    EXPECT_GE(r["state"]["energy_bounds"][1].get<double>(), high);
  }
};

// Before: the whole force off by up to its size, bounds beside the truth.
TEST_F(Loads, PatchesOfEveryWidth) {
  for (const double width : {0.2, 0.1, 0.05, 0.02, 0.01}) {
    const double a = 1.513 - width / 2, b = 1.513 + width / 2, value = -1 / width;
    const nlohmann::json truth = drawn(a, b, value, "size = 0.08"),
                         r = written(fmt::format("abs(x-1.513)<{} ? {} : 0", width / 2, value));
    expect_bounds(r, truth["state"]["energy_bounds"][0], truth["state"]["energy_bounds"][1]);
    EXPECT_NEAR(r["state"]["resultants"]["loads"][0]["force"][1].get<double>(), -1, 1e-11);
    EXPECT_NEAR(r["state"]["resultants"]["loads"][0]["moment"].get<double>(), -1.513, 1e-11);
  }
}

TEST_F(Loads, AdaptRefinesToTheStrip) {
  const nlohmann::json truth = drawn(1.508, 1.518, -100, "size = 0.1\nadapt = { error = 1e-2 }"),
                       r = written("abs(x-1.513)<0.005 ? -100 : 0", "size = 0.2\nadapt = { error = 2e-2 }");
  expect_bounds(r, -0.0097760, -0.0097760);
  const std::string stopped = r["mesh"]["adapt"]["stopped"];
  EXPECT_EQ(stopped.rfind("reached", 0), 0U) << stopped;
  EXPECT_LT(r["mesh"]["h_min"].get<double>(), 0.01);
  const double energy = truth["state"]["energy"];
  EXPECT_NEAR(r["state"]["energy"].get<double>(), energy, 2e-3 * std::abs(energy));
}

// Before: disjoint.
TEST_F(Loads, BoundsOfASingularLoadMeet) {
  const nlohmann::json a = written("(2-x)^(-0.4)"), b = written("(2-x)^(-0.4)", "size = 0.1");
  EXPECT_LE(std::max(a["state"]["energy_bounds"][0].get<double>(), b["state"]["energy_bounds"][0].get<double>()),
            std::min(a["state"]["energy_bounds"][1].get<double>(), b["state"]["energy_bounds"][1].get<double>()));
  // No polynomial is near a load whose square is not integrable: said, not bounded.
  const nlohmann::json steep = written("(2-x)^(-0.8)");
  EXPECT_TRUE(steep["state"]["energy_bounds"].is_null());
  EXPECT_NE(steep["state"]["notes"].dump().find("\\\"top\\\""), std::string::npos) << steep["state"]["notes"];
}

// A ramp of width .02, drawn as three sides that are linear.
TEST_F(Loads, PrescribedDisplacements) {
  const auto moved = [&](const Body& b) { return run_scene(scene(b)); };
  const nlohmann::json truth = moved(
      {"[[0, 0], [2, 0], [2, 1], [1.523, 1], [1.503, 1], [0, 1]]", R"(["bottom", "right", "a", "b", "c", "left"])",
       on("a", "displacement_y = 0.1") + on("b", R"(displacement_y = "0.1*(x-1.503)/0.02")") +
           on("c", "displacement_y = 0"),
       "size = 0.05"});
  const nlohmann::json r = moved({.conditions = on("top", R"(displacement_y = "min(max((x-1.503)/0.02,0),1)*0.1")")});
  expect_bounds(r, truth["state"]["energy_bounds"][0], truth["state"]["energy_bounds"][1]);
  // A step has no displacement of finite energy.
  const nlohmann::json step = moved({.conditions = on("top", R"(displacement_y = "x > 1.513 ? 0.1 : 0")")});
  EXPECT_TRUE(step["state"]["energy_bounds"].is_null());
  EXPECT_NE(step["state"]["notes"].dump().find("jumps"), std::string::npos);
  const nlohmann::json refined = moved({.conditions = on("top", R"(displacement_y = "x > 1.513 ? 0.1 : 0")"),
                                        .mesh = "size = 0.2\nadapt = { error = 10, max_triangles = 500 }"});
  const std::string stopped = refined["mesh"]["adapt"]["stopped"];
  EXPECT_NE(stopped.rfind("reached", 0), 0U) << stopped;
  EXPECT_NE(stopped.find("jumps"), std::string::npos) << stopped;
}

// A disc and a strip of body force: the whole force arrives, and the bounds hold the energy of finer meshes.
TEST_F(Loads, BodyForces) {
  for (const std::string f : {"(x-1.513)^2+(y-0.51)^2<0.0004 ? -100 : 0", "abs(x-1.513)<0.005 ? -100 : 0",
                              "100*exp(-((x-1.513)^2+(y-0.51)^2)/0.0001)"}) {
    const auto with = [&](const std::string& mesh) {
      return run_scene(scene({.conditions = "[body]\nforce = [0, \"" + f + "\"]", .mesh = mesh}));
    };
    const double force = f[0] == '(' ? -100 * pi * 4e-4 : f[0] == 'a' ? -1 : 100 * pi * 1e-4;
    const nlohmann::json coarse = with("size = 0.2"), fine = with("size = 0.05");
    EXPECT_NEAR(coarse["state"]["resultants"]["body"]["force"][1].get<double>(), force, 0.02 * std::abs(force)) << f;
    ASSERT_TRUE(coarse["state"]["energy_bounds"].is_array()) << f << coarse["state"];
    EXPECT_LE(coarse["state"]["energy_bounds"][0].get<double>(), fine["state"]["energy_bounds"][1].get<double>()) << f;
    EXPECT_GE(coarse["state"]["energy_bounds"][1].get<double>(), fine["state"]["energy_bounds"][0].get<double>()) << f;
    expect_bounds(coarse, fine["state"]["energy"].get<double>(), fine["state"]["energy"].get<double>());
  }
}

TEST_F(Loads, AreCheckedBeforeTheSolve) {
  const std::filesystem::path file = folder / "checked.toml";
  std::ofstream(file) << scene(
      {.conditions = on("top", R"(traction = [0, "abs(x-1.513)<0.005 ? -100 : 0"])") + on("right", "pressure = 2")});
  const std::string text = check(read_case(file, {}));
  EXPECT_NE(text.find("force (0, -1), moment -1.513 about (0, 0)"), std::string::npos) << text;
  EXPECT_NE(text.find("force (-2, 0), moment 1 about (0, 0)"), std::string::npos) << text;
  EXPECT_NE(text.find("force (-2, -1), moment -0.513 about (0, 0)"), std::string::npos) << text;
}

// Loads and reactions by hand: a cantilever under gravity and a tip load.
TEST_F(Loads, ReactionsBalanceTheLoads) {
  for (const std::string element : {"bdms", "afw", "p1", "p2"}) {
    const nlohmann::json r =
        run_scene(scene({.conditions = on("right", R"(traction = ["y", 3])") +
                                       "[body]\nforce = [0, -1]\n[solver]\nelement = \"" + element + "\"\n"}));
    const auto& all = r["state"]["resultants"];
    EXPECT_EQ(all["reactions"][0]["on"], "left");
    EXPECT_NEAR(all["reactions"][0]["force"][0].get<double>(), -0.5, 1e-9) << element;
    EXPECT_NEAR(all["reactions"][0]["force"][1].get<double>(), -1, 1e-9) << element;
    EXPECT_NEAR(all["reactions"][0]["moment"].get<double>(), 1. / 3 - 6 + 2, 1e-9) << element;
    EXPECT_NEAR(all["balance"]["moment"].get<double>(), 0, 1e-9) << element;
  }
}

}  // namespace
}  // namespace kerf::data_test
