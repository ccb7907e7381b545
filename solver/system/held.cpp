#include "solver/system/held.hpp"

#include "solver/system/lost_definiteness.hpp"

namespace kerf {

std::vector<Index> sequence_within(const Mesh& mesh, const Skeleton& s, const Ordering& o) {
  const Index leading = o.size - o.contact_rows;
  std::vector<Index> behind(static_cast<std::size_t>(o.size) + 1, none), next(o.contact_rows, none), sequence;
  // Chains of rows in contact, each behind the last row of its edge's node, or behind all.
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    if (s.jump[e] == none) continue;
    Index at = o.size;
    for (int i = 0; i < s.per_edge; ++i)
      if (const Index row = o.row[edge_unknown(s, e) + i]; row != none) at = o.first[o.node_of[row] + 1] - 1;
    for (int i = s.per_edge - 1; i >= 0; --i)
      if (const Index row = o.row[s.jump[e] + i]; row != none && row >= leading) {
        next[row - leading] = behind[at];
        behind[at] = row;
      }
  }
  sequence.reserve(static_cast<std::size_t>(o.size));
  const auto add_behind = [&](Index row) {
    for (Index r = behind[row]; r != none; r = next[r - leading]) sequence.push_back(r);
  };
  for (Index row = 0; row < leading; ++row) {
    sequence.push_back(row);
    add_behind(row);
  }
  add_behind(o.size);
  return sequence;
}

std::vector<bool> held_by(const std::vector<Motion>& motion, Index contact_rows) {
  std::vector<bool> held(static_cast<std::size_t>(contact_rows), true);
  for (std::size_t i = 0; i < motion.size(); ++i) held[i] = motion[i] == Motion::Held;
  return held;
}

namespace {

LowerTriangle with_held(const LowerTriangle& K, const std::vector<bool>& held) {
  LowerTriangle k = K;
  const Index leading = k.size - static_cast<Index>(held.size());
  const auto is_held = [&](Index row) { return row >= leading && held[row - leading]; };
  for (Index j = 0; j < k.size; ++j) {
    const bool column = is_held(j);
    for (Index p = k.start[j] + 1; p < k.start[j + 1]; ++p)
      if (column || is_held(k.rows[p])) k.values[p] = 0;
  }
  return k;
}

}  // namespace

std::shared_ptr<const Factor> HeldFactors::of(const LowerTriangle& K, const std::vector<bool>& held) {
  if (static_cast<Index>(held.size()) != contact_rows_)
    throw std::invalid_argument("HeldFactors: one entry per row in contact is needed");
  const std::scoped_lock lock(one_at_a_time_);
  if (last_ && held == held_) return last_;
  LowerTriangle k = with_held(K, held);
  if (last_.use_count() > 1) last_.reset();
  held_.clear();  // nothing is known if the next line throws
  try {
    last_ = factorize(k);
  } catch (const LostDefiniteness&) {  // as for any slender body, the factor is a preconditioner then
    constexpr double shift = 1e-13;
    for (Index row = 0; row < k.size; ++row) k.values[k.start[row]] *= 1 + shift;
    last_ = factorize(k);
  }
  held_ = held;
  ++made_;
  return last_;
}

std::shared_ptr<Factor> HeldFactors::factorize(const LowerTriangle& K) {
  if (!last_) return std::make_shared<Factor>(K, std::span<const Index>(sequence_), threads_);
  last_->refactor(K);
  return last_;
}

}  // namespace kerf
