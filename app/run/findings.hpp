#pragma once
// What is found of a solved body, by the process that has all of it or by all that have a part: numbers that are the
// same on each of them. All call the same functions in the same order.

#include "app/run/map.hpp"
#include "app/run/peaks.hpp"
#include "kerf/case_file.hpp"
#include "solver/divided_body.hpp"
#include "solver/resultants.hpp"

namespace kerf {

/// A body and its state, as this process has them.
struct SolvedPart {
  const Model& model;
  const State& state;
  const Indicator& indicator;
  Communicator& comm;
  std::vector<std::array<bool, 2>> tips = {};      // per crack which of its ends are tips
  bool of_polygon = false;                         // is_of_polygon of the body
  const std::vector<std::vector<double>>* from{};  // of a part, MeshPart::from; none: the body
  // K, G and T by the profiles of the cracks, and the bounds of the energy.
  std::function<std::vector<TipIntensity>(const std::vector<std::vector<CrackPoint>>&)> intensities = {};
  std::function<EnergyBounds()> energy_bounds = {};
};
/// Of a body that this process has as a whole.
SolvedPart whole(const Case& c, const Model& model, const State& state, const Indicator& indicator = {});

struct Findings {
  StateResult state = {};  // its numbers, and notes on margins; others are made of what follows (tell_state)
  State solved = {};       // certificate and counts alone
  ContactMethod method = ContactMethod::ActiveSet;
  bool has_stress = false;
  std::optional<EnergyBounds> energy = {};
  std::vector<LabelResultant> reactions = {};
  std::vector<CrackResult> cracks = {};
  std::vector<std::vector<CrackPoint>> profiles = {};  // of those that are no half ones
  double mean_stress = 0;
  std::optional<Peak> strain = {};
  double beside_chords = 0;  // top_on_chords
  std::optional<SolverResult> solver = {};
  std::vector<std::string> notes = {};  // on the way it was solved
};

/// Energies, area and what the supports exert.
void find_numbers(const Case& c, const SolvedPart& solved, Findings& found);
/// These and cracks, as far as the case asks for them. `seconds`: of energy bounds, tips and the rest.
Findings find_state(const Case& c, const SolvedPart& solved, Seconds& seconds);
/// The larger of what the processes have.
std::optional<Peak> largest_of(Communicator& comm, const std::optional<Peak>& own);
/// The largest stress, displacement, strain and pressures, and reserves. `zones`: of the body.
void find_peaks(const Case& c, const SolvedPart& solved, const PlotData& data, const SingularZones& zones,
                Findings& found);
/// Cracks with their tips, and behind them half cracks of a body that this process has as a whole.
std::vector<CrackResult> find_cracks(const Case& c, const SolvedPart& solved, bool with_tips, Findings& found);

/// A map with its result.
Mapped find_map(const MapTask& task, Analysis& analysis, const PlotData& data, const SingularZones& zones,
                Communicator& comm);
/// Per probe the rows of its table; with the map of the task unless `analysis` is null.
std::vector<std::vector<std::vector<double>>> find_probes(const Case& c, const SolvedPart& solved, const MapTask& task,
                                                          const Analysis* analysis);

/// A solved body as the rest of a run takes it.
struct RunState {
  Adapted adapted;  // of several processes the body before its mesh was divided, as pictures show it, without a state
  PlotData data;
  Findings found;
  /// Of several processes: what they have found with the state, while they had it.
  struct Together {
    Analysis functional = {};              // its values
    Mapped map = {};                       // at corners and centroids of the mesh before it was divided
    std::vector<std::string> limits = {};  // limits_of_map
    std::vector<std::vector<std::vector<double>>> probes = {};
  };
  std::optional<Together> together = {};
};

}  // namespace kerf
