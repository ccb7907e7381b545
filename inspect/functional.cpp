// K of open cracks normal to the boundary as a functional. Quadratic loads on a crack of length a give
//   K_I = sqrt(pi a) sum_j N_j (F_j + k a H_j),   N(s) = sum_j N_j (s/a)^j                                [theory: M.1]
// and their values at s/a = 0, 1/2, 1 say what the N_j are: K_I = sqrt(pi a) sum_k (c_k + k a h_k) N(s_k) with weights
// c, h that have the moments F, H [theory: M.8].

#include "inspect/mouth.hpp"
#include "kerf/edge_cracks.hpp"

namespace kerf::inspect {

namespace {

/// c with sum_k c_k depth_k^j = moment_j at the depths 0, 1/2, 1.
std::array<double, powers> weights_of(const Powers& moment) {
  const double middle = 4 * (moment[1] - moment[2]), end = moment[1] - middle / 2;
  return {moment[0] - middle - end, middle, end};
}

}  // namespace

Term worst_edge_crack(std::vector<Index> labels, double length, double p) {
  if (!(length > 0 && p >= 2))
    throw Error(Fault::Usage, "worst_edge_crack: a positive length and a power of 2 or more are wanted");
  static const Column normal = open_mouth(pi / 2).K[0][0];
  Term term{.kind = "worst_edge_crack", .power = 1 / p, .uses_stress = true, .uses_place = false};
  term.edge_cracks = EdgeCrackNorm{.length = length,
                                   .p = p,
                                   .labels = std::move(labels),
                                   .depth = {0, 0.5, 1},
                                   .weight = weights_of(normal.straight),
                                   .bend = weights_of(normal.curved)};
  return term;
}

}  // namespace kerf::inspect
