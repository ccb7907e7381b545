#include "optimize/level_set/speed.hpp"

#include "kerf/shape_gradient.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double slow_waves = 4;  // shorter than this many lengths of smoothing they are short

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
    r.label.push_back(label);
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

namespace {

/// What the speed of an edge is made of, per edge.
struct Members {
  Eigen::VectorXd gain;  // of J, per area taken away
  Eigen::VectorXd half;  // thickness
  Eigen::VectorXd root;  // of the gain, where it is one
  Eigen::VectorXd calm;  // the same without short waves
  double scale = 0;      // root mean square of the gain
};

Members members_of(const BackgroundMesh& background, const Eigen::VectorXd& distance, const BoundaryRate& rate,
                   const SpeedLimits& limits) {
  const Eigen::Index n = rate.density.size();
  Members m{.gain = -rate.density, .half = Eigen::VectorXd(n), .calm = Eigen::VectorXd(n)};
  const double slow = slow_waves * limits.smoothing, reach = std::max(slow, limits.min_feature);
  for (Eigen::Index i = 0; i < n; ++i)
    m.half[i] = half_thickness(background, distance, rate.middle[static_cast<std::size_t>(i)],
                               rate.normal[static_cast<std::size_t>(i)], reach);
  m.scale = std::sqrt(m.gain.cwiseAbs2().dot(rate.length) / rate.length.sum());
  m.root = m.gain.cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd calm_at = smooth_along(rate.curve, rate.length, slow, m.root);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [a, b] = rate.curve.edges[static_cast<std::size_t>(i)];
    m.calm[i] = 0.5 * (calm_at[a] + calm_at[b]);
  }
  return m;
}

/// The speed of every edge at a price of area. Short waves of a thick member's boundary change the stress there far
/// more than its thickness does: they may go as far as the smoothing, only long ones as far as the thickness.
Eigen::VectorXd speed_at(double price, const Members& m, const SpeedLimits& limits) {
  const double fast = limits.smoothing;
  Eigen::VectorXd v(m.gain.size());
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    if (price > 0)
      v[i] = limits.share * (std::min(m.half[i], fast) * (m.root[i] / std::sqrt(price) - 1) +
                             std::max(m.half[i] - fast, 0.0) * (m.calm[i] / std::sqrt(price) - 1));
    else
      v[i] = m.scale > 0 ? limits.most * (m.gain[i] - price) / m.scale : 0;
    // A member that is too thin: what would it carry at the thickness wanted, for the same force?
    const double least = 0.5 * limits.min_feature;
    if (price > 0 && m.half[i] < least) {
      constexpr double idle = 0.15;  // of the multiplier
      const double thick = m.gain[i] * (m.half[i] / least) * (m.half[i] / least);
      v[i] = thick > idle * price ? std::max(v[i], least - m.half[i]) : -limits.most;
    }
    v[i] = std::clamp(v[i], -limits.most, limits.most);
  }
  return v;
}

/// The price at which the area does not change; 0 where it always falls.
double balancing_price(const Members& m, const BoundaryRate& rate, const SpeedLimits& limits) {
  double price = 0;
  if (!(m.gain.maxCoeff() > 0)) return price;
  double low = 1e-12 * m.gain.maxCoeff(), high = m.gain.maxCoeff();
  const auto grows = [&](double p) { return speed_at(p, m, limits).dot(rate.length) > 0; };
  if (!grows(low)) return price;
  for (int i = 0; i < 60; ++i) {
    price = std::sqrt(low * high);
    (grows(price) ? low : high) = price;
  }
  return price;
}

/// Root mean square along what can move of (gain - price)/price without its short waves [theory: L.10]. What would grow
/// out of the frame, and what would take from parts that stay solid, cannot move.
double shape_residual(const SpeedOf& of, double price, double smoothing) {
  const auto& [background, distance, rate, free_label] = of;
  const Eigen::Index n = rate.density.size();
  const double gain = std::sqrt(rate.density.cwiseAbs2().dot(rate.length) / rate.length.sum());
  const double unit = price > 0 ? price : gain;  // without a price nothing but a vanishing gain is optimal
  if (!(unit > 0)) return 0;
  Eigen::VectorXd r(n);
  std::vector<bool> blocked(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    r[i] = (-rate.density[i] - price) / unit;
    const bool solid =
        background.frozen.size() > 0 && value_at(background, background.frozen, rate.middle[k]) < 0.5 * background.size;
    blocked[k] = r[i] > 0 ? rate.label[k] < free_label : solid;
    if (blocked[k]) r[i] = 0;
  }
  const Eigen::VectorXd smooth = smooth_along(rate.curve, rate.length, smoothing, r);
  double sum = 0, length = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [a, b] = rate.curve.edges[static_cast<std::size_t>(i)];
    if (blocked[static_cast<std::size_t>(i)]) continue;
    sum += rate.length[i] * (smooth[a] * smooth[a] + smooth[a] * smooth[b] + smooth[b] * smooth[b]) / 3;
    length += rate.length[i];
  }
  return length > 0 ? std::sqrt(sum / length) : 0;
}

}  // namespace

Speed boundary_speed(const SpeedOf& of, const SpeedLimits& limits, const ElasticProduct* elastic,
                     std::optional<double> multiplier) {
  const auto& [background, distance, rate, free_label] = of;
  const Eigen::Index n = rate.density.size();
  Speed s;
  s.on_background = Eigen::VectorXd::Zero(distance.size());
  if (n == 0) return s;
  const Members m = members_of(background, distance, rate, limits);
  s.multiplier = multiplier ? *multiplier : balancing_price(m, rate, limits);
  s.on_curve = speed_at(s.multiplier, m, limits);
  s.optimality = shape_residual(of, s.multiplier, limits.smoothing);
  const Eigen::VectorXd moved = smooth_along(rate.curve, rate.length, limits.smoothing, s.on_curve);
  s.on_background =
      elastic ? elastic->extend(background, rate.curve, moved, distance) : extend(background, rate.curve.points, moved);
  return s;
}

}  // namespace kerf
