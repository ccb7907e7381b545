// The regular part Hreg(x) of the Green tensor over a body from at most 400 solves [theory: T.31, T.32]. Towards a side
// Hreg grows like the logarithm of the distance, with one coefficient per direction that the half plane tells: a
// support, a roller, a free side, a closed crack. The sum over kinds of walls of
//   ln(delta) (times_1 a a' + times_2 b b'),   delta = (1/2 int ds/|x - y|^3 over the walls of that kind)^(-1/2),
// a and b the axes of the walls' frames, is taken out of the samples: delta is the distance beside a straight side and
// smooth inside. The rest is interpolated by moving least squares with cubics over the nearest samples that no wall
// hides. Each next sample is the candidate farthest from all samples in units of its distance to tips and corners, or
// of three times that to the sides, beside which the rest is smooth. Sampling ends where the next batch is predicted
// well enough for M^-1 Hreg, M of (T.29). Derived in docs/theory/topological_derivatives.md, section "Clamped holes".

#include "topo/map/green_samples.hpp"
#include "solver/system.hpp"

#include "geometry/plane.hpp"
#include "kerf/recover.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kerf {

namespace {

double inverse_cubes_of_wall(const Wall& w, const Vec2& x) {
  return kerf::inverse_cubes(w.a, w.b, x);
}

// 2/d^2 on a straight side, d the distance.
double wall_distance(double cubes) {
  return std::sqrt(2 / cubes);
}
double wall_distance(const std::vector<std::vector<Wall>>& walls, const Vec2& x) {
  double sum = 0;
  for (const auto& alike : walls)
    for (const Wall& w : alike) sum += inverse_cubes_of_wall(w, x);
  return wall_distance(sum);
}

// Half planes under a unit force at the distance d, G + w at the force: an image for supports and rollers; the force's
// logarithm at infinity for a free side; closed faces are a roller for even fields and free for odd ones.
struct Coefficients {
  double fixed, roller, free, closed_across, closed_along;
};
Coefficients coefficients(const Material& m) {
  const double k = kolosov(m), f = flexibility(m);
  return {f * k, -f * k, -0.5 * f * (k * k + 1), -0.25 * f * (k - 1) * (k - 1), -0.25 * f * (k + 1) * (k + 1)};
}

// Edges of the boundary and of cracks that may move, grouped by their coefficients. On a support the frame of the edge
// tells which component is held; an edge with one held component is a roller along the other.
std::vector<std::vector<Wall>> find_walls(const Model& m, const Field& s, const Coefficients& c) {
  std::vector<std::vector<Wall>> walls;
  const auto add = [&](const Wall& w) {
    for (auto& alike : walls)
      if (alike.front().times == w.times) {
        alike.push_back(w);
        return;
      }
    walls.push_back({w});
  };
  const std::vector<bool> closed = tied(contact_status(m, s));
  const Index leading = m.inner->ordering.leading();
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    const Vec2& a = m.mesh.points[m.mesh.edges[e][0]];
    const Vec2& b = m.mesh.points[m.mesh.edges[e][1]];
    const Mat2& axes = m.inner->skeleton.frame[e];
    if (m.mesh.sides[e][0] == none || m.mesh.sides[e][1] == none) {
      const Index first = edge_unknown(m.inner->skeleton, e);
      const bool held[2] = {m.inner->skeleton.fixed[first], m.inner->skeleton.fixed[first + 1]};
      const double other = held[0] || held[1] ? c.roller : c.free;
      add({a, b, axes, {held[0] ? c.fixed : other, held[1] ? c.fixed : other}});
    } else if (m.mesh.crack[e] != none && m.scene.laws[m.mesh.crack[e]].kind != CrackLaw::Kind::Bonded) {
      // `shut` counts normal rows that are tied. per_edge/2 points lie on an edge: closed where more than half of them
      // are.
      int shut = 0;
      for (int k = 0; k < m.inner->skeleton.per_edge; k += 2) {
        const Index row = m.inner->ordering.row[m.inner->skeleton.jump[e] + k];
        if (row >= leading && closed[static_cast<std::size_t>(row - leading)]) ++shut;
      }
      add({a, b, axes,
           4 * shut > m.inner->skeleton.per_edge ? Vec2(c.closed_across, c.closed_along) : Vec2(c.free, c.free)});
    }
  }
  return walls;
}

bool crosses(const std::pair<Vec2, Vec2>& wall, const Vec2& a, const Vec2& b) {
  return cross_inside(a, b, wall.first, wall.second);
}

// Where the body's scale is a point: tips, corners, ends of supports.
std::vector<Vec2> find_points(const std::vector<std::vector<Wall>>& walls) {
  struct Ray {
    Vec2 end, along;  // away from it
    std::size_t kind;
  };
  std::vector<Ray> rays;
  for (std::size_t kind = 0; kind < walls.size(); ++kind)
    for (const Wall& w : walls[kind]) {
      const Vec2 along = (w.b - w.a).normalized();
      rays.push_back({w.a, along, kind});
      rays.push_back({w.b, -along, kind});
    }
  const auto less = [](const Ray& p, const Ray& q) {
    return std::pair(p.end.x(), p.end.y()) < std::pair(q.end.x(), q.end.y());
  };
  std::sort(rays.begin(), rays.end(), less);
  std::vector<Vec2> points;
  constexpr double straight = -0.94;  // 20 degrees
  for (std::size_t i = 0, next; i < rays.size(); i = next) {
    next = i + 1;
    while (next < rays.size() && !less(rays[i], rays[next])) ++next;
    const bool goes_on =
        next == i + 2 && rays[i].kind == rays[i + 1].kind && rays[i].along.dot(rays[i + 1].along) < straight;
    if (!goes_on) points.push_back(rays[i].end);
  }
  return points;
}

}  // namespace

// sum over kinds of ln(delta) (t_2 I + (t_1 - t_2) <a a'>).
Mat2 wall_logarithms(const std::vector<std::vector<Wall>>& walls, const Vec2& x) {
  // The direction of a group of walls is the mean of a a' with the weights of delta: sharp beside a side, isotropic far
  // away.
  Mat2 sum = Mat2::Zero();
  for (const auto& alike : walls) {
    Mat2 first = Mat2::Zero();
    double cubes = 0;
    for (const Wall& w : alike) {
      const double share = inverse_cubes_of_wall(w, x);
      cubes += share;
      first += share * w.axes.col(0) * w.axes.col(0).transpose();
    }
    const Vec2& times = alike.front().times;
    sum += std::log(wall_distance(cubes)) * (times[1] * Mat2::Identity() + (times[0] - times[1]) * first / cubes);
  }
  return sum;
}

GreenSamples sample_green(const Model& m, const Field& s, double eps, std::span<const Vec2> candidates,
                          std::span<const Index> in) {
  GreenSamples g;
  if (candidates.empty()) return g;
  const Material& material = m.scene.material;
  g.walls = find_walls(m, s, coefficients(material));
  for (const auto& alike : g.walls)
    for (const Wall& w : alike) g.barriers.emplace_back(w.a, w.b);
  GreenTensor tensor(m, s);
  std::vector<double> scale(candidates.size()), wide(candidates.size(), infinity);
  // Along straight walls the rest is as smooth as elsewhere.
  const std::vector<Vec2> points = find_points(g.walls);
  constexpr double beside_walls = 3;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    scale[i] = beside_walls * wall_distance(g.walls, candidates[i]);
    for (const Vec2& p : points) scale[i] = std::min(scale[i], (candidates[i] - p).norm());
  }
  // `accurate` is of M^-1 Hreg, which has no unit. The first 60 samples are not predicted; 400 bound the cost.
  constexpr double accurate = 5e-4, residual = 1e-7;
  constexpr std::size_t most = 400, batch = 20, least = 60;
  bool covered = false;
  while (g.x.size() < most && !covered) {
    const std::size_t first = g.x.size(), end = first < least ? least : first + batch;
    // Where the next ones go does not depend on what those before them say.
    std::vector<Vec2> x;
    std::vector<Index> at;
    while (first + x.size() < end) {
      const std::size_t next = static_cast<std::size_t>(std::max_element(wide.begin(), wide.end()) - wide.begin());
      covered = wide[next] == 0;
      if (covered) break;
      x.push_back(candidates[next]);
      at.push_back(in[next]);
      for (std::size_t i = 0; i < candidates.size(); ++i)
        wide[i] = std::min(wide[i], (candidates[i] - x.back()).norm() / scale[i]);
    }
    const std::vector<Mat2> exact = tensor.regular_at(x, at, residual);
    double worst = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Mat2 matrix = clamped_matrix(material, eps, exact[k]);
      if (first >= least && admits_clamp(matrix))
        worst = std::max(worst, (matrix.inverse() * (exact[k] - interpolate(g, x[k]))).norm());
      g.x.push_back(x[k]);
      g.rest.push_back(exact[k] - wall_logarithms(g.walls, x[k]));
    }
    if (covered || first < least) continue;
    g.error = worst;
    if (g.error < accurate) break;
  }
  return g;
}

// int ds/r^3 = (s2/r2 - s1/r1)/away^2. Beside the segment's line that is 0/0: where the foot lies outside the segment,
// the form with the difference of squares does not cancel.
double inverse_cubes(const Vec2& a, const Vec2& b, const Vec2& x) {
  const Vec2 along = (b - a).normalized(), from = a - x, to = b - x;
  const double s1 = along.dot(from), s2 = along.dot(to), r1 = from.norm(), r2 = to.norm();
  if (s1 * s2 > 0) return (s2 * s2 - s1 * s1) / (r1 * r1 * r2 * r2 * (s2 / r2 + s1 / r1));
  const double away = cross(along, from);
  return (s2 / r2 - s1 / r1) / (away * away);
}

Eigen::RowVectorXd interpolate_rows(const std::vector<Vec2>& samples,
                                    const std::vector<std::pair<Vec2, Vec2>>& barriers,
                                    const std::function<Eigen::RowVectorXd(std::size_t)>& values_of, const Vec2& x) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < samples.size(); ++i) near.emplace_back((samples[i] - x).squaredNorm(), i);
  // 28 samples in sight for 10 coefficients; fewer in sight lower the degree.
  constexpr std::size_t many = 28, looked_at = 64;
  const std::size_t looked = std::min(looked_at, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(looked), near.end());
  std::vector<std::pair<double, std::size_t>> seen;
  for (std::size_t k = 0; k < looked && seen.size() < many; ++k)
    if (std::none_of(barriers.begin(), barriers.end(),
                     [&](const auto& wall) { return crosses(wall, x, samples[near[k].second]); }))
      seen.push_back(near[k]);
  if (seen.empty()) seen.push_back(near.front());
  const Eigen::Index n = static_cast<Eigen::Index>(seen.size());
  // Cubics, parabolas, planes or a constant.
  const Eigen::Index terms = n >= 18 ? 10 : n >= 9 ? 6 : n >= 4 ? 3 : 1;
  const double reach = 1.2 * std::sqrt(seen.back().first) + std::numeric_limits<double>::min();
  Eigen::MatrixXd rows(n, terms);
  Eigen::MatrixXd values(n, values_of(0).size());
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [square, k] = seen[static_cast<std::size_t>(i)];
    const Vec2 d = (samples[k] - x) / reach;
    const double r2 = d.squaredNorm();
    // The weight nearly interpolates: it is largest, 1/sqrt(sharp), at the sample itself, and 0 at the reach.
    constexpr double sharp = 1e-4;
    const double weight = (1 - r2) / std::sqrt(r2 + sharp);
    Eigen::Matrix<double, 10, 1> p;
    p << 1, d.x(), d.y(), d.x() * d.x(), d.x() * d.y(), d.y() * d.y(), d.x() * d.x() * d.x(), d.x() * d.x() * d.y(),
        d.x() * d.y() * d.y(), d.y() * d.y() * d.y();
    rows.row(i) = weight * p.head(terms).transpose();
    values.row(i) = weight * values_of(k);
  }
  // The value at x is the constant of the polynomial about x.
  return rows.colPivHouseholderQr().solve(values).row(0);
}

Mat2 interpolate(const GreenSamples& g, const Vec2& x) {
  const auto value = [&](std::size_t k) -> Eigen::RowVectorXd {
    return Eigen::RowVector3d(g.rest[k](0, 0), g.rest[k](1, 1), 0.5 * (g.rest[k](0, 1) + g.rest[k](1, 0)));
  };
  const Eigen::RowVector3d v = interpolate_rows(g.x, g.barriers, value, x);
  return wall_logarithms(g.walls, x) + (Mat2() << v[0], v[2], v[2], v[1]).finished();
}

}  // namespace kerf
