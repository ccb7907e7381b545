// The results of the benches as tables (CSV) and JSON. A section function makes the JSON object of a row, and the
// columns of the table are its keys: a default row gives the head, each row its cells, so that both always agree.
// Numbers that are not finite are null, and empty cells. machines.json is read back, since rows are measured by
// programs of their own (machines.cpp). bench/README.md says what the columns mean.

#include "bench/command/records.hpp"

#include "io/csv.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <type_traits>

namespace kerf {

namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json run_section(const StateMeasurement& m) {
  const PhaseSeconds& s = m.seconds;
  return {{"case", m.problem},
          {"poisson", m.poisson},
          {"element", m.element},
          {"degree", m.degree},
          {"mesh", m.mesh},
          {"level", m.level},
          {"h", number(m.h)},
          {"triangles", m.triangles},
          {"unknowns", m.unknowns},
          {"condensed_unknowns", m.condensed_unknowns},
          {"mesh_s", number(s.mesh)},
          {"assemble_s", number(s.assemble)},
          {"factor_s", number(s.factor)},
          {"solve_s", number(s.solve)},
          {"contact_s", number(s.contact)},
          {"recover_s", number(s.recover)},
          {"work_s", number(s.work())},
          {"memory_mb", number(m.memory_mb)},
          {"stress_error", number(m.error.stress)},
          {"displacement_error", number(m.error.displacement)},
          {"contact_iterations", m.contact_iterations},
          {"certified", m.certified}};
}

Json hard_section(const HardRow& r) {
  return {{"family", r.family},
          {"knob", r.label},
          {"value", number(r.value)},
          {"verdict", name_of(r.verdict)},
          {"exit", r.exit},
          {"error", number(r.error)},
          {"allowed", number(r.allowed)},
          {"digits_lost", number(r.digits)},
          {"estimated_error", number(r.estimated)},
          {"residual", number(r.residual)},
          {"work_error", number(r.work)},
          {"triangles", r.triangles},
          {"seconds", number(r.seconds)},
          {"slower", number(r.slower)},
          {"said", r.said}};
}

Json proof_section(const ProofRow& r) {
  return {{"case", r.problem},          {"mesh", r.mesh},           {"degree", r.degree},
          {"triangles", r.triangles},   {"quantity", r.quantity},   {"exact", number(r.exact)},
          {"lower", number(r.lower)},   {"upper", number(r.upper)}, {"half_width", number(r.relative)},
          {"guaranteed", r.guaranteed}, {"contained", r.contained}, {"cost", number(r.cost)}};
}

Json contact_section(const ContactRow& r) {
  return {{"family", r.family},
          {"knob", r.knob},
          {"friction", r.friction},
          {"triangles", r.triangles},
          {"contact_unknowns", r.unknowns},
          {"sets", r.sets},
          {"linear_solves", r.solves},
          {"linear_s", number(r.linear_s)},
          {"contact_s", number(r.contact_s)},
          {"ratio", number(r.ratio())},
          {"memory_mb", number(r.memory_mb)},
          {"kkt", number(r.kkt)},
          {"certified", r.certified},
          {"refused", r.refused}};
}

/// Visits name and member, to write or to read.
template <typename Row, typename Visit>
void machine_fields(Row& r, Visit&& visit) {
  visit("family", r.family), visit("parts", r.parts), visit("element", r.element), visit("degree", r.degree);
  visit("poisson", r.poisson), visit("contrast", r.contrast), visit("cracks", r.cracks), visit("across", r.across);
  visit("triangles", r.triangles), visit("unknowns", r.unknowns), visit("iterations", r.iterations);
  visit("condition", r.condition), visit("interface_unknowns", r.interface_unknowns);
  visit("primal_unknowns", r.primal_unknowns), visit("bytes_per_iteration", r.sent), visit("first_mb", r.first_mb);
  visit("others_mb", r.others_mb), visit("parts_s", r.parts_s), visit("iterate_s", r.iterate_s);
  visit("factor_s", r.factor_s), visit("off", r.off), visit("refused", r.refused);
}

Json machine_section(const MachineRow& r) {
  Json out;
  machine_fields(r, [&](const char* name, const auto& value) {
    if constexpr (std::is_floating_point_v<std::decay_t<decltype(value)>>)
      out[name] = number(value);
    else
      out[name] = value;
  });
  return out;
}

MachineRow machine_row(const Json& from) {
  MachineRow r;
  machine_fields(r, [&](const char* name, auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_floating_point_v<Value>)
      value = from[name].is_number() ? from[name].get<double>() : nan;
    else
      value = from[name].get<Value>();
  });
  return r;
}

Json second_section(const SecondTermRow& r) {
  return {{"change", r.change},
          {"degree", r.degree},
          {"triangles", r.triangles},
          {"x", r.at.x()},
          {"y", r.at.y()},
          {"T_exact", number(r.T_exact)},
          {"T", number(r.T)},
          {"c2_exact", number(r.c2_exact)},
          {"c2", number(r.c2)},
          {"c2_off_by", number(r.error)},
          {"radius", number(r.radius)},
          {"left_by_first", number(r.left_by_first)},
          {"left_by_second", number(r.left_by_second)}};
}

Json phase_section(const LimitRow& r, const LimitPhase& p) {
  return {{"triangles", r.triangles},
          {"threads", r.threads},
          {"phase", p.name},
          {"wall_s", number(p.wall_s)},
          {"processor_s", number(p.processor_s)}};
}

Json limit_section(const LimitRow& r) {
  Json phases = Json::object();
  for (const LimitPhase& p : r.phases)
    phases[p.name] = {{"wall_s", number(p.wall_s)}, {"processor_s", number(p.processor_s)}};
  return {{"triangles", r.triangles},
          {"threads", r.threads},
          {"wall_s", number(r.wall())},
          {"processor_s", number(r.processor())},
          {"factor_flops", number(r.factor_flops)},
          {"dgemm_flops_per_s", number(r.dgemm_rate)},
          {"limit_s", number(r.limit())},
          {"memory_mb", number(r.memory_mb)},
          {"bytes_per_triangle", number(r.bytes_per_triangle())},
          {"certified", r.certified},
          {"phases", std::move(phases)}};
}

Json map_section(const MapMeasurement& m) {
  return {{"case", m.problem},
          {"poisson", m.poisson},
          {"element", m.element},
          {"degree", m.degree},
          {"mesh", m.mesh},
          {"level", m.level},
          {"triangles", m.triangles},
          {"mesh_s", number(m.state.mesh)},
          {"assemble_s", number(m.state.assemble)},
          {"factor_s", number(m.state.factor)},
          {"solve_s", number(m.state.solve)},
          {"contact_s", number(m.state.contact)},
          {"value_s", number(m.value_s)},
          {"evaluate_s", number(m.evaluate_s)},
          {"evaluation_share", number(m.evaluation_share())},
          {"adjoint_s", number(m.adjoint_s)},
          {"evaluate_dual_s", number(m.evaluate_dual_s)},
          {"work_s", number(m.work())},
          {"memory_mb", number(m.memory_mb)},
          {"value", number(m.value)},
          {"map_error", number(m.error)},
          {"certified", m.certified}};
}

Json design_section(const Row& row) {
  const DesignRun& r = *row.run;
  const DesignVerdict& c = r.verdict;
  const auto over = [&](const DesignRun* other) { return other ? number(r.value / other->value) : Json(nullptr); };
  const auto own = [&](double value) { return r.own ? number(value) : Json(nullptr); };
  return {{"case", r.problem},
          {"tool", r.tool},
          {"variant", r.variant},
          {"iterations", r.iterations},
          {"state_solves", r.state_solves},
          {"cpu_s", number(r.seconds)},
          {"own_value", number(r.own_value)},
          {"value", number(r.value)},
          {"over_best_peer", over(row.peer)},
          {"over_best_known", over(row.known)},
          {"compliance", r.last.mesh.triangles.empty() ? Json(nullptr) : number(r.last.compliance)},
          {"compliance_least", r.last.mesh.triangles.empty() ? Json(nullptr) : number(r.last.least)},
          {"compliance_most", r.last.mesh.triangles.empty() ? Json(nullptr) : number(r.last.most)},
          {"volume", r.last.mesh.triangles.empty() ? Json(nullptr) : number(r.last.volume)},
          {"triangles", r.last.mesh.triangles.size()},
          {"near_iterations", r.near.iteration},
          {"near_state_solves", r.near.state_solves},
          {"near_cpu_s", number(r.near.seconds)},
          {"simp_50_cpu_s", row.usual ? number(row.usual->seconds) : Json(nullptr)},
          {"shape_residual", own(c.residual)},
          {"hole_margin", own(c.margin)},
          {"finer_objective", own(c.finer)},
          {"finer_change", own(c.change)},
          {"ending", r.own ? Json(word(c.ending)) : Json(nullptr)},
          {"feasible", r.own ? Json(c.feasible) : Json(nullptr)},
          {"stopped", r.stopped}};
}

/// Of all runs; those of other programs beside nothing.
std::vector<Json> design_sections(const OptimizeBench& bench) {
  std::vector<Json> out;
  for (const Row& row : rows(bench)) out.push_back(design_section(row));
  for (const DesignRun& r : bench.runs)
    if (!r.own) out.push_back(design_section({.run = &r}));
  return out;
}

Json point_section(const DesignRun& r, const DesignPoint& p) {
  return {{"case", r.problem},
          {"tool", r.tool},
          {"variant", r.variant},
          {"iteration", p.iteration},
          {"state_solves", p.state_solves},
          {"cpu_s", number(p.seconds)},
          {"value", number(p.value)},
          {"volume", number(p.volume)}};
}

Json spread_run_section(const std::string& problem, const SpreadRun& r) {
  return {{"case", problem},
          {"start", r.start},
          {"size", r.size},
          {"budget", r.budget},
          {"loads", r.loads},
          {"state_solves", r.state_solves},
          {"cpu_s", number(r.seconds)},
          {"value", number(r.value)},
          {"volume", number(r.volume)},
          {"ending", word(r.ending)},
          {"feasible", r.feasible}};
}

Json spread_section(const Spread& spread) {
  const SpreadSummary s = summarize(spread);
  Json runs = Json::array();
  for (const SpreadRun& r : spread.runs) runs.push_back(spread_run_section(spread.problem, r));
  return {{"case", spread.problem},      {"least", number(s.least)},
          {"most", number(s.most)},      {"default", number(s.usual)},
          {"infeasible", s.infeasible},  {"rounding", number(s.rounding)},
          {"failures", spread.failures}, {"runs", runs}};
}

Json published_section(const PublishedRun& r) {
  return {{"method", r.method},
          {"start", r.start},
          {"iterations", r.iterations},
          {"state_solves", r.state_solves},
          {"cpu_s", number(r.seconds)},
          {"objective", number(r.objective)},
          {"compliance", number(r.compliance)},
          {"volume", number(r.volume)},
          {"body_fitted_objective", number(r.judged)},
          {"stopped", r.stopped}};
}

Json validation_section(const ValidationMeasurement& v) {
  return {{"case", v.problem},
          {"poisson", v.poisson},
          {"functional", v.functional},
          {"triangles", v.triangles},
          {"points", v.points},
          {"radii", v.radii},
          {"state_s", number(v.state.work())},
          {"validate_s", number(v.validate_s)},
          {"validate_over_state", number(v.ratio())},
          {"memory_mb", number(v.memory_mb)},
          {"holds", v.holds},
          {"fails", v.fails},
          {"out_of_range", v.out_of_range}};
}

/// Columns as in `empty`, one row each.
std::string csv(const Json& empty, const std::vector<Json>& rows) {
  std::string out;
  for (const auto& [name, value] : empty.items()) out += (out.empty() ? "" : ",") + name;
  out += '\n';
  for (const Json& cells : rows) {
    std::string row;
    for (const auto& [name, value] : cells.items()) {
      if (!row.empty()) row += ',';
      row += value.is_string() ? csv_text(value.get<std::string>()) : value.is_null() ? "" : value.dump();
    }
    out += row + '\n';
  }
  return out;
}

template <typename Row>
void write_rows(const std::filesystem::path& path, const std::vector<Row>& rows, Json (*section)(const Row&)) {
  std::vector<Json> cells;
  for (const Row& row : rows) cells.push_back(section(row));
  write_file(path, csv(section({}), cells));
}

/// An array of sections.
template <typename Row>
Json all_of(const std::vector<Row>& rows, Json (*section)(const Row&)) {
  Json out = Json::array();
  for (const Row& row : rows) out.push_back(section(row));
  return out;
}

/// How every record begins.
Json record(const char* bench, bool stopped, bool failed = false) {
  return {{"schema", 1}, {"bench", bench}, {"status", stopped ? "stopped" : failed ? "failed" : "ok"}};
}

void write_record(const std::filesystem::path& path, const Json& out) {
  write_file(path, out.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

const char* word(TimeTo::Kind kind) {
  switch (kind) {
    case TimeTo::Kind::Interpolated:
      return "interpolated";
    case TimeTo::Kind::AtMost:
      return "at most";
    case TimeTo::Kind::Extrapolated:
      return "extrapolated";
    case TimeTo::Kind::Missed:
      break;
  }
  return "missed";
}

Json fastest_section(const std::vector<Fastest>& all) {
  Json out = Json::array();
  for (const Fastest& f : all)
    out.push_back({{"case", f.problem},
                   {"poisson", f.poisson},
                   {"error", f.error},
                   {"name", f.name},
                   {"seconds", number(f.time.seconds)},
                   {"kind", word(f.time.kind)}});
  return out;
}

Json ratio_section(const std::vector<Fastest>& best, const std::vector<Fastest>& best_peers) {
  Json out = Json::array();
  for (const Fastest& f : best)
    for (const Fastest& p : best_peers)
      if (p.problem == f.problem && p.poisson == f.poisson && p.error == f.error &&
          p.time.kind != TimeTo::Kind::Missed && f.time.kind != TimeTo::Kind::Missed)
        out.push_back({{"case", f.problem},
                       {"poisson", f.poisson},
                       {"error", f.error},
                       {"peer", p.name},
                       {"peer_kind", word(p.time.kind)},
                       {"kerf", f.name},
                       {"kerf_kind", word(f.time.kind)},
                       {"peer_over_kerf", number(p.time.seconds / f.time.seconds)}});
  return out;
}

// What every bench says of another program's run.
Json peer_section(const PeerRun& p) {
  return {{"case", p.problem},        {"poisson", p.poisson},   {"name", p.name},
          {"triangles", p.triangles}, {"unknowns", p.unknowns}, {"work_s", number(p.work)}};
}

}  // namespace

void write_state_csv(const std::filesystem::path& path, const StateBench& bench) {
  write_rows(path, bench.runs, run_section);
}

void write_state_json(const std::filesystem::path& path, const StateBench& bench) {
  Json out = record("state", bench.stopped);
  out["threads"] = 1;
  out["references"] = Json::array();
  for (const ReferenceUsed& r : bench.references)
    out["references"].push_back({{"case", r.problem},
                                 {"poisson", r.poisson},
                                 {"points", r.points},
                                 {"strain_energy", number(r.strain_energy)},
                                 {"known_energy", r.known_energy > 0 ? Json(r.known_energy) : Json(nullptr)},
                                 {"estimated_stress_error", number(r.error)}});
  out["runs"] = all_of(bench.runs, run_section);
  out["fastest"] = fastest_section(bench.best);
  out["peers"] = Json::array();
  for (const PeerRun& p : bench.peers) {
    Json section = peer_section(p);
    section["stress_error"] = number(p.error);
    out["peers"].push_back(std::move(section));
  }
  out["fastest_peers"] = fastest_section(bench.best_peers);
  out["ratios"] = ratio_section(bench.best, bench.best_peers);
  out["notes"] = bench.notes;
  write_record(path, out);
}

void write_map_csv(const std::filesystem::path& path, const MapBench& bench) {
  std::vector<Json> rows;
  for (const auto* runs : {&bench.sequences, &bench.sizes})
    for (const MapMeasurement& m : *runs) rows.push_back(map_section(m));
  write_file(path, csv(map_section({}), rows));
}

void write_validation_csv(const std::filesystem::path& path, const MapBench& bench) {
  write_rows(path, bench.validations, validation_section);
}

void write_hard_csv(const std::filesystem::path& path, const HardBench& bench) {
  write_rows(path, bench.rows, hard_section);
}

void write_contact_csv(const std::filesystem::path& path, const ContactBench& bench) {
  write_rows(path, bench.rows, contact_section);
}

void write_contact_json(const std::filesystem::path& path, const ContactBench& bench) {
  Json out = record("contact", bench.stopped);
  out["quick"] = bench.quick;
  out["rows"] = all_of(bench.rows, contact_section);
  write_record(path, out);
}

void write_proof_csv(const std::filesystem::path& path, const ProofBench& bench) {
  write_rows(path, bench.rows, proof_section);
}

void write_second_terms_csv(const std::filesystem::path& path, const ProofBench& bench) {
  write_rows(path, bench.second, second_section);
}

void write_proof_json(const std::filesystem::path& path, const ProofBench& bench) {
  Json out = record("proof", bench.stopped, failures(bench) > 0);
  out["quick"] = bench.quick;
  out["rows"] = all_of(bench.rows, proof_section);
  out["second_terms"] = all_of(bench.second, second_section);
  write_record(path, out);
}

void write_limit_csv(const std::filesystem::path& path, const LimitBench& bench) {
  std::vector<Json> rows;
  for (const LimitRow& r : bench.rows)
    for (const LimitPhase& p : r.phases) rows.push_back(phase_section(r, p));
  write_file(path, csv(phase_section({}, {""}), rows));
}

void write_limit_json(const std::filesystem::path& path, const LimitBench& bench) {
  const auto memory = [](const LimitRow& r) { return r.memory_mb - r.before_mb; };
  Json out = record("limit", bench.stopped);
  out["time_grows_like"] = {number(growth_exponent(bench, 1, &LimitRow::wall)),
                            number(growth_exponent(bench, 2, &LimitRow::wall))};
  out["memory_grows_like"] = number(growth_exponent(bench, 1, memory));
  out["rows"] = all_of(bench.rows, limit_section);
  write_record(path, out);
}

void write_machines_csv(const std::filesystem::path& path, const MachineBench& bench) {
  write_rows(path, bench.rows, machine_section);
}

void write_machines_json(const std::filesystem::path& path, const MachineBench& bench) {
  Json out = record("machines", bench.stopped);
  out["quick"] = bench.quick;
  out["notes"] = bench.notes;
  out["rows"] = all_of(bench.rows, machine_section);
  write_record(path, out);
}

std::vector<MachineRow> read_machines_json(const std::filesystem::path& path) {
  std::ifstream file(path);
  const Json all = Json::parse(file, nullptr, false);
  std::vector<MachineRow> rows;
  if (!all.is_discarded() && all.contains("rows"))
    for (const Json& row : all["rows"]) rows.push_back(machine_row(row));
  return rows;
}

void write_hard_json(const std::filesystem::path& path, const HardBench& bench) {
  Json out = record("hard", bench.stopped, failures(bench) > 0);
  out["quick"] = bench.quick;
  out["rows"] = all_of(bench.rows, hard_section);
  write_record(path, out);
}

void write_map_json(const std::filesystem::path& path, const MapBench& bench) {
  Json out = record("map", bench.stopped);
  out["threads"] = 1;
  out["sequences"] = all_of(bench.sequences, map_section);
  out["sizes"] = all_of(bench.sizes, map_section);
  out["validations"] = all_of(bench.validations, validation_section);
  out["fastest"] = fastest_section(bench.best);
  out["peers"] = Json::array();
  for (const PeerRun& p : bench.peers) {
    Json section = peer_section(p);
    section["evaluate_s"] = number(p.post);
    section["memory_mb"] = number(p.memory_mb);
    section["value"] = p.value == 0 ? Json(nullptr) : number(p.value);
    section["map_error"] = p.error > 0 ? number(p.error) : Json(nullptr);
    out["peers"].push_back(std::move(section));
  }
  out["fastest_peers"] = fastest_section(bench.best_peers);
  out["ratios"] = ratio_section(bench.best, bench.best_peers);
  out["notes"] = bench.notes;
  write_record(path, out);
}

void write_optimize_csv(const std::filesystem::path& path, const OptimizeBench& bench) {
  const DesignRun none;
  write_file(path, csv(design_section({.run = &none}), design_sections(bench)));
}

void write_optimize_curves_csv(const std::filesystem::path& path, const OptimizeBench& bench) {
  std::vector<Json> rows;
  for (const DesignRun& r : bench.runs)
    for (const DesignPoint& p : r.curve) rows.push_back(point_section(r, p));
  write_file(path, csv(point_section({}, {}), rows));
}

void write_optimize_spread_csv(const std::filesystem::path& path, const OptimizeBench& bench) {
  std::vector<Json> rows;
  for (const Spread& spread : bench.spreads)
    for (const SpreadRun& r : spread.runs) rows.push_back(spread_run_section(spread.problem, r));
  write_file(path, csv(spread_run_section({}, {}), rows));
}

void write_optimize_json(const std::filesystem::path& path, const OptimizeBench& bench) {
  Json out = record("optimize", bench.stopped);
  out["threads"] = 1;
  out["runs"] = design_sections(bench);
  out["spreads"] = all_of(bench.spreads, spread_section);
  out["published"] = {{"least_objective", published.least_value},
                      {"most_objective", published.most_value},
                      {"fewest_state_solves", published.fewest_solves},
                      {"most_state_solves", published.most_solves},
                      {"runs", all_of(bench.published, published_section)}};
  if (bench.remeshing) {
    const Remeshing& r = *bench.remeshing;
    out["remeshing"] = {{"triangles", r.triangles},     {"iterations", r.iterations}, {"iteration_s", r.iteration_s},
                        {"carve_s", number(r.carve_s)}, {"mesh_s", number(r.mesh_s)}, {"share", number(r.share())}};
  }
  if (bench.random) {
    const RandomDesigns& r = *bench.random;
    out["random_designs"] = {{"count", r.count},     {"meshed", r.meshed}, {"refused", r.refused},
                             {"failed", r.failures}, {"cpu_s", r.seconds}, {"slowest_s", r.slowest}};
  }
  out["notes"] = bench.notes;
  write_record(path, out);
}

std::string last_line(const std::string& output) {
  std::istringstream lines(output);
  std::string last;
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) last = line;
  return last.substr(0, 200);
}

std::optional<PeerRun> read_peer_line(const std::string& output) {
  std::istringstream lines(output);
  std::optional<PeerRun> found;
  for (std::string line; std::getline(lines, line);) {
    const Json json = line.starts_with("{") ? Json::parse(line, nullptr, false) : Json();
    if (!json.is_object()) continue;
    const auto value = [&](const char* key) {
      const auto at = json.find(key);
      return at != json.end() && at->is_number() ? at->get<double>() : 0.0;
    };
    const double error = std::max(value("err_s"), value("err_map"));
    if (!(error > 0) && !(std::abs(value("J")) > 0)) continue;
    found = PeerRun{.triangles = static_cast<long>(value("nt")),
                    .unknowns = static_cast<long>(value("ndof")),
                    .work = value("t_mesh") + value("t_asm") + value("t_solve") + value("t_post"),
                    .post = value("t_post"),
                    .error = error,
                    .value = value("J")};
  }
  return found;
}

}  // namespace kerf
