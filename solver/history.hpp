#pragma once
// A body under loads that change in steps, with friction that remembers what has slid.

#include "solver/system.hpp"

namespace kerf {

/// The body of `m`, by its factor, under the loads and the prescribed displacements of `scene` (as for with_loads):
/// slip is counted from where `before`, a state of the step before, left it [theory: C.28].
Model continued(const Model& m, Scene scene, const Field& before);

/// A state and the model that it solves.
struct InHistory {
  const Model& model;
  const Field& state;
};

/// What came into the body between two states: the work of loads, pressures and supports on the straight line between
/// them [theory: C.30]. For mixed elements.
double work_between(const InHistory& from, const InHistory& to);
/// What friction took of it: the mean of its limits before and after times the slip [theory: C.29].
double dissipation_between(const InHistory& from, const InHistory& to);
/// The same from the unloaded body.
double work_from_rest(const InHistory& to);
double dissipation_from_rest(const InHistory& to);

/// Slip of this step at the points of crack_profile; 0 where faces stick.
std::vector<double> slip_profile(const Model& model, const Field& state, Index crack);

/// Of the faces in contact of all cracks with friction.
struct SlipLengths {
  double stick = 0, slip = 0;  // in this step
};
SlipLengths slip_lengths(const Model& model, const Field& state);

}  // namespace kerf
