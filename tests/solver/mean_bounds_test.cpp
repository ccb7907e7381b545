// Bounds of means: of stress and strain over discs and along lines, of displacements, of forces at supports, of works.

#include "base/quadrature.hpp"
#include "kerf/bounds.hpp"
#include "solver/data.hpp"
#include "solver/nucleus.hpp"
#include "tests/solver/exact_crack.hpp"
#include "tests/support/exact.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

namespace kerf::mean_bounds_test {
namespace {

constexpr double slope = pi / 6;

template <typename Field>
Mat2 mean_over_disc(const OverDisc& d, const Field& of) {
  const EdgeRule rule = gauss(24);
  Mat2 sum = Mat2::Zero();
  constexpr int sectors = 48;
  for (int k = 0; k < sectors; ++k)
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const double angle = 2 * pi * k / sectors, r = d.radius * rule.s[q];
      const Mat2 here = of(Vec2(d.center + r * Vec2(std::cos(angle), std::sin(angle))));
      sum += 2 * rule.s[q] * rule.w[q] / sectors * here;
    }
  return sum;
}

template <typename Field>
Mat2 mean_along_line(const AlongLine& line, const Field& of) {
  const EdgeRule rule = gauss(24);
  Mat2 sum = Mat2::Zero();
  for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
    const Mat2 here = of(Vec2(line.from + rule.s[q] * (line.to - line.from)));
    sum += rule.w[q] * here;
  }
  return sum;
}

Mat2 frame_of(const AlongLine& line) {
  const Vec2 t = (line.to - line.from).normalized();
  return (Mat2() << t.x(), -t.y(), t.y(), t.x()).finished();
}

// int v(x, n) along a label.
template <typename Value>
double along_label(const Mesh& mesh, Index label, const Value& of) {
  const EdgeRule rule = gauss(24);
  double sum = 0;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    if (mesh.label[e] != label) continue;
    const EdgeLine line = edge_line(mesh, e);
    for (Eigen::Index q = 0; q < rule.s.size(); ++q)
      sum += length(mesh, e) * rule.w[q] * of(Vec2(line.a + rule.s[q] * (line.b - line.a)), line.n);
  }
  return sum;
}

BoundaryField unit(int k) {
  return [k](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Unit(k); };
}

double half_width(const Bounded& b) {
  return 0.5 * (b.upper - b.lower);
}

void expect_contains(const Bounded& b, double exact, const std::string& which) {
  EXPECT_LE(b.lower, exact) << which << " by " << b.lower - exact << " " << b.note;
  EXPECT_GE(b.upper, exact) << which << " by " << exact - b.upper << " " << b.note;
  EXPECT_TRUE(b.guaranteed) << which << " " << b.note;
}

void expect_contains(const StressBounds& b, const Mat2& exact, const std::string& which) {
  expect_contains(b.s11, exact(0, 0), which + " s11");
  expect_contains(b.s22, exact(1, 1), which + " s22");
  expect_contains(b.s12, exact(0, 1), which + " s12");
}

constexpr std::array parts{PointStress::Trace, PointStress::Difference, PointStress::Shear};

// The mean of a quantity has the mean of its fields: outside the disc, and away from the line.
TEST(MeanNuclei, AreMeansOfThoseOfPoints) {
  const Material m = plane_strain(2, 0.3);
  const OverDisc disc{{0.2, -0.1}, 0.5};
  const AlongLine line{{-0.3, 0.1}, {0.4, 0.6}};
  const Mat2 frame = frame_of(line);
  for (const Vec2& at : {Vec2(1.1, 0.3), Vec2(-0.7, -0.8), Vec2(0.1, 0.9)})
    for (const PointStress part : parts) {
      const auto both = [&](const Nucleus& G) {
        Eigen::Matrix<double, 2, 3> all;
        all << G.displacement(at), G.stress(at);
        return all;
      };
      Eigen::Matrix<double, 2, 3> over = both(disc_nucleus(m, disc.center, disc.radius, part)),
                                  along = both(line_nucleus(m, line.from, line.to, part));
      const EdgeRule rule = gauss(24);
      for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
        constexpr int sectors = 96;
        for (int k = 0; k < sectors; ++k) {
          const double angle = 2 * pi * k / sectors, r = disc.radius * rule.s[q];
          over -= 2 * rule.s[q] * rule.w[q] / sectors *
                  both(point_nucleus(m, disc.center + r * Vec2(std::cos(angle), std::sin(angle)), part));
        }
        // In the frame of the line: the body is turned instead.
        const Nucleus turned =
            point_nucleus(m, frame.transpose() * (line.from + rule.s[q] * (line.to - line.from)), part);
        const Vec2 there = frame.transpose() * at;
        along.col(0) -= rule.w[q] * frame * turned.displacement(there);
        along.rightCols<2>() -= rule.w[q] * frame * turned.stress(there) * frame.transpose();
      }
      EXPECT_LT(over.norm(), 1e-11) << static_cast<int>(part);
      EXPECT_LT(along.norm(), 1e-8) << static_cast<int>(part);
    }
}

TEST(MeanNuclei, OfADiscHaveNoGapOnTheCircle) {
  const Material m = plane_strain(2, 0.3);
  for (const PointStress part : parts) {
    const Nucleus G = disc_nucleus(m, {0.2, -0.1}, 0.5, part);
    for (int k = 0; k < 12; ++k) {
      const Vec2 way(std::cos(0.5 * k), std::sin(0.5 * k)), x = Vec2(0.2, -0.1) + 0.5 * way;
      EXPECT_LT((G.displacement(x - 1e-9 * way) - G.displacement(x + 1e-9 * way)).norm(), 1e-7);
    }
  }
}

TEST(MeanBounds, ContainMeansOverDiscsAndLines) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  const OverDisc disc{{0.2, 1.0}, 0.4};
  const AlongLine line{{-0.5, 0.9}, {0.6, 1.3}};
  const auto stress = [&](const Vec2& x) { return f.stress(x, exact::side_of(f, x)); };
  const Mat2 over = mean_over_disc(disc, stress), Q = frame_of(line),
             along = Q.transpose() * mean_along_line(line, stress) * Q;
  // The mean is not the value in the middle: what tells them apart is seen.
  EXPECT_GT((over - stress(disc.center)).norm(), 0.02);
  for (const std::vector<Index>& held : {std::vector<Index>{}, std::vector<Index>{0}})
    for (const int degree : {1, 2}) {
      std::vector<double> width;
      for (const int n : {8, 16}) {
        const CrackProblem p = crack_problem(f, n, degree, held);
        const QuantityBounds bounds(p.model, p.state);
        const std::string which = fmt::format("held {} degree {} n {}", held.size(), degree, n);
        const StressBounds s = bounds.mean_stress(disc);
        expect_contains(s, over, which + " disc");
        expect_contains(bounds.mean_stress(line), along, which + " line");
        const StrainBounds e = strain_bounds(f.material, s);
        const double shape = 0.5 / f.material.mu, volume = f.material.c * over.trace();
        expect_contains(e.e11, volume + 0.5 * shape * (over(0, 0) - over(1, 1)), which + " e11");
        expect_contains(e.e22, volume - 0.5 * shape * (over(0, 0) - over(1, 1)), which + " e22");
        expect_contains(e.e12, shape * over(0, 1), which + " e12");
        width.push_back(half_width(s.s22));
      }
      EXPECT_LT(width[1], 0.6 * width[0]);  // of the order of the mesh size: the tips are not resolved
    }
}

// The field of a smooth state with its body force in the unit square, label 0 held: the nucleus is cut off.
CrackProblem smooth(const exact::ExactField& f, int n, int degree) {
  Scene s;
  s.material = f.material;
  s.body = [f](const Vec2& x) -> Vec2 { return f.body(x); };
  s.supports.push_back(
      {0, false, true, true, [f](const Vec2& x, const Vec2&) -> Vec2 { return f.displacement(x, 0); }});
  for (Index label = 1; label < 4; ++label)
    s.tractions.push_back({label, [f](const Vec2& x, const Vec2& n) -> Vec2 { return f.stress(x, 0) * n; }});
  CrackProblem p{f, prepare(exact::unit_square_mesh(n, 0.1), element("bdms", degree), s, 1), {}};
  p.state = solve(p.model);
  return p;
}

TEST(MeanBounds, ContainMeansUnderBodyForces) {
  const OverDisc disc{{0.52, 0.47}, 0.2};
  const AlongLine line{{0.4, 0.6}, {0.65, 0.5}};
  for (const exact::ExactField& f : {exact::wave_field(0.2)}) {
    const auto stress = [&](const Vec2& x) { return f.stress(x, 0); };
    const Mat2 over = mean_over_disc(disc, stress), Q = frame_of(line),
               along = Q.transpose() * mean_along_line(line, stress) * Q;
    std::vector<double> width;
    for (const int n : {12, 18}) {
      const CrackProblem p = smooth(f, n, 2);
      const QuantityBounds bounds(p.model, p.state);
      const StressBounds s = bounds.mean_stress(disc), t = bounds.mean_stress(line);
      expect_contains(s, over, fmt::format("{} n {} disc", f.name, n));
      expect_contains(t, along, fmt::format("{} n {} line", f.name, n));
      width.push_back(half_width(s.s11));
      width.push_back(half_width(t.s22));
      for (const int k : {0, 1}) {
        const double top = along_label(p.model.mesh, 2,
                                       [&](const Vec2&x, const Vec2&) { return f.displacement(x, 0)[k]; }),
                     force = along_label(p.model.mesh, 0,
                                         [&](const Vec2&x, const Vec2&out) { return f.stress(x, 0).row(k).dot(out); });
        expect_contains(bounds.work({{2, unit(k)}}), top, "top");
        expect_contains(bounds.reaction({0}, k), force, "force");
      }
    }
    EXPECT_LT(width[2], 0.2 * width[0]);
    EXPECT_LT(width[3], 0.2 * width[1]);
  }
}

// A small disc and a short line say what the point says; a large one does not.
TEST(MeanBounds, TendToThoseOfThePoint) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  const CrackProblem p = crack_problem(f, 16, 2, {0});
  const QuantityBounds bounds(p.model, p.state);
  const Vec2 x(0.2, 1.0);
  const StressBounds point = bounds.stress(x), disc = bounds.mean_stress(OverDisc{x, 1e-4}),
                     line = bounds.mean_stress(AlongLine{x - Vec2(1e-4, 0), x + Vec2(1e-4, 0)});
  const auto expect_same = [](const Bounded& a, const Bounded& b) {
    EXPECT_NEAR(a.lower, b.lower, 1e-6);
    EXPECT_NEAR(a.upper, b.upper, 1e-6);
  };
  for (const StressBounds* s : {&disc, &line}) {
    expect_same(s->s11, point.s11);
    expect_same(s->s22, point.s22);
    expect_same(s->s12, point.s12);
  }
  // Without the second potential of the disc its field is that of the point, and the interval misses the mean.
  const OverDisc wide{x, 0.5};
  const Mat2 mean = mean_over_disc(wide, [&](const Vec2& y) { return f.stress(y, exact::side_of(f, y)); });
  EXPECT_TRUE(point.s11.upper < mean(0, 0) || point.s11.lower > mean(0, 0));
  EXPECT_TRUE(point.s22.upper < mean(1, 1) || point.s22.lower > mean(1, 1));
  expect_contains(bounds.mean_stress(wide), mean, "wide");
}

Vec2 exact_displacement(const exact::ExactField& f, const Vec2& x) {
  return f.displacement(x, exact::side_of(f, x));
}
Mat2 exact_stress(const exact::ExactField& f, const Vec2& x) {
  return f.stress(x, exact::side_of(f, x));
}

// On loaded and on held labels, of open cracks and of cracks in contact.
TEST(MeanBounds, ContainDisplacementsForcesAndWorks) {
  for (const auto& [id, kind] : {std::pair("c03_inclined_open", CrackLaw::Kind::Open),
                                 std::pair("c05_partial_linear", CrackLaw::Kind::Unilateral)}) {
    const exact::ExactField f = exact::table_field(id, 0.3);
    std::vector<double> width;
    for (const int n : {8, 16}) {
      const CrackProblem p = crack_problem(f, n, 1, {0}, kind);
      const QuantityBounds bounds(p.model, p.state);
      const std::string which = fmt::format("{} n {}", id, n);
      double work = 0;
      for (Index label = 1; label < 4; ++label)
        work += along_label(p.model.mesh, label, [&](const Vec2& x, const Vec2& out) {
          return exact_displacement(f, x).dot(exact_stress(f, x) * out);
        });
      for (const int k : {0, 1}) {
        const auto displacement = [&](const Vec2& x, const Vec2&) { return exact_displacement(f, x)[k]; };
        const auto force = [&](const Vec2& x, const Vec2& out) { return exact_stress(f, x).row(k).dot(out); };
        expect_contains(bounds.work({{2, unit(k)}}), along_label(p.model.mesh, 2, displacement), which + " top");
        const Bounded held = bounds.work({{0, unit(k)}});
        const double exact = along_label(p.model.mesh, 0, displacement);
        EXPECT_NEAR(held.value, exact, 1e-9);
        EXPECT_LT(half_width(held), 1e-9);
        const Bounded reaction = bounds.reaction({0}, k);
        expect_contains(reaction, along_label(p.model.mesh, 0, force), which + " reaction");
      }
      const Bounded all = bounds.work_of_loads();
      expect_contains(all, work, which + " all loads");
      width.push_back(half_width(all));
    }
    EXPECT_LT(width[1], 0.65 * width[0]);
  }
}

// The force of the only support balances the loads: it is known, whatever the mesh.
TEST(MeanBounds, AForceThatStaticsTellIsSharp) {
  const CrackProblem p = crack_problem(exact::table_field("c03_inclined_open", 0.3), 8, 1, {});
  Scene s = p.model.scene;
  s.tractions = {{2, unit(1)}};
  s.supports.push_back({0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  const Model m = prepare(p.model.mesh, element("bdms"), s, 1);
  const State state = solve(m);
  const Bounded force = QuantityBounds(m, state).reaction({0}, 1);
  expect_contains(force, -4, "vertical");
  EXPECT_LT(half_width(force), 1e-10);
}

// Two supports share the load as stiffnesses tell: that is bounded.
TEST(MeanBounds, ContainForcesThatStaticsDoNotTell) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  for (const int k : {0, 1}) {
    std::vector<double> width;
    for (const int n : {8, 16}) {
      const CrackProblem p = crack_problem(f, n, 2, {0, 2});
      const Bounded b = QuantityBounds(p.model, p.state).reaction({0}, k);
      const auto force = [&](const Vec2& x, const Vec2& out) { return exact_stress(f, x).row(k).dot(out); };
      expect_contains(b, along_label(p.model.mesh, 0, force), fmt::format("n {} component {}", n, k));
      width.push_back(half_width(b));
    }
    EXPECT_GT(width[1], 1e-6);
    EXPECT_LT(width[1], 0.6 * width[0]);
  }
}

// Clamped all around under a body force: the compliance is minus twice the energy.
TEST(MeanBounds, ContainTheComplianceOfABodyAtRest) {
  const exact::ExactField f = exact::trig_field(0.3);
  Scene s;
  s.material = f.material;
  s.body = [f](const Vec2& x) -> Vec2 { return f.body(x); };
  for (Index label = 0; label < 4; ++label)
    s.supports.push_back({label, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  const Model m = prepare(exact::unit_square_mesh(16), element("bdms", 2), s, 1);
  const State state = solve(m);
  const EdgeRule rule = gauss(32);
  double work = 0;
  for (Eigen::Index i = 0; i < rule.s.size(); ++i)
    for (Eigen::Index j = 0; j < rule.s.size(); ++j) {
      const Vec2 x(rule.s[i], rule.s[j]);
      work += rule.w[i] * rule.w[j] * f.body(x).dot(f.displacement(x, 0));
    }
  const Bounded b = QuantityBounds(m, state).work_of_loads();
  expect_contains(b, work, "all loads");
  EXPECT_LT(half_width(b), 0.01 * work);
}

// A body that grows freely by an eigenstrain has u = e x and no stress.
TEST(MeanBounds, KnowTheGrowthOfAFreeBody) {
  Scene s;
  s.material = plane_strain(2, 0.3);
  s.eigenstrain.resize(1);
  s.eigenstrain[0].normal = linear_field([](const Vec2&) -> Vec2 { return {0.25, -0.125}; });
  s.eigenstrain[0].shear = linear_field([](const Vec2&) -> Vec2 { return Vec2::Zero(); });
  s.supports.push_back({0, true, true, false, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  s.supports.push_back({3, true, true, false, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  const Model m = prepare(exact::unit_square_mesh(4, 0.1), element("bdms"), s, 1);
  const State state = solve(m);
  const QuantityBounds bounds(m, state);
  expect_contains(bounds.work({{1, unit(0)}}), 0.25, "right");
  expect_contains(bounds.work({{2, unit(1)}}), -0.125, "top");
  const Bounded left = bounds.reaction({3}, 0);  // its neighbour holds the other direction
  EXPECT_NEAR(left.value, 0, 1e-13);
  EXPECT_LT(half_width(left), 1e-13);
  EXPECT_TRUE(left.guaranteed) << left.note;
  expect_contains(bounds.work_of_loads(), 0, "no loads");
  static constexpr double pull = 0.5;
  s.tractions.push_back({1, [](const Vec2&, const Vec2&) -> Vec2 { return {pull, 0}; }});
  const Model pulled = prepare(exact::unit_square_mesh(4, 0.1), element("bdms"), s, 1);
  const State longer = solve(pulled);
  const Bounded work = QuantityBounds(pulled, longer).work_of_loads();
  EXPECT_NEAR(work.value, pull * (0.25 + pull * (s.material.c + 0.25 / s.material.mu)), 1e-9);
  EXPECT_LT(half_width(work), 1e-6);
  EXPECT_LT(half_width(bounds.work({{1, unit(0)}})), 1e-6);
  EXPECT_EQ(bounds.mean_stress(OverDisc{{0.5, 0.5}, 0.1}).s11.note, "no bounds: there is an eigenstrain");
}

TEST(MeanBounds, ContainMeansBesideACrackInContact) {
  const exact::ExactField f = exact::table_field("c05_partial_linear", 0.3);
  const CrackProblem p = crack_problem(f, 16, 1, {0}, CrackLaw::Kind::Unilateral);
  const QuantityBounds bounds(p.model, p.state);
  const OverDisc disc{{0.2, 1.1}, 0.4};
  const AlongLine line{{-0.4, 1.0}, {0.6, 1.2}};
  const auto stress = [&](const Vec2& x) { return exact_stress(f, x); };
  expect_contains(bounds.mean_stress(disc), mean_over_disc(disc, stress), "disc");
  const Mat2 Q = frame_of(line);
  expect_contains(bounds.mean_stress(line), Q.transpose() * mean_along_line(line, stress) * Q, "line");
}

TEST(MeanBounds, SayWhyThereAreNone) {
  const exact::ExactField f = exact::table_field("c03_inclined_open", 0.3);
  const CrackProblem p = crack_problem(f, 8, 1, {0, 1});
  const QuantityBounds bounds(p.model, p.state);
  const auto expect_none = [](const Bounded& b, const std::string& why) {
    EXPECT_TRUE(std::isnan(b.lower) && !b.guaranteed);
    EXPECT_NE(b.note.find(why), std::string::npos) << b.note;
  };
  expect_none(bounds.mean_stress(OverDisc{{9, 9}, 1}).s11, "its middle lies outside the body");
  expect_none(bounds.mean_stress(OverDisc{{0, 1.2}, 1}).s11, "it touches the boundary, a crack or another material");
  expect_none(bounds.mean_stress(AlongLine{{0.3, -0.9}, {0.3, 0.9}}).s11, "it touches the boundary, a crack");
  expect_none(bounds.mean_stress(AlongLine{{-2, 1}, {2, 1}}).s11, "it touches the boundary, a crack");
  // Labels 0 and 1 hold the same corner; neither holds 2.
  expect_none(bounds.reaction({0}, 0), "it meets another support that holds the same direction");
  expect_none(bounds.reaction({2}, 1), "no support holds it");
  EXPECT_TRUE(bounds.reaction({0, 1}, 0).guaranteed);
  const CrackProblem floating = crack_problem(f, 8, 1, {});
  expect_none(QuantityBounds(floating.model, floating.state).work({{2, unit(1)}}), "nothing holds the body");
  EXPECT_THROW(bounds.mean_stress(OverDisc{{0.2, 1}, -1}), std::invalid_argument);
}

}  // namespace
}  // namespace kerf::mean_bounds_test
