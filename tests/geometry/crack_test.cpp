// Curved cracks, and cracks that cross, branch and share ends.

#include "geometry/topology.hpp"
#include "kerf/mesher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace kerf::crack_test {
namespace {

Shape square(std::vector<Crack> cracks) {
  return {polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0), {}, std::move(cracks), {"side"}};
}

Vec2 direction(double degrees) {
  return {std::cos(degrees * pi / 180), std::sin(degrees * pi / 180)};
}

Crack arc(std::string name, const Vec2& center, double radius, double from_deg, double to_deg) {
  return arc_crack(std::move(name), center, radius, from_deg * pi / 180, to_deg * pi / 180);
}

Index vertex_near(const Mesh& m, const Vec2& x) {
  const auto nearest = std::ranges::min_element(m.points, {}, [&](const Vec2& p) { return (p - x).squaredNorm(); });
  return Index(nearest - m.points.begin());
}

/// Corner numbers at the vertex next to x: the sectors into which the cracks cut its surroundings.
Index fans(const Mesh& m, const Vec2& x) {
  const Index v = vertex_near(m, x);
  return Index(std::ranges::count(split_at_cracks(m).vertex, v));
}

double crack_length(const Mesh& m, std::size_t crack) {
  double sum = 0;
  for (const CrackEdge& piece : m.cracks[crack]) sum += length(m, piece.edge);
  return sum;
}

std::vector<Vec2> path(const Mesh& m, std::size_t crack) {
  std::vector<Vec2> points;
  for (const auto& [e, forward] : m.cracks[crack]) {
    auto [a, b] = m.edges[std::size_t(e)];
    if (!forward) std::swap(a, b);
    if (points.empty()) points.push_back(m.points[std::size_t(a)]);
    EXPECT_EQ(points.back(), m.points[std::size_t(a)]);
    points.push_back(m.points[std::size_t(b)]);
  }
  return points;
}

/// Every crack from its start to its end, along its own edges, on its arc.
void expect_complete(const Shape& shape, const Mesh& m) {
  double sum = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) sum += area(m, Index(t));
  EXPECT_NEAR(sum, 16, 1e-10);
  ASSERT_EQ(m.cracks.size(), shape.cracks.size());
  for (std::size_t c = 0; c < shape.cracks.size(); ++c) {
    const Crack& crack = shape.cracks[c];
    const std::vector<Vec2> points = path(m, c);
    ASSERT_GE(points.size(), 2u);
    EXPECT_LE((points.front() - crack.points.front()).norm(), 1e-5);
    EXPECT_LE((points.back() - crack.points.back()).norm(), 1e-5);
    EXPECT_EQ(std::ranges::count(m.crack, Index(c)), Index(m.cracks[c].size()));
    if (!crack.arc) {
      EXPECT_NEAR(crack_length(m, c), path_length(crack), 1e-9 * path_length(crack));
      continue;
    }
    const double radius = crack.arc->axes.col(0).norm();
    for (const Vec2& x : points) EXPECT_NEAR((x - crack.arc->center).norm(), radius, 1e-12);
    // 32 pieces per turn: chords lose (2 pi / 32)^2 / 24 of the length.
    EXPECT_NEAR(crack_length(m, c), path_length(crack), 2e-3 * path_length(crack));
  }
}

TEST(CurvedCrack, LiesOnItsArcAndGradesToItsTips) {
  for (const double to : {20.0, 90.0, 200.0, -200.0, 350.0, 359.9}) {
    SCOPED_TRACE(to);
    const Shape shape = square({arc("c", {0.1, 0.2}, 1, 0, to)});
    const double tip = 1e-3;
    const Mesh m = triangulate(shape, {.size = 0.1, .crack_tip_size = tip});
    expect_complete(shape, m);
    EXPECT_GE(quality(m).min_angle_deg, 25);
    // Ends with less than two edges between them get a twentieth of what is there.
    const double apart = 2 * std::sin((360 - to) / 2 * pi / 180);
    const double wanted = to > 0 && apart < 2 * tip ? apart / 20 : tip;
    for (const Index e : {m.cracks[0].front().edge, m.cracks[0].back().edge}) {
      EXPECT_GT(length(m, e), wanted / 2);
      EXPECT_LT(length(m, e), wanted * 2);
    }
    EXPECT_EQ(split_at_cracks(m).vertex.size() - m.points.size(), m.cracks[0].size() - 1);
  }
}

TEST(CurvedCrack, HasEdgesOfTheTargetLengthWithoutKinks) {
  const Mesh m = triangulate(square({arc("c", {0, 0}, 1.5, 0, 180)}), {.size = 0.05});
  // Far from its tips the crack is as any line: no edge is shorter than most.
  for (const CrackEdge& piece : m.cracks[0]) {
    const Vec2 x = (m.points[std::size_t(m.edges[std::size_t(piece.edge)][0])] +
                    m.points[std::size_t(m.edges[std::size_t(piece.edge)][1])]) /
                   2;
    if (x.y() > 1) {
      EXPECT_NEAR(length(m, piece.edge), 0.05, 0.01);
    }
  }
  EXPECT_GE(quality(m).mean_quality, 0.97);
}

TEST(CurvedCrack, EndsOnOutlineAndHole) {
  Shape shape = square({arc("c", {2, 0}, 1, 90, 180)});
  shape.holes = {circle("h", {1, -0.4}, 0.4, 0)};
  // Quarter of a circle from (2, 1), on the outline, to (1, 0), on top of the hole.
  const Mesh m = triangulate(shape, {.size = 0.1});
  EXPECT_EQ(split_at_cracks(m).vertex.size() - m.points.size(), m.cracks[0].size() + 1);
  for (const Vec2& x : path(m, 0)) EXPECT_NEAR((x - Vec2(2, 0)).norm(), 1, 1e-12);
}

TEST(CrossingCracks, HaveAVertexWithFourFansAtAnyAngle) {
  for (const double angle : {90.0, 60.0, 30.0, 20.0, 10.0, 5.0, 2.0}) {
    SCOPED_TRACE(angle);
    const Vec2 at(0.1, 0.2), u = direction(7), v = direction(7 + angle);
    const Shape shape = square({{"c", {at - u, at + 0.8 * u}}, {"d", {at - 0.9 * v, at + v}}});
    const Mesh m = triangulate(shape, {.size = 0.2});
    expect_complete(shape, m);
    EXPECT_LE((m.points[std::size_t(vertex_near(m, at))] - at).norm(), 1e-14);
    EXPECT_EQ(fans(m, at), 4);
    EXPECT_EQ(split_at_cracks(m).vertex.size() - m.points.size(), m.cracks[0].size() + m.cracks[1].size() - 1);
    EXPECT_GE(quality(m).min_angle_deg, std::min(25.0, 0.9 * angle));
    EXPECT_LT(m.triangles.size(), 20000u);
  }
}

TEST(CrossingCracks, MayBeManyThroughOnePoint) {
  for (const double off : {0.0, 1e-14, 1e-8}) {
    const Vec2 at(0.3, -0.2);
    std::vector<Crack> cracks;
    for (const double angle : {10.0, 55.0, 130.0})
      cracks.push_back(
          {std::string(1, char('c' + cracks.size())), {at - direction(angle), at + 1.1 * direction(angle)}});
    cracks[2].points[0] += Vec2(off, 0);
    cracks[2].points[1] += Vec2(off, 0);
    const Shape shape = square(cracks);
    const Mesh m = triangulate(shape, {.size = 0.2});
    expect_complete(shape, m);
    EXPECT_EQ(fans(m, at), 6);
  }
}

TEST(CrossingCracks, CrossArcs) {
  const Shape line = square({arc("c", {0, 0}, 1, 0, 350), {"d", {{-1.5, 0.3}, {1.6, 0.5}}}});
  const Mesh m = triangulate(line, {.size = 0.15});
  expect_complete(line, m);
  int crossings = 0;
  for (const Vec2& x : path(m, 1))
    if (std::abs(x.norm() - 1) < 1e-12) {
      ++crossings;
      EXPECT_EQ(fans(m, x), 4);
    }
  EXPECT_EQ(crossings, 2);

  const Shape arcs = square({arc("c", {-0.5, 0}, 1, -80, 100), arc("d", {0.5, 0.1}, 0.9, 60, 300)});
  const Mesh n = triangulate(arcs, {.size = 0.15});
  expect_complete(arcs, n);
  crossings = 0;
  for (const Vec2& x : path(n, 0))
    if (std::abs((x - Vec2(0.5, 0.1)).norm() - 0.9) < 1e-12) {
      ++crossings;
      EXPECT_EQ(fans(n, x), 4);
    }
  EXPECT_EQ(crossings, 2);

  // An arc that a line cuts off at 8 degrees: the two pieces between the crossings are a thin lens.
  const Shape lens = square({arc("c", {0, -1}, 1.5, 40, 140), {"d", {{-1, 0.485}, {1, 0.485}}}});
  expect_complete(lens, triangulate(lens, {.size = 0.2}));
}

TEST(BranchingCracks, HaveThreeFansAndNoTipThere) {
  for (const double angle : {90.0, 45.0, 20.0, 5.0}) {
    SCOPED_TRACE(angle);
    const Vec2 at(0.13, 0), end = at + direction(angle);
    const Shape shape = square({{"c", {{-1, 0}, {1, 0}}}, {"d", {at, end}}});
    const Mesh m = triangulate(shape, {.size = 0.2, .crack_tip_size = 1e-4});
    expect_complete(shape, m);
    EXPECT_EQ(fans(m, at), 3);
    EXPECT_GE(quality(m).min_angle_deg, std::min(25.0, 0.9 * angle));
    EXPECT_GT(length(m, m.cracks[1].front().edge), 1e-3);
    EXPECT_LT(length(m, m.cracks[1].back().edge), 2e-4);
  }
}

TEST(BranchingCracks, MayBeGivenInDecimals) {
  // The end lies 4e-7 off the oblique crack, on either side of it.
  for (const double off : {4e-7, -4e-7}) {
    const Vec2 u = direction(33), n = direction(123);
    const Shape shape = square({{"c", {-u, u}}, {"d", {0.2 * u + off * n, 0.2 * u + n}}});
    const Mesh m = triangulate(shape, {.size = 0.2});
    EXPECT_EQ(fans(m, 0.2 * u), 3);
    EXPECT_NEAR(crack_length(m, 0), 2, 1e-12);
    EXPECT_NEAR(crack_length(m, 1), 1, 1e-6);
  }
}

TEST(BranchingCracks, ShareEndsKinksAndMouths) {
  const Shape tips = square({{"c", {{-1, 0}, {0, 0}}}, {"d", {{0, 0}, {1, 1}}}, {"e", {{1, -1}, {0, 0}}}});
  Mesh m = triangulate(tips, {.size = 0.2});
  expect_complete(tips, m);
  EXPECT_EQ(fans(m, {0, 0}), 3);
  const Shape kinks = square({{"c", {{-1, -1}, {0, 0}, {1, -1}}}, {"d", {{-1, 1}, {0, 0}, {1, 1}}}});
  m = triangulate(kinks, {.size = 0.2});
  expect_complete(kinks, m);
  EXPECT_EQ(fans(m, {0, 0}), 4);
  const Shape mouth = square({{"c", {{-2, 0}, {0, 0}}}, {"d", {{-2, 0}, {0, 1}}}});
  m = triangulate(mouth, {.size = 0.2});
  expect_complete(mouth, m);
  EXPECT_EQ(fans(m, {-2, 0}), 3);
  // A square cut out of the body: two pieces.
  const Shape cut = square({{"c", {{-1, -1}, {1, -1}, {1, 1}}}, {"d", {{-1, -1}, {-1, 1}, {1, 1}}}});
  m = triangulate(cut, {.size = 0.2});
  expect_complete(cut, m);
  std::vector<bool> cracked(m.edges.size());
  for (std::size_t e = 0; e < cracked.size(); ++e) cracked[e] = m.crack[e] != none;
  const std::vector<Index> piece = pieces(m, cracked);
  EXPECT_EQ(*std::ranges::max_element(piece), 1);
  const Shape arcs = square({arc("c", {0, 0}, 1, 0, 180), arc("d", {0, 0}, 1, 180, 270), {"e", {{0, -1}, {1, 0}}}});
  m = triangulate(arcs, {.size = 0.2});
  expect_complete(arcs, m);
  for (const Vec2& x : {Vec2(-1, 0), Vec2(1, 0), Vec2(0, -1)}) EXPECT_EQ(fans(m, x), 2);
}

TEST(BranchingCracks, AreDeterministic) {
  const Shape shape = square({arc("c", {0, 0}, 1, 0, 300), {"d", {{-1.5, 0.3}, {1.6, 0.5}}}, {"e", {{0, 0}, {1, 0}}}});
  const Mesh a = triangulate(shape, {.size = 0.1}), b = triangulate(shape, {.size = 0.1});
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.crack, b.crack);
}

/// Random sets of cracks in a square: every crack complete, or a refusal that names one.
TEST(RandomCracks, AreNamedOrMeshed) {
  int meshed = 0, curved = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto pick = [&](double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; };
    const auto place = [&]() -> Vec2 { return {pick(-1.8, 1.8), pick(-1.8, 1.8)}; };
    std::vector<Crack> cracks;
    for (int i = 1 + int(pick(0, 4)); i > 0; --i) {
      const std::string name(1, char('p' + i));
      const double kind = pick(0, 1);
      if (kind < 0.3) {
        cracks.push_back(
            arc(name, {pick(-0.8, 0.8), pick(-0.8, 0.8)}, pick(0.2, 1.1), pick(-180, 180), pick(180, 360)));
      } else {
        cracks.push_back({name, {place(), place()}, {}});
        if (kind < 0.5) cracks.back().points.push_back(place());
        // A branch: it starts on an earlier crack.
        if (kind > 0.7 && cracks.size() > 1 && !cracks[cracks.size() - 2].arc) {
          const auto& other = cracks[cracks.size() - 2].points;
          cracks.back().points[0] = other[0] + pick(0, 1) * (other[1] - other[0]);
        }
      }
    }
    const Shape shape = square(cracks);
    try {
      const Mesh m = triangulate(shape, {.size = 0.3});
      expect_complete(shape, m);
      ++meshed;
      curved += std::ranges::any_of(cracks, [](const Crack& c) { return c.arc.has_value(); });
    } catch (const Error& error) {
      EXPECT_EQ(error.fault, Fault::Geometry);
      EXPECT_NE(std::string(error.what()).find('\''), std::string::npos) << error.what();
    }
  }
  EXPECT_GE(meshed, 60);
  EXPECT_GE(curved, 20);
}

// Two tips 2e-6 apart in a body of 5.7 are one, a mouth 1e-7 beside the side lies on it: the user is told. Ends that
// meet but for rounding are as drawn.
TEST(CrackEnds, AreNotJoinedInSilence) {
  const auto notes = [](std::vector<Crack> cracks) { return crowded_tips(square(std::move(cracks)), {.size = 0.3}); };
  const auto tips = notes({{"l", {{-1, 0}, {-1e-6, 0}}, {}}, {"r", {{1e-6, 0}, {1, 0}}, {}}});
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_NE(tips[0].find("is moved by 2e-06, onto the next thing drawn"), std::string::npos) << tips[0];
  EXPECT_EQ(notes({{"m", {{-2 + 1e-7, 0}, {0, 0}}, {}}}).size(), 1u);
  EXPECT_TRUE(notes({{"m", {{-2 + 1e-12, 0}, {0, 0}}, {}}}).empty());
  EXPECT_TRUE(notes({{"l", {{-1, 0}, {0, 0}}, {}}, {"r", {{1e-12, 0}, {1, 0.2}}, {}}}).empty());
}

}  // namespace
}  // namespace kerf::crack_test
