#pragma once
// The body without loads, for those who load it anew with its own factor.

#include "kerf/model.hpp"

namespace kerf {

/// The body of the model without loads, its supports at rest.
Scene at_rest(const Model& model);

}  // namespace kerf
