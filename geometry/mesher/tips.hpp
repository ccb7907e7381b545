#pragma once
// Free ends of cracks: how much room they have, and the patch of triangles around them that is its own mirror image in
// the crack; internal to this room.

#include "geometry/mesher/size_field.hpp"

namespace kerf {

/// A free end of a crack.
struct TipEnd {
  std::size_t strand;  // that ends there
  bool at_start;       // of the strand
  Index corner, crack;
  double room;  // to the nearest other strand, the strand's other end, or to where it has turned by half a radian
};
std::vector<TipEnd> free_ends(const Drawing& drawing);

/// The largest edges at a tip with that room that leave a ring of elements around it.
double largest_in_room(double room);

/// The size of edges at a tip with that room: as asked, or, where that is larger, small enough for a good ring.
double size_in_room(double room, double asked);

/// Triangles around a tip. The first points are those of its boundary, counter-clockwise, point 0 on the crack.
struct Patch {
  std::vector<Vec2> points;
  Index boundary = 0;  // how many of them
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Index> crack;  // points on the crack, from the tip to point 0
  TipEnd tip = {};
};

/// What patches are made of: edges 1 at the tip, growing by `grading`, up to a radius.
struct PatchKind {
  double radius, grading;
  bool operator==(const PatchKind&) const = default;
};

/// A tip at which the crack, the negative x axis, ends at the origin, from a mesh of the upper half of the disc whose
/// straight side has label 0 and whose rim has label 1.
Shape half_disc(const PatchKind& kind);
Patch mirrored(const Mesh& half);

struct PatchPlace {
  TipEnd tip;
  PatchKind kind;
  double size;  // of the edges at the tip
};

/// The largest kind up to the radius `most` that half the room and the field allow; false when fewer than 3 edges fit.
bool fit(PatchPlace& place, const Drawing& drawing, const SizeField& field, double most);

/// Where the patches of a drawing belong: 10 edges of the tip wide, or as far as they fit.
std::vector<PatchPlace> place_patches(const Drawing& drawing, const SizeField& field);

/// The patch at its place: moved, turned and, on an arc, bent with the crack.
Patch put(const Patch& patch, const Drawing& drawing, const PatchPlace& place);

/// The drawing with the patches left out: each becomes a hole whose sides are kept, the last strands, patch after patch
/// and in the order of its points; cracks end on them.
Drawing without(Drawing drawing, const std::vector<Patch>& patches, Index first_loop);

}  // namespace kerf
