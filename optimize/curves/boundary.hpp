#pragma once
// The boundary of a body of curves in samples: what its normal moves with the variables weigh, and how near it comes to
// itself and to what is fixed.

#include "optimize/curves/design_curves.hpp"

namespace kerf {

/// Rows of linear constraints row . step <= room.
struct LinearRows {
  std::vector<Eigen::VectorXd> row;
  std::vector<double> room;
  void add(Eigen::VectorXd r, double b) {
    row.push_back(std::move(r));
    room.push_back(b);
  }
};

/// Normal moves of the chains at quadrature points (one row each) by the variables, with what they weigh.
struct NormalMoves {
  Eigen::MatrixXd by;
  Eigen::VectorXd weight;      // lengths
  std::vector<Index> chain;    // per row
  std::vector<Vec2> at, left;  // into the body
  double length = 0;           // of all chains
};
NormalMoves normal_moves(const DesignCurves& d);

/// Adds a little to the diagonal of a form, of lengths and of angles apart, so that it is definite in any unit of
/// length. An end that slides along its own tangent moves nothing normal to the chain. `angles`: which variables turn.
void steady(Eigen::MatrixXd& form, const std::vector<bool>& angles, double little);

/// int v_i v_j over the chains [theory: K.3].
Eigen::MatrixXd mass(const NormalMoves& moves, const DesignCurves& d);

/// A guess of the second derivative of J over the price of area: 4 |d/ds| + 6 / width, in squared normal moves
/// [theory: K.4].
Eigen::MatrixXd curvature_guess(const NormalMoves& moves, const DesignCurves& d, double size);

/// What must stay away from what: all within `reach` of their limits.
struct Clearances {
  double members;     // least width
  double gaps;        // between them
  double reach;       // how much a distance may change in a step
  double min_radius;  // 0: any
  double size;
  double fine = 0;  // step at which widths are measured, as local thickness; 0: by the nearest samples
  // Those that are narrower have to get wider; false: no narrower.
  bool widen_members = false, widen_gaps = false;
};
/// How far the chains lie outside the frame, or in what stays solid.
double overhang(const DesignCurves& d, const Shape& frame, const std::vector<Loop>& solid, double size);

LinearRows clearance_rows(const DesignCurves& d, const Shape& frame, const std::vector<Loop>& frozen,
                          const Clearances& how);

}  // namespace kerf
