// Bounds of quantities, from the case file to what kerf says and writes.

#include "app/run.hpp"
#include "tests/io/case/case_files.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <sstream>

namespace kerf::bounds_run_test {
namespace {

// Two equal pulls along y: a plate with an open crack along x, in a frame so wide that K_I is near s sqrt(pi a).
const std::string pulled = R"([domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1.0
poisson = 0.3
[[crack]]
name = "c"
path = [[-0.2, 0], [0.2, 0]]
contact = "open"
[[boundary]]
on = "top"
traction = [0, 1]
[[boundary]]
on = "bottom"
traction = [0, -1]
[mesh]
size = 0.2
[output]
vtk = false
png = false
html = false
)";

nlohmann::json result_of(const TemporaryFolder& folder, const std::string& text,
                         const std::vector<std::string>& set = {}, Job job = Job::Solve) {
  const Case c = read_case(folder.write("a.toml", text), set);
  run(c, job, {.folder = folder.path / "out", .threads = 1});
  return nlohmann::json::parse(std::ifstream(folder.path / "out" / "result.json"));
}

void expect_interval(const nlohmann::json& b, double truth, double widest) {
  EXPECT_TRUE(b["guaranteed"].get<bool>()) << b;
  EXPECT_LE(b["lower"].get<double>(), truth) << b;
  EXPECT_GE(b["upper"].get<double>(), truth) << b;
  EXPECT_LT(b["upper"].get<double>() - b["lower"].get<double>(), widest) << b;
  EXPECT_NEAR(b["value"].get<double>(), 0.5 * (b["lower"].get<double>() + b["upper"].get<double>()),
              1e-9 * (std::abs(truth) + widest));
}

// A finer mesh of higher degree says what lies between; the hole's T of the energy from the stress there.
TEST(BoundsRun, ContainWhatAFinerSolutionSays) {
  const TemporaryFolder folder, finer;
  const std::string points = "[bounds]\npoints = [[0.6, 0.5]]\n[map]\npoints = [[0.6, 0.5]]\n";
  const nlohmann::json coarse = result_of(folder, pulled + points, {}, Job::Run),
                       fine = result_of(finer, pulled + points, {"solver.degree=3", "mesh.size=0.1"}, Job::Run);
  ASSERT_EQ(coarse["bounds"]["tips"].size(), 2u);
  for (int i = 0; i < 2; ++i) {
    const nlohmann::json &tip = coarse["bounds"]["tips"][i], &exact = fine["cracks"][0]["tips"][i];
    EXPECT_EQ(tip["crack"], "c");
    EXPECT_EQ(tip["tip"], i == 0 ? "start" : "end");
    expect_interval(tip["K_I"], exact["K_I"], 0.1);
    expect_interval(tip["K_II"], exact["K_II"], 0.1);
    expect_interval(tip["G"], exact["G"], 0.2);
  }
  const nlohmann::json& at = coarse["bounds"]["points"][0];
  for (const char* quantity : {"s_xx", "s_yy", "s_xy", "von_mises"}) {
    const nlohmann::json& precise = fine["bounds"]["points"][0][quantity];
    expect_interval(at[quantity], precise["value"], 0.15);
    EXPECT_GT(precise["upper"].get<double>() - precise["lower"].get<double>(), 0);
  }
  expect_interval(at["topological_derivative"], fine["map"]["points"][0]["value"], 0.5);
  EXPECT_GT(coarse["time_s"]["bounds"].get<double>(), 0);
  std::stringstream rows(
      std::string(std::istreambuf_iterator<char>(std::ifstream(folder.path / "out" / "bounds.csv").rdbuf()), {}));
  std::string line;
  std::getline(rows, line);
  EXPECT_EQ(line, "quantity,crack,tip,x,y,value,lower,upper,guaranteed,note,on,radius,to_x,to_y");
  int count = 0;
  while (std::getline(rows, line)) ++count;
  EXPECT_EQ(count, 2 * 3 + 5);
}

TEST(BoundsRun, PointsAreDrawnInParaView) {
  const TemporaryFolder folder;
  result_of(folder, pulled + "[bounds]\npoints = [[0.3, 0.5]]\n", {"output.vtk=true"});
  const std::string text(std::istreambuf_iterator<char>(std::ifstream(folder.path / "out" / "bounds.vtp").rdbuf()), {});
  for (const char* field : {"s_xx", "s_yy_lower", "s_xy_upper", "von_mises_guaranteed", "topological_derivative_lower"})
    EXPECT_NE(text.find('"' + std::string(field) + '"'), std::string::npos) << field;
  result_of(folder, pulled, {});
  EXPECT_FALSE(std::filesystem::exists(folder.path / "out" / "bounds.vtp")) << "of the run before";
}

// With an adjoint: the opening of the crack, the work of loads beside a prescribed displacement, a displacement.
TEST(BoundsRun, ContainTOfFunctionalsWithAnAdjoint) {
  const std::string moved = pulled + "[[boundary]]\non = \"left\"\ndisplacement = [0.1, 0]\n";
  for (const char* functional :
       {"crack_opening\"\ncrack = \"c\"\n", "compliance\"\n", "displacement\"\non = \"top\"\ndirection = [1, 2]\n"}) {
    const TemporaryFolder folder, finer;
    const std::string text = moved + "[functional]\nkind = \"" + functional;
    const nlohmann::json coarse = result_of(folder, text + "[bounds]\npoints = [[0.3, 0.5]]\n", {"solver.degree=2"}),
                         fine =
                             result_of(finer, text + "[map]\npoints = [[0.3, 0.5]]\n", {"solver.degree=3"}, Job::Map);
    const double T = fine["map"]["points"][0]["value"];
    expect_interval(coarse["bounds"]["points"][0]["topological_derivative"], T, 0.5 * std::abs(T));
  }
}

TEST(BoundsRun, SayWhyThereAreNone) {
  const TemporaryFolder folder;
  const auto note = [&](const std::string& set) {
    const nlohmann::json r = result_of(folder, pulled + "[bounds]\n", {set});
    const nlohmann::json& b = r["bounds"]["tips"][0]["K_I"];
    EXPECT_FALSE(b["guaranteed"].get<bool>());
    return b["note"].get<std::string>();
  };
  // Open everywhere on this mesh, which proves nothing of the exact solution.
  EXPECT_EQ(note("crack[0].contact=\"unilateral\""),
            "the interval is that of a crack whose faces may penetrate: on this mesh they are open everywhere");
  EXPECT_EQ(note("solver.element=\"p2\""), "element \"p2\" has no bounds of the energy; use \"bdms\" or \"afw\"");
}

// A bar without Poisson's effect, pulled at its top, with twice that as its weight: s_yy = 2 y - 1, u_y = y^2 - y.
TEST(BoundsRun, ContainTheMeansOfABar) {
  const TemporaryFolder folder;
  const nlohmann::json r = result_of(folder, R"([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1.0
poisson = 0
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "top"
traction = [0, 1]
[body]
force = [0, -2]
[mesh]
size = 0.07
[output]
vtk = false
png = false
html = true
[bounds]
displacements = "top"
reactions = "bottom"
compliance = true
disc = [{ center = [0.4, 0.5], radius = 0.15 }]
line = [{ from = [0.4, 0.4], to = [0.6, 0.4] }]
[[probe]]
name = "p"
points = [[0.5, 0.5], [2, 2]]
bounds = true
)");
  const nlohmann::json &b = r["bounds"], &disc = b["discs"][0], &line = b["lines"][0];
  constexpr double narrow = 0.02;
  expect_interval(disc["s_xx"], 0, narrow);
  expect_interval(disc["s_yy"], 0, narrow);
  expect_interval(disc["s_xy"], 0, narrow);
  expect_interval(disc["e_yy"], 0, narrow);
  expect_interval(line["s_nn"], -0.2, narrow);
  expect_interval(line["s_nt"], 0, narrow);
  expect_interval(line["s_tt"], 0, narrow);
  expect_interval(b["displacements"][0]["u_x"], 0, narrow);
  expect_interval(b["displacements"][0]["u_y"], 0, narrow);
  expect_interval(b["reactions"][0]["force_x"], 0, 1e-9);
  expect_interval(b["reactions"][0]["force_y"], 1, 1e-9);
  expect_interval(b["compliance"], 1.0 / 3, narrow);  // int -2 (y^2 - y)
  std::ifstream probe(folder.path / "out" / "probe_p.csv");
  std::string head, inside, outside;
  std::getline(probe, head);
  std::getline(probe, inside);
  std::getline(probe, outside);
  EXPECT_TRUE(head.ends_with("s_xx_lower,s_xx_upper,s_yy_lower,s_yy_upper,s_xy_lower,s_xy_upper,guaranteed")) << head;
  EXPECT_TRUE(inside.ends_with(",1")) << inside;
  EXPECT_TRUE(outside.ends_with(",,,,,,0")) << outside;
  const std::string page = read_file(folder.path / "out" / "report.html");
  EXPECT_NE(page.find("support of bottom"), std::string::npos);
  EXPECT_NE(page.find("mean over the disc"), std::string::npos);
}

TEST(BoundsRun, MeshesAreRefinedForAQuantity) {
  const TemporaryFolder folder;
  const nlohmann::json r =
      result_of(folder, pulled, {"mesh.adapt={error=2e-3, max_triangles=20000, of=\"K_I\", crack=\"c\", tip=\"end\"}"});
  const nlohmann::json& adapt = r["mesh"]["adapt"];
  EXPECT_EQ(adapt["of"], "K_I at the end of crack \"c\"");
  EXPECT_TRUE(adapt["stopped"].get<std::string>().starts_with("reached")) << adapt;
  EXPECT_LE(adapt["rounds"].back()["estimated_error"].get<double>(), 2e-3);
  const nlohmann::json& b = r["bounds"]["tips"][1]["K_I"];
  EXPECT_TRUE(b["guaranteed"].get<bool>()) << b;
  EXPECT_LE(b["upper"].get<double>() - b["lower"].get<double>(), 4e-3 * b["value"].get<double>()) << b;
  EXPECT_LT(r["mesh"]["triangles"].get<int>(), 20000);
}

TEST(BoundsRun, GoalsAreNamedWhole) {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& adapt) {
    try {
      read_case(folder.write("a.toml", pulled), std::vector<std::string>{"mesh.adapt={error=1e-2, " + adapt + "}"});
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(said("of=\"K_I\"").find("missing key \"crack\""), std::string::npos);
  EXPECT_NE(said("of=\"K_I\", crack=\"d\", tip=\"end\"").find("there is no crack \"d\""), std::string::npos);
  EXPECT_NE(said("of=\"s_xx\", crack=\"c\"").find("does not go with of = \"s_xx\""), std::string::npos);
  EXPECT_NE(said("crack=\"c\"").find("goes with of"), std::string::npos);
  EXPECT_NE(said("of=\"s_zz\", at=[0,0]").find("s_zz"), std::string::npos);
}

}  // namespace
}  // namespace kerf::bounds_run_test
