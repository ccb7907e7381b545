// What a lattice knows of a body: materials, supports, what stays solid, mirrors; and which problems it can be made
// for.

#include "optimize/density/lattice.hpp"

#include "optimize/density/density.hpp"
#include "optimize/density/filter.hpp"
#include "optimize/density/simp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::lattice_test {
namespace {

BoundaryField constant(const Vec2& value) {
  return [value](const Vec2&, const Vec2&) { return value; };
}

/// [0, 2] x [0, 1], clamped on the left, a force down on all of the right side.
Problem strip() {
  Problem p;
  p.frame.labels = {"free", "load", "left", "hole"};
  p.frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0);
  p.frame.outline.sides[1].label = 1;
  p.frame.outline.sides[3].label = 2;
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{.label = 2, .value = constant({0, 0})}};
  p.scene.tractions = {{.label = 1, .value = constant({0, -1})}};
  p.sizing.size = 0.1;
  p.objective = {"compliance", {compliance()}};
  p.plane_strain = false;
  return p;
}

OptimizeRequest at_most(double volume) {
  OptimizeRequest r;
  r.volume_at_most = volume;
  return r;
}

Index cell_at(const Lattice& l, const Vec2& x) {
  const Vec2 in_cells = (x - l.origin) / l.cell;
  return static_cast<Index>(in_cells.x()) + l.columns * static_cast<Index>(in_cells.y());
}

TEST(Lattice, TheInnermostRegionCounts) {
  Problem p = strip();
  p.frame.regions = {polygon("outer", {{0.5, 0.2}, {1.5, 0.2}, {1.5, 0.8}, {0.5, 0.8}}, none),
                     polygon("inner", {{0.8, 0.4}, {1.2, 0.4}, {1.2, 0.6}, {0.8, 0.6}}, none)};
  Material rubber = plane_strain(0.25, 0.5);
  ASSERT_EQ(rubber.c, 0);  // incompressible
  p.scene.regions = {plane_stress(4, 0.3), rubber};
  for (const bool swapped : {false, true}) {
    if (swapped) {
      std::swap(p.frame.regions[0], p.frame.regions[1]);
      std::swap(p.scene.regions[0], p.scene.regions[1]);
    }
    const Lattice l = make_lattice(p, at_most(0.5), 800);
    const double stiffest = plane_stress(4, 0.3).mu;  // the unit
    EXPECT_NEAR(l.mu[cell_at(l, {0.25, 0.5})], plane_stress(1, 0.3).mu / stiffest, 1e-9);
    EXPECT_NEAR(l.mu[cell_at(l, {0.65, 0.5})], 1, 1e-9);
    EXPECT_NEAR(l.mu[cell_at(l, {1, 0.5})], rubber.mu / stiffest, 1e-9);
    // What is nearly incompressible counts as less so: bulk over shear modulus at most 5.
    EXPECT_NEAR(l.lambda[cell_at(l, {1, 0.5})] / l.mu[cell_at(l, {1, 0.5})], 4, 1e-9);
    // Regions stay solid.
    EXPECT_TRUE(l.solid[std::size_t(cell_at(l, {1, 0.5}))]);
    EXPECT_FALSE(l.solid[std::size_t(cell_at(l, {0.25, 0.5}))]);
  }
}

TEST(Lattice, RingsFrozenPartsAndWhatIsLookedAtStaySolid) {
  Problem p = strip();
  p.frame.cracks = {{"c", {Vec2(0, 0.5), Vec2(0.6, 0.5)}}};
  p.scene.laws.resize(1);
  p.objective = {"release", {energy_release_rate({0.6, 0.5}, {1, 0}, {0.05, 0.2}, {})}};
  OptimizeRequest r = at_most(0.5);
  r.level_set.frozen = {circle("pad", {1.4, 0.5}, 0.2, none)};
  FunctionalBound bound;
  bound.functional = {"tracking", {boundary_tracking(0, constant({0, 0}), {})}};
  bound.at_most = 1;
  r.bounds = {bound};
  const Lattice l = make_lattice(p, r, 800);
  const auto solid = [&](const Vec2& x) { return bool(l.solid[std::size_t(cell_at(l, x))]); };
  EXPECT_TRUE(solid({0.7, 0.5}));
  EXPECT_TRUE(solid({1.4, 0.5}));
  EXPECT_FALSE(solid({1, 0.5}));
  EXPECT_TRUE(solid({1, 0.01}));    // along the bottom, which the bound looks at
  EXPECT_TRUE(solid({1.99, 0.5}));  // along the load
  EXPECT_FALSE(solid({0.2, 0.2}));
}

/// A plate held in its hole, and loaded in it.
TEST(Lattice, HolesHoldAndLoad) {
  Problem p = strip();
  p.frame.holes = {circle("h", {1, 0.5}, 0.25, 3)};
  p.scene.supports = {{.label = 3, .normal_frame = true, .first = true, .second = false, .value = constant({0, 0})}};
  // Rollers hold by the square of the cosine: half of the circumference each way.
  const Lattice rollers = make_lattice(p, at_most(0.5), 800);
  for (const Index component : {0, 1}) {
    double sum = 0;
    for (const Lattice::Spring& s : rollers.springs)
      if (s.first % 2 == component && s.second % 2 == component) sum += s.stiffness;
    EXPECT_NEAR(sum, 1e3 * pi * 0.25 / rollers.cell, 1e-3 * sum);
  }
  p.scene.supports[0].second = true;
  const Lattice clamped = make_lattice(p, at_most(0.5), 800);
  EXPECT_FALSE(unsupported(clamped));
  EXPECT_NEAR(clamped.part.sum() * clamped.cell * clamped.cell, 2 - pi / 16, 1e-3);
  EXPECT_EQ(clamped.part[cell_at(clamped, {1, 0.5})], 0);
  p.scene.supports = {{.label = 2, .value = constant({0, 0})}};
  p.scene.tractions = {{.label = 3, .value = [](const Vec2&, const Vec2& n) -> Vec2 { return -n; }}};
  const Lattice pressed = make_lattice(p, at_most(0.5), 800);
  // A pressure on a closed line pulls nowhere.
  Vec2 sum = Vec2::Zero();
  for (Eigen::Index i = 0; i < pressed.force.rows(); i += 2) sum += pressed.force.block<2, 1>(i, 0);
  EXPECT_LT(sum.norm(), 1e-6);
  EXPECT_GT(pressed.force.norm(), 1);
}

TEST(Lattice, ABodyMayBeOneCellWide) {
  for (const bool upright : {false, true}) {
    Problem p = strip();
    for (Side& side : p.frame.outline.sides) {
      side.start.y() *= 0.01;
      if (upright) side.start = Vec2(-side.start.y(), side.start.x());
    }
    const Lattice l = make_lattice(p, at_most(0.5), 50);
    EXPECT_EQ(upright ? l.columns : l.rows, 1);
    EXPECT_NEAR(l.part.sum() * l.cell * l.cell, 0.02, 1e-6);
    for (const auto& [cell, weight] : between_centers(l.columns, l.rows, Vec2(0.2, 0.3)))
      EXPECT_TRUE(cell >= 0 && cell < l.columns * l.rows);
  }
}

/// Cells on cracks are weak, straight or curved, those on bonded ones are not.
TEST(Lattice, CracksAreLinesOfWeakCells) {
  Problem p = strip();
  p.frame.cracks = {arc_crack("arc", {1, 0}, 0.5, 0.5, 2.5), {"bonded", {Vec2(0.2, 0.8), Vec2(0.5, 0.8)}, {}}};
  p.scene.laws = {{.kind = CrackLaw::Kind::Open}, {.kind = CrackLaw::Kind::Bonded}};
  EXPECT_TRUE(has_cracks(p));
  const Lattice l = make_lattice(p, at_most(0.5), 1200, true), whole = make_lattice(p, at_most(0.5), 1200);
  for (const double t : {0.6, 1.2, 2.4}) {
    const Index c = cell_at(l, Vec2(1, 0) + 0.5 * Vec2(std::cos(t), std::sin(t)));
    EXPECT_NEAR(l.mu[c], 0.01 * whole.mu[c], 1e-12);
  }
  EXPECT_EQ(l.mu[cell_at(l, {0.35, 0.8})], whole.mu[cell_at(l, {0.35, 0.8})]);
  EXPECT_EQ(l.mu[cell_at(l, {1, 0.2})], whole.mu[cell_at(l, {1, 0.2})]);
}

/// Of (column) + 10 (row) on 4 x 3 cells: bilinear between the centers, constant beyond.
TEST(Lattice, BetweenCenters) {
  const auto value = [](const Vec2& x) {
    double sum = 0;
    for (const auto& [cell, weight] : between_centers(4, 3, x)) sum += weight * (cell % 4 + 10 * (cell / 4));
    return sum;
  };
  EXPECT_NEAR(value({0.5, 0.5}), 0, 1e-12);
  EXPECT_NEAR(value({2.25, 1.75}), 1.75 + 12.5, 1e-12);
  EXPECT_NEAR(value({-3, 9}), 0 + 20, 1e-12);
  EXPECT_NEAR(value({9, -1}), 3, 1e-12);
}

/// The image of what lies beyond the body is itself.
TEST(Lattice, MirrorsKnowWhereTheBodyEnds) {
  Problem p = strip();
  p.frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 0.5}, {0, 0.5}}, 0);
  p.frame.outline.sides[5].label = 2;
  p.frame.outline.sides[1].label = 1;
  OptimizeRequest r = at_most(0.5);
  r.level_set.mirror = Mirror{{1.2, 0.5}, {0, 1}};  // x -> 2.4 - x
  const Lattice l = make_lattice(p, r, 600);
  const LatticeMirror mirror(l);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(l.part.size());
  for (const Index c : l.cells) x[c] = l.center(c).x();
  const Eigen::VectorXd mean = mirror.symmetrized(x);
  const double middle = 1.2 / l.cell;
  EXPECT_NEAR(mean[cell_at(l, {0.7, 0.25})], middle, 1);  // and its image at 1.7
  const Index beyond = cell_at(l, {0.1, 0.25});           // whose image lies off the box
  EXPECT_EQ(mean[beyond], x[beyond]);
  const Index beside = cell_at(l, {1.7, 0.8});  // whose image lies in the notch
  EXPECT_EQ(mean[beside], x[beside]);
  EXPECT_EQ(LatticeMirror(make_lattice(p, at_most(0.5), 600)).symmetrized(x), x);
}

TEST(DensityStage, SaysForWhatItIsNot) {
  const OptimizeRequest r = at_most(0.4);
  const auto why = [&](const Problem& p, const OptimizeRequest& request) {
    return no_density_stage(p, request).value_or("");
  };
  Problem p = strip();
  EXPECT_EQ(why(p, r), "");
  OptimizeRequest mma = r;
  mma.method = OptimizeMethod::Mma;
  EXPECT_EQ(why(p, mma), "it is made for a level set");
  Problem moved = p;
  for (const bool second : {false, true}) {
    moved.scene.supports[0].value = constant(second ? Vec2(0, 1) : Vec2(1, 0));
    EXPECT_EQ(why(moved, r), "a support moves, which the coarse lattice does not know");
  }
  moved.scene.supports[0].second = false;  // what is not prescribed is not looked at
  moved.scene.supports.push_back({.label = 0, .value = constant({0, 0})});
  EXPECT_EQ(why(moved, r), "");
  moved.scene.supports[0].first = false;
  moved.scene.supports[0].second = true;
  moved.scene.supports[0].value = constant({1, 0});
  EXPECT_EQ(why(moved, r), "");
  moved.frame.holes = {circle("h", {1, 0.5}, 0.2, 3)};
  moved.scene.supports.push_back({.label = 3, .value = constant({0, 1})});
  EXPECT_NE(why(moved, r), "");
  Problem soft = p;
  soft.objective.terms[0].factor = -1;
  EXPECT_EQ(why(soft, r), "its J is less the more the body gives way");
  // The potential energy is minus half of the compliance: the more of it the better.
  soft.objective = {"energy", {energy()}};
  EXPECT_EQ(why(soft, r), "its J is less the more the body gives way");
  soft.objective.terms[0].factor = -2;
  EXPECT_EQ(why(soft, r), "");
  EXPECT_EQ(why(p, {}), "the coarse lattice knows compliance and area, and nothing bounds the area");
  Problem light = p;
  light.objective = {"volume", {volume()}};
  EXPECT_EQ(why(light, {}), "the coarse lattice knows compliance and area, and nothing bounds the area");
  OptimizeRequest priced;
  priced.volume_penalty = 1;
  EXPECT_EQ(why(p, priced), "");
  Problem peaks = p;  // what it does not know: the compliance instead, where the area is bounded
  peaks.objective = {"stress", {stress_pnorm(4, {}, false)}};
  EXPECT_EQ(why(peaks, r), "");
  EXPECT_EQ(why(peaks, {}), "the coarse lattice knows compliance and area, and nothing bounds the area");
  // Powers are other functionals than what they are of.
  for (const Term& term : {compliance(), volume(), energy()}) {
    peaks.objective = {"power", {term}};
    peaks.objective.terms[0].power = 2;
    EXPECT_EQ(why(peaks, r), "");
    EXPECT_EQ(why(peaks, {}), "the coarse lattice knows compliance and area, and nothing bounds the area");
  }
  OptimizeRequest thin = r;
  thin.level_set.min_feature = 0.05;  // more cells
  EXPECT_EQ(why(p, thin), "");
}

/// What bounds say of the area, as far as the lattice knows them.
TEST(DensityStage, BoundsOnTheAreaAreTheAreaAllowed) {
  const Problem p = strip();
  const auto possible = [&](const Functional& j, double most) {
    OptimizeRequest r;
    FunctionalBound bound;
    bound.functional = j;
    bound.at_most = most;
    r.bounds = {bound};
    return !no_density_stage(p, r);
  };
  Functional area{"volume", {volume()}};
  EXPECT_TRUE(possible(area, 0.8));
  area.terms[0].factor = -1;  // at least so much
  EXPECT_FALSE(possible(area, -0.8));
  area.terms[0].factor = 1;
  EXPECT_FALSE(possible({"sum", {area.terms[0], compliance()}, true}, 0.8));  // of both: which is which?
  area.terms[0].power = 2;
  EXPECT_FALSE(possible(area, 0.64));
  EXPECT_FALSE(possible({"stress", {stress_pnorm(4, {}, false)}}, 1));
  EXPECT_FALSE(possible({"compliance", {compliance()}}, 1));  // which the full body keeps best
  EXPECT_FALSE(possible({"energy", {energy()}}, 1));
}

}  // namespace
}  // namespace kerf::lattice_test
