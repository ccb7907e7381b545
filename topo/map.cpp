#include "topo/map.hpp"

#include "solver/parallel.hpp"

#include <limits>

namespace kerf {

namespace {

double at_point(const Model& m, const State& s, Index t, const Vec2& x) {
  const Mat2 stress = tensor(stress_at(m.kernel, triangle(m, t), s.interior.col(t), x));
  if (!m.scene.body) return hole_energy(m.scene.material, stress, Vec2::Zero(), Vec2::Zero());
  const Vec2 u = recovered_displacement(m, s, t, x).col(0);
  return hole_energy(m.scene.material, stress, m.scene.body(x), u);
}

}  // namespace

std::vector<double> energy_map(const Model& model, const State& state, std::span<const Vec2> points) {
  const std::vector<Index> where = locate(model.mesh, points);
  std::vector<double> value(points.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (where[i] != none) value[i] = at_point(model, state, where[i], points[i]);
  return value;
}

FullMap energy_map(const Model& model, const State& state, const Corners& corners, const CornerValues& values) {
  FullMap map;
  map.at_centroids.resize(static_cast<Eigen::Index>(model.mesh.triangles.size()));
  parallel_for(static_cast<Index>(model.mesh.triangles.size()), model.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) map.at_centroids[t] = at_point(model, state, t, centroid(model.mesh, t));
  });
  map.at_corners.resize(static_cast<Eigen::Index>(corners.vertex.size()));
  for (Eigen::Index i = 0; i < map.at_corners.size(); ++i) {
    const Vec2& x = model.mesh.points[corners.vertex[i]];
    const Vec2 body = model.scene.body ? model.scene.body(x) : Vec2::Zero();
    map.at_corners[i] =
        hole_energy(model.scene.material, tensor(values.stress.col(i)), body, values.displacement.col(i));
  }
  return map;
}

}  // namespace kerf
