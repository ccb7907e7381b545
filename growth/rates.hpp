#pragma once
// How far a crack grows in a cycle of load: the laws of Paris, Walker, Forman and NASGRO, and what K of a mixed mode is
// put into them [theory: G.8, G.9, G.10, G.11, G.12].
//
// K in one unit [stress length^1/2], lengths in that of C. K_min is what the body has at the least load: 0 where
// contact closes the tip. No part of a cycle is cut here, and none is assumed: R = K_min/K_max may be negative.

#include "growth/kink.hpp"

#include <optional>
#include <string>

namespace kerf::growth {

std::string name(const GrowthLaw& law);

/// Throws Error (Usage) with a sentence for a user where a constant is not what the law wants.
void check(const GrowthLaw& law);

/// dK_th at this R <= 1 of a crack of length a.
double threshold(const GrowthLaw& law, double R, double a);

/// da/dN: 0 up to the threshold and for K_max <= 0, infinity from K_max = K_c on. Throws (Usage) for K_min > K_max.
double rate(const GrowthLaw& law, double K_max, double K_min, double a);

/// Newman's f = K_op/K_max at R <= 1, that at R = -2 below it [Newman 1984; theory: G.10].
double opening_ratio(double R, double alpha, double flow_ratio);

/// What speaks against the units of a law at this cycle, or nothing: less than an atom in 1e12 cycles cannot be told,
/// but growth by more than the crack's own length in a cycle can.
std::string doubt(const GrowthLaw& law, double K_max, double K_min, double a);

/// How two loads of a mixed mode make one range.
enum class Equivalence {
  Opening,  // the kink whose k_1 changes most: max over angles of |max(k_1, 0) at one - max(k_1, 0) at the other|
  Energy,   // sqrt(dK_I^2 + dK_II^2)
  Tanaka    // (dK_I^4 + 8 dK_II^4)^(1/4) [Tanaka 1974]
};

/// K_max and K_min of a law, of the two loads between which a cycle goes; K_I < 0 counts as 0. `angle`: of the kink, 0
/// but for Opening, with a `rival` where another is as good (full reversals in shear).
struct EquivalentCycle {
  double K_max = 0, K_min = 0;
  double angle = 0;
  std::optional<double> rival;
};
EquivalentCycle equivalent(Equivalence how, const TipLoad& at_max, const TipLoad& at_min);

}  // namespace kerf::growth
