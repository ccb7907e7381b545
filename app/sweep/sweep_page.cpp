// The page of a sweep: failures, numbers over the first swept key whose values are numbers (a curve for each
// combination of the others), a picture of each run (design, map or stress), and the table. It has no script: a policy
// in its head forbids any. Columns are the leaves of result.json, in the order in which they are first met; a run that
// lacks one has an empty cell. Charts are drawn as SVG by hand, without axes that the values on both ends do not need.

#include "app/sweep/sweep_page.hpp"

#include "app/sweep/convergence.hpp"
#include "io/files.hpp"
#include "io/text.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

namespace kerf {

namespace {

namespace fs = std::filesystem;

constexpr const char* style = R"(
:root { color-scheme: light dark; --ink: #1c2733; --paper: #fff; --line: #c8d0d8; --mark: #2a6fb0; --bad: #b03a2a; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e9ee; --paper: #14191f; --line: #3b4653; --mark: #7db8ee; --bad: #f09a8a; } }
body { font: 15px/1.45 system-ui, sans-serif; color: var(--ink); background: var(--paper); margin: 0 auto; max-width: 1200px; padding: 1em; }
.grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(220px, 1fr)); gap: 1em; }
.two { grid-template-columns: 1fr 1fr; }
figure { margin: 0; border: 1px solid var(--line); border-radius: 6px; padding: .5em; overflow-wrap: anywhere; font-size: 13px; }
figure img, figure svg { width: 100%; height: auto; display: block; }
a { color: var(--mark); }
.bad { color: var(--bad); }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13px; }
td, th { border-bottom: 1px solid var(--line); padding: .2em .6em; text-align: right; white-space: nowrap; }
td:first-child, th:first-child { text-align: left; }
svg text { fill: var(--ink); font: 11px system-ui, sans-serif; }
svg .axis { stroke: var(--line); fill: none; }
svg .curve { fill: none; stroke-width: 1.6; }
)";

std::string label(const SweepTable& table, const SweepTable::Row& row, std::size_t but) {
  std::string out;
  for (std::size_t k = 0; k < table.keys.size(); ++k)
    if (k != but)
      out += fmt::format("{}{} = {}", out.empty() ? "" : ", ", table.keys[k].substr(table.keys[k].rfind('.') + 1),
                         row.values[k]);
  return out;
}

/// A number of the results against the first key whose values are numbers, a curve for all that the other keys say.
struct SweepPanel {
  std::string name;
  std::map<std::string, std::vector<std::pair<double, double>>> curves;
  Vec2 low{infinity, infinity}, high{-infinity, -infinity};
};

std::optional<SweepPanel> panel_of(const SweepTable& table, std::size_t key, std::size_t column) {
  SweepPanel out{.name = table.columns[column], .curves = {}};
  std::size_t count = 0;
  for (const SweepTable::Row& row : table.rows) {
    const auto x = number_in(row.values[key]), y = number_in(row.cells[column]);
    if (!x || !y) continue;
    out.curves[label(table, row, key)].emplace_back(*x, *y);
    const Vec2 at(*x, *y);
    out.low = out.low.cwiseMin(at);
    out.high = out.high.cwiseMax(at);
    ++count;
  }
  if (count < 2 || !(out.high.x() > out.low.x()) || !(out.high.y() > out.low.y())) return std::nullopt;
  for (auto& [name, points] : out.curves) std::sort(points.begin(), points.end());
  return out;
}

std::string drawn(const SweepPanel& panel, const std::string& key) {
  constexpr double width = 260, height = 170, left = 12, right = 12, top = 10, bottom = 26;
  const auto at = [&](double x, double y) {
    const Vec2 size = panel.high - panel.low;
    return fmt::format("{:.1f},{:.1f}", left + (width - left - right) * (x - panel.low.x()) / size.x(),
                       height - bottom - (height - top - bottom) * (y - panel.low.y()) / size.y());
  };
  std::string out = fmt::format(
      "<figure><svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{} against {}, from {:.6g} to {:.6g}\">"
      "<path class=\"axis\" d=\"M{} {}V{}H{}\"/>",
      width, height, escape_html(panel.name), escape_html(key), panel.low.y(), panel.high.y(), left, top,
      height - bottom, width - right);
  std::size_t number = 0;
  for (const auto& [name, points] : panel.curves) {
    const int hue = static_cast<int>(210 + 67 * number++) % 360;
    std::string line, dots;
    for (const auto& [x, y] : points) {
      line += fmt::format("{}{}", line.empty() ? "M" : "L", at(x, y));
      const std::string place = at(x, y);
      const std::size_t comma = place.find(',');
      dots += fmt::format(
          "<circle cx=\"{}\" cy=\"{}\" r=\"2.4\" fill=\"hsl({} 60% 50%)\"><title>{}{}{:.6g}: "
          "{:.6g}</title></circle>",
          place.substr(0, comma), place.substr(comma + 1), hue, escape_html(name), name.empty() ? "" : ", ", x, y);
    }
    out += fmt::format("<path class=\"curve\" stroke=\"hsl({} 60% 50%)\" d=\"{}\"/>{}", hue, line, dots);
  }
  out += fmt::format("<text x=\"{}\" y=\"{}\">{:.4g}</text><text x=\"{}\" y=\"{}\" text-anchor=\"end\">{:.4g}</text>",
                     left, height - 10, panel.low.x(), width - right, height - 10, panel.high.x());
  out += fmt::format(
      "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text></svg><figcaption>{}: {:.6g} to "
      "{:.6g}</figcaption></figure>\n",
      width / 2, height - 10, escape_html(key), escape_html(panel.name), panel.low.y(), panel.high.y());
  return out;
}

std::string panels(const SweepTable& table) {
  constexpr std::size_t most = 24, most_rows = 5000;
  std::size_t key = table.keys.size();
  for (std::size_t k = table.keys.size(); k-- > 0 && table.rows.size() <= most_rows;)
    if (!table.rows.empty() && number_in(table.rows[0].values[k])) key = k;
  if (key == table.keys.size()) return "";
  std::string out;
  std::size_t count = 0;
  for (std::size_t c = 0; c < table.columns.size() && count < most; ++c) {
    const std::string& name = table.columns[c];
    if (!table.is_number[c] || name.starts_with("mesh.") || name.starts_with("time_s") || name.starts_with("peak_"))
      continue;
    if (const auto panel = panel_of(table, key, c)) out += drawn(*panel, table.keys[key]), ++count;
  }
  if (out.empty()) return out;
  return fmt::format("<h2>Numbers</h2>\n<div class=\"grid\">\n{}</div>\n", out);
}

std::string pictures(const SweepTable& table, const fs::path& folder) {
  std::string out;
  for (const SweepTable::Row& row : table.rows)
    for (const char* picture : {"design.png", "map.png", "von_mises.png"}) {
      if (!fs::exists(folder / row.name / picture)) continue;
      const std::string name = escape_html(row.name);
      out += fmt::format(
          "<figure><a href=\"{0}/report.html\"><img loading=\"lazy\" src=\"{0}/{1}\" alt=\"{2}\"></a>"
          "<figcaption>{2}</figcaption></figure>\n",
          name, picture, escape_html(label(table, row, table.keys.size())));
      break;
    }
  if (out.empty()) return out;
  return fmt::format("<h2>Pictures</h2>\n<div class=\"grid\">\n{}</div>\n", out);
}

std::string failures(const SweepTable& table) {
  std::string out;
  for (const SweepTable::Row& row : table.rows)
    if (row.status == "failed")
      out += fmt::format("<li><b>{}</b>: {}</li>\n", escape_html(row.name), escape_html(row.reason));
  if (out.empty()) return out;
  return fmt::format("<h2 class=\"bad\">Failed</h2>\n<ul>\n{}</ul>\n", out);
}

std::string table_of(const SweepTable& table) {
  std::string out = "<h2>Table</h2>\n<div class=\"wide\"><table>\n<tr><th>run</th><th>status</th>";
  for (const std::string& column : table.columns) out += fmt::format("<th>{}</th>", escape_html(column));
  out += "</tr>\n";
  for (const SweepTable::Row& row : table.rows) {
    out += fmt::format("<tr><td>{}</td><td{}>{}</td>", escape_html(row.name),
                       row.status == "failed" ? " class=\"bad\"" : "", escape_html(row.status));
    for (const std::string& cell : row.cells) {
      const auto value = number_in(cell);
      out += fmt::format("<td>{}</td>", value ? six(*value) : escape_html(cell));
    }
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

}  // namespace

std::optional<double> number_in(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

void add_result(SweepTable& table, SweepTable::Row& row, const std::vector<Leaf>& leaves) {
  row.cells.resize(table.columns.size());
  std::map<std::string, std::size_t> place;
  for (std::size_t k = 0; k < table.columns.size(); ++k) place.emplace(table.columns[k], k);
  for (const Leaf& leaf : leaves) {
    if (leaf.name == "status") row.status = leaf.value;
    if (leaf.name == "reason") row.reason = leaf.value;
    if (leaf.name == "status" || leaf.name == "reason") continue;
    const auto [found, is_new] = place.emplace(leaf.name, table.columns.size());
    if (is_new) {
      table.columns.push_back(leaf.name);
      table.is_number.push_back(leaf.is_number);
      row.cells.emplace_back();
    }
    row.cells[found->second] = leaf.value;
  }
}

bool is_usual(std::string_view name) {
  static constexpr std::array<std::string_view, 16> ends{
      "K_I",   "K_II",  "G",      "verdict",    "stopped",         "objective", "coefficient", "energy",
      "value", "ended", "factor", "compliance", "volume_fraction", "lower",     "upper",       "cycles"};
  for (const std::string_view hidden : {".spread.", ".margin.", ".residual", "time_s.", ".history"})
    if (name.find(hidden) != std::string_view::npos) return false;
  if (name == "mesh.triangles") return true;
  const std::string_view last = name.substr(name.rfind('.') + 1);
  return std::ranges::find(ends, last) != ends.end();
}

void choose_columns(SweepTable& table, const std::vector<std::string>& wanted) {
  if (wanted == std::vector<std::string>{"all"}) return;
  const auto names = [](const std::string& column, const std::string& word) {
    return column == word ||
           (column.size() > word.size() && column.ends_with(word) && column[column.size() - word.size() - 1] == '.');
  };
  for (const std::string& word : wanted)
    if (!table.columns.empty() && std::ranges::none_of(table.columns, [&](const auto& c) { return names(c, word); }))
      throw Error(Fault::Usage,
                  fmt::format("--columns {}: no run has such a quantity; {}", word, suggest(word, table.columns)));
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < table.columns.size(); ++k)
    if (wanted.empty() ? is_usual(table.columns[k])
                       : std::ranges::any_of(wanted, [&](const auto& word) { return names(table.columns[k], word); }))
      kept.push_back(k);
  const auto pick = [&](auto& all) {
    std::remove_cvref_t<decltype(all)> some;
    for (const std::size_t k : kept) some.push_back(all[k]);
    all = std::move(some);
  };
  pick(table.columns);
  pick(table.is_number);
  for (SweepTable::Row& row : table.rows) pick(row.cells);
}

std::string plain_page(const std::string& title, const std::string& body, const std::string& head) {
  return html_head(title, "script-src 'none'; object-src 'none'; base-uri 'none'; form-action 'none'", style,
                   "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n" + head) +
         fmt::format("<main>\n<h1>{}</h1>\n{}</main>\n</body>\n</html>\n", escape_html(title), body);
}

void write_sweep_page(const fs::path& path, const SweepTable& table, const fs::path& folder) {
  const auto count = [&](std::string_view status) {
    return std::ranges::count_if(table.rows, [&](const auto& row) { return row.status == status; });
  };
  std::string keys;
  for (const std::string& key : table.keys) keys += fmt::format("{}{}", keys.empty() ? "" : ", ", key);
  write_file(path, plain_page(fmt::format("Sweep of {}", table.title),
                              fmt::format("<p>{} runs over {}: {} ok, {} failed, {} not yet run. The numbers are in "
                                          "<a href=\"sweep.csv\">sweep.csv</a>.</p>\n",
                                          table.rows.size(), escape_html(keys), count("ok"), count("failed"),
                                          count("missing")) +
                                  failures(table) + convergence_table(table.convergence) + panels(table) +
                                  pictures(table, folder) + table_of(table)));
}

}  // namespace kerf
