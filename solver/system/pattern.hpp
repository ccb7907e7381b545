#pragma once
// The pattern of the condensed matrix: columns of one node have the rows of the node from the diagonal down, then those
// of the nodes that it is coupled to.

#include "solver/system/ordering.hpp"
#include "solver/system/sparse.hpp"

namespace kerf {

/// All values 0. Throws Error(Numerics) when there are too many entries for their index.
LowerTriangle pattern(const Ordering& o);

/// Where the entry (row, column) lies in the pattern's values; row >= column, of nodes that are coupled.
/// Columns of a node share its list of coupled nodes, which is short: a search of some steps instead of one in the
/// rows.
inline Index place(const Ordering& o, const LowerTriangle& k, Index row, Index column) {
  const Index n = o.node_of[column], m = o.node_of[row];
  if (m == n) return k.start[column] + row - column;
  Index p = k.start[column] + o.first[n + 1] - column;
  for (Index q = o.adjacent_start[n];; ++q) {
    const Index other = o.adjacent[q];
    if (other == m) return p + row - o.first[m];
    p += o.first[other + 1] - o.first[other];
  }
}

}  // namespace kerf
