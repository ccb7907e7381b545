// Sections of the page with tables: mesh, state with its resultants, load cases, contact, cracks with their tips. Long
// tables of rows along a crack are thinned evenly to 60 rows, with the name of the file that has all of them. Numbers
// carry their units where the case names units.

#include "io/text.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/sections.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

namespace {

std::string mesh_table(const Result& r) {
  Facts facts;
  facts.add("triangles", fmt::format("{}", r.triangles));
  facts.add("vertices", fmt::format("{}", r.vertices));
  facts.add("shortest edge", with_unit(r.mesh.h_min, r.units, dimension::length));
  facts.add("longest edge", with_unit(r.mesh.h_max, r.units, dimension::length));
  facts.add("smallest angle", fmt::format("{:.1f}°", r.mesh.min_angle_deg));
  facts.add("mean quality", fmt::format("{:.3f}", r.mesh.mean_quality));
  if (r.adapt) {
    facts.add("refinement", escape_html(r.adapt->stopped));
    for (const auto& [triangles, error] : r.adapt->rounds)
      facts.add(fmt::format("{} triangles", triangles), "estimated error " + pretty(error));
  }
  return facts.table();
}

std::string state_table(const Result& r) {
  const StateResult& s = *r.state;
  const Units& u = r.units;
  Facts facts;
  facts.add("element", escape_html(s.element) + fmt::format(", degree {}", s.degree));
  facts.add("unknowns", fmt::format("{}", s.unknowns));
  facts.add("after condensation", fmt::format("{}", s.condensed_unknowns));
  facts.add("residual", pretty(s.residual));
  facts.add("energy", with_unit(s.energy, u, dimension::energy));
  facts.add("compliance", with_unit(s.compliance, u, dimension::energy));
  facts.add("area", with_unit(s.area, u, dimension::area));
  if (s.von_mises) add_peak(facts, "largest von Mises stress", *s.von_mises, u, dimension::stress);
  if (s.displacement) add_peak(facts, "largest displacement", *s.displacement, u, dimension::length);
  for (const ReserveResult& r : s.reserves) add_reserve(facts, r, u);
  if (s.estimated_error) facts.add("estimated error", pretty(*s.estimated_error));
  if (s.energy_bounds)
    facts.add(s.of_polygon ? "energy of the polygon between" : "energy between",
              pretty((*s.energy_bounds)[0]) + " and " + with_unit((*s.energy_bounds)[1], u, dimension::energy));
  if (r.functional) {
    facts.add("functional " + r.functional->kind, with_unit(r.functional->value, u, r.functional_dimension));
    for (const auto& term : r.functional->terms)
      facts.add(pretty(term.factor) + " times " + term.kind, pretty(term.value));
  }
  std::string out = facts.table();
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const char* what, const ResultantResult& f) {
    rows.push_back({escape_html(f.on.empty() ? std::string(what) : fmt::format("{} on {}", what, f.on)),
                    pretty(f.force.x()), pretty(f.force.y()), pretty(f.moment)});
  };
  for (const ResultantResult& f : s.loads) add("load", f);
  for (const ResultantResult& f : s.reactions) add("reaction", f);
  if (s.body) add("body force", *s.body);
  if (s.balance) add("sum of all", *s.balance);
  if (!rows.empty()) out += table({"resultant", "force x", "force y", "moment about the origin"}, rows);
  return out;
}

/// A row per load case, that of the pictures in bold.
std::string load_case_table(const Result& r) {
  const auto placed = [&](const std::optional<Peak>& peak) -> std::string {
    if (!peak) return "–";
    const bool regular = peak->singular && peak->regular;
    const PlacedValue& v = regular ? *peak->regular : peak->largest;
    const std::string margin = v.margin && std::isfinite(*v.margin) ? fmt::format(" ± {:.2g}", *v.margin) : "";
    return pretty(v.value) + margin + " at " + at_place(v.at) + (peak->singular && !regular ? " (singular)" : "");
  };
  const auto head = [&](const char* name, const Dimension& of) {
    return r.units.given() ? fmt::format("{} in {}", name, escape_html(unit(r.units, of))) : std::string(name);
  };
  std::vector<std::vector<std::string>> rows, reactions;
  for (const LoadCaseResult& c : r.load_cases) {
    const bool shown = r.state && r.state->load_case == c.name;
    rows.push_back({shown ? "<b>" + escape_html(c.name) + "</b> (shown)" : escape_html(c.name), pretty(c.weight),
                    pretty(c.compliance), placed(c.von_mises), placed(c.displacement)});
    for (const ResultantResult& f : c.reactions)
      reactions.push_back(
          {escape_html(c.name), escape_html(f.on), pretty(f.force.x()), pretty(f.force.y()), pretty(f.moment)});
  }
  std::string out =
      table({"load case", "weight", head("compliance", dimension::energy),
             head("largest von Mises stress", dimension::stress), head("largest displacement", dimension::length)},
            rows);
  if (!reactions.empty())
    out += folded("Reactions under each load case",
                  table({"load case", "reaction on", "force x", "force y", "moment about the origin"}, reactions));
  return out;
}

std::string contact_table(const Result& r) {
  const ContactResultSummary& c = *r.contact;
  Facts facts;
  facts.add("method", escape_html(c.method));
  facts.add("iterations", fmt::format("{}", c.iterations));
  facts.add("linear solves", fmt::format("{}", c.linear_solves));
  facts.add("KKT residual", pretty(c.kkt));
  facts.add("open length", with_unit(c.open_length, r.units, dimension::length));
  facts.add("closed length", with_unit(c.closed_length, r.units, dimension::length));
  facts.add("biactive length", with_unit(c.biactive_length, r.units, dimension::length));
  return facts.table();
}

/// At most so many rows, evenly spread.
std::string crack_rows(const CrackResult& crack) {
  constexpr std::size_t most = 60;
  const std::size_t stride = std::max<std::size_t>(1, (crack.rows.size() + most - 1) / most);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < crack.rows.size(); i += stride) {
    const CrackRow& row = crack.rows[i];
    rows.push_back({pretty(row.s), at_place(row.at), pretty(row.jump_n + row.gap), pretty(row.jump_t),
                    pretty(-row.sigma_n - row.fluid_pressure), row.closed ? "closed" : "open"});
  }
  std::string out = table({"arc length", "at", "opening", "slip", "pressure", "contact"}, rows);
  if (stride > 1)
    out += fmt::format("<p class=\"dim\">Every {} rows; all of them are in crack_{}.csv.</p>\n", stride,
                       escape_html(crack.name));
  return out;
}

std::string curve_slots(const CrackResult& crack, std::size_t i) {
  std::string out = "<div class=\"curves\">\n";
  for (const char* id : {"opening", "slip", "pressure"})
    out += fmt::format("<figure id=\"crack-{}-{}\"><div class=\"plot\"></div></figure>\n", i, id);
  out += "</div>\n";
  const bool closed = std::any_of(crack.rows.begin(), crack.rows.end(), [](const CrackRow& row) { return row.closed; });
  if (closed) out += "<p class=\"dim\">Shaded: closed.</p>\n";
  return out;
}

std::string crack_section(const CrackResult& crack, std::size_t i, const Units& u) {
  std::string out =
      fmt::format("<h3>Crack {}{}</h3>\n", escape_html(crack.name), crack.half ? ", in a plane of symmetry" : "");
  if (crack.rows.size() > 1) out += curve_slots(crack, i);
  Facts facts;
  facts.add("length", with_unit(crack.length, u, dimension::length));
  facts.add("largest opening", with_unit(crack.max_opening, u, dimension::length));
  if (crack.fluid_pressure) facts.add("fluid pressure", with_unit(*crack.fluid_pressure, u, dimension::stress));
  if (crack.pressure)
    add_peak(facts, "largest pressure", *crack.pressure, u, dimension::stress);
  else
    facts.add("largest pressure", with_unit(crack.max_pressure, u, dimension::stress));
  out += facts.table();
  std::vector<std::vector<std::string>> rows;
  for (const auto& t : crack.transitions) rows.push_back({at_place(t.at), escape_html(t.from), escape_html(t.to)});
  if (!rows.empty()) out += table({"transition at", "from", "to"}, rows);
  rows.clear();
  for (const TipResult& tip : crack.tips) {
    using Margin = TipResult::Margin;
    const auto number = [&](const std::optional<double>& value, double Margin::*margin) {
      const std::string out = number_or_dash(value);
      return value && tip.margin ? fmt::format("{} ± {:.2g}", out, (*tip.margin).*margin) : out;
    };
    rows.push_back({at_place(tip.at) + (tip.note.empty() ? "" : ", " + escape_html(tip.note)),
                    number(tip.K_I, &Margin::K_I), number(tip.K_II, &Margin::K_II), number(tip.G, &Margin::G),
                    number(tip.T, &Margin::T)});
  }
  const auto head = [&](const char* name, const Dimension& of) {
    return u.given() ? fmt::format("{} in {}", name, escape_html(unit(u, of))) : std::string(name);
  };
  if (!rows.empty())
    out += table(
        {"tip", head("K<sub>I</sub>", dimension::stress_intensity), head("K<sub>II</sub>", dimension::stress_intensity),
         head("G", dimension::release_rate), head("T", dimension::stress)},
        rows);
  if (crack.rows.size() > 1)
    out += folded(fmt::format("Opening, slip and pressure along {}", crack.name), crack_rows(crack));
  return out;
}

}  // namespace

std::string cracks_section(const Result& r) {
  if (r.cracks.empty()) return {};
  std::string out = "<h2>Cracks</h2>\n";
  for (std::size_t i = 0; i < r.cracks.size(); ++i) out += crack_section(r.cracks[i], i, r.units);
  return out;
}

std::string load_cases_section(const Result& r) {
  return r.load_cases.empty() ? std::string() : "<h2>Load cases</h2>\n" + load_case_table(r);
}

std::string tables_section(const Result& r) {
  std::string out;
  if (r.triangles > 0) out += folded_section("Mesh", fmt::format("{} triangles", r.triangles), mesh_table(r));
  if (r.state) out += folded_section("State", "energies, largest values, resultants", state_table(r));
  if (r.contact) out += folded_section("Contact", "how it was solved, what is open and closed", contact_table(r));
  return out;
}

}  // namespace kerf
