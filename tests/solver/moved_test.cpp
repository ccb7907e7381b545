// A mesh that moves: what is taken over from before changes no bit.

#include "solver/moved.hpp"

#include "kerf/state.hpp"
#include "solver/system.hpp"
#include "tests/support/exact.hpp"

#include <gtest/gtest.h>

namespace kerf::moved_test {
namespace {

Vec2 zero(const Vec2&, const Vec2&) {
  return {0, 0};
}
Vec2 pull(const Vec2& x, const Vec2&) {
  return {0.1 * x.x(), 1};
}

Scene pulled(const Mesh& mesh) {
  Scene s;
  s.material = plane_strain(1, 0.3);
  s.supports = {{0, false, true, true, zero}};
  s.tractions = {{2, pull}};
  s.laws.assign(mesh.cracks.size(), {.kind = CrackLaw::Kind::Unilateral});
  return s;
}

Mesh sheared(Mesh mesh, double by) {
  for (Vec2& x : mesh.points) x.x() += by * x.y();
  return mesh;
}

void expect_same(const Model& a, const Model& b) {
  EXPECT_EQ(a.inner->ordering.row, b.inner->ordering.row);
  EXPECT_EQ(a.inner->system.K->values, b.inner->system.K->values);
  EXPECT_EQ(a.inner->factor->contact_factor(), b.inner->factor->contact_factor());
  EXPECT_EQ(solve(a).skeleton, solve(b).skeleton);
}

TEST(Moved, NoBitChanges) {
  const Mesh mesh = exact::crack_mesh(8);
  for (const char* name : {"bdms", "bdms-c", "afw"}) {
    Model moved = prepare(mesh, element(name), pulled(mesh), 1);
    const Factor* const first = moved.inner->factor.get();
    for (const double by : {0.05, 0.1}) {
      const Mesh there = sheared(mesh, by);
      moved = prepare_moved(there, element(name), pulled(mesh), 1, std::move(moved));
      expect_same(moved, prepare(there, element(name), pulled(mesh), 1));
      EXPECT_EQ(moved.inner->factor.get() == first, is_definite(element(name))) << name;
    }
  }
}

TEST(Moved, AFactorThatSomebodyHasStays) {
  const Mesh mesh = exact::crack_mesh(8);
  const Model before = prepare(mesh, element("bdms"), pulled(mesh), 1);
  const Eigen::MatrixXd kept = before.inner->factor->contact_factor();
  const Mesh there = sheared(mesh, 0.1);
  const Model moved = prepare_moved(there, element("bdms"), pulled(mesh), 1, before);
  EXPECT_NE(moved.inner->factor, before.inner->factor);
  EXPECT_EQ(before.inner->factor->contact_factor(), kept);
  expect_same(moved, prepare(there, element("bdms"), pulled(mesh), 1));
}

TEST(Moved, AnotherBodyIsPreparedAnew) {
  const Mesh mesh = exact::crack_mesh(8), other = exact::crack_mesh(4);
  expect_same(prepare_moved(other, element("bdms"), pulled(other), 1, prepare(mesh, element("bdms"), pulled(mesh), 1)),
              prepare(other, element("bdms"), pulled(other), 1));
  Scene held = pulled(mesh);
  held.supports.push_back({1, false, true, true, zero});
  expect_same(prepare_moved(mesh, element("bdms"), held, 1, prepare(mesh, element("bdms"), pulled(mesh), 1)),
              prepare(mesh, element("bdms"), held, 1));
  expect_same(prepare_moved(mesh, element("bdms"), held, 1, Model{}), prepare(mesh, element("bdms"), held, 1));
}

}  // namespace
}  // namespace kerf::moved_test
