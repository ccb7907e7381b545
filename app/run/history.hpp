#pragma once
// A history of loads: the states at the ends of its steps, with friction that remembers what has slid.

#include "app/run/journal.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/case_file.hpp"

namespace kerf {

/// What cannot be had with [[step]]. Throws Error(Usage).
void refuse_with_steps(const Case& c, const char* job);
void refuse_steps(const Case& c);

/// The last state, on a mesh that is not graded at the ends of contact and slip, which move. `out` has the steps that
/// are done also when one cannot be solved: Error(Numerics), which names it.
Adapted solve_steps(const Case& c, const Adaptation& how, Journal& journal, std::vector<StepResult>& out);

}  // namespace kerf
