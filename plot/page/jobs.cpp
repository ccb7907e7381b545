// Sections of the page for validations and optimizations: verdicts in sentences, tables of radii, of iterations, of
// holes that appeared, and the certificate of a design: the residual of the first-order conditions, (T - price) / price
// of small holes, the same of small bumps, and the design on a finer mesh with intervals of its bounds.
// docs/theory/validation.md, "The verdict"; docs/theory/guarantees.md, "What is guaranteed of an optimised design".

#include "io/history.hpp"
#include "io/text.hpp"
#include "io/validation.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

std::string radii_table(const ValidationResult& validation) {
  std::vector<std::vector<std::string>> rows;
  std::size_t left_out = 0;
  for (const Validation& v : validation.points)
    for (const ValidationRow& row : v.rows) {
      if (rows.size() == most_rows) {
        ++left_out;
        continue;
      }
      rows.push_back({at_place(v.at), pretty(row.radius), pretty(row.J), pretty(row.difference), pretty(row.predicted),
                      pretty(row.remainder), pretty(row.order), pretty(row.remainder_second), pretty(row.order_second),
                      row.same_contact ? "same" : "changed"});
    }
  if (rows.empty()) return {};
  std::string out = table({"point", "radius", "J", "difference", "predicted", "remainder", "order",
                           "with c<sub>2</sub>", "order", "contact"},
                          rows);
  if (left_out > 0) out += fmt::format("<p class=\"dim\">{} more rows are in validate.csv.</p>\n", left_out);
  return folded("Every radius", out);
}

}  // namespace

std::string validation_section(const Result& r) {
  const ValidationResult& validation = *r.validate;
  std::string out = fmt::format("<h2>Validation: {}</h2>\n", escape_html(validation.perturbation));
  std::vector<std::vector<std::string>> rows;
  for (const Validation& v : validation.points) {
    out += note(sentence(v), v.verdict == Verdict::Fails);
    if (rows.size() < most_rows)
      rows.push_back({at_place(v.at), std::string(word(v.verdict)), pretty(v.coefficient), pretty(v.intercept),
                      pretty(v.order), pretty(v.plateau), pretty(v.c2), pretty(v.c2_predicted), pretty(v.c3)});
  }
  const bool curves = std::any_of(validation.points.begin(), validation.points.end(),
                                  [](const Validation& v) { return v.rows.size() > 1; });
  if (curves) out += "<figure id=\"validation-curves\"><div class=\"plot\"></div></figure>\n";
  out += table({"point", "expansion", "T", "intercept", "order", "plateau", "c<sub>2</sub>", "c<sub>2</sub> predicted",
                "c<sub>3</sub>"},
               rows);
  out +=
      "<p class=\"dim\">Intercept, c<sub>2</sub>: of the fit T + c<sub>2</sub> ε² + c<sub>4</sub> ε⁴ to the difference "
      "over its scale (π ε²); c<sub>3</sub> of ε² ln ε: known, or fitted instead of c<sub>4</sub>. Predicted: by the "
      "formula. Plateau: relative error that the mesh leaves.</p>\n";
  return out + radii_table(validation);
}

namespace {

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
  const std::array last{heads.size() - 1};
  std::string out = table(heads, rows, last);
  if (stride > 1)
    out += fmt::format("<p class=\"dim\">Every {} iterations; all of them are in history.csv.</p>\n", stride);
  return folded("Every iteration", out);
}

/// What a bound on a stress or a release rate is judged by.
std::string interval_in_words(const FinerDesign& finer, std::size_t k, const OptimizeNames& names) {
  const Bounded& b = finer.intervals[k];
  if (!std::isfinite(b.upper)) return escape_html(b.note);
  return fmt::format("{} there, {} at most {} ({} allowed){}", pretty(finer.bounds[k]),
                     b.guaranteed ? "proved" : "estimated", pretty(b.upper), pretty(names.at_most[k]),
                     b.note.empty() ? "" : ": " + escape_html(b.note));
}

/// Holes that appeared on the way: what their two terms promised and what they did.
std::string nucleated_table(const std::vector<NucleatedHole>& holes) {
  std::vector<std::vector<std::string>> rows;
  for (const NucleatedHole& h : holes)
    rows.push_back({fmt::format("{}", h.iteration), at_place(h.at), pretty(h.radius, 3), pretty(h.T, 4),
                    pretty(h.c2, 4), pretty(h.predicted, 4), pretty(h.actual, 4), escape_html(h.note)});
  return folded("Holes that appeared", table({"iteration", "at", "radius", "T", "c<sub>2</sub>",
                                              "change of J predicted", "made alone", "note"},
                                             rows, std::array{std::size_t{7}}));
}

/// What the last word of the optimization rests on.
std::string certificate(const Result& r) {
  const OptimizeResult& o = *r.optimize;
  Facts facts;
  if (std::isfinite(o.optimality)) facts.add("residual of the first-order conditions", pretty(o.optimality, 3));
  if (std::isfinite(o.holes.least))
    facts.add("small holes", fmt::format("(T − price) / price is least, {}, at {}{}{}", pretty(o.holes.least, 3),
                                         at_place(o.holes.at), o.holes.least >= 0 ? ": none pays" : ": one there pays",
                                         o.holes.proof ? fmt::format("; a hole made there: {}", word(*o.holes.proof))
                                                       : std::string()));
  if (std::isfinite(o.bumps.least))
    facts.add("small bumps",
              fmt::format("(price − worth) / price is least, {}, at {}{}", pretty(o.bumps.least, 3),
                          at_place(o.bumps.at), o.bumps.least >= 0 ? ": none pays" : ": one there pays"));
  if (std::isfinite(o.gain.sum()))
    facts.add("what could still be gained",
              fmt::format("at most {} % of J: boundary {} %, best hole {} %, best bump {} %",
                          pretty(100 * o.gain.sum(), 2), pretty(100 * o.gain.shape, 2),
                          pretty(100 * o.gain.hole.gain, 2), pretty(100 * o.gain.bump.gain, 2)));
  if (o.finer.size > 0) {
    facts.add("on a finer mesh", o.finer.failure.empty()
                                     ? fmt::format("objective {}, volume fraction {}, largest violation {}",
                                                   with_unit(o.finer.objective, r.units, r.functional_dimension),
                                                   pretty(o.finer.volume_fraction, 5), pretty(o.finer.violation, 3))
                                     : escape_html(o.finer.failure));
    for (std::size_t k = 0; k < std::min(o.finer.intervals.size(), r.optimize_names.bounds.size()); ++k)
      if (const std::string words = interval_in_words(o.finer, k, r.optimize_names); !words.empty())
        facts.add(escape_html(r.optimize_names.bounds[k]), words);
    facts.add("its size and element",
              fmt::format("{}, {} of degree {}{}", pretty(o.finer.size), escape_html(o.finer.element.name),
                          o.finer.element.degree, o.finer.curved ? " on curved edges" : ""));
  }
  return facts.html.empty() ? facts.html : "<h3>Certificate</h3>\n" + facts.table();
}

std::string design_figures(const Result& r, const PageData& data) {
  std::string out;
  if (const NamedArray* shots = find_array(data.arrays, "design.shots"))
    out += fmt::format(
        "<figure class=\"view\" id=\"design\"><div class=\"stage\" role=\"group\" aria-label=\"The design, iteration "
        "by "
        "iteration\"></div>\n<figcaption>The design at {} of {} iterations. Dashed: where it began.</figcaption>"
        "</figure>\n",
        shots->rows(), r.optimize->history.size());
  if (find_array(data.arrays, "found.lines"))
    out += fmt::format(
        "<figure class=\"view\" id=\"found\"><div class=\"stage\" role=\"group\" aria-label=\"What was found\"></div>\n"
        "<figcaption>What was found: gray and dashed where it began, {}thin blue what was "
        "found{}.</figcaption></figure>\n",
        r.identified.empty() ? "" : "broad green what is true, ",
        r.fit && !r.fit->ellipses.empty() ? ", orange 95 % of its uncertainty" : "");
  if (r.optimize->history.size() < 2) return out;
  out += "<div class=\"curves\">\n";
  for (const char* id : {"objective", "volume", "bounds"}) {
    if (std::string_view(id) == "bounds" && r.optimize_names.bounds.empty()) continue;
    out += fmt::format("<figure id=\"history-{}\"><div class=\"plot\"></div></figure>\n", id);
  }
  return out + "</div>\n";
}

}  // namespace

std::string optimize_section(const Result& r, const PageData& data) {
  const OptimizeResult& o = *r.optimize;
  const OptimizeNames& names = r.optimize_names;
  std::string out = "<h2>Optimization</h2>\n" + note(sentence(o), !o.feasible);
  for (const std::string& text : o.notes) out += note(text);
  if (r.counted) {
    std::string lines;
    for (const std::string& line : table_in_words(*r.counted)) lines += escape_html(line) + "<br>\n";
    out += "<p class=\"note\">" + lines + "</p>\n";
  }
  if (r.fit) {
    std::string lines;
    for (const std::string& line : in_words(*r.fit, names.variables)) lines += escape_html(line) + "<br>\n";
    out += "<p class=\"note\">" + lines + "</p>\n";
  }
  for (const Identified& i : r.identified) out += note(in_words(i));
  out += design_figures(r, data);
  Facts facts;
  facts.add("method", escape_html(word(o.method)));
  if (!o.history.empty())
    facts.add("objective at the start", with_unit(o.history.front().objective, r.units, r.functional_dimension));
  facts.add("objective", with_unit(o.objective, r.units, r.functional_dimension));
  facts.add("volume fraction",
            pretty(o.volume_fraction) +
                (names.volume_at_most ? fmt::format(" (at most {})", pretty(*names.volume_at_most)) : ""));
  if (!o.history.empty())
    for (std::size_t i = 0; i < std::min(names.bounds.size(), o.history.back().bounds.size()); ++i)
      facts.add(names.bounds[i],
                fmt::format("{} (at most {})", pretty(o.history.back().bounds[i]), pretty(names.at_most[i])));
  facts.add("state solves", fmt::format("{}", o.state_solves));
  out += facts.table() + certificate(r);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < std::min(names.variables.size(), static_cast<std::size_t>(o.variables.size())); ++i)
    rows.push_back({escape_html(names.variables[i]), pretty(o.variables[static_cast<Eigen::Index>(i)])});
  if (!rows.empty()) out += folded("Variables of the design", table({"variable", "value"}, rows));
  if (!o.nucleated.empty()) out += nucleated_table(o.nucleated);
  if (!o.history.empty()) out += history_table(o.history, names);
  return out;
}

}  // namespace kerf
