// Triangles that are eliminated side by side: what one by one gives, and the same bits in every place.

#include "solver/element/local.hpp"

#include <gtest/gtest.h>

#include <fmt/core.h>

#include <algorithm>
#include <random>

namespace kerf::packed_test {
namespace {

/// Triangles of any shape and place, of materials from stiff to nearly incompressible.
struct Crowd {
  std::vector<LocalTriangle> triangles;
  std::vector<Recovered> found;
  std::vector<Eigen::VectorXd> interior;
};

class Packed : public testing::TestWithParam<Element> {
 protected:
  const Kernel k = kernel(GetParam());
  const std::array<Material, 3> materials{plane_strain(1, 0.3), plane_strain(50, 0.4999), plane_stress(1e-3, 0.2)};
  std::mt19937 random{7};
  const EdgeCurvature curvature = [] {
    EdgeCurvature b;
    b.q[0] = Vec2(0.01, -0.02);
    return b;
  }();

  double in() {
    return std::uniform_real_distribution<double>(-1, 1)(random);
  }
  Triangle shape() {
    Triangle t;
    const double size = std::exp(3 * in());
    do {
      for (Vec2& x : t.x) x = Vec2(3, -1) + size * Vec2(in(), in());
    } while (area(t) < 0.1 * size * size);
    for (std::size_t e = 0; e < 3; ++e) {
      const double angle = 3 * in();
      t.frame[e] << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
      t.forward[e] = in() > 0;
    }
    return t;
  }
  /// `forces`: numbers per triangle.
  Crowd crowd(std::size_t count, int forces, bool penalized) {
    Crowd c{std::vector<LocalTriangle>(count), std::vector<Recovered>(count), std::vector<Eigen::VectorXd>(count)};
    for (std::size_t i = 0; i < count; ++i) {
      LocalTriangle& t = c.triangles[i];
      t.shape = shape();
      t.material = &materials[i % materials.size()];
      t.force.resize(forces);
      for (int j = 0; j < forces; ++j) t.force[j] = in();
      if (penalized) t.penalty = {.a = 1e-3 / t.material->mu, .theta = in()};
      c.found[i].m.resize(skeleton_count(k.element));
      for (double& m : c.found[i].m) m = in();
    }
    return c;
  }
  void recover(Crowd& c) const {
    for (std::size_t i = 0; i < c.found.size(); ++i) {
      c.interior[i].setZero(interior_count(k.element));
      c.found[i].interior = c.interior[i].data();
    }
    interiors(k, c.triangles, c.found);
  }
  std::vector<Condensed> condensed(const Crowd& c) const {
    std::vector<Condensed> all(c.triangles.size());
    condense(k, c.triangles, all);
    return all;
  }
  static double off(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).cwiseAbs().maxCoeff() / std::max(1e-300, b.cwiseAbs().maxCoeff());
  }
  /// Cubic monomials on thin triangles have a condition of up to 1e6, quartic ones of 1e9; without a penalty
  /// 1/(1 - 2 nu) = 5000 comes on top.
  double close_to(const LocalTriangle& t) const {
    return (k.element.stress == 4 ? 1e3 : 1) * (t.material == &materials[1] && t.penalty.a == 0 ? 1e-8 : 1e-9);
  }

  void compare(Crowd& c) const {
    const std::vector<Condensed> together = condensed(c);
    recover(c);
    for (std::size_t i = 0; i < c.triangles.size(); ++i) {
      const LocalTriangle& t = c.triangles[i];
      const double close = close_to(t);
      const Condensed alone = condense(k, t.shape, *t.material, t.force, t.penalty);
      EXPECT_LT(off(together[i].K, alone.K), close) << i;
      EXPECT_EQ(together[i].K, together[i].K.transpose().eval());
      if (t.force.size() > 0) {
        EXPECT_LT(off(together[i].F, alone.F), close) << i;
      } else {
        EXPECT_TRUE(together[i].F.isZero(0));
      }
      ASSERT_EQ(together[i].trace.size(), alone.trace.size());
      if (alone.trace.size() > 0) {
        EXPECT_LT(off(together[i].trace, alone.trace), close);
        EXPECT_NEAR(together[i].own, alone.own, close * (std::abs(alone.own) + alone.trace.norm()));
        EXPECT_NEAR(together[i].by_theta, alone.by_theta, close * std::abs(alone.by_theta));
      }
      TraceForces forces;
      const Eigen::VectorXd interior_alone =
          interior(k, t.shape, *t.material, t.force, c.found[i].m, t.penalty, forces);
      EXPECT_LT(off(c.interior[i], interior_alone), close) << i;
      EXPECT_LT(off(c.found[i].forces.of_trace, forces.of_trace), close) << i;
      if (t.force.size() > 0) {
        EXPECT_LT(off(c.found[i].forces.given, forces.given), close) << i;
      }
    }
  }
};

TEST_P(Packed, AgreesWithOneByOne) {
  for (const bool forced : {false, true})
    for (const bool penalized : {false, true}) {
      Crowd c = crowd(9, forced ? displacement_count(k.element) : 0, penalized);
      compare(c);
    }
}

TEST_P(Packed, CurvedAndStrainedTrianglesGoTheirOwnWay) {
  Crowd bowed = crowd(7, displacement_count(k.element), false);
  bowed.triangles[2].shape.curvature[1] = &curvature;
  compare(bowed);
  Crowd strained = crowd(5, displacement_count(k.element) + stress_count(k.element), true);
  compare(strained);
}

TEST_P(Packed, ATriangleHasTheSameBitsInEveryPlace) {
  Crowd c = crowd(8, displacement_count(k.element), true);
  const std::vector<Condensed> forth = condensed(c);
  recover(c);
  Crowd turned = c;
  std::ranges::reverse(turned.triangles);
  std::ranges::reverse(turned.found);
  turned.triangles.erase(turned.triangles.begin());  // seven: other neighbours, and a pack that is not full
  turned.found.erase(turned.found.begin());
  turned.interior.pop_back();
  const std::vector<Condensed> back = condensed(turned);
  recover(turned);
  for (std::size_t i = 0; i < back.size(); ++i) {
    const std::size_t same = 6 - i;
    EXPECT_EQ(back[i].K, forth[same].K);
    EXPECT_EQ(back[i].F, forth[same].F);
    EXPECT_EQ(back[i].trace, forth[same].trace);
    EXPECT_EQ(turned.interior[i], c.interior[same]);
    EXPECT_EQ(turned.found[i].forces.of_trace, c.found[same].forces.of_trace);
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, Packed,
                         testing::Values(bdms(1), bdms(2), bdms(3), bdms(4), afw(1), afw(2), afw(3), afw(4)),
                         [](const auto& info) { return fmt::format("{}{}", info.param.name, info.param.degree); });

}  // namespace
}  // namespace kerf::packed_test
