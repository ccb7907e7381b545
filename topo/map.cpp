#include "topo/map.hpp"

#include "solver/parallel.hpp"
#include "topo/green.hpp"
#include "topo/mask.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace kerf {

namespace {

Mat2 symmetric(const Eigen::Vector3d& s) {
  return (Mat2() << s[0], s[2], s[2], s[1]).finished();
}
Eigen::Vector3d components(const Eigen::Vector4d& s) {
  return {s[0], s[3], 0.5 * (s[1] + s[2])};
}

bool removes_body(const Perturbation& p) {
  return p.kind == Perturbation::Kind::Hole || p.kind == Perturbation::Kind::Ellipse;
}

// One state at some points: stress s11, s22, s12; displacement where asked for.
struct Sample {
  Eigen::Matrix3Xd stress;
  Points displacement;
};

// What the expansion asks for, of every state that it is made of.
struct Needs {
  bool displacement = false;  // of the state
  bool dual_displacement = false;
  bool stress_only_dual = true;  // the adjoint's displacement may be recovered from its stress
};
Needs needs(const Analysis& a, const Functional& j, const Perturbation& p) {
  Needs n;
  const bool loaded = removes_body(p) && a.model->scene.body;
  n.displacement = loaded;
  n.dual_displacement = loaded && a.adjoint;
  for (const Term& term : j.terms) {
    if (term.uses_displacement) n.displacement = true;
    if (term.uses_stress) n.stress_only_dual = false;
  }
  return n;
}

// At one point of every state.
struct Values {
  Vec2 x;
  Material material;
  Eigen::Vector3d stress, dual, measured;
  Vec2 u = Vec2::Zero(), p = Vec2::Zero(), measured_u = Vec2::Zero();
  Eigen::Matrix3Xd openings = {};  // stress of the responses to openings
  Points opening_u = {};
};

class Expansion {
 public:
  Expansion(const Analysis& a, const Functional& j, const Perturbation& p) : a_(a), j_(j), p_(p) {}

  // `closed` is a guess for the biactive rows, and their state afterwards.
  Oriented operator()(const Values& v, std::vector<bool>& closed) const {
    const Mat2 s = symmetric(v.stress);
    std::array<Product, 3> products;
    std::size_t count = 0;
    if (a_.energy_share != 0 || !a_.adjoint) products[count++] = {-0.5 * a_.energy_share, s, s};
    if (a_.adjoint) products[count++] = {1, s, symmetric(v.dual)};
    if (a_.measured) products[count++] = {-0.5 * a_.measured_share, symmetric(v.measured), symmetric(v.measured)};
    Oriented t = oriented(p_, v.material, std::span(products.data(), count));
    const bool loaded = removes_body(p_) && a_.model->scene.body;
    Vec2 body = Vec2::Zero();
    if (loaded) {
      body = a_.model->scene.body(v.x);
      t.value += body.dot(a_.energy_share * v.u - v.p + a_.measured_share * v.measured_u);
    }
    for (std::size_t i = 0; i < j_.terms.size(); ++i) t.value += a_.slope[i] * local(j_.terms[i], v, s);
    if (a_.biactive) {
      const Eigen::Index n = v.openings.cols();
      Eigen::VectorXd g(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        g[i] = form(p_, v.material, t.angle, s, symmetric(v.openings.col(i)));
        if (loaded) g[i] -= body.dot(v.opening_u.col(i));
      }
      // lambda >= 0, g + S lambda >= 0, lambda (g + S lambda) = 0.
      const Unilateral push = solve_unilateral(a_.biactive->opening, -g, closed);
      closed = push.closed;
      t.value += push.jump.dot(a_.biactive->slope);
    }
    return t;
  }

 private:
  double local(const Term& term, const Values& v, const Mat2& s) const {
    if (!term.density) return 0;
    const FieldPoint at{.x = v.x, .stress = s, .displacement = v.u, .material = v.material};
    if (term.local) return term.local(p_, at);
    return removes_body(p_) ? -term.density(at).value : 0;
  }

  const Analysis& a_;
  const Functional& j_;
  const Perturbation& p_;
};

Vec2 displacement_at(const Model& m, const State& s, Index t, const Vec2& x, bool recovered) {
  return recovered ? Vec2(recovered_displacement(m, s, t, x).col(0)) : Vec2(evaluate(m, s, t, x).displacement.col(0));
}

std::vector<bool> start(const Analysis& a) {
  return std::vector<bool>(a.biactive ? a.biactive->response.size() : 0, false);
}

// Area-weighted averages at the corners of values at the corners of triangles.
template <typename Local>
void average(const Mesh& mesh, const Corners& corners, const Local& local, Local& at_corners) {
  at_corners.setZero(local.rows(), static_cast<Eigen::Index>(corners.vertex.size()));
  Eigen::RowVectorXd weight = Eigen::RowVectorXd::Zero(at_corners.cols());
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const double w = area(mesh, t);
    for (int i = 0; i < 3; ++i) {
      at_corners.col(corners.of[t][i]) += w * local.col(Eigen::Index{3} * t + i);
      weight[corners.of[t][i]] += w;
    }
  }
  for (Eigen::Index c = 0; c < at_corners.cols(); ++c) at_corners.col(c) /= weight[c];
}

struct Everywhere {
  Sample centroids, corners;
};
Everywhere sample_everywhere(const Model& m, const State& s, const Corners& corners, bool displacement,
                             bool recovered) {
  const Index n = static_cast<Index>(m.mesh.triangles.size());
  Everywhere e;
  e.centroids.stress.resize(3, n);
  Eigen::Matrix3Xd local(3, Eigen::Index{3} * n);
  Points local_u(2, displacement ? Eigen::Index{3} * n : 0);
  if (displacement) e.centroids.displacement.resize(2, n);
  parallel_for(n, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Triangle shape = triangle(m, t);
      e.centroids.stress.col(t) = components(stress_at(m.kernel, shape, s.interior.col(t), centroid(shape)));
      for (int i = 0; i < 3; ++i)
        local.col(Eigen::Index{3} * t + i) = components(stress_at(m.kernel, shape, s.interior.col(t), shape.x[i]));
      if (!displacement) continue;
      Points x(2, 4);
      x << shape.x[0], shape.x[1], shape.x[2], centroid(shape);
      const Points u = recovered ? recovered_displacement(m, s, t, x) : evaluate(m, s, t, x).displacement;
      local_u.middleCols<3>(Eigen::Index{3} * t) = u.leftCols<3>();
      e.centroids.displacement.col(t) = u.col(3);
    }
  });
  average(m.mesh, corners, local, e.corners.stress);
  if (displacement) average(m.mesh, corners, local_u, e.corners.displacement);
  return e;
}

}  // namespace

std::vector<MapPoint> map_at(const Analysis& a, const Functional& j, const MapRequest& r,
                             std::span<const Vec2> points) {
  const Model& m = *a.model;
  const std::vector<bool> masked = too_close(m, j, points, clear_radii * r.radius, r.radius);
  std::vector<MapPoint> map(points.size());
  if (r.perturbation.kind == Perturbation::Kind::ClampedHole) {
    const std::vector<double> value = clamped_at(a, j, r.radius, points);
    for (std::size_t i = 0; i < points.size(); ++i) map[i] = {.at = points[i], .value = value[i], .masked = masked[i]};
    return map;
  }
  const Expansion expansion(a, j, r.perturbation);
  const Needs need = needs(a, j, r.perturbation);
  const std::vector<Index> where = locate(m.mesh, points);
  std::vector<bool> closed = start(a);
  for (std::size_t i = 0; i < points.size(); ++i) {
    map[i].at = points[i];
    map[i].masked = masked[i];
    map[i].value = std::numeric_limits<double>::quiet_NaN();
    const Index t = where[i];
    if (t == none) continue;
    const Vec2& x = points[i];
    const Triangle shape = triangle(m, t);
    const auto stress = [&](const State& s) { return components(stress_at(m.kernel, shape, s.interior.col(t), x)); };
    Values v{.x = x, .material = material_of(m.mesh, m.scene, t), .stress = stress(*a.state)};
    if (need.displacement) v.u = displacement_at(m, *a.state, t, x, true);
    if (a.adjoint) v.dual = stress(*a.adjoint);
    if (need.dual_displacement) v.p = displacement_at(m, *a.adjoint, t, x, need.stress_only_dual);
    if (a.measured) {
      v.measured = stress(*a.measured);
      if (need.displacement) v.measured_u = displacement_at(*a.measured_model, *a.measured, t, x, true);
    }
    if (a.biactive) {
      const Eigen::Index n = static_cast<Eigen::Index>(a.biactive->response.size());
      v.openings.resize(3, n);
      v.opening_u.resize(2, n);
      for (Eigen::Index k = 0; k < n; ++k) {
        const State& y = a.biactive->response[static_cast<std::size_t>(k)];
        v.openings.col(k) = stress(y);
        if (need.displacement) v.opening_u.col(k) = displacement_at(m, y, t, x, true);
      }
    }
    const Oriented value = expansion(v, closed);
    map[i].value = value.value;
    map[i].angle = value.angle;
  }
  return map;
}

FullMap map_everywhere(const Analysis& a, const Functional& j, const MapRequest& r, const Corners& corners) {
  const Model& m = *a.model;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size()),
              count = static_cast<Index>(corners.vertex.size());
  std::vector<Vec2> centers, vertices;
  for (Index t = 0; t < triangles; ++t) centers.push_back(centroid(m.mesh, t));
  for (const Index v : corners.vertex) vertices.push_back(m.mesh.points[v]);
  std::vector<Index> beside(static_cast<std::size_t>(count), 0);  // a triangle at every corner
  for (Index t = 0; t < triangles; ++t)
    for (const Index c : corners.of[t]) beside[c] = t;
  FullMap map;
  map.masked_centroid = too_close(m, j, centers, clear_radii * r.radius, r.radius);
  map.masked_corner = too_close(m, j, vertices, clear_radii * r.radius, r.radius);
  if (r.perturbation.kind == Perturbation::Kind::ClampedHole) {
    std::vector<Vec2> points = centers;
    points.insert(points.end(), vertices.begin(), vertices.end());
    std::vector<Index> in(static_cast<std::size_t>(triangles));
    std::iota(in.begin(), in.end(), Index{0});
    in.insert(in.end(), beside.begin(), beside.end());
    std::vector<bool> skip = map.masked_centroid;
    skip.insert(skip.end(), map.masked_corner.begin(), map.masked_corner.end());
    const ClampedMap clamped = clamped_everywhere(a, j, r.radius, points, in, skip);
    map.at_centroids = clamped.value.head(triangles);
    map.at_corners = clamped.value.tail(count);
    return map;
  }
  const Expansion expansion(a, j, r.perturbation);
  const Needs need = needs(a, j, r.perturbation);
  const Everywhere state = sample_everywhere(m, *a.state, corners, need.displacement, true);
  std::optional<Everywhere> dual, measured;
  if (a.adjoint) dual = sample_everywhere(m, *a.adjoint, corners, need.dual_displacement, need.stress_only_dual);
  if (a.measured) measured = sample_everywhere(*a.measured_model, *a.measured, corners, need.displacement, true);
  std::vector<Everywhere> openings;
  if (a.biactive)
    for (const State& y : a.biactive->response)
      openings.push_back(sample_everywhere(m, y, corners, need.displacement, true));
  const bool turned =
      r.perturbation.kind == Perturbation::Kind::Ellipse || r.perturbation.kind == Perturbation::Kind::Crack;
  if (turned) map.angle.resize(triangles);
  const auto fill = [&](Index n, Sample Everywhere::*at, const std::function<Vec2(Index)>& place,
                        const std::function<Index(Index)>& in, Eigen::VectorXd& value, Eigen::VectorXd* angle) {
    value.resize(n);
    parallel_for(n, m.threads, [&](Index begin, Index end) {
      std::vector<bool> closed = start(a);
      for (Index i = begin; i < end; ++i) {
        Values v{.x = place(i), .material = material_of(m.mesh, m.scene, in(i)), .stress = (state.*at).stress.col(i)};
        if (need.displacement) v.u = (state.*at).displacement.col(i);
        if (dual) v.dual = ((*dual).*at).stress.col(i);
        if (need.dual_displacement) v.p = ((*dual).*at).displacement.col(i);
        if (measured) v.measured = ((*measured).*at).stress.col(i);
        if (measured && need.displacement) v.measured_u = ((*measured).*at).displacement.col(i);
        if (!openings.empty()) {
          v.openings.resize(3, static_cast<Eigen::Index>(openings.size()));
          v.opening_u.resize(2, v.openings.cols());
          for (std::size_t k = 0; k < openings.size(); ++k) {
            v.openings.col(static_cast<Eigen::Index>(k)) = (openings[k].*at).stress.col(i);
            if (need.displacement)
              v.opening_u.col(static_cast<Eigen::Index>(k)) = (openings[k].*at).displacement.col(i);
          }
        }
        const Oriented t = expansion(v, closed);
        value[i] = t.value;
        if (angle) (*angle)[i] = t.angle;
      }
    });
  };
  fill(
      triangles, &Everywhere::centroids, [&](Index t) { return centers[static_cast<std::size_t>(t)]; },
      [](Index t) { return t; }, map.at_centroids, turned ? &map.angle : nullptr);
  fill(
      count, &Everywhere::corners, [&](Index c) { return vertices[static_cast<std::size_t>(c)]; },
      [&](Index c) { return beside[static_cast<std::size_t>(c)]; }, map.at_corners, nullptr);
  return map;
}

}  // namespace kerf
