// What is said of a state beside its numbers: data that the rules do not resolve, faces that penetrate, chords in the
// place of curves, a mesh as coarse as the body, loads that are none, points outside. A run of one process and one of
// several say the same, so each note is made here, of what either knows.

#include "app/run/notes.hpp"

#include "app/run/findings.hpp"
#include "geometry/curved.hpp"
#include "geometry/plane.hpp"
#include "io/document.hpp"
#include "kerf/mesher.hpp"
#include "optimize/refuse.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace kerf {

namespace {

/// "the gap in a crack" of one with a name.
std::string in_crack(std::string_view what, const std::string& name) {
  return fmt::format("{} crack \"{}\"", what.substr(0, what.rfind(" a crack")), name);
}

}  // namespace

std::string sampled_note(const Model& m) {
  for (const UnseenData& u : unseen_data(m.mesh, m.scene, m.inner->data))
    if (!u.stops_bounds)
      return fmt::format("the bounds are estimates: {} {} near ({:.6g}, {:.6g})", u.what, u.how, u.at.x(), u.at.y());
  return {};
}

std::vector<std::string> notes_on_data(const Mesh& mesh, const Scene& scene, const SceneData& data,
                                       const Shape& shape) {
  std::vector<std::string> notes;
  for (const UnseenData& u : unseen_data(mesh, scene, data))
    notes.push_back(fmt::format(
        "{} {} near ({:.6g}, {:.6g}): {}",
        u.label != none   ? fmt::format("{} on \"{}\"", u.what, shape.labels[u.label])
        : u.crack != none ? in_crack(u.what, shape.cracks[u.crack].name)
                          : u.what,
        u.how, u.at.x(), u.at.y(),
        u.stops_bounds ? "no error that is claimed can be trusted there" : "what lies between them is not seen"));
  return notes;
}

std::string note_on_loads(const Scene& scene, const Shape& shape) {
  const bool by_faces = std::ranges::any_of(scene.laws, [](const CrackLaw& law) { return has_gap(law); });
  if (has_eigenstrain(scene) || by_faces || !nothing_acts(scene, shape)) return {};
  return "nothing acts on the body, and its displacements and stresses are 0: give it a traction, a pressure, a body "
         "force, an eigenstrain or a prescribed displacement that is not 0";
}

std::string note_on_size(const Case& c, std::size_t triangles) {
  if (c.mesh || !(c.sizing.size > 0)) return {};
  Vec2 low = c.shape.outline.sides.front().start, high = low;
  for (const Side& side : c.shape.outline.sides) low = low.cwiseMin(side.start), high = high.cwiseMax(side.start);
  for (const Arc& arc : arcs_of(c.shape))
    for (const Vec2& x : points_on(arc, 8)) low = low.cwiseMin(x), high = high.cwiseMax(x);
  const double width = (high - low).minCoeff();
  constexpr double resolved = 0.1;
  if (!(c.sizing.size >= width)) return {};
  return fmt::format(
      "mesh.size = {:.3g} is no smaller than the body is wide, {:.3g}: the mesh has {} triangles, as few as its "
      "corners "
      "and cracks allow, and resolves no field; take {:.2g} or less",
      c.sizing.size, width, triangles, resolved * width);
}

std::string note_on_points(const std::string& whose, const Mesh& mesh, const Locator& locator,
                           const std::vector<Vec2>& points) {
  std::vector<Vec2> lost;
  std::ranges::copy_if(points, std::back_inserter(lost),
                       [&](const Vec2& x) { return locate(mesh, locator, x) == none; });
  if (lost.empty()) return {};
  const Vec2& first = lost.front();
  return fmt::format("{}: {} of {} points lie outside the body, the first at ({:.6g}, {:.6g}): there is no value there",
                     whose, lost.size(), points.size(), first.x(), first.y());
}

std::vector<std::string> notes_on_files(const Case& c) {
  std::vector<std::string> notes = c.file_notes;
  if (!c.mesh) {
    const std::vector<std::string> crowded = crowded_tips(c.shape, c.sizing);
    notes.insert(notes.end(), crowded.begin(), crowded.end());
    return notes;
  }
  constexpr std::string_view unlike =
      "the mesh of domain.file is used as it is: with friction K_II may be wrong by up to a tenth at tips where it is "
      "not its own mirror image in the crack";
  if (c.sizing.mirrored_tips) notes.emplace_back(unlike);
  return notes;
}

bool is_of_polygon(const Shape& shape, const Mesh& mesh) {
  return !arcs_of(shape).empty() && mesh.arc.empty();
}

namespace {

/// Open faces that penetrate.
std::vector<std::string> notes_on_faces(const std::vector<CrackResult>& cracks) {
  std::vector<std::string> notes;
  for (const CrackResult& crack : cracks)
    if (!(crack.penetration > 1e-6 * crack.max_opening && crack.penetration > 0))
      continue;
    else if (crack.half)
      notes.push_back(fmt::format(
          "\"{}\", the face of a crack in a plane of symmetry, passes through that plane by up to {:.3g}: the "
          "crack closes there, and K and G are those of faces that pass through each other; model the whole "
          "body with a [[crack]], whose faces may touch",
          crack.name, crack.penetration / 2));
    else
      notes.push_back(
          fmt::format("the faces of crack \"{}\" (contact = \"open\") penetrate by up to {:.3g}; "
                      "contact = \"unilateral\" prevents it",
                      crack.name, crack.penetration));
  return notes;
}

/// Measured on 89 random bodies with holes, fillets, slots and rings, meshes by default, bdms: the largest von Mises
/// stress of chords against the truth, least and largest difference. docs/method/state.md has the table.
std::string chords_may_cost(const Element& e) {
  if (e.name != "bdms" && e.name != "afw") return "is that of a polygon, and may be off by a tenth and more";
  return e.degree == 1   ? "may be 9 % too small to 5 % too large"
         : e.degree == 2 ? "may be up to 18 % too large"
                         : "may be 5 to 22 % too large";
}

/// That chords are drawn where nothing asks for them, why, and what that may cost; empty: they are not.
std::string note_on_drawing(const Case& c, const Model& model) {
  if (!is_of_polygon(c.shape, model.mesh) || c.why_chords.empty()) return {};
  return fmt::format("curved sides are drawn by chords, because {}: the largest stress on them {}", c.why_chords,
                     chords_may_cost(model.element));
}

}  // namespace

namespace {

/// What stands at each edge that was drawn around a point. Half the width under the same force moves the middle by
/// 2 |F| ln 2/(pi E') more: the displacement of a half plane under a strip grows like -2 F/(pi E') ln of its width
/// [Johnson 1985].
std::vector<PatchResult> patch_results(const Case& c, const Model& body, const StateResult& state) {
  std::vector<PatchResult> all;
  for (const PointPatch& patch : c.patches) {
    PatchResult p{.on = c.shape.labels[static_cast<std::size_t>(patch.label)], .at = patch.at, .width = patch.width};
    for (const auto* some : {&state.loads, &state.reactions})
      for (const ResultantResult& r : *some)
        if (r.on == p.on) p.force += r.force;
    const double share = patch.at_plane ? 2 : 1;  // of the force on the whole edge
    p.mean_stress = share * p.force.norm() / patch.width;
    const auto edge = std::ranges::find(body.mesh.label, patch.label);
    if (edge != body.mesh.label.end()) {
      const auto& [left, right] = body.mesh.sides[static_cast<std::size_t>(edge - body.mesh.label.begin())];
      if (const Material& m = material_of(body.mesh, body.scene, left != none ? left : right); isotropic(m))
        p.displacement_change = share * p.force.norm() * 2 * std::log(2.0) / (pi * plane_modulus(m));
    }
    all.push_back(std::move(p));
  }
  return all;
}

std::vector<std::string> notes_on_patches(const Case& c, const StateResult& s) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < s.patches.size(); ++i) {
    const PatchResult& p = s.patches[i];
    if (p.force.isZero(0)) continue;
    std::string note = fmt::format(
        "\"{}\" at ({:.6g}, {:.6g}): the force ({:.4g}, {:.4g}) acts on an edge {:.4g} wide{}{}, {:.4g} per length",
        p.on, p.at.x(), p.at.y(), p.force.x(), p.force.y(), p.width,
        c.patches[i].given ? "" : ", 1/1000 of the body's diagonal by default",
        c.patches[i].at_plane ? ", of which a plane of symmetry leaves one half" : "", p.mean_stress);
    if (p.displacement_change) {
      note += fmt::format("; half that width would move it locally by {:.3g} more", *p.displacement_change);
      if (s.compliance > 0)
        note +=
            fmt::format(" ({:.2g} % of the compliance)", 100 * *p.displacement_change * p.force.norm() / s.compliance);
    }
    notes.push_back(std::move(note));
  }
  return notes;
}

}  // namespace

void add_notes(const Case& c, const Model& body, const Findings& found, bool in_single, Result& r) {
  std::vector<std::string>& notes = r.state->notes;
  const auto add = [&notes](std::string note) {
    if (!note.empty()) notes.push_back(std::move(note));
  };
  const auto add_all = [&add](std::vector<std::string> some) {
    for (std::string& note : some) add(std::move(note));
  };
  add_all(notes_on_data(body.mesh, body.scene, body.inner->data, c.shape));
  r.state->patches = patch_results(c, body, *r.state);
  add_all(notes_on_patches(c, *r.state));
  add_all(notes_on_faces(r.cracks));
  add(note_on_drawing(c, body));
  if (in_single)
    add("the factor is kept in single precision: in double it would take more memory than there is or may be used");
  add(implausible(c.units, c.young));
  if (has_functions(*c.document))
    add("functions of a program are known at sampled points alone: what is said of errors holds as sampled");
  if (!r.steps.empty())
    add(fmt::format("state, cracks and pictures are those of the end of step \"{}\"; steps.csv has all of the history",
                    r.steps.back().name));
  std::string loads = note_on_loads(c.scene, c.shape);
  if (loads.empty() && certified(found.solved) && !found.has_stress)
    loads =
        "there is no stress in the body: its loads are 0 wherever they were looked at, and what is prescribed moves "
        "it as a rigid one";
  add(std::move(loads));
  add(note_on_size(c, static_cast<std::size_t>(r.triangles)));
  add_all(notes_on_files(c));
  add_all(notes_on_contact(r.cracks, body, {found.mean_stress, found.profiles}));
}

void add_notes_on_chords(const Case& c, const Mesh& mesh, double beside, Result& r) {
  StateResult& s = *r.state;
  if (!s.von_mises) return;
  if (const auto top = top_on_chords(c, *s.von_mises))
    if (std::string note = note_on_chords(c, *top, beside); !note.empty()) s.notes.push_back(std::move(note));
  if (lies_on_chords_of_file(c, mesh, *s.von_mises))
    s.notes.push_back(note_on_chords_of_file(s.von_mises->singular ? *s.von_mises->regular : s.von_mises->largest));
}

std::vector<std::string> notes_on_points(const Case& c, const Mesh& mesh, const Locator& locator, bool with_map) {
  std::vector<std::string> notes;
  const auto look = [&](const std::string& whose, const std::vector<Vec2>& points) {
    if (std::string note = note_on_points(whose, mesh, locator, points); !note.empty())
      notes.push_back(std::move(note));
  };
  for (const Probe& probe : c.probes) look(fmt::format("probe \"{}\"", probe.name), probe.points);
  if (with_map && c.map && !c.map->points.empty()) look("map", c.map->points);
  return notes;
}

}  // namespace kerf
