#include "io/files.hpp"
#include "io/history.hpp"
#include "io/result.hpp"
#include "io/text.hpp"
#include "io/validation.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr const char* style = R"css(
:root { --ink: #1c242c; --dim: #5a6570; --rule: #d8dee4; --soft: #f4f6f8; --accent: #2a788e; }
* { box-sizing: border-box; }
body { margin: 0; color: var(--ink); background: #fff; font: 16px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 2rem 1.25rem 3rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .3rem; overflow-wrap: anywhere; }
h2 { font-size: 1.25rem; margin: 2.4rem 0 .7rem; padding-bottom: .3rem; border-bottom: 1px solid var(--rule); }
h3 { font-size: 1.05rem; margin: 1.5rem 0 .5rem; overflow-wrap: anywhere; }
p { margin: .4rem 0; overflow-wrap: anywhere; }
.dim { color: var(--dim); fill: var(--dim); }
.status { display: inline-block; padding: 0 .6em; border-radius: 1em; color: #fff; background: #2e7d4f; font-size: .85em; }
.status.bad { background: #b3261e; }
.note { padding: .5rem .9rem; border-left: 4px solid var(--accent); background: var(--soft); }
.note.bad { border-color: #b3261e; }
.key { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: .7rem; margin: 1.4rem 0; }
.key div { padding: .6rem .9rem; background: var(--soft); border-radius: 6px; }
.key b { display: block; font-size: 1.2rem; font-variant-numeric: tabular-nums; overflow-wrap: anywhere; }
.key span { color: var(--dim); font-size: .85rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .3rem 0 1rem; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem 1.1rem .3rem 0; text-align: right; border-bottom: 1px solid var(--rule); white-space: nowrap; }
th:first-child, td:first-child, .facts td { text-align: left; }
th { color: var(--dim); font-weight: 600; font-size: .88rem; }
.facts th { width: 12rem; text-align: left; }
figure { margin: 1.2rem 0; text-align: center; }
figure img { max-width: 100%; max-height: 92vh; height: auto; }
figcaption { color: var(--dim); font-size: .92rem; overflow-wrap: anywhere; }
svg { display: block; width: 100%; max-width: 720px; height: auto; font: 14px system-ui, "DejaVu Sans", sans-serif; }
svg text { fill: var(--ink); } svg .dim { fill: var(--dim); } svg .name { font-weight: 600; }
svg .grid { stroke: var(--rule); } svg .axis { stroke: #8a949e; fill: none; } svg .closed { fill: #e8ecf1; }
footer { margin-top: 3rem; padding-top: .8rem; border-top: 1px solid var(--rule); color: var(--dim); font-size: .88rem; }
@media print { main { max-width: none; padding: 0; } figure, table, svg { break-inside: avoid; } h2, h3 { break-after: avoid; } }
)css";

constexpr std::size_t most_rows = 200;  // of a table

std::string at(const Vec2& p) {
  return fmt::format("({}, {})", pretty(p.x()), pretty(p.y()));
}

std::string value(const std::optional<double>& v) {
  return v ? pretty(*v) : "–";
}

/// Rows of name and value; values arrive as HTML.
struct Facts {
  std::string html;
  void add(const std::string& name, const std::string& value) {
    html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escape_html(name), value);
  }
  std::string table() const {
    return fmt::format("<div class=\"scroll\"><table class=\"facts\">\n{}</table></div>\n", html);
  }
};

std::string table(const std::vector<std::string>& heads, const std::vector<std::vector<std::string>>& rows) {
  std::string out = "<div class=\"scroll\"><table>\n<tr>";
  for (const auto& head : heads) out += fmt::format("<th scope=\"col\">{}</th>", head);
  out += "</tr>\n";
  for (const auto& row : rows) {
    out += "<tr>";
    for (const auto& cell : row) out += fmt::format("<td>{}</td>", cell);
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string head(const Result& result, const std::string& title) {
  const bool good = result.status == "ok";
  std::string out = fmt::format("<h1>{}</h1>\n<p class=\"dim\">case {} <span class=\"status{}\">{}</span></p>\n", title,
                                escape_html(result.case_name), good ? "" : " bad", escape_html(result.status));
  if (result.reason) out += fmt::format("<p class=\"note bad\">{}</p>\n", escape_html(*result.reason));
  if (result.state) {
    for (const auto& note : result.state->notes) out += fmt::format("<p class=\"note\">{}</p>\n", escape_html(note));
  }
  return out;
}

/// A number with its unit, where there is one.
std::string with_unit(double value, const Units& units, const std::optional<Dimension>& dimension) {
  return pretty(value) + escape_html(with_blank(dimension ? unit(units, *dimension) : std::string()));
}

std::string key_numbers(const Result& result) {
  std::string out;
  const auto add = [&](const std::string& name, const std::string& number) {
    out += fmt::format("<div><b>{}</b><span>{}</span></div>\n", number, escape_html(name));
  };
  if (result.triangles > 0) add("triangles", fmt::format("{}", result.triangles));
  if (result.state) {
    add("unknowns", fmt::format("{}", result.state->unknowns));
    add("energy", with_unit(result.state->energy, result.units, dimension::energy));
    add("compliance", with_unit(result.state->compliance, result.units, dimension::energy));
  }
  if (result.optimize) {
    add("objective", with_unit(result.optimize->objective, result.units, result.functional_dimension));
    add("volume fraction", pretty(result.optimize->volume_fraction, 4));
  }
  if (result.functional)
    add(result.functional->kind + " (functional)",
        with_unit(result.functional->value, result.units, result.functional_dimension));
  if (std::isfinite(result.seconds.total)) add("seconds", fmt::format("{:.3g}", result.seconds.total));
  return fmt::format("<div class=\"key\">\n{}</div>\n", out);
}

/// What a finer mesh does not change first.
void add_peak(Facts& facts, const std::string& name, const Peak& peak, const Units& units, const Dimension& of) {
  const auto placed = [&](const PlacedValue& v) { return with_unit(v.value, units, of) + " at " + at(v.at); };
  if (!peak.singular) return facts.add(name, placed(peak.largest));
  facts.add(name, peak.regular ? placed(*peak.regular) : "only near singular points");
  facts.add(name + ", singular", placed(peak.largest) + " (larger on finer meshes)");
}

std::string mesh_and_state(const Result& result) {
  std::string out;
  if (result.triangles > 0) {
    Facts facts;
    facts.add("triangles", fmt::format("{}", result.triangles));
    facts.add("vertices", fmt::format("{}", result.vertices));
    facts.add("shortest edge", pretty(result.mesh.h_min));
    facts.add("longest edge", pretty(result.mesh.h_max));
    facts.add("smallest angle", fmt::format("{:.1f}°", result.mesh.min_angle_deg));
    facts.add("mean quality", fmt::format("{:.3f}", result.mesh.mean_quality));
    if (result.adapt) {
      facts.add("refinement", escape_html(result.adapt->stopped));
      for (const auto& [triangles, error] : result.adapt->rounds)
        facts.add(fmt::format("{} triangles", triangles), "estimated error " + pretty(error));
    }
    out += "<h2>Mesh</h2>\n" + facts.table();
  }
  if (result.state) {
    const StateResult& s = *result.state;
    Facts facts;
    facts.add("element", escape_html(s.element) + fmt::format(", degree {}", s.degree));
    facts.add("unknowns", fmt::format("{}", s.unknowns));
    facts.add("after condensation", fmt::format("{}", s.condensed_unknowns));
    facts.add("residual", pretty(s.residual));
    const Units& u = result.units;
    facts.add("energy", with_unit(s.energy, u, dimension::energy));
    facts.add("compliance", with_unit(s.compliance, u, dimension::energy));
    facts.add("area", with_unit(s.area, u, dimension::area));
    if (s.von_mises) add_peak(facts, "largest von Mises stress", *s.von_mises, u, dimension::stress);
    if (s.displacement) add_peak(facts, "largest displacement", *s.displacement, u, dimension::length);
    if (s.estimated_error) facts.add("estimated error", pretty(*s.estimated_error));
    if (s.energy_bounds)
      facts.add(s.of_polygon ? "energy of the polygon between" : "energy between",
                pretty((*s.energy_bounds)[0]) + " and " + with_unit((*s.energy_bounds)[1], u, dimension::energy));
    if (result.functional) {
      facts.add("functional " + result.functional->kind,
                with_unit(result.functional->value, u, result.functional_dimension));
      for (const auto& term : result.functional->terms)
        facts.add(pretty(term.factor) + " times " + term.kind, pretty(term.value));
    }
    out += "<h2>State</h2>\n" + facts.table();
  }
  return out;
}

std::string crack_section(const CrackResult& crack, const Units& u) {
  Facts facts;
  facts.add("length", with_unit(crack.length, u, dimension::length));
  facts.add("largest opening", with_unit(crack.max_opening, u, dimension::length));
  if (crack.fluid_pressure) facts.add("fluid pressure", with_unit(*crack.fluid_pressure, u, dimension::stress));
  if (crack.pressure)
    add_peak(facts, "largest pressure", *crack.pressure, u, dimension::stress);
  else
    facts.add("largest pressure", with_unit(crack.max_pressure, u, dimension::stress));
  std::string out = fmt::format("<h3>Crack {}</h3>\n", escape_html(crack.name)) + facts.table();
  std::vector<std::vector<std::string>> rows;
  for (const auto& t : crack.transitions) rows.push_back({at(t.at), escape_html(t.from), escape_html(t.to)});
  if (!rows.empty()) out += table({"transition at", "from", "to"}, rows);
  rows.clear();
  for (const TipResult& tip : crack.tips)
    rows.push_back({at(tip.at), value(tip.K_I), value(tip.K_II), value(tip.G), value(tip.T)});
  if (!rows.empty()) {
    const auto head = [&](const char* name, const Dimension& of) {
      return u.given() ? fmt::format("{} in {}", name, escape_html(unit(u, of))) : std::string(name);
    };
    out += table(
        {"tip", head("K<sub>I</sub>", dimension::stress_intensity), head("K<sub>II</sub>", dimension::stress_intensity),
         head("G", dimension::release_rate), head("T", dimension::stress)},
        rows);
  }
  const std::string opening =
      crack_curve(crack, {"opening", "#b3261e", [](const CrackRow& row) { return row.jump_n; }});
  const std::string pressure = crack_curve(
      crack, {"pressure", "#2a788e", [](const CrackRow& row) { return -row.sigma_n - row.fluid_pressure; }});
  out += opening + pressure;
  if (crack.fluid_pressure)
    out += crack_curve(crack, {"fluid pressure", "#2a788e", [](const CrackRow& row) { return row.fluid_pressure; }});
  if (!opening.empty()) out += "<p class=\"dim\">Shaded: closed.</p>\n";
  return out;
}

std::string contact_and_cracks(const Result& result) {
  std::string out;
  if (result.contact) {
    const ContactResultSummary& c = *result.contact;
    Facts facts;
    facts.add("method", escape_html(c.method));
    facts.add("iterations", fmt::format("{}", c.iterations));
    facts.add("linear solves", fmt::format("{}", c.linear_solves));
    facts.add("KKT residual", pretty(c.kkt));
    facts.add("open length", pretty(c.open_length));
    facts.add("closed length", pretty(c.closed_length));
    facts.add("biactive length", pretty(c.biactive_length));
    out += "<h2>Contact</h2>\n" + facts.table();
  }
  if (!result.cracks.empty()) out += "<h2>Cracks</h2>\n";
  for (const CrackResult& crack : result.cracks) out += crack_section(crack, result.units);
  return out;
}

std::string map_section(const MapResult& map, const std::string& unit) {
  std::string out = fmt::format("<h2>Topological derivative: {}</h2>\n", escape_html(map.perturbation));
  out += table({"", "value" + (unit.empty() ? "" : " in " + escape_html(unit)), "at"},
               {{"min", pretty(map.min.value), at(map.min.at)}, {"max", pretty(map.max.value), at(map.max.at)}});
  if (map.excluded_radius > 0) {
    out += fmt::format("<p class=\"dim\">Min and max leave out {} around crack tips and reentrant corners.</p>\n",
                       pretty(map.excluded_radius));
  }
  if (map.masked_share > 0)
    out += fmt::format(
        "<p class=\"dim\">The expansion cannot hold at radius {} on {:.3g} % of the area (gray in the "
        "picture): too near to a boundary, a crack, a tip or an end of contact, a support or a load. Min "
        "and max leave it out.</p>\n",
        pretty(map.radius), 100 * map.masked_share);
  if (map.biactive_length > 0)
    out += fmt::format(
        "<p class=\"note\">A length {} of the cracks has neither gap nor pressure: J has one-sided derivatives, and "
        "the "
        "map is of these.</p>\n",
        pretty(map.biactive_length));
  std::vector<std::string> heads = {"point", "value", "lower", "upper"};
  if (map.oriented) heads.push_back("angle");
  heads.push_back("expansion");
  std::vector<std::vector<std::string>> rows;
  for (const MapPoint& p : map.points) {
    if (rows.size() == most_rows) break;
    rows.push_back({at(p.at), pretty(p.value), value(p.lower), value(p.upper)});
    if (map.oriented) rows.back().push_back(fmt::format("{:.1f}°", degrees(p.angle)));
    rows.back().push_back(!std::isfinite(p.value) ? "–" : p.masked ? "masked" : "valid");
  }
  if (!rows.empty()) out += table(heads, rows);
  if (map.points.size() > most_rows)
    out += fmt::format("<p class=\"dim\">{} more points are in map.csv.</p>\n", map.points.size() - most_rows);
  return out;
}

std::string validation_section(const ValidationResult& validation, const std::string& figure) {
  std::string out = fmt::format("<h2>Validation: {}</h2>\n", escape_html(validation.perturbation));
  std::vector<std::vector<std::string>> rows;
  for (const Validation& v : validation.points) {
    out += fmt::format("<p class=\"note{}\">{}</p>\n", v.verdict == Verdict::Fails ? " bad" : "",
                       escape_html(sentence(v)));
    if (rows.size() < most_rows)
      rows.push_back({at(v.at), std::string(word(v.verdict)), pretty(v.coefficient), pretty(v.intercept),
                      pretty(v.order), pretty(v.plateau), pretty(v.c2), pretty(v.c3)});
  }
  out += table({"point", "expansion", "T", "intercept", "order", "plateau", "c<sub>2</sub>", "c<sub>3</sub>"}, rows);
  out +=
      "<p class=\"dim\">Intercept, c<sub>2</sub>, c<sub>3</sub>: of the fit T + c<sub>2</sub> ε² + c<sub>3</sub> ε² "
      "ln ε to the difference over its scale (π ε²). Plateau: relative error that the mesh leaves.</p>\n" +
      figure;
  rows.clear();
  std::size_t left_out = 0;
  for (const Validation& v : validation.points)
    for (const ValidationRow& row : v.rows) {
      if (rows.size() == most_rows) {
        ++left_out;
        continue;
      }
      rows.push_back({at(v.at), pretty(row.radius), pretty(row.J), pretty(row.difference), pretty(row.predicted),
                      pretty(row.remainder), pretty(row.order), row.same_contact ? "same" : "changed"});
    }
  if (!rows.empty())
    out += table({"point", "radius", "J", "difference", "predicted", "remainder", "order", "contact"}, rows);
  if (left_out > 0) out += fmt::format("<p class=\"dim\">{} more rows are in validate.csv.</p>\n", left_out);
  return out;
}

/// Rows of the history: all, or the first, the last and some between.
std::string history_table(const std::vector<Iteration>& history, const OptimizeNames& names) {
  constexpr std::size_t most = 40;
  std::vector<std::string> heads = {"iteration",  "objective", "volume",    "step",
                                    "optimality", "holes",     "triangles", "state solves"};
  for (const std::string& name : names.bounds) heads.push_back(escape_html(name));
  heads.emplace_back("note");
  std::vector<std::vector<std::string>> rows;
  const std::size_t stride = (history.size() + most - 1) / most;
  for (std::size_t i = 0; i < history.size(); ++i) {
    const Iteration& row = history[i];
    if (i % stride != 0 && i + 1 != history.size()) continue;
    rows.push_back({fmt::format("{}", row.number), pretty(row.objective), pretty(row.volume_fraction, 4),
                    pretty(row.step, 3), pretty(row.optimality, 3), fmt::format("{}", row.holes),
                    fmt::format("{}", row.triangles), fmt::format("{}", row.state_solves)});
    for (std::size_t k = 0; k < names.bounds.size(); ++k)
      rows.back().push_back(k < row.bounds.size() ? pretty(row.bounds[k]) : "–");
    rows.back().push_back(escape_html(row.note));
  }
  std::string out = table(heads, rows);
  if (stride > 1)
    out += fmt::format("<p class=\"dim\">Every {} iterations; all of them are in history.csv.</p>\n", stride);
  return out;
}

std::string optimize_section(const OptimizeResult& o, const OptimizeNames& names, const std::string& figures) {
  std::string out = "<h2>Optimization</h2>\n";
  out += fmt::format("<p class=\"note{}\">{}</p>\n", o.feasible ? "" : " bad", escape_html(sentence(o)));
  Facts facts;
  facts.add("method", escape_html(word(o.method)));
  if (!o.history.empty()) facts.add("objective at the start", pretty(o.history.front().objective));
  facts.add("objective", pretty(o.objective));
  facts.add("volume fraction",
            pretty(o.volume_fraction) +
                (names.volume_at_most ? fmt::format(" (at most {})", pretty(*names.volume_at_most)) : ""));
  if (!o.history.empty())
    for (std::size_t i = 0; i < std::min(names.bounds.size(), o.history.back().bounds.size()); ++i)
      facts.add(names.bounds[i],
                fmt::format("{} (at most {})", pretty(o.history.back().bounds[i]), pretty(names.at_most[i])));
  if (std::isfinite(o.optimality)) facts.add("optimality", pretty(o.optimality, 3));
  facts.add("state solves", fmt::format("{}", o.state_solves));
  out += facts.table();
  for (const std::string& note : o.notes) out += fmt::format("<p class=\"note\">{}</p>\n", escape_html(note));
  out += figures;
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < std::min(names.variables.size(), static_cast<std::size_t>(o.variables.size())); ++i)
    rows.push_back({escape_html(names.variables[i]), pretty(o.variables[static_cast<Eigen::Index>(i)])});
  if (!rows.empty()) out += table({"variable", "value"}, rows);
  if (!o.history.empty()) out += history_table(o.history, names);
  return out;
}

}  // namespace

void write_page(const std::filesystem::path& path, const Result& result,
                const std::vector<std::pair<std::string, std::filesystem::path>>& pictures) {
  const std::string title = escape_html(result.title.empty() ? result.case_name : result.title);
  std::string out = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>{}</style>\n"
      "</head>\n<body>\n<main>\n",
      title, style);
  out += head(result, title) + key_numbers(result);
  std::string validation_figure, optimize_figures;
  for (const auto& [caption, file] : pictures) {
    const std::string text = escape_html(caption);
    const std::string name = file.filename().string();
    (name == "validate.png"                                                    ? validation_figure
     : name == "evolution.png" || name == "history.png" || name == "found.png" ? optimize_figures
                                                                               : out) +=
        fmt::format("<figure><img alt=\"{}\" src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
                    text, base64(read_file(file)), text);
  }
  if (result.optimize) out += optimize_section(*result.optimize, result.optimize_names, optimize_figures);
  if (result.fit)
    for (const std::string& line : in_words(*result.fit, result.optimize_names.variables))
      out += fmt::format("<p class=\"note\">{}</p>\n", escape_html(line));
  for (const Identified& i : result.identified)
    out += fmt::format("<p class=\"note\">{}</p>\n", escape_html(in_words(i)));
  out += mesh_and_state(result) + contact_and_cracks(result);
  if (result.map)
    out += map_section(*result.map,
                       result.functional_dimension ? unit(result.units, per_area(*result.functional_dimension)) : "");
  if (result.validate) out += validation_section(*result.validate, validation_figure);
  out += "<h2>Time</h2>\n" + time_bars(result.seconds);
  out += fmt::format("<p>Total {:.3f} s", result.seconds.total);
  if (result.peak_memory_mb > 0) out += fmt::format(", peak memory {:.1f} MB", result.peak_memory_mb);
  out += ".</p>\n";
  out += fmt::format("<footer>kerf {}</footer>\n</main>\n</body>\n</html>\n", escape_html(result.version));
  write_file(path, out);
}

}  // namespace kerf
