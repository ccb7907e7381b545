// The pages of the validation manual: an index with a row per benchmark, the value that is furthest out in terms of its
// tolerance, and a page per benchmark with setup, source, second check, all numbers, the reasons of tolerances, a
// picture and the case. What is rounding beside an absolute tolerance is printed as 0. Nothing depends on the day or
// the machine, so that pages made again show what has changed. docs/validation has the pages.

#include "bench/verify/pages.hpp"

#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

std::string printed_on_page(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "";
}

/// Rounding, far below a tolerance around zero, is no number to print.
std::string printed_on_page(const ManualValue& value, const VerifiedValue& found) {
  constexpr double rounding = 1e-6;
  return printed_on_page(value.absolute && std::abs(found.measured) < rounding * value.tolerance ? 0 : found.measured);
}

/// In a cell of a table.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

/// The value that is furthest out in terms of its tolerance; null: none is compared.
const VerifiedValue* worst(const VerifiedEntry& e, const ManualValue*& what) {
  const VerifiedValue* found = nullptr;
  double most = -infinity;
  for (std::size_t k = 0; k < e.values.size(); ++k) {
    const ManualValue& value = e.entry.values[k];
    if (!value.published) continue;
    const double share = (e.values[k].within ? 0 : 1e6) + std::abs(e.values[k].deviation) / value.tolerance;
    if (!(share > most)) continue;
    most = share;
    found = &e.values[k];
    what = &value;
  }
  return found;
}

std::string index_row(const VerifiedEntry& e) {
  const std::string head = fmt::format("| [{}]({}.md) | {} |", e.entry.id, e.entry.id, cell(e.entry.title));
  const ManualValue* what = nullptr;
  const VerifiedValue* found = worst(e, what);
  if (!found) {
    const ManualValue& first = e.entry.values.front();
    return fmt::format("{} {} | {} |  |  |  | {} |\n", head, cell(first.name),
                       printed_on_page(first.published.value_or(nan)), e.verdict);
  }
  return fmt::format("{} {}{} | {} | {} | {} | {} | {} |\n", head, cell(what->name),
                     e.values.size() > 1 ? fmt::format(" (worst of {})", e.values.size()) : "",
                     printed_on_page(*what->published), printed_on_page(*what, *found), deviation_text(*what, *found),
                     tolerance_text(*what), e.verdict);
}

std::string index(const VerifyBench& bench) {
  std::string out = fmt::format(
      "# Validation manual\n\n"
      "Benchmarks with published or closed-form values, and what kerf finds: {} within their tolerance, {} outside, "
      "{} not possible yet. Written by\n\n"
      "    kerf bench verify --write docs/validation\n\n"
      "from the files in `bench/verify/cases`, one per benchmark. Each page has the setup, the source, what else "
      "confirms the value, all numbers\nwith the tolerance and its reason, a picture, and the case file. Tolerances "
      "come from the sources (the stated error of a formula, the distance of\na finite plate to an infinite one), not "
      "from kerf. Where a benchmark has several values the table shows the one that is furthest out in terms of\nits "
      "tolerance.\n\nBooks and papers are cited as usual, and not all of them were looked up in print: what a value "
      "was confirmed "
      "by is under *Second check*. The\nerror bar of a number is its distance to a second computation of kerf.\n\n"
      "Topological derivatives are compared with drawn bodies product by product, too: [products](products.md).\n",
      count(bench, "within"), count(bench, "outside"), count(bench, "not possible"));
  std::vector<std::string> groups;
  for (const VerifiedEntry& e : bench.entries)
    if (std::ranges::find(groups, e.entry.group) == groups.end()) groups.push_back(e.entry.group);
  std::ranges::sort(groups);
  for (const std::string& group : groups) {
    out += fmt::format(
        "\n## {}\n\n| benchmark | what | value | published | kerf | deviation | tolerance | verdict |\n"
        "|---|---|---|---|---|---|---|---|\n",
        group);
    for (const VerifiedEntry& e : bench.entries)
      if (e.entry.group == group) out += index_row(e);
  }
  return out;
}

/// How a run differs from the case below.
std::string run_text(const ManualRun& run) {
  if (run.overrides.empty()) return fmt::format("* {}: the case as it is\n", run.name);
  std::string out = fmt::format("* {}:", run.name);
  for (const std::string& change : run.overrides) out += fmt::format(" `--set '{}'`", change);
  return out + "\n";
}

std::string value_rows(const VerifiedEntry& e) {
  std::string out =
      "| value | published | kerf | error bar | deviation | tolerance | verdict |\n|---|---|---|---|---|---|---|\n";
  for (std::size_t k = 0; k < e.entry.values.size(); ++k) {
    const ManualValue& value = e.entry.values[k];
    const bool known = k < e.values.size();
    const VerifiedValue found = known ? e.values[k] : VerifiedValue{};
    const char* verdict = !known             ? e.verdict.c_str()
                          : !value.published ? "first published here"
                          : found.within     ? "within"
                                             : "outside";
    out += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", cell(value.name),
                       printed_on_page(value.published.value_or(nan)), printed_on_page(value, found),
                       std::isfinite(found.error_bar) ? fmt::format("{:.1g}", found.error_bar) : "",
                       deviation_text(value, found), tolerance_text(value), verdict);
  }
  return out;
}

/// Formulas and reasons, each once.
std::string value_notes(const ManualEntry& entry) {
  std::string out;
  for (const ManualValue& value : entry.values)
    if (!value.formula.empty()) out += fmt::format("* {} is `{}`\n", value.name, value.formula);
  std::vector<std::string> reasons;
  for (const ManualValue& value : entry.values)
    if (!value.reason.empty() && std::ranges::find(reasons, value.reason) == reasons.end())
      reasons.push_back(value.reason);
  for (const std::string& reason : reasons) out += fmt::format("* Tolerance: {}\n", reason);
  return out.empty() ? out : "\n" + out;
}

std::string page(const VerifiedEntry& e) {
  const ManualEntry& m = e.entry;
  std::string out =
      fmt::format("# {}: {}\n\n[All benchmarks](index.md) · {} · **{}**", m.id, m.title, m.group, e.verdict);
  if (!m.impossible.empty()) out += ", because " + m.impossible;
  if (!e.trouble.empty()) out += ": " + e.trouble;
  out += fmt::format("\n\n{}\n\n**Source.** {}\n\n**Second check.** {}\n\n{}{}", m.setup, m.source, m.check,
                     value_rows(e), value_notes(m));
  if (e.has_picture) out += fmt::format("\n![{}]({}.png)\n", m.title, m.id);
  if (m.case_text.empty()) return out;
  out += fmt::format("\n{}\n```toml\n{}\n```\n",
                     e.triangles > 0 ? fmt::format("The case, {} triangles{}:\n", e.triangles,
                                                   m.runs.size() > 1 ? " in the first run" : "")
                                     : "The case:\n",
                     m.case_text);
  if (m.runs.size() > 1) {
    out += "\nRuns:\n\n";
    for (const ManualRun& run : m.runs) out += run_text(run);
  }
  if (!m.again.empty()) {
    out += "\nThe error bar is the distance to a second computation:";
    for (const std::string& change : m.again) out += fmt::format(" `--set '{}'`", change);
    out += "\n";
  }
  return out;
}

}  // namespace

void write_pages(const std::filesystem::path& folder, const VerifyBench& bench) {
  write_file(folder / "index.md", index(bench));
  for (const VerifiedEntry& e : bench.entries) write_file(folder / (e.entry.id + ".md"), page(e));
}

}  // namespace kerf
