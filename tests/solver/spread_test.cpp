// Error bars of the topological derivative of a hole on exact solutions.

#include "solver/spread.hpp"

#include "geometry/mesher.hpp"
#include "tests/exact_more.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kerf {
namespace {

constexpr double pi = std::numbers::pi;

struct Body {
  std::string name;
  exact::ExactField field;
  Shape shape;
  CrackLaw law = {};
  double covered = 0.95, width = 4;  // least share of the points, largest median of half widths over median of errors
};

Body straight(std::string name, exact::ExactField f, double low = -2, double high = 2) {
  Body b{std::move(name), std::move(f), {}};
  b.shape.labels = {"outer", "hole"};
  b.shape.outline = polygon("outline", {{low, low}, {high, low}, {high, high}, {low, high}}, 0);
  for (std::size_t i = 0; i + 1 < b.field.tips.size(); i += 2)
    b.shape.cracks.push_back({std::to_string(i), {b.field.tips[i].at, b.field.tips[i + 1].at}, {}});
  return b;
}
Body table(const std::string& id) {
  return straight(id, exact::table_field(id));
}
Body with_hole(const std::string& id, const exact::ExactField& f, double outer) {
  Body b = straight(id, f);
  if (outer > 0) b.shape.outline = circle("outline", Vec2::Zero(), outer, 0);
  b.shape.holes = {circle("hole", Vec2::Zero(), 0.5, 1)};
  return b;
}
Body friction(const std::string& id) {
  const auto f = exact::friction_table(id);
  Body b = straight(id, f.field);
  b.law.slip_bound = std::abs(f.shear);
  return b;
}
Body l_shape(const std::string& id) {
  Body b = straight(id, exact::more_table_field(id));
  b.shape.outline = polygon("outline", {{0, 0}, {0, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, 0}}, 0);
  return b;
}
Body slit() {
  Body b = straight("c13_slit", exact::more_table_field("c13_slit"), -1, 1);
  b.shape.cracks = {{"slit", {Vec2(-1, 0), Vec2(0, 0)}, {}}};
  b.law.kind = CrackLaw::Kind::Open;
  return b;
}
Body expecting(Body b, double covered, double width) {
  b.covered = covered;
  b.width = width;
  return b;
}

struct Measured {
  double covered, width;
};

// Displacements prescribed around, and on holes.
Measured measure(const Body& b, double size) {
  Scene scene;
  scene.material = b.field.material;
  scene.body = b.field.body;
  scene.laws.assign(b.shape.cracks.size(), b.law);
  for (const Index label : {0, 1})
    if (label == 0 || !b.shape.holes.empty())
      scene.supports.push_back({label, false, true, true, [f = b.field](const Vec2& x, const Vec2&) {
                                  return f.displacement(x, exact::side_of(f, x));
                                }});
  const Mesh mesh = triangulate(b.shape, {.size = size});
  const Corners corners = split_at_cracks(mesh);
  const auto hole = [&](const auto& s) {
    return exact::hole_derivative(b.field.material, (Mat2() << s[0], s[2], s[2], s[1]).finished());
  };
  const auto map = [&](const Element& e) {
    const Model m = prepare(mesh, e, scene, 2);
    const State s = solve(m);
    const RecoveredStress r = recover_stress(m, s, corners, singular_corners(m, s, corners), scene.body);
    PointValues v{Eigen::VectorXd(r.at_corners.cols()), Eigen::VectorXd(r.at_centroids.cols())};
    for (Eigen::Index i = 0; i < v.at_corners.size(); ++i) v.at_corners[i] = hole(r.at_corners.col(i));
    for (Eigen::Index t = 0; t < v.at_centroids.size(); ++t) v.at_centroids[t] = hole(r.at_centroids.col(t));
    return v;
  };
  const Element& e = element("bdms");
  const PointValues values = map(e);
  const PointValues bars = spread(corners, values, map(better_element(e))).half_width;
  std::vector<double> errors, widths;
  double covered = 0;
  const auto add = [&](const Vec2& x, int side, double value, double width) {
    for (const exact::ExactTip& tip : b.field.tips)
      if ((tip.at - x).norm() < 1e-9) return;
    errors.push_back(std::abs(value - exact::hole_derivative(b.field.material, b.field.stress(x, side))));
    widths.push_back(width);
    covered += errors.back() <= width ? 1 : 0;
  };
  std::vector<int> side(corners.vertex.size());
  for (Index t = 0; t < static_cast<Index>(corners.of.size()); ++t) {
    const Vec2 x = centroid(mesh, t);
    const int own = exact::side_of(b.field, x);
    for (const Index i : corners.of[t]) side[i] = own;
    add(x, own, values.at_centroids[t], bars.at_centroids[t]);
  }
  for (std::size_t i = 0; i < side.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    add(mesh.points[corners.vertex[i]], side[i], values.at_corners[at], bars.at_corners[at]);
  }
  const auto median = [](std::vector<double>& v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  return {covered / static_cast<double>(errors.size()), median(widths) / median(errors)};
}

class ErrorBars : public testing::TestWithParam<Body> {};

TEST_P(ErrorBars, CoverNearlyAllPointsAndAreNotMuchWider) {
  for (const double size : {0.2, 0.1}) {
    const Measured m = measure(GetParam(), size);
    EXPECT_GE(m.covered, GetParam().covered) << size;
    EXPECT_LE(m.width, GetParam().width) << size;
  }
}

const Material incompressible = plane_strain(1000, 0.499999);
INSTANTIATE_TEST_SUITE_P(
    Exact, ErrorBars,
    testing::Values(
        table("c01_modeI"), table("c01b_modeI_biaxial"), table("c02_modeII"), table("c03_inclined_open"),
        table("c04_inclined_closed"), table("c05_partial_linear"), table("c05_partial_linear_w"),
        table("c05b_partial_general"), table("c05c_lens"),
        expecting(straight("c06_two_cracks", exact::more_table_field("c06_two_cracks")), 0.95, 4.9),
        friction("c07_tresca"), friction("c07_coulomb"), with_hole("c08_kirsch", exact::table_field("c08_kirsch"), 0),
        with_hole("c09_lame", exact::more_table_field("c09_lame"), 1.5),
        with_hole("c09b_annulus_deviator", exact::more_table_field("c09b_annulus_deviator"), 1.5),
        with_hole("c09c_inclusion", exact::more_table_field("c09c_inclusion"), 1.5),
        straight("wave", exact::wave_field(0.3), 0, 1),
        straight("wave_incompressible", exact::wave_field(0.499999), 0, 1),
        straight("c10_trig", exact::trig_field(0.3), 0, 1),
        straight("c10_trig_incompressible", exact::trig_field(0.499999), 0, 1),
        straight("c10_exp", exact::exp_field(0.3), 0, 1), l_shape("c13_L_modeI"), l_shape("c13_L_modeII"), slit(),
        straight("open_incompressible", exact::line_crack("open", incompressible, {.p0 = 1, .westergaard = true})),
        // Both solutions find the end of the contact equally well.
        expecting(straight("partly_incompressible",
                           exact::line_crack("partly", incompressible, {.p1 = 1, .westergaard = true})),
                  0.93, 4.5)),
    [](const auto& info) { return info.param.name; });

TEST(Spread, VanishesBetweenEqualSolutionsAndInterpolates) {
  const Mesh mesh = triangulate(straight("", exact::wave_field(0.3), 0, 1).shape, {.size = 0.3});
  const Corners c = split_at_cracks(mesh);
  const auto corners = static_cast<Eigen::Index>(c.vertex.size()), triangles = static_cast<Eigen::Index>(c.of.size());
  const PointValues zero{Eigen::VectorXd::Zero(corners), Eigen::VectorXd::Zero(triangles)};
  const PointValues one{Eigen::VectorXd::Constant(corners, -3), Eigen::VectorXd::Constant(triangles, -3)};
  EXPECT_EQ(spread(c, one, one).half_width.at_corners.maxCoeff(), 0);
  const Spread s = spread(c, zero, one);
  EXPECT_NEAR(s.half_width.at_centroids.minCoeff(), 6.3, 1e-12);
  EXPECT_NEAR(s.half_width.at_corners.maxCoeff(), 6.3, 1e-12);
  EXPECT_NEAR(half_width_at(mesh, c, s, 0, centroid(mesh, 0), 3), 6.3, 1e-12);
  EXPECT_NEAR(half_width_at(mesh, c, s, 0, centroid(mesh, 0), 0), 4.8, 1e-12);
}

TEST(Spread, KnowsABetterElementOrSaysThatThereIsNone) {
  EXPECT_EQ(better_element(element("bdms")).degree, 2);
  EXPECT_EQ(better_element(element("bdms", 2)).degree, 3);
  EXPECT_EQ(better_element(element("peers")).degree, 1);
  EXPECT_EQ(better_element(element("p2")).name, "bdms");
  EXPECT_THROW(better_element(element("bdms", 3)), Error);
}

}  // namespace
}  // namespace kerf
