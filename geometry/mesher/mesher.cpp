// A shape to a mesh of triangles, with CGAL's constrained Delaunay triangulation. In this order:
// 1. the drawing (shape/drawing.hpp) and the target edge length h(x) at every point (size_field.hpp);
// 2. sides and cracks in pieces of about h (split.cpp), inserted as constraints;
// 3. points of hexagonal lattices inside (lattice.cpp), most of the points of the mesh, which need no search;
// 4. Delaunay refinement of triangles with an edge longer than 1.6 h or an angle below the least one; edges to be kept
// (of patches, of holes for balls) are never split: what would encroach upon them is left as it is;
// 5. points of curved cracks moved to their arcs, labels, cracks, regions, curved edges (Mesh::arc);
// 6. smoothing (smooth.cpp).
// With `mirrored_tips` a patch around each tip is meshed on one side, mirrored, and left out of the rest: see "False
// pressure at sliding tips" in docs/theory/fracture.md. Deterministic: the order of insertion depends on the drawing
// alone.

#include "kerf/mesher.hpp"
#include "geometry/topology.hpp"
#include "kerf/stop.hpp"

#include "geometry/mesher/lattice.hpp"
#include "geometry/mesher/smooth.hpp"
#include "geometry/mesher/tips.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace kerf {

namespace {

constexpr int sweeps = 8;  // of smoothing
constexpr double max_triangles = 2e7;
constexpr double longest_edge = 1.6;  // of the target length: lattice edges reach sqrt 2

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
struct Number {
  Index value = none;
  std::array<Index, 2> kept{none, none};  // the other ends of its edges that are to be kept
};
using VertexInfo = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using VertexBase = CGAL::Delaunay_mesh_vertex_base_2<Kernel, VertexInfo>;
using FaceBase = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;
using Vertex = Triangulation::Vertex_handle;
using Face = Triangulation::Face_handle;

Vec2 vec(const Kernel::Point_2& p) {
  return {p.x(), p.y()};
}

/// What CGAL's mesher asks about a face: too long an edge for the size field (to be mended in any case), or too small
/// an angle (to be mended unless the input forces it).
/// The angle: the square of the sine of the smallest one, (2 area)^2 over the product of the two longer sides squared.
class Criteria {
 public:
  Criteria(const SizeField& field, double min_angle_deg) : field_(&field) {
    const double sine = std::sin(min_angle_deg * pi / 180);
    least_squared_sine_ = sine * sine;
  }

  struct Quality {
    double squared_sine = 1, oversize = 0;
    bool operator<(const Quality& q) const {  // true: mend this one first
      if (oversize > 1 || q.oversize > 1) return oversize > q.oversize;
      return squared_sine < q.squared_sine;
    }
  };

  class Is_bad {
   public:
    Is_bad(const SizeField& field, double least_squared_sine)
        : field_(&field), least_squared_sine_(least_squared_sine) {}

    CGAL::Mesh_2::Face_badness operator()(const Quality& q) const {
      if (q.oversize > 1) return CGAL::Mesh_2::IMPERATIVELY_BAD;
      return q.squared_sine < least_squared_sine_ ? CGAL::Mesh_2::BAD : CGAL::Mesh_2::NOT_BAD;
    }
    CGAL::Mesh_2::Face_badness operator()(const Face& face, Quality& q) const {
      const Vec2 a = vec(face->vertex(0)->point()), b = vec(face->vertex(1)->point()),
                 c = vec(face->vertex(2)->point());
      std::array<double, 3> squared{(c - b).squaredNorm(), (a - c).squaredNorm(), (b - a).squaredNorm()};
      std::sort(squared.begin(), squared.end());
      const double h = longest_edge * size_at(*field_, (a + b + c) / 3);
      const double twice = cross(b - a, c - a);
      q.oversize = squared[2] / (h * h);
      q.squared_sine = q.oversize > 1 ? 1 : twice * twice / (squared[1] * squared[2]);
      return (*this)(q);
    }

   private:
    const SizeField* field_;
    double least_squared_sine_;
  };
  Is_bad is_bad_object() const {
    return {*field_, least_squared_sine_};
  }

 private:
  const SizeField* field_;
  double least_squared_sine_;
};

/// Limits that would end in hours or in rounding: 2e7 triangles, 1e-11 of the extent, 30 degrees.
Sizing checked(const Shape& shape, Sizing sizing) {
  const double whole = extent(shape);
  const auto require = [](bool holds, const std::string& words) {
    if (!holds) throw Error(Fault::Geometry, words);
  };
  require(std::isfinite(sizing.size) && sizing.size >= 0, "mesh.size must be a positive length, or 0 for the default");
  require(std::isfinite(sizing.crack_tip_size) && sizing.crack_tip_size >= 0,
          "mesh.crack_tip_size must be a positive length, or 0 for the default");
  require(std::isfinite(sizing.grading) && sizing.grading >= 0.01 && sizing.grading <= 2,
          "the grading of the mesh must lie between 0.01 and 2");
  require(sizing.min_angle_deg >= 0 && sizing.min_angle_deg <= 30,
          "mesh.min_angle must lie between 0 and 30 degrees: no mesher can promise more");
  sizing.size = target_size(sizing, shape);
  sizing.size = std::min(sizing.size, whole);
  if (sizing.crack_tip_size == 0) sizing.crack_tip_size = sizing.size / 100;
  sizing.crack_tip_size = std::min(sizing.crack_tip_size, sizing.size);
  const double predicted = area(shape) / (std::sqrt(3.0) / 4 * sizing.size * sizing.size);
  require(predicted <= max_triangles,
          fmt::format("mesh.size = {:.3g} would give about {:.2g} triangles; at most {:.0e} are allowed", sizing.size,
                      predicted, max_triangles));
  require(sizing.crack_tip_size >= 1e-11 * whole,
          fmt::format("mesh.crack_tip_size = {:.3g} is below the digits of the coordinates of a body of extent {:.3g}",
                      sizing.crack_tip_size, whole));
  return sizing;
}

/// The pieces as constraints of an empty triangulation; vertices carry the number of their point. Points enter in ever
/// finer subsets of the path, each next to one already there: in path order every new point would see all earlier ones.
std::vector<Vertex> insert_pieces(Triangulation& triangulation, const Pieces& pieces) {
  std::vector<Vertex> vertex(pieces.points.size());
  const std::size_t end = pieces.pieces.size();
  std::size_t stride = 1;
  while (2 * stride < end) stride *= 2;
  const auto insert = [&](Index v, std::size_t before) {
    if (vertex[std::size_t(v)] != Vertex()) return;
    const Vertex close = vertex[std::size_t(pieces.pieces[before].a)];
    const Vec2& x = pieces.points[std::size_t(v)];
    const Vertex added = triangulation.insert({x.x(), x.y()}, close == Vertex() ? Face() : close->face());
    if (added->info().value != none)
      throw Error(Fault::Geometry, fmt::format("two points of the shape coincide at ({:.6g}, {:.6g})", x.x(), x.y()));
    added->info().value = v;
    vertex[std::size_t(v)] = added;
  };
  for (std::size_t i = 0; i < end; i += stride) insert(pieces.pieces[i].a, i >= stride ? i - stride : 0);
  for (; stride > 1; stride /= 2)
    for (std::size_t i = stride / 2; i < end; i += stride) insert(pieces.pieces[i].a, i - stride / 2);
  for (std::size_t i = 0; i < end; ++i) insert(pieces.pieces[i].b, i);  // ends of cracks
  const auto count = triangulation.number_of_vertices();
  for (const Piece& piece : pieces.pieces)
    triangulation.insert_constraint(vertex[std::size_t(piece.a)], vertex[std::size_t(piece.b)]);
  for (const Piece& piece : pieces.pieces)
    if (piece.keep)
      for (const auto& [from, to] : {std::array{piece.a, piece.b}, std::array{piece.b, piece.a}}) {
        std::array<Index, 2>& kept = vertex[std::size_t(from)]->info().kept;
        kept[kept[0] == none ? 0 : 1] = to;
      }
  if (triangulation.number_of_vertices() != count)
    throw Error(Fault::Geometry, "sides or cracks of the shape cross within the digits of their coordinates");
  return vertex;
}

/// Marks the faces inside: crossing a loop changes sides, crossing a crack does not.
void mark_domain(Triangulation& triangulation, const Drawing& drawing, const Pieces& pieces) {
  std::vector<Index> next(pieces.points.size(), none);  // along loops
  for (const Piece& piece : pieces.pieces)
    if (drawing.strands[std::size_t(piece.strand)].loop != none) next[std::size_t(piece.a)] = piece.b;
  const auto on_loop = [&](const Face& face, int i) {
    if (!face->is_constrained(i)) return false;
    const Index a = face->vertex(Triangulation::ccw(i))->info().value,
                b = face->vertex(Triangulation::cw(i))->info().value;
    return next[std::size_t(a)] == b || next[std::size_t(b)] == a;
  };
  for (const Face face : triangulation.all_face_handles()) face->set_in_domain(false);
  std::vector<std::pair<Face, bool>> open{{triangulation.infinite_face(), false}};
  CGAL::Unique_hash_map<Face, bool> seen(false, triangulation.number_of_faces());
  seen[triangulation.infinite_face()] = true;
  while (!open.empty()) {
    const auto [face, inside] = open.back();
    open.pop_back();
    for (int i = 0; i < 3; ++i) {
      const Face other = face->neighbor(i);
      if (seen[other]) continue;
      seen[other] = true;
      const bool there = inside != on_loop(face, i);
      other->set_in_domain(there);
      open.push_back({other, there});
    }
  }
}

std::string nearest_name(const Shape& shape, const Drawing& drawing, const Pieces& pieces, const Vec2& x) {
  double least = infinity;
  std::string name;
  for (const Piece& piece : pieces.pieces) {
    const double d = distance(x, pieces.points[std::size_t(piece.a)], pieces.points[std::size_t(piece.b)]);
    if (d >= least) continue;
    least = d;
    name = kerf::name(shape, drawing.strands[std::size_t(piece.strand)]);
  }
  return name;
}

/// Edges that are to be kept count as conforming, whatever lies in their diametral circles.
struct Conforming : CGAL::Mesh_2::Is_locally_conforming_Gabriel<Triangulation> {
  using Gabriel = CGAL::Mesh_2::Is_locally_conforming_Gabriel<Triangulation>;
  static bool kept(const Vertex& a, const Vertex& b) {
    const Index to = b->info().value;
    return to != none && (a->info().kept[0] == to || a->info().kept[1] == to);
  }
  static bool kept(const Face& face, int i) {
    return kept(face->vertex(Triangulation::cw(i)), face->vertex(Triangulation::ccw(i)));
  }
  template <class... More>
  bool operator()(const Triangulation& t, const Face& face, int i, const More&... more) const {
    return kept(face, i) || Gabriel::operator()(t, face, i, more...);
  }
  template <class... More>
  bool operator()(const Triangulation& t, const Vertex& a, const Vertex& b, const More&... more) const {
    return kept(a, b) || Gabriel::operator()(t, a, b, more...);
  }
};

/// The point that a bad triangle asks for does not enter where it would encroach upon an edge to be kept, or where such
/// an edge hides it from the triangle.
struct Edges : CGAL::Mesh_2::Refine_edges_with_clusters<Triangulation, Conforming> {
  using Base = CGAL::Mesh_2::Refine_edges_with_clusters<Triangulation, Conforming>;
  using Base::Base;
  bool keeps = false;  // whether there are such edges

  CGAL::Mesher_level_conflict_status test_point_conflict_from_superior(
      const Kernel::Point_2& p, CGAL::Triangulation_mesher_level_traits_2<Triangulation>::Zone& zone) {
    const auto encroached = [&](const Triangulation::Edge& edge) {
      const auto& [face, i] = edge;
      return face->is_constrained(i) && Conforming::kept(face, i) &&
             CGAL::angle(face->vertex(Triangulation::cw(i))->point(), p,
                         face->vertex(Triangulation::ccw(i))->point()) != CGAL::ACUTE;
    };
    if (keeps && (std::ranges::find(zone.faces, zone.parent_face) == zone.faces.end() ||
                  std::ranges::any_of(zone.boundary_edges, encroached)))
      return CGAL::CONFLICT_AND_ELEMENT_SHOULD_BE_DROPPED;
    return Base::test_point_conflict_from_superior(p, zone);
  }
};

/// `budget`: refinement of a healthy drawing takes a small part of it; where two sides nearly touch it may never end.
void refine(Triangulation& triangulation, Criteria criteria, const Shape& shape, const Drawing& drawing,
            const Pieces& pieces) {
  // As in CGAL::Delaunay_mesher_2, which does not let its edges be replaced.
  CGAL::Null_mesher_level no_level;
  CGAL::Null_mesh_visitor no_visitor;
  CGAL::Mesh_2::Clusters<Triangulation> clusters(triangulation);
  Edges edges(triangulation, clusters, no_level);
  edges.keeps = std::ranges::any_of(pieces.pieces, &Piece::keep);
  using Faces = CGAL::Mesh_2::Refine_faces<Triangulation, Criteria, Edges>;
  Faces faces(triangulation, criteria, edges);
  const CGAL::Mesh_2::Refine_edges_visitor_from_faces<Faces> visitor(faces, edges, no_visitor);
  const std::size_t start = triangulation.number_of_vertices();
  const std::size_t budget = 200000 + 20 * start;
  CGAL::Delaunay_mesher_2<Triangulation, Criteria>::propagate_marks(triangulation.infinite_face(), false);
  clusters.create_clusters();
  edges.scan_triangulation();
  faces.scan_triangulation();
  for (std::size_t step = 0; !faces.is_algorithm_done(); ++step) {
    if (step % 10000 == 0) check_stop();
    if (step == budget) {
      const Vec2 x = vec(edges.is_algorithm_done() ? faces.refinement_point(faces.get_next_element())
                                                   : edges.refinement_point(edges.get_next_element()));
      throw Error(Fault::Geometry,
                  fmt::format("the mesh around ({:.6g}, {:.6g}), next to {}, does not settle: {} refinement steps were "
                              "not enough; look there for nearly touching sides or very small angles",
                              x.x(), x.y(), nearest_name(shape, drawing, pieces, x), budget));
    }
    faces.one_step(visitor);
  }
}

/// The vertices along the constraint from a to b, which the refinement may have split.
/// Vertices of the drawing have numbers, those that refinement has put in have none: a chain ends at the next number.
std::vector<Vertex> chain(const Triangulation& triangulation, const Vertex& a, const Vertex& b) {
  const auto each_neighbor = [&](const Vertex& v, auto&& visit) {
    auto edge = triangulation.incident_edges(v);
    const auto begin = edge;
    do {
      const auto& [face, i] = *edge;
      if (!face->is_constrained(i)) continue;
      const Vertex u = face->vertex(Triangulation::ccw(i)), w = face->vertex(Triangulation::cw(i));
      visit(u == v ? w : u);
    } while (++edge != begin);
  };
  std::vector<Vertex> path, found;
  each_neighbor(a, [&](const Vertex& first) {
    path = {a, first};
    while (path.back()->info().value == none) {
      const Vertex before = path[path.size() - 2];
      Vertex after;
      each_neighbor(path.back(), [&](const Vertex& v) {
        if (v != before) after = v;
      });
      path.push_back(after);
    }
    if (path.back() == b) found = path;
  });
  return found;
}

/// An edge that follows an arc from a to b.
struct Followed {
  Index a, b;
  Arc arc;
};

/// Arcs run from the smaller vertex of their edge to the larger one.
void follow(Mesh& mesh, const std::vector<Followed>& followed) {
  if (followed.empty()) return;
  std::map<std::pair<Index, Index>, const Followed*> between;
  for (const Followed& f : followed) between[std::minmax(f.a, f.b)] = &f;
  mesh.arc.assign(mesh.edges.size(), none);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto found = between.find({mesh.edges[e][0], mesh.edges[e][1]});
    if (found == between.end()) continue;
    mesh.arc[e] = Index(mesh.arcs.size());
    mesh.arcs.push_back(found->second->arc);
    if (found->second->a != mesh.edges[e][0]) std::swap(mesh.arcs.back().from, mesh.arcs.back().to);
  }
}

/// A mesh, its points on the chords of curved cracks with their places on the arcs, and the edges around regions.
struct Rough {
  std::vector<Vec2> points;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Marked> marked;
  std::vector<std::pair<Index, Vec2>> places;
  struct RegionEdge {
    Index a, b, region;           // on the left from a to b
    std::optional<Index> beyond;  // on the right, where that is known
  };
  std::vector<RegionEdge> around_regions;
  std::vector<Followed> followed;
};

/// Only faces of the domain count; points get their numbers in the order in which triangles name them. Along a piece
/// that the refinement has split, places on the arc are in proportion to the places on the chord.
Rough mesh_of(const Shape& shape, const Drawing& drawing, const Pieces& pieces, const SizeField& field,
              double min_angle_deg, bool curved) {
  Triangulation triangulation;
  const std::vector<Vertex> vertex = insert_pieces(triangulation, pieces);
  Face hint = vertex.front()->face();
  for (const Vec2& x : lattice_points(drawing, pieces, field, std::size_t(max_triangles / 2)))
    hint = triangulation.insert({x.x(), x.y()}, hint)->face();
  mark_domain(triangulation, drawing, pieces);
  refine(triangulation, Criteria(field, min_angle_deg), shape, drawing, pieces);

  std::vector<std::vector<Vertex>> chains;
  for (const Piece& piece : pieces.pieces) {
    chains.push_back(chain(triangulation, vertex[std::size_t(piece.a)], vertex[std::size_t(piece.b)]));
    if (chains.back().empty())
      throw Error(Fault::Geometry,
                  fmt::format("the mesher lost an edge of {} at ({:.6g}, {:.6g}); something nearly touches it there",
                              nearest_name(shape, drawing, pieces, pieces.points[std::size_t(piece.a)]),
                              pieces.points[std::size_t(piece.a)].x(), pieces.points[std::size_t(piece.a)].y()));
  }
  for (const Vertex v : triangulation.finite_vertex_handles()) v->info().value = none;
  Rough rough;
  rough.points.reserve(triangulation.number_of_vertices());
  rough.triangles.reserve(triangulation.number_of_faces());
  for (const Face face : triangulation.finite_face_handles()) {
    if (!face->is_in_domain()) continue;
    std::array<Index, 3> t;
    for (int i = 0; i < 3; ++i) {
      Index& number = face->vertex(i)->info().value;
      if (number == none) {
        number = Index(rough.points.size());
        rough.points.push_back(vec(face->vertex(i)->point()));
      }
      t[std::size_t(i)] = number;
    }
    rough.triangles.push_back(t);
  }
  for (std::size_t i = 0; i < chains.size(); ++i) {
    const Piece& piece = pieces.pieces[i];
    const Strand& strand = drawing.strands[std::size_t(piece.strand)];
    for (std::size_t k = 0; k + 1 < chains[i].size(); ++k) {
      const Index a = chains[i][k]->info().value, b = chains[i][k + 1]->info().value;
      if (strand.region != none || strand.beyond) rough.around_regions.push_back({a, b, strand.region, strand.beyond});
      if (strand.crack != none || strand.loop != none) rough.marked.push_back({a, b, strand.label, strand.crack});
    }
    if (!strand.arc || (strand.crack == none && !curved)) continue;
    std::vector<double> at{piece.from};  // of the chain's points on the strand
    const Vec2 &a = pieces.points[std::size_t(piece.a)], &b = pieces.points[std::size_t(piece.b)];
    for (std::size_t k = 1; k + 1 < chains[i].size(); ++k) {
      const double part = (vec(chains[i][k]->point()) - a).norm() / (b - a).norm();
      at.push_back(piece.from + part * (piece.to - piece.from));
      rough.places.push_back({chains[i][k]->info().value, point(drawing, strand, at.back())});
    }
    at.push_back(piece.to);
    if (!curved) continue;
    const auto turned = [&](double s) { return strand.arc->from + s * (strand.arc->to - strand.arc->from); };
    for (std::size_t k = 0; k + 1 < chains[i].size(); ++k) {
      const Arc arc{strand.arc->center, strand.arc->axes, turned(at[k]), turned(at[k + 1])};
      rough.followed.push_back({chains[i][k]->info().value, chains[i][k + 1]->info().value, arc});
    }
  }
  return rough;
}

/// The region of every triangle: inwards from the edges around a region as far as the next such edge.
std::vector<Index> regions(const Mesh& mesh, const std::vector<Rough::RegionEdge>& around) {
  if (around.empty()) return {};
  std::map<std::pair<Index, Index>, Index> edge;
  for (const Rough::RegionEdge& i : around) edge[std::minmax(i.a, i.b)] = none;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (const auto found = edge.find({mesh.edges[e][0], mesh.edges[e][1]}); found != edge.end())
      found->second = Index(e);
  std::vector<bool> cut(mesh.edges.size(), false);
  for (const auto& [ends, e] : edge) cut[std::size_t(e)] = true;
  const std::vector<Index> piece = pieces(mesh, cut);
  std::vector<Index> of_piece(mesh.triangles.size(), none), region;
  for (const Rough::RegionEdge& i : around) {
    const auto& sides = mesh.sides[std::size_t(edge[std::minmax(i.a, i.b)])];
    of_piece[std::size_t(piece[std::size_t(sides[i.a < i.b ? 0 : 1])])] = i.region;
    if (i.beyond) of_piece[std::size_t(piece[std::size_t(sides[i.a < i.b ? 1 : 0])])] = *i.beyond;
  }
  for (const Index p : piece) region.push_back(of_piece[std::size_t(p)]);
  return region;
}

/// Moves the points on chords to their arcs. False when that would flatten a triangle.
/// A triangle may lose up to 70 % of its area; beyond that the arcs get more pieces.
bool place_on_arcs(Rough& rough) {
  if (rough.places.empty()) return true;
  const auto twice = [&](const std::vector<Vec2>& x, const std::array<Index, 3>& t) {
    return cross(x[std::size_t(t[1])] - x[std::size_t(t[0])], x[std::size_t(t[2])] - x[std::size_t(t[0])]);
  };
  std::vector<Vec2> moved = rough.points;
  for (const auto& [v, x] : rough.places) moved[std::size_t(v)] = x;
  for (const std::array<Index, 3>& t : rough.triangles)
    if (!(twice(moved, t) > 0.3 * twice(rough.points, t))) return false;
  rough.points = std::move(moved);
  return true;
}

/// The box is that of the evenly split outline, arcs included.
SizeField field_of(const Shape& shape, const Drawing& drawing, const Sizing& sizing, const Background* background) {
  Vec2 low = drawing.corners.front(), high = low;
  const Pieces outline = split_evenly(drawing);
  for (const Vec2& x : outline.points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double margin = 0.01 * drawing.extent;
  SizeField field = size_field(find_sources(shape, drawing, sizing, !background), sizing.size, sizing.grading,
                               low.array() - margin, high.array() + margin);
  if (background) add_background(field, *background, 1e-9 * drawing.extent);
  add_kept(field, drawing);
  field.long_ligaments = sizing.long_ligaments;
  return field;
}

/// A drawing meshed and smoothed; and its edges that mean something, those of patches last.
struct Meshed {
  Mesh mesh;
  std::vector<Marked> marked;
  std::vector<Followed> followed;
};

/// `names`: whose words errors are in.
/// 16 times as many pieces on arcs at most; then a crossing is an error, and points stay on their chords.
Meshed mesh_drawing(const Shape& names, const Drawing& drawing, const SizeField& field, double min_angle_deg,
                    bool curved = false) {
  // Chords may touch what their arcs do not, and refinement may split them off the arc: then the arcs get more pieces.
  for (int finer = 1;; finer *= 2) {
    const Pieces pieces = split_to_size(drawing, field, finer, curved);
    const auto problem = find_crossing(names, drawing, pieces, {0, 0}, false);
    if (problem && finer == 16) throw Error(Fault::Geometry, *problem);
    if (problem) continue;
    Rough rough = mesh_of(names, drawing, pieces, field, min_angle_deg, curved);
    if (!place_on_arcs(rough) && finer < 16) continue;
    Mesh mesh = connect(std::move(rough.points), std::move(rough.triangles), rough.marked);
    mesh.region = regions(mesh, rough.around_regions);
    Smoothed smoothed = smooth(mesh, min_angle_deg, sweeps);
    mesh = connect(std::move(smoothed.points), std::move(smoothed.triangles), rough.marked, std::move(mesh.region));
    follow(mesh, rough.followed);
    return {std::move(mesh), std::move(rough.marked), std::move(rough.followed)};
  }
}

/// In units of the edge at the tip: one patch of a kind serves all tips of that kind.
Patch make_patch(const PatchKind& kind, double min_angle_deg) {
  const Shape half = half_disc(kind);
  const Vec2 margin = 0.1 * Vec2::Ones(), corner(kind.radius, kind.radius);
  const SizeField field = size_field({{Vec2::Zero(), Vec2::Zero(), 1}}, 1 + kind.grading * kind.radius, kind.grading,
                                     -corner - margin, corner + margin);
  return mirrored(mesh_drawing(half, draw(half), field, min_angle_deg).mesh);
}

/// Made once per kind.
struct Patches {
  double min_angle_deg;
  std::vector<std::pair<PatchKind, Patch>> made = {};

  const Patch& of(const PatchKind& kind) {
    const auto known = std::ranges::find(made, kind, &std::pair<PatchKind, Patch>::first);
    return known != made.end() ? known->second : made.emplace_back(kind, make_patch(kind, min_angle_deg)).second;
  }
};

/// The patches in their holes.
/// Cracks are marked along their path: patches at starts, the body, then patches at ends.
Mesh fill(Meshed outside, const std::vector<Patch>& patches) {
  Mesh& mesh = outside.mesh;
  std::size_t sides = 0;
  for (const Patch& patch : patches) sides += std::size_t(patch.boundary);
  auto side = outside.marked.end() - Index(sides);
  std::vector<Marked> body(outside.marked.begin(), side), marked, at_ends;  // along each crack from start to end
  std::vector<Index> region = mesh.region;
  std::map<std::pair<Index, Index>, Index> beside;  // the triangles that the patches touch
  if (!region.empty())
    for (std::size_t e = 0; e < mesh.edges.size(); ++e)
      if (const auto& [left, right] = mesh.sides[e]; left == none || right == none)
        beside[{mesh.edges[e][0], mesh.edges[e][1]}] = std::max(left, right);
  for (const Patch& patch : patches) {
    if (!region.empty())
      region.insert(region.end(), patch.triangles.size(),
                    region[std::size_t(beside.at(std::minmax(side->a, side->b)))]);
    std::vector<Index> number;
    for (Index i = 0; i < patch.boundary; ++i, ++side) number.push_back(side->a);
    for (std::size_t i = std::size_t(patch.boundary); i < patch.points.size(); ++i) {
      number.push_back(Index(mesh.points.size()));
      mesh.points.push_back(patch.points[i]);
    }
    for (const auto& [a, b, c] : patch.triangles)
      mesh.triangles.push_back({number[std::size_t(a)], number[std::size_t(b)], number[std::size_t(c)]});
    std::vector<Marked> edges;
    for (std::size_t i = 0; i + 1 < patch.crack.size(); ++i)
      edges.push_back(
          {number[std::size_t(patch.crack[i])], number[std::size_t(patch.crack[i + 1])], none, patch.tip.crack});
    if (patch.tip.at_start) {
      marked.insert(marked.end(), edges.begin(), edges.end());
    } else {
      for (Marked& e : edges) std::swap(e.a, e.b);
      at_ends.insert(at_ends.end(), edges.rbegin(), edges.rend());
    }
  }
  marked.insert(marked.end(), body.begin(), body.end());
  marked.insert(marked.end(), at_ends.begin(), at_ends.end());
  Mesh whole = connect(std::move(mesh.points), std::move(mesh.triangles), marked, std::move(region));
  follow(whole, outside.followed);
  return whole;
}

/// Per patch whether an angle in it or at its rim is smaller than promised.
/// Triangles are known to belong to a patch by the coordinates of its points, which are copied bit for bit.
std::vector<bool> cramped(const Mesh& mesh, const std::vector<Patch>& patches, double min_angle_deg) {
  std::map<std::pair<double, double>, std::size_t> patch_at;
  for (std::size_t p = 0; p < patches.size(); ++p)
    for (const Vec2& x : patches[p].points) patch_at[{x.x(), x.y()}] = p;
  const double least = std::sin(min_angle_deg * pi / 180) * (1 - 1e-6);
  std::vector<bool> found(patches.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    std::array<double, 3> length;
    for (std::size_t i = 0; i < 3; ++i)
      length[i] = (mesh.points[std::size_t(v[i])] - mesh.points[std::size_t(v[(i + 1) % 3])]).norm();
    std::ranges::sort(length);
    if (2 * area(mesh, Index(t)) >= least * length[1] * length[2]) continue;
    for (const Index i : v)
      if (const auto at = patch_at.find({mesh.points[std::size_t(i)].x(), mesh.points[std::size_t(i)].y()});
          at != patch_at.end())
        found[at->second] = true;
  }
  return found;
}

/// With patches around the tips. Edges at their rims cannot be split, so that an angle there may fall short: then that
/// patch becomes smaller, and in the end is left out.
Mesh with_patches(const Shape& shape, const Drawing& drawing, const SizeField& field, double min_angle_deg,
                  bool curved) {
  Patches kinds{min_angle_deg};
  std::vector<PatchPlace> places = place_patches(drawing, field);
  for (int attempt = 0;; ++attempt) {
    Shape names = shape;
    std::vector<Patch> patches;
    for (const PatchPlace& place : places) {
      patches.push_back(put(kinds.of(place.kind), drawing, place));
      names.holes.push_back({fmt::format("around a tip of {}", name(shape, drawing.strands[place.tip.strand])), {}});
    }
    const Drawing around = without(drawing, patches, Index(shape.holes.size()) + 1);
    Mesh mesh = fill(mesh_drawing(names, around, field, min_angle_deg, curved), patches);
    constexpr int patience = 6;
    const std::vector<bool> bad = cramped(mesh, patches, min_angle_deg);
    if (attempt == patience || std::ranges::none_of(bad, std::identity{})) return mesh;
    std::vector<PatchPlace> next;
    for (std::size_t p = 0; p < places.size(); ++p)
      if (!bad[p] || (attempt + 1 < patience && fit(places[p], drawing, field, places[p].kind.radius - 1)))
        next.push_back(places[p]);
    places = std::move(next);
  }
}

/// Unusable shapes are refused first: CGAL would end in an assertion or never.
Mesh triangulate(const Shape& shape, const Sizing& given, const Background* background) {
  check_stop();
  if (const auto problem = find_problem(shape)) throw Error(Fault::Geometry, *problem);
  const Sizing sizing = checked(shape, given);
  const Drawing drawing = draw(shape);
  const SizeField field = field_of(shape, drawing, sizing, background);
  if (sizing.mirrored_tips) return with_patches(shape, drawing, field, sizing.min_angle_deg, sizing.curved);
  return mesh_drawing(shape, drawing, field, sizing.min_angle_deg, sizing.curved).mesh;
}

}  // namespace

double target_size(const Sizing& sizing, const Shape& shape) {
  return sizing.size > 0 ? sizing.size : extent(shape) / 40;
}

Mesh triangulate(const Shape& shape, const Sizing& sizing) {
  return triangulate(shape, sizing, nullptr);
}

Mesh triangulate(const Shape& shape, const Sizing& sizing, const Background& background) {
  return triangulate(shape, sizing, &background);
}

namespace {

/// Ends that are moved onto the next thing drawn by more than rounding.
void note_joined_ends(const Shape& shape, const Drawing& drawing, std::vector<std::string>& notes) {
  for (const Crack& crack : shape.cracks)
    for (const Vec2& end : {crack.points.front(), crack.points.back()}) {
      double moved = infinity;
      for (const Strand& strand : drawing.strands)
        for (const Index corner : {strand.from, strand.to})
          moved = std::min(moved, (drawing.corners[std::size_t(corner)] - end).norm());
      if (moved > touch_tolerance * drawing.extent)
        notes.push_back(
            fmt::format("the end of crack \"{}\" at ({:.6g}, {:.6g}) is moved by {:.2g}, onto the next thing drawn: "
                        "ends within {} of "
                        "the extent of the body are joined",
                        crack.name, end.x(), end.y(), moved, join_tolerance));
    }
}

}  // namespace

std::vector<std::string> crowded_tips(const Shape& shape, const Sizing& given) {
  const Sizing sizing = checked(shape, given);
  const Drawing drawing = draw(shape);
  std::vector<std::string> notes;
  note_joined_ends(shape, drawing, notes);
  for (const TipEnd& tip : free_ends(drawing)) {
    const double size = size_in_room(tip.room, sizing.crack_tip_size);
    if (size >= sizing.crack_tip_size) continue;
    const Vec2& x = drawing.corners[std::size_t(tip.corner)];
    notes.push_back(
        fmt::format("the tip of crack \"{}\" at ({:.6g}, {:.6g}) has only {:.3g} to its other end or the next thing "
                    "drawn, less than two edges of mesh.crack_tip_size = {:.3g}: its edges are {:.3g}",
                    shape.cracks[std::size_t(tip.crack)].name, x.x(), x.y(), tip.room, sizing.crack_tip_size, size));
  }
  return notes;
}

}  // namespace kerf
