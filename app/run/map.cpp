// J with its notes, and the map of its topological derivative with masks, bars and second terms. Notes say where the
// value or the map is not what one may take it for: fields of a term that the mesh does not resolve, powers of the
// stress that are not integrable at tips, a ring that holds more than a tip, a misfit that grows as the mesh gets finer
// (data that jump are infinite in energy), and a nearly incompressible body held all around, which answers a hole by
// pressure everywhere, so that the expansion holds for much smaller radii. Each place is left out of the extrema for a
// reason, from the weakest to the strongest: masked for the radius, near a singular point.
// docs/theory/topological_derivatives.md, "How good the expansion is".

#include "app/run/map.hpp"

#include "app/run/peaks.hpp"
#include "app/write/draw.hpp"
#include "app/write/files.hpp"
#include "kerf/second_order.hpp"
#include "topo/analysis.hpp"
#include "topo/near.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

bool is_clamped(const MapTask& task) {
  return !has_series(task.request.perturbation);
}

/// Holes of the size that the map is for are then none of those that it speaks of.
std::vector<std::string> beyond_answers(const MapTask& task, const Analysis& a, const MapResult& map) {
  if (!may_answer_by_pressure(a.model->scene)) return {};
  SecondOrders second(a, task.functional, task.request.perturbation);
  const Vec2 at = second.roomiest();
  const double answered = second.answer_radius(at);
  constexpr double small = 0.25;
  // As far off as the next feature all bodies answer so.
  if (!(map.radius > answered) || nearest(*a.model, task.functional, {&at, 1}, answered / small, 0)[0] != Near::Nothing)
    return {};
  return {fmt::format(
      "the body is nearly incompressible and held all around: at ({:.6g}, {:.6g}) it answers a change of radius {:.2g} "
      "by as much stress as there was before. The map says what changes far smaller than that do, below {:.2g}; one of "
      "radius {:.2g} does something else",
      at.x(), at.y(), answered, small * answered, map.radius)};
}

/// The quantity of the tip as the state has it, and what its errors are compared with.
std::pair<double, double> at_tip(const TipResult& tip, TipQuantity quantity) {
  if (quantity == TipQuantity::ReleaseRate) return {*tip.G, std::abs(*tip.G)};
  const double size = std::hypot(*tip.K_I, *tip.K_II);
  if (quantity == TipQuantity::Equivalent) return {size, size};
  return {quantity == TipQuantity::OpeningMode ? *tip.K_I : *tip.K_II, size};
}

}  // namespace

std::vector<std::string> notes_on(const Functional& j, const Analysis& analysis, const Shape& shape,
                                  const std::vector<CrackResult>& cracks) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < j.terms.size(); ++i) {
    const Term& term = j.terms[i];
    constexpr double much = 0.01;
    if (const auto [share, at] = missed(term, *analysis.model); share > much)
      notes.push_back(fmt::format(
          "what {} takes from the case (weight, target, direction) varies too quickly for the mesh: up to {:.0f} % of "
          "its integral may be missed, most of it near ({:.6g}, {:.6g}); let the mesh follow it there (the edge of a "
          "region), or make mesh.size smaller",
          term.kind, 100 * share, at.x(), at.y()));
    constexpr double integrable = 4;
    if (term.stress_power >= integrable && !shape.cracks.empty())
      notes.push_back(
          fmt::format("the stress to the power {:g} is not integrable at crack tips: unless its weight vanishes there, "
                      "the value of {} is that of this mesh",
                      term.stress_power, term.kind));
    if (!(term.feature_radius > 0)) continue;
    if (term.tip->quantity == TipQuantity::OpeningMode && analysis.term_value[i] == 0)
      notes.push_back(
          "contact closes this tip: K_I is 0, and stays so for small changes of the body; mode = \"II\" and "
          "\"eq\" say what they do to the rest");
    for (const CrackResult& crack : cracks)
      for (const TipResult& tip : crack.tips) {
        constexpr double same = 0.03;
        if (!tip.G || (tip.at - term.feature).norm() > 1e-9 * extent(shape)) continue;
        const auto [value, size] = at_tip(tip, term.tip->quantity);
        if (std::abs(analysis.term_value[i] - value) > same * size)
          notes.push_back(
              fmt::format("{} is {:.4g}, the interaction integrals at that tip say {:.4g}: the ring has "
                          "too few triangles (mesh.size), or holds more than the tip",
                          term.kind, analysis.term_value[i], value));
      }
  }
  return notes;
}

std::string note_on_growth(const Functional& j, const Body& body, ContactMethod contact, const Analysis& analysis) {
  constexpr double grows = 1.1, little = 1e-5;  // of its energies: less is what is straight between readings
  if (std::ranges::none_of(j.terms, [](const Term& t) { return t.measured.has_value(); })) return {};
  const Model& model = *analysis.model;
  const double J = analysis.value, floor = little * std::max(std::abs(potential_energy(model, *analysis.state)),
                                                             std::abs(work_of_loads(model, *analysis.state)));
  if (!(std::abs(J) > floor)) return {};
  Sizing coarse = body.sizing;
  coarse.size = 2 * target_size(coarse, body.shape);
  coarse.crack_tip_size *= 2;
  try {
    const Model before = prepare(triangulate(body.shape, coarse), body.element, body.scene, model.threads);
    const State state = solve(before, contact);
    if (!certified(state)) return {};
    const double value = analyze(j, before, state, true).value;
    if (!(std::abs(J) > grows * std::abs(value) + floor)) return {};
    return fmt::format(
        "the misfit grows as the mesh gets finer: {:.4g} with edges of {:.3g}, {:.4g} on this mesh. Measured "
        "displacements that jump or scatter along the boundary, or do not fit the supports at its ends, do that; J "
        "compares bodies on one mesh alone then",
        value, coarse.size, J);
  } catch (const Error&) {  // what cannot be meshed or solved so coarsely is not compared
    return {};
  }
}

Mapped make_map(const MapTask& task, Analysis& analysis, const PlotData& data, const SingularZones& zones) {
  if (!is_clamped(task)) analysis.fields = recover_fields(analysis, data.corners);
  Mapped map;
  if (task.points.empty() || !needs_points(*analysis.model, task.functional, task.request.perturbation))
    map.full = map_everywhere(analysis, task.functional, task.request, data.corners);
  const Model& model = *analysis.model;
  const auto left_out = [&](const Vec2& x, bool masked) {
    return zones.hold(x) ? LeftOut::Singular : masked ? LeftOut::Masked : LeftOut::No;
  };
  if (is_everywhere(map.full)) {
    for (std::size_t i = 0; i < data.points.size(); ++i)
      map.left_out_corner.push_back(left_out(data.points[i], map.full.masked_corner[i]));
    for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t)
      map.left_out_centroid.push_back(
          left_out(centroid(model.mesh, static_cast<Index>(t)), map.full.masked_centroid[t]));
  }
  return map;
}

// Held all around, such a body answers a change by pressure everywhere.
bool may_answer_by_pressure(const Scene& scene) {
  constexpr double nearly = 0.01;  // of c mu, (1 - 2 nu)/4 in plane strain: nu = 0.48
  return scene.material.c * scene.material.mu < nearly;
}

std::vector<std::string> limits_of_map(const MapTask& task, const Analysis& analysis, const MapResult& map) {
  if (!is_clamped(task)) return beyond_answers(task, analysis, map);
  if (!has_contact(analysis.model->scene)) return {};
  return {
      "a clamped hole changes the state at once, not in proportion to its area: the map keeps the contact on the "
      "cracks as it is without the hole, and was off by up to 17 % beside cracks whose contact changes; [validate] "
      "tells at a point"};
}

std::vector<std::string> bound_map(const MapTask& task, const Analysis& analysis, const Body& body, Mapped& map) {
  std::vector<std::string> notes;
  if (task.request.second && is_clamped(task))
    notes.emplace_back("no c2: a clamped hole has no expansion in powers of its radius");
  else if (!map.full.second_note.empty())
    notes.push_back(fmt::format("no c2: {}", map.full.second_note));
  if (!task.request.bounds) return notes;
  if (is_clamped(task)) {
    notes.emplace_back("there are no bounds for maps of clamped holes");
    return notes;
  }
  add_bars(analysis, task.functional, task.request, {body.shape, body.sizing}, {map.full, map.result.points});
  return notes;
}

void write_map(const MapTask& task, const Mapped& map, const Model& model, const PlotData& data, Journal& journal) {
  journal.begin("write the map");
  write_map_files(journal, task, map, model.mesh, data);
  if (!is_everywhere(map.full)) return;
  journal.picture("map.png", [&] { return map_picture(journal.title_of_state(), task, model, data, map); });
  journal.seconds.output += journal.lap();
}

}  // namespace kerf
