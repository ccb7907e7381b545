#pragma once
// What cannot be had is refused before anything is solved. All throw Error(Usage).

#include "kerf/case_file.hpp"
#include "kerf/element.hpp"
#include "kerf/map.hpp"

namespace kerf {

/// Everything in a case that [optimize] cannot do and that is known before anything is solved: a line each, with its
/// place in the file.
void refuse_optimization(const Case& c);

/// Elements without error bars for the map.
void refuse_map(const Element& e, const MapRequest& request);

/// Changes and functionals whose expansion is not known in an orthotropic body, with the place of its material.
void refuse_orthotropic(const Case& c);

/// Elements that the validation cannot condense.
void refuse_validation(const Element& e);

}  // namespace kerf
