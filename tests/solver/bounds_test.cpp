// Bounds of the energy contain that of exact fields, with and without cracks, and close at twice the order of the
// stress where the field is smooth; bodies without an exact solution: bounds on fine meshes lie in those on coarse
// ones.

#include "kerf/bounds.hpp"

#include "base/polynomial.hpp"
#include "solver/bounds/conforming.hpp"
#include "solver/bounds/right_inverse.hpp"
#include "tests/support/exact.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

namespace kerf::bounds_test {
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
      for (const int degree : {1, 2, 3, 4})
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
    for (const int degree : {1, 2, 3, 4})
      for (const char* name : {"wave", "trig", "exp"})
        for (const Held& held : {Held{0, 1, 2, 3}, Held{0, 3}}) {
          const exact::ExactField f = std::string(name) == "wave"   ? exact::wave_field(nu)
                                      : std::string(name) == "trig" ? exact::trig_field(nu)
                                                                    : exact::exp_field(nu);
          std::vector<double> gap;
          const std::string which = fmt::format("{} nu {} degree {} held {}", name, nu, degree, held.size());
          for (const int n : {2, 4, 8}) {
            const Measured r = measure(exact::unit_square_mesh(n, 0.2), f, held, degree);
            expect_bounds(r, which + " n " + std::to_string(n));
            gap.push_back(r.gap());
          }
          if (gap[2] > (degree == 4 ? 1e-8 : 1e-10)) {  // not rounding alone
            EXPECT_GT(std::log2(gap[1] / gap[2]), 2 * degree + (degree == 4 ? 1.1 : 1.3)) << which;
          }
        }
}

TEST(EnergyBounds, GapIsASmallMultipleOfTheErrorOfTheStress) {
  for (const double nu : {0.3, 0.499999})
    for (const int degree : {1, 2}) {
      const exact::ExactField f = exact::exp_field(nu);
      const Mesh mesh = exact::unit_square_mesh(8, 0.2);
      const Model m = prepare(mesh, element("bdms", degree), scene_of(f, {0, 3}, 0), 1);
      const State s = solve(m);
      const double error = exact::integrate(mesh, f, [&](Index t, int side, const Vec2& x) {
        const Mat2 d = tensor(stress_at(m.inner->kernel, triangle(m, t), s.interior.col(t), x)) - f.stress(x, side);
        return 0.5 * strain(f.material, d).cwiseProduct(d).sum();
      });
      const EnergyBounds b = energy_bounds(m, s);
      EXPECT_GT(b.upper - b.lower, error);
      EXPECT_LT(b.upper - b.lower, 7 * error);  // 2.4 to 5.9
    }
}

TEST(EnergyBounds, ContainTheEnergyOfCrackedBodies) {
  for (const char* name : {"I", "II", "III", "IV"})
    for (const int degree : {1, 2, 3})
      for (const Held& held : {Held{0, 1, 2, 3}, Held{0, 3}}) {
        const exact::ExactField f = exact::crack_case(name, 0.3);
        const std::string which = fmt::format("{} degree {} held {}", name, degree, held.size());
        std::vector<double> gap;
        for (const int n : {4, 8, 16}) {
          const Measured r = measure(exact::crack_mesh(n, 0.3, 0.2), f, held, degree);
          expect_bounds(r, which + " n " + std::to_string(n));
          EXPECT_TRUE(r.bounds.guaranteed) << which;
          gap.push_back(r.gap());
        }
        EXPECT_LT(gap[2], 0.62 * gap[1]) << which;
      }
}

TEST(EnergyBounds, ContainTheEnergiesOfTheTables) {
  for (const char* id : {"c01_modeI", "c01b_modeI_biaxial", "c02_modeII", "c03_inclined_open", "c04_inclined_closed",
                         "c05_partial_linear", "c05_partial_linear_w", "c05b_partial_general", "c05c_lens"}) {
    const exact::ExactField f = exact::table_field(id);
    const Vec2 along = f.tips[1].at - f.tips[0].at;
    const double angle = std::atan2(along.y(), along.x());
    if (std::abs(along.norm() - 2) > 1e-12 || (f.tips[1].at + f.tips[0].at).norm() > 1e-12) continue;
    for (const int n : {8, 16}) {
      const Measured r = measure(exact::crack_mesh(n, angle), f, {0, 1, 2, 3}, 1);
      expect_bounds(r, std::string(id) + " n " + std::to_string(n));
      if (angle == 0) {
        EXPECT_NEAR(r.exact / exact::read_table(KERF_TEST_DATA "/exact", id).energy, 1, 1e-10) << id;
      }
    }
  }
}

TEST(EnergyBounds, ContainTheEnergyAroundAHole) {
  const exact::ExactField f = exact::kirsch(plane_strain(1000, 0.3), (Mat2() << 1, 0.2, 0.2, -0.3).finished(), 1);
  for (const int n : {12, 24}) {
    std::vector<Vec2> points;
    std::vector<std::array<Index, 3>> triangles;
    std::vector<Marked> marked;
    const Index rings = n / 4;
    for (Index i = 0; i <= rings; ++i)
      for (Index j = 0; j < n; ++j) {
        const double turn = 2 * pi * j / n, radius = 1 + 2.0 * i / rings;
        points.emplace_back(radius * std::cos(turn), radius * std::sin(turn));
      }
    for (Index j = 0; j < n; ++j) {
      const Index next = (j + 1) % n;
      for (Index i = 0; i < rings; ++i) {
        triangles.push_back({i * n + j, (i + 1) * n + j, (i + 1) * n + next});
        triangles.push_back({i * n + j, (i + 1) * n + next, i * n + next});
      }
      marked.push_back({j, next, 0});
      marked.push_back({rings * n + j, rings * n + next, 1});
    }
    for (const int degree : {1, 3}) {
      const Measured r = measure(connect(points, triangles, marked), f, {1}, degree);
      expect_bounds(r, fmt::format("hole degree {} n {}", degree, n));
    }
  }
}

// Bodies without an exact solution: the bounds on a fine mesh lie between those on a coarse one, nearly.
struct Fixture {
  std::string name;
  Mesh mesh;
  Scene scene;
};

Mesh square_with_cracks(const std::vector<std::vector<Index>>& paths) {  // vertices i + 5 j of a 4 x 4 grid
  Mesh mesh = exact::unit_square_mesh(4);
  std::vector<Marked> marked;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (mesh.label[e] != none) marked.push_back({mesh.edges[e][0], mesh.edges[e][1], mesh.label[e]});
  for (std::size_t c = 0; c < paths.size(); ++c)
    for (std::size_t i = 0; i + 1 < paths[c].size(); ++i)
      marked.push_back({paths[c][i], paths[c][i + 1], none, static_cast<Index>(c)});
  return connect(mesh.points, mesh.triangles, marked);
}

std::vector<Fixture> fixtures() {
  const auto zero = [](const Vec2&, const Vec2&) { return Vec2(0, 0); };
  const auto pull = [](const Vec2& x, const Vec2&) { return Vec2(0.3 * x.x(), 1 - 3 * x.x()); };
  Scene held;
  held.material = plane_strain(3, 0.3);
  held.supports.push_back({0, false, true, true, zero});
  held.tractions.push_back({2, pull});
  std::vector<Fixture> list;
  const auto add = [&](std::string name, const std::vector<std::vector<Index>>& paths, Scene scene) {
    scene.laws.resize(paths.size());
    list.push_back({std::move(name), square_with_cracks(paths), scene});
  };
  add("no crack", {}, held);
  add("edge crack", {{10, 11, 12}}, held);
  add("kinked crack", {{11, 12, 18}}, held);
  add("sharply kinked crack", {{11, 12, 7}}, held);
  add("crack from a support", {{2, 7, 12}}, held);
  Scene law = held;
  law.laws = {{CrackLaw::Kind::Open}};
  add("open law", {{10, 11, 12}}, law);
  law.laws = {{CrackLaw::Kind::Bonded}};
  add("bonded law", {{10, 11, 12}}, law);
  law.laws = {{CrackLaw::Kind::Unilateral}, {CrackLaw::Kind::Bonded}};
  add("unilateral beside bonded", {{10, 11, 12}, {12, 13}}, law);
  add("branching", {{11, 12, 13}, {12, 17}}, held);
  Scene rollers;
  rollers.material = plane_stress(3, 0.3);
  rollers.supports.push_back(
      {0, true, true, false, [](const Vec2& x, const Vec2&) { return Vec2(0.1 * x.x() * x.x(), 0); }});
  rollers.supports.push_back({3, true, true, false, zero});
  rollers.tractions.push_back({2, pull});
  rollers.body = [](const Vec2& x) { return Vec2(0.2, x.x() - 1); };
  add("rollers", {{11, 12, 13}}, rollers);
  Scene loaded = rollers;
  loaded.tractions.push_back({0, pull});  // its tangential part acts, its normal part is work on the given displacement
  add("rollers under traction", {}, loaded);
  Scene floating;
  floating.material = plane_strain(3, 0.3);
  floating.tractions.push_back({2, [](const Vec2& x, const Vec2&) { return Vec2(0, x.x() * (1 - x.x())); }});
  floating.tractions.push_back({0, [](const Vec2& x, const Vec2&) { return Vec2(0, -x.x() * (1 - x.x())); }});
  add("no supports", {{11, 12, 13}}, floating);
  return list;
}

TEST(EnergyBounds, OfCoarseMeshesContainThoseOfFineOnes) {
  for (const Fixture& f : fixtures()) {
    const Mesh fine = refine(refine(f.mesh));
    const Model reference = prepare(fine, element("bdms", 2), f.scene, 1);
    const EnergyBounds inner = energy_bounds(reference, solve(reference));
    const double middle = 0.5 * (inner.lower + inner.upper);
    for (const int degree : {1, 2, 3}) {
      const Model m = prepare(f.mesh, element("bdms", degree), f.scene, 1);
      const State s = solve(m);
      const EnergyBounds b = energy_bounds(m, s);
      EXPECT_LE(b.lower, middle) << f.name;
      EXPECT_GE(b.upper, middle) << f.name;
      EXPECT_LT(inner.upper - inner.lower, 0.7 * (b.upper - b.lower)) << f.name;
      EXPECT_LT(b.imbalance, 1e-11) << f.name;
      EXPECT_TRUE(b.guaranteed) << f.name << b.note;
    }
  }
}

// Pressure at the Gauss points does not exclude tension between them and the ends of an edge: the solution itself is no
// admissible stress, and the bound must not be taken from it.
TEST(EnergyBounds, DoNotRelyOnTheSignAtGaussPoints) {
  int unsafe = 0;
  for (const char* name : {"II", "III"})
    for (const int n : {8, 16}) {
      const exact::ExactField f = exact::crack_case(name);
      const Model m = prepare(exact::crack_mesh(n), element("bdms"), scene_of(f, {0, 1, 2, 3}, 1), 1);
      const State s = solve(m);
      double tension = 0;
      for (const CrackEdge& c : m.mesh.cracks[0])
        for (const Index v : m.mesh.edges[c.edge]) {
          const Index t = m.mesh.sides[c.edge][0];
          const Vec2 normal = m.inner->skeleton.frame[c.edge].col(0);
          const Mat2 stress = tensor(stress_at(m.inner->kernel, triangle(m, t), s.interior.col(t), m.mesh.points[v]));
          tension = std::max(tension, normal.dot(stress * normal));
        }
      if (tension > 1e-3) ++unsafe;
      const EnergyBounds b = energy_bounds(m, s);
      const double exact = exact_energy(m.mesh, f, {0, 1, 2, 3});
      EXPECT_LE(b.lower, exact);
      EXPECT_GE(b.upper, exact);
    }
  EXPECT_GE(unsafe, 2);
}

// The edges of a straight crack that a mesher splits are parallel to rounding only: the faces must slide all the same.
TEST(EnergyBounds, LetFacesSlideOverRounding) {
  const exact::ExactField f = exact::crack_case("II");
  Mesh mesh = exact::crack_mesh(16);
  const double straight = measure(mesh, f, {0, 1, 2, 3}, 1).gap();
  double shift = 1e-13;
  for (const CrackEdge& c : mesh.cracks[0]) mesh.points[mesh.edges[c.edge][0]].y() += (shift = -shift);
  const Measured r = measure(mesh, f, {0, 1, 2, 3}, 1);
  expect_bounds(r, "rough crack");
  EXPECT_NEAR(r.gap() / straight, 1, 1e-6);
}

TEST(EnergyBounds, ExistWithoutCompressibility) {
  for (const int degree : {1, 2, 3, 4}) {
    const exact::ExactField f = exact::wave_field(0.5);
    const Measured r = measure(exact::unit_square_mesh(4, 0.2), f, {0, 3}, degree);
    expect_bounds(r, "nu 0.5 degree " + std::to_string(degree));
    EXPECT_LT(r.gap(), degree == 1 ? 3e-2 : 2e-4);
  }
}

TEST(EnergyBounds, HaveTheSameBitsForAnyNumberOfThreads) {
  const exact::ExactField f = exact::crack_case("III");
  const Mesh mesh = exact::crack_mesh(32, 0, 0.2);
  const Scene scene = scene_of(f, {0, 3}, 1);
  const Model one = prepare(mesh, element("bdms"), scene, 1), three = prepare(mesh, element("bdms"), scene, 3);
  const EnergyBounds a = energy_bounds(one, solve(one)), b = energy_bounds(three, solve(three));
  EXPECT_EQ(a.lower, b.lower);
  EXPECT_EQ(a.upper, b.upper);
}

TEST(EnergyBounds, AreNotGivenWithFriction) {
  const exact::ExactField f = exact::crack_case("II");
  Model m = prepare(exact::crack_mesh(4), element("bdms"), scene_of(f, {0, 1, 2, 3}, 1), 1);
  const State s = solve(m);
  m.scene.laws[0].friction = 0.3;
  const EnergyBounds b = energy_bounds(m, s);
  EXPECT_TRUE(std::isnan(b.lower) && std::isnan(b.upper));
  EXPECT_FALSE(b.guaranteed);
  EXPECT_NE(b.note.find("friction"), std::string::npos);
}

// A traction that jumps inside an edge widens the bounds, a displacement with a kink there makes them estimates.
TEST(EnergyBounds, SayWhenTheDataAreNotResolved) {
  Scene scene;
  scene.supports.push_back({0, false, true, true, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }});
  scene.tractions.push_back({2, [](const Vec2& x, const Vec2&) { return Vec2(0, x.x() < 0.4 ? 1 : 0); }});
  const auto bounds = [&] {
    const Model m = prepare(exact::unit_square_mesh(4), element("bdms"), scene, 1);
    return energy_bounds(m, solve(m));
  };
  const EnergyBounds jump = bounds();
  EXPECT_TRUE(jump.guaranteed);
  EXPECT_GT(jump.oscillation, 0.01 * (jump.upper - jump.lower));
  scene.supports.push_back(
      {2, false, true, true, [](const Vec2& x, const Vec2&) { return Vec2(0, std::abs(x.x() - 0.4)); }});
  scene.tractions.clear();
  const EnergyBounds kink = bounds();
  EXPECT_FALSE(kink.guaranteed);
  EXPECT_NE(kink.note.find("prescribed displacements"), std::string::npos) << kink.note;
}

// A pull along y and the eigenstrain of a displacement U that is no polynomial and changes the volume of a body whose
// material does not, or hardly, do so: J = -1/(8 mu) - int_top U_y.
TEST(Bounds, HoldTheEnergyWithAnEigenstrainThatChangesTheVolume) {
  constexpr double mu = 0.5;
  const auto U = [](const Vec2& x) -> Vec2 { return {0.1 * std::exp(x.x()), 0.05 * x.x() * std::exp(x.y())}; };
  for (const double c : {0.0, 1e-6}) {
    const Material material{mu, c};
    const Mat2 pull = (Mat2() << 0, 0, 0, 1).finished(), stretch = strain(material, pull);
    const double energy = -0.5 * (1 / (4 * mu) + c) - 0.025 * std::exp(1.0);
    Scene s{.material = material};
    s.eigenstrain = {{[](const Vec2& x) -> Vec2 {
                        return {0.1 * std::exp(x.x()), 0.05 * x.x() * std::exp(x.y())};
                      },
                      [](const Vec2& x) -> Vec2 {
                        return {0.025 * std::exp(x.y()), 0};
                      },
                      false}};
    s.supports = {
        {0, false, true, true, [U, stretch](const Vec2& x, const Vec2&) -> Vec2 { return U(x) + stretch * x; }}};
    for (const Index label : {1, 2, 3})
      s.tractions.push_back({label, [pull](const Vec2&, const Vec2& n) -> Vec2 { return pull * n; }});
    std::vector<double> gap;
    for (const int n : {2, 4}) {
      const Model m = prepare(exact::unit_square_mesh(n, 0.2), element("bdms", 2), s, 1);
      const EnergyBounds b = energy_bounds(m, solve(m));
      EXPECT_TRUE(b.guaranteed) << b.note;
      EXPECT_LE(b.lower, energy) << c;
      EXPECT_GE(b.upper, energy) << c;
      gap.push_back(b.upper - b.lower);
    }
    EXPECT_LT(gap[1], gap[0] / 16);
  }
}

}  // namespace
}  // namespace kerf::bounds_test
