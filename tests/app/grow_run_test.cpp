// Cracks that grow, from the case file to what kerf says and writes.

#include "app/run.hpp"
#include "io/read_result.hpp"
#include "kerf/stop.hpp"
#include "tests/io/case/case_files.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace kerf::grow_run_test {
namespace {

const std::string plate = R"([domain]
outline = [[-4, -4], [4, -4], [4, 4], [-4, 4]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1000
poisson = 0.3
[[crack]]
name = "c"
path = [[-0.4, -0.3], [0.4, 0.3]]
[[boundary]]
on = "top"
traction = [0, 1]
[[boundary]]
on = "bottom"
displacement_y = 0
[mesh]
size = 1
[solver]
degree = 1
[output]
vtk = false
png = false
html = false
margins = false
)";
const std::string fatigue = "[grow]\nlaw = { kind = \"paris\", C = 1e-9, m = 3 }\nstep = 0.2\nuntil = { steps = 2 }\n";

std::string refusal(const std::string& grow) {
  const TemporaryFolder folder;
  try {
    read_case(folder.write("a.toml", plate + grow));
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(GrowRun, FilesAndResultsThereAndBack) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path / "out";
  const Result r = run(read_case(folder.write("a.toml", plate + fatigue)), Job::Grow, {.folder = out, .threads = 1});
  ASSERT_TRUE(r.growth);
  EXPECT_EQ(r.growth->ended, "2 steps are done (grow.until.steps)");
  ASSERT_EQ(r.growth->steps.size(), 3u);
  EXPECT_GT(r.growth->steps[2].cycles, r.growth->steps[1].cycles);
  EXPECT_GT(r.seconds.grow, 0);
  const Result again = read_result(out);
  ASSERT_TRUE(again.growth);
  ASSERT_EQ(again.growth->steps.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto &a = r.growth->steps[i], &b = again.growth->steps[i];
    EXPECT_EQ(a.cycles, b.cycles);
    EXPECT_EQ(a.potential, b.potential);
    ASSERT_EQ(a.tips.size(), b.tips.size());
    for (std::size_t k = 0; k < a.tips.size(); ++k) {
      EXPECT_EQ(a.tips[k].name, b.tips[k].name);
      EXPECT_EQ(a.tips[k].at, b.tips[k].at);
      EXPECT_EQ(a.tips[k].K_II, b.tips[k].K_II);
    }
  }
  const std::string csv = (std::ostringstream() << std::ifstream(out / "growth.csv").rdbuf()).str();
  EXPECT_TRUE(
      csv.starts_with("step,cycles,load,tip,x,y,a,K_I,K_II,T,G,K_max,K_I_min,K_II_min,dK,rate,da,angle,symmetry\n"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 3 * 2);
  EXPECT_NE(csv.find("\n0,0,1,c:start,"), std::string::npos) << csv;
  EXPECT_NE(summary(r).find("growth      Paris by local symmetry: 3 steps"), std::string::npos) << summary(r);
  // The body at the end goes on from there.
  const Case on = read_case(out / "grown.toml");
  const auto& path = on.shape.cracks[0].points;
  EXPECT_NEAR(
      (path.back() - r.growth->steps[2].tips[0].at).norm() * (path.back() - r.growth->steps[2].tips[1].at).norm(), 0,
      1e-12);
  EXPECT_TRUE(on.grow);
}

TEST(GrowRun, RunGrowsToo) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", plate + fatigue), std::vector<std::string>{"grow.until.steps=1"});
  const Result r = run(c, Job::Run, {.folder = folder.path / "out", .threads = 1});
  ASSERT_TRUE(r.growth);
  EXPECT_EQ(r.growth->steps.size(), 2u);
  const TemporaryFolder other;
  EXPECT_FALSE(run(c, Job::Solve, {.folder = other.path / "out", .threads = 1}).growth);
}

// C of other units: the crack grows by more than its length in a cycle, or by less than an atom in any life.
TEST(GrowRun, DoubtsTheUnitsOfALaw) {
  for (const auto& [C, said] :
       {std::pair{"1e3", "lengths of the crack per cycle"}, std::pair{"1e-40", "no growth in any life"}}) {
    const TemporaryFolder folder;
    const Case c = read_case(folder.write("a.toml", plate + fatigue),
                             std::vector<std::string>{"grow.until.steps=1", std::string("grow.law.C=") + C});
    const Result r = run(c, Job::Grow, {.folder = folder.path / "out", .threads = 1});
    ASSERT_TRUE(r.growth);
    EXPECT_TRUE(std::ranges::any_of(r.growth->notes, [&](const std::string& note) {
      return note.find(said) != std::string::npos && note.find("other units") != std::string::npos;
    })) << C;
  }
}

TEST(GrowRun, SpectraComeFromTables) {
  const TemporaryFolder folder;
  folder.write("s.csv", "time,load\n0,0\n1,1.5\n2,-0.5\n3,1\n");
  const Case c =
      read_case(folder.write("a.toml", plate + fatigue), std::vector<std::string>{"grow.cycle.file=\"s.csv\""});
  EXPECT_EQ(c.grow->spectrum, (std::vector<double>{0, 1.5, -0.5, 1}));
  EXPECT_EQ(c.grow->max, 1.5);
  EXPECT_EQ(c.grow->min, -0.5);
  folder.write("s.csv", "load\n1\n1\n");
  EXPECT_THROW(
      read_case(folder.write("a.toml", plate + fatigue), std::vector<std::string>{"grow.cycle.file=\"s.csv\""}), Error);
}

TEST(GrowRun, RefusalsNameWhatIsWrong) {
  EXPECT_NE(refusal("[grow]\nstep = 1\n").find("law"), std::string::npos);
  EXPECT_NE(refusal("[grow]\nlaw = { kind = \"pariss\", C = 1, m = 3 }\n").find("did you mean \"paris\""),
            std::string::npos);
  EXPECT_NE(refusal("[grow]\nlaw = { kind = \"paris\", m = 3 }\n").find("C"), std::string::npos);
  EXPECT_NE(refusal("[grow]\nlaw = { kind = \"forman\", C = 1, m = 3 }\n").find("law in [grow]"), std::string::npos);
  EXPECT_NE(refusal("[grow]\nlaw = { kind = \"quasi-static\", K_c = 1 }\ntips = [\"d:end\"]\n").find("no crack \"d\""),
            std::string::npos);
  EXPECT_NE(refusal("[grow]\nlaw = { kind = \"quasi-static\", K_c = 1 }\ntips = [\"c\"]\n").find("\"c:end\""),
            std::string::npos);
  EXPECT_NE(refusal("[grow]\nlaw = { kind = \"quasi-static\", K_c = 1 }\ncycle = { min = 0 }\n").find("fatigue"),
            std::string::npos);
  EXPECT_NE(
      refusal("[grow]\nlaw = { kind = \"paris\", C = 1, m = 3 }\ncycle = { min = 2 }\n").find("min must be below"),
      std::string::npos);
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& set, Job job = Job::Grow) -> std::string {
    try {
      run(read_case(folder.write("a.toml", plate + fatigue), std::vector<std::string>{set}), job,
          {.folder = folder.path / "out", .threads = 1});
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(refused("mesh.refine=1").find("growth of cracks"), std::string::npos);
  const TemporaryFolder plain;
  const Case none_asked = read_case(plain.write("a.toml", plate));
  EXPECT_THROW(run(none_asked, Job::Grow, {.folder = plain.path / "out", .threads = 1}), Error);
}

TEST(GrowRun, BoundsThereAndBack) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path / "out";
  const std::string grow =
      "[grow]\nlaw = { kind = \"paris\", C = 1e-9, m = 3 }\nstep = 0.2\nbounds = true\nuntil = { steps = 2 }\n";
  const Result r = run(read_case(folder.write("a.toml", plate + grow)), Job::Grow, {.folder = out, .threads = 1});
  const Result again = read_result(out);
  ASSERT_TRUE(again.growth && again.growth->bounds);
  EXPECT_EQ(again.growth->bounds->cycles.low, r.growth->bounds->cycles.low);
  EXPECT_EQ(again.growth->bounds->lost.high, r.growth->bounds->lost.high);
  EXPECT_EQ(again.growth->bounds->guaranteed, r.growth->bounds->guaranteed);
  ASSERT_TRUE(again.growth->steps[1].tips[0].in);
  EXPECT_EQ(again.growth->steps[1].tips[0].in->G.high, r.growth->steps[1].tips[0].in->G.high);
  const std::string csv = (std::ostringstream() << std::ifstream(out / "growth.csv").rdbuf()).str();
  EXPECT_NE(csv.find(",symmetry,K_I_lower,K_I_upper,K_II_lower,K_II_upper,G_lower,G_upper,guaranteed\n"),
            std::string::npos);
}

// beta of a small crack in tension is near 1 by the stress that is asked for.
TEST(GrowRun, BetaOfASmallCrack) {
  const TemporaryFolder folder;
  std::string straight = plate;
  straight.replace(straight.find("[[-0.4, -0.3], [0.4, 0.3]]"), 26, "[[-0.3, 0], [0.3, 0]]");
  const std::string grow =
      "[grow]\nlaw = { kind = \"paris\", C = 1e-9, m = 3 }\ncycle = { max = 50 }\nstress = 50\nstep = 0.1\n"
      "until = { steps = 1 }\n";
  run(read_case(folder.write("a.toml", straight + grow)), Job::Grow, {.folder = folder.path / "out", .threads = 1});
  for (const char* tip : {"start", "end"}) {
    std::ifstream csv(folder.path / "out" / (std::string("beta_c_") + tip + ".csv"));
    std::string line;
    std::getline(csv, line);
    EXPECT_EQ(line, "a,beta,K_max");
    int rows = 0;
    while (std::getline(csv, line)) {
      ++rows;
      const double a = std::stod(line), beta = std::stod(line.substr(line.find(',') + 1));
      EXPECT_NEAR(beta, 1 / std::sqrt(std::cos(pi * a / 8)), 0.03);
    }
    EXPECT_EQ(rows, 2);
  }
}

TEST(GrowRun, FormulasOfDirectionAreRead) {
  const std::string head = "[grow]\nlaw = { kind = \"quasi-static\", K_c = 1, ";
  const TemporaryFolder folder;
  const Case c = read_case(folder.write("a.toml", plate + head + "K_IIc = 3, anisotropy = \"1 + 0.5*sin(phi)^2\" }\n"));
  EXPECT_EQ(c.grow->toughness_shear, 3);
  EXPECT_NEAR(c.grow->anisotropy(pi / 2), 1.5, 1e-15);
  EXPECT_NEAR(c.grow->anisotropy(-0.3), 1 + 0.5 * std::pow(std::sin(0.3), 2), 1e-15);
  EXPECT_NE(refusal(head + "anisotropy = \"1 + theta\" }\n").find("theta"), std::string::npos);
  EXPECT_NE(refusal("[grow]\nlaw = { kind = \"paris\", C = 1, m = 3, anisotropy = \"1\" }\n").find("anisotropy"),
            std::string::npos);
}

// What is left of a run that was stopped goes on and ends with the same bits.
TEST(GrowRun, ResumesWithTheSameBits) {
  const TemporaryFolder folder;
  const Case c = read_case(folder.write(
      "a.toml", plate + "[grow]\nlaw = { kind = \"paris\", C = 1e-9, m = 3 }\nstep = 0.2\nuntil = { steps = 4 }\n"));
  const Result whole = run(c, Job::Grow, {.folder = folder.path / "whole", .threads = 1});
  int steps = 0;
  RunOptions options{.folder = folder.path / "cut", .threads = 1, .on_phase = [&](const std::string& phase) {
                       if (phase.starts_with("grow: step") && ++steps == 2) request_stop();
                     }};
  EXPECT_ANY_THROW(run(c, Job::Grow, options));
  forget_stop();
  options.on_phase = {};
  options.resume = true;
  const Result rest = run(c, Job::Grow, options);
  ASSERT_EQ(rest.growth->steps.size(), whole.growth->steps.size());
  for (std::size_t i = 0; i < whole.growth->steps.size(); ++i) {
    EXPECT_EQ(rest.growth->steps[i].cycles, whole.growth->steps[i].cycles);
    EXPECT_EQ(rest.growth->steps[i].tips[0].at, whole.growth->steps[i].tips[0].at);
  }
}

}  // namespace
}  // namespace kerf::grow_run_test
