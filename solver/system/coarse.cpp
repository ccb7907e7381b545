// The small problem of BDDC: the sum of dense matrices of all processes, sparse as a whole, factorized by every
// process, so that all have the same solution [theory: E.36].

#include "solver/system/coarse.hpp"

#include "base/packer.hpp"
#include "solver/system/lost_definiteness.hpp"

#include <algorithm>
#include <map>

namespace kerf {

namespace {

/// Lower triangle, column by column.
using SparseRows = std::vector<std::map<Index, double>>;

LowerTriangle lower_of(const SparseRows& entries) {
  LowerTriangle lower{static_cast<Index>(entries.size()), {0}, {}, {}};
  for (const auto& column : entries) {
    for (const auto& [row, value] : column) {
      lower.rows.push_back(row);
      lower.values.push_back(value);
    }
    lower.start.push_back(static_cast<Index>(lower.rows.size()));
  }
  return lower;
}

std::vector<Index> sequence_of(const LowerTriangle& lower) {
  std::vector<std::vector<Index>> near(static_cast<std::size_t>(lower.size));
  for (Index j = 0; j < lower.size; ++j)
    for (Index p = lower.start[j] + 1; p < lower.start[j + 1]; ++p) {
      near[j].push_back(lower.rows[p]);
      near[lower.rows[p]].push_back(j);
    }
  std::vector<Index> start{0}, neighbors;
  for (const std::vector<Index>& rows : near) {
    neighbors.insert(neighbors.end(), rows.begin(), rows.end());
    start.push_back(static_cast<Index>(neighbors.size()));
  }
  return dissection(start, neighbors);
}

}  // namespace

// Rounding can leave the sum indefinite: the diagonal is then raised by 1e-14 of itself, and ten times more each time
// until a factor exists, by 1e-8 at most.
Coarse::Coarse(const Eigen::MatrixXd& S, const std::vector<Index>& at, Index total, Communicator& comm)
    : at_(at), total_(total), peers_(&comm) {
  if (total == 0) return;
  Packer packer;
  packer.put(at);
  packer.put(S);
  const std::vector<std::string> from =
      comm.exchange(std::vector<std::string>(static_cast<std::size_t>(comm.count()), std::move(packer).take()));
  SparseRows entries(static_cast<std::size_t>(total));
  for (const std::string& bytes : from) {
    Unpacker of(bytes);
    const std::vector<Index> unknowns = of.all<Index>();
    for (const Index j : unknowns)
      for (const Index i : unknowns)
        if (const double value = of.get<double>(); i >= j) entries[j][i] += value;
  }
  LowerTriangle lower = lower_of(entries);
  const std::vector<Index> sequence = sequence_of(lower);
  for (double shift = 1e-14;; shift *= 10) try {
      factor_ = std::make_unique<Factor>(lower, sequence);
      return;
    } catch (const LostDefiniteness&) {  // rounding: what is near it will do for a preconditioner
      constexpr double most = 1e-8;
      if (shift > most) throw;
      for (Index j = 0; j < total; ++j) lower.values[lower.start[j]] *= 1 + shift;
    }
}

Eigen::VectorXd Coarse::solve(const Eigen::VectorXd& own) const {
  if (total_ == 0) return own;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(total_), here(own.size());
  for (std::size_t k = 0; k < at_.size(); ++k) all[at_[k]] += own[static_cast<Eigen::Index>(k)];
  peers_->sum({all.data(), static_cast<std::size_t>(total_)});
  all = factor_->solve(all);
  for (std::size_t k = 0; k < at_.size(); ++k) here[static_cast<Eigen::Index>(k)] = all[at_[k]];
  return here;
}

}  // namespace kerf
