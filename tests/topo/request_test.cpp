// Validations and functionals that make no sense are refused in words; where no points are asked for, good ones are
// chosen.

#include "kerf/analysis.hpp"
#include "kerf/map.hpp"
#include "kerf/shape_gradient.hpp"
#include "tests/topo/validation.hpp"
#include "topo/analysis.hpp"
#include "topo/changes.hpp"
#include "topo/responses.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::request_test {
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
    EXPECT_EQ(v[std::size_t(i)].reason,
              "the point lies on a boundary, a crack or a jump of the data, or in the ring of the functional");
  EXPECT_EQ(v[3].reason,
            "no radius fits: the nearest boundary, crack, jump of the data or other feature is 0.01 away; use radii "
            "below 0.0025");
  // Outside of the body and yet in the ring of a functional.
  const Body b = plate();
  const Functional rate{"", {energy_release_rate({0.4, 0}, {1, 0}, {0.06, 3}, {})}};
  const Validation beyond = validate({b.shape, b.sizing}, b.element, b.scene, rate, {{{2, 0}}, {0.1, 0.05}}).front();
  EXPECT_EQ(beyond.reason, "the point lies outside the body");
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
  EXPECT_EQ(said(rough, {energy()}), "no refusal");
  EXPECT_EQ(
      said(rough, {misfit(2, [](const Vec2&, const Vec2&) { return Vec2(0, 0.1); })}),
      "functional \"misfit\" needs cracks without friction for its derivatives: neither of its two states minimizes "
      "an energy; remove friction and tresca, or track the displacements (boundary_tracking)");

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
  warm.scene.eigenstrain[0].out_of_plane = false;
  EXPECT_EQ(said(warm, {stress_power(2, {}, false)}), "no refusal");

  const BoundaryField measured = [](const Vec2&, const Vec2&) { return Vec2(0, 0.1); };
  EXPECT_EQ(said(plate(), {misfit(2, measured)}), "no refusal");
  EXPECT_EQ(said(plate(), {misfit(2, measured), misfit(2, measured)}), "a sum may hold one misfit only");

  const ScalarField negative = [](const Vec2&) { return -1.0; };
  EXPECT_NE(said(plate(), {stress_pnorm(4, negative, false)}).find("is negative: its weight must not be"),
            std::string::npos);
}

/// Uniaxial stress along a crack leaves its faces in touch, without pressure.
Body pulled_along() {
  Body b = plate();
  b.scene.supports = {{3, false, true, false, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }},
                      {0, false, false, true, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }}};
  b.scene.tractions = {{1, [](const Vec2&, const Vec2&) { return Vec2(1, 0); }}};
  return b;
}

TEST(FunctionalRequests, RoughFacesThatTouchWithoutPressure) {
  Body b = pulled_along();
  b.scene.laws[0].friction = 0.3;
  const Prepared p = prepared(b);
  try {
    analyze({"", {energy()}}, p.model, p.state);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Numerics);
    EXPECT_NE(std::string(e.what()).find("on they touch without pressure, on 0.8 of the 0.8 of the crack"),
              std::string::npos)
        << e.what();
  }
}

/// Measurements that a uniform state explains, whatever else loads the body.
TEST(FunctionalRequests, AMisfitOfItsOwnStateIsNothing) {
  Body b{rectangle({-1, -1}, {1, 1}), {}, {.size = 0.6}, element("bdms", 1)};
  const Mat2 stress = Vec2(0.5, 1).asDiagonal();
  b.scene.material = plane_strain(1, 0.3);
  const auto moved = [&](const Vec2& x, const Vec2&) -> Vec2 { return strain(b.scene.material, stress) * x; };
  b.scene.supports = {{3, false, true, false, moved}, {0, false, false, true, moved}};
  for (const Index label : {1, 2})
    b.scene.tractions.push_back({label, [stress](const Vec2&, const Vec2& n) -> Vec2 { return stress * n; }});
  const Prepared p = prepared(b);
  const Functional gap{"", {misfit(2, moved)}};
  const Analysis a = analyze(gap, p.model, p.state);
  EXPECT_NEAR(a.value, 0, 1e-12);
  EXPECT_NEAR(map_at(a, gap, {}, std::vector<Vec2>{{0.2, 0.3}})[0].value, 0, 1e-12);
  // Twice the displacement on top: the other load still does its work.
  const Functional twice{"", {misfit(2, [&](const Vec2& x, const Vec2& n) -> Vec2 { return 2 * moved(x, n); })}};
  EXPECT_GT(analyze(twice, p.model, p.state, true).value, 0.1);
}

TEST(FunctionalRequests, OfABodyAtRest) {
  Body b = plate();
  b.scene.tractions.clear();
  const Prepared p = prepared(b);
  const Functional norm{"", {stress_pnorm(3, {}, false)}};
  const Analysis a = analyze(norm, p.model, p.state);
  EXPECT_EQ(a.value, 0);
  EXPECT_EQ(a.slope.front(), 0);  // of a root at zero: finite all the same
  EXPECT_EQ(map_at(a, norm, {}, std::vector<Vec2>{{0.5, 0.5}})[0].value, 0);
}

/// At the tip itself the cut-off is flat, and has no direction.
TEST(FunctionalRequests, TheReleaseRateHasADensityAtItsTip) {
  const Vec2 tip(0.4, 0);
  const VectorField body = [](const Vec2&) { return Vec2(0, -2); };
  FieldPoint at{.x = tip, .stress = (Mat2() << 1, 0.3, 0.3, 2).finished(), .rotation = 0.1};
  at.material = plane_stress(1, 0.3);
  EXPECT_EQ(energy_release_rate(tip, {1, 0}, {0.06, 0.2}, {}).density(at).value, 0);
  // The body force times the derivative of the displacement along the crack.
  EXPECT_NEAR(energy_release_rate(tip, {1, 0}, {0.06, 0.2}, body).density(at).value,
              2 * (strain(at.material, at.stress)(1, 0) - at.rotation), 1e-15);
}

TEST(FunctionalRequests, LoadsAndSupportsThatTheyDoNotKnow) {
  const auto said = [](const Body& b, const Term& term) {
    const Prepared p = prepared(b);
    return refusal([&] { analyze({"", {term}}, p.model, p.state); });
  };
  // A pressure in a crack, within the ring of a tip of it and away from that of another one.
  Body pressed = plate();
  pressed.shape.cracks.push_back({"other", {Vec2(-0.3, 0.6), Vec2(0.3, 0.6)}, {}});
  pressed.scene.laws.resize(2);
  pressed.scene.laws[1].pressure = [](const Vec2&, const Vec2&) { return Vec2(1, 0); };
  const auto release = [](const Vec2& tip) { return energy_release_rate(tip, {1, 0}, {0.06, 0.2}, {}); };
  EXPECT_NE(said(pressed, release({0.3, 0.6})).find("does not know the work of a pressure in the crack"),
            std::string::npos);
  EXPECT_EQ(said(pressed, release({0.4, 0})), "no refusal");
  // What sees displacements needs supports, what sees stresses does not.
  Body floating = plate();
  floating.scene.supports.clear();
  floating.scene.tractions = {{0, [](const Vec2&, const Vec2&) { return Vec2(0, -1); }},
                              {2, [](const Vec2&, const Vec2&) { return Vec2(0, 1); }}};
  const Prepared f = prepared(floating);
  for (const Term& term : {displacement_tracking({}, {}), boundary_tracking(2, {}, {})}) {
    const Functional j{"", {term}};
    EXPECT_NE(refusal([&] { require_supports(j, f.model); }).find("sees rigid motions"), std::string::npos);
  }
  for (const Term& term : {stress_power(2, {}, true), energy()}) {
    const Functional j{"", {term}};
    EXPECT_EQ(refusal([&] { require_supports(j, f.model); }), "no refusal");
  }
  // A weight beyond all numbers.
  const Prepared p = prepared(plate());
  try {
    analyze({"",
             {stress_power(
                 2, [](const Vec2&) { return 1e308; }, true)}},
            p.model, p.state);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Numerics);
    EXPECT_STREQ(e.what(), "the functional overflows: scale its weights or factors");
  }
}

TEST(FunctionalRequests, ReadingsAreOfTheBoundary) {
  const auto said = [](const Body& b, const Term& term) {
    const Prepared p = prepared(b);
    return refusal([&] { responses(p.model, p.state, std::span(&term, 1)); });
  };
  Term reading{.kind = "reading", .linear = true, .label = 2};
  reading.on_boundary = [](const Vec2&, const Vec2&, const Vec2& u) {
    return Density{.value = u.y(), .by_displacement = Vec2(0, 1)};
  };
  EXPECT_EQ(said(plate(), reading), "no refusal");
  Body rough = plate();
  rough.scene.laws[0].friction = 0.3;
  EXPECT_EQ(said(rough, reading), "responses of readings need cracks without friction; remove friction and tresca");
  const std::string words = "readings are integrals of the displacement over a part of the boundary";
  for (const Term& term : {energy(), compliance(), stress_power(2, {}, true), crack_opening(0, {}), volume()})
    EXPECT_EQ(said(plate(), term), words) << term.kind;
  // Nor may one weigh something else besides.
  std::vector<Term> more(5, reading);
  more[0].density = volume().density;
  more[1].on_crack = crack_opening(0, {}).on_crack;
  more[2].measured = clamp(2);
  more[3].energy = true;
  more[4].work = true;
  for (const Term& term : more) EXPECT_EQ(said(plate(), term), words) << &term - more.data();
  EXPECT_EQ(said(plate(), misfit(2, [](const Vec2&, const Vec2&) { return Vec2(0, 0); })), words);
  Body floating = plate();
  floating.scene.supports.clear();
  floating.scene.tractions.clear();
  EXPECT_NE(said(floating, reading).find("sees rigid motions"), std::string::npos);
}

/// The integral of a power of the stress knows what a change does to its own density.
TEST(FunctionalRequests, StressPowersAroundChanges) {
  const Term law = stress_power(4, {}, false);
  const Material m = plane_stress(1, 0.3);
  FieldPoint at{.x = {0, 0}, .stress = (Mat2() << 1, 0.3, 0.3, 2).finished(), .material = m};
  using Kind = Perturbation::Kind;
  EXPECT_NE(refusal([&] { law.local({.kind = Kind::ClampedHole}, at); }).find("around which the stress is singular"),
            std::string::npos);
  // Of its own material, and where the weight is zero: nothing.
  Perturbation same{.kind = Kind::Inclusion, .inclusion = m};
  EXPECT_EQ(law.local(same, at), 0);
  same.inclusion = plane_stress(2, 0.3);
  EXPECT_NE(law.local(same, at), 0);
  same.inclusion.mu = m.mu;
  same.inclusion.c = 0.5 * m.c;
  EXPECT_NE(law.local(same, at), 0);
  const Term nowhere = stress_power(
      4, [](const Vec2&) { return 0.0; }, false);
  EXPECT_EQ(nowhere.local({}, at), 0);
  // A round ellipse is a hole; its direction does not matter then.
  const double hole = law.local({}, at);
  for (const double angle : {0.0, 0.7})
    EXPECT_NEAR(law.local({.kind = Kind::Ellipse, .aspect = 1, .angle = angle}, at), hole, 1e-6 * std::abs(hole));
  // A slit along the only stress there is disturbs nothing. (At its tips a fourth power is not integrable.)
  const Term third = stress_power(3, {}, false);
  at.stress << 1, 0, 0, 0;
  EXPECT_NEAR(third.local({.kind = Kind::Crack, .angle = 0}, at), 0, 1e-9);
  EXPECT_GT(third.local({.kind = Kind::Crack, .angle = pi / 2}, at), 0.1);
  // One that presses closes, and then stands in nobody's way either.
  at.stress << 0, 0, 0, -1;
  EXPECT_NEAR(third.local({.kind = Kind::Crack, .angle = 0}, at), 0, 1e-9);
  for (const double p : {0.5, 101.0, nan})
    EXPECT_NE(refusal([&] { stress_power(p, {}, true).local({}, at); }).find("it must lie in [1, 100]"),
              std::string::npos);
}

TEST(ShapeDerivatives, EigenstrainsAreRefused) {
  Body warm = plate();
  warm.scene.eigenstrain = {
      {.normal = [](const Vec2&) { return Vec2(1e-3, 1e-3); }, .shear = [](const Vec2&) { return Vec2(0, 0); }}};
  const Prepared p = prepared(warm);
  const Functional j{"", {energy()}};
  const Analysis a = analyze(j, p.model, p.state);
  EXPECT_NE(refusal([&] { shape_gradient(a, j); }).find("an eigenstrain stays while the material moves"),
            std::string::npos);
}

TEST(Changes, WhatCannotBeMade) {
  Body b = plate();
  const Functional j{"", {energy()}};
  const auto said = [&](const Perturbation& p) {
    const Meshing meshing{b.shape, b.sizing};
    const std::vector<Scene> scenes{b.scene};
    const std::vector<SmallChange> changes{{{0.5, 0.5}, 0.05}};
    return refusal([&] { changes_at({meshing, b.element, scenes, j}, p, changes); });
  };
  EXPECT_EQ(said({}), "no refusal");
  EXPECT_EQ(said({.kind = Perturbation::Kind::Crack, .angle = 0}), "a small crack is no change of a disc");
  b.element = element("arnold-winther", 1);  // whose corners share unknowns
  EXPECT_NE(said({}), "no refusal");
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
  EXPECT_NE(said(pulled_along()).find("cracks with neither gap nor pressure respond to it one-sidedly"),
            std::string::npos);
  EXPECT_NE(said(plate(), stress_power(2, {}, false)).find("the stress around a clamped hole is singular"),
            std::string::npos);
}

}  // namespace
}  // namespace kerf::request_test
