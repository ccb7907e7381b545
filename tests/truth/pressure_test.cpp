// A fluid's pressure in cracks: against the same body without it under a uniform state more, which is exact for any
// body and any mesh, and against closed forms.

#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"
#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "kerf/recover.hpp"
#include "solver/saddle_point.hpp"
#include "solver/system.hpp"
#include "tests/support/exact_families.hpp"
#include "tests/truth/scene.hpp"

#include <cmath>

namespace kerf::pressure_test {
namespace {

const Material steel = plane_strain(1000, 0.3);
using Law = CrackLaw::Kind;

Shape rectangle(const Vec2& low, const Vec2& high, std::vector<Crack> cracks) {
  Shape shape{.outline = polygon("outline", {low, {high.x(), low.y()}, high, {low.x(), high.y()}}, 0),
              .holes = {},
              .cracks = std::move(cracks),
              .labels = {"bottom", "right", "top", "left"}};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[static_cast<std::size_t>(i)].label = i;
  return shape;
}

BoundaryField uniform(double p) {
  return [p](const Vec2&, const Vec2&) { return Vec2(p, 0); };
}

struct Body {
  std::string name;
  std::vector<Crack> cracks;
  Material material = steel;
};
const Body straight{"straight", {{"c", {{0.35, 0.4}, {0.75, 0.55}}}}};
const Body kinked{"kinked", {{"c", {{0.3, 0.4}, {0.6, 0.45}, {0.85, 0.6}}}}};
const Body curved{"curved", {arc_crack("c", {0.5, 0.3}, 0.3, 0.5, 2.2)}};
const Body crossing{"crossing", {{"c", {{0.3, 0.5}, {0.7, 0.5}}}, {"d", {{0.45, 0.3}, {0.55, 0.75}}}}};
const Body edge{"edge", {{"c", {{0, 0.5}, {0.4, 0.6}}}}};
const Body incompressible{"incompressible", straight.cracks, plane_strain(1000, 0.5)};

/// In the body under tractions t: a pressure in its cracks, or instead tractions p n on all its outline.
struct Pair {
  Model pressed, pulled;
};
Pair pair_of(const Body& body, const Element& e, CrackLaw law, double p, const BoundaryField& t) {
  const Shape shape = rectangle({0, 0}, {1.2, 1}, body.cracks);
  const Mesh mesh = triangulate(shape, {.size = 0.12, .crack_tip_size = 0.03});
  const auto model = [&](bool inside) {
    Scene scene{.material = body.material, .regions = {}, .body = {}, .supports = {}, .tractions = {}, .laws = {}};
    for (Index label = 0; label < 4; ++label)
      scene.tractions.push_back(
          {label, [=](const Vec2& x, const Vec2& n) -> Vec2 { return t(x, n) + (inside ? 0 : p) * n; }});
    for (const Crack& crack : body.cracks) {
      CrackLaw own = law;
      if (crack.arc)
        own.normal = [center = crack.arc->center](const Vec2& x) { return (x - center).normalized().eval(); };
      if (inside) own.pressure = uniform(p);
      scene.laws.push_back(own);
    }
    return prepare(mesh, e, std::move(scene), 1);
  };
  return {model(true), model(false)};
}

const BoundaryField no_traction = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
/// In equilibrium; closes a part of a crack along x, and shears it.
const BoundaryField bending = [](const Vec2& x, const Vec2& n) -> Vec2 {
  return Vec2(0.4 * n.y(), 0.4 * n.x() + (3 * (x.x() - 0.55) - 0.2) * n.y());
};

/// The states differ by a uniform pressure, and by nothing else that is measured.
void expect_superposed(const Pair& of, const State& a, const State& b, double p) {
  constexpr double precise = 1e-7;
  ASSERT_TRUE(a.converged && b.converged);
  EXPECT_LT(a.certificate.work, 1e-8);
  double stress = 0;
  for (Index t = 0; t < static_cast<Index>(of.pressed.mesh.triangles.size()); ++t) {
    const Points x = centroid(of.pressed.mesh, t);
    const Eigen::Vector4d difference =
        evaluate(of.pressed, a, t, x).stress.col(0) - evaluate(of.pulled, b, t, x).stress.col(0);
    stress = std::max(stress, (difference + p * Eigen::Vector4d(1, 0, 0, 1)).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(stress, precise);
  for (Index c = 0; c < static_cast<Index>(of.pressed.mesh.cracks.size()); ++c) {
    const auto with = crack_profile(of.pressed, a, c), without = crack_profile(of.pulled, b, c);
    double open = 0;
    for (const CrackPoint& q : without) open = std::max({open, std::abs(q.jump_n), std::abs(q.jump_t)});
    for (std::size_t i = 0; i < with.size(); ++i) {
      EXPECT_NEAR(with[i].jump_n, without[i].jump_n, precise * open);
      EXPECT_NEAR(with[i].jump_t, without[i].jump_t, precise * open);
      EXPECT_NEAR(with[i].sigma_n, without[i].sigma_n - p, precise);
      EXPECT_NEAR(with[i].sigma_t, without[i].sigma_t, precise);
      EXPECT_NEAR(with[i].contact_pressure(), without[i].contact_pressure(), precise);
      EXPECT_EQ(with[i].status, without[i].status);
    }
  }
  const auto with = crack_tips(of.pressed, a), without = crack_tips(of.pulled, b);
  ASSERT_FALSE(with.empty());
  for (std::size_t i = 0; i < with.size(); ++i) {
    if (with[i].radius == 0) continue;
    EXPECT_NEAR(with[i].K_I, without[i].K_I, precise);
    EXPECT_NEAR(with[i].K_II, without[i].K_II, precise);
    EXPECT_NEAR(with[i].T, without[i].T, precise);
  }
}

TEST(Pressure, IsAUniformStateMoreWhateverTheCrackAndTheElement) {
  const double p = 0.7;
  for (const Element& e : elements) {
    if (!can_press_cracks(e)) continue;
    for (const Body& body : {straight, kinked, curved, crossing, edge}) {
      if (e.degree == 3 && body.name != "curved") continue;
      SCOPED_TRACE(testing::Message() << e.name << e.degree << ' ' << body.name);
      const Pair of = pair_of(body, e, {.kind = Law::Open}, p, no_traction);
      expect_superposed(of, solve(of.pressed), solve(of.pulled), p);
    }
  }
}

TEST(Pressure, IsAUniformStateMoreInContactToo) {
  const double p = 0.2;
  for (const Body& body : {straight, kinked, curved, crossing, incompressible})
    for (const double friction : {0.0, 0.4})
      for (const auto method : {ContactMethod::DualQp, ContactMethod::ActiveSet, ContactMethod::Uzawa}) {
        if (friction > 0 && method == ContactMethod::Uzawa) continue;
        SCOPED_TRACE(testing::Message() << body.name << ' ' << friction << ' ' << static_cast<int>(method));
        const Pair of = pair_of(body, element("bdms"), {.friction = friction}, p, bending);
        const State a = solve(of.pressed, method), b = solve(of.pulled, method);
        EXPECT_LT(a.certificate.kkt, 1e-8);
        expect_superposed(of, a, b, p);
        std::size_t closed = 0, open = 0;
        for (const CrackPoint& q : crack_profile(of.pressed, a, 0))
          ++(q.status == CrackPoint::Status::Closed ? closed : open);
        EXPECT_GT(closed, 3U);
        EXPECT_GT(open, 3U);
      }
}

TEST(Pressure, SaddlePointAgrees) {
  for (const char* name : {"bdms", "peers", "afw"})
    for (const Body& body : {straight, curved}) {
      if (body.name == "curved" && std::string(name) != "bdms") continue;
      SCOPED_TRACE(testing::Message() << name << ' ' << body.name);
      const Pair of = pair_of(body, element(name), {.friction = 0.3}, 0.2, bending);
      const State a = solve_saddle_point(of.pressed), condensed = solve(of.pressed);
      expect_superposed(of, a, solve_saddle_point(of.pulled), 0.2);
      EXPECT_NEAR(potential_energy(of.pressed, a), potential_energy(of.pressed, condensed),
                  1e-8 * std::abs(potential_energy(of.pressed, condensed)));
      EXPECT_LT((a.force - condensed.force).cwiseAbs().maxCoeff(), 1e-8);
    }
}

/// The exact displacement of an infinite plate, less a uniform pressure p, on the outline of a square around a crack.
Model in_infinite_plate(const exact::ExactField& f, Crack crack, CrackLaw law, double p, const Sizing& sizing) {
  const Shape shape = rectangle({-2, -2}, {2, 2}, {std::move(crack)});
  Mesh mesh = triangulate(shape, sizing);
  Scene scene{.material = f.material, .regions = {}, .body = {}, .supports = {}, .tractions = {}, .laws = {law}};
  const Mat2 strained = strain(f.material, Mat2(-p * Mat2::Identity()));
  for (Index label = 0; label < 4; ++label)
    scene.supports.push_back({label, false, true, true, [f, strained](const Vec2& x, const Vec2&) -> Vec2 {
                                return f.displacement(x, exact::side_of(f, x)) + strained * x;
                              }});
  return prepare(std::move(mesh), element("bdms", 2), std::move(scene), 2);
}

// K_I = p sqrt(pi a), T = 0.
TEST(Pressure, StraightCrackInAnInfinitePlate) {
  const double p = 1.3;
  const exact::ExactField f = exact::line_crack("pressed", steel, exact::under(Mat2(p * Mat2::Identity()), 0.4, 1));
  const Vec2 end(std::cos(0.4), std::sin(0.4));
  for (const Law kind : {Law::Open, Law::Unilateral}) {
    const Model m = in_infinite_plate(f, {"c", {-end, end}}, {.kind = kind, .pressure = uniform(p)}, p,
                                      {.size = 0.3, .crack_tip_size = 0.005});
    const State s = solve(m);
    for (const TipIntensity& t : crack_tips(m, s)) {
      EXPECT_NEAR(t.K_I / (p * std::sqrt(pi)), 1, 2e-4);
      EXPECT_NEAR(t.K_II, 0, 2e-4);
      EXPECT_NEAR(t.T, 0, 5e-3);
      EXPECT_NEAR(t.J / t.G, 1, 5e-3);
      EXPECT_LT(t.spread, 1e-3);
    }
  }
}

TEST(Pressure, CrackAlongAnArcInAnInfinitePlate) {
  const double p = 1, radius = 1, half = 0.7;
  const exact::ExactField f =
      exact::arc_crack("pressed", steel, {.far_stress = p * Mat2::Identity(), .radius = radius, .half_angle = half});
  CrackLaw law{
      .kind = Law::Open, .normal = [](const Vec2& x) { return x.normalized().eval(); }, .pressure = uniform(p)};
  const Model m = in_infinite_plate(f, arc_crack("c", {0, 0}, radius, half, -half), law, p,
                                    {.size = 0.15, .crack_tip_size = 0.005});
  const std::vector<TipIntensity> tips = crack_tips(m, solve(m));
  for (std::size_t i = 0; i < 2; ++i) {
    const double size = std::hypot(f.tips[i].k1, f.tips[i].k2);
    EXPECT_NEAR(tips[i].K_I, f.tips[i].k1, 3e-3 * size);
    EXPECT_NEAR(tips[i].K_II, f.tips[i].k2, 3e-3 * size);
    EXPECT_NEAR(tips[i].J / tips[i].G, 1, 2e-2);
  }
}

// K_II = tau - f (s_n - p) times sqrt(pi a): friction takes what presses beyond the fluid.
TEST(Pressure, TakesWeightOffFriction) {
  const double angle = 0.5, friction = 0.5, normal = 1, fluid = 0.4;
  const Vec2 t(std::cos(angle), std::sin(angle)), n(-t.y(), t.x());
  const Mat2 far = -normal * n * n.transpose() + t * n.transpose() + n * t.transpose();
  const exact::ExactField f =
      exact::friction_crack("pore", steel,
                            {.far_stress = far, .angle = angle, .half = 1, .limit = friction * (normal - fluid)})
          .field;
  const Model m = in_infinite_plate(f, {"c", {-t, t}}, {.friction = friction, .pressure = uniform(fluid)}, 0,
                                    {.size = 0.2, .crack_tip_size = 0.005, .mirrored_tips = true});
  const State s = solve(m);
  const double wanted = (1 - friction * (normal - fluid)) * std::sqrt(pi);
  for (const TipIntensity& tip : crack_tips(m, s)) {
    EXPECT_NEAR(std::abs(tip.K_II) / wanted, 1, 1e-3);
    EXPECT_NEAR(tip.K_I, 0, 1e-3);
    EXPECT_NEAR(tip.J / tip.G, 1, 2e-2);
  }
  for (const CrackPoint& q : crack_profile(m, s, 0)) {
    if (std::abs(q.s - 1) > 0.8) continue;
    EXPECT_NEAR(q.contact_pressure(), normal - fluid, 1e-3);
    EXPECT_NEAR(q.sigma_n, -normal, 1e-3);
    EXPECT_NEAR(std::abs(q.sigma_t), friction * (normal - fluid), 1e-3);
  }
}

std::string wide_plate(double half, const std::string& crack) {
  return fmt::format(R"(
[domain]
outline = [[-{0}, -{0}], [{0}, -{0}], [{0}, {0}], [-{0}, {0}]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1
poisson = 0.3
[mesh]
size = {1}
crack_tip_size = 0.01
[solver]
degree = 2
)",
                     half, half / 4) +
         crack;
}

// p = p0 x/a, open: K = +-p0/2 sqrt(pi a). In contact the crack is one from -a/3 to a, and K (2/3)^(3/2) p0 sqrt(pi a).
TEST_F(Truth, PressureThatRisesAlongTheCrack) {
  const std::string crack = R"(
[[crack]]
name = "c"
path = [[-1, 0], [1, 0]]
pressure = "0.01 * x"
contact = ")";
  const double whole = 0.01 * std::sqrt(pi);
  const nlohmann::json open = run_scene(wide_plate(40, crack + "open\"\n"))["cracks"][0];
  EXPECT_NEAR(open["tips"][0]["K_I"].get<double>() / whole, -0.5, 1e-3);
  EXPECT_NEAR(open["tips"][1]["K_I"].get<double>() / whole, 0.5, 1e-3);
  const nlohmann::json closing = run_scene(wide_plate(40, crack + "unilateral\"\n"));
  const nlohmann::json& c = closing["cracks"][0];
  EXPECT_EQ(c["tips"][0]["K_I"], 0);
  EXPECT_NEAR(c["tips"][1]["K_I"].get<double>() / whole, std::pow(2.0 / 3, 1.5), 1e-3);
  ASSERT_EQ(c["transitions"].size(), 1U);
  EXPECT_NEAR(c["transitions"][0]["at"][0].get<double>(), -1.0 / 3, 5e-3);
  EXPECT_NEAR(std::abs(c["fluid_pressure"].get<double>()), 0.01, 1e-4);
  EXPECT_EQ(closing["status"], "ok");
}

// 1.1215 p sqrt(pi a) at the edge of a half plane.
TEST_F(Truth, PressureInACrackFromTheEdge) {
  const nlohmann::json r = run_scene(R"(
[domain]
outline = [[0, -400], [400, -400], [400, 400], [0, 400]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[0, 0], [1, 0]]
pressure = 0.01
[material]
young = 1
poisson = 0.3
[mesh]
size = 100
crack_tip_size = 0.01
[solver]
degree = 2
)");
  EXPECT_NEAR(r["cracks"][0]["tips"][0]["K_I"].get<double>() / (0.01 * std::sqrt(pi)), 1.1215, 5e-4);
  const double energy = r["state"]["energy"], compliance = r["state"]["compliance"];
  EXPECT_NEAR(compliance, -2 * energy, 1e-10 * compliance);
}

// Pressed together by s > p: contact bears s - p all along.
TEST_F(Truth, PressureUnderCompression) {
  const nlohmann::json r = run_scene(R"(
[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[0.5, 0.5], [1.5, 0.5]]
pressure = 0.3
[material]
young = 1
poisson = 0.3
[[boundary]]
on = ["bottom", "top"]
pressure = 1
[mesh]
size = 0.25
)");
  EXPECT_NEAR(r["cracks"][0]["max_pressure"].get<double>(), 0.7, 1e-10);
  EXPECT_NEAR(r["contact"]["closed_length"].get<double>(), 1, 1e-12);
  EXPECT_NEAR(r["cracks"][0]["tips"][1]["K_I"].get<double>(), 0, 1e-10);
  EXPECT_NEAR(r["cracks"][0]["tips"][1]["T"].get<double>(), 1, 1e-8);  // s_xx - s_yy
}

// The energy bounds hold that of far better solutions by other elements, whatever the pressure.
TEST(Pressure, BoundsHoldTheEnergy) {
  const Shape shape = rectangle({0, 0}, {1.2, 1}, {{"c", {{0.3, 0.4}, {0.8, 0.6}}}, {"d", {{0.5, 0.2}, {0.9, 0.2}}}});
  const auto scene = [](Law law) {
    Scene s{.material = steel, .regions = {}, .body = {}, .supports = {}, .tractions = {}, .laws = {}};
    s.supports.push_back({0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
    s.tractions.push_back({2, [](const Vec2& x, const Vec2& n) -> Vec2 { return (x.x() - 0.5) * n; }});
    CrackLaw first{.kind = law}, second{.kind = law};
    first.pressure = [](const Vec2& x, const Vec2&) { return Vec2(std::exp(3 * x.x()) * 0.05, 0); };
    second.pressure = [](const Vec2& x, const Vec2&) { return Vec2(std::sin(9 * x.x()), 0); };
    s.laws = {first, second};
    return s;
  };
  for (const Law law : {Law::Open, Law::Unilateral}) {
    const Model fine =
        prepare(triangulate(shape, {.size = 0.06, .crack_tip_size = 2e-4}), element("afw", 3), scene(law), 2);
    const double truth = potential_energy(fine, solve(fine));
    for (const char* name : {"bdms", "afw"})
      for (const int degree : {1, 2}) {
        SCOPED_TRACE(testing::Message() << name << degree << ' ' << static_cast<int>(law));
        const Model m =
            prepare(triangulate(shape, {.size = 0.2, .crack_tip_size = 0.01}), element(name, degree), scene(law), 2);
        const EnergyBounds b = energy_bounds(m, solve(m));
        EXPECT_TRUE(b.guaranteed) << b.note;
        EXPECT_LE(b.lower, truth);
        EXPECT_GE(b.upper, truth);
        EXPECT_LT(b.upper - b.lower, (degree == 1 ? 0.2 : 0.05) * std::abs(truth));
        EXPECT_LT(b.imbalance, 1e-8);
      }
  }
}

// The estimate sees a pressure that the mesh does not resolve, and refines until another element agrees.
TEST(Pressure, MeshesAdaptToIt) {
  const Shape shape = rectangle({0, 0}, {1.2, 1}, {{"c", {{0.3, 0.5}, {0.9, 0.5}}}});
  Scene scene{.material = steel, .regions = {}, .body = {}, .supports = {}, .tractions = {}, .laws = {}};
  CrackLaw law{.kind = Law::Open};
  law.pressure = [](const Vec2& x, const Vec2&) { return Vec2(1 + std::sin(60 * x.x()), 0); };
  scene.laws = {law};
  const Adapted a = solve_adaptively(shape, {.size = 0.2}, element("bdms"), scene, {.error = 0.03, .threads = 2});
  ASSERT_TRUE(a.stopped.starts_with("reached")) << a.stopped;
  const Model fine = prepare(triangulate(shape, {.size = 0.03, .crack_tip_size = 1e-4}), element("bdms", 3), scene, 2);
  const double truth = strain_energy(fine, solve(fine));
  EXPECT_NEAR(strain_energy(a.model, a.state) / truth, 1, 2 * 0.03 * 0.03);
}

}  // namespace
}  // namespace kerf::pressure_test
