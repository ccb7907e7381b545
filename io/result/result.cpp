// result.json: every number of a run, a section per job that ran. Numbers have the shortest text that gives the same
// double; one that is not finite, or not known, is null. Keys are written in the order of the code and never sorted, so
// that files of two runs can be compared line by line. Angles are written in degrees. Names come from users and may
// hold any bytes: what is no UTF-8 is replaced. read.cpp is the mirror of this file, and a key that is added here is
// added there. docs/results.md says what the sections hold.

#include "io/result.hpp"

#include "io/files.hpp"
#include "io/growth_columns.hpp"
#include "io/result/edge_crack_columns.hpp"
#include "io/text.hpp"
#include "io/validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace kerf {

namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json number(const std::optional<double>& value) {
  return value ? number(*value) : Json(nullptr);
}

Json place_of(const Vec2& at) {
  return Json::array({number(at.x()), number(at.y())});
}

Json placed(const PlacedValue& value) {
  Json out = {{"at", place_of(value.at)}, {"value", number(value.value)}};
  if (value.margin) out["margin"] = number(*value.margin);
  return out;
}

Json mesh_section(const Result& result) {
  Json section = {{"triangles", result.triangles},
                  {"vertices", result.vertices},
                  {"h_min", number(result.mesh.h_min)},
                  {"h_max", number(result.mesh.h_max)},
                  {"min_angle_deg", number(result.mesh.min_angle_deg)},
                  {"mean_quality", number(result.mesh.mean_quality)}};
  if (result.adapt) {
    Json rounds = Json::array();
    for (const auto& [triangles, error] : result.adapt->rounds)
      rounds.push_back({{"triangles", triangles}, {"estimated_error", number(error)}});
    section["adapt"] = {{"rounds", rounds}, {"stopped", result.adapt->stopped}};
    if (!result.adapt->of.empty()) section["adapt"]["of"] = result.adapt->of;
  }
  return section;
}

Json peak_section(const Peak& peak) {
  Json out = placed(peak.largest);
  out["singular"] = peak.singular;
  if (peak.singular) out["regular"] = peak.regular ? placed(*peak.regular) : Json(nullptr);
  return out;
}

Json resultant(const ResultantResult& r) {
  Json out = Json::object();
  if (!r.on.empty()) out["on"] = r.on;
  out["force"] = place_of(r.force);
  out["moment"] = number(r.moment);
  return out;
}

Json resultants(const StateResult& state) {
  Json out = {{"loads", Json::array()}, {"reactions", Json::array()}};
  for (const ResultantResult& r : state.loads) out["loads"].push_back(resultant(r));
  for (const ResultantResult& r : state.reactions) out["reactions"].push_back(resultant(r));
  if (state.body) out["body"] = resultant(*state.body);
  out["balance"] = resultant(*state.balance);
  if (!state.patches.empty()) out["patches"] = Json::array();
  for (const PatchResult& p : state.patches)
    out["patches"].push_back({{"on", p.on},
                              {"at", place_of(p.at)},
                              {"width", number(p.width)},
                              {"force", {number(p.force.x()), number(p.force.y())}},
                              {"mean_stress", number(p.mean_stress)},
                              {"displacement_change", number(p.displacement_change)}});
  return out;
}

/// Of the whole plate, thickness included.
Json plate_section(const StateResult& state, double thickness) {
  Json out = {{"thickness", number(thickness)},
              {"energy", number(thickness * state.energy)},
              {"compliance", number(thickness * state.compliance)}};
  if (!state.balance) return out;
  StateResult whole{.loads = state.loads, .reactions = state.reactions, .body = state.body, .balance = state.balance};
  const auto scale = [&](ResultantResult& r) {
    r.force *= thickness;
    r.moment *= thickness;
  };
  for (ResultantResult& r : whole.loads) scale(r);
  for (ResultantResult& r : whole.reactions) scale(r);
  if (whole.body) scale(*whole.body);
  scale(*whole.balance);
  out["resultants"] = resultants(whole);
  return out;
}

Json reserve_section(const std::vector<ReserveResult>& reserves) {
  Json out = Json::array();
  for (const ReserveResult& r : reserves) {
    Json row = {{"of", reserve_words[static_cast<std::size_t>(r.of)]},
                {"factor", number(r.factor)},
                {"value", number(r.value)},
                {"limit", number(r.limit)},
                {"at", place_of(r.at)}};
    if (!r.region.empty()) row["region"] = r.region;
    if (!r.crack.empty()) row["crack"] = r.crack;
    out.push_back(std::move(row));
  }
  return out;
}

Json state_section(const StateResult& state) {
  Json bounds = nullptr;
  if (state.energy_bounds) bounds = Json::array({number((*state.energy_bounds)[0]), number((*state.energy_bounds)[1])});
  Json out = {{"element", state.element},
              {"unknowns", state.unknowns},
              {"condensed_unknowns", state.condensed_unknowns},
              {"residual", number(state.residual)},
              {"energy", number(state.energy)},
              {"compliance", number(state.compliance)},
              {"area", number(state.area)},
              {"estimated_error", number(state.estimated_error)},
              {"energy_bounds", std::move(bounds)}};
  out["degree"] = state.degree;
  out["work_error"] = number(state.work_error);
  if (state.energy_bounds) out["energy_bounds_of"] = state.of_polygon ? "polygon" : "body";
  if (state.von_mises) out["max_von_mises"] = peak_section(*state.von_mises);
  if (state.displacement) out["max_displacement"] = placed(state.displacement->largest);
  if (!state.load_case.empty()) out["load_case"] = state.load_case;
  if (!state.reserves.empty()) out["reserve"] = reserve_section(state.reserves);
  if (!state.notes.empty()) out["notes"] = state.notes;
  if (state.balance) out["resultants"] = resultants(state);
  if (const auto& t = state.thickness) out["plate"] = plate_section(state, *t);
  return out;
}

Json load_case_section(const LoadCaseResult& c) {
  Json out = {{"name", c.name},
              {"weight", number(c.weight)},
              {"energy", number(c.energy)},
              {"compliance", number(c.compliance)}};
  if (c.von_mises) out["max_von_mises"] = peak_section(*c.von_mises);
  if (c.displacement) out["max_displacement"] = placed(c.displacement->largest);
  if (!c.reserves.empty()) out["reserve"] = reserve_section(c.reserves);
  out["reactions"] = Json::array();
  for (const ResultantResult& r : c.reactions) out["reactions"].push_back(resultant(r));
  return out;
}

Json units_section(const Result& result) {
  const Units& u = result.units;
  Json out = {{"length", u.length},
              {"stress", u.stress},
              {"force_per_thickness", unit(u, dimension::force)},
              {"moment_per_thickness", unit(u, dimension::moment)},
              {"energy_per_thickness", unit(u, dimension::energy)},
              {"K", unit(u, dimension::stress_intensity)},
              {"G", unit(u, dimension::release_rate)}};
  if (result.state && result.state->thickness) {
    out["force_of_plate"] = unit_of_plate(u, dimension::force);
    out["energy_of_plate"] = unit_of_plate(u, dimension::energy);
  }
  if (const auto& j = result.functional_dimension) {
    out["functional"] = unit(u, *j);
    out["topological_derivative"] = unit(u, per_area(*j));
    out["functional_powers"] = {number(j->stress), number(j->length)};
  }
  return out;
}

Json contact_section(const ContactResultSummary& contact) {
  return {{"method", contact.method},
          {"iterations", contact.iterations},
          {"linear_solves", contact.linear_solves},
          {"kkt", number(contact.kkt)},
          {"open_length", number(contact.open_length)},
          {"closed_length", number(contact.closed_length)},
          {"biactive_length", number(contact.biactive_length)}};
}

Json crack_section(const CrackResult& crack) {
  Json transitions = Json::array(), tips = Json::array();
  for (const auto& t : crack.transitions) {
    transitions.push_back({{"at", place_of(t.at)}, {"from", t.from}, {"to", t.to}});
  }
  for (const TipResult& tip : crack.tips) {
    Json spread = nullptr;
    if (const auto& s = tip.spread) spread = {{"K_I", number(s->K_I)}, {"K_II", number(s->K_II)}, {"T", number(s->T)}};
    tips.push_back({{"at", place_of(tip.at)},
                    {"K_I", number(tip.K_I)},
                    {"K_II", number(tip.K_II)},
                    {"G", number(tip.G)},
                    {"T", number(tip.T)},
                    {"spread", std::move(spread)}});
    if (const auto& m = tip.margin)
      tips.back()["margin"] = {
          {"K_I", number(m->K_I)}, {"K_II", number(m->K_II)}, {"G", number(m->G)}, {"T", number(m->T)}};
    if (!tip.note.empty()) tips.back()["note"] = tip.note;
  }
  Json out = {{"name", crack.name},
              {"length", number(crack.length)},
              {"max_opening", number(crack.max_opening)},
              {"max_pressure", number(crack.max_pressure)},
              {"transitions", std::move(transitions)},
              {"tips", std::move(tips)}};
  if (crack.half) out["half"] = true;
  if (crack.fluid_pressure) out["fluid_pressure"] = number(*crack.fluid_pressure);
  if (crack.pressure) out["pressure_peak"] = peak_section(*crack.pressure);
  return out;
}

Json step_section(const StepResult& step) {
  Json values = Json::object(), tips = Json::array();
  for (const auto& [name, value] : step.values) values[name] = number(value);
  for (const StepResult::Tip& t : step.tips)
    tips.push_back({{"crack", t.crack}, {"at", place_of(t.at)}, {"K_I", number(t.K_I)}, {"K_II", number(t.K_II)}});
  return {{"name", step.name},
          {"part", step.part},
          {"parts", step.parts},
          {"define", std::move(values)},
          {"energy", number(step.energy)},
          {"strain_energy", number(step.strain_energy)},
          {"work", number(step.work)},
          {"dissipation", number(step.dissipation)},
          {"imbalance", number(step.imbalance)},
          {"open_length", number(step.open_length)},
          {"closed_length", number(step.closed_length)},
          {"stick_length", number(step.stick_length)},
          {"slip_length", number(step.slip_length)},
          {"kkt", number(step.kkt)},
          {"tips", std::move(tips)}};
}

/// name: [lower, upper] of each, whether they are guaranteed, and why not.
template <typename Of>
Json intervals(const Of& of, const auto& columns) {
  Json out = {{"guaranteed", of.guaranteed}};
  for (const auto& [name, member] : columns) out[name] = {number((of.*member).low), number((of.*member).high)};
  if (!of.note.empty()) out["note"] = of.note;
  return out;
}

/// The interval of the life: that which bounds give, or that of the last halving of the step; null where neither is
/// there, and without cycles.
Json life_of(const GrowthResult& growth, double cycles) {
  if (growth.law == "quasi-static") return nullptr;
  if (growth.bounds && std::isfinite(growth.bounds->cycles.low))
    return Json::array({number(growth.bounds->cycles.low), number(growth.bounds->cycles.high)});
  if (!std::isfinite(growth.cycles_error)) return nullptr;
  return Json::array({number(cycles - growth.cycles_error), number(cycles + growth.cycles_error)});
}

Json grown_tips(const growth::GrowthStep& step) {
  Json tips = Json::array();
  for (const growth::GrownTip& t : step.tips) {
    Json tip = {{"tip", t.name}, {"at", place_of(t.at)}};
    for (const auto& [name, member] : columns_of_tip) tip[name] = number(t.*member);
    if (t.in) tip["bounds"] = intervals(*t.in, intervals_of_tip);
    tips.push_back(std::move(tip));
  }
  return tips;
}

Json growth_section(const GrowthResult& growth) {
  Json steps = Json::array();
  for (const growth::GrowthStep& s : growth.steps)
    steps.push_back({{"step", s.number},
                     {"cycles", number(s.cycles)},
                     {"load", number(s.load)},
                     {"potential", number(s.potential)},
                     {"solves", s.solves},
                     {"tips", grown_tips(s)}});
  Json out = {{"law", growth.law},
              {"criterion", growth.criterion},
              {"ended", growth.ended},
              {"notes", growth.notes},
              {"solves", growth.solves},
              {"step", number(growth.step)},
              {"path_error", number(growth.path_error)},
              {"cycles_error", number(growth.cycles_error)},
              {"energy_balance", number(growth.energy_balance)},
              {"steps", std::move(steps)}};
  if (!growth.steps.empty()) {
    const growth::GrowthStep& last = growth.steps.back();
    out["cycles"] = number(last.cycles);
    out["life"] = life_of(growth, last.cycles);
    out["tips"] = grown_tips(last);
  }
  if (growth.unstable_from) out["unstable_from"] = *growth.unstable_from;
  if (growth.snaps_back_from) out["snaps_back_from"] = *growth.snaps_back_from;
  if (growth.bounds) out["bounds"] = intervals(*growth.bounds, intervals_of_path);
  return out;
}

Json edge_crack(const inspect::EdgeCrack& crack) {
  Json out = {
      {"at", place_of(crack.at)}, {"inward", place_of(crack.inward)}, {"angle_deg", number(crack.angle * 180 / pi)}};
  for (const auto& [name, member] : columns_of_edge_crack) out[name] = number(crack.*member);
  out["closed"] = crack.closed;
  out["masked"] = word(crack.masked);
  return out;
}

Json interior_crack(const inspect::InteriorCrack& crack) {
  Json out = {{"at", place_of(crack.at)}, {"direction_deg", number(crack.direction * 180 / pi)}};
  for (const auto& [name, member] : columns_of_interior_crack) out[name] = number(crack.*member);
  out["closed"] = crack.closed;
  return out;
}

/// The worst places in short.
Json inspect_section(const EdgeCrackResult& e) {
  Json out = Json::array();
  for (const EdgeCrackResult::Row& row : e.worst)
    out.push_back({{"at", place_of(row.crack.at)},
                   {"K", number(row.crack.K)},
                   {"angle", number(row.crack.angle * 180 / pi)},
                   {"critical_length", e.law.empty() ? Json(nullptr) : number(row.tolerance.critical_length)},
                   {"cycles", e.law.empty() ? Json(nullptr) : number(row.tolerance.cycles)}});
  return out;
}

Json edge_cracks_section(const EdgeCrackResult& e) {
  Json worst = Json::array(), drawn = Json::array(), inside = Json::array();
  for (const inspect::InteriorCrack& crack : e.inside) inside.push_back(interior_crack(crack));
  for (const EdgeCrackResult::Row& row : e.worst) {
    Json out = edge_crack(row.crack);
    if (!e.law.empty()) {
      out["tolerated"] = word(row.tolerance.how);
      for (const auto& [name, member] : columns_of_tolerance) out[name] = number(row.tolerance.*member);
    }
    worst.push_back(std::move(out));
  }
  for (const inspect::DrawnPlace& place : e.drawn) {
    Json rows = Json::array();
    for (const inspect::DrawnEdge& row : place.rows) {
      Json out;
      for (const auto& [name, member] : columns_of_drawn_edge) out[name] = number(row.*member);
      out["valid"] = row.valid;
      rows.push_back(std::move(out));
    }
    drawn.push_back({{"crack", edge_crack(place.crack)},
                     {"verdict", word(place.verdict)},
                     {"reason", place.reason},
                     {"rows", std::move(rows)}});
  }
  Json out = {{"length", number(e.length)}};
  if (e.angle) out["angle_deg"] = number(*e.angle * 180 / pi);
  out["friction"] = number(e.friction);
  out["pressurized"] = e.pressurized;
  out["places"] = e.places;
  out["masked_share"] = number(e.masked_share);
  for (std::size_t i = 0; i < e.masked_by.size(); ++i)
    out["masked_by"][std::string(word(inspect::reasons_to_mask[i]))] = number(e.masked_by[i]);
  out["asked"] = e.asked;
  out["worst"] = std::move(worst);
  out["inside"] = std::move(inside);
  if (!e.law.empty()) {
    out["law"] = e.law;
    out["factor"] = number(e.factor);
    if (e.safe) out["shortest_critical"] = placed(*e.safe);
    out["open_share"] = number(e.open_share);
  }
  if (!drawn.empty()) out["drawn"] = std::move(drawn);
  return out;
}

Json bounded(const Bounded& b) {
  Json out = {
      {"value", number(b.value)}, {"lower", number(b.lower)}, {"upper", number(b.upper)}, {"guaranteed", b.guaranteed}};
  if (!b.note.empty()) out["note"] = b.note;
  return out;
}

Json bounded_mean(const BoundedMean& m) {
  Json out = m.of == BoundedMean::Of::Disc   ? Json{{"center", place_of(m.from)}, {"radius", number(m.radius)}}
             : m.of == BoundedMean::Of::Line ? Json{{"from", place_of(m.from)}, {"to", place_of(m.to)}}
                                             : Json{{"on", m.on}};
  const std::span<const NamedQuantity> names = quantities_of(m.of);
  for (std::size_t i = 0; i < m.quantities.size(); ++i) out[std::string(names[i].name)] = bounded(m.quantities[i]);
  return out;
}

Json bounds_section(const BoundsResult& bounds) {
  Json out = {{"tips", Json::array()}, {"points", Json::array()}};
  for (const BoundedTip& t : bounds.tips)
    out["tips"].push_back({{"crack", t.crack},
                           {"tip", t.at_start ? "start" : "end"},
                           {"at", place_of(t.at)},
                           {"K_I", bounded(t.K_I)},
                           {"K_II", bounded(t.K_II)},
                           {"G", bounded(t.G)}});
  for (const BoundedPoint& p : bounds.points)
    out["points"].push_back({{"at", place_of(p.at)},
                             {"s_xx", bounded(p.s_xx)},
                             {"s_yy", bounded(p.s_yy)},
                             {"s_xy", bounded(p.s_xy)},
                             {"von_mises", bounded(p.von_mises)},
                             {"topological_derivative", bounded(p.derivative)}});
  for (const auto& [of, list] : bounded_lists) out[list] = Json::array();
  for (const BoundedMean& m : bounds.means) {
    if (m.of == BoundedMean::Of::Loads) {
      out["compliance"] = bounded(m.quantities[0]);
      continue;
    }
    Json& list = out[std::ranges::find(bounded_lists, m.of, [](const auto& l) { return l.first; })->second];
    list.push_back(bounded_mean(m));
  }
  return out;
}

Json functional_section(const FunctionalResult& functional) {
  Json out = {{"kind", functional.kind}, {"value", number(functional.value)}};
  for (const auto& term : functional.terms)
    out["terms"].push_back({{"kind", term.kind}, {"factor", number(term.factor)}, {"value", number(term.value)}});
  return out;
}

Json map_section(const MapResult& map) {
  Json points = Json::array();
  for (const MapPoint& p : map.points) {
    const Json angle = map.oriented && std::isfinite(p.value) ? number(degrees(p.angle)) : Json(nullptr);
    points.push_back({{"at", place_of(p.at)},
                      {"value", number(p.value)},
                      {"lower", number(p.lower)},
                      {"upper", number(p.upper)},
                      {"c2", number(p.c2)},
                      {"valid_radius", number(p.valid_radius)},
                      {"masked", p.masked},
                      {"angle_deg", angle}});
  }
  return {{"perturbation", map.perturbation},
          {"min", placed(map.min)},
          {"max", placed(map.max)},
          {"points", std::move(points)},
          {"excluded_radius", number(map.excluded_radius)},
          {"radius", number(map.radius)},
          {"masked_share", number(map.masked_share)},
          {"biactive_length", number(map.biactive_length)}};
}

Json validate_section(const ValidationResult& validation) {
  Json points = Json::array();
  for (const Validation& v : validation.points) {
    Json rows = Json::array(), modes = Json::object();
    for (const Mode& m : v.modes) modes[m.name] = number(m.value);
    for (const ValidationRow& row : v.rows)
      rows.push_back({{"radius", number(row.radius)},
                      {"J", number(row.J)},
                      {"difference", number(row.difference)},
                      {"predicted", number(row.predicted)},
                      {"remainder", number(row.remainder)},
                      {"order", number(row.order)},
                      {"same_contact", row.same_contact},
                      {"predicted_second", number(row.predicted_second)},
                      {"remainder_second", number(row.remainder_second)},
                      {"order_second", number(row.order_second)}});
    points.push_back({{"at", place_of(v.at)},
                      {"perturbation", validation.perturbation},
                      {"coefficient", number(v.coefficient)},
                      {"order", number(v.order)},
                      {"verdict", std::string(word(v.verdict))},
                      {"rows", std::move(rows)},
                      {"reason", v.reason},
                      {"intercept", number(v.intercept)},
                      {"plateau", number(v.plateau)},
                      {"c2", number(v.c2)},
                      {"c3", number(v.c3)},
                      {"c4", number(v.c4)},
                      {"c2_predicted", number(v.c2_predicted)},
                      {"c2_on_mesh", number(v.c2_on_mesh)},
                      {"order_second", number(v.order_second)},
                      {"logarithm", std::string(word(v.logarithm))},
                      {"on_mesh", number(v.on_mesh)},
                      {"bar", number(v.bar)},
                      {"independent",
                       {{"radius", number(v.drawn.radius)},
                        {"difference", number(v.drawn.difference)},
                        {"formula", number(v.drawn.coefficient)},
                        {"intercept", number(v.drawn.intercept)}}},
                      {"modes", std::move(modes)}});
  }
  return points;
}

Json numbers_of(const Eigen::VectorXd& x) {
  Json out = Json::array();
  for (const double value : x) out.push_back(number(value));
  return out;
}

Json identified_section(const std::vector<Identified>& all) {
  Json out = Json::array();
  for (const Identified& i : all)
    out.push_back({{"name", i.name},
                   {"found", numbers_of(i.found)},
                   {"truth", i.truth},
                   {"exact", numbers_of(i.exact)},
                   {"position_error", i.truth.empty() ? Json(nullptr) : number(i.position_error)},
                   {"size_error", i.truth.empty() ? Json(nullptr) : number(i.size_error)}});
  return out;
}

Json fit_section(const LeastSquares& fit, const OptimizeNames& names) {
  Json out = {{"readings", fit.readings},
              {"start", number(fit.start)},
              {"end", number(fit.end)},
              {"noise", number(fit.noise)},
              {"estimated", fit.estimated},
              {"steps", fit.steps},
              {"state_solves", fit.state_solves},
              {"optimality", number(fit.optimality)},
              {"stopped", fit.stopped},
              {"verdict", word(fit.verdict)},
              {"gain", number(fit.gain)},
              {"rank", rank_of(fit)},
              {"unknowns", fit.combinations.size()}};
  if (std::isfinite(fit.most)) {
    const double unit = fit.noise * fit.noise * fit.readings, n = fit.readings;
    out["chi_square"] = {{"per_reading", number(fit.end / unit)},
                         {"expected", {number(fit.expected[0] / n), number(fit.expected[1] / n)}},
                         {"at_most", number(fit.most / n)},
                         {"finer", number(fit.finer / unit)},
                         {"mesh", number(fit.mesh / unit)}};
  }
  for (const Combination& c : fit.combinations)
    out["combinations"].push_back(
        {{"weights", numbers_of(c.weights)}, {"deviation", number(c.deviation)}, {"fixed", c.fixed}});
  for (Eigen::Index i = 0; i < fit.variables.size(); ++i)
    out["variables"].push_back({{"name", names.variables.at(static_cast<std::size_t>(i))},
                                {"value", number(fit.variables[i])},
                                {"deviation", number(deviation_of(fit, i))}});
  for (Eigen::Index i = 0; i < fit.covariance.rows(); ++i)
    out["covariance"].push_back(numbers_of(fit.covariance.row(i).transpose()));
  for (const UncertaintyEllipse& e : fit.ellipses)
    out["ellipses"].push_back({{"name", e.name},
                               {"at", place_of(e.at)},
                               {"semi_axes", place_of(e.semi_axes)},
                               {"angle_deg", number(e.angle * 180 / pi)},
                               {"probability", 0.95}});
  return out;
}

Json count_section(const Count& count) {
  Json out = {{"count", count.tried.at(count.chosen).count},
              {"chosen", count.chosen},
              {"things", count.things},
              {"tried", Json::array()}};
  for (const Counted& one : count.tried) {
    Json row = {{"count", one.count},
                {"of", one.of},
                {"unknowns", one.variables},
                {"criterion", number(one.criterion)},
                {"aicc", number(one.aicc)},
                {"readings", one.fit.readings},
                {"noise", number(one.fit.noise)},
                {"estimated", one.fit.estimated},
                {"squares", number(one.fit.end)},
                {"variables", numbers_of(one.fit.variables)}};
    if (!one.failure.empty()) row["failure"] = one.failure;
    out["tried"].push_back(std::move(row));
  }
  return out;
}

Json starts_section(const std::vector<StartTried>& starts) {
  Json out = Json::array();
  for (const StartTried& t : starts) {
    Json row = {{"from", numbers_of(t.from)},       {"reached", numbers_of(t.variables)}, {"merit", number(t.merit)},
                {"violation", number(t.violation)}, {"state_solves", t.state_solves},     {"in_full", t.in_full}};
    if (t.end > 0) row["end"] = t.end;
    if (!t.failure.empty()) row["failure"] = t.failure;
    out.push_back(std::move(row));
  }
  return out;
}

/// Of a bound on a stress or a release rate.
void add_interval(Json& row, const Bounded& b) {
  if (std::isfinite(b.upper)) {
    row["lower"] = number(b.lower);
    row["upper"] = number(b.upper);
    row["guaranteed"] = b.guaranteed;
  }
  if (!b.note.empty()) row["note"] = b.note;
}

Json nucleated_section(const std::vector<NucleatedHole>& holes) {
  Json out = Json::array();
  for (const NucleatedHole& h : holes) {
    Json row = {{"iteration", h.iteration}, {"at", place_of(h.at)}};
    const auto add = [&](const char* key, double value) {
      if (std::isfinite(value)) row[key] = number(value);
    };
    add("radius", h.radius);
    add("topological_derivative", h.T);
    add("c2", h.c2);
    add("predicted", h.predicted);
    add("actual", h.actual);
    if (!h.note.empty()) row["note"] = h.note;
    out.push_back(std::move(row));
  }
  return out;
}

Json finer_section(const FinerDesign& finer, const OptimizeNames& names) {
  Json out = {{"size", number(finer.size)},           {"element", finer.element.name},
              {"degree", finer.element.degree},       {"curved", finer.curved},
              {"objective", number(finer.objective)}, {"volume_fraction", number(finer.volume_fraction)},
              {"violation", number(finer.violation)}};
  for (std::size_t i = 0; i < std::min(names.bounds.size(), finer.bounds.size()); ++i) {
    Json row = {{"name", names.bounds[i]}, {"value", number(finer.bounds[i])}};
    if (i < finer.intervals.size()) add_interval(row, finer.intervals[i]);
    out["bounds"].push_back(std::move(row));
  }
  if (std::isfinite(finer.residual)) out["residual"] = number(finer.residual);
  if (!finer.failure.empty()) out["failure"] = finer.failure;
  return out;
}

Json constraints_section(const std::vector<KeptConstraint>& all) {
  Json out = Json::array();
  for (const KeptConstraint& c : all) {
    Json row = {{"name", c.name}, {"asked", number(c.asked)}, {"got", number(c.got)}, {"kept", c.kept}};
    if (c.at) row["at"] = place_of(*c.at);
    if (!c.note.empty()) row["note"] = c.note;
    out.push_back(std::move(row));
  }
  return out;
}

Json gain_section(const GainLeft& gain) {
  Json out = {{"shape", number(gain.shape)}, {"hole", number(gain.hole.gain)}, {"bump", number(gain.bump.gain)}};
  const auto place = [&](const BestChange& change, const char* name) {
    if (change.gain > 0) out[name] = {{"at", place_of(change.at)}, {"radius", number(change.radius)}};
  };
  place(gain.hole, "best_hole");
  place(gain.bump, "best_bump");
  return out;
}

Json optimize_section(const OptimizeResult& o, const OptimizeNames& names) {
  Json out = {{"method", word(o.method)},
              {"iterations", o.iterations},
              {"state_solves", o.state_solves},
              {"objective", number(o.objective)},
              {"volume_fraction", number(o.volume_fraction)},
              {"feasible", o.feasible},
              {"stopped", o.stopped},
              {"ending", verdict_of(o)},
              {"converged", o.ending == Ending::Optimal || o.ending == Ending::OptimalWithin},
              {"optimality", number(o.optimality)}};
  if (names.volume_at_most) out["volume_at_most"] = number(*names.volume_at_most);
  if (!o.constraints.empty()) out["constraints"] = constraints_section(o.constraints);
  if (std::isfinite(o.holes.least)) {
    out["hole_margin"] = {{"least", number(o.holes.least)}, {"at", place_of(o.holes.at)}};
    if (o.holes.proof) out["hole_margin"]["proof"] = word(*o.holes.proof);
  }
  if (std::isfinite(o.bumps.least))
    out["bump_margin"] = {{"least", number(o.bumps.least)}, {"at", place_of(o.bumps.at)}};
  if (o.method == OptimizeMethod::LevelSet) out["gain"] = gain_section(o.gain);
  if (o.finer.size > 0) out["finer"] = finer_section(o.finer, names);
  if (!o.history.empty()) {
    const Iteration &first = o.history.front(), &last = o.history.back();
    out["start"] = {{"objective", number(first.objective)}, {"volume_fraction", number(first.volume_fraction)}};
    out["merit"] = number(last.merit);
    out["violation"] = number(last.violation);
    out["holes"] = last.holes;
    out["triangles"] = last.triangles;
    for (std::size_t i = 0; i < std::min(names.bounds.size(), last.bounds.size()); ++i)
      out["bounds"].push_back(
          {{"name", names.bounds[i]}, {"value", number(last.bounds[i])}, {"at_most", number(names.at_most[i])}});
  }
  for (std::size_t i = 0; i < std::min(names.variables.size(), static_cast<std::size_t>(o.variables.size())); ++i)
    out["variables"].push_back(
        {{"name", names.variables[i]}, {"value", number(o.variables[static_cast<Eigen::Index>(i)])}});
  if (!o.starts.empty()) out["starts"] = starts_section(o.starts);
  if (!o.nucleated.empty()) out["nucleated"] = nucleated_section(o.nucleated);
  if (!o.notes.empty()) out["notes"] = o.notes;
  return out;
}

Json time_section(const Seconds& s) {
  Json out = Json::object();
  for (const TimedPhase& phase : timed_phases)
    if (phase.always || s.*phase.of > 0) out[phase.name] = number(s.*phase.of);
  out["total"] = number(s.total);
  return out;
}

}  // namespace

void write_json(const std::filesystem::path& path, const Result& result, Flush flush) {
  Json out = {{"schema", 1}, {"version", result.version}, {"case", result.case_name}, {"status", result.status}};
  if (result.units.given()) out["units"] = units_section(result);
  if (result.triangles > 0) out["mesh"] = mesh_section(result);
  if (result.state) out["state"] = state_section(*result.state);
  if (const auto& s = result.solver; s && result.state && s->parts == 1)
    out["state"]["solver"] = {
        {"backend", "cholmod"}, {"precision", "single"}, {"solves", s->solves}, {"iterations", s->iterations}};
  else if (s && result.state)
    out["state"]["solver"] = {{"backend", "petsc"},
                              {"parts", s->parts},
                              {"solves", s->solves},
                              {"iterations", s->iterations},
                              {"condition", number(s->condition)},
                              {"interface_unknowns", s->interface_unknowns},
                              {"primal_unknowns", s->primal_unknowns},
                              {"bytes_per_iteration", number(s->sent)},
                              {"peak_memory_mb", {number(s->first_mb), number(s->others_mb)}}};
  for (const LoadCaseResult& c : result.load_cases) out["load_cases"].push_back(load_case_section(c));
  if (result.contact) out["contact"] = contact_section(*result.contact);
  for (const CrackResult& crack : result.cracks) out["cracks"].push_back(crack_section(crack));
  for (const StepResult& step : result.steps) out["steps"].push_back(step_section(step));
  if (result.bounds) out["bounds"] = bounds_section(*result.bounds);
  if (result.growth) out["grow"] = growth_section(*result.growth);
  if (result.functional) out["functional"] = functional_section(*result.functional);
  if (result.map) out["map"] = map_section(*result.map);
  if (result.edge_cracks) {
    out["edge_cracks"] = edge_cracks_section(*result.edge_cracks);
    out["inspect"] = inspect_section(*result.edge_cracks);
  }
  if (result.validate) out["validate"] = validate_section(*result.validate);
  if (result.optimize) out["optimize"] = optimize_section(*result.optimize, result.optimize_names);
  if (result.fit) out["optimize"]["least_squares"] = fit_section(*result.fit, result.optimize_names);
  if (result.counted) out["optimize"]["defects"] = count_section(*result.counted);
  if (!result.identified.empty()) out["optimize"]["identified"] = identified_section(result.identified);
  out["time_s"] = time_section(result.seconds);
  out["peak_memory_mb"] = number(result.peak_memory_mb);
  if (!result.title.empty()) out["title"] = result.title;
  if (result.reason) out["reason"] = *result.reason;
  // Names come from users: bytes that are no UTF-8 are replaced, not thrown about.
  write_file(path, out.dump(2, ' ', false, Json::error_handler_t::replace) + '\n', flush);
}

}  // namespace kerf
