// Distances between boundaries that depend on variables, and their derivatives by these: disc to disc exactly, all
// others as the soft minimum over points and pieces of polylines [theory: L.9],
//   -w ln sum_i exp(-d_i/w),   never above the least d_i, smooth, with the weights exp(-d_i/w)/sum for the derivatives.
// The derivative of the distance of a point to a piece is the unit vector n from its foot: n by the point, -(1 - t) n
// and -t n by the ends of the piece, t the share of the foot. What lies inside a closed curve has a negative distance,
// the shortest way out; with `container` what lies outside has. docs/theory/level_set.md, section "Drawn designs".

#include "optimize/parametric/distance.hpp"

#include "geometry/plane.hpp"

#include <algorithm>

namespace kerf {

namespace {

using Eigen::Matrix2Xd;
using Eigen::VectorXd;

Index pieces_of(const DesignCurve& c) {
  return static_cast<Index>(c.points.size()) - (c.closed ? 0 : 1);
}

/// Signed distances of the point x to all pieces of the polyline c; `sign` of what lies inside a closed one.
/// A soft minimum of negative distances would be the longest way out: inside only the nearest piece counts.
template <class Add>
void to_pieces(const Vec2& x, const DesignCurve& c, bool container, const Add& add) {
  const bool in = c.closed && inside_polygon(c.points, x);
  const double sign = c.closed && in != container ? -1 : 1;
  if (sign < 0) {  // the way out is the shortest one
    Index best = 0;
    double least = infinity;
    for (Index i = 0; i < pieces_of(c); ++i) {
      const SegmentFoot f = segment_foot(x, c.points[static_cast<std::size_t>(i)],
                                         c.points[static_cast<std::size_t>(i + 1) % c.points.size()]);
      if (f.distance < least) {
        least = f.distance;
        best = i;
      }
    }
    const SegmentFoot f = segment_foot(x, c.points[static_cast<std::size_t>(best)],
                                       c.points[static_cast<std::size_t>(best + 1) % c.points.size()]);
    add(best, f, sign);
    return;
  }
  for (Index i = 0; i < pieces_of(c); ++i) {
    add(i,
        segment_foot(x, c.points[static_cast<std::size_t>(i)],
                     c.points[static_cast<std::size_t>(i + 1) % c.points.size()]),
        sign);
  }
}

/// Distances of the points of a to the pieces of b into `soft`, first and second argument swapped where asked.
/// With d = |x - foot|: the foot is the share t of the way along its piece, so that its ends take 1 - t and t of -n.
void points_to_pieces(const DesignCurve& a, const DesignCurve& b, bool container, bool swapped, SoftMinimum& soft) {
  for (std::size_t k = 0; k < a.points.size(); ++k)
    to_pieces(a.points[k], b, container, [&](Index i, const SegmentFoot& f, double sign) {
      const auto first = static_cast<std::size_t>(i), second = (first + 1) % b.points.size();
      soft.add(sign * f.distance, [&](VectorXd& by_a, VectorXd& by_b) {
        if (swapped) std::swap(by_a, by_b);
        add_derivative(a, k, sign * f.normal, by_a);
        add_derivative(b, first, -sign * (1 - f.part) * f.normal, by_b);
        add_derivative(b, second, -sign * f.part * f.normal, by_b);
        if (swapped) std::swap(by_a, by_b);
      });
    });
}

// Without columns the center is fixed.
VectorXd product(const Matrix2Xd& by, const Vec2& direction, Eigen::Index size) {
  return by.cols() == 0 ? VectorXd(VectorXd::Zero(size)) : VectorXd(by.transpose() * direction);
}

// a - b| - r_a - r_b, or r_b - |a - b| - r_a inside of b.
Distance disc_to_disc(const DesignCurve& a, const DesignCurve& b, const Apart& how) {
  const Vec2 away = a.center - b.center;
  // Concentric discs have no direction: any one serves.
  const double d = away.norm(), sign = how.container ? -1 : 1;
  const Vec2 n = d > 0 ? Vec2(away / d) : Vec2::UnitX();
  Distance r{sign * (d - b.radius) - a.radius, product(a.by_center, sign * n, how.by_a),
             product(b.by_center, -sign * n, how.by_b)};
  if (a.by_radius.size() > 0) r.by_a -= a.by_radius;
  if (b.by_radius.size() > 0) r.by_b -= sign * b.by_radius;
  return r;
}

}  // namespace

DesignCurve fixed_disc(const Vec2& center, double radius) {
  return {.disc = true, .closed = true, .center = center, .radius = radius};
}

DesignCurve fixed_polyline(std::vector<Vec2> points, bool closed) {
  DesignCurve c;
  c.points = std::move(points);
  c.closed = closed;
  return c;
}

SoftMinimum::SoftMinimum(double width, Eigen::Index a, Eigen::Index b)
    : width_(width), zero_a_(VectorXd::Zero(a)), zero_b_(VectorXd::Zero(b)) {}

Distance SoftMinimum::sum() const {
  Distance d{infinity, zero_a_, zero_b_};
  if (entries_.empty()) return d;
  double total = 0;
  for (const Distance& e : entries_) {
    // Relative to the least, so that nothing underflows.
    const double w = std::exp(-(e.value - least_) / width_);
    total += w;
    d.by_a += w * e.by_a;
    d.by_b += w * e.by_b;
  }
  d.by_a /= total;
  d.by_b /= total;
  d.value = least_ - width_ * std::log(total);
  return d;
}

void add_derivative(const DesignCurve& c, std::size_t point, const Vec2& direction, VectorXd& sum) {
  if (!c.by.empty()) sum += c.by[point].transpose() * direction;
}

Distance distance_between(const DesignCurve& a, const DesignCurve& b, const Apart& how) {
  const Eigen::Index na = how.by_a, nb = how.by_b;
  const bool container = how.container;
  if (a.disc && b.disc) return disc_to_disc(a, b, how);
  // The center of a disc against pieces of a polyline, less the radius.
  SoftMinimum soft(how.width, na, nb);
  if (a.disc) {
    to_pieces(a.center, b, container, [&](Index i, const SegmentFoot& f, double sign) {
      const auto first = static_cast<std::size_t>(i), second = (first + 1) % b.points.size();
      soft.add(sign * f.distance - a.radius, [&](VectorXd& by_a, VectorXd& by_b) {
        by_a = product(a.by_center, sign * f.normal, na);
        if (a.by_radius.size() > 0) by_a -= a.by_radius;
        add_derivative(b, first, -sign * (1 - f.part) * f.normal, by_b);
        add_derivative(b, second, -sign * f.part * f.normal, by_b);
      });
    });
    return soft.sum();
  }
  if (b.disc) {
    // Outside of each other the distance is the same both ways.
    if (!container) {
      Distance r = distance_between(b, a, {.width = how.width, .by_a = nb, .by_b = na});
      std::swap(r.by_a, r.by_b);
      return r;
    }
    for (std::size_t k = 0; k < a.points.size(); ++k) {
      const Vec2 away = a.points[k] - b.center;
      const double d = away.norm();
      const Vec2 n = d > 0 ? Vec2(away / d) : Vec2::UnitX();
      soft.add(b.radius - d, [&](VectorXd& by_a, VectorXd& by_b) {
        add_derivative(a, k, -n, by_a);
        by_b = product(b.by_center, n, nb);
        if (b.by_radius.size() > 0) by_b += b.by_radius;
      });
    }
    return soft.sum();
  }
  points_to_pieces(a, b, container, false, soft);
  // Both ways: a corner of b may be nearest to the middle of a piece of a.
  if (!container) points_to_pieces(b, a, false, true, soft);
  return soft.sum();
}

// A ray from x crosses the polygon an odd number of times.
bool inside_polygon(const std::vector<Vec2>& polygon, const Vec2& x) {
  bool in = false;
  for (std::size_t i = 0, k = polygon.size() - 1; i < polygon.size(); k = i++)
    if (crosses_ray(x, polygon[i], polygon[k])) in = !in;
  return in;
}

SegmentFoot segment_foot(const Vec2& x, const Vec2& a, const Vec2& b) {
  const double square = (b - a).squaredNorm();
  const double part = foot(x, a, b);
  const Vec2 away = x - a - part * (b - a);
  const double d = away.norm();
  // On the line itself: its normal, so that there is a way out.
  const Vec2 across = square > 0 ? Vec2(Vec2(a.y() - b.y(), b.x() - a.x()) / std::sqrt(square)) : Vec2::UnitX();
  return {d > 0 ? Vec2(away / d) : across, part, d};
}

}  // namespace kerf
