// Values at points: the recovered displacement u* [theory: R.1], the stress that the element has there, and T by the
// expansion at that point [theory: T.4], as probes and map.points have them. A point is looked for in the boxes of a
// tree; points of one triangle are evaluated together.

#include "app/run/point_values.hpp"

#include "base/parallel.hpp"
#include "kerf/perturbation.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"

namespace kerf {

namespace {

ValuesAt outside(std::size_t count) {
  const auto n = static_cast<Eigen::Index>(count);
  ValuesAt v{.triangle = std::vector<Index>(count, none)};
  v.displacement = Points::Constant(2, n, nan);
  v.stress = Eigen::Matrix4Xd::Constant(4, n, nan);
  v.rotation = v.von_mises = Eigen::RowVectorXd::Constant(n, nan);
  return v;
}

/// Of the triangle with straight edges.
Vec2 barycentric(const Mesh& mesh, Index t, const Vec2& x) {
  const auto& [a, b, c] = mesh.triangles[t];
  Mat2 edges;
  edges << mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a];
  return edges.inverse() * (x - mesh.points[a]);
}

double von_mises_at(const SolvedBody& body, Index t, const Vec2& x, const Eigen::Vector4d& s) {
  const Mesh& mesh = body.model.mesh;
  const StrainData& strain = body.model.inner->data.strain;
  const double e33 = strain.empty() ? 0 : strain_33_at(strain, t, barycentric(mesh, t, x))[0];
  return von_mises(material_of(mesh, body.model.scene, t), body.plane_strain, s, e33);
}

void add_derivative(const Analysis& mapped, const MapTask& task, std::span<const Vec2> points, ValuesAt& v) {
  MapRequest request = task.request;
  request.bounds = request.second = false;  // which would need solves
  std::vector<Vec2> inside;
  std::vector<Eigen::Index> number;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (v.triangle[k] != none) {
      inside.push_back(points[k]);
      number.push_back(static_cast<Eigen::Index>(k));
    }
  v.derivative = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(points.size()), nan);
  v.masked.assign(points.size(), false);
  const std::vector<MapPoint> found = map_at(mapped, task.functional, request, inside);
  for (std::size_t k = 0; k < found.size(); ++k) {
    v.derivative[number[k]] = found[k].value;
    v.masked[static_cast<std::size_t>(number[k])] = found[k].masked;
  }
}

}  // namespace

ValuesAt values_at(const SolvedBody& body, const Analysis* mapped, const MapTask& task, std::span<const Vec2> points) {
  ValuesAt v = outside(points.size());
  parallel_for(static_cast<Index>(points.size()), body.model.threads, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!points[k].allFinite()) continue;
      const Index t = v.triangle[k] = locate(body.model.mesh, body.locator, points[k]);
      if (t == none) continue;
      const Fields there = evaluate(body.model, body.state, t, points[k]);
      v.displacement.col(i) = recovered_displacement(body.model, body.state, t, points[k]).col(0);
      v.stress.col(i) = there.stress.col(0);
      v.rotation[i] = there.rotation[0];
      v.von_mises[i] = von_mises_at(body, t, points[k], there.stress.col(0));
    }
  });
  if (mapped && has_series(task.request.perturbation)) add_derivative(*mapped, task, points, v);
  return v;
}

}  // namespace kerf
