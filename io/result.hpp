#pragma once
// Every number a run produced, and the files that carry them. A section is present exactly when its job ran.

#include "base/whole_file.hpp"
#include "inspect/interior.hpp"
#include "kerf/bounds.hpp"
#include "kerf/edge_cracks.hpp"
#include "kerf/growth.hpp"
#include "kerf/inverse.hpp"
#include "kerf/optimize.hpp"
#include "kerf/units.hpp"
#include "kerf/validate.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerf {

struct Seconds {
  double mesh = 0, assemble = 0, factor = 0, solve = 0, contact = 0, estimate = 0, energy_bounds = 0, tips = 0,
         recover = 0, margins = 0, map = 0, bounds = 0, validate = 0, grow = 0, optimize = 0, output = 0, total = 0;
};
struct TimedPhase {
  const char* name;
  double Seconds::*of;
  bool always;  // in result.json; else where it took any time
};
/// All but the total, in the order of tables.
inline constexpr std::array<TimedPhase, 16> timed_phases{{{"mesh", &Seconds::mesh, true},
                                                          {"assemble", &Seconds::assemble, true},
                                                          {"factor", &Seconds::factor, true},
                                                          {"solve", &Seconds::solve, true},
                                                          {"contact", &Seconds::contact, true},
                                                          {"estimate", &Seconds::estimate, false},
                                                          {"energy_bounds", &Seconds::energy_bounds, false},
                                                          {"tips", &Seconds::tips, false},
                                                          {"recover", &Seconds::recover, false},
                                                          {"margins", &Seconds::margins, false},
                                                          {"bounds", &Seconds::bounds, false},
                                                          {"grow", &Seconds::grow, false},
                                                          {"map", &Seconds::map, true},
                                                          {"validate", &Seconds::validate, true},
                                                          {"optimize", &Seconds::optimize, true},
                                                          {"output", &Seconds::output, true}}};

struct PlacedValue {
  Vec2 at = Vec2::Zero();
  double value = 0;
  std::optional<double> margin = {};  // the truth is expected within value +- margin; absent: not computed
};

/// A largest value. `singular`: it lies so near a tip, a kink, a corner or the end of a support that a finer mesh would
/// make it larger; `regular` is then the largest one elsewhere, if there is any.
struct Peak {
  PlacedValue largest;
  bool singular = false;
  std::optional<PlacedValue> regular = {};
};

/// Along a crack, in path order: n points to the left of the path, jump = left face minus right face.
struct CrackRow {
  double s;  // arc length from the start of the path
  Vec2 at;
  double jump_n, jump_t, sigma_n, sigma_t;
  bool closed;
  double fluid_pressure = 0;  // a part of -sigma_n
  double gap = 0;             // before loading: the faces are jump_n + gap apart
};

struct TipResult {
  Vec2 at = Vec2::Zero();
  std::optional<double> K_I, K_II, G, T;  // absent: not computed; written as null
  struct Spread {                         // relative, between domains of different size; beyond 0.01: do not trust
    double K_I, K_II, T;
  };
  std::optional<Spread> spread = {};
  struct Margin {  // the truth is expected within each of them
    double K_I, K_II, G, T;
  };
  std::optional<Margin> margin = {};
  std::string note = {};  // why there is no K, where that is known
};

struct CrackResult {
  std::string name;
  bool half = false;  // of a crack in a plane of symmetry: the side with this label and its mirror image
  double length = 0, max_opening = 0, max_pressure = 0;            // of contact
  double open_length = 0, closed_length = 0, biactive_length = 0;  // in the sums of "contact"
  double penetration = 0;                                          // of faces without a contact condition
  struct Transition {
    Vec2 at;
    std::string from, to;  // "open" | "closed", or "stick" | "slip"
  };
  std::vector<Transition> transitions;
  std::vector<TipResult> tips;
  std::optional<Peak> pressure = {};          // absent without contact pressure
  std::optional<double> fluid_pressure = {};  // the largest by amount, of a crack that has one
  bool has_gap = false;                       // before loading; max_opening is the largest distance of the faces then
  std::vector<CrackRow> rows;                 // to crack_<name>.csv and .vtp, not to result.json
};

/// A force and its moment about the origin, of what acts on a label (none named: the body force, a balance).
struct ResultantResult {
  std::string on;
  Vec2 force = Vec2::Zero();
  double moment = 0;
};

/// A short edge drawn for a force or a support at a point.
struct PatchResult {
  std::string on;
  Vec2 at = Vec2::Zero();
  double width = 0;
  Vec2 force = Vec2::Zero();                  // of loads and supports
  double mean_stress = 0;                     // its amount over the length of the edge
  std::optional<double> displacement_change;  // along the force, had it half the width; of isotropic bodies
};

/// Of backend = "petsc", and of a factor in single precision: one part.
struct SolverResult {
  int parts = 0, solves = 0, iterations = 0;  // the most iterations of a solve
  double condition = 0;                       // the largest estimate
  int interface_unknowns = 0, primal_unknowns = 0;
  double sent = 0;                     // bytes per iteration of the process that sends most
  double first_mb = 0, others_mb = 0;  // peaks of memory: of the first process, the largest of the others
};

/// How far the loads are from what the material bears: factor = limit/value, of release rates its root, so that the
/// factor is that of the loads where the response is proportional to them.
struct ReserveResult {
  enum class Of { Yield, Toughness, ReleaseRate } of = Of::Yield;
  double value = 0, limit = 0, factor = 0;
  Vec2 at = Vec2::Zero();
  std::string region = {};  // none: outside all regions
  std::string crack = {};   // of tips
};

inline constexpr std::array<std::string_view, 3> reserve_words{"yield", "toughness", "release_rate"};
/// What is compared, as "von Mises stress"; its dimension; what it is a reserve against: "yield" or "fracture".
struct ReserveWords {
  std::string_view quantity, against;
  Dimension dimension;
};
ReserveWords words_of(ReserveResult::Of of);

struct StateResult {
  std::string element;
  int degree = 1;
  Index unknowns = 0, condensed_unknowns = 0;
  double residual = 0, work_error = 0, energy = 0, compliance = 0, area = 0;
  std::optional<double> estimated_error;               // absent: null
  std::optional<std::array<double, 2>> energy_bounds;  // absent: null
  bool of_polygon = false;                             // the bounds: chords stand for curved sides
  std::vector<std::string> notes;                      // what the user should know ("rigid motion fixed ...")
  std::optional<Peak> von_mises = {}, displacement = {};
  std::vector<ResultantResult> loads, reactions;  // per label
  std::optional<ResultantResult> body, balance;   // of the body force; the sum of all
  std::vector<PatchResult> patches = {};
  std::optional<double> thickness;  // all that is per thickness, times it, is that of the plate
  std::string load_case = {};       // whose state it is, where the case has several
  std::vector<ReserveResult> reserves = {};
};

/// What a load case does to the body.
struct LoadCaseResult {
  std::string name;
  double weight = 1, energy = 0, compliance = 0;
  std::optional<Peak> von_mises = {}, displacement = {};
  std::vector<ResultantResult> reactions = {};
  std::vector<ReserveResult> reserves = {};
};

struct AdaptResult {
  std::vector<std::pair<Index, double>> rounds;  // triangles, estimated error or half width
  std::string stopped;                           // why
  std::string of = {};                           // the quantity that is bounded, if one is
};

struct ContactResultSummary {
  std::string method;
  int iterations = 0, linear_solves = 0;
  double kkt = 0, open_length = 0, closed_length = 0, biactive_length = 0;
};

/// The end of a step of the history of the loads, or of a part of it.
struct StepResult {
  std::string name;
  int part = 1, parts = 1;
  std::vector<std::pair<std::string, double>> values;  // of [define], that steps change
  double energy = 0, strain_energy = 0;
  double work = 0, dissipation = 0;  // since the beginning: of loads and supports, of friction
  double imbalance = 0;              // work less strain energy and dissipation; NaN where it is not known
  double open_length = 0, closed_length = 0, stick_length = 0, slip_length = 0;
  double kkt = 0;
  struct Tip {
    std::string crack;
    Vec2 at = Vec2::Zero();
    std::optional<double> K_I, K_II;
  };
  std::vector<Tip> tips;
};

struct FunctionalResult {
  std::string kind;
  double value = 0;
  struct TermResult {
    std::string kind;
    double factor = 1, value = 0;  // the factor is left out of the value
  };
  std::vector<TermResult> terms = {};  // of a sum
};

struct MapResult {
  std::string perturbation;
  PlacedValue min, max;          // where nothing is masked, if that is anywhere
  double excluded_radius = 0;    // min and max leave out this neighborhood of crack tips and reentrant corners
  std::vector<MapPoint> points;  // the asked points; empty when the map was asked everywhere
  double radius = 0;             // that the mask is for
  double masked_share = 0;       // of the area
  double biactive_length = 0;
  bool oriented = false;  // the perturbation has an angle
  bool second = false;    // masked where the second term says so
};

struct ValidationResult {
  std::string perturbation;
  std::vector<Validation> points;
};

/// Intervals that contain the quantity of the exact solution, guaranteed or said not to be.
struct BoundedTip {
  std::string crack;
  bool at_start = false;
  Vec2 at = Vec2::Zero();
  Bounded K_I, K_II, G;
};
struct BoundedPoint {
  Vec2 at = Vec2::Zero();
  Bounded s_xx, s_yy, s_xy, von_mises, derivative;
};
/// Means, and what works on the boundary.
struct BoundedMean {
  enum class Of { Disc, Line, Displacement, Reaction, Loads } of = Of::Disc;
  std::string on = {};                          // a label
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();  // of a disc its center
  double radius = 0;
  std::vector<Bounded> quantities = {};  // as quantities_of(of)
};
struct NamedQuantity {
  std::string_view name;
  Dimension dimension;
};
std::span<const NamedQuantity> quantities_of(BoundedMean::Of of);
/// What lists of them are called in result.json; those of the loads are not listed.
inline constexpr std::array bounded_lists{
    std::pair(BoundedMean::Of::Disc, "discs"), std::pair(BoundedMean::Of::Line, "lines"),
    std::pair(BoundedMean::Of::Displacement, "displacements"), std::pair(BoundedMean::Of::Reaction, "reactions")};

struct BoundsResult {
  std::vector<BoundedTip> tips;
  std::vector<BoundedPoint> points;
  std::vector<BoundedMean> means = {};
};

/// What the numbers of an optimization are called, and their limits.
struct OptimizeNames {
  std::vector<std::string> bounds;
  std::vector<double> at_most;  // of the bounds
  std::optional<double> volume_at_most;
  std::vector<std::string> variables;
};

/// Of cracks that grew, beside the state of the body before.
struct GrowthResult {
  std::string law, criterion, ended;
  std::vector<std::string> notes = {};
  int solves = 0;
  double step = 0, path_error = nan, cycles_error = nan, energy_balance = nan;  // growth::Grown
  std::vector<growth::GrowthStep> steps = {};
  std::optional<growth::PathBounds> bounds = {};
  std::optional<int> unstable_from = {}, snaps_back_from = {};  // growth::Grown
};

/// Edge cracks, as far as result.json has them: edge_cracks.csv has all places.
struct EdgeCrackResult {
  double length = 0;
  std::optional<double> angle = {};  // radians; absent: the worst one of each place
  double friction = 0;
  bool pressurized = false;
  int places = 0;
  double masked_share = 0;  // of the length of the boundary
  std::array<double, inspect::reasons_to_mask.size()> masked_by = {};
  struct Row {
    inspect::EdgeCrack crack;
    inspect::Tolerance tolerance = {};
  };
  std::vector<Row> worst;                           // or the places that were asked for, in their order
  std::vector<inspect::InteriorCrack> inside = {};  // the worst ones
  bool asked = false;
  std::string law = {};                  // of [inspect]; empty: none
  double factor = 1;                     // of [inspect]
  std::optional<PlacedValue> safe = {};  // the shortest critical length
  double open_share = 0;                 // inspect::EdgeCrackMap
  std::vector<inspect::DrawnPlace> drawn = {};
};

struct Result {
  std::string version, case_name, title, status = "ok";
  Units units;
  std::optional<Dimension> functional_dimension;  // of the functional, the map and the objective
  std::optional<std::string> reason;              // when status is not ok
  Index triangles = 0, vertices = 0;
  Quality mesh;
  std::optional<AdaptResult> adapt;  // under "mesh"
  std::optional<StateResult> state;
  std::vector<LoadCaseResult> load_cases;  // by name; that of the state is one of them
  std::optional<ContactResultSummary> contact;
  std::vector<CrackResult> cracks;
  std::vector<StepResult> steps;
  std::optional<BoundsResult> bounds;
  std::optional<GrowthResult> growth = {};
  std::optional<FunctionalResult> functional;
  std::optional<MapResult> map;
  std::optional<EdgeCrackResult> edge_cracks = {};
  std::optional<ValidationResult> validate;
  std::optional<OptimizeResult> optimize;  // mesh, state, ... are then those of its design
  OptimizeNames optimize_names;
  std::optional<LeastSquares> fit;     // of readings, at the end of an inverse problem
  std::optional<Count> counted;        // where defects were counted
  std::vector<Identified> identified;  // what was found beside what is true, with synthetic data
  Seconds seconds;
  double peak_memory_mb = 0;
  std::optional<SolverResult> solver = {};  // of the state, under "state"
};

/// result.json, schema 1 of the interface: the shortest digits that are read back as the same number, written to a
/// temporary file and renamed.
void write_json(const std::filesystem::path& path, const Result& result, Flush flush = Flush::Buffers);

/// Comma-separated table, digits as there; a value that is not finite is an empty cell.
void write_csv(const std::filesystem::path& path, const std::vector<std::string>& columns,
               const std::vector<std::vector<double>>& rows);

/// crack_<name>.csv: s,x,y,jump_n,jump_t,sigma_n,sigma_t,status; status is the word open or closed. Of a crack
/// under the pressure of a fluid also fluid_pressure, of one with a gap also gap.
void write_crack_csv(const std::filesystem::path& path, const CrackResult& crack);

/// bounds.csv: quantity,crack,tip,x,y,value,lower,upper,guaranteed,note,on,radius,to_x,to_y; a row per quantity, an
/// empty cell is not known or not of that quantity. x, y: of a disc its center, of a line where it begins.
void write_bounds_csv(const std::filesystem::path& path, const BoundsResult& bounds);

/// Where each step stands in the history: 1.5 is half of the second.
std::vector<double> places_in_history(const std::vector<StepResult>& steps);
/// steps.csv: step (1.5: half of the second), the names that steps change, energies, lengths, and K of every tip.
void write_steps_csv(const std::filesystem::path& path, const std::vector<StepResult>& steps);

/// growth.csv: a row per tip and step: step, cycles or load, the tip (crack:end), its place, K of both loads, dK, rate,
/// and by how much and which way it grows.
void write_growth_csv(const std::filesystem::path& path, const GrowthResult& growth);

/// Names of all tips, "c:end".
std::vector<std::string> tips_of(const GrowthResult& growth);
/// beta_CRACK_TIP.csv, what programs of lives read: per step the length a of a tip (half of the crack where both ends
/// grow), beta = K_max/(stress sqrt(pi a)), and K_max.
void write_beta_csv(const std::filesystem::path& path, const GrowthResult& growth, const std::string& tip,
                    double stress);
/// edge_cracks.csv: a row per place of the boundary, with its tolerance where that was asked for.
void write_edge_cracks_csv(const std::filesystem::path& path, const inspect::EdgeCrackMap& map);
/// drawn_edge_cracks.csv: a row per place and length that was drawn.
void write_drawn_edge_cracks_csv(const std::filesystem::path& path, const std::vector<inspect::DrawnPlace>& drawn);

/// The summary for a terminal: mesh, state, contact, map, validation, optimization, times; no colors, at most 100
/// columns.
std::string summary(const Result& result);

}  // namespace kerf
