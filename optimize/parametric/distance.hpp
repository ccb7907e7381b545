#pragma once
// Distances between boundaries that depend on variables, with their derivatives.

#include "kerf/shape.hpp"

#include <cmath>

namespace kerf {

/// A boundary at some values of variables: a disc, or a polyline with the derivatives of its points by the variables of
/// the one thing that draws it (none for fixed ones).
struct DesignCurve {
  bool disc = false, closed = false;
  Vec2 center = Vec2::Zero();
  double radius = 0;
  std::vector<Vec2> points;
  std::vector<Eigen::Matrix2Xd> by;  // per point, 2 x variables; empty: fixed
  Eigen::Matrix2Xd by_center;        // of a disc
  Eigen::VectorXd by_radius;
};
DesignCurve fixed_disc(const Vec2& center, double radius);
DesignCurve fixed_polyline(std::vector<Vec2> points, bool closed);

/// A distance and its derivatives by the variables of two things.
struct Distance {
  double value = infinity;
  Eigen::VectorXd by_a, by_b;
};

inline constexpr double sharpness = 40;  // of soft minima: their width is the distance asked for over this

/// Soft minimum of many distances: smooth and never larger than the least of them, -width log sum exp(-d_i/width).
class SoftMinimum {
 public:
  /// a, b: numbers of variables of the two things.
  SoftMinimum(double width, Eigen::Index a, Eigen::Index b);
  /// `gradient(by_a, by_b)` adds the derivatives of the value to two vectors; it is called where the value counts.
  template <typename Gradient>
  void add(double value, const Gradient& gradient) {
    if (value > least_ + 30 * width_) return;  // e^-30: lost in the sum
    entries_.push_back({value, zero_a_, zero_b_});
    gradient(entries_.back().by_a, entries_.back().by_b);
    least_ = std::min(least_, value);
  }
  Distance sum() const;

 private:
  double width_;
  Eigen::VectorXd zero_a_, zero_b_;
  double least_ = infinity;
  std::vector<Distance> entries_;
};

/// Adds the derivatives of direction . point by the variables, if it has any.
void add_derivative(const DesignCurve& c, std::size_t point, const Vec2& direction, Eigen::VectorXd& sum);

/// How two boundaries lie and how smooth their distance is.
struct Apart {
  bool container = false;           // the first is to stay inside the second
  double width = 0;                 // of the soft minimum
  Eigen::Index by_a = 0, by_b = 0;  // numbers of variables
};
/// Between discs exact, otherwise the soft minimum over points and pieces. Negative where they overlap.
Distance distance_between(const DesignCurve& a, const DesignCurve& b, const Apart& how);

bool inside_polygon(const std::vector<Vec2>& polygon, const Vec2& x);

/// The nearest point of a segment.
struct SegmentFoot {
  Vec2 normal;  // from the foot to the point, unit
  double part, distance;
};
SegmentFoot segment_foot(const Vec2& x, const Vec2& a, const Vec2& b);

}  // namespace kerf
