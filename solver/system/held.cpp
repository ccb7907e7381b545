// Solves with rows in contact held, for contact too large for a dense S. With C the held rows and M all others,
//   K_MM x_M = F_M + p_M,   x_C = 0   [theory: C.31],
// by a factor of K in which rows and columns of C are those of its diagonal, so that pattern, analysis and memory serve
// every set. Sets that differ from that of the factor K_0 = L L' in some hundred rows are bordered: W has a column of K
// for each released row, a unit vector for each row that is held since, D the entries of K among released rows,
//   (Y'Y - D) v = Y'y - b_R,   Y = L^-1 W,   y = L^-1 b,   x = L^-T (y - Y v)   [theory: C.32],
// v the jumps of released rows and less the forces on held ones. Half solves are kept: sets that follow each other
// share their right-hand side. Derived in docs/theory/contact.md, section Large contact.

#include "solver/system/held.hpp"

#include "solver/system/lost_definiteness.hpp"

#include <Eigen/LU>

#include <algorithm>

namespace kerf {

// Chained lists in two arrays, behind[] and next[]; built from the last component to the first, so that they are read
// in order.
std::vector<Index> sequence_within(const Mesh& mesh, const Skeleton& s, const Ordering& o) {
  const Index leading = o.leading();
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

// Diagonals stay: they keep the matrix definite, and the scale of the pivots.
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

// A factor that somebody else holds stays as it is, and a new one is made.
std::shared_ptr<const Factor> HeldFactors::of(const LowerTriangle& K, const std::vector<bool>& held) {
  if (static_cast<Index>(held.size()) != contact_rows_)
    throw std::invalid_argument("HeldFactors: one entry per row in contact is needed");
  if (last_ && held == held_) return last_;
  columns_.reset();
  right_.resize(0);
  number_.clear();
  bordered_.clear();
  small_.resize(0, 0);
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

// The columns cost a part of a solve each, their small matrix the square of their number.
bool HeldFactors::worth_bordering(const std::vector<Index>& changed) const {
  constexpr std::size_t most = 600;
  const std::size_t fresh = static_cast<std::size_t>(
      std::ranges::count_if(changed, [&](Index i) { return number_.empty() || number_[i] == none; }));
  constexpr double flops_per_entry = 0.2;
  return bordered_.size() + fresh <= most &&
         static_cast<double>(fresh) * flops_per_entry * last_->entries() < last_->flops();
}

// small_ starts as -D; the products Y'Y are added in `border`. An entry between two rows held in the factor is in D if
// both have columns; other entries go to the column of the released row.
std::vector<PartialForward::Column> HeldFactors::read_columns(const LowerTriangle& K, const std::vector<Index>& fresh) {
  const Index leading = K.size - contact_rows_;
  std::vector<PartialForward::Column> columns(fresh.size());
  std::vector<bool> released(contact_rows_, false);
  const Index first = static_cast<Index>(bordered_.size());
  for (std::size_t k = 0; k < fresh.size(); ++k) {
    const Index i = fresh[k];
    number_[i] = first + static_cast<Index>(k);
    bordered_.push_back(i);
    released[i] = held_[i];
    if (!held_[i]) columns[k].emplace_back(leading + i, 1);
  }
  const Eigen::Index count = static_cast<Eigen::Index>(bordered_.size());
  small_.conservativeResize(count, count);
  small_.rightCols(count - first).setZero();
  small_.bottomRows(count - first).setZero();
  const auto in = [&](const std::vector<bool>& set, Index row) { return row >= leading && set[row - leading]; };
  for (const auto& [i, j, at] : couplings(K)) {
    if (!in(released, i) && !in(released, j)) continue;
    if (in(held_, i) && in(held_, j)) {
      const Index a = number_[i - leading], b = number_[j - leading];
      if (a != none && b != none) small_(a, b) = small_(b, a) = -K.values[at];
    } else if (in(released, i)) {
      columns[number_[i - leading] - first].emplace_back(j, K.values[at]);
    } else {
      columns[number_[j - leading] - first].emplace_back(i, K.values[at]);
    }
  }
  return columns;
}

const std::vector<EntryPlace>& HeldFactors::couplings(const LowerTriangle& K) {
  if (couplings_.empty()) couplings_ = entries_of_last(K, contact_rows_);
  return couplings_;
}

void HeldFactors::border(const LowerTriangle& K, const std::vector<Index>& changed) {
  if (!columns_) {
    columns_.emplace(*last_);
    number_.assign(contact_rows_, none);
  }
  std::vector<Index> fresh;
  for (const Index i : changed)
    if (number_[i] == none) fresh.push_back(i);
  if (fresh.empty()) return;
  const Eigen::Index before = columns_->count(), more = static_cast<Eigen::Index>(fresh.size());
  const Eigen::MatrixXd products = columns_->add(read_columns(K, fresh));
  small_.rightCols(more) += products;
  small_.bottomLeftCorner(more, before) += products.topRows(before).transpose();
}

// v of (C.32), for the columns of the rows that differ now: others that have entered before stay out.
Eigen::VectorXd HeldFactors::multipliers(const std::vector<Index>& changed, const Eigen::VectorXd& y,
                                         const Eigen::VectorXd& b) const {
  const Index leading = static_cast<Index>(sequence_.size()) - contact_rows_;
  std::vector<Index> at;
  for (const Index i : changed) at.push_back(number_[i]);
  Eigen::VectorXd rest = columns_->products(y)(at);
  for (std::size_t k = 0; k < changed.size(); ++k)
    if (held_[changed[k]]) rest[static_cast<Eigen::Index>(k)] -= b[leading + changed[k]];
  return small_(at, at).partialPivLu().solve(rest);
}

// A search solves for the same loads on set after set: the first half is kept while the right-hand side is the same
// number by number.
const Eigen::VectorXd& HeldFactors::partial_forward(Eigen::VectorXd right) {
  if (right_.size() != right.size() || right_ != right) {
    y_ = last_->forward(right);
    right_ = std::move(right);
  }
  return y_;
}

Eigen::VectorXd HeldFactors::backward(const LowerTriangle& K, const Eigen::VectorXd& y, On on) {
  if (on == On::All) return last_->backward(y);
  if (fronts_.empty()) {
    std::vector<Index> rows;
    for (const EntryPlace& c : couplings(K)) rows.insert(rows.end(), {c.row, c.column});
    fronts_ = last_->fronts_above(rows);
  }
  return last_->backward(y, fronts_);
}

// Right-hand sides of held rows are 0: the factor has only their diagonal there. After the bordering released rows take
// v for their value, newly held ones 0.
Eigen::VectorXd HeldFactors::solve(const LowerTriangle& K, const std::vector<bool>& held, const Eigen::VectorXd& b,
                                   On on) {
  const std::scoped_lock lock(one_at_a_time_);
  const Index leading = K.size - contact_rows_;
  std::vector<Index> changed;
  if (last_ && !held_.empty()) changed = changes(held);
  if (!last_ || held_.empty() || (!changed.empty() && !worth_bordering(changed))) {
    of(K, held);
    changed.clear();
  }
  Eigen::VectorXd right = b;  // of rows that are held now alone a multiplier takes what stands there
  for (Index i = 0; i < contact_rows_; ++i)
    if (held_[i]) right[leading + i] = 0;
  if (changed.empty()) return backward(K, partial_forward(std::move(right)), on);
  border(K, changed);
  Eigen::VectorXd y = partial_forward(std::move(right));
  const Eigen::VectorXd share = multipliers(changed, y, b);
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(columns_->count());
  for (std::size_t k = 0; k < changed.size(); ++k) shares[number_[changed[k]]] = share[static_cast<Eigen::Index>(k)];
  columns_->subtract(shares, y);
  Eigen::VectorXd x = backward(K, y, on);
  for (std::size_t k = 0; k < changed.size(); ++k)
    x[leading + changed[k]] = held_[changed[k]] ? share[static_cast<Eigen::Index>(k)] : 0;
  return x;
}

}  // namespace kerf
