// Quantities that are bounded together, against the same one by one, which takes another way: with indicators.
#include "kerf/bounds.hpp"

#include "kerf/fracture.hpp"
#include "tests/solver/exact_crack.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <functional>

namespace kerf::lane_bounds_test {
namespace {

exact::ExactField inclined() {
  return exact::table_field("c03_inclined_open", 0.3);
}

QuantityRequest many(const CrackProblem& p) {
  const auto along = [](int k) { return [k](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Unit(k); }; };
  return {.tips = crack_tips(p.model, p.state),
          .points = {{0.3, 0.9}, {-1.2, -0.3}},
          .discs = {{{1.2, -1.1}, 0.3}},
          .lines = {{{-1.5, 1.0}, {-0.5, 1.4}}},
          .works = {{{2, along(0)}}, {{2, along(1)}}},
          .reactions = {{{0}, 0}, {{0}, 1}}};
}

std::vector<Bounded> listed(const QuantityIntervals& q) {
  std::vector<Bounded> all;
  for (const TipBounds& b : q.tips) all.insert(all.end(), {b.K_I, b.K_II, b.G});
  for (const std::vector<StressBounds>* of : {&q.points, &q.discs, &q.lines})
    for (const StressBounds& b : *of) all.insert(all.end(), {b.s11, b.s22, b.s12});
  all.insert(all.end(), q.works.begin(), q.works.end());
  all.insert(all.end(), q.reactions.begin(), q.reactions.end());
  return all;
}

void expect_the_same(const char* name, int degree, const std::vector<Index>& held) {
  const CrackProblem p = crack_problem(inclined(), 4, degree, held, CrackLaw::Kind::Open, name);
  const QuantityBounds together(p.model, p.state), alone(p.model, p.state, true);
  const std::vector<Bounded> all = listed(together.all(many(p))), each = listed(alone.all(many(p)));
  ASSERT_EQ(all.size(), each.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string which = fmt::format("{} {} held {} quantity {}", name, degree, held.size(), i);
    EXPECT_EQ(all[i].guaranteed, each[i].guaranteed) << which << all[i].note << each[i].note;
    EXPECT_EQ(all[i].note, each[i].note) << which;
    const double width = each[i].upper - each[i].lower;
    if (!std::isfinite(width)) continue;  // nothing holds the body: no reaction
    EXPECT_NEAR(all[i].lower, each[i].lower, 1e-6 * width) << which;
    EXPECT_NEAR(all[i].upper, each[i].upper, 1e-6 * width) << which;
  }
}

// Where one side alone holds the body, what it bears is known but for rounding.
TEST(QuantityBounds, AreTheSameTogetherAndOneByOne) {
  for (const std::vector<Index>& held : {std::vector<Index>{0}, std::vector<Index>{}, std::vector<Index>{0, 2}})
    expect_the_same("bdms", 1, held);
  expect_the_same("bdms", 2, {0});
  expect_the_same("bdms", 3, {0});
  expect_the_same("bdms", 4, {0});
  expect_the_same("afw", 1, {0});
}

/// The crack of `inclined`, label 0 held, and something for which singular fields are cut off.
struct Changed {
  Model model;
  State state;
  Changed(int degree, const std::function<void(Mesh&, Scene&)>& change) : model(of(degree, change)) {
    state = solve(model);
  }
  static Model of(int degree, const std::function<void(Mesh&, Scene&)>& change) {
    CrackProblem p = crack_problem(inclined(), 8, degree, {0});
    Mesh mesh = p.model.mesh;
    Scene scene = p.model.scene;
    change(mesh, scene);
    return prepare(mesh, p.model.element, scene, 1);
  }
};

void expect_cut_off_alike(const std::string& name, int degree, const std::function<void(Mesh&, Scene&)>& change) {
  const Changed c(degree, change);
  const QuantityRequest request{.tips = crack_tips(c.model, c.state),
                                .points = {{0.3, 1.2}, {-1.2, -0.3}},
                                .discs = {{{-1.2, 1.2}, 0.1}},
                                .lines = {{{-1.4, 1.2}, {-1.2, 1.3}}},
                                .works = {{{2, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::UnitX(); }}}}};
  const std::vector<Bounded> all = listed(QuantityBounds(c.model, c.state).all(request)),
                             each = listed(QuantityBounds(c.model, c.state, true).all(request));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string which = fmt::format("{} {} quantity {}", name, degree, i);
    EXPECT_EQ(all[i].guaranteed, each[i].guaranteed) << which << all[i].note << each[i].note;
    EXPECT_EQ(all[i].note, each[i].note) << which;
    const double width = each[i].upper - each[i].lower;
    EXPECT_NEAR(all[i].lower, each[i].lower, 1e-6 * width) << which;
    EXPECT_NEAR(all[i].upper, each[i].upper, 1e-6 * width) << which;
  }
}

TEST(QuantityBounds, CutOffAreTheSameTogetherAndOneByOne) {
  const auto weight = [](Mesh&, Scene& s) { s.body = [](const Vec2&) -> Vec2 { return {0.1, -0.3}; }; };
  const auto uneven = [](Mesh&, Scene& s) {
    s.body = [](const Vec2& x) -> Vec2 { return {0.2 * x.y(), x.x() * x.x() - 0.3}; };
  };
  const auto pressed = [](Mesh&, Scene& s) {
    s.laws[0].pressure = [](const Vec2& x, const Vec2&) -> Vec2 { return {0.2 + 0.1 * x.x(), 0}; };
  };
  const auto stiff = [](Mesh& m, Scene& s) {
    s.regions = {plane_strain(5, 0.2)};
    m.region.assign(m.triangles.size(), none);
    for (Index t = 0; t < static_cast<Index>(m.triangles.size()); ++t)
      if (centroid(m, t).x() > 1.5) m.region[static_cast<std::size_t>(t)] = 0;
  };
  expect_cut_off_alike("weight", 1, weight);
  expect_cut_off_alike("uneven", 1, uneven);
  expect_cut_off_alike("uneven", 2, uneven);
  expect_cut_off_alike("pressed", 1, pressed);
  expect_cut_off_alike("materials", 1, stiff);
  expect_cut_off_alike("materials", 2, stiff);
}

TEST(QuantityBounds, TogetherHaveTheSameBitsForAnyNumberOfThreads) {
  CrackProblem p = crack_problem(inclined(), 12, 1, {0});
  const std::vector<Bounded> one = listed(QuantityBounds(p.model, p.state).all(many(p)));
  p.model.threads = 3;
  const std::vector<Bounded> three = listed(QuantityBounds(p.model, p.state).all(many(p)));
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].lower, three[i].lower) << i;
    EXPECT_EQ(one[i].upper, three[i].upper) << i;
  }
}

// What one of them lacks does not touch the others.
TEST(QuantityBounds, StandBesideOnesThatThereAreNot) {
  const exact::ExactField f = inclined();
  const CrackProblem p = crack_problem(f, 12, 1, {0});
  const Vec2 inside(0.3, 0.9), outside(3, 0);
  const QuantityIntervals q = QuantityBounds(p.model, p.state).all({.points = {outside, inside}});
  EXPECT_EQ(q.points[0].s11.note, "no bounds: the point lies outside the body");
  const Mat2 exact = f.stress(inside, exact::side_of(f, inside));
  EXPECT_LE(q.points[1].s22.lower, exact(1, 1));
  EXPECT_GE(q.points[1].s22.upper, exact(1, 1));
  EXPECT_TRUE(q.points[1].s22.guaranteed);
}

}  // namespace
}  // namespace kerf::lane_bounds_test
