// Points to triangles: triangles filed in the cells of a uniform grid.

#include "geometry/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {

namespace {

struct Box {
  Vec2 low, high;
};

Box box(const Mesh& mesh, std::size_t t, double margin) {
  const auto& v = mesh.triangles[t];
  const Vec2 &a = mesh.points[std::size_t(v[0])], &b = mesh.points[std::size_t(v[1])],
             &c = mesh.points[std::size_t(v[2])];
  return {a.cwiseMin(b).cwiseMin(c).array() - margin, a.cwiseMax(b).cwiseMax(c).array() + margin};
}

/// How far x lies outside the triangle, measured along the normals of its sides; not positive inside.
double outside(const Mesh& mesh, std::size_t t, const Vec2& x) {
  double worst = -std::numeric_limits<double>::infinity();
  const auto& v = mesh.triangles[t];
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 &a = mesh.points[std::size_t(v[i])], &b = mesh.points[std::size_t(v[(i + 1) % 3])];
    worst = std::max(worst, cross(x - a, b - a) / (b - a).norm());
  }
  return worst;
}

struct Grid {
  Vec2 low;
  double cell;  // width
  int columns, rows;
  std::vector<Index> start, triangle;  // per cell its triangles, increasing

  int column(double x) const {
    return int(std::clamp((x - low.x()) / cell, 0.0, columns - 1.0));
  }
  int row(double y) const {
    return int(std::clamp((y - low.y()) / cell, 0.0, rows - 1.0));
  }
};

Grid file(const Mesh& mesh, const Box& all, double margin) {
  const Vec2 size = all.high - all.low;
  const double count = double(mesh.triangles.size());
  Grid grid;
  grid.low = all.low;
  // About one triangle per cell, and never more than `count` cells along the long side of a thin body.
  grid.cell = std::max(std::sqrt(size.x() * size.y() / count), size.maxCoeff() / count);
  grid.columns = int(size.x() / grid.cell) + 1;
  grid.rows = int(size.y() / grid.cell) + 1;
  grid.start.assign(std::size_t(grid.columns) * std::size_t(grid.rows) + 1, 0);
  const auto each_cell = [&](std::size_t t, auto&& visit) {
    const Box b = box(mesh, t, margin);
    const int right = grid.column(b.high.x()), top = grid.row(b.high.y());
    for (int j = grid.row(b.low.y()); j <= top; ++j)
      for (int i = grid.column(b.low.x()); i <= right; ++i)
        visit(std::size_t(j) * std::size_t(grid.columns) + std::size_t(i));
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    each_cell(t, [&](std::size_t cell) { ++grid.start[cell + 1]; });
  for (std::size_t c = 0; c + 1 < grid.start.size(); ++c) grid.start[c + 1] += grid.start[c];
  grid.triangle.resize(std::size_t(grid.start.back()));
  std::vector<Index> fill(grid.start.begin(), grid.start.end() - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    each_cell(t, [&](std::size_t cell) { grid.triangle[std::size_t(fill[cell]++)] = Index(t); });
  return grid;
}

}  // namespace

std::vector<Index> locate(const Mesh& mesh, std::span<const Vec2> points) {
  std::vector<Index> found(points.size(), none);
  if (mesh.triangles.empty() || points.empty()) return found;
  Box all = box(mesh, 0, 0);
  for (std::size_t t = 1; t < mesh.triangles.size(); ++t) {
    const Box b = box(mesh, t, 0);
    all = {all.low.cwiseMin(b.low), all.high.cwiseMax(b.high)};
  }
  const double margin = 1e-12 * (all.high - all.low).norm();
  const Grid grid = file(mesh, all, margin);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Vec2& x = points[p];
    // Not finite, or outside the box: no triangle.
    if (!((x - all.low).minCoeff() >= -margin && (all.high - x).minCoeff() >= -margin)) continue;
    const std::size_t cell = std::size_t(grid.row(x.y())) * std::size_t(grid.columns) + std::size_t(grid.column(x.x()));
    double least = margin;
    for (Index i = grid.start[cell]; i < grid.start[cell + 1]; ++i) {
      const Index t = grid.triangle[std::size_t(i)];
      const double distance = outside(mesh, std::size_t(t), x);
      if (distance > least || (found[p] != none && distance == least)) continue;
      least = distance;
      found[p] = t;
      if (least <= 0) break;
    }
  }
  return found;
}

}  // namespace kerf
