// Products with a symmetric matrix that is kept as its lower triangle, and its rows in another order.

#include "solver/system/sparse.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

// Column j gives to the rows below it and takes from them, for the upper triangle.
template <typename Value>
Eigen::VectorXd symmetric_product(const LowerTriangle& a, const Eigen::VectorXd& x, const Value& value_of) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(a.size);
  for (Index j = 0; j < a.size; ++j) {
    const double xj = x[j];
    double sum = 0;
    for (Index p = a.start[j]; p < a.start[j + 1]; ++p) {
      const Index i = a.rows[p];
      const double value = value_of(a.values[p]);
      y[i] += value * xj;
      if (i != j) sum += value * x[i];
    }
    y[j] += sum;
  }
  return y;
}

}  // namespace

std::vector<EntryPlace> entries_of_last(const LowerTriangle& a, Index rows) {
  std::vector<EntryPlace> all;
  for (Index j = 0; j < a.size; ++j)
    for (Index p = a.start[j]; p < a.start[j + 1]; ++p)
      if (a.rows[p] >= a.size - rows) all.push_back({a.rows[p], j, p});
  return all;
}

LowerTriangle reordered(const LowerTriangle& a, std::span<const Index> order) {
  std::vector<Index> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[static_cast<std::size_t>(order[k])] = static_cast<Index>(k);
  LowerTriangle r{a.size, std::vector<Index>(a.start.size(), 0), std::vector<Index>(a.rows.size()),
                  std::vector<double>(a.values.size())};
  const auto each = [&](const auto& visit) {
    for (Index j = 0; j < a.size; ++j)
      for (Index p = a.start[j]; p < a.start[j + 1]; ++p)
        visit(p, place[static_cast<std::size_t>(a.rows[p])], place[static_cast<std::size_t>(j)]);
  };
  each([&](Index, Index row, Index column) { ++r.start[std::min(row, column) + 1]; });
  std::partial_sum(r.start.begin(), r.start.end(), r.start.begin());
  std::vector<Index> next(r.start.begin(), r.start.end() - 1);
  each([&](Index p, Index row, Index column) {
    const Index to = next[std::min(row, column)]++;
    r.rows[to] = std::max(row, column);
    if (!r.values.empty()) r.values[to] = a.values[p];
  });
  return r;
}

Eigen::VectorXd multiply(const LowerTriangle& a, const Eigen::VectorXd& x) {
  return symmetric_product(a, x, [](double value) { return value; });
}

Eigen::VectorXd multiply_sizes(const LowerTriangle& a, const Eigen::VectorXd& x) {
  return symmetric_product(a, x.cwiseAbs(), [](double value) { return std::abs(value); });
}

}  // namespace kerf
