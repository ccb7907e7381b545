// Validations and functionals that make no sense are refused in words; where no points are asked for, good ones are
// chosen.

#include "kerf/analysis.hpp"
#include "kerf/map.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf {
namespace {

using namespace scenes;

template <class F>
std::string refusal(const F& f) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage) << e.what();
    return e.what();
  }
  return "no refusal";
}

Body plate() {
  return {cracked_square(), pulled(plane_strain(1, 0.3), opens), {.size = 0.3}, element("bdms", 1)};
}

std::vector<Validation> validations(const Body& b, const ValidationRequest& r) {
  return validate({b.shape, b.sizing}, b.element, b.scene, {"", {energy()}}, r);
}

TEST(ValidationRequests, RadiiThatCannotBe) {
  const auto with = [](std::vector<double> radii, const Perturbation& p = {}) {
    return refusal([&] { validations(plate(), {{{0.5, 0.5}}, std::move(radii), p}); });
  };
  EXPECT_EQ(with({}), "validation needs positive radii; give radii in [validate]");
  EXPECT_EQ(with({0.1, 0}), "validation needs positive radii; give radii in [validate]");
  EXPECT_EQ(with({0.1, -0.1}), "validation needs positive radii; give radii in [validate]");
  EXPECT_EQ(with({0.1, 1e-9}), "radius 1e-09 of the validation is too small for a mesh: use 2.8e-06 or more");
  EXPECT_EQ(with({0.1, 0.099}),
            "radii 0.1 and 0.099 of the validation lie too close together: each should be 1.05 times the next or more");
  EXPECT_EQ(with({0.1, 0.05}, {.kind = Perturbation::Kind::Ellipse, .aspect = 11}),
            "validation resolves ellipses of aspect 10 at most, not 11; the map goes further");
}

TEST(ValidationRequests, PlacesWithoutRoom) {
  const std::vector<Validation> v = validations(plate(), {{{2, 0}, {1, 0.5}, {0, 0}, {0.5, 0.99}}, {0.1, 0.05}});
  for (const Validation& at : v) EXPECT_EQ(at.verdict, Verdict::OutOfRange) << at.reason;
  EXPECT_EQ(v[0].reason, "the point lies outside the body");
  for (const int i : {1, 2})
    EXPECT_EQ(v[std::size_t(i)].reason, "the point lies on a boundary or a crack, or in the ring of the functional");
  EXPECT_EQ(v[3].reason,
            "no radius fits: the nearest boundary, crack or other feature is 0.01 away; use radii below 0.0025");
}

TEST(ValidationRequests, PointsAreChosenWithRoomAndApart) {
  const Body b = plate();
  for (const auto kind : {Perturbation::Kind::Hole, Perturbation::Kind::ClampedHole}) {
    const std::vector<Validation> v = validations(b, {{}, {0.08, 0.04, 0.02}, {.kind = kind}});
    ASSERT_GE(v.size(), 1u);
    ASSERT_LE(v.size(), 2u);
    for (const Validation& at : v) {
      const double to_side = 1 - at.at.cwiseAbs().maxCoeff(),
                   to_crack = std::hypot(at.at.y(), std::max(0.0, std::abs(at.at.x()) - 0.4));
      EXPECT_GT(std::min(to_side, to_crack), 0.08) << text(at);
      for (const ValidationRow& r : at.rows) EXPECT_TRUE(std::isfinite(r.difference)) << text(at);
    }
    if (v.size() == 2) {
      EXPECT_GT((v[0].at - v[1].at).norm(), 0.25 * std::sqrt(8.0));
    }
  }
  // The ring of an energy release rate that leaves no room beside it.
  const Functional everywhere{"", {energy_release_rate({0.4, 0}, {1, 0}, {0.06, 3}, {})}};
  EXPECT_EQ(refusal([&] {
              validate({b.shape, b.sizing}, b.element, b.scene, everywhere, {{}, {0.08, 0.04}});
            }),
            "validation finds no point with room for a radius; give points");
}

struct Prepared {
  Model model;
  State state;
};
Prepared prepared(const Body& b) {
  Prepared p{prepare(triangulate(b.shape, b.sizing), b.element, b.scene, 1), {}};
  p.state = solve(p.model);
  return p;
}

TEST(FunctionalRequests, BodiesThatTheyDoNotKnow) {
  const auto said = [](const Body& b, std::vector<Term> terms, bool value_only = false) {
    const Prepared p = prepared(b);
    return refusal([&] { analyze({"", terms}, p.model, p.state, value_only); });
  };
  Body rough = plate();
  rough.scene.laws[0].friction = 0.5;
  EXPECT_EQ(said(rough, {energy()}),
            "topological derivatives need cracks without friction: the state does not minimize the energy; remove "
            "friction and tresca");
  EXPECT_EQ(said(rough, {energy()}, true), "no refusal");

  Body warm = plate();
  warm.scene.eigenstrain = {{.normal = [](const Vec2&) { return Vec2(1e-3, 1e-3); },
                             .shear = [](const Vec2&) { return Vec2(0, 1e-3); },
                             .out_of_plane = true}};
  EXPECT_NE(said(warm, {energy_release_rate({0.4, 0}, {1, 0}, {0.06, 0.2}, {})})
                .find("cannot be taken in a body with an eigenstrain"),
            std::string::npos);
  EXPECT_NE(said(warm, {stress_power(2, {}, false)}).find("knows no stress out of the plane from an eigenstrain"),
            std::string::npos);
  EXPECT_EQ(said(warm, {energy()}), "no refusal");

  const BoundaryField measured = [](const Vec2&, const Vec2&) { return Vec2(0, 0.1); };
  EXPECT_EQ(said(plate(), {misfit(2, measured)}), "no refusal");
  EXPECT_EQ(said(plate(), {misfit(2, measured), misfit(2, measured)}), "a sum may hold one misfit only");

  const ScalarField negative = [](const Vec2&) { return -1.0; };
  EXPECT_NE(said(plate(), {stress_pnorm(4, negative, false)}).find("is negative: its weight must not be"),
            std::string::npos);
}

TEST(ClampedHoles, BodiesThatTheyDoNotKnow) {
  const auto said = [](const Body& b, const Term& term = energy()) {
    const Prepared p = prepared(b);
    const Functional j{"", {term}};
    const Analysis a = analyze(j, p.model, p.state);
    const std::vector<Vec2> at = {{0.5, 0.5}};
    return refusal(
        [&] { map_at(a, j, {.perturbation = {.kind = Perturbation::Kind::ClampedHole}, .radius = 0.02}, at); });
  };
  EXPECT_EQ(said(plate()), "no refusal");
  Body floating = plate();
  floating.scene.supports.clear();
  floating.scene.tractions = {{0, [](const Vec2&, const Vec2&) { return Vec2(0, -1); }},
                              {2, [](const Vec2&, const Vec2&) { return Vec2(0, 1); }}};
  EXPECT_NE(said(floating).find("the supports leave the body a rigid motion"), std::string::npos) << said(floating);
  Body filled = plate();
  filled.shape.regions = {circle("r", {-0.5, -0.5}, 0.2, none)};
  filled.scene.regions = {plane_strain(2, 0.3)};
  EXPECT_NE(said(filled).find("its Green tensor is known in one material only"), std::string::npos) << said(filled);
  // Pulled along itself a crack neither opens nor presses.
  Body along = plate();
  along.scene.supports = {{3, false, true, false, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }},
                          {0, false, false, true, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }}};
  along.scene.tractions = {{1, [](const Vec2&, const Vec2&) { return Vec2(1, 0); }}};
  EXPECT_NE(said(along).find("cracks with neither gap nor pressure respond to it one-sidedly"), std::string::npos)
      << said(along);
  EXPECT_NE(said(plate(), stress_power(2, {}, false)).find("the stress around a clamped hole is singular"),
            std::string::npos);
}

}  // namespace
}  // namespace kerf
