#pragma once
// What a step of growth decides: how far each tip goes, which one moves and at what load, and whether one step agrees
// with two halves [theory: G.22, G.23, G.24].

#include "kerf/types.hpp"

#include <span>
#include <vector>

namespace kerf::growth {

/// Fatigue: how far tips go that compete.
struct Advances {
  std::vector<double> lengths;  // per tip, the fastest one's is the longest; 0 where it rests
  bool all_rest = false;        // no tip is above its threshold
  bool runs = false;            // a rate is infinite: those tips go, all others stay
};
/// da_i = longest rate_i/max rate. Throws Error (Usage) for a negative rate or one that is no number.
Advances advance(std::span<const double> rates, double longest);

/// Quasi-static growth: the tip that moves first when all loads grow together.
struct LeadingTip {
  Index tip = none;               // none: no tip has G > 0
  double load_factor = infinity;  // sqrt(G_c/G): what the loads are multiplied by when it moves
  std::vector<Index> with_it;     // others whose factor is the same within `tie`: a symmetric set-up
};
/// G at the given loads, G_c in the direction of growth. G of a body with gaps or a preload is no square of the loads:
/// it has to be solved again at the factor.
LeadingTip leading_tip(std::span<const double> G, std::span<const double> G_c, double tie = 1e-3);

/// Where quasi-static growth stands: the load factor at which the crack moves, and the displacement of the loads there
/// (their work over the load; 2 |potential energy|/load_factor where loads alone act).
struct LoadPoint {
  double load_factor = 0, displacement = 0;
};
enum class Course {
  Stable,     // the load has to grow
  LoadFalls,  // unstable under given loads, stable under given displacements
  SnapBack    // unstable under both
};
/// From one length of a crack to the next.
Course course(const LoadPoint& before, const LoadPoint& after);

/// int G da along a path, the energy that growth takes, with the difference to that by every second point (not a number
/// for two points) [theory: G.25].
struct ReleasedEnergy {
  double energy = 0, error = 0;
};
ReleasedEnergy released_energy(std::span<const double> a, std::span<const double> G);
/// Bounds of it by bounds of G at the points, if G is between its values at the ends of each step: a theorem then.
struct ReleasedBounds {
  double lower = 0, upper = 0;
};
ReleasedBounds bound_released_energy(std::span<const double> a, std::span<const double> G_lower,
                                     std::span<const double> G_upper);

/// The tips after a step and numbers that belong to it (cycles of the step, its load factor).
struct StepResultAt {
  std::vector<Vec2> tips;
  std::vector<double> numbers;
};
struct StepControl {
  double tolerance = 1e-2;  // of the tips by the length of the step, of numbers by themselves
  int order = 2;            // of the path: 2 with curved pieces, 1 with straight ones and behind a kink
  double least = 0, most = infinity;
};
/// A step of this length, made at once and in two halves.
struct StepJudgement {
  bool accepted = false;
  bool at_least = false;  // accepted though it errs by more, as no shorter one is allowed
  double tip_error = 0;   // of the halves [length], the largest of all tips
  std::vector<double> number_errors;
  std::vector<Vec2> better_tips;  // both extrapolated; for what is reported, not to go on from
  double next_length = 0;
};
StepJudgement judge(const StepResultAt& whole, const StepResultAt& halves, double length, const StepControl& control);

/// Errors of accepted steps, summed: of the place of a tip and of numbers that sum up (cycles). It takes no account of
/// a path that amplifies them, as one with T > 0 does.
struct PathErrors {
  double tip = 0;
  std::vector<double> numbers;
  void add(const StepJudgement& step);
};

}  // namespace kerf::growth
