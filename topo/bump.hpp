#pragma once
// Material added to a free edge.

namespace kerf {

/// What a half disc of material on a free edge brings over what a thin layer of the same area does, of a change that
/// the stress along the edge makes: of any material, in plane stress and plane strain [theory: L.13].
inline constexpr double bump_share = 0.16464;

}  // namespace kerf
