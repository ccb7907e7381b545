#pragma once
// The leading rows of K, those that no contact law acts on, in parts, one for each process: which triangles and
// unknowns are whose, and what of K a part packs.

#include "solver/divided_body.hpp"
#include "solver/system/assemble.hpp"

namespace kerf {

/// Whether the two sides of a crack move by themselves in a component: its jump is a leading row.
bool parts_freely(const Ordering& o, Index jump);
/// The unknown of a trace: what the right side of a crack sees is one of its own, in the place of the jump, where the
/// sides part freely, and that of the left side where the jump is held or in contact.
Index unknown_of_trace(const Ordering& o, Index base, Index jump);
/// The corners of the mesh cut open at the edges whose sides move by themselves in all components: where such a crack
/// ends or crosses what two parts share, that is in two pieces.
Corners corners_at_free_cracks(const Assembly& from);
/// Per skeleton unknown the process that answers for it (OwnShare::holder), from that of each triangle.
std::vector<Index> holders(const Mesh& mesh, const Skeleton& s, const Ordering& o, const std::vector<Index>& process);

/// The process of each triangle, so that parts are of one size and in one piece, and few edges are cut.
std::vector<Index> partition(const Assembly& from, const Partitioner& partitioner);

/// What a part is packed from. `number`: of the leading rows that its triangles see, among all.
struct Packing {
  const Assembly& from;
  double penalty = 0;      // System::penalty
  const Corners& corners;  // at free cracks
  const std::vector<Index>& number;
};
/// What condensed_part (solver/part_matrix.hpp) unpacks: of these triangles; of the unknowns of all the process owns so
/// many.
std::string packed_part(const Packing& by, std::span<const Index> triangles, Index owned);

}  // namespace kerf
