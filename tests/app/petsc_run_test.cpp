// backend = "petsc" on one, two and four processes: the same numbers as by the factor of one.

#include "tests/support/folder.hpp"
#include "tests/support/running.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace kerf::petsc_run_test {

namespace {

using nlohmann::json;

struct Outcome {
  int code = -1;
  std::string said;
};

const std::string square = R"([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [0.3, 1]
[mesh]
size = 0.06
[output]
vtk = false
png = false
html = false
)";

std::string material(const char* poisson) {
  return fmt::format("[material]\nyoung = 1\npoisson = {}\n", poisson);
}

std::string solver(const std::string& element, int degree) {
  return fmt::format("[solver]\nelement = \"{}\"\ndegree = {}\n", element, degree);
}

const std::string open_crack = R"([[crack]]
name = "c"
path = [[0.31, 0.42], [0.72, 0.55]]
contact = "open"
)";

class PetscRun : public kerf::test::InFolder {
 protected:
#ifndef KERF_WITH_PETSC
  void SetUp() override {
    GTEST_SKIP() << "built without PETSc (./dev petsc)";
  }
#endif

  /// By `count` processes; 0: without mpiexec. `kilobytes`: of memory that each may take, or 0.
  Outcome kerf(int count, const std::string& arguments, int kilobytes = 0) const {
    const std::string mpiexec =
        count == 0 ? ""
                   : fmt::format(
                         "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpiexec --oversubscribe "
                         "--bind-to none -n {} ",
                         count);
    const std::string limited =
        kilobytes == 0 ? "" : fmt::format("bash -c 'ulimit -d {} && exec \"$0\" \"$@\"' ", kilobytes);
    const int status = std::system(fmt::format("cd '{}' && OPENBLAS_NUM_THREADS=1 {} {} '{}' {} >said 2>&1",
                                               folder.string(), mpiexec, limited, KERF_PROGRAM, arguments)
                                       .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text("said")};
  }

  void write(const std::string& case_file) const {
    std::ofstream(folder / "a.toml") << case_file;
  }

  json result(int count, const std::string& backend, const std::string& command = "solve",
              const std::string& more = {}) const {
    const std::string out = fmt::format("out_{}_{}", backend, count);
    const Outcome o =
        kerf(count, fmt::format("{} a.toml -o {} --force --threads 1 --quiet --set 'solver.backend=\"{}\"' --set "
                                "output.margins=false {}",
                                command, out, backend, more));
    EXPECT_EQ(o.code, 0) << o.said;
    return json::parse(std::ifstream(folder / out / "result.json"));
  }

  /// Both are within 1e-9 of each other, relative to `size` or themselves.
  static void expect_same(const json& a, const json& b, const std::string& what, double size = 0) {
    const double x = a.get<double>(), y = b.get<double>();
    EXPECT_NEAR(x, y, 1e-9 * std::max(size, std::abs(y))) << what;
  }

  static void expect_same_state(const json& r, const json& truth, const std::string& what) {
    expect_same(r["state"]["energy"], truth["state"]["energy"], what + ": energy");
    expect_same(r["state"]["compliance"], truth["state"]["compliance"], what + ": compliance");
    EXPECT_LT(r["state"]["residual"].get<double>(), 1e-8) << what;
    EXPECT_LT(r["state"]["work_error"].get<double>(), 1e-8) << what;
    for (std::size_t c = 0; truth.contains("cracks") && c < truth["cracks"].size(); ++c)
      for (std::size_t t = 0; t < truth["cracks"][c]["tips"].size(); ++t) {
        const json &tip = r["cracks"][c]["tips"][t], &other = truth["cracks"][c]["tips"][t];
        const double size = std::hypot(other["K_I"].get<double>(), other["K_II"].get<double>());
        for (const char* K : {"K_I", "K_II"}) expect_same(tip[K], other[K], what + ": " + K, size);
      }
  }
};

TEST_F(PetscRun, SameStateOnAnyNumberOfProcesses) {
  write(square + material("0.3") + open_crack + solver("bdms", 1));
  const json truth = result(0, "cholmod");
  for (const int count : {0, 1, 2, 4}) {
    const json r = result(count, "petsc");
    expect_same_state(r, truth, fmt::format("{} processes", count));
    EXPECT_EQ(r["state"].contains("solver"), count > 1);  // one process has a factor
    if (count < 2) continue;
    EXPECT_EQ(r["state"]["solver"]["parts"], count);
    EXPECT_LE(r["state"]["solver"]["iterations"].get<int>(), 40);
  }
}

TEST_F(PetscRun, ElementsAndMaterials) {
  struct Row {
    std::string element;
    int degree;
    const char* poisson;
  };
  for (const Row& row :
       {Row{"bdms", 1, "0.5"}, Row{"bdms", 2, "0.4999"}, Row{"bdms", 3, "0.499999"}, Row{"afw", 1, "0.499999"},
        Row{"afw", 2, "0.5"}, Row{"afw", 3, "0.3"}, Row{"arnold-winther-nc", 1, "0.3"}}) {
    const std::string what = fmt::format("{} {}, nu = {}", row.element, row.degree, row.poisson);
    write(square + material(row.poisson) + open_crack + solver(row.element, row.degree));
    const std::string coarse = "--set mesh.size=0.14 --set mesh.crack_tip_size=0.07";
    const json r = result(4, "petsc", "solve", coarse);
    expect_same_state(r, result(0, "cholmod", "solve", coarse), what);
    EXPECT_LE(r["state"]["solver"]["iterations"], 30) << what;
    EXPECT_LE(r["state"]["solver"]["condition"], 30) << what;
    EXPECT_GT(r["state"]["solver"]["primal_unknowns"], 0) << what;
    EXPECT_GT(r["state"]["solver"]["bytes_per_iteration"], 0) << what;
  }
}

// Two discs, a million times as stiff one as the other, and cracks that run through parts.
TEST_F(PetscRun, RegionsOfContrastAndCracksAcrossParts) {
  write(square + material("0.499999") + solver("bdms", 1) + R"([[region]]
name = "stiff"
circle = { center = [0.31, 0.33], radius = 0.21 }
young = 1e3
poisson = 0.499999
[[region]]
name = "soft"
circle = { center = [0.7, 0.6], radius = 0.15 }
young = 1e-3
poisson = 0.499999
[[crack]]
name = "long"
path = [[0.1, 0.87], [0.9, 0.83]]
contact = "open"
[[crack]]
name = "tall"
path = [[0.92, 0.1], [0.9, 0.7]]
contact = "open"
)");
  const std::string coarse = "--set mesh.size=0.1 --set mesh.crack_tip_size=0.05";
  const json r = result(4, "petsc", "solve", coarse);
  expect_same_state(r, result(0, "cholmod", "solve", coarse), "contrast");
  EXPECT_LE(r["state"]["solver"]["iterations"], 30);
  EXPECT_LE(r["state"]["solver"]["condition"], 30);
}

TEST_F(PetscRun, Contact) {
  write(square + material("0.3") + solver("bdms", 1) + R"([[crack]]
name = "c"
path = [[0.2, 0.3], [0.8, 0.62]]
friction = 0.2
[[crack]]
name = "d"
path = [[0.15, 0.8], [0.85, 0.75]]
)");
  const std::string coarse = "--set mesh.size=0.14 --set mesh.crack_tip_size=0.07";
  const json truth = result(0, "cholmod", "solve", coarse), r = result(4, "petsc", "solve", coarse);
  expect_same_state(r, truth, "contact");
  EXPECT_NEAR(r["contact"]["closed_length"].get<double>(), truth["contact"]["closed_length"].get<double>(), 1e-8);
}

TEST_F(PetscRun, MapOfAFunctionalWithAnAdjoint) {
  write(square + material("0.3") + open_crack + solver("bdms", 1) + R"([functional]
kind = "displacement_tracking"
target = ["0", "0.1"]
[map]
points = [[0.2, 0.7], [0.55, 0.3]]
)");
  const json truth = result(0, "cholmod", "map"), r = result(4, "petsc", "map");
  for (std::size_t i = 0; i < 2; ++i)
    expect_same(r["map"]["points"][i]["value"], truth["map"]["points"][i]["value"], "T");
}

// A mesh that is divided on its processes, of which none has the whole.
class DividedRun : public PetscRun {
 protected:
  /// The same by one process and by several, but for what these leave out.
  void expect_same_in_parts(const std::string& case_file, int count, const std::string& more) const {
    write(case_file);
    const std::string what = case_file + more;
    const json truth = result(0, "cholmod", "solve", more), r = result(count, "petsc", "solve", more);
    EXPECT_EQ(r["mesh"]["triangles"], truth["mesh"]["triangles"]) << what;
    EXPECT_EQ(r["mesh"]["vertices"], truth["mesh"]["vertices"]) << what;
    EXPECT_NEAR(r["mesh"]["h_min"].get<double>(), truth["mesh"]["h_min"].get<double>(), 1e-12) << what;
    for (const char* key : {"energy", "compliance", "area"})
      expect_same(r["state"][key], truth["state"][key], what + key);
    EXPECT_EQ(r["state"]["unknowns"], truth["state"]["unknowns"]) << what;
    EXPECT_LT(r["state"]["residual"].get<double>(), 1e-8) << what;
    EXPECT_LT(r["state"]["work_error"].get<double>(), 1e-9) << what;
    expect_same(r["functional"]["value"], truth["functional"]["value"], what + "functional");
    expect_same_interval(r["state"], truth["state"], truth.contains("contact"), what);
    for (const char* key : {"max_von_mises", "max_displacement"}) {
      const json &peak = r["state"][key], &other = truth["state"][key];
      EXPECT_NEAR(peak["value"].get<double>(), other["value"].get<double>(), 1e-7 * other["value"].get<double>())
          << what;
      EXPECT_EQ(peak.value("singular", false), other.value("singular", false)) << what;
    }
    for (const char* key : {"loads", "reactions"}) {
      const json &forces = r["state"]["resultants"][key], &others = truth["state"]["resultants"][key];
      ASSERT_EQ(forces.size(), others.size()) << what;
      for (std::size_t i = 0; i < others.size(); ++i)
        for (std::size_t d = 0; d < 2; ++d) expect_same(forces[i]["force"][d], others[i]["force"][d], what + key, 1);
    }
    expect_same_estimate(r, truth, what);
    if (!truth.contains("cracks")) return;
    for (std::size_t c = 0; c < truth["cracks"].size(); ++c) {
      expect_same_tips(r["cracks"][c], truth["cracks"][c], what);
      const json &crack = r["cracks"][c], &other = truth["cracks"][c];
      for (const char* key : {"length", "max_opening", "max_pressure"})
        EXPECT_NEAR(crack[key].get<double>(), other[key].get<double>(), 1e-7) << what << key;
      const auto rows = [&](const char* out) {
        return text(fmt::format("{}/crack_{}.csv", out, std::string(other["name"])));
      };
      expect_same_rows(rows(fmt::format("out_petsc_{}", count).c_str()), rows("out_cholmod_0"), what);
    }
    if (truth.contains("contact")) {
      EXPECT_NEAR(r["contact"]["closed_length"].get<double>(), truth["contact"]["closed_length"].get<double>(), 1e-8)
          << what;
      const int most = case_file.find("friction") == std::string::npos ? 30 : 300;  // one per unknown would be 600
      EXPECT_LT(r["state"]["solver"]["solves"].get<int>(), most) << what;
    }
  }

  static void expect_same_estimate(const json& r, const json& truth, const std::string& what) {
    const double estimate = truth["state"]["estimated_error"].get<double>();
    EXPECT_NEAR(r["state"]["estimated_error"].get<double>(), estimate, 1e-10 * std::max(1.0, estimate)) << what;
  }

  /// Rounding that is left of equilibrium is a part of it. `contact`: the pressures are then not the best ones, as in
  /// bodies of one process whose contact is large.
  static void expect_same_interval(const json& state, const json& truth, bool contact, const std::string& what) {
    const json &interval = state["energy_bounds"], &other = truth["energy_bounds"];
    ASSERT_EQ(interval.is_null(), other.is_null()) << what;
    if (other.is_null()) return;
    const double energy = truth["energy"].get<double>(), width = other.at(1).get<double>() - other.at(0).get<double>();
    for (std::size_t end = 0; end < 2; ++end)
      EXPECT_NEAR(interval.at(end).get<double>(), other.at(end).get<double>(),
                  contact ? 0.25 * width : 1e-7 * std::abs(energy))
          << what;
    EXPECT_LT(interval.at(0).get<double>(), other.at(1).get<double>()) << what;
    EXPECT_GT(interval.at(1).get<double>(), other.at(0).get<double>()) << what;
  }

  static void expect_same_tips(const json& crack, const json& truth, const std::string& what) {
    ASSERT_EQ(crack["tips"].size(), truth["tips"].size()) << what;
    for (std::size_t t = 0; t < truth["tips"].size(); ++t) {
      const json &tip = crack["tips"][t], &other = truth["tips"][t];
      // Of the size of the stress in the body: bonded and closed tips have next to none.
      const double size = std::max(1.0, std::hypot(other["K_I"].get<double>(), other["K_II"].get<double>()));
      for (const char* key : {"K_I", "K_II"}) expect_same(tip[key], other[key], what + key, size);
      EXPECT_NEAR(tip["T"].get<double>(), other["T"].get<double>(), 1e-8) << what;
    }
  }

  /// Of maps: corners of the mesh before it was divided, and what the divided one has there; two at faces of cracks.
  void expect_rows_of(const std::string& some, const std::string& all) const {
    const auto rows_of = [&](const std::string& name) {
      std::istringstream lines(text(name));
      std::string line;
      std::getline(lines, line);
      std::vector<std::array<double, 3>> rows;
      while (std::getline(lines, line)) {
        std::ranges::replace(line, ',', ' ');
        std::istringstream numbers(line);
        auto& row = rows.emplace_back();
        numbers >> row[0] >> row[1] >> row[2];
      }
      return rows;
    };
    const auto few = rows_of(some), many = rows_of(all);
    EXPECT_GT(few.size(), 50u);
    EXPECT_GT(many.size(), 2 * few.size());
    double largest = 0;
    for (const auto& row : many) largest = std::max(largest, std::abs(row[2]));
    for (const auto& row : few)
      EXPECT_TRUE(std::ranges::any_of(many,
                                      [&](const auto& other) {
                                        return other[0] == row[0] && other[1] == row[1] &&
                                               std::abs(other[2] - row[2]) <= 1e-7 * largest;
                                      }))
          << row[0] << " " << row[1];
  }

  /// Of tables with a line of names.
  static void expect_same_rows(const std::string& a, const std::string& b, const std::string& what) {
    std::istringstream left(a), right(b);
    std::string x, y;
    int rows = 0;
    while (std::getline(right, y)) {
      ASSERT_TRUE(static_cast<bool>(std::getline(left, x))) << what;
      if (rows++ == 0) {
        EXPECT_EQ(x, y) << what;
        continue;
      }
      std::ranges::replace(x, ',', ' ');
      std::ranges::replace(y, ',', ' ');
      std::istringstream p(x), q(y);
      double u = 0, v = 0;
      while (q >> v) {
        ASSERT_TRUE(static_cast<bool>(p >> u)) << what;
        EXPECT_NEAR(u, v, 1e-6 * std::max(1.0, std::abs(v))) << what;
      }
    }
    EXPECT_GT(rows, 10) << what;
    EXPECT_FALSE(static_cast<bool>(std::getline(left, x))) << what;
  }
};

const std::string coarse_in_parts = " --set mesh.size=0.14 --set mesh.crack_tip_size=0.05 --set mesh.refine=1 ";

std::string crack(const std::string& more) {
  return "[[crack]]\nname = \"c\"\npath = [[0.2, 0.3], [0.8, 0.62]]\n" + more;
}

TEST_F(DividedRun, ElementsAndMaterials) {
  expect_same_in_parts(square + material("0.3") + open_crack + solver("bdms", 1), 4, coarse_in_parts);
  expect_same_in_parts(square + material("0.499999") + open_crack + solver("afw", 2), 3, coarse_in_parts);
  expect_same_in_parts(square + material("0.5") + crack("contact = \"bonded\"\n") + solver("bdms", 2), 2,
                       coarse_in_parts);
  expect_same_in_parts(square + material("0.3") + solver("arnold-winther-nc", 1), 2,
                       coarse_in_parts + "--set mesh.refine=2");
}

// Cracks through parts and along their borders, as the partition has them: sets of points in contact take a system of
// the whole each, and friction further solves.
TEST_F(DividedRun, Contact) {
  expect_same_in_parts(square + material("0.3") + crack("") + solver("bdms", 1), 4, coarse_in_parts);
  expect_same_in_parts(square + material("0.5") + crack("friction = 0.3\n") + solver("bdms", 1), 3, coarse_in_parts);
  expect_same_in_parts(square + material("0.3") + crack("gap = \"0.05*x\"\n") + solver("bdms", 1), 2, coarse_in_parts);
  expect_same_in_parts(
      square + material("0.3") + crack("contact = \"open\"\npressure = \"1 + x\"\n") + solver("bdms", 2), 2,
      coarse_in_parts);
}

// Nothing holds it: the loads are in equilibrium, with and without a body force; a stiff disc lies across parts.
TEST_F(DividedRun, FreeBodiesRegionsAndBodyForces) {
  const std::string pulled = R"([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[[boundary]]
on = "left"
traction = [-1, "y - 0.5"]
[[boundary]]
on = "right"
traction = [1, "0.5 - y"]
[[region]]
name = "stiff"
circle = { center = [0.31, 0.53], radius = 0.21 }
young = 1e3
poisson = 0.3
[mesh]
size = 0.06
[output]
vtk = false
png = false
html = false
)";
  expect_same_in_parts(pulled + material("0.3") + solver("bdms", 1), 3, coarse_in_parts);
  expect_same_in_parts(pulled + "[body]\nforce = [\"x - 0.5\", 0]\n" + material("0.3") + solver("bdms", 1), 2,
                       coarse_in_parts);
  expect_same_in_parts(square + "[body]\nforce = [\"x*y\", -1]\n" + material("0.499") + solver("bdms", 1), 2,
                       coarse_in_parts);
  expect_same_in_parts(square + material("0.3") + "eigenstrain = [\"0.1*x\", \"0.1*y*y\", 0.02]\n" +
                           crack("contact = \"open\"\n") + solver("bdms", 1),
                       3, coarse_in_parts);
}

// The middles of curved edges go onto their arcs on every process alike: holes, an ellipse between materials, cracks
// that are open, touch and slide.
TEST_F(DividedRun, CurvedEdges) {
  const std::string body = square + material("0.3") + R"([[hole]]
name = "h"
circle = { center = [0.3, 0.3], radius = 0.15 }
[[boundary]]
on = "hole:h"
pressure = "1 + x"
[[region]]
name = "stiff"
ellipse = { center = [0.75, 0.25], semi_axes = [0.15, 0.1], angle_deg = 20 }
young = 10
poisson = 0.2
)",
                    arc =
                        "[[crack]]\nname = \"c\"\n"
                        "arc = { center = [0.55, 0.6], radius = 0.2, from_deg = 10, to_deg = 110 }\n",
                    coarse = " --set mesh.size=0.12 --set mesh.crack_tip_size=0.04 --set mesh.refine=1 ";
  expect_same_in_parts(body + "[body]\nforce = [\"x*y\", -1]\n" + arc + "contact = \"open\"\n" + solver("bdms", 2), 3,
                       coarse);
  // Loads are those of the edges before they were divided, which quadratic ones carry to 1e-5 alone.
  expect_same_in_parts(body + arc + "friction = 0.3\n" + solver("bdms", 2), 2, coarse);
}

// Nothing answers a uniform pressure: its mean is 0, as one process has it.
TEST_F(DividedRun, EnclosedIncompressibleBodies) {
  const std::string enclosed = R"enclosed([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["a", "b", "a", "a"]
[[boundary]]
on = "a"
displacement = [0, 0]
[[boundary]]
on = "b"
displacement = [0, "0.1*y*(1 - y)"]
[body]
force = ["x*y", 1]
[mesh]
size = 0.06
[output]
vtk = false
png = false
html = false
[[region]]
name = "disc"
circle = { center = [0.31, 0.53], radius = 0.21 }
young = 5
poisson = 0.5
)enclosed";
  expect_same_in_parts(enclosed + material("0.5") + solver("bdms", 1), 3, coarse_in_parts);
  std::string squeezed = enclosed;
  squeezed.replace(squeezed.find("[0, \"0.1*y*(1 - y)\"]"), 20, "[\"0.1*y*(1 - y)\", 0]");
  write(squeezed + material("0.5") + solver("bdms", 1));
  const Outcome o = kerf(3, "solve a.toml --force --set 'solver.backend=\"petsc\"'" + coarse_in_parts);
  EXPECT_EQ(o.code, 4) << o.said;
  EXPECT_NE(o.said.find("the prescribed displacements change its area by"), std::string::npos) << o.said;
}

// What only an adjoint tells: of the displacement on a side, of stresses, of a crack's pressure, of a compliance under
// prescribed displacements, of a misfit, whose second state is that of another body.
TEST_F(DividedRun, MapsWithAdjoints) {
  const std::string body = square + crack("") + solver("bdms", 1) + "[map]\npoints = [[0.21, 0.72], [0.55, 0.36], " +
                           "[0.5, 0.53], [0.77, 0.1]]\nradius = 0.015\n";
  std::string pulled = body;
  pulled.replace(pulled.find("traction = [0.3, 1]"), 19,
                 "displacement = [\"0.1 + 0.05*y\", 0]\n[body]\nforce = [\"x*y\", -1]");
  const auto expect_same_map = [&](const std::string& case_file, const std::string& functional) {
    write(case_file + "[functional]\n" + functional + "\n");
    const json truth = result(0, "cholmod", "map", coarse_in_parts), r = result(3, "petsc", "map", coarse_in_parts);
    expect_same(r["functional"]["value"], truth["functional"]["value"], functional);
    double largest = 0;
    for (const json& p : truth["map"]["points"]) largest = std::max(largest, std::abs(p["value"].get<double>()));
    EXPECT_GT(largest, 0) << functional;
    for (std::size_t i = 0; i < 4; ++i)
      expect_same(r["map"]["points"][i]["value"], truth["map"]["points"][i]["value"], functional, largest);
  };
  expect_same_map(body + material("0.3"), "kind = \"stress_pnorm\"\np = 3");
  expect_same_map(body + material("0.4999"), "kind = \"displacement\"\non = \"right\"\ndirection = [0.2, 1]");
  expect_same_map(body + material("0.3"), "kind = \"crack_pressure\"\ncrack = \"c\"\ntarget = 0.2");
  expect_same_map(body + material("0.3"), "kind = \"energy_release_rate\"\ncrack = \"c\"\ntip = \"end\"");
  expect_same_map(pulled + material("0.3"), "kind = \"compliance\"");
  std::string rubbing = body;
  rubbing.replace(rubbing.find("[solver]"), 8, "friction = 0.3\n[solver]");
  expect_same_map(rubbing + material("0.3"), "kind = \"energy\"");
  expect_same_map(body + material("0.3"), "kind = \"misfit\"\non = \"right\"\nmeasured = [\"0.3\", \"2*y\"]");
}

// With the divided mesh of each round, whose indicator grades the next one before it is divided.
TEST_F(DividedRun, AdaptiveRounds) {
  write(square + material("0.3") + crack("contact = \"open\"\n") + solver("bdms", 1));
  const std::string more = " --set mesh.size=0.2 --set mesh.refine=1 --set mesh.adapt.error=0.02";
  const json truth = result(0, "cholmod", "solve", more), r = result(3, "petsc", "solve", more);
  const json &rounds = r["mesh"]["adapt"]["rounds"], &others = truth["mesh"]["adapt"]["rounds"];
  ASSERT_GE(rounds.size(), 2u);
  ASSERT_EQ(rounds.size(), others.size());
  EXPECT_EQ(rounds[0]["triangles"], others[0]["triangles"]);
  EXPECT_NEAR(rounds[0]["estimated_error"].get<double>(), others[0]["estimated_error"].get<double>(), 1e-10);
  EXPECT_NE(r["mesh"]["adapt"]["stopped"].get<std::string>().find("reached the asked error 0.02"), std::string::npos);
  EXPECT_LE(r["state"]["estimated_error"].get<double>(), 0.02);
  // Sizes are the same to rounding; of that the mesher makes another mesh.
  const double triangles = truth["mesh"]["triangles"].get<double>(),
               estimate = truth["state"]["estimated_error"].get<double>();
  EXPECT_NEAR(r["mesh"]["triangles"].get<double>(), triangles, 0.01 * triangles);
  EXPECT_NEAR(r["state"]["estimated_error"].get<double>(), estimate, 0.02 * estimate);
  EXPECT_EQ(rounds.back()["triangles"], r["mesh"]["triangles"]);
}

// Chords that are divided are chords still: the error of the polygon stays in the estimate.
TEST_F(DividedRun, ChordsOfTheUndividedMeshAreInTheEstimate) {
  std::string holed = square;
  holed.replace(holed.find("[mesh]"), 6,
                "[[hole]]\nname = \"h\"\ncircle = { center = [0.5, 0.5], radius = 0.25 }\n[mesh]");
  write(holed + material("0.3") + solver("bdms", 2));
  const std::string coarse = " --set mesh.size=0.25 --set mesh.curved=false --set mesh.refine=";
  const double divided = result(0, "cholmod", "solve", coarse + "3")["state"]["estimated_error"].get<double>();
  const json parts = result(3, "petsc", "solve", coarse + "3");
  EXPECT_NEAR(parts["state"]["estimated_error"].get<double>(), divided, 1e-10);
  EXPECT_EQ(parts["state"]["energy_bounds_of"], "polygon");
  // What the polygon lacks does not fall with the divisions.
  const double once = result(0, "cholmod", "solve", coarse + "2")["state"]["estimated_error"].get<double>();
  EXPECT_GT(divided, 0.6 * once);
}

// The fields that a map is read off are recovered with neighbors of other processes, its mask knows features of all.
// Its support turns and moves it as a whole: all stresses are rounding.
TEST_F(DividedRun, ABodyThatIsMovedAsAWhole) {
  std::string moved = square;
  moved.replace(moved.find("displacement = [0, 0]"), 21, "displacement = [\"1 - 0.2*y\", \"0.2*x\"]");
  moved.replace(moved.find("traction = [0.3, 1]"), 19, "traction = [0, 0]");
  write(moved + material("0.3") + solver("bdms", 1));
  const json r = result(2, "petsc", "solve", coarse_in_parts);
  EXPECT_EQ(r["status"], "ok");
  EXPECT_LT(r["state"]["max_von_mises"]["value"].get<double>(), 1e-12);
  EXPECT_NEAR(r["state"]["max_displacement"]["value"].get<double>(), std::hypot(1.0, 0.2), 0.21);
}

TEST_F(DividedRun, SoftIncompressibleDiscsInAStifferBody) {
  // Without taking the uniform pressures out (E.23) the second ends 3e-4 off, with a residual of 1e-5.
  for (const char* young : {"1e-3", "1e-6"})
    expect_same_in_parts(square + material("0.3") + solver("bdms", 1) +
                             fmt::format("[[region]]\nname = \"soft\"\ncircle = {{ center = [0.5, 0.53], radius = 0.21 "
                                         "}}\nyoung = {}\npoisson = 0.4999999\n[[region]]\nname = \"stiff\"\ncircle = "
                                         "{{ center = [0.2, 0.2], radius = 0.1 }}\nyoung = 1e3\npoisson = 0.5\n",
                                         young),
                         3, coarse_in_parts);
}

TEST_F(DividedRun, MapsOfEnergies) {
  for (const std::string perturbation : {"\"hole\"", "{ young = 3, poisson = 0.2 }", "\"crack\""}) {
    write(square + material("0.3") + crack("") + solver("bdms", 1) +
          "[map]\npoints = [[0.21, 0.72], [0.55, 0.36], [0.5, 0.53], [0.77, 0.1]]\nradius = 0.015\nperturbation = " +
          perturbation + "\n");
    const json truth = result(0, "cholmod", "map", coarse_in_parts), r = result(3, "petsc", "map", coarse_in_parts);
    for (std::size_t i = 0; i < 4; ++i) {
      const json &p = r["map"]["points"][i], &other = truth["map"]["points"][i];
      expect_same(p["value"], other["value"], perturbation);
      EXPECT_EQ(p["masked"], other["masked"]);
    }
    EXPECT_EQ(text("out_petsc_3/map.csv").size() > 100, true);
  }
  write(square + material("0.3") + crack("") + solver("bdms", 1));
  const std::string more = coarse_in_parts + "--set 'functional.kind=\"compliance\"' --set output.vtk=true";
  const json truth = result(0, "cholmod", "map", more), r = result(4, "petsc", "map", more);
  for (const char* key : {"min", "max"}) {
    EXPECT_NEAR(r["map"][key]["value"].get<double>(), truth["map"][key]["value"].get<double>(),
                1e-7 * std::abs(truth["map"][key]["value"].get<double>()));
    EXPECT_EQ(r["map"][key]["at"], truth["map"][key]["at"]);
  }
  EXPECT_NEAR(r["map"]["masked_share"].get<double>(), truth["map"]["masked_share"].get<double>(), 1e-9);
  expect_rows_of("out_petsc_4/map.csv", "out_cholmod_0/map.csv");
  EXPECT_NE(text("out_petsc_4/map.pvtu").find("<Piece Source=\"map_0003.vtu\"/>"), std::string::npos);
  EXPECT_GT(std::filesystem::file_size(folder / "out_petsc_4" / "map_0003.vtu"), 10000u);
}

// By Green's tensor of the mesh before it was divided, which is as smooth as it is there.
TEST_F(DividedRun, MapsOfClampedHoles) {
  for (const std::string functional :
       {"kind = \"energy\"", "kind = \"displacement\"\non = \"right\"\ndirection = [0, 1]"}) {
    write(square + material("0.3") + open_crack + solver("bdms", 1) +
          "[map]\npoints = [[0.21, 0.72], [0.77, 0.2], [0.5, 0.8]]\nradius = 0.01\nperturbation = \"clamped_hole\"\n" +
          "[functional]\n" + functional + "\n");
    const json truth = result(0, "cholmod", "map", coarse_in_parts), r = result(3, "petsc", "map", coarse_in_parts);
    double largest = 0;
    for (const json& p : truth["map"]["points"]) largest = std::max(largest, std::abs(p["value"].get<double>()));
    EXPECT_GT(largest, 0) << functional;
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(r["map"]["points"][i]["value"].get<double>(), truth["map"]["points"][i]["value"].get<double>(),
                  2e-3 * largest)
          << functional;
  }
  write(square + material("0.3") + open_crack + solver("bdms", 1) +
        "[map]\nradius = 0.01\nperturbation = \"clamped_hole\"\n");
  const json truth = result(0, "cholmod", "map", coarse_in_parts), r = result(3, "petsc", "map", coarse_in_parts);
  for (const char* key : {"min", "max"})
    EXPECT_NEAR(r["map"][key]["value"].get<double>(), truth["map"][key]["value"].get<double>(),
                5e-3 * truth["map"]["max"]["value"].get<double>())
        << key;
}

// What one process tells its reader, several do.
TEST_F(DividedRun, NotesAreThoseOfOneProcess) {
  const auto expect_notes = [this](const std::string& case_file, const std::string& command,
                                   const std::vector<std::string>& some) {
    write(case_file);
    const json truth = result(0, "cholmod", command, coarse_in_parts), r = result(2, "petsc", command, coarse_in_parts);
    std::vector<std::string> notes = r["state"]["notes"].get<std::vector<std::string>>();
    for (const json& note : truth["state"]["notes"]) {
      if (note.get<std::string>().find("held all around") != std::string::npos) continue;  // it names a point of a mesh
      EXPECT_NE(std::ranges::find(notes, note.get<std::string>()), notes.end()) << note << "\n" << r["state"]["notes"];
    }
    for (const std::string& words : some)
      EXPECT_TRUE(
          std::ranges::any_of(notes, [&](const std::string& note) { return note.find(words) != std::string::npos; }))
          << words << "\n"
          << r["state"]["notes"];
  };
  std::string pressed = square;
  pressed.replace(pressed.find("displacement = [0, 0]"), 21, "traction = [1, 0]");
  pressed.replace(pressed.find("traction = [0.3, 1]"), 19, "traction = [-1, 0]");
  pressed.replace(pressed.find("[mesh]"), 6, "[mesh]\ncurved = false");
  expect_notes(pressed + material("0.3") + R"([[hole]]
name = "h"
circle = { center = [0.3, 0.72], radius = 0.12 }
[[crack]]
name = "c"
path = [[0.65, 0.3], [0.6, 0.45]]
contact = "open"
)",
               "solve",
               {"the faces of crack \"c\" (contact = \"open\") penetrate by", "strains reach", "displacements reach",
                "lies at a corner of the chords"});
  expect_notes(R"rim([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["rim", "rim", "rim", "rim"]
[[boundary]]
on = "rim"
displacement = ["1e-3 * x", "-1e-3 * y"]
[body]
force = ["10 * sin(pi * x)", "y"]
[map]
radius = 0.1
[output]
vtk = false
png = false
html = false
)rim" + material("0.49"),
               "map", {"the body is nearly incompressible and held all around"});
}

// Of each material its own largest stress, wherever it lies; of the crack its tips.
TEST_F(DividedRun, ReservesAreThoseOfOneProcess) {
  write(square + material("0.3") + "yield = 3\ntoughness = 2\n" + open_crack + solver("bdms", 1) +
        R"([[region]]
name = "stiff"
circle = { center = [0.3, 0.75], radius = 0.12 }
young = 3
poisson = 0.2
yield = 5
)");
  const std::string more = coarse_in_parts + "--set mesh.curved=false";
  const json truth = result(0, "cholmod", "solve", more)["state"]["reserve"];
  const json r = result(3, "petsc", "solve", more)["state"]["reserve"];
  ASSERT_EQ(truth.size(), 4u) << truth;
  ASSERT_EQ(r.size(), truth.size()) << r;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    expect_same(r[i]["factor"], truth[i]["factor"], fmt::format("reserve {}", i));
    EXPECT_EQ(r[i]["of"], truth[i]["of"]);
  }
}

TEST_F(DividedRun, Probes) {
  write(square + material("0.3") + crack("") + solver("bdms", 1) +
        "[[probe]]\nname = \"line\"\nfrom = [0.1, 0.2]\nto = [1.1, 0.8]\ncount = 15\n");
  for (const char* command : {"solve", "map"}) {
    result(0, "cholmod", command, coarse_in_parts);
    result(3, "petsc", command, coarse_in_parts);
    const std::string rows = text("out_petsc_3/probe_line.csv");
    expect_same_rows(rows, text("out_cholmod_0/probe_line.csv"), command);
    EXPECT_NE(rows.find("1.1,0.8,,,,,,"), std::string::npos) << rows;
  }
}

// At the corners of the mesh before it was divided, with what the divided one has there.
TEST_F(DividedRun, PicturesAndPage) {
  write(square + material("0.3") + crack("") + solver("bdms", 1));
  const std::string shown = coarse_in_parts + "--set output.png=true --set output.html=true";
  const json r = result(3, "petsc", "map", shown);
  for (const char* name : {"mesh.png", "von_mises.png", "map.png"})
    EXPECT_GT(std::filesystem::file_size(folder / "out_petsc_3" / name), 10000u) << name;
  const std::string arrays = text("out_petsc_3/report.bin");
  for (const char* name : {"von_mises", "stress", "map", "margin"})
    EXPECT_NE(arrays.find(name), std::string::npos) << name;
  EXPECT_GT(std::filesystem::file_size(folder / "out_petsc_3" / "report.html"), 100000u);
}

TEST_F(DividedRun, FieldsComeInPiecesAndNoProcessHasTheWhole) {
  write(square + material("0.3") + open_crack + solver("bdms", 1));
  const std::string large =
      "--set mesh.size=0.025 --set mesh.refine=2 --set output.vtk=true --set output.energy_bounds=false";
  const json truth = result(0, "cholmod", "solve", large), r = result(6, "petsc", "solve", large);
  const std::string grid = text("out_petsc_6/state.pvtu");
  for (int p = 0; p < 6; ++p) {
    const std::string piece = fmt::format("state_{:04}.vtu", p);
    EXPECT_NE(grid.find(fmt::format("<Piece Source=\"{}\"/>", piece)), std::string::npos);
    EXPECT_GT(std::filesystem::file_size(folder / "out_petsc_6" / piece), 1000000u);
  }
  for (const char* name : {"\"u\" NumberOfComponents=\"3\"", "\"von_mises\" NumberOfComponents=\"1\""})
    EXPECT_NE(grid.find(name), std::string::npos) << grid;
  // The largest of the others, and the first one, which has the undivided mesh besides.
  const double whole = truth["peak_memory_mb"].get<double>();
  for (const json& mb : r["state"]["solver"]["peak_memory_mb"]) EXPECT_LT(mb.get<double>(), 0.7 * whole);
}

// Each has less memory than one process takes for half of the body.
TEST_F(DividedRun, NoProcessHasTheMemoryOfTheWhole) {
  constexpr int kilobytes = 200000;
  write(square + material("0.3") + crack("") + solver("bdms", 1));
  const std::string large =
      "solve a.toml -o out --force --threads 1 --quiet --set mesh.size=0.03 --set mesh.refine=2 --set "
      "'solver.backend=\"petsc\"'";
  const Outcome one = kerf(0, large, kilobytes);
  EXPECT_EQ(one.code, 4) << one.said;
  EXPECT_NE(one.said.find("out of memory"), std::string::npos) << one.said;
  const Outcome six = kerf(6, large, kilobytes);
  ASSERT_EQ(six.code, 0) << six.said;
  const json r = json::parse(std::ifstream(folder / "out" / "result.json"));
  EXPECT_GT(r["mesh"]["triangles"], 60000);
  EXPECT_LT(r["state"]["residual"].get<double>(), 1e-8);
}

TEST_F(DividedRun, WhatIsOfTheWholeIsRefused) {
  write(square + material("0.3") + open_crack + solver("bdms", 1));
  const auto refused = [&](int count, const std::string& arguments, int refine = 1) {
    const Outcome o =
        kerf(count, fmt::format("{} --force --set 'solver.backend=\"petsc\"' --set mesh.refine={}", arguments, refine));
    EXPECT_EQ(o.code, 2) << o.said;
    return o.said;
  };
  EXPECT_NE(refused(2, "map a.toml --set map.second=true").find("the second term takes solves of the whole"),
            std::string::npos);
  EXPECT_NE(refused(2,
                    "map a.toml --set 'map.perturbation=\"clamped_hole\"' --set map.radius=0.02 --set "
                    "'functional.kind=\"displacement_tracking\"' --set 'functional.target=[\"0\",\"0.1\"]'")
                .find("takes an integral over the whole body per point"),
            std::string::npos);
  EXPECT_NE(
      refused(2, "solve a.toml --set 'solver.petsc=\"-ksp_no_such 3\"'").find("PETSc has no use here for -ksp_no_such"),
      std::string::npos);
  EXPECT_NE(refused(2, "solve a.toml --set mesh.adapt.error=0.1 --set 'mesh.adapt.of=\"energy\"'")
                .find("mesh.adapt.of asks for intervals"),
            std::string::npos);
  EXPECT_NE(refused(2, "solve a.toml --set bounds.compliance=true", 0).find("[bounds] asks for"), std::string::npos);
  EXPECT_NE(refused(2, "map a.toml --set map.bounds=true", 0).find("error bars of a map"), std::string::npos);
  write(square + material("0.3") + solver("bdms", 1));
  EXPECT_NE(refused(4, "solve a.toml --set mesh.size=0.9").find("too few for 4 processes"), std::string::npos);
}

TEST_F(PetscRun, RefusalsNameTheirReason) {
  write(square + material("0.3"));
  const auto refused = [&](int count, const std::string& arguments) {
    const Outcome o = kerf(count, "solve a.toml --force " + arguments);
    EXPECT_EQ(o.code, 2) << o.said;
    return o.said;
  };
  EXPECT_NE(refused(2, "").find("mpiexec started 2 processes, and backend = \"cholmod\" uses one"), std::string::npos);
  EXPECT_NE(refused(0, "--set 'solver.backend=\"petsc\"' --set 'solver.element=\"peers\"'").find("live on edges alone"),
            std::string::npos);
  EXPECT_NE(refused(2, "--set 'solver.backend=\"petsc\"' --set 'solver.petsc=\"-ksp_no_such 3\"'")
                .find("PETSc has no use here for -ksp_no_such"),
            std::string::npos);
  EXPECT_EQ(kerf(2, "solve nothing.toml").code, 5);
}

/// The processes that `parent` has started and not yet waited for.
std::vector<pid_t> children(pid_t parent) {
  std::ifstream file(fmt::format("/proc/{0}/task/{0}/children", parent));
  return {std::istream_iterator<pid_t>(file), {}};
}

TEST_F(PetscRun, StartsOfAnOptimizationAreShared) {
  write(square + material("0.3") + R"([optimize]
method = "slsqp"
max_iterations = 12
starts = 5
volume = { at_most = 0.95 }
[functional]
kind = "compliance"
[[optimize.hole]]
name = "h"
circle = { center = [[0.3, 0.7], [0.3, 0.7]], radius = [0.1, 0.2] }
start = { center = [0.5, 0.5], radius = 0.13 }
)");
  const json truth = result(0, "cholmod", "optimize"), r = result(3, "cholmod", "optimize");
  ASSERT_EQ(truth["optimize"]["starts"].size(), 5u);
  for (const char* key : {"starts", "objective", "stopped", "state_solves"})
    EXPECT_EQ(r["optimize"][key], truth["optimize"][key]) << key;
  EXPECT_EQ(text("out_cholmod_3/history.csv"), text("out_cholmod_0/history.csv"));
  const Outcome alone = kerf(2, "optimize a.toml --force --set optimize.starts=1");
  EXPECT_EQ(alone.code, 2) << alone.said;
  EXPECT_NE(alone.said.find("set optimize.starts to 2 or more"), std::string::npos) << alone.said;
}

/// A run that somebody interferes with.
class DisturbedRun : public PetscRun {
 protected:
  /// Four processes of a large body, once they solve.
  void start(const std::string& name) {
    write(square + material("0.3") + solver("bdms", 1) + R"([[crack]]
name = "c"
path = [[0.1, 0.3], [0.9, 0.62]]
)");
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    run.emplace(folder,
                std::vector<std::string>{KERF_PROGRAM, "solve", "a.toml", "-o", name, "--processes", "4", "--threads",
                                         "1", "--set", "solver.backend=\"petsc\"", "--set", "mesh.size=0.01"});
    ASSERT_TRUE(run->reaches([&] {
      if (const auto launchers = children(run->id()); !launchers.empty()) started = children(launchers[0]);
      return started.size() == 4 && text("stderr").find("solve in parts") != std::string::npos;
    })) << text("stderr");
  }

  /// Sends the signal: the run ends with this code, and nobody is left.
  void expect_end(pid_t to, int signal, int code) {
    ASSERT_EQ(kill(to, signal), 0) << text("stderr");
    EXPECT_EQ(run->code(), code) << text("stderr");
    EXPECT_TRUE(kerf::test::eventually(
        [&] { return std::ranges::none_of(started, [](pid_t one) { return ::kill(one, 0) == 0; }); }));
  }

  std::optional<kerf::test::Running> run;
  std::vector<pid_t> started;
};

// The third process is killed while all solve.
TEST_F(DisturbedRun, AKilledProcessEndsTheRunAndLeavesWhatIsWritten) {
  start("results");
  if (HasFatalFailure()) return;
  expect_end(started[2], SIGKILL, 5);
  EXPECT_NE(text("stderr").find("one of 4 processes was killed (signal 9)"), std::string::npos) << text("stderr");
  EXPECT_FALSE(text("results/case.toml").empty());
}

TEST_F(DisturbedRun, AStopEndsAllProcesses) {
  start("results");
  if (HasFatalFailure()) return;
  expect_end(run->id(), SIGINT, 4);
  EXPECT_NE(text("stderr").find("stopped"), std::string::npos) << text("stderr");
  EXPECT_EQ(text("stderr").find("did not start"), std::string::npos) << text("stderr");
  EXPECT_FALSE(text("results/case.toml").empty());
}

TEST_F(PetscRun, BenchOfMachines) {
  if (!std::filesystem::exists(std::filesystem::path(KERF_PROGRAM).replace_filename("kerf-bench")))
    GTEST_SKIP() << "built without the benches";
  const Outcome o = kerf(0, "bench machines --quick --quiet --case contrast -o b");
  ASSERT_EQ(o.code, 0) << o.said;
  const json bench = json::parse(std::ifstream(folder / "b" / "machines.json"));
  ASSERT_EQ(bench["rows"].size(), 1u) << bench["notes"];
  EXPECT_LE(bench["rows"][0]["iterations"], 30);
  EXPECT_LE(bench["rows"][0]["off"], 1e-9);
}

TEST_F(PetscRun, OptionsReachPetsc) {
  write(square + material("0.3"));
  // On two parts the weights of both sides make the preconditioner exact.
  const json loose = result(4, "petsc", "solve", "--set 'solver.petsc=\"-ksp_rtol 1e-4\"'"), tight = result(4, "petsc");
  EXPECT_LT(loose["state"]["solver"]["iterations"], tight["state"]["solver"]["iterations"]);
  expect_same_state(loose, tight, "rounds make up for loose solves");
}

// On what the parts share with kerf's preconditioner; on K of the parts with those of PETSc; on the sum of K.
TEST_F(DividedRun, WhateverPetscSolvesWith) {
  write(square + material("0.3") + crack("") + solver("bdms", 1));
  const json truth = result(0, "cholmod", "solve", coarse_in_parts);
  for (const char* words :
       {"-ksp_type fcg", "-ksp_type pipecg", "-ksp_type gmres", "-ksp_guess_type pod", "-pc_type bddc",
        "-pc_type cholesky -pc_factor_mat_solver_type mumps", "-pc_type lu -ksp_type preonly"})
    expect_same_state(result(3, "petsc", "solve", coarse_in_parts + fmt::format("-- {}", words)), truth, words);
}

TEST_F(DividedRun, WhatPetscFailsInIsSaidOnceInItsWords) {
  write(square + material("0.499999") + open_crack + solver("bdms", 1));
  const auto fails = [&](int code, const std::string& words) {
    const Outcome o =
        kerf(3, "solve a.toml --force --quiet --set 'solver.backend=\"petsc\"'" + coarse_in_parts + words);
    EXPECT_EQ(o.code, code) << words << o.said;
    std::istringstream lines(o.said);
    int said = 0;
    for (std::string line; std::getline(lines, line);) said += line.starts_with("kerf: ") ? 1 : 0;
    EXPECT_EQ(said, 1) << words << o.said;
    return o.said;
  };
  EXPECT_NE(fails(4, "-- -ksp_max_it 1").find("DIVERGED_ITS after 1 iterations"), std::string::npos);
  EXPECT_NE(fails(4, "-- -pc_type jacobi").find("PETSc's solver ends on 3 parts with DIVERGED_ITS"), std::string::npos);
  EXPECT_NE(fails(2, "--set 'solver.petsc=\"-ksp_rtol abc\"'").find("options of PETSc"), std::string::npos);
  EXPECT_NE(fails(2, "-- -pc_type nonsense").find("nonsense"), std::string::npos);
  EXPECT_NE(fails(2, "-- -ksp_no_such 3").find("PETSc has no use here for -ksp_no_such"), std::string::npos);
  EXPECT_NE(fails(2, "-- ksp_rtol 1e-3").find("is no option of PETSc"), std::string::npos);
}

TEST_F(DividedRun, TheUsersOptionsGoBeforeThoseOfTheCase) {
  write(square + material("0.3") + open_crack + solver("bdms", 1));
  const auto said = [&](const std::string& before, const std::string& words) {
    if (!before.empty()) setenv("PETSC_OPTIONS", before.c_str(), 1);
    const Outcome o =
        kerf(3, "solve a.toml --force --quiet --set 'solver.backend=\"petsc\"'" + coarse_in_parts + words);
    unsetenv("PETSC_OPTIONS");
    EXPECT_EQ(o.code, 0) << o.said;
    return o.said;
  };
  const std::string table = said("", "-- -log_view");
  for (const char* event : {"KerfAssembly", "KerfSetUp", "KerfApply", "KSPSolve"})
    EXPECT_NE(table.find(event), std::string::npos) << event;
  const std::string view = said("-ksp_view", "--set 'solver.petsc=\"-ksp_rtol 1e-4\"' -- -ksp_rtol 1e-5");
  EXPECT_NE(view.find("relative=1e-05"), std::string::npos) << view;
  EXPECT_NE(view.find("BDDC of kerf: 3 parts"), std::string::npos) << view;
}

// As srun --mpi=pmix starts them, and as the launcher of another MPI does.
TEST_F(PetscRun, MpiKnowsHowManyThereAre) {
  write(square + material("0.3") + solver("bdms", 1));
  const std::string arguments = "solve a.toml -o out --force --quiet --set 'solver.backend=\"petsc\"'";
  const auto started = [&](const std::string& line) {
    const int status = std::system(
        fmt::format("cd '{}' && {} '{}' {} >said 2>&1", folder.string(), line, KERF_PROGRAM, arguments).c_str());
    return Outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, text("said")};
  };
  const Outcome pmix = started(
      "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpiexec --oversubscribe --bind-to none -n 3 env -u "
      "OMPI_COMM_WORLD_SIZE");
  ASSERT_EQ(pmix.code, 0) << pmix.said;
  EXPECT_EQ(json::parse(std::ifstream(folder / "out" / "result.json"))["state"]["solver"]["parts"], 3);
  for (const char* name : {"PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    const Outcome alone = started(fmt::format("{}=4", name));
    EXPECT_EQ(alone.code, 2) << alone.said;
    EXPECT_NE(alone.said.find("a launcher started 4 processes"), std::string::npos) << alone.said;
  }
}

TEST_F(DividedRun, RunByMpiexecSaysWhatItsPartsTook) {
  write(square + material("0.3") + crack("") + solver("bdms", 1) + "[functional]\nkind = \"compliance\"\n[map]\n");
  const Outcome o =
      kerf(4, "run a.toml -o out --force --threads 1 --set output.vtk=true --set 'solver.backend=\"petsc\"'" +
                  coarse_in_parts);
  ASSERT_EQ(o.code, 0) << o.said;
  EXPECT_NE(o.said.find("4 processes"), std::string::npos) << o.said;
  EXPECT_NE(o.said.find("MB of the others"), std::string::npos) << o.said;
  EXPECT_TRUE(std::filesystem::exists(folder / "out" / "map.pvtu"));
}

TEST_F(DividedRun, LimitsAndForecasts) {
  write(square + material("0.3") + open_crack + solver("bdms", 1));
  const std::string large =
      "solve a.toml -o out --force --threads 1 --set 'solver.backend=\"petsc\"' --set mesh.size=0.02 --set "
      "mesh.refine=2 ";
  const Outcome dry = kerf(2, large + "--dry-run");
  EXPECT_EQ(dry.code, 0) << dry.said;
  EXPECT_NE(dry.said.find("by one process, and less for each of several"), std::string::npos) << dry.said;
  const Outcome slow = kerf(2, large + "--max-seconds 1");
  EXPECT_EQ(slow.code, 4) << slow.said;
  EXPECT_NE(slow.said.find("stopped: it took longer than --max-seconds 1"), std::string::npos) << slow.said;
}

}  // namespace
}  // namespace kerf::petsc_run_test
