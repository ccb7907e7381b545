// The exact fields against their tables, against the equations, and against the numbers of elements.json.

#include "tests/support/exact.hpp"
#include "base/quadrature.hpp"
#include "tests/solver/equations.hpp"

#include <gtest/gtest.h>
#include <cmath>

namespace kerf::exact::exact_test {
namespace {

const std::filesystem::path data = KERF_TEST_DATA;

/// Work of the tractions on the sides of [-2, 2]^2, composite Gauss.
std::array<double, 4> work_on_box(const ExactField& field) {
  const std::array<Vec2, 5> corner = {Vec2(-2, -2), Vec2(2, -2), Vec2(2, 2), Vec2(-2, 2), Vec2(-2, -2)};
  const EdgeRule rule = gauss(16);
  std::array<double, 4> work = {};
  for (int k = 0; k < 4; ++k) {
    const Vec2 along = corner[k + 1] - corner[k], normal = Vec2(along.y(), -along.x()).normalized();
    for (int piece = 0; piece < 8; ++piece)
      for (Index i = 0; i < rule.s.size(); ++i) {
        const Vec2 x = corner[k] + (piece + rule.s[i]) / 8 * along;
        const int side = side_of(field, x);
        work[k] += rule.w[i] * along.norm() / 8 * (field.stress(x, side) * normal).dot(field.displacement(x, side));
      }
  }
  return work;
}

double strain_energy(const Mesh& mesh, const ExactField& field) {
  return integrate(mesh, field, [&](Index, int side, const Vec2& x) {
    const Mat2 s = field.stress(x, side);
    return strain(field.material, s).cwiseProduct(s).sum() / 2;
  });
}

double displacement_norm(const Mesh& mesh, const ExactField& field) {
  return std::sqrt(integrate(
      mesh, field, [&](Index, int side, const Vec2& x) { return field.displacement(x, side).squaredNorm(); }));
}

double rotation_norm(const Mesh& mesh, const ExactField& field) {
  return std::sqrt(
      integrate(mesh, field, [&](Index, int side, const Vec2& x) { return std::pow(field.rotation(x, side), 2); }));
}

double stress_norm(const Mesh& mesh, const ExactField& field) {
  return stress_error(mesh, field, [](Index, const Vec2&) { return Mat2::Zero().eval(); });
}

struct ExactTables : testing::TestWithParam<const char*> {};

TEST_P(ExactTables, EveryRowIsReproduced) {
  const Table table = read_table(data / "exact", GetParam());
  ASSERT_GE(table.rows.size(), 40u);
  double u_max = 0, s_max = 0, rot_max = 0, hole_max = 0, body_max = 0;
  for (const Row& row : table.rows) {
    u_max = std::max(u_max, row.u.norm());
    s_max = std::max(s_max, row.stress.norm());
    rot_max = std::max(rot_max, std::abs(row.rot));
    hole_max = std::max(hole_max, std::abs(row.hole));
    body_max = std::max(body_max, row.body.norm());
  }
  for (const Row& row : table.rows) {
    SCOPED_TRACE(row.kind + " " + std::to_string(row.x.x()) + " " + std::to_string(row.x.y()));
    const ExactField field = table_field(GetParam(), row.poisson);
    const Mat2 stress = field.stress(row.x, row.side);
    EXPECT_LT((field.displacement(row.x, row.side) - row.u).norm(), 1e-12 * u_max);
    EXPECT_LT((stress - row.stress).norm(), 1e-12 * s_max);
    EXPECT_NEAR(-field.rotation(row.x, row.side), row.rot, 1e-12 * rot_max);
    if (hole_max > 0) {
      EXPECT_NEAR(hole_derivative(field.material, stress), row.hole, 1e-12 * hole_max);
    }
    if (body_max > 0) {
      EXPECT_LT((field.body(row.x) - row.body).norm(), 1e-12 * body_max);
    }
  }
}

TEST_P(ExactTables, EquationsHoldByDifferences) {
  for (const Row& row : read_table(data / "exact", GetParam()).rows) {
    const bool inside = row.kind == "bulk" || row.kind.empty();
    if (inside) expect_equations(table_field(GetParam(), row.poisson), row.x, 5e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ExactTables,
                         testing::Values("c01_modeI", "c01b_modeI_biaxial", "c02_modeII", "c03_inclined_open",
                                         "c04_inclined_closed", "c05_partial_linear", "c05_partial_linear_w",
                                         "c05b_partial_general", "c05c_lens", "c08_kirsch", "c10_trig", "c10_exp"));

struct ExactCracks : testing::TestWithParam<const char*> {};

TEST_P(ExactCracks, FacesAndIntensitiesMatchTheTable) {
  const Table table = read_table(data / "exact", GetParam());
  const ExactField field = table_field(GetParam());
  const double size = 1 / plane_modulus(field.material);
  ASSERT_EQ(table.faces.size(), 5u);
  for (const Face& face : table.faces) {
    EXPECT_LT((crack_point(field, face.s) - face.x).norm(), 1e-15);
    EXPECT_NEAR(field.opening(face.s), face.jump_n, 1e-13 * size);
    EXPECT_NEAR(field.slip(face.s), face.jump_t, 1e-13 * size);
    EXPECT_NEAR(-field.pressure(face.s), face.sigma_n, 1e-13);
    EXPECT_EQ(is_open(field, face.s), face.jump_n > 0);
  }
  EXPECT_NEAR(field.tips[0].k1, table.scalars.at("KI_left"), 1e-13);
  EXPECT_NEAR(field.tips[1].k1, table.scalars.at("KI_right"), 1e-13);
  EXPECT_NEAR(field.tips[0].k2, table.scalars.at("KII_left"), 1e-13);
  EXPECT_NEAR(field.tips[1].k2, table.scalars.at("KII_right"), 1e-13);
  if (table.scalars.count("closure_point"))
    EXPECT_NEAR(field.transitions.back(), table.scalars.at("closure_point"), 1e-15);
  else
    EXPECT_TRUE(field.transitions.empty());
}

TEST_P(ExactCracks, WorkOnTheBoxIsTheTabulatedEnergy) {
  const Table table = read_table(data / "exact", GetParam());
  const std::array<double, 4> work = work_on_box(table_field(GetParam()));
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(work[k], table.work[k], 1e-12 * table.energy);
  EXPECT_NEAR((work[0] + work[1] + work[2] + work[3]) / 2, table.energy, 1e-12 * table.energy);
}

INSTANTIATE_TEST_SUITE_P(All, ExactCracks,
                         testing::Values("c01_modeI", "c01b_modeI_biaxial", "c02_modeII", "c03_inclined_open",
                                         "c04_inclined_closed", "c05_partial_linear", "c05_partial_linear_w",
                                         "c05b_partial_general", "c05c_lens"));

/// Cracks in every regime, turned, off center, of another length; some with p1 < 0.
std::vector<ExactField> regimes() {
  const Material steel = plane_strain(210, 0.3), sheet = plane_stress(7, 0.25), rubber = plane_strain(3, 0.5);
  const Vec2 center(0.3, -0.2);
  return {line_crack("open", steel, {center, 0.7, 0.8, 1, 0.4, 0.2, 0.3}),
          line_crack("open, p1 < 0", sheet, {center, -1.2, 0.8, 1, -0.4, 0.2, 0.3}),
          line_crack("partial, p1 < 0", rubber, {center, 2.5, 0.8, 0.1, -0.5, 0.2, -0.3, true}),
          line_crack("mostly closed", steel, {center, 0.7, 0.8, -0.35, 0.5, 0.2, 0.3}),
          line_crack("closed", sheet, {center, 0.7, 0.8, -1, 0.5, 0.2, 0.3, true}),
          line_crack("closed, p1 < 0", sheet, {center, 0.7, 0.8, -1, -0.5, 0.2, 0.3}),
          line_crack("uniformly closed", sheet, {center, 0.7, 0.8, -1, 0, 0.2, 0.3}),
          lens_crack("lens", rubber, {center, 0.4, 0.8, 0.1, 1.5, 0.2}),
          lens_crack("lens, Z alone", steel, {center, 0.4, 0.8, 0.1, 1.5, 0.2, true})};
}

TEST(ExactField, EquationsHoldInEveryRegime) {
  for (const ExactField& field : regimes())
    for (const Vec2& x : {Vec2(0.6, 0.4), Vec2(-0.7, -0.9), Vec2(1.5, 0.1), Vec2(0.1, 1.3)})
      expect_equations(field, x, 5e-4);
}

TEST(ExactField, JumpsAndTractionsOnTheCrackObeyUnilateralContact) {
  for (const ExactField& field : regimes()) {
    SCOPED_TRACE(field.name);
    const Vec2 a = field.tips[0].at, b = field.tips[1].at, t = (b - a).normalized(), n(-t.y(), t.x());
    const double half = (b - a).norm() / 2, strain_size = 1 / plane_modulus(field.material);
    EXPECT_LT((a + b - 2 * Vec2(0.3, -0.2)).norm(), 1e-15);
    for (int i = 1; i < 60; ++i) {
      const double s = half * (2 * i / 60.0 - 1);
      const Vec2 x = crack_point(field, s);
      const Vec2 jump = field.displacement(x, 1) - field.displacement(x, -1);
      EXPECT_NEAR(jump.dot(n), field.opening(s), 1e-14 * strain_size);
      EXPECT_NEAR(jump.dot(t), field.slip(s), 1e-14 * strain_size);
      for (const int side : {1, -1}) {
        const Vec2 traction = field.stress(x, side) * n;
        EXPECT_NEAR(traction.dot(n), -field.pressure(s), 1e-14);
        EXPECT_NEAR(traction.dot(t), 0, 1e-14);
      }
      EXPECT_GE(field.opening(s), 0);
      EXPECT_GE(field.pressure(s), 0);
      EXPECT_EQ(field.opening(s) * field.pressure(s), 0);
    }
    for (const double s : field.transitions) {
      EXPECT_LT(std::abs(s), half);
      EXPECT_NE(is_open(field, s - 1e-3), is_open(field, s + 1e-3));
    }
  }
}

/// Both ends of the partly open regime, up to a translation.
TEST(ExactField, ContactBeginsContinuously) {
  const Material m = plane_strain(1, 0.3);
  for (const double p1 : {1.0, -1.0})
    for (const double p0 : {0.5, -1.0}) {
      const ExactField one = line_crack("", m, {.p0 = p0 - 1e-9, .p1 = p1}),
                       two = line_crack("", m, {.p0 = p0 + 1e-9, .p1 = p1});
      EXPECT_NE(one.transitions.empty(), two.transitions.empty());
      const Vec2 shift = one.displacement({0, 1}, 0) - two.displacement({0, 1}, 0);
      for (const Vec2& x : {Vec2(0.6, 0.4), Vec2(-0.7, -0.9), Vec2(0.2, 0.01)}) {
        EXPECT_LT((one.displacement(x, 0) - two.displacement(x, 0) - shift).norm(), 1e-7);
        EXPECT_LT((one.stress(x, 0) - two.stress(x, 0)).norm(), 1e-7);
      }
    }
}

/// Ahead of a tip s_nn = K_I/sqrt(2 pi r), s_tn = K_II/sqrt(2 pi r), to O(1).
TEST(ExactField, StressNearTheTipsHasTheIntensities) {
  const double r = 1e-12, root = std::sqrt(2 * pi * r);
  for (const ExactField& field : regimes())
    for (int k = 0; k < 2; ++k) {
      const Vec2 t = (field.tips[k].at - field.tips[1 - k].at).normalized(), n(-t.y(), t.x());
      // n is the other way at the start of the crack, and so are both factors of s_tn.
      const Vec2 traction = root * field.stress(field.tips[k].at + r * t, 0) * n;
      EXPECT_NEAR(traction.dot(n), field.tips[k].k1, 1e-4) << field.name;
      EXPECT_NEAR(traction.dot(t), field.tips[k].k2, 1e-4) << field.name;
    }
}

TEST(ExactField, TipsKeepTheirDigits) {
  // With the tip at the origin the distance to it has no rounding: a turned copy must agree to the last digits.
  const Material m = plane_strain(1, 0.3);
  for (const double r : {1e-3, 1e-8, 1e-14})
    for (const double theta : {0.3, 1.5, 3.1, -3.1415926}) {
      const double angle = 0.6;
      const Vec2 x = r * Vec2(std::cos(theta), std::sin(theta));
      const Mat2 turn = (Mat2() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
      LineCrack crack{.center = {-1, 0}, .p0 = 0.1, .p1 = 1, .s_tt = 0.3, .s_tn = 0.4};
      const ExactField straight = line_crack("", m, crack);
      crack.angle = angle;
      crack.center = -Vec2(std::cos(angle), std::sin(angle));
      const ExactField turned = line_crack("", m, crack);
      const Mat2 s = straight.stress(x, 0);
      EXPECT_LT((turned.stress(turn * x, 0) - turn * s * turn.transpose()).norm(), 1e-13 * s.norm());
      // The jump between the faces r behind the tip, a difference of two displacements of size 1.
      const double jump = (straight.displacement({-r, 0}, 1) - straight.displacement({-r, 0}, -1)).y();
      const double sqrt_law = 8 * straight.tips[1].k1 / plane_modulus(m) * std::sqrt(r / (2 * pi));
      EXPECT_NEAR(jump, sqrt_law, 2 * r * sqrt_law + 4e-16);
    }
}

TEST(ExactField, DisplacementIsFiniteAndSingleValuedAtTips) {
  for (const ExactField& field : regimes())
    for (const ExactTip& tip : field.tips) {
      const Vec2 u = field.displacement(tip.at, 0);
      EXPECT_TRUE(u.allFinite()) << field.name;
      EXPECT_LT((u - field.displacement(tip.at, -1)).norm(), 1e-15);
      EXPECT_LT((u - field.displacement(tip.at + Vec2(0, 1e-14), 0)).norm(), 1e-6);
    }
}

TEST(ExactField, KirschRimCarriesThePressureAlone) {
  Mat2 far;
  far << 1, 0.3, 0.3, -0.4;
  const Vec2 center(0.2, 0.1);
  const ExactField field = kirsch(plane_stress(3, 0.2), far, 0.5, 0.7, center);
  for (int i = 0; i < 12; ++i) {
    const Vec2 n(std::cos(i * pi / 6), std::sin(i * pi / 6));
    EXPECT_LT((field.stress(center + 0.5 * n, 0) * n + 0.7 * n).norm(), 1e-14);
    expect_equations(field, center + 0.8 * n, 1e-3);
  }
  EXPECT_LT((field.stress({1e6, 2e6}, 0) - far).norm(), 1e-11);
}

TEST(ExactField, SmoothNormsMatchTheTable) {
  const Mesh mesh = unit_square_mesh(8);
  for (const char* id : {"c10_trig", "c10_exp"})
    for (const auto& row : read_table(data / "exact", id).per_nu) {
      const ExactField field = table_field(id, row.at("nu"));
      EXPECT_NEAR(displacement_norm(mesh, field), row.at("u_L2"), 1e-12 * row.at("u_L2"));
      EXPECT_NEAR(rotation_norm(mesh, field), row.at("rotation_L2"), 1e-12 * row.at("rotation_L2"));
      EXPECT_NEAR(stress_norm(mesh, field), row.at("sigma_L2"), 1e-12 * row.at("sigma_L2"));
      EXPECT_NEAR(strain_energy(mesh, field), row.at("energy"), 1e-12 * row.at("energy"));
    }
}

TEST(ExactField, WaveObeysTheEquations) {
  for (const double nu : {0.25, 0.4999, 0.5})
    for (const Vec2& x : {Vec2(0.1, 0.2), Vec2(0.7, 0.4), Vec2(0.9, 0.95)}) expect_equations(wave_field(nu), x, 2e-3);
}

/// For the elements of the table div s_h = -P0 f, so err_div = |f - P0 f| fixes body force, mesh and rule to its
/// digits; u_h is close to P0 u, so |u|^2 = |u_h|^2 + |u - u_h|^2 up to a product of small terms.
TEST(ExactField, WaveIsTheSmoothSolutionOfTheElementTable) {
  for (const ElementRow& row : read_elements(data / "elements.json", "smooth")) {
    if (row.element != "BDMSd") continue;
    const ExactField field = wave_field(row.poisson);
    const Mesh mesh = unit_square_mesh(row.n);
    std::vector<Vec2> mean(mesh.triangles.size());
    for (int k = 0; k < 2; ++k) {
      for (Index t = 0; t < Index(mesh.triangles.size()); ++t) {
        const auto& v = mesh.triangles[t];
        mean[t][k] = integrate({mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]]}, -1,
                               [&](const Vec2& x) { return field.body(x)[k]; }) /
                     area(mesh, t);
      }
    }
    const double oscillation = std::sqrt(
        integrate(mesh, field, [&](Index t, int, const Vec2& x) { return (field.body(x) - mean[t]).squaredNorm(); }));
    EXPECT_NEAR(oscillation, row.value.at("err_div"), 1e-9 * row.value.at("err_div"));
    const double u = displacement_norm(mesh, field);
    EXPECT_NEAR(std::hypot(row.value.at("norm_u"), row.value.at("err_u")), u, 2 * row.value.at("err_Pu"));
    EXPECT_LT(std::abs(stress_norm(mesh, field) - row.value.at("norm_s")), row.value.at("err_s"));
    EXPECT_LT(std::abs(rotation_norm(mesh, field) - row.value.at("norm_gamma")), row.value.at("err_gamma"));
  }
}

TEST(ExactField, CrackCasesAreThoseOfTheElementTable) {
  for (const ElementRow& row : read_elements(data / "elements.json", "crack")) {
    if (row.n != 32 || row.element != "BDMSd") continue;
    SCOPED_TRACE(row.crack_case);
    const ExactField field = crack_case(row.crack_case);
    const Mesh mesh = crack_mesh(row.n);
    EXPECT_NEAR(std::hypot(row.value.at("norm_u"), row.value.at("err_u")), displacement_norm(mesh, field),
                row.value.at("err_Pu"));
    EXPECT_LT(std::abs(stress_norm(mesh, field) - row.value.at("norm_s")), 0.1 * row.value.at("err_s"));
    EXPECT_LT(std::abs(rotation_norm(mesh, field) - row.value.at("norm_gamma")), 0.1 * row.value.at("err_gamma"));
  }
}

TEST(ExactIntegrals, EnergyInTheBodyIsHalfTheWorkOnItsBoundary) {
  for (const char* name : {"I", "II", "III", "IV"}) {
    const ExactField field = crack_case(name);
    const std::array<double, 4> work = work_on_box(field);
    const double half_work = (work[0] + work[1] + work[2] + work[3]) / 2;
    EXPECT_NEAR(strain_energy(crack_mesh(32), field), half_work, 1e-8 * half_work) << name;
    EXPECT_NEAR(strain_energy(crack_mesh(32, 0, 0.2), field), half_work, 1e-7 * half_work) << name;
  }
}

TEST(ExactIntegrals, TurnedCrackHasTheSameNorms) {
  for (const char* name : {"I", "II", "III", "IV"}) {
    const double flat = stress_norm(crack_mesh(8, 0, 0.2, 3), crack_case(name)),
                 turned = stress_norm(crack_mesh(8, 0.5, 0.2, 3), crack_case(name, 0.5));
    EXPECT_NEAR(turned, flat, 1e-13 * flat);
  }
}

TEST(ExactIntegrals, RulesAreExactForPolynomialsAndTips) {
  const Triangle triangle = {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
  const auto monomial = [](const Vec2& x) { return std::pow(x.x(), 6) * std::pow(x.y(), 7); };
  EXPECT_NEAR(integrate(triangle, -1, monomial), 720.0 * 5040 / 1307674368000, 1e-19);
  const auto lower = [](const Vec2& x) { return std::pow(x.x(), 4) * std::pow(x.y(), 5); };
  EXPECT_NEAR(integrate(triangle, 2, lower), 24.0 * 120 / 39916800, 1e-18);
  // int r^-1 over the triangle = int dtheta / (cos + sin) = sqrt(2) artanh(sqrt(1/2))
  const double inverse = std::sqrt(2) * std::atanh(std::sqrt(0.5));
  const auto tip = [](const Vec2& x) { return 1 / x.norm(); };
  EXPECT_NEAR(integrate(triangle, 0, tip), inverse, 1e-9);
  // A tensor r^(-1/2) I, tip at the second vertex.
  const Triangle cycled = {triangle[2], triangle[0], triangle[1]};
  const double squared =
      l2_error_squared(cycled, 1, [](const Vec2& x) { return (Mat2::Identity() / std::sqrt(x.norm())).eval(); });
  EXPECT_NEAR(squared, 2 * inverse, 1e-9);
}

TEST(ExactMeshes, SquareAndCrackFollowTheRecipe) {
  const Mesh square = unit_square_mesh(4);
  EXPECT_EQ(square.points[7], Vec2(0.5, 0.25));
  EXPECT_EQ(square.triangles[2], (std::array<Index, 3>{1, 2, 7}));
  EXPECT_EQ(square.triangles[3], (std::array<Index, 3>{1, 7, 6}));
  EXPECT_TRUE(square.cracks.empty());
  const Mesh mesh = crack_mesh(8, 0.5, 0.25, 7);
  double total = 0;
  for (Index t = 0; t < Index(mesh.triangles.size()); ++t) total += area(mesh, t);
  EXPECT_NEAR(total, 16, 1e-13);
  ASSERT_EQ(mesh.cracks.size(), 1u);
  ASSERT_EQ(mesh.cracks[0].size(), 4u);
  const ExactField field = crack_case("I", 0.5);
  const auto end = [&](const CrackEdge& e, bool last) { return mesh.points[mesh.edges[e.edge][last == e.forward]]; };
  EXPECT_EQ(end(mesh.cracks[0].front(), false), field.tips[0].at);
  EXPECT_EQ(end(mesh.cracks[0].back(), true), field.tips[1].at);
  std::array<int, 4> edges = {};
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] != none) ++edges.at(mesh.label[e]);
  EXPECT_EQ(edges, (std::array<int, 4>{8, 8, 8, 8}));
  EXPECT_EQ(crack_mesh(8, 0, 0.25, 7).points, crack_mesh(8, 0, 0.25, 7).points);
  EXPECT_NE(crack_mesh(8, 0, 0.25, 7).points, crack_mesh(8, 0, 0.25, 8).points);
}

}  // namespace
}  // namespace kerf::exact::exact_test
