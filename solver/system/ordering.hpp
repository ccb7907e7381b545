#pragma once
// The order in which the condensed unknowns are eliminated.

#include "solver/system/skeleton.hpp"

#include <span>

namespace kerf {

/// Rows of the condensed matrix: the free unknowns of one edge or corner lie together, by nested dissection of the
/// vertices, and the jumps that a contact law acts on last. A function of the topology alone.
struct Ordering {
  std::vector<Index> row;       // per skeleton unknown, none where fixed
  Index size = 0;               // rows
  Index contact_rows = 0;       // of them jumps in contact, at the end, in the order of the cracks' paths
  Index interface_rows = 0;     // before those the base unknowns of the interface's edges, in their given order
  std::vector<Index> first;     // per node its first row, one more entry at the end
  std::vector<Index> node_of;   // per row its node
  std::vector<Index> adjacent;  // per node the later nodes that it is coupled to, increasing
  std::vector<Index> adjacent_start;

  Index leading() const {  // rows that no contact law acts on
    return size - contact_rows;
  }
};
/// `sequence`: vertex_sequence(mesh), where it is known.
Ordering order(const Mesh& mesh, const Skeleton& s, std::span<const Index> interface_edges = {}, int threads = 1,
               std::span<const Index> sequence = {});
/// Rows as the unknowns are numbered, those in contact last: for who eliminates nothing. No nodes. `held`, per unknown:
/// of those in contact these have no row, and the others have theirs among all.
Ordering as_numbered(const Skeleton& s, const std::vector<bool>* held = nullptr);

}  // namespace kerf
