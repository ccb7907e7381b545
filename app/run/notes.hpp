#pragma once
// What is said of a state beside its numbers. Each note stands here once and is made for a run of one process and for
// one of several.

#include "app/run/collect.hpp"
#include "kerf/case_file.hpp"
#include "solver/data.hpp"

#include <functional>

namespace kerf {

struct Findings;  // app/run/findings.hpp

/// Why no guarantee stands on the data of the body: they are sampled at points; empty: it does.
std::string sampled_note(const Model& model);
/// Data that the rules of the solver do not resolve: what, where, in words.
std::vector<std::string> notes_on_data(const Mesh& mesh, const Scene& scene, const SceneData& data, const Shape& shape);
/// That nothing acts on the body, where that is certain: what it would need. Empty otherwise.
std::string note_on_loads(const Scene& scene, const Shape& shape);
/// That the mesh is asked for as coarse as the body: with what size it would be resolved. Empty otherwise.
std::string note_on_size(const Case& c, std::size_t triangles);
/// How many of the points lie outside the body, and where the first of them is. Empty where none does.
std::string note_on_points(const std::string& whose, const Mesh& mesh, const Locator& locator,
                           const std::vector<Vec2>& points);
/// What files that the case names leave to be desired, a mesh of them or the one that is to be made.
std::vector<std::string> notes_on_files(const Case& c);

/// Whether chords stand for curved sides, so that what is bounded is of the polygon.
bool is_of_polygon(const Shape& shape, const Mesh& mesh);

/// Of data, faces, drawing, factors, units, loads, mesh and contact, in this order, behind what `r.state` has. Takes
/// `r.cracks`, `r.steps` and `r.triangles`. `body`: on several processes that before the mesh is divided; `in_single`:
/// factors, by a forecast.
void add_notes(const Case& c, const Model& body, const Findings& found, bool in_single, Result& r);
/// Where the largest stress lies on chords that stand for a curve. `beside`: the largest stress in the middles of the
/// edges next to it.
void add_notes_on_chords(const Case& c, const Mesh& mesh, double beside, Result& r);
/// Of points outside the body: those of probes, and of the map if there is one.
std::vector<std::string> notes_on_points(const Case& c, const Mesh& mesh, const Locator& locator, bool with_map);

}  // namespace kerf
