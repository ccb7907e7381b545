// How far the loads are from what the material bears. Against yield: the yield stress over the largest von Mises stress
// away from singular points, where a stress of the mesh would say nothing. Against fracture: the toughness over
// K_eq = sqrt(max(K_I, 0)^2 + K_II^2), or the root of G_c/G, which is the same where K_Ic^2 = E' G_c. Factors are those
// of the loads where the response is proportional to them: no gaps, no eigenstrain, no pressure that does not grow with
// the loads. Of each material that has a strength, the largest stress in its own triangles counts.

#include "app/run/reserve.hpp"

#include "geometry/plane.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// The innermost region that holds x; none: outside of all.
Index region_at(const Shape& shape, const Vec2& x) {
  Index found = none;
  double least = infinity;
  const double chord = 1e-4 * extent(shape), step = 0.01 * extent(shape);
  for (std::size_t k = 0; k < shape.regions.size(); ++k) {
    Shape alone;
    alone.outline = shape.regions[k];
    if (inside(flatten(shape.regions[k], chord, step).points, x) && area(alone) < least) {
      least = area(alone);
      found = static_cast<Index>(k);
    }
  }
  return found;
}

std::string name_of_region(const Shape& shape, Index region) {
  return region == none ? std::string() : shape.regions[static_cast<std::size_t>(region)].name;
}

const Strength* strength_of(const Case& c, const std::string& region) {
  const auto found = std::ranges::find(c.strength, region, &Strength::region);
  return found == c.strength.end() ? nullptr : &*found;
}

/// The values at corners of own triangles of one region; not a number elsewhere.
Eigen::VectorXd in_region(const Model& model, const PlotData& data, Index region) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(data.von_mises.size(), nan);
  for (Index t = 0; t < own_triangles(model); ++t)
    if (region_of(model.mesh, t) == region)
      for (const Index corner : data.corners.of[static_cast<std::size_t>(t)]) out[corner] = data.von_mises[corner];
  return out;
}

std::optional<PlacedValue> regular(const std::optional<Peak>& peak) {
  if (!peak) return std::nullopt;
  return peak->singular ? peak->regular : std::optional(peak->largest);
}

/// What is known of the whole body, where it lies in this region, too, is known better than at corners.
std::optional<PlacedValue> largest_in(const SolvedPart& s, const PlotData& data, const std::optional<Peak>& of_body,
                                      const SingularZones& zones, Index region) {
  const auto whole = regular(of_body);
  const auto own = regular(largest_of(s.comm, peak(data.points, in_region(s.model, data, region), zones)));
  return own && whole && whole->value > own->value && (whole->at - own->at).norm() <= zones.largest() ? whole : own;
}

ReserveResult against(ReserveResult::Of of, double value, double limit, const Vec2& at) {
  return {.of = of, .value = value, .limit = limit, .factor = value > 0 ? limit / value : infinity, .at = at};
}

void add_tips(const Case& c, const std::vector<CrackResult>& cracks, std::vector<ReserveResult>& out) {
  for (const CrackResult& crack : cracks)
    for (const TipResult& tip : crack.tips) {
      const Index region = region_at(c.shape, tip.at);
      const Strength* const found = strength_of(c, name_of_region(c.shape, region));
      if (!found) continue;
      const Strength& bears = *found;
      std::optional<ReserveResult> r;
      if (bears.toughness && tip.K_I && tip.K_II)
        r = against(ReserveResult::Of::Toughness, std::hypot(std::max(*tip.K_I, 0.0), *tip.K_II), *bears.toughness,
                    tip.at);
      if (bears.release_rate && tip.G) {
        r = against(ReserveResult::Of::ReleaseRate, *tip.G, *bears.release_rate, tip.at);
        r->factor = std::sqrt(r->factor);
      }
      if (!r) continue;
      r->region = name_of_region(c.shape, region);
      r->crack = crack.name;
      out.push_back(std::move(*r));
    }
}

}  // namespace

std::vector<ReserveResult> reserves_of(const Case& c, const SolvedPart& solved, const PlotData& data,
                                       const SingularZones& zones, const Findings& found) {
  std::vector<ReserveResult> out;
  if (c.strength.empty()) return out;
  // By name: a design may have other regions than the case.
  const auto regions = static_cast<Index>(c.shape.regions.size());
  for (Index region = none; region < regions; ++region) {
    const Strength* const bears = strength_of(c, name_of_region(c.shape, region));
    if (!bears || !bears->yield) continue;
    const auto& body = found.state.von_mises;
    const auto largest = regions == 0 ? regular(body) : largest_in(solved, data, body, zones, region);
    if (!largest) continue;
    out.push_back(against(ReserveResult::Of::Yield, largest->value, *bears->yield, largest->at));
    out.back().region = bears->region;
  }
  add_tips(c, found.cracks, out);
  std::ranges::stable_sort(out, {}, &ReserveResult::factor);
  return out;
}

}  // namespace kerf
