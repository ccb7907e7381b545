#pragma once
// Optimization: what is asked, what is reported, and the two loops. A level set moves boundaries freely; numbers move
// holes, cracks and inclusions that are drawn.

#include "kerf/bounds.hpp"
#include "kerf/design.hpp"
#include "kerf/functional.hpp"
#include "kerf/mesher.hpp"
#include "kerf/state.hpp"
#include "kerf/validate.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string_view>

namespace kerf {

/// A level set, or one of NLopt's methods. Their words are those of case files, results and messages.
enum class OptimizeMethod { LevelSet, Mma, Ccsaq, Slsqp, Cobyla };
inline constexpr std::array<std::string_view, 5> optimize_method_words{"level-set", "mma", "ccsaq", "slsqp", "cobyla"};
constexpr std::string_view word(OptimizeMethod method) {
  return optimize_method_words[static_cast<std::size_t>(method)];
}

// What is asked.

/// The body to begin with, its loads, and J.
struct Problem {
  Shape frame;  // fixed holes, cracks and regions included
  Scene scene;  // of the frame: a law per crack, a material per region
  Sizing sizing;
  Element element = bdms(1);
  Functional objective;
  ContactMethod contact = ContactMethod::DualQp;
  bool plane_strain = true;  // how Young's modulus and Poisson's ratio of a drawn inclusion become a Material
  int threads = 1;
  bool follow_curves = true;  // designs are judged with edges that follow their curves, where the element can
};

/// Another set of loads on the same body with the same supports: J is the sum of weight J(state under these loads).
struct LoadCase {
  std::string name;
  double weight = 1;
  std::vector<Traction> tractions;
  VectorField body;  // empty: none
};

/// A functional that must not exceed a value. With several load cases: the worst of them.
struct FunctionalBound {
  std::string name;  // in messages and tables
  Functional functional;
  double at_most = 0;
};

/// A line through which the design is its own mirror image.
struct Mirror {
  Vec2 point = Vec2::Zero(), direction = Vec2::UnitX();
};

/// Circular holes to begin with: a regular pattern, or seeded random places.
struct StartHoles {
  int columns = 0, rows = 0;  // regular pattern in the bounding box, every other column shifted by half a row
  int random = 0;             // or this many random holes
  unsigned seed = 1;
  double radius = 0.1;
};

/// How a level set moves.
struct LevelSetRequest {
  enum class Move { ShapeGradient, FixedPoint } move = Move::ShapeGradient;
  enum class Product { H1, Elasticity } product = Product::H1;
  double smoothing = 0;    // length of the inner product that regularizes velocities; 0: chosen from the mesh size
  double min_feature = 0;  // members thinner than this are not wanted; 0: none
  double min_gap = 0;      // nor gaps; 0: the same
  double min_radius = 0;   // of arcs of the finished design; 0: any that meshes can tell
  int nucleate_every = 5;  // 0: never
  double nucleate_fraction = 0.02;
  std::vector<Loop> frozen;  // stays solid; may touch and leave the body
  std::optional<Mirror> mirror;
  std::optional<StartHoles> start;
  std::optional<Shape> start_design;  // a body inside the frame to begin with, instead of start
  double ersatz = 0;                  // weak phase instead of void: its stiffness relative to the body's; 0: none
};

inline constexpr std::array<std::string_view, 2> move_words{"shape-gradient", "fixed-point"};
inline constexpr std::array<std::string_view, 2> inner_product_words{"h1", "elasticity"};

/// What is minimized over, under which constraints, and how.
struct OptimizeRequest {
  OptimizeMethod method = OptimizeMethod::LevelSet;
  std::optional<double> volume_at_most;  // fraction of the area of the body without the design's holes
  double volume_penalty = 0;             // J + penalty * area
  int max_iterations = 100;              // of the level set; state evaluations of the others
  double tolerance = 1e-3;               // of J that may be left to gain; fixed point: relative change; NLopt: residual
  int starts = 0;                        // designs to begin with, the given one first; 0: what is usual for the method
  double min_distance = 0;               // NLopt methods: between holes, and from holes to cracks and the outline
  std::vector<Loop> keep_out;            // stay void: the frame is already without them
  std::vector<FunctionalBound> bounds;
  std::vector<LoadCase> load_cases;  // empty: the loads of the scene alone
  LevelSetRequest level_set;         // of the level set
  Design design;                     // of the others: what numbers draw
};

// What is reported.

/// A row of history.csv. No times: a resumed run writes the same file bit for bit.
struct Iteration {
  int number = 0;        // 0: the start
  double objective = 0;  // J, volume penalty left out
  double merit = 0;      // what is minimized: J + penalty * area
  double volume_fraction = 0;
  std::vector<double> bounds;  // values of the bounded functionals
  double violation = 0;        // largest relative violation of a constraint
  double step = 0;             // level set: largest move of the boundary; NLopt: largest relative change
  double optimality = 0;       // level set: angle (radians) or shape residual; NLopt: KKT residual; NaN unknown
  int holes = 0;
  Index triangles = 0;
  int state_solves = 0;            // so far, line searches included
  bool accepted = true;            // false: a step that was refused; the design stayed
  std::string note;                // why the objective rose, what was nucleated, dropped, ...; empty mostly
  Eigen::VectorXd variables = {};  // NLopt methods
};

/// How an optimization ended. Optimal: its conditions hold to the residuals printed, on a finer mesh, too. Within: they
/// do not, but what could still be gained is at most the tolerance. The last two are of inverse problems.
enum class Ending { Optimal, OptimalWithin, Stalled, BudgetUsed, Infeasible, Unexplained, Undetermined };
inline constexpr std::array<std::string_view, 7> ending_words{"optimal",
                                                              "optimal within",
                                                              "stalled",
                                                              "budget used",
                                                              "infeasible",
                                                              "the model does not explain the readings",
                                                              "not enough readings"};
constexpr std::string_view word(Ending ending) {
  return ending_words[static_cast<std::size_t>(ending)];
}

/// What was asked of a design, and what it has as it is drawn. `name`: "volume", "frozen NAME", "min_feature",
/// "min_gap", "symmetry", "keep_out NAME", or that of a bound. `asked`, `got`: shares of the area, lengths (of frozen
/// regions, keep-outs and symmetry 0, and what is missing), values of bounded functionals.
struct KeptConstraint {
  enum class Kind { Volume, Bound, Frozen, Void, Width, Mirror } kind = Kind::Volume;
  std::string name;
  double asked = 0, got = nan;
  bool kept = true;
  std::optional<Vec2> at = {};  // where it is kept worst
  std::string note = {};        // in words, where it is not kept
};

/// The design at the end, solved again on a mesh of half the size, with one degree more where the element has it.
struct FinerDesign {
  double size = 0;  // of the mesh, near which edges are
  Element element = bdms(1);
  bool curved = false;  // its edges follow the curves of the design
  double objective = nan, volume_fraction = nan;
  std::vector<double> bounds;  // values of the bounded functionals
  /// Of those of stresses and release rates, on that mesh: `upper`, where there is one, is what the bound is judged by
  /// if the interval is guaranteed, and the larger of it and the value otherwise. `note`: why there is none, or not
  /// guaranteed. Not a number, without a note: of other functionals.
  std::vector<Bounded> intervals;
  double violation = nan;  // largest relative violation of a constraint, so judged
  double residual = nan;   // of the shape, of a level set's curves
  std::string failure;     // why it could not be solved; empty mostly
};

/// Of a level set's design, per area: the least of (T - price of area) / price over the body away from singular points.
/// Where it is not negative no small hole pays.
struct HoleMargin {
  double least = nan;
  Vec2 at = Vec2::Zero();
  std::shared_ptr<const Mesh> mesh = {};  // of the design; none where nothing was looked at
  std::vector<double> margin = {};        // per triangle, not a number where no hole may be
  /// T at that place by holes really made there [theory: V.1]: the verdict on the first load case that does not hold.
  std::optional<Verdict> proof = {};
};

/// Of a level set's design, per area: the least of (price of area - worth) / price of small half discs of material on
/// its free boundary, away from singular points. Where it is not negative none of them pays.
struct BumpMargin {
  double least = nan;  // not looked at under body forces, and with functionals that have a density
  Vec2 at = Vec2::Zero();
};

/// The change that would gain most, of its kind.
struct BestChange {
  double gain = nan;  // share of |J + penalty * area|; 0: none pays, NaN: not known
  Vec2 at = Vec2::Zero();
  double radius = 0;
};

/// Bounds of what a level set's design could still gain [theory: K.8, L.14, L.21].
struct GainLeft {
  double shape = nan;  // by moving the curves, a share as well; NaN: no model of second order
  BestChange hole, bump;
  /// All of them; NaN where shape or holes are not known. Bumps are not looked at under body forces.
  double sum() const {
    return shape + hole.gain + (std::isfinite(bump.gain) ? bump.gain : 0);
  }
};

/// A hole that nucleation cut, as it was drawn, and what it does to J: as the loop foresaw, and when it alone is made
/// in the design before [theory: L.14]. Bounds are left out.
struct NucleatedHole {
  int iteration = 0;                     // of the row of the history
  Vec2 at = Vec2::Zero();                // centroid
  double radius = nan;                   // of a circle of its area; NaN: it is no hole of its own
  double T = nan, c2 = nan;              // c2: NaN where it is not known
  double predicted = nan, actual = nan;  // changes of J; NaN where they could not be told
  std::string note = {};                 // why not
};

/// An accepted iterate; model and state are those of the first load case.
struct Iterate {
  const Iteration& row;
  const Shape& shape;
  const Model& model;
  const State& state;
};
/// Called after every accepted iterate, and at the end once more with the best one: always with a design of numbers,
/// with a level set where that is not the last one. false: stop here.
using Observer = std::function<bool(const Iterate&)>;

/// One of several designs to begin with.
struct StartTried {
  Eigen::VectorXd from = {}, variables = {};  // NLopt methods: where it began, and what it had reached when it ended
  double merit = nan, violation = nan;        // then; NaN: it could not be evaluated
  bool in_full = false;                       // went on to the end; otherwise it was only ranked, on a coarse mesh
  int state_solves = 0;
  std::string failure = {};  // why it could not be evaluated; empty mostly
  int end = 0;               // number of the end that it came to, the best one 1; 0: none
};

struct OptimizeResult {
  OptimizeMethod method = OptimizeMethod::LevelSet;
  int iterations = 0, state_solves = 0;
  double objective = 0, volume_fraction = 0, optimality = 0;
  bool feasible = true;  // on the finer mesh, too
  Ending ending = Ending::Stalled;
  std::string stopped;  // the word of the ending, and why
  FinerDesign finer;
  std::vector<KeptConstraint> constraints;
  HoleMargin holes;  // level set
  BumpMargin bumps;  // level set
  GainLeft gain;     // level set
  std::vector<std::string> notes;
  std::vector<Iteration> history;
  Shape shape;                                // the last one
  Scene scene;                                // of it: laws and regions may be fewer or more than those of the case
  Eigen::VectorXd variables = {};             // NLopt methods
  std::vector<StartTried> starts;             // where there were several: ranked ones, then those that went on
  std::vector<NucleatedHole> nucleated = {};  // level set, in their order
};

/// "optimal", "optimal within 0.05 %", "stalled", ...
std::string verdict_of(const OptimizeResult& result);

/// The body without a region that stays void, of which it may have a part, all or nothing; new sides have the label
/// "keep_out:NAME". Exact to 1e-9 of the size. Throws Error(Geometry) where nothing is left, or more than one piece,
/// and where a crack of the body reaches into it.
Shape without(const Shape& body, const Loop& keep_out);

// The loops.

/// Where a loop keeps what it needs to go on. An empty path: nowhere. `fingerprint`: of the case, made by the caller; a
/// checkpoint of another one is refused with Error(Usage). `write` is given what writes a checkpoint, to be called
/// once, at any time and by any thread, one after the other; none: the loop writes before it goes on.
struct CheckpointPlace {
  std::filesystem::path path;
  std::string fingerprint;
  bool resume = false;  // false: what lies there is overwritten
  std::function<void(std::function<void()>)> write = {};
};

/// Minimizes J + penalty * area over the boundary: a level set on a mesh of the frame, its design meshed anew in every
/// iteration, moved by the shape gradient or the fixed point of the topological derivative; holes appear where the
/// topological derivative pays (request.level_set.nucleate_every). The area falls to the one wanted first, then J falls
/// until no step of 5% of the mesh size makes it fall further, or over 8 iterations by less than 0.2 % (the fixed
/// point: by less than the tolerance); request.max_iterations in all. What bears supports, loads and functionals stays
/// solid. `place`: after every iteration a checkpoint is written; resumed, the run goes on from there and ends with the
/// same bits. Every iterate is shown to `see`. The end is "optimal" where the shape residual (root mean square over
/// what can move of (rate of J - price)/price, without waves shorter than the mesh size) is at most 0.02 of curves on
/// their mesh and 0.05 on the finer one, or 0.05 of a carved design, no small hole or bump pays, and the constraints
/// hold on a mesh of half the size; "optimal within p %" where instead the bounds of what could still be gained sum to
/// at most request.tolerance of J. Throws Error(Usage) for a request or an element that does not fit, Error(Geometry)
/// or Error(Numerics) when the start cannot be meshed or solved.
OptimizeResult optimize_level_set(const Problem& p, const OptimizeRequest& r, const Observer& see,
                                  const CheckpointPlace& place);

/// Minimizes J + penalty * area over the variables of request.design, under its constraints and those that keep designs
/// meshable, by request.method through NLopt. In rounds, each on a fresh mesh that follows the design, until a round
/// lowers J by less than the tolerance; request.max_iterations evaluations in all. The derivative is checked once at
/// the start: a note, and an Error(Numerics) when it is off by more than 1%. `place`: after every evaluation a
/// checkpoint is written; resumed, the run repeats from what was evaluated and ends with the same bits. Iterates of the
/// history that were there already are not shown to `see` again. Accepted iterates, shown to `see`: those better than
/// all before in their round (less violation, or feasible and lower), the first of every round, and at the end the best
/// one once more. Throws Error(Usage) for a design or a method that does not fit, Error(Geometry) or Error(Numerics)
/// when the start cannot be meshed or solved.
OptimizeResult optimize_parameters(const Problem& problem, const OptimizeRequest& request, const Observer& see,
                                   const CheckpointPlace& place);

}  // namespace kerf
