// backend = "petsc" on one, two and four processes: the same numbers as by the factor of one.

#include "tests/support/folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

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

  /// By `count` processes; 0: without mpiexec.
  Outcome kerf(int count, const std::string& arguments) const {
    const std::string mpiexec =
        count == 0 ? ""
                   : fmt::format(
                         "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpiexec --oversubscribe "
                         "--bind-to none -n {} ",
                         count);
    const int status = std::system(fmt::format("cd '{}' && OPENBLAS_NUM_THREADS=1 {} '{}' {} >said 2>&1",
                                               folder.string(), mpiexec, KERF_PROGRAM, arguments)
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
        kerf(count, fmt::format("{} a.toml -o {} --force --threads 1 --quiet --set 'solver.backend=\"{}\"' {}", command,
                                out, backend, more));
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
  for (const Row& row : {Row{"bdms", 2, "0.4999"}, Row{"bdms", 3, "0.3"}, Row{"afw", 1, "0.499999"},
                         Row{"afw", 2, "0.5"}, Row{"arnold-winther-nc", 1, "0.3"}}) {
    write(square + material(row.poisson) + solver(row.element, row.degree));
    expect_same_state(result(4, "petsc"), result(0, "cholmod"),
                      fmt::format("{} {}, nu = {}", row.element, row.degree, row.poisson));
  }
}

TEST_F(PetscRun, RegionsOfContrastAndCracksAcrossParts) {
  write(square + material("0.3") + solver("bdms", 1) + R"([[region]]
name = "stiff"
circle = { center = [0.5, 0.5], radius = 0.23 }
young = 1e4
poisson = 0.2
[[crack]]
name = "long"
path = [[0.1, 0.87], [0.9, 0.83]]
contact = "open"
[[crack]]
name = "tall"
path = [[0.86, 0.1], [0.82, 0.7]]
contact = "open"
)");
  expect_same_state(result(4, "petsc"), result(0, "cholmod"), "contrast");
}

TEST_F(PetscRun, Contact) {
  write(square + material("0.3") + solver("bdms", 1) + R"([[crack]]
name = "c"
path = [[0.2, 0.3], [0.8, 0.62]]
friction = 0.2
)");
  const json truth = result(0, "cholmod"), r = result(2, "petsc");
  expect_same_state(r, truth, "contact");
  EXPECT_EQ(r["contact"]["closed_length"], truth["contact"]["closed_length"]);
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

TEST_F(PetscRun, OptionsReachPetsc) {
  write(square + material("0.3"));
  // On two parts the weights of both sides make the preconditioner exact.
  const json loose = result(4, "petsc", "solve", "--set 'solver.petsc=\"-ksp_rtol 1e-4\"'"), tight = result(4, "petsc");
  EXPECT_LT(loose["state"]["solver"]["iterations"], tight["state"]["solver"]["iterations"]);
  expect_same_state(loose, tight, "rounds make up for loose solves");
}

}  // namespace
