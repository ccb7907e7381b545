#pragma once
// From the signs of a function at the vertices of a mesh to closed loops of boundary.

#include "geometry/carve.hpp"
#include "geometry/shape/drawing.hpp"

namespace kerf {

/// What a function says at the vertices of a mesh. An edge whose ends have two signs is crossed.
struct Signs {
  std::vector<char> inside;
  std::vector<double> magnitude;  // of the function; -1 where the sign was turned: crossed as near as can be
  std::vector<double> clear;      // per vertex, how far crossings keep away from it (on short edges less)
};
Signs signs_of(const Mesh& mesh, const Eigen::VectorXd& phi);

inline bool crossed(const Mesh& mesh, const Signs& signs, Index edge) {
  const auto& [a, b] = mesh.edges[std::size_t(edge)];
  return signs.inside[std::size_t(a)] != signs.inside[std::size_t(b)];
}

/// Where a crossed edge is crossed: the part of its length from edges[e][0]. With and without keeping clear.
double exact_crossing(const Mesh& mesh, const Signs& signs, Index edge);
double crossing(const Mesh& mesh, const Signs& signs, Index edge);

/// Area inside, with crossings where crossing() says.
double inside_area(const Mesh& mesh, const Signs& signs, Index triangle);

/// The place on the circle or ellipse in the direction of x.
Vec2 onto(const Arc& arc, const Vec2& x);

/// Which strand of the frame's loops an edge of the mesh lies on. Strands are those of `drawing`, the body on their
/// left; strand k is side `side[k]` of its loop, run backwards when the loop is `reversed`.
struct Rim {
  Drawing drawing;
  std::vector<Index> strand;   // per edge of the mesh; none inside
  std::vector<Index> side;     // per strand
  std::vector<bool> reversed;  // per loop of the frame, the outline first
  std::vector<bool> corner;    // per vertex of the mesh: where two strands meet
  std::vector<Index>
      next_edge;  // per vertex of the mesh on the boundary: the edge that leaves it, the body on its left
};
Rim find_rim(const Shape& frame, const Mesh& mesh);

/// Turns signs within the tolerance until boundaries keep apart: necks, slits, cracks that the zero line nearly
/// reaches.
void clean(const Shape& frame, const Mesh& mesh, const Rim& rim, const Carving& how, Signs& signs,
           std::vector<std::string>& notes);

/// Drops the pieces of material that are not wanted, fills small holes. Throws Error(Geometry).
void choose_pieces(const Shape& frame, const Mesh& mesh, const Carving& how, Signs& signs,
                   std::vector<std::string>& notes);

/// A point of the boundary of what is inside: the crossing of an edge, or a vertex on the frame's boundary.
struct ContourNode {
  Index edge = none, vertex = none;
};
/// Closed, what is inside on the left: node i to node i + 1 along the frame's `strand[i]`, or (none) the zero line.
struct Contour {
  std::vector<ContourNode> nodes;
  std::vector<Index> strand;
};
std::vector<Contour> contours(const Mesh& mesh, const Signs& signs, const Rim& rim);

/// The place of a crossing. On curved strands and cracks it lies on the curve.
Vec2 place(const Shape& frame, const Mesh& mesh, const Signs& signs, const Rim& rim, Index edge);

/// Part of a crack between two places on its path.
struct CrackPart {
  Index crack;
  ContourNode from, to;  // an edge: cut there; neither: the crack's own end
  Crack shape;           // without a name
};
/// What lies inside, in the order of the cracks and along their paths; what is shorter than `least` is left out.
std::vector<CrackPart> cut_cracks(const Shape& frame, const Mesh& mesh, const Signs& signs, const Rim& rim,
                                  double least, std::vector<std::string>& notes);

/// A piece of zero line: points, those that must stay; a closed one does not repeat its first point.
struct Chain {
  std::vector<Vec2> points;
  std::vector<bool> fixed;
  std::vector<Index> meets;  // per point, the obstacle (as a group) that it lies on, or none
  bool closed = false;
};

struct Simplifying {
  double spacing;
  double move;        // how far smoothing may move the line
  double chord;       // how far it may lie from the chords that replace it
  double offset = 0;  // area to gain on the left, per length
};

inline constexpr int longest_chord = 8;  // in steps of sample

/// Points at even steps, several per spacing, the fixed ones among them.
Chain sample(const Chain& chain, double spacing);

/// What a zero line must not meet. Segments of one group stand for one thing.
struct Obstacle {
  Vec2 a, b;
  Index group;
};

/// For a point of a chain the distance to other chains, its own beyond its neighborhood, and obstacles; and the same
/// without what the fixed points next to it lie on, which chords from these do not cross.
struct Room {
  double all, beside;
};
/// Per chain and point; `far` where nothing is nearer than that.
std::vector<std::vector<Room>> room(const std::vector<Chain>& chains, const std::vector<Obstacle>& obstacles,
                                    double far);

/// Fewer points than the fine chain has, about `spacing` apart, that enclose the area that `chain` does and what the
/// offset adds, by moves that are small against the room of its points. Fixed points stay as they are, among them the
/// ends of an open chain.
Chain simplify(const Chain& chain, const Chain& fine, const std::vector<Room>& room, const Simplifying& how);

}  // namespace kerf
