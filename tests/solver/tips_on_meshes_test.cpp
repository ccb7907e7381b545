// Crack tips on the meshes of the mesher: T-stress, collinear, curved and sliding cracks, finite plates.

#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "kerf/recover.hpp"
#include "tests/support/exact.hpp"
#include "tests/support/exact_families.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>

namespace kerf::tips_on_meshes_test {
namespace {

const std::filesystem::path data = KERF_TEST_DATA;
const Material steel = plane_strain(1000, 0.3);
using Law = CrackLaw::Kind;

/// Labels 0 bottom, 1 right, 2 top, 3 left.
Shape box(const Vec2& low, const Vec2& high, std::vector<Crack> cracks) {
  Shape shape{.outline = polygon("outline", {low, {high.x(), low.y()}, high, {low.x(), high.y()}}, 0),
              .holes = {},
              .cracks = std::move(cracks),
              .labels = {"bottom", "right", "top", "left"}};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[i].label = i;
  return shape;
}

struct Solved {
  Model model;
  State state;
};

Solved solve_scene(Mesh mesh, Scene scene) {
  Model model = prepare(std::move(mesh), element("bdms"), std::move(scene), 1);
  State state = solve(model);
  return {std::move(model), std::move(state)};
}

/// The displacement on the whole outer boundary.
Solved solve_with(Mesh mesh, const VectorField& displacement, const CrackLaw& law = {}) {
  Scene scene{.material = steel, .body = {}, .supports = {}, .tractions = {}, .laws = {}};
  scene.laws.assign(mesh.cracks.size(), law);
  for (Index label = 0; label < 4; ++label)
    scene.supports.push_back(
        {label, false, true, true, [displacement](const Vec2& x, const Vec2&) { return displacement(x); }});
  return solve_scene(std::move(mesh), std::move(scene));
}

VectorField displacement_of(const exact::ExactField& f) {
  return [f](const Vec2& x) { return f.displacement(x, exact::side_of(f, x)); };
}

/// Straight cracks between the tips of a field, two by two, in [-2, 2]^2.
Mesh mesh_for(const exact::ExactField& f, double size = 0) {
  std::vector<Crack> cracks;
  for (std::size_t i = 0; i + 1 < f.tips.size(); i += 2) cracks.push_back({"crack", {f.tips[i].at, f.tips[i + 1].at}});
  return triangulate(box({-2, -2}, {2, 2}, std::move(cracks)), {.size = size});
}

std::vector<TipIntensity> tips_of(const exact::ExactField& f, Mesh mesh) {
  const Solved s = solve_with(std::move(mesh), displacement_of(f));
  return crack_tips(s.model, s.state);
}

struct TipCase : testing::TestWithParam<const char*> {};

TEST_P(TipCase, KAndTOnTheDefaultMesh) {
  const std::string id = GetParam();
  const exact::ExactField f = exact::table_field(id);
  const exact::Table table = exact::read_table(data / "exact", id);
  const auto tips = tips_of(f, mesh_for(f));
  ASSERT_EQ(tips.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    const TipIntensity& t = tips[i];
    EXPECT_NEAR(t.K_I, f.tips[i].k1, 1e-4);
    EXPECT_NEAR(t.K_II, f.tips[i].k2, 1e-4);
    EXPECT_NEAR(t.T, table.scalars.at(i == 0 ? "T_left" : "T_right"), 2e-4);
    EXPECT_LT(std::max({t.spread_K_I, t.spread_K_II, t.spread_T}), 2e-4);
    EXPECT_EQ(t.spread, std::max(t.spread_K_I, t.spread_K_II));
    if (f.tips[i].k1 == 0) {
      EXPECT_LT(t.K_I, 1e-4);  // exactly 0 where contact holds the tip
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, TipCase,
                         testing::Values("c01_modeI", "c01b_modeI_biaxial", "c02_modeII", "c03_inclined_open",
                                         "c04_inclined_closed", "c05_partial_linear", "c05_partial_linear_w",
                                         "c05b_partial_general", "c05c_lens"),
                         [](const auto& info) { return std::string(info.param); });

TEST(TipsOnMeshes, CollinearCracks) {
  const exact::ExactField f = exact::family_field("c06_two_cracks");
  const auto tips = tips_of(f, mesh_for(f));
  ASSERT_EQ(tips.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(tips[i].crack, i / 2);
    EXPECT_NEAR(tips[i].K_I, f.tips[i].k1, 1e-4);
    EXPECT_NEAR(tips[i].K_II, 0, 1e-4);
    EXPECT_NEAR(tips[i].T, -1, 3e-4);
  }
}

/// The axis of x becomes the circle of that radius about the origin, from its top clockwise.
Mesh bent(const Mesh& mesh, double radius) {
  std::vector<Vec2> points;
  for (const Vec2& x : mesh.points)
    points.push_back((radius + x.y()) * Vec2(std::sin(x.x() / radius), std::cos(x.x() / radius)));
  std::vector<Marked> marked;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] != none) marked.push_back({mesh.edges[e][0], mesh.edges[e][1], mesh.label[e]});
  for (const CrackEdge& c : mesh.cracks[0]) {
    const auto [a, b] = mesh.edges[c.edge];
    marked.push_back({c.forward ? a : b, c.forward ? b : a, none, 0});
  }
  return connect(std::move(points), mesh.triangles, marked);
}

Mesh arc_mesh(double half_angle, double size) {
  return bent(triangulate(box({-1.7, -0.6}, {1.7, 1}, {{"arc", {{-half_angle, 0}, {half_angle, 0}}}}), {.size = size}),
              1);
}

/// Ahead of a tip the singular terms of s_xx and s_yy are equal: s_xx - s_yy = T + O(r^1/2).
double t_stress(const exact::ExactField& f, const Vec2& tip, const Vec2& ahead) {
  const Vec2 up(-ahead.y(), ahead.x());
  const auto difference = [&](double r) {
    const Mat2 s = f.stress(tip + r * ahead, 0);
    return ahead.dot(s * ahead) - up.dot(s * up);
  };
  const double r = 1e-6;
  return 2 * difference(r) - difference(4 * r);
}

TEST(TipsOnMeshes, TheCurveOfAnArcBelongsToTheIntegral) {
  for (const auto& [id, half_angle] : {std::pair("c11_arc", pi / 4), std::pair("c11b_arc_shear", pi / 6)}) {
    SCOPED_TRACE(id);
    const exact::ExactField f = exact::family_field(id);
    for (const double size : {0.1, 0.05}) {
      const auto tips = tips_of(f, arc_mesh(half_angle, size));
      ASSERT_EQ(tips.size(), 2u);
      for (int i = 0; i < 2; ++i) {
        const TipIntensity& t = tips[i];
        const exact::ExactTip& tip = f.tips[i];
        const double k = std::hypot(tip.k1, tip.k2), allowed = size < 0.1 ? 2e-4 : 4e-4;
        EXPECT_LT((t.at - tip.at).norm(), 1e-12);
        EXPECT_NEAR(t.K_I, tip.k1, allowed * k);
        EXPECT_NEAR(t.K_II, tip.k2, allowed * k);
        EXPECT_NEAR(t.J, t.G, 4e-4 * t.G);
        EXPECT_LT(t.spread, 2e-4);
        const Vec2 ahead = (i == 0 ? 1 : -1) * Vec2(-t.at.y(), t.at.x());
        EXPECT_NEAR(t.T, t_stress(f, t.at, ahead), size < 0.1 ? 6e-4 : 2e-3);
      }
    }
  }
}

/// A bonded crack carries a uniform stress as if it were not there: the ring and all terms on the faces cancel, up to
/// what lies between the edges and the curve.
TEST(TipsOnMeshes, TermsOnCurvedFacesBalanceAUniformStress) {
  const Mat2 stress = (Mat2() << 0.3, 0.4, 0.4, -0.7).finished(), gradient = strain(steel, stress);
  for (const double bend : {0.0, 1.0})
    for (const double size : {0.1, 0.05}) {
      Mesh mesh = arc_mesh(0.7, size);
      for (Vec2& x : mesh.points) x.y() += bend * (0.3 * x.x() * x.x() + 0.2 * std::pow(x.x(), 3));
      const Solved s = solve_with(mesh, [&](const Vec2& x) -> Vec2 { return gradient * x; }, {Law::Bonded});
      const double allowed = size < 0.1 ? 3e-4 : 7e-4;
      for (const TipIntensity& t : crack_tips(s.model, s.state)) {
        const CrackEdge& end = t.at_start ? mesh.cracks[0].front() : mesh.cracks[0].back();
        const Vec2 ahead = tangent(mesh, end.edge), up(-ahead.y(), ahead.x());  // of the chord
        EXPECT_NEAR(t.K_I, 0, allowed);
        EXPECT_NEAR(t.K_II, 0, allowed);
        EXPECT_NEAR(t.J, 0, 1e-7);
        EXPECT_NEAR(t.T, ahead.dot(stress * ahead) - up.dot(stress * up), 0.01);
      }
    }
}

/// J knows nothing of the auxiliary fields: that it equals G proves K_II where curved faces slide in contact.
TEST(TipsOnMeshes, CurvedFacesInContact) {
  const Mat2 stress = (Mat2() << -0.5, 0.5, 0.5, -1).finished(), gradient = strain(steel, stress);
  const Solved s = solve_with(arc_mesh(0.6, 0.1), [&](const Vec2& x) -> Vec2 { return gradient * x; });
  for (const TipIntensity& t : crack_tips(s.model, s.state)) {
    EXPECT_EQ(t.K_I, 0);
    EXPECT_GT(t.K_II, 0.2);
    EXPECT_NEAR(t.J, t.G, 0.02 * t.G);
    EXPECT_LT(t.spread, 1e-3);
    EXPECT_LT(t.spread_T, 2e-3);
  }
}

/// Faces that slide under a uniform stress: the sum of a body without a crack and one whose crack slides freely, both
/// linear, on one mesh.
Solved sliding(const exact::ExactField& f, const Mat2& carried, const exact::ExactField& slip, const Mesh& mesh) {
  const Mat2 stretch = strain(f.material, carried);
  Solved stuck = solve_with(mesh, [&](const Vec2& x) -> Vec2 { return stretch * x; }, {Law::Bonded});
  const Solved free = solve_with(mesh, displacement_of(slip), {Law::Open});
  stuck.state.skeleton += free.state.skeleton;
  stuck.state.interior += free.state.interior;
  return stuck;
}

TEST(TipsOnMeshes, FrictionWorksOnTheAuxiliarySlip) {
  for (const char* id : {"c07_coulomb", "c07_tresca", "c07_stick"}) {
    SCOPED_TRACE(id);
    const exact::FrictionField friction = exact::friction_table(id);
    const exact::ExactField& f = friction.field;
    const exact::Table table = exact::read_table(data / "exact", id);
    const Vec2 t = (f.tips[1].at - f.tips[0].at).normalized(), n(-t.y(), t.x());
    const double angle = std::atan2(t.y(), t.x()), slipping = table.scalars.at("tau_eff");
    const Mat2 shear = t * n.transpose() + n * t.transpose();
    const Mat2 carried = (Mat2() << 0, 0, 0, -1).finished() - slipping * shear;
    const exact::ExactField slip = exact::line_crack("slip", steel, {.angle = angle, .s_tn = slipping});
    const Solved s = sliding(f, carried, slip, mesh_for(f));
    const std::vector<CrackPoint> profile = crack_profile(s.model, s.state, 0);
    EXPECT_NEAR(profile[profile.size() / 2].sigma_t, friction.shear, 1e-9);
    for (const TipIntensity& tip : crack_tips(s.model, s.state)) {
      EXPECT_NEAR(tip.K_I, 0, 1e-4);
      EXPECT_NEAR(tip.K_II, f.tips[0].k2, 1e-4);
      EXPECT_NEAR(tip.T, table.scalars.at("T_left"), 2e-4);
      const double largest = table.scalars.at("s_tn") * table.scalars.at("s_tn") * pi / plane_modulus(steel);
      EXPECT_NEAR(tip.G, table.scalars.at("G_left"), 2e-4 * largest);
      EXPECT_NEAR(tip.J, table.scalars.at("G_left"), 1e-3 * largest);
      EXPECT_LT(std::max(tip.spread, tip.spread_T), 2e-4);
    }
  }
}

/// For the state solver with friction: the same numbers without a superposition.
TEST(TipsOnMeshes, FrictionOfTheStateSolver) {
  struct Case {
    const char* id;
    CrackLaw law;
  };
  for (const auto& [id, law] : {Case{"c07_coulomb", {.friction = 0.3}}, Case{"c07_tresca", {.slip_bound = 0.2}},
                                Case{"c07_stick", {.friction = 0.4}}}) {
    SCOPED_TRACE(id);
    const exact::ExactField f = exact::friction_table(id).field;
    const exact::Table table = exact::read_table(data / "exact", id);
    const Solved s = solve_with(mesh_for(f), displacement_of(f), law);
    for (const TipIntensity& tip : crack_tips(s.model, s.state)) {
      EXPECT_NEAR(tip.K_I, 0, 1e-3);
      EXPECT_NEAR(tip.K_II, f.tips[0].k2, 1e-3);
      EXPECT_NEAR(tip.T, table.scalars.at("T_left"), 1e-3);
      EXPECT_NEAR(tip.J, tip.G, 1e-3 * pi / plane_modulus(steel));
    }
  }
}

struct Plate {
  bool edge;
  double a, W, H, K, T;
};

std::vector<Plate> plates() {
  std::ifstream in(data / "exact" / "c12_plates.csv");
  std::vector<Plate> all;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    Plate p{.edge = line.starts_with("edge")};
    double f = 0;
    if (std::sscanf(line.c_str() + line.find(','), ",%lf,%lf,%lf,%lf,%lf,%lf", &p.a, &p.W, &p.H, &f, &p.K, &p.T) == 6)
      all.push_back(p);
  }
  return all;
}

/// Traction 1 on y = +-H. W is half the width of a plate with a central crack, all of it with an edge crack.
std::vector<TipIntensity> pulled(const Plate& p) {
  const Shape shape = p.edge ? box({0, -p.H}, {p.W, p.H}, {{"crack", {{0, 0}, {p.a, 0}}}})
                             : box({-p.W, -p.H}, {p.W, p.H}, {{"crack", {{-p.a, 0}, {p.a, 0}}}});
  Scene scene{.material = steel, .body = {}, .supports = {}, .tractions = {}, .laws = {{}}};
  for (const Index label : {0, 2}) scene.tractions.push_back({label, [](const Vec2&, const Vec2& n) { return n; }});
  const Solved s = solve_scene(triangulate(shape, {}), std::move(scene));
  return crack_tips(s.model, s.state);
}

TEST(TipsOnMeshes, FinitePlates) {
  ASSERT_EQ(plates().size(), 8u);
  for (const Plate& p : plates()) {
    SCOPED_TRACE(std::string(p.edge ? "edge" : "center") + " a = " + std::to_string(p.a) +
                 " H = " + std::to_string(p.H));
    const auto tips = pulled(p);
    ASSERT_EQ(tips.size(), p.edge ? 1u : 2u);
    for (const TipIntensity& t : tips) {
      EXPECT_NEAR(t.K_I, p.K, 3e-4 * p.K);
      EXPECT_NEAR(t.K_II, 0, 3e-4 * p.K);
      EXPECT_NEAR(t.T, p.T, 2e-3);
      EXPECT_NEAR(t.J, t.G, 1e-3 * t.G);
    }
  }
}

/// Long strips against Tada's formula, good to a thousandth.
TEST(TipsOnMeshes, CentralCracksOfAllLengths) {
  for (const double a : {0.1, 0.4, 0.6, 0.8}) {
    const double k = std::sqrt(pi * a / std::cos(pi * a / 2)) * (1 - 0.025 * a * a + 0.06 * std::pow(a, 4));
    for (const TipIntensity& t : pulled({.edge = false, .a = a, .W = 1, .H = 3, .K = k, .T = 0}))
      EXPECT_NEAR(t.K_I, k, 1.5e-3 * k) << a;
  }
}

/// A short kink in the field of a long crack [Amestoy, Leblond 1992]: K_I F11(angle), K_I F21(angle), up to the order
/// of its length as the long crack has no T-stress.
TEST(TipsOnMeshes, AShortKinkHasTheIntensitiesOfTheExpansion) {
  const double m = 1.0 / 6, angle = m * pi, length = 0.05;
  const double F11 = 1 - 3 * pi * pi / 8 * m * m + (pi * pi - 5 * std::pow(pi, 4) / 128) * std::pow(m, 4),
               F21 = pi / 2 * m - (4 * pi / 3 + std::pow(pi, 3) / 48) * std::pow(m, 3);
  const Vec2 end(1 + length * std::cos(angle), length * std::sin(angle));
  Scene scene{.material = steel, .body = {}, .supports = {}, .tractions = {}, .laws = {{}}};
  for (Index label = 0; label < 4; ++label)
    scene.tractions.push_back({label, [](const Vec2&, const Vec2& n) { return n; }});
  const Mesh mesh = triangulate(box({-8, -8}, {8, 8}, {{"crack", {{-1, 0}, {1, 0}, end}}}), {});
  const Solved s = solve_scene(mesh, std::move(scene));
  const auto tips = crack_tips(s.model, s.state);
  ASSERT_EQ(tips.size(), 2u);
  EXPECT_NEAR(tips[1].radius, 0.8 * 0.9 * length, 1e-12);
  EXPECT_NEAR(tips[1].K_I, F11 * tips[0].K_I, 5e-3 * tips[0].K_I);
  EXPECT_NEAR(tips[1].K_II, F21 * tips[0].K_I, 5e-3 * tips[0].K_I);
  EXPECT_NEAR(tips[1].J, tips[1].G, 1e-3 * tips[1].G);
  EXPECT_LT(tips[1].spread, 1e-3);
  EXPECT_LT(tips[1].spread_T, 0.01);
}

/// A crack that ends on another one has no tip there, wherever along the other one.
TEST(TipsOnMeshes, AnEndOnAnotherCrackIsNoTip) {
  const int n = 16;
  const auto vertex = [&](int i, int j) { return Index(j * (n + 1) + i); };
  const Mesh plain = exact::crack_mesh(n);
  std::vector<Marked> marked;
  for (std::size_t e = 0; e < plain.edges.size(); ++e)
    if (plain.label[e] != none) marked.push_back({plain.edges[e][0], plain.edges[e][1], plain.label[e]});
  for (int i = n / 4; i < 3 * n / 4; ++i) marked.push_back({vertex(i, n / 2), vertex(i + 1, n / 2), none, 0});
  for (int j = n / 2; j < 3 * n / 4; ++j) marked.push_back({vertex(n / 2, j), vertex(n / 2, j + 1), none, 1});
  for (int j = n / 4; j < n / 2; ++j) marked.push_back({vertex(n / 4, j), vertex(n / 4, j + 1), none, 2});
  const Mesh mesh = connect(plain.points, plain.triangles, marked);
  const Solved s = solve_with(mesh, [](const Vec2& x) -> Vec2 { return 1e-3 * x; });
  const auto tips = crack_tips(s.model, s.state);
  ASSERT_EQ(tips.size(), 3u);
  EXPECT_EQ(tips[0].at, Vec2(1, 0));
  EXPECT_EQ(tips[1].at, Vec2(0, 1));
  EXPECT_EQ(tips[2].at, Vec2(-1, -1));
  EXPECT_EQ(tips[2].crack, 2);
}

}  // namespace
}  // namespace kerf::tips_on_meshes_test
