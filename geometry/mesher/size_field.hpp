#pragma once
// The target edge length at every point: h(x) = min(cap, min over sources of size + grading d), d = dist(x, source);
// within the reach of a singular point not above max(size, cap (d/reach)^0.8); beside an edge that is kept not below
// its length - steepness d.

#include "geometry/shape/drawing.hpp"
#include "kerf/mesher.hpp"

#include <array>
#include <vector>

namespace kerf {

/// A segment (or a point, a = b) where something asks for short edges.
struct Source {
  Vec2 a, b;
  double size;
  // Singular points. Linear growth alone leaves h/d, and with it the relative error around the point, at `grading` on
  // every mesh; for a stress like d^-1/2, h ~ d^(5/6) spreads the L2 error evenly and keeps the order of the elements.
  double reach = 0;
};

/// The sources, filed in a quadtree: a leaf lists those that can be the least one somewhere in its square. And a target
/// given at the vertices of an earlier mesh.
struct SizeField {
  struct Node {
    Index child = none;  // the first of four, or none for a leaf
    Index first = 0, count = 0;
  };
  double cap = 1, grading = 0.25;
  std::vector<Source> sources;
  Vec2 low = Vec2::Zero();  // of the root square
  double width = 1;
  std::vector<Node> nodes;
  std::vector<Index> listed;
  const Mesh* background = nullptr;
  std::vector<double> at_vertex;  // of the background
  Locator locator;
  bool long_ligaments = false;
  std::vector<Source> kept;  // edges that are not split, where the rest asks for shorter ones
  Vec2 kept_low = Vec2::Zero(), kept_high = Vec2::Zero();  // what they reach
};
SizeField size_field(std::vector<Source> sources, double cap, double grading, const Vec2& low, const Vec2& high);

/// The background's sizes between `least` and the field's cap, growing by the field's grading at most; lowers the cap
/// to the largest of them. Throws std::invalid_argument.
void add_background(SizeField& field, const Background& background, double least);

/// The strands to keep, where the field so far asks for less than their length.
void add_kept(SizeField& field, const Drawing& drawing);

double size_at(const SizeField& field, const Vec2& x);

/// Bounds within a distance of x: of the size, and of how fast it changes.
double largest_size(const SizeField& field, const Vec2& x, double distance);
double steepest(const SizeField& field, const Vec2& x, double distance);

/// What asks for short edges in a drawing: crack tips inside the body, kinks and mouths of cracks, reentrant corners,
/// (not those of sides to be kept), corners of regions, curved sides, narrow gaps; without `singular_points` only the
/// last two and short sides. Throws Error(Geometry) naming the two sides of a gap too narrow to mesh.
std::vector<Source> find_sources(const Shape& shape, const Drawing& drawing, const Sizing& sizing,
                                 bool singular_points);

/// Per corner whether the body fills more than reentrant_angle around it (corners of loops only).
std::vector<bool> reentrant_corners(const Drawing& drawing);

/// A straight crack along a straight side or crack, many times longer than the two are apart: one layer of triangles
/// fills it, with edges as long along it as the rest asks for. On the crack's strand from .. to, without the ends of
/// the gap; what lies straight across on the other strand; the widths at both, positive on the left.
struct Ligament {
  Index crack, other;
  double from, to;
  double other_from = 0, other_to = 0;
  std::array<double, 2> width = {};
};
std::vector<Ligament> find_ligaments(const Drawing& drawing);
double width(const Ligament& l, double s);   // at s of the crack's strand
double facing(const Ligament& l, double s);  // on the other strand
/// The longest edges there, for a body of that mesh size.
void add_ligaments(const Drawing& drawing, const std::vector<Ligament>& ligaments, double size,
                   std::vector<Source>& sources);
/// Whether from .. to of a strand, where it faces the other, lies in one.
bool in_ligament(const std::vector<Ligament>& ligaments, Index strand, Index other, double from, double to);

/// The narrow gaps alone, but for the ligaments: between two sides or cracks that face each other across the body
/// nearer than twice the size.
void add_gaps(const Shape& shape, const Drawing& drawing, const std::vector<Ligament>& ligaments, double size,
              double across, std::vector<Source>& sources);

/// Strands split at the target length. Whole circles and ellipses on which no crack ends get the polygon that has their
/// area, unless edges are to be `curved`: then all points stay on the arcs, pieces of 45 degrees at most. `finer`
/// multiplies the number of pieces on arcs.
Pieces split_to_size(const Drawing& drawing, const SizeField& field, int finer, bool curved);

}  // namespace kerf
