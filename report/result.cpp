#include "report/result.hpp"

#include "report/files.hpp"

#include <fmt/format.h>

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

Json place(const Vec2& at) {
  return Json::array({number(at.x()), number(at.y())});
}

Json placed(const PlacedValue& value) {
  return {{"at", place(value.at)}, {"value", number(value.value)}};
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
  }
  return section;
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
  if (!state.notes.empty()) out["notes"] = state.notes;
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
    transitions.push_back({{"at", place(t.at)}, {"from", t.from}, {"to", t.to}});
  }
  for (const TipResult& tip : crack.tips) {
    Json spread = nullptr;
    if (const auto& s = tip.spread) spread = {{"K_I", number(s->K_I)}, {"K_II", number(s->K_II)}, {"T", number(s->T)}};
    tips.push_back({{"at", place(tip.at)},
                    {"K_I", number(tip.K_I)},
                    {"K_II", number(tip.K_II)},
                    {"G", number(tip.G)},
                    {"T", number(tip.T)},
                    {"spread", std::move(spread)}});
  }
  return {{"name", crack.name},
          {"length", number(crack.length)},
          {"max_opening", number(crack.max_opening)},
          {"max_pressure", number(crack.max_pressure)},
          {"transitions", std::move(transitions)},
          {"tips", std::move(tips)}};
}

Json map_section(const MapResult& map) {
  Json points = Json::array();
  for (const MapPoint& p : map.points) {
    points.push_back(
        {{"at", place(p.at)}, {"value", number(p.value)}, {"lower", number(p.lower)}, {"upper", number(p.upper)}});
  }
  return {{"perturbation", map.perturbation},
          {"min", placed(map.min)},
          {"max", placed(map.max)},
          {"points", std::move(points)},
          {"excluded_radius", number(map.excluded_radius)}};
}

Json time_section(const Seconds& s) {
  return {{"mesh", number(s.mesh)},         {"assemble", number(s.assemble)}, {"factor", number(s.factor)},
          {"solve", number(s.solve)},       {"contact", number(s.contact)},   {"map", number(s.map)},
          {"validate", number(s.validate)}, {"optimize", number(s.optimize)}, {"output", number(s.output)},
          {"total", number(s.total)}};
}

/// The shortest text that reads back to the same bits; nothing for what is not finite.
void append_cell(fmt::memory_buffer& out, double value) {
  if (std::isfinite(value)) fmt::format_to(std::back_inserter(out), "{}", value);
}

std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
  std::string out = "\"";
  for (const char c : name) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + '"';
}

std::string_view view(const fmt::memory_buffer& buffer) {
  return {buffer.data(), buffer.size()};
}

}  // namespace

void write_json(const std::filesystem::path& path, const Result& result) {
  Json out = {{"schema", 1}, {"version", result.version}, {"case", result.case_name}, {"status", result.status}};
  if (result.triangles > 0) out["mesh"] = mesh_section(result);
  if (result.state) out["state"] = state_section(*result.state);
  if (result.contact) out["contact"] = contact_section(*result.contact);
  for (const CrackResult& crack : result.cracks) out["cracks"].push_back(crack_section(crack));
  if (result.functional) {
    out["functional"] = {{"kind", result.functional->first}, {"value", number(result.functional->second)}};
  }
  if (result.map) out["map"] = map_section(*result.map);
  out["time_s"] = time_section(result.seconds);
  out["peak_memory_mb"] = number(result.peak_memory_mb);
  if (!result.title.empty()) out["title"] = result.title;
  if (result.reason) out["reason"] = *result.reason;
  // Names come from users: bytes that are no UTF-8 are replaced, not thrown about.
  write_file(path, out.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

void write_csv(const std::filesystem::path& path, const std::vector<std::string>& columns,
               const std::vector<std::vector<double>>& rows) {
  fmt::memory_buffer out;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    fmt::format_to(std::back_inserter(out), "{}{}", i > 0 ? "," : "", quoted(columns[i]));
  }
  out.push_back('\n');
  for (const auto& row : rows) {
    if (row.size() != columns.size()) {
      throw std::invalid_argument(
          fmt::format("a row of '{}' has {} values; {} would be right", path.string(), row.size(), columns.size()));
    }
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) out.push_back(',');
      append_cell(out, row[i]);
    }
    out.push_back('\n');
  }
  write_file(path, view(out));
}

void write_crack_csv(const std::filesystem::path& path, const CrackResult& crack) {
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "s,x,y,jump_n,jump_t,sigma_n,sigma_t,status\n");
  for (const CrackRow& row : crack.rows) {
    for (const double value : {row.s, row.at.x(), row.at.y(), row.jump_n, row.jump_t, row.sigma_n, row.sigma_t}) {
      append_cell(out, value);
      out.push_back(',');
    }
    fmt::format_to(std::back_inserter(out), "{}\n", row.closed ? "closed" : "open");
  }
  write_file(path, view(out));
}

}  // namespace kerf
