// Tips of cracks in planes of symmetry: K_I, T, G and J of the half are those of the whole body on the mesh and its
// mirror image, to rounding; against Tada's strip; and where there is no tip.

#include "solver/half_cracks.hpp"

#include "kerf/element.hpp"
#include "kerf/mesher.hpp"
#include "kerf/state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace kerf::tips_on_halves_test {
namespace {

enum Label : Index { Face, Ligament, Right, Far, Left };
constexpr std::array<Index, 1> planes{Ligament};
constexpr double a = 0.4;

/// 1 wide, `height` high, the face from x = 0 to a on y = 0.
Mesh half_strip(double height, double size, double tip_size) {
  const std::vector<std::pair<Vec2, Index>> corners{
      {{0, 0}, Face},  {{a - tip_size, 0}, Face}, {{a, 0}, Ligament}, {{a + tip_size, 0}, Ligament},
      {{1, 0}, Right}, {{1, height}, Far},        {{0, height}, Left}};
  Shape shape{.labels = {"face", "ligament", "right", "far", "left"}};
  shape.outline.name = "outline";
  for (const auto& [x, label] : corners) shape.outline.sides.push_back({x, label});
  return triangulate(shape, {.size = size});
}

std::vector<Marked> marked(const Mesh& mesh) {
  std::vector<Marked> all;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] != none) all.push_back({mesh.edges[e][0], mesh.edges[e][1], mesh.label[e]});
  return all;
}

Mesh mirrored(const Mesh& mesh) {
  std::vector<Vec2> points = mesh.points;
  for (Vec2& x : points) x.y() *= -1;
  auto triangles = mesh.triangles;
  for (auto& t : triangles) std::swap(t[1], t[2]);
  return connect(std::move(points), std::move(triangles), marked(mesh));
}

/// The half and its image; the face is crack 0.
Mesh whole(const Mesh& half) {
  std::vector<Vec2> points = half.points;
  std::vector<Index> image(points.size());
  for (std::size_t v = 0; v < half.points.size(); ++v) {
    const Vec2& x = half.points[v];
    image[v] = x.y() == 0 ? static_cast<Index>(v) : static_cast<Index>(points.size());
    if (x.y() != 0) points.emplace_back(x.x(), -x.y());
  }
  auto triangles = half.triangles;
  for (const auto& [i, j, k] : half.triangles) triangles.push_back({image[i], image[k], image[j]});
  std::vector<Marked> edges, faces;
  for (const Marked& m : marked(half)) {
    if (m.label == Face) faces.push_back({m.a, m.b, none, 0});
    if (m.label == Face || m.label == Ligament) continue;
    edges.push_back(m);
    edges.push_back({image[m.a], image[m.b], m.label});
  }
  for (Marked& f : faces)
    if (points[f.a].x() > points[f.b].x()) std::swap(f.a, f.b);
  std::ranges::sort(faces, {}, [&](const Marked& f) { return points[f.a].x(); });
  edges.insert(edges.end(), faces.begin(), faces.end());
  return connect(std::move(points), std::move(triangles), edges);
}

BoundaryField constant(double x, double y) {
  return [x, y](const Vec2&, const Vec2&) { return Vec2(x, y); };
}

/// Tension across the plane, no displacement along it on the right.
Scene stretched(const Material& material) {
  Scene s{.material = material};
  s.supports = {{Right, false, true, false, constant(0, 0)}};
  s.tractions = {{Far, [](const Vec2&, const Vec2& n) { return Vec2(0, n.y()); }}};
  return s;
}

Scene on_plane(Scene s) {
  s.supports.push_back({Ligament, true, true, false, constant(0, 0)});
  return s;
}

TipIntensity of_half(Mesh mesh, const Element& e, Scene scene) {
  const Model m = prepare(std::move(mesh), e, on_plane(std::move(scene)), 1);
  const State s = solve(m);
  const auto cracks = half_cracks(m.mesh, m.scene, planes);
  EXPECT_EQ(cracks.size(), 1u);
  const auto tips = half_crack_tips(m, s, cracks);
  EXPECT_EQ(tips.size(), 1u);
  return tips.at(0);
}

TipIntensity of_whole(const Mesh& half, const Element& e, Scene scene, BoundaryField pressure = {}) {
  scene.laws = {{.kind = CrackLaw::Kind::Open, .pressure = std::move(pressure)}};
  const Model m = prepare(whole(half), e, std::move(scene), 1);
  const auto tips = crack_tips(m, solve(m));
  EXPECT_EQ(tips.size(), 1u);
  return tips.at(0);
}

void expect_same(const TipIntensity& half, const TipIntensity& whole, double of_j = 1e-7) {
  constexpr double rounding = 1e-7;
  EXPECT_NEAR(half.K_I, whole.K_I, rounding * std::abs(whole.K_I));
  EXPECT_EQ(half.K_II, 0);
  EXPECT_NEAR(whole.K_II, 0, rounding * std::abs(whole.K_I));
  EXPECT_NEAR(half.T, whole.T, rounding * std::abs(whole.K_I));
  EXPECT_NEAR(half.G, whole.G, rounding * whole.G);
  EXPECT_NEAR(half.J, whole.J, of_j * whole.G);
  EXPECT_EQ(half.radius, whole.radius);
  EXPECT_NEAR(half.spread, whole.spread, rounding);
}

const Mesh coarse = half_strip(1, 0.25, 0.02);
const Material steel = plane_strain(1000, 0.3);

TEST(TipsOnHalves, AreThoseOfTheMirroredBodyToRounding) {
  for (const Element& e : {element("bdms", 2), element("afw", 1), element("p2")})
    expect_same(of_half(coarse, e, stretched(steel)), of_whole(coarse, e, stretched(steel)));
}

TEST(TipsOnHalves, DoNotMindOnWhichSideTheBodyLies) {
  const TipIntensity above = of_half(coarse, bdms(2), stretched(steel)),
                     below = of_half(mirrored(coarse), bdms(2), stretched(steel));
  EXPECT_NEAR(above.K_I, below.K_I, 1e-9 * above.K_I);
  EXPECT_NEAR(above.T, below.T, 1e-9 * above.K_I);
  EXPECT_NEAR(above.J, below.J, 1e-9 * above.G);
}

TEST(TipsOnHalves, SeeLoadsOfFacesAndBodiesAndStrains) {
  const auto p = [](const Vec2& x) { return 0.5 + x.x(); };
  Scene scene = stretched(steel), half = scene;
  half.tractions.push_back({Face, [p](const Vec2& x, const Vec2& n) { return Vec2(-p(x) * n); }});
  // J takes the work on the faces from gradients here, from jumps there.
  expect_same(of_half(coarse, bdms(2), half),
              of_whole(coarse, bdms(2), scene, [p](const Vec2& x, const Vec2&) { return Vec2(p(x), 0); }), 0.05);
  scene.body = [](const Vec2& x) { return Vec2(1 + x.x(), 0); };
  expect_same(of_half(coarse, bdms(2), scene), of_whole(coarse, bdms(2), scene));
  scene.eigenstrain = {
      {[](const Vec2& x) { return Vec2(1e-3 * x.x() * x.x(), 2e-3); }, [](const Vec2&) { return Vec2(0, 0); }}};
  expect_same(of_half(coarse, bdms(2), scene), of_whole(coarse, bdms(2), scene));
}

TEST(TipsOnHalves, HoldInMaterialsWithAxesInThePlane) {
  const Material wood = orthotropic({.young = {1000, 250}, .poisson = 0.3, .shear = 180});
  expect_same(of_half(coarse, bdms(2), stretched(wood)), of_whole(coarse, bdms(2), stretched(wood)));
}

// Edge crack in a strip, error of the formula below 0.5 % Tada, Paris, Irwin, handbook.
TEST(TipsOnHalves, HaveTheStripOfTada) {
  const double t = std::tan(pi * a / 2), c = std::cos(pi * a / 2), s = std::sin(pi * a / 2),
               F = std::sqrt(2 / (pi * a) * t) * (0.752 + 2.02 * a + 0.37 * std::pow(1 - s, 3)) / c;
  Scene scene = stretched(plane_stress(1, 0.3));
  scene.supports.clear();
  const TipIntensity tip = of_half(half_strip(4, 0.25, 0.002), bdms(2), scene);
  EXPECT_NEAR(tip.K_I / std::sqrt(pi * a), F, 0.005 * F);
  EXPECT_NEAR(tip.J, tip.G, 0.005 * tip.G);
  EXPECT_LT(tip.spread, 0.005);
}

TEST(TipsOnHalves, OpenTwiceAsFarAsTheirFace) {
  const Model m = prepare(coarse, bdms(2), on_plane(stretched(steel)), 1);
  const State s = solve(m);
  const auto cracks = half_cracks(m.mesh, m.scene, planes);
  const auto profile = half_profile(m, s, cracks.at(0));
  Scene scene = stretched(steel);
  scene.laws = {{.kind = CrackLaw::Kind::Open}};
  const Model twin = prepare(whole(coarse), bdms(2), scene, 1);
  const auto of_twin = crack_profile(twin, solve(twin), 0);
  const auto opening = [](const auto& rows) {
    double sum = 0;
    for (const CrackPoint& p : rows) sum += p.length * p.jump_n;
    return sum;
  };
  EXPECT_NEAR(opening(profile), opening(of_twin), 0.01 * opening(of_twin));
  EXPECT_NEAR(profile.back().s, a, 0.02);
}

// Where the face is held, turns off, or a crack ends there.
TEST(TipsOnHalves, AreOnlyWhereAFreeFaceGoesOnStraight) {
  Scene held = on_plane(stretched(steel));
  held.supports.push_back({Face, false, true, false, constant(0, 0)});
  EXPECT_TRUE(half_cracks(coarse, held, planes).empty());
  Mesh bent = coarse;
  for (Vec2& x : bent.points)
    if (x.x() < a) x.y() += 0.1 * (a - x.x());
  EXPECT_TRUE(half_cracks(bent, on_plane(stretched(steel)), planes).empty());
  EXPECT_TRUE(half_cracks(coarse, on_plane(stretched(steel)), {}).empty());
}

}  // namespace
}  // namespace kerf::tips_on_halves_test
