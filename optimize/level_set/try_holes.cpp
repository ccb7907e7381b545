// What nucleated holes do to J, each made alone in the design before by condensation onto a ball, against what T and c2
// promise [theory: L.14, V.2].

#include "optimize/level_set/try_holes.hpp"

#include "topo/changes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// Of the load cases with their weights; a row not a number: no room for a ball.
Eigen::VectorXd weighted(const Evaluated& e, const Eigen::MatrixXd& difference) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(difference.rows());
  for (std::size_t k = 0; k < e.cases.size(); ++k)
    sum += e.cases[k].weight * difference.col(static_cast<Eigen::Index>(k));
  return sum;
}

/// One more solve of each load case, of a mesh with a ball around every hole. Returns how many times that was.
int make(const HolesTried& in, std::span<NucleatedHole*> holes) {
  const Evaluated& e = in.design;
  std::vector<Scene> scenes;
  for (const SolvedCase& c : e.cases) scenes.push_back(c.model.scene);
  std::vector<SmallChange> changes;
  for (const NucleatedHole* h : holes) changes.push_back({h->at, h->radius});
  const Problem p = fitted(in.g, in.coarse);
  try {
    const ChangesMade made = changes_at({{e.shape, p.sizing}, p.element, scenes, e.objective, p.threads}, {}, changes);
    const Eigen::VectorXd actual = weighted(e, made.difference);
    for (std::size_t i = 0; i < holes.size(); ++i) {
      holes[i]->actual = actual[static_cast<Eigen::Index>(i)];
      if (std::isnan(holes[i]->actual)) holes[i]->note = "the design before has no room for it";
    }
    return made.meshes;
  } catch (const Error& error) {
    for (NucleatedHole* h : holes) h->note = fmt::format("it could not be made alone: {}", error.what());
    return 1;
  }
}

}  // namespace

// Holes that grew into others have no radius and are not made.
int try_holes(const HolesTried& in, HoleExpansion& expansion, std::vector<NucleatedHole>& holes) {
  std::vector<NucleatedHole*> own;
  for (NucleatedHole& h : holes) {
    if (std::isnan(h.radius)) continue;
    const HoleTerms terms = expansion.objective(h.at);
    h.T = terms.T;
    h.c2 = terms.c2;
    h.note = terms.note;
    h.predicted = terms.change(h.radius);
    own.push_back(&h);
  }
  return own.empty() ? 0 : make(in, own);
}

// Sums are over holes that could be made alone, predicted and actual.
std::string in_words(std::span<const NucleatedHole> holes) {
  const auto count = [](std::size_t n) { return fmt::format("{} hole{}", n, n == 1 ? "" : "s"); };
  double predicted = 0, actual = 0;
  std::size_t own = 0, made = 0;
  for (const NucleatedHole& h : holes) {
    if (std::isnan(h.radius)) continue;
    ++own;
    if (!std::isfinite(h.actual)) continue;
    ++made;
    predicted += h.predicted;
    actual += h.actual;
  }
  std::string words = count(holes.size()) + " nucleated";
  if (own < holes.size()) words += fmt::format(", {} drawn", own);
  if (made == 0) return words;
  if (made < own) words += fmt::format("; {} made alone", made);
  return words + fmt::format(": J by {:.4g}, predicted {:.4g}", actual, predicted);
}

}  // namespace kerf
