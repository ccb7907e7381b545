#pragma once
// How a shape changed: small drawings side by side.

#include "kerf/mesh.hpp"
#include "kerf/optimize.hpp"
#include "optimize/checkpoint.hpp"

namespace kerf {

/// The boundary of a mesh as closed polygons (the body to the left; where holes touch, in any pairing), and its cracks
/// as polylines.
struct Contours {
  std::vector<std::vector<Vec2>> boundary, cracks;
};
Contours contours(const Mesh& mesh);

/// One accepted iterate.
struct Snapshot {
  int iteration = 0;
  double objective = 0, volume_fraction = 0;
  Contours contours;
};

/// A few of many, evenly spread, while it is not known how many there will be: every `stride`-th iteration is kept, and
/// the stride doubles when there are too many. `last` is always there.
struct Snapshots {
  int stride = 1;
  std::vector<Snapshot> kept;
  std::optional<Snapshot> last;
};
/// Takes the place of one of the same iteration.
void add(Snapshots& snapshots, Snapshot snapshot);

/// At most `most` >= 2 of them, the first and the last among them.
std::vector<Snapshot> pick(const Snapshots& snapshots, std::size_t most);

/// To a file and back; bit for bit. Throws Error(Files) where the checkpoint holds something else.
Checkpoint to_checkpoint(const Snapshots& snapshots, const std::string& fingerprint);
Snapshots from_checkpoint(const Checkpoint& checkpoint);

/// A strip of drawings as a PNG: material dark, cracks red, the first one's outer contour behind each. Throws
/// Error(Files) naming the path.
struct Evolution {
  std::string title, subtitle;
  std::vector<Snapshot> snapshots;
};
void draw(const std::filesystem::path& path, const Evolution& evolution);

}  // namespace kerf
