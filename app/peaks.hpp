#pragma once
// The largest values of a state, told apart from those that only the mesh makes large.

#include "app/collect.hpp"
#include "kerf/case_file.hpp"

namespace kerf {

/// Where a body has infinite stresses, and how far around values are those of the mesh.
struct SingularZones {
  std::vector<Vec2> points;
  double radius = 0;  // 2 % of the extent of the body; 0 without points
  bool hold(const Vec2& x) const;
};
SingularZones singular_zones(const Model& model, double extent);

/// The largest of `values` (not finite ones left out) at `points`, and the largest outside the zones where that is
/// another one; nothing for no values.
std::optional<Peak> peak(std::span<const Vec2> points, const Eigen::VectorXd& values, const SingularZones& zones);

/// Fills in the largest stress, displacement and pressures, and notes strains above 5 % and displacements above 10 % of
/// the extent: small strains are what everything here is about.
void add_peaks(const Model& model, const PlotData& data, double extent, StateResult& state,
               std::vector<CrackResult>& cracks);

/// Chords stand for curved sides, and at their corners the stress is larger than on the curve: what to say of a largest
/// stress there that is by 2 % larger than in the middle of the chords beside it. Empty where there is nothing to say.
std::string note_on_chords(const Adapted& adapted, const PlotData& data, const Case& c, const Peak& von_mises);

}  // namespace kerf
