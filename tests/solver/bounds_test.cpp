#include "solver/bounds.hpp"

#include "solver/conforming.hpp"
#include "solver/polynomial.hpp"
#include "solver/right_inverse.hpp"
#include "tests/exact.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace kerf {
namespace {

using Held = std::vector<Index>;

Vec2 displacement(const exact::ExactField& f, const Vec2& x) {
  return f.displacement(x, exact::side_of(f, x));
}

Scene scene_of(const exact::ExactField& f, const Held& held, std::size_t cracks) {
  Scene s;
  s.material = f.material;
  s.body = f.body;
  for (Index label = 0; label < 4; ++label) {
    if (std::find(held.begin(), held.end(), label) != held.end())
      s.supports.push_back({label, false, true, true, [f](const Vec2& x, const Vec2&) { return displacement(f, x); }});
    else
      s.tractions.push_back(
          {label, [f](const Vec2& x, const Vec2& n) { return Vec2(f.stress(x, exact::side_of(f, x)) * n); }});
  }
  s.laws.resize(cracks);
  return s;
}

// Potential energy of an exact field on the body of a mesh, from works on its boundary and of the body force.
double exact_energy(const Mesh& mesh, const exact::ExactField& f, const Held& held) {
  const EdgeRule rule = gauss(24);
  double inner = 0, outer = 0;
  for (std::size_t i = 0; i < mesh.edges.size(); ++i) {
    const Index e = static_cast<Index>(i);
    if (mesh.label[e] == none) continue;
    const Vec2 &a = mesh.points[mesh.edges[e][0]], &b = mesh.points[mesh.edges[e][1]];
    const Vec2 n = mesh.sides[e][1] == none ? normal(mesh, e) : Vec2(-normal(mesh, e));
    double work = 0;
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const Vec2 x = a + rule.s[q] * (b - a);
      work += length(mesh, e) * rule.w[q] * displacement(f, x).dot(f.stress(x, exact::side_of(f, x)) * n);
    }
    inner += work;
    if (std::find(held.begin(), held.end(), mesh.label[e]) == held.end()) outer += work;
  }
  if (f.body) {
    const double work = exact::integrate(
        mesh, f, [&](Index, int side, const Vec2& x) { return f.body(x).dot(f.displacement(x, side)); });
    inner += work;
    outer += work;
  }
  return 0.5 * inner - outer;
}

struct Measured {
  EnergyBounds bounds;
  double exact = 0, scale = 0;
  double gap() const {
    return (bounds.upper - bounds.lower) / scale;
  }
};

Measured measure(const Mesh& mesh, const exact::ExactField& f, const Held& held, int degree) {
  const Model m = prepare(mesh, element("bdms", degree), scene_of(f, held, mesh.cracks.size()), 1);
  const State s = solve(m);
  return {energy_bounds(m, s), exact_energy(mesh, f, held), strain_energy(m, s)};
}

void expect_bounds(const Measured& r, const std::string& which) {
  std::printf("%-40s gap %.3e  low %.3e  high %.3e  osc %.1e  guaranteed %d  asymmetry %.1e imbalance %.1e\n",
              which.c_str(), r.gap(), (r.exact - r.bounds.lower) / r.scale, (r.bounds.upper - r.exact) / r.scale,
              r.bounds.oscillation / r.scale, r.bounds.guaranteed, r.bounds.asymmetry, r.bounds.imbalance);
  EXPECT_LE(r.bounds.lower, r.exact) << which;
  EXPECT_GE(r.bounds.upper, r.exact) << which;
  EXPECT_LT(r.bounds.asymmetry, 1e-11) << which;
  EXPECT_LT(r.bounds.imbalance, 1e-11) << which;
}

TEST(RightInverse, HasTheDivergenceAndVanishesOnTheBoundary) {
  for (const int n : {1, 2, 3, 4, 6}) {
    // Per third: three points inside and two on its side of the triangle.
    const std::array<Vec2, 3> corner{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
    TriangleRule at{Points(2, 15), Eigen::VectorXd(15)};
    for (int t = 0; t < 3; ++t) {
      const Vec2 a = corner[(t + 1) % 3], b = corner[(t + 2) % 3], c = Vec2::Constant(1.0 / 3);
      const std::array<Vec2, 5> x{0.2 * a + 0.3 * b + 0.5 * c, 0.1 * a + 0.8 * b + 0.1 * c, 0.6 * a + 0.1 * b + 0.3 * c,
                                  0.3 * a + 0.7 * b, 0.9 * a + 0.1 * b};
      for (int q = 0; q < 5; ++q) at.x.col(5 * t + q) = x[q];
    }
    const RightInverse inverse = right_inverse(n, at);
    const Eigen::MatrixXd free = normal_free_right_inverse(std::max(n, 2));
    const TriangleRule rule = triangle_rule(2 * n);
    Eigen::VectorXd g = Eigen::VectorXd::LinSpaced(dim(n), -1, 2).array().sin();
    g.array() -= (interpolation(n, rule.x) * g).dot(rule.w);
    const Eigen::VectorXd wanted = interpolation(n, at.x) * g, d = inverse.derivative * g, v = inverse.value * g;
    for (int q = 0; q < 15; ++q) {
      EXPECT_NEAR(d[4 * q] + d[4 * q + 3], wanted[q], 1e-11) << n;
      if (q % 5 > 2) {
        EXPECT_LT(v.segment<2>(2 * q).norm(), 1e-13) << n;
      }
    }
  }
}

TEST(RightInverse, WithoutNormalTraceHasTheDivergence) {
  for (const int n : {2, 3, 5, 6}) {
    const Points nodes = lattice(n);
    const TriangleRule rule = triangle_rule(2 * n);
    Eigen::VectorXd low = Eigen::VectorXd::LinSpaced(dim(n - 1), -1, 2).array().sin();
    low.array() -= (interpolation(n - 1, rule.x) * low).dot(rule.w);
    const Eigen::VectorXd g = interpolation(n - 1, nodes) * low, p = normal_free_right_inverse(n) * g;
    const Eigen::Map<const Points> field(p.data(), 2, nodes.cols());
    const auto d = differentiation(n, nodes);
    EXPECT_LT((d[0] * field.row(0).transpose() + d[1] * field.row(1).transpose() - g).norm(), 1e-11) << n;
    const Mat2 J = jacobian({Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)});  // physical coordinates are (l1, l2)
    for (Eigen::Index q = 0; q < nodes.cols(); ++q) {
      const Vec2 here = J * field.col(q);
      if (nodes(0, q) == 0) {
        EXPECT_NEAR(here.x(), 0, 1e-12);
      }
      if (nodes(1, q) == 0) {
        EXPECT_NEAR(here.y(), 0, 1e-12);
      }
    }
  }
}

// Constant stress: both bounds are the energy.
TEST(EnergyBounds, CoincideInThePatchTest) {
  for (const double nu : {0.0, 0.3, 0.499999})
    for (const bool crack : {false, true})
      for (const int degree : {1, 2, 3})
        for (const Held& held : {Held{0, 1, 2, 3}, Held{0, 3}}) {
          Mat2 stress;
          stress << 0.3, crack ? 0 : 0.4, crack ? 0 : 0.4, -0.7;
          exact::ExactField f;
          f.material = plane_strain(2, nu);
          f.stress = [=](const Vec2&, int) { return stress; };
          f.displacement = [=](const Vec2& x, int) { return Vec2(strain(f.material, stress) * x + Vec2(0.3, -0.1)); };
          const Mesh mesh = crack ? exact::crack_mesh(4, 0, 0.2) : exact::unit_square_mesh(3, 0.2);
          const Measured r = measure(mesh, f, held, degree);
          const std::string which = std::to_string(nu) + (crack ? " crack " : " ") + std::to_string(degree);
          expect_bounds(r, which);
          EXPECT_LT(r.gap(), 1e-10) << which;
          EXPECT_TRUE(r.bounds.guaranteed) << r.bounds.note;
        }
}

TEST(EnergyBounds, ContainTheEnergyOfSmoothBodiesAndCloseAtTwiceTheOrder) {
  for (const double nu : {0.3, 0.499999})
    for (const int degree : {1, 2, 3})
      for (const char* name : {"wave", "trig", "exp"})
        for (const Held& held : {Held{0, 1, 2, 3}, Held{0, 3}}) {
          const exact::ExactField f = std::string(name) == "wave"   ? exact::wave_field(nu)
                                      : std::string(name) == "trig" ? exact::trig_field(nu)
                                                                    : exact::exp_field(nu);
          for (const int n : {2, 4, 8}) {
            const Measured r = measure(exact::unit_square_mesh(n, 0.2), f, held, degree);
            expect_bounds(r, std::string(name) + " nu " + std::to_string(nu) + " k " + std::to_string(degree) + " n " +
                                 std::to_string(n) + (held.size() == 4 ? " D" : " DN"));
          }
        }
}

TEST(EnergyBounds, ContainTheEnergyOfCrackedBodies) {
  for (const char* name : {"I", "II", "III", "IV"})
    for (const int degree : {1, 2, 3})
      for (const int n : {4, 8, 16})
        for (const Held& held : {Held{0, 1, 2, 3}, Held{0, 3}}) {
          const exact::ExactField f = exact::crack_case(name, 0.3);
          const Measured r = measure(exact::crack_mesh(n, 0.3, 0.2), f, held, degree);
          expect_bounds(r, std::string(name) + " k " + std::to_string(degree) + " n " + std::to_string(n) +
                               (held.size() == 4 ? " D" : " DN"));
        }
}

}  // namespace
}  // namespace kerf
