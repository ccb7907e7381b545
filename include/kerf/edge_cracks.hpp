#pragma once
// The worst crack anywhere on the boundary: K of a short crack of a given length at every place of the outline and of
// holes, from one state of the body without it. docs/theory/edge_cracks.md.

#include "kerf/growth.hpp"
#include "kerf/validate.hpp"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::inspect {

struct EdgeCrackRequest {
  double length = 0;
  std::optional<double> angle = {};  // radians from the boundary, 90 degrees: normal; none: the worst one
  double friction = 0;               // of the would-be crack, whose faces may touch
  bool pressurized = false;          // the pressure on the boundary acts in the crack, too
  std::vector<Vec2> points = {};     // the nearest places of the boundary alone; none: all
};

/// What lies too near for the expansion.
enum class Masked {
  No,
  Support,    // the place is held, or near the end of what is
  Reentrant,  // a corner, tip or junction where the stress may be infinite
  Convex,     // a corner that is no more than that
  Near,       // the other side of the body, a crack, another material
  Rough       // the stress is no quadratic polynomial over the length
};
inline constexpr std::array<Masked, 5> reasons_to_mask{Masked::Support, Masked::Reentrant, Masked::Convex, Masked::Near,
                                                       Masked::Rough};
/// "no", "support", "reentrant corner", "convex corner", "too near", "stress not smooth".
std::string_view word(Masked why);

/// K of a crack at one place, and which crack.
struct EdgeCrack {
  Vec2 at = Vec2::Zero(), inward = Vec2::Zero();  // unit normal
  double along = 0;                               // length of the boundary that the place stands for
  double curvature = 0;                           // of the boundary; positive: convex
  double angle = 0;                               // radians from the boundary, the body to its left
  double K_I = 0, K_II = 0, K = 0, G = 0;         // K = sqrt(E' G)
  bool closed = false;                            // faces touch: K_I = 0, K_II less friction
  double stress = 0, gradient = 0;                // along the boundary, and its change per depth
  double first_order = 0;                         // 1.1215 stress sqrt(pi length), what handbooks say
  double valid_length = 0;                        // up to which K is good to 5 % by the geometry of the boundary
  double corner = nan;  // exponent lambda of the reentrant corner that it begins at; NaN: a smooth boundary
  Masked masked = Masked::No;
  Vec2 direction() const;  // of the crack, unit
  bool flattest() const;   // the angle is the flattest that is known: a flatter one may be worse
};

/// A functional for maps and optimizations: (int K_I^p)^(1/p) along these parts of the boundary, K_I of open cracks of
/// this length normal to it, with the terms of curvature and of the stress along them [theory: M.8]. The larger p, the
/// nearer to the worst one. As the cycles that a crack lives fall like K^-m, that of 1/N with p is that of K with m p.
/// Unit: K length^(1/p).
Term worst_edge_crack(std::vector<Index> labels, double length, double p);

/// How much damage a place bears.
struct ToleranceRequest {
  std::optional<double> toughness = {};       // K_c
  std::optional<growth::GrowthLaw> law = {};  // of fatigue, with its own K_c
  double max = 1, min = 0;                    // of a cycle: factors of the loads; below 0 the crack is closed
  double factor = 2;                          // cycles over the interval between two inspections
};
enum class Tolerated {
  Unknown,   // masked
  Critical,  // after `cycles`, at `critical_length`
  AtLeast,   // cycles until valid_length, beyond which the expansion says nothing; not critical up to there
  Rests      // the range of K is below the threshold: it does not grow
};
/// "", "critical", "at least", "rests".
std::string_view word(Tolerated how);

/// Of a crack that has the length of the map and keeps its line.
struct Tolerance {
  Tolerated how = Tolerated::Unknown;
  double critical_length = nan;  // where K is the toughness; NaN: not up to valid_length
  double cycles = nan, interval = nan;
};

/// All places along the boundary, three on each edge of the mesh, and reentrant corners between straight sides without
/// loads, where the crack is on the bisector; or those that were asked for. Masked ones keep what can be said.
struct EdgeCrackMap {
  double length = 0;
  std::vector<EdgeCrack> places;
  std::vector<std::size_t> worst;  // largest K among its neighbors, not masked, by falling K; ten at most
  double masked_share = 0;         // of the length of the boundary
  std::array<double, reasons_to_mask.size()> masked_by = {};  // why
  std::vector<Tolerance> tolerance = {};                      // per place, where it is asked for
  /// The shortest critical length, at `safe_at`; NaN: none up to valid_length, or no toughness. `open_share`: of the
  /// length of the boundary, masked or without a critical length up to a valid_length that is shorter than that.
  double safe_length = nan;
  std::size_t safe_at = 0;
  double open_share = 0;
};

/// The stress of a state, recovered once for all that is asked of it. Model and state must outlive it.
struct RecoveredState;
std::shared_ptr<const RecoveredState> recover_state(const Model& model, const State& state);

/// Throws Error(Usage) for a length that is not positive, an angle beyond 30 to 150 degrees, friction below 0, an
/// orthotropic material.
/// With `tolerance` also critical lengths, lives and intervals; throws Error(Usage) for neither a toughness nor a law.
EdgeCrackMap edge_cracks(const RecoveredState& state, const EdgeCrackRequest& request,
                         const std::optional<ToleranceRequest>& tolerance = {});
EdgeCrackMap edge_cracks(const Model& model, const State& state, const EdgeCrackRequest& request,
                         const std::optional<ToleranceRequest>& tolerance = {});

/// One crack of the expansion drawn into the body and solved.
struct DrawnEdge {
  double length = 0;
  double K_I = nan, K_II = nan, spread = nan;    // of the drawn crack, and what its rings differ by
  double predicted_I = nan, predicted_II = nan;  // of the expansion
  double first_order = nan;                      // EdgeCrack::first_order
  double error = nan;                            // |K - predicted|/K
  bool valid = false;                            // within valid_length and not masked
};
struct DrawnPlace {
  EdgeCrack crack;  // of the first length
  std::vector<DrawnEdge> rows;
  Verdict verdict = Verdict::NothingSaid;
  std::string reason;
};
/// Cracks of these lengths at the place and the angle of each of `cracks`. Holds: every length within valid_length
/// agrees to 5 % and what the rings differ by. Throws as solve_graded does, but for lengths that cannot be drawn.
std::vector<DrawnPlace> draw_cracks(const RecoveredState& state, const Meshing& body, const EdgeCrackRequest& request,
                                    const std::vector<EdgeCrack>& cracks, const std::vector<double>& lengths,
                                    const Adaptation& how);

}  // namespace kerf::inspect
