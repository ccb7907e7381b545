#pragma once
// Processes that solve one system together. How they talk, and with what they solve, lives outside this room.

#include "kerf/types.hpp"

#include <Eigen/Core>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// What solves cost so far.
struct PartedEffort {
  int parts = 0, solves = 0;
  int iterations = 0;    // the most of a solve
  double condition = 0;  // largest estimate
};

/// K x = b, K being the sum over parts; b and x in the numbers of RankPart::number.
class PartedSolver {
 public:
  virtual ~PartedSolver() = default;
  virtual Eigen::VectorXd solve(const Eigen::VectorXd& b) = 0;  // throws Error(Numerics) when it does not converge
  virtual PartedEffort effort() const = 0;
};

/// Part p belongs to process p, the first to this one.
class Ranks {
 public:
  virtual ~Ranks() = default;
  virtual int count() const = 0;
  /// A part for each node of a graph, so that they are of one size and few edges are cut: as `dissection` has it.
  virtual std::vector<Index> partition(const std::vector<Index>& start, const std::vector<Index>& neighbors) = 0;
  /// `parts`: packed, one per process. Of the unknowns owned[p] belong to process p, in order.
  virtual std::unique_ptr<PartedSolver> solver(std::vector<std::string> parts, std::vector<Index> owned) = 0;
};

/// What a process has of the system: K_p, assembled from its own triangles, onto the unknowns that these see.
struct RankPart {
  Index rows = 0;
  std::vector<Index> number;          // of its rows among all
  std::vector<Index> start, columns;  // K_p, both triangles, sorted
  std::vector<double> values;
  std::vector<Index> near_start, near_rows;  // for each row those of its own edge and of edges that meet it
  Index owned = 0;                           // unknowns
  Index mode_count = 0;
  std::vector<double> modes;  // orthonormal: of one its values on what is owned, then of the next
};
/// Condenses the triangles of a packed part (solver/system/parted.hpp packs them).
RankPart condensed_part(std::string_view packed);

}  // namespace kerf
