// Shape derivatives of every functional against central differences of whole solves on moved points; at a tip against
// the energy release rate.

#include "kerf/shape_gradient.hpp"
#include "solver/system.hpp"

#include "kerf/fracture.hpp"
#include "tests/topo/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::shape_gradient_test {
namespace {

using namespace scenes;

// [-1, 1]^2 with a hole (label 4), a crack beside it and a disc of another material: clamped at the bottom with a
// displacement that varies along it, a roller on the left, a traction that varies on top, a pressure in the hole.
struct Scenario {
  std::string name;
  double poisson = 0.3;
  std::string element = "bdms";
  int degree = 1;
  enum class Crack { Open, Partly, Closed, Bonded } crack = Crack::Open;
  bool body = true;        // a body force
  bool prescribed = true;  // displacements that are not 0
  double step = 1e-3;      // small enough that no contact changes
  bool fluid = false;      // a pressure in the crack
  bool gap = false;        // faces that are apart, or overlap, before loading
  double friction = 0;
};

const Vec2 hole_center(-0.35, 0.35), tip(0.6, -0.3);
constexpr double hole_radius = 0.25;

Shape body_shape() {
  Shape s = rectangle({-1, -1}, {1, 1});
  s.labels.push_back("hole");
  s.holes = {circle("hole", hole_center, hole_radius, 4)};
  s.cracks = {{"crack", {Vec2(-0.2, -0.4), tip}}};
  s.regions = {circle("stiff", {0.5, 0.5}, 0.2, none)};
  return s;
}
const Mesh& body_mesh() {
  static const Mesh mesh = triangulate(body_shape(), {.size = 0.3, .crack_tip_size = 0.1});
  return mesh;
}

Scene scene_of(const Scenario& s) {
  Scene scene;
  scene.material = plane_strain(1, s.poisson);
  scene.regions = {plane_strain(3, 0.25)};
  scene.laws.resize(1);
  if (s.fluid)
    scene.laws[0].pressure = [](const Vec2& x, const Vec2&) {
      return Vec2(0.3 + 0.2 * std::sin(3 * x.x() + x.y()), 0);
    };
  if (s.gap) scene.laws[0].gap = [](const Vec2& x, const Vec2&) { return Vec2(0.02 * std::sin(4 * x.x()) - 0.005, 0); };
  scene.laws[0].friction = s.friction;
  if (s.crack == Scenario::Crack::Bonded) scene.laws[0].kind = CrackLaw::Kind::Bonded;
  const double size = s.prescribed ? 0.05 : 0;
  scene.supports = {
      {0, false, true, true, [=](const Vec2& x, const Vec2&) { return Vec2(size * x.x() * x.x(), size * x.x()); }},
      {3, true, true, false, [=](const Vec2& x, const Vec2&) { return Vec2(size * std::sin(x.y()), 0); }}};
  const Scenario::Crack crack = s.crack;
  scene.tractions = {{2,
                      [=](const Vec2& x, const Vec2& n) -> Vec2 {
                        const double up = crack == Scenario::Crack::Open     ? 1 + 0.2 * x.x()
                                          : crack == Scenario::Crack::Partly ? x.x() * x.x() - 1 + 3 * x.x()
                                                                             : -1 - 0.2 * x.x();
                        return Vec2(0.1 * x.x(), 0) + up * n;
                      }},
                     {4, [](const Vec2& x, const Vec2& n) -> Vec2 { return -0.3 * (1 + x.x()) * n; }}};
  if (s.body) scene.body = [](const Vec2& x) { return Vec2(0.1 * x.y(), -0.2 + 0.1 * std::sin(2 * x.x())); };
  return scene;
}

void PrintTo(const Scenario& s, std::ostream* out) {
  *out << s.name;
}

struct Named {
  std::string name;
  std::vector<Term> terms;
};
std::vector<Named> functionals(const Scenario& s) {
  const auto target = [](const Vec2& x) { return Vec2(0.3 * x.y(), std::sin(x.x())); };
  const auto weight = [](const Vec2& x) { return 1 + 0.5 * std::sin(x.x() + 2 * x.y()); };
  const auto boundary_target = [=](const Vec2& x, const Vec2& n) -> Vec2 { return target(x) + 0.1 * n; };
  const auto boundary_weight = [=](const Vec2& x, const Vec2& n) { return weight(x) + 0.2 * n.x() * n.x(); };
  const Term rate = energy_release_rate(tip, {1, 0.2}, {0.12, 0.32}, s.body ? scene_of(s).body : VectorField{});
  std::vector<Named> all{
      {"energy", {energy()}},
      {"compliance", {compliance()}},
      {"volume", {volume()}},
      {"displacement", {displacement_tracking(target, weight)}},
      {"boundary", {boundary_tracking(1, boundary_target, boundary_weight)}},
      {"loaded_boundary", {boundary_tracking(2, boundary_target, boundary_weight)}},
      {"supported_boundary", {boundary_tracking(3, boundary_target, boundary_weight)}},
      {"along", {boundary_displacement(1, boundary_target, boundary_weight)}},
      {"power", {stress_power(4, weight, true)}},
      {"norm", {stress_pnorm(6, weight, true)}},
      {"misfit", {misfit(2, [](const Vec2& x, const Vec2& n) -> Vec2 { return 0.3 * n + Vec2(0.1 * x.x(), 0); })}},
      {"rate", {rate}},
      {"opening", {crack_opening(0, weight)}},
      {"pressure",
       {crack_pressure(
           0, [](const Vec2& x) { return 0.1 * x.x(); },
           // The square of the pressure has no integral at a tip where the faces overlap before loading.
           [gap = s.gap, weight](const Vec2& x) { return weight(x) * (gap ? (x - Vec2(-0.2, -0.4)).norm() : 1); })}},
      {"turning", {turning()}},
      {"sum", {compliance(), volume(), stress_pnorm(4, weight, true), energy()}},
  };
  all.back().terms[1].factor = 3;
  all.back().terms[2].factor = -0.5;
  all.back().terms[3].factor = 0.7;
  if (s.fluid || s.gap || s.friction > 0)  // refused: it would miss the work of the fluid, of contact and of friction
    std::erase_if(all, [](const Named& n) { return n.name == std::string("rate"); });
  if (s.friction > 0) std::erase_if(all, [](const Named& n) { return n.name == std::string("misfit"); });  // refused
  return all;
}

Model model_of(const Scenario& s, Mesh mesh) {
  return prepare(std::move(mesh), element(s.element, s.degree), scene_of(s), 2);
}

// dJ/dt at 0 of every functional for points x + t theta: central differences of fourth order of whole solves.
std::vector<double> differences_along(const Scenario& s, const std::vector<Named>& all, const Points& theta,
                                      const std::vector<ContactStatus>& status) {
  std::vector<double> slope(all.size(), 0);
  for (const auto& [at, weight] : {std::pair{1, 8}, {-1, -8}, {2, -1}, {-2, 1}}) {
    Mesh mesh = body_mesh();
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
      mesh.points[i] += at * s.step * theta.col(static_cast<Eigen::Index>(i));
    const Model m = model_of(s, std::move(mesh));
    const State state = solve(m);
    EXPECT_TRUE(certified(state));
    EXPECT_TRUE(contact_status(m, state) == status);
    for (std::size_t i = 0; i < all.size(); ++i)
      slope[i] += weight * analyze({all[i].name, all[i].terms}, m, state, true).value / (12 * s.step);
  }
  return slope;
}

// Numbers in [-1, 1] that are the same everywhere.
double noise(unsigned& seed) {
  seed = seed * 1664525u + 1013904223u;
  return (seed >> 8) / static_cast<double>(1u << 23) - 1;
}

enum class Moving { Hole, Free, All };
Points field(Moving what) {
  const Mesh& mesh = body_mesh();
  const Eigen::Index n = static_cast<Eigen::Index>(mesh.points.size());
  Points theta = Points::Zero(2, n);
  if (what == Moving::Hole) {  // smooth, around the hole
    for (Eigen::Index v = 0; v < n; ++v) {
      const Vec2 d = mesh.points[static_cast<std::size_t>(v)] - hole_center;
      const double r = std::max(0.0, 1 - d.squaredNorm() / 0.36);
      theta.col(v) = r * r * r * Vec2(1 + d.y(), 0.5 - 2 * d.x() * d.y());
    }
    return theta;
  }
  std::vector<bool> held(mesh.points.size(), false);
  if (what == Moving::Free)
    for (std::size_t e = 0; e < mesh.edges.size(); ++e)
      for (const Index v : mesh.edges[e])
        if (mesh.crack[e] != none || (mesh.label[e] != none && mesh.label[e] != 1))
          held[static_cast<std::size_t>(v)] = true;
  unsigned seed = 7;
  for (Eigen::Index v = 0; v < n; ++v) {
    const Vec2 random(noise(seed), noise(seed));
    if (!held[static_cast<std::size_t>(v)]) theta.col(v) = 0.1 * random;
  }
  return theta;
}

class ShapeGradient : public testing::TestWithParam<Scenario> {};

TEST_P(ShapeGradient, IsTheDerivativeOfTheWholeProgram) {
  const Scenario& scenario = GetParam();
  const std::vector<Named> all = functionals(scenario);
  const Model model = model_of(scenario, body_mesh());
  const State state = solve(model);
  ASSERT_TRUE(certified(state));
  const std::vector<ContactStatus> status = contact_status(model, state);
  // What a gap that belongs to places does when these move, and what the frames of faces that slide do, is not known.
  const std::vector<Moving> kinds =
      scenario.gap ? std::vector{Moving::Hole, Moving::Free} : std::vector{Moving::Hole, Moving::Free, Moving::All};
  std::vector<std::vector<double>> expected;
  for (const Moving what : kinds) expected.push_back(differences_along(scenario, all, field(what), status));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Functional j{all[i].name, all[i].terms};
    const Analysis a = analyze(j, model, state);
    const Points gradient = shape_gradient(a, j);
    ASSERT_TRUE(gradient.allFinite());
    // Differences see the third derivative of the ring's cut-off jump as points cross its ends; and G of a closed crack
    // is what remains of the energy in the ring, about 0.3.
    const bool rate = j.kind == "rate";
    const double tolerance = rate ? 5e-6 : 1e-6, scale = rate ? std::max(std::abs(a.value), 0.3) : std::abs(a.value);
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      const double actual = gradient.cwiseProduct(field(kinds[k])).sum(), there = expected[k][i];
      EXPECT_NEAR(actual, there, tolerance * std::max(std::abs(there), 0.05 * scale))
          << j.kind << " moving " << k << " J " << a.value << " relative " << actual / there - 1;
    }
  }
}

std::string name_of(const testing::TestParamInfo<Scenario>& info) {
  return info.param.name;
}

/// A body whose points go along a random field, the program run anew for each of them.
struct MovingBody {
  const Mesh& mesh;
  const Scene& scene;
  Points theta;

  MovingBody(const Mesh& on, const Scene& under, double size, unsigned seed)
      : mesh(on), scene(under), theta(2, static_cast<Eigen::Index>(on.points.size())) {
    for (Eigen::Index v = 0; v < theta.cols(); ++v) theta.col(v) = size * Vec2(noise(seed), noise(seed));
  }
  Model at(double t) const {
    Mesh moved = mesh;
    for (std::size_t i = 0; i < moved.points.size(); ++i)
      moved.points[i] += t * theta.col(static_cast<Eigen::Index>(i));
    return prepare(std::move(moved), element("bdms", 1), scene, 1);
  }
  /// dJ/dt at 0 by central differences of fourth order.
  double slope(const Functional& j, double step) const {
    const auto value = [&](double t) {
      const Model m = at(t);
      return analyze(j, m, solve(m), true).value;
    };
    return (8 * (value(step) - value(-step)) - (value(2 * step) - value(-2 * step))) / (12 * step);
  }
};

// Loads in equilibrium hold the body: what they lose of it on moved edges is balanced by a body force.
TEST(ShapeGradientOf, AFloatingBody) {
  Shape shape = rectangle({-1, -1}, {1, 1});
  shape.labels.push_back("hole");
  shape.holes = {circle("hole", hole_center, hole_radius, 4)};
  const Mesh mesh = triangulate(shape, {.size = 0.4});
  Scene scene;
  scene.material = plane_stress(1, 0.3);
  const Mat2 stress = (Mat2() << 1, 0.4, 0.4, 0.7).finished();
  for (Index label = 0; label < 4; ++label)
    scene.tractions.push_back(
        {label, [=](const Vec2& x, const Vec2& n) -> Vec2 { return (1 + 0.3 * x.squaredNorm()) * (stress * n); }});
  const MovingBody body(mesh, scene, 0.05, 3);
  for (const Functional& j :
       {Functional{"", {energy()}}, Functional{"", {compliance()}}, Functional{"", {stress_pnorm(4, {}, false)}}}) {
    const Model model = body.at(0);
    EXPECT_FALSE(model.inner->floating.empty());
    const State state = solve(model);
    const Analysis a = analyze(j, model, state);
    const double expected = body.slope(j, 2e-3);
    EXPECT_NEAR(shape_gradient(a, j).cwiseProduct(body.theta).sum() / expected, 1, 1e-7) << j.terms[0].kind;
  }
}

// -dPi/d(tip) is the energy release rate, by the interaction integrals of crack_tips and by the functional.
TEST(ShapeGradientOf, ATipIsItsEnergyReleaseRate) {
  const Mesh mesh = triangulate(cracked_square(), {.size = 0.1, .crack_tip_size = 0.005});
  const Vec2 end(0.4, 0);
  constexpr std::array<double, 2> ring = {0.06, 0.2};
  for (const bool closing : {false, true})
    for (const double nu : {0.3, 0.499999}) {
      const Model model =
          prepare(mesh, element("bdms", 2), pulled(plane_strain(1, nu), closing ? closes_half : opens), 2);
      const State state = solve(model);
      const Functional potential{"", {energy()}}, rate{"", {energy_release_rate(end, {1, 0}, ring, {})}};
      const Points gradient = shape_gradient(analyze(potential, model, state), potential);
      double along = 0;
      for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        const double t = std::clamp(((mesh.points[v] - end).norm() - ring[0]) / (ring[1] - ring[0]), 0.0, 1.0);
        along += (1 - t * t * t * (10 - 15 * t + 6 * t * t)) * gradient(0, static_cast<Eigen::Index>(v));
      }
      EXPECT_NEAR(-along / analyze(rate, model, state, true).value, 1, 2e-3) << closing << nu;
      EXPECT_NEAR(-along / crack_tips(model, state).at(1).G, 1, 5e-3) << closing << nu;
    }
}

// A crack along an arc whose law knows the true normal: frames turn with the place, not with the edge. Faces slide.
TEST(ShapeGradientOf, ACurvedCrack) {
  const Vec2 center(0, -0.6);
  Shape shape = rectangle({-1, -1}, {1, 1});
  shape.cracks = {arc_crack("arc", center, 0.7, 0.6, 2.4)};
  const Mesh mesh = triangulate(shape, {.size = 0.3, .crack_tip_size = 0.1});
  for (const auto& [closed, fluid] : {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
    Scene scene = pulled(plane_strain(1, 0.3), [closed = closed](const Vec2& x) -> Vec2 {
      return {0.4, closed ? -1 - 0.2 * x.x() : 1 + 0.2 * x.x()};
    });
    scene.laws[0].normal = [center](const Vec2& x) { return Vec2((x - center).normalized()); };
    if (fluid) scene.laws[0].pressure = [](const Vec2& x, const Vec2&) { return Vec2(0.2 + 0.1 * x.x() * x.y(), 0); };
    const MovingBody body(mesh, scene, 0.1, 5);
    for (const Functional& j : {Functional{"", {energy()}}, Functional{"", {boundary_tracking(2, {}, {})}},
                                Functional{"", {closed ? crack_pressure(0, {}, {}) : crack_opening(0, {})}}}) {
      const Model model = body.at(0);
      const State state = solve(model);
      const Analysis a = analyze(j, model, state);
      const double expected = body.slope(j, 1e-3);
      EXPECT_NEAR(shape_gradient(a, j).cwiseProduct(body.theta).sum() / expected, 1, 1e-6)
          << j.terms[0].kind << closed << fluid;
    }
  }
}

// The upper piece lies in a groove of the lower one, held by contact alone.
TEST(ShapeGradientOf, APieceThatContactHolds) {
  Shape shape = rectangle({-1, -1}, {1, 1});
  shape.labels.push_back("hole");
  shape.holes = {circle("hole", {-0.3, -0.55}, 0.2, 4), circle("upper", {0.2, 0.5}, 0.2, 4)};
  shape.cracks = {{"groove", {Vec2(-1, 0.2), Vec2(0, -0.15), Vec2(1, 0.2)}}};
  const Mesh mesh = triangulate(shape, {.size = 0.25});
  for (const double friction : {0.0, 0.1}) {
    Scene scene;
    scene.material = plane_strain(1, 0.3);
    scene.laws = {{.friction = friction}};
    scene.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
    scene.tractions = {{2, [](const Vec2& x, const Vec2&) { return Vec2(0.02, -1 - 0.1 * x.x()); }}};
    const MovingBody body(mesh, scene, 0.05, 11);
    const Model model = body.at(0);
    EXPECT_FALSE(model.inner->semicoercive.empty());
    const State state = solve(model);
    ASSERT_TRUE(certified(state));
    for (const Functional& j : {Functional{"", {energy()}}, Functional{"", {compliance()}},
                                Functional{"", {displacement_tracking({}, {})}}}) {
      const Analysis a = analyze(j, model, state);
      const double expected = body.slope(j, 2e-4);
      EXPECT_NEAR(shape_gradient(a, j).cwiseProduct(body.theta).sum() / expected, 1, 1e-6)
          << j.terms[0].kind << friction;
    }
  }
}

TEST(ShapeGradientOf, TheBitsDoNotDependOnTheThreads) {
  const Mesh mesh = triangulate(cracked_square(), {.size = 0.1});
  const Functional j{"", {compliance(), stress_pnorm(4, {}, true), volume()}};
  std::vector<Points> gradients;
  for (const int threads : {1, 3}) {
    const Model model = prepare(mesh, element("bdms", 1), pulled(plane_strain(1, 0.3), opens), threads);
    const State state = solve(model);
    gradients.push_back(shape_gradient(analyze(j, model, state), j));
  }
  ASSERT_GT(mesh.triangles.size(), 2000u);  // or one thread does it all
  EXPECT_TRUE(gradients[0] == gradients[1]);
}

// Constant fields move everything: what does not depend on the place does not change.
TEST(ShapeGradientOf, ATranslationIsNothing) {
  const Mesh mesh = triangulate(cracked_square(), {.size = 0.2});
  const Functional j{"", {compliance(), stress_pnorm(4, {}, true), volume(), crack_opening(0, {})}};
  const Model model =
      prepare(mesh, element("bdms", 1), pulled(plane_strain(1, 0.3), [](const Vec2&) { return Vec2(0.1, 1); }), 1);
  const State state = solve(model);
  const Points gradient = shape_gradient(analyze(j, model, state), j);
  EXPECT_LT(gradient.rowwise().sum().norm(), 1e-9 * gradient.norm());
}

// A load that is defined below the top only; and one that is defined nowhere else.
TEST(ShapeGradientOf, DataThatEndAtTheBoundary) {
  const Mesh mesh = triangulate(cracked_square(), {.size = 0.3});
  const Functional j{"", {compliance()}};
  const auto gradient_of = [&](const VectorField& top) {
    const Model model = prepare(mesh, element("bdms", 1), pulled(plane_strain(1, 0.3), top), 1);
    const State state = solve(model);
    return shape_gradient(analyze(j, model, state), j);
  };
  const auto load = [](const Vec2& x) { return Vec2(0.1, 1 + x.x() * x.y()); };
  const double nowhere = std::nan("");
  const Points everywhere = gradient_of(load),
               below = gradient_of([=](const Vec2&x) { return x.y() > 1 ? Vec2(nowhere, nowhere) : load(x); });
  EXPECT_LT((everywhere - below).cwiseAbs().maxCoeff(), 1e-7 * everywhere.cwiseAbs().maxCoeff());
  try {
    gradient_of([=](const Vec2& x) { return x.y() == 1 ? load(x) : Vec2(nowhere, nowhere); });
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Numerics);
  }
}

// A weight that jumps a hair beside a quadrature point, or a little farther away.
TEST(ShapeGradientOf, AWeightThatJumps) {
  const Scenario s{"open"};
  const Model model = model_of(s, body_mesh());
  const State state = solve(model);
  const Triangle shape = triangle(model, 20);
  const double size = std::sqrt(area(shape)), at = rule_points(triangle_rule(8), shape)(0, 5);
  std::vector<Points> gradients;
  for (const double away : {2e-5, 2e-4}) {
    const double end = at + away * size;
    const Functional j{"", {displacement_tracking({}, [end](const Vec2& x) { return x.x() > end ? 1 : 0; })}};
    gradients.push_back(shape_gradient(analyze(j, model, state), j));
  }
  EXPECT_LT((gradients[0] - gradients[1]).cwiseAbs().maxCoeff(), 1e-6 * gradients[0].cwiseAbs().maxCoeff());
}

TEST(ShapeGradientOf, OtherElementsAreRefused) {
  for (const char* name : {"arnold-winther", "arnold-winther-nc", "p2"}) {
    Shape shape = rectangle({-1, -1}, {1, 1});
    Scene scene = pulled(plane_strain(1, 0.3), opens);
    scene.laws.clear();
    const Model model = prepare(triangulate(shape, {.size = 0.5}), element(name), scene, 1);
    const State state = solve(model);
    const Functional j{"", {energy()}};
    try {
      shape_gradient(analyze(j, model, state), j);
      ADD_FAILURE() << name;
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Usage);
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, ShapeGradient,
    testing::Values(
        Scenario{"open"}, Scenario{.name = "partly", .crack = Scenario::Crack::Partly},
        Scenario{.name = "closed", .crack = Scenario::Crack::Closed}, Scenario{.name = "fixed", .prescribed = false},
        Scenario{.name = "nu499999", .poisson = 0.499999},
        Scenario{.name = "nu499999_partly", .poisson = 0.499999, .crack = Scenario::Crack::Partly},
        Scenario{.name = "nu499999_closed", .poisson = 0.499999, .crack = Scenario::Crack::Closed},
        Scenario{.name = "nu5", .poisson = 0.5}, Scenario{.name = "degree2", .degree = 2},
        Scenario{.name = "degree3", .degree = 3, .crack = Scenario::Crack::Partly, .step = 1e-4},
        Scenario{.name = "peers", .element = "peers", .crack = Scenario::Crack::Partly},
        Scenario{.name = "afw", .element = "afw", .crack = Scenario::Crack::Partly},
        Scenario{.name = "bdmsc", .element = "bdms-c"}, Scenario{.name = "fluid", .fluid = true},
        Scenario{.name = "bonded", .crack = Scenario::Crack::Bonded},
        Scenario{.name = "fluid_partly", .crack = Scenario::Crack::Partly, .fluid = true},
        Scenario{.name = "fluid_closed", .degree = 2, .crack = Scenario::Crack::Closed, .fluid = true},
        Scenario{.name = "gap", .crack = Scenario::Crack::Closed, .step = 1e-4, .gap = true},
        Scenario{.name = "gap_degree2", .degree = 2, .crack = Scenario::Crack::Partly, .step = 1e-4, .gap = true},
        Scenario{.name = "friction", .crack = Scenario::Crack::Closed, .step = 1e-4, .friction = 0.1},
        Scenario{.name = "friction_partly", .crack = Scenario::Crack::Partly, .step = 1e-4, .friction = 0.2},
        Scenario{.name = "friction_gap", .crack = Scenario::Crack::Closed, .step = 1e-4, .gap = true, .friction = 0.1}),
    name_of);

}  // namespace
}  // namespace kerf::shape_gradient_test
