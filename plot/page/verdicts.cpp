// The head of the page: one line per job with a verdict in a word, good, a warning or bad, and why; and the numbers
// that one looks for first. A validation is bad where the expansion fails at a point, good where it holds at all of
// them, and a warning else; its reason is that of the worst point. A state that did not converge and a design that is
// infeasible are said in the line of their job; any other failure in a line of its own.

#include "io/history.hpp"
#include "io/map_words.hpp"
#include "io/text.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/sections.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

namespace kerf {

namespace {

enum class Mood { Good, Warn, Bad };

std::string line(const char* job, Mood mood, const std::string& word, const std::string& why) {
  const char* kind = mood == Mood::Good ? "good" : mood == Mood::Warn ? "warn" : "bad";
  return fmt::format("<li class=\"{}\"><span class=\"job\">{}</span><p><span class=\"word\">{}</span>{}{}</p></li>\n",
                     kind, job, escape_html(word), why.empty() ? "" : ": ", escape_html(why));
}

std::string of_state(const Result& r) {
  const StateResult& s = *r.state;
  if (r.status == "not converged") return line("state", Mood::Bad, r.status, r.reason.value_or(""));
  std::string why = fmt::format("residual {}", pretty(s.residual, 2));
  if (r.contact) why += fmt::format(", contact solved to {}", pretty(r.contact->kkt, 2));
  if (std::isfinite(s.work_error))
    why += fmt::format(", work of the loads equals twice the energy to {}", pretty(s.work_error, 2));
  if (s.estimated_error)
    why += fmt::format("; estimated error of the stress {} %", pretty(100 * *s.estimated_error, 3));
  return line("state", Mood::Good, "ok", why);
}

std::string of_refinement(const AdaptResult& adapt) {
  return line("mesh", adapt.stopped.starts_with("reached") ? Mood::Good : Mood::Warn, "refined",
              adapt.of.empty() ? adapt.stopped : fmt::format("for {}: {}", adapt.of, adapt.stopped));
}

std::string of_map(const MapResult& map) {
  if (!std::isfinite(map.min.value)) return line("map", Mood::Warn, "no values", without_extrema(map));
  std::string why = fmt::format("from {} to {}", pretty(map.min.value), pretty(map.max.value));
  if (map.masked_share > 0)
    why += fmt::format("; at radius {} it says nothing of {:.3g} % of the area", pretty(map.radius),
                       100 * map.masked_share);
  return line("map", Mood::Good, "made", why);
}

/// "2 hold, 1 fails": the words of the points, in the order of the verdicts; the reason where there is one word.
std::string of_validation(const ValidationResult& validation) {
  std::map<Verdict, int> count;
  for (const Validation& v : validation.points) ++count[v.verdict];
  std::string words;
  for (const auto& [verdict, n] : count) {
    if (!words.empty()) words += ", ";
    words += count.size() == 1 ? std::string(word(verdict)) : fmt::format("{} at {}", word(verdict), n);
  }
  const Validation* worst = nullptr;
  for (const Validation& v : validation.points)
    if (!worst || (v.verdict == Verdict::Fails && worst->verdict != Verdict::Fails) ||
        (v.verdict != Verdict::Holds && worst->verdict == Verdict::Holds))
      worst = &v;
  if (!worst) return {};
  const Mood mood = count.count(Verdict::Fails) > 0                        ? Mood::Bad
                    : count.count(Verdict::Holds) > 0 && count.size() == 1 ? Mood::Good
                                                                           : Mood::Warn;
  std::string why = fmt::format("{} point{}", validation.points.size(), validation.points.size() == 1 ? "" : "s");
  if (!worst->reason.empty()) why += fmt::format("; at {}: {}", place(worst->at), worst->reason);
  return line("validation", mood, words, why);
}

std::string of_optimization(const OptimizeResult& o) {
  std::string why = o.stopped;
  const std::string said = verdict_of(o);
  if (why.starts_with(said + ": ")) why = why.substr(said.size() + 2);
  const bool bad = o.ending == Ending::Infeasible || o.ending == Ending::Unexplained;
  const bool good = o.ending == Ending::Optimal || o.ending == Ending::OptimalWithin;
  const Mood mood = good ? Mood::Good : bad ? Mood::Bad : Mood::Warn;
  return line("optimization", mood, said, why);
}

/// The constraints, measured on the design that is drawn.
std::string of_constraints(const std::vector<KeptConstraint>& all) {
  std::string why;
  int kept = 0;
  for (const KeptConstraint& c : all) {
    kept += c.kept;
    if (!why.empty()) why += "; ";
    why += c.kept ? fmt::format("{} {:.4g}, asked {:.4g}", c.name, c.got, c.asked) : c.note;
  }
  const bool good = kept == int(all.size());
  return line("constraints", good ? Mood::Good : Mood::Bad,
              good ? "kept" : fmt::format("{} of {} not kept", int(all.size()) - kept, all.size()), why);
}

}  // namespace

std::string verdicts(const Result& r) {
  std::string out;
  const bool elsewhere =
      r.status == "ok" || (r.status == "not converged" && r.state) || (r.status == "infeasible" && r.optimize);
  if (!elsewhere) out += line("run", Mood::Bad, r.status, r.reason.value_or(""));
  if (r.adapt) out += of_refinement(*r.adapt);
  if (r.state) out += of_state(r);
  if (r.map) out += of_map(*r.map);
  if (r.validate) out += of_validation(*r.validate);
  if (r.optimize) out += of_optimization(*r.optimize);
  if (r.optimize && !r.optimize->constraints.empty()) out += of_constraints(r.optimize->constraints);
  return out.empty() ? out : fmt::format("<ul class=\"verdicts\" aria-label=\"Verdicts\">\n{}</ul>\n", out);
}

namespace {

/// "28.98 ± 0.8 N/mm": four digits, of the margin one.
std::string with_margin(double value, std::optional<double> margin, const Units& units,
                        const std::optional<Dimension>& of) {
  std::string out = pretty(value, 4);
  if (margin && std::isfinite(*margin)) out += " ± " + pretty(*margin, 1);
  return of ? out + escape_html(with_blank(unit(units, *of))) : out;
}

/// The tip that is pulled most, if any has K.
struct WorstTip {
  const CrackResult* crack = nullptr;
  const TipResult* tip = nullptr;
};
WorstTip worst_tip(const Result& r) {
  WorstTip worst;
  for (const CrackResult& crack : r.cracks)
    for (const TipResult& tip : crack.tips)
      if (tip.K_I && tip.K_II && (!worst.tip || tip.G.value_or(0) > worst.tip->G.value_or(0))) worst = {&crack, &tip};
  return worst;
}

}  // namespace

std::string key_numbers(const Result& r) {
  std::string out;
  const auto add = [&](const std::string& name, const std::string& number) {
    out += fmt::format("<div><b>{}</b><span>{}</span></div>\n", number, escape_html(name));
  };
  const auto add_placed = [&](const std::string& name, const PlacedValue& v, const Dimension& of) {
    add(name, with_margin(v.value, v.margin, r.units, of));
  };
  if (r.optimize) {
    add("objective", with_margin(r.optimize->objective, {}, r.units, r.functional_dimension));
    add("volume fraction", pretty(r.optimize->volume_fraction, 4));
  }
  if (const auto [crack, tip] = worst_tip(r); tip) {
    const std::string of =
        r.cracks.size() + crack->tips.size() > 2 ? " of " + crack->name + ", the tip pulled most" : "";
    const auto margin = [&](double TipResult::Margin::*of_what) {
      return tip->margin ? std::optional(*tip->margin.*of_what) : std::nullopt;
    };
    add("K_I" + of, with_margin(*tip->K_I, margin(&TipResult::Margin::K_I), r.units, dimension::stress_intensity));
    add("K_II" + of, with_margin(*tip->K_II, margin(&TipResult::Margin::K_II), r.units, dimension::stress_intensity));
    if (tip->G) add("G" + of, with_margin(*tip->G, margin(&TipResult::Margin::G), r.units, dimension::release_rate));
  }
  if (r.state && !r.state->reserves.empty()) {
    const ReserveResult& least = r.state->reserves.front();
    add(fmt::format("reserve against {}", words_of(least.of).against), pretty(least.factor, 3));
  }
  if (r.functional)
    add(r.functional->kind + " (functional)", with_margin(r.functional->value, {}, r.units, r.functional_dimension));
  if (r.state) {
    const std::string said = r.functional ? r.functional->kind : std::string();
    if (said != "energy") add("energy", with_margin(r.state->energy, {}, r.units, dimension::energy));
    if (said != "compliance") add("compliance", with_margin(r.state->compliance, {}, r.units, dimension::energy));
    if (const auto& peak = r.state->von_mises)
      add_placed("largest von Mises stress", peak->singular && peak->regular ? *peak->regular : peak->largest,
                 dimension::stress);
    if (const auto& peak = r.state->displacement) add_placed("largest displacement", peak->largest, dimension::length);
  }
  std::vector<std::string> size;
  if (r.triangles > 0) size.push_back(fmt::format("{} triangles", r.triangles));
  if (r.state) size.push_back(fmt::format("{} unknowns", r.state->unknowns));
  if (std::isfinite(r.seconds.total)) size.push_back(fmt::format("{:.3g} seconds", r.seconds.total));
  return fmt::format("<div class=\"key\">\n{}</div>\n<p class=\"size\">{}</p>\n", out, fmt::join(size, ", "));
}

}  // namespace kerf
