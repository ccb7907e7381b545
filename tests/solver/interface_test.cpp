// Regions that touch each other along their borders: press fits against Lame, rings in rings under cos 2t, layers.

#include "geometry/interfaces.hpp"
#include "kerf/mesher.hpp"
#include "kerf/recover.hpp"
#include "kerf/state.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>

namespace kerf::interface_test {
namespace {

struct Solved {
  Model model;
  State state;
};
Solved solved(const Shape& shape, const Scene& scene, const Sizing& sizing, const Element& e = bdms(1)) {
  Model m = prepare(triangulate(shape, sizing), e, scene, 1);
  State s = solve(m);
  EXPECT_TRUE(certified(s)) << s.certificate.kkt << ' ' << s.certificate.work;
  return {std::move(m), std::move(s)};
}

/// The interface of two regions as the cracks of the shape.
void touch(Shape& shape, Index region, Index other) {
  for (Crack crack : seams(shape, region, other)) {
    crack.name = "fit";
    shape.cracks.push_back(std::move(crack));
  }
}

Support hold(Index label, bool first, bool second, Vec2 (*value)(const Vec2&) = nullptr) {
  return {label, false, first, second,
          [value](const Vec2& x, const Vec2&) -> Vec2 { return value ? value(x) : Vec2(Vec2::Zero()); }};
}

/// Means of the pressure and of its part cos(n t) over the angle t about the origin.
struct Harmonics {
  double mean = 0, second = 0, worst = 0;
};
Harmonics pressure_on(const Solved& s, double wanted = 0) {
  Harmonics h;
  double total = 0;
  for (Index crack = 0; crack < Index(s.model.mesh.cracks.size()); ++crack)
    for (const CrackPoint& p : crack_profile(s.model, s.state, crack)) {
      const double t = std::atan2(p.at.y(), p.at.x());
      total += p.length;
      h.mean += p.length * p.contact_pressure();
      h.second += 2 * p.length * p.contact_pressure() * std::cos(2 * t);
      h.worst = std::max(h.worst, std::abs(p.contact_pressure() - wanted));
    }
  h.mean /= total;
  h.second /= total;
  return h;
}

/// Radial displacement at r, over r, of a ring with sigma_rr = A - B/r^2.
double opening(const Material& m, double A, double B, double r) {
  return B / (2 * m.mu * r * r) + 2 * m.c * A;
}

/// Rings a to b (a = 0: a disc) and b to c that overlap by delta in the radius, free outside: the pressure between
/// them.
struct Rings {
  double a, b, c;
  Material inner, outer;
  double pressure(double delta) const {
    // Per unit of pressure. Outside it: sigma_rr(b) = -1, sigma_rr(c) = 0; inside: sigma_rr(a) = 0, sigma_rr(b) = -1.
    const double A = b * b / (c * c - b * b), A_in = -b * b / (b * b - a * a);
    return delta / (b * (opening(outer, A, A * c * c, b) - opening(inner, A_in, A_in * a * a, b)));
  }
};

/// A quarter, x and y positive: sides are 0 on the x axis, 1 on the y axis, 2 free outside, 3 free inside.
Shape quarter(const Rings& r) {
  const auto arc = [](double radius, double from, double to) {
    return Arc{Vec2::Zero(), radius * Mat2::Identity(), from, to};
  };
  const auto loop = [&](const char* name, double to, bool labeled) {
    const auto label = [&](Index l) { return labeled ? l : none; };
    Loop l{name, {}};
    if (r.a == 0)
      l.sides = {{{0, 0}, label(0), {}}};
    else
      l.sides = {{{0, r.a}, label(3), arc(r.a, pi / 2, 0)}, {{r.a, 0}, label(0), {}}};
    l.sides.push_back({{to, 0}, label(2), arc(to, 0, pi / 2)});
    l.sides.push_back({{0, to}, label(1), {}});
    return l;
  };
  Shape shape{loop("outline", r.c, true), {}, {}, {"x", "y", "outside", "inside"}, {loop("inner", r.b, false)}};
  touch(shape, 0, none);
  return shape;
}

Scene symmetric(const Rings& r, const Shape& shape) {
  Scene s{.material = r.outer, .regions = {r.inner}};
  s.supports = {hold(0, false, true), hold(1, true, false)};
  s.laws.assign(shape.cracks.size(), {});
  return s;
}

TEST(PressFit, HasLamesPressure) {
  const auto steel = [](bool strain) { return strain ? plane_strain(2, 0.3) : plane_stress(2, 0.3); };
  for (const bool strain : {true, false})
    for (const double a : {0.0, 0.5})
      for (const double nu : {0.3, 0.49, 0.5}) {
        SCOPED_TRACE(testing::Message() << strain << ' ' << a << ' ' << nu);
        const Rings rings{a, 1, 2, strain ? plane_strain(1, nu) : plane_stress(1, nu), steel(strain)};
        const Shape shape = quarter(rings);
        Scene scene = symmetric(rings, shape);
        scene.laws[0].gap = [](const Vec2&, const Vec2&) { return Vec2(-0.01, 0); };
        const Solved s = solved(shape, scene, {.size = 0.15, .curved = true});
        const double exact = rings.pressure(0.01);
        const Harmonics found = pressure_on(s, exact);
        EXPECT_NEAR(found.mean, exact, 1e-3 * exact);
        EXPECT_LT(found.worst, 1e-2 * exact);
      }
}

// The order of the energy: the pressure is right to h^2k+2 in the mean.
TEST(PressFit, ConvergesWithTheDegree) {
  const Rings rings{0, 1, 2, plane_strain(1, 0.3), plane_strain(3, 0.2)};
  const Shape shape = quarter(rings);
  Scene scene = symmetric(rings, shape);
  scene.laws[0].gap = [](const Vec2&, const Vec2&) { return Vec2(-0.01, 0); };
  const double exact = rings.pressure(0.01);
  for (const auto& [degree, tolerance] : {std::pair{1, 1e-3}, {2, 1e-5}, {3, 1e-6}}) {
    const Solved s = solved(shape, scene, {.size = 0.2, .curved = true}, bdms(degree));
    EXPECT_NEAR(pressure_on(s).mean, exact, tolerance * exact) << degree;
  }
}

// A whole disc, which only contact holds, in a plate held at r = 2: two terms of Lame with u(2) = 0.
TEST(PressFit, HoldsAWholeDisc) {
  const Material plate = plane_strain(1, 0.3), disc = plane_strain(2, 0.25);
  const double A = -1 / (1 + 4 * 4 * plate.mu * plate.c), B = -4 * plate.mu * plate.c * 4 * A;
  EXPECT_NEAR(A - B, -1, 1e-14);
  EXPECT_NEAR(opening(plate, A, B, 2), 0, 1e-15);
  const double exact = 0.01 / (opening(plate, A, B, 1) + 2 * disc.c);
  Shape shape{circle("outline", Vec2::Zero(), 2, 0), {}, {}, {"rim"}, {circle("disc", Vec2::Zero(), 1, none)}};
  touch(shape, 0, none);
  for (const double friction : {0.0, 0.3})
    for (const bool curved : {true, false}) {
      SCOPED_TRACE(testing::Message() << friction << ' ' << curved);
      Scene scene{.material = plate, .regions = {disc}};
      scene.supports = {hold(0, true, true)};
      scene.laws = {{.friction = friction,
                     .normal = [](const Vec2& x) { return x.normalized().eval(); },
                     .gap = [](const Vec2&, const Vec2&) { return Vec2(-0.01, 0); }}};
      const Solved s = solved(shape, scene, {.size = 0.2, .curved = curved});
      EXPECT_NEAR(pressure_on(s).mean, exact, (curved ? 1e-3 : 1e-2) * exact);
    }
}

// Michell's terms of cos 2t: r^2, r^4, r^-2, 1; their s_rr, s_rt, 2 mu u_r.
std::array<Eigen::Vector3d, 4> terms(double r, const Material& m) {
  const double kappa = 1 + 8 * m.mu * m.c;  // 3 - 4 nu in plane strain
  return {Eigen::Vector3d(-2, 2, -2 * r), Eigen::Vector3d(0, 6 * r * r, (kappa - 3) * r * r * r),
          Eigen::Vector3d(-6 / std::pow(r, 4), -6 / std::pow(r, 4), 2 / std::pow(r, 3)),
          Eigen::Vector3d(-4 / (r * r), -2 / (r * r), (kappa + 1) / r)};
}

/// Part cos 2t of the pressure between a disc and a ring without friction, that part of the pressure outside being 1.
double second_harmonic(const Rings& rings) {
  const auto in = terms(rings.b, rings.inner), out = terms(rings.b, rings.outer), rim = terms(rings.c, rings.outer);
  Eigen::Matrix<double, 6, 6> M = Eigen::Matrix<double, 6, 6>::Zero();  // unknowns: two of the disc, four of the ring
  Eigen::Matrix<double, 6, 1> f = Eigen::Matrix<double, 6, 1>::Zero();
  for (int i = 0; i < 4; ++i) {
    if (i < 2) M.col(i) << in[i][1], 0, in[i][0], in[i][2] / rings.inner.mu, 0, 0;
    M.col(2 + i) << 0, out[i][1], -out[i][0], -out[i][2] / rings.outer.mu, rim[i][0], rim[i][1];
  }
  f[4] = -1;
  const auto x = M.partialPivLu().solve(f).eval();
  return -(x[0] * in[0][0] + x[1] * in[1][0]);
}

TEST(RingInRing, CarriesTheSecondHarmonic) {
  const Material m = plane_strain(1, 0.3);
  const Rings rings{0, 0.6, 1, m, m};
  EXPECT_NEAR(0.2 * second_harmonic(rings), 0.295853, 1e-6);  // measured with another program
  const Shape shape = quarter(rings);
  Scene scene = symmetric(rings, shape);
  scene.tractions = {{2, [](const Vec2& x, const Vec2& n) -> Vec2 {
                        return -(1 + 0.2 * std::cos(2 * std::atan2(x.y(), x.x()))) * n;
                      }}};
  std::vector<double> error;
  for (const double size : {0.1, 0.05}) {
    const Solved s = solved(shape, scene, {.size = size, .curved = true});
    error.push_back(std::abs(pressure_on(s).second - 0.2 * second_harmonic(rings)));
  }
  EXPECT_LT(error[0], 1e-3 * 0.2959);
  EXPECT_LT(error[1], error[0] / 3);
  scene.material = plane_strain(4, 0.2);
  const Rings two{0, 0.6, 1, m, scene.material};
  const Solved s = solved(shape, scene, {.size = 0.1, .curved = true}, bdms(2));
  EXPECT_NEAR(pressure_on(s).second, 0.2 * second_harmonic(two), 1e-4 * 0.2959);
}

/// Layers of height 1 and width 2 on top of each other: by regions and interfaces, or by cracks.
Shape layers(int count, bool regions) {
  const double height = count;
  Shape shape{.outline = polygon("outline", {{-1, 0}, {1, 0}, {1, height}, {-1, height}}, 1),
              .labels = {"bottom", "side", "top"}};
  shape.outline.sides[0].label = 0;
  shape.outline.sides[2].label = 2;
  for (double y = 1; y < height; ++y)
    if (regions)
      shape.regions.push_back(polygon("layer", {{-1, y}, {1, y}, {1, y + 1}, {-1, y + 1}}, none));
    else
      shape.cracks.push_back({"joint", {{-1, y}, {1, y}}, {}});
  for (Index r = 0; r + 1 < count && regions; ++r) touch(shape, r, r - 1);
  return shape;
}

// Layers that slide on each other under a uniform pressure and a uniform shear below the limit, of other materials.
TEST(Layers, PassThePatchTest) {
  const Shape shape = layers(3, true);
  ASSERT_EQ(shape.cracks.size(), 2u);
  // s_yy = -0.1, s_xy = 0.02, s_xx = 0 everywhere: e_xx must be the same in all layers, so c - 1/(4 mu) is.
  const auto with = [](double mu) { return Material{.mu = mu, .c = 0.1 + 0.25 * (1 / mu - 1)}; };
  Scene scene{.material = with(1), .regions = {with(1.25), with(0.8)}};
  scene.laws.assign(2, {.friction = 0.5});
  const auto stress = [](const Vec2&, const Vec2& n) -> Vec2 { return {0.02 * n.y(), 0.02 * n.x() - 0.1 * n.y()}; };
  scene.tractions = {{1, stress}, {2, stress}};
  // What the stress does to the lowest layer, without rotation at the bottom.
  const double tr = -0.1, mu = 1, c = 0.1, e_xx = -tr / 2 / (2 * mu) + c * tr;
  scene.supports = {{0, false, true, true, [e_xx](const Vec2& x, const Vec2&) -> Vec2 { return {e_xx * x.x(), 0}; }}};
  const Solved s = solved(shape, scene, {.size = 0.3});
  for (const Index crack : {0, 1})
    for (const CrackPoint& p : crack_profile(s.model, s.state, crack)) {
      EXPECT_NEAR(p.sigma_n, -0.1, 1e-10);
      EXPECT_NEAR(std::abs(p.sigma_t), 0.02, 1e-10);
      EXPECT_NEAR(p.jump_t, 0, 1e-10);
    }
}

TEST(Layers, AreWhatCracksAre) {
  std::array<std::vector<double>, 2> force;
  std::array<double, 2> energy;
  for (const bool regions : {false, true}) {
    const Shape shape = layers(4, regions);
    Scene scene{.material = plane_strain(1, 0.3)};
    scene.regions.assign(shape.regions.size(), scene.material);
    scene.supports = {hold(0, true, true)};
    scene.tractions = {{2, [](const Vec2& x, const Vec2&) -> Vec2 { return {0.01, -0.1 * (1 + x.x())}; }}};
    scene.laws.assign(shape.cracks.size(), {.friction = 0.3});
    const Solved s = solved(shape, scene, {.size = 0.25});
    energy[regions] = potential_energy(s.model, s.state);
    for (Index c = 0; c < Index(shape.cracks.size()); ++c) {
      double normal = 0, moment = 0;
      for (const CrackPoint& p : crack_profile(s.model, s.state, c)) {
        normal += p.length * p.contact_pressure();
        moment += p.length * p.contact_pressure() * p.at.x();
      }
      force[regions].push_back(normal);
      force[regions].push_back(moment);
    }
  }
  ASSERT_EQ(force[0].size(), 6u);
  ASSERT_EQ(force[1].size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(force[0][i], force[1][i], 1e-10);
  EXPECT_NEAR(energy[0], energy[1], 1e-2 * std::abs(energy[0]));
}

}  // namespace
}  // namespace kerf::interface_test
