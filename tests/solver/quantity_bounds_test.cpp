// Bounds of K, G and stresses contain those of exact fields of a straight crack, with regions, body forces, pressure
// and without change of volume.

#include "kerf/bounds.hpp"

#include "kerf/fracture.hpp"
#include "tests/solver/exact_crack.hpp"
#include "tests/support/exact.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

namespace kerf::quantity_bounds_test {
namespace {

constexpr double slope = pi / 6;

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
        const CrackProblem p = crack_problem(f, n, degree, held);
        const QuantityBounds bounds(p.model, p.state);
        for (const TipIntensity& tip : crack_tips(p.model, p.state)) {
          const std::string which =
              fmt::format("held {} degree {} n {} start {}", held.size(), degree, n, tip.at_start);
          const TipBounds b = bounds.tip(tip);
          const Bounded &one = b.K_I, &two = b.K_II, &g = b.G;
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
        const CrackProblem p = crack_problem(f, n, degree, held);
        const QuantityBounds bounds(p.model, p.state);
        for (const Vec2& x : {Vec2(0.3, 0.9), Vec2(-1.2, -0.3), Vec2(0.1, -0.4)}) {
          const auto s = bounds.stress(x);
          const Mat2 exact = f.stress(x, exact::side_of(f, x));
          const std::string which =
              fmt::format("held {} degree {} n {} at {} {}", held.size(), degree, n, x.x(), x.y());
          expect_contains(s.s11, exact(0, 0), which);
          expect_contains(s.s22, exact(1, 1), which);
          expect_contains(s.s12, exact(0, 1), which);
          for (const Bounded& b : {s.s11, s.s22, s.s12}) EXPECT_TRUE(b.guaranteed) << which << b.note;
          for (const bool plane_strain : {true, false}) {
            const Bounded v = von_mises_bounds(f.material, plane_strain, s);
            const double s33 = plane_strain ? 0.3 * exact.trace() : 0;
            const Mat2 square = exact * exact;
            const double mean = (exact.trace() + s33) / 3;
            expect_contains(v, std::sqrt(1.5 * (square.trace() + s33 * s33 - 3 * mean * mean)), which + " von Mises");
            EXPECT_TRUE(v.guaranteed);
            EXPECT_LT(v.upper - v.lower, 4 * (s.trace.upper - s.trace.lower + s.s12.upper - s.s12.lower));
          }
        }
      }
}

// A polynomial state with a body force that leaves the faces of the crack free: s = P t t', t along the crack, P = x^2
// + q y^2 there, compatible for one q.
struct Polynomial {
  Material m;
  Mat2 frame;

  double share() const {
    return 1 / (4 * m.mu) - m.c;
  }
  double ratio() const {
    return share() * plane_modulus(m);
  }
  Vec2 displacement(const Vec2& at) const {
    const Vec2 x = frame.transpose() * at;
    return frame * Vec2((std::pow(x.x(), 3) / 3 + ratio() * x.x() * x.y() * x.y()) / plane_modulus(m),
                        -share() * (x.x() * x.x() * x.y() + ratio() * std::pow(x.y(), 3) / 3));
  }
  Mat2 stress(const Vec2& at) const {
    const Vec2 x = frame.transpose() * at, t = frame.col(0);
    return (x.x() * x.x() + ratio() * x.y() * x.y()) * t * t.transpose();
  }
  Vec2 force(const Vec2& at) const {
    return -2 * frame.col(0).dot(at) * frame.col(0);
  }
};

// The crack of `problem` under the exact tractions of both fields and under a pressure inside, with a region of the
// same material: the singular field is cut off about each point.
CrackProblem local_problem(const exact::ExactField& f, const Polynomial& more, double pressure, int n, int degree) {
  Mesh mesh = exact::crack_mesh(n, slope, 0.2);
  mesh.region.assign(mesh.triangles.size(), none);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (centroid(mesh, static_cast<Index>(t)).y() > 1.6) mesh.region[t] = 0;
  Scene s;
  s.material = f.material;
  s.regions = {f.material};
  s.body = linear_field([more](const Vec2& x) { return more.force(x); });
  s.supports.push_back({0, false, true, true, [f, more, pressure](const Vec2& x, const Vec2&) -> Vec2 {
                          return f.displacement(x, exact::side_of(f, x)) + more.displacement(x) -
                                 2 * pressure * f.material.c * x;
                        }});
  for (Index label = 1; label < 4; ++label)
    s.tractions.push_back({label, [f, more, pressure](const Vec2& x, const Vec2& n) -> Vec2 {
                             const Mat2 all = f.stress(x, exact::side_of(f, x)) + more.stress(x);
                             return all * n - pressure * n;
                           }});
  s.laws.push_back({.kind = CrackLaw::Kind::Open, .pressure = [pressure](const Vec2&, const Vec2&) -> Vec2 {
                      return {pressure, 0};
                    }});
  CrackProblem p{f, prepare(std::move(mesh), element("bdms", degree), s, 1), {}};
  p.state = solve(p.model);
  return p;
}

TEST(QuantityBounds, ContainWithRegionsBodyForceAndPressure) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  const double normal = 0.5 * std::pow(std::sin(slope), 2) + std::pow(std::cos(slope), 2),
               shear = 0.5 * std::sin(slope) * std::cos(slope), k1 = normal * std::sqrt(pi), k2 = shear * std::sqrt(pi);
  const Polynomial more{f.material,
                        (Mat2() << std::cos(slope), -std::sin(slope), std::sin(slope), std::cos(slope)).finished()};
  constexpr double pressure = 0.5;
  for (const int degree : {1, 2}) {
    std::vector<double> width;
    for (const int n : {16, 32}) {
      const CrackProblem p = local_problem(f, more, pressure, n, degree);
      const QuantityBounds bounds(p.model, p.state);
      const std::string which = fmt::format("degree {} n {}", degree, n);
      const TipBounds b = bounds.tip({.crack = 0});
      expect_contains(b.K_I, k1, which + " K_I");
      expect_contains(b.K_II, k2, which + " K_II");
      if (n == 32) {
        EXPECT_TRUE(b.K_I.guaranteed) << which << " " << b.K_I.note;
      }
      width.push_back(half_width(b.K_I) / k1);
      const Vec2 x(0.1, 0.9);
      const StressBounds at = bounds.stress(x);
      const Mat2 exact = f.stress(x, exact::side_of(f, x)) + more.stress(x) - pressure * Mat2::Identity();
      expect_contains(at.s11, exact(0, 0), which);
      expect_contains(at.s22, exact(1, 1), which);
      expect_contains(at.s12, exact(0, 1), which);
      if (n == 32) {
        EXPECT_TRUE(at.s11.guaranteed) << which << " " << at.s11.note;
      }
      width.push_back(half_width(at.s11));
    }
    EXPECT_LT(width[2], 0.6 * width[0]);
    EXPECT_LT(width[3], 0.6 * width[1]);
  }
}

// Where nothing changes its volume the singular fields are cut off with a source that fades [theory: B.28].
TEST(QuantityBounds, ContainWithoutChangeOfVolume) {
  const Material rubber{1, 0};
  const exact::ExactField f =
      exact::line_crack("rubber", rubber, exact::under((Mat2() << 0.5, 0, 0, 1).finished(), slope));
  const double k1 = (0.5 * std::pow(std::sin(slope), 2) + std::pow(std::cos(slope), 2)) * std::sqrt(pi);
  const Polynomial more{rubber,
                        (Mat2() << std::cos(slope), -std::sin(slope), std::sin(slope), std::cos(slope)).finished()};
  constexpr double pressure = 0.5;
  std::vector<double> width;
  for (const auto& [degree, n] : {std::pair(1, 16), std::pair(1, 32), std::pair(2, 16)}) {
    const CrackProblem p = local_problem(f, more, pressure, n, degree);
    const QuantityBounds bounds(p.model, p.state);
    const std::string which = fmt::format("degree {} n {}", degree, n);
    const Bounded one = bounds.tip({.crack = 0}).K_I;
    expect_contains(one, k1, which + " K_I");
    const Vec2 x(0.1, 0.9);
    const StressBounds at = bounds.stress(x);
    const Mat2 exact = f.stress(x, exact::side_of(f, x)) + more.stress(x) - pressure * Mat2::Identity();
    expect_contains(at.trace, exact.trace(), which + " trace");
    expect_contains(at.difference, 0.5 * (exact(1, 1) - exact(0, 0)), which + " difference");
    expect_contains(at.s12, exact(0, 1), which + " shear");
    for (const Bounded& of : {one, at.trace, at.s12}) {
      width.push_back(half_width(of));
      EXPECT_TRUE(of.guaranteed || n == 16) << which << " " << of.note;
    }
  }
  for (int i = 0; i < 3; ++i) EXPECT_LT(width[3 + i], 0.6 * width[i]) << i;
}

TEST(QuantityBounds, SayWhyThereAreNone) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  CrackProblem p = crack_problem(f, 8, 1, {0});
  Scene contact = p.model.scene;
  contact.laws[0].kind = CrackLaw::Kind::Unilateral;
  const Model m = prepare(p.model.mesh, element("bdms", 1), contact, 1);
  const State s = solve(m);
  EXPECT_EQ(QuantityBounds(m, s).tip({.crack = 0}).K_I.note, "no bounds: a crack may be in contact");
  const QuantityBounds bounds(p.model, p.state);
  const Bounded outside = bounds.stress({9, 9}).s11;
  EXPECT_EQ(outside.note, "no bounds: the point lies outside the body");
  EXPECT_TRUE(std::isnan(outside.lower) && !outside.guaranteed);
  // Beside the crack, nearer than half an edge: the sampled tractions are not proof enough.
  const Bounded near = bounds.stress({0.05 * std::sin(slope), -0.05 * std::cos(slope)}).s12;
  EXPECT_FALSE(near.guaranteed);
  EXPECT_FALSE(near.note.empty());
  contact.laws[0].kind = CrackLaw::Kind::Bonded;
  const Model bonded = prepare(p.model.mesh, element("bdms", 1), contact, 1);
  const State whole = solve(bonded);
  EXPECT_EQ(QuantityBounds(bonded, whole).tip({.crack = 0}).K_I.note, "no bounds: the crack is bonded");
}

}  // namespace
}  // namespace kerf::quantity_bounds_test
