#pragma once
// Growth of cracks in a run.

#include "app/run/solve.hpp"

namespace kerf {

/// The cracks of the case grown as [grow] asks; growth.csv after every step, at the end growth.png and grown.toml.
/// `how`: as for the state. Throws what growth::grow throws.
GrowthResult grow_cracks(const Case& c, const Adaptation& how, Journal& journal);

}  // namespace kerf
