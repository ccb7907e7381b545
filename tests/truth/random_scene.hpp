#pragma once
// Bodies nobody tuned on: case files from a seed.

#include <string>

namespace kerf {

/// A star-shaped polygon, sometimes with a square hole, another material and up to two straight cracks, with a clamped
/// side, loads on one or two others (constant, linear, steps, narrow strips, bells, roots that end in infinity) and
/// sometimes a body force. The same text for the same number on every machine.
std::string random_scene(unsigned seed);

/// Of the environment: KERF_SCENES=1000 for many scenes, KERF_FIRST=n to begin elsewhere.
unsigned number(const char* name, unsigned otherwise);

}  // namespace kerf
