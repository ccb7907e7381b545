#pragma once
// The symbolic phase of a sparse Cholesky factorization, by CHOLMOD.

#include "solver/system/multifrontal.hpp"

#include <span>
#include <vector>

namespace kerf {

struct Symbolic {
  std::vector<Index> order;  // order[k] is the k-th row to be eliminated
  Supernodes supernodes;     // in that order
  double entries = 0;        // nonzeros of L
  double flops = 0;          // of the factorization; both as if all nodes of a front were of one size
};

/// In the order in which the rows come, or near that of `sequence`, where sequence[k] is the k-th row: subtrees of the
/// tree of elimination are put together then. Throws std::bad_alloc.
Symbolic analyze_pattern(const LowerTriangle& lower, std::span<const Index> sequence = {});

}  // namespace kerf
