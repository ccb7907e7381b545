#pragma once
// The solutions of several duals at once: fields side by side, so that what depends on the mesh is made once per
// triangle for all of them [theory: B.30].

#include "solver/bounds/ring_loads.hpp"
#include "solver/system.hpp"

#include <memory>
#include <span>

namespace kerf {

/// Values of `lanes` fields, `rows` of them per item, one item after the other. Memory stays for the next time: to be
/// given pages anew costs as much as some of the passes do.
struct LaneArray {
  Index rows = 0;

  /// The values are void.
  void resize(Index items, Index rows_each);
  void clear();
  double* at(Index item) {
    return values_.get() + place(item);
  }
  const double* at(Index item) const {
    return values_.get() + place(item);
  }
  /// Of one field.
  Eigen::VectorXd column(Index item, int lane) const {
    return Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<lanes>>(at(item) + lane, rows);
  }

 private:
  std::size_t place(Index item) const {
    return static_cast<std::size_t>(item) * static_cast<std::size_t>(rows) * lanes;
  }
  std::unique_ptr<double[]> values_;
  std::size_t size_ = 0, room_ = 0;
};

struct LaneStates {
  int count = 0;
  LaneArray skeleton;  // per unknown
  LaneArray interior;  // per triangle, as Field::interior
  LaneArray nodal;     // per triangle u* at lattice(trace + 1): x, y of each point
  LaneArray moments;   // on the way
  Eigen::MatrixXd x;   // the same per row of the system
};

/// Whether the solutions of duals of this model can be found together; else they are found one by one.
bool can_solve_together(const Model& model);

/// `duals`, `lanes` at most, as loads_alone makes them of `model`, body force and eigenstrain in their rings alone.
/// Those with a ring are solutions under their couples, too (see static_interior). Returns false where rounding leaves
/// more than a solve by itself would.
bool solve_together(const Model& model, std::span<const LaneDual> duals, const LaneRings& rings, LaneStates& states);

}  // namespace kerf
