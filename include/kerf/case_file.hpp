#pragma once
// A case file, read and checked. toml++ lives in reader.cpp and nowhere else.

#include "kerf/bounds.hpp"
#include "kerf/edge_cracks.hpp"
#include "kerf/growth.hpp"
#include "kerf/inverse.hpp"
#include "kerf/mesh_file.hpp"
#include "kerf/optimize.hpp"
#include "kerf/units.hpp"
#include "kerf/validate.hpp"

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerf {

struct Probe {
  std::string name;
  std::vector<Vec2> points;
  bool bounds = false;  // of the stresses, at so many points at most
  static constexpr std::size_t most_bounded = 200;
};

/// A quantity that an adapted mesh is to bound.
struct GoalRequest {
  std::string quantity;  // a word of goal_words
  Index crack = none;    // of K_I, K_II and G, at one of its ends
  bool at_start = false;
  Vec2 at = Vec2::Zero();  // of stresses and T
};
inline constexpr std::array<std::string_view, 9> goal_words{
    "K_I", "K_II", "G", "s_xx", "s_yy", "s_xy", "von_mises", "topological_derivative", "energy"};

struct AdaptRequest {
  double error = 1e-2;  // wanted, relative L2 stress error as estimated; of a goal the relative half width
  Index max_triangles = 200000;
  std::optional<GoalRequest> of = {};
};

struct MapJob {
  std::vector<Vec2> points;  // empty: everywhere in the body
};

/// Intervals that contain quantities of the exact solution.
struct BoundsRequest {
  bool tips = true;                  // K_I, K_II and G at every tip
  std::vector<Vec2> points;          // stresses and T there
  std::vector<OverDisc> discs;       // mean stresses and strains
  std::vector<AlongLine> lines;      // mean stresses
  std::vector<Index> displacements;  // labels: their means
  std::vector<Index> reactions;      // labels: the forces of their supports
  bool compliance = false;
};

struct OutputRequest {
  bool vtk = true, png = true, html = true;
  // What is found of the state beside the solution, and takes its time: the estimated error, the interval of the
  // energy, K, G and T at tips, the largest stress and displacement.
  bool estimate = true, energy_bounds = true, tips = true, peaks = true;
  std::optional<bool> margins = {};  // of the last two; absent: where that is quick
};

/// What solves: factors of the condensed matrix or of the saddle point that is not condensed; or processes that have a
/// part of the condensed matrix each.
enum class Backend { Cholmod, Umfpack, Petsc };

/// Auto: double, or single where double is more than the memory that there is or may be used.
enum class FactorPrecision { Auto, Double, Single };

// The words of case files, results and messages for values of enums, in the order of the values.
inline constexpr std::array<std::string_view, 3> contact_method_words{"dual-qp", "active-set", "uzawa"};
inline constexpr std::array<std::string_view, 3> backend_words{"cholmod", "umfpack", "petsc"};
inline constexpr std::array<std::string_view, 3> precision_words{"auto", "double", "single"};
inline constexpr std::array<std::string_view, 3> crack_law_words{"unilateral", "open", "bonded"};
constexpr std::string_view word(ContactMethod method) {
  return contact_method_words[static_cast<std::size_t>(method)];
}

constexpr std::string_view word(CrackLaw::Kind kind) {
  return crack_law_words[static_cast<std::size_t>(kind)];
}

struct Elastic {
  double young = 1, poisson = 0.3;  // E1 and nu12 of an orthotropic material
  std::optional<Orthotropy> orthotropy = {};
};

/// What a material bears, as far as the case says it.
struct Strength {
  std::string region = {};                  // its name; none: outside of all regions
  std::optional<double> yield = {};         // von Mises stress
  std::optional<double> toughness = {};     // K_Ic
  std::optional<double> release_rate = {};  // G_c, instead
};

struct Node;  // of a TOML document: not for users

/// An inverse problem ends with least squares of the readings.
struct FitRequest {
  double noise = 0;         // standard deviation of every component; 0: that of [synthetic], or estimated
  int defects_at_most = 0;  // count them, up to so many; 0: as many as are drawn
};

/// The loads at the end of a step of their history, or of a part of it.
struct LoadStep {
  std::string name;
  int part = 1, parts = 1;
  std::vector<std::pair<std::string, double>> values;  // of the names that steps change
  Scene scene;
};

/// A short piece of the boundary that a case asks for at a point, with a label of its own: where a force acts, or where
/// the body rests on something.
struct PointPatch {
  Index label = none;
  Index beside = none;     // the label of the side that it is a piece of
  Vec2 at = Vec2::Zero();  // its middle, or the corner that it begins at
  double width = 0;        // along the boundary, what is beyond a plane of symmetry included
  bool at_plane = false;   // a plane of symmetry cuts it: one half of it is there
  bool given = false;      // the width is that of the case
};

struct Case {
  std::string name;   // file name without extension
  std::string title;  // the name when the file gives none
  Units units;
  Shape shape;
  std::shared_ptr<const Mesh> mesh = {};      // of the shape, from a file: the state is solved on it as it is
  std::vector<std::string> file_notes = {};   // what was left out of that file
  std::vector<std::string> crack_names = {};  // of [[crack]], in the order of the case; the shape has its own
  Sizing sizing;
  std::optional<bool> curved = {};  // mesh.curved, if it is not "auto"
  std::string why_chords = {};      // the edges of curved sides are chords, though nothing asks for chords
  int divisions = 0;                // mesh.refine
  Scene scene;                      // one law per crack of the shape
  double young = 1, poisson = 0.3;  // E1 and nu12 of an orthotropic body
  std::optional<Orthotropy> orthotropy;
  bool plane_strain = true;
  std::optional<double> thickness = {};  // of a plate in plane stress
  std::vector<Elastic> regions;          // per region of the shape; as materials in the scene
  std::vector<Strength> strength = {};   // outside all regions first, then per region; empty: of none
  Element element = bdms(2);
  Element optimize_element = bdms(1);  // of the iterations of [optimize], which take many states
  ContactMethod contact = ContactMethod::DualQp;
  Backend backend = Backend::Cholmod;
  FactorPrecision precision = FactorPrecision::Auto;
  std::optional<AdaptRequest> adapt;
  Functional functional;
  MapRequest map_request;                // perturbation, radius and bounds of a map, asked for in the case or not
  std::vector<LoadStep> steps;           // the last one has the loads of the scene
  std::vector<Index> planes = {};        // labels of sides in planes of symmetry, with supports in the scene
  std::vector<Vec2> half_tips = {};      // of cracks in these planes
  std::vector<PointPatch> patches = {};  // in the order of [[load]], then [[boundary]]
  std::optional<MapJob> map;
  std::optional<ValidationRequest> validate;                  // the perturbation is that of the map
  std::optional<inspect::EdgeCrackRequest> edge_cracks = {};  // instead of `map`, and
  std::vector<double> drawn_lengths = {};                     // of `validate`
  std::optional<inspect::ToleranceRequest> tolerance = {};
  std::vector<Vec2> drawn_at = {};  // none: the worst places
  std::vector<Probe> probes;
  std::optional<BoundsRequest> bounds;
  std::optional<growth::GrowRequest> grow;
  OutputRequest output;
  std::optional<OptimizeRequest> optimize;
  std::optional<FitRequest> fit;
  Readings readings;                          // of a table of measured displacements
  std::optional<Synthetic> synthetic;         // the misfit of the functional then waits for its data
  std::shared_ptr<const Node> document = {};  // as read, with its overrides
  std::filesystem::path folder = {};          // where files lie that it names
  std::string fingerprint;                    // of all that an optimization depends on, but for how long it may go on
  std::map<std::string, std::string> places;  // where every key and table stands: "hole[0].circle" "a.toml:12:10"
  std::string petsc;                          // options of PETSc, as on a command line
};

/// "file:line:column" of a key, or of the nearest table around it that there is.
std::string place_of(const Case& c, std::string key);

/// Sets sizing.curved and why_chords for the shape, as `curved` asks, or wherever the job can; a mesh from a file gets
/// chords where it must.
void choose_edges(Case& c);

/// What [optimize] asks about: straight edges, its own element. `threads` of all that is solved.
Problem problem_of(const Case& c, int threads = 1);

/// The scene with the loads of the first load case, if there are load cases.
Scene loaded_scene(const Case& c);

/// Strict: an unknown, duplicated or ill-typed key, an unknown label, an unused definition is an Error(Usage) that
/// reads `file:line:column: what is wrong; what would be right`. An unreadable file is an Error(Files). `overrides` are
/// "key.path=value" in TOML syntax, applied in order before anything is checked.
Case read_case(const std::filesystem::path& path, std::span<const std::string> overrides = {});

}  // namespace kerf
