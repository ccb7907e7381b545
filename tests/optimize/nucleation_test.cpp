// How large holes are cut, and what the log says that they do.

#include "optimize/level_set/hole_terms.hpp"
#include "optimize/level_set/nucleate.hpp"
#include "topo/changes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::nucleation_test {
namespace {

/// Clamped on the left, bent and pulled by the right side.
Problem plate(double size) {
  Problem p;
  p.frame.labels = {"side", "right", "left"};
  p.frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0);
  p.frame.outline.sides[1].label = 1;
  p.frame.outline.sides[3].label = 2;
  p.scene.material = plane_stress(1, 0.3);
  p.plane_strain = false;
  p.scene.supports = {{.label = 2, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{.label = 1, .value = [](const Vec2&, const Vec2&) -> Vec2 { return {1, -0.5}; }}};
  p.sizing.size = size;
  p.objective = {"compliance", {compliance()}};
  return p;
}

OptimizeRequest full_body(int iterations) {
  OptimizeRequest r;
  r.volume_at_most = 0.5;
  r.max_iterations = iterations;
  r.level_set.nucleate_every = 2;
  return r;
}

/// A support that moves a little: no density stage knows it, and holes appear in the full body.
Problem cantilever(double size) {
  Problem p = plate(size);
  p.frame.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 0.45}, {2, 0.55}, {2, 1}, {0, 1}}, 0);
  p.frame.labels = {"side", "load", "left"};
  p.frame.outline.sides[2].label = 1;
  p.frame.outline.sides[5].label = 2;
  p.scene.supports[0].value = [](const Vec2&, const Vec2&) -> Vec2 { return {0, 1e-9}; };
  p.scene.tractions[0].value = [](const Vec2&, const Vec2&) -> Vec2 { return {0, -10}; };
  return p;
}

/// Left at that iteration, without what judges the end.
OptimizeResult begun(const Problem& p, const OptimizeRequest& r, int last) {
  return optimize_level_set(p, r, [last](const Iterate& i) { return i.row.number < last; }, {});
}

TEST(Nucleation, TheRadiusGainsMost) {
  constexpr double most = 0.3;
  const auto gain = [](const HoleTerms& h, double price, double r) { return price * pi * r * r - h.change(r); };
  for (const double c2 : {-8.0, -0.5, 0.0, 1.0, 6.0, 40.0, 400.0})
    for (const double T : {-1.0, 0.2, 0.99, 1.4}) {
      const HoleTerms h{.T = T, .c2 = c2};
      const double found = best_radius(h, 1, most);
      double best = 0;
      for (int i = 1; i <= 3000; ++i) best = std::max(best, gain(h, 1, most * i / 3000));
      EXPECT_NEAR(gain(h, 1, found), best, 1e-6 * (1 + best)) << T << ' ' << c2;
      EXPECT_LE(found, most);
    }
  EXPECT_NEAR(best_radius({.T = 0.5, .c2 = 25}, 1, most), 0.1, 1e-15);  // sqrt((price - T) / (2 c2))
  // Where c2 is not known T alone decides.
  EXPECT_EQ(best_radius({.T = 0.5}, 1, most), most);
  EXPECT_EQ(best_radius({.T = 1.5}, 1, most), 0);
  EXPECT_DOUBLE_EQ(HoleTerms{.T = 2}.change(0.1), 0.02 * pi);
}

TEST(Nucleation, ASecondTermThatPunishesLargeHolesMakesThemSmaller) {
  const Problem p = plate(0.08);
  const BackgroundMesh b = background_mesh(triangulate(p.frame, {.size = 0.04}), {.held = {2}}, {});
  const Eigen::VectorXd d = signed_distance(b, Eigen::VectorXd::Constant(b.lumped.size(), -1));
  const Eigen::VectorXd T = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(b.mesh.triangles.size()), 0.5);
  const auto places = [&](double c2) {
    return places_to_nucleate(b, d, {b.mesh, T, [&](const Vec2&) { return HoleTerms{.T = 0.5, .c2 = c2}; }},
                              {.multiplier = 1, .area = 0.5, .least = 0.04, .most = 0.1});
  };
  ASSERT_FALSE(places(0).empty());
  EXPECT_TRUE(places(1e4).empty());
  double largest = 0;  // 0.05 gains most, and has no room everywhere
  for (const Disc& disc : places(100)) largest = std::max(largest, disc.radius);
  EXPECT_DOUBLE_EQ(largest, 0.05);
  // Where the mesh does not resolve the second term no hole is cut, but on coarse meshes of rankings.
  const HolesIn coarse{b.mesh, T, [](const Vec2&) { return HoleTerms{.T = 0.5, .resolved = false}; }};
  const Nucleation how{.multiplier = 1, .area = 0.5, .least = 0.04, .most = 0.1};
  Nucleation ranking = how;
  ranking.resolved = false;
  EXPECT_TRUE(places_to_nucleate(b, d, coarse, how).empty());
  EXPECT_FALSE(places_to_nucleate(b, d, coarse, ranking).empty());
  // The support is a side as others are: distances of level sets do not know it.
  for (const Disc& disc : places(0)) EXPECT_GE(disc.center.x(), 3 * disc.radius - 1e-12);
}

TEST(Nucleation, DiscsAreTheirOwnMirrorImage) {
  const Problem p = plate(0.08);
  const BackgroundMesh b =
      background_mesh(triangulate(p.frame, {.size = 0.04}), {.held = {2}}, Mirror{{0, 0.5}, {1, 0}});
  const Eigen::VectorXd d = signed_distance(b, Eigen::VectorXd::Constant(b.lumped.size(), -1));
  const auto least = [](const Vec2& x) {  // on one side of the axis
    return HoleTerms{.T = std::min((x - Vec2(0.7, 0.3)).norm(), (x - Vec2(1.4, 0.55)).norm())};
  };
  Eigen::VectorXd T(static_cast<Eigen::Index>(b.mesh.triangles.size()));
  for (Index t = 0; t < T.size(); ++t) T[t] = least(centroid(b.mesh, t)).T;
  const std::vector<Disc> discs =
      places_to_nucleate(b, d, {b.mesh, T, least}, {.multiplier = 0.1, .area = 1, .least = 0.04, .most = 0.07});
  ASSERT_GE(discs.size(), 3u);
  for (const Disc& disc : discs) {
    const Vec2 image(disc.center.x(), 1 - disc.center.y());
    EXPECT_TRUE(std::ranges::any_of(discs, [&](const Disc& o) { return (o.center - image).norm() < 1e-12; }));
  }
  // What is cut stays when the function becomes its own mirror image.
  Eigen::VectorXd phi = d;
  cut_discs(b, discs, phi);
  phi = constrained(b, phi);
  for (const Disc& disc : discs) EXPECT_GT(value_at(b, phi, disc.center), 0.5 * disc.radius);
}

TEST(Nucleation, HolesAreFoundInWhatWasDrawn) {
  Shape shape = plate(0.1).frame;
  shape.holes.push_back(circle("round", {0.52, 0.5}, 0.1, 0));
  shape.holes.push_back(ellipse("joined", {1.3, 0.5}, {0.3, 0.08}, 0, 0));
  const std::vector<Disc> discs{{{0.5, 0.5}, 0.12}, {{1.2, 0.5}, 0.1}, {{0.2, 0.2}, 0.05}};
  const std::vector<NucleatedHole> holes = drawn_holes(discs, shape);
  ASSERT_EQ(holes.size(), 3u);
  EXPECT_NEAR(holes[0].radius, 0.1, 5e-4);
  EXPECT_LT((holes[0].at - Vec2(0.52, 0.5)).norm(), 1e-6);
  EXPECT_TRUE(holes[0].note.empty());
  EXPECT_TRUE(std::isnan(holes[1].radius) && !holes[1].note.empty());
  EXPECT_TRUE(std::isnan(holes[2].radius) && !holes[2].note.empty());
}

// The truth comes from bodies with the hole drawn, on a mesh of their own, of degree 2.
TEST(Nucleation, TwoTermsFollowHolesDrawnOnOtherMeshes) {
  const Problem coarse = plate(0.06);
  Problem fine = plate(0.04);
  fine.element = element("bdms", 2);
  const Evaluated body = evaluate_design(coarse, {}, coarse.frame, {});
  HoleExpansion expansion(analyze_objective(body), {});
  const double before = evaluate_design(fine, {}, fine.frame, {}).J;
  for (const auto& [at, radius] : {Disc{{0.9, 0.3}, 0.1}, Disc{{1.4, 0.62}, 0.12}}) {
    Shape with = fine.frame;
    with.holes.push_back(circle("hole", at, radius, 0));
    const double made = evaluate_design(fine, {}, with, {}).J - before;
    const HoleTerms h = expansion.objective(at);
    EXPECT_NEAR(h.change(radius), made, 0.02 * made);
    EXPECT_GT(std::abs(pi * radius * radius * h.T - made), 0.05 * made);  // T alone does not
    const Scene& scene = body.cases.front().model.scene;
    const std::array changes{SmallChange{at, radius}};
    const ChangesMade alone =
        changes_at({{body.shape, coarse.sizing}, coarse.element, std::span(&scene, 1), body.objective}, {}, changes);
    EXPECT_EQ(alone.meshes, 1);
    EXPECT_NEAR(alone.difference(0, 0), made, 0.02 * made);
  }
}

TEST(Nucleation, TheLogHoldsInARun) {
  const OptimizeResult result = begun(cantilever(0.08), full_body(30), 6);
  int made = 0;
  for (const NucleatedHole& h : result.nucleated) {
    const Iteration& row = *std::ranges::find(result.history, h.iteration, &Iteration::number);
    EXPECT_NE(row.note.find("nucleated"), std::string::npos) << row.note;
    if (!std::isfinite(h.actual)) {
      EXPECT_FALSE(h.note.empty());
      continue;
    }
    ++made;
    EXPECT_NEAR(h.predicted, pi * h.radius * h.radius * (h.T + (std::isnan(h.c2) ? 0 : h.c2 * h.radius * h.radius)),
                1e-12 * std::abs(h.predicted));
    EXPECT_NEAR(h.predicted, h.actual, 0.1 * std::abs(h.actual)) << h.at.transpose() << ' ' << h.radius;
  }
  EXPECT_GE(made, 3);
}

TEST(Nucleation, ABodyForceLeavesTAlone) {
  Problem p = cantilever(0.08);
  p.scene.body = [](const Vec2&) -> Vec2 { return {0, -0.1}; };
  const OptimizeResult result = begun(p, full_body(30), 4);
  int drawn = 0;
  for (const NucleatedHole& h : result.nucleated) {
    EXPECT_TRUE(std::isnan(h.c2));
    if (!std::isfinite(h.radius)) continue;
    ++drawn;
    EXPECT_DOUBLE_EQ(h.predicted, pi * h.radius * h.radius * h.T);
  }
  EXPECT_GE(drawn, 1);
}

TEST(Nucleation, LoadCasesWeighInTheLog) {
  Problem p = cantilever(0.08);
  const std::vector<Traction> load = p.scene.tractions;
  p.scene.tractions.clear();
  OptimizeRequest r = full_body(30);
  const auto with = [&](double weight) {
    r.load_cases = {{.name = "one", .weight = weight, .tractions = load},
                    {.name = "two", .weight = weight, .tractions = load}};
    return begun(p, r, 2).nucleated;
  };
  const std::vector<NucleatedHole> half = with(0.5), whole = with(1);
  ASSERT_FALSE(half.empty());
  ASSERT_EQ(half.size(), whole.size());
  for (std::size_t i = 0; i < half.size(); ++i) {
    if (!std::isfinite(half[i].actual)) continue;
    EXPECT_NEAR(2 * half[i].actual, whole[i].actual, 1e-6 * std::abs(whole[i].actual));
    EXPECT_NEAR(2 * half[i].predicted, whole[i].predicted, 1e-6 * std::abs(whole[i].predicted));
  }
}

TEST(Changes, NoRoomIsNoNumber) {
  const Problem p = plate(0.1);
  const std::array changes{SmallChange{{1, 0.5}, 0.1}, SmallChange{{1, 0.06}, 0.1}, SmallChange{{3, 0.5}, 0.1}};
  const ChangesMade made =
      changes_at({{p.frame, p.sizing}, p.element, std::span(&p.scene, 1), p.objective}, {}, changes);
  EXPECT_GT(made.difference(0, 0), 0);
  EXPECT_TRUE(std::isnan(made.difference(1, 0)) && std::isnan(made.difference(2, 0)));
  EXPECT_EQ(made.meshes, 1);
  EXPECT_THROW(changes_at({{p.frame, p.sizing}, p.element, std::span(&p.scene, 1), p.objective},
                          {.kind = Perturbation::Kind::Crack}, changes),
               Error);
}

}  // namespace
}  // namespace kerf::nucleation_test
