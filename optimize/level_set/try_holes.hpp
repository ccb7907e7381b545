#pragma once
// What became of the holes that nucleation cut.

#include "optimize/level_set/ground.hpp"
#include "optimize/level_set/hole_terms.hpp"

namespace kerf {

/// The design in which they are made, and the mesh size against the one asked for.
struct HolesTried {
  const Ground& g;
  const Evaluated& design;
  double coarse;
};

/// Terms, predicted and actual change of J of holes as they were drawn, each made alone [theory: L.14]; where that
/// cannot be had the note says why. Returns how often the states were solved.
int try_holes(const HolesTried& in, HoleExpansion& expansion, std::vector<NucleatedHole>& holes);

/// For the history: "2 holes nucleated: J by 0.0125, predicted 0.0123".
std::string in_words(std::span<const NucleatedHole> holes);

}  // namespace kerf
