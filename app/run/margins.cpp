// The largest stress between corners, and margins of stresses, displacements, K, G and T: the state once more by the
// element of one degree more on the same mesh, contact solved anew,
//   margin = c max(|M - M_b|, root mean square of the difference around the largest value) [theory: R.11],
// c = 1.5, 3 where the two differ by more than a twentieth, or 6 where the body has singular points and for what stands
// at tips. In parts the processes look for the largest stress together. Where the better element fails for want of
// memory the state is there without margins. docs/theory/recovery_and_estimates.md, "Margins".

#include "app/run/margins.hpp"

#include "kerf/fracture.hpp"
#include "solver/error_bars.hpp"
#include "solver/half_cracks.hpp"
#include "solver/largest_stress.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <new>

namespace kerf {

namespace {

constexpr double most_triangles = 30000;  // half a second on one processor
// Times the difference of the two solutions. Beside singular points a higher degree takes a quarter of the error away:
// that of K falls with the square of the degree at a fixed mesh.
constexpr double smooth = 1.5, singular = 6;
// Where the two differ by more than a twentieth the mesh is too coarse for either.
constexpr double too_coarse = 0.05, coarse = 3;
constexpr double worth_saying = 0.02;

std::function<bool(const Vec2&)> in_zones(const SingularZones& zones) {
  return [&zones](const Vec2& x) { return zones.hold(x); };
}

/// The value that a margin belongs to: what a finer mesh does not change.
PlacedValue* regular_part(Peak& peak) {
  return !peak.singular ? &peak.largest : peak.regular ? &*peak.regular : nullptr;
}

/// From what the better solution has at the same tips, in the same order.
void add_to_tips(const Model& better, const State& state, std::span<const Index> planes,
                 std::vector<CrackResult>& cracks) {
  const bool any = std::ranges::any_of(cracks, [](const CrackResult& crack) { return !crack.tips.empty(); });
  if (!any) return;
  const auto margin = [](double x, double y, double rings) { return std::max(singular * std::abs(x - y), rings); };
  std::vector<TipIntensity> finer = crack_tips(better, state);
  const std::vector<HalfCrack> halves = half_cracks(better.mesh, better.scene, planes);
  for (const TipIntensity& tip : half_crack_tips(better, state, halves)) finer.push_back(tip);
  std::size_t i = 0;
  for (CrackResult& crack : cracks)
    for (TipResult& tip : crack.tips) {
      if (i == finer.size()) return;
      const TipIntensity& b = finer[i++];
      if (!tip.K_I || !tip.spread || !std::isfinite(b.K_I)) continue;
      const double K = std::hypot(*tip.K_I, *tip.K_II), T = tip.T.value_or(nan);
      tip.margin = {.K_I = margin(*tip.K_I, b.K_I, tip.spread->K_I * K),
                    .K_II = margin(*tip.K_II, b.K_II, tip.spread->K_II * K),
                    .G = margin(*tip.G, b.G, 0),
                    .T = margin(T, b.T, tip.spread->T * std::abs(T))};
    }
}

void set_margins(const Case& c, const Adapted& adapted, const PlotData& data, const Model& better, const State& state,
                 StateResult& result, std::vector<CrackResult>& cracks) {
  const Model& m = adapted.model;
  const SingularZones zones = singular_zones(m, extent(c.shape));
  const double safety = zones.points.empty() ? smooth : singular;
  if (PlacedValue* stress = result.von_mises ? regular_part(*result.von_mises) : nullptr) {
    const std::vector<PointIn> points = points_near_largest(m, data.corners, data.von_mises, in_zones(zones));
    const double difference = difference_of(von_mises_at(m, adapted.state, c.plane_strain, points),
                                            von_mises_at(better, state, c.plane_strain, points));
    stress->margin = (difference > too_coarse * stress->value ? std::max(safety, coarse) : safety) * difference;
    if (*stress->margin > worth_saying * stress->value && !lies_on_chords_of_file(c, m.mesh, *result.von_mises)) {
      const double size = quality(m.mesh).h_max;
      const std::string finer = c.mesh ? std::string("a finer mesh in domain.file")
                                       : fmt::format("mesh.size = {:.2g} instead of {:.2g}", 0.5 * size, size);
      result.notes.push_back(fmt::format(
          "the largest von Mises stress is known to {:.2g} % only: {}, or solver.degree = {}, makes that less",
          100 * *stress->margin / stress->value, finer, std::min(4, c.element.degree + 1)));
    }
  }
  if (result.displacement) {
    const Points u = corner_values(better, state, data.corners).displacement;
    const double difference = (u - data.values.displacement).colwise().norm().maxCoeff();
    result.displacement->largest.margin = safety * difference;
  }
  add_to_tips(better, state, c.planes, cracks);
}

}  // namespace

bool wants_margins(const Case& c, double triangles) {
  return c.output.peaks && c.output.margins.value_or(triangles <= most_triangles) && can_be_bettered(c.element) &&
         is_mixed(c.element) && c.steps.empty();
}

void refine_peak(const SolvedPart& s, const PlotData& data, bool plane_strain, const SingularZones& zones,
                 const std::vector<bool>& own, Peak& von_mises) {
  PlacedValue* value = regular_part(von_mises);
  if (!value) return;
  Eigen::VectorXd at_corners = data.von_mises;
  for (Eigen::Index i = 0; i < at_corners.size(); ++i)
    if (!own[static_cast<std::size_t>(i)] || !(at_corners[i] >= near_largest * value->value)) at_corners[i] = nan;
  const std::vector<PointIn> points = points_near_largest(s.model, data.corners, at_corners, in_zones(zones));
  const Eigen::VectorXd found = von_mises_at(s.model, s.state, plane_strain, points);
  struct Flat {
    double value, x, y;
  };
  std::vector<Flat> flat;
  Eigen::Index best = 0;
  if (found.size() > 0 && std::isfinite(found.maxCoeff(&best))) {
    const Vec2& x = points[static_cast<std::size_t>(best)].x;
    flat.push_back({found[best], x.x(), x.y()});
  }
  const std::vector<Flat> all = gathered(s.comm, flat);
  const auto largest = std::ranges::max_element(all, {}, &Flat::value);
  if (largest != all.end()) *value = {Vec2(largest->x, largest->y), largest->value};
}

void add_margins(const Case& c, const Adapted& adapted, const PlotData& data, StateResult& result,
                 std::vector<CrackResult>& cracks) {
  if (!wants_margins(c, static_cast<double>(adapted.model.mesh.triangles.size())) || has_large_contact(adapted.model))
    return;
  try {
    const Model better =
        prepare(adapted.model.mesh, better_element(c.element), adapted.model.scene, adapted.model.threads);
    const State state = solve(better, c.contact);
    if (certified(state)) set_margins(c, adapted, data, better, state, result, cracks);
  } catch (const Error& e) {  // too large for one degree more: the state is there without margins
    if (e.fault != Fault::Numerics) throw;
    result.notes.push_back(fmt::format("no margins: {}", e.what()));
  } catch (const std::bad_alloc&) {
    result.notes.emplace_back("no margins: one degree more needs more memory than there is");
  }
}

}  // namespace kerf
