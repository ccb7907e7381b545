#pragma once
// A small change of the body as a person would draw it: by the tables of a case file, read as any others.

#include "kerf/case_file.hpp"

namespace kerf {

/// What acts on the body of `c` with the change of map.perturbation drawn at `at` (radius and, for what has one, angle
/// in radians), as a [[hole]], with a [[boundary]] where it is clamped, a [[region]] or a [[crack]] more. A region gets
/// the key `eigenstrain` of the table of `host`, the region of the scene around it (none: of [material]). What is new
/// is the last of its kind: the label of a hole's rim comes after those of c.shape. Null where bodies are not drawn in
/// the case (domain.file). Throws Error(Usage) as read_case does.
ScenesOfChanges scenes_of_changes(const Case& c);

}  // namespace kerf
