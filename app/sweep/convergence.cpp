// What quantities tend to as the mesh gets finer: three meshes, each of half the size of the one before. With
// q(h) = q + c h^p the differences of neighbors have the ratio 2^p, so that p = log2((q1 - q2)/(q2 - q3)) and
// q = q3 + (q3 - q2)/(2^p - 1) [Richardson 1911]. Where differences change sign, or fall slower than the slowest
// singularity of elasticity makes them (p = 1/2), they follow no such law: there is no limit, and the error is the
// larger of them. Faster than p = 4 they fall by chance: then the error is that of p = 4. Beside it stands the margin
// that the finest run says of itself.

#include "app/sweep/convergence.hpp"

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf {

namespace {

/// The column of the margin of a quantity: "tips.end.margin.K_I" of "tips.end.K_I", "max_von_mises.margin" of
/// "max_von_mises.value".
std::string margin_of(const std::string& column) {
  const std::size_t dot = column.rfind('.');
  const std::string before = dot == std::string::npos ? std::string() : column.substr(0, dot + 1),
                    last = column.substr(before.size());
  return last == "value" ? before + "margin" : before + "margin." + last;
}

/// Rows of one combination of the other keys, the coarsest mesh first.
std::map<std::string, std::vector<const SweepTable::Row*>> studies(const SweepTable& table, std::size_t key) {
  std::map<std::string, std::vector<const SweepTable::Row*>> out;
  for (const SweepTable::Row& row : table.rows) {
    std::string with;
    for (std::size_t k = 0; k < table.keys.size(); ++k)
      if (k != key) with += fmt::format("{}{}={}", with.empty() ? "" : ", ", table.keys[k], row.values[k]);
    out[with].push_back(&row);
  }
  for (auto& [with, rows] : out)
    std::ranges::sort(rows, std::ranges::greater{},
                      [&](const SweepTable::Row* row) { return number_in(row->values[key]).value_or(nan); });
  return out;
}

std::string six_or_dash(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : std::string("-");
}

}  // namespace

void extrapolate(Convergence& c) {
  constexpr double digits = 1e-12;                 // of the value: differences below are rounding
  constexpr double slowest = 1.414, fastest = 16;  // ratios of differences
  const double first = c.value[0] - c.value[1], second = c.value[1] - c.value[2], ratio = first / second;
  if (std::abs(second) <= digits * std::abs(c.value[2])) {
    c.limit = c.value[2];
    c.error = std::abs(second);
  } else if (ratio >= slowest) {
    c.order = std::log2(ratio);
    c.limit = c.value[2] - second / (ratio - 1);
    c.error = std::abs(second / (std::min(ratio, fastest) - 1));
  } else {
    c.error = std::max(std::abs(first), std::abs(second));
  }
}

std::vector<Convergence> convergence_of(const SweepTable& table, const std::string& key_name) {
  const auto found = std::ranges::find(table.keys, key_name);
  if (found == table.keys.end()) return {};
  const auto key = static_cast<std::size_t>(found - table.keys.begin());
  std::map<std::string, std::size_t> place;
  for (std::size_t c = 0; c < table.columns.size(); ++c) place.emplace(table.columns[c], c);
  std::vector<Convergence> all;
  for (const auto& [with, rows] : studies(table, key)) {
    if (rows.size() != 3) continue;
    for (std::size_t column = 0; column < table.columns.size(); ++column) {
      if (!table.is_number[column] || table.columns[column].starts_with("mesh.")) continue;
      Convergence c{.of = table.columns[column], .with = with};
      for (std::size_t k = 0; k < 3; ++k) {
        c.size[k] = number_in(rows[k]->values[key]).value_or(nan);
        c.value[k] = number_in(rows[k]->cells[column]).value_or(nan);
      }
      if (!std::ranges::all_of(c.value, [](double v) { return std::isfinite(v); })) continue;
      if (const auto said = place.find(margin_of(c.of)); said != place.end())
        c.said = number_in(rows[2]->cells[said->second]).value_or(nan);
      extrapolate(c);
      all.push_back(std::move(c));
    }
  }
  return all;
}

void write_convergence(const std::filesystem::path& path, const std::vector<Convergence>& all) {
  std::string out = "quantity,with,size_1,size_2,size_3,value_1,value_2,value_3,order,limit,error,margin\n";
  const auto cell = [](double value) { return std::isfinite(value) ? fmt::format("{:.17g}", value) : std::string(); };
  for (const Convergence& c : all) {
    out += fmt::format("{},{}", csv_text(c.of), csv_text(c.with));
    for (const double size : c.size) out += "," + cell(size);
    for (const double value : c.value) out += "," + cell(value);
    for (const double value : {c.order, c.limit, c.error, c.said}) out += "," + cell(value);
    out += "\n";
  }
  write_file(path, out);
}

std::string in_words(const std::vector<Convergence>& all) {
  constexpr std::size_t most = 12;
  std::string out;
  for (std::size_t k = 0; k < std::min(most, all.size()); ++k) {
    const Convergence& c = all[k];
    out += fmt::format("{}{}{}: {}, {}, {}; ", c.of, c.with.empty() ? "" : " with ", c.with, six_or_dash(c.value[0]),
                       six_or_dash(c.value[1]), six_or_dash(c.value[2]));
    out += std::isfinite(c.limit)
               ? fmt::format("limit {:.6g}{}, error of the last {:.2g}", c.limit,
                             std::isfinite(c.order) ? fmt::format(" of order {:.2g}", c.order) : "", c.error)
               : fmt::format("no limit yet: neighbors differ by {:.2g}", c.error);
    if (std::isfinite(c.said)) out += fmt::format("; the run says {:.2g}", c.said);
    out += "\n";
  }
  if (all.size() > most) out += fmt::format("and {} more in convergence.csv\n", all.size() - most);
  return out;
}

std::string convergence_table(const std::vector<Convergence>& all) {
  if (all.empty()) return {};
  const auto& size = all.front().size;
  std::string out = fmt::format(
      "<h2>Convergence</h2>\n<p>Three meshes, each of half the size of the one before. Order and limit are "
      "Richardson's: "
      "q = limit + c h<sup>order</sup>. Where the differences do not fall, or slower than h<sup>1/2</sup>, there is no "
      "limit, and the error is the larger of them. Margin: what the finest run says of itself.</p>\n<div "
      "class=\"wide\"><table>\n<tr><th>quantity</th>"
      "<th>{:.4g}</th><th>{:.4g}</th><th>{:.4g}</th><th>order</th><th>limit</th><th>error of the "
      "last</th><th>margin</th>"
      "</tr>\n",
      size[0], size[1], size[2]);
  for (const Convergence& c : all) {
    out += fmt::format("<tr><td>{}{}{}</td>", escape_html(c.of), c.with.empty() ? "" : ", ", escape_html(c.with));
    for (const double value : c.value) out += fmt::format("<td>{}</td>", six_or_dash(value));
    out += fmt::format("<td>{}</td><td>{}</td><td>{:.2g}</td><td>{}</td></tr>\n",
                       std::isfinite(c.order) ? fmt::format("{:.2f}", c.order) : "-", six_or_dash(c.limit), c.error,
                       std::isfinite(c.said) ? fmt::format("{:.2g}", c.said) : "-");
  }
  return out + "</table></div>\n";
}

}  // namespace kerf
