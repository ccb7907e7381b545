// Sizes on a background mesh, sizes from indicators, and bisection of triangles. The truths are the piecewise constant
// approximation of r^-1/2, whose optimal rate is N^-1/2, the four shapes that halving leaves of a triangle, and the
// arcs that edges stand for.

#include "geometry/adapt.hpp"

#include "kerf/mesher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace kerf::adapt_test {
namespace {

Shape square(std::vector<Crack> cracks = {}) {
  return {polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0), {}, std::move(cracks), {"side"}};
}

std::vector<double> sizes(const Mesh& m, const auto& size) {
  std::vector<double> values;
  for (const Vec2& x : m.points) values.push_back(size(x));
  return values;
}

double total(std::span<const double> eta) {
  double sum = 0;
  for (const double e : eta) sum += e * e;
  return std::sqrt(sum);
}

/// The error of piecewise constants for r^-1/2, which a crack tip at the origin has: sums of midpoints of 4^level
/// triangles each.
std::vector<double> indicators(const Mesh& m) {
  std::vector<double> eta;
  const auto each = [](const auto& self, const Vec2& a, const Vec2& b, const Vec2& c, int level,
                       const auto& visit) -> void {
    if (level == 0) {
      visit(std::pow(((a + b + c) / 3).norm(), -0.5));
      return;
    }
    const Vec2 p = (b + c) / 2, q = (c + a) / 2, r = (a + b) / 2;
    self(self, a, r, q, level - 1, visit);
    self(self, r, b, p, level - 1, visit);
    self(self, q, p, c, level - 1, visit);
    self(self, p, q, r, level - 1, visit);
  };
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const auto [i, j, k] = m.triangles[t];
    double sum = 0, squares = 0;
    each(each, m.points[std::size_t(i)], m.points[std::size_t(j)], m.points[std::size_t(k)], 2, [&](double f) {
      sum += f / 16;
      squares += f * f / 16;
    });
    eta.push_back(std::sqrt(std::max(0.0, squares - sum * sum) * area(m, Index(t))));
  }
  return eta;
}

TEST(Background, GivesTheMeshItsSizes) {
  const Mesh coarse = triangulate(square(), {.size = 0.5});
  const auto target = [](const Vec2& x) { return 0.03 + 0.02 * (x.x() + 2); };
  const Mesh m = triangulate(square(), {.size = 1}, {&coarse, sizes(coarse, target)});
  EXPECT_GE(quality(m).min_angle_deg, 25);
  double predicted = 0, deviation = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const double h = target(centroid(m, Index(t))), mean = std::sqrt(4 / std::sqrt(3.0) * area(m, Index(t)));
    predicted += (mean / h) * (mean / h);
    deviation = std::max(deviation, std::abs(std::log2(mean / h)));
  }
  EXPECT_NEAR(predicted / double(m.triangles.size()), 1, 0.1);
  EXPECT_LT(deviation, 1.2);
}

TEST(Background, IsCappedLimitedAndExtended) {
  // A jump in the sizes is graded; beyond the old boundary, a coarse polygon for a circle, the sizes go on.
  const Shape disc{circle("outline", {0, 0}, 1, 0), {}, {}, {"side"}};
  const Mesh coarse = triangulate(disc, {.size = 0.5});
  const auto target = [](const Vec2& x) { return x.x() < 0 ? 0.01 : 10; };
  const Mesh m = triangulate(disc, {.size = 0.2}, {&coarse, sizes(coarse, target)});
  EXPECT_GE(quality(m).min_angle_deg, 25);
  EXPECT_LT(quality(m).h_max, 0.4);
  for (std::size_t e = 0; e < m.edges.size(); ++e) {
    const double x = m.points[std::size_t(m.edges[e][0])].x();
    EXPECT_LT(length(m, Index(e)), 1.6 * (0.01 + 0.3 * std::max(0.0, x + 0.5)) + 0.02) << x;
  }
  EXPECT_THROW(triangulate(disc, {.size = 0.2}, {&coarse, {1, 2}}), std::invalid_argument);
  EXPECT_THROW(triangulate(disc, {.size = 0.2}, {&coarse, std::vector<double>(coarse.points.size(), 0.0)}),
               std::invalid_argument);
}

TEST(Background, ReplacesTheSizesOfTips) {
  const Shape shape = square({{"c", {{-1, 0}, {1, 0}}}});
  const Mesh graded = triangulate(shape, {.size = 0.2});
  const Mesh even = triangulate(shape, {.size = 0.2}, {&graded, std::vector<double>(graded.points.size(), 0.2)});
  EXPECT_LT(even.triangles.size(), 1500u);
  EXPECT_GT(quality(even).h_min, 0.08);
  const Mesh sharp =
      triangulate(shape, {.size = 0.2},
                  {&graded, sizes(graded, [](const Vec2& x) { return 1e-12 + std::abs((x - Vec2(1, 0)).norm()); })});
  EXPECT_NEAR(std::log10(quality(sharp).h_min), std::log10(1e-9 * extent(shape)), 0.5);
  EXPECT_GE(quality(sharp).min_angle_deg, 25);
}

TEST(Background, IsDeterministic) {
  const Shape shape = square({{"c", {{-1, 0}, {1, 0.3}}}});
  const Mesh coarse = triangulate(shape, {.size = 0.3});
  const Background background{&coarse, sizes(coarse, [](const Vec2& x) { return 0.02 + 0.1 * x.norm(); })};
  const Mesh a = triangulate(shape, {.size = 0.3}, background), b = triangulate(shape, {.size = 0.3}, background);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(EquidistributedSizes, AskForTheFewestTriangles) {
  // Indicators as of c_T area^(1/2) h^p: the new ones are equal and sum to the goal.
  const Mesh m = triangulate(square(), {.size = 0.3});
  std::mt19937 random(1);
  for (const double order : {1.0, 2.0, 3.0}) {
    std::vector<double> eta;
    for (std::size_t t = 0; t < m.triangles.size(); ++t) eta.push_back(std::exp(3e-10 * double(random())));
    const Goal goal{.error = 0.3 * total(eta), .order = order, .smallest = 1e-3, .largest = 1e3};
    const std::vector<double> size = equidistributed_sizes(m, eta, goal);
    // Sizes at vertices are minima: each triangle's own is the largest factor that its vertices and it allow.
    double least = 1e300, squared = 0;
    for (std::size_t t = 0; t < eta.size(); ++t) {
      double h = 0;
      for (const Index v : m.triangles[t]) h = std::max(h, size[std::size_t(v)]);
      const double r = h / std::sqrt(4 / std::sqrt(3.0) * area(m, Index(t)));
      least = std::min(least, std::pow(r, order + 1) * eta[t]);
      squared += eta[t] * eta[t] * std::pow(r, 2 * order);
    }
    EXPECT_LE(squared, goal.error * goal.error);
    EXPECT_GT(least, 0);
  }
  // Equal indicators: the factor is known.
  const std::vector<double> equal(m.triangles.size(), 1.0);
  for (const auto& [wanted, factor] : std::vector<std::pair<double, double>>{{0.5, 0.5}, {1e-6, 0.125}, {1e6, 4}}) {
    const std::vector<double> size = equidistributed_sizes(m, equal, {.error = wanted * total(equal), .order = 1});
    double largest = 0, mean = 0;
    for (std::size_t t = 0; t < equal.size(); ++t) mean = std::max(mean, area(m, Index(t)));
    for (const double h : size) largest = std::max(largest, h);
    EXPECT_LE(largest, factor * std::sqrt(4 / std::sqrt(3.0) * mean) * (1 + 1e-12));
    EXPECT_GE(largest, 0.7 * factor * std::sqrt(4 / std::sqrt(3.0) * mean));
  }
  const std::vector<double> few =
      equidistributed_sizes(m, equal, {.error = 1e-6, .max_triangles = 4.0 * double(m.triangles.size())});
  const std::vector<double> half = equidistributed_sizes(m, equal, {.error = 0.5 * total(equal)});
  for (std::size_t v = 0; v < few.size(); ++v) EXPECT_NEAR(few[v], half[v], 1e-9 * half[v]);
  EXPECT_THROW(equidistributed_sizes(m, few, {.error = 1}), std::invalid_argument);
  EXPECT_THROW(equidistributed_sizes(m, equal, {.error = 0}), std::invalid_argument);
  const std::vector<double> zero(m.triangles.size(), 0.0);
  for (const double h : equidistributed_sizes(m, zero, {.error = 1})) EXPECT_TRUE(std::isfinite(h));
}

TEST(Remeshing, ReachesTheErrorAtTheOptimalRate) {
  // Constants for r^-1/2: optimal is N^-1/2, on even meshes it is N^-1/4.
  const Shape shape = square({{"c", {{-1.5, 0}, {0, 0}}}});
  std::vector<double> product;
  for (const double wanted : {0.1, 0.05, 0.025}) {
    Mesh m = triangulate(shape, {.size = 0.4, .crack_tip_size = 0.4});
    int rounds = 0;
    std::vector<double> eta = indicators(m);
    for (; total(eta) > wanted && rounds < 12; ++rounds) {
      m = triangulate(shape, {.size = 1}, {&m, equidistributed_sizes(m, eta, {.error = 0.95 * wanted})});
      eta = indicators(m);
    }
    EXPECT_LE(total(eta), wanted);
    EXPECT_LE(rounds, 8);
    product.push_back(total(eta) * std::sqrt(double(m.triangles.size())));
  }
  EXPECT_NEAR(product[2] / product[0], 1, 0.2);
}

/// The grid's shapes: angles rounded, sorted.
std::map<std::array<int, 3>, int> shapes(const Mesh& m) {
  std::map<std::array<int, 3>, int> found;
  for (const auto& t : m.triangles) {
    std::array<int, 3> angles;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 p = m.points[std::size_t(t[(i + 1) % 3])] - m.points[std::size_t(t[i])],
                 q = m.points[std::size_t(t[(i + 2) % 3])] - m.points[std::size_t(t[i])];
      angles[i] = int(std::lround(std::atan2(cross(p, q), p.dot(q)) * 1e5));
    }
    std::sort(angles.begin(), angles.end());
    ++found[angles];
  }
  return found;
}

TEST(Bisect, KeepsAtMostFourShapesPerTriangle) {
  Mesh m = longest_edges_first(connect({{0, 0}, {1, 0}, {0.83, 0.61}}, {{0, 1, 2}}, {}));
  EXPECT_EQ(m.triangles[0], (std::array<Index, 3>{1, 2, 0}));
  std::mt19937 random(3);
  for (int round = 0; round < 25; ++round) {
    std::vector<Index> marked;
    for (std::size_t t = 0; t < m.triangles.size(); ++t)
      if (random() % 4 == 0 || t == 0) marked.push_back(Index(t));
    m = bisect(m, marked);
    if (m.triangles.size() > 20000) break;
  }
  EXPECT_GT(m.triangles.size(), 1000u);
  EXPECT_LE(shapes(m).size(), 4u);
}

TEST(Bisect, IsConformingAndKeepsMarks) {
  const Shape shape = square({{"c", {{-1, 0}, {1, 0.2}}}, {"d", {{0.1, -1}, {-0.1, 1}}}});
  const Mesh start = triangulate(shape, {.size = 0.5});
  Mesh m = longest_edges_first(start);
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& e = m.edges[std::size_t(m.edges_of[t][i])];
      EXPECT_TRUE(e[0] != m.triangles[t][i] && e[1] != m.triangles[t][i]);
      EXPECT_LE(length(m, m.edges_of[t][i]), length(m, m.edges_of[t][0]));
    }
  std::mt19937 random(5);
  for (int round = 0; round < 7; ++round) {
    std::vector<Index> marked;
    std::vector<double> old;
    for (std::size_t t = 0; t < m.triangles.size(); ++t)
      if ((centroid(m, Index(t)) - Vec2(1, 0.2)).norm() < std::pow(0.7, round) || random() % 100 == 0)
        marked.push_back(Index(t));
    const Mesh finer = bisect(m, marked);
    EXPECT_GE(finer.triangles.size(), m.triangles.size() + marked.size());
    EXPECT_EQ(bisect(m, marked).points, finer.points);
    m = finer;
  }
  EXPECT_EQ(bisect(m, {}).triangles, m.triangles);
  double sum = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) sum += area(m, Index(t));
  EXPECT_NEAR(sum, 16, 1e-11);
  EXPECT_EQ(Index(m.points.size()) - Index(m.edges.size()) + Index(m.triangles.size()), 1);
  double boundary = 0;
  for (std::size_t e = 0; e < m.edges.size(); ++e) {
    EXPECT_EQ(m.label[e] != none, m.sides[e][0] == none || m.sides[e][1] == none);
    if (m.label[e] != none) boundary += length(m, Index(e));
  }
  EXPECT_NEAR(boundary, 16, 1e-12);
  for (std::size_t c = 0; c < 2; ++c) {
    Vec2 at = shape.cracks[c].points[0];
    for (const auto& [e, forward] : m.cracks[c]) {
      auto [a, b] = m.edges[std::size_t(e)];
      if (!forward) std::swap(a, b);
      EXPECT_EQ(m.points[std::size_t(a)], at);
      at = m.points[std::size_t(b)];
    }
    EXPECT_EQ(at, shape.cracks[c].points[1]);
  }
  // A halved longest edge leaves no angle below half the smallest one.
  EXPECT_GE(quality(m).min_angle_deg, quality(start).min_angle_deg / 2);
}

TEST(Bisect, EndsWhateverTheEdgesToHalve) {
  // The grid's triangles turned at random: no longest edges, and still a mesh.
  Mesh m = triangulate(square(), {.size = 0.5});
  std::mt19937 random(8);
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const Index turn = Index(random() % 3);
    std::rotate(m.triangles[t].begin(), m.triangles[t].begin() + turn, m.triangles[t].end());
    std::rotate(m.edges_of[t].begin(), m.edges_of[t].begin() + turn, m.edges_of[t].end());
  }
  for (int round = 0; round < 6; ++round) {
    std::vector<Index> marked;
    for (std::size_t t = 0; t < m.triangles.size(); ++t)
      if (random() % 3 == 0) marked.push_back(Index(t));
    m = bisect(m, marked);
  }
  EXPECT_EQ(Index(m.points.size()) - Index(m.edges.size()) + Index(m.triangles.size()), 1);
}

/// Both ends of every arc are those of its edge, per label and crack they turn by as much as before, and the edges of
/// cracks follow each other.
void expect_arcs_of(const Mesh& before, const Mesh& m) {
  const auto turns = [](const Mesh& of) {
    std::map<std::pair<Index, Index>, double> sum;
    for (std::size_t e = 0; e < of.arc.size(); ++e)
      if (of.arc[e] != none) {
        const Arc& arc = of.arcs[std::size_t(of.arc[e])];
        sum[{of.label[e], of.crack[e]}] += std::abs(arc.to - arc.from);
      }
    return sum;
  };
  const auto now = turns(m), then = turns(before);
  ASSERT_EQ(now.size(), then.size());
  for (const auto& [what, turn] : then) EXPECT_NEAR(now.at(what), turn, 1e-12);
  for (std::size_t e = 0; e < m.edges.size(); ++e) {
    if (m.arc[e] == none) continue;
    const Arc& arc = m.arcs[std::size_t(m.arc[e])];
    for (const std::size_t end : {0u, 1u}) {
      const double t = end == 0 ? arc.from : arc.to;
      const Vec2 x = arc.center + arc.axes * Vec2(std::cos(t), std::sin(t));
      EXPECT_LT((x - m.points[std::size_t(m.edges[e][end])]).norm(), 1e-14);
    }
  }
  for (Index t = 0; t < Index(m.triangles.size()); ++t) EXPECT_GT(area(m, t), 0);
}

// Arcs of all kinds, triangles halved and quartered at random: new vertices lie on the arcs, which stay whole.
TEST(Bisect, AndQuarteringFollowArcs) {
  std::mt19937 random(11);
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  for (int body = 0; body < 12; ++body) {
    Shape shape = square();
    shape.holes = {circle("round", {-1, -1}, in(0.2, 0.6), 1),
                   ellipse("long", {1, -1}, {in(0.5, 0.7), in(0.2, 0.4)}, in(0, 3), 2)};
    shape.regions = {circle("core", {-1, 1}, in(0.2, 0.7), none)};
    shape.cracks = {arc_crack("bent", {1, 1}, in(0.2, 0.6), 0, in(0.5, 2.5))};
    shape.labels = {"side", "round", "long"};
    const Mesh first = longest_edges_first(triangulate(shape, {.size = in(0.2, 0.5), .curved = true}));
    Mesh m = first;
    for (int round = 0; round < 3; ++round) {
      if (in(0, 1) < 0.3) {
        m = longest_edges_first(refine(m));
      } else {
        std::vector<Index> marked;
        for (Index t = 0; t < Index(m.triangles.size()); ++t)
          if (in(0, 1) < 0.2) marked.push_back(t);
        m = bisect(m, marked);
      }
      expect_arcs_of(first, m);
    }
    EXPECT_GT(quality(refine(refine(first))).min_angle_deg, 10);
  }
}

}  // namespace
}  // namespace kerf::adapt_test
