#pragma once
// What an infinitesimal kink of a crack sees, and which way the crack turns: by local symmetry, by the largest energy
// release rate, by the largest hoop stress [theory: G.1, G.2, G.3, G.4, G.5].
//
// Angles in radians, counter-clockwise from the tip's own direction. K_I < 0 (faces that a gap keeps apart) counts as
// 0. K_II > 0 turns a crack to negative angles. Everything is odd in K_II to the last bit. All functions throw Error
// (Usage) where an argument is not finite.

#include "kerf/growth.hpp"

#include <functional>
#include <optional>

namespace kerf::growth {

/// A tip: K_I, K_II [stress length^1/2] and T [stress].
struct TipLoad {
  double K_I = 0, K_II = 0, T = 0;
};
struct KinkLoad {
  double k_1 = 0, k_2 = 0;
};

/// The series of the kink are used up to this angle.
inline constexpr double largest_kink = pi / 2;

/// k_p = F_pq K_q + G_p T sqrt(length) at the end of a straight kink of this length, faces free, up to O(length)
/// [Amestoy, Leblond 1992; theory: G.1, G.2]. Throws beyond `largest_kink`, and for a negative length.
KinkLoad kink(const TipLoad& tip, double angle, double length = 0);

/// E/(1 - nu^2) in plane strain, E in plane stress.
double effective_modulus(double young, double poisson, bool plane_strain);
/// (max(k_1, 0)^2 + k_2^2)/E' [theory: G.3].
double release_rate(const KinkLoad& k, double effective_modulus);

/// A direction. `rival`: another one that is as good, as in a symmetric set-up which may go either way: then rounding
/// decides in a computation, and a report should say so. `at_limit`: the criterion wants more than `largest_kink`.
struct Direction {
  double angle = 0;
  KinkLoad k;  // there
  std::optional<double> rival;
  bool at_limit = false;
};

/// k_2 = 0: the first such angle on the side to which K_II turns the crack. Straight on for K_II = 0; with a rival
/// where a large T sqrt(length) makes that unstable [theory: G.4].
Direction symmetric_direction(const TipLoad& tip, double length = 0);

/// The largest G on the side to which K_II turns the crack, or the largest G/G_c for a toughness [force/length, > 0]
/// that depends on the angle, which is looked for all around in steps of a quarter of a degree [theory: G.3]. Throws
/// where the toughness is not positive.
using Toughness = std::function<double(double angle)>;
Direction energetic_direction(const TipLoad& tip, double length = 0, const Toughness& toughness = {});

/// 2 atan((K_I - sqrt(K_I^2 + 8 K_II^2))/(4 K_II)) [Erdogan, Sih 1963; theory: G.5].
Direction hoop_direction(const TipLoad& tip);

/// The largest k_1. With K_I = 0 it is where a closed crack opens a wing.
Direction opening_direction(const TipLoad& tip, double length = 0);

Direction direction(Criterion criterion, const TipLoad& tip, double length = 0);

/// Whether a crack under pressure grows in its own plane: no kink has k_1 >= K_Ic, and |K_II| > K_IIc.
bool grows_by_shear(const TipLoad& tip, double K_Ic, double K_IIc, double length = 0);

/// The path of a tip whose K_II is small [Cotterell, Rice 1980; theory: G.6]: y at x >= 0 ahead of it, and dy/dx.
/// slope = -2 K_II/K_I, beta = 2 sqrt(2) T/K_I [length^-1/2].
double slightly_curved_path(double x, double slope, double beta);
double slightly_curved_slope(double x, double slope, double beta);

}  // namespace kerf::growth
