#include "optimize/level_set/speed.hpp"

#include "kerf/shape_gradient.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// Half the thickness of the member that an edge bounds, along its normal: the distance falls again behind the middle.
double half_thickness(const BackgroundMesh& background, const Eigen::VectorXd& distance, const Vec2& x,
                      const Vec2& normal, double most) {
  for (double depth = 0.5 * background.size;; depth *= 2) {
    depth = std::min(depth, most);
    const double inside = -value_at(background, distance, x - depth * normal);
    if (inside < 0.6 * depth) return std::max(0.5 * (inside + depth), 0.25 * background.size);
    if (depth >= most) return most;
  }
}

}  // namespace

BoundaryRate boundary_rate(const Evaluated& e, std::span<const WeightedAnalysis> analyses) {
  const Model& m = e.cases.front().model;
  const Index edges = static_cast<Index>(m.mesh.edges.size());
  std::vector<double> rate(static_cast<std::size_t>(edges), 0);
  for (std::size_t i = 0; i < analyses.size(); ++i) {
    const Functional& j = *analyses[i].functional;
    for (const BoundaryGradient::Point& p : boundary_gradient(analyses[i].analysis, j).points)
      rate[static_cast<std::size_t>(p.edge)] += analyses[i].weight * p.weight * p.density;
  }
  BoundaryRate r;
  std::vector<Index> number(m.mesh.points.size(), none);
  std::vector<double> density;
  for (Index edge = 0; edge < edges; ++edge) {
    const auto& [left, right] = m.mesh.sides[static_cast<std::size_t>(edge)];
    if (left != none && right != none) continue;
    const Index label = m.mesh.label[static_cast<std::size_t>(edge)];
    const auto on_label = [label](const auto& condition) { return condition.label == label; };
    const bool held = std::any_of(e.cases.begin(), e.cases.end(), [&](const SolvedCase& c) {
      const Scene& scene = c.model.scene;
      return std::any_of(scene.supports.begin(), scene.supports.end(), on_label) ||
             std::any_of(scene.tractions.begin(), scene.tractions.end(), on_label);
    });
    if (held) continue;
    std::array<Index, 2> ends;
    for (std::size_t i = 0; i < 2; ++i) {
      const Index v = m.mesh.edges[static_cast<std::size_t>(edge)][i];
      Index& k = number[static_cast<std::size_t>(v)];
      if (k == none) {
        k = static_cast<Index>(r.curve.points.size());
        r.curve.points.push_back(m.mesh.points[static_cast<std::size_t>(v)]);
      }
      ends[i] = k;
    }
    r.curve.edges.push_back(ends);
    const Vec2 &a = r.curve.points[static_cast<std::size_t>(ends[0])],
               &b = r.curve.points[static_cast<std::size_t>(ends[1])];
    r.middle.push_back(0.5 * (a + b));
    r.normal.push_back(outward_normal(m.mesh, edge));
    density.push_back(rate[static_cast<std::size_t>(edge)] / (b - a).norm());
  }
  const Eigen::Index n = static_cast<Eigen::Index>(density.size());
  r.density = Eigen::Map<const Eigen::VectorXd>(density.data(), n);
  r.length.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [a, b] = r.curve.edges[static_cast<std::size_t>(i)];
    r.length[i] = (r.curve.points[static_cast<std::size_t>(a)] - r.curve.points[static_cast<std::size_t>(b)]).norm();
  }
  return r;
}

void add(BoundaryRate& a, double factor, const BoundaryRate& b) {
  a.density += factor * b.density;
}

Speed boundary_speed(const BackgroundMesh& background, const Eigen::VectorXd& distance, const BoundaryRate& rate,
                     const SpeedLimits& limits, const ElasticProduct* elastic, std::optional<double> multiplier) {
  const Eigen::Index n = rate.density.size();
  Speed s;
  s.on_background = Eigen::VectorXd::Zero(distance.size());
  if (n == 0) return s;
  const Eigen::VectorXd gain = -rate.density;
  Eigen::VectorXd half(n);
  const double fast = limits.smoothing, slow = 4 * limits.smoothing;
  const double reach = std::max(slow, limits.min_feature);
  for (Eigen::Index i = 0; i < n; ++i)
    half[i] = half_thickness(background, distance, rate.middle[static_cast<std::size_t>(i)],
                             rate.normal[static_cast<std::size_t>(i)], reach);
  const double scale = std::sqrt(gain.cwiseAbs2().dot(rate.length) / rate.length.sum());
  // Short waves of a thick member's boundary change the stress there far more than its thickness does: they may go as
  // far as the smoothing, only long ones as far as the thickness.
  const Eigen::VectorXd root = gain.cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd calm_at = smooth_along(rate.curve, rate.length, slow, root);
  Eigen::VectorXd calm(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [a, b] = rate.curve.edges[static_cast<std::size_t>(i)];
    calm[i] = 0.5 * (calm_at[a] + calm_at[b]);
  }
  const auto speed = [&](double price) {
    Eigen::VectorXd v(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (price > 0)
        v[i] = limits.share * (std::min(half[i], fast) * (root[i] / std::sqrt(price) - 1) +
                               std::max(half[i] - fast, 0.0) * (calm[i] / std::sqrt(price) - 1));
      else
        v[i] = scale > 0 ? limits.most * (gain[i] - price) / scale : 0;
      // A member that is too thin: what would it carry at the thickness wanted, for the same force?
      const double least = 0.5 * limits.min_feature;
      if (price > 0 && half[i] < least) {
        constexpr double idle = 0.15;  // of the multiplier
        const double thick = gain[i] * (half[i] / least) * (half[i] / least);
        v[i] = thick > idle * price ? std::max(v[i], least - half[i]) : -limits.most;
      }
      v[i] = std::clamp(v[i], -limits.most, limits.most);
    }
    return v;
  };
  if (multiplier) {
    s.multiplier = *multiplier;
  } else if (gain.maxCoeff() > 0) {
    double low = 1e-12 * gain.maxCoeff(), high = gain.maxCoeff();
    if (speed(low).dot(rate.length) > 0) {
      for (int i = 0; i < 60; ++i) {
        s.multiplier = std::sqrt(low * high);
        (speed(s.multiplier).dot(rate.length) > 0 ? low : high) = s.multiplier;
      }
    }
  }
  s.on_curve = speed(s.multiplier);
  s.optimality = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double size = std::abs(gain[i]) + std::abs(s.multiplier);
    if (size > 0) s.optimality += rate.length[i] * std::abs(gain[i] - s.multiplier) / size;
  }
  s.optimality /= rate.length.sum();
  const Eigen::VectorXd moved = smooth_along(rate.curve, rate.length, limits.smoothing, s.on_curve);
  s.on_background =
      elastic ? elastic->extend(background, rate.curve, moved, distance) : extend(background, rate.curve.points, moved);
  return s;
}

}  // namespace kerf
