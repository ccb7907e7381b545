// Validation against the finite element cases of tests/data/topological_derivatives.json: coefficients and difference
// quotients of an independent code (isoparametric quadratic displacements). Its readme states 1e-5 for T and 1e-5 to
// 5e-5 for D; ours add what a hole with 64 straight sides costs, 1e-4 of D.

#include "tests/support/exact_families.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>

namespace kerf::validate_test {
namespace {

using namespace scenes;
using nlohmann::json;
using Kind = Perturbation::Kind;

json reference(const std::string& name) {
  const json all = json::parse(std::ifstream(std::string(KERF_TEST_DATA) + "/topological_derivatives.json"));
  for (const json& entry : all.at("fe"))
    if (entry.at("name") == name) return entry;
  throw std::invalid_argument(name);
}

// [0, 2] x [0, 1], u = 0 on x = 0, traction (0.3, -1) on x = 2.
Body cantilever(const Material& m, bool loaded) {
  Scene s;
  s.material = m;
  s.supports = {clamp(3)};
  s.tractions = {{1, [](const Vec2&, const Vec2&) { return Vec2(0.3, -1); }}};
  if (loaded) s.body = [](const Vec2&) { return Vec2(0.2, -0.5); };
  return {rectangle({0, 0}, {2, 1}), s, {.size = 0.05}};
}
const Vec2 in_cantilever(0.8, 0.35), beside_crack(0.15, 0.35);

double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}
double weight(const Vec2& x) {
  return smooth((x.x() - 0.2) / 0.3) * smooth((1.9 - x.x()) / 0.3);
}

// Relative tolerances of T and D.
void compare(const Validation& v, const json& expected, double of_t, double of_d) {
  SCOPED_TRACE(text(v));
  EXPECT_EQ(v.verdict, Verdict::Holds);
  EXPECT_NEAR(v.coefficient / expected.at("T").get<double>(), 1, of_t);
  EXPECT_NEAR((v.rows[0].J - v.rows[0].difference) / expected.at("J0").get<double>(), 1, 2 * of_t);
  const std::vector<double> eps = expected.at("eps"), D = expected.at("D");
  std::size_t compared = 0;
  for (std::size_t i = 0; i < eps.size(); ++i)
    for (std::size_t row = 0; row < v.rows.size(); ++row)
      if (v.rows[row].radius == eps[i]) {
        EXPECT_NEAR(quotient(v, row) / D[i], 1, of_d) << "eps " << eps[i];
        ++compared;
      }
  EXPECT_EQ(compared, v.rows.size());
}

struct Named {
  const char* name;
  Term term;
};
class Cantilever : public testing::TestWithParam<Named> {};
class OpenCrack : public testing::TestWithParam<Named> {};
std::string name_of(const testing::TestParamInfo<Named>& info) {
  return info.param.name;
}

TEST_P(Cantilever, AgreesWithTheReference) {
  const Functional j{"", {GetParam().term}};
  const Validation v =
      validated(cantilever(plane_stress(1, 0.3), true), j, in_cantilever, {}, {0.16, 0.08, 0.04, 0.02, 0.01});
  compare(v, reference(std::string("cantilever_") + GetParam().name), 1e-4, 2e-4);
  EXPECT_GT(v.order, 3.7);
  EXPECT_LT(v.order, 4.3);
}
INSTANTIATE_TEST_SUITE_P(Functionals, Cantilever,
                         testing::Values(Named{"comp", compliance()}, Named{"track", displacement_tracking({}, {})},
                                         Named{"vm2", stress_power(2, weight, false)},
                                         Named{"vm4", stress_power(4, weight, false)},
                                         Named{"vm6", stress_power(6, weight, false)}),
                         name_of);

// Both codes are as good as their edges at the ends of the support: 3e-4 of J itself.
TEST_P(OpenCrack, AgreesWithTheReference) {
  const Functional j{"", {GetParam().term}};
  const Body b{cracked_square(), pulled(plane_strain(1, 0.3), opens), {.size = 0.1, .crack_tip_size = 1e-4}};
  const Validation v = validated(b, j, beside_crack);
  compare(v, reference(std::string("crack_open_") + GetParam().name), 6e-4, 6e-4);
  EXPECT_GT(v.order, 3.7);
  EXPECT_LT(v.order, 4.3);
}
INSTANTIATE_TEST_SUITE_P(Functionals, OpenCrack,
                         testing::Values(Named{"comp", compliance()}, Named{"track", displacement_tracking({}, {})},
                                         Named{"btrack", boundary_tracking(2, {}, {})},
                                         Named{"G", energy_release_rate({0.4, 0}, {1, 0}, {0.06, 0.2}, {})}),
                         name_of);

// Rows of the file: eps, T and D of compliance and tracking.
void compare_rows(const std::string& name, const Material& matrix, const Perturbation& p, double of_t, double of_d) {
  const json rows = reference(name).at("rows");
  const std::vector<Term> terms = {compliance(), displacement_tracking({}, {})};
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const Validation v = validated(cantilever(matrix, false), {"", {terms[k]}}, in_cantilever, p);
    SCOPED_TRACE(terms[k].kind + "\n" + text(v));
    EXPECT_EQ(v.verdict, Verdict::Holds);
    EXPECT_NEAR(v.coefficient / rows.back()[1][k].get<double>(), 1, of_t);
    ASSERT_EQ(rows.size(), v.rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      EXPECT_NEAR(quotient(v, i) / rows[i][2][k].get<double>(), 1, of_d) << rows[i][0];
  }
}

// Held all around and nearly incompressible, a body answers a change of its volume by pressure everywhere: the series
// begins below a thousandth of its size, and what larger radii tend to is another number. Body forces, no c2.
TEST(HeldBody, NothingFailsWhereTheSeriesHasNotBegun) {
  for (const exact::ExactField& field : {exact::wave_field(0.499999), exact::trig_field(0.499999)}) {
    Body b{.shape = rectangle({0, 0}, {1, 1})};
    b.scene.material = field.material;
    b.scene.body = field.body;
    for (Index label = 0; label < 4; ++label)
      b.scene.supports.push_back({label, false, true, true, [field](const Vec2& x, const Vec2&) {
                                    return field.displacement(x, exact::side_of(field, x));
                                  }});
    const Vec2 at(0.44, 0.3);
    const Functional j{"energy", {energy()}};
    const double T =
        exact::hole_derivative(field.material, field.stress(at, 0)) + field.body(at).dot(field.displacement(at, 0));
    const Validation large = validated(b, j, at), small = validated(b, j, at, {}, {8e-5, 4e-5, 2e-5, 1e-5});
    EXPECT_EQ(large.verdict, Verdict::OutOfRange) << text(large);
    EXPECT_NE(large.reason.find("nearly incompressible and held all around"), std::string::npos) << large.reason;
    EXPECT_GT(std::abs(large.intercept / T - 1), 0.05);
    EXPECT_EQ(small.verdict, Verdict::Holds) << text(small);
    EXPECT_NEAR(small.drawn.intercept / T, 1, 2e-3);
    EXPECT_NEAR(small.coefficient / T, 1, 5e-3);
  }
}

// [-2, 2]^2 with the crack of the field, held by its displacements all around.
Body held_around(const exact::ExactField& field, const CrackLaw& law = {}) {
  Body b{.shape = rectangle({-2, -2}, {2, 2}), .element = element("bdms")};
  b.shape.cracks = {{"crack", {field.tips[0].at, field.tips[1].at}, {}}};
  b.scene.material = field.material;
  b.scene.laws = {law};
  for (Index label = 0; label < 4; ++label)
    b.scene.supports.push_back({label, false, true, true, [field](const Vec2& x, const Vec2&) {
                                  return field.displacement(x, exact::side_of(field, x));
                                }});
  return b;
}

// A crack that stays closed has no opening: T and the differences are rounding, and what they tend to is no fault.
TEST(HeldBody, AnOpeningOfAClosedCrackVanishes) {
  const exact::FrictionField f = exact::friction_table("c07_tresca");
  const Body b = held_around(f.field, {.slip_bound = std::abs(f.shear)});
  const Functional j{"", {crack_opening(0, {})}};
  for (const Kind kind : {Kind::Hole, Kind::ClampedHole, Kind::Crack}) {
    const Validation v = validated(b, j, {-1.36, -1.2}, {.kind = kind});
    EXPECT_EQ(v.verdict, Verdict::Vanishes) << text(v);
  }
}

// What a clamped hole does to the square of the displacement is a difference of two parts, and here passes through zero
// at a radius of 6e-4: what the prediction leaves is a share of the parts.
TEST(HeldBody, AClampedHoleWhosePredictionPassesThroughZeroDoesNotFail) {
  Body b = held_around(exact::table_field("c01b_modeI_biaxial"));
  const Functional j{"", {displacement_tracking({}, {})}};
  const auto found = [&](const std::vector<double>& radii) {
    return validated(b, j, {-1.68, -0.24}, {.kind = Kind::ClampedHole}, radii);
  };
  const std::vector<double> small{0.02, 0.01, 0.005, 0.0025, 0.00125, 6e-4};
  // The mesh leaves 0.1 % of the parts, and another one says so.
  const Validation coarse = found(small);
  EXPECT_EQ(coarse.verdict, Verdict::NothingSaid) << text(coarse);
  EXPECT_NE(coarse.reason.find("the differences tend to 0.99"), std::string::npos) << coarse.reason;
  EXPECT_NE(coarse.reason.find("; but a change of radius 0.02 drawn on another mesh says"), std::string::npos)
      << coarse.reason;
  b.sizing.size = 0.05;
  EXPECT_NE(found(usual_radii).verdict, Verdict::Fails);
  const Validation fine = found(small);
  EXPECT_EQ(fine.verdict, Verdict::Holds) << text(fine);
  for (const ValidationRow& r : fine.rows) EXPECT_GT(r.size, std::abs(r.predicted));
}

// The file gives E* only where it gives anything: these nu*, and for the last two E*, are the round numbers whose T of
// both functionals agree with its own.
TEST(Inclusion, Stiff) {
  compare_rows("cantilever_incl_stiff", plane_stress(1, 0.3), {Kind::Inclusion, plane_stress(20, 0.1)}, 1e-4, 2e-4);
}
TEST(Inclusion, Soft) {
  compare_rows("cantilever_incl_soft", plane_stress(1, 0.3), {Kind::Inclusion, plane_stress(0.1, 0.45)}, 1e-4, 2e-4);
}
// Locking noise of the reference's elements, up to 1.1e-3: the remainder of its D is not of order 4, ours is.
TEST(Inclusion, InANearlyIncompressibleBody) {
  compare_rows("cantilever_incl_strain_nu.4999", plane_strain(1, 0.4999), {Kind::Inclusion, plane_strain(3, 0.2)},
               1.2e-3, 1.2e-3);
}
TEST(Inclusion, NearlyIncompressible) {
  compare_rows("cantilever_incl_to_incompressible", plane_strain(1, 0.2), {Kind::Inclusion, plane_strain(0.3, 0.4999)},
               2e-4, 2e-4);
}
TEST(Ellipse, TwoToOneAtThirtyDegrees) {
  const Perturbation p{.kind = Kind::Ellipse, .aspect = 2, .angle = pi / 6};
  compare_rows("cantilever_ellipse_2:1_30deg", plane_stress(1, 0.3), p, 1e-4, 3e-4);
}

}  // namespace
}  // namespace kerf::validate_test
