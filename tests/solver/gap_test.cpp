// Faces that are apart, or overlap, before loading: patches, Hertz's pressure, tips, and what the gap does to the
// energy.

#include "kerf/analysis.hpp"
#include "kerf/bounds.hpp"
#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "kerf/recover.hpp"
#include "kerf/state.hpp"
#include "solver/data.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace kerf::gap_test {
namespace {

using Complex = std::complex<double>;

constexpr Index bottom = 0, right = 1, top = 2, left = 3;

/// The square [-1, 1]^2 with a crack.
Shape square(const Vec2& from, const Vec2& to) {
  Shape shape{.outline = polygon("outline", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, bottom),
              .cracks = {{"c", {from, to}}},
              .labels = {"bottom", "right", "top", "left"}};
  for (std::size_t i = 0; i < 4; ++i) shape.outline.sides[i].label = static_cast<Index>(i);
  return shape;
}

/// Cut along y = 0.
Shape blocks() {
  return square({-1, 0}, {1, 0});
}

BoundaryField uniform(double value) {
  return [value](const Vec2&, const Vec2&) { return Vec2(value, 0); };
}

/// On rollers at the sides and the bottom, the top pushed down by `down`: a state of uniaxial strain in both blocks.
Scene pressed(const Material& m, double down, BoundaryField gap) {
  Scene s{.material = m};
  const auto normal_only = [](Index label, double value) {
    return Support{label, true, true, false, [value](const Vec2&, const Vec2&) { return Vec2(value, 0); }};
  };
  s.supports = {normal_only(bottom, 0), normal_only(right, 0), normal_only(left, 0), normal_only(top, -down)};
  s.laws = {{.gap = std::move(gap)}};
  return s;
}

struct Solved {
  Model model;
  State state;
};
Solved solved(const Shape& shape, const Sizing& sizing, const Element& e, const Scene& scene) {
  Model m = prepare(triangulate(shape, sizing), e, scene, 1);
  State s = solve(m);
  EXPECT_TRUE(certified(s));
  return {std::move(m), std::move(s)};
}

double energy_of(const Solved& s) {
  return analyze({"energy", {energy()}}, s.model, s.state).value;
}

// Uniaxial strain: s_yy = (lambda + 2 mu) e, whatever the element and the mesh.
TEST(Gap, UniformOnesPassThePatchTest) {
  const Material m = plane_strain(1, 0.3);
  const double lambda = 0.3 / (1.3 * 0.4), modulus = lambda + 2 * m.mu;
  struct Case {
    double down, gap;
  };
  for (const auto& [down, gap] : {Case{0.1, 0.04}, Case{0, -0.02}, Case{0.01, 0.03}})
    for (const Element& e : {bdms(1), bdms(2), element("peers", 1), element("afw", 1), element("bdms-c", 1)}) {
      SCOPED_TRACE(fmt::format("{} {}: down {}, gap {}", e.name, e.degree, down, gap));
      const Solved s = solved(blocks(), {.size = 0.5}, e, pressed(m, down, uniform(gap)));
      const double pressure = std::max(0.0, modulus * (down - gap) / 2);
      for (const CrackPoint& p : crack_profile(s.model, s.state, 0)) {
        EXPECT_NEAR(p.contact_pressure(), pressure, 1e-10);
        EXPECT_NEAR(p.distance(), std::max(0.0, gap - down), 1e-10);
        EXPECT_EQ(p.status, down > gap ? CrackPoint::Status::Closed : CrackPoint::Status::Open);
      }
      EXPECT_NEAR(energy_of(s), 0.5 * pressure * pressure / modulus * 4, 1e-10);
    }
}

// The pressure of contact is what the energy loses per gap: no formula of contact enters the left side.
TEST(Gap, DrivesTheEnergyByThePressure) {
  const Material m = plane_strain(1, 0.3);
  const auto gap = [](double more) -> BoundaryField {
    return [more](const Vec2& x, const Vec2&) {
      return Vec2(0.03 * x.x() * x.x() - 0.01 + more * std::cos(2 * x.x() + 1), 0);
    };
  };
  const auto at = [&](double more) { return solved(blocks(), {.size = 0.12}, bdms(1), pressed(m, 0.01, gap(more))); };
  const Solved s = at(0);
  double work = 0;
  unsigned open = 0, closed = 0;
  for (const CrackPoint& p : crack_profile(s.model, s.state, 0)) {
    work -= p.length * p.contact_pressure() * std::cos(2 * p.at.x() + 1);
    ++(p.status == CrackPoint::Status::Closed ? closed : open);
  }
  EXPECT_GT(open, 3u);
  EXPECT_GT(closed, 3u);
  constexpr double step = 1e-6;
  EXPECT_NEAR((energy_of(at(step)) - energy_of(at(-step))) / (2 * step), work, 1e-6 * std::abs(work));
}

/// Two equal half planes, apart by a parabola, pressed over |x| < b: s_yy = Re Z + y Im Z', s_xx = Re Z - y Im Z',
/// s_xy = -y Re Z' with Z = -i p0/b (z - sqrt(z^2 - b^2)) above.
struct Hertz {
  Material m;
  double b, largest;

  /// The branch that is z far away.
  Complex root(Complex z) const {
    return std::sqrt(z - b) * std::sqrt(z + b);
  }
  double pressure(double x) const {
    return std::abs(x) < b ? largest * std::sqrt(1 - x * x / (b * b)) : 0;
  }
  double kappa() const {
    return 8 * m.mu / plane_modulus(m) - 1;
  }
  double gap(double x) const {
    return (kappa() + 1) * largest / (4 * m.mu * b) * x * x;
  }
  /// The upper one's displacement is 0 at the origin; the lower one's is its mirror image.
  Vec2 displacement(const Vec2& x, bool above) const {
    const double up = above ? 1 : -1;
    const Complex i(0, 1), z(x.x(), std::max(up * x.y(), 1e-14)), r = root(z);
    const Complex Z = -i * largest / b * (z - r),
                  primitive = -i * largest / b * 0.5 * (z * z - z * r + b * b * std::log((z + r) / (i * b)));
    const double k = kappa(), y = z.imag();
    const double u = (k - 1) / 2 * primitive.real() - y * Z.imag(), v = (k + 1) / 2 * primitive.imag() - y * Z.real();
    return Vec2(u, up * v) / (2 * m.mu);
  }
};

TEST(Gap, PressesAsHertzSays) {
  const Hertz exact{plane_strain(1, 0.3), 0.3, 0.01};
  std::vector<double> off;
  for (const double size : {0.06, 0.03}) {
    Scene scene{.material = exact.m};
    for (const Index label : {bottom, right, top, left})
      scene.supports.push_back(
          {label, false, true, true, [exact](const Vec2& x, const Vec2&) { return exact.displacement(x, x.y() > 0); }});
    scene.laws = {{.gap = [exact](const Vec2& x, const Vec2&) { return Vec2(exact.gap(x.x()), 0); }}};
    const Solved s = solved(blocks(), {.size = size}, bdms(1), scene);
    double square = 0, whole = 0, force = 0, most = 0;
    for (const CrackPoint& p : crack_profile(s.model, s.state, 0)) {
      const double should = exact.pressure(p.at.x());
      square += p.length * std::pow(p.contact_pressure() - should, 2);
      whole += p.length * should * should;
      force += p.length * p.contact_pressure();
      most = std::max(most, p.contact_pressure());
    }
    off.push_back(std::sqrt(square / whole));
    EXPECT_NEAR(force, pi / 2 * exact.b * exact.largest, 2e-3 * exact.b * exact.largest);
    EXPECT_NEAR(most, exact.largest, 5e-3 * exact.largest);
  }
  EXPECT_LT(off[0], 0.02);
  EXPECT_LT(off[1], 0.01);
}

// A disc pressed into a ring that is too small for it [Lame]: two arcs make the closed interface, the disc is held by
// contact alone.
TEST(Gap, PressFitsADisc) {
  constexpr double radius = 0.6, overlap = 1e-3;
  const Material m = plane_strain(1, 0.3);
  const double kappa = 8 * m.mu / plane_modulus(m) - 1;
  // Of the ring s_r = A (1 - 1/r^2), 2 mu u_r = A ((kappa - 1)/2 r + 1/r); of the disc 2 mu u_r = -p (kappa - 1)/2 r.
  const double per_pressure = radius * radius / (1 - radius * radius),
               ring = per_pressure * ((kappa - 1) / 2 * radius + 1 / radius), disc = (kappa - 1) / 2 * radius,
               pressure = overlap * 2 * m.mu / (ring + disc),
               outside = per_pressure * pressure * ((kappa - 1) / 2 + 1) / (2 * m.mu);
  Shape shape;
  shape.labels = {"rim"};
  shape.outline = circle("rim", {0, 0}, 1, 0);
  for (const double side : {1.0, -1.0}) {
    const double from = side > 0 ? 0 : pi;
    shape.cracks.push_back({side > 0 ? "upper" : "lower",
                            {{side * radius, 0}, {-side * radius, 0}},
                            Arc{Vec2::Zero(), radius * Mat2::Identity(), from, from + pi}});
  }
  Scene scene{.material = m};
  scene.supports = {{0, false, true, true, [=](const Vec2& x, const Vec2&) -> Vec2 { return outside * x; }}};
  const auto normal = [](const Vec2& x) -> Vec2 { return x.normalized(); };
  scene.laws.assign(2, {.normal = normal, .gap = uniform(-overlap)});
  std::vector<double> off;
  for (const double size : {0.1, 0.05}) {
    const Solved s = solved(shape, {.size = size}, bdms(1), scene);
    double square = 0, length = 0;
    for (Index c = 0; c < 2; ++c)
      for (const CrackPoint& p : crack_profile(s.model, s.state, c)) {
        EXPECT_EQ(p.status, CrackPoint::Status::Closed);
        square += p.length * std::pow(p.contact_pressure() / pressure - 1, 2);
        length += p.length;
      }
    off.push_back(std::sqrt(square / length));
  }
  EXPECT_LT(off[0], 0.02);
  EXPECT_LT(off[1], 0.7 * off[0]);
}

// An interference as large as the opening of a crack under a uniform pressure leaves the same stress as that pressure:
// gap and fluid are two loads of one problem.
// Contact takes a gap at a few points of each edge: what lies between them would pass in silence.
TEST(Gap, ThatTheMeshDoesNotFollowIsNamed) {
  const auto bump = [](double width) -> BoundaryField {
    return [width](const Vec2& x, const Vec2&) {
      return Vec2(-0.02 * std::exp(-std::pow((x.x() - 0.017) / width, 2)), 0);
    };
  };
  const BoundaryField parabola = [](const Vec2& x, const Vec2&) { return Vec2(0.1 * x.x() * x.x(), 0); };
  const auto unseen = [](const BoundaryField& gap, double size) {
    const Model m = prepare(triangulate(blocks(), {.size = size}), bdms(1), pressed(plane_strain(1, 0.3), 0.1, gap), 1);
    std::vector<UnseenData> all = unseen_data(m.mesh, m.scene, m.inner->data);
    std::erase_if(all, [](const UnseenData& u) { return u.crack == none; });  // supports, known at sampled points
    return all;
  };
  for (const double width : {0.05, 0.004}) {
    const std::vector<UnseenData> found = unseen(bump(width), 0.5);
    ASSERT_EQ(found.size(), 1u) << width;
    EXPECT_EQ(found[0].crack, 0);
    EXPECT_TRUE(found[0].stops_bounds);
    EXPECT_STREQ(found[0].what, "the gap in a crack");
    EXPECT_NEAR(found[0].at.x(), 0.017, 0.5);
    EXPECT_NEAR(found[0].at.y(), 0, 1e-15);
  }
  EXPECT_TRUE(unseen(bump(0.3), 0.1).empty());
  EXPECT_TRUE(unseen(parabola, 0.5).empty());
  EXPECT_TRUE(unseen(uniform(-0.01), 0.5).empty());
}

/// A plate pressed by 1 far away, with a slit on |x| < 1 that is apart by g and closes over |x| < c: s_yy + i s = Re Z
/// on the line, Z = -((z^2 - c^2)/(z^2 - 1))^1/2. c = 0: it stays open.
struct PressedSlit {
  double c;
  Mat2 stress(const Vec2& x) const {
    const Complex z(x.x(), x.y()), below = std::sqrt(z - 1.0) * std::sqrt(z + 1.0);
    const Complex above = c == 0 ? z : std::sqrt(z - c) * std::sqrt(z + c);
    const Complex Z = -above / below, slope = Z * (z / (z * z - c * c) - z / (z * z - 1.0));
    const double shear = -x.y() * slope.real();
    return (Mat2() << Z.real() - x.y() * slope.imag(), shear, shear, Z.real() + x.y() * slope.imag()).finished();
  }
  /// (4/E') int_c^1 ((x^2 - c^2)/(1 - x^2))^1/2 dx, x^2 = c^2 cos^2 + sin^2.
  double gap(double modulus) const {
    constexpr int n = 200;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double t = (i + 0.5) * pi / 2 / n, s = std::sin(t), x = std::hypot(c * std::cos(t), s);
      sum += (1 - c * c) * s * s / x * pi / 2 / n;
    }
    return 4 / modulus * sum;
  }
};

std::vector<TipIntensity> tips_of_slit(const PressedSlit& exact, const Material& m, BoundaryField gap) {
  Shape shape{.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, bottom),
              .cracks = {{"c", {{-1, 0}, {1, 0}}}},
              .labels = {"outline"}};
  Scene s{.material = m, .laws = {{.gap = std::move(gap)}}};
  s.tractions = {{bottom, [exact](const Vec2& x, const Vec2& n) -> Vec2 { return exact.stress(x) * n; }}};
  const Solved solution = solved(shape, {.size = 0.4, .crack_tip_size = 0.02}, bdms(2), s);
  return crack_tips(solution.model, solution.state);
}

// Faces that a gap keeps apart at the tips are free to come nearer there, whether they meet elsewhere or not.
TEST(Gap, LetsTipsCloseAsFarAsItReaches) {
  const Material m = plane_strain(100, 0.3);
  const double modulus = plane_modulus(m);
  for (const double c : {0.0, 0.3, 0.5, 0.8}) {
    SCOPED_TRACE(c);
    const PressedSlit exact{c};
    const double K = -std::sqrt(pi * (1 - c * c)), gap = c == 0 ? 1 : exact.gap(modulus);
    for (const TipIntensity& tip : tips_of_slit(exact, m, uniform(gap))) {
      EXPECT_NEAR(tip.K_I, K, 4e-3 * std::sqrt(pi));
      EXPECT_NEAR(tip.G, K * K / modulus, 8e-3 * pi / modulus);
      EXPECT_NEAR(tip.K_II, 0, 1e-3);
      EXPECT_NEAR(tip.J, tip.G, 2e-2 * pi / modulus);
    }
  }
}

// Gaps that end at the tips: an ellipse is closed all over at once, by (E'/4) times its half height, and bears what is
// left of the pressure; one that ends in an angle lets nothing of K_I.
TEST(Gap, ThatEndsAtTheTipsBoundsTheClosure) {
  const Material m = plane_strain(100, 0.3);
  const double modulus = plane_modulus(m);
  const auto ellipse = [&](double share) -> BoundaryField {
    return [=](const Vec2& x, const Vec2&) {
      return Vec2(share * 4 / modulus * std::sqrt(std::max(0.0, 1 - x.x() * x.x())), 0);
    };
  };
  const PressedSlit open{0};
  for (const double share : {0.25, 0.6, 1.5})
    for (const TipIntensity& tip : tips_of_slit(open, m, ellipse(share)))
      EXPECT_NEAR(tip.K_I, -std::min(share, 1.0) * std::sqrt(pi), 4e-3 * std::sqrt(pi)) << share;
  const BoundaryField roof = [&](const Vec2& x, const Vec2&) { return Vec2(1 / modulus * (1 - std::abs(x.x())), 0); };
  for (const TipIntensity& tip : tips_of_slit(open, m, roof)) EXPECT_NEAR(tip.K_I, 0, 1e-6);
}

TEST(Gap, InterferenceIsAWedge) {
  const Material m = plane_strain(1, 0.3);
  const Shape shape = square({-0.4, 0}, {0.4, 0});
  Scene scene{.material = m};
  scene.supports = {{bottom, false, true, true, {}}};
  scene.supports[0].value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
  scene.laws = {{.pressure = uniform(0.01)}};
  const Sizing sizing{.size = 0.1};
  const Solved open = solved(shape, sizing, bdms(1), scene);
  // The opening of this mesh, point by point, given back as a gap.
  const std::vector<CrackPoint> profile = crack_profile(open.model, open.state, 0);
  scene.laws = {{.gap = [profile](const Vec2& x, const Vec2&) {
    const CrackPoint* nearest = &profile.front();
    for (const CrackPoint& p : profile)
      if ((p.at - x).norm() < (nearest->at - x).norm()) nearest = &p;
    return Vec2(-nearest->jump_n, 0);
  }}};
  const Solved wedge = solved(shape, sizing, bdms(1), scene);
  for (const CrackPoint& p : crack_profile(wedge.model, wedge.state, 0)) EXPECT_NEAR(p.contact_pressure(), 0.01, 1e-8);
  const std::vector<TipIntensity> a = crack_tips(open.model, open.state), b = crack_tips(wedge.model, wedge.state);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(b[i].G, a[i].G, 0.05 * a[i].G);
    EXPECT_TRUE(std::isnan(energy_bounds(wedge.model, wedge.state).lower));
  }
}

}  // namespace
}  // namespace kerf::gap_test
