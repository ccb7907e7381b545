#include "solver/system/held.hpp"

#include "solver/system/lost_definiteness.hpp"

#include <Eigen/LU>

#include <algorithm>

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
  if (last_ && held == held_) return last_;
  columns_.clear();
  products_.clear();
  LowerTriangle k = with_held(K, held);
  if (last_.use_count() > 1) last_.reset();
  held_.clear();  // nothing is known if the next line throws
  try {
    factorize(k);
  } catch (const LostDefiniteness&) {  // as for any slender body, the factor is a preconditioner then
    constexpr double shift = 1e-13;
    for (Index row = 0; row < k.size; ++row) k.values[k.start[row]] *= 1 + shift;
    factorize(k);
  }
  held_ = held;
  ++made_;
  return last_;
}

void HeldFactors::factorize(const LowerTriangle& K) {
  if (last_)
    last_->refactor(K);
  else
    last_ = std::make_shared<Factor>(K, std::span<const Index>(sequence_), threads_);
}

std::vector<Index> HeldFactors::changes(const std::vector<bool>& held) const {
  std::vector<Index> changed;
  for (Index i = 0; i < contact_rows_; ++i)
    if (held[i] != held_[i]) changed.push_back(i);
  return changed;
}

// A column costs a solve, many at once less.
bool HeldFactors::worth_bordering(const std::vector<Index>& changed) const {
  const auto fresh = static_cast<double>(
      std::count_if(changed.begin(), changed.end(), [&](Index i) { return !columns_.contains(i); }));
  constexpr double flops_per_entry = 4;
  constexpr std::size_t most = 200;
  return columns_.size() < most && fresh * flops_per_entry * last_->entries() < last_->flops();
}

namespace {

double product(const std::vector<std::pair<Index, double>>& column, const auto& v) {
  double sum = 0;
  for (const auto& [row, value] : column) sum += value * v[row];
  return sum;
}

std::pair<Index, Index> ordered(Index a, Index b) {
  return {std::max(a, b), std::min(a, b)};
}

}  // namespace

void HeldFactors::read_columns(const LowerTriangle& K, const std::vector<Index>& fresh) {
  const Index leading = K.size - contact_rows_;
  std::vector<bool> released(contact_rows_, false);
  for (const Index i : fresh) {
    released[i] = held_[i];
    columns_[i].clear();
    if (!held_[i]) columns_[i].emplace_back(leading + i, 1);
  }
  const auto in = [&](const std::vector<bool>& set, Index row) { return row >= leading && set[row - leading]; };
  for (Index j = 0; j < K.size; ++j)
    for (Index p = K.start[j]; p < K.start[j + 1]; ++p) {
      const Index i = K.rows[p];
      if (!in(released, i) && !in(released, j)) continue;
      if (in(held_, i) && in(held_, j))
        products_[{i - leading, j - leading}] = -K.values[p];
      else if (in(released, i))
        columns_[i - leading].emplace_back(j, K.values[p]);
      else
        columns_[j - leading].emplace_back(i, K.values[p]);
    }
}

void HeldFactors::border(const LowerTriangle& K, const std::vector<Index>& changed) {
  std::vector<Index> fresh;
  for (const Index i : changed)
    if (!columns_.contains(i)) fresh.push_back(i);
  if (fresh.empty()) return;
  read_columns(K, fresh);
  std::map<Index, Index> place;  // of the fresh ones
  for (const Index i : fresh) place.emplace(i, static_cast<Index>(place.size()));
  constexpr std::size_t batch = 16;
  for (std::size_t first = 0; first < fresh.size(); first += batch) {
    const std::size_t count = std::min(batch, fresh.size() - first);
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(K.size, static_cast<Eigen::Index>(count));
    for (std::size_t k = 0; k < count; ++k)
      for (const auto& [row, value] : columns_[fresh[first + k]]) block(row, static_cast<Eigen::Index>(k)) = value;
    block = last_->solve_all(block);
    for (std::size_t k = 0; k < count; ++k) {
      const Index i = fresh[first + k];
      for (const auto& [j, column] : columns_) {
        const auto at = place.find(j);
        if (at != place.end() && at->second > place.at(i)) continue;  // every pair once
        products_[ordered(i, j)] += product(column, block.col(static_cast<Eigen::Index>(k)));
      }
    }
  }
}

// Jumps of released rows, less the forces on rows that are held now.
Eigen::VectorXd HeldFactors::multipliers(const std::vector<Index>& changed, const Eigen::VectorXd& x,
                                         const Eigen::VectorXd& b) const {
  const Index leading = static_cast<Index>(sequence_.size()) - contact_rows_;
  const Eigen::Index count = static_cast<Eigen::Index>(changed.size());
  Eigen::MatrixXd small(count, count);
  Eigen::VectorXd rest(count);
  for (Eigen::Index p = 0; p < count; ++p) {
    const Index i = changed[p];
    rest[p] = product(columns_.at(i), x) - (held_[i] ? b[leading + i] : 0);
    for (Eigen::Index q = 0; q < count; ++q) small(p, q) = products_.at(ordered(i, changed[q]));
  }
  return small.partialPivLu().solve(rest);
}

Eigen::VectorXd HeldFactors::solve(const LowerTriangle& K, const std::vector<bool>& held, const Eigen::VectorXd& b) {
  const std::scoped_lock lock(one_at_a_time_);
  const Index leading = K.size - contact_rows_;
  std::vector<Index> changed;
  if (last_ && !held_.empty()) changed = changes(held);
  if (!last_ || held_.empty() || (!changed.empty() && !worth_bordering(changed))) {
    of(K, held);
    changed.clear();
  }
  Eigen::VectorXd right = b;
  for (Index i = 0; i < contact_rows_; ++i)
    if (held[i] || held_[i]) right[leading + i] = 0;
  if (changed.empty()) return last_->solve(right);
  border(K, changed);
  const Eigen::VectorXd share = multipliers(changed, last_->solve(right), b);
  for (std::size_t k = 0; k < changed.size(); ++k)
    for (const auto& [row, value] : columns_[changed[k]]) right[row] -= share[static_cast<Eigen::Index>(k)] * value;
  Eigen::VectorXd x = last_->solve(right);
  for (std::size_t k = 0; k < changed.size(); ++k)
    x[leading + changed[k]] = held_[changed[k]] ? share[static_cast<Eigen::Index>(k)] : 0;
  return x;
}

}  // namespace kerf
