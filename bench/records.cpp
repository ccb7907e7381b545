#include "bench/records.hpp"

#include "report/files.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

namespace kerf {

namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json run_section(const Measurement& m) {
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

Json ratio_section(const StateBench& bench) {
  Json out = Json::array();
  for (const Fastest& f : bench.best)
    for (const Fastest& p : bench.best_peers)
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

}  // namespace

void write_state_csv(const std::filesystem::path& path, const StateBench& bench) {
  std::string out;
  const Json columns = run_section({});
  for (const auto& [name, value] : columns.items()) out += (out.empty() ? "" : ",") + name;
  out += '\n';
  for (const Measurement& m : bench.runs) {
    std::string row;
    const Json cells = run_section(m);
    for (const auto& [name, value] : cells.items()) {
      if (!row.empty()) row += ',';
      row += value.is_string() ? value.get<std::string>() : value.is_null() ? "" : value.dump();
    }
    out += row + '\n';
  }
  write_file(path, out);
}

void write_state_json(const std::filesystem::path& path, const StateBench& bench) {
  Json out = {{"schema", 1}, {"bench", "state"}, {"status", bench.stopped ? "stopped" : "ok"}, {"threads", 1}};
  out["references"] = Json::array();
  for (const ReferenceUsed& r : bench.references)
    out["references"].push_back({{"case", r.problem},
                                 {"poisson", r.poisson},
                                 {"points", r.points},
                                 {"strain_energy", number(r.strain_energy)},
                                 {"known_energy", r.known_energy > 0 ? Json(r.known_energy) : Json(nullptr)},
                                 {"estimated_stress_error", number(r.error)}});
  out["runs"] = Json::array();
  for (const Measurement& m : bench.runs) out["runs"].push_back(run_section(m));
  out["fastest"] = fastest_section(bench.best);
  out["peers"] = Json::array();
  for (const PeerRun& p : bench.peers)
    out["peers"].push_back({{"case", p.problem},
                            {"poisson", p.poisson},
                            {"name", p.name},
                            {"triangles", p.triangles},
                            {"unknowns", p.unknowns},
                            {"work_s", number(p.work)},
                            {"stress_error", number(p.stress_error)}});
  out["fastest_peers"] = fastest_section(bench.best_peers);
  out["ratios"] = ratio_section(bench);
  out["notes"] = bench.notes;
  write_file(path, out.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
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
    if (!(value("err_s") > 0)) continue;
    found = PeerRun{.triangles = static_cast<long>(value("nt")),
                    .unknowns = static_cast<long>(value("ndof")),
                    .work = value("t_mesh") + value("t_asm") + value("t_solve") + value("t_post"),
                    .stress_error = value("err_s")};
  }
  return found;
}

}  // namespace kerf
