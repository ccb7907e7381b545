#pragma once
// Where a crack ends inside the body: the frame of the tip and the smooth part of the crack behind it. Internal to this
// room.

#include "kerf/mesh.hpp"
#include "kerf/scene.hpp"

#include <span>

namespace kerf {

/// Points and directions are in the frame of the tip: x extends the crack, y is x turned by +90 degrees.
struct CrackTip {
  Index crack = none;
  bool at_start = false;  // of the crack's path
  Vec2 at = Vec2::Zero();
  Mat2 frame = Mat2::Identity();  // columns: x and y
  std::vector<Index> edges;       // the smooth part, from the tip
  std::vector<Vec2> vertices;     // of those edges: one more, the first at 0, ever farther from it
  std::vector<Vec2> slopes;       // of the curve through the vertices, per length of chord
  bool curved = false;            // straight otherwise, up to rounding
  bool follows = false;           // edges of the mesh do: Mesh::arc
  bool on_border = false;         // between materials: its field is not that of a tip
  double room =
      0;  // to the nearest end of the material other than the smooth part: boundary, other cracks, kinks, regions
  int half = 0;  // 1, -1: only what lies at y > 0, or y < 0, is there, and the edges are those of the boundary
};

/// Ends on the boundary, on a hole, or on another crack are no tips. In the order of the cracks, start before end. A
/// crack is smooth as far as its curvature changes gradually from vertex to vertex (then its edges are taken for chords
/// of a curve) and until it has turned by half a radian.
/// `divisions`: as if every edge were divided into two so many times; CrackTip::edges are then those before, each as
/// often as it has parts. `scene`: borders between regions of the same material end nothing.
std::vector<CrackTip> find_tips(const Mesh& mesh, int divisions = 0, const Scene* scene = nullptr);

/// The tip of a straight crack of which the body on one side is there. `face`: edges of the boundary from the tip,
/// `ahead`: those of the ligament.
CrackTip half_tip(const Mesh& mesh, std::span<const Index> face, std::span<const Index> ahead);

/// The curve over edge i of the smooth part, t in [0, 1] away from the tip: cubic, through the vertices.
struct CurvePoint {
  Vec2 at, slope;  // slope: per t
};
CurvePoint curve_point(const CrackTip& tip, std::size_t edge, double t);

/// Angle of x about the tip, continuous off the crack: 0 ahead, about pi above the crack, about -pi below.
double angle_about(const CrackTip& tip, const Vec2& x);

}  // namespace kerf
