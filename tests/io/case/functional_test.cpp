// Sections [functional], [map] and [validate] against the terms they stand for, evaluated at points by hand; measured
// data against linear functions.

#include "io/case/tip.hpp"
#include "tests/io/case/case_files.hpp"

#include <cmath>

namespace kerf::functional_test {
namespace {

Functional functional(const std::string& lines) {
  return read(square + lines).functional;
}

TEST(Functional, KindsWithoutKeys) {
  for (const char* kind : {"energy", "compliance", "volume"}) {
    const Functional j = functional(std::string("[functional]\nkind = '") + kind + "'");
    EXPECT_EQ(j.kind, kind);
    ASSERT_EQ(j.terms.size(), 1u) << kind;
    EXPECT_EQ(j.terms[0].kind, kind);
    EXPECT_EQ(j.terms[0].factor, 1);
  }
}

TEST(Functional, ExpressionsUseDefinitions) {
  const Functional j = functional(
      "[define]\nw = 'x + 1'\n[functional]\nkind = 'displacement_tracking'\ntarget = ['x', 2]\nweight = 'w*y'");
  ASSERT_EQ(j.terms.size(), 1u);
  const FieldPoint at{.x = {1, 0.5}, .displacement = {3, 3}};
  EXPECT_DOUBLE_EQ(j.terms[0].density(at).value, 0.5 * (2 * 0.5) * (4 + 1));
  EXPECT_EQ(error(square + "[define]\nw = 'x'\nv = 'x'\n[functional]\nkind = 'stress_power'\np = 2\nweight = 'w'"),
            "a.toml:9:1: unused key \"v\" in [define]; use it in an expression or remove it");
}

TEST(Functional, OneTermPerLabel) {
  const Functional j = functional(
      "[functional]\nkind = 'boundary_tracking'\non = ['top', 'right']\ntarget = ['nx', 0]\nweight = 'ny + 2'");
  EXPECT_EQ(j.kind, "boundary_tracking");
  ASSERT_EQ(j.terms.size(), 2u);
  EXPECT_EQ(j.terms[0].label, 2);
  EXPECT_EQ(j.terms[1].label, 1);
  EXPECT_DOUBLE_EQ(j.terms[0].on_boundary({0, 1}, {0, 1}, {1, 0}).value, 1.5);
}

TEST(Functional, DisplacementAlongADirection) {
  const Functional j = functional(
      "[functional]\nkind = 'displacement'\non = ['top', 'right']\ndirection = ['nx', 2]\nweight = 'x + ny'");
  EXPECT_EQ(j.kind, "displacement");
  ASSERT_EQ(j.terms.size(), 2u);
  EXPECT_EQ(j.terms[1].label, 1);
  EXPECT_TRUE(j.terms[1].linear);
  const Density d = j.terms[0].on_boundary({3, 1}, {0, 1}, {7, -2});
  EXPECT_DOUBLE_EQ(d.value, -16);
  EXPECT_EQ(d.by_displacement, Vec2(0, 8));
}

TEST(Functional, SumWithFactors) {
  const Functional j = functional(
      "[functional]\nkind = 'sum'\nterms = [{ kind = 'compliance', factor = 0.5 }, { kind = 'volume', factor = -100 "
      "},\n"
      " { kind = 'stress_pnorm', p = 8 }, { kind = 'boundary_tracking', on = ['top', 'left'], target = [0, 0], factor "
      "= "
      "3 }]");
  EXPECT_EQ(j.kind, "sum");
  ASSERT_EQ(j.terms.size(), 5u);
  const std::vector<double> factors = {0.5, -100, 1, 3, 3};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(j.terms[i].factor, factors[i]) << i;
  EXPECT_DOUBLE_EQ(j.terms[2].power, 0.125);
}

TEST(Functional, Cracks) {
  const std::string cracks =
      "[[crack]]\nname = 'a'\npath = [[0.2, 0.2], [0.4, 0.2]]\n[[crack]]\nname = 'b'\npath = [[1, 0.2], [1, 0.8]]\n";
  const Functional open = functional(cracks + "[functional]\nkind = 'crack_opening'\ncrack = 'b'\nweight = 'x + y'");
  EXPECT_EQ(open.terms.at(0).crack, 1);
  EXPECT_DOUBLE_EQ(open.terms[0].on_crack({.x = {1, 2}, .jump_n = 4}).value, 12);
  const Functional pressure = functional(cracks + "[functional]\nkind = 'crack_pressure'\ncrack = 'a'\ntarget = 'x'");
  EXPECT_EQ(pressure.terms.at(0).crack, 0);
  EXPECT_DOUBLE_EQ(pressure.terms[0].on_crack({.x = {1, 0}, .pressure = 3}).value, 2);
}

struct Tip {
  const char* crack;
  const char* end;
  Vec2 at;
  double outer;
};
class TipRing : public testing::TestWithParam<Tip> {};

// Half the length is the measure, unless something is near or the crack is curved.
TEST_P(TipRing, Default) {
  const Tip& tip = GetParam();
  const Functional j =
      functional(std::string("[[hole]]\nname = 'h'\ncircle = { center = [1.5, 0.25], radius = 0.1 }\n") +
                 "[[crack]]\nname = 'c'\n" + tip.crack +
                 "\n[functional]\nkind = 'energy_release_rate'\ncrack = 'c'\ntip = '" + tip.end + "'");
  EXPECT_NEAR((j.terms.at(0).feature - tip.at).norm(), 0, 1e-12);
  EXPECT_NEAR(j.terms[0].feature_radius, tip.outer, 1e-7);
}

INSTANTIATE_TEST_SUITE_P(
    Rings, TipRing,
    testing::Values(
        Tip{"path = [[0.4, 0.5], [0.8, 0.5]]", "end", {0.8, 0.5}, 0.04},
        Tip{"path = [[0.4, 0.5], [0.8, 0.5]]", "start", {0.4, 0.5}, 0.04},
        Tip{"path = [[0.2, 0.9], [1.2, 0.98]]", "end", {1.2, 0.98}, 0.01},
        Tip{"path = [[0.5, 0.25], [1.39, 0.25]]", "end", {1.39, 0.25}, 0.005},
        Tip{"path = [[0.4, 0.5], [0.8, 0.5], [0.82, 0.52]]", "end", {0.82, 0.52}, 0.01 * std::sqrt(2.0)},
        Tip{"arc = { center = [0.6, 0.5], radius = 0.2, from_deg = 0, to_deg = 270 }", "end", {0.6, 0.3}, 0.02}));

// Out of the crack, along its last piece or the tangent of its arc.
TEST(Functional, DirectionOfATip) {
  Shape shape;
  shape.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
  shape.cracks = {{"p", {{0, 1}, {1, 1}, {1, 1.3}}, {}},
                  arc_crack("up", {0, 0}, 0.5, 0, M_PI / 2),
                  arc_crack("down", {0, -1}, 0.5, M_PI / 2, 0)};
  const auto expect = [&](Index crack, bool at_start, const Vec2& direction) {
    EXPECT_NEAR((crack_tip(shape, crack, at_start).direction - direction).norm(), 0, 1e-15) << crack << at_start;
  };
  expect(0, true, {-1, 0});
  expect(0, false, {0, 1});
  expect(1, true, {0, -1});
  expect(1, false, {-1, 0});
  expect(2, true, {-1, 0});
  expect(2, false, {0, -1});
  EXPECT_EQ(crack_tip(shape, 0, true).nearest, "crack \"up\"");
  EXPECT_NEAR(crack_tip(shape, 0, true).clearance, 0.5, 1e-15);
  EXPECT_EQ(crack_tip(shape, 0, false).nearest, "its kink");
  shape.regions = {circle("disc", {1, 1.5}, 0.125, none)};
  EXPECT_EQ(crack_tip(shape, 0, false).nearest, "region \"disc\"");
  EXPECT_NEAR(crack_tip(shape, 0, false).clearance, 0.075, 1e-6);
}

TEST(Functional, GivenRing) {
  const Functional j = functional(
      "[[crack]]\nname = 'c'\npath = [[0.4, 0.5], [0.8, 0.5]]\n"
      "[functional]\nkind = 'energy_release_rate'\ncrack = 'c'\ntip = 'end'\nring = [0.1, 0.3]");
  EXPECT_EQ(j.terms.at(0).feature_radius, 0.3);
}

struct Measured : testing::Test {
  TemporaryFolder folder;
  std::string lines = "[functional]\nkind = 'misfit'\non = 'top'\nmeasured = 'data.csv'";
  Case with(const std::string& data) const {
    folder.write("data.csv", data);
    return read_case(folder.write("a.toml", square + lines));
  }
  std::string message(const std::string& data) const {
    try {
      with(data);
    } catch (const Error& e) {
      std::string text = e.what();
      const std::string prefix = folder.path.string() + "/";
      for (std::size_t at; (at = text.find(prefix)) != std::string::npos;) text.erase(at, prefix.size());
      return text;
    }
    return "no error";
  }
};

TEST_F(Measured, LinearBetweenNeighbors) {
  const Case c = with("u_x,u_y,x,y,name\n0,0,2,1,a\n1,2,1,1.001,b\n4,4,0.0,1,c\n");
  ASSERT_EQ(c.functional.terms.size(), 1u);
  ASSERT_TRUE(c.functional.terms[0].measured);
  const Support& s = *c.functional.terms[0].measured;
  EXPECT_EQ(s.label, 2);
  EXPECT_NEAR((s.value({1.5, 1}, {0, 1}) - Vec2(0.5, 1)).norm(), 0, 2e-3);
  EXPECT_NEAR((s.value({0.25, 1}, {0, 1}) - Vec2(3.25, 3.5)).norm(), 0, 2e-3);
  EXPECT_EQ(s.value({2.01, 1}, {0, 1}), Vec2(0, 0)) << "the end of the label is the nearest place";
  EXPECT_THROW(s.value({2.1, 1}, {0, 1}), Error);
  EXPECT_TRUE(c.file_notes.empty());
}

TEST_F(Measured, StraightOnToTheEndsWhateverTheOrder) {
  const std::string head = "x,y,u_x,u_y\n";
  const std::vector<std::string> rows{"0.25,1,0.25,1\n", "0.75,1,0.75,3\n", "1.25,1,1.25,5\n", "1.75,1,1.75,7\n"};
  for (const std::array order : {std::array{0, 1, 2, 3}, std::array{2, 0, 3, 1}, std::array{3, 2, 1, 0}}) {
    std::string data = head;
    for (const int k : order) data += rows[static_cast<std::size_t>(k)];
    const Case c = with(data + "0.5,0,9,9\n1,0.5,9,9\n");
    const auto& value = c.functional.terms.at(0).measured->value;
    for (const double x : {0., 0.1, 0.25, 0.6, 1.1, 1.9, 2.})
      EXPECT_NEAR((value({x, 1}, {0, 1}) - Vec2(x, 4 * x)).norm(), 0, 1e-12) << x;
    ASSERT_EQ(c.file_notes.size(), 2u);
    EXPECT_NE(c.file_notes[0].find(": 25 % of \"top\" lies beyond the outer readings, up to 0.25 at ("),
              std::string::npos);
    EXPECT_EQ(c.file_notes[1].substr(c.file_notes[1].find(": 2 ")),
              ": 2 readings are left out: 1 on other sides, 1 further than 0.0224 from the boundary");
  }
}

// Displacements u = (x, y) of points on a path around corners, in a drawn order, with and without the corners.
TEST(MeasuredAlong, CornersHolesAndMouthsAreNotCut) {
  TemporaryFolder folder;
  const std::string body = R"([domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["rim", "rim", "rim", "left"]
[material]
young = 1
poisson = 0.3
[[hole]]
name = "h"
circle = { center = [0.1, 0.2], radius = 0.3 }
[[crack]]
name = "c"
path = [[0.5, -1], [0.5, -0.5]]
[[boundary]]
on = "left"
displacement = [0, 0]
)";
  // Differentiable along each side, apart at the mouth of the crack.
  const auto u = [](const Vec2& x) { return Vec2(2 * x.x() - x.y() + (x.x() > 0.5 ? 1.5 * (1 - x.y()) : 0), x.y()); };
  for (const bool corners : {true, false}) {
    std::vector<Vec2> at;
    for (int i = corners ? 0 : 1; i <= (corners ? 40 : 39); i += corners ? 2 : 1) {
      const double t = -1 + 0.05 * i;
      for (const Vec2& x : {Vec2(t, -1), Vec2(1, t), Vec2(t, 1)})
        if (x != Vec2(0.5, -1)) at.push_back(x);
    }
    std::string data = "x,y,u_x,u_y\n";
    for (std::size_t k = 0; k < at.size(); ++k) {
      const Vec2 x = at[(37 * k) % at.size()];
      data += fmt::format("{},{},{},{}\n", x.x(), x.y(), u(x).x(), u(x).y());
    }
    folder.write("data.csv", data);
    const Case c =
        read_case(folder.write("a.toml", body + "[functional]\nkind = 'misfit'\non = 'rim'\nmeasured = 'data.csv'\n"));
    const auto& value = c.functional.terms.at(0).measured->value;
    for (int k = 0; k < 300; ++k) {
      const double t = -1 + (k + 0.5) / 150;
      for (const auto& [x, n] :
           {std::pair(Vec2(t, -1), Vec2(0, -1)), std::pair(Vec2(1, t), Vec2(1, 0)), std::pair(Vec2(t, 1), Vec2(0, 1))})
        ASSERT_NEAR((value(x, n) - u(x)).norm(), 0, 1e-9) << x.transpose();
    }
    EXPECT_EQ(c.file_notes.size(), 1u) << "to the mouth, and to the corners";
  }
  // Around the hole, twelve readings: linear in the angle between them.
  std::string data = "x,y,u_x,u_y\n";
  for (int k = 0; k < 12; ++k) {
    const double t = 2 * pi * ((5 * k) % 12) / 12;
    data += fmt::format("{},{},{},1\n", 0.1 + 0.3 * std::cos(t), 0.2 + 0.3 * std::sin(t), std::cos(t));
  }
  folder.write("data.csv", data);
  const Case c =
      read_case(folder.write("a.toml", body + "[functional]\nkind = 'misfit'\non = 'h'\nmeasured = 'data.csv'\n"));
  EXPECT_TRUE(c.file_notes.empty());
  for (int k = 0; k < 100; ++k) {
    const double t = 2 * pi * (k + 0.3) / 100, h = 2 * pi / 12;
    const Vec2 n(std::cos(t), std::sin(t));
    const double part = t / h - std::floor(t / h), before = std::floor(t / h) * h;
    const double expected = (1 - part) * std::cos(before) + part * std::cos(before + h);
    EXPECT_NEAR(c.functional.terms.at(0).measured->value(Vec2(0.1, 0.2) + 0.3 * n, -n).x(), expected, 1e-4);
  }
}

TEST_F(Measured, Expressions) {
  const Case c = read(square + "[functional]\nkind = 'misfit'\non = 'top'\nmeasured = ['x', 'ny']");
  EXPECT_EQ(c.functional.terms.at(0).measured->value({3, 0}, {0, 1}), Vec2(3, 1));
}

TEST_F(Measured, WrongData) {
  const std::string where = "a.toml:10:12: measured in [functional] = \"data.csv\": ";
  EXPECT_EQ(message("x,y,u_x,u_y\n0,1,0,0\n0.7,1,0,0\n1.2,1,0,0\n"),
            where +
                "the data end 0.8 before the boundary point (2, 1); measure along the whole label \"top\", to its "
                "ends and corners or as near to them as the readings are apart");
  EXPECT_EQ(message("x,y,u_x,u_y\n0,0,0,0\n2,1,0,0\n"),
            where +
                "the data end 2 before the boundary point (0, 1); measure along the whole label \"top\", to its "
                "ends and corners or as near to them as the readings are apart");
  EXPECT_EQ(message("x,y,u_x,u_z\n0,1,0,0\n"),
            "data.csv:1:1: the first line must name the columns, x,y,u_x,u_y among them");
  EXPECT_EQ(message("x,y,u_x,u_y\n0,1,0\n"), "data.csv:2:1: 3 cells instead of 4");
  EXPECT_EQ(message("x,y,u_x,u_y\n0,1,0,nan\n"), "data.csv:2:1: \"nan\" is not a finite number");
  EXPECT_EQ(message("x,y,u_x,u_y\n0,1,0,0\n"),
            "a.toml:10:12: measured in [functional]: \"data.csv\" has one point; give at least 2 along the "
            "boundary");
  EXPECT_NE(error(square + lines, {}, Fault::Files).find("a.toml:10:12: measured in [functional]: "),
            std::string::npos);
}

TEST(MapSection, Perturbations) {
  const auto perturbation = [](const std::string& value) {
    return read(square + "[map]\nperturbation = " + value).map_request.perturbation;
  };
  EXPECT_EQ(perturbation("'hole'").kind, Perturbation::Kind::Hole);
  EXPECT_EQ(perturbation("'clamped_hole'").kind, Perturbation::Kind::ClampedHole);
  EXPECT_EQ(perturbation("'crack'").kind, Perturbation::Kind::Crack);
  const Perturbation inclusion = perturbation("{ young = 2, poisson = 0.5 }");
  EXPECT_EQ(inclusion.kind, Perturbation::Kind::Inclusion);
  EXPECT_DOUBLE_EQ(inclusion.inclusion.mu, 2.0 / 3);
  EXPECT_EQ(inclusion.inclusion.c, 0);
  const Perturbation ellipse = perturbation("{ aspect = 3 }");
  EXPECT_EQ(ellipse.kind, Perturbation::Kind::Ellipse);
  EXPECT_EQ(ellipse.aspect, 3);
}

TEST(MapSection, RadiusAndBounds) {
  const std::string validate = "[validate]\npoints = [[1, 0.5], [0.5, 0.5]]\nradii = [0.05, 0.2, 0.1]\n";
  Case c = read(square + "[map]\nbounds = true\npoints = [[1, 0.5]]\nradius = 0.02\n" + validate);
  EXPECT_TRUE(c.map_request.bounds);
  EXPECT_EQ(c.map_request.radius, 0.02);
  ASSERT_TRUE(c.map && c.validate);
  EXPECT_EQ(c.validate->radii, (std::vector<double>{0.2, 0.1, 0.05}));
  EXPECT_EQ(c.validate->points.at(1), Vec2(0.5, 0.5));
  c = read(square + validate);
  EXPECT_FALSE(c.map);
  EXPECT_EQ(c.map_request.radius, 0.05);
}

TEST(ValidateSection, GeometricRadiiAndThePerturbationOfTheMap) {
  const Case c = read(square +
                      "[validate]\npoints = [[1, 0.5]]\nradii = { largest = 0.2, ratio = 0.5, count = 6 }\n"
                      "[map]\nperturbation = 'crack'\n");
  ASSERT_TRUE(c.validate);
  EXPECT_EQ(c.validate->radii, (std::vector<double>{0.2, 0.1, 0.05, 0.025, 0.0125, 0.00625}));
  EXPECT_EQ(c.validate->perturbation.kind, Perturbation::Kind::Crack);
  EXPECT_EQ(c.map_request.radius, 0.00625);
}

}  // namespace
}  // namespace kerf::functional_test
