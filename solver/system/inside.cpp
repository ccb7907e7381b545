// The inside of one part of a body eliminated exactly. With I its rows inside, G those that it shares with other parts,
//   K_II = L L',   S = K_GG - K_GI K_II^-1 K_IG   [theory: E.35],
// by the multifrontal method with the last columns, G, kept: S, dense, is what the fronts leave there. Order: nested
// dissection of the graph of edges, whose rows see the same, G last. L may be kept in single precision; S is made in
// double precision on the way. What a step has used up is given back before the next one, since the peak of the memory
// counts. Derived in docs/theory/elements.md, section Solving in parts.

#include "solver/system/inside.hpp"

#include "base/kept_memory.hpp"
#include "solver/factor.hpp"
#include "solver/system/lost_definiteness.hpp"
#include "solver/system/symbolic.hpp"

#include <algorithm>
#include <utility>

namespace kerf {

namespace {

std::span<const Index> columns_of(const PartMatrix& part, Index row) {
  return {part.columns.data() + part.start[row], part.columns.data() + part.start[row + 1]};
}

/// Rows in the order of elimination: those of an edge see the same and are one node of the graph, which is sixteen
/// times smaller than that of the rows.
std::vector<Index> sequence(const PartMatrix& part, std::span<const Index> shared, int threads) {
  std::vector<Index> node(static_cast<std::size_t>(part.rows), 0), first, end;  // rows of each node
  for (const Index row : shared) node[row] = none;
  for (Index row = 0; row < part.rows; ++row) {
    if (node[row] == none) continue;
    if (row == 0 || node[row - 1] == none || !std::ranges::equal(columns_of(part, row), columns_of(part, row - 1))) {
      first.push_back(row);
      end.push_back(row);
    }
    ++end.back();
    node[row] = static_cast<Index>(first.size()) - 1;
  }
  std::vector<Index> start{0}, neighbors;
  for (Index k = 0; k < static_cast<Index>(first.size()); ++k) {
    const auto begin = static_cast<std::ptrdiff_t>(neighbors.size());
    for (const Index column : columns_of(part, first[k]))
      if (const Index other = node[column]; other != none && other != k) neighbors.push_back(other);
    std::sort(neighbors.begin() + begin, neighbors.end());
    neighbors.erase(std::unique(neighbors.begin() + begin, neighbors.end()), neighbors.end());
    start.push_back(static_cast<Index>(neighbors.size()));
  }
  std::vector<Index> rows;
  rows.reserve(static_cast<std::size_t>(part.rows));
  for (const Index k : dissection(start, neighbors, threads))
    for (Index row = first[k]; row < end[k]; ++row) rows.push_back(row);
  rows.insert(rows.end(), shared.begin(), shared.end());
  return rows;
}

/// Nothing stays of the part.
LowerTriangle in_order(PartMatrix& part, const std::vector<Index>& order) {
  std::vector<Index> position(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) position[order[k]] = static_cast<Index>(k);
  LowerTriangle lower{part.rows, {0}, {}, {}};
  const std::size_t half = (part.columns.size() + order.size()) / 2;
  lower.rows.reserve(half);
  lower.values.reserve(half);
  std::vector<std::pair<Index, double>> column;
  for (Index k = 0; k < part.rows; ++k) {
    column.clear();
    for (Index p = part.start[order[k]]; p < part.start[order[k] + 1]; ++p)
      if (const Index at = position[part.columns[p]]; at >= k) column.emplace_back(at, part.values[p]);
    std::ranges::sort(column, {}, &std::pair<Index, double>::first);
    for (const auto& [row, value] : column) {
      lower.rows.push_back(row);
      lower.values.push_back(value);
    }
    lower.start.push_back(static_cast<Index>(lower.rows.size()));
  }
  part = {};
  return lower;
}

}  // namespace

bool Inside::factorize(const LowerTriangle& lower, Eigen::MatrixXd& S) {
  return values_ ? numeric_->factorize(lower, values_.get(), S, threads_)
                 : numeric_->factorize(lower, rounded_.get(), S, threads_);
}

// A shift of 1e-13 stands above the rounding of K_II; conjugate gradients on the interface, and the rounds around them,
// undo it. If that is not enough, nothing else is tried.
Inside::Inside(PartMatrix& part, std::span<const Index> shared, int threads, Precision precision, Eigen::MatrixXd& S)
    : order_(sequence(part, shared, threads)), threads_(threads) {
  const auto kept = static_cast<Index>(shared.size());
  S.setZero(kept, kept);
  if (part.rows == 0) return;
  LowerTriangle lower = in_order(part, order_);
  return_freed_memory();  // of the part, and of its ordering
  numeric_ = std::make_unique<Multifrontal>(analyze_pattern(lower).supernodes, kept);
  return_freed_memory();  // of the analysis
  const auto entries = static_cast<std::size_t>(numeric_->entries());
  if (precision == Precision::Single)
    rounded_.reset(new float[entries]);
  else
    values_.reset(new double[entries]);
  if (factorize(lower, S)) return;
  constexpr double shift = 1e-13;  // as for any slender body, the factor is a preconditioner then
  for (Index row = 0; row < lower.size - kept; ++row) lower.values[lower.start[row]] *= 1 + shift;
  S.setZero();
  if (!factorize(lower, S))
    throw LostDefiniteness(
        "rounding has eaten the stiffness of a part of the body: it is slender, triangles are very flat, or materials "
        "differ too much; refine the mesh there, or use fewer processes");
}

// The multifrontal substitution counts the block of kept columns as 1: the tail is b_G - K_GI K_II^-1 b_I.
Eigen::VectorXd Inside::forward(const Eigen::VectorXd& b) const {
  Eigen::VectorXd y(b.size());
  for (std::size_t k = 0; k < order_.size(); ++k) y[static_cast<Eigen::Index>(k)] = b[order_[k]];
  if (values_) numeric_->forward(values_.get(), y, threads_);
  if (rounded_) numeric_->forward(rounded_.get(), y, threads_);
  return y;
}

Eigen::VectorXd Inside::backward(Eigen::VectorXd y) const {
  if (values_) numeric_->backward(values_.get(), y, threads_);
  if (rounded_) numeric_->backward(rounded_.get(), y, threads_);
  Eigen::VectorXd x(y.size());
  for (std::size_t k = 0; k < order_.size(); ++k) x[order_[k]] = y[static_cast<Eigen::Index>(k)];
  return x;
}

}  // namespace kerf
