// A crack: x, y of the vertices of its path, from start to end. Vertices of the mesh keep their edge and their share of
// it. Constraints see each edge in eight samples; next to a fixed end, which may lie on another thing, the last quarter
// of the edge is left out against fixed things. A path keeps its edges as long as the least distance, turns by less
// than 120 degrees and comes nowhere nearer to itself than that distance. A guess is a straight crack at one of 24
// angles, between the boxes of its ends [theory: I.1]. docs/theory/inverse.md.

#include "optimize/parametric/shapes/shape.hpp"

#include <fmt/core.h>

#include <cmath>

namespace kerf {

namespace {

using Eigen::Matrix2Xd;
using Eigen::VectorXd;

Vec2 vertex_of_crack(const VectorXd& v, Index i) {
  return v.segment<2>(2 * i);
}

bool crack_fits(Eigen::Index count) {
  return count >= 4 && count % 2 == 0;
}

void check_crack(const Drawn&, const Problem&) {}

std::vector<Vec2> path(const VectorXd& v) {
  std::vector<Vec2> points;
  for (Index i = 0; i < static_cast<Index>(v.size() / 2); ++i) points.push_back(vertex_of_crack(v, i));
  return points;
}

void draw_crack(const Drawn& d, const VectorXd& v, const Problem&, DrawnBody& body) {
  body.shape.cracks.push_back({d.name, path(v), {}});
  body.scene.laws.push_back(d.law);
}

std::function<Spot(const Vec2& x)> locate_on_crack(const VectorXd& v, double) {
  return [points = path(v)](const Vec2& x) { return place_on(points, false, x); };
}

// Linear in both ends of its edge.
Vec2 position_on_crack(const Spot& spot, const VectorXd& v) {
  return vertex_of_crack(v, spot.piece) +
         spot.part * (vertex_of_crack(v, spot.piece + 1) - vertex_of_crack(v, spot.piece));
}

void pull_crack(const Spot& spot, const VectorXd&, const Vec2& force, Eigen::Ref<VectorXd> sum) {
  sum.segment<2>(2 * spot.piece) += (1 - spot.part) * force;
  sum.segment<2>(2 * spot.piece + 2) += spot.part * force;
}

DesignCurve crack_boundary(const Drawn& d, const VectorXd& v, bool cut) {
  DesignCurve c;
  const Eigen::Index n = v.size();
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
  return c;
}

// 1 - |b - a|/least, t the direction of the edge.
Constraint long_enough(const Drawn& d, Eigen::Index first, Eigen::Index i, double least) {
  return own_constraint(fmt::format("edge {} of {} is shorter than {:.4g}", i / 2 + 1, name(d), least), first,
                        d.lower.size(), [=](const VectorXd& v, VectorXd& by) {
                          const Vec2 along = v.segment<2>(i + 2) - v.segment<2>(i);
                          const double size = along.norm();
                          const Vec2 t = size > 0 ? Vec2(along / size) : Vec2::UnitX();
                          by.segment<2>(i) = t / least;
                          by.segment<2>(i + 2) = -t / least;
                          return 1 - size / least;
                        });
}

// fold - cos of the turn between two edges.
Constraint without_fold(const Drawn& d, Eigen::Index first, Eigen::Index i) {
  return own_constraint(fmt::format("{} folds at its point {}", name(d), i / 2 + 2), first, d.lower.size(),
                        [=](const VectorXd& v, VectorXd& by) {
                          Vec2 by_a, by_b;
                          const double c = cosine(v.segment<2>(i + 2) - v.segment<2>(i),
                                                  v.segment<2>(i + 4) - v.segment<2>(i + 2), by_a, by_b);
                          by.segment<2>(i) = by_a;
                          by.segment<2>(i + 2) = by_b - by_a;
                          by.segment<2>(i + 4) = -by_b;
                          return fold - c;
                        });
}

/// The edge whose first vertex has its variables at `at`.
DesignCurve edge(const VectorXd& v, Eigen::Index at) {
  DesignCurve c = fixed_polyline({v.segment<2>(at), v.segment<2>(at + 2)}, false);
  for (Eigen::Index e = at; e <= at + 2; e += 2) {
    Matrix2Xd g = Matrix2Xd::Zero(2, v.size());
    g(0, e) = g(1, e + 1) = 1;
    c.by.push_back(std::move(g));
  }
  return c;
}

// Of edges that share no vertex; both belong to the same variables.
Constraint edges_apart(const Drawn& d, Eigen::Index first, std::array<Eigen::Index, 2> at, double least) {
  const auto [i, k] = at;
  const Eigen::Index n = d.lower.size();
  return own_constraint(
      fmt::format("edges {} and {} of {} are less than {:.4g} apart", i / 2 + 1, k / 2 + 1, name(d), least), first, n,
      [=, i = i, k = k](const VectorXd& v, VectorXd& by) {
        const Distance r = distance_between(edge(v, i), edge(v, k), {.width = least / sharpness, .by_a = n, .by_b = n});
        by = -(r.by_a + r.by_b) / least;
        return 1 - r.value / least;
      });
}

/// Edges as long as the distance and as far apart, no folds.
void constrain_crack(const Drawn& d, Eigen::Index first, double least, std::vector<Constraint>& all) {
  const Eigen::Index n = d.lower.size();
  const auto moves = [&](Eigen::Index i) { return d.lower.segment<4>(i) != d.upper.segment<4>(i); };
  for (Eigen::Index i = 0; i + 2 < n; i += 2) {
    if (moves(i)) all.push_back(long_enough(d, first, i, least));
    if (i + 4 < n && (moves(i) || moves(i + 2))) all.push_back(without_fold(d, first, i));
    for (Eigen::Index k = i + 4; k + 2 < n; k += 2)
      if (moves(i) || moves(k)) all.push_back(edges_apart(d, first, {i, k}, least));
  }
}

/// Straight cracks in all directions.
/// Half the least and the largest distance of the boxes of both ends.
Sought seek_crack(const Drawn& d, const Problem&) {
  const VectorXd &l = d.lower, &u = d.upper;
  const Eigen::Index last = l.size() - 2;
  const Vec2 nearest = (l.segment<2>(last) - u.head<2>()).cwiseMax(l.head<2>() - u.segment<2>(last)).cwiseMax(0);
  const Vec2 furthest = (u.segment<2>(last) - l.head<2>()).cwiseMax(u.head<2>() - l.segment<2>(last));
  Sought s{.low = 0.5 * (l.head<2>() + l.segment<2>(last)),
           .high = 0.5 * (u.head<2>() + u.segment<2>(last)),
           .least = std::max(0.5 * nearest.norm(), 1e-3 * furthest.norm()),
           .most = 0.5 * furthest.norm(),
           .variants = {},
           .turns = true};
  s.size = std::sqrt(s.least * s.most);
  constexpr int angles = 24;
  for (int i = 0; i < angles; ++i) {
    Variant v{.angle = pi * i / angles};
    v.what.kind = Perturbation::Kind::Crack;
    s.variants.push_back(v);
  }
  return s;
}

/// A straight path, in the direction that its boxes suit better.
VectorXd guessed_crack(const Guess& g, const Drawn& d) {
  const Vec2 half = g.size * Vec2(std::cos(g.angle), std::sin(g.angle));
  const auto path = [&](double sign) {
    VectorXd w(d.start.size());
    const Eigen::Index pieces = w.size() / 2 - 1;
    for (Eigen::Index i = 0; i <= pieces; ++i)
      w.segment<2>(2 * i) = g.at + sign * (2.0 * static_cast<double>(i) / static_cast<double>(pieces) - 1) * half;
    return w;
  };
  // A path has two directions: the one that leaves its boxes less.
  const auto outside = [&](const VectorXd& w) { return (w - w.cwiseMax(d.lower).cwiseMin(d.upper)).norm(); };
  return outside(path(-1)) < outside(path(1)) ? path(-1) : path(1);
}

std::string crack_guess_in_words(const Guess& g) {
  return fmt::format("half its length {:.3g}, {:.0f} degrees", g.size, g.angle * 180 / pi);
}

}  // namespace

constinit const DrawnShape crack_shape{.kind = Drawn::Kind::Crack,
                                       .part = BodyPart::Crack,
                                       .names = coordinate_names,
                                       .fits = crack_fits,
                                       .asks = "a crack needs two points or more, x and y each",
                                       .check = check_crack,
                                       .draw = draw_crack,
                                       .locate = locate_on_crack,
                                       .position = position_on_crack,
                                       .pull = pull_crack,
                                       .boundary = crack_boundary,
                                       .box = box_of_points,
                                       .constrain = constrain_crack,
                                       .seek = seek_crack,
                                       .guessed = guessed_crack,
                                       .guess_in_words = crack_guess_in_words};

}  // namespace kerf
