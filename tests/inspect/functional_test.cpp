// The worst crack of the boundary as a functional: its value against closed forms and the map of edge cracks, its
// derivatives against whole solves on moved points and on bodies that are changed.

#include "kerf/edge_cracks.hpp"
#include "kerf/shape_gradient.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::inspect::functional_test {
namespace {

using namespace scenes;

constexpr double koiter = 1.1215222552;

Model pulled_strip(double width, double height, const Element& e = bdms(1)) {
  Scene s;
  s.material = plane_stress(100, 0.3);
  for (const Index side : {0, 2}) s.tractions.push_back({side, [](const Vec2&, const Vec2& n) -> Vec2 { return n; }});
  return prepare(triangulate(rectangle({0, 0}, {width, height}), {.size = width / 12}), e, s, 1);
}

// Places within 2.5 to 5 lengths of a corner count less: 3.75 lengths are lost at each.
TEST(WorstEdgeCrack, OfAStripInTension) {
  const Model m = pulled_strip(4, 8);
  const State state = solve(m);
  const double a = 0.2, K = koiter * std::sqrt(pi * a);
  for (const double p : {2., 8., 40.}) {
    const Functional j{"worst_edge_crack", {worst_edge_crack({1, 3}, a, p)}};
    const double length = 2 * (8 - 2 * 3.75 * a);
    EXPECT_NEAR(analyze(j, m, state, true).value, K * std::pow(length, 1 / p), 2e-3 * K * std::pow(length, 1 / p)) << p;
  }
  // Sides across the load bear nothing, and under compression no crack opens.
  EXPECT_NEAR(analyze({"", {worst_edge_crack({0}, a, 4)}}, m, state, true).value, 0, 1e-6);
  Model pressed = m;
  for (Traction& t : pressed.scene.tractions) t.value = [](const Vec2&, const Vec2& n) -> Vec2 { return -n; };
  pressed = prepare(pressed.mesh, pressed.element, pressed.scene, 1);
  const State closed = solve(pressed);
  EXPECT_EQ(analyze({"", {worst_edge_crack({1, 3}, a, 4)}}, pressed, closed).value, 0);
}

// [-1, 1]^2 with a hole (label 4), clamped at the bottom.
Shape holed_square() {
  Shape s = rectangle({-1, -1}, {1, 1});
  s.labels.push_back("hole");
  s.holes = {circle("hole", {-0.2, 0.3}, 0.3, 4)};
  return s;
}
Scene holed_scene() {
  Scene s = pulled(plane_strain(1, 0.3), [](const Vec2& x) { return Vec2(0.2, 1 + 0.3 * x.x()); });
  s.laws.clear();
  s.tractions.push_back({4, [](const Vec2& x, const Vec2& n) -> Vec2 { return -0.3 * (1 + x.x()) * n; }});
  s.body = [](const Vec2& x) { return Vec2(0.1 * x.y(), -0.2); };
  return s;
}

Scene pulled_square() {
  Scene s = holed_scene();
  s.tractions.pop_back();
  s.body = {};
  return s;
}

// The same sum over the places of the map, whose stresses are recovered and fitted. Both have the terms of curvature
// and of the slope with depth; at a tenth of the radius 1.12 stress sqrt(pi a) alone is some 20 % off.
TEST(WorstEdgeCrack, IsThatOfTheMap) {
  const double a = 0.03, p = 16;
  const Model m = prepare(triangulate(holed_square(), {.size = 0.15, .curved = true}), bdms(2), holed_scene(), 1);
  const State state = solve(m);
  const EdgeCrackMap map = edge_cracks(m, state, {.length = a, .angle = pi / 2});
  double sum = 0, first_order = 0, largest = 0;
  for (const EdgeCrack& c : map.places) {
    if ((c.at - Vec2(-0.2, 0.3)).norm() > 0.4) continue;
    sum += c.along * std::pow(c.K_I, p);
    first_order += c.along * std::pow(std::max(c.first_order, 0.), p);
    largest = std::max(largest, c.K_I);
  }
  const double J = analyze({"", {worst_edge_crack({4}, a, p)}}, m, state, true).value;
  EXPECT_NEAR(J, std::pow(sum, 1 / p), 0.01 * J);
  EXPECT_GT(std::pow(first_order, 1 / p), 1.1 * J);
  EXPECT_NEAR(J, largest, 0.15 * largest);
}

/// A motion of all points, or of those about the hole alone.
Points motion(const Mesh& mesh, bool all) {
  Points theta(2, static_cast<Eigen::Index>(mesh.points.size()));
  for (Eigen::Index v = 0; v < theta.cols(); ++v) {
    const Vec2& x = mesh.points[static_cast<std::size_t>(v)];
    const Vec2 d = x - Vec2(-0.2, 0.3);
    const double r = std::max(0.0, 1 - d.squaredNorm() / 0.4);
    theta.col(v) = all ? 0.1 * Vec2(std::sin(17 * x.x() + 5 * x.y()), std::cos(13 * x.y() - 7 * x.x()))
                       : Vec2(r * r * r * Vec2(1 + d.y(), 0.5 - 2 * d.x() * d.y()));
  }
  return theta;
}

class Derivative : public testing::TestWithParam<std::pair<const char*, int>> {};

// Chords of the hole have a curvature, which moves, too.
TEST_P(Derivative, IsThatOfTheWholeProgram) {
  const auto& [name, degree] = GetParam();
  const Element e = element(name, degree);
  const Mesh mesh = triangulate(holed_square(), {.size = 0.12});
  const Scene scene = holed_scene();
  for (const Functional& j : {Functional{"hole", {worst_edge_crack({4}, 0.05, 6)}},
                              Functional{"sides", {worst_edge_crack({1, 3}, 0.08, 3)}}}) {
    const Model m = prepare(mesh, e, scene, 1);
    const State state = solve(m);
    const Analysis a = analyze(j, m, state);
    ASSERT_GT(a.value, 0.1);
    const Points gradient = shape_gradient(a, j);
    for (const bool all : {false, true}) {
      const Points theta = motion(mesh, all);
      constexpr double step = 2e-5;  // no place crosses from one triangle to another
      double slope = 0;
      for (const auto& [at, weight] : {std::pair{1, 8}, {-1, -8}, {2, -1}, {-2, 1}}) {
        Mesh moved = mesh;
        for (std::size_t v = 0; v < moved.points.size(); ++v)
          moved.points[v] += at * step * theta.col(static_cast<Eigen::Index>(v));
        const Model there = prepare(std::move(moved), e, scene, 1);
        const State s = solve(there);
        slope += weight * analyze(j, there, s, true).value / (12 * step);
      }
      EXPECT_NEAR(gradient.cwiseProduct(theta).sum(), slope, 1e-6 * std::max(std::abs(slope), 0.05 * a.value))
          << j.kind << (all ? " all" : " hole") << " J " << a.value;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Elements, Derivative,
                         testing::Values(std::pair{"bdms", 1}, std::pair{"bdms", 2}, std::pair{"peers", 1},
                                         std::pair{"afw", 1}),
                         [](const auto& info) {
                           return std::string(info.param.first) + std::to_string(info.param.second);
                         });

// Changes of the body inside against finite sizes.
TEST(WorstEdgeCrack, TopologicalDerivativeHolds) {
  using Kind = Perturbation::Kind;
  const Body b{rectangle({-1, -1}, {1, 1}), pulled_square(), {.size = 0.15}, bdms(2)};
  const Functional j{"", {worst_edge_crack({3}, 0.1, 6)}};
  for (const Perturbation& p : {Perturbation{}, Perturbation{Kind::Inclusion, plane_strain(10, 0.3)},
                                Perturbation{Kind::Ellipse, {}, 3}, Perturbation{.kind = Kind::Crack}}) {
    const Validation v = validated(b, j, {-0.45, 0.2}, p, {0.08, 0.04, 0.02, 0.01});
    EXPECT_EQ(v.verdict, Verdict::Holds) << static_cast<int>(p.kind) << ' ' << text(v);
    EXPECT_NEAR(v.intercept / v.coefficient, 1, 1e-3) << text(v);
  }
  // Beneath the side a change meets the cracks themselves.
  EXPECT_EQ(validated(b, j, {-0.93, 0.2}, {}, {0.01}).verdict, Verdict::OutOfRange);
}

TEST(WorstEdgeCrack, RefusesByName) {
  const Model m = prepare(triangulate(holed_square(), {.size = 0.15}), bdms(1), holed_scene(), 1);
  const State state = solve(m);
  const auto refused = [&](std::vector<Index> labels, double length) -> std::string {
    try {
      analyze({"", {worst_edge_crack(std::move(labels), length, 4)}}, m, state);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(refused({0}, 0.05).find("leave sides with supports out"), std::string::npos);
  const Model thin = pulled_strip(0.3, 8);
  const State pulled = solve(thin);
  EXPECT_THROW(analyze({"", {worst_edge_crack({1}, 0.35, 4)}}, thin, pulled), Error);
  EXPECT_EQ(refused({4}, 0.05), "");
  EXPECT_THROW(worst_edge_crack({4}, 0, 4), Error);
  EXPECT_THROW(worst_edge_crack({4}, 1, 1), Error);
}

}  // namespace
}  // namespace kerf::inspect::functional_test
