// Meshes refined to an estimated error; contact along curved cracks on them.
#include "kerf/adaptive.hpp"

#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "kerf/recover.hpp"
#include "solver/saddle_point.hpp"
#include "tests/solver/scenes.hpp"
#include "tests/support/exact.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::adaptive_test {
namespace {

struct Square {
  Shape shape;
  Scene scene;
};

// Case III: partly closed by contact, exact displacements around.
Square cracked(const exact::ExactField& f) {
  Square s;
  s.shape.labels = {"outer"};
  s.shape.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
  s.shape.cracks = {{"c", {Vec2(-1, 0), Vec2(1, 0)}, {}}};
  s.scene.material = f.material;
  s.scene.laws.resize(1);
  s.scene.supports.push_back(
      {0, false, true, true, [f](const Vec2& x, const Vec2&) { return f.displacement(x, exact::side_of(f, x)); }});
  return s;
}

double true_error(const Adapted& a, const exact::ExactField& f) {
  const double norm = exact::stress_error(a.model.mesh, f, [](Index, const Vec2&) -> Mat2 { return Mat2::Zero(); });
  return exact::stress_error(a.model, a.state, f) / norm;
}

TEST(Adaptive, ReachesTheAskedErrorAtTheOptimalRateInTheNumberOfTriangles) {
  const exact::ExactField f = exact::crack_case("III");
  const Square s = cracked(f);
  for (const int degree : {1, 2}) {
    std::vector<double> size, error;
    for (const double wanted : {4e-3, 4e-3 / (degree == 1 ? 4 : 16)}) {
      const Adapted a = solve_adaptively(s.shape, {.size = 0.5, .crack_tip_size = 0.5}, element("bdms", degree),
                                         s.scene, {.error = wanted});
      EXPECT_EQ(a.stopped.rfind("reached", 0), 0u) << a.stopped;
      EXPECT_LE(a.rounds.size(), 9u);
      EXPECT_LE(a.indicator.relative, wanted);
      EXPECT_GT(a.indicator.relative, 0.3 * wanted);
      EXPECT_TRUE(certified(a.state));
      size.push_back(static_cast<double>(a.model.mesh.triangles.size()));
      error.push_back(true_error(a, f));
      EXPECT_LT(error.back(), 2 * wanted) << degree;
    }
    const double rate = std::log(error[0] / error[1]) / std::log(size[1] / size[0]);
    EXPECT_GT(rate, 0.8 * (degree + 1) / 2) << degree;  // h^(degree + 1) in two dimensions
  }
}

TEST(Adaptive, RemeshingTakesFewerRoundsThanBisection) {
  const exact::ExactField f = exact::crack_case("III");
  const Square s = cracked(f);
  const auto run = [&](Refinement refinement) {
    return solve_adaptively(s.shape, {.size = 0.5, .crack_tip_size = 0.5}, element("bdms"), s.scene,
                            {.error = 2.5e-3, .refinement = refinement});
  };
  const Adapted remeshed = run(Refinement::Remesh), bisected = run(Refinement::Bisect);
  EXPECT_EQ(bisected.stopped.rfind("reached", 0), 0u) << bisected.stopped;
  EXPECT_LT(true_error(bisected, f), 5e-3);
  EXPECT_LT(2 * remeshed.rounds.size(), bisected.rounds.size());
  // The ends of contact, graded for maps, take some hundred triangles.
  EXPECT_LT(static_cast<double>(remeshed.model.mesh.triangles.size()),
            1.5 * static_cast<double>(bisected.model.mesh.triangles.size()) + 500);
}

// Lame's ring under inner pressure, s = A I -+ B/r^2: new vertices lie on the arcs, so that the error falls at the
// order of the element by either way.
TEST(Adaptive, CurvedSidesStayCurvedAtTheRateOfTheElement) {
  const Shape ring{circle("outline", {0, 0}, 2, 0), {circle("hole", {0, 0}, 1, 1)}, {}, {"rim", "hole"}, {}};
  Scene scene;
  scene.material = {1, 0.1};
  scene.tractions.push_back({1, [](const Vec2&, const Vec2& n) { return Vec2(-n); }});
  exact::ExactField f{"ring", scene.material};
  f.stress = [](const Vec2& x, int) -> Mat2 {
    const double r2 = x.squaredNorm();
    return (Mat2::Identity() + 4 / r2 * (Mat2::Identity() - 2 / r2 * x * x.transpose())) / 3;
  };
  constexpr double energy = -pi * 0.5 * (0.4 / 3 + 4.0 / 3);
  for (const Refinement way : {Refinement::Remesh, Refinement::Bisect}) {
    std::vector<double> size, error;
    for (const double wanted : {4e-3, 1e-4}) {
      const Adapted a = solve_adaptively(ring, {.size = 0.7, .curved = true}, element("bdms", 2), scene,
                                         {.error = wanted, .refinement = way});
      EXPECT_EQ(a.stopped.rfind("reached", 0), 0u) << a.stopped;
      size.push_back(static_cast<double>(a.model.mesh.triangles.size()));
      double squares = 0, whole = 0;
      const TriangleRule rule = triangle_rule(12);
      for (Index t = 0; t < static_cast<Index>(a.model.mesh.triangles.size()); ++t) {
        const Triangle cell = triangle(a.model, t);
        const Points x = rule_points(rule, cell);
        const Eigen::VectorXd w = area(cell) * rule_weights(rule, cell);
        const Eigen::Matrix4Xd found = evaluate(a.model, a.state, t, x).stress;
        for (Eigen::Index q = 0; q < x.cols(); ++q) {
          const Mat2 there = f.stress(x.col(q), 0);
          squares += w[q] * (tensor(found.col(q)) - there).squaredNorm();
          whole += w[q] * there.squaredNorm();
        }
      }
      error.push_back(std::sqrt(squares / whole));
      EXPECT_LT(error.back(), 2 * wanted);
      EXPECT_NEAR(area(a.model), 3 * pi, wanted);
      EXPECT_NEAR(potential_energy(a.model, a.state), energy, 10 * wanted * wanted);
    }
    EXPECT_GT(std::log(error[0] / error[1]) / std::log(size[1] / size[0]), 0.8 * 3 / 2);
  }
}

TEST(Adaptive, SaysWhyItStops) {
  const exact::ExactField f = exact::crack_case("III");
  const Square s = cracked(f);
  const Sizing coarse{.size = 0.5, .crack_tip_size = 0.5};
  const Adapted few =
      solve_adaptively(s.shape, coarse, element("bdms"), s.scene, {.error = 1e-9, .max_triangles = 2000});
  EXPECT_EQ(few.stopped.rfind("stopped at max_triangles = 2000", 0), 0u) << few.stopped;
  EXPECT_LT(few.model.mesh.triangles.size(), 2600u);
  int asked = 0;
  const Adapted once = solve_adaptively(s.shape, coarse, element("bdms"), s.scene,
                                        {.error = 1e-9, .go_on = [&](const Round&) { return ++asked < 2; }});
  EXPECT_EQ(once.stopped, "stopped on request");
  EXPECT_EQ(once.rounds.size(), 2u);
  try {
    solve_adaptively(s.shape, coarse, element("p2"), s.scene, {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
  }
}

// A closed arc slides along itself: with the normals of its chords the faces would interlock at every vertex, and the
// pressure would saw by E' curvature slip on each edge, whatever the mesh.
TEST(CurvedContact, FacesSlideAlongTheArc) {
  Shape shape;
  shape.labels = {"outer"};
  shape.outline = polygon("outline", {{-4, -4}, {4, -4}, {4, 4}, {-4, 4}}, 0);
  const Vec2 center(0, -1);
  shape.cracks = {arc_crack("c", center, 1.5, pi / 6, 5 * pi / 6)};
  Scene scene;
  scene.material = plane_strain(1000, 0.3);
  scene.laws.resize(1);
  scene.laws[0].normal = [center](const Vec2& x) { return Vec2((x - center).normalized()); };
  scene.tractions.push_back({0, [](const Vec2&, const Vec2& n) { return Vec2(0, -n.y()); }});
  std::vector<double> k2;
  for (const double size : {0.3, 0.15}) {
    const Model m = prepare(triangulate(shape, {.size = size}), element("bdms"), scene, 1);
    const State s = solve(m);
    ASSERT_TRUE(certified(s));
    const std::vector<CrackPoint> profile = crack_profile(m, s, 0);
    double pressure = 0, saw = 0;
    for (std::size_t i = 2; i + 2 < profile.size(); ++i) {
      if (std::abs(profile[i].at.x()) > 1) continue;  // away from the tips
      pressure = std::max(pressure, -profile[i].sigma_n);
      saw = std::max(saw, std::abs(profile[i].sigma_n - 0.5 * (profile[i - 1].sigma_n + profile[i + 1].sigma_n)));
      EXPECT_EQ(profile[i].status, CrackPoint::Status::Closed);
    }
    EXPECT_LT(saw, 0.05 * pressure) << size;
    for (const TipIntensity& t : crack_tips(m, s)) k2.push_back(std::abs(t.K_II));
  }
  ASSERT_EQ(k2.size(), 4u);
  EXPECT_NEAR(k2[0], k2[1], 1e-3 * k2[0]);
  EXPECT_NEAR(k2[0], k2[2], 3e-3 * k2[0]);
}

}  // namespace
}  // namespace kerf::adaptive_test
