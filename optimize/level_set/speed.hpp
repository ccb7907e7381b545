#pragma once
// From the rate of J by motions of the boundary to the speed of the boundary [theory: L.1].

#include "optimize/level_set/regularize.hpp"
#include "optimize/loop/evaluate.hpp"

namespace kerf {

/// dJ(theta) = sum over edges of length * density * theta.n on the boundary of a design that can move.
struct BoundaryRate {
  EdgeCurve curve;
  std::vector<Vec2> middle, normal;
  Eigen::VectorXd length, density;  // per edge of the curve
  std::vector<Index> label;         // of the mesh, per edge
};
BoundaryRate boundary_rate(const Evaluated& e, std::span<const WeightedAnalysis> analyses);
/// a + factor b of one design.
void add(BoundaryRate& a, double factor, const BoundaryRate& b);

/// A design whose boundary moves: the signed distance to it on the canvas, and the rates of J without what volume costs
/// in it and of every bounded functional, all along one curve. Edges with labels below `free_label` lie on the frame.
struct MovingDesign {
  const BackgroundMesh& background;
  const Eigen::VectorXd& distance;
  const BoundaryRate& objective;
  std::span<const BoundaryRate> bounded;
  Index free_label = 0;
};

/// What a step may do.
struct StepLimits {
  double radius = 0;         // of the boundary's motion
  double share = 1;          // of the way to where a thin member would be best
  double smoothing = 0;      // of the H1 product along the boundary
  double min_feature = 0;    // thinner members grow to it, or go where they would carry nearly nothing; 0: none
  double price = 0;          // of area, at least
  double growth = infinity;  // largest change of the area
  std::vector<double> room;  // largest change of every bounded functional
};

/// Motion of the boundary along its normal, outwards positive, and what it changes to second order [theory: L.1, L.12].
struct BoundaryStep {
  double price = 0;                // of area
  std::vector<double> multiplier;  // of every bounded functional
  double residual = 0;             // of the shape [theory: L.10]
  double objective = 0, area = 0;  // changes
  std::vector<double> bounded;     // changes
  Eigen::VectorXd on_background;   // per vertex, smooth
};
/// With g = -(dJ + sum mu_k db_k) per area and w half the thickness of the member: in a member that a given force
/// stretches g falls as 1/w^2, so that an edge goes w (g - p)/(|g| + |p|), as far as the limits allow (the fully
/// stressed design is a fixed point). In thick members only long waves go that far: short ones would overshoot. What
/// would grow out of the frame, and what would take from parts that stay solid, does not move. Price and multipliers
/// are the least ones with which area and bounded functionals keep to their limits. `elastic`: the product that extends
/// the motion; null: constant along normals.
BoundaryStep constrained_step(const MovingDesign& of, const StepLimits& limits, const ElasticProduct* elastic);

/// The residual of that step alone: nothing moves.
double shape_residual(const MovingDesign& of, const StepLimits& limits);

}  // namespace kerf
