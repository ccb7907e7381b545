// What results and pictures take from a state: profiles, tips, resultants, peaks and maps at corners. Values at corners
// are those of the recovered fields, with a corner for each face of a crack. A crack's result sums lengths by the
// status of its points; a transition lies half way between two points of different status. Beside a closed tip false
// tension may open up to half an edge: it counts as closed. A crack that changes between open and closed often, by less
// than 1e-3 of what the mean stress of the body could cause, gets a note, since derivatives then depend on the mesh:
// the measure is
//   max(int |p| ds, E' / length int |gap| ds) / (length mean stress).
// Extrema of a map leave out corners for no stronger reason than is needed to have any.

#include "app/run/collect.hpp"

#include "io/validation.hpp"
#include "kerf/case_file.hpp"
#include "kerf/fracture.hpp"
#include "solver/half_cracks.hpp"
#include "solver/history.hpp"
#include "solver/recovery.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

PlotData plot_corners(const Model& model) {
  PlotData d{.corners = split_for_stress(model.mesh)};
  for (const Index v : d.corners.vertex) d.points.push_back(model.mesh.points[v]);
  return d;
}

PlotData plot_data(const Model& model, const Field& state, bool plane_strain) {
  PlotData d = plot_corners(model);
  const std::vector<Material> materials = corner_materials(model, d.corners);
  d.values = corner_values(model, state, d.corners);
  const Eigen::RowVectorXd e33 = corner_eigenstrains(model, d.corners).row(4);
  d.von_mises.resize(d.values.stress.cols());
  for (Eigen::Index i = 0; i < d.von_mises.size(); ++i)
    d.von_mises[i] = von_mises(materials[i], plane_strain, d.values.stress.col(i), e33[i]);
  return d;
}

SolverResult solver_result(const SolverEffort& e) {
  return {e.parts, e.solves, e.iterations, e.condition, e.interface_rows, e.primal, e.sent, e.first_mb, e.other_mb};
}

void add_energy_bounds(const EnergyBounds& bounds, StateResult& state) {
  if (std::isfinite(bounds.lower) && std::isfinite(bounds.upper)) state.energy_bounds = {bounds.lower, bounds.upper};
  if (!bounds.note.empty()) state.notes.push_back(bounds.note);
}

namespace {

/// Where faces begin or cease to touch, and where faces in contact that resist sliding begin or cease to slide.
std::vector<CrackResult::Transition> transitions(const std::vector<CrackPoint>& profile,
                                                 const std::vector<double>& slip, const CrackLaw& law) {
  double most = 0;
  for (const double s : slip) most = std::max(most, std::abs(s));
  const auto closed = [](const CrackPoint& p) { return p.status == CrackPoint::Status::Closed; };
  // Held rows have no jump; the smooth domain's solver knows it up to rounding.
  const auto sticks = [&](std::size_t i) { return std::abs(slip[i]) <= 1e-9 * most; };
  std::vector<CrackResult::Transition> found;
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const CrackPoint &before = profile[i - 1], &here = profile[i];
    const Vec2 at = 0.5 * (before.at + here.at);
    if (closed(before) != closed(here))
      found.push_back({at, closed(before) ? "closed" : "open", closed(here) ? "closed" : "open"});
    else if (has_friction(law) && closed(here) && sticks(i - 1) != sticks(i))
      found.push_back({at, sticks(i - 1) ? "stick" : "slip", sticks(i) ? "stick" : "slip"});
  }
  return found;
}

}  // namespace

namespace {

/// Where false tension beside a closed tip has opened no more than half an edge, it is closed there.
std::vector<CrackPoint> settled(std::vector<CrackPoint> profile, const CrackEnds& ends) {
  const std::size_t n = profile.size();
  for (const bool start : {true, false}) {
    if (!ends.tips[start ? 0 : 1] || n <= ends.per_edge) continue;
    const auto from_tip = [&](std::size_t i) -> CrackPoint& { return profile[start ? i : n - 1 - i]; };
    const auto is_open = [](const CrackPoint& p) { return p.status == CrackPoint::Status::Open && !(p.gap > 0); };
    double edge = 0, open = 0;
    for (std::size_t i = 0; i < ends.per_edge; ++i) edge += from_tip(i).length;
    std::size_t count = 0;
    while (count < ends.per_edge && is_open(from_tip(count))) open += from_tip(count++).length;
    constexpr double half = 0.5 + 1e-9;
    if (open > half * edge || from_tip(count).status != CrackPoint::Status::Closed) continue;
    for (std::size_t i = 0; i < count; ++i) from_tip(i).status = CrackPoint::Status::Closed;
  }
  return profile;
}

}  // namespace

CrackResult crack_result(const std::string& name, const CrackLaw& law, const std::vector<CrackPoint>& of,
                         const std::vector<double>& slip, const CrackEnds& ends) {
  const bool touches = is_unilateral(law);
  const std::vector<CrackPoint> profile = touches ? settled(of, ends) : of;
  CrackResult r;
  r.name = name;
  double most = 0;  // of the fluid
  for (const CrackPoint& p : profile) {
    const bool closed = p.status == CrackPoint::Status::Closed;
    r.length += p.length;
    (closed ? r.closed_length : p.status == CrackPoint::Status::Open ? r.open_length : r.biactive_length) += p.length;
    if (!closed) r.max_opening = std::max(r.max_opening, p.distance());
    if (p.status == CrackPoint::Status::Open) r.penetration = std::max(r.penetration, -p.distance());
    r.max_pressure = std::max(r.max_pressure, p.contact_pressure());
    if (std::abs(p.fluid_pressure) > std::abs(most)) most = p.fluid_pressure;
    r.rows.push_back({p.s, p.at, p.jump_n, p.jump_t, p.sigma_n, p.sigma_t, closed, p.fluid_pressure, p.gap});
  }
  if (has_pressure(law)) r.fluid_pressure = most;
  r.has_gap = has_gap(law);
  r.transitions = transitions(profile, slip, law);
  if (!is_unilateral(law)) r.open_length = r.closed_length = r.biactive_length = 0;
  return r;
}

TipResult tip_result(const TipIntensity& t) {
  TipResult tip{.at = t.at};
  if (t.on_border) tip.note = "on a border between materials: no K here";
  if (!std::isfinite(t.K_I)) return tip;
  tip.K_I = t.K_I, tip.K_II = t.K_II, tip.G = t.G;
  if (std::isfinite(t.T)) tip.T = t.T;
  tip.spread = {t.spread_K_I, t.spread_K_II, t.spread_T};
  return tip;
}

namespace {

/// The label, with a number where that is taken.
std::string unused_name(const std::string& label, const std::vector<CrackResult>& others) {
  std::string name = label;
  for (char& c : name)
    if (c == ':') c = '_';  // of a hole; names are those of files, too
  const std::string first = name;
  for (int k = 2; std::ranges::find(others, name, &CrackResult::name) != others.end(); ++k)
    name = fmt::format("{}.{}", first, k);
  return name;
}

}  // namespace

void add_half_cracks(const Model& model, const State& state, const Shape& shape, std::span<const Index> planes,
                     bool with_tips, std::vector<CrackResult>& results) {
  const std::vector<HalfCrack> halves = half_cracks(model.mesh, model.scene, planes);
  std::vector<TipIntensity> tips;
  if (with_tips) tips = half_crack_tips(model, state, halves);
  for (std::size_t k = 0; k < halves.size(); ++k) {
    const HalfCrack& half = halves[k];
    const Index label = half.label[half.tips[0] ? 0 : 1];
    CrackLaw law{.kind = CrackLaw::Kind::Open};
    const std::vector<CrackPoint> profile = half_profile(model, state, half);
    if (std::ranges::any_of(profile, [](const CrackPoint& p) { return p.fluid_pressure != 0; }))
      law.pressure = [](const Vec2&, const Vec2&) { return Vec2(0, 0); };  // it has one: that of the profile
    CrackResult r = crack_result(unused_name(shape.labels[static_cast<std::size_t>(label)], results), law, profile, {},
                                 {half.tips, profile.size() / half.edges.size()});
    r.half = true;
    for (const TipIntensity& t : tips)
      if (t.crack == static_cast<Index>(k)) r.tips.push_back(tip_result(t));
    results.push_back(std::move(r));
  }
}

namespace {

constexpr std::size_t often = 5;  // an open middle and two open ends change four times

std::size_t turns_of(const CrackResult& crack) {
  return static_cast<std::size_t>(std::ranges::count_if(
      crack.transitions, [](const CrackResult::Transition& t) { return t.from == "open" || t.to == "open"; }));
}

}  // namespace

bool turn_often(const std::vector<CrackResult>& cracks) {
  return std::ranges::any_of(cracks, [](const CrackResult& crack) { return turns_of(crack) >= often; });
}

std::vector<std::string> notes_on_contact(const std::vector<CrackResult>& cracks, const Model& body,
                                          const ContactMeasures& of) {
  constexpr double little = 1e-3;
  std::vector<std::string> notes;
  for (std::size_t c = 0; c < cracks.size(); ++c) {
    const CrackResult& crack = cracks[c];
    const std::size_t turns = turns_of(crack);
    if (turns < often) continue;
    // Means along the crack: at its tips what a mesh errs by is singular, too.
    double pressure = 0, gap = 0;
    for (const CrackPoint& p : of.profiles[c]) {
      pressure += p.length * std::abs(p.contact_pressure());
      gap += p.length * std::abs(p.distance());
    }
    const double share = std::max(pressure, gap * modulus_beside(body, static_cast<Index>(c)) / crack.length) /
                         (crack.length * of.stress);
    if (share < little)
      notes.push_back(fmt::format(
          "crack \"{}\" touches and opens in turn, {} times, by {:.1g} of what the stress in the body could "
          "cause: that little may be what the mesh errs by. Derivatives of all that sees its contact (every functional "
          "but energies) then hang on the mesh: compare with a smaller mesh.size, give it loads that open or close it, "
          "or contact = \"open\" or \"bonded\"",
          crack.name, turns, share));
  }
  return notes;
}

ContactResultSummary contact_result(const State& state, ContactMethod method, const std::vector<CrackResult>& cracks) {
  ContactResultSummary r{.method = std::string(word(method)),
                         .iterations = state.contact_iterations,
                         .linear_solves = state.linear_solves,
                         .kkt = state.certificate.kkt};
  for (const CrackResult& c : cracks) {
    r.open_length += c.open_length;
    r.closed_length += c.closed_length;
    r.biactive_length += c.biactive_length;
  }
  return r;
}

FunctionalResult functional_result(const Functional& j, const Analysis& analysis) {
  FunctionalResult r{j.kind, analysis.value};
  if (j.sum)
    for (std::size_t i = 0; i < j.terms.size(); ++i)
      r.terms.push_back({j.terms[i].kind, j.terms[i].factor, analysis.term_value.at(i)});
  return r;
}

bool is_everywhere(const FullMap& map) {
  return map.at_centroids.size() > 0;
}

std::vector<NamedField> state_fields(const Model& model, const State& state, const PlotData& data,
                                     const Indicator& indicator) {
  const Eigen::Index n = data.values.stress.cols(), cells = state.interior.cols();
  Eigen::MatrixXd symmetric(3, n), first(1, n), second(1, n), raw(4, cells);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector4d s = data.values.stress.col(i);
    const PrincipalStresses principal = principal_stresses(s);
    symmetric.col(i) = symmetric_part(s);
    first(0, i) = principal.first;
    second(0, i) = principal.second;
  }
  for (Index t = 0; t < static_cast<Index>(cells); ++t) {
    const Eigen::Vector4d s =
        stress_at(model.inner->kernel, triangle(model, t), state.interior.col(t), centroid(model.mesh, t));
    raw.col(t) << s[0], s[3], s[1], s[2];
  }
  std::vector<NamedField> fields{{"u", false, data.values.displacement},
                                 {"sigma", false, symmetric},
                                 {"von_mises", false, data.von_mises.transpose()},
                                 {"principal_stress_1", false, first},
                                 {"principal_stress_2", false, second},
                                 {"gamma", false, data.values.rotation},
                                 {"sigma_raw", true, raw}};
  if (indicator.eta.size() > 0) fields.push_back({"error_indicator", true, indicator.eta.transpose()});
  if (!model.mesh.region.empty()) {
    Eigen::MatrixXd region(1, cells);
    for (Index t = 0; t < static_cast<Index>(cells); ++t) region(0, t) = 1 + model.mesh.region[t];
    fields.push_back({"region", true, std::move(region)});
  }
  return fields;
}

std::vector<NamedField> design_fields(const Model& model, const PlotData& data) {
  const Eigen::Index n = data.values.stress.cols();
  Eigen::MatrixXd symmetric(3, n);
  for (Eigen::Index i = 0; i < n; ++i) symmetric.col(i) = symmetric_part(data.values.stress.col(i));
  std::vector<NamedField> fields{{"u", false, data.values.displacement},
                                 {"sigma", false, std::move(symmetric)},
                                 {"von_mises", false, data.von_mises.transpose()}};
  if (!model.mesh.region.empty()) {
    Eigen::MatrixXd region(1, static_cast<Eigen::Index>(model.mesh.region.size()));
    for (std::size_t t = 0; t < model.mesh.region.size(); ++t)
      region(0, static_cast<Eigen::Index>(t)) = 1 + model.mesh.region[t];
    fields.push_back({"region", true, std::move(region)});
  }
  return fields;
}

std::size_t held(const std::vector<Vec2>& points, const Corners& corners, const std::vector<NamedField>& fields) {
  std::size_t bytes = points.size() * sizeof(Vec2) + corners.of.size() * sizeof corners.of[0];
  for (const NamedField& field : fields) bytes += sizeof(double) * static_cast<std::size_t>(field.values.size());
  return bytes;
}

std::vector<NamedField> crack_fields(const CrackResult& crack) {
  const Eigen::Index n = static_cast<Eigen::Index>(crack.rows.size());
  std::vector<NamedField> fields;
  const auto add = [&](const char* name, auto value) {
    Eigen::MatrixXd row(1, n);
    for (Eigen::Index i = 0; i < n; ++i) row(0, i) = value(crack.rows[static_cast<std::size_t>(i)]);
    fields.push_back({name, false, std::move(row)});
  };
  add("s", [](const CrackRow& r) { return r.s; });
  add("jump_n", [](const CrackRow& r) { return r.jump_n; });
  add("jump_t", [](const CrackRow& r) { return r.jump_t; });
  add("sigma_n", [](const CrackRow& r) { return r.sigma_n; });
  add("sigma_t", [](const CrackRow& r) { return r.sigma_t; });
  add("contact_status", [](const CrackRow& r) { return r.closed ? 1.0 : 0.0; });
  if (crack.fluid_pressure) add("fluid_pressure", [](const CrackRow& r) { return r.fluid_pressure; });
  if (crack.has_gap) add("gap", [](const CrackRow& r) { return r.gap; });
  return fields;
}

}  // namespace kerf
