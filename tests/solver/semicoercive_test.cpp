// Pieces that contact alone holds: patches, resultants, what is solvable and what is told free to move.

#include "kerf/mesher.hpp"
#include "kerf/recover.hpp"
#include "kerf/state.hpp"
#include "kerf/validate.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace kerf::standing_test {
namespace {

constexpr Index bottom = 0, side = 1, top = 2;

/// Blocks of width 2 and height 1 on top of each other, the faces between them cracks from side to side.
Shape stack(int blocks) {
  const double height = blocks;
  Shape shape{.outline = polygon("outline", {{-1, 0}, {1, 0}, {1, height}, {-1, height}}, side),
              .labels = {"bottom", "side", "top"}};
  shape.outline.sides[0].label = bottom;
  shape.outline.sides[2].label = top;
  for (int i = 1; i < blocks; ++i) shape.cracks.push_back({fmt::format("c{}", i), {{-1., i}, {1., i}}, {}});
  return shape;
}

Scene on_ground(const Shape& shape, double friction = 0) {
  Scene s{.material = plane_strain(1, 0.3)};
  s.supports = {{bottom, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  s.laws.assign(shape.cracks.size(), {.friction = friction});
  return s;
}

void load_top(Scene& s, std::function<Vec2(double x)> t) {
  s.tractions.push_back({top, [t](const Vec2& x, const Vec2&) { return t(x.x()); }});
}

struct Solved {
  Model model;
  State state;
};
Solved solved(const Shape& shape, const Scene& scene, double size = 0.25, const Element& e = bdms(1)) {
  Model m = prepare(triangulate(shape, {.size = size}), e, scene, 1);
  State s = solve(m);
  EXPECT_TRUE(certified(s)) << s.certificate.kkt << ' ' << s.certificate.work;
  return {std::move(m), std::move(s)};
}

std::string refusal_of(const Shape& shape, const Scene& scene) {
  try {
    solve(prepare(triangulate(shape, {.size = 0.25}), bdms(1), scene, 1));
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

/// Force and moment about x = 0 that a crack transmits.
Vec2 resultant(const Solved& s, Index crack) {
  Vec2 sum = Vec2::Zero();
  for (const CrackPoint& p : crack_profile(s.model, s.state, crack)) {
    EXPECT_GE(p.contact_pressure(), -1e-9);
    sum += p.length * p.contact_pressure() * Vec2(1, p.at.x());
  }
  return sum;
}

// Free to expand sideways, nothing but uniform pressure is possible, in any element.
TEST(Semicoercive, PassesThePatchTest) {
  for (const Element& e : {bdms(1), bdms(2), element("peers", 1), element("afw", 1), element("bdms-c", 1)}) {
    SCOPED_TRACE(e.name);
    Shape shape = stack(3);
    Scene scene = on_ground(shape);
    scene.supports[0].first = false;  // slides on the ground, too
    load_top(scene, [](double) { return Vec2(0, -0.1); });
    // Somewhere the whole must be held sideways.
    shape.labels.push_back("pin");
    const Solved s = [&] {
      scene.supports[0].first = true;
      return solved(shape, scene, 0.5, e);
    }();
    // The ground holds the lowest block at its foot; from the second joint on the stress is uniform.
    for (Index c = 0; c < 2; ++c) EXPECT_NEAR(resultant(s, c).x(), 0.2, 1e-10);
    for (const CrackPoint& p : crack_profile(s.model, s.state, 1)) EXPECT_NEAR(p.contact_pressure(), 0.1, 0.02);
    EXPECT_NE(s.model.notes.back().find("2 pieces of the body are held by contact alone"), std::string::npos)
        << s.model.notes.back();
  }
}

// What goes through every joint is what statics says, with the load anywhere in the middle third or beyond, with
// friction or without.
TEST(Semicoercive, TransmitsWhatStaticsSays) {
  for (const int blocks : {2, 5})
    for (const double friction : {0.0, 0.3})
      for (const double eccentric : {0.0, 0.2, 0.5}) {
        SCOPED_TRACE(fmt::format("{} blocks, friction {}, eccentric {}", blocks, friction, eccentric));
        const Shape shape = stack(blocks);
        Scene scene = on_ground(shape, friction);
        load_top(scene, [&](double x) { return Vec2(0, -0.1 * (1 + 3 * eccentric * x)); });  // a thrust at `eccentric`
        const Solved s = solved(shape, scene);
        for (Index c = 0; c + 1 < blocks; ++c) {
          EXPECT_NEAR(resultant(s, c).x(), 0.2, 1e-9);
          EXPECT_NEAR(resultant(s, c).y(), 0.2 * eccentric, 1e-9);
        }
      }
}

TEST(Semicoercive, NamesTheMotionThatNothingResists) {
  const Shape shape = stack(2);
  const auto says = [&](std::function<Vec2(double)> t, const std::string& what) {
    Scene scene = on_ground(shape);
    load_top(scene, std::move(t));
    const std::string why = refusal_of(shape, scene);
    EXPECT_NE(why.find(what), std::string::npos) << why;
  };
  says([](double) { return Vec2(0, 0.1); }, "a translation along (0, 1)");
  says([](double) { return Vec2(0.1, -0.1); }, "a translation along (1, ");
  says([](double x) { return Vec2(0, -0.1 * (1 + 3.3 * x)); },
       "a rotation about (1, 1.5)");  // the thrust at 1.1: the edge slides under the middle
  Scene open = on_ground(shape);
  open.laws[0].kind = CrackLaw::Kind::Open;
  load_top(open, [](double) { return Vec2(0, -0.1); });
  EXPECT_NE(refusal_of(shape, open).find("which no contact can stop"), std::string::npos);
  Scene held_by_nothing = on_ground(shape);
  held_by_nothing.supports.clear();
  load_top(held_by_nothing, [](double) { return Vec2(0, -0.1); });
  EXPECT_NE(refusal_of(shape, held_by_nothing).find("nothing holds the body against a translation along (0, "),
            std::string::npos);
}

// Loads in balance press two blocks together, and what carries no load stays: the rigid motion is a matter of choice,
// and said.
TEST(Semicoercive, WhatIsInBalanceStands) {
  const Shape shape = stack(2);
  Scene free = on_ground(shape, 0.3);
  free.supports.clear();
  load_top(free, [](double) { return Vec2(0, -0.1); });
  free.tractions.push_back({bottom, [](const Vec2&, const Vec2&) { return Vec2(0, 0.1); }});
  const Solved pressed = solved(shape, free);
  for (const CrackPoint& p : crack_profile(pressed.model, pressed.state, 0))
    EXPECT_NEAR(p.contact_pressure(), 0.1, 1e-9);
  EXPECT_TRUE(std::ranges::any_of(pressed.model.notes, [](const std::string& note) {
    return note.find("the rigid motion is fixed by zero mean displacement and rotation") != std::string::npos;
  }));
  // A traction on half of a side, by one formula; the other half is a piece of its own.
  Shape halves{.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, side),
               .labels = {"bottom", "side", "left"}};
  halves.outline.sides[0].label = bottom, halves.outline.sides[3].label = top;
  halves.cracks = {{"c", {{1, 0}, {1, 1}}, {}}};
  Scene scene{.material = plane_strain(1000, 0.3), .laws = {{}}};
  scene.supports = {{top, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  scene.tractions = {{bottom, [](const Vec2& x, const Vec2&) { return Vec2(x.x() < 1 ? 1 : 0, 0); }}};
  const Solved loose = solved(halves, scene);
  for (const CrackPoint& p : crack_profile(loose.model, loose.state, 0)) EXPECT_NEAR(p.contact_pressure(), 0, 1e-9);
}

// Statics decides: a block stands where the thrust meets its foot and is steeper than friction asks for, however near
// to the end of the foot; else it is said to slide or to tip.
TEST(Semicoercive, StandsWhereStaticsSays) {
  const Shape shape = stack(2);
  std::mt19937 random(7);
  const auto draw = [&](double low, double high) {
    return low * std::pow(high / low, std::uniform_real_distribution<double>(0, 1)(random));
  };
  for (int i = 0; i < 24; ++i) {
    const bool sticks = i % 2 == 0, inside = i % 4 < 2;
    const double sign = i % 8 < 4 ? 1 : -1, slope = sign * draw(0.05, 0.5), off = draw(2e-3, 0.2),
                 more = draw(5e-3, 0.5);
    const double friction = std::abs(slope) * (sticks ? 1 + more : 1 - more / 2);
    const double foot = sign * (inside ? 1 - off : 1 + off), top_at = foot - slope;  // of the thrust
    SCOPED_TRACE(fmt::format("{}: slope {}, friction {}, thrust at {}", i, slope, friction, foot));
    Scene scene = on_ground(shape, friction);
    load_top(scene, [=](double x) { return Vec2(0.1 * slope, -0.1 * (1 + 3 * top_at * x)); });
    if (sticks && inside) {
      const Solved s = solved(shape, scene);
      EXPECT_NEAR(resultant(s, 0).x(), 0.2, 1e-8);
      EXPECT_NEAR(resultant(s, 0).y(), 0.2 * foot, 1e-8);
      continue;
    }
    const std::string why = refusal_of(shape, scene);
    EXPECT_NE(why.find("contact does not hold the body"), std::string::npos) << why;
    if (sticks) {
      EXPECT_NE(why.find("a rotation about"), std::string::npos) << why;
    } else if (inside) {
      EXPECT_NE(why.find(fmt::format("a translation along ({}, 0)", sign)), std::string::npos) << why;
    }
  }
}

// NAFEMS CGS-4: a block on an incline of slope 0.1 with friction 0.3, pushed uphill along the horizontal: it slips at
// F/G = (0.1 + 0.3)/(1 - 0.03) = 0.412371.
TEST(Semicoercive, SlipsUphillWhereNafemsSays) {
  const Shape shape = stack(2);
  const double a = std::atan(0.1);
  const Vec2 down(-std::sin(a), -std::cos(a)), push(std::cos(a), -std::sin(a));
  const auto loaded = [&](double share) {
    Scene scene = on_ground(shape, 0.3);
    scene.body = [=](const Vec2& x) -> Vec2 {
      return x.y() < 1 ? Vec2(Vec2::Zero()) : Vec2(0.05 * (down + share * push));
    };
    return scene;
  };
  const Solved s = solved(shape, loaded(0.4123));
  double normal = 0, shear = 0;
  for (const CrackPoint& p : crack_profile(s.model, s.state, 0)) {
    normal += p.length * p.contact_pressure();
    shear += p.length * p.sigma_t;
  }
  const double weight = 0.1;
  EXPECT_NEAR(normal, weight * (std::cos(a) + 0.4123 * std::sin(a)), 1e-6);
  EXPECT_NEAR(std::abs(shear), weight * (0.4123 * std::cos(a) - std::sin(a)), 1e-6);
  const std::string why = refusal_of(shape, loaded(0.4125));
  EXPECT_NE(why.find("free to make a translation along (1, 0)"), std::string::npos) << why;
}

// The same wall twice: a block that contact holds sideways between two walls, and the same body with bonded joints
// under loads that keep the joints closed and without shear: nothing tells them apart.
TEST(Semicoercive, IsTheBondedBodyWhereNothingOpensOrSlides) {
  const Shape shape = stack(2);
  Scene semicoercive = on_ground(shape);
  semicoercive.supports[0].first = false;  // rollers; sideways the bodies are held by their symmetry alone
  semicoercive.supports.push_back(
      {side, true, true, false, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  load_top(semicoercive, [](double x) { return Vec2(0, -0.1 - 0.02 * x * x); });
  Scene bonded = semicoercive;
  bonded.laws[0].kind = CrackLaw::Kind::Bonded;
  const Solved a = solved(shape, semicoercive, 0.2), b = solved(shape, bonded, 0.2);
  const double ea = strain_energy(a.model, a.state), eb = strain_energy(b.model, b.state);
  EXPECT_GE(ea, eb * (1 - 1e-9));  // free to slide: softer
  EXPECT_NEAR(ea, eb, 2e-3 * eb);
}

// T of the energy against holes really made.
TEST(Semicoercive, MapsHold) {
  const Shape shape = stack(2);
  Scene scene = on_ground(shape, 0);
  load_top(scene, [](double x) { return Vec2(0, -0.1 * (1 + 0.6 * x)); });
  const Sizing sizing{.size = 0.25};
  const ValidationRequest request{.points = {{0.2, 1.5}}, .radii = {0.16, 0.08, 0.04, 0.02}};
  for (const Validation& v : validate({shape, sizing}, bdms(1), scene, {"energy", {energy()}}, request))
    EXPECT_EQ(v.verdict, Verdict::Holds) << v.at.transpose() << ": " << v.reason;
  // The upper block slides as it likes: nothing is said of what sees that.
  const Functional moved{"tracking", {displacement_tracking({}, {})}};
  EXPECT_THROW(validate({shape, sizing}, bdms(1), scene, moved, request), Error);
}

}  // namespace
}  // namespace kerf::standing_test
