#pragma once
// One design solved: shape -> mesh -> states -> J and its bounds.

#include "geometry/carve.hpp"
#include "kerf/analysis.hpp"
#include "kerf/optimize.hpp"
#include "solver/system.hpp"

namespace kerf {

struct SolvedCase {
  double weight = 1;
  Model model;
  State state;
};

/// The problem on one design. What counts cracks (terms, laws) is in the numbers of the design's shape.
struct Evaluated {
  Shape shape;
  Functional objective;
  std::vector<Functional> bounded;
  std::vector<SolvedCase> cases;             // per load case; one without load cases
  double J = 0;                              // sum of weight * J
  std::vector<double> bounds;                // the worst of the load cases
  std::vector<Index> worst;                  // per bound, that case
  std::vector<std::vector<double>> by_case;  // per bound and load case
  double area = 0;
};

/// Scenes of the load cases: that of the problem, its tractions and body force with those of the case added.
std::vector<Scene> scenes_of(const Problem& p, const OptimizeRequest& r);

/// What the terms of J that count volume cost per area, in all load cases.
double price_of_volume(const Problem& p, const OptimizeRequest& r);

/// The functional when the cracks of the body are `crack_of` the cracks it was written for: terms on a crack become a
/// sum over its parts, and vanish with it.
Functional on_parts(const Functional& j, const std::vector<Index>& crack_of);

/// The scene with the laws of the cracks that there are.
Scene with_cracks(Scene scene, const std::vector<Index>& crack_of);

/// Meshes and solves. Throws Error(Geometry | Numerics); a state that is not certified is Error(Numerics).
Evaluated evaluate_design(const Problem& p, const OptimizeRequest& r, Shape shape, const std::vector<Index>& crack_of);

/// The same on a mesh that is there. `before`: a model that is not needed any more; of the same mesh with its points
/// elsewhere it saves ordering and analysis; `sequence` saves the first (solver/moved.hpp).
Evaluated evaluate_mesh(const Problem& p, const OptimizeRequest& r, Shape shape, Mesh mesh,
                        const std::vector<Index>& crack_of, Model before = {}, std::span<const Index> sequence = {});
/// That of a design which nobody else has, or nothing.
Model model_to_reuse(std::shared_ptr<Evaluated>& design);

/// Per load case the analysis of a functional, and its share in a sum: weights of the cases, or 1 for the worst.
struct WeightedAnalysis {
  const Functional* functional;
  Analysis analysis;
  double weight = 1;
};
std::vector<WeightedAnalysis> analyze_objective(const Evaluated& e);
/// Of the worst load case, or of the one given.
std::vector<WeightedAnalysis> analyze_bound(const Evaluated& e, std::size_t bound, Index load_case = none);

}  // namespace kerf
