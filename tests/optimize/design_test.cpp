// Drawn designs: the motion of vertices, areas and constraints against differences and against distances by hand; what
// is drawn wrong is named.

#include "optimize/parametric/constraints.hpp"
#include "optimize/parametric/extend.hpp"
#include "optimize/parametric/followers.hpp"
#include "optimize/parametric/start.hpp"
#include "tests/optimize/designs.hpp"

#include <gtest/gtest.h>

#include <random>

namespace kerf::design_test {
namespace {

using namespace scenes;
using Eigen::VectorXd;

VectorXd random_in(const Design& d, unsigned seed) {
  std::mt19937 bits(seed);
  const VectorXd l = lower_bounds(d), u = upper_bounds(d);
  VectorXd x(l.size());
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] = l[i] + (u[i] - l[i]) * (static_cast<double>(bits()) / 4294967296.0);
  return x;
}

VectorXd differences(const std::function<double(const VectorXd&)>& f, const VectorXd& x, double step) {
  VectorXd g(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    VectorXd a = x, b = x;
    a[i] += step;
    b[i] -= step;
    g[i] = (f(a) - f(b)) / (2 * step);
  }
  return g;
}

TEST(Design, DrawsBehindWhatTheFrameHas) {
  const Problem p = everything();
  const Design d = everything_drawn();
  check_design(d, p);
  const DrawnBody body = body_of(d, start_of(d), p);
  ASSERT_EQ(body.shape.holes.size(), 3u);
  ASSERT_EQ(body.shape.cracks.size(), 2u);
  ASSERT_EQ(body.shape.regions.size(), 1u);
  EXPECT_EQ(body.shape.labels,
            (std::vector<std::string>{"bottom", "right", "top", "left", "hole:circle", "hole:ellipse", "hole:spline"}));
  EXPECT_EQ(body.scene.laws.size(), 2u);
  ASSERT_EQ(body.scene.regions.size(), 1u);
  EXPECT_DOUBLE_EQ(body.scene.regions[0].mu, 3 / 2.6);
  EXPECT_EQ(find_problem(body.shape), std::nullopt);
}

TEST(Design, EveryKindNamesItsVariables) {
  const Design d = everything_drawn();
  for (const Drawn& one : d.drawn) EXPECT_EQ(shape_of(one).kind, one.kind);
  const std::vector<std::string> names = variable_names(d);
  ASSERT_EQ(names.size(), static_cast<std::size_t>(start_of(d).size()));
  EXPECT_EQ(names[2], "circle.radius");
  EXPECT_EQ(names[7], "ellipse.angle");
  EXPECT_EQ(names[19], "spline.y6");
  EXPECT_EQ(names[20], "crack.x1");
  EXPECT_EQ(names.back(), "stiff.young");
}

TEST(Design, MeshVerticesFollowTheVariables) {
  const Problem p = everything();
  const Design d = everything_drawn();
  const VectorXd x = start_of(d);
  const Mesh mesh = triangulate(body_of(d, x, p).shape, p.sizing);
  const std::vector<Follower> f = followers(d, x, p, mesh);
  std::vector<int> count(5, 0);
  const Points at = positions(d, f, x);
  for (std::size_t i = 0; i < f.size(); ++i) {
    ++count[static_cast<std::size_t>(f[i].drawn)];
    EXPECT_LT((at.col(static_cast<Eigen::Index>(i)) - mesh.points[static_cast<std::size_t>(f[i].vertex)]).norm(),
              1e-12);
  }
  for (const int n : count) EXPECT_GE(n, 8);
  // Where they go lies on what is drawn there.
  const VectorXd y = random_in(d, 3);
  const Points to = positions(d, f, y);
  for (std::size_t i = 0; i < f.size(); ++i) {
    const Vec2 v = to.col(static_cast<Eigen::Index>(i));
    const Index drawn = f[i].drawn;
    if (drawn != 0 && drawn != 4) continue;
    const Eigen::Index first = drawn == 0 ? 0 : 26;
    EXPECT_NEAR((v - y.segment<2>(first)).norm() / y[first + 2], 1, 0.02);
  }
  // The pull is the derivative of force . position.
  Points force(2, at.cols());
  for (Eigen::Index i = 0; i < force.size(); ++i) force.data()[i] = std::sin(1.0 + static_cast<double>(i));
  const VectorXd g = pull_back(d, f, y, force);
  const VectorXd expected =
      differences([&](const VectorXd& z) { return positions(d, f, z).cwiseProduct(force).sum(); }, y, 1e-5);
  EXPECT_LT((g - expected).norm(), 1e-8 * expected.norm());
}

TEST(Design, AreaOfHolesAndItsDerivative) {
  const Design d = everything_drawn();
  for (unsigned seed = 1; seed < 4; ++seed) {
    const VectorXd x = random_in(d, seed);
    VectorXd g;
    const double area = area_of_holes(d, x, &g);
    const VectorXd expected = differences([&](const VectorXd& z) { return area_of_holes(d, z, nullptr); }, x, 1e-5);
    EXPECT_LT((g - expected).norm(), 1e-9);
    // Against the polygons that are meshed.
    const Problem p = everything();
    Shape shape = body_of(d, x, p).shape;
    EXPECT_NEAR(kerf::area(p.frame) - kerf::area(shape), area, 2e-3 * area);
  }
}

TEST(Design, ASplineOfPointsOnACircleIsNearlyACircle) {
  VectorXd v(24);
  for (int i = 0; i < 12; ++i) v.segment<2>(2 * i) = Vec2(std::cos(M_PI * i / 6), std::sin(M_PI * i / 6));
  const Design d{{drawn(Drawn::Kind::Spline, "s", v, 0.1)}};
  // The spline averages its control points: its radius at knots and between them.
  const double knot = (4 + 2 * std::cos(M_PI / 6)) / 6, between = (23 * std::cos(M_PI / 12) + std::cos(M_PI / 4)) / 24;
  EXPECT_LT(area_of_holes(d, v, nullptr), M_PI * knot * knot);
  EXPECT_GT(area_of_holes(d, v, nullptr), M_PI * between * between);
}

TEST(Design, SaysWhatIsDrawnWrong) {
  const Problem p = everything();
  const auto complaint = [&](const std::function<void(Design&)>& spoil) {
    Design d = everything_drawn();
    spoil(d);
    try {
      check_design(d, p);
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Usage);
      return std::string(e.what());
    }
    return std::string("none");
  };
  EXPECT_NE(complaint([](Design& d) { d.drawn.clear(); }).find("draws nothing"), std::string::npos);
  EXPECT_NE(complaint([](Design& d) { d.drawn[0].lower[2] = 0; }).find("hole 'circle'"), std::string::npos);
  EXPECT_NE(complaint([](Design& d) { d.drawn[1].start[0] = 7; }).find("has to lie between"), std::string::npos);
  EXPECT_NE(complaint([](Design& d) { d.drawn[3].name = "fixed"; }).find("taken"), std::string::npos);
  EXPECT_NE(complaint([](Design& d) { d.drawn[4].poisson = 0.7; }).find("Poisson"), std::string::npos);
  EXPECT_NE(complaint([](Design& d) { d.drawn[4].lower[3] = 0; }).find("Young"), std::string::npos);
  EXPECT_NE(complaint([](Design& d) { d.drawn[2].lower.conservativeResize(6); }).find("spline"), std::string::npos);
  EXPECT_NE(complaint([](Design& d) { d.drawn[0].upper[0] = std::nan(""); }).find("finite"), std::string::npos);
  const auto with = [&](std::size_t k, Eigen::Index count) {
    return complaint([&](Design& d) {
      for (auto* v : {&d.drawn[k].lower, &d.drawn[k].upper, &d.drawn[k].start}) v->setOnes(count);
    });
  };
  for (const Eigen::Index count : {2, 5})
    EXPECT_NE(with(3, count).find("a crack needs two points or more, x and y each"), std::string::npos) << count;
  for (const Eigen::Index count : {6, 9})
    EXPECT_NE(with(2, count).find("a spline needs four control points or more"), std::string::npos) << count;
  EXPECT_NE(complaint([](Design& d) { d.drawn[4].poisson = -1; }).find("Poisson"), std::string::npos);
  Problem thin = p;
  thin.plane_strain = false;
  Design d = everything_drawn();
  d.drawn[4].poisson = 0.7;  // plane stress knows no bulk
  EXPECT_NO_THROW(check_design(d, thin));
  d.drawn[4].poisson = 1;
  EXPECT_THROW(check_design(d, thin), Error);
}

TEST(Design, MeshesWithoutASizeHaveAFortiethOfTheBody) {
  Problem p = everything();
  EXPECT_EQ(mesh_size(p), 0.5);
  p.sizing.size = 0;
  EXPECT_DOUBLE_EQ(mesh_size(p), std::sqrt(32.0) / 40);
}

TEST(Extension, IsTheTransposeOfItsGathering) {
  const Problem p = everything();
  const Design d = everything_drawn();
  const Mesh mesh = triangulate(body_of(d, start_of(d), p).shape, p.sizing);
  const std::vector<bool> given = vertices_that_mean_something(mesh);
  const Extension e = make_extension(mesh, given);
  const auto n = static_cast<Eigen::Index>(mesh.points.size());
  Points motion(2, n), force(2, n);
  for (Eigen::Index i = 0; i < 2 * n; ++i) {
    motion.data()[i] = std::sin(static_cast<double>(3 * i));
    force.data()[i] = std::cos(static_cast<double>(5 * i));
  }
  const Points all = extend(e, motion), on = gather(e, force);
  double inner = 0;
  for (Eigen::Index v = 0; v < n; ++v)
    if (given[static_cast<std::size_t>(v)])
      inner += on.col(v).dot(motion.col(v));
    else
      EXPECT_EQ(on.col(v), Vec2::Zero());
  EXPECT_NEAR(force.cwiseProduct(all).sum(), inner, 1e-11 * force.norm() * all.norm());
  // Affine motions of a mesh are harmonic with any weight only if they are rigid shifts; those come through.
  for (Eigen::Index v = 0; v < n; ++v) motion.col(v) = Vec2(1, -2);
  EXPECT_LT((extend(e, motion) - motion).cwiseAbs().maxCoeff(), 1e-12);
  // Where every vertex is given nothing is left to extend.
  const Extension nothing = make_extension(mesh, std::vector<bool>(mesh.points.size(), true));
  EXPECT_EQ(extend(nothing, force), force);
  EXPECT_EQ(gather(nothing, force), force);
}

std::vector<Constraint> close_constraints(const Design& d, const Problem& p) {
  return constraints(d, p, 0.6, {{"a ring", {0, 0.9}, 0.3}});
}

TEST(Constraints, HaveTheirDerivatives) {
  const Problem p = everything();
  Design d = everything_drawn();
  for (Drawn& one : d.drawn) {  // so that none is left out
    one.lower.array() -= 2;
    one.upper.array() += 2;
  }
  const std::vector<Constraint> all = close_constraints(d, p);
  EXPECT_GE(all.size(), 5u * 3 + 10);
  const Design narrow = everything_drawn();
  for (unsigned seed = 1; seed < 6; ++seed) {
    const VectorXd x = random_in(narrow, seed);
    for (const Constraint& c : all) {
      VectorXd g;
      c.value(x, &g);
      const VectorXd expected = differences([&](const VectorXd& z) { return c.value(z, nullptr); }, x, 1e-6);
      EXPECT_LT((g - expected).norm(), 1e-5 * std::max(1.0, expected.norm())) << c.name << " seed " << seed;
    }
  }
}

TEST(Constraints, CirclesAreExact) {
  Problem p = everything();
  p.frame.cracks.clear();
  p.scene.laws.clear();
  p.frame.holes = {circle("there", {1, 0}, 0.5, 0)};
  Design d{{drawn(Drawn::Kind::Circle, "a", Eigen::Vector3d(-1, 0, 0.3), 0.25),
            drawn(Drawn::Kind::Circle, "b", Eigen::Vector3d(-1, 1, 0.4), 0.3)}};
  const std::vector<Constraint> all = constraints(d, p, 0.1, {});
  const VectorXd x = start_of(d);
  std::map<std::string, double> distance;
  for (const Constraint& c : all) distance[c.name] = (1 - c.value(x, nullptr)) * 0.1;
  EXPECT_NEAR(distance.at("hole 'a' and hole 'b' are less than 0.1 apart"), 0.3, 1e-12);
  EXPECT_NEAR(distance.at("hole 'b' and the outline are less than 0.1 apart"), 0.6, 2e-3);  // two sides
  EXPECT_EQ(distance.count("hole 'a' and hole 'there' are less than 0.1 apart"), 0u);       // their bounds keep them
  d.drawn[0].upper[0] = 1;
  bool seen = false;
  for (const Constraint& c : constraints(d, p, 0.1, {}))
    if (c.name == "hole 'a' and hole 'there' are less than 0.1 apart") {
      seen = true;
      EXPECT_NEAR((1 - c.value(x, nullptr)) * 0.1, 2 - 0.8, 1e-12);
    }
  EXPECT_TRUE(seen);
}

TEST(Constraints, KnowOverlapCrossingAndLeaving) {
  const Problem p = everything();
  Design d = everything_drawn();
  for (Drawn& one : d.drawn) {
    one.lower.array() -= 2;
    one.upper.array() += 2;
  }
  const std::vector<Constraint> all = constraints(d, p, 0.1, {});
  const auto value = [&](const std::string& name, const VectorXd& x) {
    for (const Constraint& c : all)
      if (c.name.rfind(name, 0) == 0) return c.value(x, nullptr);
    ADD_FAILURE() << name;
    return 0.0;
  };
  const VectorXd good = start_of(d);
  for (const Constraint& c : all) EXPECT_LT(c.value(good, nullptr), 0) << c.name;
  VectorXd x = good;
  x.head<2>() = Vec2(0, 0);  // the circle over the crack
  EXPECT_GT(value("hole 'circle' and crack 'fixed'", x), 1);
  x = good;
  x.segment<2>(3) = Vec2(0, 0.05);  // the ellipse too
  EXPECT_GT(value("hole 'ellipse' and crack 'fixed'", x), 1);
  x = good;
  x[0] = -3;  // the circle has left
  EXPECT_GT(value("hole 'circle' and the outline", x), 5);
  x = good;
  x.segment<2>(0) = x.segment<2>(3);  // the circle in the ellipse
  EXPECT_GT(value("hole 'circle' and hole 'ellipse'", x), 2);
  x = good;
  for (int i = 0; i < 6; ++i) x.segment<2>(8 + 2 * i) = good.segment<2>(8 + 2 * (5 - i));  // clockwise
  EXPECT_GT(value("hole 'spline' is smaller", x), 1);
  x = good;
  x.segment<2>(8) = good.segment<2>(14) + Vec2(-0.3, 0);  // pulled through the other side
  EXPECT_GT(std::max({value("hole 'spline' is thinner", x), value("hole 'spline' turns", x)}), 0.1);
  x = good;
  x.segment<2>(24) = good.segment<2>(20) + Vec2(0.1, 0.15);  // the crack folds
  EXPECT_GT(value("crack 'crack' folds", x), 0);
}

// A path whose first two edges cannot move: the third keeps off the first, and does not fold onto the second.
TEST(Constraints, EdgesThatMoveKeepOffThoseThatDoNot) {
  Problem p = everything();
  VectorXd path(8);
  path << -1, 0.5, -0.5, 0.5, 0, 0.5, 0.5, 0.7;
  Design d{{drawn(Drawn::Kind::Crack, "crack", path, 0)}};
  d.drawn[0].lower.tail<2>().array() -= 1;
  d.drawn[0].upper.tail<2>().array() += 1;
  std::map<std::string, double> value;
  VectorXd x = start_of(d);
  x.tail<2>() = Vec2(-0.8, 0.51);  // back over both
  for (const Constraint& c : constraints(d, p, 0.1, {}))
    value[c.name.substr(0, c.name.find(" of"))] = c.value(x, nullptr);
  ASSERT_TRUE(value.contains("edges 1 and 3"));
  EXPECT_GT(value.at("edges 1 and 3"), 0);
  bool folds = false;
  for (const Constraint& c : constraints(d, p, 0.1, {}))
    folds = folds || (c.name.find("folds") != std::string::npos && c.value(x, nullptr) > 0);
  EXPECT_TRUE(folds);
}

// Points that lie on each other: numbers all the same, and a way out.
TEST(Constraints, StandThingsOfNoSize) {
  const Problem p = everything();
  Design d = everything_drawn();
  for (Drawn& one : d.drawn) {
    one.lower.array() -= 2;
    one.upper.array() += 2;
  }
  const std::vector<Constraint> all = constraints(d, p, 0.1, {});
  VectorXd x = start_of(d);
  for (int i = 0; i < 6; ++i) x.segment<2>(8 + 2 * i) = Vec2(0, 0);   // the spline is a point
  for (int i = 0; i < 3; ++i) x.segment<2>(20 + 2 * i) = Vec2(1, 0);  // and so is the crack
  x.head<2>() = Vec2(-0.3, 0.1);                                      // the circle about the end of the other crack
  std::map<std::string, double> value;
  for (const Constraint& c : all) {
    VectorXd by;
    value[c.name] = c.value(x, &by);
    EXPECT_TRUE(std::isfinite(value[c.name])) << c.name;
    EXPECT_TRUE(by.allFinite()) << c.name;
  }
  EXPECT_GE(value.at("hole 'spline' is thinner than 0.1"), 1);
  EXPECT_EQ(value.at("edge 1 of crack 'crack' is shorter than 0.1"), 1);
  OptimizeRequest r;
  r.design = d;
  r.min_distance = 0.1;
  const std::optional<VectorXd> better = repaired(x, p, r);
  ASSERT_TRUE(better);
  for (const Constraint& c : all) EXPECT_LE(c.value(*better, nullptr), 0) << c.name;
  EXPECT_FALSE(find_problem(body_of(d, *better, p).shape));
}

}  // namespace
}  // namespace kerf::design_test
