#pragma once
// The state of a body: solved, described, written.

#include "app/run/collect.hpp"
#include "app/run/journal.hpp"
#include "kerf/case_file.hpp"

namespace kerf {

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

/// Chords for curved sides after all.
void draw_chords(Case& c, const std::string& why);
/// Graded at the ends of contact; `how.error` and what belongs to it are not asked.
Adapted solve_once(const Body& body, const Adaptation& how, Journal& journal);
Adapted solve_refined(const Body& body, Adaptation how, Journal& journal);

AdaptResult adapt_result(const Adapted& adapted);

/// What a result says about a state. `contact`: with cracks that may close.
struct StateSection {
  StateResult state;
  std::vector<CrackResult> cracks;
  std::optional<ContactResultSummary> contact;
};
/// As much of it as the case asks for.
StateSection describe_state(const Adapted& adapted, const Case& c, Journal& journal);

/// Loads and reactions by label, and what they sum to.
void add_resultants(const Model& model, const std::vector<LabelResultant>& reactions, const Shape& shape,
                    StateResult& out);

/// The files and pictures of a state.
void write_state(const Adapted& adapted, const PlotData& data, const std::vector<CrackResult>& cracks,
                 Journal& journal);

/// Why a state that is not certified is none.
std::string failure(const Model& model, const State& state);

}  // namespace kerf
