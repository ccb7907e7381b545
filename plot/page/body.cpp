// What the page says of stress and map in words, under their figures: where the largest value is and whether a finer
// mesh would change it, what a small change of the body does to J (pi eps^2 T), what is masked and why. A singular peak
// is named beside the largest value away from singular points, since the first grows with every finer mesh. A clamped
// hole has no series in eps: there the map is the expected change of J itself. docs/theory/topological_derivatives.md,
// "Clamped holes".

#include "io/map_words.hpp"
#include "io/text.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/sections.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kerf {

namespace {

std::string said(const PlacedValue& v, const std::string& unit) {
  return fmt::format("{}{} at {}", pretty(v.value), with_blank(unit), at_place(v.at));
}

std::string unit_of_map(const Result& r) {
  return r.functional_dimension ? unit(r.units, per_area(*r.functional_dimension)) : std::string();
}

std::string under_load_case(const Result& r) {
  return r.state && !r.state->load_case.empty() ? fmt::format(" Under load case {}.", r.state->load_case)
                                                : std::string();
}

}  // namespace

Finding stress_finding(const Result& r) {
  Finding out{.title = "Stress", .text = {}};
  if (!r.state) return out;
  const auto& s = *r.state;
  if (const auto& peak = s.von_mises) {
    const std::string of = unit(r.units, dimension::stress);
    if (!peak->singular)
      out.text = fmt::format("The von Mises stress is largest, {}.", said(peak->largest, of));
    else if (peak->regular)
      out.text = fmt::format(
          "Away from singular points the von Mises stress is largest, {}; near them it grows with every finer mesh, "
          "here "
          "to {}.",
          said(*peak->regular, of), said(peak->largest, of));
    else
      out.text = fmt::format(
          "The von Mises stress is largest, {}; that is near a singular point, and larger on finer "
          "meshes.",
          said(peak->largest, of));
  }
  if (s.displacement)
    out.text += fmt::format(" The displacement is largest, {}.",
                            said(s.displacement->largest, unit(r.units, dimension::length)));
  if (out.text.empty()) out.text = "The body and its stress.";
  out.text += under_load_case(r);
  return out;
}

Finding map_finding(const Result& r) {
  const MapResult& map = *r.map;
  std::string name = map.perturbation;
  for (char& c : name) c = c == '_' ? ' ' : c;
  const std::string j = r.functional ? r.functional->kind : std::string("functional");
  Finding out{.title = "Topological derivative", .text = {}};
  const bool series = map.perturbation != "clamped_hole";
  out.text = series
                 ? fmt::format("A small {} of area π ε² changes J ({}) by π ε² T.", name, j)
                 : fmt::format("What a {} of radius {} is expected to change of J ({}).", name, pretty(map.radius), j);
  if (std::isfinite(map.min.value))
    out.text += fmt::format(" {} is least, {}, and largest, {}.", series ? "T" : "It", said(map.min, unit_of_map(r)),
                            said(map.max, unit_of_map(r)));
  if (map.masked_share > 0)
    out.text += fmt::format(" Hatched, {:.3g} % of the area: {} for a radius of {}.", 100 * map.masked_share,
                            map.second ? "too near to something else, or the second term above 5 % of the first,"
                                       : "too near to something else",
                            pretty(map.radius));
  out.text += under_load_case(r);
  return out;
}

std::string body_figure(const char* id, const Finding& finding) {
  return fmt::format(
      "<figure class=\"view\" id=\"{}\"><div class=\"stage\" role=\"group\" aria-label=\"{}: {}\"></div>\n"
      "<figcaption>{}</figcaption></figure>\n",
      id, escape_html(finding.title), escape_html(finding.text), escape_html(finding.text));
}

std::string thinned(const Result& r, const PageData& data) {
  const NamedArray* triangles = find_array(data.arrays, "triangles");
  if (!triangles || static_cast<Index>(triangles->rows()) >= r.triangles) return {};
  return fmt::format(
      "<p class=\"dim\">The figures have {} triangles, the mesh {}: neighboring vertices inside the body are drawn as "
      "one. Values at the vertices that are left are those of the mesh.</p>\n",
      triangles->rows(), r.triangles);
}

std::string map_section(const Result& r, const std::string& figure) {
  const MapResult& map = *r.map;
  const std::string of = unit_of_map(r);
  std::string out = fmt::format("<h2>Topological derivative: {}</h2>\n", escape_html(map.perturbation)) + figure;
  if (!std::isfinite(map.min.value)) return out + note(without_extrema(map), true);
  out += table(
      {"", "value" + (of.empty() ? "" : " in " + escape_html(of)), "at"},
      {{"min", pretty(map.min.value), at_place(map.min.at)}, {"max", pretty(map.max.value), at_place(map.max.at)}});
  if (map.excluded_radius > 0)
    out += fmt::format("<p class=\"dim\">Min and max leave out {} around crack tips and reentrant corners.</p>\n",
                       pretty(map.excluded_radius));
  if (map.masked_share > 0)
    out += fmt::format(
        "<p class=\"dim\">The expansion cannot hold at radius {} on {:.3g} % of the area (hatched): {}too near to a "
        "boundary, a crack, a tip or an end of contact, a support or a load. Min and max leave it out.</p>\n",
        pretty(map.radius), 100 * map.masked_share,
        map.second ? "the second term is more than 5 % of the first, or, where it is not known, " : "");
  if (map.biactive_length > 0)
    out +=
        note(fmt::format("A length {} of the cracks has neither gap nor pressure: J has one-sided derivatives, and "
                         "the map is of these.",
                         pretty(map.biactive_length)));
  std::vector<std::string> heads = {"point", "value", "lower", "upper"};
  if (map.oriented) heads.emplace_back("angle");
  heads.emplace_back("expansion");
  std::vector<std::vector<std::string>> rows;
  for (const MapPoint& p : map.points) {
    if (rows.size() == most_rows) break;
    rows.push_back({at_place(p.at), pretty(p.value), number_or_dash(p.lower), number_or_dash(p.upper)});
    if (map.oriented) rows.back().push_back(fmt::format("{:.1f}°", degrees(p.angle)));
    rows.back().emplace_back(!std::isfinite(p.value) ? "–" : p.masked ? "masked" : "valid");
  }
  if (!rows.empty()) out += table(heads, rows);
  if (map.points.size() > most_rows)
    out += fmt::format("<p class=\"dim\">{} more points are in map.csv.</p>\n", map.points.size() - most_rows);
  return out;
}

}  // namespace kerf
