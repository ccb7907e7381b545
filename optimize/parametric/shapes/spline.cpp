// A hole inside a closed uniform cubic B-spline: x, y of its control points, counter-clockwise. It is drawn as a
// polygon with 4, 8, ... pieces per span until corners turn by at most 6 degrees, well below what counts as a corner of
// the body, and sides are no longer than the mesh size. A vertex keeps its piece and share of it, so that it moves
// linearly with the control points of both ends of the piece. The area 1/2 int x cross x' ds is exact with three Gauss
// points per span. Three constraints keep the shape: its area at least that of a disc of the least distance (which also
// fixes the sense), its thickness, its turns.

#include "optimize/parametric/shapes/spline.hpp"

#include "geometry/plane.hpp"
#include "optimize/parametric/shapes/shape.hpp"

#include <fmt/core.h>

#include <cmath>

namespace kerf {

// The cubic B-spline basis of four control points, t the share of the span.
SplineWeights spline_weights(Index n, double s) {
  const double floor = std::floor(s), t = s - floor;
  SplineWeights w{static_cast<Index>(floor) % n, {}, {}};
  w.position << (1 - t) * (1 - t) * (1 - t), 3 * t * t * t - 6 * t * t + 4, -3 * t * t * t + 3 * t * t + 3 * t + 1,
      t * t * t;
  w.position /= 6;
  w.derivative << -(1 - t) * (1 - t), 3 * t * t - 4 * t, -3 * t * t + 2 * t + 1, t * t;
  w.derivative /= 2;
  return w;
}

namespace {

using Eigen::Matrix2Xd;
using Eigen::VectorXd;

Vec2 vertex_of_spline(const VectorXd& v, Index i) {
  return v.segment<2>(2 * i);
}

Vec2 spline_point(const VectorXd& v, double s) {
  const auto n = static_cast<Index>(v.size() / 2);
  const SplineWeights w = spline_weights(n, s);
  Vec2 x = Vec2::Zero();
  for (Index i = 0; i < 4; ++i) x += w.position[i] * vertex_of_spline(v, (w.first + i) % n);
  return x;
}

/// Pieces of the polygon of a spline: each corner turns by 6 degrees at most, well below what counts as one.
Index spline_pieces(const VectorXd& v, double size) {
  const auto n = static_cast<Index>(v.size() / 2);
  constexpr double most_turn = 6 * pi / 180;
  static_assert(most_turn < reentrant_angle - pi);
  constexpr Index most = 64;  // per span
  for (Index per_span = 4;; per_span *= 2) {
    double turn = 0, longest = 0;
    const Index count = n * per_span;
    Vec2 before = spline_point(v, 0) - spline_point(v, static_cast<double>(count - 1) / per_span);
    for (Index i = 0; i < count; ++i) {
      const Vec2 side = spline_point(v, static_cast<double>((i + 1) % count) / per_span) -
                        spline_point(v, static_cast<double>(i) / per_span);
      turn = std::max(turn, std::abs(std::atan2(cross(before, side), before.dot(side))));
      longest = std::max(longest, side.norm());
      before = side;
    }
    if ((turn <= most_turn && longest <= size) || per_span == most) return count;
  }
}

std::vector<Vec2> spline_polygon(const VectorXd& v, Index pieces) {
  const double per_span = static_cast<double>(pieces) / (static_cast<double>(v.size()) / 2);
  std::vector<Vec2> points;
  for (Index i = 0; i < pieces; ++i) points.push_back(spline_point(v, i / per_span));
  return points;
}

bool spline_fits(Eigen::Index count) {
  return count >= 8 && count % 2 == 0;
}

void check_spline(const Drawn&, const Problem&) {}

void draw_spline(const Drawn& d, const VectorXd& v, const Problem& p, DrawnBody& body) {
  body.shape.holes.push_back(
      polygon(d.name, spline_polygon(v, spline_pieces(v, mesh_size(p))), hole_label(body.shape, d.name)));
}

std::function<Spot(const Vec2& x)> locate_on_spline(const VectorXd& v, double size) {
  return [points = spline_polygon(v, spline_pieces(v, size))](const Vec2& x) { return place_on(points, true, x); };
}

// On the chord between two points of the spline.
Vec2 position_on_spline(const Spot& spot, const VectorXd& v) {
  const double per_span = static_cast<double>(spot.pieces) / (static_cast<double>(v.size()) / 2);
  const Vec2 a = spline_point(v, spot.piece / per_span), b = spline_point(v, (spot.piece + 1) % spot.pieces / per_span);
  return a + spot.part * (b - a);
}

// To both ends of the chord by their shares, and from there to four control points each.
void pull_spline(const Spot& spot, const VectorXd& v, const Vec2& force, Eigen::Ref<VectorXd> sum) {
  const auto n = static_cast<Index>(v.size() / 2);
  const double per_span = static_cast<double>(spot.pieces) / n;
  for (int end = 0; end < 2; ++end) {
    const SplineWeights w = spline_weights(n, (spot.piece + end) % spot.pieces / per_span);
    for (Index i = 0; i < 4; ++i)
      sum.segment<2>(2 * ((w.first + i) % n)) += (end == 0 ? 1 - spot.part : spot.part) * w.position[i] * force;
  }
}

void add_area_of_spline(const VectorXd& v, double& area, VectorXd* gradient) {
  // 1/2 int x cross x' ds: of degree 5 on each span, so that three Gauss points are exact.
  const auto n = static_cast<Index>(v.size() / 2);
  const double away = std::sqrt(0.15);
  for (Index span = 0; span < n; ++span)
    for (int q = -1; q <= 1; ++q) {
      const SplineWeights w = spline_weights(n, span + 0.5 + q * away);
      Vec2 at = Vec2::Zero(), along = Vec2::Zero();
      for (Index i = 0; i < 4; ++i) {
        at += w.position[i] * vertex_of_spline(v, (w.first + i) % n);
        along += w.derivative[i] * vertex_of_spline(v, (w.first + i) % n);
      }
      const double half = (q == 0 ? 4.0 / 9 : 5.0 / 18) / 2;
      area += half * cross(at, along);
      if (!gradient) continue;
      for (Index i = 0; i < 4; ++i)
        gradient->segment<2>(2 * ((w.first + i) % n)) +=
            half * (w.position[i] * Vec2(along.y(), -along.x()) + w.derivative[i] * Vec2(-at.y(), at.x()));
    }
}

// Points on the curve itself, not on the polygon drawn: their number must not depend on the variables.
DesignCurve spline_boundary(const Drawn&, const VectorXd& v, bool) {
  DesignCurve c = fixed_polyline({}, true);
  const Eigen::Index n = v.size();
  const auto points = static_cast<Index>(n / 2);
  const Index per_span = std::max<Index>(4, (samples + points - 1) / points);
  for (Index i = 0; i < points * per_span; ++i) {
    const SplineWeights w = spline_weights(points, static_cast<double>(i) / per_span);
    Vec2 x = Vec2::Zero();
    Matrix2Xd by = Matrix2Xd::Zero(2, n);
    for (Index k = 0; k < 4; ++k) {
      const Index at = 2 * ((w.first + k) % points);
      x += w.position[k] * v.segment<2>(at);
      by(0, at) += w.position[k];
      by(1, at + 1) += w.position[k];
    }
    c.points.push_back(x);
    c.by.push_back(std::move(by));
  }
  return c;
}

/// Not smaller than a disc, and counter-clockwise.
Constraint large_enough(const Drawn& d, Eigen::Index first, double least) {
  const double smallest = pi / 4 * least * least;
  return own_constraint(name(d) + " is smaller than a disc of the least distance, or its points run clockwise", first,
                        d.lower.size(), [=](const VectorXd& v, VectorXd& by) {
                          double area = 0;
                          add_area_of_spline(v, area, &by);
                          by /= -smallest;
                          // Far from its bound the value does not matter.
                          return std::max(1 - area / smallest, -1e3);
                        });
}

// Between points a quarter of the curve apart or more: nearer ones are neighbors.
Constraint thick_enough(const Drawn& d, Eigen::Index first, double least) {
  const Eigen::Index n = d.lower.size();
  return own_constraint(
      fmt::format("{} is thinner than {:.4g}", name(d), least), first, n, [=](const VectorXd& v, VectorXd& by) {
        const DesignCurve c = spline_boundary(d, v, false);
        const auto count = static_cast<Index>(c.points.size());
        SoftMinimum soft(least / sharpness, n, 0);
        for (Index i = 0; i < count; ++i)
          // Each pair once, without neighbors along the curve on either side.
          for (Index k = i + count / 4; k < count && k <= i + count - count / 4; ++k) {
            const Vec2 away = c.points[static_cast<std::size_t>(i)] - c.points[static_cast<std::size_t>(k)];
            const double size = away.norm();
            soft.add(size, [&](VectorXd& g, VectorXd&) {
              if (!(size > 0)) return;
              add_derivative(c, static_cast<std::size_t>(i), away / size, g);
              add_derivative(c, static_cast<std::size_t>(k), -away / size, g);
            });
          }
        const Distance r = soft.sum();
        by = -r.by_a / least;
        return 1 - r.value / least;
      });
}

/// Neither loops nor cusps.
/// Tangents half a span apart: a turn of more than 120 degrees there is a loop or a cusp.
Constraint smooth_enough(const Drawn& d, Eigen::Index first) {
  const Eigen::Index n = d.lower.size();
  return own_constraint(name(d) + " turns too sharply", first, n, [=](const VectorXd& v, VectorXd& by) {
    const auto points = static_cast<Index>(n / 2);
    SoftMinimum soft(1 / sharpness, n, 0);
    constexpr Index per_span = 4;
    const auto along = [&](Index i) {
      const SplineWeights w = spline_weights(points, static_cast<double>(i % (points * per_span)) / per_span);
      Vec2 t = Vec2::Zero();
      for (Index k = 0; k < 4; ++k) t += w.derivative[k] * v.segment<2>(2 * ((w.first + k) % points));
      return std::pair(w, t);
    };
    for (Index i = 0; i < points * per_span; ++i) {
      const auto [wa, a] = along(i);
      const auto [wb, b] = along(i + per_span / 2);
      Vec2 by_a, by_b;
      const double c = cosine(a, b, by_a, by_b);
      soft.add(c, [&, wa = wa, wb = wb](VectorXd& g, VectorXd&) {
        for (Index k = 0; k < 4; ++k) {
          g.segment<2>(2 * ((wa.first + k) % points)) += wa.derivative[k] * by_a;
          g.segment<2>(2 * ((wb.first + k) % points)) += wb.derivative[k] * by_b;
        }
      });
    }
    const Distance r = soft.sum();
    by = -r.by_a;
    return fold - r.value;
  });
}

void constrain_spline(const Drawn& d, Eigen::Index first, double least, std::vector<Constraint>& all) {
  all.push_back(large_enough(d, first, least));
  all.push_back(thick_enough(d, first, least));
  all.push_back(smooth_enough(d, first));
}

// The mean of the control points is that of the curve over its parameter.
Vec2 middle(const VectorXd& xy) {
  Vec2 sum = Vec2::Zero();
  for (Eigen::Index i = 0; i + 1 < xy.size(); i += 2) sum += xy.segment<2>(i);
  return 2 * sum / static_cast<double>(xy.size());
}
double mean_radius(const VectorXd& xy) {
  const Vec2 center = middle(xy);
  double sum = 0;
  for (Eigen::Index i = 0; i + 1 < xy.size(); i += 2) sum += (xy.segment<2>(i) - center).norm();
  return 2 * sum / static_cast<double>(xy.size());
}

// Sizes between a quarter and four times that of the start, since boxes of control points say nothing of it.
Sought seek_spline(const Drawn& d, const Problem&) {
  constexpr double range = 4;
  Sought s{.low = middle(d.lower),
           .high = middle(d.upper),
           .least = mean_radius(d.start) / range,
           .most = mean_radius(d.start) * range};
  s.size = std::sqrt(s.least * s.most);
  return s;
}

// The start's shape, moved and scaled.
VectorXd guessed_spline(const Guess& g, const Drawn& d) {
  VectorXd v = d.start;
  const Vec2 center = middle(v);
  const double factor = g.size / mean_radius(v);
  for (Eigen::Index i = 0; i < v.size(); i += 2) v.segment<2>(i) = g.at + factor * (v.segment<2>(i) - center);
  return v;
}

}  // namespace

constinit const DrawnShape spline_shape{.kind = Drawn::Kind::Spline,
                                        .part = BodyPart::Hole,
                                        .names = coordinate_names,
                                        .fits = spline_fits,
                                        .asks = "a spline needs four control points or more, x and y each",
                                        .check = check_spline,
                                        .draw = draw_spline,
                                        .locate = locate_on_spline,
                                        .position = position_on_spline,
                                        .pull = pull_spline,
                                        .add_area = add_area_of_spline,
                                        .boundary = spline_boundary,
                                        .box = box_of_points,
                                        .constrain = constrain_spline,
                                        .seek = seek_spline,
                                        .guessed = guessed_spline,
                                        .guess_in_words = radius_in_words};

}  // namespace kerf
