// The three contact methods through the whole solver give one state; friction against its exact fields.

#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "solver/system.hpp"
#include "tests/solver/scenes.hpp"
#include "tests/support/exact_families.hpp"

#include <gtest/gtest.h>

namespace kerf::contact_methods_test {
namespace {

Mesh graded_mesh(const exact::ExactField& f, double size) {
  Shape shape;
  shape.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
  shape.labels = {"bottom", "right", "top", "left"};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[static_cast<std::size_t>(i)].label = i;
  shape.cracks = {{"crack", {f.tips[0].at, f.tips[1].at}, {}}};
  return triangulate(shape, {.size = size});
}

std::string word(ContactMethod method) {
  return method == ContactMethod::DualQp ? "dual-qp" : method == ContactMethod::ActiveSet ? "active-set" : "uzawa";
}

void expect_one_state(const Model& m, const std::string& which) {
  const State reference = solve(m);
  EXPECT_TRUE(certified(reference)) << which;
  const double jumps = reference.skeleton.tail(m.inner->skeleton.total - m.inner->skeleton.base).cwiseAbs().maxCoeff();
  for (const ContactMethod method : {ContactMethod::ActiveSet, ContactMethod::Uzawa}) {
    const State other = solve(m, method);
    const std::string what = which + " " + word(method);
    EXPECT_TRUE(certified(other)) << what << " " << other.certificate.kkt << " " << other.converged;
    EXPECT_TRUE(other.converged) << what;
    EXPECT_GE(other.contact_iterations, 1) << what;
    EXPECT_GE(other.linear_solves, 1) << what;
    // Stresses and jumps; forces per point.
    const Eigen::Index s = stress_count(m.inner->kernel.element);
    EXPECT_LT((other.interior.topRows(s) - reference.interior.topRows(s)).norm(),
              1e-8 * reference.interior.topRows(s).norm())
        << what;
    const Eigen::VectorXd difference = other.skeleton - reference.skeleton;
    EXPECT_LE(difference.tail(m.inner->skeleton.total - m.inner->skeleton.base).cwiseAbs().maxCoeff(), 1e-8 * jumps)
        << what;
    EXPECT_LT((other.force - reference.force).norm(), 1e-8 * std::max(reference.force.norm(), 1e-4)) << what;
  }
}

TEST(ContactMethods, GiveOneStateOnTheExactCases) {
  for (const char* name : {"I", "II", "III", "IV"})
    for (const CrackLaw& law : {CrackLaw{}, CrackLaw{.friction = 0.3}, CrackLaw{.slip_bound = 0.1}}) {
      const auto f = exact::crack_case(name);
      const Model m = prepare(exact::crack_mesh(16), element("bdms"), scene_of(f, {0, 1, 2, 3}, {law}), 1);
      expect_one_state(m,
                       std::string(name) + " " + std::to_string(law.friction) + " " + std::to_string(law.slip_bound));
    }
}

TEST(ContactMethods, GiveOneStateOnAGradedPartlyClosedCrack) {
  const exact::ExactField f =
      exact::line_crack("partly", plane_strain(1, 0.3), {.angle = 0.4, .p0 = 0.1, .p1 = 1, .s_tt = 0.2, .s_tn = 0.3});
  for (const CrackLaw& law : {CrackLaw{}, CrackLaw{.friction = 0.3}, CrackLaw{.slip_bound = 0.1}}) {
    const Model m = prepare(graded_mesh(f, 0.5), element("bdms"), scene_of(f, {0, 1, 2, 3}, {law}), 1);
    expect_one_state(m, "graded " + std::to_string(law.friction) + " " + std::to_string(law.slip_bound));
  }
}

// The other elements with contact, nearly incompressible as well: the penalty's iterations go through the same methods.
TEST(ContactMethods, GiveOneStateForEveryElement) {
  for (const Element& e : elements) {
    if (!is_mixed(e) || e.at_vertices == AtVertices::Stress) continue;
    for (const double nu : {0.3, 0.5}) {
      const auto f = exact::crack_case("III", 0, plane_strain(2, nu));
      const CrackLaw law{.friction = nu == 0.5 ? 0.3 : 0};
      const Model m = prepare(exact::crack_mesh(8), e, scene_of(f, {0, 1, 2, 3}, {law}), 1);
      expect_one_state(m, title(e) + " " + std::to_string(nu));
    }
  }
}

struct Friction {
  const char* id;
  CrackLaw law;
};
class FrictionFields : public testing::TestWithParam<Friction> {};

TEST_P(FrictionFields, AreReproduced) {
  const exact::FrictionField friction = exact::friction_table(GetParam().id);
  const exact::ExactField& f = friction.field;
  const bool slides = std::abs(f.tips[0].k2) > 1e-9;
  // Uniform meshes about the turned crack: the singular rate. Boundary data on all of the turned square.
  const double angle = std::atan2(f.tips[1].at.y(), f.tips[1].at.x());
  for (const char* name : {"bdms", "peers"}) {
    std::vector<double> error, slip;
    for (const int n : {8, 16, 32}) {
      const Model m =
          prepare(exact::crack_mesh(n, angle), element(name), scene_of(f, {0, 1, 2, 3}, {GetParam().law}), 1);
      const State s = solve(m);
      EXPECT_TRUE(certified(s));
      error.push_back(exact::stress_error(m, s, f));
      double off = 0, size = 0;
      const std::vector<CrackPoint> profile = crack_profile(m, s, 0);
      for (const CrackPoint& p : profile) {
        off += p.length * std::pow(p.jump_t - f.slip(p.s - 1), 2);
        size += p.length * std::pow(f.slip(p.s - 1), 2);
        EXPECT_EQ(p.jump_n, 0);
        EXPECT_EQ(p.status, CrackPoint::Status::Closed);
        if (slides) {
          EXPECT_NEAR(std::abs(p.sigma_t), GetParam().law.slip_bound - GetParam().law.friction * p.sigma_n, 1e-10);
        }
      }
      slip.push_back(slides ? std::sqrt(off / size) : std::sqrt(off));
    }
    if (slides) {
      EXPECT_NEAR(std::log2(error[1] / error[2]), 0.5, 0.05);
      EXPECT_NEAR(std::log2(slip[1] / slip[2]), 1, 0.15);
      EXPECT_LT(slip[2], name == std::string("peers") ? 0.12 : 0.045);
    } else {
      EXPECT_LT(error[0], 1e-10);
      EXPECT_EQ(slip[0], 0);
    }
  }
  const Model m = prepare(graded_mesh(f, 0.2), element("bdms", 2), scene_of(f, {0, 1, 2, 3}, {GetParam().law}), 1);
  const State s = solve(m);
  EXPECT_TRUE(certified(s));
  // Coulomb's limit feels the error of the pressure, which at every distance r from a tip is K r^-1/2 times the local
  // resolution: K_II converges with the grading, not with the size at the tip.
  const double tolerance = GetParam().law.friction > 0 && slides ? 3e-4 : 3e-5;
  for (const TipIntensity& tip : crack_tips(m, s)) {
    EXPECT_EQ(tip.K_I, 0);
    EXPECT_NEAR(tip.K_II, f.tips[0].k2, tolerance);
  }
  double off = 0, size = 0;
  for (const CrackPoint& p : crack_profile(m, s, 0)) {
    off = std::max(off, std::abs(p.jump_t - f.slip(p.s - 1)));
    size = std::max(size, std::abs(f.slip(p.s - 1)));
  }
  EXPECT_LE(off, 0.012 * size);
  expect_one_state(m, GetParam().id);
}

INSTANTIATE_TEST_SUITE_P(Tables, FrictionFields,
                         testing::Values(Friction{"c07_coulomb", {.friction = 0.3}},
                                         Friction{"c07_stick", {.friction = 0.4}},
                                         Friction{"c07_tresca", {.slip_bound = 0.2}}),
                         [](const auto& info) { return std::string(info.param.id); });

}  // namespace
}  // namespace kerf::contact_methods_test
