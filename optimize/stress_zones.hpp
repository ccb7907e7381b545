#pragma once
// What a bound on the largest stress leaves out.

#include "kerf/max_stress.hpp"
#include "kerf/shape.hpp"

#include <span>

namespace kerf {

/// What of a body and its loads makes stresses infinite, whatever the design: bands along sides that are clamped, discs
/// around the ends of loads and supports, around tips and kinks of cracks, around corners of other materials, and
/// around reentrant corners that no design can cut away, since one of their sides bears something or what surrounds
/// them stays solid. Radii as LargestStress has them.
struct StressedBody {
  const Shape& shape;
  std::span<const Support> supports;
  std::vector<Index> loaded;  // labels with tractions, of all load cases
  std::span<const Loop> frozen;
};
std::vector<StressZone> stress_zones(const StressedBody& body, const LargestStress& how);

/// What is left out, in words: "support "top" within 0.02, ..."; empty: nothing.
std::string zones_in_words(const LargestStress& what);

/// The functional with the zones of its largest stresses.
Functional with_zones(Functional j, const StressedBody& body);

}  // namespace kerf
