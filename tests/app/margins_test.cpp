// Bodies of textbooks by defaults alone: the largest stress, K and displacements, and whether their margins hold the
// truth.

#include "app/margins.hpp"
#include "app/run.hpp"

#include "kerf/mesher.hpp"
#include "solver/largest_stress.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"
#include "tests/support/exact_families.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <fmt/core.h>
#include <cmath>
#include <fstream>
#include <random>

namespace kerf::margins_test {
namespace {

class Defaults : public test::InFolder {
 protected:
  Result solved(const std::string& text, const std::vector<std::string>& settings = {}) const {
    std::ofstream(folder / "a.toml") << text << "[output]\nvtk = false\npng = false\nhtml = false\n";
    const Case c = read_case(folder / "a.toml", settings);
    return run(c, Job::Solve, {.folder = folder / "out"});
  }
  /// Within half a percent of the truth, and the margin holds it.
  static void expect_stress(const Result& r, double truth) {
    ASSERT_TRUE(r.state && r.state->von_mises && r.state->von_mises->largest.margin);
    const PlacedValue& peak = r.state->von_mises->largest;
    EXPECT_FALSE(r.state->von_mises->singular);
    EXPECT_NEAR(peak.value, truth, 5e-3 * truth);
    EXPECT_NEAR(peak.value, truth, *peak.margin);
    EXPECT_LT(*peak.margin, 0.02 * truth);
  }
};

std::string ring(double outer, const std::string& state) {
  return fmt::format(R"([domain]
outline = [{{ arc_to = [{0}, 0], center = [0, 0] }}, {{ arc_to = [-{0}, 0], center = [0, 0] }}]
sides = ["rim", "rim"]
[[hole]]
name = "h"
circle = {{ center = [0, 0], radius = 1 }}
[material]
young = 1000
poisson = 0.3
state = "{1}"
)",
                     outer, state);
}

// Lame: s_t = 5/3, s_r = -1 at the hole, and s_z = nu (s_t + s_r) in plane strain; u_r there.
TEST_F(Defaults, RingUnderPressure) {
  const Result r = solved(ring(2, "plane strain") + "[[boundary]]\non = \"hole:h\"\npressure = 1\n");
  constexpr double t = 5.0 / 3, z = 0.3 * (t - 1);
  expect_stress(r, std::sqrt(((t + 1) * (t + 1) + (1 + z) * (1 + z) + (z - t) * (z - t)) / 2));
  const double u = 1e-3 * 1.3 * (0.7 * t + 0.3);
  const PlacedValue& moved = r.state->displacement->largest;
  ASSERT_TRUE(moved.margin);
  EXPECT_NEAR(moved.value, u, std::max(*moved.margin, 1e-9));
  EXPECT_EQ(r.state->degree, 2);
}

// s_t = (3 + nu)/4 (b^2 + a^2 (1 - nu)/(3 + nu)) at the hole of a spinning disc.
TEST_F(Defaults, SpinningDisc) {
  const Result r = solved(ring(3, "plane stress") + "[body]\nforce = [\"x\", \"y\"]\n");
  expect_stress(r, 3.3 / 4 * (9 + 0.7 / 3.3));
  ASSERT_TRUE(r.state->energy_bounds);
  const double exact = -0.198716207315066;
  EXPECT_LE((*r.state->energy_bounds)[0], exact);
  EXPECT_GE((*r.state->energy_bounds)[1], exact);
}

// The resultant of tractions along a hole is that of the curve, not of chords.
TEST_F(Defaults, ResultantOfTractionsOnAnArc) {
  const Result r = solved(R"([domain]
outline = [[-3, -3], [3, -3], [3, 3], [-3, 3]]
sides = ["bottom", "side", "side", "side"]
[[hole]]
name = "h"
circle = { center = [0, 0], radius = 1 }
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "hole:h"
traction = ["0", "ny*ny"]
)");
  const auto load = std::ranges::find(r.state->loads, "hole:h", &ResultantResult::on);
  ASSERT_NE(load, r.state->loads.end());
  EXPECT_NEAR(load->force.x(), 0, 1e-12);
  EXPECT_NEAR(load->force.y(), pi, 1e-6);  // int_0^{2 pi} sin^2
}

// A single edge crack, a/W = .3: 1.6600 by Tada's formula to .5 %; 1.66077 (collocation) for H = W.
TEST_F(Defaults, MarginsOfKHoldFinerMeshes) {
  const std::string body = R"([domain]
outline = [[0, -1.5], [1, -1.5], [1, 1.5], [0, 1.5]]
sides = ["bottom", "side", "top", "side"]
[[crack]]
name = "c"
path = [[0, 0], [0.3, 0]]
contact = "open"
[material]
young = 1
poisson = 0.3
[[boundary]]
on = ["top", "bottom"]
traction = ["0", "ny"]
)";
  const Result r = solved(body);
  const Result fine = solved(body, {"solver.degree=4", "mesh.size=0.03", "output.margins=false"});
  const TipResult &tip = r.cracks.at(0).tips.at(0), &better = fine.cracks.at(0).tips.at(0);
  ASSERT_TRUE(tip.margin);
  EXPECT_FALSE(better.margin);
  EXPECT_NEAR(*tip.K_I, *better.K_I, tip.margin->K_I);
  EXPECT_NEAR(*tip.G, *better.G, tip.margin->G);
  EXPECT_NEAR(*tip.T, *better.T, tip.margin->T);
  EXPECT_NEAR(*tip.K_I, 1.6600 * std::sqrt(0.3 * pi), 5e-3 * *tip.K_I);
  EXPECT_LT(tip.margin->K_I, 2e-3 * *tip.K_I);
}

// Straight cracks of random length, place and direction in a square under random tractions, open or closed: K of
// degree 4 on edges of a third lies within the margins in 9 of 10 cases.
TEST_F(Defaults, MarginsOfKHoldInRandomBodies) {
  std::mt19937 random(1128);
  const auto draw = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
  };
  int held = 0, all = 0;
  for (int i = 0; i < 8; ++i) {
    const double a = draw(0.1, 0.5), turn = draw(0, pi), x = draw(-0.3, 0.3), y = draw(-0.3, 0.3);
    const std::string body = fmt::format(R"([domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["side", "side", "side", "side"]
[[crack]]
name = "c"
path = [[{}, {}], [{}, {}]]
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "side"
traction = ["{}*nx + {}*ny", "{}*nx + {}*ny"]
)",
                                         x - a * std::cos(turn), y - a * std::sin(turn), x + a * std::cos(turn),
                                         y + a * std::sin(turn), draw(-1, 1), 0.3, 0.3, draw(-1, 1));
    const Result r = solved(body);
    const Result fine = solved(body, {"solver.degree=4", "mesh.size=0.03", "output.margins=false"});
    for (std::size_t k = 0; k < 2; ++k) {
      const TipResult &tip = r.cracks[0].tips[k], &better = fine.cracks[0].tips[k];
      ASSERT_TRUE(tip.margin);
      all += 2;
      held += std::abs(*tip.K_I - *better.K_I) <= tip.margin->K_I + 1e-9 ? 1 : 0;
      held += std::abs(*tip.K_II - *better.K_II) <= tip.margin->K_II + 1e-9 ? 1 : 0;
    }
  }
  EXPECT_GE(held, all * 9 / 10) << held << " of " << all;
}

// A heated core of radius 1 in a disc of radius 2 of the same material in plane stress: the pressure between them is
// E e/2 (1 - 1/4), the energy of the misfit 3 pi/8 E e^2, and the stress beside the core the largest.
TEST_F(Defaults, HeatedCore) {
  const Result r = solved(R"([domain]
outline = [{ arc_to = [2, 0], center = [0, 0] }, { arc_to = [-2, 0], center = [0, 0] }]
sides = ["rim", "rim"]
[material]
young = 1000
poisson = 0.3
state = "plane stress"
[[region]]
name = "core"
circle = { center = [0, 0], radius = 1 }
eigenstrain = [0.001, 0.001, 0]
)");
  const double exact = 1e-3 * 3 * pi / 8;
  ASSERT_TRUE(r.state->energy_bounds);
  EXPECT_LE((*r.state->energy_bounds)[0], exact);
  EXPECT_GE((*r.state->energy_bounds)[1], exact);
  EXPECT_LT((*r.state->energy_bounds)[1] - (*r.state->energy_bounds)[0], 1e-6 * exact);
  // s_r = -3/8, s_t = 5/8 outside the core
  expect_stress(r, std::sqrt(9.0 / 64 + 25.0 / 64 + 15.0 / 64));
}

TEST_F(Defaults, NothingStandsWhereItIsNotAskedFor) {
  const Result r =
      solved(ring(2, "plane strain") + "[[boundary]]\non = \"hole:h\"\npressure = 1\n", {"output.margins=false"});
  EXPECT_FALSE(r.state->von_mises->largest.margin);
  EXPECT_FALSE(r.state->displacement->largest.margin);
}

// Holes in a square that the exact tractions of an infinite plate pull: round, or elliptic up to an aspect of 3; the
// size of the mesh and the load are drawn. The margin of the largest von Mises stress holds the truth in 95 of 100.
TEST(Margins, HoldTheTruthOfRandomHoles) {
  std::mt19937 random(20261128);
  const auto draw = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
  };
  int held = 0;
  constexpr int all = 40;
  double widest = 0;
  for (int i = 0; i < all; ++i) {
    const double a = draw(0.2, 0.6), b = a * draw(1.0 / 3, 1);
    Mat2 pull;
    pull << draw(-1, 1), draw(-1, 1), 0, draw(-1, 1);
    pull(1, 0) = pull(0, 1);
    const Material steel = plane_stress(1, 0.3);
    const exact::ExactField f = exact::inglis("hole", steel, {pull, {a, b}});
    Shape shape{polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0), {}, {}, {"outside", "hole"}, {}};
    shape.holes.push_back(ellipse("hole", {0, 0}, {a, b}, 0, 1));
    Scene scene{.material = steel};
    scene.tractions.push_back({0, [f](const Vec2& x, const Vec2& n) { return Vec2(f.stress(x, 0) * n); }});
    double truth = 0;  // on the rim: harmonic traces are largest on the boundary
    for (int k = 0; k < 20000; ++k) {
      const double s = 2 * pi * k / 20000;
      const Mat2 there = f.stress((1 + 1e-12) * Vec2(a * std::cos(s), b * std::sin(s)), 0);
      truth = std::max(truth, von_mises(steel, false, {there(0, 0), there(0, 1), there(1, 0), there(1, 1)}));
    }
    const Model own = prepare(triangulate(shape, {.size = draw(0.1, 0.5), .curved = true}), bdms(2), scene, 1),
                better = prepare(own.mesh, bdms(3), scene, 1);
    const State state = solve(own), finer = solve(better);
    const PlotData data = plot_data(own, state, false);
    const std::vector<PointIn> points =
        points_near_largest(own, data.corners, data.von_mises, [](const Vec2&) { return false; });
    const Eigen::VectorXd q = von_mises_at(own, state, false, points), p = von_mises_at(better, finer, false, points);
    const double margin = 1.5 * difference_of(q, p);
    held += std::abs(q.maxCoeff() - truth) <= margin ? 1 : 0;
    widest = std::max(widest, margin / truth);
    EXPECT_NEAR(q.maxCoeff(), truth, 0.02 * truth) << i;
  }
  EXPECT_GE(held, all * 95 / 100);
  EXPECT_LT(widest, 0.05);
}

}  // namespace
}  // namespace kerf::margins_test
