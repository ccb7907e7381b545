// The report of `kerf bench hard`: a page with a table of families and a section per family (truth, limit and its
// reason, all rows), the picture with a chart per family, and the table for a terminal. A row that was not held shows
// what the program said. docs/hard.md is this page.

#include "bench/hard/report.hpp"

#include "bench/hard/family.hpp"
#include "plot/multiples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

std::string error_text(double value) {
  return std::isfinite(value) ? fmt::format("{:.1e}", value) : std::string("-");
}

std::string digits_text(double value) {
  return std::isfinite(value) ? fmt::format("{:.1f}", value + 0.0) : std::string("-");
}

std::string first_sentence(const std::string& text) {
  std::string line = text.substr(0, text.find('\n'));
  constexpr std::size_t most = 160;
  if (line.size() <= most) return line;
  return line.substr(0, line.rfind(' ', most)) + " ...";
}

std::string in_cell(std::string text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

/// The rows of one family, if there are any.
std::vector<const HardRow*> rows_of(const HardBench& bench, const HardFamily& family) {
  std::vector<const HardRow*> rows;
  for (const HardRow& r : bench.rows)
    if (r.family == family.name) rows.push_back(&r);
  return rows;
}

MultipleMark mark_of(const HardRow& r) {
  switch (r.verdict) {
    case HardVerdict::Held:
      return MultipleMark::Good;
    case HardVerdict::Told:
      return MultipleMark::Told;
    case HardVerdict::Refused:
      return MultipleMark::Refused;
    default:
      return MultipleMark::Bad;
  }
}

std::string family_line(const HardFamily& family, const std::vector<const HardRow*>& rows) {
  double worst = -infinity, slowest = 0;
  int refused = 0, bad = 0, told = 0;
  for (const HardRow* r : rows) {
    if (r->digits > worst) worst = r->digits;
    slowest = std::max(slowest, r->slower);
    refused += r->verdict == HardVerdict::Refused;
    told += r->verdict == HardVerdict::Told;
    bad += is_failure(r->verdict);
  }
  return fmt::format("| `{}` | {}: {} to {} | {} | {} | {:.3g} | {} | {} | {} |\n", family.name, family.knob,
                     rows.front()->label, rows.back()->label, rows.size(), digits_text(worst), slowest, refused, told,
                     bad);
}

constexpr const char* columns =
    "error | allowed | digits lost | estimated | residual | work | triangles | time / benign | exit | verdict |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|\n";

std::string family_section(const HardFamily& family, const std::vector<const HardRow*>& rows) {
  std::string out =
      fmt::format("\n## `{}`: {}\n\nTruth: {}. Limit: {}.", family.name, family.title, family.truth, family.limit);
  if (!family.why.empty()) out += fmt::format(" No better because {}.", family.why);
  out += fmt::format("\n\n| {} | {}", family.knob, columns);
  std::string said;
  for (const HardRow* r : rows) {
    out +=
        fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {:.2g} | {} | {} |\n", r->label, error_text(r->error),
                    error_text(r->allowed), digits_text(r->digits), error_text(r->estimated), error_text(r->residual),
                    error_text(r->work), r->triangles, r->slower, r->exit, name_of(r->verdict));
    if (r->verdict != HardVerdict::Held && !r->said.empty())
      said += fmt::format("* {}: {}\n", r->label, in_cell(first_sentence(r->said)));
  }
  return said.empty() ? out : out + "\n" + said;
}

}  // namespace

std::string hard_page(const HardBench& bench) {
  std::string families =
      "# Hard cases\n\nMade by `kerf bench hard`. Error: relative, against the truth that each family names; allowed: "
      "the "
      "limit, which a row must stay below; digits lost: against the benign row of the family; estimated: what the run "
      "itself says of the error of its stress; residual, work: of equilibrium and contact, and of the work of the "
      "loads, "
      "as the run certifies them; exit: as of `kerf solve`.\n\n"
      "| family | knob | rows | digits lost, at most | time / benign, at most | refused | told | failures |\n"
      "|---|---|---|---|---|---|---|---|\n";
  std::string sections;
  for (const HardFamily& family : hard_families()) {
    const auto rows = rows_of(bench, family);
    if (rows.empty()) continue;
    families += family_line(family, rows);
    sections += family_section(family, rows);
  }
  return families + sections;
}

void draw_hard_plot(const std::filesystem::path& path, const HardBench& bench) {
  Multiples multiples{.title = "Hard cases: error against truth as the knob turns",
                      .subtitle =
                          "gray: the limit; blue: below it; orange: above it, and the run says so; cross: "
                          "refused with a sentence; red: failure"};
  for (const HardFamily& family : hard_families()) {
    Multiple panel{.title = family.title, .x_label = family.knob};
    for (const HardRow* r : rows_of(bench, family))
      panel.points.push_back({r->label, r->error, r->allowed, mark_of(*r)});
    if (!panel.points.empty()) multiples.panels.push_back(std::move(panel));
  }
  draw(path, multiples);
}

std::string summary(const HardBench& bench) {
  std::string out = fmt::format("{:<16}{:>10}{:>11}{:>11}{:>8}{:>11}{:>9}{:>6}  {}\n", "family", "knob", "error",
                                "allowed", "digits", "residual", "slower", "exit", "verdict");
  for (const HardRow& r : bench.rows) {
    out += fmt::format("{:<16}{:>10}{:>11}{:>11}{:>8}{:>11}{:>9.2g}{:>6}  {}\n", r.family, r.label, error_text(r.error),
                       error_text(r.allowed), digits_text(r.digits), error_text(r.residual), r.slower, r.exit,
                       name_of(r.verdict));
    if (r.verdict != HardVerdict::Held && !r.said.empty()) out += "    " + first_sentence(r.said) + '\n';
  }
  out += fmt::format("{} rows, {} failures\n", bench.rows.size(), failures(bench));
  if (bench.stopped) out += "stopped before the end\n";
  return out;
}

}  // namespace kerf
