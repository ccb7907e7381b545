// Bodies of several materials.
#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"
#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "solver/saddle_point.hpp"
#include "solver/system.hpp"
#include "tests/solver/scenes.hpp"
#include "tests/support/exact_families.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::region_test {
namespace {

/// The unit square, region 0 above the middle.
Mesh layers() {
  Mesh m = exact::unit_square_mesh(4);
  for (Index t = 0; t < static_cast<Index>(m.triangles.size()); ++t)
    m.region.push_back(centroid(m, t).y() > 0.5 ? 0 : none);
  return m;
}

double largest_stress_error(const Model& m, const State& s, const std::function<Eigen::Vector4d(Index)>& stress) {
  double worst = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Eigen::Matrix4Xd found = evaluate(m, s, t, rule_points(m.inner->kernel.rule, triangle(m, t))).stress;
    worst = std::max(worst, (found.colwise() - stress(region_of(m.mesh, t))).cwiseAbs().maxCoeff());
  }
  return worst;
}

BoundaryField constant(double x, double y) {
  return [x, y](const Vec2&, const Vec2&) { return Vec2(x, y); };
}

/// s_yy = 1, no strain across.
Scene pressed(const Material& below, const Material& above) {
  Scene s{.material = below, .regions = {above}};
  s.supports = {{0, false, false, true, constant(0, 0)},
                {1, false, true, false, constant(0, 0)},
                {3, false, true, false, constant(0, 0)}};
  s.tractions = {{2, constant(0, 1)}};
  return s;
}
/// s_xx with e_xx = 0: (1/(4 mu) + c) s_xx = (1/(4 mu) - c) s_yy.
Eigen::Vector4d pressed_stress(const Material& m) {
  return {(1 / (4 * m.mu) - m.c) / (1 / (4 * m.mu) + m.c), 0, 0, 1};
}

/// s_xy = 1; the rotation is 1/(2 mu).
Scene sheared(const Material& below, const Material& above) {
  Scene s{.material = below, .regions = {above}};
  s.supports = {{0, false, true, true, constant(0, 0)}};
  s.tractions = {{1, constant(0, 1)}, {2, constant(1, 0)}, {3, constant(0, -1)}};
  return s;
}

constexpr Material steel = plane_strain(200, 0.3), rubber = plane_strain(1, 0.4999), ideal = plane_strain(3, 0.5);

class Layers : public testing::TestWithParam<const char*> {};

TEST_P(Layers, PassThePatchTest) {
  const Element& e = element(GetParam());
  for (const auto& [below, above] : {std::pair(steel, plane_strain(2, 0.1)), std::pair(rubber, steel),
                                     std::pair(steel, rubber), std::pair(ideal, steel), std::pair(steel, ideal)}) {
    if (!is_mixed(e) && !(below.c > 0 && above.c > 0)) continue;
    const auto stress = [&, b = below, a = above](Index region) { return pressed_stress(region == none ? b : a); };
    const Model m = prepare(layers(), e, pressed(below, above), 1);
    const State s = solve(m);
    EXPECT_TRUE(certified(s));
    const double lost = is_mixed(e) ? 1e-9 : 1e-8;  // contrast 200, poisson up to 0.5
    EXPECT_LT(largest_stress_error(m, s, stress), lost);
    const auto half = [](const Material& x) {  // of the strain energy of a layer of height 1/2
      const Eigen::Vector4d v = pressed_stress(x);
      return 0.25 * (std::pow(v[0] - v[3], 2) / (4 * x.mu) + x.c * std::pow(v[0] + v[3], 2));
    };
    EXPECT_NEAR(strain_energy(m, s), half(below) + half(above), lost * (half(below) + half(above)));

    const Model shear = prepare(layers(), e, sheared(below, above), 1);
    const State t = solve(shear);
    EXPECT_LT(largest_stress_error(shear, t, [](Index) { return Eigen::Vector4d(0, 1, 1, 0); }), lost);
    if (!is_mixed(e)) continue;
    EXPECT_LT(error_indicator(shear, t).relative, 1e-9);
    for (Index k = 0; k < static_cast<Index>(shear.mesh.triangles.size()); ++k) {
      const double mu = material_of(shear.mesh, shear.scene, k).mu;
      EXPECT_NEAR(evaluate(shear, t, k, Points(centroid(shear.mesh, k))).rotation[0], 1 / (2 * mu), 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Layers,
                         testing::Values("bdms", "bdms-c", "afw", "peers", "arnold-winther", "arnold-winther-nc", "p1",
                                         "p2"),
                         [](const auto& info) {
                           std::string name(info.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(Regions, RefuseWhatTheElementCannotDo) {
  EXPECT_THROW(prepare(layers(), element("arnold-winther-c"), sheared(steel, rubber), 1), Error);
  EXPECT_THROW(prepare(layers(), element("p2"), sheared(steel, ideal), 1), Error);
  Scene none_given = sheared(steel, rubber);
  none_given.regions.clear();
  EXPECT_THROW(prepare(layers(), element("bdms"), none_given, 1), std::invalid_argument);
}

TEST(Regions, EnclosedIncompressibleRegionInACompressibleBodyHasALevelOfPressure) {
  Scene s{.material = steel, .regions = {ideal}};
  for (Index label = 0; label < 4; ++label)
    s.supports.push_back({label, false, true, true, [](const Vec2& x, const Vec2&) { return Vec2(0.1 * x); }});
  const Model m = prepare(layers(), element("bdms"), s, 1);
  EXPECT_FALSE(has_free_pressure(m.mesh, m.scene, m.inner->skeleton));
  const State found = solve(m),
              reference = solve_saddle_point(prepare(layers(), element("bdms"), s, 1, {.factorize = false}));
  EXPECT_TRUE(certified(found));
  EXPECT_LT((found.interior - reference.interior).cwiseAbs().maxCoeff(),
            1e-8 * reference.interior.cwiseAbs().maxCoeff());
}

/// [-1, 1]^2 cut out of a disc of radius 2 with a bonded inclusion of radius 1/2.
struct Inclusion {
  exact::TwoPhases exact;
  Scene scene;
  Mesh mesh(double size) const {
    const Shape shape{
        polygon("outline", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, 0), {}, {}, {"all"}, {circle("r", {0, 0}, 0.5, none)}};
    Mesh m = triangulate(shape, {.size = size});
    for (Index e = 0; e < static_cast<Index>(m.edges.size()); ++e)  // left side held, tractions elsewhere
      if (m.label[e] == 0 && m.points[m.edges[e][0]].x() == -1 && m.points[m.edges[e][1]].x() == -1) m.label[e] = 3;
    return m;
  }
  double error(const Model& m, const State& s) const {
    const TriangleRule rule = triangle_rule(8);
    double sum = 0, size = 0;
    for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
      const exact::ExactField& f = region_of(m.mesh, t) == none ? exact.outside : exact.inside;
      const Points x = rule_points(rule, triangle(m, t));
      const Fields found = evaluate(m, s, t, x);
      for (Eigen::Index q = 0; q < x.cols(); ++q) {
        const double w = area(m.mesh, t) * rule.w[q];
        sum += w * (tensor(found.stress.col(q)) - f.stress(x.col(q), 0)).squaredNorm();
        size += w * f.stress(x.col(q), 0).squaredNorm();
      }
    }
    return std::sqrt(sum / size);
  }
};

Inclusion inclusion(const Material& matrix, const Material& inside) {
  const exact::Annulus disc{.stress = (Mat2() << 1, 0.3, 0.3, -0.4).finished(), .inner = 0.5, .outer = 2};
  Inclusion i{exact::inclusion("two", matrix, inside, disc), {.material = matrix, .regions = {inside}}};
  const exact::ExactField f = i.exact.outside;
  i.scene.tractions = {{0, [f](const Vec2& x, const Vec2& n) { return Vec2(f.stress(x, 0) * n); }}};
  i.scene.supports = {{3, false, true, true, [f](const Vec2& x, const Vec2&) { return f.displacement(x, 0); }}};
  return i;
}

struct Contrast {
  const char* name;
  Material matrix, inside;
};
void PrintTo(const Contrast& c, std::ostream* out) {
  *out << c.name;
}
class Inclusions : public testing::TestWithParam<Contrast> {};

TEST_P(Inclusions, StressConvergesAndIsEstimatedAndBounded) {
  const Inclusion i = inclusion(GetParam().matrix, GetParam().inside);
  std::vector<double> errors;
  for (const double size : {0.1, 0.05, 0.025}) {
    const Model m = prepare(i.mesh(size), element("bdms"), i.scene, 1);
    const State s = solve(m);
    EXPECT_TRUE(certified(s));
    errors.push_back(i.error(m, s));
    const double estimated = error_indicator(m, s).relative;
    EXPECT_GT(estimated, errors.back() / 1.3);
    EXPECT_LT(estimated, errors.back() * 1.3);
  }
  // The polygon through the rim costs half an order: its chords leave a layer of h^2 on the wrong side.
  EXPECT_GT(std::log2(errors[0] / errors[2]) / 2, 1.45);

  const Mesh coarse = i.mesh(0.2);
  const Model m = prepare(coarse, element("bdms"), i.scene, 1),
              n = prepare(refine(coarse), element("bdms"), i.scene, 1);
  const EnergyBounds wide = energy_bounds(m, solve(m)), narrow = energy_bounds(n, solve(n));
  EXPECT_LE(wide.lower, narrow.lower) << wide.note;
  EXPECT_LE(narrow.lower, narrow.upper);
  EXPECT_LE(narrow.upper, wide.upper);
  EXPECT_LT(wide.upper - wide.lower, 0.01 * std::abs(wide.lower));  // whatever the contrast
}

INSTANTIATE_TEST_SUITE_P(
    All, Inclusions,
    testing::Values(Contrast{"stiff", plane_strain(1, 0.3), plane_strain(10, 0.2)},
                    Contrast{"soft", plane_strain(1, 0.3), plane_strain(0.1, 0.2)},
                    Contrast{"very_stiff", plane_strain(1, 0.3), plane_strain(1e4, 0.2)},
                    Contrast{"incompressible_inside", plane_strain(1, 0.3), plane_strain(1, 0.5)},
                    Contrast{"incompressible_outside", plane_strain(1, 0.5), plane_strain(10, 0.3)},
                    Contrast{"soft_incompressible_inside", plane_strain(1e4, 0.3), plane_strain(1, 0.5)}),
    [](const auto& info) { return std::string(info.param.name); });

/// u = (0, u_y(y)) with s_yy = cos(3 y) in both layers.
TEST(Regions, FlatInterfacesKeepTheOrder) {
  const Material below = plane_strain(1, 0.3), above = plane_strain(20, 0.2);
  std::vector<double> errors;
  for (const int n : {4, 8, 16}) {
    Mesh mesh = exact::unit_square_mesh(n);
    for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t)
      mesh.region.push_back(centroid(mesh, t).y() > 0.5 ? 0 : none);
    Scene scene = pressed(below, above);
    scene.tractions = {{2, constant(0, std::cos(3.0))}};
    scene.body = [](const Vec2& x) { return Vec2(0, 3 * std::sin(3 * x.y())); };
    const Model m = prepare(mesh, element("bdms"), scene, 1);
    const State s = solve(m);
    double square = 0;
    for (Index t = 0; t < n * n * 2; ++t) {
      const Points x = rule_points(m.inner->kernel.load, triangle(m, t));
      const Fields f = evaluate(m, s, t, x);
      for (Eigen::Index q = 0; q < x.cols(); ++q) {
        const Eigen::Vector4d exact = std::cos(3 * x(1, q)) * pressed_stress(material_of(m.mesh, m.scene, t));
        square += area(m.mesh, t) * m.inner->kernel.load.w[q] * (f.stress.col(q) - exact).squaredNorm();
      }
    }
    errors.push_back(std::sqrt(square));
  }
  EXPECT_GT(std::log2(errors[1] / errors[2]), 1.9);
}

TEST(Regions, SaddlePointAgrees) {
  const Inclusion i = inclusion(plane_strain(1, 0.3), plane_strain(10, 0.49));
  const Mesh mesh = i.mesh(0.25);
  const Model m = prepare(mesh, element("bdms"), i.scene, 1);
  const State a = solve(m), b = solve_saddle_point(prepare(mesh, element("bdms"), i.scene, 1, {.factorize = false}));
  EXPECT_LT((a.interior - b.interior).cwiseAbs().maxCoeff(), 1e-9 * a.interior.cwiseAbs().maxCoeff());
  EXPECT_LT((a.skeleton - b.skeleton).cwiseAbs().maxCoeff(), 1e-9 * a.skeleton.cwiseAbs().maxCoeff());
}

/// A crack under tension whose end has `gap` to the rim of a region.
std::vector<TipIntensity> tips(double gap, const Material& inside) {
  Shape shape{polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0),
              {},
              {{"c", {{-0.5, 0}, {0.5, 0}}, {}}},
              {"all"},
              {circle("r", {0, 0}, 0.5 + gap, none)}};
  Scene s{.material = plane_strain(1, 0.3), .regions = {inside}};
  s.tractions = {{0, [](const Vec2&, const Vec2& n) { return Vec2(0, n.y()); }}};
  s.laws = {{CrackLaw::Kind::Unilateral}};
  const Model m = prepare(triangulate(shape, {.size = 0.2}), element("bdms"), s, 1);
  return crack_tips(m, solve(m));
}

TEST(Regions, TipsHaveTheMaterialAroundThem) {
  const std::vector<TipIntensity> same = tips(0.5, plane_strain(1, 0.3));
  ASSERT_EQ(same.size(), 2u);
  EXPECT_NEAR(same[1].K_I, 1.32, 0.05);  // sqrt(pi/2) and the finite width
  const std::vector<TipIntensity> stiff = tips(0.5, plane_strain(10, 0.3));
  EXPECT_LT(stiff[1].radius, 0.45);
  EXPECT_LT(stiff[1].spread, 2e-3);
  EXPECT_GT(stiff[1].K_I, 1.1 * same[1].K_I);  // a stiff inclusion draws the load in
  EXPECT_NEAR(stiff[1].J, stiff[1].G, 0.01 * stiff[1].G);
  EXPECT_NEAR(stiff[1].G, stiff[1].K_I * stiff[1].K_I / plane_modulus(plane_strain(10, 0.3)), 1e-6);
  const std::vector<TipIntensity> near = tips(0.01, plane_strain(10, 0.3));
  EXPECT_LT(near[1].spread, 0.02);
  EXPECT_LT(near[1].radius, 0.01);
}

}  // namespace
}  // namespace kerf::region_test
