// Every factor of every formula, changed by 1 %, turns a verdict "holds" into "fails" at points that validation chooses
// itself. A program of its own, whose formulas are built with KERF_MUTATIONS.

#include "kerf/second_order.hpp"
#include "tests/topo/disc_series.hpp"
#include "tests/topo/validation.hpp"
#include "topo/mutation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf {
namespace {

using namespace scenes;
using Kind = Perturbation::Kind;
using Part = FormulaPart;

struct Mutants {
  const char* name;
  Term term;
  Perturbation p;
  std::vector<Part> parts;
  bool body = false, pressed = false;
};

const BoundaryField measured = [](const Vec2& x, const Vec2&) { return Vec2(2 * x.x(), 12 + 4 * x.x()); };

std::vector<Mutants> all() {
  const Perturbation stiff{Kind::Inclusion, plane_strain(8, 0.1)}, soft{Kind::Inclusion, plane_strain(0.3, 0.45)};
  return {
      {"hole_compliance", compliance(), {}, {Part::HoleProduct, Part::HoleTrace, Part::Energy, Part::BodyForce}, true},
      {"hole_tracking",
       displacement_tracking([](const Vec2&) { return Vec2(0, -30); }, {}),
       {},
       {Part::Dual, Part::LocalDensity, Part::BodyForce},
       true},
      {"hole_misfit", misfit(2, measured), {}, {Part::Measured}},
      {"hole_power", stress_power(2, {}, true), {}, {Part::PowerOutside, Part::PowerSlope, Part::PowerExterior}},
      {"inclusion_power", stress_power(2, {}, true), soft, {Part::PowerInside}},
      {"inclusion", boundary_tracking(2, {}, {}), stiff, {Part::InclusionTrace, Part::InclusionDeviator}},
      {"ellipse",
       compliance(),
       {.kind = Kind::Ellipse, .aspect = 2, .angle = 0.5},
       {Part::EllipseProduct, Part::EllipseTrace, Part::EllipseShorter, Part::EllipseLonger}},
      {"open_crack", compliance(), {.kind = Kind::Crack}, {Part::CrackNormal}},
      {"pressed_crack", compliance(), {.kind = Kind::Crack}, {Part::CrackTangential}, false, true},
      {"clamped_hole",
       compliance(),
       {.kind = Kind::ClampedHole},
       {Part::ClampedLogarithm, Part::ClampedRegular, Part::ClampedForce}},
  };
}

class Factor1Percent : public testing::TestWithParam<Mutants> {
 protected:
  void TearDown() override {
    mutation = {};
  }
  // At these points, or where validation chooses to.
  std::vector<Validation> run(const std::vector<Vec2>& points = {}) const {
    const Mutants& m = GetParam();
    Scene s;
    s.material = plane_strain(1, 0.3);
    s.supports = {clamp(0)};
    const double sign = m.pressed ? -1 : 1;
    s.tractions = {{2, [=](const Vec2& x, const Vec2&) { return Vec2(0.4, sign * (2 + 0.3 * x.x())); }},
                   {1, [=](const Vec2&, const Vec2&) { return Vec2(sign * 1.2, 0.2); }}};
    if (m.body) s.body = [](const Vec2&) { return Vec2(0.4, -2); };
    const Shape shape = rectangle({-1, -1}, {1, 1});
    const Sizing sizing{.size = 0.25};
    const std::vector<double> radii =
        m.p.kind == Kind::Crack ? std::vector<double>{0.1, 0.05, 0.025} : std::vector<double>{0.1, 0.05, 0.025, 0.0125};
    return validate({shape, sizing}, element("bdms", 1), s, {"", {m.term}}, {points, radii, m.p, 2});
  }
};

TEST_P(Factor1Percent, IsNoticed) {
  std::vector<Vec2> held;
  std::string words;
  for (const Validation& v : run()) {
    EXPECT_NE(v.verdict, Verdict::Fails) << text(v);
    if (v.verdict == Verdict::Holds) held.push_back(v.at);
    words += text(v);
  }
  ASSERT_FALSE(held.empty()) << words;
  for (const Part part : GetParam().parts) {
    mutation = {part, 1.01};
    bool fails = false;
    words.clear();
    for (const Validation& v : run(held)) {
      fails = fails || v.verdict == Verdict::Fails;
      words += text(v);
      for (const Mode& m : v.modes) words += fmt::format("    {} {:.3g}\n", m.name, m.value / v.coefficient);
    }
    EXPECT_TRUE(fails) << "part " << static_cast<int>(part) << "\n" << words;
  }
}
INSTANTIATE_TEST_SUITE_P(Formulas, Factor1Percent, testing::ValuesIn(all()),
                         [](const auto& info) { return std::string(info.param.name); });

// A part of the second term that is left out turns "holds" into "fails".
TEST(SecondTerm, ValidationNoticesAMissingPart) {
  Scene s;
  s.material = plane_strain(1, 0.3);
  s.supports = {clamp(0)};
  s.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0.8 - x.x(), 0.3 + 2 * x.x() * x.x()); }}};
  const auto run = [&](const Perturbation& p) {
    std::vector<Validation> all = validate({rectangle({-1, -1}, {1, 1}), {.size = 0.2}}, element("bdms", 2), s,
                                           {"", {compliance()}}, {{{0.3, 0.2}, {-0.4, 0.4}}, usual_radii, p, 2});
    return all;
  };
  const Perturbation stiff{Kind::Inclusion, plane_strain(8, 0.1)};
  for (const Perturbation& p : {Perturbation{}, stiff}) {
    mutation = {};
    for (const Validation& v : run(p)) EXPECT_EQ(v.verdict, Verdict::Holds) << text(v);
    for (const Part part : {Part::SecondMeanGradient, Part::SecondDeviatorGradient, Part::SecondCurvature,
                            Part::SecondReplyMean, Part::SecondReplyDeviator, Part::SecondInclusion}) {
      if (part == Part::SecondInclusion && p.kind == Kind::Hole) continue;
      mutation = {part, part == Part::SecondInclusion ? -1. : 0.};
      bool fails = false;
      std::string words;
      for (const Validation& v : run(p)) {
        fails = fails || v.verdict == Verdict::Fails;
        words += text(v) + fmt::format(" c2 {} {}\n", v.c2_predicted, v.c2);
      }
      EXPECT_TRUE(fails) << "part " << static_cast<int>(part) << "\n" << words;
    }
  }
  mutation = {};
}

// Of the second term against discs whose series are exact: the largest error, of the sum of its parts.
double second_error(const Analysis& a, const Functional& j, const series::Polynomial& loads) {
  using series::Complex;
  double worst = 0;
  const Material& m = a.model->scene.material;
  const std::optional<Material> inside[] = {std::nullopt, plane_strain(5, 0.2)};
  for (const Complex x : {Complex(0, 0), Complex(.3, .1)})
    for (const auto& in : inside) {
      const Perturbation p = in ? Perturbation{Kind::Inclusion, *in} : Perturbation{};
      const double exact = series::limits(m, in, x, loads, 0.2 * (1 - std::abs(x))).c2;
      const SecondOrder s = second_order(a, j, p, {x.real(), x.imag()});
      const double parts =
          std::abs(s.mean_gradient) + std::abs(s.deviator_gradient) + std::abs(s.curvature) + std::abs(s.reply);
      worst = std::max(worst, std::abs(s.c2 - exact) / parts);
    }
  return worst;
}

TEST(SecondTerm, OnePercentInAnyFactorIsNoticed) {
  using series::Complex;
  const series::Polynomial loads{{Complex(.4, 0), Complex(.3, -.2), Complex(-.15, .1)},
                                 {Complex(.5, -.3), Complex(-.2, .25), Complex(.1, .12)}};
  Shape shape;
  shape.labels = {"rim"};
  shape.outline = circle("rim", {0, 0}, 1, 0);
  Scene scene{.material = plane_strain(1, 0.3)};
  scene.tractions.push_back(
      {0, [&](const Vec2& x, const Vec2& n) -> Vec2 { return series::stress(loads, Complex(x.x(), x.y())) * n; }});
  const Model m = prepare(triangulate(shape, {.size = 0.06}), element("bdms", 2), scene, 1);
  const State s = solve(m);
  const Functional j{"energy", {energy()}};
  const Analysis a = analyze(j, m, s);
  EXPECT_LT(second_error(a, j, loads), 1e-4);
  for (const Part part : {Part::SecondMeanGradient, Part::SecondDeviatorGradient, Part::SecondCurvature,
                          Part::SecondReplyMean, Part::SecondReplyDeviator, Part::SecondInclusion}) {
    mutation = {part, 1.01};
    EXPECT_GT(second_error(a, j, loads), 5e-4) << "part " << static_cast<int>(part);
  }
  mutation = {};
}

}  // namespace
}  // namespace kerf
