// result.json and the tables beside it, read back: the mirror of result.cpp, section by section. null and what is not
// there become NaN, an empty optional or a default; a section of the wrong form is "damaged". Words become values of
// enums by the same tables that write them. Rows of cracks come from crack_NAME.csv, whose name is checked before it
// becomes a part of a path, and the history of an optimization from history.csv. Not in the files, and so not read:
// designs of counted defects, fields.

#include "io/read_result.hpp"
#include "io/words.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

#include "io/growth_columns.hpp"
#include "io/result/bounded_json.hpp"
#include "io/result/edge_crack_columns.hpp"
#include "io/result/read_tables.hpp"

namespace kerf {

namespace {

using Json = nlohmann::ordered_json;

/// null, or nothing: not a number.
double read_number(const Json& from, const char* key) {
  const auto found = from.find(key);
  return found == from.end() || found->is_null() ? nan : found->get<double>();
}
double read_number(const Json& value) {
  return value.is_null() ? nan : value.get<double>();
}
std::optional<double> maybe(const Json& from, const char* key) {
  const auto found = from.find(key);
  return found == from.end() || found->is_null() ? std::nullopt : std::optional(found->get<double>());
}
/// What no result has, though it is JSON.
struct Damage {};
/// A whole number.
int whole(const Json& from, const char* key, int otherwise = 0) {
  const double value = from.value(key, static_cast<double>(otherwise));
  if (!(std::abs(value) <= std::numeric_limits<int>::max()) || value != std::floor(value)) throw Damage();
  return static_cast<int>(value);
}
std::string text(const Json& from, const char* key) {
  return from.value(key, std::string());
}
std::vector<std::string> texts(const Json& from, const char* key) {
  return from.value(key, std::vector<std::string>());
}
/// An empty array where there is none.
const Json& list(const Json& from, const char* key) {
  static const Json none_there = Json::array();
  const auto found = from.find(key);
  return found == from.end() || found->is_null() ? none_there : *found;
}

Vec2 read_place(const Json& at) {
  return {read_number(at.at(0)), read_number(at.at(1))};
}
PlacedValue read_placed(const Json& value) {
  return {read_place(value.at("at")), read_number(value, "value"), maybe(value, "margin")};
}
Peak peak(const Json& from) {
  Peak out{read_placed(from), from.value("singular", false), std::nullopt};
  if (from.contains("regular") && !from["regular"].is_null()) out.regular = read_placed(from["regular"]);
  return out;
}
ResultantResult read_resultant(const Json& from) {
  return {text(from, "on"), read_place(from.at("force")), read_number(from, "moment")};
}
Eigen::VectorXd numbers(const Json& from) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(from.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = read_number(from[static_cast<std::size_t>(i)]);
  return out;
}

/// The one whose word it is; the first where there is none.
template <typename T, std::size_t n>
T from_word(const std::array<std::string_view, n>& words, const std::string& word) {
  for (std::size_t i = 0; i < n; ++i)
    if (words[i] == word) return static_cast<T>(i);
  return T{};
}
std::vector<ReserveResult> read_reserves(const Json& from) {
  std::vector<ReserveResult> out;
  if (!from.contains("reserve")) return out;
  for (const Json& r : from["reserve"])
    out.push_back({from_word<ReserveResult::Of>(reserve_words, text(r, "of")), read_number(r, "value"),
                   read_number(r, "limit"), read_number(r, "factor"), read_place(r.at("at")), text(r, "region"),
                   text(r, "crack")});
  return out;
}
Verdict verdict(const std::string& said) {
  for (const Verdict v : {Verdict::Holds, Verdict::Fails, Verdict::Vanishes, Verdict::OutOfRange})
    if (word(v) == said) return v;
  return Verdict::NothingSaid;
}

void read_mesh(const Json& from, Result& r) {
  r.triangles = whole(from, "triangles");
  r.vertices = whole(from, "vertices");
  r.mesh = {read_number(from, "h_min"), read_number(from, "h_max"), read_number(from, "min_angle_deg"),
            read_number(from, "mean_quality")};
  if (!from.contains("adapt")) return;
  r.adapt = AdaptResult{{}, text(from["adapt"], "stopped"), text(from["adapt"], "of")};
  for (const Json& round : from["adapt"].at("rounds"))
    r.adapt->rounds.emplace_back(whole(round, "triangles"), read_number(round, "estimated_error"));
}

StateResult state(const Json& from) {
  StateResult s;
  s.element = text(from, "element");
  s.degree = whole(from, "degree", 1);
  s.unknowns = whole(from, "unknowns");
  s.condensed_unknowns = whole(from, "condensed_unknowns");
  s.residual = read_number(from, "residual");
  s.work_error = read_number(from, "work_error");
  s.energy = read_number(from, "energy");
  s.compliance = read_number(from, "compliance");
  s.area = read_number(from, "area");
  s.estimated_error = maybe(from, "estimated_error");
  if (const Json& bounds = list(from, "energy_bounds"); bounds.size() == 2)
    s.energy_bounds = {read_number(bounds[0]), read_number(bounds[1])};
  s.of_polygon = text(from, "energy_bounds_of") == "polygon";
  s.notes = texts(from, "notes");
  if (from.contains("max_von_mises")) s.von_mises = peak(from["max_von_mises"]);
  if (from.contains("max_displacement")) s.displacement = Peak{read_placed(from["max_displacement"])};
  if (from.contains("resultants")) {
    const Json& all = from["resultants"];
    for (const Json& r : list(all, "loads")) s.loads.push_back(read_resultant(r));
    for (const Json& r : list(all, "reactions")) s.reactions.push_back(read_resultant(r));
    if (all.contains("body")) s.body = read_resultant(all["body"]);
    if (all.contains("balance")) s.balance = read_resultant(all["balance"]);
    if (all.contains("patches"))
      for (const Json& p : all["patches"])
        s.patches.push_back({text(p, "on"), read_place(p.at("at")), read_number(p, "width"), read_place(p.at("force")),
                             read_number(p, "mean_stress"), maybe(p, "displacement_change")});
  }
  if (from.contains("plate")) s.thickness = read_number(from["plate"], "thickness");
  s.load_case = text(from, "load_case");
  s.reserves = read_reserves(from);
  return s;
}

LoadCaseResult load_case(const Json& from) {
  LoadCaseResult c{text(from, "name"), read_number(from, "weight"), read_number(from, "energy"),
                   read_number(from, "compliance")};
  if (from.contains("max_von_mises")) c.von_mises = peak(from["max_von_mises"]);
  if (from.contains("max_displacement")) c.displacement = Peak{read_placed(from["max_displacement"])};
  for (const Json& r : list(from, "reactions")) c.reactions.push_back(read_resultant(r));
  c.reserves = read_reserves(from);
  return c;
}

SolverResult solver(const Json& from) {
  SolverResult s;
  s.parts = whole(from, "parts", 1);
  s.solves = whole(from, "solves");
  s.iterations = whole(from, "iterations");
  s.condition = read_number(from, "condition");
  s.interface_unknowns = whole(from, "interface_unknowns");
  s.primal_unknowns = whole(from, "primal_unknowns");
  s.sent = read_number(from, "bytes_per_iteration");
  if (const Json& peaks = list(from, "peak_memory_mb"); peaks.size() == 2) {
    s.first_mb = read_number(peaks[0]);
    s.others_mb = read_number(peaks[1]);
  }
  return s;
}

CrackResult crack(const Json& from) {
  CrackResult out;
  out.name = text(from, "name");
  out.length = read_number(from, "length");
  out.max_opening = read_number(from, "max_opening");
  out.max_pressure = read_number(from, "max_pressure");
  for (const Json& t : list(from, "transitions"))
    out.transitions.push_back({read_place(t.at("at")), text(t, "from"), text(t, "to")});
  for (const Json& t : list(from, "tips")) {
    TipResult tip{read_place(t.at("at")), maybe(t, "K_I"), maybe(t, "K_II"),
                  maybe(t, "G"),          maybe(t, "T"),   std::nullopt};
    if (t.contains("spread") && !t["spread"].is_null())
      tip.spread = {read_number(t["spread"], "K_I"), read_number(t["spread"], "K_II"), read_number(t["spread"], "T")};
    if (t.contains("margin"))
      tip.margin = {read_number(t["margin"], "K_I"), read_number(t["margin"], "K_II"), read_number(t["margin"], "G"),
                    read_number(t["margin"], "T")};
    if (t.contains("note")) tip.note = text(t, "note");
    out.tips.push_back(tip);
  }
  out.half = from.contains("half");
  out.fluid_pressure = maybe(from, "fluid_pressure");
  if (from.contains("pressure_peak")) out.pressure = peak(from["pressure_peak"]);
  return out;
}

Bounded read_bounded(const Json& from, const char* key) {
  const auto found = from.find(key);
  if (found == from.end() || found->is_null()) return {nan, nan, nan};
  return {read_number(*found, "value"), read_number(*found, "lower"), read_number(*found, "upper"),
          found->value("guaranteed", false), text(*found, "note")};
}

BoundsResult bounds(const Json& from) {
  BoundsResult out;
  for (const Json& t : list(from, "tips"))
    out.tips.push_back({text(t, "crack"), text(t, "tip") == "start", read_place(t.at("at")), read_bounded(t, "K_I"),
                        read_bounded(t, "K_II"), read_bounded(t, "G")});
  for (const Json& p : list(from, "points"))
    out.points.push_back({read_place(p.at("at")), read_bounded(p, "s_xx"), read_bounded(p, "s_yy"),
                          read_bounded(p, "s_xy"), read_bounded(p, "von_mises"),
                          read_bounded(p, "topological_derivative")});
  for (const auto& [of, key] : bounded_lists)
    for (const Json& m : list(from, key)) {
      BoundedMean mean{.of = of};
      if (of == BoundedMean::Of::Disc) {
        mean.from = mean.to = read_place(m.at("center"));
        mean.radius = read_number(m, "radius");
      } else if (of == BoundedMean::Of::Line) {
        mean.from = read_place(m.at("from"));
        mean.to = read_place(m.at("to"));
      } else {
        mean.on = text(m, "on");
      }
      for (const NamedQuantity& q : quantities_of(of))
        mean.quantities.push_back(read_bounded(m, std::string(q.name).c_str()));
      out.means.push_back(std::move(mean));
    }
  if (from.contains("compliance"))
    out.means.push_back({.of = BoundedMean::Of::Loads, .quantities = {read_bounded(from, "compliance")}});
  return out;
}

FunctionalResult functional(const Json& from) {
  FunctionalResult out{text(from, "kind"), read_number(from, "value"), {}};
  for (const Json& t : list(from, "terms"))
    out.terms.push_back({text(t, "kind"), read_number(t, "factor"), read_number(t, "value")});
  return out;
}

MapResult map(const Json& from) {
  MapResult out;
  out.perturbation = text(from, "perturbation");
  out.min = read_placed(from.at("min"));
  out.max = read_placed(from.at("max"));
  out.excluded_radius = read_number(from, "excluded_radius");
  out.radius = read_number(from, "radius");
  out.masked_share = read_number(from, "masked_share");
  out.biactive_length = read_number(from, "biactive_length");
  for (const Json& p : list(from, "points")) {
    const std::optional<double> angle = maybe(p, "angle_deg");
    out.oriented = out.oriented || angle;
    out.points.push_back({.at = read_place(p.at("at")),
                          .value = read_number(p, "value"),
                          .angle = angle.value_or(0) * pi / 180,
                          .masked = p.value("masked", false),
                          .lower = maybe(p, "lower"),
                          .upper = maybe(p, "upper"),
                          .c2 = maybe(p, "c2"),
                          .valid_radius = maybe(p, "valid_radius")});
  }
  return out;
}

Validation validation(const Json& from) {
  Validation v;
  v.at = read_place(from.at("at"));
  v.coefficient = read_number(from, "coefficient");
  v.order = read_number(from, "order");
  v.verdict = verdict(text(from, "verdict"));
  v.reason = text(from, "reason");
  v.intercept = read_number(from, "intercept");
  v.plateau = read_number(from, "plateau");
  v.c2 = read_number(from, "c2");
  v.c3 = read_number(from, "c3");
  v.c4 = read_number(from, "c4");
  v.c2_predicted = read_number(from, "c2_predicted");
  v.c2_on_mesh = read_number(from, "c2_on_mesh");
  v.order_second = read_number(from, "order_second");
  for (const Logarithm known : {Logarithm::Absent, Logarithm::Known})
    if (from.value("logarithm", "") == word(known)) v.logarithm = known;
  v.on_mesh = read_number(from, "on_mesh");
  v.bar = read_number(from, "bar");
  if (from.contains("independent")) {
    const Json& drawn = from["independent"];
    v.drawn.radius = read_number(drawn, "radius");
    v.drawn.difference = read_number(drawn, "difference");
    v.drawn.coefficient = read_number(drawn, "formula");
    v.drawn.intercept = read_number(drawn, "intercept");
  }
  if (from.contains("modes"))
    for (const auto& [name, value] : from["modes"].items()) v.modes.push_back({name, read_number(value)});
  for (const Json& row : list(from, "rows"))
    v.rows.push_back({read_number(row, "radius"), read_number(row, "J"), read_number(row, "difference"),
                      read_number(row, "predicted"), read_number(row, "remainder"), read_number(row, "order"),
                      row.value("same_contact", true), read_number(row, "predicted_second"),
                      read_number(row, "remainder_second"), read_number(row, "order_second")});
  return v;
}

Identified identified(const Json& from) {
  Identified i{text(from, "name"), text(from, "truth"), numbers(from.at("found")), numbers(from.at("exact"))};
  i.position_error = i.truth.empty() ? 0 : read_number(from, "position_error");
  i.size_error = i.truth.empty() ? 0 : read_number(from, "size_error");
  return i;
}

LeastSquares fit(const Json& from) {
  LeastSquares out;
  out.readings = whole(from, "readings");
  out.start = read_number(from, "start");
  out.end = read_number(from, "end");
  out.noise = read_number(from, "noise");
  out.estimated = from.value("estimated", false);
  out.steps = whole(from, "steps");
  out.state_solves = whole(from, "state_solves");
  out.optimality = read_number(from, "optimality");
  out.stopped = text(from, "stopped");
  out.gain = read_number(from, "gain");
  out.verdict = from_word<FitVerdict>(fit_verdict_words, text(from, "verdict"));
  if (from.contains("chi_square")) {
    const Json& chi = from["chi_square"];
    const double unit = out.noise * out.noise * out.readings, n = out.readings;
    const Eigen::VectorXd expected = numbers(list(chi, "expected"));
    if (expected.size() != 2) throw Damage();
    out.expected = {n * expected[0], n * expected[1]};
    out.most = n * read_number(chi, "at_most");
    out.finer = unit * read_number(chi, "finer");
    out.mesh = unit * read_number(chi, "mesh");
  }
  for (const Json& c : list(from, "combinations")) {
    const double deviation = read_number(c, "deviation");
    const bool is_fixed = c.value("fixed", false);
    out.combinations.push_back(
        {numbers(list(c, "weights")), is_fixed || std::isfinite(deviation) ? deviation : infinity, is_fixed});
  }
  const Json &variables = list(from, "variables"), &rows = list(from, "covariance");
  const auto n = static_cast<Eigen::Index>(variables.size());
  out.variables.resize(n);
  out.covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out.variables[i] = read_number(variables[k], "value");
    if (rows.size() != variables.size()) continue;
    const Eigen::VectorXd row = numbers(rows[k]);
    if (row.size() != n) throw Damage();
    out.covariance.row(i) = row.transpose();
  }
  for (const Combination& c : out.combinations)
    if (c.weights.size() != n) throw Damage();
  for (const Json& e : list(from, "ellipses"))
    out.ellipses.push_back({text(e, "name"), read_place(e.at("at")), read_place(e.at("semi_axes")),
                            read_number(e, "angle_deg") * pi / 180});
  return out;
}

/// Without the designs, which result.json does not have.
Count defects(const Json& from) {
  Count out{.things = texts(from, "things")};
  for (const Json& one : list(from, "tried")) {
    Counted& c = out.tried.emplace_back();
    c.count = whole(one, "count");
    for (const double of : numbers(list(one, "of"))) c.of.push_back(static_cast<int>(of));
    if (c.of.size() != out.things.size()) throw Damage();
    c.variables = whole(one, "unknowns", 0);
    c.criterion = read_number(one, "criterion");
    c.aicc = read_number(one, "aicc");
    c.fit.readings = whole(one, "readings", 0);
    c.fit.noise = read_number(one, "noise");
    c.fit.estimated = one.value("estimated", false);
    c.fit.end = read_number(one, "squares");
    c.fit.variables = numbers(list(one, "variables"));
    c.failure = text(one, "failure");
  }
  const auto is_chosen = [&](const Counted& one) { return one.count == whole(from, "count"); };
  const auto by_count = std::ranges::find_if(out.tried, is_chosen) - out.tried.begin();
  const int chosen = whole(from, "chosen", static_cast<int>(by_count));
  if (chosen < 0 || static_cast<std::size_t>(chosen) >= out.tried.size()) throw Damage();
  out.chosen = static_cast<std::size_t>(chosen);
  return out;
}

StartTried start_tried(const Json& from) {
  return {.from = numbers(list(from, "from")),
          .variables = numbers(list(from, "reached")),
          .merit = read_number(from, "merit"),
          .violation = read_number(from, "violation"),
          .in_full = from.value("in_full", false),
          .state_solves = whole(from, "state_solves"),
          .failure = text(from, "failure"),
          .end = whole(from, "end", 0)};
}

FinerDesign finer(const Json& from) {
  FinerDesign out;
  out.size = read_number(from, "size");
  for (const Element& e : elements)
    if (e.name == text(from, "element") && e.degree == whole(from, "degree", 1)) out.element = e;
  out.curved = from.value("curved", false);
  out.objective = read_number(from, "objective");
  out.volume_fraction = read_number(from, "volume_fraction");
  out.violation = read_number(from, "violation");
  for (const Json& b : list(from, "bounds")) {
    out.bounds.push_back(read_number(b, "value"));
    const auto read = [&](const char* key) { return b.contains(key) ? read_number(b, key) : nan; };
    out.intervals.push_back({nan, read("lower"), read("upper"), b.value("guaranteed", false),
                             b.contains("note") ? text(b, "note") : std::string()});
  }
  out.residual = read_number(from, "residual");
  out.failure = text(from, "failure");
  return out;
}

NucleatedHole nucleated_hole(const Json& from) {
  NucleatedHole h{.iteration = whole(from, "iteration"), .at = read_place(from.at("at"))};
  h.radius = read_number(from, "radius");
  h.T = read_number(from, "topological_derivative");
  h.c2 = read_number(from, "c2");
  h.predicted = read_number(from, "predicted");
  h.actual = read_number(from, "actual");
  h.note = text(from, "note");
  return h;
}

BestChange best_change(const Json& gain, const char* share, const char* place) {
  BestChange change{.gain = read_number(gain, share)};
  if (gain.contains(place))
    change.at = read_place(gain[place].at("at")), change.radius = read_number(gain[place], "radius");
  return change;
}

/// The verdict may have a number: "optimal within 0.05 %".
Ending ending(const std::string& said) {
  return said.starts_with(word(Ending::OptimalWithin)) ? Ending::OptimalWithin : from_word<Ending>(ending_words, said);
}

KeptConstraint kept_constraint(const Json& from) {
  KeptConstraint c{.name = text(from, "name"), .asked = read_number(from, "asked"), .got = read_number(from, "got")};
  c.kept = from.value("kept", false);
  if (from.contains("at")) c.at = read_place(from["at"]);
  c.note = text(from, "note");
  return c;
}

void read_optimize(const Json& from, Result& r) {
  OptimizeResult o;
  o.method = from_word<OptimizeMethod>(optimize_method_words, text(from, "method"));
  o.iterations = whole(from, "iterations");
  o.state_solves = whole(from, "state_solves");
  o.objective = read_number(from, "objective");
  o.volume_fraction = read_number(from, "volume_fraction");
  o.feasible = from.value("feasible", false);
  o.stopped = text(from, "stopped");
  o.ending = ending(text(from, "ending"));
  o.optimality = read_number(from, "optimality");
  for (const Json& c : list(from, "constraints")) o.constraints.push_back(kept_constraint(c));
  if (from.contains("hole_margin")) {
    const Json& holes = from["hole_margin"];
    o.holes.least = read_number(holes, "least");
    o.holes.at = read_place(holes.at("at"));
    if (holes.contains("proof")) o.holes.proof = verdict(text(holes, "proof"));
  }
  if (from.contains("bump_margin")) {
    o.bumps.least = read_number(from["bump_margin"], "least");
    o.bumps.at = read_place(from["bump_margin"].at("at"));
  }
  if (from.contains("gain")) {
    const Json& gain = from["gain"];
    o.gain = {read_number(gain, "shape"), best_change(gain, "hole", "best_hole"),
              best_change(gain, "bump", "best_bump")};
  }
  if (from.contains("finer")) o.finer = finer(from["finer"]);
  for (const Json& h : list(from, "nucleated")) o.nucleated.push_back(nucleated_hole(h));
  for (const Json& t : list(from, "starts")) o.starts.push_back(start_tried(t));
  o.notes = texts(from, "notes");
  OptimizeNames& names = r.optimize_names;
  names.volume_at_most = maybe(from, "volume_at_most");
  for (const Json& b : list(from, "bounds")) {
    names.bounds.push_back(text(b, "name"));
    names.at_most.push_back(read_number(b, "at_most"));
  }
  const Json& variables = list(from, "variables");
  o.variables.resize(static_cast<Eigen::Index>(variables.size()));
  for (std::size_t i = 0; i < variables.size(); ++i) {
    names.variables.push_back(text(variables[i], "name"));
    o.variables[static_cast<Eigen::Index>(i)] = read_number(variables[i], "value");
  }
  if (from.contains("least_squares")) r.fit = fit(from["least_squares"]);
  if (from.contains("defects")) r.counted = defects(from["defects"]);
  for (const Json& i : list(from, "identified")) r.identified.push_back(identified(i));
  r.optimize = std::move(o);
}

StepResult step(const Json& from) {
  StepResult s{.name = text(from, "name"), .part = whole(from, "part", 1), .parts = whole(from, "parts", 1)};
  if (s.parts < 1) s.parts = 1;
  for (const auto& [name, value] : from.at("define").items()) s.values.emplace_back(name, read_number(value));
  s.energy = read_number(from, "energy");
  s.strain_energy = read_number(from, "strain_energy");
  s.work = read_number(from, "work");
  s.dissipation = read_number(from, "dissipation");
  s.imbalance = read_number(from, "imbalance");
  s.open_length = read_number(from, "open_length");
  s.closed_length = read_number(from, "closed_length");
  s.stick_length = read_number(from, "stick_length");
  s.slip_length = read_number(from, "slip_length");
  s.kkt = read_number(from, "kkt");
  for (const Json& t : list(from, "tips"))
    s.tips.push_back({text(t, "crack"), read_place(t.at("at")), maybe(t, "K_I"), maybe(t, "K_II")});
  return s;
}

template <typename Of>
std::optional<Of> maybe_intervals(const Json& from, const auto& columns) {
  if (!from.contains("bounds")) return std::nullopt;
  const Json& in = from["bounds"];
  Of out;
  out.guaranteed = in.value("guaranteed", false);
  for (const auto& [name, member] : columns) {
    const Vec2 ends = read_place(in.at(name));
    out.*member = {ends.x(), ends.y()};
  }
  out.note = text(in, "note");
  return out;
}

GrowthResult read_growth(const Json& from) {
  GrowthResult out{.law = text(from, "law"), .criterion = text(from, "criterion"), .ended = text(from, "ended")};
  out.notes = texts(from, "notes");
  out.solves = whole(from, "solves");
  out.step = read_number(from, "step");
  out.path_error = read_number(from, "path_error");
  out.cycles_error = read_number(from, "cycles_error");
  out.energy_balance = read_number(from, "energy_balance");
  out.bounds = maybe_intervals<growth::PathBounds>(from, intervals_of_path);
  if (from.contains("unstable_from")) out.unstable_from = whole(from, "unstable_from");
  if (from.contains("snaps_back_from")) out.snaps_back_from = whole(from, "snaps_back_from");
  for (const Json& s : list(from, "steps")) {
    growth::GrowthStep& step = out.steps.emplace_back();
    step.number = whole(s, "step");
    step.cycles = read_number(s, "cycles");
    step.load = read_number(s, "load");
    step.potential = read_number(s, "potential");
    step.solves = whole(s, "solves");
    for (const Json& t : list(s, "tips")) {
      growth::GrownTip& tip = step.tips.emplace_back();
      tip.name = text(t, "tip");
      tip.at = read_place(t.at("at"));
      for (const auto& [name, member] : columns_of_tip) tip.*member = read_number(t, name);
      tip.in = maybe_intervals<growth::TipIntervals>(t, intervals_of_tip);
    }
  }
  return out;
}

/// The value of an enum by its word.
template <typename Enum>
Enum by_word(const Json& from, const char* key, std::initializer_list<Enum> values) {
  const std::string given = text(from, key);
  for (const Enum value : values)
    if (word(value) == given) return value;
  throw Damage{};
}

inspect::EdgeCrack read_edge_crack(const Json& from) {
  using inspect::Masked;
  inspect::EdgeCrack crack;
  crack.at = read_place(from.at("at"));
  crack.inward = read_place(from.at("inward"));
  crack.angle = read_number(from, "angle_deg") * pi / 180;
  for (const auto& [name, member] : columns_of_edge_crack) crack.*member = read_number(from, name);
  crack.closed = from.at("closed").get<bool>();
  crack.masked = by_word(from, "masked",
                         {Masked::No, Masked::Support, Masked::Reentrant, Masked::Convex, Masked::Near, Masked::Rough});
  return crack;
}

inspect::InteriorCrack read_interior_crack(const Json& from) {
  inspect::InteriorCrack crack{.at = read_place(from.at("at")),
                               .direction = read_number(from, "direction_deg") * pi / 180,
                               .closed = from.at("closed").get<bool>()};
  for (const auto& [name, member] : columns_of_interior_crack) crack.*member = read_number(from, name);
  return crack;
}

EdgeCrackResult read_edge_cracks(const Json& from) {
  using inspect::Tolerated;
  EdgeCrackResult e{.length = read_number(from, "length"),
                    .friction = read_number(from, "friction"),
                    .pressurized = from.at("pressurized").get<bool>(),
                    .places = whole(from, "places"),
                    .masked_share = read_number(from, "masked_share"),
                    .worst = {},
                    .asked = from.at("asked").get<bool>()};
  if (const auto angle = maybe(from, "angle_deg")) e.angle = *angle * pi / 180;
  if (from.contains("law")) {
    e.law = text(from, "law");
    e.factor = read_number(from, "factor");
    e.open_share = read_number(from, "open_share");
    if (from.contains("shortest_critical")) e.safe = read_placed(from["shortest_critical"]);
  }
  for (const Json& w : list(from, "worst")) {
    EdgeCrackResult::Row& row = e.worst.emplace_back();
    row.crack = read_edge_crack(w);
    if (e.law.empty()) continue;
    row.tolerance.how =
        by_word(w, "tolerated", {Tolerated::Unknown, Tolerated::Critical, Tolerated::AtLeast, Tolerated::Rests});
    for (const auto& [name, member] : columns_of_tolerance) row.tolerance.*member = read_number(w, name);
  }
  if (from.contains("masked_by"))
    for (std::size_t i = 0; i < e.masked_by.size(); ++i)
      e.masked_by[i] = read_number(from["masked_by"], std::string(word(inspect::reasons_to_mask[i])).c_str());
  for (const Json& i : list(from, "inside")) e.inside.push_back(read_interior_crack(i));
  for (const Json& d : list(from, "drawn")) {
    inspect::DrawnPlace& place = e.drawn.emplace_back();
    place.crack = read_edge_crack(d.at("crack"));
    place.verdict = verdict(text(d, "verdict"));
    place.reason = text(d, "reason");
    for (const Json& r : list(d, "rows")) {
      inspect::DrawnEdge& row = place.rows.emplace_back();
      for (const auto& [name, member] : columns_of_drawn_edge) row.*member = read_number(r, name);
      row.valid = r.at("valid").get<bool>();
    }
  }
  return e;
}

Seconds seconds(const Json& from) {
  Seconds s{.total = read_number(from, "total")};
  for (const TimedPhase& phase : timed_phases)
    s.*phase.of = phase.always || from.contains(phase.name) ? read_number(from, phase.name) : 0;
  return s;
}

Result from_json(const Json& from) {
  Result r;
  r.version = text(from, "version");
  r.case_name = text(from, "case");
  r.status = text(from, "status");
  r.title = text(from, "title");
  if (from.contains("reason")) r.reason = text(from, "reason");
  if (from.contains("units")) {
    const Json& units = from["units"];
    r.units = {text(units, "length"), text(units, "stress")};
    if (const Json& powers = list(units, "functional_powers"); powers.size() == 2)
      r.functional_dimension = Dimension{read_number(powers[0]), read_number(powers[1])};
  }
  if (from.contains("mesh")) read_mesh(from["mesh"], r);
  if (from.contains("state")) {
    r.state = state(from["state"]);
    if (from["state"].contains("solver")) r.solver = solver(from["state"]["solver"]);
  }
  if (from.contains("contact")) {
    const Json& c = from["contact"];
    r.contact = ContactResultSummary{text(c, "method"),
                                     whole(c, "iterations"),
                                     whole(c, "linear_solves"),
                                     read_number(c, "kkt"),
                                     read_number(c, "open_length"),
                                     read_number(c, "closed_length"),
                                     read_number(c, "biactive_length")};
  }
  for (const Json& c : list(from, "load_cases")) r.load_cases.push_back(load_case(c));
  for (const Json& c : list(from, "cracks")) r.cracks.push_back(crack(c));
  for (const Json& s : list(from, "steps")) r.steps.push_back(step(s));
  if (from.contains("bounds")) r.bounds = bounds(from["bounds"]);
  if (from.contains("grow")) r.growth = read_growth(from["grow"]);
  if (from.contains("functional")) r.functional = functional(from["functional"]);
  if (from.contains("map")) r.map = map(from["map"]);
  if (from.contains("edge_cracks")) r.edge_cracks = read_edge_cracks(from["edge_cracks"]);
  if (from.contains("validate")) {
    r.validate = ValidationResult{};
    for (const Json& v : from["validate"]) {
      r.validate->perturbation = text(v, "perturbation");
      r.validate->points.push_back(validation(v));
    }
  }
  if (from.contains("optimize")) read_optimize(from["optimize"], r);
  if (from.contains("time_s")) r.seconds = seconds(from["time_s"]);
  r.peak_memory_mb = read_number(from, "peak_memory_mb");
  return r;
}

}  // namespace

Result read_result(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "result.json";
  Result r;
  try {
    r = from_json(read_json(path));
  } catch (const Json::exception&) {
    throw damaged_result(path);
  } catch (const Damage&) {
    throw damaged_result(path);
  }
  for (CrackResult& c : r.cracks) {
    if (!is_safe_name(c.name)) throw damaged_result(path);  // part of a path
    read_crack_rows(folder / ("crack_" + c.name + ".csv"), c);
  }
  if (r.optimize) r.optimize->history = read_history(folder / "history.csv", r.optimize_names);
  return r;
}

}  // namespace kerf
