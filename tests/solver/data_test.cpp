// Data without enclosures, as sampled; body forces on triangles; resultants.

#include "solver/data.hpp"
#include "kerf/adaptive.hpp"
#include "solver/resultants.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::data_test {
namespace {

const EdgeLine edge{Vec2(2, 1), Vec2(1.8, 1), Vec2(0, 1)};

double mean(const EdgeValues& v, int component = 0) {
  return v.at.row(component).dot(gauss(data_points).w.transpose());
}

EdgeValues values_of(const std::function<double(double)>& f) {
  return edge_values([f](const Vec2& x, const Vec2&) { return Vec2(f(x.x()), 0); }, edge, "load");
}

TEST(Data, BlackBoxesAreSampledWhereTheyAreRough) {
  const EdgeValues step = values_of([](double x) { return x < 1.937 ? 3.0 : 1.0; });
  EXPECT_EQ(step.how, Resolution::Sampled);
  EXPECT_TRUE(step.jumps);
  EXPECT_NEAR(mean(step), (3 * 0.137 + 0.063) / 0.2, 1e-5);
  const EdgeValues kink = values_of([](double x) { return std::abs(x - 1.937); });
  EXPECT_FALSE(kink.jumps);
  EXPECT_NEAR(mean(kink), 0.5 * (0.137 * 0.137 + 0.063 * 0.063) / 0.2, 1e-9);
  EXPECT_GT(kink.rest[0], 0);
  const EdgeValues smooth = values_of([](double x) { return std::exp(x); });
  EXPECT_NEAR(mean(smooth), (std::exp(2) - std::exp(1.8)) / 0.2, 1e-12);
}

TEST(Data, WhatIsNotFiniteIsRefusedWithItsPlace) {
  try {
    values_of([](double x) { return x < 1.9 ? nan : 0; });
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Numerics);
    EXPECT_NE(std::string(e.what()).find("the load is not finite at (1.8"), std::string::npos) << e.what();
  }
}

// The rest of a step: its mean square is what P leaves of the mean square of f.
TEST(Data, LeaveOutWhatProjectionsLeaveOut) {
  const EdgeValues v = values_of([](double x) { return x < 1.937 ? 3.0 : 1.0; });
  const double square = (9 * 0.137 + 0.063) / 0.2;
  EXPECT_NEAR(v.rest[0], square - v.at.row(0).cwiseAbs2().dot(gauss(data_points).w.transpose()), 1e-4);
  EXPECT_LT(v.primitive[0], v.rest[0] / 100);
}

TEST(Data, TrianglesAreCutWhereTheForceIsRough) {
  const std::array<Vec2, 3> corners{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
  const TriangleRule rule = triangle_rule(8);
  const auto half = [](const Vec2& x) { return Vec2(x.x() < 0.31 ? 1 : 0, x.y()); };
  const TriangleValues v = triangle_values(VectorField(half), corners, rule);
  EXPECT_FALSE(v.whole);
  EXPECT_NEAR(v.at.row(0).dot(rule.w.transpose()), 1 - 0.69 * 0.69, 2e-3);
  EXPECT_NEAR(v.at.row(1).dot(rule.w.transpose()), 1. / 3, 1e-12);
  EXPECT_GT(v.rest, 0.01);
  const TriangleValues smooth =
      triangle_values(VectorField([](const Vec2& x) { return Vec2(std::exp(x.x()), 0); }), corners, rule);
  EXPECT_TRUE(smooth.whole);
  EXPECT_NEAR(smooth.at.row(0).dot(rule.w.transpose()), 2 * (std::exp(1) - 2), 1e-9);
}

TEST(Data, FieldsAreSums) {
  const VectorField one([](const Vec2&) { return Vec2(1, 2); }), none;
  const VectorField linear = linear_field([](const Vec2& x) { return Vec2(x.y(), -x.x()); });
  EXPECT_EQ(sum(one, none)(Vec2(3, 4)), Vec2(1, 2));
  EXPECT_EQ(sum(one, linear)(Vec2(3, 4)), Vec2(5, -1));
  EXPECT_EQ(sum(one, linear).known(), nullptr);
  ASSERT_TRUE(sum(linear, linear).known());
  EXPECT_EQ(sum(linear, linear).known()->degree(), 1);
  const auto box = sum(linear, linear).known()->over({0, 1}, {2, 3});
  EXPECT_LE(box[0].low, 4);
  EXPECT_GE(box[0].high, 6);
}

// A square held below, pressed aside by 2 above with a weight of 3.
TEST(Data, ReactionsAreWhatHoldsTheBody) {
  Shape shape;
  shape.outline = polygon("outline", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0);
  shape.labels = {"bottom", "rest", "top"};
  for (const int side : {1, 3}) shape.outline.sides[static_cast<std::size_t>(side)].label = 1;
  shape.outline.sides[2].label = 2;
  Scene scene;
  scene.material = plane_strain(1, 0.3);
  scene.body = [](const Vec2&) { return Vec2(0, -3); };
  scene.supports.push_back({0, false, true, true, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }});
  scene.tractions.push_back({2, [](const Vec2&, const Vec2&) { return Vec2(2, 0); }});
  for (const char* name : {"bdms", "afw", "p2"}) {
    const Model m = prepare(triangulate(shape, {.size = 0.3}), element(name), scene, 1);
    const std::vector<LabelResultant> held = reactions(m, solve(m));
    ASSERT_EQ(held.size(), 1U);
    EXPECT_EQ(held[0].label, 0);
    EXPECT_NEAR(held[0].of.force.x(), -2, 1e-10) << name;
    EXPECT_NEAR(held[0].of.force.y(), 3, 1e-10) << name;
    EXPECT_NEAR(held[0].of.moment, 3 * 0.5 + 2, 1e-10) << name;
    const std::vector<LabelResultant> loads = traction_resultants(m.mesh, {}, m.scene, m.inner->data);
    ASSERT_EQ(loads.size(), 1U);
    EXPECT_NEAR(loads[0].of.moment, -2, 1e-12);
    const Resultant body = body_resultant(m.mesh, {}, m.scene, m.inner->data, m.inner->kernel.load);
    EXPECT_NEAR(body.moment, -1.5, 1e-12);
  }
}

}  // namespace
}  // namespace kerf::data_test
