#pragma once
// The shape as corners and smooth strands between them, crack ends joined to the sides on which they end. What
// find_problem looks at and the mesher splits.

#include "geometry/boxes.hpp"
#include "geometry/plane.hpp"
#include "kerf/shape.hpp"

namespace kerf {

/// Crack ends nearer to a side than this part of the extent end on it.
inline constexpr double join_tolerance = 1e-6;
/// Nothing nearer than this part of the extent counts as apart.
inline constexpr double touch_tolerance = 1e-9;

double signed_area(const Loop& loop);  // positive when counter-clockwise
bool closed(const Side& side);         // a whole circle or ellipse

/// A side (or a part of it between crack ends), the body on its left; a segment or arc of a crack between kinks, ends
/// and junctions; or a side of a region, that on its left.
struct Strand {
  Index from, to;          // corners; equal for a whole circle (of a loop)
  std::optional<Arc> arc;  // from `from` to `to`
  Index label = none;
  Index loop = none;    // 0 the outline, i hole i - 1
  Index crack = none;   // or the crack
  Index region = none;  // or the region
  bool keep = false;    // one edge of the mesh
  bool smooth = false;  // part of a smooth curve
  // Of a region's side in a shape with interfaces: what lies on its right. Such a strand may be one of a crack, too.
  std::optional<Index> beyond = {};
};

struct Drawing {
  std::vector<Vec2> corners;
  // Loops in order, each closed; cracks, each in the order of its path; regions, closed, unless some of their sides are
  // those of loops, of each other or of cracks (join_regions). Cracks and regions that meet share corners
  // (join_borders).
  std::vector<Strand> strands;
  double extent = 0;
};
/// Apart: every region with all of its own sides, whatever it touches.
enum class Regions { Joined, Apart };
Drawing draw(const Shape& shape, Regions regions = Regions::Joined);

/// "the outline", "hole 'h'", "crack 'c'", "region 'r'".
std::string name(const Shape& shape, const Strand& strand);

/// Whether sides or corners of regions lie on those of loops or of each other.
bool regions_touch(Drawing drawing);

/// In a shape with cracks along the sides of regions (`along`, per crack; interfaces), or whose regions touch: sides
/// that regions share with loops and with each other become one strand, those of interfaces strands of cracks.
void join_regions(Drawing& drawing, const Shape& shape, const std::vector<bool>& along);

/// What is wrong with interfaces and the regions of a shape that has some, in words, or nothing: regions of which each
/// has something of its own and something in common, interfaces in the same place.
std::optional<std::string> find_wrong_interface(const Shape& shape, const std::vector<bool>& along);

/// A whole circle or ellipse: it ends where it begins.
bool whole(const Strand& strand);
/// A side of a region, of an interface, too.
bool is_border(const Strand& strand);

/// Where a strand is cut, s in [0, 1].
struct StrandCut {
  double s;
  Index corner;
};
/// The strand in pieces between its cuts, in any order; a whole circle begins and ends at cuts. Pieces between the same
/// corner are left out.
void append_pieces(const Strand& strand, std::vector<StrandCut> cuts, std::vector<Strand>& pieces);

/// Cuts the strands of cracks where another crack ends, has a kink or crosses them; meeting strands share a corner.
void join_cracks(Drawing& drawing);

/// The same of cracks and the borders of regions, which do not move: cracks that cross them, and ends and kinks of
/// cracks on them.
void join_borders(Drawing& drawing);

/// s in [0, 1] -> point; the corners exactly at the ends.
Vec2 point(const Drawing& drawing, const Strand& strand, double s);

Vec2 velocity(const Drawing& drawing, const Strand& strand, double s);  // dx/ds
double length(const Drawing& drawing, const Strand& strand);            // of an arc: at most that, a circle's exactly

/// A box around the strand: around all of its circle or ellipse, if it is curved. And those of all.
AxisBox box_of(const Drawing& drawing, const Strand& strand);
std::vector<AxisBox> boxes_of(const Drawing& drawing);

/// Nearest point of the strand.
struct Foot {
  double s, distance;
};
Foot nearest(const Drawing& drawing, const Strand& strand, const Vec2& x);

/// Straight pieces between points; points[i] for i < corners is corner i.
struct Piece {
  Index a, b;
  Index strand;
  double from, to;    // the strand's s at a and b
  bool keep = false;  // one edge of the mesh
};
struct Pieces {
  std::vector<Vec2> points;
  std::vector<Piece> pieces;  // along the strands, in their order
};

/// Arcs split evenly in their parameter, about 70 pieces a turn.
Pieces split_evenly(const Drawing& drawing);

/// Lengths at which things touch: loops one another and themselves, a crack and anything else.
struct Gaps {
  double loop, crack;
};

/// The first place where pieces cross, touch or overlap, in words, or nothing. Pieces that share a point may meet
/// there. `curved`: a piece stands for its part of the arc, and is halved until its chord says what the arc does.
std::optional<std::string> find_crossing(const Shape& shape, const Drawing& drawing, const Pieces& pieces,
                                         const Gaps& gaps, bool curved);

}  // namespace kerf
