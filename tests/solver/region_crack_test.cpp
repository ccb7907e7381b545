// Cracks that cross the borders of regions. Truths from outside: a region of the body's own material changes nothing; G
// of a tip behind or before a border by the energies of a longer and a shorter crack, which no ring enters; contact in
// layers of two stiffnesses by their springs.

#include "geometry/plane.hpp"
#include "kerf/bounds.hpp"
#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "kerf/recover.hpp"
#include "solver/system.hpp"
#include "tests/support/dice.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::region_crack_test {
namespace {

const auto held = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
constexpr Material body = plane_strain(1000, 0.3);

struct Plate {
  Shape shape;
  Scene scene;
};
/// [-2, 2] squared on its bottom, pulled at the top.
Plate plate(std::vector<Loop> regions, std::vector<Material> of_regions, std::vector<Crack> cracks, Vec2 pull,
            CrackLaw law = {.kind = CrackLaw::Kind::Open}) {
  Plate p;
  p.shape = {polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0),
             {},
             std::move(cracks),
             {"bottom", "right", "top", "left"},
             std::move(regions)};
  for (Index side = 0; side < 4; ++side) p.shape.outline.sides[static_cast<std::size_t>(side)].label = side;
  p.scene = {.material = body, .regions = std::move(of_regions)};
  p.scene.supports = {{0, false, true, true, held}};
  p.scene.tractions = {{2, [pull](const Vec2&, const Vec2&) { return pull; }}};
  p.scene.laws.assign(p.shape.cracks.size(), law);
  return p;
}

struct Found {
  double energy = 0;
  std::vector<TipIntensity> tips;
};
Found found(const Plate& p, double tip_size = 2e-3, int degree = 2, double size = 0.4) {
  const Model m = prepare(triangulate(p.shape, {.size = size, .crack_tip_size = tip_size}), bdms(degree), p.scene, 1);
  const State s = solve(m);
  EXPECT_TRUE(certified(s));
  return {potential_energy(m, s), crack_tips(m, s)};
}

TEST(RegionCracks, AreThoseOfTheBodyInARegionOfItsOwnMaterial) {
  test::Dice dice(7);
  for (int k = 0; k < 4; ++k) {
    const Vec2 a(dice.between(-1.2, -0.3), dice.between(-0.6, 0.6)), b(dice.between(0.3, 1.2), dice.between(-0.6, 0.6));
    std::vector<Crack> cracks{{"c", {a, b}, {}}};
    if (k % 2 == 1) cracks[0].points.insert(cracks[0].points.begin() + 1, Vec2(0, dice.between(-0.2, 0.2)));
    const Loop region = k < 2 ? circle("r", {0.7, 0.1}, 0.5, none)
                              : polygon("r", {{-0.1, -0.9}, {0.9, -0.8}, {0.2, 0.9}, {-0.3, 0.4}}, none);
    const CrackLaw law = k < 3 ? CrackLaw{.kind = CrackLaw::Kind::Open} : CrackLaw{.friction = 0.2};
    const Vec2 pull = k < 3 ? Vec2(0.3, 1) : Vec2(0.5, -1);
    const Found with = found(plate({region}, {body}, cracks, pull, law)),
                without = found(plate({}, {}, cracks, pull, law));
    EXPECT_NEAR(with.energy, without.energy, (k < 3 ? 2e-5 : 2e-4) * std::abs(without.energy)) << k;
    ASSERT_EQ(with.tips.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      const TipIntensity &t = with.tips[i], &u = without.tips[i];
      const double size = std::hypot(u.K_I, u.K_II);
      EXPECT_NEAR(t.K_I, u.K_I, 3e-3 * size) << k;
      EXPECT_NEAR(t.K_II, u.K_II, 3e-3 * size) << k;
      EXPECT_NEAR(t.radius, u.radius, 1e-9) << "no border is in the way of a ring";
    }
  }
}

// G = -dPi/da by central differences of the energy, also with a tip a hundredth of the crack from the border.
TEST(RegionCracks, HaveTheReleaseRateThatEnergiesSay) {
  const double from = -0.6, at = 0.5;
  for (const double contrast : {0.1, 10.0})
    for (const double end : {at + 0.2, at + 0.02, at - 0.02}) {
      const auto with = [&](double x) {
        return found(plate({circle("r", {at + 0.5, 0}, 0.5, none)}, {plane_strain(1000 * contrast, 0.2)},
                           {{"c", {{from, 0}, {x, 0}}, {}}}, {0, 1}),
                     2e-4);
      };
      const double da = 0.1 * std::abs(end - at);
      const Found here = with(end);
      ASSERT_EQ(here.tips.size(), 2u);
      const double by_energy = (with(end - da).energy - with(end + da).energy) / (2 * da);
      EXPECT_NEAR(here.tips[1].G, by_energy, 5e-3 * by_energy) << contrast << ' ' << end;
      EXPECT_LE(here.tips[1].radius, std::abs(end - at)) << "rings lie in one material";
      EXPECT_EQ(here.tips[1].region, end > at ? 0 : none);
    }
}

TEST(RegionCracks, HaveNoKOnABorder) {
  const Crack crack{"c", {{-0.6, 0}, {0.5, 0}}, {}};
  const Loop region = circle("r", {1, 0}, 0.5, none);
  const Found on = found(plate({region}, {plane_strain(100, 0.3)}, {crack}, {0, 1}));
  ASSERT_EQ(on.tips.size(), 2u);
  EXPECT_TRUE(std::isfinite(on.tips[0].K_I));
  EXPECT_FALSE(on.tips[0].on_border);
  EXPECT_TRUE(on.tips[1].on_border);
  EXPECT_TRUE(std::isnan(on.tips[1].K_I) && std::isnan(on.tips[1].G) && std::isnan(on.tips[1].T));
  EXPECT_EQ(on.tips[1].radius, 0);
  const Found same = found(plate({region}, {body}, {crack}, {0, 1}));
  EXPECT_FALSE(same.tips[1].on_border);
  EXPECT_NEAR(same.tips[1].K_I, found(plate({}, {}, {crack}, {0, 1})).tips[1].K_I, 3e-3 * same.tips[1].K_I);
}

// Columns side by side, nu = 0, a crack across both, pressed by e: the pressure is E e in each; pulled, it is open.
TEST(RegionCracks, ArePressedAsTheLayersTheyCross) {
  constexpr double e = 1e-3;
  for (const double other : {20.0, 5000.0}) {
    Plate p = plate({polygon("right", {{0, -2}, {2, -2}, {2, 2}, {0, 2}}, none)}, {plane_stress(other, 0)},
                    {{"c", {{-2, 0.3}, {2, 0.1}}, {}}}, {0, 0}, {.friction = 0.5});
    p.scene.material = plane_stress(1000, 0);
    p.scene.tractions.clear();
    p.scene.supports.push_back({2, false, true, true, [](const Vec2&, const Vec2&) { return Vec2(0, -4 * e); }});
    const Model m = prepare(triangulate(p.shape, {.size = 0.5}), bdms(1), p.scene, 1);
    const State s = solve(m);
    EXPECT_TRUE(certified(s));
    for (const CrackPoint& x : crack_profile(m, s, 0)) {
      const double E = x.at.x() > 0 ? other : 1000, cosine = 1 / std::hypot(1, 0.05);
      EXPECT_NEAR(x.contact_pressure(), E * e * cosine * cosine, 1e-7 * std::max(other, 1000.0) * e)
          << x.at.transpose();
    }
    EXPECT_NEAR(strain_energy(m, s), 0.5 * e * e * 8 * (1000 + other), 1e-9 * e * e * 8 * (1000 + other));
  }
}

}  // namespace
}  // namespace kerf::region_crack_test
