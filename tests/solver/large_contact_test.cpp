// Contact without its dense matrix, by a factor per set: the state that the dense matrix gives, and exact fields.

#include "kerf/adaptive.hpp"
#include "kerf/adjoint.hpp"
#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "solver/history.hpp"
#include "solver/lone_cracks.hpp"
#include "solver/system.hpp"
#include "solver/tangent_cone.hpp"
#include "tests/solver/many_cracks.hpp"
#include "tests/solver/scenes.hpp"
#include "tests/support/exact_families.hpp"

#include <gtest/gtest.h>

namespace kerf::large_contact_test {
namespace {

constexpr Index always_dense = 1000000;

void expect_the_dense_state(const Mesh& mesh, const Element& e, const Scene& scene, const std::string& which) {
  const Model dense = prepare(mesh, e, scene, 1, {.most_dense = always_dense});
  const Model large = prepare(mesh, e, scene, 1, {.most_dense = 0});
  EXPECT_FALSE(has_large_contact(dense));
  ASSERT_TRUE(has_large_contact(large)) << which;
  const State one = solve(dense), other = solve(large);
  EXPECT_TRUE(certified(one)) << which;
  EXPECT_TRUE(certified(other)) << which << " " << other.certificate.kkt << " " << other.converged;
  EXPECT_LT((other.skeleton - one.skeleton).cwiseAbs().maxCoeff(), 1e-10 * one.skeleton.cwiseAbs().maxCoeff()) << which;
  EXPECT_LT((other.force - one.force).cwiseAbs().maxCoeff(), 1e-10 * one.force.cwiseAbs().maxCoeff()) << which;
  // The guess that a state makes is the state.
  const Model guessed = prepare(mesh, e, scene, 1, {.most_dense = 0, .contact = contact_guess(large, other)});
  const State again = solve(guessed);
  EXPECT_TRUE(certified(again)) << which;
  EXPECT_LT((again.force - one.force).cwiseAbs().maxCoeff(), 1e-10 * one.force.cwiseAbs().maxCoeff()) << which;
}

TEST(LargeContact, GivesTheDenseStateOfManyCracks) {
  const Shape shape = random_cracks(8, 3, 7);
  const Mesh mesh = triangulate(shape, {.size = 0.4, .crack_tip_size = 0.05});
  for (const CrackLaw& law : {CrackLaw{}, CrackLaw{.friction = 0.3}, CrackLaw{.slip_bound = 0.05}})
    expect_the_dense_state(mesh, element("bdms"), pushed(8, law),
                           std::to_string(law.friction) + " " + std::to_string(law.slip_bound));
}

// Each crack alone under the tensions of the body without cracks: most of the set, at the price of a coarse mesh.
TEST(LargeContact, BeginsWithLoneCracks) {
  const Shape shape = random_cracks(8, 3, 7);
  const Mesh mesh = triangulate(shape, {.size = 0.4, .crack_tip_size = 0.05});
  const Scene scene = pushed(8, {});
  const State dense = solve(prepare(mesh, element("bdms"), scene, 1, {.most_dense = always_dense}));
  const ContactGuess guess = lone_cracks_guess(shape, element("bdms"), scene, 0.5, 1);
  const Model m = prepare(mesh, element("bdms"), scene, 1, {.most_dense = 0, .contact = guess});
  const State s = solve(m);
  EXPECT_TRUE(certified(s));
  EXPECT_LT((s.force - dense.force).cwiseAbs().maxCoeff(), 1e-10 * dense.force.cwiseAbs().maxCoeff());
  const Ordering& o = m.inner->ordering;
  Index wrong = 0;
  for (Index u = 0; u < m.inner->skeleton.total; ++u)
    if (m.inner->skeleton.bounded[u])
      wrong += (s.force[u] > 0) != (m.inner->start[o.row[u] - o.leading()] == Motion::Held);
  EXPECT_LT(wrong, o.contact_rows / 5);
  EXPECT_GT(o.contact_rows, 100);
}

TEST(LargeContact, GivesTheDenseStateOfOtherElementsAndIncompressibleBodies) {
  const Shape shape = random_cracks(5, 2.5, 3);
  const Mesh mesh = triangulate(shape, {.size = 0.4, .crack_tip_size = 0.1});
  for (const Element& e : {element("bdms", 2), element("afw"), element("peers")})
    expect_the_dense_state(mesh, e, pushed(5, {}), title(e));
  expect_the_dense_state(mesh, element("bdms"), pushed(5, {}, 0.5), "incompressible");
}

TEST(LargeContact, GivesTheDenseStateWithGapsAndPressure) {
  const Shape shape = random_cracks(5, 2.5, 4);
  const Mesh mesh = triangulate(shape, {.size = 0.4, .crack_tip_size = 0.1});
  CrackLaw law;
  law.gap = [](const Vec2& x, const Vec2&) -> Vec2 { return {0.01 * std::sin(x.x()), 0}; };
  expect_the_dense_state(mesh, element("bdms"), pushed(5, law), "gap");
  law = {};
  law.pressure = [](const Vec2& x, const Vec2&) -> Vec2 { return {0.1 * std::cos(x.x()), 0}; };
  expect_the_dense_state(mesh, element("bdms"), pushed(5, law), "pressure");
}

TEST(LargeContact, GivesTheDenseTangents) {
  const Shape shape = random_cracks(6, 3, 5);
  const Mesh mesh = triangulate(shape, {.size = 0.4, .crack_tip_size = 0.1});
  const Scene scene = pushed(6, {});
  const Model dense = prepare(mesh, element("bdms"), scene, 1, {.most_dense = always_dense});
  const Model large = prepare(mesh, element("bdms"), scene, 1, {.most_dense = 0});
  const State one = solve(dense), other = solve(large);
  const std::vector<bool> held = tied(contact_status(dense, one));
  EXPECT_EQ(held, tied(contact_status(large, other)));
  Sensitivity dJ;
  dJ.skeleton = Eigen::VectorXd::NullaryExpr(one.skeleton.size(), [](Eigen::Index i) { return std::sin(1.0 + i); });
  dJ.force = Eigen::VectorXd::NullaryExpr(one.force.size(), [](Eigen::Index i) { return std::cos(2.0 + i); });
  const TangentField a = solve_adjoint(dense, dJ, held), b = solve_adjoint(large, dJ, held);
  EXPECT_LT((a.skeleton - b.skeleton).norm(), 1e-10 * a.skeleton.norm());
  EXPECT_LT((a.interior - b.interior).norm(), 1e-10 * a.interior.norm());
  EXPECT_LT(b.residual, 1e-12);
}

// Loaded, then unloaded by half: slip is remembered.
TEST(LargeContact, GivesTheDenseHistory) {
  const Shape shape = random_cracks(6, 3, 5);
  const Mesh mesh = triangulate(shape, {.size = 0.4, .crack_tip_size = 0.1});
  const Scene scene = pushed(6, {.friction = 0.3});
  Scene half = scene;
  for (Traction& t : half.tractions) {
    const BoundaryField whole = t.value;
    t.value = [whole](const Vec2& x, const Vec2& n) -> Vec2 { return 0.5 * whole(x, n); };
  }
  std::vector<State> last;
  for (const Index most_dense : {always_dense, Index{0}}) {
    const Model first = prepare(mesh, element("bdms"), scene, 1, {.most_dense = most_dense});
    const State loaded = solve(first);
    last.push_back(solve(continued(first, half, loaded)));
    EXPECT_TRUE(certified(last.back()));
    EXPECT_GT((last.back().skeleton - 0.5 * loaded.skeleton).cwiseAbs().maxCoeff(),
              1e-3 * loaded.skeleton.cwiseAbs().maxCoeff());
  }
  EXPECT_LT((last[1].skeleton - last[0].skeleton).cwiseAbs().maxCoeff(),
            1e-10 * last[0].skeleton.cwiseAbs().maxCoeff());
  EXPECT_LT((last[1].force - last[0].force).cwiseAbs().maxCoeff(), 1e-10 * last[0].force.cwiseAbs().maxCoeff());
}

/// Edges of `size` on the first crack, growing away from it.
Mesh fine_at_crack(const Shape& shape, double size) {
  const Mesh coarse = triangulate(shape, {.size = 0.2});
  Background background{&coarse, {}};
  for (const Vec2& x : coarse.points) background.size.push_back(size + 0.5 * distance_to(x, shape.cracks[0].points));
  return triangulate(shape, {.size = 0.5, .grading = 0.5}, background);
}

// More unknowns than the dense matrix may have: the exact field of a partly closed crack, with the order of the stress
// and the place where contact ends.
TEST(LargeContact, ReproducesAPartlyClosedCrack) {
  const exact::ExactField f =
      exact::line_crack("partly", plane_strain(1, 0.3), {.angle = 0.4, .p0 = 0.1, .p1 = 1, .s_tt = 0.2, .s_tn = 0.3});
  Shape shape = square(2);
  shape.cracks = {{"crack", {f.tips[0].at, f.tips[1].at}, {}}};
  ContactGuess guess;
  std::vector<double> error;
  for (const double size : {0.02, 0.005, 0.00125}) {
    Preparation how{.contact = guess};
    if (size > 0.01) how.most_dense = 0;
    const Model m =
        prepare(fine_at_crack(shape, size), element("bdms"), scene_of(f, {0, 1, 2, 3}, {CrackLaw{}}), 1, how);
    const State s = solve(m);
    EXPECT_TRUE(certified(s)) << size;
    guess = contact_guess(m, s);
    for (const CrackPoint& p : crack_profile(m, s, 0)) {
      const double off = p.s - 1 - f.transitions.at(0);
      if (std::abs(off) < size || 1 - std::abs(p.s - 1) < 4 * size) continue;  // single points at tips decide nothing
      EXPECT_EQ(p.status == CrackPoint::Status::Open, exact::is_open(f, p.s - 1)) << size << " " << p.s;
    }
    error.push_back(exact::stress_error(m, s, f));
  }
  EXPECT_LT(error[1], 0.6 * error[0]);  // the root of the size at the tip; the finest mesh is no finer far from it
  EXPECT_LT(error[2], 0.8 * error[1]);
}

TEST(LargeContact, SaysWhatItCannotDo) {
  const Shape shape = random_cracks(3, 2.5, 4);
  const Mesh mesh = triangulate(shape, {.size = 0.5, .crack_tip_size = 0.2});
  const Model m = prepare(mesh, element("bdms"), pushed(3, {}), 1, {.most_dense = 0});
  EXPECT_THROW(solve(m, ContactMethod::Uzawa), Error);
  EXPECT_TRUE(certified(solve(m, ContactMethod::ActiveSet)));
  // Slip whose limit follows the pressure: its tangent needs the dense matrix.
  const Model rubbing = prepare(mesh, element("bdms"), pushed(3, {.friction = 0.1}), 1, {.most_dense = 0});
  const State s = solve(rubbing);
  Sensitivity dJ;
  dJ.skeleton = s.skeleton;
  const TangentCone cone = tangent_cone(rubbing, s);
  ASSERT_FALSE(cone.sliding.empty());
  EXPECT_THROW(solve_adjoint(rubbing, dJ, cone), Error);
}

TEST(LargeContact, BoundsContainTheEnergy) {
  const Shape shape = random_cracks(6, 3, 5);
  const Mesh mesh = triangulate(shape, {.size = 0.3, .crack_tip_size = 0.1});
  const Scene scene = pushed(6, {});
  const Model large = prepare(mesh, element("bdms"), scene, 1, {.most_dense = 0});
  const Model fine = prepare(triangulate(shape, {.size = 0.2, .crack_tip_size = 0.005}), element("bdms", 2), scene, 1);
  const State s = solve(large);
  const EnergyBounds bounds = energy_bounds(large, s);
  const double energy = potential_energy(fine, solve(fine));
  EXPECT_LT(bounds.lower, energy);
  EXPECT_GT(bounds.upper, energy);
  EXPECT_LT(bounds.upper - bounds.lower, 0.1 * std::abs(energy));
}

}  // namespace
}  // namespace kerf::large_contact_test
