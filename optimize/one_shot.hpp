#pragma once
// Starting guesses of an inverse problem in one shot: everything from topological derivatives on the body without what
// is looked for.

#include "optimize/design.hpp"
#include "optimize/problem.hpp"

namespace kerf {

/// Something small that explains a part of the data.
struct Guess {
  std::size_t drawn = 0;  // number in the design
  Vec2 at = Vec2::Zero();
  double size = 0;   // radius, half the length of a crack
  double angle = 0;  // radians, of a crack
  double young = 0;  // of an inclusion
};

struct OneShot {
  Design design;  // with the starts filled in
  std::vector<Guess> guesses;
  double explained = 0;  // part of the data: 1 - |u_m - u(guess)|^2 / |u_m - u|^2 in the hats; NaN: no misfit
  int solves = 0;        // states and linear ones
};

/// With a misfit: the data are the differences u_m - u between the measured displacements and those of the body without
/// what is looked for, b_k = int phi_k . (u_m - u), phi_k hats along the label, normed in L2, so that independent noise
/// at the sensors is independent and equal in all b. A hole of area a at x changes reading k by a T_k(x), T_k its
/// topological derivative. The guess minimises
///   |b - sum_i a_i T(x_i)|^2
/// over places, angles and areas a_i = pi size_i^2 within the boxes of the design: the expansion of the misfit to
/// second order in the areas. Best places first among a grid of candidates (pairs together where there are few enough),
/// then between them. The first-order part alone, which is the map of the misfit, does not tell how deep a hole lies:
/// the stresses that it is made of are largest at the boundary.
///
/// Then the guess is drawn and solved for, what the expansion missed is taken off b, and the fit repeated as long as
/// that explains more: holes are not small, and feel each other.
///
/// Without a misfit: the most negative values of the map of the objective, apart from one another and as far from
/// everything else as their size needs, which stays the start's.
///
/// `clear`: what must remain between two of them and to everything else. Throws Error(Usage) where nothing of the boxes
/// lies in the body, and like analyse and responses.
OneShot one_shot(const Problem& problem, const Design& design, double clear);

/// Whether there is anything to be read off a map.
bool wants_map(const Design& design);

}  // namespace kerf
