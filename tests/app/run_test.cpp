// Case files that ship with kerf, run as they are: what lands on disk, and whether the numbers are right.

#include "app/run.hpp"

#include "tests/support/exact.hpp"
#include "tests/support/folder.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace kerf::run_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Run : public test::InFolder {
 protected:
  json run_case(const std::string& name, const std::vector<std::string>& overrides, Job job = Job::Run, int threads = 2,
                const std::string& to = "out") {
    const Case c = read_case(fs::path(KERF_CASES) / (name + ".toml"), overrides);
    run(c, job, {.folder = folder / to, .threads = threads});
    std::ifstream file(folder / to / "result.json");
    return json::parse(file);
  }
};

void expect_keys(const json& object, std::initializer_list<const char*> keys, const std::string& where) {
  for (const char* key : keys) EXPECT_TRUE(object.contains(key)) << where << " lacks " << key;
}

// Graded at the ends of contact before it is divided; what is divided is of a state and its map alone.
TEST_F(Run, RefineDividesEveryTriangleIntoFour) {
  const std::vector<std::string> coarse{"mesh.size=0.4", "mesh.crack_tip_size=0.1"};
  std::vector<std::string> divided = coarse;
  divided.emplace_back("mesh.refine=1");
  const json once = run_case("partly_closed", coarse, Job::Solve), r = run_case("partly_closed", divided, Job::Map);
  EXPECT_EQ(r["mesh"]["triangles"].get<int>(), 4 * once["mesh"]["triangles"].get<int>());
  EXPECT_DOUBLE_EQ(r["mesh"]["h_min"].get<double>(), once["mesh"]["h_min"].get<double>() / 2);
  EXPECT_LT(r["state"]["estimated_error"].get<double>(), 0.6 * once["state"]["estimated_error"].get<double>());
  EXPECT_TRUE(r.contains("map"));
  try {
    run_case("cracked_plate", {"mesh.refine=1"}, Job::Validate);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(
        std::string(e.what()).find("mesh.refine is for a state and a map of it; a validation meshes the body anew"),
        std::string::npos)
        << e.what();
  }
}

TEST_F(Run, ShowcaseWritesEveryFieldOfTheInterface) {
  const json r = run_case("cracked_plate", {"mesh.size=0.2", "mesh.crack_tip_size=0.02"});
  expect_keys(r,
              {"schema", "version", "case", "status", "mesh", "state", "contact", "cracks", "functional", "map",
               "validate", "optimize", "time_s", "peak_memory_mb"},
              "result");
  EXPECT_EQ(r["schema"], 1);
  EXPECT_EQ(r["case"], "cracked_plate");
  EXPECT_EQ(r["status"], "ok");
  expect_keys(r["optimize"],
              {"method", "iterations", "state_solves", "objective", "volume_fraction", "feasible", "stopped"},
              "optimize");
  EXPECT_NEAR(r["optimize"]["volume_fraction"].get<double>(), 0.85, 1e-3);
  expect_keys(r["mesh"], {"triangles", "vertices", "h_min", "h_max", "min_angle_deg"}, "mesh");
  expect_keys(r["state"],
              {"element", "unknowns", "condensed_unknowns", "residual", "energy", "compliance", "area",
               "estimated_error", "energy_bounds"},
              "state");
  expect_keys(r["contact"],
              {"method", "iterations", "linear_solves", "kkt", "open_length", "closed_length", "biactive_length"},
              "contact");
  ASSERT_EQ(r["cracks"].size(), 1u);
  expect_keys(r["cracks"][0], {"name", "length", "max_opening", "max_pressure", "transitions", "tips"}, "crack");
  ASSERT_EQ(r["cracks"][0]["tips"].size(), 2u);
  expect_keys(r["cracks"][0]["tips"][0], {"at", "K_I", "K_II", "G", "T", "spread"}, "tip");
  ASSERT_GE(r["cracks"][0]["transitions"].size(), 1u);
  expect_keys(r["cracks"][0]["transitions"][0], {"at", "from", "to"}, "transition");
  expect_keys(r["functional"], {"kind", "value"}, "functional");
  expect_keys(r["map"], {"perturbation", "min", "max", "points"}, "map");
  expect_keys(r["map"]["min"], {"at", "value"}, "map.min");
  ASSERT_EQ(r["validate"].size(), 2u);
  for (const json& v : r["validate"]) {
    expect_keys(
        v,
        {"at", "coefficient", "order", "verdict", "reason", "intercept", "c2", "c2_predicted", "c3", "plateau", "rows"},
        "validate");
    EXPECT_NEAR(v["c2_predicted"].get<double>() / v["c2"].get<double>(), 1, 5e-3);
    EXPECT_EQ(v["logarithm"], "absent");
    EXPECT_EQ(v["verdict"], "holds") << v["reason"];
    EXPECT_NEAR(v["intercept"].get<double>() / v["coefficient"].get<double>(), 1, 5e-4);
    EXPECT_EQ(v["rows"].size(), 5u);
  }
  expect_keys(r["time_s"],
              {"mesh", "assemble", "factor", "solve", "contact", "map", "validate", "optimize", "output", "total"},
              "time_s");
  EXPECT_EQ(r["functional"]["value"], r["state"]["compliance"]);
  // Dead loads on a body held at zero: Clapeyron.
  EXPECT_NEAR(r["state"]["energy"].get<double>() / r["state"]["compliance"].get<double>(), -0.5, 1e-9);
  EXPECT_NEAR(r["state"]["area"].get<double>(), 16 - std::acos(-1) * (0.09 + 0.0484), 1e-6);
  EXPECT_LT(r["contact"]["kkt"].get<double>(), 1e-10);
  EXPECT_NEAR(r["contact"]["open_length"].get<double>() + r["contact"]["closed_length"].get<double>(), 2, 1e-9);
  EXPECT_GE(r["map"]["min"]["value"].get<double>(), 0);
  for (const char* name :
       {"state.vtu", "map.vtu", "map.csv", "crack_c.vtp", "crack_c.csv", "probe_above_crack.csv", "probe_ligaments.csv",
        "report.html", "mesh.png", "von_mises.png", "map.png", "validate.csv", "validate.png"})
    EXPECT_GT(fs::file_size(folder / "out" / name), 100u) << name;
}

// The folder of a run holds all that it needs to be made again, here or elsewhere, overrides and data included.
TEST_F(Run, TheFolderRunsAgain) {
  const auto write = [&](const fs::path& name, const std::string& what) {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << what;
  };
  write("cases/data/top.csv", "x,y,u_x,u_y\n1,1,0.001,0.01\n0,1,0,0.011\n");
  write("cases/more/top.csv", "x,y\n0.3,0.4\n0.6,0.1\n");
  write("cases/a.toml", R"([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 100
poisson = 0.3
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "top"
traction = ["r / 3", 1]
[define]
r = "x + 0.1"
[functional]
kind = "misfit"
on = "top"
measured = "data/top.csv"
[[probe]]
name = "p"
file = "more/top.csv"
[output]
vtk = false
png = false
)");
  const auto numbers = [&](const fs::path& file, const fs::path& to, const std::vector<std::string>& overrides) {
    run(read_case(folder / file, overrides), Job::Map, {.folder = folder / to, .command = "kerf map a.toml"});
    json r = json::parse(text(to / "result.json"));
    for (const char* own : {"time_s", "peak_memory_mb", "case"}) r.erase(own);
    return r.dump() + text(to / "probe_p.csv") + text(to / "map.csv");
  };
  const std::string first = numbers("cases/a.toml", "out", {"mesh.size=0.31", "material.young=123.456789"});
  const std::string kept = text("out/case.toml");
  EXPECT_EQ(
      kept.find("# The case of these results, as kerf " KERF_VERSION " read it\n# kerf map a.toml\ntitle = \"a\"\n"),
      0u);
  EXPECT_NE(kept.find("young = 123.456789"), std::string::npos) << kept;
  fs::remove_all(folder / "cases");
  fs::rename(folder / "out", folder / "moved");
  EXPECT_EQ(numbers("moved/case.toml", "again", {}), first);
  // Into itself, twice.
  EXPECT_EQ(numbers("moved/case.toml", "moved", {}), first);
  EXPECT_EQ(numbers("moved/case.toml", "moved", {}), first);
  EXPECT_EQ(text("moved/case.toml"), kept);
}

TEST_F(Run, SolveAloneHasNoMap) {
  const json r = run_case("cracked_plate", {"mesh.size=0.4", "mesh.crack_tip_size=0.1"}, Job::Solve);
  EXPECT_FALSE(r.contains("map"));
  EXPECT_FALSE(r.contains("validate"));
  EXPECT_FALSE(fs::exists(folder / "out/map.vtu"));
  const std::string probe = text("out/probe_ligaments.csv");
  EXPECT_EQ(probe.substr(0, probe.find('\n')), "x,y,u_x,u_y,s_xx,s_yy,s_xy,topological_derivative");
  EXPECT_EQ(probe.substr(probe.find('\n') + 1, 6), "-1.5,0");
  EXPECT_EQ(probe[probe.find('\n', probe.find('\n') + 1) - 1], ',') << "an empty cell: not computed";
}

TEST_F(Run, SceneWithoutACrackHasNoContact) {
  std::ofstream(folder / "plain.toml")
      << "[domain]\noutline = [[0,0],[1,0],[1,1],[0,1]]\nsides = [\"a\",\"b\",\"c\",\"d\"]\n"
         "[material]\nyoung = 1\npoisson = 0.3\n[mesh]\nsize = 0.25\n"
         "[[boundary]]\non = \"a\"\ndisplacement = [0, 0]\n"
         "[[boundary]]\non = \"c\"\ntraction = [0, 1]\n";
  const Case c = read_case(folder / "plain.toml");
  const Result r = run(c, Job::Run, {.folder = folder / "out"});
  EXPECT_FALSE(r.contact.has_value());
  EXPECT_TRUE(r.cracks.empty());
  EXPECT_FALSE(json::parse(text("out/result.json")).contains("contact"));
}

TEST_F(Run, PartlyClosedCaseMeetsTheExactSolution) {
  const json r = run_case("partly_closed",
                          {"mesh.size=0.1", "mesh.crack_tip_size=0.002", "output.png=false", "output.html=false"});
  const exact::Table table = exact::read_table(fs::path(KERF_TEST_DATA) / "exact", "c05_partial_linear_w");
  // Displacements prescribed all round: the potential energy is the strain energy.
  EXPECT_NEAR(r["state"]["energy"].get<double>() / table.energy, 1, 2e-4);
  ASSERT_EQ(r["cracks"][0]["transitions"].size(), 1u);
  const json& t = r["cracks"][0]["transitions"][0];
  EXPECT_NEAR(t["at"][0].get<double>(), table.scalars.at("closure_point"), 0.1);
  EXPECT_EQ(t["from"], "closed");
  EXPECT_EQ(t["to"], "open");
  const double k = table.scalars.at("KI_right");
  EXPECT_NEAR(r["cracks"][0]["tips"][1]["K_I"].get<double>() / k, 1, 2e-3);
  EXPECT_NEAR(r["cracks"][0]["tips"][0]["K_I"].get<double>(), 0, 1e-3 * k);
  EXPECT_NEAR(r["cracks"][0]["tips"][1]["G"].get<double>() / table.scalars.at("G_right"), 1, 4e-3);
  EXPECT_NEAR(r["cracks"][0]["tips"][1]["T"].get<double>(), table.scalars.at("T_right"), 1e-2);
  for (const char* of : {"K_I", "K_II", "T"}) EXPECT_LT(r["cracks"][0]["tips"][1]["spread"][of].get<double>(), 1e-2);
  for (const json& p : r["map"]["points"])
    for (const exact::Row& row : table.rows)
      if ((row.x - Vec2(p["at"][0], p["at"][1])).norm() < 1e-9) {
        EXPECT_NEAR(p["value"].get<double>() / row.hole, 1, 0.02) << row.x.transpose();
      }
}

TEST_F(Run, SameBitsForAnyNumberOfThreads) {
  for (const int threads : {1, 2, 5})
    run_case("cracked_plate", {"mesh.size=0.15", "output.png=false", "output.html=false"}, Job::Map, threads,
             std::to_string(threads));
  for (const char* name : {"state.vtu", "map.vtu", "map.csv", "crack_c.csv", "probe_above_crack.csv"})
    for (const char* other : {"2", "5"}) EXPECT_EQ(text(fs::path("1") / name), text(fs::path(other) / name)) << name;
}

TEST_F(Run, EveryShippedCaseRunsCoarsely) {
  for (const auto& entry : fs::directory_iterator(KERF_CASES)) {
    if (entry.path().extension() != ".toml") continue;
    const std::string name = entry.path().stem().string();
    const json r = run_case(name, {"output.html=false"}, Job::Run, 2, name);
    EXPECT_EQ(r["status"], "ok") << name;
    // Near poisson = 0.5 rounding alone leaves 5e-11 to 2e-10, as the processor's kernels add.
    EXPECT_LT(r["state"]["residual"].get<double>(), 0.1 * few_digits) << name;
    if (r.contains("contact")) {
      EXPECT_LT(r["contact"]["kkt"].get<double>(), 0.1 * few_digits) << name;
    }
    if (r.contains("validate")) {
      for (const json& v : r["validate"]) EXPECT_EQ(v["verdict"], "holds") << name << ": " << v["reason"];
    }
    EXPECT_GE(r["mesh"]["min_angle_deg"].get<double>(), 25) << name;
  }
  // The pictures in docs/gallery are drawn from the same numbers.
  const std::string gallery = (fs::path(KERF_CASES).parent_path() / "docs/gallery.py").string();
  EXPECT_EQ(std::system(("python3 " + gallery + " --check --results " + folder.string()).c_str()), 0);
}

TEST_F(Run, FailureIsWrittenWithItsReason) {
  std::ofstream(folder / "free.toml")
      << "[domain]\noutline = [[0,0],[1,0],[1,1],[0,1]]\nsides = [\"a\",\"b\",\"c\",\"d\"]\n"
         "[material]\nyoung = 1\npoisson = 0.3\n[mesh]\nsize = 0.25\n"
         "[[boundary]]\non = \"c\"\ntraction = [0, 1]\n";
  const Case c = read_case(folder / "free.toml");
  try {
    run(c, Job::Run, {.folder = folder / "out"});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Numerics);
    EXPECT_NE(std::string(e.what()).find("holds the body against a translation along (0, 1)"), std::string::npos)
        << e.what();
  }
  const json r = json::parse(text("out/result.json"));
  EXPECT_EQ(r["status"], "failed");
  EXPECT_FALSE(r.contains("state"));
}

TEST_F(Run, EquilibratedLoadsSaySoInTheNotes) {
  const json r = run_case("inclined_closed", {"output.png=false", "output.html=false"});
  ASSERT_TRUE(r["state"].contains("notes"));
  EXPECT_NE(r["state"]["notes"][0].get<std::string>().find("rigid motion is fixed"), std::string::npos);
}

const std::string square4 =
    "[domain]\noutline = [[-2,-2],[2,-2],[2,2],[-2,2]]\nsides = [\"a\",\"b\",\"c\",\"d\"]\n"
    "[material]\nyoung = 1000\npoisson = 0.3\n[output]\npng = false\nhtml = false\nvtk = false\n";

TEST_F(Run, SlenderBeamIsCertifiedAndRight) {
  std::ofstream(folder / "beam.toml") << "[domain]\noutline = [[0,0],[50,0],[50,1],[0,1]]\n"
                                         "sides = [\"b\",\"r\",\"t\",\"l\"]\n[material]\nyoung = 1000\npoisson = 0.3\n"
                                         "state = \"plane stress\"\n[mesh]\nsize = 0.3\n[output]\npng = false\n"
                                         "html = false\nvtk = false\n[[boundary]]\non = \"l\"\ndisplacement = [0, 0]\n"
                                         "[[boundary]]\non = \"r\"\ntraction = [0, 1]\n";
  const Result r = run(read_case(folder / "beam.toml"), Job::Solve, {.folder = folder / "out"});
  EXPECT_EQ(r.status, "ok");
  // Timoshenko: P L^3 / (3 E I) + 1.2 P L / (G A), P = 1, I = 1/12.
  const double tip = std::pow(50.0, 3) * 12 / 3000 + 1.2 * 50 * 2.6 / 1000;
  EXPECT_NEAR(r.state->compliance / tip, 1, 1e-3);
}

TEST_F(Run, RollersOnARimLeaveTheRotationFree) {
  std::ofstream(folder / "rim.toml")
      << square4
      << "[mesh]\nsize = 0.2\n[[hole]]\nname = \"h\"\n"
         "circle = { center = [0, 0], radius = 1 }\n"
         "[[boundary]]\non = \"hole:h\"\ndisplacement_normal = 0\n"
         "[[boundary]]\non = [\"a\", \"b\", \"c\", \"d\"]\ntraction = [\"-ny\", \"nx\"]\n";
  try {
    run(read_case(folder / "rim.toml"), Job::Solve, {.folder = folder / "out"});
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("holds the body against a rotation about (0, 0)"), std::string::npos)
        << e.what();
  }
}

TEST_F(Run, StressIntensityDoesNotFeelARigidRotation) {
  std::vector<double> k;
  for (const char* w : {"0", "1", "100"}) {
    std::ofstream(folder / "turn.toml")
        << square4
        << "[mesh]\nsize = 0.2\n[[crack]]\nname = \"c\"\n"
           "path = [[-0.6, 0], [0.6, 0]]\n[[boundary]]\non = [\"a\", \"b\", \"c\", \"d\"]\n"
           "displacement = [\"-"
        << w << "*y\", \"0.001*y + " << w << "*x\"]\n";
    const Result r = run(read_case(folder / "turn.toml"), Job::Solve, {.folder = folder / w});
    k.push_back(*r.cracks[0].tips[0].K_I);
  }
  EXPECT_GT(k[0], 1);
  EXPECT_NEAR(k[1], k[0], 1e-6);
  EXPECT_NEAR(k[2], k[0], 1e-4);
}

TEST_F(Run, LoadsBalancedButForThePolygonsOfArcsAreAccepted) {
  std::ofstream(folder / "disc.toml")
      << "[domain]\noutline = [{ arc_to = [2, 0], center = [0, 0] }, { arc_to = [0, 2], center = [0, 0] }, "
         "{ arc_to = [-2, 0], center = [0, 0] }, { arc_to = [0, -2], center = [0, 0] }]\n"
         "sides = [\"o\", \"o\", \"o\", \"o\"]\n[[hole]]\nname = \"h\"\n"
         "circle = { center = [0, 0], radius = 1 }\n[material]\nyoung = 1000\npoisson = 0.3\n"
         "[mesh]\nsize = 0.1\n[output]\npng = false\nhtml = false\nvtk = false\n"
         "[[boundary]]\non = \"o\"\ntraction = [\"-ny\", \"nx\"]\n"
         "[[boundary]]\non = \"hole:h\"\ntraction = [\"-4*ny\", \"4*nx\"]\n";
  const Result r = run(read_case(folder / "disc.toml"), Job::Solve, {.folder = folder / "out"});
  EXPECT_EQ(r.status, "ok");
  // And perhaps one on the largest stress, at a corner of the chords.
  ASSERT_FALSE(r.state->notes.empty());
  EXPECT_NE(r.state->notes[0].find("imbalance"), std::string::npos) << r.state->notes[0];
  // Torsion of a ring: s_rt = 4/r^2, energy = int s_rt^2/(2 mu) = 12 pi/(2 mu) ... compliance is twice that.
  const double mu = 1000 / 2.6;
  EXPECT_NEAR(r.state->compliance / (12 * std::acos(-1) / mu), 1, 5e-3);
}

TEST_F(Run, BackendsAgree) {
  const auto with = [&](const std::string& backend) {
    return run_case("partly_closed",
                    {"solver.backend=\"" + backend + "\"", "mesh.size=0.3", "mesh.crack_tip_size=0.05"}, Job::Run, 2,
                    backend);
  };
  const json one = with("cholmod"), two = with("umfpack");
  EXPECT_EQ(two["status"], "ok");
  EXPECT_NEAR(two["state"]["energy"].get<double>() / one["state"]["energy"].get<double>(), 1, 1e-11);
  EXPECT_NEAR(two["contact"]["open_length"].get<double>(), one["contact"]["open_length"].get<double>(), 1e-11);
  for (int tip : {0, 1})
    EXPECT_NEAR(two["cracks"][0]["tips"][tip]["K_I"].get<double>(), one["cracks"][0]["tips"][tip]["K_I"].get<double>(),
                1e-9);
}

TEST_F(Run, HigherDegreesAgreeOnTheShowcase) {
  std::vector<double> k;
  for (const char* degree : {"1", "2", "3"}) {
    const json r =
        run_case("cracked_plate",
                 {std::string("solver.degree=") + degree, "mesh.size=0.2", "output.png=false", "output.html=false"},
                 Job::Solve, 2, degree);
    EXPECT_EQ(r["status"], "ok");
    k.push_back(r["cracks"][0]["tips"][1]["K_I"]);
  }
  EXPECT_NEAR(k[0] / k[2], 1, 5e-3);
  EXPECT_NEAR(k[1] / k[2], 1, 2e-3);
}

// Shear along a crack neither opens nor closes it: where it touches is what the mesh errs by, and a map of its opening
// is another one on every mesh. A pressure of a thousandth of the shear decides it.
TEST(ShearedCrack, SaysWhereTheMeshDecidesWhatACrackDoes) {
  const auto notes = [](double pressure) {
    const test::Folder folder;
    std::ofstream(folder.path / "a.toml") << fmt::format(R"(
[domain]
outline = [[-2, -2], [2, -2], [2, 2], [-2, 2]]
sides = ["outer", "outer", "outer", "outer"]
[[crack]]
name = "c"
path = [[-1, 0], [1, 0]]
[material]
young = 1000
poisson = 0.3
[[boundary]]
on = "outer"
traction = ["ny", "nx - {} * ny"]
[mesh]
size = 0.1
[solver]
degree = 1
)",
                                                         pressure);
    const Result r = run(read_case(folder.path / "a.toml"), Job::Solve, {.folder = folder.path / "out", .threads = 1});
    std::string all;
    for (const std::string& note : r.state->notes) all += note + '\n';
    return all;
  };
  const char* const words = "crack \"c\" touches and opens in turn";
  EXPECT_NE(notes(0).find(words), std::string::npos) << notes(0);
  EXPECT_EQ(notes(1e-3).find(words), std::string::npos) << notes(1e-3);
}

}  // namespace
}  // namespace kerf::run_test
