// From the rate of J along the boundary to its speed, and the prices that keep the constraints [theory: L.1, L.2, L.3,
// L.12]. With gamma = -(g + sum mu_k g_k), what the objective falls per area that grows, w half the thickness of the
// member, lambda the price of area:
//   v = 1.1 s w (gamma - lambda)/(|gamma| + |lambda| + 0.1 rms gamma),   |v| <= R.
// In a member that a given force stretches gamma ~ 1/w^2, so that this goes to the fully stressed design. The part of w
// beyond the smoothing length uses gamma without short waves, which change the stress there more than the thickness
// does. A change of J is predicted as the reciprocal of a thickness where gamma > 0 [theory: L.12]. The least mu_k in
// turns, each with the least lambda for it, with which area and bounds keep to their limits are found by bisection. The
// residual of the shape is the smoothed (gamma - lambda)/lambda over what can move [theory: L.10]. Derived in
// docs/theory/level_set.md, sections "Speed of the boundary" and "Optimality".

#include "optimize/level_set/speed.hpp"

#include "kerf/shape_gradient.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// Half the thickness of the member that an edge bounds, along its normal: the distance falls again behind the middle.
/// Depths are doubled until the distance to the boundary falls short of the depth: (inside + depth)/2 is then half of
/// the way through the member.
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

// The rate is over edges without supports and tractions, of any load case.
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
  // Per edge the integral of the density over its length: two Gauss points become one value.
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

constexpr double slow_waves = 4;   // shorter than this many lengths of smoothing they are short
constexpr double eager = 1.1;      // steps against those of the fully stressed design
constexpr double softening = 0.1;  // of the root mean square of the gain: where gain and price vanish together
constexpr int halvings = 40;

double square_mean(const Eigen::VectorXd& v, const Eigen::VectorXd& length) {
  return std::sqrt(v.cwiseAbs2().dot(length) / length.sum());
}

/// The edges, and what moving them would bring.
struct Members {
  const MovingDesign& of;
  const StepLimits& limits;
  Eigen::VectorXd half;     // thickness
  std::vector<bool> rim;    // on the frame: cannot grow
  std::vector<bool> solid;  // cannot shrink
  Eigen::MatrixXd gain;     // edges x (J, bounded functionals): fall per area that grows
  Eigen::MatrixXd calm;     // the same without short waves

  Eigen::VectorXd total(const Eigen::MatrixXd& of_each, const Eigen::VectorXd& multiplier) const {
    return of_each.col(0) + of_each.rightCols(of_each.cols() - 1) * multiplier;
  }
};

// Values per edge go to the points of the curve by the product of (L.4) and come back as means of both ends.
Eigen::VectorXd without_short_waves(const BoundaryRate& rate, double r, const Eigen::VectorXd& values) {
  const Eigen::VectorXd at = smooth_along(rate.curve, rate.length, r, values);
  Eigen::VectorXd calm(values.size());
  for (Eigen::Index i = 0; i < calm.size(); ++i) {
    const auto& [a, b] = rate.curve.edges[static_cast<std::size_t>(i)];
    calm[i] = 0.5 * (at[a] + at[b]);
  }
  return calm;
}

// half is looked for up to what matters: four smoothing lengths, or the smallest feature.
Members members_of(const MovingDesign& of, const StepLimits& limits) {
  const BoundaryRate& rate = of.objective;
  const Eigen::Index n = rate.density.size();
  Members m{.of = of, .limits = limits, .half = Eigen::VectorXd(n), .rim = {}, .solid = {}, .gain = {}, .calm = {}};
  const double slow = slow_waves * limits.smoothing, reach = std::max(slow, limits.min_feature);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    m.half[i] = half_thickness(of.background, of.distance, rate.middle[k], rate.normal[k], reach);
    m.rim.push_back(rate.label[k] < of.free_label);
    m.solid.push_back(of.background.frozen.size() > 0 &&
                      value_at(of.background, of.background.frozen, rate.middle[k]) < 0.5 * of.background.size);
  }
  const auto functionals = static_cast<Eigen::Index>(1 + of.bounded.size());
  m.gain.resize(n, functionals);
  m.calm.resize(n, functionals);
  for (Eigen::Index k = 0; k < functionals; ++k) {
    m.gain.col(k) = -(k == 0 ? rate : of.bounded[static_cast<std::size_t>(k - 1)]).density;
    m.calm.col(k) = without_short_waves(rate, slow, m.gain.col(k));
  }
  return m;
}

/// How far every edge goes at a price of area.
Eigen::VectorXd speed_at(double price, const Eigen::VectorXd& multiplier, const Members& m) {
  const StepLimits& limits = m.limits;
  const Eigen::VectorXd gain = m.total(m.gain, multiplier), calm = m.total(m.calm, multiplier);
  const double soft = softening * square_mean(gain, m.of.objective.length) + 1e-300, fast = limits.smoothing;
  const auto part = [&](double g) { return eager * (g - price) / (std::abs(g) + std::abs(price) + soft); };
  Eigen::VectorXd v(gain.size());
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    v[i] = limits.share * (std::min(m.half[i], fast) * part(gain[i]) + std::max(m.half[i] - fast, 0.0) * part(calm[i]));
    // A member that is too thin: what would it carry at the thickness wanted, for the same force?
    const double least = 0.5 * limits.min_feature;
    if (price > 0 && m.half[i] < least) {
      constexpr double idle = 0.15;  // of the price
      const double thick = gain[i] * (m.half[i] / least) * (m.half[i] / least);
      v[i] = thick > idle * price ? std::max(v[i], least - m.half[i]) : -limits.radius;
    }
    v[i] = std::clamp(v[i], m.solid[k] ? 0 : -limits.radius, m.rim[k] ? 0 : limits.radius);
  }
  return v;
}

/// Change of functional k by a motion. What falls with growing area falls as the reciprocal of a thickness.
double change_of(Eigen::Index k, const Eigen::VectorXd& v, const Members& m) {
  const Eigen::VectorXd& length = m.of.objective.length;
  double change = 0;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    // 0.3 keeps the reciprocal finite for steps through a member.
    const double g = m.gain(i, k), thicker = std::max(1 + v[i] / m.half[i], 0.3);
    change -= length[i] * v[i] * (g > 0 ? g / thicker : g);
  }
  return change;
}

/// The least value from `low` on at which `fits`, which stays true from there on; where none below `most` does, that.
template <typename Fits>
double least_that(double low, double first, double most, const Fits& fits) {
  if (fits(low)) return low;
  double high = std::max(first, 1e-300);
  // Powers of four bracket the value, forty halvings settle it.
  while (high < most && !fits(low + high)) high *= 4;
  if (high >= most) return low + most;
  double below = high / 4 <= first ? 0 : high / 4;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (below + high);
    (fits(low + middle) ? high : below) = middle;
  }
  return low + high;
}

/// The least price at which the area keeps to its limit.
double price_at(const Eigen::VectorXd& multiplier, const Members& m) {
  const StepLimits& limits = m.limits;
  if (!std::isfinite(limits.growth)) return limits.price;
  const double largest = m.total(m.gain, multiplier).cwiseAbs().maxCoeff();
  if (!(largest > 0)) return limits.price;
  return least_that(limits.price, 1e-9 * largest, 1e9 * largest, [&](double price) {
    return speed_at(price, multiplier, m).dot(m.of.objective.length) <= limits.growth;
  });
}

/// The least multipliers with which bounded functionals keep to their limits, one after the other until they stay.
Eigen::VectorXd multipliers_of(const Members& m) {
  constexpr int rounds = 6;
  constexpr double most = 30;  // in units of the derivatives
  const Eigen::Index n = m.gain.cols() - 1;
  Eigen::VectorXd multiplier = Eigen::VectorXd::Zero(n);
  const Eigen::VectorXd& length = m.of.objective.length;
  const double of_objective = std::max(square_mean(m.gain.col(0), length), m.limits.price);
  for (int round = 0; round < (n > 1 ? rounds : 1); ++round)
    for (Eigen::Index k = 0; k < n; ++k) {
      const double of_bound = square_mean(m.gain.col(k + 1), length);
      if (!(of_bound > 0)) continue;
      const double unit = of_objective > 0 ? of_objective / of_bound : 1;
      multiplier[k] = least_that(0, 1e-6 * unit, most * unit, [&](double value) {
        Eigen::VectorXd tried = multiplier;
        tried[k] = value;
        return change_of(k + 1, speed_at(price_at(tried, m), tried, m), m) <=
               m.limits.room[static_cast<std::size_t>(k)];
      });
    }
  return multiplier;
}

/// Root mean square along what can move of (gain - price)/price without its short waves [theory: L.10].
/// int of the square of a linear function with the ends a, b over an edge: length (a^2 + a b + b^2)/3.
double shape_residual(const Eigen::VectorXd& gain, double price, const Members& m) {
  const BoundaryRate& rate = m.of.objective;
  // Without a price nothing but a vanishing gain is optimal.
  const double unit = price > 0 ? price : square_mean(gain, rate.length);
  if (!(unit > 0)) return 0;
  Eigen::VectorXd r = (gain.array() - price) / unit;
  std::vector<bool> blocked;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    blocked.push_back(r[i] > 0 ? m.rim[k] : m.solid[k]);
    if (blocked.back()) r[i] = 0;
  }
  const Eigen::VectorXd smooth = smooth_along(rate.curve, rate.length, m.limits.smoothing, r);
  double sum = 0, length = 0;
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    if (blocked[static_cast<std::size_t>(i)]) continue;
    const auto& [a, b] = rate.curve.edges[static_cast<std::size_t>(i)];
    sum += rate.length[i] * (smooth[a] * smooth[a] + smooth[a] * smooth[b] + smooth[b] * smooth[b]) / 3;
    length += rate.length[i];
  }
  return length > 0 ? std::sqrt(sum / length) : 0;
}

}  // namespace

double shape_residual(const MovingDesign& of, const StepLimits& limits) {
  if (of.objective.density.size() == 0) return 0;
  const Members m = members_of(of, limits);
  const Eigen::VectorXd multiplier = multipliers_of(m);
  return shape_residual(m.total(m.gain, multiplier), price_at(multiplier, m), m);
}

// Predictions are of the smoothed speed, which is what the boundary does.
BoundaryStep constrained_step(const MovingDesign& of, const StepLimits& limits, const ElasticProduct* elastic) {
  const BoundaryRate& rate = of.objective;
  BoundaryStep s{.price = limits.price, .multiplier = std::vector<double>(of.bounded.size(), 0), .bounded = {}};
  s.bounded = s.multiplier;
  s.on_background = Eigen::VectorXd::Zero(of.distance.size());
  if (rate.density.size() == 0) return s;
  const Members m = members_of(of, limits);
  const Eigen::VectorXd multiplier = multipliers_of(m);
  s.price = price_at(multiplier, m);
  s.multiplier.assign(multiplier.begin(), multiplier.end());
  s.residual = shape_residual(m.total(m.gain, multiplier), s.price, m);
  // The speed is smoothed once more as a gradient in the product of the boundary; what must not move is set to 0
  // afterwards.
  const Eigen::VectorXd moved =
      smooth_along(rate.curve, rate.length, limits.smoothing, speed_at(s.price, multiplier, m));
  Eigen::VectorXd v(rate.density.size());
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    const auto& [a, b] = rate.curve.edges[static_cast<std::size_t>(i)];
    const auto k = static_cast<std::size_t>(i);
    v[i] = 0.5 * (moved[a] + moved[b]);
    if (v[i] > 0 ? m.rim[k] : m.solid[k]) v[i] = 0;
  }
  s.objective = change_of(0, v, m);
  s.area = v.dot(rate.length);
  for (std::size_t k = 0; k < of.bounded.size(); ++k) s.bounded[k] = change_of(static_cast<Eigen::Index>(k) + 1, v, m);
  s.on_background = elastic ? elastic->extend(of.background, rate.curve, moved, of.distance)
                            : extend(of.background, rate.curve.points, moved);
  return s;
}

}  // namespace kerf
