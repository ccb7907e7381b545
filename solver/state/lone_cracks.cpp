// A first set for contact on many cracks: each crack alone in an infinite body, under the tensions t that the body
// without cracks has where it lies. With constant openings w_j on 48 equal parts, up to a factor,
//   A w - t = p,   A_ij = 1/(i - j + 1/2) - 1/(i - j - 1/2),   w, p >= 0,   w.p = 0   [theory: C.36],
// the pressures at the middles of the parts of dislocations at their ends. A is positive on the diagonal alone, so that
// exchanging all wrong parts settles at once. Straight cracks without friction, gap and fluid; others begin closed. For
// bodies whose coarser meshes are not much smaller, because every tip needs short edges. Derived in
// docs/theory/contact.md, section Large contact.

#include "solver/lone_cracks.hpp"

#include "base/dense.hpp"
#include "kerf/mesher.hpp"
#include "kerf/state.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

constexpr Index parts = 48;  // of each crack

/// The pressures at the middles of equal parts of a straight crack in an infinite body for constant openings of these,
/// up to a factor.
Eigen::MatrixXd pressures_of_openings() {
  Eigen::MatrixXd A(parts, parts);
  for (Index i = 0; i < parts; ++i)
    for (Index j = 0; j < parts; ++j) A(i, j) = 1 / (i - j + 0.5) - 1 / (i - j - 0.5);
  return A;
}

/// Which parts open under the tensions of the body without the crack. All off the diagonal of A is negative, so that
/// exchanges settle at once.
std::vector<bool> opened(const Eigen::MatrixXd& A, const Eigen::VectorXd& tension) {
  std::vector<bool> open(parts);
  for (Index i = 0; i < parts; ++i) open[i] = tension[i] > 0;
  for (Index step = 0; step < parts; ++step) {
    std::vector<Index> moving;
    for (Index i = 0; i < parts; ++i)
      if (open[i]) moving.push_back(i);
    Eigen::VectorXd opening = Eigen::VectorXd::Zero(parts);
    if (!moving.empty()) {
      const Eigen::VectorXd load = tension(moving), moved = solve_lu(A(moving, moving), load);
      opening(moving) = moved;
    }
    const Eigen::VectorXd pressure = multiply(A, opening) - tension;
    std::vector<bool> next(parts);
    for (Index i = 0; i < parts; ++i) next[i] = open[i] ? opening[i] > 0 : pressure[i] < 0;
    if (next == open) break;
    open = std::move(next);
  }
  return open;
}

/// A point of a path and the direction there.
struct Station {
  Vec2 at, along;
};
/// By the share of the length of the path; a path with kinks is taken as if it were straight.
Station station(const std::vector<Vec2>& path, double share) {
  double whole = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) whole += (path[i + 1] - path[i]).norm();
  double left = share * whole;
  std::size_t i = 0;
  for (; i + 2 < path.size() && left > (path[i + 1] - path[i]).norm(); ++i) left -= (path[i + 1] - path[i]).norm();
  const Vec2 along = (path[i + 1] - path[i]).normalized();
  return {path[i] + left * along, along};
}

bool is_plain(const CrackLaw& law) {
  return is_unilateral(law) && !has_friction(law) && !has_gap(law) && !has_pressure(law);
}

}  // namespace

/// A station that lies in no triangle has no tension: its part begins closed.
ContactGuess lone_cracks_guess(const Shape& shape, const Element& e, const Scene& scene, double size, int threads) {
  Shape bare = shape;
  bare.cracks.clear();
  Scene loads = scene;
  loads.laws.clear();
  std::vector<Station> stations;
  std::vector<Index> cracks;
  for (Index c = 0; c < static_cast<Index>(shape.cracks.size()); ++c) {
    if (!is_plain(scene.laws[c]) || shape.cracks[c].arc) continue;
    cracks.push_back(c);
    for (Index i = 0; i < parts; ++i) stations.push_back(station(shape.cracks[c].points, (i + 0.5) / parts));
  }
  const Model m = prepare(triangulate(bare, {.size = size, .crack_tip_size = size}), e, std::move(loads), threads);
  const State state = solve(m);
  std::vector<Vec2> points;
  for (const Station& s : stations) points.push_back(s.at);
  const std::vector<Index> in = locate(m.mesh, points);
  const Eigen::MatrixXd A = pressures_of_openings();
  ContactGuess guess(shape.cracks.size());
  for (std::size_t k = 0; k < cracks.size(); ++k) {
    Eigen::VectorXd tension = Eigen::VectorXd::Zero(parts);
    for (Index i = 0; i < parts; ++i) {
      const std::size_t at = k * parts + static_cast<std::size_t>(i);
      if (in[at] == none) continue;
      const Eigen::Vector4d s = evaluate(m, state, in[at], stations[at].at).stress.col(0);
      const Vec2 n(-stations[at].along.y(), stations[at].along.x());
      tension[i] = s[0] * n.x() * n.x() + (s[1] + s[2]) * n.x() * n.y() + s[3] * n.y() * n.y();
    }
    const std::vector<bool> open = opened(A, tension);
    for (Index i = 0; i < parts; ++i)
      if (i == 0 || open[i] != open[i - 1])
        guess[cracks[k]].push_back({.from = static_cast<double>(i) / parts, .open = open[i]});
  }
  return guess;
}

}  // namespace kerf
