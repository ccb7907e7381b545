// Meshes that other programs wrote, through domain.file, against the same triangulation put together here: read by
// these few lines, labels from coordinates, the scene by hand.

#include "kerf/case_file.hpp"
#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "kerf/state.hpp"
#include "tests/truth/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

namespace kerf::mesh_file_test {
namespace {

namespace fs = std::filesystem;

struct Plain {
  std::vector<Vec2> points;
  std::vector<std::array<Index, 3>> triangles;
};

/// Points by their places, which glues doubled faces; whatever is no triangle is left out.
Plain read_plainly(const fs::path& path) {
  std::ifstream in(path);
  Plain out;
  std::map<std::pair<double, double>, Index> places;
  std::map<long, Index> vertex;
  const auto add = [&](long tag, double x, double y) {
    const auto [place, fresh] = places.emplace(std::pair(x, y), Index(out.points.size()));
    if (fresh) out.points.emplace_back(x, y);
    vertex[tag] = place->second;
  };
  std::string word;
  bool four = false;
  while (in >> word) {
    if (word == "4.1") four = true;
    if (word == "$Nodes" && !four) {
      long n, tag;
      double x, y, z;
      for (in >> n; n-- > 0;) {
        in >> tag >> x >> y >> z;
        add(tag, x, y);
      }
    } else if (word == "$Nodes") {
      long blocks, n, skip;
      in >> blocks >> n >> skip >> skip;
      while (blocks-- > 0) {
        in >> skip >> skip >> skip >> n;
        std::vector<long> tags(static_cast<std::size_t>(n));
        for (long& tag : tags) in >> tag;
        double x, y, z;
        for (const long tag : tags) {
          in >> x >> y >> z;
          add(tag, x, y);
        }
      }
    } else if (word == "$Elements") {
      std::string line;
      std::getline(in, line);
      std::getline(in, line);
      long type = 0, left = 0;
      while (std::getline(in, line) && line.front() != '$') {
        std::istringstream numbers(line);
        std::vector<long> v;
        for (long x; numbers >> x;) v.push_back(x);
        if (four && left == 0) {
          type = v[2], left = v[3];
          continue;
        }
        if (four) --left;
        if ((four ? type : v[1]) != 2) continue;
        out.triangles.push_back({vertex[v[v.size() - 3]], vertex[v[v.size() - 2]], vertex[v[v.size() - 1]]});
      }
    }
  }
  for (auto& t : out.triangles) {
    const Vec2 p = out.points[t[1]] - out.points[t[0]], q = out.points[t[2]] - out.points[t[0]];
    if (cross(p, q) < 0) std::swap(t[1], t[2]);
  }
  return out;
}

struct Scenario {
  std::string name;
  Vec2 high;                // the outline is [-high, high]; left and right are labels 0 and 1
  std::string left, right;  // in the file
  std::optional<std::pair<Vec2, Vec2>> crack;
  bool stiff;  // in [-1.6, -1.2] x [-0.7, -0.3]
};

struct Numbers {
  double energy;
  std::vector<double> K;
};

Numbers solve_here(const Scenario& s) {
  Plain plain = read_plainly(fs::path(KERF_TEST_DATA) / "meshes" / (s.name + ".msh"));
  std::vector<Index> region;
  if (s.stiff)
    for (const auto& t : plain.triangles) {
      const Vec2 x = (plain.points[t[0]] + plain.points[t[1]] + plain.points[t[2]]) / 3;
      region.push_back(std::abs(x.x() + 1.4) < 0.2 && std::abs(x.y() + 0.5) < 0.2 ? 0 : none);
    }
  const Mesh bare = connect(plain.points, plain.triangles, {});
  std::vector<Marked> marked;
  std::vector<std::pair<double, Marked>> on_crack;
  for (std::size_t e = 0; e < bare.edges.size(); ++e) {
    const auto [a, b] = bare.edges[e];
    const Vec2 x = (bare.points[a] + bare.points[b]) / 2;
    const bool rim = bare.sides[e][0] == none || bare.sides[e][1] == none;
    if (rim && std::abs(std::abs(x.x()) - s.high.x()) < 1e-9) marked.push_back({a, b, x.x() < 0 ? 0 : 1, none});
    if (!s.crack || rim) continue;
    const Vec2 along = s.crack->second - s.crack->first, from = x - s.crack->first;
    const double t = from.dot(along) / along.squaredNorm();
    const auto off = [&](Index v) { return std::abs(cross(along, bare.points[v] - s.crack->first)); };
    if (t < 0 || t > 1 || off(a) > 1e-9 || off(b) > 1e-9) continue;
    const bool forward = (bare.points[b] - bare.points[a]).dot(along) > 0;
    on_crack.push_back({t, {forward ? a : b, forward ? b : a, none, 0}});
  }
  std::sort(on_crack.begin(), on_crack.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
  for (const auto& [t, edge] : on_crack) marked.push_back(edge);
  const auto constant = [](const Vec2& v) { return [v](const Vec2&, const Vec2&) { return v; }; };
  Scene scene{.material = plane_strain(1, 0.3)};
  if (s.stiff) scene.regions = {plane_strain(10, 0.3)};
  if (s.crack) scene.laws = {{.kind = CrackLaw::Kind::Open}};
  scene.supports = {{.label = 0, .value = constant(Vec2(0, 0))}};
  scene.tractions = {{.label = 1, .value = constant(Vec2(0.5, 1))}};
  const Model model = prepare(connect(plain.points, plain.triangles, marked, region), bdms(2), scene, 1);
  const State state = solve(model);
  Numbers out{potential_energy(model, state), {}};
  for (const TipIntensity& tip : crack_tips(model, state)) out.K.insert(out.K.end(), {tip.K_I, tip.K_II});
  return out;
}

std::string case_text(const Scenario& s) {
  std::string text = "[domain]\nfile = '" + (fs::path(KERF_TEST_DATA) / "meshes" / (s.name + ".msh")).string() + "'\n";
  text += "[material]\nyoung = 1\npoisson = 0.3\n[[boundary]]\non = '" + s.left + "'\ndisplacement = [0, 0]\n";
  text += "[[boundary]]\non = '" + s.right + "'\ntraction = [0.5, 1]\n";
  if (s.crack) text += "[[crack]]\nname = 'c'\ncontact = 'open'\n";
  if (s.stiff) text += "[[region]]\nname = 'stiff'\nyoung = 10\npoisson = 0.3\n";
  return text;
}

using MeshFileTruth = Truth;

TEST_F(MeshFileTruth, EnergyAndIntensitiesAreThoseOfTheSameTriangulationBuiltHere) {
  const std::pair<Vec2, Vec2> plate_crack{{-0.8, 0}, {0.4, 0.1}}, grid_crack{{-0.5, 0}, {0.4, 0}};
  const std::vector<Scenario> scenarios = {{"gmsh22", {2, 1}, "left", "right", plate_crack, true},
                                           {"gmsh41", {2, 1}, "left", "right", plate_crack, true},
                                           {"gmsh_crack", {2, 1}, "left", "right", plate_crack, true},
                                           {"freefem", {2, 1}, "4", "2", {}, false},
                                           {"meshio", {1, 0.6}, "left", "right", grid_crack, false}};
  for (const Scenario& s : scenarios) {
    SCOPED_TRACE(s.name);
    const Numbers here = solve_here(s);
    const nlohmann::json r = run_scene(case_text(s));
    EXPECT_NEAR(r["state"]["energy"].get<double>(), here.energy, 1e-10 * std::abs(here.energy));
    std::vector<double> K;
    const nlohmann::json cracks = r.value("cracks", nlohmann::json::array());
    for (const auto& crack : cracks)
      for (const auto& tip : crack["tips"]) K.insert(K.end(), {tip["K_I"].get<double>(), tip["K_II"].get<double>()});
    ASSERT_EQ(K.size(), here.K.size());
    double size = 0;
    for (const double k : here.K) size = std::max(size, std::abs(k));
    for (std::size_t i = 0; i < K.size(); ++i) EXPECT_NEAR(K[i], here.K[i], 1e-10 * size);
  }
}

// The plate of gmsh's geometry against the same plate drawn in the case.
TEST_F(MeshFileTruth, AGeometryIsTheBodyThatItDraws) {
#ifndef KERF_WITH_GMSH
  GTEST_SKIP() << "built without gmsh";
#endif
  const std::string rest =
      "[material]\nyoung = 1\npoisson = 0.3\n[[boundary]]\non = 'left'\ndisplacement = [0, 0]\n[[boundary]]\non = "
      "'right'\ntraction = [1, 0.1]\n[mesh]\nsize = 0.15\n[solver]\nelement = 'bdms'\ndegree = 2\n";
  const std::string law = "[[crack]]\nname = 'c'\ncontact = 'open'\n", stiff = "young = 10\npoisson = 0.3\n";
  const auto geometry = fs::path(KERF_TEST_DATA) / "meshes" / "plate.geo";
  const nlohmann::json read =
      run_scene("[domain]\nfile = '" + geometry.string() + "'\n" + rest + law + "[[region]]\nname = 'stiff'\n" + stiff);
  const nlohmann::json drawn = run_scene(
      "[domain]\noutline = [[-2, -1], [2, -1], [2, 1], [-2, 1]]\nsides = ['bottom', 'right', 'top', 'left']\n[[hole]]\n"
      "name = 'h'\ncircle = { center = [1.2, 0.2], radius = 0.3 }\n" +
      rest + law +
      "path = [[-0.8, 0], [0.4, 0.1]]\n[[region]]\nname = 'stiff'\npolygon = [[-1.6, -0.7], [-1.2, -0.7], "
      "[-1.2, -0.3], [-1.6, -0.3]]\n" +
      stiff);
  const double energy = drawn["state"]["energy"].get<double>();
  EXPECT_NEAR(read["state"]["energy"].get<double>(), energy, 1e-4 * std::abs(energy));
  for (const int tip : {0, 1}) {
    const auto K = [&](const nlohmann::json& r) { return r["cracks"][0]["tips"][tip]["K_I"].get<double>(); };
    EXPECT_NEAR(K(read), K(drawn), 2e-3 * std::abs(K(drawn)));
  }
}

// A crack along an arc, which the file knows only by chords: closed faces that slide must not interlock at its corners.
TEST_F(MeshFileTruth, FacesSlideAlongChordsOfACurveAsAlongTheCurve) {
  Shape shape;
  shape.labels = {"outer"};
  shape.outline = polygon("outline", {{-3, -3}, {3, -3}, {3, 3}, {-3, 3}}, 0);
  shape.cracks = {arc_crack("c", {0, 0}, 1, -pi / 3, pi / 3)};
  const Mesh mesh = triangulate(shape, {.size = 0.6, .crack_tip_size = 0.1});
  write_mesh(folder / "arc.msh", mesh, shape);
  const nlohmann::json r = run_scene(
      "[domain]\nfile = 'arc.msh'\n[material]\nyoung = 1\npoisson = 0.3\n[[boundary]]\non = 'outer'\ntraction = "
      "['-nx', '-0.2 * ny']\n");
  const auto energy = [&](std::function<Vec2(const Vec2&)> normal) {
    Scene scene{.material = plane_strain(1, 0.3)};
    scene.laws = {{.normal = std::move(normal)}};
    scene.tractions = {{.label = 0, .value = [](const Vec2&, const Vec2& n) { return Vec2(-n.x(), -0.2 * n.y()); }}};
    const Model model = prepare(mesh, bdms(2), scene, 1);
    return potential_energy(model, solve(model));
  };
  const double curve = energy([](const Vec2&x) { return x.normalized().eval(); }), chords = energy({});
  EXPECT_GT(r["contact"]["closed_length"].get<double>(), 0.5);
  EXPECT_LT(std::abs(r["state"]["energy"].get<double>() - curve), 0.05 * std::abs(chords - curve))
      << "curve " << curve << ", chords " << chords;
}

}  // namespace
}  // namespace kerf::mesh_file_test
