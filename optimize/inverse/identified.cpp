// What was found against what is true, for synthetic data: holes, regions and cracks of the design and of the true body
// are paired within their kind, the nearest two first. A hole counts as the circle of its area and centroid, a crack by
// its ends, whichever way it runs; a region has Young's modulus besides, from mu and c of its material [theory: N.5].
// Errors are the distance of the centers (for a crack the larger one of its ends) and the difference of radii or
// lengths. What is left without a partner is named and not compared. docs/theory/inverse.md has the fit itself.

#include "kerf/inverse.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Eigen::VectorXd;
enum class Sort { Hole, Crack, Region };

struct Thing {
  Sort sort;
  std::string name;
  VectorXd value;
};

/// Center and radius of the circle of the same area and centroid.
VectorXd as_circle(const Loop& loop, double size) {
  if (loop.sides.size() == 1 && loop.sides[0].arc) {
    const Arc& arc = *loop.sides[0].arc;
    return Eigen::Vector3d(arc.center.x(), arc.center.y(),
                           std::sqrt(std::abs(cross(arc.axes.col(0), arc.axes.col(1)))));
  }
  const Polygon p = flatten(loop, 1e-6 * size, size / 50);
  double area = 0;
  Vec2 moment = Vec2::Zero();
  const Vec2& origin = p.points[0];
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const Vec2 a = p.points[i] - origin, b = p.points[(i + 1) % p.points.size()] - origin;
    // Triangles from the first point: area and first moment without cancellation far from the origin.
    area += 0.5 * cross(a, b);
    moment += cross(a, b) / 6 * (a + b);
  }
  const Vec2 center = origin + moment / area;
  return Eigen::Vector3d(center.x(), center.y(), std::sqrt(area / pi));
}

/// Young's modulus of a material, in the state that the problem is in.
double young_of(const Material& m, bool plane_strain) {
  const double lateral = 4 * m.mu * m.c;  // 1 - 2 nu, or (1 - nu)/(1 + nu)
  const double poisson = plane_strain ? 0.5 * (1 - lateral) : (1 - lateral) / (1 + lateral);
  return 2 * m.mu * (1 + poisson);
}

VectorXd with_young(const VectorXd& circle, const Material& m, const Problem& p) {
  VectorXd v(4);
  v << circle, young_of(m, p.plane_strain);
  return v;
}

/// Everything that the frame has not.
/// Holes, cracks and regions stand behind those of the frame.
std::vector<Thing> things(const Shape& shape, const Scene& scene, const Problem& p) {
  std::vector<Thing> all;
  const double size = extent(shape);
  for (std::size_t i = p.frame.holes.size(); i < shape.holes.size(); ++i)
    all.push_back({Sort::Hole, "hole '" + shape.holes[i].name + "'", as_circle(shape.holes[i], size)});
  for (std::size_t i = p.frame.cracks.size(); i < shape.cracks.size(); ++i) {
    const Crack& c = shape.cracks[i];
    VectorXd ends(4);
    ends << c.points.front(), c.points.back();
    all.push_back({Sort::Crack, "crack '" + c.name + "'", ends});
  }
  for (std::size_t i = p.frame.regions.size(); i < shape.regions.size(); ++i)
    all.push_back({Sort::Region, "region '" + shape.regions[i].name + "'",
                   with_young(as_circle(shape.regions[i], size), scene.regions[i], p)});
  return all;
}

// A crack may be written from either end: the order that is nearer to the one found.
void turn_towards(const VectorXd& found, VectorXd& ends) {
  VectorXd other(4);
  other << ends.tail<2>(), ends.head<2>();
  if ((other - found).norm() < (ends - found).norm()) ends = other;
}

// Of a crack the worse one of its ends counts.
double away(const Thing& a, const Thing& b) {
  if (a.sort != Sort::Crack) return (a.value.head<2>() - b.value.head<2>()).norm();
  VectorXd ends = b.value;
  turn_towards(a.value, ends);
  return std::max((ends.head<2>() - a.value.head<2>()).norm(), (ends.tail<2>() - a.value.tail<2>()).norm());
}

std::string numbers(Sort sort, const VectorXd& v) {
  if (sort == Sort::Crack) return fmt::format("({:.5g}, {:.5g}) to ({:.5g}, {:.5g})", v[0], v[1], v[2], v[3]);
  return fmt::format("center ({:.5g}, {:.5g}), radius {:.5g}{}", v[0], v[1], v[2],
                     sort == Sort::Region ? fmt::format(", young {:.5g}", v[3]) : "");
}

}  // namespace

// Greedy pairs: with few things well apart the nearest two belong together.
std::vector<Identified> identified(const Design& design, const VectorXd& x, const Problem& p, const Synthetic& truth) {
  const auto body = body_of(design, x, p);
  const std::vector<Thing> found = things(body.shape, body.scene, p),
                           exact = things(truth.true_shape, truth.true_scene, p);
  std::vector<Identified> out;
  for (const Thing& f : found) out.push_back({.name = f.name, .truth = "", .found = f.value, .exact = {}});
  std::vector<bool> taken(exact.size(), false);
  for (std::size_t round = 0; round < found.size(); ++round) {  // the nearest two that are left
    double least = infinity;
    std::size_t at = 0, to = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
      for (std::size_t k = 0; k < exact.size(); ++k)
        if (out[i].truth.empty() && !taken[k] && found[i].sort == exact[k].sort && away(found[i], exact[k]) < least)
          least = away(found[i], exact[k]), at = i, to = k;
    if (!std::isfinite(least)) break;
    taken[to] = true;
    Identified& one = out[at];
    one.truth = exact[to].name;
    one.exact = exact[to].value;
    one.position_error = least;
    if (found[at].sort == Sort::Crack) {
      turn_towards(one.found, one.exact);
      const auto length = [](const VectorXd& v) { return (v.tail<2>() - v.head<2>()).norm(); };
      one.size_error = length(one.found) - length(one.exact);
    } else {
      one.size_error = one.found[2] - one.exact[2];
    }
  }
  return out;
}

std::string in_words(const Identified& i) {
  const Sort sort = i.name.starts_with("crack") ? Sort::Crack : i.found.size() == 4 ? Sort::Region : Sort::Hole;
  std::string words = i.name + ": " + numbers(sort, i.found);
  if (i.truth.empty()) return words + "; nothing true of its kind is left to compare with";
  words += fmt::format("; true {}: {}; off by {:.3g}, {} by {:+.3g}", i.truth, numbers(sort, i.exact), i.position_error,
                       sort == Sort::Crack ? "length" : "radius", i.size_error);
  if (sort == Sort::Region) words += fmt::format(", young by {:+.3g}", i.found[3] - i.exact[3]);
  return words;
}

}  // namespace kerf
