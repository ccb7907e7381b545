#pragma once
// Triangles, edges, and what each edge is. Plain arrays; nothing here knows about unknowns.

#include "kerf/shape.hpp"
#include "kerf/types.hpp"

#include <array>
#include <span>
#include <vector>

namespace kerf {

/// An edge of a crack; `forward` when it runs (smaller to larger vertex) the way the crack's path does.
struct CrackEdge {
  Index edge;
  bool forward;
};

/// Edge e runs from edges[e][0] to edges[e][1] (smaller vertex first). sides[e][0] lies to its left, sides[e][1] to its
/// right (`none` outside the body); the unit normal points from left to right. Edge i of a triangle is opposite its
/// vertex i. Cracks are ordinary interior edges: the two faces share their vertices.
struct Mesh {
  std::vector<Vec2> points;
  std::vector<std::array<Index, 3>> triangles;  // counter-clockwise
  std::vector<std::array<Index, 2>> edges;
  std::vector<std::array<Index, 3>> edges_of;  // per triangle
  std::vector<std::array<Index, 2>> sides;     // per edge: left, right triangle or none
  std::vector<Index> label;                    // per edge: boundary label or none
  std::vector<Index> crack;                    // per edge: crack number or none
  std::vector<std::vector<CrackEdge>> cracks;  // per crack, its edges from the start of its path to the end
  std::vector<Index> region;                   // per triangle: region number or none; empty when there are none
  // Edges that stand for a piece of an arc, x(from) = points[edges[e][0]], x(to) = points[edges[e][1]]: elements that
  // can be curved follow it. Per edge its place in `arcs` or none; empty when all edges are straight.
  std::vector<Index> arc = {};
  std::vector<Arc> arcs = {};
};

/// An edge that means something: a piece of the boundary (label) or of a crack, a -> b along the crack's path.
struct Marked {
  Index a, b;
  Index label = none, crack = none;
};

/// Edges and neighbors of counter-clockwise triangles. The marked edges of one crack come in path order.
/// `region` as in Mesh. Throws std::invalid_argument on a marked pair that is no edge, a degenerate triangle, an edge
/// with three triangles, or regions for another number of triangles.
Mesh connect(std::vector<Vec2> points, std::vector<std::array<Index, 3>> triangles, std::span<const Marked> marked,
             std::vector<Index> region = {});

Index region_of(const Mesh& mesh, Index triangle);
/// Whether the edge separates two regions, or a region from the rest.
bool is_interface(const Mesh& mesh, Index edge);

double area(const Mesh& mesh, Index triangle);
double length(const Mesh& mesh, Index edge);
Vec2 normal(const Mesh& mesh, Index edge);  // unit, from left to right of the edge
Vec2 outward_normal(const Mesh& mesh, Index boundary_edge);
Vec2 tangent(const Mesh& mesh, Index edge);  // unit, from edges[e][0] to edges[e][1]
Vec2 centroid(const Mesh& mesh, Index triangle);

/// `mean_quality` is the mean over triangles of 4 sqrt(3) area / (sum of squared edge lengths): 1 when equilateral.
struct Quality {
  double h_min = 0, h_max = 0, min_angle_deg = 0, mean_quality = 0;
};
Quality quality(const Mesh& mesh);

/// The corners of the triangles, numbered so that two triangles share a number at a vertex exactly when one can walk
/// from one to the other around that vertex without crossing a crack: a vertex on a crack has two numbers, a tip one.
struct Corners {
  std::vector<std::array<Index, 3>> of;  // per triangle
  std::vector<Index> vertex;             // per corner number, its vertex
};
Corners split_at_cracks(const Mesh& mesh);
/// The same at cracks and where two regions meet: what a stress needs.
Corners split_for_stress(const Mesh& mesh);
/// Where points lie in a mesh: boxes around triangles, made once and good for that mesh as it is.
struct Locator {
  struct Node {
    Vec2 low, high;
    Index first, count;  // of `triangles`
    Index right;         // second child; the first one follows its parent; none for a leaf
  };
  std::vector<Node> nodes;
  std::vector<Index> triangles;
};
Locator make_locator(const Mesh& mesh);

/// A triangle that contains the point (boundary included, to 1e-12 of the extent), or none.
Index locate(const Mesh& mesh, const Locator& locator, const Vec2& point);
std::vector<Index> locate(const Mesh& mesh, std::span<const Vec2> points);

/// A triangle of least distance to a finite point, wherever that lies; none if there are no triangles.
Index nearest_triangle(const Mesh& mesh, const Locator& locator, const Vec2& point);

/// Every triangle into four similar ones; beside curved edges, whose middles lie on their arcs, nearly so. Labels,
/// cracks and arcs carry over. Throws FoldedTriangle (kerf/folded.hpp) where a middle on an arc turns a triangle over.
Mesh refine(const Mesh& mesh);

}  // namespace kerf
