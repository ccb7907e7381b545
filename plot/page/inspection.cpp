// The report of an inspection on one page, to be printed: the part with its loads, material and law as the case gives
// them, the map, the worst places with lengths, lives and intervals, what was proved by drawn cracks, and what is not
// covered. No script: a policy in the head allows styles and the picture in the file and nothing else.

#include "plot/inspection.hpp"

#include "io/files.hpp"
#include "io/text.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

namespace kerf {

namespace {

constexpr std::string_view sheet =
    "body{font:8.5pt/1.25 sans-serif;margin:12mm auto;max-width:190mm;color:#111}h1{font-size:13pt;margin:0 0 1mm}"
    "h2{font-size:10pt;margin:2.5mm 0 .5mm}h3{font-size:9pt;margin:2mm 0 .5mm}p{margin:.7mm 0}"
    "pre{font-size:6.5pt;line-height:1.15;background:#f4f4f4;padding:1.5mm;margin:.5mm "
    "0;columns:2;white-space:pre-wrap}"
    "table{border-collapse:collapse;font-size:7.5pt}th,td{border-bottom:.2mm solid #bbb;padding:.3mm "
    "1.2mm;white-space:nowrap;"
    "text-align:right}img{max-width:100%;max-height:58mm;display:block;margin:1mm auto}"
    "@page{size:A4;margin:10mm}@media print{body{margin:0;max-width:none;zoom:.8}}";

/// The tables of a case that say what the part is, as HTML: lines from their heads to the next one, without empty ones.
std::string tables_of_case(const std::string& text) {
  constexpr std::array<std::string_view, 10> wanted{"units",     "material", "region", "boundary", "load",
                                                    "load_case", "body",     "define", "map",      "inspect"};
  std::string out;
  bool keep = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    if (line.starts_with('[')) {
      const std::size_t from = line.find_first_not_of('['), to = line.find_first_of(".]", from);
      keep = from != std::string::npos &&
             std::ranges::find(wanted, std::string_view(line).substr(from, to - from)) != wanted.end();
    }
    if (keep && line.find_first_not_of(" \t\r") != std::string::npos) out += escape_html(line) + '\n';
  }
  return out;
}

std::string inside_table(const EdgeCrackResult& e) {
  std::vector<std::vector<std::string>> rows;
  constexpr std::size_t most = 3;
  for (const inspect::InteriorCrack& crack : std::span(e.inside).first(std::min(most, e.inside.size())))
    rows.push_back({std::to_string(rows.size() + 1), at_place(crack.at), pretty(crack.K), pretty(crack.K_I),
                    pretty(crack.K_II), fmt::format("{:.0f}", crack.direction * 180 / pi),
                    crack.closed ? "closed" : "open"});
  return table({"", "middle at", "K", "K<sub>I</sub>", "K<sub>II</sub>", "degrees", "faces"}, rows);
}

std::string not_covered(const EdgeCrackResult& e) {
  std::string out = "<h2>Not covered</h2>\n<p>";
  if (e.masked_share > 0) {
    out += fmt::format("{:.1f} % of the boundary: ", 100 * e.masked_share);
    bool first = true;
    for (std::size_t i = 0; i < e.masked_by.size(); ++i)
      if (e.masked_by[i] > 0) {
        out += fmt::format("{}{} {:.1f} %", first ? "" : ", ", word(inspect::reasons_to_mask[i]), 100 * e.masked_by[i]);
        first = false;
      }
    out += ". ";
  }
  out +=
      "Cracks through corners, along borders of materials, longer than the length up to which K is good, or more than "
      "one at a time; cracks that turn while they grow; residual stresses, scatter of the law and of the loads, "
      "corrosion and retardation, unless the loads and the law above have them.";
  if (e.drawn.empty()) out += " No crack was drawn and solved for comparison: kerf validate does.";
  return out + "</p>\n";
}

}  // namespace

std::string inspection_page(const Result& r, const std::string& case_text, std::string_view picture) {
  const EdgeCrackResult& e = *r.edge_cracks;
  const std::string title = escape_html(r.title.empty() ? r.case_name : r.title);
  std::string out = html_head((r.title.empty() ? r.case_name : r.title) + ": inspection",
                              "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; "
                              "form-action 'none'",
                              sheet);
  out += fmt::format("<h1>{}: damage tolerance</h1>\n", title);
  out += fmt::format("<p>Case {}, status {}. Mesh of {} triangles", escape_html(r.case_name), escape_html(r.status),
                     r.triangles);
  if (r.state) {
    out += fmt::format(", elements {} of degree {}", escape_html(r.state->element), r.state->degree);
    if (r.state->estimated_error)
      out += fmt::format(", estimated error of the stress {:.2g} %", 100 * *r.state->estimated_error);
  }
  out += fmt::format(". Cracks of length {}{}.</p>\n", pretty(e.length),
                     with_blank(escape_html(unit(r.units, dimension::length))));
  if (const std::string given = tables_of_case(case_text); !given.empty())
    out += "<h2>Material, loads and law, as given</h2>\n<pre>" + given + "</pre>\n";
  if (!picture.empty())
    out += fmt::format(
        "<h2>Map</h2>\n<img alt=\"the part, its boundary in colors of K\" "
        "src=\"data:image/png;base64,{}\">\n",
        base64(picture));
  out += edge_cracks_section(e, r.units);
  if (!e.inside.empty()) out += "<h2>Cracks of that length inside the body</h2>\n" + inside_table(e);
  out += not_covered(e);
  out +=
      "<h2>Sources</h2>\n<p>K by the state of the part without a crack, expanded for short edge cracks with curvature, "
      "slope of the stress, angle and closed faces (theory M.1 to M.7 of the manual); lives by the law above along the "
      "line of each crack (G.13).</p>\n";
  return out + fmt::format("<p>kerf {}</p>\n</body>\n</html>\n", escape_html(r.version));
}

void write_inspection(const std::filesystem::path& path, const Result& result, const std::string& case_text,
                      std::string_view picture) {
  write_file(path, inspection_page(result, case_text, picture));
}

}  // namespace kerf
