// The intervals that [bounds], probes and mesh.adapt ask for, their notes, and what contradicts them. The solver gives
// guaranteed intervals of the body as it is meshed (docs/theory/bounds.md); here they become results, and are called
// estimates where a guarantee has no ground: data known at samples only, chords in the place of curves. A value that
// was found in another way (K by rings around the tip, reactions by the stress on the side) is a witness: if it lies
// outside by more than it is unsure of itself, 2 % and the spread of its rings, the interval is an estimate and the
// note has both. For mesh.adapt.of the dual solutions of the quantity grade the mesh.

#include "app/run/bounds.hpp"

#include "app/run/notes.hpp"

#include "geometry/curved.hpp"
#include "kerf/derivative_bounds.hpp"
#include "solver/open_faces.hpp"
#include "solver/recovery.hpp"
#include "solver/resultants.hpp"
#include "solver/system.hpp"
#include "solver/witness.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf {

namespace {

std::vector<BoundedTip> tips_of(const BoundsTask& task, const std::vector<TipIntensity>& tips,
                                const std::vector<TipBounds>& of) {
  std::vector<BoundedTip> out;
  for (std::size_t i = 0; i < tips.size(); ++i)
    out.push_back({task.body.shape.cracks[static_cast<std::size_t>(tips[i].crack)].name, tips[i].at_start, tips[i].at,
                   of[i].K_I, of[i].K_II, of[i].G});
  return out;
}

const Material& material_at(const Model& m, const Vec2& x) {
  const Index where = locate(m.mesh, {&x, 1}).front();
  return where == none ? m.scene.material : material_of(m.mesh, m.scene, where);
}

std::vector<BoundedPoint> points_of(const BoundsTask& task, const std::vector<Vec2>& points, const Model& m,
                                    std::vector<StressBounds> stresses) {
  std::vector<BoundedPoint> out;
  if (points.empty()) return out;
  const DerivativeBounds derivative(task.functional, task.perturbation, m);
  const std::vector<Bounded> derivatives = derivative.at(points, stresses);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const StressBounds& b = stresses[i];
    out.push_back({points[i], b.s11, b.s22, b.s12, von_mises_bounds(material_at(m, points[i]), task.plane_strain, b),
                   derivatives[i]});
  }
  return out;
}

double length_of(const Model& m, Index label) {
  const Mesh& mesh = m.mesh;
  double whole = 0;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (mesh.label[e] == label) whole += length_along(m, e);
  return whole;
}

/// Everything of the body as it is, at once.
QuantityRequest requested(const BoundsRequest& request, const Model& m) {
  QuantityRequest all{.points = request.points, .discs = request.discs, .lines = request.lines};
  for (const Index label : request.displacements)
    for (int k = 0; k < 2; ++k) {
      const double whole = length_of(m, label);
      const Vec2 share = whole > 0 ? Vec2(Vec2::Unit(k) / whole) : Vec2::Zero();  // a mean displacement
      all.works.push_back({{label, [share](const Vec2&, const Vec2&) -> Vec2 { return share; }}});
    }
  for (const Index label : request.reactions)
    for (int k = 0; k < 2; ++k) all.reactions.push_back({{label}, k});
  return all;
}

std::vector<BoundedMean> means_of(const BoundsTask& task, const BoundsRequest& request, const Model& m,
                                  const QuantityIntervals& found, const QuantityBounds& bounds) {
  using enum BoundedMean::Of;
  const auto name = [&](Index label) { return task.body.shape.labels[static_cast<std::size_t>(label)]; };
  std::vector<BoundedMean> out;
  for (std::size_t i = 0; i < request.discs.size(); ++i) {
    const OverDisc& d = request.discs[i];
    const StressBounds& s = found.discs[i];
    const StrainBounds e = strain_bounds(material_at(m, d.center), s);
    out.push_back({Disc, {}, d.center, d.center, d.radius, {s.s11, s.s22, s.s12, e.e11, e.e22, e.e12}});
  }
  for (std::size_t i = 0; i < request.lines.size(); ++i) {
    const StressBounds& s = found.lines[i];
    out.push_back({Line, {}, request.lines[i].from, request.lines[i].to, 0, {s.s22, s.s12, s.s11}});
  }
  const Bounded no_edges{nan, nan, nan, false, "no bounds: the label has no edges"};
  for (std::size_t i = 0; i < request.displacements.size(); ++i) {
    const Index label = request.displacements[i];
    const bool any = length_of(m, label) > 0;
    out.push_back({.of = Displacement,
                   .on = name(label),
                   .quantities = {any ? found.works[2 * i] : no_edges, any ? found.works[2 * i + 1] : no_edges}});
  }
  for (std::size_t i = 0; i < request.reactions.size(); ++i)
    out.push_back({.of = Reaction,
                   .on = name(request.reactions[i]),
                   .quantities = {found.reactions[2 * i], found.reactions[2 * i + 1]}});
  if (request.compliance) out.push_back({.of = Loads, .quantities = {bounds.work_of_loads()}});
  return out;
}

/// Why an interval is none of the body as drawn; empty: it is.
std::string polygon_note(const BoundsTask& task) {
  return arcs_of(task.body.shape).empty() || task.body.sizing.curved ? "" : of_polygon;
}

/// Why an interval is an estimate, whatever is bounded.
std::string estimate_note(const BoundsTask& task, const Model& m) {
  std::string polygon = polygon_note(task);
  return polygon.empty() ? sampled_note(m) : polygon;
}

/// The reactions of the stress itself are better than it is: their error is a product of two.
void confront(std::vector<BoundedMean>& means, const BoundsRequest& request, const Model& m, const State& s) {
  if (request.reactions.empty()) return;
  constexpr double unsure = 0.02;
  const std::vector<LabelResultant> own = reactions(m, s);
  double size = 0;
  for (const LabelResultant& r : own) size = std::max(size, r.of.force.norm());
  std::size_t next = 0;
  for (BoundedMean& mean : means) {
    if (mean.of != BoundedMean::Of::Reaction) continue;
    const auto at = std::ranges::find(own, request.reactions[next++], &LabelResultant::label);
    if (at == own.end()) continue;
    for (int k = 0; k < 2; ++k)
      confront(mean.quantities[static_cast<std::size_t>(k)], at->of.force[k], unsure * size, "the stress on that side");
  }
}

struct GoalBound {
  Bounded interval;
  std::vector<Eigen::VectorXd> eta;  // of the dual solutions
};

GoalBound bound_goal(const BoundsTask& task, const GoalRequest& goal, const Model& m, const State& s) {
  if (goal.quantity == "energy") {
    const EnergyBounds e = energy_bounds(m, s);
    return {{0.5 * (e.lower + e.upper), e.lower, e.upper, e.guaranteed, e.note}, {}};
  }
  const QuantityBounds bounds(m, s, true);
  if (goal.crack != none) {
    const std::vector<TipIntensity> tips = crack_tips(m, s);
    const auto at = std::ranges::find_if(
        tips, [&](const TipIntensity& t) { return t.crack == goal.crack && t.at_start == goal.at_start; });
    if (at == tips.end()) return {bounds.tip({.crack = goal.crack, .at_start = goal.at_start}).K_I, {}};
    TipBounds tip = bounds.tip(*at);
    confront(tip, *at);
    return {goal.quantity == "K_I" ? tip.K_I : goal.quantity == "K_II" ? tip.K_II : tip.G, tip.eta};
  }
  StressBounds stress = bounds.stress(goal.at);
  GoalBound out;
  if (goal.quantity == "topological_derivative")
    out.interval = DerivativeBounds(task.functional, task.perturbation, m, true).at(goal.at, stress);
  else if (goal.quantity == "von_mises")
    out.interval = von_mises_bounds(material_at(m, goal.at), task.plane_strain, stress);
  else
    out.interval = goal.quantity == "s_xx" ? stress.s11 : goal.quantity == "s_yy" ? stress.s22 : stress.s12;
  out.eta = stress.eta;
  return out;
}

}  // namespace

std::string in_words(const GoalRequest& goal, const Shape& shape, bool curved) {
  const char* of = curved || arcs_of(shape).empty() ? "" : ", of the polygon of the mesh";
  if (goal.crack != none)
    return fmt::format("{} at the {} of crack \"{}\"{}", goal.quantity, goal.at_start ? "start" : "end",
                       shape.cracks[static_cast<std::size_t>(goal.crack)].name, of);
  if (goal.quantity == "energy") return fmt::format("the energy{}", of);
  return fmt::format("{} at ({:.6g}, {:.6g}){}", goal.quantity, goal.at.x(), goal.at.y(), of);
}

Indicator goal_indicator(const BoundsTask& task, const GoalRequest& goal, const Model& m, const State& s,
                         const Indicator& own) {
  const std::string what = in_words(goal, task.body.shape, task.body.sizing.curved);
  const GoalBound bound = bound_goal(task, goal, m, s);
  const Bounded& b = bound.interval;
  if (!std::isfinite(b.lower) || !std::isfinite(b.upper))
    throw Error(Fault::Usage, fmt::format("mesh.adapt.of: {}: {}", what, b.note));
  return refine_for(own, b, bound.eta);
}

std::vector<BoundedStress> bound_stresses(const BoundsTask& task, const Model& m, const std::vector<Vec2>& points,
                                          const QuantityBounds& bounds) {
  const std::string estimate = estimate_note(task, m);
  std::vector<BoundedStress> out;
  for (const StressBounds& s : bounds.all({.points = points}).points) {
    out.push_back({s.s11, s.s22, s.s12});
    for (Bounded* b : {&out.back().s_xx, &out.back().s_yy, &out.back().s_xy}) qualify(*b, estimate);
  }
  return out;
}

BoundsResult bound_quantities(const BoundsTask& task, const BoundsRequest& request, const Adapted& adapted,
                              int threads) {
  const Model& model = adapted.model;
  const State& state = adapted.state;
  const std::string estimate = estimate_note(task, model);
  const QuantityBounds bounds(model, state);
  BoundsResult out;
  QuantityRequest wanted = requested(request, model);
  std::vector<TipIntensity> tips;
  std::optional<Opened> free;  // what has the tips
  if (request.tips && !model.mesh.cracks.empty()) {
    if (open_everywhere(model, state)) free.emplace(opened(model, threads));
    tips = free ? crack_tips(free->model, free->state) : crack_tips(model, state);
    if (!free) wanted.tips = tips;
  }
  QuantityIntervals found = bounds.all(wanted);
  std::vector<TipBounds> of_tips =
      free ? QuantityBounds(free->model, free->state).all({.tips = tips}).tips : std::move(found.tips);
  for (std::size_t i = 0; i < tips.size(); ++i) confront(of_tips[i], tips[i]);
  out.tips = tips_of(task, tips, of_tips);
  for (BoundedTip& t : out.tips)
    for (Bounded* b : {&t.K_I, &t.K_II, &t.G}) qualify(*b, free ? of_opened : estimate);
  out.points = points_of(task, request.points, model, std::move(found.points));
  for (BoundedPoint& p : out.points)
    for (Bounded* b : {&p.s_xx, &p.s_yy, &p.s_xy, &p.von_mises, &p.derivative}) qualify(*b, estimate);
  out.means = means_of(task, request, model, found, bounds);
  confront(out.means, request, model, state);
  for (BoundedMean& m : out.means)
    for (Bounded& b : m.quantities) qualify(b, estimate);
  return out;
}

}  // namespace kerf
