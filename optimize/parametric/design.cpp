#include "kerf/design.hpp"

#include "geometry/plane.hpp"
#include "kerf/optimize.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf {

namespace {

using Eigen::VectorXd;
using Kind = Drawn::Kind;

Mat2 rotation(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return Mat2{{c, -s}, {s, c}};
}

/// Axes of a circle or an ellipse.
Mat2 axes(const Drawn& d, const VectorXd& v) {
  if (d.kind != Kind::Ellipse) return v[2] * Mat2::Identity();
  return rotation(v[4]) * v.segment<2>(2).asDiagonal();
}

Vec2 vertex(const VectorXd& v, Index i) {
  return v.segment<2>(2 * i);
}

Vec2 spline_point(const VectorXd& v, double s) {
  const auto n = static_cast<Index>(v.size() / 2);
  const SplineWeights w = spline_weights(n, s);
  Vec2 x = Vec2::Zero();
  for (Index i = 0; i < 4; ++i) x += w.position[i] * vertex(v, (w.first + i) % n);
  return x;
}

/// Pieces of the polygon of a spline: no corner turns by more than what the mesher takes for a smooth boundary.
Index spline_pieces(const VectorXd& v, double size) {
  const auto n = static_cast<Index>(v.size() / 2);
  constexpr double most_turn = 6 * std::numbers::pi / 180;
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

double size_of(const Problem& p) {
  return p.sizing.size > 0 ? p.sizing.size : extent(p.frame) / 40;
}

std::vector<VectorXd> parts(const Design& d, const VectorXd& x) {
  std::vector<VectorXd> all;
  Eigen::Index first = 0;
  for (const Drawn& one : d.drawn) {
    all.push_back(x.segment(first, one.lower.size()));
    first += one.lower.size();
  }
  return all;
}

void require(bool good, const Drawn& d, const std::string& what) {
  if (!good) throw Error(Fault::Usage, fmt::format("the design of {}: {}", name(d), what));
}

/// Position of a follower, and force . d position / d variables.
Vec2 position(const Drawn& d, const Followers::One& f, Index pieces, const VectorXd& v) {
  switch (d.kind) {
    case Kind::Crack:
      return vertex(v, f.piece) + f.part * (vertex(v, f.piece + 1) - vertex(v, f.piece));
    case Kind::Spline: {
      const double per_span = static_cast<double>(pieces) / (static_cast<double>(v.size()) / 2);
      const Vec2 a = spline_point(v, f.piece / per_span), b = spline_point(v, (f.piece + 1) % pieces / per_span);
      return a + f.part * (b - a);
    }
    default:
      return vertex(v, 0) + axes(d, v) * f.local;
  }
}

void add_pull(const Drawn& d, const Followers::One& f, Index pieces, const VectorXd& v, const Vec2& force,
              Eigen::Ref<VectorXd> sum) {
  switch (d.kind) {
    case Kind::Crack:
      sum.segment<2>(2 * f.piece) += (1 - f.part) * force;
      sum.segment<2>(2 * f.piece + 2) += f.part * force;
      return;
    case Kind::Spline: {
      const auto n = static_cast<Index>(v.size() / 2);
      const double per_span = static_cast<double>(pieces) / n;
      for (int end = 0; end < 2; ++end) {
        const SplineWeights w = spline_weights(n, (f.piece + end) % pieces / per_span);
        for (Index i = 0; i < 4; ++i)
          sum.segment<2>(2 * ((w.first + i) % n)) += (end == 0 ? 1 - f.part : f.part) * w.position[i] * force;
      }
      return;
    }
    case Kind::Ellipse: {
      sum.head<2>() += force;
      const Mat2 turn = rotation(v[4]);
      const Vec2 scaled = v.segment<2>(2).cwiseProduct(f.local);
      sum[2] += force.dot(turn.col(0)) * f.local.x();
      sum[3] += force.dot(turn.col(1)) * f.local.y();
      sum[4] += force.dot(turn * Vec2(-scaled.y(), scaled.x()));
      return;
    }
    case Kind::Circle:
    case Kind::Inclusion:
      sum.head<2>() += force;
      sum[2] += force.dot(f.local);
  }
}

/// The piece of a polyline nearest to y, and where along it.
std::pair<Index, double> place_on(const std::vector<Vec2>& points, bool closed, const Vec2& y) {
  const auto count = static_cast<Index>(points.size()) - (closed ? 0 : 1);
  Index best = 0;
  double least = 0, part = 0;
  for (Index i = 0; i < count; ++i) {
    const Vec2& a = points[static_cast<std::size_t>(i)];
    const Vec2& b = points[static_cast<std::size_t>(i + 1) % points.size()];
    const double away = distance(y, a, b);
    if (i > 0 && away >= least) continue;
    least = away;
    best = i;
    part = std::clamp((y - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  }
  return {best, part};
}

std::vector<Vec2> spline_polygon(const VectorXd& v, Index pieces) {
  const double per_span = static_cast<double>(pieces) / (static_cast<double>(v.size()) / 2);
  std::vector<Vec2> points;
  for (Index i = 0; i < pieces; ++i) points.push_back(spline_point(v, i / per_span));
  return points;
}

Index label_of(Shape& shape, const std::string& label) {
  const auto found = std::find(shape.labels.begin(), shape.labels.end(), label);
  if (found != shape.labels.end()) return static_cast<Index>(found - shape.labels.begin());
  shape.labels.push_back(label);
  return static_cast<Index>(shape.labels.size()) - 1;
}

}  // namespace

std::string name(const Drawn& d) {
  const char* what = d.kind == Kind::Crack ? "crack" : d.kind == Kind::Inclusion ? "region" : "hole";
  return fmt::format("{} '{}'", what, d.name);
}

bool is_hole(const Drawn& d) {
  return d.kind == Kind::Circle || d.kind == Kind::Ellipse || d.kind == Kind::Spline;
}

Eigen::Index variables(const Design& d) {
  Eigen::Index count = 0;
  for (const Drawn& one : d.drawn) count += one.lower.size();
  return count;
}

std::vector<Eigen::Index> first_variables(const Design& d) {
  std::vector<Eigen::Index> first{0};
  for (const Drawn& one : d.drawn) first.push_back(first.back() + one.lower.size());
  first.pop_back();
  return first;
}

namespace {

VectorXd joined(const Design& d, VectorXd Drawn::*member) {
  VectorXd all(variables(d));
  Eigen::Index first = 0;
  for (const Drawn& one : d.drawn) {
    all.segment(first, (one.*member).size()) = one.*member;
    first += one.lower.size();
  }
  return all;
}

}  // namespace

VectorXd lower_bounds(const Design& d) {
  return joined(d, &Drawn::lower);
}

VectorXd upper_bounds(const Design& d) {
  return joined(d, &Drawn::upper);
}

VectorXd start_of(const Design& d) {
  return joined(d, &Drawn::start);
}

void check_design(const Design& d, const Problem& p) {
  if (d.drawn.empty()) throw Error(Fault::Usage, "the design draws nothing; give it holes, cracks or inclusions");
  std::vector<std::string> holes, cracks, regions;
  for (const Loop& hole : p.frame.holes) holes.push_back(hole.name);
  for (const Crack& crack : p.frame.cracks) cracks.push_back(crack.name);
  for (const Loop& region : p.frame.regions) regions.push_back(region.name);
  for (const Drawn& one : d.drawn) {
    const Eigen::Index count = one.lower.size();
    require(one.upper.size() == count && one.start.size() == count, one, "every variable needs two bounds and a start");
    switch (one.kind) {
      case Kind::Circle:
        require(count == 3, one, "a circle has 3 variables: center x, y, radius");
        break;
      case Kind::Ellipse:
        require(count == 5, one, "an ellipse has 5 variables: center x, y, semi-axes, angle");
        break;
      case Kind::Spline:
        require(count >= 8 && count % 2 == 0, one, "a spline needs four control points or more, x and y each");
        break;
      case Kind::Crack:
        require(count >= 4 && count % 2 == 0, one, "a crack needs two points or more, x and y each");
        break;
      case Kind::Inclusion:
        require(count == 4, one, "an inclusion has 4 variables: center x, y, radius, Young's modulus");
        require(one.poisson > -1 && (p.plane_strain ? one.poisson <= 0.5 : one.poisson < 1), one,
                fmt::format("Poisson's ratio {:g} belongs to no material", one.poisson));
        break;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      require(std::isfinite(one.lower[i]) && std::isfinite(one.upper[i]) && one.lower[i] <= one.upper[i], one,
              fmt::format("the bounds {:g} and {:g} of variable {} have to be finite, the lower one first",
                          one.lower[i], one.upper[i], i + 1));
      require(one.start[i] >= one.lower[i] && one.start[i] <= one.upper[i], one,
              fmt::format("the start {:g} of variable {} has to lie between {:g} and {:g}", one.start[i], i + 1,
                          one.lower[i], one.upper[i]));
    }
    const bool round = one.kind == Kind::Circle || one.kind == Kind::Inclusion;
    require(!round || one.lower[2] > 0, one, "the radius must not vanish; give it a positive lower bound");
    require(one.kind != Kind::Ellipse || one.lower.segment<2>(2).minCoeff() > 0, one,
            "the semi-axes must not vanish; give them positive lower bounds");
    require(one.kind != Kind::Inclusion || one.lower[3] > 0, one,
            "Young's modulus must not vanish; give it a positive lower bound");
    auto& names = is_hole(one) ? holes : one.kind == Kind::Crack ? cracks : regions;
    require(std::find(names.begin(), names.end(), one.name) == names.end(), one, "that name is taken; use another one");
    names.push_back(one.name);
  }
}

Material material_of(const Drawn& inclusion, double young, const Problem& p) {
  return p.plane_strain ? plane_strain(young, inclusion.poisson) : plane_stress(young, inclusion.poisson);
}

DrawnBody body_of(const Design& d, const VectorXd& x, const Problem& p) {
  DrawnBody body{p.frame, p.scene};
  const std::vector<VectorXd> part = parts(d, x);
  for (std::size_t k = 0; k < d.drawn.size(); ++k) {
    const Drawn& one = d.drawn[k];
    const VectorXd& v = part[k];
    const Index label = is_hole(one) ? label_of(body.shape, "hole:" + one.name) : none;
    switch (one.kind) {
      case Kind::Circle:
        body.shape.holes.push_back(circle(one.name, v.head<2>(), v[2], label));
        break;
      case Kind::Ellipse:
        body.shape.holes.push_back(ellipse(one.name, v.head<2>(), v.segment<2>(2), v[4], label));
        break;
      case Kind::Spline:
        body.shape.holes.push_back(polygon(one.name, spline_polygon(v, spline_pieces(v, size_of(p))), label));
        break;
      case Kind::Crack: {
        Crack crack{one.name, {}, {}};
        for (Index i = 0; i < static_cast<Index>(v.size() / 2); ++i) crack.points.push_back(vertex(v, i));
        body.shape.cracks.push_back(std::move(crack));
        body.scene.laws.push_back(one.law);
        break;
      }
      case Kind::Inclusion:
        body.shape.regions.push_back(circle(one.name, v.head<2>(), v[2], none));
        body.scene.regions.push_back(material_of(one, v[3], p));
        break;
    }
  }
  return body;
}

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

Followers followers(const Design& d, const VectorXd& at, const Problem& p, const Mesh& mesh) {
  Followers f{at, {}, std::vector<Index>(d.drawn.size(), 0)};
  const std::vector<VectorXd> part = parts(d, at);
  Shape labels = p.frame;
  auto crack = static_cast<Index>(p.frame.cracks.size()), region = static_cast<Index>(p.frame.regions.size());
  for (std::size_t k = 0; k < d.drawn.size(); ++k) {
    const Drawn& one = d.drawn[k];
    const VectorXd& v = part[k];
    const Index label = is_hole(one) ? label_of(labels, "hole:" + one.name) : none;
    std::vector<bool> on(mesh.points.size(), false);
    for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
      const auto of_region = [&](Index t) { return t != none && region_of(mesh, t) == region; };
      const bool mine = one.kind == Kind::Crack       ? mesh.crack[e] == crack
                        : one.kind == Kind::Inclusion ? of_region(mesh.sides[e][0]) != of_region(mesh.sides[e][1])
                                                      : mesh.label[e] == label;
      if (mine)
        for (const Index i : mesh.edges[e]) on[static_cast<std::size_t>(i)] = true;
    }
    std::vector<Vec2> path;
    if (one.kind == Kind::Spline) {
      f.pieces[k] = spline_pieces(v, size_of(p));
      path = spline_polygon(v, f.pieces[k]);
    } else if (one.kind == Kind::Crack) {
      for (Index i = 0; i < static_cast<Index>(v.size() / 2); ++i) path.push_back(vertex(v, i));
    }
    Mat2 inverse = Mat2::Identity();
    if (path.empty()) {
      const Mat2 a = axes(one, v);
      inverse = Mat2{{a(1, 1), -a(0, 1)}, {-a(1, 0), a(0, 0)}} / (a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0));
    }
    for (std::size_t i = 0; i < on.size(); ++i) {
      if (!on[i]) continue;
      Followers::One follower{static_cast<Index>(i), static_cast<Index>(k)};
      if (path.empty())
        follower.local = inverse * (mesh.points[i] - v.head<2>());
      else
        std::tie(follower.piece, follower.part) = place_on(path, one.kind == Kind::Spline, mesh.points[i]);
      f.all.push_back(follower);
    }
    crack += one.kind == Kind::Crack ? 1 : 0;
    region += one.kind == Kind::Inclusion ? 1 : 0;
  }
  return f;
}

Points positions(const Design& d, const Followers& f, const VectorXd& x) {
  const std::vector<VectorXd> part = parts(d, x);
  Points at(2, static_cast<Eigen::Index>(f.all.size()));
  for (std::size_t i = 0; i < f.all.size(); ++i) {
    const auto k = static_cast<std::size_t>(f.all[i].drawn);
    at.col(static_cast<Eigen::Index>(i)) = position(d.drawn[k], f.all[i], f.pieces[k], part[k]);
  }
  return at;
}

VectorXd pull_back(const Design& d, const Followers& f, const VectorXd& x, const Points& force) {
  const std::vector<VectorXd> part = parts(d, x);
  const std::vector<Eigen::Index> first = first_variables(d);
  VectorXd sum = VectorXd::Zero(x.size());
  for (std::size_t i = 0; i < f.all.size(); ++i) {
    const auto k = static_cast<std::size_t>(f.all[i].drawn);
    add_pull(d.drawn[k], f.all[i], f.pieces[k], part[k], force.col(static_cast<Eigen::Index>(i)),
             sum.segment(first[k], part[k].size()));
  }
  return sum;
}

double area_of_holes(const Design& d, const VectorXd& x, VectorXd* gradient) {
  if (gradient) gradient->setZero(x.size());
  const std::vector<VectorXd> part = parts(d, x);
  const std::vector<Eigen::Index> first = first_variables(d);
  double area = 0;
  for (std::size_t k = 0; k < d.drawn.size(); ++k) {
    const VectorXd& v = part[k];
    constexpr double pi = std::numbers::pi;
    switch (d.drawn[k].kind) {
      case Kind::Circle:
        area += pi * v[2] * v[2];
        if (gradient) (*gradient)[first[k] + 2] = 2 * pi * v[2];
        break;
      case Kind::Ellipse:
        area += pi * v[2] * v[3];
        if (gradient) gradient->segment<2>(first[k] + 2) = pi * Vec2(v[3], v[2]);
        break;
      case Kind::Spline: {
        // 1/2 int x cross x' ds: of degree 5 on each span, so that three Gauss points are exact.
        const auto n = static_cast<Index>(v.size() / 2);
        const double away = std::sqrt(0.15);
        for (Index span = 0; span < n; ++span)
          for (int q = -1; q <= 1; ++q) {
            const SplineWeights w = spline_weights(n, span + 0.5 + q * away);
            Vec2 at = Vec2::Zero(), along = Vec2::Zero();
            for (Index i = 0; i < 4; ++i) {
              at += w.position[i] * vertex(v, (w.first + i) % n);
              along += w.derivative[i] * vertex(v, (w.first + i) % n);
            }
            const double half = (q == 0 ? 4.0 / 9 : 5.0 / 18) / 2;
            area += half * cross(at, along);
            if (!gradient) continue;
            for (Index i = 0; i < 4; ++i)
              gradient->segment<2>(first[k] + 2 * ((w.first + i) % n)) +=
                  half * (w.position[i] * Vec2(along.y(), -along.x()) + w.derivative[i] * Vec2(-at.y(), at.x()));
          }
        break;
      }
      case Kind::Crack:
      case Kind::Inclusion:
        break;
    }
  }
  return area;
}

}  // namespace kerf
