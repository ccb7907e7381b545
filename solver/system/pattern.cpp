// The pattern of the condensed matrix out of nodes and their couplings, without a list of entries.

#include "solver/system/pattern.hpp"

#include <limits>
#include <span>

namespace kerf {

namespace {

std::span<const Index> coupled(const Ordering& o, Index node) {
  return {o.adjacent.data() + o.adjacent_start[node],
          static_cast<std::size_t>(o.adjacent_start[node + 1] - o.adjacent_start[node])};
}

std::int64_t width(const Ordering& o, Index node) {
  return o.first[node + 1] - o.first[node];
}

std::int64_t entries(const Ordering& o) {
  std::int64_t count = 0;
  for (Index n = 0; n + 1 < static_cast<Index>(o.first.size()); ++n) {
    std::int64_t below = 0;
    for (const Index other : coupled(o, n)) below += width(o, other);
    count += width(o, n) * (width(o, n) + 1) / 2 + width(o, n) * below;
  }
  return count;
}

}  // namespace

LowerTriangle pattern(const Ordering& o) {
  const std::int64_t count = entries(o);
  if (count > std::numeric_limits<Index>::max())
    throw Error(Fault::Numerics, "the condensed matrix has too many entries; use a coarser mesh (mesh.size)");
  LowerTriangle k;
  k.size = o.size;
  k.start.resize(o.size + 1);
  k.rows.resize(count);
  k.values.resize(count);
  Index* rows = k.rows.data();
  k.start[0] = 0;
  for (Index n = 0; n + 1 < static_cast<Index>(o.first.size()); ++n)
    for (Index j = o.first[n]; j < o.first[n + 1]; ++j) {
      Index p = k.start[j];
      for (Index i = j; i < o.first[n + 1]; ++i) rows[p++] = i;
      for (const Index other : coupled(o, n))
        for (Index i = o.first[other]; i < o.first[other + 1]; ++i) rows[p++] = i;
      k.start[j + 1] = p;
    }
  return k;
}

}  // namespace kerf
