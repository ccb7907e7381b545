#pragma once
// The end of an optimization: the design judged by computations that the loop did not make, and the word for it.

#include "optimize/loop/evaluate.hpp"

namespace kerf {

inline constexpr double feasible_violation = 1e-3;  // relative violation of a constraint that does not count

/// Bounds and volume of a design on its mesh: the largest relative violation, 0 for none.
double violation_of(const OptimizeRequest& r, std::span<const double> bounds, double volume_fraction);
/// By what each bound of a finer design is judged: the upper end of its interval where that is guaranteed, the larger
/// of it and the value where it is not, the value where there is none.
std::vector<double> judged_by(const FinerDesign& finer);
/// How much more that is than the value on the design's own mesh, relative to this.
std::vector<double> excess_of(const FinerDesign& finer, std::span<const double> values);
inline constexpr double most_room = 0.2;  // that bounds leave on the loop's mesh for what a finer one says, of at_most
/// Bounds that leave room for it where the finer mesh says that what is asked for is violated: less than `now` allows.
/// `values`: those of the design on its own mesh. Empty where nothing is gained.
std::vector<double> with_more_room(const FinerDesign& finer, const OptimizeRequest& asked, std::span<const double> now,
                                   std::span<const double> values);

/// What they violate by more than `feasible_violation`, in words; empty for nothing.
std::string violated(const OptimizeRequest& r, std::span<const double> bounds, double volume_fraction);

/// The problem by which designs are judged: half the mesh size, one degree more where the element has it.
Problem finer_problem(Problem p);

/// Whether that is done with edges that follow the curves of the design.
bool is_judged_on_curves(const Problem& p, const Shape& shape);

/// What a design is worth there. `finer`: that problem; `whole`: the area that volume fractions refer to.
FinerDesign finer_design(const Problem& finer, const OptimizeRequest& r, const Evaluated& there, double whole);

/// The design meshed, on its curves where edges can follow them, and solved there, by the same loads and functionals.
/// `p`: its scene and its functionals are those of the shape. What cannot be meshed or solved comes back as `failure`.
FinerDesign solve_finer(Problem p, const OptimizeRequest& r, const Shape& shape, double whole);

/// The same of a design that was solved: its laws and functionals are those of its shape.
FinerDesign solve_finer(Problem p, OptimizeRequest r, const Evaluated& e, double whole);

/// The last row whose step was taken: that of the design. One must be.
const Iteration& last_taken(std::span<const Iteration> rows);

/// The design as its loop leaves it.
struct LoopEnd {
  const Iteration& row;   // of the history
  double residual = nan;  // of the conditions of optimality
  double asked = 0;       // the largest one that counts as optimal
  std::string_view kind;  // of residual, in words: "shape residual", "KKT residual"
  std::string why;        // the loop ended
  bool budget_used = false;
  double allowed = feasible_violation;  // of the constraints on the loop's own mesh
  std::string obstacle;                 // what else speaks against "optimal", in words; empty: nothing
  std::string evidence;                 // what else speaks for it
  GainLeft gain = {};                   // what is left of J
  const Shape* frame = nullptr;         // of a level set; its constraints are measured against it
};

/// Fills constraints, feasible, ending, stopped and optimality of the result, which has the finer design.
void judge(OptimizeResult& result, const OptimizeRequest& r, const LoopEnd& end);

}  // namespace kerf
