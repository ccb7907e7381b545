// A mesh that follows curves. Vertices on chains and on sides of the frame next to sliding ends keep their share of
// their arc or side [theory: K.2], and the others are carried along by the harmonic extension of their motion [theory:
// S.7]. So J is a smooth function of the variables, and its derivative by them is that by the vertices (S.3), gathered
// onto the boundary by the transposed extension and pulled back through the arcs. A motion that makes angles too small
// or stretches edges too far gives no mesh: the curves then need one of their own. docs/theory/curves.md, "Variables
// and the shape residual", and docs/theory/shape_gradient.md, "Carrying a motion into the mesh".

#include "optimize/curves/curve_mesh.hpp"

#include "geometry/plane.hpp"
#include "kerf/mesher.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr Strain most{.least_angle = 10,
                      .stretch = 2.5};  // more than drawn designs are moved: fewer meshes, less noise

// By share of its length, or of its arc's parameter.
Vec2 on(const SideEnds& s, double part) {
  if (!s.side.arc) return (1 - part) * s.side.start + part * s.end;
  return at(*s.side.arc, s.side.arc->from + part * (s.side.arc->to - s.side.arc->from));
}

const KnotHold& hold(const DesignCurves& d, const KnotRef& ref) {
  return d.holds[std::size_t(ref.chain)][std::size_t(ref.knot)];
}

bool slides(const DesignCurves& d, const KnotRef& ref) {
  return ref.chain != none && hold(d, ref).kind == KnotHold::Kind::Slides;
}

/// Every vertex on a side next to a chain whose end slides.
/// On an arc the share is that of the angle.
void add_side_followers(const DesignCurves& d, const Shape& shape, const Mesh& mesh, std::vector<bool>& taken,
                        std::vector<CurveFollower>& all) {
  const double near = 1e-9 * extent(shape);
  for (std::size_t l = 0; l < d.loops.size(); ++l)
    for (std::size_t i = 0; i < d.loops[l].pieces.size(); ++i) {
      if (d.loops[l].pieces[i].chain != none) continue;
      const SideEnds ends = side_ends(d, shape, l, i);
      if (!slides(d, ends.before) && !slides(d, ends.after)) continue;
      for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
        if (mesh.label[e] != ends.side.label || (mesh.sides[e][0] != none && mesh.sides[e][1] != none)) continue;
        for (const Index v : mesh.edges[e]) {
          if (taken[std::size_t(v)]) continue;
          const Vec2& x = mesh.points[std::size_t(v)];
          double part = foot(x, ends.side.start, ends.end);
          if (ends.side.arc) {
            const Arc& arc = *ends.side.arc;
            part = std::clamp(0.5 + beyond_middle(arc, x) / (arc.to - arc.from), 0.0, 1.0);
          }
          // The label may be that of other sides as well.
          if ((on(ends, part) - x).norm() > near) continue;
          taken[std::size_t(v)] = true;
          all.push_back({.vertex = v, .loop = Index(l), .piece = Index(i), .part = part});
        }
      }
    }
}

// Every vertex on an edge with the label of the design belongs to the chain that comes nearest to it, at the place of
// its foot.
std::vector<CurveFollower> followers(const DesignCurves& d, const Shape& shape, const Mesh& mesh) {
  std::vector<CurveFollower> all;
  std::vector<Vec2> points;
  std::vector<bool> taken(mesh.points.size(), false);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.label[e] != d.label) continue;
    for (const Index v : mesh.edges[e]) {
      if (taken[std::size_t(v)]) continue;
      taken[std::size_t(v)] = true;
      all.push_back({.vertex = v});
      points.push_back(mesh.points[std::size_t(v)]);
    }
  }
  std::vector<double> least(points.size(), infinity);
  for (std::size_t c = 0; c < d.chains.size(); ++c) {
    const std::vector<ChainPlace> places = nearest(d.chains[c], points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double away = (at(d.chains[c], places[k]) - points[k]).squaredNorm();
      if (away < least[k]) least[k] = away, all[k].chain = Index(c), all[k].place = places[k];
    }
  }
  add_side_followers(d, shape, mesh, taken, all);
  return all;
}

// Where the followers are on the curves d, which have the same knots as those the mesh was made for.
Points positions(const std::vector<CurveFollower>& followers, const DesignCurves& d) {
  const Shape shape = shape_of(d);
  Points x(2, Eigen::Index(followers.size()));
  for (std::size_t k = 0; k < followers.size(); ++k) {
    const CurveFollower& f = followers[k];
    x.col(Eigen::Index(k)) = f.chain != none
                                 ? at(d.chains[std::size_t(f.chain)], f.place)
                                 : on(side_ends(d, shape, std::size_t(f.loop), std::size_t(f.piece)), f.part);
  }
  return x;
}

}  // namespace

CurveMesh curve_mesh(const DesignCurves& d, const Sizing& sizing) {
  const Shape shape = shape_of(d);
  Mesh mesh = triangulate(shape, sizing);
  std::vector<CurveFollower> f = followers(d, shape, mesh);
  Extension extension = make_extension(mesh, vertices_that_mean_something(mesh));
  std::vector<double> angles = smallest_angles(mesh);
  Points start = positions(f, d);
  return {std::move(mesh), std::move(f), std::move(extension), std::move(angles), std::move(start)};
}

// Only the followers are given: the extension moves all other vertices.
std::optional<Mesh> moved(const CurveMesh& m, const DesignCurves& d) {
  Points motion = Points::Zero(2, Eigen::Index(m.mesh.points.size()));
  const Points to = positions(m.followers, d);
  for (std::size_t k = 0; k < m.followers.size(); ++k)
    motion.col(m.followers[k].vertex) = to.col(Eigen::Index(k)) - m.start.col(Eigen::Index(k));
  return carry(m.extension, m.mesh, m.angles, motion, most);
}

// dJ/dvariable = sum over followers of pull . dx/dvariable, pull the force on the vertices carried back by the
// transposed extension.
Eigen::VectorXd pull_back(const CurveMesh& m, const DesignCurves& d, const Points& force) {
  const Points on_given = gather(m.extension, force);
  const Shape shape = shape_of(d);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(d.variables);
  for (const CurveFollower& f : m.followers) {
    const Vec2 pull = on_given.col(f.vertex);
    if (f.chain != none) {
      const ChainPoint p = point_on(d.chains[std::size_t(f.chain)], f.place);
      add_by_segment(d, f.chain, f.place.arc / 2, pull.transpose() * p.by, sum);
      continue;
    }
    const SideEnds ends = side_ends(d, shape, std::size_t(f.loop), std::size_t(f.piece));
    for (const auto& [ref, share, x] :
         {std::tuple{ends.before, 1 - f.part, ends.side.start}, std::tuple{ends.after, f.part, ends.end}}) {
      if (!slides(d, ref)) continue;
      const Rail& rail = d.rails[std::size_t(hold(d, ref).rail)];
      // A vertex at share f of a side moves with both ends: 1 - f of the one and f of the other, each in the coordinate
      // of its rail.
      const double unit = rail.velocity(rail.at(x)).norm();
      const Vec2 here = rail.velocity(rail.at(on(ends, f.part)));
      sum[hold(d, ref).offset] += hold(d, ref).offset_sign * share * here.dot(pull) / unit;
    }
  }
  return sum;
}

}  // namespace kerf
