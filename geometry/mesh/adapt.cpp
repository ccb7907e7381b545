// The next mesh from an indicator eta_T per triangle. Remeshing: size factors r_T = w eta_T^(-1/(p+1)) between bounds
// give every new triangle the same error [theory: R.7]; w is found by bisection such that the sum of eta^2 r^(2 p)
// reaches the goal, or that of r^-2 the largest number of triangles. Newest-vertex bisection [theory: R.8]: a triangle
// halves its edge 0, opposite its newest vertex; a marked triangle marks that edge, and with it the triangle beyond,
// which halves its own edge 0 first: the loop ends because every step marks a new edge. At most four shapes of
// triangles descend from each. Images at mirrored tips are halved together. docs/theory/recovery_and_estimates.md,
// "Refinement".

#include "geometry/adapt.hpp"
#include "geometry/mesh/mirror.hpp"
#include "geometry/topology.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

void check_goal(const Mesh& mesh, std::span<const double> eta, const Goal& goal) {
  if (eta.size() != mesh.triangles.size())
    throw std::invalid_argument(fmt::format("{} indicators for {} triangles", eta.size(), mesh.triangles.size()));
  for (const double e : eta)
    if (!(e >= 0) || !std::isfinite(e)) throw std::invalid_argument(fmt::format("an indicator of {}", e));
  if (!(goal.error > 0) || !(goal.order > 0) || !(goal.max_triangles > 0))
    throw std::invalid_argument("the goal's error, order and number of triangles must be positive");
  if (!(goal.smallest > 0 && goal.smallest <= goal.largest))
    throw std::invalid_argument("the goal's bounds on the change of size must be positive and in order");
}

/// Factors on the sizes of the triangles. With r_T that of T, p the order, T becomes r^-2 triangles with the squared
/// error eta^2 r^2p in all. The least sum of r^-2 at a given sum of eta^2 r^2p has r^(2p+2) eta^2 the same everywhere:
/// every new triangle the same error. So r = w eta^(-1/(p+1)), between the bounds, w from the goal.
/// 60 steps in log w: to the last digit. Triangles without an error take the largest factor.
std::vector<double> factors(std::span<const double> eta, const Goal& goal) {
  const double p = goal.order;
  std::vector<double> factor(eta.size());
  for (std::size_t t = 0; t < eta.size(); ++t) factor[t] = eta[t] > 0 ? std::pow(eta[t], -1 / (p + 1)) : infinity;
  const double low_power = std::pow(goal.smallest, 2 * p), high_power = std::pow(goal.largest, 2 * p);
  std::vector<double> weight(eta.size());  // of w^2p in the squared error
  for (std::size_t t = 0; t < eta.size(); ++t) weight[t] = eta[t] > 0 ? std::pow(eta[t], 2 / (p + 1)) : 0;
  const auto too_large = [&](double w) {  // too large an error at w
    const double power = std::pow(w, 2 * p);
    double sum = 0;
    for (std::size_t t = 0; t < eta.size(); ++t) {
      const double r = w * factor[t];
      sum += r <= goal.smallest  ? eta[t] * eta[t] * low_power
             : r >= goal.largest ? eta[t] * eta[t] * high_power
                                 : power * weight[t];
    }
    return sum > goal.error * goal.error;
  };
  const auto too_many = [&](double w) {
    double sum = 0;
    for (const double f : factor) {
      const double r = std::clamp(w * f, goal.smallest, goal.largest);
      sum += 1 / (r * r);
    }
    return sum > goal.max_triangles;
  };
  double least = infinity, most = 0;
  for (const double f : factor)
    if (std::isfinite(f)) least = std::min(least, f), most = std::max(most, f);
  if (most > 0) {
    double low = goal.smallest / most, high = goal.largest / least;  // all factors at a bound
    for (int step = 0; step < 60; ++step) {
      const double middle = std::sqrt(low * high);
      (too_large(middle) && !too_many(middle) ? high : low) = middle;
    }
    for (double& f : factor) f *= low;
  }
  for (double& f : factor) f = std::clamp(f, goal.smallest, goal.largest);
  return factor;
}

}  // namespace

std::vector<double> equidistributed_sizes(const Mesh& mesh, std::span<const double> eta, const Goal& goal) {
  check_goal(mesh, eta, goal);
  const std::vector<double> factor = factors(eta, goal);
  std::vector<double> size(mesh.points.size(), infinity);
  for (std::size_t t = 0; t < eta.size(); ++t) {
    // The edge of the equilateral triangle of the same area.
    const double wanted = factor[t] * std::sqrt(4 / std::sqrt(3.0) * area(mesh, Index(t)));
    for (const Index v : mesh.triangles[t]) size[std::size_t(v)] = std::min(size[std::size_t(v)], wanted);
  }
  return size;
}

/// Ties go to the edge of the lower number, so that equal triangles are turned alike on every machine.
Mesh longest_edges_first(Mesh mesh, bool mirrored_tips) {
  const MirrorImages mirror = mirrored_tips ? mirror_at_tips(mesh) : MirrorImages{};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto& edges = mesh.edges_of[t];
    std::size_t longest = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      const double here = length(mesh, edges[i]), best = length(mesh, edges[longest]);
      if (here > best || (here == best && edges[i] < edges[longest])) longest = i;
    }
    // Rounding makes no difference between images: the second one follows the first.
    if (const Index image = mirrored_tips ? mirror.triangle[t] : none; image != none && std::size_t(image) < t)
      longest = std::size_t(std::ranges::find(edges, mirror.edge[std::size_t(mesh.edges_of[std::size_t(image)][0])]) -
                            edges.begin());
    std::rotate(edges.begin(), edges.begin() + Index(longest), edges.end());
    std::rotate(mesh.triangles[t].begin(), mesh.triangles[t].begin() + Index(longest), mesh.triangles[t].end());
  }
  return mesh;
}

/// A triangle with its edge 0 halved becomes two, and each half is halved again if its own outer edge is.
Mesh bisect(const Mesh& mesh, std::span<const Index> marked, bool mirrored_tips) {
  // A triangle with an edge to be halved halves its own edge 0 first. At tips the image of an edge is halved with it.
  const MirrorImages mirror = mirrored_tips ? mirror_at_tips(mesh) : MirrorImages{};
  std::vector<Index> middle(mesh.edges.size(), none);
  std::vector<Index> open(marked.begin(), marked.end());
  const auto halve = [&](Index e) {
    if (e == none || middle[std::size_t(e)] != none) return;
    middle[std::size_t(e)] = 0;
    for (const Index t : mesh.sides[std::size_t(e)])
      if (t != none) open.push_back(t);
  };
  while (!open.empty()) {
    const Index e = mesh.edges_of.at(std::size_t(open.back()))[0];
    open.pop_back();
    halve(e);
    if (mirrored_tips) halve(mirror.edge[std::size_t(e)]);
  }
  std::vector<Vec2> points = mesh.points;
  for (std::size_t e = 0; e < middle.size(); ++e) {
    if (middle[e] == none) continue;
    middle[e] = Index(points.size());
    points.push_back(middle_of(mesh, Index(e)));
  }

  std::vector<std::array<Index, 3>> triangles;
  triangles.reserve(mesh.triangles.size() + 2 * (points.size() - mesh.points.size()));
  // The half with edge 0 from b to c, halved again when that edge is.
  const auto add = [&](Index a, Index b, Index c, Index half) {
    if (half == none) {
      triangles.push_back({a, b, c});
    } else {
      triangles.push_back({half, a, b});
      triangles.push_back({half, c, a});
    }
  };
  std::vector<Index> region;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const auto [bc, ca, ab] = mesh.edges_of[t];
    const Index half = middle[std::size_t(bc)];
    if (half == none) {
      triangles.push_back({a, b, c});
    } else {
      add(half, a, b, middle[std::size_t(ab)]);
      add(half, c, a, middle[std::size_t(ca)]);
    }
    if (!mesh.region.empty()) region.resize(triangles.size(), mesh.region[t]);
  }
  return halved(mesh, middle, std::move(points), std::move(triangles), std::move(region));
}

}  // namespace kerf
