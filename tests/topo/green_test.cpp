#include "topo/green.hpp"

#include "geometry/mesher.hpp"
#include "topo/map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kerf {
namespace {

constexpr double pi = std::numbers::pi;

struct Solved {
  Model model;
  State state;
};
Solved solved(const Shape& shape, const Sizing& sizing, const Scene& scene) {
  Model m = prepare(triangulate(shape, sizing), element("bdms", 2), scene, 1);
  State s = solve(m);
  return {std::move(m), std::move(s)};
}

BoundaryField constant(const Vec2& value) {
  return [value](const Vec2&, const Vec2&) { return value; };
}

Index triangle_at(const Model& m, const Vec2& x) {
  return locate(m.mesh, std::vector<Vec2>{x})[0];
}

Green green_at(const Solved& s, const Vec2& x) {
  return GreenTensor(s.model, s.state).at(x, triangle_at(s.model, x), false);
}

double predicted(const Solved& s, const Functional& j, double eps, const Vec2& x) {
  const Analysis a = analyse(j, s.model, s.state);
  const MapRequest r{.perturbation = {.kind = Perturbation::Kind::ClampedHole}, .radius = eps};
  return map_at(a, j, r, std::vector<Vec2>{x})[0].value;
}

class Disc : public testing::TestWithParam<Material> {};

// Unit disc, held on its rim: Hreg at the center is -(1/k + 1/2)/(2 pi mu (1 + k)) I.
TEST_P(Disc, GreensTensorAtTheCenterIsExact) {
  const Material material = GetParam();
  Shape shape;
  shape.labels = {"rim"};
  shape.outline = circle("rim", {0, 0}, 1, 0);
  Scene scene{.material = material};
  scene.supports.push_back({0, false, true, true, constant({0.8, 0})});
  const Solved s = solved(shape, {.size = 0.15}, scene);
  const double k = 1 + 8 * material.mu * material.c, f = 1 / (2 * pi * material.mu * (1 + k));
  const Mat2 H = green_at(s, {0, 0}).regular;
  EXPECT_LT((H + (1 / k + 0.5) * f * Mat2::Identity()).norm() / H.norm(), 1e-5) << H;
  // The force on a clamp at the center of the disc, u0 on the rim: F = 2 pi mu (1 + k) u0/(k ln(1/eps) - 1/k).
  for (const double eps : {0.1, 0.0125})
    EXPECT_NEAR(predicted(s, {"energy", {energy()}}, eps, {0, 0}) / (0.5 * 0.64 / f / (k * std::log(1 / eps) - 1 / k)),
                1, 1e-5);
}
INSTANTIATE_TEST_SUITE_P(Materials, Disc,
                         testing::Values(plane_stress(1, 0.3), plane_strain(1, 0.3), plane_strain(1, 0.49),
                                         plane_strain(1, 0.499999), plane_strain(1, 0.5)));

// [0, 2] x [0, 1] held at x = 0, pulled at x = 2; the hole at (0.8, 0.35) [topological_derivatives.json,
// clamped_hole_cantilever].
struct Reference {
  Material material;
  double h11, h12, h22;
  Vec2 u0;
  double energy[3], track[3];  // at radius 0.08, 0.01, 0.001
};
class Cantilever : public testing::TestWithParam<Reference> {};

TEST_P(Cantilever, AgreesWithFiniteElements) {
  const Reference& r = GetParam();
  Shape shape;
  shape.labels = {"side", "held", "pulled"};
  shape.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0);
  shape.outline.sides[1].label = 2;
  shape.outline.sides[3].label = 1;
  Scene scene{.material = r.material};
  scene.supports.push_back({1, false, true, true, constant({0, 0})});
  scene.tractions.push_back({2, constant({0.3, -1})});
  const Solved s = solved(shape, {.size = 0.08}, scene);
  const Vec2 x(0.8, 0.35);
  const Mat2 H = green_at(s, x).regular;
  Mat2 reference;
  reference << r.h11, r.h12, r.h12, r.h22;
  std::printf("H %g\n", (H - reference).norm() / reference.norm());
  EXPECT_LT((H - reference).norm() / reference.norm(), 1e-4) << H;
  EXPECT_NEAR(H(0, 1), H(1, 0), 1e-5);
  const double radius[3] = {0.08, 0.01, 0.001};
  const Functional tracking{"displacement_tracking", {displacement_tracking({}, {})}};
  for (int i = 0; i < 3; ++i) {
    const double e = predicted(s, {"energy", {energy()}}, radius[i], x);
    std::printf("energy %g %.9g\n", e / r.energy[i] - 1, e);
    EXPECT_NEAR(e / r.energy[i], 1, 1e-4);
    EXPECT_NEAR(predicted(s, {"compliance", {compliance()}}, radius[i], x) / (-2 * e), 1, 1e-12);
    const double t = predicted(s, tracking, radius[i], x);
    std::printf("track %g %.9g\n", t / r.track[i] - 1, t);
    EXPECT_NEAR(t / r.track[i], 1, 2e-4);
  }
}
INSTANTIATE_TEST_SUITE_P(Materials, Cantilever,
                         testing::Values(Reference{plane_stress(1, 0.3),
                                                   0.4467818740835017,
                                                   0.5404228613540413,
                                                   3.740579494643269,
                                                   {-1.9563256668590494, -8.861662230382922},
                                                   {9.046740235552319, 8.004047651149852, 7.106653347612698},
                                                   {-302.45004494641546, -280.53234949554167, -258.9680542385279}},
                                         Reference{plane_strain(1, 0.3),
                                                   0.3706971694163281,
                                                   0.4895736305159848,
                                                   3.525115428008735,
                                                   {-1.7606426096617447, -8.143551737711682},
                                                   {8.086496481187767, 7.142975743895629, 6.3349547559723165},
                                                   {-251.8353900470492, -233.11805152101198, -214.84751921818338}},
                                         Reference{plane_strain(1, 0.4999),
                                                   0.15965738626506695,
                                                   0.3804295546868223,
                                                   3.28854170184391,
                                                   {-1.3435470360807824, -6.782205945937283},
                                                   {6.023950447830034, 5.323319974131363, 4.730589047128585},
                                                   {-167.18443669553184, -154.25653337671537, -141.97150830681431}}));

// [-1, 1]^2 held below, sheared above; a crack that the load opens and one that it closes.
struct Cracked {
  Shape shape;
  Scene scene;
};
Cracked cracked(double poisson) {
  Cracked c;
  c.shape.labels = {"side", "held", "pulled", "hole"};
  c.shape.outline = polygon("outline", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, 0);
  c.shape.outline.sides[0].label = 1;
  c.shape.outline.sides[2].label = 2;
  c.shape.cracks = {{"open", {Vec2(-0.7, 0.1), Vec2(-0.2, 0.1)}}, {"closed", {Vec2(0.3, -0.3), Vec2(0.8, -0.1)}}};
  c.scene.material = plane_strain(1, poisson);
  c.scene.laws.resize(2);
  c.scene.supports.push_back({1, false, true, true, constant({0, 0})});
  c.scene.tractions.push_back({2, [](const Vec2& x, const Vec2&) { return Vec2(0.3, -0.2 - x.x()); }});
  return c;
}

// By brute force: the hole meshed, its rim held.
TEST(ClampedHole, AgreesWithAFiniteHoleBetweenAnOpenAndAClosedCrack) {
  const Vec2 at(0.1, 0.15);
  const Functional all[] = {
      {"energy", {energy()}},
      {"crack_opening", {crack_opening(0, {})}},
      {"crack_pressure", {crack_pressure(1, {}, {})}},
      {"boundary_tracking", {boundary_tracking(2, constant({0.1, -0.1}), {})}},
      {"displacement_tracking", {displacement_tracking({}, {})}},
      {"energy_release_rate", {energy_release_rate({-0.7, 0.1}, {-1, 0}, {0.05, 0.15}, {})}},
      {"misfit", {misfit(2, constant({0.2, -0.3}))}},
      {"sum",
       {energy(), compliance(), boundary_tracking(2, constant({0.1, -0.1}), {}), crack_opening(0, {}), volume()}}};
  for (const double poisson : {0.3, 0.5}) {
    const Cracked body = cracked(poisson);
    const Sizing sizing{.size = 0.08, .crack_tip_size = 0.004};
    const Solved whole = solved(body.shape, sizing, body.scene);
    std::vector<std::vector<double>> error;
    for (const double eps : {0.06, 0.03, 0.015}) {
      Cracked drilled = body;
      drilled.shape.holes = {circle("hole", at, eps, 3)};
      drilled.scene.supports.push_back({3, false, true, true, constant({0, 0})});
      const Solved s = solved(drilled.shape, sizing, drilled.scene);
      for (const Functional& j : all) {
        const double before = analyse(j, whole.model, whole.state, true).value,
                     after = analyse(j, s.model, s.state, true).value;
        const double p = predicted(whole, j, eps, at);
        std::printf("%g %g %s: %.6g -> %.6g: %.8g predicted %.8g  rel %.2e\n", poisson, eps, j.kind.c_str(), before,
                    after, after - before, p, p / (after - before) - 1);
      }
    }
  }
}

TEST(ClampedHole, EverywhereAgreesWithPointwise) {
  const Cracked body = cracked(0.3);
  const Solved s = solved(body.shape, {.size = 0.05, .crack_tip_size = 0.005}, body.scene);
  const Functional j{"energy", {energy()}};
  const Analysis a = analyse(j, s.model, s.state);
  const MapRequest r{.perturbation = {.kind = Perturbation::Kind::ClampedHole}, .radius = 0.01};
  const Corners corners = split_at_cracks(s.model.mesh);
  const FullMap map = map_everywhere(a, j, r, corners);
  std::vector<Vec2> points, centers;
  std::vector<double> values;
  std::vector<Index> in;
  std::vector<bool> skip;
  for (Index t = 0; t < static_cast<Index>(s.model.mesh.triangles.size()); ++t) {
    centers.push_back(centroid(s.model.mesh, t));
    in.push_back(t);
    skip.push_back(map.masked_centroid[t]);
    EXPECT_EQ(std::isnan(map.at_centroids[t]), map.masked_centroid[t]);
    if (t % 29 != 0 || map.masked_centroid[t]) continue;
    points.push_back(centroid(s.model.mesh, t));
    values.push_back(map.at_centroids[t]);
  }
  const ClampedMap clamped = clamped_everywhere(a, j, r.radius, centers, in, skip);
  const std::vector<MapPoint> exact = map_at(a, j, r, points);
  double worst = 0, square = 0, largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double e = std::abs(values[i] - exact[i].value);
    worst = std::max(worst, e / std::abs(exact[i].value));
    square += e * e;
    largest = std::max(largest, std::abs(exact[i].value));
  }
  std::printf("everywhere: %zu triangles %zu points: worst %.2e rms/max %.2e, error said %.2e, samples %d\n",
              s.model.mesh.triangles.size(), points.size(), worst,
              std::sqrt(square / static_cast<double>(points.size())) / largest, clamped.error, clamped.samples);
  EXPECT_LT(worst, 2e-3);
}

TEST(ClampedHole, RefusesWhatItCannotDo) {
  const Cracked body = cracked(0.3);
  const Solved s = solved(body.shape, {.size = 0.2, .crack_tip_size = 0.05}, body.scene);
  const Functional stress{"stress_power", {stress_power(2, {}, true)}}, track{"t", {displacement_tracking({}, {})}};
  EXPECT_THROW(predicted(s, stress, 0.01, {0.1, 0.15}), Error);
  EXPECT_THROW(predicted(s, {"energy", {energy()}}, 0, {0.1, 0.15}), Error);
  const Analysis a = analyse(track, s.model, s.state);
  const MapRequest r{.perturbation = {.kind = Perturbation::Kind::ClampedHole}, .radius = 0.01};
  EXPECT_THROW(map_everywhere(a, track, r, split_at_cracks(s.model.mesh)), Error);
  // Outside, near a crack, and where the hole is too large.
  EXPECT_TRUE(std::isnan(predicted(s, {"energy", {energy()}}, 0.01, {3, 0})));
  EXPECT_TRUE(std::isnan(predicted(s, {"energy", {energy()}}, 0.01, {-0.5, 0.11})));
}

}  // namespace
}  // namespace kerf
