#pragma once
// Cracks in a plane of symmetry of which the model has one half: the body on one side of the plane, held along it by
// rollers ahead of the tip (the ligament) and free behind it (one face of the crack).

#include "kerf/fracture.hpp"
#include "kerf/recover.hpp"

#include <array>
#include <span>
#include <vector>

namespace kerf {

/// The face that is there: a straight run of edges of the boundary without supports, next to a ligament.
struct HalfCrack {
  std::vector<Index> edges;                 // along the boundary, the body on the left: from start to end
  std::array<bool, 2> tips{};               // whether a ligament goes on, straight, before the start and behind the end
  std::array<Index, 2> label{};             // of the edges at the start and at the end
  std::array<std::vector<Index>, 2> ahead;  // the ligaments, from the tip
};

/// `planes`: labels of straight sides on which the normal displacement is 0 and the shear, too. Where a crack or the
/// border of a region ends at the point between face and ligament there is no tip. In the order of their first edges.
std::vector<HalfCrack> half_cracks(const Mesh& mesh, const Scene& scene, std::span<const Index> planes);

/// Where the tip at the start, or at the end, lies.
Vec2 tip_of(const Mesh& mesh, const HalfCrack& crack, bool start);

/// As crack_profile has it for the crack of the whole body: the left face is the one that is there, the right one its
/// mirror image, so that jump_n is twice the displacement into the body, and jump_t is 0. sigma_n is that of the loads;
/// nothing keeps the faces apart.
std::vector<CrackPoint> half_profile(const Model& model, const Field& state, const HalfCrack& crack);

/// K_I, T, G and J of the whole body, K_II = 0: the integrals of crack_tips over the half ring that is there, twice
/// [theory: F.10]. `TipIntensity::crack` counts the cracks that are given, start before end.
std::vector<TipIntensity> half_crack_tips(const Model& model, const Field& state, std::span<const HalfCrack> cracks);

}  // namespace kerf
