// Slender bodies, whose strains are millions of times smaller than their displacements: against pure bending in closed
// form, and against the saddle point that is not condensed.
#include "kerf/adjoint.hpp"
#include "kerf/mesher.hpp"
#include "solver/saddle_point.hpp"
#include "solver/system.hpp"
#include "tests/truth/scene.hpp"

#include <fmt/core.h>

#include <cmath>

namespace kerf::slender_test {
namespace {

constexpr Index right = 1, left = 3;

// A strip 1 high, turned by `angle`, clamped on its left. With nu = 0 in plane stress the end moment 1 bends it to a
// parabola: stress 12 y along it, work of the load 12 length, in the space of most elements.
struct Strip {
  double length, angle = 0;
  std::vector<std::array<Vec2, 2>> cracks = {};
  CrackLaw law = {};
  double tip_size = 0;

  Vec2 turned(const Vec2& x) const {
    return {std::cos(angle) * x.x() - std::sin(angle) * x.y(), std::sin(angle) * x.x() + std::cos(angle) * x.y()};
  }
  double height(const Vec2& x) const {
    return -std::sin(angle) * x.x() + std::cos(angle) * x.y() - 0.5;
  }
  Mesh mesh(double size) const {
    Shape shape;
    shape.labels = {"bottom", "right", "top", "left"};
    shape.outline.sides = {
        {turned({0, 0}), 0}, {turned({length, 0}), right}, {turned({length, 1}), 2}, {turned({0, 1}), left}};
    for (const auto& [a, b] : cracks)
      shape.cracks.push_back({.name = fmt::format("c{}", shape.cracks.size()), .points = {turned(a), turned(b)}});
    return triangulate(shape, {.size = size, .crack_tip_size = tip_size});
  }
  Scene scene(const Material& material = plane_stress(1, 0)) const {
    Scene s;
    s.material = material;
    s.supports = {{.label = left, .value = [](const Vec2&, const Vec2&) -> Vec2 { return {0, 0}; }}};
    s.laws.assign(cracks.size(), law);
    return s;
  }
  BoundaryField moment(double value = 1) const {
    return [*this, value](const Vec2& x, const Vec2&) -> Vec2 { return turned({value * 12 * height(x), 0}); };
  }
  BoundaryField shear(double value = 1) const {
    return [*this, value](const Vec2& x, const Vec2&) -> Vec2 {
      const double y = height(x);
      return turned({0, -value * 6 * (0.25 - y * y)});
    };
  }
};

// The largest error of the stress at the centroids, relative to the largest stress 6.
double stress_error(const Strip& strip, const Model& m, const Field& s) {
  double worst = 0;
  const Vec2 axis = strip.turned({1, 0});
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Points x = centroid(m.mesh, t);
    const Mat2 exact = 12 * strip.height(x.col(0)) * axis * axis.transpose();
    worst = std::max(worst, (tensor(evaluate(m, s, t, x).stress.col(0)) - exact).cwiseAbs().maxCoeff());
  }
  return worst / 6;
}

TEST(Slender, BeamsBendAsInClosedForm) {
  struct Case {
    double length, size, angle;
  };
  for (const auto& [length, size, angle] :
       {Case{200, 0.25, 0}, Case{500, 0.25, 0.6}, Case{1000, 0.5, 0}, Case{2000, 0.5, 0}, Case{2000, 0.5, 0.6}}) {
    const Strip strip{length, angle};
    Scene scene = strip.scene();
    scene.tractions = {{.label = right, .value = strip.moment()}};
    const Model m = prepare(strip.mesh(size), element("bdms"), scene, 2);
    const State s = solve(m);
    const std::string what = fmt::format("{} {} {}", length, size, angle);
    EXPECT_NEAR(work_of_loads(m, s) / (12 * length), 1, 1e-8) << what;
    EXPECT_NEAR(2 * strain_energy(m, s) / (12 * length), 1, 1e-8) << what;
    EXPECT_LT(stress_error(strip, m, s), 1e-8) << what;
    EXPECT_TRUE(certified(s)) << what;
    EXPECT_LT(s.certificate.work, 1e-9) << what;
    EXPECT_EQ(lost_digits(s), "") << what;
  }
}

TEST(Slender, EveryElementLosesNothing) {
  const Strip strip{200};
  Scene scene = strip.scene();
  scene.tractions = {{.label = right, .value = strip.moment()}};
  for (const Element& e : elements) {
    if (has_unseen_traces(e)) continue;
    const Model m = prepare(strip.mesh(0.5), e, scene, 2);
    const State s = solve(m);
    const double work = work_of_loads(m, s), energy = 2 * strain_energy(m, s);
    EXPECT_NEAR(energy / work, 1, 1e-9) << e.name << e.degree;
    EXPECT_LT(s.certificate.work, 1e-9) << e.name << e.degree;
    const bool bends = e.order >= 2;  // has the field in its space
    if (bends) {
      EXPECT_NEAR(work / 2400, 1, 1e-9) << e.name << e.degree;
    }
  }
}

// What is not refined says how wrong it is.
TEST(Slender, TheCertificateIsTheError) {
  for (const double length : {2.0, 5.0, 10.0, 20.0}) {
    const Strip strip{length, 0.3};
    Scene scene = strip.scene();
    scene.tractions = {{.label = right, .value = strip.moment()}};
    const Model m = prepare(strip.mesh(0.1), element("bdms"), scene, 2);
    const State s = solve(m);
    const double error = std::abs(work_of_loads(m, s) / (12 * length) - 1);
    EXPECT_LE(error, 2 * s.certificate.work + 1e-13) << length;
    EXPECT_LE(s.certificate.work, 1e-8) << length;
  }
}

TEST(Slender, AFreeBeamAndARigidMotion) {
  const Strip strip{500, 0.4};
  Scene scene = strip.scene();
  scene.supports.clear();
  scene.tractions = {{.label = right, .value = strip.moment()}, {.label = left, .value = strip.moment(-1)}};
  const Model free = prepare(strip.mesh(0.5), element("bdms"), scene, 2);
  const State bent = solve(free);
  EXPECT_NEAR(work_of_loads(free, bent) / 6000, 1, 1e-8);
  EXPECT_LT(stress_error(strip, free, bent), 1e-8);

  scene.tractions.clear();
  for (const Index label : {left, right})
    scene.supports.push_back({.label = label, .value = [](const Vec2& x, const Vec2&) -> Vec2 {
                                return {1 - x.y(), x.x()};
                              }});
  const Model moved = prepare(strip.mesh(0.5), element("bdms"), scene, 2);
  const State still = solve(moved);
  EXPECT_TRUE(certified(still)) << still.certificate.kkt << ' ' << still.certificate.work;
  EXPECT_LT(still.interior.topRows(12).cwiseAbs().maxCoeff(), 1e-10);
}

// The saddle point has no condensed matrix to lose digits in.
void expect_as_saddle_point(const Strip& strip, const Scene& scene, const char* what) {
  const Model m = prepare(strip.mesh(0.5), element("bdms"), scene, 2);
  const State s = solve(m), other = solve_saddle_point(m);
  EXPECT_TRUE(certified(s)) << what;
  EXPECT_TRUE(certified(other)) << what;
  EXPECT_LT(s.certificate.work, 1e-9) << what;
  EXPECT_LT(other.certificate.work, 1e-9) << what;
  EXPECT_NEAR(strain_energy(m, s) / strain_energy(m, other), 1, 2e-9) << what;
  const double work = work_of_loads(m, other);
  if (work != 0) {
    EXPECT_NEAR(work_of_loads(m, s) / work, 1, 2e-9) << what;
  }
  EXPECT_LT((s.force - other.force).cwiseAbs().maxCoeff(), 1e-6 * (1e-3 + other.force.cwiseAbs().maxCoeff())) << what;
}

TEST(Slender, CracksThatCloseAndRub) {
  const double L = 100, at = 0.3 * L;
  for (const double friction : {0.0, 0.5}) {
    const CrackLaw law{.friction = friction};
    for (const Strip& strip : {Strip{L, 0.2, {{Vec2(at, 0.2), Vec2(at + 0.3, 0.8)}}, law, 0.1},
                               Strip{L, 0, {{Vec2(at, 0.4), Vec2(at + 2, 0.4)}}, law, 0.1}}) {
      Scene scene = strip.scene(plane_strain(1, 0.3));
      scene.tractions = {{.label = right, .value = strip.shear()}};
      expect_as_saddle_point(strip, scene, friction > 0 ? "friction" : "contact");
    }
  }
}

TEST(Slender, PrescribedDisplacements) {
  const Strip strip{500};
  Scene scene = strip.scene(plane_strain(1, 0.3));
  scene.supports.push_back({.label = right, .value = [](const Vec2&, const Vec2&) -> Vec2 { return {0, -1}; }});
  expect_as_saddle_point(strip, scene, "ends");
  // Clamped ends, one of them moved by d: 2 energy = 12 E' I d^2 / L^3, up to (height/length)^2.
  const Model m = prepare(strip.mesh(0.5), element("bdms"), scene, 2);
  const double beam = 1 / (1 - 0.09) / (500.0 * 500 * 500);
  EXPECT_NEAR(2 * strain_energy(m, solve(m)) / beam, 1, 1e-4);
}

TEST(Slender, NearlyIncompressibleAndHeavy) {
  const Strip strip{300, 0.6};
  for (const double poisson : {0.4999, 0.5}) {
    Scene scene = strip.scene(plane_strain(1, poisson));
    scene.tractions = {{.label = right, .value = strip.shear()}};
    expect_as_saddle_point(strip, scene, "incompressible");
  }
  Scene scene = strip.scene(plane_strain(1, 0.3));
  scene.body = [](const Vec2& x) -> Vec2 { return {0, -1 - x.x() / 300}; };
  expect_as_saddle_point(strip, scene, "heavy");
}

// The adjoint of the work of the loads is the state, up to its sign: mu . F = work.
TEST(Slender, Adjoints) {
  const Strip strip{1000};
  Scene scene = strip.scene();
  scene.tractions = {{.label = right, .value = strip.moment()}};
  const Model m = prepare(strip.mesh(0.5), element("bdms"), scene, 2);
  Sensitivity dJ;
  dJ.skeleton = m.inner->system.tractions;
  const TangentField adjoint = solve_adjoint(m, dJ, {});
  EXPECT_NEAR(adjoint.skeleton.dot(m.inner->system.tractions) / 12000, 1, 1e-8);
  EXPECT_LT(stress_error(strip, m, adjoint), 1e-8);
  const std::vector<double> zero(m.inner->skeleton.total, 0);
  EXPECT_LT(stress_error(strip, m, solve_linear(m, m.inner->system.tractions, zero, {})), 1e-8);
}

TEST_F(Truth, ASlenderBeamAsUsersRunIt) {
  const nlohmann::json r = run_scene(R"case(
[domain]
outline = [[0, 0], [500, 0], [500, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1.0
poisson = 0.0
state = "plane stress"
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = ["12*(y-0.5)", "0"]
[mesh]
size = 0.25
)case");
  EXPECT_EQ(r["status"], "ok");
  EXPECT_NEAR(r["state"]["compliance"].get<double>() / 6000, 1, 1e-8);
  EXPECT_NEAR(r["state"]["energy"].get<double>() / -3000, 1, 1e-8);
  EXPECT_LT(r["state"]["work_error"].get<double>(), 1e-9);
}

}  // namespace
}  // namespace kerf::slender_test
