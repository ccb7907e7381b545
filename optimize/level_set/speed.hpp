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

/// How far an edge may move: `most`, less where the member is thin.
struct SpeedLimits {
  double most = 0;         // a length
  double share = 1;        // of the way to where a thin member would be best
  double smoothing = 0;    // of the H1 product along the boundary
  double min_feature = 0;  // thinner members grow to it, or go where they would carry nearly nothing; 0: none
};

/// Motion of the boundary along its normal, outwards positive. Without constraint on the area, -density alone, what
/// grows J less than `multiplier` per area grows. In a member of half thickness w that a given force stretches
/// -density falls as 1/w^2: it is best for w sqrt(-density / multiplier), where it goes as far as the limits allow
/// (the fully stressed design is a fixed point). In thick members only waves longer than these go that far: short ones
/// would overshoot. Where J falls with less material everywhere, the speed is the gradient itself.
struct Speed {
  double multiplier = 0;          // per area
  double optimality = 0;          // shape residual [theory: L.10]
  Eigen::VectorXd on_curve;       // per edge, before it is made smooth
  Eigen::VectorXd on_background;  // per vertex, smooth, constant along normals
};
/// The design whose boundary moves: its rate, and the signed distance to the boundary on the background mesh. Edges with
/// labels below `free_label` lie on the frame and cannot grow.
struct SpeedOf {
  const BackgroundMesh& background;
  const Eigen::VectorXd& distance;
  const BoundaryRate& rate;
  Index free_label = 0;
};
/// `elastic`: the product that extends them; null: constant along normals. `multiplier` given: as it is. Otherwise such
/// that the area does not change to first order.
Speed boundary_speed(const SpeedOf& of, const SpeedLimits& limits, const ElasticProduct* elastic,
                     std::optional<double> multiplier);

}  // namespace kerf
