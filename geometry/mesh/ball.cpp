// Meshes of a ball with nested contours (circles or ellipses) or a slit, for perturbations of finite radius: see "One
// mesh" in docs/theory/validation.md. Rings of n vertices lie in geometric progression, staggered by half a step, so
// that triangles are nearly equilateral at every radius: with the step s = 2 pi/n the radius falls by exp(-s sqrt(3)/2)
// per ring. Inside the last contour every second ring has half as many vertices, down to a fan around the center. A
// slit is meshed in elliptic coordinates
//   x = c + l cosh(xi + i eta),
// which turn into polar ones towards the boundary: edges shorten towards its tips like the root of the distance.
// Contours are n-gons with the area of what they stand for, or follow it. Rings of ellipses that come out worse than 20
// degrees are given up, and the mesher fills between the contours.

#include "geometry/ball.hpp"

#include "kerf/mesher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace kerf {

namespace {

constexpr double equilateral = std::numbers::sqrt3 / 2;  // height over edge
constexpr double worst_angle = 20;                       // degrees, below which rings of ellipses are given up
constexpr double least_gap = 0.3;                        // between contours, in edges
constexpr std::size_t fan = 9;                           // triangles around the center, at most

void require(bool holds, const std::string& words) {
  if (!holds) throw std::invalid_argument(words);
}

void check_ball(const Ball& ball) {
  const auto& [center, radius, n] = ball;
  require(center.allFinite() && std::isfinite(radius) && radius > 0,
          fmt::format("a ball of radius {:g}; it must be positive", radius));
  require(n >= 12 && n % 4 == 0, fmt::format("a ball of {} edges; it needs a multiple of 4, at least 12", n));
}

double smooth_step(double t) {
  return t * t * (3 - 2 * t);
}

/// A closed polygon around the center: vertex i at the parameter (i + phase) / size of a turn.
struct Ring {
  std::vector<Index> vertex;
  double phase = 0;

  double turn(std::size_t i) const {
    return (double(i) + phase) / double(vertex.size());
  }
  Index operator[](std::size_t i) const {
    return vertex[i % vertex.size()];
  }
};

struct Triangles {
  std::vector<Vec2> points;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Index> shell;

  template <class Place>  // turn in [0, 1] -> point
  Ring ring(std::size_t count, double phase, const Place& place) {
    Ring ring{{}, phase};
    for (std::size_t i = 0; i < count; ++i) {
      ring.vertex.push_back(Index(points.size()));
      points.push_back(place((double(i) + phase) / double(count)));
    }
    return ring;
  }

  void add(Index a, Index b, Index c, Index number) {
    triangles.push_back({a, b, c});
    shell.push_back(number);
  }

  /// The triangles between two rings, each next one across the diagonal that turns less. The first vertices of the two
  /// lie less than an edge of the inner one apart.
  /// A greedy choice of the shorter diagonal, as both rings are nearly even.
  void zip(const Ring& outer, const Ring& inner, Index number) {
    const std::size_t m = outer.vertex.size(), k = inner.vertex.size();
    for (std::size_t i = 0, j = 0; i < m || j < k;) {
      const double on_outer = std::abs(outer.turn(i + 1) - inner.turn(j)),
                   on_inner = std::abs(outer.turn(i) - inner.turn(j + 1));
      if (j == k || (i < m && on_outer <= on_inner + 1e-9)) {
        add(outer[i], outer[i + 1], inner[j], number);
        ++i;
      } else {
        add(inner[j + 1], inner[j], outer[i], number);
        ++j;
      }
    }
  }
};

/// In degrees; of a turned or flat triangle none.
double least_angle(const Triangles& all) {
  double least = 60;
  for (const std::array<Index, 3>& t : all.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2& x = all.points[std::size_t(t[i])];
      const Vec2 a = all.points[std::size_t(t[(i + 1) % 3])] - x, b = all.points[std::size_t(t[(i + 2) % 3])] - x;
      least = std::min(least, std::atan2(cross(a, b), a.dot(b)) * 180 / pi);
    }
  return least;
}

double opposite(double phase) {
  return phase == 0 ? 0.5 : 0;
}

Index edge_between(const Mesh& mesh, Index a, Index b) {
  const std::array<Index, 2> edge{std::min(a, b), std::max(a, b)};
  return Index(std::lower_bound(mesh.edges.begin(), mesh.edges.end(), edge) - mesh.edges.begin());
}

/// Marked edges keep the order of the rings; areas are those of the polygons.
BallMesh finish(Triangles&& all, const std::vector<Ring>& contours, std::vector<Marked> marked) {
  const Ring& boundary = contours.front();
  for (std::size_t i = 0; i < boundary.vertex.size(); ++i) marked.push_back({boundary[i], boundary[i + 1], 0, none});
  BallMesh ball{connect(std::move(all.points), std::move(all.triangles), marked), {}, std::move(all.shell), {}};
  for (const Ring& ring : contours) {
    std::vector<Index>& edges = ball.contour.emplace_back();
    const Vec2 origin = ball.mesh.points[std::size_t(ring[0])];
    double twice = 0;
    for (std::size_t i = 0; i < ring.vertex.size(); ++i) {
      edges.push_back(edge_between(ball.mesh, ring[i], ring[i + 1]));
      twice +=
          cross(ball.mesh.points[std::size_t(ring[i])] - origin, ball.mesh.points[std::size_t(ring[i + 1])] - origin);
    }
    ball.enclosed_area.push_back(twice / 2);
  }
  return ball;
}

/// Semi-axes along and across the angle at which vertex 0 of a contour starts from the long axis: `lag` turns before.
struct Oval {
  double along, across, angle, lag;
};

/// What the contours look like: the ball's boundary first.
struct Ovals {
  Vec2 center;
  std::vector<Oval> contour;

  Vec2 place(const Oval& oval, double turn) const {
    const double t = 2 * pi * (turn - oval.lag), c = std::cos(oval.angle), s = std::sin(oval.angle);
    const Vec2 x(oval.along * std::cos(t), oval.across * std::sin(t));
    return center + Vec2(c * x.x() - s * x.y(), s * x.x() + c * x.y());
  }
};

/// Semi-axes in geometric progression; the turn of the first vertex goes over smoothly.
Oval between(const Oval& a, const Oval& b, double part) {
  return {a.along * std::pow(b.along / a.along, part), a.across * std::pow(b.across / a.across, part), b.angle,
          a.lag + smooth_step(part) * (b.lag - a.lag)};
}

/// The contours inside the ball are what they stand for.
void follow(const Ovals& ovals, const std::vector<Ring>& contours, BallMesh& ball) {
  ball.mesh.arc.assign(ball.mesh.edges.size(), none);
  for (std::size_t k = 1; k < contours.size(); ++k) {
    const Oval& oval = ovals.contour[k];
    const double c = std::cos(oval.angle), s = std::sin(oval.angle), step = 2 * pi / double(contours[k].vertex.size());
    Mat2 axes;
    axes << c * oval.along, -s * oval.across, s * oval.along, c * oval.across;
    for (std::size_t i = 0; i < contours[k].vertex.size(); ++i) {
      const Index e = ball.contour[k][i];
      const double t = 2 * pi * (contours[k].turn(i) - oval.lag);
      const bool forward = ball.mesh.edges[std::size_t(e)][0] == contours[k][i];
      ball.mesh.arc[std::size_t(e)] = Index(ball.mesh.arcs.size());
      ball.mesh.arcs.push_back({ovals.center, axes, forward ? t : t + step, forward ? t + step : t});
    }
    ball.enclosed_area[k] = pi * oval.along * oval.across;
  }
}

/// Rings of `n` vertices from contour to contour, of ever fewer from the last one to the center; nothing when ellipses
/// are too long for them.
std::optional<BallMesh> rings(const Ovals& ovals, const std::vector<Vec2>& boundary, bool curved) {
  const std::size_t n = boundary.size();
  const double step = 2 * pi / double(n);
  const bool round = ovals.contour.back().along == ovals.contour.back().across;
  Triangles all{boundary, {}, {}};
  Ring last;
  for (std::size_t i = 0; i < n; ++i) last.vertex.push_back(Index(i));
  std::vector<Ring> contours{last};
  for (std::size_t k = 0; k + 1 < ovals.contour.size(); ++k) {
    const Oval &outer = ovals.contour[k], &inner = ovals.contour[k + 1];
    const double ratio = outer.along * outer.across / (inner.along * inner.across);
    int count = std::max(1, int(std::lround(std::log(ratio) / 2 / (equilateral * step))));
    if (!round) count = 2 * ((count + 1) / 2);  // every contour has a vertex on its long axis
    for (int i = 1; i <= count; ++i) {
      const Oval oval = i == count ? inner : between(outer, inner, double(i) / count);
      Ring next = all.ring(n, opposite(last.phase), [&](double turn) { return ovals.place(oval, turn); });
      all.zip(last, next, Index(k));
      last = std::move(next);
    }
    contours.push_back(last);
  }
  const Index core = Index(ovals.contour.size()) - 1;
  double scale = 1;  // of the last contour
  const auto inward = [&](std::size_t count, double phase, double height) {
    scale *= std::exp(-height * 2 * pi / double(last.vertex.size()));
    const Oval& oval = ovals.contour.back();
    Ring next = all.ring(count, phase, [&](double turn) {
      return ovals.place({scale * oval.along, scale * oval.across, oval.angle, oval.lag}, turn);
    });
    all.zip(last, next, core);
    last = std::move(next);
  };
  while (last.vertex.size() > fan) {
    inward(last.vertex.size(), last.phase >= 0.5 ? last.phase - 0.5 : last.phase + 0.5, equilateral);
    inward((last.vertex.size() + 1) / 2, last.phase / 2, 1);
  }
  const Index middle = Index(all.points.size());
  all.points.push_back(ovals.center);
  for (std::size_t i = 0; i < last.vertex.size(); ++i) all.add(middle, last[i], last[i + 1], core);
  if (!round && least_angle(all) < worst_angle) return {};
  BallMesh ball = finish(std::move(all), contours, {});
  if (curved) follow(ovals, contours, ball);
  return ball;
}

/// The same contours with what lies between them left to the mesher.
BallMesh shells(const Ovals& ovals, const std::vector<Vec2>& boundary) {
  const std::size_t n = boundary.size();
  std::vector<std::vector<Vec2>> polygons{boundary};
  for (std::size_t k = 1; k < ovals.contour.size(); ++k) {
    std::vector<Vec2>& points = polygons.emplace_back();
    for (std::size_t i = 0; i < n; ++i) points.push_back(ovals.place(ovals.contour[k], double(i) / double(n)));
  }
  Triangles all;
  std::map<std::pair<double, double>, Index> number;
  std::vector<Ring> contours;
  for (const std::vector<Vec2>& points : polygons) {
    Ring& ring = contours.emplace_back();
    for (const Vec2& x : points) {
      ring.vertex.push_back(Index(all.points.size()));
      number[{x.x(), x.y()}] = Index(all.points.size());
      all.points.push_back(x);
    }
  }
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    Shape shape{polygon("contour", polygons[k], 0), {}, {}, {"contour"}, {}};
    if (k + 1 < polygons.size()) shape.holes.push_back(polygon("next contour", polygons[k + 1], 0));
    for (Side& side : shape.outline.sides) side.keep = true;
    for (Loop& hole : shape.holes)
      for (Side& side : hole.sides) side.keep = true;
    double longest = 0;
    for (std::size_t i = 0; i < n; ++i) longest = std::max(longest, (polygons[k][(i + 1) % n] - polygons[k][i]).norm());
    const Mesh mesh = triangulate(shape, {.size = longest});
    std::vector<Index> renumbered;
    for (const Vec2& x : mesh.points) {
      const auto known = number.find({x.x(), x.y()});
      renumbered.push_back(known != number.end() ? known->second : Index(all.points.size()));
      if (known == number.end()) all.points.push_back(x);
    }
    for (const auto& [a, b, c] : mesh.triangles)
      all.add(renumbered[std::size_t(a)], renumbered[std::size_t(b)], renumbered[std::size_t(c)], Index(k));
  }
  return finish(std::move(all), contours, {});
}

}  // namespace

std::vector<Vec2> ball_boundary(const Ball& ball) {
  check_ball(ball);
  const auto& [center, radius, n] = ball;
  std::vector<Vec2> points;
  for (int i = 0; i < n; ++i)
    points.push_back(center + radius * Vec2(std::cos(2 * pi * i / n), std::sin(2 * pi * i / n)));
  return points;
}

Loop ball_hole(std::string name, const Ball& ball, Index label) {
  Loop loop = polygon(std::move(name), ball_boundary(ball), label);
  for (Side& side : loop.sides) side.keep = true;
  return loop;
}

/// `along`: the factor step/sin(step) gives the n-gon the area of its ellipse. `lag` turns the contour by whole
/// vertices, so that one lies on the long axis and rings need not twist by more than half a step.
BallMesh ball_mesh(const Ball& ball, const std::vector<double>& radii, double aspect, double angle, bool curved) {
  check_ball(ball);
  require(std::isfinite(aspect) && aspect >= 1 && std::isfinite(angle),
          fmt::format("ellipses of aspect {:g}; it must be at least 1", aspect));
  const int n = ball.n;
  const double step = 2 * pi / n;
  if (aspect == 1) angle = 0;
  const double along = std::sqrt(aspect * (curved ? 1 : step / std::sin(step))), lag = std::round(angle / step) / n;
  Ovals ovals{ball.center, {{ball.radius, ball.radius, angle, angle / (2 * pi)}}};
  double outer = ball.radius;
  for (std::size_t k = 0; k < radii.size(); ++k) {
    require(std::isfinite(radii[k]) && radii[k] > 0, fmt::format("a contour of radius {:g}", radii[k]));
    const double reach = k == 0 ? radii[k] * along : radii[k];
    require(std::log(outer / reach) > least_gap * step,
            fmt::format("a contour reaches {:g} inside one of {:g} with {} edges: they would touch; take smaller radii",
                        reach, outer, n));
    ovals.contour.push_back({radii[k] * along, radii[k] * along / aspect, angle, lag});
    outer = radii[k];
  }
  const std::vector<Vec2> boundary = ball_boundary(ball);
  std::optional<BallMesh> mesh = rings(ovals, boundary, curved);
  if (mesh) return std::move(*mesh);
  return curved ? ball_mesh(ball, radii, aspect, angle) : shells(ovals, boundary);
}

/// x = a + b, y = a - b with a = l/2 e^xi and b = l/2 e^-xi are the semi-axes of the ellipse at xi; b fades by 1 -
/// way^4, so that the last ring is a circle. At xi = 0 both sides fall on the slit, whose inner vertices the two sides
/// share.
BallMesh slit_mesh(const Ball& ball, double half_length, double angle) {
  check_ball(ball);
  const auto& [center, radius, n] = ball;
  require(half_length > 0 && half_length <= 0.8 * radius && std::isfinite(angle),
          fmt::format("a slit of half length {:g} in a ball of radius {:g}; it may reach 0.8 of that", half_length,
                      radius));
  const double step = 2 * pi / n, end = std::log(2 * radius / half_length);
  const int count = std::max(2, int(std::lround(end / (equilateral * step))));
  const std::size_t size = std::size_t(n), half = size / 2;
  const Vec2 along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());

  // The last ring takes the vertices of the boundary: vertex i is point i + shift, after a turn of at most half a step.
  const double last_phase = count % 2 == 0 ? 0 : 0.5;
  const double shift = std::round(last_phase + angle / step), twist = (shift - last_phase) / n - angle / (2 * pi);
  Triangles all{ball_boundary(ball), {}, {}};
  Ring boundary, outer{{}, last_phase};
  for (std::size_t i = 0; i < size; ++i) {
    boundary.vertex.push_back(Index(i));
    const std::int64_t turned = (std::int64_t(i) + std::int64_t(shift)) % n;
    outer.vertex.push_back(Index((turned + n) % n));
  }
  for (int k = count - 1; k > 0; --k) {
    const double way = double(k) / count, xi = end * way, part = smooth_step(way);
    const double a = half_length / 2 * std::exp(xi), b = half_length / 2 * std::exp(-xi) * (1 - std::pow(way, 4));
    Ring inner = all.ring(size, opposite(outer.phase), [&](double turn) {
      const double eta = 2 * pi * (turn + twist * part);
      return Vec2(center + (a + b) * std::cos(eta) * along + (a - b) * std::sin(eta) * across);
    });
    all.zip(outer, inner, 0);
    outer = std::move(inner);
  }
  // The slit from eta = 0 to pi and back.
  Ring slit;
  const Index first = Index(all.points.size());
  for (std::size_t i = 0; i < size; ++i) slit.vertex.push_back(first + Index(std::min(i, size - i)));
  for (std::size_t i = 0; i <= half; ++i) {
    const double x = 2 * i == half ? 0 : std::cos(step * double(i));
    all.points.push_back(center + half_length * x * along);
  }
  all.zip(outer, slit, 0);
  std::vector<Marked> marked;
  for (std::size_t i = half; i > 0; --i) marked.push_back({slit[i], slit[i - 1], none, 0});
  return finish(std::move(all), {boundary}, std::move(marked));
}

}  // namespace kerf
