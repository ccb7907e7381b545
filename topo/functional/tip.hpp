#pragma once
// Whether a functional of a crack tip sees a tip that contact closes.

#include "kerf/functional.hpp"
#include "kerf/state.hpp"

namespace kerf {

/// K_I at a tip whose faces press on each other on the last two edges, of which this part of the body has some: it is
/// 0, and small changes of the body leave it so.
bool at_closed_tip(const Term& term, const Model& model, const Field& state);

}  // namespace kerf
