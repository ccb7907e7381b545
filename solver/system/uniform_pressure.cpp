// Uniform pressures, one per connected piece of a material. With x_k the response to theta = a on piece k,
//   mean_T(tr s(x_k)) = t_m . x_k/|T| + theta by_theta,
//   S_lk = sum over T in piece l of |T| (a [T in k] - a mean_T(tr s(x_k))),   S delta = sums of |T| (theta' - theta)
// [theory: E.23], theta' = a mean(tr s) of what there is. The same for a body of one process and for one in parts: sums
// run over own triangles, then over processes. Derived in docs/theory/elements.md, section Nearly incompressible.

#include "solver/system/uniform_pressure.hpp"

#include "base/dense.hpp"
#include "solver/state/solve.hpp"
#include "solver/system/penalty.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

// Pieces are connected across edges, cracks included.
std::vector<Index> material_pieces(const Mesh& mesh, const Scene& scene, Index most) {
  const Index triangles = static_cast<Index>(mesh.triangles.size());
  std::vector<Index> piece(static_cast<std::size_t>(triangles), scene.regions.empty() ? 0 : none);
  Index count = 0;
  std::vector<Index> waiting;
  for (Index first = 0; first < triangles; ++first) {
    if (piece[first] != none) continue;
    const Index number = std::min(count++, most - 1);
    piece[first] = number;
    waiting.assign(1, first);
    while (!waiting.empty()) {
      const Index t = waiting.back();
      waiting.pop_back();
      for (const Index e : mesh.edges_of[t])
        for (const Index next : mesh.sides[e])
          if (next != none && piece[next] == none && region_of(mesh, next) == region_of(mesh, t)) {
            piece[next] = number;
            waiting.push_back(next);
          }
    }
  }
  return piece;
}

Eigen::VectorXd UniformPressure::over_pieces(const PressedBody& body, const Eigen::VectorXd& values) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(size_.size());
  for (Index t = 0; t < own_triangles(body.model); ++t) sum[piece_[t]] += cell_area(body.model, t) * values[t];
  body.over_all.add({sum.data(), static_cast<std::size_t>(sum.size())});
  return sum;
}

void UniformPressure::prepare(const PressedBody& body) {
  const Model& m = body.model;
  constexpr Index most_pieces = 200;  // each costs a solve
  if (piece_.empty()) piece_ = material_pieces(m.mesh, m.scene, most_pieces);
  const auto triangles = static_cast<Index>(piece_.size());
  const Eigen::MatrixXd& traces = m.inner->system.traces;
  const Eigen::Index rows = traces.rows() - 2;
  double last = *std::ranges::max_element(piece_);
  body.over_all.most({&last, 1});
  const auto count = static_cast<Eigen::Index>(last) + 1;
  stiffness_.resize(count, count);
  size_.setZero(count);
  for (Index k = 0; k < static_cast<Index>(count); ++k) {
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(triangles), left(triangles);
    for (Index t = 0; t < triangles; ++t)
      if (piece_[t] == k) theta[t] = penalty_at(m, t);
    const Eigen::VectorXd x = body.respond(theta), skeleton = body.skeleton(x);
    ++solves_;
    for (Index t = 0; t < triangles; ++t) {
      const auto column = traces.col(t);
      const double a = penalty_at(m, t),
                   mean = column.head(rows).dot(trace_seen(m.mesh, m.inner->skeleton, skeleton, t)) / cell_area(m, t);
      left[t] = a * ((piece_[t] == k ? 1 - a * column[rows + 1] : 0) - mean);
    }
    stiffness_.col(k) = over_pieces(body, left);
    size_[k] = over_pieces(body, theta)[k];
    if (k == 0) response_.resize(x.size(), count);
    response_.col(k) = x;
  }
  if (body.symmetric) stiffness_ = (0.5 * (stiffness_ + stiffness_.transpose())).eval();
}

// The level is open where a uniform delta on all pieces is answered by nothing, up to 1e-11. With c = 0 the change of
// area of a triangle is 2 |T| (a mean(tr s) - theta), what the penalty still lets it take; its sum is what the boundary
// asks for and cannot have.
Eigen::VectorXd UniformPressure::correct(const PressedBody& body, const std::vector<bool>& held,
                                         const DoubleDouble& skeleton, Eigen::VectorXd& theta) {
  const Model& m = body.model;
  if (response_.size() == 0 || held != held_) prepare(body);
  held_ = held;
  Eigen::VectorXd next = theta;
  move_theta(m, body.loads, skeleton, next);
  Eigen::VectorXd rest = over_pieces(body, next - theta);
  // In units in which each piece by itself has stiffness 1 at most.
  const Eigen::VectorXd root = size_.cwiseSqrt(), by = root.cwiseInverse();
  Eigen::MatrixXd scaled = by.asDiagonal() * stiffness_ * by.asDiagonal();
  constexpr double none_left = 1e-11;
  level_open_ = !(root.dot(scaled * root) > none_left * size_.sum());
  if (level_open_) {
    if (must_fit) {
      std::array<double, 2> most{next.cwiseAbs().maxCoeff(), 0};
      for (const double u : m.inner->skeleton.prescribed) most[1] = std::max(most[1], std::abs(u));
      double whole = area(m);
      body.over_all.most(most);
      body.over_all.add({&whole, 1});
      check_volume(2 * rest.sum(), most[0], most[1], whole);
    }
    rest -= size_ * (rest.sum() / size_.sum());
    scaled += root * root.transpose() / size_.sum();
  }
  const Eigen::VectorXd weighed = by.cwiseProduct(rest),
                        found = body.symmetric ? solve_symmetric(scaled, weighed) : solve(lu(scaled), weighed),
                        delta = by.cwiseProduct(found);
  for (Index t = 0; t < static_cast<Index>(piece_.size()); ++t) theta[t] += penalty_at(m, t) * delta[piece_[t]];
  return delta;
}

// theta/a of the solution with this theta has mean 0.
void UniformPressure::take_out_level(const PressedBody& body, const DoubleDouble& skeleton,
                                     Eigen::VectorXd& theta) const {
  const Model& m = body.model;
  Eigen::VectorXd next = theta;
  move_theta(m, body.loads, skeleton, next);
  std::array<double, 2> sums{0, 0};
  for (Index t = 0; t < own_triangles(m); ++t) {
    sums[0] += cell_area(m, t) * next[t] / penalty_at(m, t);
    sums[1] += cell_area(m, t);
  }
  body.over_all.add(sums);
  for (Index t = 0; t < static_cast<Index>(theta.size()); ++t) theta[t] -= penalty_at(m, t) * sums[0] / sums[1];
}

}  // namespace kerf
