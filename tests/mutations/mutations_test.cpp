// Every factor of every formula, changed by 1 %, turns a verdict "holds" into "fails" at points that validation chooses
// itself. A program of its own, whose formulas are built with KERF_MUTATIONS.

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

}  // namespace
}  // namespace kerf
