// Edge cracks of bodies that are meshed and solved. Truths from outside: a disc and a crack at a hole (exact), the
// handbook's strip, closed forms of critical length and life, and cracks drawn and solved with exact contact.

#include "kerf/edge_cracks.hpp"

#include "kerf/adaptive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace kerf::inspect::edge_cracks_test {
namespace {

constexpr double koiter = 1.1215222552, degree = pi / 180;

struct Body {
  Shape shape;
  Scene scene;
  Sizing sizing;
};
struct Solved {
  Body body;
  Model model;
  State state;
};

Solved solved(Body b, const Element& e = bdms(2)) {
  Model m = prepare(triangulate(b.shape, b.sizing), e, b.scene, 1);
  State s = solve(m);
  return {std::move(b), std::move(m), std::move(s)};
}

BoundaryField pull(const Mat2& stress) {
  return [stress](const Vec2&, const Vec2& n) -> Vec2 { return stress * n; };
}

Mat2 stress(double xx, double yy) {
  return Mat2{{xx, 0}, {0, yy}};
}

/// A rectangle about the origin under a stress at its sides.
Body plate(double width, double height, const Mat2& s) {
  Body b;
  const double w = width / 2, h = height / 2;
  b.shape.outline = polygon("outline", {{-w, -h}, {w, -h}, {w, h}, {-w, h}}, 0);
  b.shape.labels = {"sides"};
  b.scene.material = plane_strain(1000, 0.3);
  b.scene.tractions = {{0, pull(s)}};
  b.sizing = {.size = height / 12, .curved = true};
  return b;
}

Body holed(const Mat2& s) {
  Body b = plate(40, 40, s);
  b.shape.holes = {circle("hole", {0, 0}, 1, 1)};
  b.shape.labels.push_back("hole");
  b.sizing.size = 2.5;
  return b;
}

const EdgeCrack& nearest(const EdgeCrackMap& map, const Vec2& x) {
  return *std::ranges::min_element(map.places, {}, [&](const EdgeCrack& c) { return (c.at - x).squaredNorm(); });
}

TEST(EdgeCracks, OfADiscUnderAllRoundTension) {
  Body b;
  b.shape.outline = circle("outline", {0, 0}, 1, 0);
  b.shape.labels = {"rim"};
  b.scene.material = plane_stress(100, 0.3);
  b.scene.tractions = {{0, pull(stress(1, 1))}};
  b.sizing = {.size = 0.3, .curved = true};
  const Solved s = solved(b);
  for (const double a : {0.02, 0.1}) {
    const double exact = koiter * std::pow(1 - a / 2, -1.5) * std::sqrt(pi * a);
    const EdgeCrackMap map = edge_cracks(s.model, s.state, {.length = a, .angle = pi / 2});
    EXPECT_EQ(map.masked_share, 0);
    for (const EdgeCrack& crack : map.places) {
      EXPECT_NEAR(crack.curvature, 1, 1e-9);
      EXPECT_NEAR(crack.K, exact, 0.01 * exact);
      EXPECT_NEAR(crack.G, crack.K * crack.K / 100, 1e-9);
    }
  }
}

TEST(EdgeCracks, AtAHole) {
  const Solved s = solved(holed(stress(1, 0)));
  // The plate is 40 wide: its hole has 0.3 % more stress than that of the table.
  const EdgeCrackMap map = edge_cracks(s.model, s.state, {.length = 0.05});
  ASSERT_GE(map.worst.size(), 2u);
  for (const std::size_t i : {map.worst[0], map.worst[1]}) {
    const EdgeCrack& crack = map.places[i];
    EXPECT_NEAR(std::abs(crack.at.y()), 1, 0.01);
    EXPECT_NEAR(crack.curvature, -1, 1e-9);
    EXPECT_NEAR(crack.K, 3.037342 * std::sqrt(pi * 0.05), 0.015 * 3.04 * std::sqrt(pi * 0.05));
    EXPECT_NEAR(crack.first_order, koiter * 3 * std::sqrt(pi * 0.05), 0.01 * 3.36 * std::sqrt(pi * 0.05));
  }
  // Under compression at the side of the hole.
  const EdgeCrack& side = nearest(map, {1, 0});
  EXPECT_TRUE(side.closed);
  EXPECT_EQ(side.K_I, 0);
  EXPECT_GT(std::abs(side.K_II), 0.4 * std::sqrt(pi * 0.05));
}

TEST(EdgeCracks, CriticalLengthAndLifeOfAStrip) {
  Body b = plate(40, 60, stress(0, 100));
  const Solved s = solved(b);
  growth::GrowthLaw law{growth::Paris{1e-11, 3}};
  law.K_c = 180;
  const EdgeCrackRequest request{.length = 0.3, .points = {{-20, 0.1}}};
  const EdgeCrackMap map = edge_cracks(s.model, s.state, request, ToleranceRequest{.law = law, .factor = 3});
  ASSERT_EQ(map.places.size(), 1u);
  const double F = koiter * 100 * std::sqrt(pi);  // K = F sqrt(a)
  EXPECT_NEAR(map.places[0].K, F * std::sqrt(0.3), 1e-3 * F);
  const double critical = std::pow(180 / F, 2);
  const Tolerance& t = map.tolerance[0];
  EXPECT_EQ(t.how, Tolerated::Critical);
  EXPECT_NEAR(t.critical_length, critical, 0.01 * critical);
  const double N = 2 / (1e-11 * std::pow(F, 3)) * (1 / std::sqrt(0.3) - 1 / std::sqrt(critical));
  EXPECT_NEAR(t.cycles, N, 0.01 * N);
  EXPECT_NEAR(t.interval, t.cycles / 3, 1e-9 * N);
  EXPECT_NEAR(map.safe_length, critical, 0.01 * critical);
  // Critical already, and never.
  law.K_c = 50;
  const Tolerance now = edge_cracks(s.model, s.state, request, ToleranceRequest{.law = law}).tolerance[0];
  EXPECT_EQ(now.cycles, 0);
  EXPECT_NEAR(now.critical_length, std::pow(50 / F, 2), 0.01 * std::pow(50 / F, 2));
  law.K_c = infinity;
  law.threshold = 400;
  EXPECT_EQ(edge_cracks(s.model, s.state, request, ToleranceRequest{.law = law}).tolerance[0].how, Tolerated::Rests);
}

// The handbook of H. Tada, P. C. Paris and G. R. Irwin, section 2.10 (0.5 % up to a/W = 0.6): what valid_length is for.
TEST(EdgeCracks, AtTheSideOfAStrip) {
  const double W = 10;
  const Solved s = solved(plate(W, 40, stress(0, 1)));
  for (const double x : {0.02, 0.05, 0.081}) {
    const EdgeCrackMap map = edge_cracks(s.model, s.state, {.length = x * W, .points = {{-W / 2, 0.1}}});
    const double F = 1.122 - 0.231 * x + 10.55 * x * x - 21.71 * std::pow(x, 3) + 30.382 * std::pow(x, 4);
    EXPECT_EQ(map.places[0].masked, Masked::No);
    EXPECT_NEAR(map.places[0].K / std::sqrt(pi * x * W), F, 0.05 * F) << x;
    EXPECT_NEAR(map.places[0].valid_length, std::sqrt(0.05 / 7.5) * W, 1e-6 * W);
  }
  EXPECT_EQ(edge_cracks(s.model, s.state, {.length = 0.1 * W, .points = {{-W / 2, 0.1}}}).places[0].masked,
            Masked::Near);
}

/// Drawn cracks at the places of a map that lie nearest to `at`.
std::vector<DrawnPlace> draw(const Solved& s, const std::vector<Vec2>& at, const std::vector<double>& lengths) {
  const EdgeCrackRequest request{.length = lengths[0], .points = at};
  const EdgeCrackMap map = edge_cracks(s.model, s.state, request);
  return draw_cracks(*recover_state(s.model, s.state), {s.body.shape, s.body.sizing}, request, map.places, lengths, {});
}

void expect_to_hold(const std::vector<DrawnPlace>& drawn, double error) {
  for (const DrawnPlace& place : drawn) {
    EXPECT_EQ(place.verdict, Verdict::Holds) << place.reason;
    for (const DrawnEdge& row : place.rows) EXPECT_LT(row.error, error) << row.length;
  }
}

// A convex rim whose stress falls outwards: 1 - (1 + 3 nu)/(3 + nu) of that in the middle.
TEST(EdgeCracks, AtTheRimOfARotatingDisc) {
  Body b;
  b.shape.outline = circle("outline", {0, 0}, 1, 0);
  b.shape.labels = {"rim"};
  b.scene.material = plane_stress(100, 0.3);
  b.scene.body = [](const Vec2& x) -> Vec2 { return x; };
  b.sizing = {.size = 0.2, .curved = true};
  const Solved s = solved(std::move(b), bdms(3));
  const EdgeCrackMap map = edge_cracks(s.model, s.state, {.length = 0.05});
  for (const EdgeCrack& crack : map.places) EXPECT_NEAR(crack.stress, (1 - 0.3) / 4, 2e-3);
  expect_to_hold(draw(s, {{1, 0}}, {0.1, 0.05}), 0.03);
}

/// A quarter of a ring of inner radius 1, held at one end and pushed at the other.
Body curved_beam(double thickness) {
  Body b;
  const Vec2 o(0, 0);
  const double R = 1 + thickness;
  b.shape.outline.name = "outline";
  b.shape.outline.sides = {{{R, 0}, 0, Arc{o, R * Mat2::Identity(), 0, pi / 2}},
                           {{0, R}, 1, {}},
                           {{0, 1}, 0, Arc{o, Mat2::Identity(), pi / 2, 0}},
                           {{1, 0}, 2, {}}};
  b.shape.labels = {"free", "held", "pushed"};
  b.scene.material = plane_stress(100, 0.3);
  b.scene.supports = {{1, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  b.scene.tractions = {{2, [](const Vec2&, const Vec2&) -> Vec2 { return {1, 0}; }}};
  b.sizing = {.size = 0.15 * std::min(thickness, 1.), .curved = true};
  return b;
}

// The hollow side, up to the end of valid_length.
TEST(EdgeCracks, OfCurvedBeams) {
  const double r = std::sqrt(0.5);
  for (const double thickness : {0.5, 1., 2.}) {
    const Solved s = solved(curved_beam(thickness), bdms(3));
    const EdgeCrackMap map = edge_cracks(s.model, s.state, {.length = 0.01, .points = {{r, r}}});
    EXPECT_NEAR(map.places[0].curvature, -1, 1e-6);
    const double longest = map.places[0].valid_length;
    expect_to_hold(draw(s, {{r, r}}, {longest * 0.999, longest / 2}), 0.05);
  }
}

/// A plate in tension with a notch of depth 2 at its side, whose sides stand open by an angle.
Body notched(double opening) {
  Body b = plate(20, 24, stress(0, 1));
  const double h = 2 * std::tan(opening / 2);
  b.shape.outline = polygon("outline", {{-10, -12}, {10, -12}, {10, 12}, {-10, 12}, {-10, h}, {-8, 0}, {-10, -h}}, 0);
  for (const std::size_t notch : {3u, 4u, 5u, 6u}) b.shape.outline.sides[notch].label = 1;
  b.shape.labels.push_back("left");
  b.sizing.size = 2;
  return b;
}

// The crack on the bisector of a reentrant corner against drawn ones.
TEST(EdgeCracks, AtANotch) {
  for (const double opening : {30., 90., 120.}) {
    const Solved s = solved(notched(opening * degree), bdms(3));
    const EdgeCrackRequest request{.length = 0.08, .points = {{-8, 0}}};
    const EdgeCrackMap map = edge_cracks(s.model, s.state, request);
    const EdgeCrack& crack = map.places[0];
    EXPECT_EQ(crack.masked, Masked::No);
    EXPECT_NEAR(crack.direction().x(), 1, 1e-9);
    EXPECT_LT(std::abs(crack.K_II), 0.01 * crack.K_I);
    const std::vector<DrawnPlace> drawn = draw_cracks(*recover_state(s.model, s.state), {s.body.shape, s.body.sizing},
                                                      request, map.places, {0.08, 0.04}, {});
    for (const DrawnEdge& row : drawn[0].rows) {
      EXPECT_TRUE(row.valid);
      EXPECT_LT(row.error, 0.03) << opening << ' ' << row.length << ' ' << row.K_I << ' ' << row.predicted_I << ' '
                                 << drawn[0].reason;
    }
  }
}

TEST(EdgeCracks, MasksByName) {
  Body b;
  b.shape.outline = polygon("outline", {{0, 0}, {10, 0}, {10, 4}, {4, 4}, {4, 10}, {0, 10}}, 0);
  b.shape.labels = {"sides", "held"};
  b.shape.outline.sides[4].label = 1;
  b.scene.material = plane_strain(1000, 0.3);
  b.scene.supports = {{1, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  b.scene.body = [](const Vec2&) -> Vec2 { return {0, -1}; };
  b.sizing = {.size = 0.5};
  const Solved s = solved(b);
  const EdgeCrackMap map = edge_cracks(s.model, s.state, {.length = 0.1});
  EXPECT_EQ(nearest(map, {2, 10}).masked, Masked::Support);
  EXPECT_EQ(nearest(map, {4.1, 4}).masked, Masked::Reentrant);
  EXPECT_EQ(nearest(map, {9.9, 0}).masked, Masked::Convex);
  EXPECT_EQ(nearest(map, {7, 4}).masked, Masked::No);
  const EdgeCrackMap longer = edge_cracks(s.model, s.state, {.length = 0.5});
  EXPECT_EQ(nearest(longer, {7, 4}).masked, Masked::Near);
  for (const std::size_t i : map.worst) EXPECT_EQ(map.places[i].masked, Masked::No);
}

TEST(EdgeCracks, RefusesWhatItDoesNotKnow) {
  const Solved s = solved(plate(10, 10, stress(1, 0)));
  EXPECT_THROW(edge_cracks(s.model, s.state, {.length = 0}), Error);
  EXPECT_THROW(edge_cracks(s.model, s.state, {.length = 0.1, .angle = 20 * degree}), Error);
  EXPECT_THROW(edge_cracks(s.model, s.state, {.length = 0.1, .friction = -1}), Error);
  EXPECT_THROW(edge_cracks(s.model, s.state, {.length = 0.1}, ToleranceRequest{}), Error);
}

// The expansion against cracks that are drawn: open at the top and at 45 degrees of a hole, closed at its side.
TEST(EdgeCracks, DrawnCracksHold) {
  const Solved s = solved(holed(stress(1, 0)), bdms(3));
  const double r = std::sqrt(0.5);
  const EdgeCrackRequest request{.length = 0.05, .points = {{0, 1}, {r, r}, {1, 0}}};
  const EdgeCrackMap map = edge_cracks(s.model, s.state, request);
  const std::vector<DrawnPlace> drawn = draw_cracks(*recover_state(s.model, s.state), {s.body.shape, s.body.sizing},
                                                    request, map.places, {0.1, 0.05, 0.02}, {});
  ASSERT_EQ(drawn.size(), 3u);
  for (const DrawnPlace& place : drawn) {
    EXPECT_EQ(place.verdict, Verdict::Holds) << place.reason;
    EXPECT_LT(place.rows[1].error, 0.02);
    EXPECT_LT(place.rows[2].error, 0.015);  // of the state at 45 degrees, where the stress is a third
  }
  EXPECT_GT(drawn[0].rows[0].first_order, 1.15 * drawn[0].rows[0].K_I);  // what the second order is worth
}

}  // namespace
}  // namespace kerf::inspect::edge_cracks_test
