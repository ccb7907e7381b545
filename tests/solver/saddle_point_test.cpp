// The saddle-point formulation in the smooth domain against the condensed one: the same discrete solution.
#include "solver/saddle_point.hpp"
#include "solver/system.hpp"

#include "kerf/mesher.hpp"
#include "tests/solver/scenes.hpp"
#include "tests/support/exact.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::saddle_point_test {
namespace {

const std::vector<CrackLaw> one_crack(1);

// Relative to the condensed solution: stress and displacement in L2, traces, jumps and forces in the maximum norm.
struct Difference {
  double stress = 0, displacement = 0, rotation = 0, traces = 0, jumps = 0, forces = 0;
  double pressure = 0;  // of the stress the uniform pressure, which the others do not see
  double worst() const {
    return std::max({stress, displacement, rotation, traces, jumps, forces});
  }
};

Difference difference(const Model& m, const State& a, const State& b) {
  double stress = 0, stresses = 0, trace = 0, u = 0, us = 0, r = 0, rs = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Points x = rule_points(m.inner->kernel.rule, triangle(m, t));
    const Fields f = evaluate(m, a, t, x), g = evaluate(m, b, t, x);
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      const double w = area(m.mesh, t) * m.inner->kernel.rule.w[q];
      const Eigen::Vector4d change = f.stress.col(q) - g.stress.col(q);
      stress += w * change.squaredNorm();
      stresses += w * f.stress.col(q).squaredNorm();
      trace += w * (change[0] + change[3]);
      u += w * (f.displacement.col(q) - g.displacement.col(q)).squaredNorm();
      us += w * f.displacement.col(q).squaredNorm();
      r += w * std::pow(f.rotation[q] - g.rotation[q], 2);
      rs += w * std::pow(f.rotation[q], 2);
    }
  }
  const auto largest = [](const auto& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0; };
  const auto relative = [](double error, double size) { return size > 0 ? error / size : error; };
  const Index base = m.inner->skeleton.base, jumps = m.inner->skeleton.total - base;
  const double uniform = trace * trace / (2 * area(m));
  Difference d;
  d.stress = std::sqrt(relative(std::max(stress - uniform, 0.0), stresses));
  d.pressure = std::sqrt(relative(uniform, stresses));
  d.displacement = std::sqrt(relative(u, us));
  d.rotation = std::sqrt(relative(r, rs));
  d.traces = relative(largest((a.skeleton - b.skeleton).head(base)), largest(a.skeleton.head(base)));
  d.jumps = relative(largest((a.skeleton - b.skeleton).tail(jumps)), largest(a.skeleton));
  d.forces = relative(largest(a.force - b.force), largest(a.force));
  return d;
}

Difference compare(const Model& m, const std::string& which) {
  const State condensed = solve(m), saddle = solve_saddle_point(m);
  EXPECT_TRUE(certified(condensed)) << which;
  EXPECT_TRUE(certified(saddle)) << which;
  const Difference d = difference(m, condensed, saddle);
  return d;
}

struct Named {
  const char* name;
  int degree;
};
constexpr std::array all{Named{"bdms", 1},
                         Named{"bdms", 2},
                         Named{"bdms", 3},
                         Named{"bdms", 4},
                         Named{"bdms-c", 1},
                         Named{"peers", 1},
                         Named{"afw", 1},
                         Named{"afw", 2},
                         Named{"afw", 3},
                         Named{"afw", 4},
                         Named{"arnold-winther-nc", 1}};

std::string describe(const Named& n) {
  return n.name + std::to_string(n.degree);
}

TEST(SaddlePoint, AgreesOnTheSmoothSolution) {
  const Scene scene = scene_of(exact::wave_field(0.3), {0, 3});
  for (const Named& n : all) {
    const Model m = prepare(exact::unit_square_mesh(8, 0.2), element(n.name, n.degree), scene, 1);
    const Difference d = compare(m, describe(n));
    EXPECT_LT(std::max(d.worst(), d.pressure), 1e-12) << describe(n);
  }
}

TEST(SaddlePoint, AgreesOnTheCrackCases) {
  for (const Named& n : all)
    for (const char* which : {"I", "II", "III", "IV"})
      for (const int size : {8, 16}) {
        if (size > 8 && n.name != std::string("bdms") && n.name != std::string("peers")) continue;
        if (size > 8 && n.degree > 1) continue;
        const Scene scene = scene_of(exact::crack_case(which), {0, 1, 2, 3}, one_crack);
        const Model m = prepare(exact::crack_mesh(size), element(n.name, n.degree), scene, 1);
        const Difference d = compare(m, describe(n) + " case " + which);
        EXPECT_LT(std::max(d.worst(), d.pressure), 1e-12) << describe(n) << " case " << which << ' ' << size;
      }
}

// The penalty iterations against the saddle point, which needs none.
TEST(SaddlePoint, NoDigitsAreLostTowardsIncompressibility) {
  for (const Named& n : all)
    for (const double rest : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 0.0}) {
      const Scene scene = scene_of(exact::wave_field(0.5 - rest), {0, 3});
      const Model m = prepare(exact::unit_square_mesh(8), element(n.name, n.degree), scene, 1);
      const Difference d = compare(m, describe(n) + " 1/2 - " + std::to_string(rest));
      EXPECT_LT(std::max(d.worst(), d.pressure), 1e-10) << describe(n) << ' ' << rest;
    }
}

// mean(tr s) = (integral of u.n)/(2 c |body|): towards nu = 1/2 rounding decides the level of pressure in either
// formulation (less in the condensed one, which solves for it by itself); all else keeps its digits.
TEST(SaddlePoint, EnclosedBodiesDifferByTheRoundingOfTheirPressure) {
  for (const Named& n : {all[0], all[1], all[4], all[8]})
    for (const double rest : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 0.0}) {
      const Scene scene = scene_of(exact::wave_field(0.5 - rest), {0, 1, 2, 3});
      const Model m = prepare(exact::unit_square_mesh(8), element(n.name, n.degree), scene, 1);
      const Difference d = compare(m, describe(n) + " enclosed 1/2 - " + std::to_string(rest));
      EXPECT_LT(d.worst(), 1e-10) << describe(n) << ' ' << rest;
      EXPECT_LT(d.pressure, rest > 0 ? 1e-11 + 2e-15 / rest : 1e-11) << describe(n) << ' ' << rest;
    }
}

Scene pressed(std::size_t cracks, CrackLaw law = {}) {
  Scene s;
  s.supports.push_back({0, false, true, true, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }});
  s.tractions.push_back({2, [](const Vec2& x, const Vec2&) { return Vec2(0.4, -0.6 + x.x()); }});
  s.body = [](const Vec2& x) { return Vec2(0.1, -0.2 * x.x()); };
  s.laws.assign(cracks, law);
  return s;
}

Mesh square_with(std::vector<Crack> cracks, double size = 0.4, double tip = 0.1) {
  Shape shape{.outline = polygon("outline", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, 0),
              .holes = {},
              .cracks = std::move(cracks),
              .labels = {"bottom", "right", "top", "left"}};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[i].label = i;
  return triangulate(shape, {.size = size, .crack_tip_size = tip});
}

const std::vector<Crack> kinked{{"kinked", {{-0.5, -0.2}, {0.1, 0}, {0.4, 0.4}}, {}}};
const std::vector<Crack> mouth{{"mouth", {{-1, 0.1}, {0.1, -0.1}}, {}}};
const std::vector<Crack> crossing{{"one", {{-0.6, -0.1}, {0.6, 0.1}}, {}}, {"two", {{-0.1, -0.5}, {0.1, 0.5}}, {}}};

TEST(SaddlePoint, AgreesOnCracksOfAnyShape) {
  for (const auto& cracks : {kinked, mouth, crossing}) {
    const Mesh mesh = square_with(cracks);
    for (const Named& n : all) {
      if (n.degree > 2) continue;
      const Model m = prepare(mesh, element(n.name, n.degree), pressed(cracks.size()), 1);
      const Difference d = compare(m, describe(n) + " " + cracks[0].name);
      EXPECT_LT(std::max(d.worst(), d.pressure), 1e-11) << describe(n) << ' ' << cracks[0].name;
    }
  }
}

TEST(SaddlePoint, AgreesOnEveryLaw) {
  using Kind = CrackLaw::Kind;
  const Mesh mesh = square_with(crossing);
  for (const CrackLaw& law : {CrackLaw{Kind::Open}, CrackLaw{Kind::Bonded}, CrackLaw{Kind::Unilateral, 0.3},
                              CrackLaw{Kind::Unilateral, 0, 0.1}})
    for (const Named& n : {all[0], all[3], all[4], all[6]}) {
      const Model m = prepare(mesh, element(n.name, n.degree), pressed(2, law), 1);
      const Difference d = compare(m, describe(n) + " law " + std::to_string(static_cast<int>(law.kind)));
      EXPECT_LT(std::max(d.worst(), d.pressure), 1e-11) << describe(n) << ' ' << static_cast<int>(law.kind);
    }
}

TEST(SaddlePoint, AgreesOnCracksInIncompressibleBodies) {
  const Mesh mesh = square_with(crossing);
  for (const Named& n : {all[0], all[1], all[4], all[8]})
    for (const double c : {1e-7, 1e-12, 0.0}) {
      Scene scene = pressed(2);
      scene.material.c = c;
      const Model m = prepare(mesh, element(n.name, n.degree), scene, 1);
      const Difference d = compare(m, describe(n) + " c " + std::to_string(c));
      EXPECT_LT(std::max(d.worst(), d.pressure), 1e-10) << describe(n) << ' ' << c;
    }
}

TEST(SaddlePoint, UnitsAndSmallTrianglesDoNotMatter) {
  Mesh mesh = square_with(kinked, 0.3, 3e-4);
  for (Vec2& x : mesh.points) x *= 1e-3;
  Scene scene = pressed(1);
  scene.material = {8e10, 1e-12};
  const Model m = prepare(mesh, element("bdms"), scene, 1);
  const Difference d = compare(m, "units");
  EXPECT_LT(std::max(d.worst(), d.pressure), 1e-10);
}

TEST(SaddlePoint, RollersAndFloatingBodies) {
  const Mesh mesh = square_with(kinked);
  for (const Named& n : {all[0], all[1], all[3], all[8]}) {
    Scene rolling = pressed(1);
    rolling.supports[0].second = false;
    rolling.supports.push_back({1, true, true, false, [](const Vec2& x, const Vec2&) { return Vec2(0.1 * x.y(), 0); }});
    rolling.supports.push_back({3, false, false, true, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }});
    const Model held = prepare(mesh, element(n.name, n.degree), rolling, 1);
    const Difference h = compare(held, describe(n) + " rollers");
    EXPECT_LT(std::max(h.worst(), h.pressure), 1e-11) << describe(n);

    Scene balanced;
    for (Index label = 0; label < 4; ++label)
      balanced.tractions.push_back({label, [](const Vec2& x, const Vec2& normal) {
                                      const Mat2 stress = (Mat2() << 1, 0.3, 0.3, -0.5).finished();
                                      return Vec2((1 + 0 * x.x()) * stress * normal);
                                    }});
    balanced.laws.resize(1);
    const Model floating = prepare(mesh, element(n.name, n.degree), balanced, 1);
    ASSERT_EQ(floating.inner->floating.size(), 3u);
    const Difference f = compare(floating, describe(n) + " floating");
    EXPECT_LT(std::max(f.worst(), f.pressure), 1e-10) << describe(n);
  }
}

TEST(SaddlePoint, NeedsNoFactor) {
  const Scene scene = scene_of(exact::crack_case("III"), {0, 1, 2, 3}, one_crack);
  const Model with = prepare(exact::crack_mesh(8), element("bdms"), scene, 1),
              without = prepare(exact::crack_mesh(8), element("bdms"), scene, 2, {.factorize = false});
  const State a = solve_saddle_point(with), b = solve_saddle_point(without);
  EXPECT_EQ(a.skeleton, b.skeleton);
  EXPECT_EQ(a.interior, b.interior);
  EXPECT_EQ(a.force, b.force);
}

void expect_refusal(const Model& m, Fault fault, const std::string& part) {
  try {
    solve_saddle_point(m);
    FAIL() << "not refused: " << part;
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, fault);
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}

TEST(SaddlePoint, RefusesWhatItCannotDo) {
  const Mesh mesh = exact::unit_square_mesh(4, 0.2);
  const Scene smooth = scene_of(exact::wave_field(0.3), {0, 3});
  for (const char* name : {"arnold-winther", "arnold-winther-c", "p1", "p2"})
    expect_refusal(prepare(mesh, element(name), smooth, 1), Fault::Usage, "has no saddle-point system");

  Scene swollen = scene_of(exact::wave_field(0.5), {0, 1, 2, 3});
  swollen.supports[1].value = [](const Vec2&, const Vec2&) { return Vec2(0.1, 0); };
  expect_refusal(prepare(mesh, element("bdms"), swollen, 1, {.factorize = false}), Fault::Numerics,
                 "change its area by");

  Scene enclosed = scene_of(exact::crack_case("III"), {0, 1, 2, 3}, one_crack);
  enclosed.material.c = 0;
  expect_refusal(prepare(exact::crack_mesh(8), element("bdms"), enclosed, 1, {.factorize = false}), Fault::Numerics,
                 "wholly enclosed");
}

}  // namespace
}  // namespace kerf::saddle_point_test
