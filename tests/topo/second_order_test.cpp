// The second term against discs whose series are exact, against the showcase on better meshes, and by other routes.

#include "kerf/second_order.hpp"
#include "topo/map/valid_radius.hpp"

#include "kerf/map.hpp"
#include "kerf/mesher.hpp"
#include "tests/topo/disc_series.hpp"
#include "tests/topo/validation.hpp"
#include "topo/formulas/second_term.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>

namespace kerf::second_order_test {
namespace {

using nlohmann::json;
using series::Complex;
using Kind = Perturbation::Kind;

constexpr Index rim = 0;
const Functional potential{"energy", {energy()}};

Perturbation inclusion(const Material& m) {
  return {Kind::Inclusion, m};
}

struct Solved {
  Model model;
  State state;
};
Solved solved(const Shape& shape, const Sizing& sizing, const Scene& scene, int degree = 2) {
  Model m = prepare(triangulate(shape, sizing), element("bdms", degree), scene, 1);
  State s = solve(m);
  EXPECT_TRUE(certified(s));
  return {std::move(m), std::move(s)};
}

Shape disc() {
  Shape shape;
  shape.labels = {"rim"};
  shape.outline = circle("rim", {0, 0}, 1, rim);
  return shape;
}

double parts(const SecondOrder& s) {
  return std::abs(s.mean_gradient) + std::abs(s.deviator_gradient) + std::abs(s.curvature) + std::abs(s.reply);
}

// Every term of phi and psi up to the degree 4, nothing symmetric.
const series::Polynomial loads{{Complex(.4, 0), Complex(.3, -.2), Complex(-.15, .1), Complex(.08, .05)},
                               {Complex(.5, -.3), Complex(-.2, .25), Complex(.1, .12), Complex(.05, -.04)}};

class SeriesDisc : public testing::TestWithParam<Material> {};

// The series by other means than expansions, extrapolated in even powers: T and c2 of holes and inclusions of contrast
// 1e-6 to 1e6, at the center, beside it and near the rim.
TEST_P(SeriesDisc, GivesTheSecondTerm) {
  const Material m = GetParam();
  Scene scene{.material = m};
  scene.tractions.push_back(
      {rim, [](const Vec2& x, const Vec2& n) -> Vec2 { return series::stress(loads, Complex(x.x(), x.y())) * n; }});
  const Solved s = solved(disc(), {.size = 0.05}, scene);
  const Analysis a = analyze(potential, s.model, s.state);
  std::vector<std::optional<Material>> inside{std::nullopt};
  for (const double contrast : {1e-6, 0.2, 5., 1e6}) inside.push_back(stiffened(m, contrast));
  inside.push_back(plane_strain(2, 0.1));
  for (const Complex x : {Complex(0, 0), Complex(.3, .1), Complex(-.2, .6)})
    for (const auto& in : inside) {
      const Perturbation p = in ? inclusion(*in) : Perturbation{};
      const series::Limits exact = series::limits(m, in, x, loads, 0.2 * (1 - std::abs(x)));
      const SecondOrder found = second_order(a, potential, p, {x.real(), x.imag()});
      SCOPED_TRACE(fmt::format("{} {}, mu {}: {} {}", x.real(), x.imag(), in ? in->mu : 0, found.c2, exact.c2));
      ASSERT_TRUE(found.available) << found.note;
      EXPECT_NEAR(found.T, exact.T, 2e-6 * std::abs(exact.T));
      EXPECT_NEAR(found.c2, exact.c2, 1e-4 * parts(found));
      EXPECT_EQ(found.logarithm, Logarithm::Absent);
      EXPECT_EQ(found.c3, 0);
    }
}
INSTANTIATE_TEST_SUITE_P(Materials, SeriesDisc,
                         testing::Values(plane_strain(1, 0.3), plane_stress(2, 0.3), plane_strain(1, 0.49)));

// topological_derivatives.json has the coefficient of eps^4 of a change at the center to 20 digits, under tractions
// and, what the supports of the reply are for, under displacements of the rim.
TEST(SecondOrder, AgreesWithExactDiscs) {
  const json file = json::parse(std::ifstream(std::string(KERF_TEST_DATA) + "/topological_derivatives.json"));
  const auto number = [](const json& j) { return std::stod(j.get<std::string>()); };
  int count = 0;
  for (const json& c : file.at("exact")) {
    const std::string name = c.at("name");
    const bool track = name.ends_with("domain_L2_track");
    if (!c.contains("coef_eps4") || (!name.ends_with("compliance") && !name.ends_with("energy") && !track)) continue;
    if (name.starts_with("clamped")) continue;
    ++count;
    SCOPED_TRACE(name);
    const json& p = c.at("problem");
    const bool strain = p.at("plane") == "strain";
    const auto material = [&](double young, double poisson) {
      return strain ? plane_strain(young, poisson) : plane_stress(young, poisson);
    };
    const bool held = p.contains("E_bar");
    const json& d = p.at(held ? "E_bar" : "sigma_bar");
    const Mat2 given = (Mat2() << d[0], d[2], d[2], d[1]).finished();
    const BoundaryField data = [=](const Vec2& x, const Vec2& n) -> Vec2 { return given * (held ? x : n); };
    Scene scene{.material = material(p.at("E"), p.at("nu"))};
    if (held)
      scene.supports.push_back({rim, false, true, true, data});
    else
      scene.tractions.push_back({rim, data});
    const Solved s = solved(disc(), {.size = 0.1}, scene);
    const Functional j{name,
                       {track                      ? displacement_tracking({}, {})
                        : name.ends_with("energy") ? energy()
                                                   : compliance()}};
    const Analysis a = analyze(j, s.model, s.state);
    const Perturbation change =
        name.starts_with("inclusion") ? inclusion(material(p.at("E_star"), p.at("nu_star"))) : Perturbation{};
    const SecondOrder found = second_order(a, j, change, {0, 0});
    if (track) {
      EXPECT_FALSE(found.available);
      EXPECT_EQ(found.logarithm, Logarithm::Known);
      EXPECT_NEAR(found.c3 / (number(c.at("coef_eps4_log_eps")) / pi), 1, 1e-9);
    } else {
      ASSERT_TRUE(found.available) << found.note;
      EXPECT_NEAR(found.c2 / (number(c.at("coef_eps4")) / pi), 1, 1e-4) << found.c2;
    }
  }
  EXPECT_EQ(count, 12);
}

// Clamped on r = 1 under a body force: the exact J of the hole, less T and the even powers, leaves the logarithm.
TEST(SecondOrder, KnowsTheLogarithmOfABodyForce) {
  const Material m = plane_strain(2, 0.3);
  const double kappa = 1.8;
  Scene scene{.material = m};
  scene.body = [](const Vec2&) { return Vec2(0.6, -0.8); };
  scene.supports.push_back({rim, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  const Solved s = solved(disc(), {.size = 0.3}, scene);
  const Analysis a = analyze(potential, s.model, s.state);
  const SecondOrder found = second_order(a, potential, {}, {0.1, 0.2});
  EXPECT_FALSE(found.available);
  EXPECT_EQ(found.logarithm, Logarithm::Known);
  EXPECT_NEAR(found.c3, kappa / (4 * m.mu * (1 + kappa)), 1e-12);
  EXPECT_EQ(second_order(a, potential, inclusion(plane_strain(3, 0.3)), {0.1, 0.2}).logarithm, Logarithm::Unknown);
}

// The plate of cases/cracked_plate.toml, its crack partly closed: c2 of the compliance on the case's mesh against that
// of a mesh of half the size and one degree more, at the points of its table of validations.
TEST(SecondOrder, OfTheShowcaseIsWithinHalfAPercent) {
  Shape shape = scenes::rectangle({-2, -2}, {2, 2});
  shape.labels.emplace_back("holes");
  shape.holes = {circle("h1", {1.1, 1.15}, .3, 4), circle("h2", {-1.2, -1.1}, .22, 4)};
  shape.cracks = {{"c", {Vec2(-1, 0), Vec2(1, 0)}}};
  Scene scene{.material = plane_strain(1000, .3)};
  scene.laws.resize(1);
  scene.supports = {scenes::clamp(0)};
  scene.tractions = {{2, [](const Vec2& x, const Vec2&) -> Vec2 { return {0, 0.1 + x.x()}; }}};
  const Solved s = solved(shape, {.size = .08, .crack_tip_size = .0008}, scene, 1);
  const Functional j{"compliance", {compliance()}};
  const Analysis a = analyze(j, s.model, s.state);
  SecondOrders at(a, j, {});
  struct {
    Vec2 x;
    double c2;
  } const table[] = {{{1.4, -.9}, .015054},
                     {{-.3, .9}, .00082374},
                     {{-1.4, .6}, .010413},
                     {{.5, -.6}, .0015968},
                     {{.2, .3}, .0033889}};
  for (const auto& [x, c2] : table) {
    const SecondOrder found = at.at(x);
    EXPECT_TRUE(found.available) << found.note;
    EXPECT_NEAR(found.c2 / c2, 1, 5e-3) << x.transpose();
    EXPECT_NEAR(found.valid_radius(), std::sqrt(0.05 * std::abs(found.T / found.c2)), 1e-15);
  }
}

scenes::Body pulled_square(const Material& m) {
  return {scenes::cracked_square(), scenes::pulled(m, scenes::opens), {.size = 0.1, .crack_tip_size = 1e-3}};
}

// The work of the loads as a linear functional of the displacement on the boundary has the adjoint that the compliance
// does without.
TEST(SecondOrder, ByAnAdjointIsThatOfTheCompliance) {
  const scenes::Body b = pulled_square(plane_stress(1, 0.3));
  const Solved s = solved(b.shape, b.sizing, b.scene);
  Term work{.kind = "work", .linear = true, .label = 2};
  work.on_boundary = [](const Vec2& x, const Vec2&, const Vec2& u) {
    return Density{.value = scenes::opens(x).dot(u), .by_displacement = scenes::opens(x)};
  };
  const Functional by_adjoint{"work", {work}}, direct{"compliance", {compliance()}};
  const Analysis a = analyze(by_adjoint, s.model, s.state), c = analyze(direct, s.model, s.state);
  ASSERT_TRUE(a.adjoint && !c.adjoint);
  for (const Vec2& x : {Vec2(.15, .4), Vec2(-.5, -.3)}) {
    const SecondOrder one = second_order(a, by_adjoint, {}, x), other = second_order(c, direct, {}, x);
    ASSERT_TRUE(one.available && other.available);
    EXPECT_NEAR(one.c2 / other.c2, 1, 1e-8);
    EXPECT_NEAR(one.T / other.T, 1, 1e-8);
  }
}

// By brute force: the hole meshed. What two terms leave of the opening of a crack beside it falls like eps^6,
// relatively like eps^4.
TEST(SecondOrder, OfACrackOpeningPredictsAMeshedHole) {
  const scenes::Body b = pulled_square(plane_strain(1, 0.49));
  const Functional j{"crack_opening", {crack_opening(0, {})}};
  const Solved s = solved(b.shape, b.sizing, b.scene);
  const Analysis a = analyze(j, s.model, s.state);
  const Vec2 x(.3, .45);
  const SecondOrder found = second_order(a, j, {}, x);
  ASSERT_TRUE(found.available) << found.note;
  std::vector<double> first, second;
  for (const double eps : {.16, .11, .08}) {
    Shape drilled = b.shape;
    drilled.labels.emplace_back("drilled");
    drilled.holes = {circle("drilled", x, eps, 4)};
    const Solved with = solved(drilled, b.sizing, b.scene);
    const double quotient = (analyze(j, with.model, with.state, true).value - a.value) / (pi * eps * eps);
    first.push_back(std::abs(quotient / found.T - 1));
    second.push_back(std::abs(quotient - found.T - found.c2 * eps * eps) / std::abs(found.T));
    EXPECT_LT(second.back(), 0.25 * first.back()) << "eps " << eps << ": " << first.back() << ' ' << second.back();
  }
  const double order = std::log(second[0] / second[2]) / std::log(.16 / .08);
  EXPECT_GT(order, 3.5) << second[0] << ' ' << second[1] << ' ' << second[2];
  EXPECT_LT(order, 4.5);
}

// Interpolated replies and small discs against a reply per point, away from sides and tips.
TEST(SecondOrder, EverywhereAgreesWithPointwise) {
  const scenes::Body b = pulled_square(plane_strain(1, 0.3));
  const Solved s = solved(b.shape, {.size = 0.1, .crack_tip_size = 0.02}, b.scene, 1);
  const Functional j{"compliance", {compliance()}};
  const Analysis a = analyze(j, s.model, s.state);
  const Corners corners = split_for_stress(s.model.mesh);
  const FullMap map = map_everywhere(a, j, {.second = true}, corners);
  EXPECT_TRUE(map.second_note.empty()) << map.second_note;
  ASSERT_EQ(map.c2.size(), map.at_corners.size());
  SecondOrders at(a, j, {});
  std::vector<double> error, of_radius;
  for (Eigen::Index i = 0; i < map.c2.size(); i += 5) {
    const Vec2& x = s.model.mesh.points[corners.vertex[static_cast<std::size_t>(i)]];
    const double away =
        std::min({1 - std::abs(x.x()), 1 - std::abs(x.y()), std::hypot(std::max(0.0, std::abs(x.x()) - 0.4), x.y())});
    if (away < 0.3) continue;
    ASSERT_TRUE(std::isfinite(map.valid_radius[i])) << x.transpose();
    const SecondOrder exact = at.at(x);
    const double clear = away;  // of the tips and the sides
    of_radius.push_back(
        std::abs(map.valid_radius[i] / valid_radius_of({map.at_corners[i], exact.c2, 0, parts(exact), clear}) - 1));
    if (!std::isfinite(map.c2[i])) continue;  // a small rest of its parts
    EXPECT_GT(map.c2[i] * exact.c2, 0) << x.transpose();
    error.push_back(std::abs(map.c2[i] - exact.c2) / parts(exact));
  }
  std::ranges::sort(error);
  std::ranges::sort(of_radius);
  const auto share = [](const std::vector<double>& v, double of) {
    return v[static_cast<std::size_t>(of * static_cast<double>(v.size()))];
  };
  const std::string found = fmt::format("{}: {} {} {}, radius {} {}", error.size(), share(error, 0.5),
                                        share(error, 0.9), error.back(), share(of_radius, 0.5), share(of_radius, 0.9));
  ASSERT_GT(error.size(), 20u);
  EXPECT_LT(share(error, 0.5), 0.02) << found;
  EXPECT_LT(share(error, 0.9), 0.06) << found;
  EXPECT_LT(share(of_radius, 0.5), 0.02) << found;
  EXPECT_LT(share(of_radius, 0.9), 0.06) << found;
  const MapPoint point = map_at(a, j, {.second = true}, std::vector<Vec2>{{.3, .5}}).front();
  EXPECT_EQ(point.c2, at.at({.3, .5}).c2);
  EXPECT_GT(*point.valid_radius, 0);
  const Functional track{"t", {boundary_tracking(2, {}, {})}};
  const FullMap none = map_everywhere(analyze(track, s.model, s.state), track, {.second = true}, corners);
  EXPECT_NE(none.second_note.find("boundary_tracking"), std::string::npos) << none.second_note;
  EXPECT_TRUE(none.c2.array().isNaN().all());
}

// A volume loses the hole and no more: T = -1 up to any radius. An opening has an adjoint and no energy.
TEST(SecondOrder, OfAVolumeAndOfAnOpeningEverywhere) {
  const scenes::Body b = pulled_square(plane_strain(1, 0.3));
  const Solved s = solved(b.shape, {.size = 0.2, .crack_tip_size = 0.05}, b.scene, 1);
  const Corners corners = split_for_stress(s.model.mesh);
  const std::vector<Vec2> at{{.3, .5}};
  const Functional size{"", {volume()}}, opening{"", {crack_opening(0, {})}};
  const Analysis a = analyze(size, s.model, s.state), z = analyze(opening, s.model, s.state);
  const MapPoint point = map_at(a, size, {.radius = 0.2, .second = true}, at).front();
  EXPECT_EQ(point.value, -1);
  EXPECT_EQ(point.c2, 0);
  EXPECT_NEAR(*point.valid_radius, std::hypot(0, 0.5), 1e-9);  // all the way to the next feature
  EXPECT_FALSE(point.masked);                                  // 2.5 radii of room
  EXPECT_TRUE(map_at(a, size, {.radius = 0.3, .second = true}, at).front().masked);
  const FullMap whole = map_everywhere(a, size, {.second = true}, corners);
  const FullMap opened = map_everywhere(z, opening, {.second = true}, corners);
  int known = 0;
  for (Eigen::Index i = 0; i < whole.c2.size(); ++i) {
    if (std::isfinite(whole.c2[i])) {
      EXPECT_EQ(whole.c2[i], 0);
      ++known;
    }
    const Vec2& x = s.model.mesh.points[corners.vertex[static_cast<std::size_t>(i)]];
    if ((x - at[0]).norm() > 0.15 || !std::isfinite(opened.c2[i])) continue;
    const SecondOrder exact = second_order(z, opening, {}, x);
    EXPECT_NEAR(opened.c2[i], exact.c2, 0.1 * parts(exact)) << x.transpose();
  }
  EXPECT_GT(known, 20);
}

TEST(SecondOrder, TellsHowFarTheFirstTermReaches) {
  EXPECT_TRUE(std::isnan(SecondOrder{.T = 1, .c2 = 1}.valid_radius()));
  EXPECT_EQ((SecondOrder{.T = 0, .c2 = 1, .available = true}.valid_radius()), 0);
  EXPECT_EQ((SecondOrder{.T = 1, .c2 = 0, .available = true}.valid_radius()), infinity);
  EXPECT_NEAR((SecondOrder{.T = -1, .c2 = 4, .available = true}.valid_radius(0.09)), 0.15, 1e-15);
}

// No logarithm and no c2: says so by name.
// Under pressure alone a hole of radius 1 in the unit disc sends out u = p/(2 mu) e_r/r. Held at its rim, the disc
// answers by a pressure of 2 mu/(1 - 2 nu) times that displacement; free, by the pressure itself.
TEST(SecondOrder, KnowsWhereTheBodyAnswersByAsMuchStress) {
  for (const double nu : {0.3, 0.499, 0.499999}) {
    const Material m = plane_strain(1, nu);
    Scene held{.material = m}, free{.material = m};
    held.supports = {{rim, false, true, true, [](const Vec2& x, const Vec2&) -> Vec2 { return 1e-3 * x; }}};
    free.tractions.push_back({rim, [](const Vec2&, const Vec2& n) { return n; }});
    for (const auto& [scene, radius] : {std::pair(held, std::sqrt(1 - 2 * nu)), std::pair(free, 1.0)}) {
      const Solved s = solved(disc(), {.size = 0.1}, scene);
      const Analysis a = analyze(potential, s.model, s.state);
      EXPECT_NEAR(SecondOrders(a, potential, {}).answer_radius({0, 0}), radius, 1e-2 * radius) << nu;
      EXPECT_TRUE(std::isnan(SecondOrders(a, potential, {}).answer_radius({2, 0})));
    }
  }
}

TEST(SecondOrder, SaysWhatItDoesNotKnow) {
  const scenes::Body b = pulled_square(plane_strain(1, 0.3));
  const Solved s = solved(b.shape, {.size = 0.2, .crack_tip_size = 0.05}, b.scene);
  const auto note = [&](const Functional& j, const Perturbation& p, const Vec2& x) {
    const SecondOrder found = second_order(analyze(j, s.model, s.state), j, p, x);
    EXPECT_FALSE(found.available);
    EXPECT_TRUE(std::isnan(found.c2));
    return found.note;
  };
  const Functional c{"compliance", {compliance()}};
  EXPECT_NE(note(c, {.kind = Kind::Ellipse, .aspect = 2, .angle = 0.}, {.2, .5}).find("circular"), std::string::npos);
  EXPECT_NE(note({"", {boundary_tracking(2, {}, {})}}, {}, {.2, .5}).find("boundary_tracking"), std::string::npos);
  EXPECT_NE(note({"", {stress_power(2, {}, true)}}, {}, {.2, .5}).find("stress_power"), std::string::npos);
  Term mean{.kind = "mean", .linear = true, .density = displacement_tracking({}, {}).density};
  mean.uses_displacement = true;
  EXPECT_NE(note({"", {mean}}, {}, {.2, .5}).find("not for \"mean\""), std::string::npos);
  Term rooted = crack_opening(0, {});
  rooted.kind = "root";
  rooted.power = 0.5;
  EXPECT_NE(note({"", {rooted}}, {}, {.2, .5}).find("not for \"root\""), std::string::npos);
  const Functional turn{"", {scenes::turning()}};
  EXPECT_NE(note(turn, {}, {.2, .5}).find("not for \"turning\""), std::string::npos);
  EXPECT_EQ(second_order(analyze(turn, s.model, s.state), turn, {}, {.2, .5}).logarithm, Logarithm::Unknown);
  EXPECT_NE(note(c, {}, {3, 0}).find("outside"), std::string::npos);
  EXPECT_NE(note(c, {}, {.1, 0}).find("lies on a boundary, a crack"), std::string::npos);
  EXPECT_NE(note(c, {}, {.0, .01}).find("too coarse"), std::string::npos);
  scenes::Body half = b;
  half.scene = scenes::pulled(plane_strain(1, 0.3), scenes::closes_half);
  const Solved closing = solved(half.shape, {.size = 0.2, .crack_tip_size = 0.02}, half.scene);
  const Functional opening{"crack_opening", {crack_opening(0, {})}};
  const Analysis a = analyze(opening, closing.model, closing.state), e = analyze(c, closing.model, closing.state);
  EXPECT_NE(second_order(a, opening, {}, {.2, .5}).note.find("contact ends"), std::string::npos);
  EXPECT_TRUE(second_order(e, c, {}, {.2, .5}).available);
}

}  // namespace
}  // namespace kerf::second_order_test
