#pragma once
// The largest values of a state, told apart from those that only the mesh makes large.

#include "app/run/collect.hpp"
#include "kerf/case_file.hpp"

#include <array>

namespace kerf {

/// Where a body has infinite stresses, and how far around values are those of the mesh.
struct SingularZones {
  std::vector<Vec2> points;
  std::vector<double> radius;  // of each
  bool hold(const Vec2& x) const;
  double largest() const;  // radius; 0 without points
};
/// Radius: 2 % of the extent of the body, at most a tenth of the way to the next such point (the other end of a short
/// crack), and no less than two edges of the mesh.
SingularZones singular_zones(const Model& model, double extent);

/// The largest of `values` (not finite ones left out) at `points`, and the largest outside the zones where that is
/// another one; nothing for no values.
std::optional<Peak> peak(std::span<const Vec2> points, const Eigen::VectorXd& values, const SingularZones& zones);

/// The larger principal strain, without its sign, at the corners.
Eigen::VectorXd principal_strains(const Model& model, const PlotData& data);

/// Where the profiles of pressures come from: which ends of the cracks are tips, points per edge, and where pressures
/// may be infinite.
struct PressureProfiles {
  std::vector<std::array<bool, 2>> tips;
  std::size_t per_edge;
  std::vector<Vec2> singular;
  double extent;
};
/// The largest contact pressure of every crack that has one. The pressure itself says at which points it is infinite:
/// the logarithm of its mean over [h, 2h], [2h, 4h], [4h, 8h] from there, h two edges, falls at least as fast at the
/// near end. At other tips the two edges there are left out, where the discrete pressure is false [theory: F.8].
void add_pressures(const PressureProfiles& of, std::vector<CrackResult>& cracks);

/// Strains above 5 % and displacements above 10 % of the extent: small strains are what everything here is about.
std::vector<std::string> notes_on_size(const std::optional<Peak>& strain, const std::optional<Peak>& displacement,
                                       double extent);

/// Chords stand for curved sides, and at their corners the stress is larger than on the curve: what to say of a largest
/// stress there that is by 2 % larger than in the middle of the chords beside it. Empty where there is nothing to say.
std::string note_on_chords(const Case& c, const PlacedValue& top, double beside);
/// The largest stress, where it may lie at a corner of chords.
std::optional<PlacedValue> top_on_chords(const Case& c, const Peak& von_mises);
/// Whether the largest stress lies on the rim of a mesh from a file where its straight edges stand for a curve: at the
/// nearest vertex and both beside it the rim turns the same way, by less than a corner would.
bool lies_on_chords_of_file(const Case& c, const Mesh& mesh, const Peak& von_mises);
std::string note_on_chords_of_file(const PlacedValue& top);
/// Of the von Mises stress in the middle of the boundary edges that meet at a vertex, the larger one; 0 for none.
double beside(const Model& model, const State& state, const PlotData& data, bool plane_strain, const Vec2& vertex);

}  // namespace kerf
