// Finite changes in bodies whose triangles are curved, against a disc with a hole in closed form.

#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::curved_validation_test {
namespace {

using namespace scenes;

const Material steel = plane_strain(1, 0.3);

// The unit disc, its rim moved outwards by 1.
Body disc(bool curved, int degree, double size) {
  Body b;
  b.shape = {circle("outline", {0, 0}, 1, 0), {}, {}, {"rim"}, {}};
  b.scene.material = steel;
  b.scene.supports = {{0, false, true, true, [](const Vec2& x, const Vec2&) -> Vec2 { return x; }}};
  b.sizing = {.size = size, .curved = curved};
  b.element = element("bdms", degree);
  return b;
}

// Its strain energy with a free hole of radius r in the middle: u = a x + b x/|x|^2 without traction at r.
double stored(double r) {
  const double sum = 1 / (4 * steel.c), a = 1 / (1 + sum * r * r / steel.mu);
  return pi * 2 * sum * (1 - r * r) * a;
}

double quotient_at(double r) {
  return (stored(r) - stored(0)) / (pi * r * r);
}
/// Its limit, the derivative by the area.
double limit() {
  const double sum = 1 / (4 * steel.c);
  return -2 * sum * (1 + sum / steel.mu);
}

/// The largest relative error of (J(eps) - J(0))/area.
double worst(const Validation& v, const std::vector<double>& radii) {
  double largest = 0;
  for (std::size_t i = 0; i < radii.size(); ++i)
    largest = std::max(largest, std::abs(quotient(v, i) / quotient_at(radii[i]) - 1));
  return largest;
}

const std::vector<double> radii = {0.16, 0.08, 0.04, 0.02};

TEST(CurvedValidation, DifferencesAreThoseOfRoundHolesInARoundBody) {
  for (const int degree : {1, 2}) {
    const Functional j{"", {energy()}};
    const Validation chords = validated(disc(false, degree, 0.4), j, {0, 0}, {}, radii),
                     arcs = validated(disc(true, degree, 0.4), j, {0, 0}, {}, radii);
    SCOPED_TRACE(text(arcs) + text(chords));
    EXPECT_EQ(arcs.verdict, Verdict::Holds) << degree;
    EXPECT_NEAR(arcs.coefficient / limit(), 1, 1e-6);
    EXPECT_LT(worst(arcs, radii), (degree == 1 ? 0.3 : 0.01) * worst(chords, radii)) << degree;
    EXPECT_LT(worst(arcs, radii), degree == 1 ? 3e-5 : 3e-7) << degree;
  }
}

/// A strip with a round hole, clamped on its left.
Body strip() {
  Body b;
  b.shape = rectangle({0, 0}, {2, 1});
  b.shape.holes.push_back(circle("hole", {0.5, 0.5}, 0.2, 4));
  b.shape.labels.push_back("hole");
  b.scene.material = steel;
  b.scene.supports = {clamp(3)};
  b.scene.tractions = {{1, [](const Vec2&, const Vec2&) { return Vec2(0.3, -1); }}};
  b.sizing = {.size = 0.2, .curved = true};
  return b;
}

// Of an adjoint that is 3 % too large nothing holds; without the mutation it does.
TEST(CurvedValidation, AWrongAdjointFails) {
  Term right = displacement_tracking({}, {}), wrong = right;
  wrong.density = [of = right.density](const FieldPoint& p) {
    Density d = of(p);
    d.by_displacement *= 1.03;
    return d;
  };
  const std::vector<double> small = {0.08, 0.04, 0.02, 0.01};
  const Validation good = validated(strip(), {"", {right}}, {1.1, 0.4}, {}, small),
                   bad = validated(strip(), {"", {wrong}}, {1.1, 0.4}, {}, small);
  EXPECT_EQ(good.verdict, Verdict::Holds) << text(good);
  EXPECT_EQ(bad.verdict, Verdict::Fails) << text(bad);
}

// An inclusion and an ellipse of finite size have curved rims, too.
TEST(CurvedValidation, InclusionsAndEllipsesHold) {
  using Kind = Perturbation::Kind;
  for (const Kind kind : {Kind::Inclusion, Kind::Ellipse}) {
    Perturbation p{.kind = kind};
    p.inclusion = plane_strain(5, 0.2);
    if (kind == Kind::Ellipse) p.aspect = 2;
    const Validation v = validated(strip(), {"", {compliance()}}, {1.1, 0.4}, p, {0.08, 0.04, 0.02, 0.01});
    EXPECT_EQ(v.verdict, Verdict::Holds) << text(v);
  }
}

}  // namespace
}  // namespace kerf::curved_validation_test
