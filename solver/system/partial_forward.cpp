// Y = L^-1 P W for sparse columns W [theory: C.32]. A column is 0 but on the way from its rows to the root of the tree
// of elimination, so that only supernodes on that way have a block of values: rows of the supernode by columns that
// pass it. New columns enter in batches: room is made along their ways, then from children to parents
//   Y_s = L_ss^-1 W_s,   W_p -= L_ps Y_s   (E.29),
// and the products Y'Y of new columns with all are summed on the way. Many columns cost less than a solve or two.
// Derived in docs/theory/contact.md, section Large contact.

#include "solver/system/partial_forward.hpp"

#include <algorithm>

namespace kerf {

PartialForward::PartialForward(const Factor& factor) : l_(factor.columns()) {
  const Supernodes& s = l_.blocks.supernodes();
  const auto rows = static_cast<std::size_t>(s.first.back());
  place_.resize(rows);
  supernode_of_.resize(rows);
  for (std::size_t k = 0; k < rows; ++k) place_[static_cast<std::size_t>(l_.order[k])] = static_cast<Index>(k);
  for (Index n = 0; n < s.count(); ++n)
    std::fill(supernode_of_.begin() + s.first[n], supernode_of_.begin() + s.first[n + 1], n);
}

// Room on the way of each, with the columns themselves in it.
// A way that meets a supernode which the column passes already has been marked from there to the root. Numbers grow, so
// that `which` stays sorted.
void PartialForward::enter(const std::vector<Column>& columns) {
  const Supernodes& s = l_.blocks.supernodes();
  std::map<Index, Eigen::Index> old;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Index number = count_ + static_cast<Index>(k);
    for (const auto& [row, value] : columns[k])
      for (Index n = supernode_of_[static_cast<std::size_t>(place_[static_cast<std::size_t>(row)])]; n != none;
           n = l_.blocks.parent(n)) {
        Block& block = blocks_[n];
        if (!block.which.empty() && block.which.back() == number) break;
        block.which.push_back(number);
      }
  }
  for (auto& [n, block] : blocks_) {
    const Eigen::Index before = block.values.cols(), now = static_cast<Eigen::Index>(block.which.size());
    if (before == now) continue;
    block.values.conservativeResize(s.first[n + 1] - s.first[n], now);
    block.values.rightCols(now - before).setZero();
  }
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (const auto& [row, value] : columns[k]) {
      const Index at = place_[static_cast<std::size_t>(row)], n = supernode_of_[static_cast<std::size_t>(at)];
      Block& block = blocks_.at(n);
      const auto which = std::ranges::lower_bound(block.which, count_ + static_cast<Index>(k));
      block.values(at - s.first[n], which - block.which.begin()) += value;
    }
}

// What the new columns of a supernode leave on the rows behind it.
void PartialForward::pass_on(Index n, Eigen::Index first_new) {
  const Supernodes& s = l_.blocks.supernodes();
  const FrontPanel<double> panel = l_.blocks.panel(n, l_.values);
  const Index width = panel.width, height = panel.height;
  Block& block = blocks_.at(n);
  auto here = block.values.rightCols(block.values.cols() - first_new);
  Eigen::MatrixXd left = Eigen::MatrixXd::Zero(height - width, here.cols());
  for (Index from = 0; from < width; from += FrontPanel<double>::together) {
    const Index to = std::min(width, from + FrontPanel<double>::together);
    const Eigen::Map<const Eigen::MatrixXd> l(panel.column(from) + from, height - from, to - from);
    auto own = here.middleRows(from, to - from);
    l.topRows(to - from).triangularView<Eigen::Lower>().solveInPlace(own);
    here.middleRows(to, width - to).noalias() -= l.middleRows(to - from, width - to) * own;
    left.noalias() += l.bottomRows(height - width) * own;
  }
  if (height == width) return;
  std::vector<Eigen::Index> to(static_cast<std::size_t>(left.cols()));
  Index above = none;
  Block* target = nullptr;
  for (Index i = 0; i < height - width; ++i) {
    const Index at = s.rows[s.rows_start[n] + width + i], m = supernode_of_[static_cast<std::size_t>(at)];
    if (m != above) {
      above = m;
      target = &blocks_.at(m);
      for (std::size_t k = 0; k < to.size(); ++k)
        to[k] = std::ranges::lower_bound(target->which, block.which[static_cast<std::size_t>(first_new) + k]) -
                target->which.begin();
    }
    for (std::size_t k = 0; k < to.size(); ++k)
      target->values(at - s.first[m], to[k]) -= left(i, static_cast<Eigen::Index>(k));
  }
}

Eigen::MatrixXd PartialForward::add(const std::vector<Column>& columns) {
  enter(columns);
  const Eigen::Index before = count_, more = static_cast<Eigen::Index>(columns.size());
  count_ += static_cast<Index>(more);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count_, more);
  for (auto& [n, block] : blocks_) {  // children before parents
    const Eigen::Index first_new =
        std::ranges::lower_bound(block.which, static_cast<Index>(before)) - block.which.begin();
    if (first_new == block.values.cols()) continue;
    pass_on(n, first_new);
    const Eigen::MatrixXd here = block.values.transpose() * block.values.rightCols(block.values.cols() - first_new);
    for (Eigen::Index k = 0; k < here.cols(); ++k)
      for (Eigen::Index i = 0; i < here.rows(); ++i)
        products(block.which[static_cast<std::size_t>(i)],
                 block.which[static_cast<std::size_t>(first_new + k)] - before) += here(i, k);
  }
  return products;
}

Eigen::VectorXd PartialForward::products(const Eigen::VectorXd& y) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(count_);
  for (const auto& [n, block] : blocks_) {
    const Eigen::VectorXd here =
        block.values.transpose() * y.segment(l_.blocks.supernodes().first[n], block.values.rows());
    for (std::size_t k = 0; k < block.which.size(); ++k) sum[block.which[k]] += here[static_cast<Eigen::Index>(k)];
  }
  return sum;
}

void PartialForward::subtract(const Eigen::VectorXd& share, Eigen::VectorXd& y) const {
  for (const auto& [n, block] : blocks_) {
    const Eigen::VectorXd here = share(block.which);
    y.segment(l_.blocks.supernodes().first[n], block.values.rows()).noalias() -= block.values * here;
  }
}

}  // namespace kerf
