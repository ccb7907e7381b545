// Bodies that a level set cuts out of a frame: areas, lengths of sides and numbers of holes against those of the
// circles and strips that the level set describes, and what must hold whatever was carved.

#include "geometry/carve.hpp"

#include "geometry/plane.hpp"
#include "geometry/shape/drawing.hpp"
#include "kerf/mesher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace kerf::carve_test {
namespace {

using Field = std::function<double(const Vec2&)>;

Shape plate(double width = 2, double height = 1) {
  Shape shape{polygon("outline", {{0, 0}, {width, 0}, {width, height}, {0, height}}, 0), {}, {}, {}};
  shape.labels = {"bottom", "right", "top", "left", "hole"};
  for (Index i = 0; i < 4; ++i) shape.outline.sides[std::size_t(i)].label = i;
  return shape;
}

/// Edges of one length everywhere, at cracks too.
Mesh uniform(const Shape& shape, double size) {
  const Mesh coarse = triangulate(shape, {.size = size});
  const std::vector<double> sizes(coarse.points.size(), size);
  return triangulate(shape, {.size = size}, {&coarse, sizes});
}

Eigen::VectorXd values(const Mesh& mesh, const Field& phi) {
  Eigen::VectorXd f(Index(mesh.points.size()));
  for (Index v = 0; v < f.size(); ++v) f[v] = phi(mesh.points[std::size_t(v)]);
  return f;
}

Field void_circle(const Vec2& center, double radius) {
  return [=](const Vec2& x) { return radius - (x - center).norm(); };
}
Field both(Field f, Field g) {  // the material of both
  return [=](const Vec2& x) { return std::max(f(x), g(x)); };
}

/// Area that two circles of this radius share.
double lens(double radius, double apart) {
  const double half = apart / 2 / radius;
  return 2 * radius * radius * (std::acos(half) - half * std::sqrt(1 - half * half));
}

double total_area(const Mesh& m) {
  double sum = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) sum += area(m, Index(t));
  return sum;
}
double length_of(const Mesh& m, Index label) {
  double sum = 0;
  for (std::size_t e = 0; e < m.edges.size(); ++e)
    if (m.label[e] == label) sum += length(m, Index(e));
  return sum;
}
bool says(const Carved& carved, const std::string& words) {
  return std::any_of(carved.notes.begin(), carved.notes.end(),
                     [&](const std::string& n) { return n.find(words) != std::string::npos; });
}

TEST(Carve, zero_line_of_a_circle) {
  const Mesh mesh = uniform(plate(), 0.05);
  const Eigen::VectorXd phi = values(mesh, void_circle({1, 0.5}, 0.3));
  double length = 0, moment = 0;
  for (const ZeroPiece& p : zero_line(mesh, phi)) {
    length += (p.b - p.a).norm();
    moment += cross(p.a - Vec2(1, 0.5), p.b - Vec2(1, 0.5));
  }
  EXPECT_NEAR(length, 2 * pi * 0.3, 5e-3);
  EXPECT_NEAR(moment / 2, -pi * 0.09, 1e-3);  // clockwise around the hole
  EXPECT_NEAR(negative_area(mesh, phi), 2 - pi * 0.09, 1e-3);
  EXPECT_NEAR(negative_area(mesh, phi), 2 + moment / 2, 1e-12);
}

TEST(Carve, hole) {
  const Mesh mesh = uniform(plate(), 0.05);
  const Eigen::VectorXd phi = values(mesh, void_circle({1, 0.5}, 0.3));
  const Carved carved = carve(plate(), mesh, phi, {.tolerance = 0.005, .spacing = 0.05});
  ASSERT_EQ(carved.shape.holes.size(), 1u);
  EXPECT_EQ(carved.shape.labels.back(), "design");
  EXPECT_EQ(carved.design_label, 5);
  EXPECT_EQ(carved.shape.outline.sides.size(), 4u);
  EXPECT_TRUE(carved.notes.empty()) << carved.notes.front();
  EXPECT_NEAR(carved.area, negative_area(mesh, phi), 1e-6);
  for (const Side& side : carved.shape.holes[0].sides) EXPECT_NEAR((side.start - Vec2(1, 0.5)).norm(), 0.3, 0.005);
  EXPECT_GE(carved.shape.holes[0].sides.size(), 30u);
  EXPECT_LE(carved.shape.holes[0].sides.size(), 40u);
  const Mesh result = triangulate(carved.shape, {.size = 0.05});
  EXPECT_NEAR(total_area(result), carved.area, 1e-12);
  EXPECT_LT(double(result.triangles.size()), 1.2 * double(mesh.triangles.size()));
}

TEST(Carve, over_the_outline) {
  const Mesh mesh = uniform(plate(), 0.05);
  const Eigen::VectorXd phi = values(mesh, both(void_circle({1, 1}, 0.4), void_circle({2, 0}, 0.3)));
  const Carved carved = carve(plate(), mesh, phi, {.tolerance = 0.005, .spacing = 0.05});
  EXPECT_TRUE(carved.shape.holes.empty());
  EXPECT_NEAR(carved.area, negative_area(mesh, phi), 1e-6);
  const Mesh result = triangulate(carved.shape, {.size = 0.05});
  EXPECT_NEAR(total_area(result), carved.area, 1e-12);
  EXPECT_NEAR(length_of(result, 2), 1.2, 0.005);  // top
  EXPECT_NEAR(length_of(result, 0), 1.7, 0.005);
  EXPECT_NEAR(length_of(result, 1), 0.7, 0.005);
  EXPECT_NEAR(length_of(result, 3), 1, 1e-12);
  EXPECT_NEAR(length_of(result, 5), pi * 0.4 + pi / 2 * 0.3, 1e-2);
  EXPECT_EQ(std::ranges::count_if(carved.shape.outline.sides, [](const Side& s) { return s.label == 2; }), 2);
}

TEST(Carve, island_is_dropped) {
  const Mesh mesh = uniform(plate(), 0.05);
  const Field ring = [](const Vec2& x) {
    const double r = (x - Vec2(1, 0.5)).norm();
    return std::min(r - 0.15, 0.35 - r);
  };
  const Eigen::VectorXd phi = values(mesh, ring);
  const Carved carved =
      carve(plate(), mesh, phi, {.tolerance = 0.005, .spacing = 0.05, .keep = {1, 3}, .holding = {3}});
  EXPECT_EQ(carved.shape.holes.size(), 1u);
  EXPECT_NEAR(carved.area, 2 - pi * 0.35 * 0.35, 2e-3);
  EXPECT_TRUE(says(carved, "island"));
}

TEST(Carve, crack_is_cut) {
  Shape frame = plate();
  frame.cracks = {{"c", {{0.4, 0.5}, {1.6, 0.5}}, {}}};
  const Mesh mesh = uniform(frame, 0.05);
  const Eigen::VectorXd phi = values(mesh, void_circle({1, 0.52}, 0.2));
  const Carved carved = carve(frame, mesh, phi, {.tolerance = 0.005, .spacing = 0.05});
  ASSERT_EQ(carved.shape.cracks.size(), 2u);
  EXPECT_EQ(carved.shape.cracks[0].name, "c");
  EXPECT_EQ(carved.shape.cracks[1].name, "c.2");
  EXPECT_EQ(carved.crack_of, (std::vector<Index>{0, 0}));
  const double half = std::sqrt(0.04 - 0.0004);
  EXPECT_NEAR(path_length(carved.shape.cracks[0]), 0.6 - half, 0.005);
  EXPECT_NEAR(path_length(carved.shape.cracks[1]), 0.6 - half, 0.005);
  const Mesh result = triangulate(carved.shape, {.size = 0.05});
  EXPECT_EQ(result.cracks.size(), 2u);
}

constexpr double h = 0.05;
constexpr double tolerance = 0.005;
const Carving usual{.tolerance = tolerance, .spacing = h, .least_area = h * h};
const Carving held{
    .tolerance = tolerance, .spacing = h, .least_area = h * h, .keep = {1, 3}, .holding = {3}};  // load right

struct Made {
  Carved carved;
  Mesh mesh;
};
/// What must hold whatever was carved.
Made make(const Shape& frame, const Mesh& background, const Field& phi, const Carving& how) {
  Made made{carve(frame, background, values(background, phi), how), {}};
  made.mesh = triangulate(made.carved.shape, {.size = h});
  EXPECT_NEAR(total_area(made.mesh), made.carved.area, 1e-3 * made.carved.area);
  EXPECT_EQ(Index(made.mesh.points.size()) - Index(made.mesh.edges.size()) + Index(made.mesh.triangles.size()),
            1 - Index(made.carved.shape.holes.size()));
  EXPECT_EQ(made.carved.crack_of.size(), made.carved.shape.cracks.size());
  return made;
}
std::string reason(const Shape& frame, const Mesh& background, const Field& phi, const Carving& how) {
  try {
    carve(frame, background, values(background, phi), how);
  } catch (const Error& error) {
    EXPECT_EQ(error.fault, Fault::Geometry);
    return error.what();
  }
  return "";
}

TEST(Carve, nothing_to_carve_is_the_frame) {
  Shape frame = plate();
  frame.holes = {circle("h", {0.5, 0.5}, 0.2, 4)};
  frame.cracks = {arc_crack("c", {1.2, 0.5}, 0.3, 0.5, 2.5)};
  const Mesh mesh = uniform(frame, h);
  const Made made = make(
      frame, mesh, [](const Vec2&) { return -1.0; }, usual);
  EXPECT_TRUE(made.carved.notes.empty());
  EXPECT_EQ(made.carved.shape.outline.sides.size(), 4u);
  ASSERT_EQ(made.carved.shape.holes.size(), 1u);
  EXPECT_TRUE(made.carved.shape.holes[0].sides[0].arc.has_value());
  ASSERT_EQ(made.carved.shape.cracks.size(), 1u);
  EXPECT_TRUE(made.carved.shape.cracks[0].arc.has_value());
  EXPECT_NEAR(made.carved.area, 2 - pi * 0.04, 1e-12);
}

TEST(Carve, zeros_at_vertices) {
  const Mesh mesh = uniform(plate(), h);
  const Field f = void_circle({1, 0.5}, 0.3);
  const Field zeros = [&](const Vec2& x) { return std::abs(f(x)) < 0.3 * h ? 0.0 : f(x); };
  const Made made = make(plate(), mesh, zeros, usual);
  EXPECT_EQ(made.carved.shape.holes.size(), 1u);
  EXPECT_NEAR(made.carved.area, negative_area(mesh, values(mesh, zeros)), 1e-4);
}

TEST(Carve, plateau_of_zeros_is_void) {
  const Mesh mesh = uniform(plate(), h);
  const Made made = make(
      plate(), mesh, [](const Vec2& x) { return std::min(0.0, 0.3 - (x - Vec2(1, 0.5)).norm()); }, usual);
  // Negative beyond the circle, zero within.
  EXPECT_EQ(made.carved.shape.holes.size(), 1u);
  EXPECT_NEAR(made.carved.area, 2 - pi * 0.09, h * 2 * pi * 0.3);
}

TEST(Carve, touching_holes_are_merged) {
  const Mesh mesh = uniform(plate(), h);
  const auto two = [](double gap) {
    return both(void_circle({0.7 - gap / 2, 0.5}, 0.3), void_circle({1.3 + gap / 2, 0.5}, 0.3));
  };
  const Made touching = make(plate(), mesh, two(0), usual);
  EXPECT_EQ(touching.carved.shape.holes.size(), 1u);
  const Made apart = make(plate(), mesh, two(1.2 * h), {.tolerance = tolerance, .spacing = h, .least_width = h / 2});
  EXPECT_EQ(apart.carved.shape.holes.size(), 2u);
  EXPECT_NEAR(apart.carved.area, 2 - 2 * pi * 0.09, 4e-3);
  // Whatever the distance, the two are apart or one.
  for (double gap = -0.5 * h; gap < 0.7 * h; gap += 0.07 * h) {
    const Made made = make(plate(), mesh, two(gap), {.tolerance = tolerance, .spacing = h, .least_width = h / 2});
    EXPECT_NEAR(made.carved.area, 2 - 2 * pi * 0.09, 8e-3) << gap;
  }
}

TEST(Carve, thin_strip_is_opened_and_thin_slit_closed) {
  const Mesh mesh = uniform(plate(), h);
  int notes = 0;
  for (double y = 0.48; y < 0.52; y += 0.003) {  // a member of 0.3 h in a void box
    const Field member = [y](const Vec2& x) {
      const double box = std::min(0.3 - std::abs(x.x() - 1), 0.3 - std::abs(x.y() - 0.5));
      return std::min(box, std::abs(x.y() - y) - 0.15 * h);
    };
    const Made opened = make(plate(), mesh, member, {.tolerance = tolerance, .spacing = h, .least_width = h / 2});
    EXPECT_EQ(opened.carved.shape.holes.size(), 1u) << y;
    EXPECT_NEAR(opened.carved.area, 2 - 0.36, 0.04) << y;  // stubs of the member may stay
    notes += says(opened.carved, "opened necks of material");
  }
  EXPECT_GT(notes, 0);
  const Made closed = make(
      plate(), mesh,
      [](const Vec2& x) { return 0.05 * tolerance - std::max(std::abs(x.x() - 1) - 0.3, std::abs(x.y() - 0.5)); },
      usual);
  EXPECT_EQ(closed.carved.shape.holes.size(), 0u);
  EXPECT_NEAR(closed.carved.area, 2, 1e-12);
}

TEST(Carve, small_hole_is_filled) {
  const Mesh mesh = uniform(plate(), h);
  const Made made = make(plate(), mesh, both(void_circle({0.5, 0.5}, 0.04), void_circle({1.5, 0.5}, 0.2)),
                         {.tolerance = tolerance, .spacing = h, .least_area = 0.01});
  EXPECT_EQ(made.carved.shape.holes.size(), 1u);
  EXPECT_TRUE(says(made.carved, "filled a hole"));
}

TEST(Carve, tangent_to_the_outline) {
  const Mesh mesh = uniform(plate(), h);
  for (const double off : {-0.02, -0.004, -0.001, 0.0, 0.001, 0.004, 0.02}) {
    const Made made = make(plate(), mesh, void_circle({1, 0.3 + off}, 0.3), usual);
    EXPECT_NEAR(made.carved.area, 2 - pi * 0.09, 0.01) << off;
    EXPECT_LE(made.carved.shape.holes.size(), 1u);
    EXPECT_GT(length_of(made.mesh, 0), 1.6);
  }
}

TEST(Carve, along_the_outline) {
  const Mesh mesh = uniform(plate(), h);
  for (const double y : {-0.01, -0.001, 0.0, 0.0005, 0.002, 0.01}) {
    const Made made = make(
        plate(), mesh, [y](const Vec2& x) { return y - x.y(); }, usual);
    EXPECT_NEAR(made.carved.area, 2 * (1 - std::max(0.0, y)), 2 * 1.5 * tolerance) << y;
  }
}

TEST(Carve, untouched_hole_is_the_frames_own_and_touched_one_keeps_its_arc) {
  Shape frame = plate();
  frame.holes = {circle("a", {0.5, 0.5}, 0.2, 4), circle("b", {1.4, 0.5}, 0.2, 4)};
  const Mesh mesh = uniform(frame, h);
  const Made made = make(frame, mesh, void_circle({1.7, 0.5}, 0.2), usual);
  ASSERT_EQ(made.carved.shape.holes.size(), 2u);
  const auto named = [&](const char* name) {
    return *std::ranges::find_if(made.carved.shape.holes, [&](const Loop& l) { return l.name == name; });
  };
  const Loop a = named("a"), b = named("b");
  ASSERT_EQ(a.sides.size(), 1u);
  EXPECT_EQ(a.sides[0].start, frame.holes[0].sides[0].start);
  EXPECT_TRUE(a.sides[0].arc.has_value());
  EXPECT_EQ(std::ranges::count_if(b.sides, [](const Side& s) { return s.arc && s.label == 4; }), 1);
  EXPECT_NEAR(std::abs(signed_area(b)), pi * 0.04 * 2 - lens(0.2, 0.3), 3e-3);
}

// The mesher moves the corners between arcs that go on smoothly, so that the area is kept.
TEST(Carve, a_circle_in_pieces_is_the_frames_own) {
  Shape frame = plate();
  const Vec2 center(0.5, 0.5);
  Loop hole{"arcs", {}};
  for (int k = 0; k < 4; ++k)
    hole.sides.push_back({center + 0.2 * Vec2(std::cos(k * pi / 2), std::sin(k * pi / 2)), 4,
                          Arc{center, 0.2 * Mat2::Identity(), k * pi / 2, (k + 1) * pi / 2}});
  frame.holes = {hole};
  const Mesh mesh = uniform(frame, 0.05);
  const Carved c = carve(frame, mesh, values(mesh, void_circle({1.4, 0.5}, 0.2)), {});
  EXPECT_EQ(c.shape.holes.size(), 2u);
  EXPECT_NEAR(area(c.shape), 2 - 2 * pi * 0.04, 2e-3);
}

TEST(Carve, island_cut_off_from_the_supports) {
  const Mesh mesh = uniform(plate(), h);
  const Field gap = [](const Vec2& x) { return 0.1 - std::abs(x.x() - 1); };
  EXPECT_NE(reason(plate(), mesh, gap, held).find("load on 'right' is cut off from the supports"), std::string::npos);
  // Without a load on it, it is dropped, support or not.
  Carving two = held;
  two.keep = {0, 1, 3};
  two.holding = {1, 3};
  two.keep = {1, 3};
  const Made made = make(plate(), mesh, gap, {.tolerance = tolerance, .spacing = h, .keep = {3}, .holding = {3}});
  EXPECT_TRUE(says(made.carved, "island"));
  EXPECT_TRUE(says(made.carved, "nothing is left of the boundary 'right'"));
  EXPECT_NEAR(made.carved.area, 0.9, 2e-3);
  const Made support = make(plate(), mesh, gap, two);
  EXPECT_TRUE(says(support.carved, "with it the support"));
  EXPECT_NEAR(support.carved.area, 0.9, 2e-3);
}

TEST(Carve, pieces_with_loads_and_supports_of_their_own) {
  Shape frame = plate();
  frame.labels = {"support", "load", "support", "load 2"};
  const Mesh mesh = uniform(frame, h);
  const Field gap = [](const Vec2& x) { return 0.1 - std::abs(x.x() - 1); };
  EXPECT_NE(reason(frame, mesh, gap, {.tolerance = tolerance, .keep = {0, 1, 2, 3}, .holding = {0, 2}})
                .find("the body falls apart"),
            std::string::npos);
}

TEST(Carve, reasons) {
  const Mesh mesh = uniform(plate(), h);
  EXPECT_NE(reason(
                plate(), mesh, [](const Vec2&) { return 1.0; }, usual)
                .find("no material is left"),
            std::string::npos);
  EXPECT_NE(reason(
                plate(), mesh, [](const Vec2&) { return 0.0; }, usual)
                .find("no material is left"),
            std::string::npos);
  EXPECT_NE(reason(
                plate(), mesh, [](const Vec2& x) { return x.x() - 1.5; }, held)
                .find("the boundary 'right' has lost its material"),
            std::string::npos);
  Shape frame = plate();
  frame.regions = {circle("stiff", {1, 0.5}, 0.2, none)};
  const Mesh with_region = uniform(frame, h);
  EXPECT_NE(reason(frame, with_region, void_circle({1.3, 0.5}, 0.2), usual).find("reaches region 'stiff'"),
            std::string::npos);
  for (const double r : {0.2, 0.23, 0.25, 0.26, 0.27}) {  // as near as can be
    const std::string problem = reason(frame, with_region, void_circle({1.45, 0.5}, r), usual);
    EXPECT_TRUE(problem.empty() || problem.find("reaches region 'stiff'") != std::string::npos) << problem;
  }
  EXPECT_THROW(carve(plate(), mesh, Eigen::VectorXd::Ones(3), usual), std::invalid_argument);
  EXPECT_THROW(carve(plate(), mesh, Eigen::VectorXd::Constant(Index(mesh.points.size()), NAN), usual),
               std::invalid_argument);
  EXPECT_THROW(carve(plate(3, 1), mesh, values(mesh, void_circle({1, 0.5}, 0.3)), usual), std::invalid_argument);
  EXPECT_THROW(carve(plate(), mesh, values(mesh, void_circle({1, 0.5}, 0.3)), {.tolerance = -1}),
               std::invalid_argument);
}

TEST(Carve, through_a_crack_tip) {
  Shape frame = plate();
  frame.cracks = {{"c", {{0.4, 0.5}, {1.1, 0.5}}, {}}};
  const Mesh mesh = uniform(frame, h);
  for (double off = -3 * tolerance; off < 3.1 * tolerance; off += 0.25 * tolerance) {
    const Made made = make(frame, mesh, void_circle({1.4 + off, 0.5}, 0.3), usual);
    ASSERT_EQ(made.carved.shape.cracks.size(), 1u) << off;
    const Vec2 end = made.carved.shape.cracks[0].points.back();
    if (end.x() == 1.1) {  // the tip is left: clear of the hole
      double least = 1;
      const auto& sides = made.carved.shape.holes[0].sides;
      for (std::size_t i = 0; i < sides.size(); ++i)
        least = std::min(least, distance(end, sides[i].start, sides[(i + 1) % sides.size()].start));
      EXPECT_GT(least, 0.5 * tolerance) << off;
    } else {
      EXPECT_NEAR(end.x(), 1.1 + off, 2 * tolerance) << off;
      EXPECT_TRUE(says(made.carved, "'c'"));
    }
  }
  const Made made = make(frame, mesh, void_circle({1.4, 0.5}, 0.3), usual);
  EXPECT_TRUE(says(made.carved, "passes the end of crack 'c'"));
}

TEST(Carve, stub_of_a_crack_is_dropped) {
  Shape frame = plate();
  frame.cracks = {{"c", {{0.4, 0.5}, {1.1, 0.5}}, {}}};
  const Mesh mesh = uniform(frame, h);
  const Made made = make(frame, mesh, void_circle({0.79, 0.5}, 0.296), usual);  // 0.014 stick out
  ASSERT_EQ(made.carved.shape.cracks.size(), 1u);
  EXPECT_TRUE(says(made.carved, "dropped a stub of crack 'c'"));
  EXPECT_NEAR(path_length(made.carved.shape.cracks[0]), 0.094, tolerance);
}

TEST(Carve, along_a_crack) {
  Shape frame = plate();
  frame.cracks = {{"c", {{0.4, 0.5}, {1.6, 0.52}}, {}}};
  const Mesh mesh = uniform(frame, h);
  for (const double off : {-0.02, -0.006, -0.002, 0.0, 0.002, 0.006, 0.02}) {
    const Field line = [off](const Vec2& x) { return x.y() - 0.5 - (x.x() - 0.4) / 60 - off; };
    const Made made = make(frame, mesh, line, usual);
    EXPECT_NEAR(made.carved.area, 2 * (0.51 + off), 2 * 2 * tolerance) << off;
    if (off < tolerance || off >= 0.02) {
      EXPECT_EQ(made.carved.shape.cracks.size(), off < tolerance ? 0u : 1u) << off;
    }
    EXPECT_EQ(says(made.carved, "crack 'c' lies in the void"), made.carved.shape.cracks.empty());
  }
}

TEST(Carve, kinked_and_curved_cracks) {
  Shape frame = plate();
  frame.cracks = {{"k", {{0.2, 0.2}, {0.5, 0.3}, {0.9, 0.2}}, {}}, arc_crack("c", {1.4, 0.4}, 0.3, 0.2, 2.9)};
  const Mesh mesh = uniform(frame, h);
  const Made made = make(frame, mesh, both(void_circle({0.8, 0.2}, 0.15), void_circle({1.4, 0.72}, 0.1)), usual);
  ASSERT_EQ(made.carved.shape.cracks.size(), 3u);
  EXPECT_EQ(made.carved.crack_of, (std::vector<Index>{0, 1, 1}));
  EXPECT_EQ(made.carved.shape.cracks[0].points.size(), 3u);
  EXPECT_EQ(made.carved.shape.cracks[0].points[1], Vec2(0.5, 0.3));
  EXPECT_EQ(made.carved.shape.cracks[2].name, "c.2");
  for (const std::size_t c : {1u, 2u}) {
    ASSERT_TRUE(made.carved.shape.cracks[c].arc.has_value());
    EXPECT_NEAR(path_length(made.carved.shape.cracks[c]), 0.3 * (2.7 - 2 * 2 * std::asin(0.05 / 0.3)) / 2, 0.03);
    double sum = 0;
    for (const CrackEdge& e : made.mesh.cracks[c]) sum += length(made.mesh, e.edge);
    EXPECT_NEAR(sum, path_length(made.carved.shape.cracks[c]), 1e-3);
  }
}

TEST(Carve, what_hangs_on_a_crack_alone_is_dropped) {
  Shape frame = plate();
  frame.cracks = {{"c", {{1, 0}, {1, 0.6}}, {}}};
  const Mesh mesh = uniform(frame, h);
  // A slot from the crack's end to the bottom cuts a block loose, but for the crack.
  const Field slot = [](const Vec2& x) {
    const double up = std::min(0.1 - std::abs(x.y() - 0.6), 0.35 - std::abs(x.x() - 1.25));
    const double down = std::min(0.1 - std::abs(x.x() - 1.5), 0.7 - x.y());
    return std::max(up, down);
  };
  const Made made = make(frame, mesh, slot, held);
  EXPECT_TRUE(says(made.carved, "only crack 'c' connects"));
  EXPECT_TRUE(made.carved.shape.cracks.empty());
  EXPECT_NEAR(made.carved.area, 2 - 0.6 * 0.7 - 0.1 * 0.2, 0.01);
}

TEST(Carve, kept_sides_and_labels) {
  Shape frame = plate();
  frame.outline.sides[2].keep = true;  // one edge along the whole top
  const Mesh mesh = uniform(frame, h);
  const Made made = make(frame, mesh, void_circle({1, 0.3}, 0.2), usual);
  EXPECT_TRUE(made.carved.shape.outline.sides[2].keep);
  frame = plate();
  Carving how = usual;
  how.keep = {0};
  const Mesh again = uniform(frame, h);
  const Made cut = make(frame, again, void_circle({2, 0}, 0.5), how);
  EXPECT_TRUE(says(cut.carved, "is left of the boundary 'bottom'"));
}

TEST(Carve, smooth_lines_are_not_refined) {
  const Mesh mesh = uniform(plate(), 0.02);
  const Field waves = [](const Vec2& x) { return std::sin(3 * pi * x.x() + 0.3) * std::cos(3 * pi * x.y()) - 0.4; };
  const Carved carved = carve(plate(), mesh, values(mesh, waves), {.tolerance = 0.002, .spacing = 0.02});
  const Mesh result = triangulate(carved.shape, {.size = 0.02});
  EXPECT_LT(double(result.triangles.size()), 1.15 * carved.area / total_area(mesh) * double(mesh.triangles.size()));
}

TEST(Carve, deterministic) {
  Shape frame = plate();
  frame.cracks = {{"c", {{0.4, 0.5}, {1.6, 0.52}}, {}}};
  const Mesh mesh = uniform(frame, h);
  const Eigen::VectorXd phi = values(mesh, both(void_circle({1, 0.52}, 0.2), void_circle({1.9, 0.9}, 0.4)));
  const Carved one = carve(frame, mesh, phi, usual), other = carve(frame, mesh, phi, usual);
  ASSERT_EQ(one.shape.outline.sides.size(), other.shape.outline.sides.size());
  for (std::size_t i = 0; i < one.shape.outline.sides.size(); ++i)
    EXPECT_EQ(one.shape.outline.sides[i].start, other.shape.outline.sides[i].start);
  EXPECT_EQ(one.area, other.area);
  EXPECT_EQ(one.notes, other.notes);
}

}  // namespace
}  // namespace kerf::carve_test
