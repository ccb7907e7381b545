#pragma once
// What every load case does to the body that a run shows under one of them.

#include "app/run/solve.hpp"
#include "io/result.hpp"

namespace kerf {

/// The largest stress, displacement and pressures of a state that this process has as a whole, with margins where the
/// case asks for them. Nothing where it does not ask for the largest values.
void add_largest(const Case& c, const Adapted& adapted, const PlotData& data, Findings& found, Journal& journal);

/// A case of its own under the loads of one of its load cases.
Case under(const Case& c, const LoadCase& load_case);

/// Rows of all load cases, by name, into `r.load_cases`; the shown one's is that of `r.state`, which gets a note that
/// says whose it is. Each of the others is solved as if it were alone, `solve` (the case, seconds and mesh of a result
/// that nobody keeps), or on the factor of `shown` where both are the same to the last bit: the rows do not hang on the
/// order of the tables. Throws Error(Numerics), which names the load case, where one has no state.
void add_load_cases(const Case& c, const Adapted& shown, const std::function<Adapted(Case&, Result&)>& solve,
                    Journal& journal, Result& r);

}  // namespace kerf
