// Designs as curves: fits keep the area, derivatives of area and J against differences of whole solves, optima against
// the limits asked for and against another evaluation of the same shape.

#include "optimize/curves.hpp"

#include "kerf/shape_gradient.hpp"
#include "optimize/constraints.hpp"
#include "optimize/curves/curve_mesh.hpp"
#include "optimize/curves/fit.hpp"
#include "optimize/loop/evaluate.hpp"
#include "tests/optimize/curves.hpp"

#include <gtest/gtest.h>

#include <random>

namespace kerf::curves_test {
using Eigen::VectorXd;

namespace {

OptimizeRequest stiffest(const Problem& p, const Carved& carved) {
  OptimizeRequest r;
  r.volume_at_most = carved.area / area(p.frame);
  return r;
}

DesignCurves curves_of(const Problem& p, const Carved& carved) {
  const double h = p.sizing.size;
  return design_curves(p.frame, carved, {h, 0.2 * h, 2 * h, h, {1, 2}});
}

}  // namespace

TEST(Curves, FitKeepsTheAreaAndWhatIsNotDesign) {
  const Problem p = scenes::quarter_plate(2, 0.1);
  const Carved carved = scenes::quarter_hole(p, 0.6, 12);
  const Shape shape = fit_curves(p, stiffest(p, carved), carved, {});
  EXPECT_FALSE(find_problem(shape));
  EXPECT_NEAR(area(shape), carved.area, 1e-9);
  EXPECT_EQ(shape.labels, carved.shape.labels);
  EXPECT_LE(shape.outline.sides.size(), 4u + 8u);  // of 12 pieces four arcs or so
  int arcs = 0;
  for (const Side& side : shape.outline.sides) {
    if (!side.arc) continue;
    ++arcs;
    EXPECT_EQ(side.label, 4);
    EXPECT_NEAR(side.arc->axes(0, 0), 0.6, 0.02);
  }
  EXPECT_GE(arcs, 2);
}

TEST(Curves, RingsOfFunctionalsStaySolid) {
  Problem p = scenes::quarter_plate(2, 0.2);
  OptimizeRequest r;
  r.level_set.frozen = {circle("frozen", {1, 1}, 0.1, none)};
  EXPECT_EQ(solid_loops(p, r).size(), 1u);
  r.bounds = {{"G", {"energy_release_rate", {energy_release_rate({1.2, 0.7}, {1, 0}, {0.1, 0.25}, {})}}, 1}};
  const std::vector<Loop> solid = solid_loops(p, r);
  ASSERT_EQ(solid.size(), 2u);
  EXPECT_EQ(solid[0].name, "frozen");
  EXPECT_EQ(solid[1].sides.at(0).arc->center, Vec2(1.2, 0.7));
  EXPECT_DOUBLE_EQ(solid[1].sides[0].arc->axes.col(0).norm(), 0.25);
}

TEST(Curves, TolerancesAndSizesAreThoseAskedFor) {
  Problem p = scenes::quarter_plate(2, 0.1);
  const Carved carved = scenes::quarter_hole(p, 0.6, 24);
  EXPECT_EQ(curve_size(p, {.size = 0.3}), 0.3);
  EXPECT_EQ(curve_size(p, {}), 0.1);
  const auto furthest = [&](double tolerance) {
    const Shape shape = fit_curves(p, stiffest(p, carved), carved, {.tolerance = tolerance});
    double most = 0;
    const Polygon body = flatten(shape.outline, 1e-4, 0.05);
    for (std::size_t i = 0; i < body.points.size(); ++i)
      if (body.label[i] == 4) most = std::max(most, std::abs(body.points[i].norm() - 0.6));
    return std::pair(most, shape.outline.sides.size());
  };
  const auto [near, many] = furthest(2e-3);
  const auto [far, few] = furthest(0.1);
  EXPECT_LE(near, 5e-3);
  EXPECT_LE(far, 0.11);
  EXPECT_LE(few, many);
  p.sizing.size = 0;
  EXPECT_DOUBLE_EQ(curve_size(p, {}), extent(p.frame) / 40);
}

// A compliance that may be no larger than the area times a number: what is to be at most 0 is measured as it is.
TEST(Curves, BoundsOfZeroAreNotRelative) {
  Problem p = scenes::quarter_plate(2, 0.25);
  const Carved carved = scenes::quarter_hole(p, 0.5, 8);
  OptimizeRequest r = stiffest(p, carved);
  Functional difference{"sum", {compliance(), volume()}, true};
  difference.terms[1].factor = -evaluate_design(p, {}, carved.shape, {}).J / carved.area;
  r.bounds = {{"difference", difference, 0}};
  const FinishedCurves f = finish_curves(p, r, carved, {.evaluations = 4}, {});
  ASSERT_FALSE(f.rows.empty());
  for (const CurvesRow& row : f.rows) {
    if (!row.failure.empty()) continue;
    EXPECT_EQ(row.values[0], row.bounds[0]);
  }
  EXPECT_LE(f.bounds[0], f.rows.front().bounds[0]);
  EXPECT_LT(f.J, f.rows.front().J);
}

TEST(Curves, TheDerivativeOfTheAreaIsThatOfDifferences) {
  const Problem p = scenes::quarter_plate(2, 0.1);
  const DesignCurves d = curves_of(p, scenes::quarter_hole(p, 0.6, 12));
  VectorXd by;
  area_of(d, &by);
  for (Eigen::Index k = 0; k < d.variables; ++k) {
    const double step = 1e-5;
    const VectorXd unit = VectorXd::Unit(d.variables, k);
    const double difference =
        (area_of(moved(d, step * unit), nullptr) - area_of(moved(d, -step * unit), nullptr)) / (2 * step);
    EXPECT_NEAR(by[k], difference, 1e-8);
  }
}

// Ends that slide, a crack that ends on the design, body force.
TEST(Curves, TheDerivativeOfJIsThatOfDifferences) {
  Problem p = scenes::quarter_plate(2, 0.25);
  p.scene.body = [](const Vec2& x) { return Vec2(0.3 * x.y(), -0.2); };
  const double r = 0.7, c = std::cos(pi / 4);
  p.frame.cracks = {{"c", {Vec2(0.3 * c, 0.3 * c), Vec2(1.2 * c, 1.2 * c)}}};
  p.scene.laws = {{.kind = CrackLaw::Kind::Open}};
  p.sizing.crack_tip_size = 0.1;
  Carved carved = scenes::quarter_hole(p, r, 10);
  carved.shape.cracks[0].points[0] = {r * c, r * c};
  const DesignCurves d = curves_of(p, carved);
  const CurveMesh mesh = curve_mesh(d, p.sizing);
  const OptimizeRequest request = stiffest(p, carved);
  const auto evaluate = [&](const VectorXd& step) {
    const DesignCurves there = moved(d, step);
    return evaluate_mesh(p, request, shape_of(there), moved(mesh, there).value(), carved.crack_of);
  };
  const Evaluated e = evaluate(VectorXd::Zero(d.variables));
  const Analysis a = analyze(e.objective, e.cases[0].model, e.cases[0].state);
  const VectorXd by = pull_back(mesh, d, shape_gradient(a, e.objective));
  for (Eigen::Index k = 0; k < d.variables; ++k) {
    const double step = 1e-4;
    const VectorXd unit = VectorXd::Unit(d.variables, k);
    const double difference = (evaluate(step * unit).J - evaluate(-step * unit).J) / (2 * step);
    EXPECT_NEAR(by[k], difference, 1e-5 * by.cwiseAbs().maxCoeff()) << k;
  }
}

TEST(Curves, FewSolvesReachTheOptimumAndSayHowFarItIs) {
  const Problem p = scenes::quarter_plate(2, 0.06);
  const Carved carved = scenes::quarter_hole(p, 0.5, 10);
  const FinishedCurves f = finish_curves(p, stiffest(p, carved), carved, {}, {});
  EXPECT_GT(f.residual_before, 0.3);
  EXPECT_LE(f.residual, 0.01) << f.why;
  EXPECT_LE(f.state_solves, 20);
  EXPECT_LT(f.J, f.rows.front().J);
  EXPECT_NEAR(f.area, carved.area, 1e-5 * carved.area);
  EXPECT_TRUE(f.feasible);
  EXPECT_GT(f.price, 0);
  // What is reported is what another program would compute of the shape.
  const Evaluated again = evaluate_design(p, {}, f.shape, {});
  EXPECT_NEAR(again.J, f.J, 1e-12 * f.J);
}

TEST(Curves, AVolumeUnderABoundOnTheCompliance) {
  Problem p = scenes::quarter_plate(2, 0.06);
  const Carved carved = scenes::quarter_hole(p, 0.5, 10);
  const double J = evaluate_design(p, {}, carved.shape, {}).J;
  OptimizeRequest r;
  r.bounds = {{"compliance", p.objective, J}};
  p.objective = {"volume", {volume()}};
  const FinishedCurves f = finish_curves(p, r, carved, {}, {});
  EXPECT_LE(f.residual, 0.01) << f.why;
  EXPECT_LE(f.bounds[0], J * (1 + 1e-3));
  EXPECT_LT(f.area, carved.area);
  EXPECT_DOUBLE_EQ(f.price, 1);
}

// The integral of the squared stress has an upper bound, a few percent above its value: the steps go on until that
// keeps the limit, and a run resumed before or after does the same.
TEST(Curves, BoundsLeaveRoomForWhatIsProvedOnAFinerMesh) {
  Problem p = scenes::quarter_plate(2, 0.15);
  const Carved carved = scenes::quarter_hole(p, 0.5, 10);
  const Functional stress{"stress_pnorm", {stress_pnorm(2, {}, false)}};
  p.objective = stress;
  const double most = evaluate_design(p, {}, carved.shape, {}).J;
  p.objective = {"volume", {volume()}};
  OptimizeRequest r;
  r.bounds = {{"stress", stress, most}};
  const FinishedCurves whole = finish_curves(p, r, carved, {}, {});
  ASSERT_TRUE(whole.finer) << whole.why;
  EXPECT_LT(whole.finer->violation, 1e-3);
  EXPECT_LE(whole.finer->intervals.at(0).upper, most * (1 + 1e-3));
  EXPECT_LT(whole.bounds[0], most * (1 - 2e-3));
  EXPECT_GT(whole.bounds[0], most * 0.9);
  EXPECT_LE(whole.residual, 0.01) << whole.why;
  for (const std::size_t done : {2ul, whole.rows.size() / 2, whole.rows.size() - 1}) {
    const std::vector<CurvesRow> known(whole.rows.begin(), whole.rows.begin() + std::ptrdiff_t(done));
    const FinishedCurves again = finish_curves(p, r, carved, {}, {}, known);
    EXPECT_EQ(again.J, whole.J);
    EXPECT_EQ(again.residual, whole.residual);
    EXPECT_EQ(again.finer->intervals.at(0).upper, whole.finer->intervals[0].upper);
    EXPECT_EQ(again.rows.size(), whole.rows.size());
  }
}

TEST(Curves, ArcsAreNoTighterThanAsked) {
  const Problem p = scenes::quarter_plate(2, 0.12);
  const Carved carved = scenes::quarter_hole(p, 0.5, 10);
  const FinishedCurves f = finish_curves(p, stiffest(p, carved), carved, {.min_radius = 0.42}, {});
  for (const Side& side : f.shape.outline.sides)
    if (side.arc) {
      EXPECT_GE(side.arc->axes(0, 0), 0.42 * (1 - 0.02));
      EXPECT_LT(f.J, f.rows.front().J);
    }
}

TEST(Curves, ResumingThreadsAndUnitsChangeNothing) {
  Problem p = scenes::quarter_plate(2, 0.2);
  const Carved carved = scenes::quarter_hole(p, 0.5, 8);
  const OptimizeRequest r = stiffest(p, carved);
  const FinishedCurves whole = finish_curves(p, r, carved, {.evaluations = 9}, {});
  for (const std::size_t done : {1u, 4u, 7u}) {
    const std::vector<CurvesRow> known(whole.rows.begin(), whole.rows.begin() + std::ptrdiff_t(done));
    int shown = 0;
    const FinishedCurves rest = finish_curves(
        p, r, carved, {.evaluations = 9}, [&](const CurvesIterate&) { return ++shown, true; }, known);
    EXPECT_EQ(rest.J, whole.J);
    EXPECT_EQ(rest.residual, whole.residual);
    ASSERT_EQ(rest.rows.size(), whole.rows.size());
    EXPECT_EQ(rest.rows.back().knots, whole.rows.back().knots);
    EXPECT_LE(shown, int(whole.rows.size() - done));
  }
  // With more evaluations than the run before, whose last rows are those of its end.
  const FinishedCurves cut = finish_curves(p, r, carved, {.evaluations = 5}, {}),
                       longer = finish_curves(p, r, carved, {.evaluations = 9}, {}, cut.rows);
  EXPECT_NE(cut.rows.back().knots, whole.rows[cut.rows.size() - 1].knots);
  EXPECT_EQ(longer.J, whole.J);
  ASSERT_EQ(longer.rows.size(), whole.rows.size());
  EXPECT_EQ(longer.rows.back().knots, whole.rows.back().knots);
  p.threads = 2;
  const FinishedCurves two = finish_curves(p, r, carved, {.evaluations = 9}, {});
  EXPECT_EQ(two.rows.back().knots, whole.rows.back().knots);
  const double unit = 1024;  // a power of two: the same bits
  Problem q = scenes::quarter_plate(2 * unit, 0.2 * unit);
  const Carved large = scenes::quarter_hole(q, 0.5 * unit, 8);
  const FinishedCurves other = finish_curves(q, stiffest(q, large), large, {.evaluations = 9}, {});
  EXPECT_NEAR(other.rows[0].J / (unit * unit), whole.rows[0].J, 1e-9 * whole.J);
  EXPECT_NEAR(other.J / (unit * unit), whole.J, 1e-4 * whole.J);
}

TEST(Curves, WhatCannotBeMovedStaysAsCarved) {
  Problem p = scenes::quarter_plate(2, 0.2);
  const Carved carved = scenes::quarter_hole(p, 0.5, 8);
  p.element = element("p2", 1);
  const FinishedCurves f = finish_curves(p, stiffest(p, carved), carved, {}, {});
  ASSERT_EQ(f.notes.size(), 1u);
  EXPECT_NE(f.notes[0].find("stays as carved"), std::string::npos);
  EXPECT_EQ(f.shape.outline.sides.size(), carved.shape.outline.sides.size());
  EXPECT_EQ(f.state_solves, 0);
}

TEST(Curves, WhatHasNoDerivativeOrNoBoundaryStaysAsCarved) {
  Problem p = scenes::quarter_plate(2, 0.2);
  Carved carved = scenes::quarter_hole(p, 0.5, 8);
  carved.shape.outline = p.frame.outline;
  EXPECT_EQ(finish_curves(p, stiffest(p, carved), carved, {}, {}).why,
            "the design stays as carved: no boundary of the body is free to move");
}

TEST(Curves, TheObserverStopsThem) {
  const Problem p = scenes::quarter_plate(2, 0.2);
  const Carved carved = scenes::quarter_hole(p, 0.5, 8);
  for (const int most : {1, 3}) {
    int shown = 0;
    const FinishedCurves f =
        finish_curves(p, stiffest(p, carved), carved, {}, [&](const CurvesIterate&) { return ++shown < most; });
    EXPECT_EQ(shown, most);
    EXPECT_EQ(f.why, "stopped as asked");
    EXPECT_FALSE(f.finer);
    EXPECT_TRUE(f.rows.back().accepted);
    EXPECT_EQ(f.J, f.rows.back().J);
  }
  const FinishedCurves used = finish_curves(p, stiffest(p, carved), carved, {.evaluations = 1}, {});
  EXPECT_EQ(used.rows.size(), 1u);
  EXPECT_EQ(used.why, "all 1 evaluations are used");
}

// The hole becomes twice as long as high: a stiff disc, what is frozen and a crack lie in its way.
TEST(Curves, KeepOffWhatMayNotBeTouched) {
  Problem p = scenes::quarter_plate(2, 0.12);
  p.frame.regions = {circle("stiff", {0.72, 0.18}, 0.08, none)};
  p.scene.regions = {plane_stress(5, 0.3)};
  p.frame.cracks = {arc_crack("c", {0, 0}, 0.7, 0.9, 1.3)};
  p.scene.laws = {{.kind = CrackLaw::Kind::Open}};
  p.sizing.crack_tip_size = 0.05;
  const Carved carved = scenes::quarter_hole(p, 0.5, 10);
  OptimizeRequest r = stiffest(p, carved);
  r.level_set.frozen = {circle("frozen", {0.6, 0.45}, 0.1, none)};
  const FinishedCurves f = finish_curves(p, r, carved, {.evaluations = 8}, {});
  EXPECT_LT(f.J, f.rows.front().J);
  EXPECT_FALSE(find_problem(f.shape));
  const Polygon body = flatten(f.shape.outline, 1e-3, 0.02);
  for (std::size_t i = 0; i < body.points.size(); ++i) {
    if (body.label[i] != 4) continue;
    const Vec2& x = body.points[i];
    EXPECT_GT((x - Vec2(0.72, 0.18)).norm(), 0.08 + 0.4 * 0.12) << x.transpose();
    EXPECT_GT((x - Vec2(0.6, 0.45)).norm(), 0.1) << x.transpose();
    EXPECT_GT(std::abs(x.norm() - 0.7), 0.4 * 0.12 * (std::abs(std::atan2(x.y(), x.x()) - 1.1) < 0.2)) << x.transpose();
  }
}

// Discs and triangles that the carved hole cuts into: what is solid comes back before anything is solved, and stays.
TEST(Curves, NoFrozenPartIsCut) {
  std::mt19937 bits(7);
  const auto dice = [&](double a, double b) { return a + (b - a) * (double(bits()) / double(std::mt19937::max())); };
  for (int k = 0; k < 8; ++k) {
    const Problem p = scenes::quarter_plate(2, 0.2);
    const Carved carved = scenes::quarter_hole(p, 0.6, 12);
    OptimizeRequest r = stiffest(p, carved);
    const double t = dice(0.15, pi / 2 - 0.15), R = dice(0.05, 0.3), cut = dice(0, 0.1);
    const Vec2 way(std::cos(t), std::sin(t)), side(-way.y(), way.x());
    r.level_set.frozen = {circle("disc", (0.6 + R - cut) * way, R, none)};
    if (k % 2 == 1)
      r.level_set.frozen = {polygon(
          "tip", {(0.6 - cut) * way, (0.6 + R) * way - 0.5 * R * side, (0.6 + R) * way + 0.7 * R * side}, none)};
    EXPECT_GT(intrusion(carved.shape, p.frame, r.level_set.frozen[0]).depth, 0.0) << k;
    const FinishedCurves f = finish_curves(p, r, carved, {.evaluations = 5}, {});
    const Intrusion left = intrusion(f.shape, p.frame, r.level_set.frozen[0]);
    EXPECT_EQ(left.depth, 0) << k << ": at " << left.at.transpose() << ", " << f.why;
    EXPECT_EQ(left.share, 0);
  }
}

// A round hole beside the quarter hole: the member in between is too thin, and so is the gap of a second hole. Both get
// what was asked for, and the area stays.
TEST(Curves, ThinMembersAndNarrowGapsGetWider) {
  std::mt19937 bits(11);
  const auto dice = [&](double a, double b) { return a + (b - a) * (double(bits()) / double(std::mt19937::max())); };
  for (int k = 0; k < 6; ++k) {
    const Problem p = scenes::quarter_plate(2, 0.12);
    Carved carved = scenes::quarter_hole(p, 0.5, 12);
    const double asked = dice(0.15, 0.25), width = dice(0.4, 0.95) * asked, t = dice(0.3, pi / 2 - 0.3),
                 radius = dice(0.15, 0.3);
    const Vec2 center = (0.5 + width + radius) * Vec2(std::cos(t), std::sin(t));
    std::vector<Vec2> points;
    const double gap = k % 2 == 0 ? 2 * radius : 0.8 * asked;  // of an oval
    for (int i = 0; i < 16; ++i) {
      const double a = -2 * pi * i / 16;  // the body on the left
      points.push_back(center + Vec2(radius * std::cos(a), 0.5 * gap * std::sin(a)));
    }
    carved.shape.holes.push_back(polygon("hole", points, 4));
    carved.area = area(carved.shape);
    OptimizeRequest r = stiffest(p, carved);
    r.level_set.min_feature = asked;
    if (k % 2 == 1) r.level_set.min_gap = asked;
    const FinishedCurves f =
        finish_curves(p, r, carved, {.min_feature = asked, .min_gap = r.level_set.min_gap, .evaluations = 4}, {});
    for (const KeptConstraint& c : constraints_of({.shape = f.shape, .frame = &p.frame}, r))
      EXPECT_TRUE(c.kept) << k << ": " << c.note << "; " << f.why;
  }
}

// Two load cases, a bound on the worse of them.
TEST(Curves, BoundsHoldInEveryLoadCase) {
  Problem p = scenes::quarter_plate(2, 0.2);
  const Carved carved = scenes::quarter_hole(p, 0.5, 8);
  OptimizeRequest r;
  r.load_cases = {{"both", 1, p.scene.tractions, {}}, {"half", 0.5, {p.scene.tractions[0]}, {}}};
  p.scene.tractions.clear();
  const Evaluated e = evaluate_design(p, r, carved.shape, {});
  r.bounds = {{"compliance", p.objective, e.cases.size() == 2 ? 1.02 * e.J : 0}};
  p.objective = {"volume", {volume()}};
  const FinishedCurves f = finish_curves(p, r, carved, {.evaluations = 10}, {});
  EXPECT_TRUE(f.feasible) << f.why;
  EXPECT_LE(f.bounds[0], r.bounds[0].at_most * (1 + 1e-3));
  EXPECT_LT(f.area, f.rows.front().area);
  EXPECT_NEAR(f.J, 1.5 * f.area, 1e-5 * f.J);  // of the mesh: chords
}

// Ends of the design stay where a side bears something or is looked at; cracks that end at it are kept in touch.
TEST(Curves, EndsAndMouthsStay) {
  Problem p = scenes::quarter_plate(2, 0.2);
  Carved carved = scenes::quarter_hole(p, 0.5, 8);
  const auto ends = [&](const Problem& q, const OptimizeRequest& r) {
    int moved = 0;
    const Shape shape = fit_curves(q, r, carved, {.min_feature = 0.1});
    for (const Side& side : shape.outline.sides) moved += int((side.start - Vec2(0.5, 0)).norm() < 1e-12);
    return moved;  // 1: the end on the bottom is where it was
  };
  EXPECT_EQ(ends(p, stiffest(p, carved)), 1);
  Problem looked = p;
  looked.objective = {"tracking", {boundary_tracking(0, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }, {})}};
  EXPECT_EQ(ends(looked, stiffest(p, carved)), 1);
  OptimizeRequest measured = stiffest(p, carved);
  measured.bounds = {
      {"gap", {"misfit", {misfit(0, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); })}}, 1}};
  EXPECT_EQ(ends(p, measured), 1);
  // A crack that ends at a corner of the polygon, at its first or last point, or between two of them.
  const std::vector<Side>& sides = carved.shape.outline.sides;
  const std::vector<Vec2> mouths = {sides[6].start, sides[7].start, 0.5 * (sides[7].start + sides[8].start)};
  for (const Vec2& mouth : mouths) {
    Carved cracked = carved;
    cracked.shape.cracks = {{"c", {mouth, mouth + 0.5 * mouth.normalized()}, {}}};
    cracked.crack_of = {0};
    const DesignCurves d = curves_of(p, cracked);
    int there = 0;
    for (std::size_t k = 0; k < d.holds[0].size(); ++k)
      if ((d.chains[0].knots[k].at - mouth).norm() < 1e-9) {
        ++there;
        EXPECT_EQ(d.holds[0][k].kind, KnotHold::Kind::Fixed);
      }
    EXPECT_EQ(there, 1) << mouth.transpose();
  }
}

// What is left of a side beside the end of the design would be a tiny edge: the design goes to the corner.
TEST(Curves, TinySidesBesideTheDesignGo) {
  const Problem p = scenes::quarter_plate(2, 0.2);
  Carved carved = scenes::quarter_hole(p, 0.5, 8);
  std::vector<Side>& sides = carved.shape.outline.sides;
  // From (2, 0.02) on the right side: what remains of it below is a tenth of the mesh size.
  for (std::size_t k = 4; k < sides.size(); ++k) sides[k].label = 0;
  std::vector<Side> cut{{{0, 0}, 0, std::nullopt}, {{2, 0}, 1, std::nullopt}};
  for (int k = 0; k < 6; ++k)
    cut.push_back({Vec2(2 - 0.1 * k * (5 - k) / 4, 0.02 + 0.3 * k), 4, std::nullopt, false, true});
  cut.push_back({{2, 1.8}, 1, std::nullopt});
  cut.push_back({{2, 2}, 2, std::nullopt});
  cut.push_back({{0, 2}, 3, std::nullopt});
  sides = cut;
  carved.area = area(carved.shape);
  const auto first_knot = [&](const std::vector<Index>& solid) {
    const double h = p.sizing.size;
    return design_curves(p.frame, carved, {h, 0.2 * h, 2 * h, h, solid}).chains[0].knots.front().at;
  };
  EXPECT_LT((first_knot({2}) - Vec2(2, 0)).norm(), 1e-12);
  EXPECT_LT((first_knot({1, 2}) - Vec2(2, 0.02)).norm(), 1e-12);  // a side that bears something stays
}

}  // namespace kerf::curves_test
