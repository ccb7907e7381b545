// Seeded random designs through carving and meshing: a valid mesh, or an error that says why.

#include "geometry/carve.hpp"
#include "geometry/plane.hpp"
#include "geometry/topology.hpp"
#include "kerf/mesher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <random>

namespace kerf::carve_random_test {
namespace {

constexpr double size = 0.04;
using Field = std::function<double(const Vec2&)>;

struct Frame {
  Shape shape;
  Mesh mesh;
};

Mesh uniform(const Shape& shape) {
  const Mesh coarse = triangulate(shape, {.size = size});
  const std::vector<double> sizes(coarse.points.size(), size);
  return triangulate(shape, {.size = size}, {&coarse, sizes});
}

Loop labeled(const std::vector<Vec2>& points) {
  Loop loop = polygon("outline", points, 0);
  for (std::size_t i = 0; i < loop.sides.size(); ++i) loop.sides[i].label = Index(i);
  return loop;
}

std::vector<Frame> frames() {
  std::vector<Shape> shapes;
  const std::vector<std::string> four{"bottom", "right", "top", "left"};
  const Loop plate = labeled({{0, 0}, {2, 0}, {2, 1}, {0, 1}});
  shapes.push_back({plate, {}, {}, four, {}});
  shapes.push_back({plate,
                    {},
                    {{"inner", {{0.5, 0.3}, {1.1, 0.45}}, {}},
                     {"kinked", {{1.3, 0.7}, {1.5, 0.6}, {1.8, 0.75}}, {}},
                     {"edge", {{0, 0.6}, {0.4, 0.65}}, {}}},
                    four,
                    {}});
  Shape holed{plate, {}, {}, four, {}};
  holed.labels.push_back("round");
  holed.labels.push_back("oval");
  holed.holes = {circle("h", {0.6, 0.5}, 0.17, 4), ellipse("e", {1.5, 0.3}, {0.2, 0.08}, 0.4, 5)};
  holed.cracks = {{"out", {{0.77, 0.5}, {1.2, 0.55}}, {}}, arc_crack("bow", {1.5, 0.4}, 0.35, 0.6, 2.4)};
  shapes.push_back(holed);
  Shape bracket{labeled({{0, 0}, {2, 0}, {2, 0.7}, {1, 0.7}, {0.7, 1}, {0.7, 2}, {0, 2}}),
                {},
                {{"c", {{0.2, 0.9}, {0.55, 1.1}}, {}}},
                {"a", "b", "c", "d", "e", "f", "g"},
                {}};
  bracket.outline.sides[3].arc = Arc{{1, 1}, 0.3 * Mat2::Identity(), 1.5 * pi, pi};  // a rounded inner corner
  shapes.push_back(bracket);
  Shape disc{circle("outline", {0, 0}, 0.9, 0),
             {polygon("slot", {{-0.3, -0.55}, {0.3, -0.55}, {0.3, -0.4}, {-0.3, -0.4}}, 1)},
             {{"one", {{-0.5, 0}, {0.5, 0.05}}, {}}, {"two", {{0.1, -0.3}, {-0.05, 0.5}}, {}}},
             {"rim", "slot"},
             {}};
  shapes.push_back(disc);
  shapes.push_back({plate, {}, {{"c", {{0.3, 0.5}, {0.8, 0.5}}, {}}}, four, {circle("stiff", {1.4, 0.5}, 0.15, none)}});
  std::vector<Frame> all;
  for (const Shape& shape : shapes) all.push_back({shape, uniform(shape)});
  for (const Shape& shape : shapes) all.push_back({shape, triangulate(shape, {.size = size})});  // fine at tips
  return all;
}

/// Distance to the boundary of a capsule, positive within.
double capsule(const Vec2& x, const Vec2& a, const Vec2& b, double radius) {
  return radius - distance(x, a, b);
}

struct Random {
  std::mt19937 engine;
  double operator()(double low, double high) {  // the same everywhere, unlike std::uniform_real_distribution
    return low + (high - low) * double(engine()) / 4294967296.0;
  }
  int below(int n) {
    return int(engine() % unsigned(n));
  }
};

/// Overlapping circles, slits, tangent circles, holes over cracks, over their ends, over the outline; lines along
/// cracks and sides; a plateau; waves.
Field design(const Frame& frame, Random& random) {
  std::vector<Field> voids;
  Vec2 low = frame.mesh.points.front(), high = low;
  for (const Vec2& x : frame.mesh.points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const auto anywhere = [&] { return Vec2(random(low.x(), high.x()), random(low.y(), high.y())); };
  const auto on_crack = [&]() -> Vec2 {
    if (frame.mesh.cracks.empty()) return anywhere();
    const auto& edges = frame.mesh.cracks[std::size_t(random.below(int(frame.mesh.cracks.size())))];
    const Index e = edges[std::size_t(random.below(int(edges.size())))].edge;
    return frame.mesh.points[std::size_t(frame.mesh.edges[std::size_t(e)][0])];
  };
  const auto on_tip = [&]() -> Vec2 {
    if (frame.shape.cracks.empty()) return anywhere();
    const Crack& c = frame.shape.cracks[std::size_t(random.below(int(frame.shape.cracks.size())))];
    return random.below(2) ? c.points.front() : c.points.back();
  };
  const auto on_outline = [&]() -> Vec2 {
    const auto& sides = frame.shape.outline.sides;
    const std::size_t i = std::size_t(random.below(int(sides.size())));
    const double s = random(0, 1);
    return (1 - s) * sides[i].start + s * sides[(i + 1) % sides.size()].start;
  };
  const auto add_circle = [&](const Vec2& c, double r) {
    voids.push_back([=](const Vec2& x) { return r - (x - c).norm(); });
  };
  const int count = 1 + random.below(7);
  for (int k = 0; k < count; ++k) {
    const Vec2 c = anywhere();
    const double r = random(0.02, 0.25);
    switch (random.below(12)) {
      case 0:
        add_circle(c, r);
        add_circle(c + r * Vec2(random(-1, 1), random(-1, 1)), random(0.02, 0.2));
        break;
      case 1: {  // a slit, down to nothing
        const Vec2 d = anywhere();
        const double width = random(0, 1.5) * size;
        voids.push_back([=](const Vec2& x) { return capsule(x, c, d, width); });
        break;
      }
      case 2: {  // two circles that touch, or nearly
        const double angle = random(0, 2 * pi), other = random(0.03, 0.2);
        const double gap = random.below(2) ? 0 : random(-0.3, 0.3) * size;
        add_circle(c, r);
        add_circle(c + (r + other + gap) * Vec2(std::cos(angle), std::sin(angle)), other);
        break;
      }
      case 3:
        add_circle(on_crack(), r);
        break;
      case 4: {  // through a crack tip
        const double angle = random(0, 2 * pi);
        add_circle(on_tip() + r * Vec2(std::cos(angle), std::sin(angle)), r * (1 + random(-0.02, 0.02)));
        break;
      }
      case 5:
        add_circle(on_outline(), r);
        break;
      case 6: {  // along a crack, as a line or a slit
        if (frame.shape.cracks.empty()) break;
        const Crack& crack = frame.shape.cracks[std::size_t(random.below(int(frame.shape.cracks.size())))];
        const Vec2 a = crack.points[0], d = crack.points[1] - a;
        const Vec2 n = Vec2(-d.y(), d.x()).normalized();
        const double off = random.below(2) ? 0 : random(-0.2, 0.2) * size, width = random(0.05, 0.2);
        voids.push_back(
            [=](const Vec2& x) { return capsule(x, a + (off + width) * n, a + d + (off + width) * n, width); });
        break;
      }
      case 7: {  // tangent to the outline
        const double off = random(-0.2, 0.2) * size;
        const Vec2 p = on_outline(), inward = ((low + high) / 2 - p).normalized();
        add_circle(p + (r + off) * inward, r);
        break;
      }
      case 8: {  // parallel to a side
        const double y = low.y() + random(-0.3, 0.5) * size;
        voids.push_back([=](const Vec2& x) { return y - x.y(); });
        break;
      }
      case 9: {  // a plateau at exactly zero, which is void
        voids.push_back([=](const Vec2& x) { return std::min(0.0, r - (x - c).norm()); });
        break;
      }
      case 10: {  // many small ones
        for (int i = 0; i < 8; ++i) add_circle(anywhere(), random(0.2, 1.5) * size);
        break;
      }
      default: {
        const double wave = random(2, 9), level = random(0.2, 0.8);
        voids.push_back([=](const Vec2& x) {
          return (std::sin(wave * x.x() + c.x()) * std::sin(wave * x.y() + c.y()) - level) / wave;
        });
      }
    }
  }
  return [voids](const Vec2& x) {
    double f = -10;
    for (const Field& v : voids) f = std::max(f, v(x));
    return f;
  };
}

double total_area(const Mesh& m) {
  double sum = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) sum += area(m, Index(t));
  return sum;
}

/// Reasons for which a design may be refused.
bool legitimate(const std::string& reason) {
  for (const char* words : {"no material is left", "no support is left", "has lost its material",
                            "cut off from the supports", "the body falls apart", "the zero line reaches region"})
    if (reason.find(words) != std::string::npos) return true;
  return false;
}

struct Tally {
  int meshed = 0, refused = 0, smoothed_less = 0;
  double slowest = 0, farthest = 0;
};

void carve_one(const Frame& frame, unsigned seed, Tally& tally) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  Random random{std::mt19937(seed)};
  const Field f = design(frame, random);
  Eigen::VectorXd phi(Index(frame.mesh.points.size()));
  for (Index v = 0; v < phi.size(); ++v) phi[v] = f(frame.mesh.points[std::size_t(v)]);
  constexpr std::array<double, 4> tolerances{0.1, 0.25, 0.02, 0.1};
  Carving how{.tolerance = tolerances[seed / 5 % 4] * size, .spacing = size, .least_area = size * size};
  if (seed % 4 == 3) how.least_width = size / 3;
  if (seed % 3 == 1) {
    how.keep = {0, 1};
    how.holding = {0};
  }
  const std::clock_t start = std::clock();
  Carved carved;
  Mesh mesh;
  try {
    carved = carve(frame.shape, frame.mesh, phi, how);
    mesh = triangulate(carved.shape, {.size = size});
  } catch (const Error& error) {
    EXPECT_EQ(error.fault, Fault::Geometry);
    EXPECT_TRUE(legitimate(error.what())) << error.what();
    ++tally.refused;
    return;
  }
  ++tally.meshed;
  const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
  tally.slowest = std::max(tally.slowest, seconds);
  for (const std::string& n : carved.notes) tally.smoothed_less += n.find("smooth") != std::string::npos;

  EXPECT_FALSE(find_problem(carved.shape).has_value());
  EXPECT_NEAR(total_area(mesh), carved.area, 2e-3 * carved.area);  // arcs become polygons
  EXPECT_EQ(Index(mesh.points.size()) - Index(mesh.edges.size()) + Index(mesh.triangles.size()),
            1 - Index(carved.shape.holes.size()));
  EXPECT_EQ(std::ranges::max(pieces(mesh, std::vector<bool>(mesh.edges.size(), false))), 0);
  EXPECT_GT(quality(mesh).min_angle_deg, 0.05);
  // Every label drawn is in the mesh; every label to keep is drawn.
  std::vector<bool> drawn(carved.shape.labels.size(), false), meshed = drawn;
  const auto see = [&](const Loop& loop) {
    for (const Side& s : loop.sides) drawn[std::size_t(s.label)] = true;
  };
  see(carved.shape.outline);
  for (const Loop& hole : carved.shape.holes) see(hole);
  for (const Index l : mesh.label)
    if (l != none) meshed[std::size_t(l)] = true;
  EXPECT_EQ(drawn, meshed);
  for (const Index l : how.keep) EXPECT_TRUE(meshed[std::size_t(l)]);
  // Cracks: parts of their own, in the mesh with their lengths, and those of the frame that are missing are named.
  ASSERT_EQ(mesh.cracks.size(), carved.shape.cracks.size());
  ASSERT_EQ(carved.crack_of.size(), carved.shape.cracks.size());
  std::vector<double> left(frame.shape.cracks.size(), 0);
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c) {
    const double wanted = path_length(carved.shape.cracks[c]);
    double found = 0;
    for (const CrackEdge& e : mesh.cracks[c]) found += length(mesh, e.edge);
    EXPECT_NEAR(found, wanted, 2e-3 * wanted);
    left[std::size_t(carved.crack_of[c])] += wanted;
  }
  for (std::size_t c = 0; c < left.size(); ++c) {
    const double whole = path_length(frame.shape.cracks[c]);
    EXPECT_LE(left[c], whole * (1 + 1e-9));
    const bool named = std::ranges::any_of(carved.notes, [&](const std::string& n) {
      return n.find("'" + frame.shape.cracks[c].name + "'") != std::string::npos;
    });
    EXPECT_TRUE(named || left[c] > whole * (1 - 1e-9)) << frame.shape.cracks[c].name;
  }
  // The line drawn lies near the zero line, where it does not follow a crack behind which something was dropped.
  if (std::ranges::any_of(carved.notes, [](const std::string& n) { return n.find("only crack") != n.npos; })) return;
  const std::vector<ZeroPiece> line = zero_line(frame.mesh, phi);
  const auto from_line = [&](const Loop& loop) {
    for (const Side& s : loop.sides) {
      if (s.label != carved.design_label) continue;
      double least = 1e9;
      for (const ZeroPiece& p : line) least = std::min(least, distance(s.start, p.a, p.b));
      if (least / std::max(how.tolerance, how.least_width) > 2 && std::getenv("KERF_CARVE_DESIGNS"))
        std::printf("seed %u: %.2f at %g %g\n", seed, least / std::max(how.tolerance, how.least_width), s.start.x(),
                    s.start.y());
      tally.farthest = std::max(tally.farthest, least / std::max(how.tolerance, how.least_width));
    }
  };
  from_line(carved.shape.outline);
  for (const Loop& hole : carved.shape.holes) from_line(hole);
}

TEST(CarveRandom, designs_become_meshes_or_named_errors) {
  const std::vector<Frame> all = frames();
  const char* more = std::getenv("KERF_CARVE_DESIGNS");
  const unsigned count = more ? unsigned(std::atoi(more)) : 200;
  Tally tally;
  for (unsigned seed = 0; seed < count; ++seed) carve_one(all[seed % all.size()], seed, tally);
  RecordProperty("meshed", tally.meshed);
  std::printf("%d meshed, %d refused, %d smoothed less; slowest %.3f s; farthest from the zero line %.2f tolerances\n",
              tally.meshed, tally.refused, tally.smoothed_less, tally.slowest, tally.farthest);
  EXPECT_GT(tally.meshed, int(count) / 2);
  EXPECT_LT(tally.slowest, 2);
  EXPECT_LT(tally.farthest, 4);  // where phi is all but 0 in a whole triangle its own zero line means little
}

}  // namespace
}  // namespace kerf::carve_random_test
