// The radius that a map promises 5 % for, against holes of that radius that are really made, on random bodies.

#include "topo/map/valid_radius.hpp"
#include "tests/topo/validation.hpp"
#include "topo/changes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kerf::valid_radius_test {
namespace {

using namespace scenes;

// Numbers that are the same everywhere.
class Draw {
 public:
  explicit Draw(unsigned seed) : from_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(from_() >> 8) / static_cast<double>(1u << 24);
  }

 private:
  std::mt19937 from_;
};

Scene random_scene(Draw& draw, bool cracked) {
  Scene s;
  s.material = draw(0, 1) < 0.5 ? plane_strain(1, draw(0, 0.4)) : plane_stress(1, draw(0, 0.45));
  if (cracked) s.laws = {{CrackLaw::Kind::Open}};
  s.supports = {clamp(0)};
  const double a = draw(-1, 1), b = draw(-1, 1), c = draw(-1, 1), d = draw(-1, 1), e = draw(-1, 1);
  s.tractions = {
      {2, [=](const Vec2& x, const Vec2&) { return Vec2(a + b * x.x(), c + d * x.x() + e * x.x() * x.x()); }},
      {1, [=](const Vec2& x, const Vec2&) { return Vec2(d + a * x.y(), b * (1 - x.y())); }}};
  return s;
}

struct Promise {
  double T, radius, difference;
};

// Corners of one random body, each with a hole of its radius.
std::vector<Promise> promises(unsigned seed, std::size_t count) {
  Draw draw(seed);
  const bool cracked = draw(0, 1) < 0.5;
  const Shape shape = cracked ? cracked_square(0.4) : rectangle({-1, -1}, {1, 1});
  const Scene scene = random_scene(draw, cracked);
  const Sizing sizing{.size = 0.1, .crack_tip_size = 0.02};
  const Element& e = element("bdms", 2);
  const Model m = prepare(triangulate(shape, sizing), e, scene, 2);
  const State s = solve(m);
  const Functional j{"compliance", {compliance()}};
  const Corners corners = split_for_stress(m.mesh);
  const FullMap map = map_everywhere(analyze(j, m, s), j, {.second = true}, corners);
  double largest = 0;
  for (Eigen::Index i = 0; i < map.at_corners.size(); ++i)
    if (std::isfinite(map.valid_radius[i])) largest = std::max(largest, std::abs(map.at_corners[i]));
  std::vector<Promise> all;
  std::vector<SmallChange> changes;
  for (int tries = 0; changes.size() < count && tries < 10000; ++tries) {
    const auto i = static_cast<Eigen::Index>(draw(0, 1) * static_cast<double>(map.c2.size()));
    constexpr double least = 0.002, nothing = 0.01;
    if (!(map.valid_radius[i] > least) || std::abs(map.at_corners[i]) < nothing * largest) continue;
    changes.push_back({m.mesh.points[corners.vertex[static_cast<std::size_t>(i)]], map.valid_radius[i]});
    all.push_back({map.at_corners[i], map.valid_radius[i], nan});
  }
  const ChangesMade made = changes_at({{shape, sizing}, e, std::span(&scene, 1), j, 2}, {}, changes);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].difference = made.difference(static_cast<Eigen::Index>(i), 0);
  return all;
}

void expect_kept(unsigned bodies, std::size_t each) {
  std::size_t kept = 0, all = 0;
  double worst = 0;
  std::string off;
  for (unsigned k = 0; k < bodies; ++k)
    for (const Promise& p : promises(7100 + k, each)) {
      const double error = std::abs(p.difference / (pi * p.radius * p.radius * p.T) - 1);
      ++all;
      worst = std::max(worst, error);
      if (error <= 0.05)
        ++kept;
      else
        off += fmt::format("body {}: radius {:.3g}, off by {:.2g}\n", k, p.radius, error);
    }
  fmt::print("kept {} of {}, worst {:.3g}\n{}", kept, all, worst, off);
  EXPECT_GE(all, bodies * each * 9 / 10);
  EXPECT_GE(static_cast<double>(kept), 0.98 * static_cast<double>(all)) << off;
}

TEST(ValidRadius, IsKeptByTwoHundredHoles) {
  expect_kept(10, 20);
}

TEST(ValidRadius, CountsWhatCancelsAndKeepsAway) {
  // The second term alone.
  EXPECT_NEAR(valid_radius_of({2, -4, 0, 4, 1e3}), std::sqrt(0.05 * 2 / 4.), 0.01);
  // It vanishes by chance: the parts say how large the next may be.
  EXPECT_NEAR(valid_radius_of({1, 0, 0, 10, 1e3}), std::pow(0.05, 0.25) / std::sqrt(10), 1e-12);
  EXPECT_LT(valid_radius_of({1, 1, 5, 10, 1e3}), valid_radius_of({1, 1, 0, 10, 1e3}));
  EXPECT_EQ(valid_radius_of({1, 1e-9, 0, 1e-9, 0.4}), 0.1);  // a quarter of the way
  EXPECT_EQ(valid_radius_of({-1, 0, 0, 0, 0.4}), 0.4);       // a volume
  EXPECT_EQ(valid_radius_of({0, 1, 0, 1, 0.4}), 0);
  EXPECT_TRUE(std::isnan(valid_radius_of({1, nan, 0, 1, 0.4})));
}

}  // namespace
}  // namespace kerf::valid_radius_test
