#pragma once
// The bodies whose shape `kerf bench optimize` improves: the case files of bench/scenarios, with default settings.

#include "kerf/optimize.hpp"

#include <span>

namespace kerf {

struct OptimizeProblem {
  std::string name, title;
  Problem problem;  // its scene: without the loads of load cases
  OptimizeRequest request;
};

/// Names of the scenarios, by name; the published comparison is none of them.
const std::vector<std::string>& scenario_names();

/// "published": compliance + 100 * area of a cantilever with a weak phase of 1e-3, as published for four algorithms
/// [Blauth, Sturm 2023].
inline constexpr const char* published_name = "published";
struct Published {
  double least_value, most_value;  // J
  int fewest_solves, most_solves;  // states
};
inline constexpr Published published{153.47, 154.63, 31, 116};

/// A scenario, or the published comparison, as `kerf optimize` reads it. The case file is left in `folder`, which must
/// be there. `overrides` as of read_case. Throws std::invalid_argument for an unknown name, and what read_case throws.
OptimizeProblem read_problem(const std::string& name, const std::filesystem::path& folder,
                             std::span<const std::string> overrides = {});

/// What the judge measures is what is minimized: a compliance or an area, without cracks.
bool is_judged(const OptimizeProblem& p);
/// A density can be compared: a compliance at a volume, loads on the boundary alone.
bool has_density(const OptimizeProblem& p);
inline bool is_volume(const OptimizeProblem& p) {
  return p.problem.objective.kind == "volume";
}

/// Scenes of the load cases with their weights; one without load cases.
struct WeightedScene {
  double weight = 1;
  Scene scene;
};
std::vector<WeightedScene> loaded_scenes(const OptimizeProblem& p);
/// Labels with a traction in one of them.
std::vector<Index> loaded_labels(const OptimizeProblem& p);

/// For bench/peers/simp_scenario.py, at that volume fraction: JSON. Throws Error(Usage) for tractions that are not
/// constant.
std::string density_scenario(const OptimizeProblem& p, double volume);

/// "full": no holes; "few holes", "holes": regular patterns; "random 1", "random 2": seeded places.
const std::vector<std::string>& optimize_starts();
/// The request from that start. Throws std::invalid_argument for an unknown one.
OptimizeRequest request_from(const OptimizeProblem& p, const std::string& start);

}  // namespace kerf
