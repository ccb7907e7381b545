// Every job on a mesh that gmsh wrote, and what it leaves for other programs.

#include "app/command/mesh.hpp"
#include "app/run.hpp"
#include "io/mesh_source.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/mesher.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace kerf::mesh_file_run_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class MeshFileRun : public test::InFolder {
 protected:
  Case plate(const std::string& more, const std::string& mesh = (fs::path(KERF_TEST_DATA) / "meshes/gmsh41.msh")) {
    std::ofstream(folder / "a.toml") << "[domain]\nfile = '" << mesh << "'\n[material]\nyoung = 1\npoisson = 0.3\n"
                                     << "[[region]]\nname = 'stiff'\nyoung = 5\npoisson = 0.3\n"
                                     << "[[boundary]]\non = 'left'\ndisplacement = [0, 0]\n"
                                     << "[[boundary]]\non = 'right'\ntraction = [0.2, 1]\n"
                                     << "[output]\nvtk = false\npng = false\nhtml = false\n"
                                     << more;
    return read_case(folder / "a.toml");
  }
  json run_job(const Case& c, Job job) {
    run(c, job, {.folder = folder / "out", .threads = 2});
    std::ifstream file(folder / "out" / "result.json");
    return json::parse(file);
  }
};

// Lame's ring of radii 1 and 2 under inner pressure, its mesh through files of first and of second order: the largest
// von Mises stress of plane strain is 2.3132.
TEST_F(MeshFileRun, SecondOrderKeepsTheCurves) {
  Shape ring{circle("outline", {0, 0}, 2, 0), {}, {}, {"rim", "hole"}, {}};
  ring.holes.push_back(circle("hole", {0, 0}, 1, 1));
  Mesh mesh = triangulate(ring, {.size = 0.2, .curved = true});
  const auto solved = [&](const std::string& more) {
    write_mesh(folder / "ring.msh", mesh, ring);
    std::ofstream(folder / "ring.toml") << "[domain]\nfile = 'ring.msh'\n[material]\nyoung = 1000\npoisson = 0.3\n"
                                        << "[[boundary]]\non = 'hole'\npressure = 1\n"
                                        << "[output]\nvtk = false\npng = false\nhtml = false\n"
                                        << more;
    return run(read_case(folder / "ring.toml"), Job::Solve, {.folder = folder / "out"});
  };
  const auto says = [](const Result& r, const std::string& words) {
    return std::ranges::any_of(r.state->notes, [&](const std::string& n) { return n.find(words) != n.npos; });
  };
  constexpr double t = 5.0 / 3, z = 0.3 * (t - 1);
  const double exact = std::sqrt(((t + 1) * (t + 1) + (1 + z) * (1 + z) + (z - t) * (z - t)) / 2);
  const Result curved = solved("");
  const PlacedValue& peak = curved.state->von_mises->largest;
  EXPECT_NEAR(peak.value, exact, *peak.margin);
  EXPECT_LT(*peak.margin, 5e-3 * exact);
  EXPECT_FALSE(says(curved, "Mesh.ElementOrder"));
  EXPECT_GT(solved("[mesh]\ncurved = false\n").state->von_mises->largest.value, 1.02 * exact);
  const Result divided = solved("[mesh]\nrefine = 1\n");
  EXPECT_NEAR(divided.state->von_mises->largest.value, exact, 5e-4 * exact);
  EXPECT_NEAR(divided.state->area, 3 * pi, 1e-6);
  mesh.arc.clear();
  mesh.arcs.clear();
  const Result chords = solved("");
  EXPECT_GT(chords.state->von_mises->largest.value, 1.02 * exact);
  EXPECT_TRUE(says(chords, "Mesh.ElementOrder = 2"));
}

TEST_F(MeshFileRun, TheStateIsOnTheMeshOfTheFile) {
  const json r = run_job(plate("[[crack]]\nname = 'c'\ncontact = 'open'\n"), Job::Map);
  EXPECT_EQ(r["status"], "ok");
  EXPECT_EQ(r["mesh"]["triangles"], 554);
  EXPECT_TRUE(r.contains("map"));
}

TEST_F(MeshFileRun, WithContactToo) {
  const json r = run_job(plate(""), Job::Solve);
  EXPECT_EQ(r["mesh"]["triangles"], 554);  // not graded where contact ends
  EXPECT_LT(r["contact"]["kkt"].get<double>(), 1e-10);
}

// A bent plate: the crack opens at one end, closes at the other.
TEST_F(MeshFileRun, OtherMeshesOfTheBodyAreGradedWhereContactEndsOnIt) {
  const Case c = plate("[[boundary]]\non = 'top'\ntraction = ['x > -0.2 ? 0 : 0.3', 'x > -0.2 ? -0.4 : 0.5']\n");
  const Adapted a = solve_graded(c.shape, c.sizing, c.element, c.scene, {.given = c.mesh});
  EXPECT_EQ(a.model.mesh.triangles, c.mesh->triangles);
  ASSERT_FALSE(contact_ends(a.model, a.state).empty());
  EXPECT_EQ(a.sizing.ends.size(), contact_ends(a.model, a.state).size());
}

TEST_F(MeshFileRun, AdaptiveMeshesBeginWithIt) {
  const json r =
      run_job(plate("[[crack]]\nname = 'c'\ncontact = 'open'\n[mesh]\nadapt = { error = 0.03 }\n"), Job::Solve);
  EXPECT_EQ(r["mesh"]["adapt"]["rounds"][0]["triangles"], 554);
  EXPECT_EQ(r["mesh"]["adapt"]["stopped"].get<std::string>().substr(0, 7), "reached");
}

TEST_F(MeshFileRun, ErrorBarsAndValidationMeshTheBodyAnew) {
  const json r = run_job(plate("[mesh]\nsize = 0.1\n[map]\nbounds = true\npoints = [[-0.2, -0.6]]\n[validate]\n"
                               "points = [[-0.2, -0.6]]\nradii = { largest = 0.1, ratio = 0.5, count = 5 }\n"
                               "[[crack]]\nname = 'c'\ncontact = 'bonded'\n"),
                         Job::Run);
  EXPECT_EQ(r["mesh"]["triangles"], 554);
  const json& point = r["map"]["points"][0];
  EXPECT_LT(point["lower"].get<double>(), point["upper"].get<double>());
  EXPECT_EQ(r["validate"][0]["verdict"], "holds") << r["validate"][0]["reason"];
}

TEST_F(MeshFileRun, OptimizationBeginsWithItsOutline) {
  const json r = run_job(plate("[mesh]\nsize = 0.2\n[[crack]]\nname = 'c'\ncontact = 'bonded'\n[functional]\nkind = "
                               "'compliance'\n[optimize]\nvolume = { at_most = 0.8 }\nmax_iterations = 3\n"),
                         Job::Optimize);
  EXPECT_LT(r["optimize"]["volume_fraction"].get<double>(), 0.99);
  const MeshFile design = read_mesh(folder / "out" / "design.msh", {.materials = {"stiff"}});
  EXPECT_EQ(json(design.mesh.triangles.size()), r["mesh"]["triangles"]);
  EXPECT_EQ(design.shape.regions.size(), 1u);
  EXPECT_EQ(fs::exists(folder / "out" / "design.step"), has_gmsh());
  const Case again = read_case(folder / "out" / "design.toml");
  EXPECT_FALSE(again.mesh);
  EXPECT_EQ(find_problem(again.shape), std::nullopt);
}

TEST_F(MeshFileRun, RegionsThatTouchTheOutlineAreMeshedAnew) {
  // Two halves: the right one stiff.
  std::ofstream(folder / "halves.msh")
      << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"left\"\n1 2 \"right\"\n2 3 \"stiff\"\n"
         "$EndPhysicalNames\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 2 1 0\n5 1 1 0\n6 0 1 0\n$EndNodes\n$Elements\n6\n"
         "1 1 2 1 1 6 1\n2 1 2 2 2 3 4\n3 2 2 0 1 1 2 5\n4 2 2 0 1 1 5 6\n5 2 2 3 2 2 3 4\n6 2 2 3 2 2 4 5\n"
         "$EndElements\n";
  const std::string validate = "[validate]\npoints = [[0.5, 0.5]]\nradii = [0.1, 0.05, 0.02]\n";
  const Case c = plate(validate, folder / "halves.msh");
  EXPECT_EQ(run_job(c, Job::Solve)["mesh"]["triangles"], 4);
  run(c, Job::Validate, {.folder = folder / "out", .threads = 1});
  EXPECT_TRUE(fs::exists(folder / "out" / "validate.csv"));
  EXPECT_EQ(check(c).find("kerf cannot mesh this body anew"), std::string::npos);
}

TEST_F(MeshFileRun, MeshesGoOut) {
  const Case c = read_case(fs::path(KERF_CASES) / "stiff_inclusion.toml");
  write_mesh_of(c, folder / "x.msh", "4.1");
  write_mesh_of(c, folder / "x.vtu", "");
  const Mesh mesh = triangulate(c.shape, c.sizing);
  MeshFileRequest request;
  for (const Loop& region : c.shape.regions) request.materials.push_back(region.name);
  const MeshFile back = read_mesh(folder / "x.msh", request);
  EXPECT_EQ(back.mesh.points.size(), mesh.points.size());
  // Those of a surface stand behind one another in the file.
  const auto by_region = [](const Mesh& m) {
    std::vector<std::pair<Index, std::array<Index, 3>>> all;
    for (std::size_t t = 0; t < m.triangles.size(); ++t) all.emplace_back(m.region[t], m.triangles[t]);
    std::ranges::sort(all);
    return all;
  };
  EXPECT_EQ(by_region(back.mesh), by_region(mesh));
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    EXPECT_EQ(back.mesh.label[e] == none ? "" : back.shape.labels[back.mesh.label[e]],
              mesh.label[e] == none ? "" : c.shape.labels[mesh.label[e]]);
  std::ifstream file(folder / "x.vtu", std::ios::binary);
  const std::string vtu{std::istreambuf_iterator<char>(file), {}};
  for (const std::string& label : c.shape.labels) EXPECT_NE(vtu.find("Name=\"" + label + "\""), std::string::npos);
  EXPECT_NE(vtu.find("Name=\"region\""), std::string::npos);
  EXPECT_THROW(write_mesh_of(c, folder / "x.stl", ""), Error);
}

TEST_F(MeshFileRun, ExitCodesOfTheProgram) {
  const auto code = [&](const std::string& arguments) {
    return WEXITSTATUS(std::system((std::string(KERF_PROGRAM) + " " + arguments + " > /dev/null 2>&1").c_str()));
  };
  plate("");
  const std::string a = folder / "a.toml", out = folder / "x.msh";
  EXPECT_EQ(code("mesh " + a + " -o " + out), 0);
  EXPECT_EQ(code("mesh " + a + " -o " + out), 5);  // it is there
  EXPECT_EQ(code("mesh " + a + " -o " + out + " --force --format 2.2"), 0);
  EXPECT_EQ(code("mesh " + a + " -o " + (folder / "x.stl").string()), 2);
  EXPECT_EQ(code("mesh " + a + " --format 3 -o " + out), 2);
  std::ofstream(folder / "bad.msh") << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n";
  EXPECT_THROW(plate("", folder / "bad.msh"), Error);
  EXPECT_EQ(code("check " + a), 3);
  EXPECT_THROW(plate("", folder / "none.msh"), Error);
  EXPECT_EQ(code("check " + a), 5);
}

}  // namespace
}  // namespace kerf::mesh_file_run_test
