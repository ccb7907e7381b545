// What is wrong with an optimization and can be known before anything is meshed or solved, rule by rule; the parts that
// only a level set or only drawn shapes can get wrong are in level_set.cpp and design.cpp. Each rule appends the key of
// the case file that it blames, with what to do instead; refuse_wrong throws all of them, a line each. Loads count as
// absent only where interval arithmetic encloses them by 0 over the whole side or body (docs/theory/data.md,
// "Enclosures"): what is sampled counts as a load. docs/limits.md says what is not supported.

#include "optimize/refuse.hpp"

#include "geometry/interfaces.hpp"
#include "optimize/loop/evaluate.hpp"
#include "optimize/refuse/methods.hpp"
#include "topo/orthotropic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

bool is_zero(const Interval& i) {
  return i.low == 0 && i.high == 0;
}
bool is_zero(const std::array<Interval, 2>& value) {
  return is_zero(value[0]) && is_zero(value[1]);
}

/// Whether data are known to vanish on all of a label.
bool vanishes(const BoundaryField& f, const Shape& body, Index label) {
  if (!f.known()) return false;
  // Over every side of the label: straight ones along their line, arcs by a box.
  std::vector<const Loop*> loops{&body.outline};
  for (const Loop& hole : body.holes) loops.push_back(&hole);
  for (const Loop* loop : loops)
    for (std::size_t i = 0; i < loop->sides.size(); ++i) {
      const Side& side = loop->sides[i];
      if (side.label != label) continue;
      // Over the box about the circle of the arc: more than the arc, so that a 0 is proved.
      if (side.arc) {
        const double r = largest_radius(*side.arc);
        const Vec2& c = side.arc->center;
        if (!is_zero(f.known()->over({c.x() - r, c.x() + r}, {c.y() - r, c.y() + r}))) return false;
        continue;
      }
      const Vec2 &a = side.start, &b = loop->sides[(i + 1) % loop->sides.size()].start, along = (b - a).normalized();
      if (!is_zero(f.known()->along({a, b, Vec2(along.y(), -along.x())}, 0, 1).value)) return false;
    }
  return true;
}

// Over the bounding box: more than the body, so that a 0 is proved.
bool vanishes(const auto& f, const Shape& body) {
  if (!f.known()) return false;
  const auto [low, high] = box_of(body.outline);
  return is_zero(f.known()->over({low.x(), high.x()}, {low.y(), high.y()}));
}

}  // namespace

bool nothing_acts(const Scene& scene, const Shape& body) {
  return std::ranges::all_of(scene.tractions, [&](const Traction& t) { return vanishes(t.value, body, t.label); }) &&
         (!scene.body || vanishes(scene.body, body)) &&
         std::ranges::all_of(scene.laws,
                             [&](const CrackLaw& law) { return !law.pressure || vanishes(law.pressure, body); }) &&
         std::ranges::all_of(scene.supports, [&](const Support& s) { return vanishes(s.value, body, s.label); });
}

namespace {

/// Without loads nothing moves, whatever the design; measured displacements move the body of a misfit.
void look_at_loads(const Problem& p, const OptimizeRequest& r, std::vector<Wrong>& all) {
  if (std::ranges::any_of(p.objective.terms, [](const Term& t) { return t.measured.has_value(); })) return;
  const std::vector<Scene> scenes = scenes_of(p, r);
  for (std::size_t l = 0; l < scenes.size(); ++l) {
    if (!nothing_acts(scenes[l], p.frame)) continue;
    const bool cases = !r.load_cases.empty();
    const std::string key = cases                        ? fmt::format("load_case[{}]", l)
                            : !p.scene.tractions.empty() ? "boundary"
                            : p.scene.body               ? "body.force"
                                                         : "optimize";
    all.push_back({key, fmt::format("{}: nothing acts on the body, and every design is as good as another; give it a "
                                    "traction, a pressure, a body force or a prescribed displacement that is not 0",
                                    cases ? fmt::format("[[load_case]] \"{}\"", r.load_cases[l].name) : "[optimize]")});
  }
}

// Without supports the displacement is known up to a rigid motion only, and what sees it is no number.
void look_at_rigid_motions(const Problem& p, const OptimizeRequest& r, std::vector<Wrong>& all) {
  if (!p.scene.supports.empty()) return;
  const auto look = [&](const Functional& j, const std::string& key, const std::string& where) {
    for (const Term& term : j.terms)
      if (term.uses_displacement || term.on_boundary) {
        all.push_back({key, fmt::format("{}: \"{}\" sees rigid motions, and nothing supports the body; add a "
                                        "[[boundary]] with a displacement, or use a functional of stresses, energies "
                                        "or cracks",
                                        where, term.kind)});
        return;
      }
  };
  look(p.objective, "functional", "[functional]");
  for (std::size_t b = 0; b < r.bounds.size(); ++b)
    look(r.bounds[b].functional, fmt::format("optimize.bound[{}]", b), "[[optimize.bound]]");
}

// A level set would carve a pressure away with its crack. With friction no energy is least, and what a map or a misfit
// needs is not known.
void look_at_cracks(const Problem& p, const OptimizeRequest& r, std::vector<Wrong>& all) {
  const bool level_set = r.method == OptimizeMethod::LevelSet;
  for (std::size_t k = 0; level_set && k < p.scene.laws.size() && k < p.frame.cracks.size(); ++k)
    if (has_pressure(p.scene.laws[k]))
      all.push_back({fmt::format("crack[{}].pressure", k),
                     fmt::format("crack \"{}\" carries a pressure: a level set would cut it away, and the load with "
                                 "it; remove the pressure, or use a method that moves drawn shapes, such as \"mma\"",
                                 p.frame.cracks[k].name)});
  const auto measures = [](const Functional& j) {
    return std::ranges::any_of(j.terms, [](const Term& t) { return t.measured.has_value(); });
  };
  const bool misfit = measures(p.objective) ||
                      std::ranges::any_of(r.bounds, [&](const FunctionalBound& b) { return measures(b.functional); });
  const bool found = wants_map(r.design);
  if (!found && (!misfit || r.method == OptimizeMethod::Cobyla)) return;
  for (std::size_t k = 0; k < p.scene.laws.size() && k < p.frame.cracks.size(); ++k) {
    const CrackLaw& law = p.scene.laws[k];
    if (!has_friction(law)) continue;
    all.push_back(
        {fmt::format("crack[{}].{}", k, law.friction > 0 ? "friction" : "tresca"),
         fmt::format("crack \"{}\" slides against friction, and {} needs cracks without; remove friction and "
                     "tresca{}",
                     p.frame.cracks[k].name, found ? "what begins where a map finds it" : "the derivative of a misfit",
                     found ? ", or say where the design starts" : ", or track the displacements")});
  }
}

// The first one tells enough; so with eigenstrains below.
void look_at_interfaces(const Problem& p, std::vector<Wrong>& all) {
  const std::vector<bool> along = along_regions(p.frame);
  for (std::size_t k = 0; k < along.size(); ++k)
    if (along[k]) {
      all.push_back({"interface", fmt::format("[optimize] moves nothing next to interface \"{}\": a shape that cuts it "
                                              "is not known; leave it out, or take the state, maps and validation of "
                                              "this body (kerf solve, map, validate)",
                                              p.frame.cracks[k].name)});
      return;
    }
  if (const Index k = crack_on_border(p.frame); k != none)
    all.push_back(
        {fmt::format("crack[{}]", k),
         fmt::format("[optimize] needs cracks apart from the borders of regions, and crack \"{}\" crosses or "
                     "ends on one: take the state, maps, validation and growth of this body (kerf solve, map, "
                     "validate, grow)",
                     p.frame.cracks[static_cast<std::size_t>(k)].name)});
  if (regions_touch(p.frame))
    all.push_back({"region",
                   "[optimize] needs regions that lie apart, inside the body; these share sides with each "
                   "other, the outline or a hole: take the state, maps and validation of this body (kerf "
                   "solve, map, validate)"});
}

void look_at_eigenstrain(const Problem& p, std::vector<Wrong>& all) {
  for (std::size_t k = 0; k < p.scene.eigenstrain.size(); ++k)
    if (p.scene.eigenstrain[k]) {
      all.push_back({k == 0 ? std::string("material.eigenstrain") : fmt::format("region[{}].eigenstrain", k - 1),
                     "[optimize] does not know what an eigenstrain does to derivatives by the shape; leave it out, or "
                     "take the state, maps and validation of this body (kerf solve, map, validate)"});
      return;
    }
}

void look_at_materials(const Problem& p, std::vector<Wrong>& all) {
  if (!has_orthotropic(p.scene)) return;
  const bool body = !isotropic(p.scene.material);
  all.push_back({body ? "material.young" : "region",
                 fmt::format("[optimize]: {} orthotropic, and bodies are optimized in isotropic materials only; give "
                             "young one number, or leave [optimize] out (kerf solve, map)",
                             body ? "the body is" : "a region is")});
}

}  // namespace

// Compliance alone is least for the full body, area alone for none; other functionals need some price or bound of area.
std::optional<std::string> wrong_volume(const Functional& objective, const OptimizeRequest& r) {
  if (r.method != OptimizeMethod::LevelSet) return std::nullopt;
  if ((r.volume_at_most && *r.volume_at_most < 1) || r.volume_penalty > 0) return std::nullopt;
  const auto& terms = objective.terms;
  if (std::ranges::all_of(terms, [](const Term& t) { return t.work && t.factor > 0; }))
    return r.volume_at_most
               ? "[optimize]: volume.at_most = 1 leaves the full body, which has the least compliance, and there is "
                 "nothing to optimize; ask for less"
               : "[optimize]: without volume = { at_most = ... } or { penalty = ... } the full body has the least "
                 "compliance, and there is nothing to optimize; add one of them";
  double price = 0;
  for (const Term& t : terms)
    if (t.volume) price += t.factor;
  // Nothing but area to be made small.
  const bool area = std::ranges::all_of(terms, [](const Term& t) { return t.volume; });
  if (area && r.bounds.empty())
    return "[optimize]: the least volume is no body at all; add an [[optimize.bound]] on what the body has to bear, "
           "such as kind = \"compliance\" with at_most";
  if (!r.volume_at_most && !(price > 0))
    return "[optimize]: a level set needs something that says how much material there may be: add volume = { at_most "
           "= ... } or { penalty = ... }, or minimize a sum with kind = \"volume\"";
  return std::nullopt;
}

// Measured displacements belong to one set of loads, and the ring of a release rate to one body force.
std::optional<std::string> wrong_load_cases(const Functional& objective, const OptimizeRequest& r) {
  if (r.load_cases.empty()) return std::nullopt;
  const bool forces = std::ranges::any_of(r.load_cases, [](const LoadCase& l) { return static_cast<bool>(l.body); });
  const auto wrong = [&](const Functional& j) -> std::optional<std::string> {
    for (const Term& term : j.terms) {
      if (term.measured)
        return "[[load_case]]: a misfit belongs to one set of loads; write them as [[boundary]] and [body]";
      if (term.feature_radius > 0 && forces)
        return fmt::format(
            "[[load_case]]: {} takes no body forces of load cases; write the loads as [[boundary]] and "
            "[body]",
            term.kind);
    }
    return std::nullopt;
  };
  if (auto why = wrong(objective)) return why;
  for (const FunctionalBound& bound : r.bounds)
    if (auto why = wrong(bound.functional)) return why;
  return std::nullopt;
}

// Everything that is wrong is told at once. What needs a body that can be drawn waits until there is one.
std::vector<Wrong> find_wrong(const Problem& p, const OptimizeRequest& r) {
  std::vector<Wrong> all;
  const bool drawable = !find_problem(p.frame);
  if (r.max_iterations < 1)
    all.push_back({"optimize.max_iterations", "max_iterations in [optimize] must be at least 1"});
  if (r.starts < 0) all.push_back({"optimize.starts", "starts in [optimize] must be at least 1"});
  if (auto why = wrong_load_cases(p.objective, r)) all.push_back({"load_case[0]", *why});
  if (auto why = wrong_volume(p.objective, r))
    all.push_back({r.volume_at_most ? "optimize.volume.at_most" : "optimize", *why});
  if (p.sizing.curved)
    all.push_back(
        {"mesh.curved", "mesh.curved is for solve and map; an optimization moves straight edges: leave it out"});
  look_at_materials(p, all);
  look_at_cracks(p, r, all);
  if (drawable) look_at_interfaces(p, all);
  look_at_eigenstrain(p, all);
  look_at_rigid_motions(p, r, all);
  if (drawable) look_at_loads(p, r, all);
  if (r.method == OptimizeMethod::LevelSet)
    look_at_level_set(p, r, drawable, all);
  else
    look_at_design(p, r, drawable, all);
  return all;
}

void require_drawable(const Shape& body) {
  if (const auto problem = find_problem(body)) throw Error(Fault::Geometry, *problem);
}

void refuse_wrong(const Problem& p, const OptimizeRequest& r) {
  const std::vector<Wrong> all = find_wrong(p, r);
  if (all.empty()) return require_drawable(p.frame);
  std::vector<std::string> lines;
  for (const Wrong& wrong : all) lines.push_back(wrong.what);
  throw Error(Fault::Usage, fmt::format("{}", fmt::join(lines, "\n")));
}

}  // namespace kerf
