// What two parts of a body share, in connected pieces that both processes know in the same order. Each row has an
// owner; who has it and does not own it tells the owner, so that both know of each other. On each side rows are joined
// along chains of near rows (edges that meet at a corner on one side of all cracks) and labelled by the least number; a
// piece is a set of rows with the same label on both sides. The moments that BDDC makes continuous belong to such
// pieces [theory: E.30, E.35]. Rows of a piece are in the order of their numbers on either side.
// docs/theory/elements.md, section Solving in parts.

#include "solver/system/pieces.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace kerf {

namespace {

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
template <typename T>
std::vector<T> values_of(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/// Per row the process that has it, too, or none. Who does not own a row tells its owner.
/// A row of three parts would be an unknown at a vertex, which solving in parts does not take.
std::vector<Index> other_side(const PartMatrix& part, Communicator& comm) {
  const std::vector<Index> counts = gathered(comm, std::vector<Index>{part.owned});
  std::vector<Index> end(counts.size());  // of the numbers of each process
  std::partial_sum(counts.begin(), counts.end(), end.begin());
  std::vector<Index> other(static_cast<std::size_t>(part.rows), none);
  std::vector<std::vector<Index>> asked(counts.size());
  for (Index row = 0; row < part.rows; ++row) {
    const auto owner = static_cast<Index>(std::ranges::upper_bound(end, part.number[row]) - end.begin());
    if (owner == comm.here()) continue;
    other[row] = owner;
    asked[owner].push_back(part.number[row]);
  }
  std::vector<std::string> to;
  for (const std::vector<Index>& numbers : asked) to.push_back(bytes_of(numbers));
  const std::vector<std::string> from = comm.exchange(to);
  for (std::size_t p = 0; p < from.size(); ++p)
    for (const Index number : values_of<Index>(from[p])) {
      const auto at = std::ranges::lower_bound(part.number, number);
      if (at == part.number.end() || *at != number || other[at - part.number.begin()] != none)
        throw std::logic_error("a row is shared by more than two parts");
      other[at - part.number.begin()] = static_cast<Index>(p);
    }
  return other;
}

/// Per row that is shared the least number of those that near rows join it with, all shared with the same process.
std::vector<Index> joined_here(const PartMatrix& part, const std::vector<Index>& other) {
  std::vector<Index> label(other.size(), none), open;
  for (Index seed = 0; seed < part.rows; ++seed) {
    if (other[seed] == none || label[seed] != none) continue;
    label[seed] = part.number[seed];
    open.push_back(seed);
    while (!open.empty()) {
      const Index row = open.back();
      open.pop_back();
      for (Index p = part.near_start[row]; p < part.near_start[row + 1]; ++p)
        if (const Index next = part.near_rows[p]; other[next] == other[seed] && label[next] == none) {
          label[next] = part.number[seed];
          open.push_back(next);
        }
    }
  }
  return label;
}

}  // namespace

// A piece needs the labels of both sides: two rows that are joined here may be apart beyond a crack that only the other
// part sees.
Interface find_interface(const PartMatrix& part, Communicator& comm) {
  const std::vector<Index> other = other_side(part, comm), here = joined_here(part, other);
  // In the order of their numbers the rows of both sides are the same.
  std::vector<std::vector<Index>> labels(static_cast<std::size_t>(comm.count()));
  for (Index row = 0; row < part.rows; ++row)
    if (other[row] != none) labels[other[row]].push_back(here[row]);
  std::vector<std::string> to;
  for (const std::vector<Index>& of : labels) to.push_back(bytes_of(of));
  std::vector<std::vector<Index>> there;
  for (const std::string& from : comm.exchange(to)) there.push_back(values_of<Index>(from));
  using Key = std::tuple<Index, Index, Index>;  // the other process, labels of the lower and of the higher one
  std::vector<std::pair<Key, Index>> keys;
  std::vector<std::size_t> next(there.size(), 0);
  for (Index row = 0; row < part.rows; ++row) {
    const Index with = other[row];
    if (with == none) continue;
    if (there[with].size() != labels[with].size()) throw std::logic_error("parts do not share the same rows");
    const Index beyond = there[with][next[with]++];
    keys.emplace_back(with > comm.here() ? Key{with, here[row], beyond} : Key{with, beyond, here[row]}, row);
  }
  std::ranges::sort(keys);  // rows of a part are in the order of their numbers
  Interface found;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const Index with = std::get<0>(keys[k].first), at = static_cast<Index>(k);
    if (k == 0 || keys[k].first != keys[k - 1].first) found.pieces.push_back({with, at, at});
    if (found.neighbors.empty() || found.neighbors.back().process != with) found.neighbors.push_back({with, at, at});
    found.pieces.back().end = found.neighbors.back().end = at + 1;
    found.rows.push_back(keys[k].second);
  }
  return found;
}

// Own values plus those of the other process: the sum of two numbers is the same bits on both sides.
void add_both_sides(const Interface& of, Communicator& comm, Eigen::VectorXd& values) {
  std::vector<std::string> to(static_cast<std::size_t>(comm.count()));
  for (const auto& n : of.neighbors)
    to[n.process].assign(reinterpret_cast<const char*>(values.data() + n.begin),
                         static_cast<std::size_t>(n.end - n.begin) * sizeof(double));
  const std::vector<std::string> from = comm.exchange(to);
  for (const auto& n : of.neighbors)
    values.segment(n.begin, n.end - n.begin) += Eigen::Map<const Eigen::VectorXd, Eigen::Unaligned>(
        reinterpret_cast<const double*>(from[n.process].data()), n.end - n.begin);
}

}  // namespace kerf
