#pragma once
// The bodies whose shape `kerf bench optimize` improves: those of the peers' cases.py and a bridge. Plane stress,
// E = 1, nu = 0.3, a load of 1 in all, compliance.

#include "kerf/optimize.hpp"

namespace kerf {

struct OptimizeProblem {
  std::string name, title;
  Problem problem;           // its sizing: that of kerf's runs
  double length = 1;         // of members and meshes, relative to the other bodies
  StartHoles holes, random;  // the starts of these names
  std::optional<Mirror> mirror;
  double volume = 0.4;        // fraction of the frame
  std::vector<Loop> frozen;   // stays solid
  double volume_penalty = 0;  // instead of a volume: J + penalty * area
  double ersatz = 0;          // weak phase of the published comparison
};

/// "cantilever" 2 x 1, held on the left, load on a segment of 0.1 in the middle of the right side. "mbb": half of a
/// beam 6 x 1, symmetry on the left, load on 0.1 at the top left, roller on 0.1 at the bottom right. "lbracket": 1 x 1
/// without its upper right 0.6 x 0.6, held at the top, load on 0.1 of the short right side. "bridge" 2 x 1: held on 0.1
/// of the bottom at both ends, uniform load on the bottom between, a deck of 0.05 there that stays.
const std::vector<OptimizeProblem>& optimize_problems();

/// Compliance + 100 * area of the cantilever with the load on 0.05 and a weak phase of 1e-3, as published for four
/// algorithms [Blauth, Sturm 2023].
const OptimizeProblem& published_problem();
struct Published {
  double least_value, most_value;  // J
  int fewest_solves, most_solves;  // states
};
inline constexpr Published published{153.47, 154.63, 31, 116};

/// "full": no holes; "holes": a regular pattern; "random": seeded places.
const std::vector<std::string>& optimize_starts();
/// The level set from that start. Throws std::invalid_argument for an unknown one.
OptimizeRequest level_set_request(const OptimizeProblem& p, const std::string& start);

}  // namespace kerf
