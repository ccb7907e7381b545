#pragma once
// Products with K triangle by triangle, the rigid motion of each taken out first. The assembled matrix maps a rigid
// motion to rounding times its own size instead of to nothing; a slender body bends by motions so much larger than its
// strains that this rounding is felt as a force [theory: E.17, E.18].

#include "solver/element/motions.hpp"
#include "solver/system.hpp"

namespace kerf {

/// Penalty::a of triangle t in K [theory: E.12]; 0 without one.
double penalty_at(const Model& m, Index t);

/// high + low: a vector in twice the precision. `low` has no size while it is 0.
struct DoubleDouble {
  Eigen::VectorXd high, low;
};
/// x + share y, without rounding at the size of x.
void add(DoubleDouble& x, double share, const Eigen::VectorXd& y);

/// What one triangle sees: a rigid motion, and the rest, which alone strains it.
struct Strained : MotionTraces {
  RigidMotion motion;
  SkeletonVector rest;
  /// v less its share in the span.
  SkeletonVector without_motions(const SkeletonVector& v) const {
    return v - span * (inverse * (span.transpose() * v));
  }
};
/// `values`: of all skeleton unknowns.
Strained strained(const Model& m, const DoubleDouble& values, Index t);

/// Of traces side by side, in straight triangles: `traces` (a row per unknown of the triangle) lose their rigid
/// motions, whose translations and rotation about the centroid are the rows of the result.
using LaneMotions = Eigen::Matrix<double, 3, lanes, Eigen::RowMajor>;
LaneMotions strain_lanes(const Kernel& k, const Triangle& t, double* traces);
/// The interiors (s, u, r) of such motions are added to those of the triangle: no stress.
void add_motions(const Element& e, const Triangle& t, const LaneMotions& motions, double* interior);

/// The interior (s, u, r) of a motion is added to that of triangle t: no stress.
void add_motion(const Model& m, Index t, const RigidMotion& motion, Eigen::Ref<Eigen::VectorXd> interior);

/// Sums over the triangles, per skeleton unknown: K x (with what the penalty's strains theta add), the loads that body
/// forces and tractions condense to; and x'K x, over own triangles.
struct Balance {
  Eigen::VectorXd forces, loads;
  double energy = 0;
  double noise = 0;  // x'K x where x is a rigid motion but for its rounding: energies below are nothing
};
/// Fills in field.interior on the way. `theta`: per triangle, with a penalty.
Balance recover_interior(const Model& m, const DoubleDouble& values, const Eigen::VectorXd& theta, Field& field);

/// K_T of every triangle, kept for products.
class Elementwise {
 public:
  explicit Elementwise(const Model& m);
  struct Product {
    Eigen::VectorXd forces;  // sum_T P K_T P x, per skeleton unknown
    double energy = 0;       // x'forces, without its cancellation
  };
  Product operator()(const DoubleDouble& values) const;

 private:
  const Model& m_;
  Eigen::MatrixXd lower_;  // per triangle the lower triangle of K_T, by columns
};

}  // namespace kerf
