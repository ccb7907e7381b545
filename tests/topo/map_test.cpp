// Maps of the topological derivative of the energy against the exact ones of fields with a crack, against values at
// single points, and against a hole that is drilled.

#include "kerf/map.hpp"

#include "kerf/mesher.hpp"
#include "tests/support/exact.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::map_test {
namespace {

const std::filesystem::path data = KERF_TEST_DATA;

const Functional energy_only{"energy", {energy()}};

std::vector<double> energy_map(const Model& m, const State& s, std::span<const Vec2> points) {
  std::vector<double> values;
  for (const MapPoint& p : map_at(analyze(energy_only, m, s), energy_only, {}, points)) values.push_back(p.value);
  return values;
}

struct Solved {
  Model model;
  State state;
};

// [-2, 2]^2 with the crack of the field, exact displacement on the outline.
Solved solved(const exact::ExactField& f, double size, double tip) {
  Shape shape;
  shape.labels = {"outer"};
  shape.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
  if (f.tips.size() == 2) shape.cracks = {{"c", {f.tips[0].at, f.tips[1].at}}};
  Scene scene;
  scene.material = f.material;
  scene.laws.resize(shape.cracks.size());
  scene.supports.push_back(
      {0, false, true, true, [f](const Vec2& x, const Vec2&) { return f.displacement(x, exact::side_of(f, x)); }});
  Model m = prepare(triangulate(shape, {.size = size, .crack_tip_size = tip}), element("bdms"), scene, 2);
  State s = solve(m);
  return {std::move(m), std::move(s)};
}

// Relative to the largest exact value in the group: root mean square and largest in the bulk, largest around tips.
struct MapErrors {
  double mean = 0, bulk = 0, tips = 0;
};
MapErrors errors(const Solved& s, const exact::ExactField& field, const exact::Table& table) {
  double bulk = 0, bulk_size = 0, square = 0;
  int count = 0;
  std::map<std::string, std::pair<double, double>> tips;  // per tip and ring
  std::vector<Vec2> points;
  for (const exact::Row& row : table.rows) points.push_back(row.x);
  const std::vector<double> values = energy_map(s.model, s.state, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const exact::Row& row = table.rows[i];
    const double error = std::abs(values[i] - row.hole);
    if (row.kind == "bulk") {
      bulk = std::max(bulk, error);
      square += error * error;
      ++count;
      bulk_size = std::max(bulk_size, std::abs(row.hole));
    } else if (row.kind.rfind("tip", 0) == 0) {
      double r = 1e9;
      for (const exact::ExactTip& tip : field.tips) r = std::min(r, (row.x - tip.at).norm());
      auto& [worst, size] = tips[row.kind + (r < 0.03 ? " near" : " far")];
      worst = std::max(worst, error);
      size = std::max(size, std::abs(row.hole));
    }
  }
  MapErrors e{std::sqrt(square / count) / bulk_size, bulk / bulk_size, 0};
  for (const auto& [name, pair] : tips)
    if (pair.second > 1e-12) e.tips = std::max(e.tips, pair.first / pair.second);
  return e;
}

class ExactMap : public testing::TestWithParam<const char*> {};

// At the points listed in the reference tables: the bulk, and circles of 0.01 and 0.1 half lengths around the tips.
TEST_P(ExactMap, AgreesAtTheListedPoints) {
  const auto field = exact::table_field(GetParam());
  const exact::Table table = exact::read_table(data / "exact", GetParam());
  std::vector<MapErrors> e;
  for (const double size : {0.2, 0.1, 0.05}) e.push_back(errors(solved(field, size, size / 50), field, table));
  EXPECT_LT(e[2].mean, 0.0015);
  EXPECT_LT(e[2].bulk, 0.006);
  EXPECT_LT(e[2].tips, 0.03);
  EXPECT_LT(e[2].tips, e[0].tips);
}

// Relative L1 error over the body, 0.1 and more from the tips, at the centroids.
TEST_P(ExactMap, ConvergesInTheMean) {
  const auto field = exact::table_field(GetParam());
  std::vector<double> error;
  for (const double size : {0.2, 0.1, 0.05}) {
    const Solved s = solved(field, size, size / 50);
    std::vector<Vec2> centers;
    for (Index t = 0; t < static_cast<Index>(s.model.mesh.triangles.size()); ++t)
      centers.push_back(centroid(s.model.mesh, t));
    const std::vector<double> values = energy_map(s.model, s.state, centers);
    double difference = 0, sum = 0;
    for (std::size_t i = 0; i < centers.size(); ++i) {
      if ((centers[i] - field.tips[0].at).norm() < 0.1 || (centers[i] - field.tips[1].at).norm() < 0.1) continue;
      const double value =
          exact::hole_derivative(field.material, field.stress(centers[i], exact::side_of(field, centers[i])));
      const double weight = area(s.model.mesh, static_cast<Index>(i));
      difference += weight * std::abs(values[i] - value);
      sum += weight * std::abs(value);
    }
    error.push_back(difference / sum);
  }
  EXPECT_LT(error[2], 6e-4);
  // The error comes from the tip, whose edges shrink like h: order 1.
  EXPECT_GT(std::log2(error[0] / error[2]) / 2, 1) << error[0] << ' ' << error[1] << ' ' << error[2];
}

INSTANTIATE_TEST_SUITE_P(Tables, ExactMap,
                         testing::Values("c01_modeI", "c02_modeII", "c03_inclined_open", "c04_inclined_closed",
                                         "c05_partial_linear", "c05_partial_linear_w", "c05b_partial_general"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Map, EverywhereAgreesWithPointwiseAndIsNaNOutside) {
  const auto field = exact::table_field("c05_partial_linear");
  const Solved s = solved(field, 0.2, 0.05);
  const Corners corners = split_at_cracks(s.model.mesh);
  const FullMap map = map_everywhere(analyze(energy_only, s.model, s.state), energy_only, {}, corners);
  std::vector<Vec2> centers;
  for (Index t = 0; t < static_cast<Index>(s.model.mesh.triangles.size()); ++t)
    centers.push_back(centroid(s.model.mesh, t));
  const std::vector<double> values = energy_map(s.model, s.state, centers);
  for (std::size_t i = 0; i < centers.size(); ++i)
    ASSERT_DOUBLE_EQ(values[i], map.at_centroids[static_cast<Eigen::Index>(i)]);
  EXPECT_EQ(map.at_corners.size(), static_cast<Eigen::Index>(corners.vertex.size()));
  EXPECT_TRUE(map.at_corners.allFinite());
  EXPECT_TRUE(std::isnan(energy_map(s.model, s.state, std::vector<Vec2>{{3, 0}})[0]));
}

// Of the displacement, too: of the state, the measured one and the adjoint. Where that is constant per triangle, its
// mean and gradient stand for what is recovered from both at points.
TEST(Map, OfDisplacementsEverywhereAgreesWithPointwise) {
  scenes::Body b{scenes::rectangle({-1, -1}, {1, 1}), scenes::pulled(plane_strain(1, 0.3), scenes::opens)};
  b.scene.laws.clear();
  b.scene.body = [](const Vec2& x) { return Vec2(0.3, -0.5 + 0.2 * x.x()); };
  const Functional j{"",
                     {displacement_tracking({}, {}), stress_power(2, {}, true),
                      misfit(2, [](const Vec2& x, const Vec2&) { return Vec2(0.1, 1 + x.x()); })}};
  for (const int degree : {1, 2}) {
    const Model m = prepare(triangulate(b.shape, {.size = 0.3}), element("bdms", degree), b.scene, 1);
    const State s = solve(m);
    const Analysis a = analyze(j, m, s);
    std::vector<Vec2> centers;
    for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) centers.push_back(centroid(m.mesh, t));
    for (const Perturbation& p : {Perturbation{}, Perturbation{.kind = Perturbation::Kind::Ellipse, .aspect = 2}}) {
      const FullMap map = map_everywhere(a, j, {.perturbation = p}, split_for_stress(m.mesh));
      const std::vector<MapPoint> at = map_at(a, j, {.perturbation = p}, centers);
      EXPECT_EQ(map.angle.size(), p.aspect > 1 ? map.at_centroids.size() : 0);
      const double largest = map.at_centroids.cwiseAbs().maxCoeff();
      for (std::size_t t = 0; t < centers.size(); ++t) {
        const auto i = static_cast<Eigen::Index>(t);
        EXPECT_NEAR(map.at_centroids[i], at[t].value, (degree == 1 ? 5e-3 : 1e-12) * largest) << centers[t].transpose();
        if (degree == 2 && p.aspect > 1) {
          EXPECT_EQ(map.angle[i], at[t].angle);
        }
      }
    }
  }
}

TEST(Map, BarsHoldTheExactValueBesideACrack) {
  const auto field = exact::table_field("c01_modeI");
  const exact::Table table = exact::read_table(data / "exact", "c01_modeI");
  Shape shape;
  shape.labels = {"outer"};
  shape.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
  shape.cracks = {{"c", {field.tips[0].at, field.tips[1].at}}};
  const Sizing sizing{.size = 0.4, .crack_tip_size = 0.1};
  const Solved s = solved(field, sizing.size, sizing.crack_tip_size);
  const Analysis a = analyze(energy_only, s.model, s.state);
  std::vector<Vec2> points{{3, 0}};  // outside
  std::vector<double> exact{nan};
  for (const exact::Row& row : table.rows)
    if (row.kind == "bulk") points.push_back(row.x), exact.push_back(row.hole);
  FullMap map = map_everywhere(a, energy_only, {}, split_for_stress(s.model.mesh));
  std::vector<MapPoint> at = map_at(a, energy_only, {}, points);
  add_bars(a, energy_only, {}, {shape, sizing}, {map, at});
  EXPECT_FALSE(at[0].lower || at[0].upper);
  EXPECT_TRUE((map.lower.array() <= map.upper.array()).all());
  int held = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    ASSERT_TRUE(at[i].lower && at[i].upper);
    held += *at[i].lower <= exact[i] && exact[i] <= *at[i].upper;
  }
  EXPECT_GE(held, 0.95 * static_cast<double>(points.size() - 1));
}

// The whole claim, by brute force: drill a small hole into a body with a partly closed crack and compare energies. The
// disc is an outline of both meshes' constraints only once drilled, so the sizes are fine and the tolerance is a few
// percent.
TEST(Map, PredictsTheEnergyOfADrilledBody) {
  const auto energy = [](bool drilled, double radius, double* map_value) {
    Shape shape;
    shape.labels = {"side", "bottom", "top", "hole"};
    shape.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
    shape.outline.sides[0].label = 1;
    shape.outline.sides[2].label = 2;
    shape.cracks = {{"c", {Vec2(-1, 0), Vec2(1, 0)}}};
    const Vec2 at(0.9, 0.7);
    if (drilled) shape.holes = {circle("h", at, radius, 3)};
    Scene scene;
    scene.material = plane_strain(1, 0.3);
    scene.laws.resize(1);
    scene.supports.push_back({1, false, true, true, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }});
    scene.tractions.push_back({2, [](const Vec2& x, const Vec2&) { return Vec2(0, 0.3 + x.x()); }});
    Model m = prepare(triangulate(shape, {.size = 0.02, .crack_tip_size = 0.002}), element("bdms"), scene, 2);
    const State s = solve(m);
    if (map_value) *map_value = energy_map(m, s, std::vector<Vec2>{at})[0];
    return potential_energy(m, s);
  };
  double coefficient = 0;
  const double whole = energy(false, 0, &coefficient);
  const double radius = 0.06;
  const double measured = (energy(true, radius, nullptr) - whole) / (std::acos(-1) * radius * radius);
  EXPECT_NEAR(measured / coefficient, 1, 0.05);
}

}  // namespace
}  // namespace kerf::map_test
