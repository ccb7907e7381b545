#pragma once
// The eigenstrain of an inclusion that keeps that of its place.

#include "kerf/mesh.hpp"
#include "kerf/scene.hpp"

namespace kerf {

/// nu* - nu of an inclusion and of what surrounds it, in plane strain: what the plane problem sees of e33 differs by
/// this times it, along both axes [theory: H.2].
constexpr double out_of_plane_share(const Material& around, const Material& inside) {
  return 2 * (around.mu * around.c - inside.mu * inside.c);
}

/// The eigenstrain of a place as the plane problem sees it in another material.
Eigenstrain seen_in(const Eigenstrain& here, const Material& around, const Material& inside);

/// What an inclusion of that material in triangle t strains at x, along both axes, beyond what surrounds it. 0 in plane
/// stress and without e33.
double strain_beyond(const Mesh& mesh, const Scene& scene, const Material& inclusion, Index t, const Vec2& x);

}  // namespace kerf
