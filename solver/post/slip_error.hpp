#pragma once
// How far false pressure beside a tip may have carried K_II by way of friction. Internal to this room.

#include "solver/post/crack_tip.hpp"

#include "kerf/recover.hpp"
#include "kerf/scene.hpp"

#include <span>

namespace kerf {

/// Slip at a tip makes pressure of the order of K_II/sqrt(h) on a few edges unless the mesh around it is its own mirror
/// image, and Coulomb's friction turns it into an error of K_II at every h. The pressure of the body is smooth up to a
/// closed tip: what differs from a line over `length` (halved until nine tenths of it are closed) is taken as false,
/// and weighted by what a shear at r does to K_II, (2/(pi r))^(1/2) [theory: F.8]. An estimate, seldom too small; 0
/// at tips that are open, and without Coulomb's friction.
double slip_error(const CrackTip& tip, const CrackLaw& law, std::span<const CrackPoint> profile, double length);

}  // namespace kerf
