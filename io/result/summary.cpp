// The summary of a run for a terminal: a heading of 12 columns, items with two blanks between them or a sentence,
// wrapped at 100 columns. Widths count letters, not bytes (continuation bytes of UTF-8 are left out), and words longer
// than a line are cut. Every text of a user goes through clean_text: no control characters reach the terminal. Numbers
// have six digits, with +- a margin of two where one is known, and their units where the case names units. Long lists
// are cut after ten points or thirty variables, with the file that has the rest. An interval that is no guarantee says
// "(estimate)".

#include "io/history.hpp"
#include "io/map_words.hpp"
#include "io/result.hpp"
#include "io/text.hpp"
#include "io/validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

ReserveWords words_of(ReserveResult::Of of) {
  switch (of) {
    case ReserveResult::Of::Yield:
      return {"von Mises stress", "yield", dimension::stress};
    case ReserveResult::Of::Toughness:
      return {"K_eq", "fracture", dimension::stress_intensity};
    case ReserveResult::Of::ReleaseRate:
      return {"G", "fracture", dimension::release_rate};
  }
  return {};
}

namespace {

constexpr std::size_t columns = 100, indent = 12;

std::size_t letters(const std::string& text) {
  std::size_t count = 0;
  for (const char c : text) count += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return count;
}

/// A word too long for its line goes over several.
std::vector<std::string> pieces_of(const std::string& word, std::size_t width) {
  std::vector<std::string> out(1);
  for (const char c : word) {
    const bool starts = (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    if (starts && letters(out.back()) == width) out.emplace_back();
    out.back() += c;
  }
  return out;
}

/// "  heading   text that goes on", wrapped at `columns`, further lines indented. Two blanks between items stay.
void add(std::string& out, const std::string& heading, const std::vector<std::string>& items) {
  std::string line = fmt::format("{:<{}}", heading, indent);
  bool fresh = true;
  for (const std::string& item : items) {
    for (const std::string& piece : pieces_of(item, columns - indent)) {
      if (!fresh && letters(line) + 2 + letters(piece) > columns) {
        out += line + '\n';
        line = std::string(indent, ' ');
        fresh = true;
      }
      line += (fresh ? "" : "  ") + piece;
      fresh = false;
    }
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  out += line + '\n';
}

/// One sentence, wrapped between words.
void add_sentence(std::string& out, const std::string& heading, const std::string& text) {
  std::string line = fmt::format("{:<{}}", heading, indent), word;
  const std::size_t start = line.size();
  const auto flush = [&] {
    for (const std::string& piece : pieces_of(word, columns - indent)) {
      if (line.size() > start && letters(line) + 1 + letters(piece) > columns) {
        out += line + '\n';
        line = std::string(start, ' ');
      }
      line += (line.size() > start ? " " : "") + piece;
    }
    word.clear();
  };
  for (const char c : clean_text(text)) {
    if (c != ' ') {
      word += c;
    } else if (!word.empty()) {
      flush();
    }
  }
  if (!word.empty()) flush();
  out += line + '\n';
}

std::string item(const std::string& name, double value, const std::string& unit = "") {
  return fmt::format("{} {}{}", name, six(value), with_blank(unit));
}

/// "K_I 1.2 +- 0.003 MPa √m".
std::string item(const std::string& name, double value, const std::optional<double>& margin, const std::string& unit) {
  if (!margin || !std::isfinite(*margin)) return item(name, value, unit);
  return fmt::format("{} {} +- {:.2g}{}", name, six(value), *margin, with_blank(unit));
}

std::string at(const Vec2& p) {
  return fmt::format("at ({}, {})", six(p.x()), six(p.y()));
}

/// "name 5.1 at (0, 1)"; of a singular one what a finer mesh does not change comes first.
std::vector<std::string> in_words(const std::string& name, const Peak& peak, const std::string& unit) {
  const auto placed = [&](const PlacedValue& v) {
    return item("", v.value, v.margin, unit).substr(1) + ' ' + at(v.at);
  };
  if (!peak.singular) return {name + ' ' + placed(peak.largest)};
  std::vector<std::string> items;
  if (peak.regular) items.push_back(name + ' ' + placed(*peak.regular));
  items.push_back((peak.regular ? "singular " : name + ", singular: ") + placed(peak.largest));
  return items;
}

std::string force(const ResultantResult& r, const Units& units) {
  const std::string name = unit(units, dimension::force);
  return fmt::format("force ({}, {}){}", six(r.force.x()), six(r.force.y()), name.empty() ? "" : " " + name);
}

void add_resultants(std::string& out, const StateResult& s, const Units& units) {
  const auto line = [&](const std::string& heading, const std::string& what, const ResultantResult& r) {
    std::vector<std::string> items{force(r, units), item("moment", r.moment, unit(units, dimension::moment))};
    if (!what.empty()) items.insert(items.begin(), clean_text(what));
    add(out, heading, items);
  };
  for (std::size_t i = 0; i < s.loads.size(); ++i) line(i == 0 ? "loads" : "", s.loads[i].on, s.loads[i]);
  if (s.body) line(s.loads.empty() ? "loads" : "", "body", *s.body);
  for (std::size_t i = 0; i < s.reactions.size(); ++i)
    line(i == 0 ? "reactions" : "", s.reactions[i].on, s.reactions[i]);
  if (s.balance) line("balance", "", *s.balance);
}

/// "yield 2.31: von Mises stress 108.2 of 250 at (1, 2) in region "stiff"".
std::vector<std::string> in_words(const ReserveResult& r, const Units& u) {
  const ReserveWords words = words_of(r.of);
  return {fmt::format("{} {:.3g}{}", words.against, r.factor, r.factor < 1 ? " (exceeded)" : ""),
          fmt::format("{} {:.4g} of {:.4g}{} at ({:.4g}, {:.4g}){}{}", words.quantity, r.value, r.limit,
                      with_blank(unit(u, words.dimension)), r.at.x(), r.at.y(),
                      r.region.empty() ? "" : fmt::format(" in region {}", clean_text(r.region)),
                      r.crack.empty() ? "" : fmt::format(", crack {}", clean_text(r.crack)))};
}

void add_reserves(std::string& out, const std::vector<ReserveResult>& reserves, const Units& u) {
  for (std::size_t k = 0; k < reserves.size(); ++k) add(out, k == 0 ? "reserve" : "", in_words(reserves[k], u));
}

void add_load_cases(std::string& out, const std::vector<LoadCaseResult>& cases, const Units& u) {
  for (const LoadCaseResult& c : cases) {
    add(out, "load case",
        {clean_text(c.name), item("weight", c.weight), item("compliance", c.compliance, unit(u, dimension::energy))});
    if (c.von_mises) add(out, "", in_words("max von Mises stress", *c.von_mises, unit(u, dimension::stress)));
    if (c.displacement) add(out, "", in_words("max displacement", *c.displacement, unit(u, dimension::length)));
    for (const ReserveResult& r : c.reserves) {
      std::vector<std::string> words = in_words(r, u);
      words[0] = "reserve " + words[0];
      add(out, "", words);
    }
    for (const ResultantResult& r : c.reactions)
      add(out, "", {"reaction " + clean_text(r.on), force(r, u), item("moment", r.moment, unit(u, dimension::moment))});
  }
}

/// Of the whole plate, thickness included.
void add_plate(std::string& out, const StateResult& s, double thickness, const Units& u) {
  const std::string force = unit_of_plate(u, dimension::force), energy = unit_of_plate(u, dimension::energy);
  add(out, "plate",
      {item("thickness", thickness, unit(u, dimension::length)), item("energy", thickness * s.energy, energy),
       item("compliance", thickness * s.compliance, energy)});
  const auto line = [&](const std::string& on, const ResultantResult& r) {
    add(out, "",
        {clean_text(on), fmt::format("force ({}, {}){}", six(thickness * r.force.x()), six(thickness * r.force.y()),
                                     force.empty() ? "" : " " + force)});
  };
  for (const ResultantResult& r : s.loads) line(r.on, r);
  if (s.body) line("body", *s.body);
  for (const ResultantResult& r : s.reactions) line(r.on, r);
}

void add_crack(std::string& out, const CrackResult& crack, const Units& u) {
  const std::string length = unit(u, dimension::length), stress = unit(u, dimension::stress),
                    intensity = unit(u, dimension::stress_intensity);
  add(out, "crack",
      {clean_text(crack.name) + (crack.half ? " (in a plane of symmetry)" : ""), item("length", crack.length, length),
       item("max opening", crack.max_opening, length)});
  if (crack.fluid_pressure) add(out, "", {item("fluid pressure", *crack.fluid_pressure, stress)});
  if (crack.pressure) add(out, "", in_words("max pressure", *crack.pressure, stress));
  for (const auto& t : crack.transitions)
    add(out, "", {clean_text(t.from) + " -> " + clean_text(t.to) + ' ' + at(t.at)});
  for (const TipResult& tip : crack.tips) {
    if (!tip.K_I && !tip.K_II && !tip.G && tip.note.empty()) continue;
    std::vector<std::string> items = {"tip " + at(tip.at)};
    if (!tip.note.empty()) items.push_back(tip.note);
    const auto margin = [&](double TipResult::Margin::*of) -> std::optional<double> {
      return tip.margin ? std::optional((*tip.margin).*of) : std::nullopt;
    };
    using Margin = TipResult::Margin;
    if (tip.K_I) items.push_back(item("K_I", *tip.K_I, margin(&Margin::K_I), intensity));
    if (tip.K_II) items.push_back(item("K_II", *tip.K_II, margin(&Margin::K_II), intensity));
    if (tip.G) items.push_back(item("G", *tip.G, margin(&Margin::G), unit(u, dimension::release_rate)));
    if (tip.T) items.push_back(item("T", *tip.T, margin(&Margin::T), stress));
    add(out, "", items);
  }
}

/// "K_I 1.2 in [1.1, 1.3] MPa √m", with what the interval is worth where it is no guarantee.
std::string interval(const char* name, const Bounded& b, const std::string& unit) {
  if (!std::isfinite(b.value)) return fmt::format("{}: none", name);
  return fmt::format("{} in [{}, {}]{}{}", name, six(b.lower), six(b.upper), with_blank(unit),
                     b.guaranteed ? "" : " (estimate)");
}

std::string in_words(const BoundedMean& m) {
  switch (m.of) {
    case BoundedMean::Of::Disc:
      return fmt::format("mean over the disc {}, radius {}", at(m.from), six(m.radius));
    case BoundedMean::Of::Line:
      return fmt::format("mean along the line from ({}, {}) to ({}, {})", six(m.from.x()), six(m.from.y()),
                         six(m.to.x()), six(m.to.y()));
    case BoundedMean::Of::Displacement:
      return fmt::format("mean of \"{}\"", clean_text(m.on));
    case BoundedMean::Of::Reaction:
      return fmt::format("support of \"{}\"", clean_text(m.on));
    case BoundedMean::Of::Loads:
      return "work of the loads";
  }
  return {};
}

void add_bounds(std::string& out, const BoundsResult& bounds, const Units& u, const std::string& of_map) {
  std::string heading = "bounds", said;
  const auto line = [&](const std::string& place, std::vector<std::string> items,
                        const std::vector<const Bounded*>& of) {
    items.insert(items.begin(), place);
    add(out, heading, items);
    heading.clear();
    for (const Bounded* b : of)
      if (!b->note.empty() && b->note != said) {
        said = b->note;
        add_sentence(out, "", "note: " + said);
      }
  };
  const std::string intensity = unit(u, dimension::stress_intensity), stress = unit(u, dimension::stress);
  for (const BoundedTip& t : bounds.tips)
    line("tip " + at(t.at),
         {interval("K_I", t.K_I, intensity), interval("K_II", t.K_II, intensity),
          interval("G", t.G, unit(u, dimension::release_rate))},
         {&t.K_I, &t.K_II, &t.G});
  constexpr std::size_t shown = 10;
  for (std::size_t i = 0; i < std::min(bounds.points.size(), shown); ++i) {
    const BoundedPoint& p = bounds.points[i];
    line(at(p.at),
         {interval("s_xx", p.s_xx, stress), interval("s_yy", p.s_yy, stress), interval("s_xy", p.s_xy, stress),
          interval("von Mises", p.von_mises, stress), interval("topological derivative", p.derivative, of_map)},
         {&p.s_xx, &p.derivative});
  }
  for (const BoundedMean& m : bounds.means) {
    std::vector<std::string> items;
    const std::span<const NamedQuantity> names = quantities_of(m.of);
    for (std::size_t i = 0; i < m.quantities.size(); ++i)
      items.push_back(interval(std::string(names[i].name).c_str(), m.quantities[i], unit(u, names[i].dimension)));
    std::vector<const Bounded*> all;
    for (const Bounded& b : m.quantities) all.push_back(&b);
    line(in_words(m), std::move(items), all);
  }
  if (bounds.points.size() > shown)
    add(out, "", {fmt::format("and {} more points in bounds.csv", bounds.points.size() - shown)});
}

void add_map(std::string& out, const MapResult& map, const std::string& unit) {
  if (std::isfinite(map.min.value)) {
    add(out, "map", {clean_text(map.perturbation), item("min", map.min.value, unit) + ' ' + at(map.min.at)});
    add(out, "", {item("max", map.max.value, unit) + ' ' + at(map.max.at)});
  } else {
    add_sentence(out, "map", clean_text(map.perturbation) + ": " + without_extrema(map));
  }
  if (map.excluded_radius > 0 && std::isfinite(map.min.value)) {
    add_sentence(
        out, "",
        fmt::format("min and max leave out {} around crack tips and reentrant corners", six(map.excluded_radius)));
  }
  if (map.masked_share > 0 && std::isfinite(map.min.value))
    add_sentence(
        out, "",
        fmt::format(
            "masked: a change at radius {} on {:.3g} % of the area would come too near to something; min and max "
            "leave that out",
            six(map.radius), 100 * map.masked_share));
  if (map.biactive_length > 0)
    add_sentence(out, "",
                 fmt::format("a length {} of the cracks has neither gap nor pressure: J has one-sided derivatives, and "
                             "the map is of these",
                             six(map.biactive_length)));
  constexpr std::size_t shown = 10;
  for (std::size_t i = 0; i < std::min(map.points.size(), shown); ++i) {
    const MapPoint& p = map.points[i];
    if (!std::isfinite(p.value)) {
      add(out, "",
          {at(p.at) + (p.masked ? "  no value: too near to something else for this radius"
                                : "  no value: outside the body, or on a crack")});
      continue;
    }
    std::string text = at(p.at) + "  " + six(p.value);
    if (p.lower && p.upper) text += fmt::format("  in [{}, {}]", six(*p.lower), six(*p.upper));
    if (map.oriented) text += fmt::format("  angle {:.1f} deg", degrees(p.angle));
    if (p.masked) text += "  masked";
    add(out, "", {text});
  }
  if (map.points.size() > shown)
    add(out, "", {fmt::format("and {} more points in map.csv", map.points.size() - shown)});
}

void add_functional(std::string& out, const FunctionalResult& functional, const std::string& unit) {
  add(out, "functional", {item(functional.kind, functional.value, unit)});
  for (const auto& term : functional.terms)
    add(out, "", {fmt::format("{} times", six(term.factor)), item(term.kind, term.value)});
}

void add_validation(std::string& out, const ValidationResult& validation) {
  std::size_t hold = 0;
  for (const Validation& v : validation.points) hold += v.verdict == Verdict::Holds;
  add(out, "validate",
      {clean_text(validation.perturbation), fmt::format("holds at {} of {} points", hold, validation.points.size())});
  for (const Validation& v : validation.points) add_sentence(out, "", sentence(v));
}

void add_optimization(std::string& out, const OptimizeResult& o, const OptimizeNames& names, const std::string& unit) {
  add_sentence(out, "optimize", sentence(o));
  std::vector<std::string> items = {item("objective", o.objective, unit), item("volume fraction", o.volume_fraction)};
  if (!o.history.empty()) items[0] += " from " + six(o.history.front().objective);
  if (std::isfinite(o.optimality)) items.push_back(item("optimality", o.optimality));
  if (const double left = o.gain.sum(); std::isfinite(left))
    items.push_back(fmt::format("gain left {:.2g} %", 100 * left));
  if (!o.history.empty())
    items.push_back(fmt::format("{} hole{}", o.history.back().holes, o.history.back().holes == 1 ? "" : "s"));
  add(out, "", items);
  if (!o.history.empty())
    for (std::size_t i = 0; i < std::min(names.bounds.size(), o.history.back().bounds.size()); ++i)
      add(out, "", {item(clean_text(names.bounds[i]), o.history.back().bounds[i]), item("at most", names.at_most[i])});
  for (const KeptConstraint& c : o.constraints)
    add(out, "", {item(clean_text(c.name), c.got), item("asked", c.asked), c.kept ? "kept" : "not kept"});
  items.clear();
  constexpr std::size_t shown = 30;
  const std::size_t count = std::min(names.variables.size(), static_cast<std::size_t>(o.variables.size()));
  for (std::size_t i = 0; i < std::min(count, shown); ++i)
    items.push_back(item(clean_text(names.variables[i]), o.variables[static_cast<Eigen::Index>(i)]));
  if (count > shown) items.push_back(fmt::format("and {} more variables in result.json", count - shown));
  if (!items.empty()) add(out, "", items);
  for (const std::string& note : o.notes) add_sentence(out, "", "note: " + note);
}

void add_path_bounds(std::string& out, const growth::PathBounds& b, bool fatigue) {
  const auto in = [](const Interval& i) { return fmt::format("[{}, {}]", six(i.low), six(i.high)); };
  const auto known = [](const Interval& i) { return !std::isnan(i.low) && !std::isnan(i.high); };
  if (fatigue && known(b.cycles))
    add_sentence(out, "",
                 fmt::format("cycles in {} if K changes one way from step to step, in {} if it is smooth", in(b.cycles),
                             in(b.cycles_smooth)));
  if (known(b.released) && known(b.lost))
    add_sentence(
        out, "",
        fmt::format("growth releases an energy in {}, the body loses one in {}: {}", in(b.released), in(b.lost),
                    b.released.low <= b.lost.high && b.lost.low <= b.released.high ? "both can be the same number"
                                                                                   : "they contradict each other"));
  add_sentence(out, "",
               b.guaranteed ? "the intervals of K, G and energy are guaranteed at every step"
                            : fmt::format("the intervals are not guaranteed: {}", clean_text(b.note)));
}

void add_growth(std::string& out, const GrowthResult& g, const Units& u) {
  const std::string length = unit(u, dimension::length), K = unit(u, dimension::stress_intensity);
  const bool fatigue = g.law != "quasi-static";
  add_sentence(out, "growth",
               fmt::format("{} by {}: {} step{}, {} states; {}", g.law, g.criterion, g.steps.size(),
                           g.steps.size() == 1 ? "" : "s", g.solves, clean_text(g.ended)));
  if (!g.steps.empty()) {
    const growth::GrowthStep& last = g.steps.back();
    const auto bar = [](double error) {
      return std::isfinite(error) ? fmt::format(" +- {:.2g}", error) : std::string();
    };
    std::vector<std::string> items{fatigue ? item("cycles", last.cycles) + bar(g.cycles_error)
                                           : item("load", last.load)};
    if (std::isfinite(g.path_error)) items.push_back(fmt::format("path{}{}", bar(g.path_error), with_blank(length)));
    for (const growth::GrownTip& tip : last.tips)
      items.push_back(fmt::format("{}: a {}{}, {} {}{}", clean_text(tip.name), six(tip.a), with_blank(length),
                                  fatigue ? "dK" : "K", six(tip.dK), with_blank(K)));
    add(out, "", items);
  }
  if (g.unstable_from)
    add_sentence(
        out, "",
        fmt::format("unstable from step {} on: the load falls as the crack grows{}", *g.unstable_from,
                    !g.snaps_back_from ? std::string()
                    : *g.snaps_back_from == *g.unstable_from
                        ? ", and so does its displacement (snap-back)"
                        : fmt::format(", from step {} on its displacement, too (snap-back)", *g.snaps_back_from)));
  if (std::isfinite(g.energy_balance))
    add_sentence(
        out, "",
        fmt::format("G along the paths is the loss of potential energy to {:.2g} %", 100 * std::abs(g.energy_balance)));
  if (g.bounds) add_path_bounds(out, *g.bounds, fatigue);
  for (const std::string& note : g.notes) add_sentence(out, "", clean_text(note));
}

/// "(1, 0): K 12.3 MPa, 90 degrees, critical at 3.4"
std::string in_words(const EdgeCrackResult::Row& row, const EdgeCrackResult& e, const Units& u) {
  const inspect::EdgeCrack& crack = row.crack;
  std::string line = fmt::format("({:.6g}, {:.6g}): ", crack.at.x(), crack.at.y());
  if (crack.masked != inspect::Masked::No) return line + fmt::format("masked ({})", word(crack.masked));
  line +=
      fmt::format("K {:.4g}{}, {:.0f} degrees{}{}{}, good up to a length of {:.3g}", crack.K,
                  with_blank(unit(u, dimension::stress_intensity)), crack.angle * 180 / pi,
                  crack.flattest() && !e.angle ? " or flatter" : "", std::isfinite(crack.corner) ? " in a corner" : "",
                  crack.closed ? ", closed" : "", crack.valid_length);
  if (e.law.empty()) return line;
  const inspect::Tolerance& t = row.tolerance;
  if (std::isfinite(t.critical_length)) line += fmt::format("; critical at {:.4g}", t.critical_length);
  if (t.how == inspect::Tolerated::Rests) return line + "; it does not grow";
  if (std::isfinite(t.cycles))
    line += fmt::format("; {}{:.4g} cycles, inspect every {:.4g}",
                        t.how == inspect::Tolerated::AtLeast ? "at least " : "", t.cycles, t.interval);
  return line;
}

void add_edge_cracks(std::string& out, const EdgeCrackResult& e, const Units& u) {
  add_sentence(out, "edge cracks",
               fmt::format("of length {:.4g}{} at {} places of the boundary{}; {:.0f} % of it is masked", e.length,
                           with_blank(unit(u, dimension::length)), e.places,
                           e.angle ? fmt::format(", at {:g} degrees", *e.angle * 180 / pi) : ", in the worst direction",
                           100 * e.masked_share));
  if (e.worst.empty()) add_sentence(out, "", "no place that is not masked has K > 0");
  for (const EdgeCrackResult::Row& row : e.worst) add_sentence(out, "", in_words(row, e, u));
  if (!e.inside.empty()) {
    const inspect::InteriorCrack& worst = e.inside.front();
    add_sentence(out, "",
                 fmt::format("inside the body, two lengths from all sides: K {:.4g}{} at ({:.6g}, {:.6g}), direction "
                             "{:.0f} degrees{}",
                             worst.K, with_blank(unit(u, dimension::stress_intensity)), worst.at.x(), worst.at.y(),
                             worst.direction * 180 / pi, worst.closed ? ", closed" : ""));
  }
  if (!e.law.empty())
    add_sentence(out, "",
                 e.safe
                     ? fmt::format("no crack shorter than {:.4g} is critical, first at ({:.6g}, {:.6g}); on {:.0f} % "
                                   "of the boundary that is not known",
                                   e.safe->value, e.safe->at.x(), e.safe->at.y(), 100 * e.open_share)
                     : fmt::format("no crack is critical as far as the expansion holds; on {:.0f} % of the boundary "
                                   "nothing is known",
                                   100 * e.open_share));
  for (const inspect::DrawnPlace& place : e.drawn)
    add_sentence(out, "",
                 fmt::format("drawn at ({:.6g}, {:.6g}): {}: {}", place.crack.at.x(), place.crack.at.y(),
                             word(place.verdict), place.reason));
}

void add_times(std::string& out, const Result& result) {
  const Seconds& s = result.seconds;
  std::vector<std::string> items = {fmt::format("total {:.3f} s", s.total)};
  for (const TimedPhase& phase : timed_phases)
    if (s.*phase.of > 0) items.push_back(fmt::format("{} {:.3f}", phase.name, s.*phase.of));
  add(out, "time", items);
  if (const auto& parts = result.solver; parts && parts->parts > 1) {
    add(out, "parts",
        {fmt::format("{} processes", parts->parts), fmt::format("{} solves", parts->solves),
         fmt::format("at most {} iterations", parts->iterations),
         fmt::format("peaks {:.1f} MB of the first, {:.1f} MB of the others", parts->first_mb, parts->others_mb)});
    return;
  }
  if (result.peak_memory_mb > 0) add(out, "memory", {fmt::format("peak {:.1f} MB", result.peak_memory_mb)});
}

/// The title, how the run ended, the units.
void add_case(std::string& out, const Result& result) {
  const std::string title = clean_text(result.title);
  add_sentence(out, "case",
               clean_text(result.case_name) + (title.empty() || title == result.case_name ? "" : ": " + title));
  // How an optimization ended, its own line says.
  const bool told = result.optimize && result.status == word(result.optimize->ending);
  if (!told && (result.status != "ok" || result.reason))
    add_sentence(out, "status", result.status + (result.reason ? ": " + *result.reason : ""));
  const Units& u = result.units;
  if (u.given())
    add_sentence(
        out, "units",
        fmt::format("{} and {}; forces, moments and energies per {} of thickness", u.length, u.stress, u.length));
}

void add_mesh(std::string& out, const Result& result) {
  const std::string length = unit(result.units, dimension::length);
  add(out, "mesh",
      {fmt::format("{} triangles", result.triangles), fmt::format("{} vertices", result.vertices),
       item("h", result.mesh.h_min) + " .. " + six(result.mesh.h_max) + (length.empty() ? "" : " " + length),
       fmt::format("min angle {:.1f} deg", result.mesh.min_angle_deg),
       fmt::format("mean quality {:.3f}", result.mesh.mean_quality)});
}

void add_adaptation(std::string& out, const AdaptResult& a) {
  add_sentence(out, "adapt",
               fmt::format("{}{} after {} rounds", a.of.empty() ? "" : fmt::format("for {}: ", clean_text(a.of)),
                           a.stopped, a.rounds.size()));
}

void add_state(std::string& out, const StateResult& s, const Units& u) {
  const std::string energy = unit(u, dimension::energy), stress = unit(u, dimension::stress),
                    length = unit(u, dimension::length);
  add(out, "state",
      {fmt::format("{} {}", s.element, s.degree), fmt::format("{} unknowns", s.unknowns),
       fmt::format("{} condensed", s.condensed_unknowns), item("residual", s.residual)});
  add(out, "",
      {item("energy", s.energy, energy), item("compliance", s.compliance, energy),
       item("area", s.area, unit(u, dimension::area))});
  if (s.von_mises) add(out, "", in_words("max von Mises stress", *s.von_mises, stress));
  if (s.displacement) add(out, "", in_words("max displacement", *s.displacement, length));
  if (s.estimated_error) add(out, "", {item("estimated error", *s.estimated_error)});
  if (s.energy_bounds) {
    add(out, "",
        {fmt::format("energy{} in [{}, {}]{}", s.of_polygon ? " of the polygon" : "", six((*s.energy_bounds)[0]),
                     six((*s.energy_bounds)[1]), energy.empty() ? "" : " " + energy)});
  }
  add_reserves(out, s.reserves, u);
  add_resultants(out, s, u);
  if (s.thickness) add_plate(out, s, *s.thickness, u);
  for (const std::string& note : s.notes) add_sentence(out, "note", note);
}

void add_contact(std::string& out, const ContactResultSummary& c, const std::string& length) {
  add(out, "contact",
      {c.method, fmt::format("{} iterations", c.iterations), fmt::format("{} linear solves", c.linear_solves),
       item("kkt", c.kkt)});
  std::vector<std::string> lengths = {item("open", c.open_length, length), item("closed", c.closed_length, length)};
  if (c.biactive_length > 0) lengths.push_back(item("biactive", c.biactive_length, length));
  add(out, "", lengths);
}

}  // namespace

std::string without_extrema(const MapResult& map) {
  if (map.masked_share > 0)
    return fmt::format(
        "masked everywhere: at every place a change of radius {} comes too near to something, and nothing can be said "
        "of it; a smaller map.radius leaves room",
        six(map.radius));
  return map.points.empty() ? "no place of the body has a value" : "none of the points has a value";
}

std::string summary(const Result& result) {
  const Units& u = result.units;
  const std::string of_functional = result.functional_dimension ? unit(u, *result.functional_dimension) : "",
                    of_map = result.functional_dimension ? unit(u, per_area(*result.functional_dimension)) : "";
  std::string out;
  add_case(out, result);
  if (result.triangles > 0) add_mesh(out, result);
  if (result.adapt) add_adaptation(out, *result.adapt);
  if (result.state) add_state(out, *result.state, u);
  add_load_cases(out, result.load_cases, u);
  if (result.contact) add_contact(out, *result.contact, unit(u, dimension::length));
  for (const CrackResult& crack : result.cracks) add_crack(out, crack, u);
  if (result.bounds) add_bounds(out, *result.bounds, u, of_map);
  if (result.functional) add_functional(out, *result.functional, of_functional);
  if (result.map) add_map(out, *result.map, of_map);
  if (result.edge_cracks) add_edge_cracks(out, *result.edge_cracks, u);
  if (result.validate) add_validation(out, *result.validate);
  if (result.growth) add_growth(out, *result.growth, u);
  if (result.optimize) add_optimization(out, *result.optimize, result.optimize_names, of_functional);
  if (result.counted)
    for (const std::string& line : table_in_words(*result.counted)) add_sentence(out, "count", line);
  if (result.fit)
    for (const std::string& line : in_words(*result.fit, result.optimize_names.variables))
      add_sentence(out, "fit", line);
  for (const Identified& i : result.identified) add_sentence(out, "found", in_words(i));
  add_times(out, result);
  return out;
}

}  // namespace kerf
