// One design solved: shape -> mesh -> states of all load cases -> J = sum of weight J_k, and of each bound the worst
// load case. Load cases differ in their loads alone and share the factor of the first. Terms and laws of cracks follow
// the parts that carving leaves of each crack: a crack cut in two counts twice, one cut away not at all. Analyses
// (adjoints) are made when asked for, per load case for the objective and for the worst one of a bound. A model that
// nobody needs lends its ordering and memory to the next mesh of the same topology.

#include "optimize/loop/evaluate.hpp"

#include "kerf/mesher.hpp"
#include "solver/moved.hpp"

#include <algorithm>
#include <utility>

namespace kerf {

// Loads of a case come on top of what the problem itself bears.
std::vector<Scene> scenes_of(const Problem& p, const OptimizeRequest& r) {
  if (r.load_cases.empty()) return {p.scene};
  std::vector<Scene> scenes;
  for (const LoadCase& load : r.load_cases) {
    Scene scene = p.scene;
    scene.tractions.insert(scene.tractions.end(), load.tractions.begin(), load.tractions.end());
    scene.body = sum(scene.body, load.body);
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

Functional on_parts(const Functional& j, const std::vector<Index>& crack_of) {
  Functional parts{.kind = j.kind, .terms = {}, .sum = j.sum};
  for (const Term& term : j.terms) {
    if (term.crack == none) {
      parts.terms.push_back(term);
      continue;
    }
    for (Index part = 0; part < static_cast<Index>(crack_of.size()); ++part)
      if (crack_of[static_cast<std::size_t>(part)] == term.crack) {
        parts.terms.push_back(term);
        parts.terms.back().crack = part;
      }
  }
  return parts;
}

Scene with_cracks(Scene scene, const std::vector<Index>& crack_of) {
  std::vector<CrackLaw> laws;
  for (const Index k : crack_of) laws.push_back(scene.laws.at(static_cast<std::size_t>(k)));
  scene.laws = std::move(laws);
  return scene;
}

// J is summed over load cases with their weights, and with it the terms of volume.
double price_of_volume(const Problem& p, const OptimizeRequest& r) {
  double price = 0, weights = r.load_cases.empty() ? 1 : 0;
  for (const Term& term : p.objective.terms)
    if (term.volume) price += term.factor;
  for (const LoadCase& load : r.load_cases) weights += load.weight;
  return weights * price;
}

Evaluated evaluate_design(const Problem& p, const OptimizeRequest& r, Shape shape, const std::vector<Index>& crack_of) {
  Mesh mesh = triangulate(shape, p.sizing);
  return evaluate_mesh(p, r, std::move(shape), std::move(mesh), crack_of);
}

Model model_to_reuse(std::shared_ptr<Evaluated>& design) {
  const std::shared_ptr<Evaluated> last = std::exchange(design, nullptr);
  return last.use_count() == 1 ? std::move(last->cases.front().model) : Model{};
}

Evaluated evaluate_mesh(const Problem& p, const OptimizeRequest& r, Shape shape, Mesh mesh,
                        const std::vector<Index>& crack_of, Model before, std::span<const Index> sequence) {
  Evaluated e{.shape = std::move(shape), .objective = on_parts(p.objective, crack_of)};
  for (const FunctionalBound& bound : r.bounds) e.bounded.push_back(on_parts(bound.functional, crack_of));
  e.bounds.assign(r.bounds.size(), -infinity);
  e.worst.assign(r.bounds.size(), 0);
  e.by_case.resize(r.bounds.size());
  const std::vector<Scene> scenes = scenes_of(p, r);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    Scene scene = with_cracks(scenes[i], crack_of);
    // Load cases differ in their loads alone: one factor for all.
    Model model =
        i == 0 ? prepare_moved(std::move(mesh), p.element, std::move(scene), p.threads, std::move(before), sequence)
               : with_loads(e.cases.front().model, std::move(scene));
    State state = solve(model, p.contact);
    if (!certified(state))
      throw Error(Fault::Numerics, "the state of the design could not be solved: its residual stays large");
    e.cases.push_back({r.load_cases.empty() ? 1 : r.load_cases[i].weight, std::move(model), std::move(state)});
  }
  e.area = area(e.cases.front().model);
  for (std::size_t i = 0; i < e.cases.size(); ++i) {
    const SolvedCase& c = e.cases[i];
    e.J += c.weight * analyze(e.objective, c.model, c.state, true).value;
    for (std::size_t k = 0; k < e.bounded.size(); ++k) {
      const double value = analyze(e.bounded[k], c.model, c.state, true).value;
      e.by_case[k].push_back(value);
      // A bound holds for the worst of the load cases.
      if (value > e.bounds[k]) {
        e.bounds[k] = value;
        e.worst[k] = static_cast<Index>(i);
      }
    }
  }
  return e;
}

std::vector<WeightedAnalysis> analyze_objective(const Evaluated& e) {
  std::vector<WeightedAnalysis> all;
  for (const SolvedCase& c : e.cases) all.push_back({&e.objective, analyze(e.objective, c.model, c.state), c.weight});
  return all;
}

std::vector<WeightedAnalysis> analyze_bound(const Evaluated& e, std::size_t bound, Index load_case) {
  const SolvedCase& c = e.cases[static_cast<std::size_t>(load_case == none ? e.worst[bound] : load_case)];
  std::vector<WeightedAnalysis> all;
  all.push_back({&e.bounded[bound], analyze(e.bounded[bound], c.model, c.state), 1});
  return all;
}

}  // namespace kerf
