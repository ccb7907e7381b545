#pragma once
// Cracks that grow, quasi-statically or by fatigue: bodies solved one after the other, each with the pieces that the
// cracks have grown by. docs/theory/growth.md.

#include "kerf/adaptive.hpp"
#include "kerf/fracture.hpp"

#include <array>
#include <compare>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace kerf::growth {

/// The direction of a crack that grows: K_II = 0 at the tip that has grown (found on the grown body), the largest
/// energy release rate or the largest hoop stress (both by the series of a kink, at the tip before).
enum class Criterion { LocalSymmetry, Energy, HoopStress };
inline constexpr std::array<std::string_view, 3> criterion_words{"local symmetry", "energy", "hoop stress"};

/// C dK^m [Paris, Erdogan 1963].
struct Paris {
  double C = 0, m = 0;
};
/// C (dK/(1 - R)^(1 - gamma))^m [Walker 1970].
struct Walker {
  double C = 0, m = 0, gamma = 1;
};
/// C dK^m/((1 - R) K_c - dK) [Forman, Kearney, Engle 1967]; C with the unit of K more.
struct Forman {
  double C = 0, m = 0;
};
/// C ((1 - f)/(1 - R) dK)^m (1 - dK_th/dK)^p/(1 - K_max/K_c)^q, f by Newman [Forman, Mettu 1992; Newman 1984];
/// dK_th by [theory: G.11].
struct Nasgro {
  double C = 0, m = 0, p = 0, q = 0;
  double alpha = 1;                // constraint: 1 plane stress, 3 plane strain
  double flow_ratio = 0.3;         // largest stress over flow stress, in [0, 1)
  double dK_0 = 0, a_0 = 0;        // threshold at R = 0, and the length below which it falls
  double C_plus = 0, C_minus = 0;  // how it depends on R >= 0 and on R < 0
};

/// K_c: where K_max reaches it the crack runs; Forman and NASGRO want a finite one. `threshold`: dK up to which a crack
/// rests, of all laws but NASGRO, which has its own.
struct GrowthLaw {
  std::variant<Paris, Walker, Forman, Nasgro> form;
  double K_c = infinity;
  double threshold = 0;
};

/// One end of a crack of the shape.
struct CrackEnd {
  Index crack = 0;
  bool at_start = false;
  auto operator<=>(const CrackEnd&) const = default;
};

/// What counts instead for tips in a region of the shape.
struct RegionLaw {
  Index region = none;
  std::optional<double> toughness = {};
  std::optional<GrowthLaw> law = {};
};

struct GrowRequest {
  std::optional<double> toughness = {};  // K_Ic: quasi-static growth
  /// G_c in the absolute direction phi [radians from x] over that of K_Ic, positive; none: 1.
  std::function<double(double phi)> anisotropy = {};
  double toughness_shear = infinity;    // K_IIc: of growth in the crack's own plane where no kink opens at K_Ic
  std::optional<GrowthLaw> law = {};    // else by fatigue
  std::vector<RegionLaw> regions = {};  // of the same kind
  Criterion criterion = Criterion::LocalSymmetry;
  std::vector<CrackEnd> tips = {};    // that may grow; none: all
  double max = 1, min = 0;            // of a cycle: factors of the loads
  std::vector<double> spectrum = {};  // or a history of such factors that repeats, with max and min: cycles are blocks
  double step = 0;                    // by which the fastest tip grows; 0: a tenth of the shortest crack that grows
  // Of what cracks have grown by, and of the cycles: growth is repeated with half the step until two runs differ by no
  // more than that; 0: once.
  double tolerance = 0;
  // Growth ends at the first of these; lengths are those of a crack's path.
  double length = infinity, cycles = infinity, K = infinity;
  int steps = 100;
  double stress = 1;    // that beta refers to: beta = K_max/(stress sqrt(pi a))
  bool bounds = false;  // intervals of K, G and the energy at each step, of the life and of the energy released
};

/// Intervals of K and G at an end of a crack, and whether they are guaranteed; the note says why not.
struct TipIntervals {
  CrackEnd end;
  Interval K_I{nan, nan}, K_II{nan, nan}, G{nan, nan};
  bool guaranteed = false;
  std::string note;
};
/// Of a state: the potential energy, and its tips that grow.
struct StateBounds {
  Interval energy{nan, nan};
  bool guaranteed = false;
  std::string note;
  std::vector<TipIntervals> tips;
};

/// A tip of one step, before it grows on.
struct GrownTip {
  CrackEnd end;
  std::string name;  // "c:end"
  Vec2 at = Vec2::Zero();
  double a = 0;                                    // length of the crack
  Index region = none;                             // in which it lies
  double K_I = nan, K_II = nan, T = nan, G = nan;  // at the largest load
  double K_max = nan;                              // k_1 of the kink that opens most, at the largest load
  double K_I_min = nan, K_II_min = nan;            // at the least one
  double dK = 0;                                   // equivalent range; quasi-static: equivalent K at the load
  double rate = 0;                                 // per cycle
  double da = 0, angle = 0;                        // it grows by; radians, against the direction of the tip
  double symmetry = nan;                           // |K_II|/K_I where it has grown to
  std::optional<TipIntervals> in = {};             // at the largest load
};

struct GrowthStep {
  int number = 0;
  double cycles = 0;     // so far, by the points up to this one
  double load = 1;       // quasi-static: factor of the loads at which a tip grows
  double strain = 0;     // energy
  double potential = 0;  // energy of the state that was solved: at the loads of the case, or, where K is not
                         // proportional to them, at the largest of the cycle
  int solves = 0;
  std::vector<GrownTip> tips;
};

/// Along the path that has been computed, from intervals at the steps; not a number where there are none.
struct PathBounds {
  /// Cycles, if K changes one way from each step to the next; and, narrower, if it is smooth between them.
  Interval cycles{nan, nan}, cycles_smooth{nan, nan};
  /// int G da over all tips, if G changes one way from each step to the next, and the loss of potential energy: two
  /// intervals of one number.
  Interval released{nan, nan}, lost{nan, nan};
  bool guaranteed = false;  // at every step
  std::string note;         // why not
};

struct Grown {
  Shape shape;
  std::vector<GrowthStep> steps;
  double step = 0;  // by which the fastest tip has grown
  // With a tolerance: how far this run is off the one with twice the step, tips and cycles; else not known. The error
  // of the latter by the points alone is in `cycles_error`, too.
  double path_error = nan, cycles_error = nan;
  // What the interaction integrals say that growth has released, int G da over all tips, less the loss of potential
  // energy, relative to that: two ways to the same number. Not known with friction, or where a tip has ended or has
  // crossed the border of a region, at which G jumps.
  double energy_balance = nan;
  std::optional<PathBounds> bounds = {};
  /// Quasi-static: the first step at which the crack grows on under a falling load, and that at which it does so though
  /// the displacement of the loads is held, too; none: there is no such step.
  std::optional<int> unstable_from = {}, snaps_back_from = {};
  std::string ended;  // why, in words
  std::vector<std::string> notes;
  int solves = 0;
};

/// What growth takes from a state.
struct SolvedState {
  double potential = 0, strain = 0;  // energies
  double resting = 0;                // K over the root of a crack's length below which its tips count as free of load
  std::vector<TipIntensity> tips;
  std::optional<StateBounds> bounds = {};
};
/// All that growth needs to go on as if it had never stopped: the states in the order in which they were solved, and
/// how many steps have been told.
struct GrowthRecord {
  std::vector<SolvedState> states;
  int told = 0;
};

/// What is told after each step: the body that grew in it, solved, and the record up to there; false ends the growth.
/// Steps that the record before has told are told again, without the solution (null). Step 0 again: with half the step.
using WatchGrowth = std::function<bool(const GrowthStep&, const Shape&, const Adapted*, const GrowthRecord&)>;

/// `before`: the record of the same growth, whose states are not solved again; the result has the same bits. Throws
/// Error(Usage) for what cannot grow (no tip, a crack that follows an arc or a border), else as solve_graded. `how`: as
/// for each of the states.
Grown grow(Shape shape, const Sizing& sizing, const Element& e, const Scene& scene, const GrowRequest& request,
           const Adaptation& how, const WatchGrowth& watch = {}, GrowthRecord before = {});

}  // namespace kerf::growth
