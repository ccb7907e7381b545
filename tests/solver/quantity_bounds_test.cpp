#include "kerf/bounds.hpp"

#include "kerf/fracture.hpp"
#include "tests/support/exact.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

namespace kerf {
namespace {

constexpr double slope = pi / 6;

struct Problem {
  exact::ExactField exact;
  Model model;
  State state;
};

// A straight open crack from (-1, 0) to (1, 0), turned, under the exact tractions; `held` labels have the exact
// displacements.
Problem problem(const exact::ExactField& f, int n, int degree, const std::vector<Index>& held) {
  const Mesh mesh = exact::crack_mesh(n, slope, 0.2);
  Scene s;
  s.material = f.material;
  for (Index label = 0; label < 4; ++label) {
    if (std::ranges::count(held, label) > 0)
      s.supports.push_back({label, false, true, true, [f](const Vec2& x, const Vec2&) -> Vec2 {
                              return f.displacement(x, exact::side_of(f, x));
                            }});
    else
      s.tractions.push_back(
          {label, [f](const Vec2& x, const Vec2& n) -> Vec2 { return f.stress(x, exact::side_of(f, x)) * n; }});
  }
  s.laws.push_back({.kind = CrackLaw::Kind::Open});
  Problem p{f, prepare(mesh, element("bdms", degree), s, 1), {}};
  p.state = solve(p.model);
  return p;
}

void expect_contains(const Bounded& b, double exact, const std::string& which) {
  EXPECT_LE(b.lower, exact) << which << " " << b.note;
  EXPECT_GE(b.upper, exact) << which << " " << b.note;
}

double half_width(const Bounded& b) {
  return 0.5 * (b.upper - b.lower);
}

// The remote stress resolved on the crack gives K [theory: B.11].
TEST(QuantityBounds, ContainKAndGOfAStraightCrackUnderATurnedStress) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  const double normal = 0.5 * std::pow(std::sin(slope), 2) + std::pow(std::cos(slope), 2),
               shear = 0.5 * std::sin(slope) * std::cos(slope), k1 = normal * std::sqrt(pi), k2 = shear * std::sqrt(pi),
               rate = (k1 * k1 + k2 * k2) / plane_modulus(f.material);
  for (const std::vector<Index>& held : {std::vector<Index>{}, std::vector<Index>{0, 1, 2, 3}})
    for (const int degree : {1, 2}) {
      std::vector<double> width;
      for (const int n : {8, 16}) {
        const Problem p = problem(f, n, degree, held);
        const QuantityBounds bounds(p.model, p.state);
        for (const TipIntensity& tip : crack_tips(p.model, p.state)) {
          const std::string which =
              fmt::format("held {} degree {} n {} start {}", held.size(), degree, n, tip.at_start);
          const auto [one, two, g] = bounds.tip(tip);
          expect_contains(one, k1, which + " K_I");
          expect_contains(two, k2, which + " K_II");
          expect_contains(g, rate, which + " G");
          if (!tip.at_start) width.push_back(half_width(one) / k1);
          EXPECT_TRUE(one.guaranteed && two.guaranteed && g.guaranteed) << which << one.note;
        }
      }
      EXPECT_LT(width[0], degree == 1 ? 0.12 : 0.04);
      EXPECT_LT(width[1], 0.6 * width[0]);  // of the order of the mesh size: the tips are not resolved
    }
}

TEST(QuantityBounds, ContainStressesAtPoints) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  for (const std::vector<Index>& held : {std::vector<Index>{}, std::vector<Index>{0}})
    for (const int degree : {1, 2})
      for (const int n : {8, 16}) {
        const Problem p = problem(f, n, degree, held);
        const QuantityBounds bounds(p.model, p.state);
        for (const Vec2& x : {Vec2(0.3, 0.9), Vec2(-1.2, -0.3), Vec2(0.1, -0.4)}) {
          const auto s = bounds.stress(x);
          const Mat2 exact = f.stress(x, exact::side_of(f, x));
          const std::string which =
              fmt::format("held {} degree {} n {} at {} {}", held.size(), degree, n, x.x(), x.y());
          expect_contains(s[0], exact(0, 0), which);
          expect_contains(s[1], exact(1, 1), which);
          expect_contains(s[2], exact(0, 1), which);
          for (const Bounded& b : s) EXPECT_TRUE(b.guaranteed) << which << b.note;
        }
      }
}

TEST(QuantityBounds, SayWhyThereAreNone) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  Problem p = problem(f, 8, 1, {0});
  Scene contact = p.model.scene;
  contact.laws[0].kind = CrackLaw::Kind::Unilateral;
  const Model m = prepare(p.model.mesh, element("bdms", 1), contact, 1);
  const State s = solve(m);
  EXPECT_EQ(QuantityBounds(m, s).tip({.crack = 0})[0].note, "no bounds: a crack may be in contact");
  const QuantityBounds bounds(p.model, p.state);
  const Bounded outside = bounds.stress({9, 9})[0];
  EXPECT_EQ(outside.note, "no bounds: the point lies outside the body");
  EXPECT_TRUE(std::isnan(outside.lower) && !outside.guaranteed);
  // Beside the crack, nearer than half an edge: the sampled tractions are not proof enough.
  const Bounded near = bounds.stress({0.05 * std::sin(slope), -0.05 * std::cos(slope)})[2];
  EXPECT_FALSE(near.guaranteed);
  EXPECT_FALSE(near.note.empty());
  contact.laws[0].kind = CrackLaw::Kind::Bonded;
  const Model bonded = prepare(p.model.mesh, element("bdms", 1), contact, 1);
  const State whole = solve(bonded);
  EXPECT_EQ(QuantityBounds(bonded, whole).tip({.crack = 0})[0].note, "no bounds: the crack is bonded");
}

}  // namespace
}  // namespace kerf
