// What is wrong with an optimization before anything is meshed: each thing alone, its key and its words.

#include "optimize/refuse.hpp"
#include "geometry/carve.hpp"
#include "optimize/level_set/starts.hpp"
#include "tests/optimize/designs.hpp"

#include <gtest/gtest.h>

namespace kerf {
namespace {

using namespace scenes;

OptimizeRequest level_set() {
  OptimizeRequest r;
  r.volume_at_most = 0.8;
  return r;
}
OptimizeRequest by_variables(OptimizeMethod method = OptimizeMethod::Mma) {
  OptimizeRequest r = level_set();
  r.method = method;
  r.volume_at_most = 0.95;
  r.design = everything_drawn();
  return r;
}
Problem good() {
  Problem p = everything();
  p.element = element("bdms");
  return p;
}

std::string lines(const std::vector<Wrong>& all) {
  std::string out;
  for (const Wrong& w : all) out += w.key + ": " + w.what + '\n';
  return out;
}

/// One thing is wrong; it is `words`, at `key`.
void expect_wrong(const Problem& p, const OptimizeRequest& r, const std::string& key, const std::string& words) {
  const std::vector<Wrong> all = find_wrong(p, r);
  ASSERT_EQ(all.size(), 1u) << words << '\n' << lines(all);
  EXPECT_EQ(all[0].key, key) << all[0].what;
  EXPECT_NE(all[0].what.find(words), std::string::npos) << all[0].what;
  EXPECT_THROW(refuse_wrong(p, r), Error);
}

/// (0, value), and known to be.
class Constant final : public Enclosure {
 public:
  explicit Constant(double value) : value_{Interval{0, 0}, Interval{value, value}} {}
  OnPiece along(const EdgeLine&, double, double) const override {
    return {.value = value_, .eighth = {0, 0}};
  }
  std::array<Interval, 2> over(const Interval&, const Interval&) const override {
    return value_;
  }
  int degree() const override {
    return 0;
  }

 private:
  std::array<Interval, 2> value_;
};

TEST(Refuse, NothingOfWhatIsGood) {
  EXPECT_EQ(lines(find_wrong(good(), level_set())), "");
  EXPECT_EQ(lines(find_wrong(good(), by_variables())), "");
  EXPECT_NO_THROW(refuse_wrong(good(), level_set()));
}

TEST(Refuse, Counts) {
  OptimizeRequest r = level_set();
  r.max_iterations = 0;
  expect_wrong(good(), r, "optimize.max_iterations", "max_iterations in [optimize] must be at least 1");
  r = level_set();
  r.starts = -1;
  expect_wrong(good(), r, "optimize.starts", "starts in [optimize] must be at least 1");
}

TEST(Refuse, BodiesWhoseDerivativesAreNotKnown) {
  Problem gap = good();
  gap.scene.laws[0].gap = [](const Vec2&, const Vec2&) { return Vec2(0.01, 0); };
  expect_wrong(gap, level_set(), "crack[0].gap", "does not know what the gap of crack \"fixed\" does");
  Problem warm = good();
  warm.scene.eigenstrain = {
      {.normal = [](const Vec2&) { return Vec2(1e-3, 0); }, .shear = [](const Vec2&) { return Vec2(0, 0); }}};
  expect_wrong(warm, level_set(), "material.eigenstrain", "does not know what an eigenstrain does");
  warm.frame.regions = {circle("r", {-1, -1}, 0.2, none)};
  warm.scene.regions = {plane_strain(2, 0.3)};
  warm.scene.eigenstrain.insert(warm.scene.eigenstrain.begin(), Eigenstrain{});
  expect_wrong(warm, level_set(), "region[0].eigenstrain", "does not know what an eigenstrain does");
  Problem wood = good();
  wood.scene.material = orthotropic({.young = {1, 5}, .poisson = 0.1, .shear = 0.3});
  expect_wrong(wood, level_set(), "material.young", "the body is orthotropic");
  wood = good();
  wood.frame.regions = {circle("r", {-1, -1}, 0.2, none)};
  wood.scene.regions = {orthotropic({.young = {1, 5}, .poisson = 0.1, .shear = 0.3})};
  expect_wrong(wood, level_set(), "region", "a region is orthotropic");
}

TEST(Refuse, CracksWithPressureOrFriction) {
  Problem pressed = good();
  pressed.scene.laws[0].pressure = [](const Vec2&, const Vec2&) { return Vec2(1, 0); };
  expect_wrong(pressed, level_set(), "crack[0].pressure", "a level set would cut it away");
  EXPECT_EQ(lines(find_wrong(pressed, by_variables())), "");
  Problem rough = good();
  rough.scene.laws[0].friction = 0.3;
  expect_wrong(rough, level_set(), "crack[0].friction", "a level set needs cracks without");
  expect_wrong(rough, by_variables(), "crack[0].friction", "or use method = \"cobyla\"");
  EXPECT_EQ(lines(find_wrong(rough, by_variables(OptimizeMethod::Cobyla))), "");
  rough.scene.laws[0] = {.slip_bound = 0.1};
  expect_wrong(rough, by_variables(OptimizeMethod::Slsqp), "crack[0].tresca",
               "method = \"slsqp\" needs cracks without");
  OptimizeRequest drawn_rough = by_variables();
  drawn_rough.design.drawn[3].law.friction = 0.3;
  expect_wrong(good(), drawn_rough, "optimize.crack[0]",
               "crack 'crack' has friction, and method = \"mma\" needs derivatives");
}

TEST(Refuse, LoadsAndSupports) {
  Problem idle = good();
  idle.scene.tractions.clear();
  idle.scene.body = {};
  const BoundaryField nowhere([](const Vec2&, const Vec2&) { return Vec2(0, 0); }, std::make_shared<Constant>(0));
  EXPECT_EQ(lines(find_wrong(idle, level_set())), "");  // the support may move: nothing is known of it
  idle.scene.supports[0].value = nowhere;
  expect_wrong(idle, level_set(), "optimize", "nothing acts on the body");
  // A load that is known to be zero acts as little, on straight sides and on a round one.
  Problem zero = good();
  zero.scene.body = {};
  zero.scene.supports[0].value = nowhere;
  zero.frame.labels.push_back("hole");
  zero.frame.holes = {circle("h", {-1, 0.5}, 0.2, 4)};
  for (const double value : {0., 1.}) {
    const BoundaryField known([value](const Vec2&, const Vec2&) { return Vec2(0, value); },
                              std::make_shared<Constant>(value));
    zero.scene.tractions = {{2, known}, {4, known}};
    if (value == 0) {
      expect_wrong(zero, level_set(), "boundary", "nothing acts on the body");
    } else {
      EXPECT_EQ(lines(find_wrong(zero, level_set())), "");
    }
  }
  Problem floating = good();
  floating.scene.supports.clear();
  floating.objective = {"volume", {volume()}};
  OptimizeRequest r = level_set();
  FunctionalBound b;
  b.functional = {"displacement", {displacement_tracking({}, {})}};
  b.at_most = 1;
  r.bounds = {b};
  const std::vector<Wrong> all = find_wrong(floating, r);
  EXPECT_NE(lines(all).find("optimize.bound[0]: [[optimize.bound]]: \"displacement_tracking\" sees rigid motions"),
            std::string::npos)
      << lines(all);
}

TEST(Refuse, LevelSets) {
  OptimizeRequest r = level_set();
  r.level_set.ersatz = 1e-3;
  expect_wrong(good(), r, "optimize.ersatz", "a weak phase is moved by the fixed point only");
  Problem region = good();
  region.frame.regions = {circle("r", {-1, -1}, 0.2, none)};
  region.scene.regions = {plane_strain(2, 0.3)};
  r.level_set.move = LevelSetRequest::Move::FixedPoint;
  expect_wrong(region, r, "optimize.ersatz", "does not go with [[region]]");
  for (const double share : {0., -1., 0.6}) {
    r = level_set();
    r.level_set.nucleate_fraction = share;
    expect_wrong(good(), r, "optimize.nucleate.fraction", "it must be positive and not larger than 0.5");
  }
  r = level_set();
  r.level_set.smoothing = 6;
  expect_wrong(good(), r, "optimize.smoothing", "must be smaller than the body, whose diagonal is 5.65685");
  r = level_set();
  r.level_set.min_feature = 5;
  expect_wrong(good(), r, "optimize.min_feature", "no design has such members; use less");
  r = level_set();
  r.level_set.mirror = Mirror{};
  Problem aside = good();
  aside.frame = rectangle({0, 0}, {2, 1});
  aside.frame.outline.sides[1].start = {2.5, 0};
  aside.scene.laws.clear();
  EXPECT_NE(lines(find_wrong(aside, r)).find("optimize.symmetry: symmetry in [optimize]: "), std::string::npos)
      << lines(find_wrong(aside, r));
  r = level_set();
  r.level_set.frozen = {circle("mask", {9, 9}, 0.5, none)};
  EXPECT_NE(lines(find_wrong(good(), r)).find("optimize.frozen[0]: entry 1 of frozen in [optimize]: "),
            std::string::npos)
      << lines(find_wrong(good(), r));
  // Every side is loaded or held, and no hole may appear.
  r = level_set();
  r.level_set.nucleate_every = 0;
  Problem all = good();
  for (const Index label : {0, 1, 3}) all.scene.tractions.push_back({label, all.scene.tractions[0].value});
  expect_wrong(all, r, "optimize.nucleate", "no side of the body is free of loads");
}

TEST(Refuse, DesignsThatCannotMove) {
  OptimizeRequest fixed = by_variables();
  for (Drawn& d : fixed.design.drawn) d.lower = d.upper = d.start;
  expect_wrong(good(), fixed, "optimize", "every variable of the design is fixed");
  OptimizeRequest nothing = by_variables();
  nothing.design.drawn.clear();
  EXPECT_EQ(find_wrong(good(), nothing).size(), 1u);
}

/// A given design becomes a function that is negative in it: its area is that of the design.
TEST(GivenStart, IsTheDesign) {
  Problem p = good();
  p.frame.cracks.clear();
  p.scene.laws.clear();
  p.sizing.size = 0.2;
  OptimizeRequest r = level_set();
  r.volume_at_most = 0.9;
  Shape design = p.frame;
  design.holes = {circle("h", {0.3, 0.1}, 0.8, none)};
  r.level_set.start_design = design;
  const Ground g = make_ground(p, r);
  const LevelSetStart start = given_start(g);
  EXPECT_EQ(start.name, "the design given");
  EXPECT_FALSE(start.explore);
  EXPECT_NEAR(negative_area(g.background.mesh, start.phi), 16 - pi * 0.64, 0.02);
  for (std::size_t v = 0; v < g.background.mesh.points.size(); ++v) {
    const Vec2& x = g.background.mesh.points[v];
    const double to_hole = 0.8 - (x - Vec2(0.3, 0.1)).norm(), to_side = 2 - x.cwiseAbs().maxCoeff();
    if (to_hole > 0) {  // in the hole: positive, and its distance to the rim
      EXPECT_NEAR(start.phi[Eigen::Index(v)], to_hole, 0.01);
    } else if (to_side > 0.01) {
      EXPECT_NEAR(start.phi[Eigen::Index(v)], -std::max(std::min(-to_hole, to_side), 2e-4), 0.01);
    }
  }
  r.level_set.start_design.reset();
  EXPECT_EQ(given_start(make_ground(p, r)).name, "the full body");
  r.level_set.start = StartHoles{.columns = 3, .rows = 3, .radius = 0.2};
  EXPECT_EQ(given_start(make_ground(p, r)).name, "the holes given");
}

}  // namespace
}  // namespace kerf
