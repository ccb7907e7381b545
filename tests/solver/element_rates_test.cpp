// Every element on meshes: constant stress exactly, orders of convergence up to nu = 1/2, bodies that cannot change
// their area.

#include "solver/system.hpp"
#include "tests/solver/scenes.hpp"

#include <gtest/gtest.h>

namespace kerf::element_rates_test {
namespace {

const auto by_title = [](const auto& info) { return title(info.param); };
const auto mixed_elements = testing::ValuesIn(elements.begin(), elements.end() - 2);
const auto displacement_elements = testing::ValuesIn(elements.end() - 2, elements.end());

exact::ExactField constant_field(const Material& material, const Mat2& stress) {
  exact::ExactField f;
  f.material = material;
  f.stress = [=](const Vec2&, int) { return stress; };
  f.displacement = [=](const Vec2& x, int) { return Vec2(strain(material, stress) * x + Vec2(0.3, -0.1)); };
  return f;
}

class Patch : public testing::TestWithParam<Element> {};

TEST_P(Patch, ConstantStressIsExact) {
  const Element& e = GetParam();
  const double angle = 0.5;
  for (const double nu : {0.0, 0.3, 0.4999, 0.5}) {
    if (!is_mixed(e) && nu > 0.3) continue;
    for (const bool crack : {false, true}) {
      if (crack && (!is_mixed(e) || e.at_vertices == AtVertices::Stress)) continue;
      for (int k = 0; k < 3; ++k) {
        Mat2 stress = Mat2::Zero();  // in the crack's frame: no shear, and pressure, when there is a crack
        if (k == 0) stress(0, 0) = 1;
        if (k == 1) stress(1, 1) = -1;
        if (k == 2) stress << 0.3, 0.4, 0.4, -0.7;
        if (crack && k == 0) stress(1, 1) = -0.01;
        if (crack && k == 2) stress(0, 1) = stress(1, 0) = 0;
        const Mat2 turn = (Mat2() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
        stress = turn * stress * turn.transpose();
        const exact::ExactField f = constant_field(plane_strain(2, nu), stress);
        const Model m = crack ? prepare(exact::crack_mesh(8, angle, 0.3), e, scene_of(f, {0, 3}, {{}}), 1)
                              : prepare(exact::unit_square_mesh(6, 0.3), e, scene_of(f, {0, 3}), 1);
        const State s = solve(m);
        EXPECT_TRUE(certified(s));
        double stress_off = 0, displacement_off = 0;
        for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
          const auto corner = triangle(m, t).x;
          Points x(2, 3);
          x << corner[0], corner[1], corner[2];
          const Eigen::Matrix4Xd found = evaluate(m, s, t, x).stress;
          const Points u = recovered_displacement(m, s, t, x);
          for (int i = 0; i < 3; ++i) {
            stress_off = std::max(stress_off, (tensor(found.col(i)) - stress).cwiseAbs().maxCoeff());
            displacement_off = std::max(displacement_off, (u.col(i) - f.displacement(corner[i], 0)).norm());
          }
        }
        const std::string which = std::to_string(nu) + " " + std::to_string(crack) + " " + std::to_string(k);
        EXPECT_LT(stress_off, e.stress == 4 ? 2e-10 : 5e-11) << which;
        EXPECT_LT(displacement_off, 1e-11) << which;
        if (!crack) continue;
        for (const CrackPoint& p : crack_profile(m, s, 0)) {
          EXPECT_EQ(p.status, CrackPoint::Status::Closed);
          EXPECT_EQ(p.jump_n, 0);
          EXPECT_NEAR(p.jump_t, 0, 1e-11);
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, Patch, testing::ValuesIn(elements), by_title);

// Vertices whose edges lie on two lines leave combinations of cubic traces that no triangle sees.
TEST(SingularVertices, DoNotMatterToTheElementWithCubicTraces) {
  const exact::ExactField f = exact::wave_field(0.3);
  const auto error = [&](const Mesh& mesh) {
    const Model m = prepare(mesh, arnold_winther, scene_of(f, {0, 1, 2, 3}), 1);
    const State s = solve(m);
    EXPECT_LT(s.certificate.kkt, 1e-10);
    EXPECT_LT(s.skeleton.cwiseAbs().maxCoeff(), 100);
    return exact::stress_error(m, s, f);
  };
  // A corner with two triangles between two free sides: tractions a, b on sides with normals m, n fit when a.n = b.m.
  // What their projections leave of that has no solution: the tractions next to the corner are changed, and a note says
  // so.
  const Model m = prepare(exact::unit_square_mesh(8), arnold_winther, scene_of(f, {2, 3}), 1);
  EXPECT_TRUE(certified(solve(m)));
  ASSERT_FALSE(m.notes.empty());
  EXPECT_NE(m.notes[0].find("no symmetric stress"), std::string::npos) << m.notes[0];
  exact::ExactField uniform;
  uniform.material = f.material;
  const Mat2 stress = (Mat2() << 1, 0.3, 0.3, -2).finished();
  uniform.stress = [=](const Vec2&, int) { return stress; };
  uniform.displacement = [=](const Vec2& x, int) { return Vec2(strain(f.material, stress) * x); };
  const State s = solve(prepare(exact::unit_square_mesh(8), arnold_winther, scene_of(uniform, {2, 3}), 1));
  EXPECT_LT(s.certificate.kkt, 1e-10);
  EXPECT_LT(s.skeleton.cwiseAbs().maxCoeff(), 100);
  // Four triangles around a vertex, inside the body.
  const std::vector<Vec2> points{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}};
  const std::vector<Marked> sides{{0, 1, 0}, {1, 2, 1}, {2, 3, 2}, {3, 0, 3}};
  Mesh cross = connect(points, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}, sides);
  const double coarse = error(cross);
  EXPECT_LT(error(refine(refine(cross))), coarse / 30);
}

struct Errors {
  double stress, displacement;
};
Errors errors(const Element& e, const Mesh& mesh, const exact::ExactField& f) {
  const Model m = prepare(mesh, e, scene_of(f, {0, 3}), 1);
  const State s = solve(m);
  EXPECT_TRUE(certified(s));
  return {exact::stress_error(m, s, f), recovered_error(m, s, f)};
}

class Rates : public testing::TestWithParam<Element> {};

TEST_P(Rates, OrdersHoldUpToTheIncompressibleLimit) {
  const Element& e = GetParam();
  // Two more than that of u_h, but for constants and for what the rotation limits (afw).
  const bool limited = e.displacement == 0 || e.order == e.displacement + 1;
  const double order = is_symmetric(e) && e.order == 1 ? 2 : e.displacement + (limited ? 2 : 3);
  std::vector<double> coarsest, finest;
  for (const double nu : {0.3, 0.49, 0.4999, 0.499999, 0.5}) {
    const exact::ExactField f = exact::wave_field(nu);
    std::vector<Errors> found;
    for (const int n : {4, 8, 16}) found.push_back(errors(e, exact::unit_square_mesh(n), f));
    EXPECT_NEAR(std::log2(found[1].stress / found[2].stress), e.order, 0.15) << nu;
    EXPECT_NEAR(std::log2(found[1].displacement / found[2].displacement), order, 0.2) << nu;
    coarsest.push_back(found[0].stress);
    finest.push_back(found[2].stress);
  }
  for (const std::vector<double>& error : {coarsest, finest})
    for (const double value : error) {
      EXPECT_LT(value, 1.3 * error[0]);
      EXPECT_GT(value, error[0] / 1.3);
    }
  EXPECT_NEAR(finest[3] / finest[4], 1, 1e-4) << "0.499999 and 0.5";
}

INSTANTIATE_TEST_SUITE_P(Mixed, Rates, mixed_elements, by_title);

class Locking : public testing::TestWithParam<Element> {};

TEST_P(Locking, OrdersHoldAtThreeTenthsOnly) {
  const Element& e = GetParam();
  std::vector<Errors> soft, stiff;
  for (const int n : {4, 8, 16}) {
    soft.push_back(errors(e, exact::unit_square_mesh(n), exact::wave_field(0.3)));
    stiff.push_back(errors(e, exact::unit_square_mesh(n), exact::wave_field(0.4999)));
  }
  EXPECT_NEAR(std::log2(soft[1].stress / soft[2].stress), e.order, 0.15);
  EXPECT_NEAR(std::log2(soft[1].displacement / soft[2].displacement), e.order + 1, 0.2);
  // 93 and 307 times; the displacement of p1 hardly moves at all.
  EXPECT_GT(stiff[2].stress, 80 * soft[2].stress);
  EXPECT_GT(stiff[2].displacement, 35 * soft[2].displacement);
}

TEST_P(Locking, NuOfOneHalfIsRefused) {
  try {
    errors(GetParam(), exact::unit_square_mesh(2), exact::wave_field(0.5));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault, Fault::Numerics);
    EXPECT_NE(std::string(error.what()).find("incompressible"), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(Displacement, Locking, displacement_elements, by_title);

class Enclosed : public testing::TestWithParam<Element> {};

// At nu = 1/2 a body held all around has no level of pressure: the mean pressure is zero by choice.
TEST_P(Enclosed, DisplacementsThatKeepTheAreaAreSolved) {
  const Element& e = GetParam();
  if (e.at_vertices == AtVertices::Stress) return;  // refuses every such body
  for (const exact::ExactField& f : {exact::trig_field(0.5), exact::exp_field(0.5), exact::wave_field(0.5)}) {
    double level = 0;
    std::vector<double> error;
    for (const int n : {4, 8, 16}) {
      const Model m = prepare(exact::unit_square_mesh(n), e, scene_of(f, {0, 1, 2, 3}), 1);
      const State s = solve(m);
      EXPECT_TRUE(certified(s));
      double trace = 0, pressure = 0;
      for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
        const Triangle shape = triangle(m, t);
        const Eigen::Matrix4Xd here = evaluate(m, s, t, rule_points(m.inner->kernel.rule, shape)).stress;
        trace += area(shape) * (here.row(0) + here.row(3)).dot(m.inner->kernel.rule.w);
        pressure += exact::integrate(shape.x, -1, [&](const Vec2& x) { return f.stress(x, 0).trace(); });
      }
      EXPECT_NEAR(trace, 0, 1e-10 * stress_norm(m, s));
      level = pressure / 2;
      error.push_back(exact::stress_error(m.mesh, f, [&](Index t, const Vec2& x) -> Mat2 {
        return tensor(stress_at(m.inner->kernel, triangle(m, t), s.interior.col(t), x)) + level * Mat2::Identity();
      }));
    }
    EXPECT_GT(std::log2(error[1] / error[2]), e.order - 0.2) << f.name;
  }
}

TEST_P(Enclosed, ChangeOfAreaIsRefused) {
  const bool any = GetParam().at_vertices == AtVertices::Stress;
  Scene scene;
  scene.material = plane_strain(1, 0.5);
  for (Index label = 0; label < 4; ++label)
    scene.supports.push_back({label, false, true, true, [](const Vec2& x, const Vec2&) { return Vec2(0.01 * x); }});
  try {
    solve(prepare(exact::unit_square_mesh(4), GetParam(), scene, 1));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault, Fault::Numerics);
    EXPECT_NE(std::string(error.what()).find(any ? "its pressure has no level" : "change its area by 0.02"),
              std::string::npos)
        << error.what();
  }
}

// Rollers all around enclose a body as well; one free side does not.
TEST(EnclosedByRollers, HasNoLevelOfPressureInTheConformingElement) {
  const exact::ExactField f = exact::trig_field(0.5);
  const auto zero = [](const Vec2&, const Vec2&) { return Vec2(0, 0); };
  Scene scene{.material = f.material, .body = f.body, .supports = {}, .tractions = {}, .laws = {}};
  for (Index label = 0; label < 3; ++label) scene.supports.push_back({label, true, true, false, zero});
  EXPECT_NO_THROW(prepare(exact::unit_square_mesh(2), arnold_winther_conforming, scene, 1));
  scene.supports.push_back({3, false, true, false, zero});
  EXPECT_THROW(prepare(exact::unit_square_mesh(2), arnold_winther_conforming, scene, 1), Error);
}

INSTANTIATE_TEST_SUITE_P(Mixed, Enclosed, mixed_elements, by_title);

}  // namespace
}  // namespace kerf::element_rates_test
