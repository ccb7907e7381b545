#pragma once
// The state of a body: solved, described, written.

#include "app/run/collect.hpp"
#include "app/run/journal.hpp"
#include "kerf/case_file.hpp"
#include "kerf/folded.hpp"

namespace kerf {

struct Findings;        // app/run/findings.hpp
struct LabelResultant;  // solver/resultants.hpp

/// What is solved for: the body as drawn and meshed, what acts on it, with which element.
struct Body {
  const Shape& shape;
  const Sizing& sizing;
  const Scene& scene;
  const Element& element;
};

/// Throws Error(Numerics) where squares of stresses leave the range of numbers, which these themselves do not.
void require_energy(double energy, bool has_stress);
/// Whether a stress in it is not 0.
bool has_stress(const Model& model, const State& state);

/// With chords for curved sides after all where an edge that follows a curve folds a triangle, unless mesh.curved =
/// true.
void draw_chords(Case& c, const FoldedTriangle& why);
template <typename Solve>
auto as_it_can(Case& c, const Solve& solve) {
  try {
    return solve();
  } catch (const FoldedTriangle& e) {
    draw_chords(c, e);
    return solve();
  }
}
/// Graded at the ends of contact; `how.error` and what belongs to it are not asked.
Adapted solve_once(const Body& body, const Adaptation& how, Journal& journal);
Adapted solve_refined(const Body& body, Adaptation how, Journal& journal);

AdaptResult adapt_result(const std::vector<Round>& rounds, const std::string& stopped);

/// Sections state, cracks and contact of what was found, with the notes on them. `body`: on several processes that
/// before the mesh is divided. Throws as require_energy does.
void tell_state(const Case& c, const Model& body, Findings& found, const Journal& journal, Result& r);

/// Loads and reactions by label, and what they sum to.
void add_resultants(const Model& model, const std::vector<LabelResultant>& reactions, const Shape& shape,
                    StateResult& out);

/// The files and pictures of a state.
void write_state(const Adapted& adapted, const PlotData& data, const std::vector<CrackResult>& cracks,
                 Journal& journal);

/// Why a state that is not certified is none.
std::string failure(const Model& model, const State& state);

}  // namespace kerf
