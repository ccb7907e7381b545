#pragma once
// Processes that solve one system together. How they talk, and with what they solve, lives outside this room.

#include "kerf/types.hpp"

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// What solves cost so far.
struct PartedEffort {
  int parts = 0, solves = 0;
  int iterations = 0;                  // the most of a solve
  double condition = 0;                // largest estimate
  int interface_rows = 0, primal = 0;  // unknowns that parts share, and those of the small problem; 0: not known
  double sent = 0;                     // bytes that a process sends per iteration, the most of all
  double seconds = 0;                  // of the solves
  double first_mb = 0, other_mb = 0;   // peaks so far: of the first process, the largest of the others
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
  /// `part(p)` packs what process p condenses; one exists at a time. Of the unknowns owned[p] belong to process p, in
  /// order.
  virtual std::unique_ptr<PartedSolver> solver(const std::function<std::string(Index)>& part,
                                               std::vector<Index> owned) = 0;
};

/// What a process has of the system: K_p, assembled from its own triangles, onto the unknowns that these see.
struct RankPart {
  Index rows = 0;
  std::vector<Index> number;          // of its rows among all
  std::vector<Index> start, columns;  // K_p, both triangles, sorted
  std::vector<double> values;
  std::vector<double>
      shear;  // per row the shear moduli of its triangles: the size of K_p where nothing is incompressible
  // For each row that other parts may share those of its own edge and of edges that meet it on one side of all cracks.
  std::vector<Index> near_start, near_rows;
  Index owned = 0;  // unknowns
};
/// Condenses the triangles of a packed part (solver/system/parted.hpp packs them).
RankPart condensed_part(std::string_view packed);

}  // namespace kerf
