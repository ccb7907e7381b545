// The page of a run: one HTML file with everything in it, sections in the order of the jobs, data and a script at the
// end. A policy (Content-Security-Policy) in its head allows the script with this hash, inline styles and images in the
// file, and nothing else: what a result holds is never run. Without scripts the numbers and tables are all there, and
// only the figures are missing. The command comes from the comment at the top of the case as it was kept.

#include "plot/page.hpp"

#include "io/files.hpp"
#include "io/text.hpp"
#include "plot/page/script.hpp"
#include "plot/page/sections.hpp"
#include "plot/page/svg.hpp"

#include <fmt/format.h>

namespace kerf {

namespace {

std::string head(const Result& r, const std::string& title) {
  const bool good = r.status == "ok";
  return fmt::format(
      "<header><div><h1>{}</h1>\n<p class=\"dim\">case {} <span class=\"status{}\">{}</span></p></div>\n"
      "<button id=\"theme\" type=\"button\" hidden>dark</button></header>\n",
      title, escape_html(r.case_name), good ? "" : " bad", escape_html(r.status));
}

std::string notes(const Result& r) {
  std::string out;
  if (r.state)
    for (const std::string& text : r.state->notes) out += note(text);
  return out;
}

/// Lines of the comment that stands at the top of the case as it was kept.
std::string command_of(const std::string& case_text) {
  std::string out;
  std::size_t at = 0;
  while (case_text.compare(at, 1, "#") == 0) {
    const std::size_t end = case_text.find('\n', at);
    const std::string line = case_text.substr(at, end == std::string::npos ? end : end - at);
    if (line.find("kerf ") != std::string::npos && line.find(", as kerf") == std::string::npos) out = line.substr(1);
    if (end == std::string::npos) break;
    at = end + 1;
  }
  out.erase(0, out.find_first_not_of(' '));
  return out;
}

std::string footer(const Result& r, const std::string& command) {
  const std::string by = command.empty() ? command : fmt::format("<code>{}</code><br>\n", escape_html(command));
  return fmt::format("<footer>{}kerf {}</footer>\n", by, escape_html(r.version));
}

std::string ending(const Result& r, const PageData& data) {
  std::string spent = time_bars(r.seconds) + fmt::format("<p>Total {:.3f} s", r.seconds.total);
  if (r.peak_memory_mb > 0) spent += fmt::format(", peak memory {:.1f} MB", r.peak_memory_mb);
  std::string out = folded_section("Time", fmt::format("{:.3g} seconds", r.seconds.total), spent + ".</p>\n");
  if (data.case_text.empty()) return out + footer(r, {});
  std::string text;
  for (std::size_t at = 0; at < data.case_text.size();) {
    const std::size_t end = std::min(data.case_text.find('\n', at), data.case_text.size());
    text += escape_html(data.case_text.substr(at, end - at)) + '\n';
    at = end + 1;
  }
  out += folded_section("Case", "as it was given, overrides included (case.toml)", "<pre>" + text + "</pre>\n");
  return out + footer(r, command_of(data.case_text));
}

/// The page runs its own script alone and loads nothing: what a result holds is never code.
std::string policy() {
  const std::string_view hex = browser_script_sha256();
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  return fmt::format(
      "default-src 'none'; script-src 'sha256-{}'; style-src 'unsafe-inline'; img-src data:; "
      "base-uri 'none'; form-action 'none'",
      base64(bytes));
}

}  // namespace

std::string page(const Result& r, const PageData& data) {
  const std::string title = escape_html(r.title.empty() ? r.case_name : r.title);
  std::string out = html_head(r.title.empty() ? r.case_name : r.title, policy(), browser_style(),
                              "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<link "
                              "rel=\"icon\" href=\"data:,\">\n");
  out += "<main>\n" + head(r, title) + verdicts(r) + notes(r) + key_numbers(r);
  const bool drawn = find_array(data.arrays, "points") != nullptr;
  out +=
      "<noscript><p class=\"note\">The figures are drawn by a script in this file. Without it the numbers and tables "
      "are all here.</p></noscript>\n";
  if (drawn && r.state) out += "<h2>Stress</h2>\n" + body_figure("stress", stress_finding(r)) + thinned(r, data);
  out += load_cases_section(r);
  if (r.map) out += map_section(r, find_array(data.arrays, "map") ? body_figure("map", map_finding(r)) : std::string());
  out += cracks_section(r);
  if (!r.steps.empty()) out += steps_section(r);
  if (r.growth) out += growth_section(*r.growth, data);
  if (r.edge_cracks) out += edge_cracks_section(*r.edge_cracks, r.units);
  if (r.bounds) out += bounds_section(r);
  if (r.validate) out += validation_section(r);
  if (r.optimize) out += optimize_section(r, data);
  out += tables_section(r) + ending(r, data) + "</main>\n";
  out += data_elements(r, data);
  return out + "<script>" + browser_script() + "</script>\n</body>\n</html>\n";
}

void write_page(const std::filesystem::path& path, const Result& result, const PageData& data) {
  write_file(path, page(result, data));
}

}  // namespace kerf
