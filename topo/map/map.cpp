#include "kerf/map.hpp"
#include "solver/recovery.hpp"
#include "solver/system.hpp"

#include "kerf/mesher.hpp"
#include "solver/error_bars.hpp"
#include "solver/parallel.hpp"
#include "topo/map/fields.hpp"
#include "topo/map/green.hpp"
#include "topo/map/mask.hpp"

#include <cmath>
#include <numeric>

namespace kerf {

namespace {

std::shared_ptr<const MapFields> fields_of(const Analysis& a, const Corners& corners = {}) {
  return a.fields ? a.fields : recover_fields(a, corners);
}

// Displacements at centroids and corners (there the average weighted by area).
struct Displacements {
  Points at_centroids, at_corners;
};
Displacements displacements(const Model& m, const Field& s, const Corners& corners, bool recovered) {
  const Index n = static_cast<Index>(m.mesh.triangles.size());
  const bool linear = m.element.displacement == 0 && is_mixed(m.element);
  Points local(2, Eigen::Index{3} * n);
  Displacements d{Points(2, n), Points::Zero(2, static_cast<Eigen::Index>(corners.vertex.size()))};
  parallel_for(n, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Triangle shape = triangle(m, t);
      Points x(2, 4);
      x << shape.x[0], shape.x[1], shape.x[2], centroid(shape);
      Points u(2, 4);
      if (recovered && linear) {
        // The mean of the displacement and its gradient at the centroid: as exact as u* where the mean is all there is.
        const Fields f = evaluate(m.inner->kernel, shape, s.interior.col(t), x.rightCols<1>());
        const Eigen::Vector4d d =
            displacement_gradient(material_of(m.mesh, m.scene, t), f.stress.col(0), f.rotation[0]);
        const Mat2 gradient = (Mat2() << d[0], d[1], d[2], d[3]).finished();
        for (int i = 0; i < 4; ++i) u.col(i) = f.displacement.col(0) + gradient * (x.col(i) - x.col(3));
      } else {
        u = recovered ? recovered_displacement(m, s, t, x) : evaluate(m, s, t, x).displacement;
      }
      local.middleCols<3>(Eigen::Index{3} * t) = u.leftCols<3>();
      d.at_centroids.col(t) = u.col(3);
    }
  });
  Eigen::RowVectorXd weight = Eigen::RowVectorXd::Zero(d.at_corners.cols());
  for (Index t = 0; t < n; ++t)
    for (int i = 0; i < 3; ++i) {
      d.at_corners.col(corners.of[t][i]) += area(m.mesh, t) * local.col(Eigen::Index{3} * t + i);
      weight[corners.of[t][i]] += area(m.mesh, t);
    }
  for (Eigen::Index c = 0; c < d.at_corners.cols(); ++c) d.at_corners.col(c) /= weight[c];
  return d;
}

// Everything that the expansion needs at all corners or at all centroids.
struct Sample {
  const Eigen::Matrix3Xd* stress;
  const Eigen::Matrix3Xd *dual = nullptr, *measured = nullptr;
  std::vector<const Eigen::Matrix3Xd*> openings = {};
  const Points *u = nullptr, *p = nullptr, *measured_u = nullptr;
  std::vector<const Points*> opening_u = {};
};

PointValues values(const Sample& s, Index i) {
  PointValues v;
  v.stress = s.stress->col(i);
  if (s.dual) v.dual = s.dual->col(i);
  if (s.measured) v.measured = s.measured->col(i);
  if (s.u) v.u = s.u->col(i);
  if (s.p) v.p = s.p->col(i);
  if (s.measured_u) v.measured_u = s.measured_u->col(i);
  const Eigen::Index n = static_cast<Eigen::Index>(s.openings.size());
  if (n > 0) {
    v.openings.resize(3, n);
    v.opening_u = Points::Zero(2, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      v.openings.col(k) = s.openings[static_cast<std::size_t>(k)]->col(i);
      if (!s.opening_u.empty()) v.opening_u.col(k) = s.opening_u[static_cast<std::size_t>(k)]->col(i);
    }
  }
  return v;
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
  const Needs need = needs(a, j, r.perturbation);
  const std::vector<Index> where = locate(m.mesh, points);
  const std::shared_ptr<const MapFields> fields = fields_of(a);
  std::vector<bool> closed = no_row_closed(a);
  for (std::size_t i = 0; i < points.size(); ++i) {
    map[i] = {.at = points[i], .value = nan, .masked = masked[i]};
    if (where[i] == none) continue;
    const Oriented t = expand_at(a, j, r.perturbation, *fields, need, where[i], points[i], closed);
    map[i].value = t.value;
    map[i].angle = t.angle;
  }
  return map;
}

FullMap map_everywhere(const Analysis& a, const Functional& j, const MapRequest& r, const Corners& corners) {
  const Model& m = *a.model;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size()),
              count = static_cast<Index>(corners.vertex.size());
  std::vector<Vec2> at_centroids, at_vertices;
  for (Index t = 0; t < triangles; ++t) at_centroids.push_back(centroid(m.mesh, t));
  for (const Index v : corners.vertex) at_vertices.push_back(m.mesh.points[v]);
  std::vector<Index> beside(static_cast<std::size_t>(count), 0);  // a triangle at every corner
  for (Index t = 0; t < triangles; ++t)
    for (const Index c : corners.of[t]) beside[c] = t;
  FullMap map;
  map.masked_centroid = too_close(m, j, at_centroids, clear_radii * r.radius, r.radius);
  // True distances as far as a triangle reaches, so that the mask's edge can be drawn inside triangles.
  const double clear = clear_radii * r.radius, reach = clear + 1.01 * quality(m.mesh).h_max;
  const std::vector<double> margin = margins(m, j, at_vertices, clear, r.radius, reach);
  map.margin = Eigen::Map<const Eigen::VectorXd>(margin.data(), count);
  for (const double v : margin) map.masked_corner.push_back(v < 0);
  if (r.perturbation.kind == Perturbation::Kind::ClampedHole) {
    std::vector<Vec2> points = at_centroids;
    points.insert(points.end(), at_vertices.begin(), at_vertices.end());
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
  const Needs need = needs(a, j, r.perturbation);
  const std::shared_ptr<const MapFields> fields = fields_of(a, corners);
  const MapFields& f = *fields;
  if (f.state.at_corners.cols() != count)
    throw std::invalid_argument("map_everywhere: the corners are those of split_for_stress");
  std::vector<Displacements> u;  // state, dual, measured, openings
  u.reserve(3 + f.openings.size());
  Sample centroids{.stress = &f.state.at_centroids}, vertices{.stress = &f.state.at_corners};
  const auto displaced = [&](const Model& model, const Field& s, bool recovered, const Points*& at_centroids,
                             const Points*& at_corners) {
    u.push_back(displacements(model, s, corners, recovered));
    at_centroids = &u.back().at_centroids;
    at_corners = &u.back().at_corners;
  };
  if (need.displacement) displaced(m, *a.state, true, centroids.u, vertices.u);
  if (f.dual) centroids.dual = &f.dual->at_centroids, vertices.dual = &f.dual->at_corners;
  if (need.dual_displacement) displaced(m, *a.adjoint, need.recover_dual, centroids.p, vertices.p);
  if (f.measured) {
    centroids.measured = &f.measured->at_centroids, vertices.measured = &f.measured->at_corners;
    if (need.displacement) displaced(*a.measured_model, *a.measured, true, centroids.measured_u, vertices.measured_u);
  }
  for (std::size_t k = 0; k < f.openings.size(); ++k) {
    centroids.openings.push_back(&f.openings[k].at_centroids);
    vertices.openings.push_back(&f.openings[k].at_corners);
    if (!need.displacement) continue;
    centroids.opening_u.push_back(nullptr), vertices.opening_u.push_back(nullptr);
    displaced(m, a.biactive->response[k], true, centroids.opening_u.back(), vertices.opening_u.back());
  }
  const bool turned =
      r.perturbation.kind == Perturbation::Kind::Ellipse || r.perturbation.kind == Perturbation::Kind::Crack;
  if (turned) map.angle.resize(triangles);
  const auto fill = [&](Index n, const Sample& sample, const std::vector<Vec2>& x, const std::vector<Index>* in,
                        Eigen::VectorXd& value, Eigen::VectorXd* angle) {
    value.resize(n);
    parallel_for(n, m.threads, [&](Index begin, Index end) {
      std::vector<bool> closed = no_row_closed(a);
      for (Index i = begin; i < end; ++i) {
        PointValues v = values(sample, i);
        v.x = x[static_cast<std::size_t>(i)];
        v.material = material_of(m.mesh, m.scene, in ? (*in)[static_cast<std::size_t>(i)] : i);
        const Oriented t = expand(a, j, r.perturbation, v, closed);
        value[i] = t.value;
        if (angle) (*angle)[i] = t.angle;
      }
    });
  };
  fill(triangles, centroids, at_centroids, nullptr, map.at_centroids, turned ? &map.angle : nullptr);
  fill(count, vertices, at_vertices, &beside, map.at_corners, nullptr);
  return map;
}

Eigen::VectorXd map_at_centroids(const Analysis& a, const Functional& j,
                                 const std::function<const Perturbation&(Index triangle)>& change) {
  const Model& m = *a.model;
  const Index n = static_cast<Index>(m.mesh.triangles.size());
  Eigen::VectorXd value(n);
  parallel_for(n, m.threads, [&](Index begin, Index end) {
    std::vector<bool> closed = no_row_closed(a);
    for (Index t = begin; t < end; ++t) {
      const Perturbation& p = change(t);
      const Needs need = needs(a, j, p);
      const Triangle shape = triangle(m, t);
      const Vec2 x = centroid(shape);
      const auto stress = [&](const Field& s) {
        return components(stress_at(m.inner->kernel, shape, s.interior.col(t), x));
      };
      PointValues v{.x = x, .material = material_of(m.mesh, m.scene, t), .stress = stress(*a.state)};
      if (need.displacement) v.u = displacement_at(m, *a.state, t, x, true);
      if (a.adjoint) v.dual = stress(*a.adjoint);
      if (need.dual_displacement) v.p = displacement_at(m, *a.adjoint, t, x, need.recover_dual);
      if (a.measured) {
        v.measured = stress(*a.measured);
        if (need.displacement) v.measured_u = displacement_at(*a.measured_model, *a.measured, t, x, true);
      }
      if (a.biactive) {
        const Eigen::Index k = static_cast<Eigen::Index>(a.biactive->response.size());
        v.openings.resize(3, k);
        v.opening_u = Points::Zero(2, k);
        for (Eigen::Index i = 0; i < k; ++i) {
          const Field& y = a.biactive->response[static_cast<std::size_t>(i)];
          v.openings.col(i) = stress(y);
          if (need.displacement) v.opening_u.col(i) = displacement_at(m, y, t, x, true);
        }
      }
      value[t] = expand(a, j, p, v, closed).value;
    }
  });
  return value;
}

void add_bars(const Analysis& a, const Functional& j, const MapRequest& r, const Shape& shape, const Sizing& sizing,
              FullMap& map, std::span<MapPoint> points) {
  const Model& m = *a.model;
  const std::shared_ptr<const MapFields> fields = fields_of(a);
  const MapFields& own = *fields;
  const std::vector<double> sizes = better_sizes(m.mesh, own.corners, own.singular);
  const Model better =
      prepare(triangulate(shape, sizing, Background{&m.mesh, sizes}), better_element(m.element), m.scene, m.threads);
  const State state = solve(better);
  if (!certified(state))
    throw Error(Fault::Numerics, "the better solution for error bars (map.bounds) did not converge");
  Analysis finer = analyze(j, better, state);
  finer.fields = recover_fields(finer);
  const Places at = places(m.mesh, own.corners, better.mesh);
  const auto sampled = [&](const Analysis& of, const std::vector<Index>& where) {
    const Needs need = needs(of, j, r.perturbation);
    const MapFields& f = &of == &finer ? *finer.fields : own;
    Eigen::VectorXd value(static_cast<Eigen::Index>(at.x.size()));
    parallel_for(static_cast<Index>(at.x.size()), m.threads, [&](Index begin, Index end) {
      std::vector<bool> closed = no_row_closed(of);
      for (Index i = begin; i < end; ++i) {
        const auto k = static_cast<std::size_t>(i);
        value[i] = where[k] == none ? nan : expand_at(of, j, r.perturbation, f, need, where[k], at.x[k], closed).value;
      }
    });
    return value;
  };
  const Spread bars = spread(own.corners, sampled(a, at.own), sampled(finer, at.better));
  map.lower = map.at_corners - bars.at_corners;
  map.upper = map.at_corners + bars.at_corners;
  std::vector<Vec2> x;
  for (const MapPoint& p : points) x.push_back(p.at);
  const std::vector<Index> where = locate(m.mesh, x), there = locate(better.mesh, x);
  const Needs need = needs(finer, j, r.perturbation);
  std::vector<bool> closed = no_row_closed(finer);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (where[i] == none || there[i] == none) continue;
    const double finest = expand_at(finer, j, r.perturbation, *finer.fields, need, there[i], x[i], closed).value;
    const double half = half_width_at(m.mesh, own.corners, bars, where[i], x[i], points[i].value - finest);
    points[i].lower = points[i].value - half;
    points[i].upper = points[i].value + half;
  }
}

}  // namespace kerf
