#include "optimize/parametric/constraints.hpp"

#include "geometry/plane.hpp"
#include "kerf/optimize.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

namespace kerf {

namespace {

using Eigen::Matrix2Xd;
using Eigen::VectorXd;
using Kind = Drawn::Kind;

constexpr double sharpness = 40;  // of soft minima

/// A boundary at some x: a disc, or a polyline with the derivatives of its points by the variables of the one thing
/// that draws it (none for fixed ones).
struct Curve {
  bool disc = false, closed = false;
  Vec2 center = Vec2::Zero();
  double radius = 0;
  std::vector<Vec2> points;
  std::vector<Matrix2Xd> by;  // per point; empty: fixed
  Matrix2Xd by_center;        // of a disc
  VectorXd by_radius;
};

/// Something that has a boundary; `drawn`: number of what draws it, or none.
struct Thing {
  std::string name;
  Index drawn = none;
  std::function<Curve(const VectorXd& v)> curve;
  std::function<Curve(const VectorXd& v)> cut = {};  // of a crack, what counts against fixed things
  bool container = false;                            // what is drawn stays inside
  Vec2 low, high;                                    // a box that holds it for all variables
};

/// A distance and its derivatives by the variables of two things.
struct Distance {
  double value = infinity;
  VectorXd by_a, by_b;
};

/// Soft minimum of many distances.
class Soft {
 public:
  Soft(double width, Eigen::Index a, Eigen::Index b)
      : width_(width), zero_a_(VectorXd::Zero(a)), zero_b_(VectorXd::Zero(b)) {}
  void add(double value, const std::function<void(VectorXd& a, VectorXd& b)>& gradient) {
    if (value > least_ + 30 * width_) return;  // e^-30: lost in the sum
    entries_.push_back({value, zero_a_, zero_b_});
    gradient(entries_.back().by_a, entries_.back().by_b);
    least_ = std::min(least_, value);
  }
  Distance sum() const {
    Distance d{infinity, zero_a_, zero_b_};
    if (entries_.empty()) return d;
    double total = 0;
    for (const Distance& e : entries_) {
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

 private:
  double width_;
  VectorXd zero_a_, zero_b_;
  double least_ = infinity;
  std::vector<Distance> entries_;
};

bool inside(const std::vector<Vec2>& polygon, const Vec2& x) {
  bool in = false;
  for (std::size_t i = 0, k = polygon.size() - 1; i < polygon.size(); k = i++)
    if (crosses_ray(x, polygon[i], polygon[k])) in = !in;
  return in;
}

struct Foot {
  Vec2 normal;  // from the foot to the point, unit
  double part, distance;
};
Foot foot_on(const Vec2& x, const Vec2& a, const Vec2& b) {
  const double square = (b - a).squaredNorm();
  const double part = foot(x, a, b);
  const Vec2 away = x - a - part * (b - a);
  const double d = away.norm();
  // On the line itself: its normal, so that there is a way out.
  const Vec2 across = square > 0 ? Vec2(Vec2(a.y() - b.y(), b.x() - a.x()) / std::sqrt(square)) : Vec2::UnitX();
  return {d > 0 ? Vec2(away / d) : across, part, d};
}

Index pieces_of(const Curve& c) {
  return static_cast<Index>(c.points.size()) - (c.closed ? 0 : 1);
}

/// Signed distances of the point x to all pieces of the polyline c; `sign` of what lies inside a closed one.
template <class Add>
void to_pieces(const Vec2& x, const Curve& c, bool container, const Add& add) {
  const bool in = c.closed && inside(c.points, x);
  const double sign = c.closed && in != container ? -1 : 1;
  if (sign < 0) {  // the way out is the shortest one
    Index best = 0;
    double least = infinity;
    for (Index i = 0; i < pieces_of(c); ++i) {
      const Foot f = foot_on(x, c.points[static_cast<std::size_t>(i)],
                             c.points[static_cast<std::size_t>(i + 1) % c.points.size()]);
      if (f.distance < least) {
        least = f.distance;
        best = i;
      }
    }
    const Foot f = foot_on(x, c.points[static_cast<std::size_t>(best)],
                           c.points[static_cast<std::size_t>(best + 1) % c.points.size()]);
    add(best, f, sign);
    return;
  }
  for (Index i = 0; i < pieces_of(c); ++i) {
    add(i,
        foot_on(x, c.points[static_cast<std::size_t>(i)], c.points[static_cast<std::size_t>(i + 1) % c.points.size()]),
        sign);
  }
}

void add_by(VectorXd& sum, const std::vector<Matrix2Xd>& by, std::size_t point, const Vec2& direction) {
  if (!by.empty()) sum += by[point].transpose() * direction;
}

/// Distances of the points of a to the pieces of b into `soft`, first and second argument swapped where asked.
void points_to_pieces(const Curve& a, const Curve& b, bool container, bool swapped, Soft& soft) {
  for (std::size_t k = 0; k < a.points.size(); ++k)
    to_pieces(a.points[k], b, container, [&](Index i, const Foot& f, double sign) {
      const auto first = static_cast<std::size_t>(i), second = (first + 1) % b.points.size();
      soft.add(sign * f.distance, [&](VectorXd& by_a, VectorXd& by_b) {
        if (swapped) std::swap(by_a, by_b);
        add_by(by_a, a.by, k, sign * f.normal);
        add_by(by_b, b.by, first, -sign * (1 - f.part) * f.normal);
        add_by(by_b, b.by, second, -sign * f.part * f.normal);
        if (swapped) std::swap(by_a, by_b);
      });
    });
}

VectorXd product(const Matrix2Xd& by, const Vec2& direction, Eigen::Index size) {
  return by.cols() == 0 ? VectorXd(VectorXd::Zero(size)) : VectorXd(by.transpose() * direction);
}

Distance disc_to_disc(const Curve& a, const Curve& b, bool container, Eigen::Index na, Eigen::Index nb) {
  const Vec2 away = a.center - b.center;
  const double d = away.norm(), sign = container ? -1 : 1;
  const Vec2 n = d > 0 ? Vec2(away / d) : Vec2::UnitX();
  Distance r{sign * (d - b.radius) - a.radius, product(a.by_center, sign * n, na), product(b.by_center, -sign * n, nb)};
  if (a.by_radius.size() > 0) r.by_a -= a.by_radius;
  if (b.by_radius.size() > 0) r.by_b -= sign * b.by_radius;
  return r;
}

/// `container`: a is to stay inside b.
Distance distance_between(const Curve& a, const Curve& b, bool container, double width, Eigen::Index na,
                          Eigen::Index nb) {
  if (a.disc && b.disc) return disc_to_disc(a, b, container, na, nb);
  Soft soft(width, na, nb);
  if (a.disc) {
    to_pieces(a.center, b, container, [&](Index i, const Foot& f, double sign) {
      const auto first = static_cast<std::size_t>(i), second = (first + 1) % b.points.size();
      soft.add(sign * f.distance - a.radius, [&](VectorXd& by_a, VectorXd& by_b) {
        by_a = product(a.by_center, sign * f.normal, na);
        if (a.by_radius.size() > 0) by_a -= a.by_radius;
        add_by(by_b, b.by, first, -sign * (1 - f.part) * f.normal);
        add_by(by_b, b.by, second, -sign * f.part * f.normal);
      });
    });
    return soft.sum();
  }
  if (b.disc) {
    if (!container) {
      Distance r = distance_between(b, a, false, width, nb, na);
      std::swap(r.by_a, r.by_b);
      return r;
    }
    for (std::size_t k = 0; k < a.points.size(); ++k) {
      const Vec2 away = a.points[k] - b.center;
      const double d = away.norm();
      const Vec2 n = d > 0 ? Vec2(away / d) : Vec2::UnitX();
      soft.add(b.radius - d, [&](VectorXd& by_a, VectorXd& by_b) {
        add_by(by_a, a.by, k, -n);
        by_b = product(b.by_center, n, nb);
        if (b.by_radius.size() > 0) by_b += b.by_radius;
      });
    }
    return soft.sum();
  }
  points_to_pieces(a, b, container, false, soft);
  if (!container) points_to_pieces(b, a, false, true, soft);
  return soft.sum();
}

Curve disc(const Vec2& center, double radius) {
  Curve c{.disc = true, .closed = true, .center = center, .radius = radius};
  return c;
}

Curve polyline(std::vector<Vec2> points, bool closed) {
  Curve c;
  c.points = std::move(points);
  c.closed = closed;
  return c;
}

std::optional<Curve> as_disc(const Loop& loop) {
  if (loop.sides.size() != 1 || !loop.sides[0].arc) return std::nullopt;
  const Arc& arc = *loop.sides[0].arc;
  const double r = arc.axes.col(0).norm();
  if (std::abs(arc.axes.col(1).norm() - r) > 1e-12 * r ||
      std::abs(arc.axes.col(0).dot(arc.axes.col(1))) > 1e-12 * r * r)
    return std::nullopt;
  return disc(arc.center, r);
}

void set_box(Thing& thing, const Curve& c) {
  thing.low = Vec2::Constant(infinity);
  thing.high = -thing.low;
  if (c.disc) {
    thing.low = c.center.array() - c.radius;
    thing.high = c.center.array() + c.radius;
  }
  for (const Vec2& x : c.points) {
    thing.low = thing.low.cwiseMin(x);
    thing.high = thing.high.cwiseMax(x);
  }
}

Thing fixed(std::string name, Curve curve) {
  Thing thing{.name = std::move(name)};
  set_box(thing, curve);
  thing.curve = [curve = std::move(curve)](const VectorXd&) { return curve; };
  return thing;
}

Thing fixed_loop(std::string name, const Loop& loop, double chord, double longest) {
  if (auto round = as_disc(loop)) return fixed(std::move(name), std::move(*round));
  return fixed(std::move(name), polyline(flatten(loop, chord, longest).points, true));
}

Curve path_of(const Crack& crack, double longest) {
  std::vector<Vec2> points = crack.points;
  if (crack.arc) {
    const int pieces = std::max(16, static_cast<int>(std::ceil(path_length(crack) / longest)));
    points = points_on(*crack.arc, pieces);
  }
  return polyline(std::move(points), false);
}

constexpr Index samples = 64;  // of an ellipse

/// `cut`: without what lies next to fixed ends of a crack, which may end on something.
Curve drawn_curve(const Drawn& d, const VectorXd& v, bool cut = false) {
  Curve c;
  c.closed = d.kind != Kind::Crack;
  const Eigen::Index n = v.size();
  switch (d.kind) {
    case Kind::Circle:
    case Kind::Inclusion:
      c.disc = true;
      c.center = v.head<2>();
      c.radius = v[2];
      c.by_center = Matrix2Xd::Zero(2, n);
      c.by_center(0, 0) = c.by_center(1, 1) = 1;
      c.by_radius = VectorXd::Zero(n);
      c.by_radius[2] = 1;
      break;
    case Kind::Ellipse: {
      const Vec2 first(std::cos(v[4]), std::sin(v[4])), second(-first.y(), first.x());
      for (Index i = 0; i < samples; ++i) {
        const double t = 2 * std::numbers::pi * i / samples, a = std::cos(t), b = std::sin(t);
        c.points.push_back(v.head<2>() + v[2] * a * first + v[3] * b * second);
        Matrix2Xd by(2, 5);
        by << Mat2::Identity(), a * first, b * second, v[2] * a * second - v[3] * b * first;
        c.by.push_back(std::move(by));
      }
      break;
    }
    case Kind::Spline: {
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
      break;
    }
    case Kind::Crack: {
      // Edges are sampled: what they cross is seen by their points.
      const auto points = static_cast<Index>(n / 2);
      constexpr Index per_edge = 8;
      const auto is_fixed = [&](Index i) { return d.lower.segment<2>(2 * i) == d.upper.segment<2>(2 * i); };
      for (Index i = 0; i + 1 < points; ++i)
        for (Index k = 0; k < per_edge + (i + 2 == points ? 1 : 0); ++k) {
          const double t = static_cast<double>(k) / per_edge;
          c.points.push_back((1 - t) * v.segment<2>(2 * i) + t * v.segment<2>(2 * i + 2));
          Matrix2Xd by = Matrix2Xd::Zero(2, n);
          for (int axis = 0; axis < 2; ++axis) {
            by(axis, 2 * i + axis) = 1 - t;
            by(axis, 2 * i + 2 + axis) = t;
          }
          c.by.push_back(std::move(by));
        }
      constexpr Index left_out = per_edge / 4;
      const auto shorten = [&](bool at_start) {
        for (Index k = 0; k < left_out; ++k) {
          if (at_start) {
            c.points.erase(c.points.begin());
            c.by.erase(c.by.begin());
          } else {
            c.points.pop_back();
            c.by.pop_back();
          }
        }
      };
      if (cut && is_fixed(0)) shorten(true);
      if (cut && is_fixed(points - 1)) shorten(false);
      break;
    }
  }
  return c;
}

Thing drawn_thing(const Drawn& d, Index number) {
  Thing thing{.name = name(d), .drawn = number};
  thing.curve = [d](const VectorXd& v) { return drawn_curve(d, v); };
  thing.cut = [d](const VectorXd& v) { return drawn_curve(d, v, true); };
  const VectorXd &l = d.lower, &u = d.upper;
  switch (d.kind) {
    case Kind::Circle:
    case Kind::Inclusion:
    case Kind::Ellipse: {
      const double radius = d.kind == Kind::Ellipse ? std::max(u[2], u[3]) : u[2];
      thing.low = l.head<2>().array() - radius;
      thing.high = u.head<2>().array() + radius;
      break;
    }
    default:
      thing.low = Vec2::Constant(infinity);
      thing.high = -thing.low;
      for (Eigen::Index i = 0; i < l.size(); i += 2) {
        thing.low = thing.low.cwiseMin(l.segment<2>(i));
        thing.high = thing.high.cwiseMax(u.segment<2>(i));
      }
  }
  return thing;
}

bool always_apart(const Thing& a, const Thing& b, double least) {
  if (b.container) return false;
  const Vec2 gap = (b.low - a.high).cwiseMax(a.low - b.high);
  return gap.maxCoeff() > least;
}

/// Whether a box lies farther than `least` inside a closed polygon or disc.
bool always_inside(const Thing& a, const Curve& b, double least) {
  const std::array<Vec2, 4> corners = {a.low, Vec2(a.high.x(), a.low.y()), a.high, Vec2(a.low.x(), a.high.y())};
  if (b.disc)
    return std::ranges::all_of(corners, [&](const Vec2& x) { return (x - b.center).norm() + least < b.radius; });
  for (const Vec2& x : corners)
    if (!inside(b.points, x)) return false;
  // No side comes near the box.
  for (std::size_t i = 0; i < b.points.size(); ++i) {
    const Vec2 &p = b.points[i], &q = b.points[(i + 1) % b.points.size()];
    if (p.x() > a.low.x() && p.x() < a.high.x() && p.y() > a.low.y() && p.y() < a.high.y()) return false;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec2 &c = corners[k], &e = corners[(k + 1) % 4];
      if (std::min({foot_on(c, p, q).distance, foot_on(e, p, q).distance, foot_on(p, c, e).distance,
                    foot_on(q, c, e).distance}) <= least)
        return false;
      if (cross_inside(c, e, p, q)) return false;
    }
  }
  return true;
}

Condition apart(const Thing& a, const Thing& b, double least, const std::string& what, const Design& d) {
  const std::vector<Eigen::Index> first = first_variables(d);
  const auto begin = [&](const Thing& t) { return t.drawn == none ? 0 : first[static_cast<std::size_t>(t.drawn)]; };
  const auto count = [&](const Thing& t) {
    return t.drawn == none ? 0 : d.drawn[static_cast<std::size_t>(t.drawn)].lower.size();
  };
  const Eigen::Index from_a = begin(a), from_b = begin(b), na = count(a), nb = count(b);
  return {what, [=](const VectorXd& x, VectorXd* gradient) {
            const VectorXd va = x.segment(from_a, na);
            const Distance r = distance_between(b.drawn == none ? a.cut(va) : a.curve(va),
                                                b.curve(x.segment(from_b, nb)), b.container, least / sharpness, na, nb);
            if (gradient) {
              gradient->setZero(x.size());
              gradient->segment(from_a, na) -= r.by_a / least;
              gradient->segment(from_b, nb) -= r.by_b / least;
            }
            return std::isfinite(r.value) ? 1 - r.value / least : -1.0;
          }};
}

/// A condition on the variables of one thing.
Condition own(std::string what, Eigen::Index first, Eigen::Index count,
              std::function<double(const VectorXd& v, VectorXd& gradient)> value) {
  return {std::move(what), [=](const VectorXd& x, VectorXd* gradient) {
            VectorXd by = VectorXd::Zero(count);
            const double c = value(x.segment(first, count), by);
            if (gradient) {
              gradient->setZero(x.size());
              gradient->segment(first, count) = by;
            }
            return c;
          }};
}

/// cos of the angle between two vectors, and its derivatives by them.
double cosine(const Vec2& a, const Vec2& b, Vec2& by_a, Vec2& by_b) {
  const double la = a.norm(), lb = b.norm();
  if (!(la > 0) || !(lb > 0)) {
    by_a = by_b = Vec2::Zero();
    return 1;
  }
  const double c = a.dot(b) / (la * lb);
  by_a = b / (la * lb) - c * a / (la * la);
  by_b = a / (la * lb) - c * b / (lb * lb);
  return c;
}

constexpr double fold = -0.5;  // cosine of the sharpest turn allowed, 120 degrees

void add_spline(const Drawn& d, Eigen::Index first, double least, std::vector<Condition>& all) {
  const Eigen::Index n = d.lower.size();
  const Design alone{{d}};
  const double smallest = std::numbers::pi / 4 * least * least;
  all.push_back(own(name(d) + " is smaller than a disc of the least distance, or its points run clockwise", first, n,
                    [=](const VectorXd& v, VectorXd& by) {
                      const double area = area_of_holes(alone, v, &by);
                      by /= -smallest;
                      return std::max(1 - area / smallest, -1e3);
                    }));
  all.push_back(
      own(fmt::format("{} is thinner than {:.4g}", name(d), least), first, n, [=](const VectorXd& v, VectorXd& by) {
        const Curve c = drawn_curve(d, v);
        const auto count = static_cast<Index>(c.points.size());
        Soft soft(least / sharpness, n, 0);
        for (Index i = 0; i < count; ++i)
          for (Index k = i + count / 4; k < count && k <= i + count - count / 4; ++k) {
            const Vec2 away = c.points[static_cast<std::size_t>(i)] - c.points[static_cast<std::size_t>(k)];
            const double size = away.norm();
            if (!(size > 0)) continue;
            soft.add(size, [&](VectorXd& g, VectorXd&) {
              add_by(g, c.by, static_cast<std::size_t>(i), away / size);
              add_by(g, c.by, static_cast<std::size_t>(k), -away / size);
            });
          }
        const Distance r = soft.sum();
        by = -r.by_a / least;
        return 1 - r.value / least;
      }));
  all.push_back(own(name(d) + " turns too sharply", first, n, [=](const VectorXd& v, VectorXd& by) {
    const auto points = static_cast<Index>(n / 2);
    Soft soft(1 / sharpness, n, 0);
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
  }));
}

void add_path(const Drawn& d, Eigen::Index first, double least, std::vector<Condition>& all) {
  const Eigen::Index n = d.lower.size();
  for (Eigen::Index i = 0; i + 2 < n; i += 2) {
    if (d.lower.segment<4>(i) == d.upper.segment<4>(i)) continue;
    all.push_back(own(fmt::format("edge {} of {} is shorter than {:.4g}", i / 2 + 1, name(d), least), first, n,
                      [=](const VectorXd& v, VectorXd& by) {
                        const Vec2 along = v.segment<2>(i + 2) - v.segment<2>(i);
                        const double size = along.norm();
                        const Vec2 t = size > 0 ? Vec2(along / size) : Vec2::UnitX();
                        by.segment<2>(i) = t / least;
                        by.segment<2>(i + 2) = -t / least;
                        return 1 - size / least;
                      }));
    if (i + 4 < n)
      all.push_back(own(
          fmt::format("{} folds at its point {}", name(d), i / 2 + 2), first, n, [=](const VectorXd& v, VectorXd& by) {
            Vec2 by_a, by_b;
            const double c =
                cosine(v.segment<2>(i + 2) - v.segment<2>(i), v.segment<2>(i + 4) - v.segment<2>(i + 2), by_a, by_b);
            by.segment<2>(i) = by_a;
            by.segment<2>(i + 2) = by_b - by_a;
            by.segment<2>(i + 4) = -by_b;
            return fold - c;
          }));
    for (Eigen::Index k = i + 4; k + 2 < n; k += 2)
      all.push_back(
          own(fmt::format("edges {} and {} of {} are less than {:.4g} apart", i / 2 + 1, k / 2 + 1, name(d), least),
              first, n, [=](const VectorXd& v, VectorXd& by) {
                const auto edge = [&](Eigen::Index at) {
                  Curve c = polyline({v.segment<2>(at), v.segment<2>(at + 2)}, false);
                  for (Eigen::Index e = at; e <= at + 2; e += 2) {
                    Matrix2Xd g = Matrix2Xd::Zero(2, n);
                    g(0, e) = g(1, e + 1) = 1;
                    c.by.push_back(std::move(g));
                  }
                  return c;
                };
                const Distance r = distance_between(edge(i), edge(k), false, least / sharpness, n, n);
                by = -(r.by_a + r.by_b) / least;
                return 1 - r.value / least;
              }));
  }
}

}  // namespace

std::vector<Condition> conditions(const Design& d, const Problem& p, double least,
                                  const std::vector<Forbidden>& forbidden) {
  const double longest = std::max(least, extent(p.frame) / 200), chord = least / 20;
  std::vector<Thing> others;
  others.push_back(fixed_loop("the outline", p.frame.outline, chord, extent(p.frame)));
  others.back().container = true;
  for (const Loop& hole : p.frame.holes)
    others.push_back(fixed_loop(fmt::format("hole '{}'", hole.name), hole, chord, longest));
  for (const Crack& crack : p.frame.cracks)
    others.push_back(fixed(fmt::format("crack '{}'", crack.name), path_of(crack, longest)));
  for (const Loop& region : p.frame.regions)
    others.push_back(fixed_loop(fmt::format("region '{}'", region.name), region, chord, longest));
  const std::size_t first_region = others.size() - p.frame.regions.size();
  for (const Forbidden& f : forbidden) others.push_back(fixed(f.name, disc(f.center, f.radius)));

  std::vector<Condition> all;
  const std::vector<Eigen::Index> first = first_variables(d);
  std::vector<Thing> things;
  for (std::size_t k = 0; k < d.drawn.size(); ++k) things.push_back(drawn_thing(d.drawn[k], static_cast<Index>(k)));
  for (std::size_t k = 0; k < things.size(); ++k) {
    const Drawn& one = d.drawn[k];
    if (one.lower == one.upper) continue;
    const std::string apart_by = fmt::format("less than {:.4g} apart", least);
    for (std::size_t i = 0; i < others.size(); ++i) {
      Thing other = others[i];
      const Curve curve = other.curve({});
      if (i >= first_region && i < first_region + p.frame.regions.size()) {
        const Curve start = things[k].curve(one.start);
        const Vec2 x = start.disc ? start.center : start.points.front();
        other.container = curve.disc ? (x - curve.center).norm() < curve.radius : inside(curve.points, x);
      }
      if (other.container ? always_inside(things[k], curve, least) : always_apart(things[k], other, least)) continue;
      all.push_back(
          apart(things[k], other, least, fmt::format("{} and {} are {}", things[k].name, other.name, apart_by), d));
    }
    for (std::size_t i = 0; i < things.size(); ++i) {
      if (i == k || (i < k && d.drawn[i].lower != d.drawn[i].upper)) continue;  // once per pair
      if (always_apart(things[k], things[i], least)) continue;
      all.push_back(apart(things[k], things[i], least,
                          fmt::format("{} and {} are {}", things[k].name, things[i].name, apart_by), d));
    }
    if (one.kind == Kind::Spline) add_spline(one, first[k], least, all);
    if (one.kind == Kind::Crack) add_path(one, first[k], least, all);
  }
  return all;
}

}  // namespace kerf
