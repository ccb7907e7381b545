#include "optimize/parametric/extend.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf {

namespace {

/// Stiffness of the pair of vertices i, k of a triangle over its area: -1/2 cot of the angle between, over the area.
double stiffness(const Mesh& mesh, Index t, std::size_t i, std::size_t k) {
  const auto& v = mesh.triangles[static_cast<std::size_t>(t)];
  const auto edge = [&](std::size_t c) {
    return Vec2(mesh.points[static_cast<std::size_t>(v[(c + 2) % 3])] -
                mesh.points[static_cast<std::size_t>(v[(c + 1) % 3])]);
  };
  const double whole = area(mesh, t);
  return edge(i).dot(edge(k)) / (4 * whole * whole);
}

}  // namespace

Extension make_extension(const Mesh& mesh, const std::vector<bool>& given) {
  const auto vertices = static_cast<Index>(mesh.points.size());
  // Neighbors among free vertices, for the order and the pattern.
  std::vector<Index> number(mesh.points.size(), none);
  Index count = 0;
  for (Index v = 0; v < vertices; ++v)
    if (!given[static_cast<std::size_t>(v)]) number[static_cast<std::size_t>(v)] = count++;
  std::vector<std::vector<Index>> beside(static_cast<std::size_t>(count));
  for (const auto& [a, b] : mesh.edges) {
    const Index i = number[static_cast<std::size_t>(a)], k = number[static_cast<std::size_t>(b)];
    if (i == none || k == none) continue;
    beside[static_cast<std::size_t>(i)].push_back(k);
    beside[static_cast<std::size_t>(k)].push_back(i);
  }
  std::vector<Index> start{0}, neighbors;
  for (auto& list : beside) {
    std::sort(list.begin(), list.end());
    neighbors.insert(neighbors.end(), list.begin(), list.end());
    start.push_back(static_cast<Index>(neighbors.size()));
  }
  std::vector<Index> row(mesh.points.size(), none), place(static_cast<std::size_t>(count));
  if (count > 0) {
    const std::vector<Index> order = dissection(start, neighbors);
    for (Index k = 0; k < count; ++k) place[static_cast<std::size_t>(order[static_cast<std::size_t>(k)])] = k;
    for (std::size_t v = 0; v < row.size(); ++v)
      if (number[v] != none) row[v] = place[static_cast<std::size_t>(number[v])];
  }
  LowerTriangle inner;
  inner.size = count;
  inner.start.assign(static_cast<std::size_t>(count) + 1, 0);
  std::vector<std::vector<Index>> below(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i) {
    const auto r = static_cast<std::size_t>(place[static_cast<std::size_t>(i)]);
    below[r].push_back(static_cast<Index>(r));
    for (const Index k : beside[static_cast<std::size_t>(i)]) {
      const Index other = place[static_cast<std::size_t>(k)];
      if (other > static_cast<Index>(r)) below[r].push_back(other);
    }
    std::sort(below[r].begin(), below[r].end());
  }
  for (std::size_t c = 0; c < below.size(); ++c) {
    inner.rows.insert(inner.rows.end(), below[c].begin(), below[c].end());
    inner.start[c + 1] = static_cast<Index>(inner.rows.size());
  }
  inner.values.assign(inner.rows.size(), 0.0);
  std::vector<Extension::Coupling> couplings;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const auto& v = mesh.triangles[static_cast<std::size_t>(t)];
    for (std::size_t i = 0; i < 3; ++i) {
      const Index r = row[static_cast<std::size_t>(v[i])];
      if (r == none) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index c = row[static_cast<std::size_t>(v[k])];
        if (c > r) continue;  // stored from the other side
        const double value = stiffness(mesh, t, i, k);
        if (c == none) {
          couplings.push_back({r, v[k], value});
          continue;
        }
        const auto first = inner.rows.begin() + inner.start[static_cast<std::size_t>(c)],
                   last = inner.rows.begin() + inner.start[static_cast<std::size_t>(c) + 1];
        inner.values[static_cast<std::size_t>(std::lower_bound(first, last, r) - inner.rows.begin())] += value;
      }
    }
  }
  Factor factor(inner, 0);
  return {std::move(row), std::move(inner), std::move(factor), std::move(couplings)};
}

Points extend(const Extension& e, const Points& motion) {
  Points all = motion;
  if (e.inner.size == 0) return all;
  Eigen::Matrix2Xd load = Eigen::Matrix2Xd::Zero(2, e.inner.size);
  for (const auto& c : e.couplings) load.col(c.row) -= c.value * motion.col(c.vertex);
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::VectorXd u = e.factor.solve(load.row(axis).transpose());
    for (std::size_t v = 0; v < e.row.size(); ++v)
      if (e.row[v] != none) all(axis, static_cast<Eigen::Index>(v)) = u[e.row[v]];
  }
  return all;
}

Points gather(const Extension& e, const Points& force) {
  Points all = force;
  if (e.inner.size == 0) return all;
  Eigen::Matrix2Xd pull(2, e.inner.size);
  for (std::size_t v = 0; v < e.row.size(); ++v) {
    const auto column = static_cast<Eigen::Index>(v);
    if (e.row[v] == none) continue;
    pull.col(e.row[v]) = force.col(column);
    all.col(column).setZero();
  }
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::VectorXd p = e.factor.solve(pull.row(axis).transpose());
    for (const auto& c : e.couplings) all(axis, c.vertex) -= c.value * p[c.row];
  }
  return all;
}

std::vector<bool> vertices_that_mean_something(const Mesh& mesh) {
  std::vector<bool> special(mesh.points.size(), false);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const bool on_boundary = mesh.sides[e][0] == none || mesh.sides[e][1] == none;
    if (on_boundary || mesh.crack[e] != none || is_interface(mesh, static_cast<Index>(e)))
      for (const Index v : mesh.edges[e]) special[static_cast<std::size_t>(v)] = true;
  }
  return special;
}

std::vector<double> smallest_angles(const Mesh& mesh) {
  std::vector<double> angles;
  angles.reserve(mesh.triangles.size());
  for (const auto& v : mesh.triangles) {
    double least = 180;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2& x = mesh.points[static_cast<std::size_t>(v[i])];
      const Vec2 a = mesh.points[static_cast<std::size_t>(v[(i + 1) % 3])] - x,
                 b = mesh.points[static_cast<std::size_t>(v[(i + 2) % 3])] - x;
      least = std::min(least, std::atan2(cross(a, b), a.dot(b)) * 180 / std::numbers::pi);
    }
    angles.push_back(least);
  }
  return angles;
}

}  // namespace kerf
