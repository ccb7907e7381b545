#pragma once
// What a part shares with others, in connected pieces that both sides know in the same order.

#include "solver/divided_body.hpp"

namespace kerf {

/// Rows begin .. end of an interface, shared with the part of one other process.
struct Border {
  Index with, begin, end;
  Index size() const {
    return end - begin;
  }
};

/// Rows of a part that others have, too, piece by piece, those with one process after the other.
struct Interface {
  std::vector<Index> rows;
  std::vector<Border> pieces;
  struct Neighbor {
    Index process, begin, end;  // its rows here
  };
  std::vector<Neighbor> neighbors;
};

/// All processes call it. Rows are in one piece where a chain of near rows (PartMatrix::near_rows) joins them on both
/// sides. Each row is shared by two processes at most, by the one that owns it and another.
Interface find_interface(const PartMatrix& part, Communicator& comm);

/// `values` of rows of the interface, those of both sides added.
void add_both_sides(const Interface& of, Communicator& comm, Eigen::VectorXd& values);

}  // namespace kerf
