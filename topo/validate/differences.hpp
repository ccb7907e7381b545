#pragma once
// J of a body changed at finite size, minus J, by condensation onto balls [theory: V.2, V.5].

#include "kerf/validate.hpp"
#include "topo/validate/condense.hpp"

namespace kerf {

struct Difference {
  double value = 0;
  bool same_contact = true;
};

/// Solves for the change of the state, not for the changed state: what is small keeps its digits, and so does the
/// near-incompressible body, whose compliances are floored at 1e-8/mu instead of penalized.
class Differences {
 public:
  /// The analysis belongs to a model of `filled.mesh`, prepared `how` with the balls' boundaries kept.
  Differences(const Analysis& a, const Functional& j, const Perturbation& p, const Filled& filled,
              const Preparation& how);
  ~Differences();

  /// Per ball, for every radius.
  std::vector<std::vector<Difference>> all(const std::vector<BallMesh>& balls);

 private:
  struct Body;
  struct Change;
  struct Solved;
  std::vector<Solved> solve(std::size_t ball, const BallMesh& mesh);
  void outside(std::vector<std::vector<Solved>>& solved);
  Difference finish(std::size_t ball, Solved& of, Field& near) const;
  Scene starred_scene() const;

  const Analysis& a_;
  const Functional& j_;
  Perturbation p_;
  const Filled& filled_;
  std::vector<std::unique_ptr<Body>> bodies_;  // the body, and that of a misfit
  std::vector<Sensitivity> derivatives_;       // of the terms, where fields are asked for
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> far_;  // changes outside: a column per radius
  bool fields_ = false, self_adjoint_ = true;  // whether J asks for the fields themselves; homogeneous supports
};

}  // namespace kerf
