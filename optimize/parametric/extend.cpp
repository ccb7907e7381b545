// The motion of a boundary carried into a mesh and forces on the mesh carried back [theory: S.7]:
//   sum_T 1/|T| int_T grad u . grad v = 0 for all v that vanish at given vertices,   u = given there,
// linear elements with a weight that keeps small triangles stiff. The matrix of the free vertices is factorized once
// per mesh; `gather` is the transpose of `extend`, one more solve with the same factor. A moved mesh is refused where
// an angle falls below 13 degrees and below 0.6 of what it was, or a triangle is stretched by more than 1.6.
// docs/theory/shape_gradient.md, section "Carrying a motion into the mesh".

#include "optimize/parametric/extend.hpp"

#include "solver/moved.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// F = b a^-1 maps the triangle before to the one after.
bool distorted(const Mesh& before, const Mesh& after, std::size_t t, double most) {
  const auto sides = [t](const Mesh& mesh) {
    const auto& v = mesh.triangles[t];
    const Vec2& x = mesh.points[static_cast<std::size_t>(v[0])];
    Mat2 both;
    both << mesh.points[static_cast<std::size_t>(v[1])] - x, mesh.points[static_cast<std::size_t>(v[2])] - x;
    return both;
  };
  const Mat2 a = sides(before), b = sides(after);
  const Mat2 f = b * Mat2{{a(1, 1), -a(0, 1)}, {-a(1, 0), a(0, 0)}} / cross(a.col(0), a.col(1));
  // Singular values: half the sum and the difference of these.
  const double plus = std::hypot(f(0, 0) + f(1, 1), f(1, 0) - f(0, 1)),
               minus = std::hypot(f(0, 0) - f(1, 1), f(1, 0) + f(0, 1));
  return plus + minus > 2 * most || plus - minus < 2 / most;
}

/// Stiffness of the pair of vertices i, k of a triangle over its area: -1/2 cot of the angle between, over the area.
/// e_i . e_k/(4 |T|) of linear elements, and once more over |T| for the weight.
double stiffness(const Mesh& mesh, Index t, std::size_t i, std::size_t k) {
  const auto& v = mesh.triangles[static_cast<std::size_t>(t)];
  const auto edge = [&](std::size_t c) {
    return Vec2(mesh.points[static_cast<std::size_t>(v[(c + 2) % 3])] -
                mesh.points[static_cast<std::size_t>(v[(c + 1) % 3])]);
  };
  const double whole = area(mesh, t);
  return edge(i).dot(edge(k)) / (4 * whole * whole);
}

/// Per free vertex its row, in the sequence of all.
std::vector<Index> rows_in(std::span<const Index> sequence, const std::vector<bool>& given) {
  std::vector<Index> row(given.size(), none);
  Index count = 0;
  for (const Index v : sequence)
    if (!given[static_cast<std::size_t>(v)]) row[static_cast<std::size_t>(v)] = count++;
  return row;
}

/// The matrix of the free vertices without its values.
/// A column per free vertex: itself and its neighbors in larger rows.
LowerTriangle pattern_of(const Mesh& mesh, const std::vector<Index>& row) {
  LowerTriangle inner;
  inner.size = static_cast<Index>(std::ranges::count_if(row, [](Index r) { return r != none; }));
  std::vector<std::vector<Index>> below(static_cast<std::size_t>(inner.size));
  for (Index r = 0; r < inner.size; ++r) below[static_cast<std::size_t>(r)].push_back(r);
  for (const auto& [a, b] : mesh.edges) {
    const Index i = row[static_cast<std::size_t>(a)], k = row[static_cast<std::size_t>(b)];
    if (i != none && k != none) below[static_cast<std::size_t>(std::min(i, k))].push_back(std::max(i, k));
  }
  inner.start.push_back(0);
  for (std::vector<Index>& list : below) {
    std::ranges::sort(list);
    inner.rows.insert(inner.rows.end(), list.begin(), list.end());
    inner.start.push_back(static_cast<Index>(inner.rows.size()));
  }
  inner.values.assign(inner.rows.size(), 0.0);
  return inner;
}

/// Stiffnesses between free vertices into the matrix; returns those with given ones.
std::vector<Extension::Coupling> scatter(const Mesh& mesh, const std::vector<Index>& row, LowerTriangle& inner) {
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
  return couplings;
}

}  // namespace

Extension make_extension(const Mesh& mesh, const std::vector<bool>& given) {
  std::vector<Index> sequence = vertex_sequence(mesh), row = rows_in(sequence, given);
  LowerTriangle inner = pattern_of(mesh, row);
  std::vector<Extension::Coupling> couplings = scatter(mesh, row, inner);
  Factor factor(inner, 0);
  return {std::move(sequence), std::move(row), std::move(inner), std::move(factor), std::move(couplings)};
}

// K u = -C given, per axis.
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

// given force - C' K^-1 (free force): work is the same, force . extend(motion) = gather(force) . motion.
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
      least = std::min(least, std::atan2(cross(a, b), a.dot(b)) * 180 / pi);
    }
    angles.push_back(least);
  }
  return angles;
}

std::optional<Mesh> carry(const Extension& e, const Mesh& before, std::span<const double> before_angles,
                          const Points& motion, const Strain& most) {
  Mesh mesh = before;
  if (!motion.isZero(0)) {
    const Points all = extend(e, motion);
    for (std::size_t v = 0; v < mesh.points.size(); ++v) mesh.points[v] += all.col(static_cast<Eigen::Index>(v));
  }
  // Angles that are small already may fall to 0.6 of what they are.
  const std::vector<double> angles = smallest_angles(mesh);
  for (std::size_t t = 0; t < angles.size(); ++t)
    if (!(angles[t] >= std::min(most.least_angle, 0.6 * before_angles[t])) || distorted(before, mesh, t, most.stretch))
      return std::nullopt;
  return mesh;
}

}  // namespace kerf
