// What the library refuses of a program that uses it, and with which words.

#include "kerf/adjoint.hpp"
#include "kerf/bounds.hpp"
#include "solver/factor.hpp"
#include "solver/system.hpp"
#include "tests/support/exact.hpp"

#include <gtest/gtest.h>

namespace kerf::refusals_test {
namespace {

Vec2 zero(const Vec2&, const Vec2&) {
  return {0, 0};
}

template <class F>
std::string refusal(const F& f) {
  try {
    f();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "no refusal";
}

Scene held_below(std::vector<CrackLaw> laws) {
  Scene s;
  s.material = plane_strain(1, 0.3);
  s.supports = {{0, false, true, true, zero}};
  s.laws = std::move(laws);
  return s;
}

const CrackLaw unilateral = {.kind = CrackLaw::Kind::Unilateral};

TEST(Refusals, ScenesThatDoNotFitTheMesh) {
  const Mesh mesh = exact::crack_mesh(4);
  const auto prepared = [&](const Scene& s) { return refusal([&] { prepare(mesh, element("bdms"), s, 1); }); };
  EXPECT_EQ(prepared(held_below({unilateral})), "no refusal");
  EXPECT_EQ(prepared(held_below({})), "prepare: one law per crack is needed");
  EXPECT_EQ(prepared(held_below({unilateral, unilateral})), "prepare: one law per crack is needed");
  const CrackLaw pressed = {.kind = CrackLaw::Kind::Bonded,
                            .pressure = [](const Vec2&, const Vec2&) { return Vec2(1, 0); }};
  EXPECT_EQ(prepared(held_below({pressed})), "prepare: a bonded crack has no faces for a pressure");
}

TEST(Refusals, OtherSupportsThanThoseOfTheFactor) {
  const Scene scene = held_below({unilateral});
  const Model m = prepare(exact::crack_mesh(4), element("bdms"), scene, 1);
  Scene other = scene;
  other.tractions = {{2, [](const Vec2&, const Vec2&) { return Vec2(0, 1); }}};
  EXPECT_EQ(refusal([&] { with_loads(m, other); }), "no refusal");
  other.supports.push_back({1, false, true, true, zero});
  EXPECT_EQ(refusal([&] { with_loads(m, other); }), "with_loads: the supports differ");
}

TEST(Refusals, AnotherNumberOfRowsInContact) {
  const Model m = prepare(exact::crack_mesh(4), element("bdms"), held_below({unilateral}), 1);
  const std::size_t rows = contact_status(m, solve(m)).size();
  ASSERT_GT(rows, 0u);
  for (const std::size_t n : {std::size_t{0}, rows - 1, rows + 1}) {
    EXPECT_EQ(refusal([&] { solve_adjoint(m, {}, std::vector<bool>(n)); }),
              "solve_adjoint: one entry per row in contact is needed");
    EXPECT_EQ(refusal([&] { TangentSolver(m, std::vector<bool>(n)); }),
              "TangentSolver: one entry per row in contact is needed");
  }
  EXPECT_EQ(refusal([&] { TangentSolver(m, std::vector<bool>(rows)); }), "no refusal");
}

TEST(Refusals, LinesWithoutLength) {
  const Model m = prepare(exact::crack_mesh(4), element("bdms"), held_below({{.kind = CrackLaw::Kind::Open}}), 1);
  const State s = solve(m);
  const QuantityBounds bounds(m, s);
  EXPECT_EQ(refusal([&] { bounds.mean_stress(AlongLine{{0.2, 1}, {0.2, 1}}); }), "mean_stress: the line has no length");
  EXPECT_EQ(refusal([&] { bounds.mean_stress(OverDisc{{0.2, 1}, nan}); }), "mean_stress: the radius must be positive");
}

/// [[2, 1], [1, -3]]: its eigenvalues have both signs.
TEST(Refusals, FactorsOfIndefiniteMatrices) {
  const LowerTriangle indefinite = {2, {0, 2, 3}, {0, 1, 1}, {2, 1, -3}};
  EXPECT_EQ(refusal([&] { Factor(indefinite, 1, false); }),
            "Factor: rows in contact or on an interface need a definite matrix");
  EXPECT_EQ(refusal([&] { Factor(indefinite, 0, false, 1); }),
            "Factor: rows in contact or on an interface need a definite matrix");
  Factor lu(indefinite, 0, false);
  EXPECT_EQ(refusal([&] { lu.refactor(indefinite); }), "Factor: refactor with another pattern");
  const Eigen::VectorXd x = lu.solve(Eigen::Vector2d(7, -14));  // of (1, 5)
  EXPECT_NEAR(x[0], 1, 1e-14);
  EXPECT_NEAR(x[1], 5, 1e-14);
  EXPECT_THROW(Factor(indefinite, 0), Error);
}

}  // namespace
}  // namespace kerf::refusals_test
