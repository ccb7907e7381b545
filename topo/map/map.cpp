// Maps of the topological derivative T [theory: T.4]: at listed points, at all centroids and corners, and their error
// bars.
//  T = form(sigma, zeta) - b.p + local   from recovered stresses [theory: R.2, R.3] and displacements [theory: R.1]
// `expand` (topo/map/point.cpp) evaluates it at one place. A full map takes every field at all places first, so that
// recovery and element kernels run once per triangle. A clamped hole has no T: its map is the predicted change at the
// given radius (topo/map/green.cpp). What cannot hold is masked: nearer than four radii to a feature, or, where the
// second term c2 is known, where the radius of (Q.14) is less than the one asked for. Error bars compare with a better
// solution: an element of one degree more on another mesh with as many unknowns [theory: R.9], T expanded there at the
// same places. Derived in docs/theory/topological_derivatives.md.

#include "kerf/map.hpp"
#include "solver/recovery.hpp"
#include "solver/system.hpp"

#include "base/parallel.hpp"
#include "kerf/mesher.hpp"
#include "solver/error_bars.hpp"
#include "topo/analysis.hpp"
#include "topo/map/fields.hpp"
#include "topo/map/green.hpp"
#include "topo/map/mask.hpp"
#include "topo/map/second_map.hpp"
#include "topo/map/valid_radius.hpp"
#include "topo/map_at_centroids.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

std::shared_ptr<const MapFields> fields_of(const Analysis& a, const Corners& corners = {}) {
  return a.fields ? a.fields : recover_fields(a, corners);
}

// Displacements at centroids and corners (there the average weighted by area).
struct Displacements {
  Points at_centroids, at_corners;
};
// u* jumps from triangle to triangle.
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
            displacement_gradient(material_of(m.mesh, m.scene, t), f.stress.col(0), f.rotation[0]) +
            eigenstrain_at(m, s.eigenstrain, t, x.rightCols<1>());
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

// Points, each in a triangle.
struct Nodes {
  std::vector<Vec2> x;
  std::vector<Index> in;
};
Nodes centroids(const Mesh& mesh) {
  Nodes n;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    n.x.push_back(centroid(mesh, t));
    n.in.push_back(t);
  }
  return n;
}
// Any triangle of a corner does: what it is asked for (material, region) is the same for all triangles of one corner of
// split_for_stress.
Nodes at_corners(const Mesh& mesh, const Corners& corners) {
  Nodes n;
  for (const Index v : corners.vertex) n.x.push_back(mesh.points[v]);
  n.in.assign(n.x.size(), 0);
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t)
    for (const Index c : corners.of[t]) n.in[c] = t;
  return n;
}

// Asked as at a point, the expansion names the displacements that it wants: want(FieldOf, recovered).
template <class Want>
void ask(const Expansion& e, const Want& want) {
  point_values(
      e, [](const FieldOf&) -> Eigen::Vector3d { return Eigen::Vector3d::Zero(); },
      [&](const FieldOf& of, bool recovered) -> Vec2 {
        want(of, recovered);
        return Vec2::Zero();
      });
}

// T at all centroids or all corners, from fields that are known at all of them.
class Everywhere {
 public:
  Everywhere(const Expansion& e, const MapFields& fields) : e_(e), fields_(fields) {
    ask(e, [&](const FieldOf& of, bool recovered) {
      moved_.resize(std::max(moved_.size(), of.number + 1));
      moved_[of.number] = displacements(of.model, of.field, fields.corners, recovered);
    });
  }

  // Which of the two a member pointer names; the angle where it is asked for.
  void fill(const Nodes& nodes, Eigen::Matrix3Xd RecoveredStress::*stress, Points Displacements::*displacement,
            Eigen::VectorXd& value, Eigen::VectorXd* angle = nullptr) const {
    const Model& m = *e_.a.model;
    const Index n = static_cast<Index>(nodes.x.size());
    value.resize(n);
    if (angle) angle->resize(n);
    parallel_for(n, m.threads, [&](Index begin, Index end) {
      std::vector<bool> closed = no_row_closed(e_.a);
      for (Index i = begin; i < end; ++i) {
        PointValues v = point_values(
            e_, [&](const FieldOf& of) -> Eigen::Vector3d { return (fields_.recovered[of.number].*stress).col(i); },
            [&](const FieldOf& of, bool) -> Vec2 { return (moved_[of.number].*displacement).col(i); });
        set_place(e_, nodes.in[static_cast<std::size_t>(i)], nodes.x[static_cast<std::size_t>(i)], v);
        const Oriented t = expand(e_, v, closed);
        value[i] = t.value;
        if (angle) (*angle)[i] = t.angle;
      }
    });
  }

 private:
  const Expansion& e_;
  const MapFields& fields_;
  std::vector<Displacements> moved_;  // per FieldOf::number
};

// Where a full map is.
struct Grid {
  Nodes centroids, corners;
  const Corners& shape;
};

void mask(const Analysis& a, const Functional& j, double radius, const Grid& grid, FullMap& map) {
  const Model& m = *a.model;
  const double clear = clear_radii * radius;
  map.masked_centroid = too_close(m, j, grid.centroids.x, clear, radius);
  // True distances as far as a triangle reaches, so that the mask's edge can be drawn inside triangles.
  const std::vector<double> margin =
      margins(m, j, grid.corners.x, {clear, radius, clear + 1.01 * quality(m.mesh).h_max});
  map.margin = Eigen::Map<const Eigen::VectorXd>(margin.data(), static_cast<Eigen::Index>(margin.size()));
  for (const double v : margin) map.masked_corner.push_back(v < 0);
}

void fill_clamped(const Analysis& a, const Functional& j, double radius, const Grid& grid, FullMap& map) {
  Candidates all{grid.centroids.x, grid.centroids.in, map.masked_centroid};
  all.x.insert(all.x.end(), grid.corners.x.begin(), grid.corners.x.end());
  all.in.insert(all.in.end(), grid.corners.in.begin(), grid.corners.in.end());
  all.skip.insert(all.skip.end(), map.masked_corner.begin(), map.masked_corner.end());
  const ClampedMap clamped = clamped_everywhere(a, j, radius, all);
  map.at_centroids = clamped.value.head(static_cast<Eigen::Index>(grid.centroids.x.size()));
  map.at_corners = clamped.value.tail(static_cast<Eigen::Index>(grid.corners.x.size()));
}

// Where the second term is known it says where the first one is good at that radius, if the change has room at all. A
// value that is nothing beside the others may have any relative error.
constexpr double room_radii = 2;
// margin < 0 is masked. It is the least of three: how far the radius of (Q.14) exceeds the one asked for, how much room
// there is beyond two radii (the margin so far counts from four), and one radius.
void mask_by_second(double radius, const Grid& grid, const Mesh& mesh, const SecondMap& second, FullMap& map) {
  constexpr double nothing = 0.01;
  double largest = 0;
  for (Eigen::Index i = 0; i < second.c2.size(); ++i)
    if (std::isfinite(second.c2[i])) largest = std::max(largest, std::abs(map.at_corners[i]));
  for (Eigen::Index i = 0; i < second.c2.size(); ++i) {
    if (!std::isfinite(second.c2[i]) || !std::isfinite(map.at_corners[i])) continue;
    const double T = std::max(std::abs(map.at_corners[i]), nothing * largest),
                 reach = valid_radius_of({T, second.c2[i], second.unsure[i], second.parts[i], second.clear[i]});
    map.margin[i] = std::min({reach - radius, map.margin[i] + (clear_radii - room_radii) * radius, radius});
    map.masked_corner[static_cast<std::size_t>(i)] = map.margin[i] < 0;
  }
  const Corners& corners = grid.shape;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    double mean = 0;
    for (const Index c : corners.of[t]) mean += map.margin[c] / 3;
    map.masked_centroid[t] = mean < 0;
  }
}

// At the corners. A c2 whose sign the interpolation leaves open is not told, nor one that is a small rest of its parts;
// how far the first term reaches is.
void fill_second(const Analysis& a, const Functional& j, const MapRequest& r, const Grid& grid, FullMap& map) {
  const SecondMap second = second_everywhere(
      a, j, r.perturbation, {grid.corners.x, grid.corners.in, std::vector<bool>(grid.corners.x.size(), false)});
  map.c2 = second.c2;
  map.second_note = second.note;
  map.valid_radius.resize(map.c2.size());
  for (Eigen::Index i = 0; i < map.c2.size(); ++i) {
    map.valid_radius[i] =
        valid_radius_of({map.at_corners[i], second.c2[i], second.unsure[i], second.parts[i], second.clear[i]});
    constexpr double rest = 0.2;  // beside tips the map misses a reply by as much as a fifth
    if (std::max(second.unsure[i], rest * second.parts[i]) > std::abs(second.c2[i])) map.c2[i] = nan;
  }
  mask_by_second(r.radius, grid, a.model->mesh, second, map);
}

/// Where J has an adjoint, it is loaded in rough places of its own (jumps of weights, sides that are held), and what
/// these cost everywhere falls with the mesh alone: edges are shorter, so that the better solution errs by less than a
/// third there, too.
Mesh mesh_for(const Analysis& a, const Meshing& meshing, const MapFields& own) {
  constexpr double beside_adjoints = 0.65;
  const double longer = a.adjoint ? beside_adjoints : longer_edges(a.model->element);
  Sizing sizing = meshing.sizing;
  sizing.size *= longer;
  const Mesh& mesh = a.model->mesh;
  return triangulate(meshing.shape, sizing, {&mesh, better_sizes(mesh, own.corners, own.singular, longer)});
}

// The solution that error bars compare with.
struct Finer {
  Finer(const Analysis& a, const Functional& j, const Meshing& meshing, const MapFields& own)
      : model(prepare(mesh_for(a, meshing, own), better_element(a.model->element), a.model->scene, a.model->threads)),
        state(solve(model)) {
    if (!certified(state))
      throw Error(Fault::Numerics, "the better solution for error bars (map.bounds) did not converge");
    analysis = analyze(j, model, state);
    analysis.fields = recover_fields(analysis);
  }
  Finer(const Finer&) = delete;

  Model model;
  State state;
  Analysis analysis;
};

// Points, each in a triangle or in none, and those in one in the order of their triangles.
struct Scattered {
  const std::vector<Vec2>& x;
  const std::vector<Index>& in;
  std::vector<Index> order, first;  // where the points of the next triangle begin in `order`, and its end

  Scattered(const std::vector<Vec2>& x, const std::vector<Index>& in) : x(x), in(in) {
    for (std::size_t i = 0; i < in.size(); ++i)
      if (in[i] != none) order.push_back(static_cast<Index>(i));
    std::ranges::stable_sort(order, {}, [&](Index i) { return in[static_cast<std::size_t>(i)]; });
    for (std::size_t k = 0; k < order.size(); ++k)
      if (k == 0 || triangle_of(k) != triangle_of(k - 1)) first.push_back(static_cast<Index>(k));
    first.push_back(static_cast<Index>(order.size()));
  }
  Index triangle_of(std::size_t place) const {
    return in[static_cast<std::size_t>(order[place])];
  }
};

// What displacement_at gives, once for the points of a triangle.
Points displacements_at(const FieldOf& of, const Scattered& points, bool recovered) {
  Points u = Points::Zero(2, static_cast<Eigen::Index>(points.x.size()));
  parallel_for(static_cast<Index>(points.first.size()) - 1, of.model.threads, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      const auto run = static_cast<std::size_t>(k), from = static_cast<std::size_t>(points.first[run]);
      const Index t = points.triangle_of(from);
      Points x(2, points.first[run + 1] - points.first[run]);
      for (Eigen::Index i = 0; i < x.cols(); ++i)
        x.col(i) = points.x[static_cast<std::size_t>(points.order[from + static_cast<std::size_t>(i)])];
      const Points found = recovered ? recovered_displacement(of.model, of.field, t, x)
                                     : evaluate(of.model, of.field, t, x).displacement;
      for (Eigen::Index i = 0; i < x.cols(); ++i)
        u.col(points.order[from + static_cast<std::size_t>(i)]) = found.col(i);
    }
  });
  return u;
}

// expand_at of all points; NaN where there is no triangle.
Eigen::VectorXd sampled_expansion(const Expansion& e, const MapFields& fields, const Scattered& points) {
  const Model& m = *e.a.model;
  std::vector<Points> moved;  // per FieldOf::number
  ask(e, [&](const FieldOf& of, bool recovered) {
    moved.resize(std::max(moved.size(), of.number + 1));
    moved[of.number] = displacements_at(of, points, recovered);
  });
  Eigen::VectorXd value(static_cast<Eigen::Index>(points.x.size()));
  parallel_for(static_cast<Index>(points.x.size()), m.threads, [&](Index begin, Index end) {
    std::vector<bool> closed = no_row_closed(e.a);
    for (Index i = begin; i < end; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const Index t = points.in[k];
      if (t == none) {
        value[i] = nan;
        continue;
      }
      PointValues v = point_values(
          e,
          [&](const FieldOf& of) {
            return recovered_at(of.model, of.field, fields.corners, fields.recovered[of.number], {t, points.x[k]});
          },
          [&](const FieldOf& of, bool) -> Vec2 { return moved[of.number].col(i); });
      set_place(e, t, points.x[k], v);
      value[i] = expand(e, v, closed).value;
    }
  });
  return value;
}

}  // namespace

std::vector<MapPoint> map_at(const Analysis& a, const Functional& j, const MapRequest& r,
                             std::span<const Vec2> points) {
  const Model& m = *a.model;
  const std::vector<bool> masked = too_close(m, j, points, clear_radii * r.radius, r.radius);
  std::vector<MapPoint> map(points.size());
  if (!has_series(r.perturbation)) {
    const std::vector<double> value = clamped_at(a, j, r.radius, points);
    const std::vector<Index> where = locate(m.mesh, points);
    for (std::size_t i = 0; i < points.size(); ++i)
      map[i] = {.at = points[i], .value = value[i], .masked = masked[i] && where[i] != none};
    return map;
  }
  const Expansion e(a, j, r.perturbation);
  const std::vector<Index> where = locate(m.mesh, points);
  const std::shared_ptr<const MapFields> fields = fields_of(a);
  std::vector<bool> closed = no_row_closed(a);
  for (std::size_t i = 0; i < points.size(); ++i) {
    map[i] = {.at = points[i], .value = nan, .masked = masked[i] && where[i] != none};
    if (where[i] == none) continue;
    const Oriented t = expand_at(e, *fields, where[i], points[i], closed);
    map[i].value = t.value;
    map[i].angle = t.angle;
  }
  if (!r.second) return map;
  SecondOrders second(a, j, r.perturbation);
  const Mesh& mesh = whole_mesh(m);
  const std::vector<double> clear =
      margins(m, j, points, {0, 0, quality(mesh).h_max * std::sqrt(mesh.triangles.size())});
  for (std::size_t i = 0; i < map.size(); ++i) {
    MapPoint& p = map[i];
    const SecondOrder found = second.at(p.at);
    p.c2 = found.c2;
    p.valid_radius = valid_radius_of({p.value, found.c2, 0, parts_of(found), clear[i]});
    // Where the second term is known it decides what is masked, instead of four radii of room.
    if (std::isnan(*p.valid_radius)) continue;
    p.masked = *p.valid_radius < r.radius || too_close(m, j, {&p.at, 1}, room_radii * r.radius, r.radius)[0];
  }
  return map;
}

// The mask first, since a clamped map skips what is masked; recovery once for centroids and corners.
FullMap map_everywhere(const Analysis& a, const Functional& j, const MapRequest& r, const Corners& corners) {
  const Grid grid{centroids(a.model->mesh), at_corners(a.model->mesh, corners), corners};
  FullMap map;
  mask(a, j, r.radius, grid, map);
  if (!has_series(r.perturbation)) {
    fill_clamped(a, j, r.radius, grid, map);
    return map;
  }
  const std::shared_ptr<const MapFields> fields = fields_of(a, corners);
  if (fields->corners.vertex.size() != corners.vertex.size())
    throw std::invalid_argument("map_everywhere: the corners are those of split_for_stress");
  const Expansion e(a, j, r.perturbation);
  const Everywhere everywhere(e, *fields);
  everywhere.fill(grid.centroids, &RecoveredStress::at_centroids, &Displacements::at_centroids, map.at_centroids,
                  is_directed(r.perturbation) ? &map.angle : nullptr);
  everywhere.fill(grid.corners, &RecoveredStress::at_corners, &Displacements::at_corners, map.at_corners);
  if (r.second) fill_second(a, j, r, grid, map);
  return map;
}

// From the element's own stresses, unrecovered, and with a change of its own per triangle: for level sets.
Eigen::VectorXd map_at_centroids(const Analysis& a, const Functional& j,
                                 const std::function<const Perturbation&(Index triangle)>& change) {
  const Model& m = *a.model;
  const Index n = static_cast<Index>(m.mesh.triangles.size());
  Eigen::VectorXd value(n);
  parallel_for(n, m.threads, [&](Index begin, Index end) {
    std::vector<bool> closed = no_row_closed(a);
    for (Index t = begin; t < end; ++t) {
      const Expansion e(a, j, change(t));
      const Triangle shape = triangle(m, t);
      const Vec2 x = centroid(shape);
      PointValues v = point_values(
          e,
          [&](const FieldOf& of) { return components(stress_at(m.inner->kernel, shape, of.field.interior.col(t), x)); },
          [&](const FieldOf& of, bool recovered) { return displacement_at(of.model, of.field, t, x, recovered); });
      set_place(e, t, x, v);
      value[t] = expand(e, v, closed).value;
    }
  });
  return value;
}

// The same expansion of both solutions at the same places; half widths at corners go to points by interpolation.
void add_bars(const Analysis& a, const Functional& j, const MapRequest& r, const Meshing& meshing, const Maps& maps) {
  const Mesh& mesh = a.model->mesh;
  const std::shared_ptr<const MapFields> own = fields_of(a);
  const Finer finer(a, j, meshing, *own);
  const MapFields& better = *finer.analysis.fields;
  const Expansion e(a, j, r.perturbation), e_finer(finer.analysis, j, r.perturbation);
  const Places at = places(mesh, own->corners, finer.model.mesh);
  ErrorBars bars = error_bars(own->corners, sampled_expansion(e, *own, {at.x, at.own}),
                              sampled_expansion(e_finer, better, {at.x, at.better}));
  // Measured on 131 random problems with an adjoint (tests/app/map_bars_test.cpp draws others).
  const double safety = a.adjoint ? 2 : 1;
  bars.at_corners *= safety;
  maps.everywhere.lower = maps.everywhere.at_corners - bars.at_corners;
  maps.everywhere.upper = maps.everywhere.at_corners + bars.at_corners;
  std::vector<Vec2> x;
  for (const MapPoint& p : maps.points) x.push_back(p.at);
  const std::vector<Index> where = locate(mesh, x), there = locate(finer.model.mesh, x);
  std::vector<bool> closed = no_row_closed(finer.analysis);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (where[i] == none || there[i] == none) continue;
    MapPoint& p = maps.points[i];
    const double finest = expand_at(e_finer, better, there[i], x[i], closed).value;
    const double half = safety * half_width_at(mesh, own->corners, bars, {where[i], x[i]}, p.value - finest);
    p.lower = p.value - half;
    p.upper = p.value + half;
  }
}

}  // namespace kerf
