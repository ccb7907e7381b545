#pragma once
// J of a body changed at finite size, minus J, by condensation onto balls [theory: V.2, V.5].

#include "kerf/validate.hpp"
#include "topo/validate/far_field.hpp"

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
  /// `drawn`: what is drawn at the balls' centers, if not by the library's rule.
  Differences(const BallsInBody& in, const Perturbation& p, const Preparation& how, const ScenesOfChanges& drawn);

  /// Per ball, for every radius.
  std::vector<std::vector<Difference>> all(const std::vector<BallMesh>& balls);

 private:
  struct Changed;
  BallInMesh ball(std::size_t number, const BallMesh& mesh) const;
  void fill_near(const ChangedBall& of, Field& near) const;
  Difference finish(const BallInMesh& ball, const ChangedBall& of, Field& near) const;
  double change(std::size_t term, const Changed& c) const;
  double change_of_fields(std::size_t term, const Changed& c) const;

  BallsInBody in_;
  DifferenceSetting setting_;
  std::vector<BodyOperator> bodies_;  // the body, and that of a misfit
  FarField far_;
  bool fields_ = false, self_adjoint_ = true;  // whether J asks for the fields themselves; rigid supports
};

}  // namespace kerf
