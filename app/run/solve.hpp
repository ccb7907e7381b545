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
/// Whether chords stand for curved sides, so that what is bounded is of the polygon.
bool is_of_polygon(const Shape& shape, const Mesh& mesh);
/// That chords are drawn where nothing asks for them, why, and what that may cost; empty: they are not.
std::string note_on_drawing(const Case& c, const Model& model);

/// That nothing acts on the body, where that is certain: what it would need. Empty otherwise.
std::string note_on_loads(const Scene& scene, const Shape& shape);
/// That the mesh is asked for as coarse as the body: with what size it would be resolved. Empty otherwise.
std::string note_on_size(const Case& c, std::size_t triangles);
/// How many of the points lie outside the body, and where the first of them is. Empty where none does.
std::string note_on_points(const std::string& whose, const Mesh& mesh, const Locator& locator,
                           const std::vector<Vec2>& points);

/// What files that the case names leave to be desired, a mesh of them or the one that is to be made.
std::vector<std::string> notes_on_files(const Case& c);

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
