// Densities on a lattice: compliances against the body-fitted solver, beam theory and uniform stresses, derivatives
// against differences, the method of moving asymptotes against the cantilever of [Svanberg 1987].

#include "optimize/density/density.hpp"

#include "optimize/density/mma.hpp"
#include "optimize/density/simp.hpp"
#include "optimize/loop/evaluate.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::density_test {
namespace {

BoundaryField constant(const Vec2& value) {
  return [value](const Vec2&, const Vec2&) { return value; };
}

/// [0, 2] x [0, 1] in the unit given, clamped on the left, a force down on the middle of the right side.
Problem cantilever(double unit = 1, double modulus = 1) {
  Problem p;
  p.frame.labels = {"free", "load", "left"};
  p.frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 0.45}, {2, 0.55}, {2, 1}, {0, 1}}, 0);
  for (Side& side : p.frame.outline.sides) side.start *= unit;
  p.frame.outline.sides[2].label = 1;
  p.frame.outline.sides[5].label = 2;
  p.scene.material = plane_stress(modulus, 0.3);
  p.scene.supports = {{.label = 2, .value = constant({0, 0})}};
  p.scene.tractions = {{.label = 1, .value = constant({0, -10 * modulus})}};
  p.sizing.size = 0.05 * unit;
  p.objective = {"compliance", {compliance()}};
  p.plane_strain = false;
  return p;
}

OptimizeRequest at_most(double volume) {
  OptimizeRequest r;
  r.volume_at_most = volume;
  return r;
}

double full_compliance(const Problem& p, double cells = 3200) {
  const Lattice l = make_lattice(p, at_most(0.5), cells);
  const LatticePattern pattern = lattice_pattern(l);
  LatticeStiffness stiffness(l, pattern);
  Eigen::VectorXd full = Eigen::VectorXd::Zero(l.part.size());
  for (const Index c : l.cells) full[c] = 1;
  return l.compliance_unit * compliances(l, stiffness, {}, full).value[0];
}

double solved_compliance(const Problem& p) {
  return evaluate_design(p, {}, p.frame, {}).J;
}

TEST(Density, LatticeOfAFullBodyHasItsCompliance) {
  const Problem p = cantilever();
  EXPECT_NEAR(full_compliance(p), solved_compliance(p), 0.01 * solved_compliance(p));
}

// Nothing of this body is parallel to the lattice: a bar turned by 30 degrees under a shear force at its end, of which
// the roller holds the normal and a point-like piece the rest.
TEST(Density, SlantedSidesHoldAndLoadAsTheyShould) {
  const double turn = pi / 6;
  const Mat2 rotation{{std::cos(turn), -std::sin(turn)}, {std::sin(turn), std::cos(turn)}};
  Problem p;
  p.frame.labels = {"free", "load", "roller", "pin"};
  p.frame.outline = polygon("outline", {{0, 0}, {3, 0}, {3, 1}, {0, 1}, {0, 0.6}, {0, 0.4}}, 0);
  const std::array<Index, 6> labels{0, 1, 0, 2, 3, 2};
  for (std::size_t i = 0; i < 6; ++i) {
    p.frame.outline.sides[i].start = rotation * p.frame.outline.sides[i].start;
    p.frame.outline.sides[i].label = labels[i];
  }
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{.label = 2, .normal_frame = true, .second = false, .value = constant({0, 0})},
                      {.label = 3, .value = constant({0, 0})}};
  p.scene.tractions = {
      {.label = 1, .value = [rotation](const Vec2&, const Vec2&) -> Vec2 { return rotation * Vec2(0, -1); }}};
  p.sizing.size = 0.1;
  p.objective = {"compliance", {compliance()}};
  p.plane_strain = false;
  EXPECT_NEAR(full_compliance(p), solved_compliance(p), 0.04 * solved_compliance(p));
  // Beam theory, clamped: F^2 L^3 / (3 E I) + F^2 L / (k G A).
  const double beam = 27 / (3.0 / 12) + 3 / (5.0 / 6 / 2.6);
  EXPECT_NEAR(full_compliance(p), beam, 0.05 * beam);
}

// A square on rollers at two of its sides, pulled at the others: uniform stresses.
TEST(Density, RollersHoldOneWay) {
  Problem p;
  p.frame.labels = {"bottom", "right", "top", "left"};
  p.frame.outline = polygon("outline", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0);
  for (Index i = 0; i < 4; ++i) p.frame.outline.sides[static_cast<std::size_t>(i)].label = i;
  p.scene.material = plane_stress(2, 0.25);
  p.scene.supports = {{.label = 0, .first = false, .value = constant({0, 0})},
                      {.label = 3, .second = false, .value = constant({0, 0})}};
  p.scene.tractions = {{.label = 1, .value = constant({3, 0})}, {.label = 2, .value = constant({0, 1})}};
  p.sizing.size = 0.1;
  p.objective = {"compliance", {compliance()}};
  p.plane_strain = false;
  const double exact = (9 + 1 - 2 * 0.25 * 3) / 2.0;  // sigma . epsilon over the unit square
  EXPECT_NEAR(full_compliance(p), exact, 0.02 * exact);
}

TEST(Density, StepsEndWhereNothingChanges) {
  const Problem p = cantilever();
  const Lattice l = make_lattice(p, at_most(0.5), 50);
  const LatticePattern pattern = lattice_pattern(l);
  LatticeGoal goal{.weights = Eigen::VectorXd::Ones(1), .area = 0.5 * l.part.sum()};
  goal.most = Eigen::VectorXd::Constant(1, infinity);
  EXPECT_TRUE(goal.plain());
  const Schedule whatever{.change_steps = 3, .most_steps = 9, .least_change = 2};  // no density changes by more
  EXPECT_EQ(optimality_criteria(l, pattern, goal, whatever).steps, 4);
  EXPECT_EQ(moving_asymptotes(l, pattern, goal, whatever).steps, 4);
  // Without a reason to prefer one design to another the first one stays.
  goal.weights.setZero();
  const Eigen::VectorXd start = 0.4 * l.part;
  const Densities first = optimality_criteria(l, pattern, goal, {.change_steps = 3, .most_steps = 9, .start = start});
  EXPECT_EQ(first.steps, 1);
  EXPECT_EQ(first.density, start);
  LatticeGoal other = goal;
  other.most[0] = 3;
  EXPECT_FALSE(other.plain());
  other = goal;
  other.price = 1;
  EXPECT_FALSE(other.plain());
  other = goal;
  other.area.reset();
  EXPECT_FALSE(other.plain());
}

TEST(Density, CellsAreSharedWithTheOutsideAsTheBodyIs) {
  Problem p = cantilever();
  p.frame.holes = {circle("hole", {0.7, 0.5}, 0.3, 0), ellipse("other", {1.5, 0.4}, {0.2, 0.1}, 0.5, 0)};
  const Lattice l = make_lattice(p, at_most(0.5), 3200);
  EXPECT_NEAR(l.part.sum() * l.cell * l.cell, area(p.frame), 1e-4);
  const Index middle = static_cast<Index>(0.7 / l.cell) + l.columns * static_cast<Index>(0.5 / l.cell);
  EXPECT_EQ(l.part[middle], 0);
  for (const DensityDesign& d : density_designs(p, at_most(0.5))) EXPECT_NEAR(d.volume_fraction, 0.5, 1e-3);
}

TEST(Density, DerivativesAreThoseOfDifferences) {
  Problem p = cantilever();
  p.scene.body = [](const Vec2& x) { return Vec2(1, -3 * x.x()); };
  const Lattice l = make_lattice(p, at_most(0.5), 50);
  const LatticePattern pattern = lattice_pattern(l);
  LatticeStiffness stiffness(l, pattern);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(l.part.size());
  for (const Index c : l.cells) x[c] = 0.3 + 0.6 * std::abs(std::sin(c * 1.7));
  const Compliances now = compliances(l, stiffness, {}, x);
  for (const Index c : {3, 17, 40}) {
    Eigen::VectorXd more = x, less = x;
    more[c] += 1e-5, less[c] -= 1e-5;
    const double difference =
        (compliances(l, stiffness, {}, more).value[0] - compliances(l, stiffness, {}, less).value[0]) / 2e-5;
    EXPECT_NEAR(now.by_density(c, 0), difference, 1e-6 * now.by_density.cwiseAbs().maxCoeff()) << c;
  }
}

TEST(Density, DesignsAreGoodMeetTheVolumeLoseNoSymmetryAndKnowNoUnitsAndThreads) {
  const std::vector<DensityDesign> designs = density_designs(cantilever(), at_most(0.4));
  ASSERT_EQ(designs.size(), 2u);
  EXPECT_LE(designs[0].compliance, designs[1].compliance);
  EXPECT_LT(designs[0].compliance, 74);  // SIMP on 5000 cells: 72.8
  EXPECT_GT(designs[0].compliance, 70);
  for (const DensityDesign& d : designs) {
    EXPECT_NEAR(d.volume_fraction, 0.4, 1e-3);
    for (const double x : {0.31, 1.04, 1.77})
      for (const double y : {0.07, 0.33, 0.46}) EXPECT_NEAR(density_at(d, {x, y}), density_at(d, {x, 1 - y}), 1e-3);
  }
  Problem p = cantilever(1e3, 2.1e5);
  p.threads = 2;
  const std::vector<DensityDesign> mm = density_designs(p, at_most(0.4));
  ASSERT_EQ(designs.size(), mm.size());
  for (std::size_t i = 0; i < mm.size(); ++i) {
    EXPECT_EQ(designs[i].density, mm[i].density);
    EXPECT_NEAR(mm[i].compliance, 2.1e5 * 1e6 * designs[i].compliance, 1e-9 * mm[i].compliance);
  }
}

TEST(Density, AMirrorIsKept) {
  Problem p = cantilever();
  p.scene.tractions[0].value = constant({-5, -10});
  OptimizeRequest r = at_most(0.4);
  r.level_set.mirror = Mirror{{0, 0.5}, {1, 0}};
  for (const DensityDesign& d : density_designs(p, r))
    for (const double x : {0.31, 1.04, 1.77}) EXPECT_NEAR(density_at(d, {x, 0.13}), density_at(d, {x, 0.87}), 1e-6);
}

// Five segments of a cantilever, the least weight under a bound on the deflection of the tip; from the even start
// [Svanberg 1987, section 4].
TEST(Mma, FindsTheCantileverOfItsInventor) {
  const Eigen::VectorXd c = (Eigen::VectorXd(5) << 61, 37, 19, 7, 1).finished();
  Eigen::VectorXd x = Eigen::VectorXd::Constant(5, 5);
  Mma mma(Eigen::VectorXd::Constant(5, 1), Eigen::VectorXd::Constant(5, 10), 0.5);
  for (int i = 0; i < 25; ++i) {
    MmaPoint at{Eigen::VectorXd::Constant(5, 0.0624), Eigen::VectorXd(1), Eigen::MatrixXd(5, 1)};
    at.g[0] = c.dot(x.array().pow(-3).matrix()) - 1;
    at.by.col(0) = -3 * c.array() * x.array().pow(-4);
    x = mma.step(x, at);
  }
  EXPECT_NEAR(0.0624 * x.sum(), 1.340, 1e-3);
  EXPECT_NEAR(x[0], 6.016, 0.01);
  EXPECT_NEAR(x[4], 2.153, 0.01);
  EXPECT_NEAR(c.dot(x.array().pow(-3).matrix()), 1, 1e-4);
}

// x >= 3 and x <= 1 at most: no x between 0 and 1 keeps the first; the nearest one is 1.
TEST(Mma, BearsConstraintsThatCannotBeKept) {
  Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 0.5);
  Mma mma(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1), 0.5);
  for (int i = 0; i < 20; ++i) {
    MmaPoint at{Eigen::VectorXd::Ones(1), Eigen::VectorXd(2), Eigen::MatrixXd(1, 2)};
    at.g << 3 - x[0], x[0] - 1;  // x >= 3, x <= 1
    at.by << -1, 1;
    x = mma.step(x, at);
  }
  EXPECT_NEAR(x[0], 1, 1e-3);
}

TEST(Mma, NeedsNoConstraints) {
  Eigen::VectorXd x = Eigen::Vector2d(0.9, 0.9);
  Mma mma(Eigen::VectorXd::Zero(2), Eigen::VectorXd::Ones(2), 0.5);
  for (int i = 0; i < 40; ++i)  // (x - 0.3)^2 + (y + 1)^2
    x = mma.step(x, {Eigen::Vector2d(2 * (x[0] - 0.3), 2 * (x[1] + 1)), Eigen::VectorXd(0), Eigen::MatrixXd(2, 0)});
  EXPECT_NEAR(x[0], 0.3, 5e-3);
  EXPECT_NEAR(x[1], 0, 1e-3);
}

TEST(Density, LeastVolumeUnderACompliance) {
  Problem p = cantilever();
  p.objective = {"volume", {volume()}};
  OptimizeRequest r;
  r.bounds = {{"c", {"compliance", {compliance()}}, 71.5}};
  const std::vector<DensityDesign> designs = density_designs(p, r);
  EXPECT_LT(designs[0].volume_fraction, 0.415);  // of body-fitted designs 0.40
  EXPECT_GT(designs[0].volume_fraction, 0.385);
  EXPECT_NEAR(designs[0].compliance, 2 * designs[0].volume_fraction, 1e-3);
}

// An arch that carries its own weight and a crust: more than it wants is not taken, however much is allowed.
TEST(Density, OwnWeightTakesNoMoreThanItNeeds) {
  Problem p;
  p.frame.labels = {"free", "feet", "crust"};
  p.frame.outline = polygon("outline", {{0, 0}, {0.2, 0}, {1.8, 0}, {2, 0}, {2, 1}, {0, 1}}, 0);
  for (const std::size_t i : {0, 2}) p.frame.outline.sides[i].label = 1;
  p.frame.outline.sides[4].label = 2;
  p.scene.material = plane_stress(1, 0.3);
  p.scene.supports = {{.label = 1, .value = constant({0, 0})}};
  p.scene.tractions = {{.label = 2, .value = constant({0, 0})}};
  p.scene.body = [](const Vec2&) { return Vec2(0, -1); };
  p.sizing.size = 0.03;
  p.objective = {"compliance", {compliance()}};
  p.plane_strain = false;
  double before = infinity;
  for (const double most : {0.2, 0.5}) {
    const DensityDesign d = density_designs(p, at_most(most))[0];
    EXPECT_LE(d.volume_fraction, most + 1e-9);
    EXPECT_LT(d.volume_fraction, 0.35);
    EXPECT_LT(d.compliance, 1.1 * before) << most;
    before = d.compliance;
  }
  EXPECT_LT(before, 0.35);  // a level set from the full body: 0.59
}

// A crack across the upper flange of a cantilever: a design that knows of it bears loads around it.
TEST(Density, OneDesignAvoidsCracks) {
  Problem p = cantilever();
  p.frame.cracks = {{"c", {Vec2(0.3, 0.75), Vec2(0.35, 1)}}};
  p.scene.laws = {{.kind = CrackLaw::Kind::Open}};
  const std::vector<DensityDesign> designs = density_designs(p, at_most(0.5));
  ASSERT_EQ(designs.size(), 2u);
  EXPECT_EQ(designs[0].name, "density, filter 1.4, cracks weak");
  EXPECT_LT(designs[0].compliance, 0.95 * designs[1].compliance);
  p.scene.laws = {{.kind = CrackLaw::Kind::Bonded}};
  for (const DensityDesign& d : density_designs(p, at_most(0.5))) EXPECT_EQ(d.name.find("crack"), std::string::npos);
}

TEST(Density, SaysWhyThereIsNone) {
  Problem p = cantilever();
  EXPECT_FALSE(no_density_stage(p, at_most(0.4)));
  p.scene.supports[0].second = false;
  EXPECT_EQ(no_density_stage(p, at_most(0.4)), "the supports leave the body free to move");
  p = cantilever();
  p.scene.tractions.clear();
  EXPECT_EQ(no_density_stage(p, at_most(0.4)), "there are no loads");
  EXPECT_THROW(density_designs(p, at_most(0.4)), Error);
}

}  // namespace
}  // namespace kerf::density_test
