// The data of the page for its script, as JSON and as arrays in base64: fields with their colors and limits, marks,
// curves. Indices take one, two or four bytes, as many as the largest needs; numbers are floats, which a screen does
// not tell from doubles. Data lie in elements of types that no browser runs: they are never code, whatever a result
// holds. Texts of users are escaped. What the page shows of each field (component, length, principal stress) is said in
// one table here, and the browser's script computes it from the arrays.

#include "plot/page/script.hpp"

#include "io/text.hpp"
#include "plot/charts.hpp"
#include "plot/figure/colors.hpp"
#include "plot/figure/ticks.hpp"
#include "plot/page/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

namespace kerf {

namespace {

// Arrays.

template <typename To, typename From>
std::string bytes_of(const std::vector<From>& values) {
  std::vector<To> out(values.size());
  std::transform(values.begin(), values.end(), out.begin(), [](From v) { return static_cast<To>(v); });
  return {reinterpret_cast<const char*>(out.data()), out.size() * sizeof(To)};
}

/// Indices in as few bytes as hold the largest.
std::string array_element(const NamedArray& a) {
  const char* type = "f32";
  std::string bytes;
  if (!a.is_indices()) {
    bytes = bytes_of<float>(a.numbers);
  } else {
    const std::uint32_t most = a.indices.empty() ? 0 : *std::max_element(a.indices.begin(), a.indices.end());
    type = most < 256 ? "u8" : most < 65536 ? "u16" : "u32";
    bytes = most < 256     ? bytes_of<std::uint8_t>(a.indices)
            : most < 65536 ? bytes_of<std::uint16_t>(a.indices)
                           : bytes_of<std::uint32_t>(a.indices);
  }
  return fmt::format("<script type=\"text/plain\" data-array=\"{}\" data-type=\"{}\">{}</script>\n",
                     escape_html(a.name), type, base64(bytes));
}

/// s, opening, slip, contact pressure, fluid pressure, closed.
NamedArray crack_array(const CrackResult& crack, std::size_t i) {
  NamedArray out{.name = fmt::format("crack.{}", i), .width = 6};
  for (const CrackRow& row : crack.rows)
    for (const double value : {row.s, row.jump_n + row.gap, row.jump_t, -row.sigma_n - row.fluid_pressure,
                               row.fluid_pressure, row.closed ? 1.0 : 0.0})
      out.numbers.push_back(static_cast<float>(value));
  return out;
}

// The header.

std::string hex(Scale scale) {
  std::string out;
  for (const std::uint32_t c : colors(scale)) out += fmt::format("{:06x}", c & 0xffffff);
  return out;
}

struct FieldRow {
  const char *id, *label, *symbol, *array;
  int width = 1;
  const char* kind = "component";
  int component = 0;
  std::optional<Dimension> of = dimension::stress;
};

std::string fields(const Result& r) {
  const std::optional<Dimension> per =
      r.functional_dimension ? std::optional(per_area(*r.functional_dimension)) : std::nullopt;
  const bool clamped = r.map && r.map->perturbation == "clamped_hole";
  const FieldRow rows[] = {
      {"von_mises", "von Mises stress", "von Mises", "von_mises"},
      {"first", "larger principal stress", "σ₁", "stress", 3, "first"},
      {"second", "smaller principal stress", "σ₂", "stress", 3, "second"},
      {"s_xx", "stress xx", "σxx", "stress", 3, "component", 0},
      {"s_yy", "stress yy", "σyy", "stress", 3, "component", 1},
      {"s_xy", "stress xy", "σxy", "stress", 3, "component", 2},
      {"u", "displacement", "|u|", "u", 2, "length", 0, dimension::length},
      {"u_x", "displacement x", "ux", "u", 2, "component", 0, dimension::length},
      {"u_y", "displacement y", "uy", "u", 2, "component", 1, dimension::length},
      {"error", "error indicator of the triangle", "η", "error_indicator", 1, "component", 0, std::nullopt},
      {"T", clamped ? "predicted change of J" : "topological derivative T", clamped ? "ΔJ" : "T", "map", 1, "component",
       0, clamped ? r.functional_dimension : per},
      {"lower", "lower end of the error bar", "lower", "lower", 1, "component", 0, per},
      {"upper", "upper end of the error bar", "upper", "upper", 1, "component", 0, per},
      {"angle", "angle in degrees", "angle", "angle", 1, "component", 0, std::nullopt}};
  JsonObject out;
  for (const FieldRow& f : rows) {
    JsonObject field;
    field.text("label", f.label).text("symbol", f.symbol).text("array", f.array).number("width", f.width);
    field.text("kind", f.kind).number("component", f.component);
    field.text("unit", f.of ? unit(r.units, *f.of) : std::string());
    const std::string_view id = f.id;
    field.add("mask", id == "T" || id == "lower" || id == "upper" ? "true" : "false");
    out.add(f.id, field.done());
  }
  return out.done();
}

std::string mark(const Vec2& at, const char* kind, const char* field, double value, const std::string& brief,
                 const std::string& text) {
  JsonObject out;
  out.number("x", at.x()).number("y", at.y()).text("kind", kind).text("field", field).number("value", value);
  return out.text("short", brief).text("text", text).done();
}

void add_tips(const Result& r, std::vector<std::string>& marks) {
  for (const CrackResult& c : r.cracks) {
    for (const TipResult& tip : c.tips) marks.push_back(mark(tip.at, "tip", "", nan, "", "tip of crack " + c.name));
    for (const auto& t : c.transitions)
      marks.push_back(mark(t.at, "change", "", nan, "", fmt::format("crack {}: {} to {}", c.name, t.from, t.to)));
  }
}

std::vector<std::string> state_marks(const Result& r) {
  std::vector<std::string> marks;
  add_tips(r, marks);
  if (!r.state) return marks;
  if (const auto& peak = r.state->von_mises) {
    const PlacedValue& v = peak->singular && peak->regular ? *peak->regular : peak->largest;
    marks.push_back(mark(v.at, "largest", "von_mises", v.value, "largest",
                         peak->singular ? "largest away from singular points" : "largest von Mises stress"));
  }
  if (const auto& peak = r.state->displacement)
    marks.push_back(mark(peak->largest.at, "largest", "u", peak->largest.value, "largest", "largest displacement"));
  return marks;
}

std::vector<std::string> map_marks(const Result& r) {
  std::vector<std::string> marks;
  add_tips(r, marks);
  if (r.map && std::isfinite(r.map->min.value)) {
    marks.push_back(mark(r.map->min.at, "least", "T", r.map->min.value, "least", "least value"));
    marks.push_back(mark(r.map->max.at, "largest", "T", r.map->max.value, "largest", "largest value"));
  }
  if (r.map)
    for (std::size_t i = 0; i < std::min<std::size_t>(r.map->points.size(), most_rows); ++i)
      marks.push_back(mark(r.map->points[i].at, "unsaid", "T", r.map->points[i].value, fmt::format("{}", i + 1),
                           fmt::format("asked point {}", i + 1)));
  if (r.validate)
    for (const Validation& v : r.validate->points) {
      const char* kind = v.verdict == Verdict::Holds ? "holds" : v.verdict == Verdict::Fails ? "fails" : "unsaid";
      const double value = std::isfinite(v.on_mesh) ? v.on_mesh : v.coefficient;
      marks.push_back(mark(v.at, kind, "", nan, std::string(word(v.verdict)),
                           fmt::format("validated here: {}, T {}", word(v.verdict), pretty(value))));
    }
  return marks;
}

/// The factor by which displacements are drawn at first: a few percent of the body, a round number.
double exaggeration(const PageData& data) {
  const NamedArray *points = find_array(data.arrays, "points"), *u = find_array(data.arrays, "u");
  if (!points || !u || points->numbers.empty()) return 0;
  double low[2] = {infinity, infinity}, high[2] = {-infinity, -infinity}, largest = 0;
  for (std::size_t i = 0; i < points->numbers.size(); ++i) {
    low[i % 2] = std::min<double>(low[i % 2], points->numbers[i]);
    high[i % 2] = std::max<double>(high[i % 2], points->numbers[i]);
  }
  for (std::size_t i = 0; i + 1 < u->numbers.size(); i += 2) {
    const double length = std::hypot(u->numbers[i], u->numbers[i + 1]);
    if (std::isfinite(length)) largest = std::max(largest, length);
  }
  const double wanted = 0.06 * std::hypot(high[0] - low[0], high[1] - low[1]) / largest;
  if (!std::isfinite(wanted) || !(wanted > 0)) return 0;
  const double power = std::pow(10, std::floor(std::log10(wanted)));
  for (const double round : {5.0, 2.0})
    if (wanted >= round * power) return round * power;
  return power;
}

std::string figure(const char* id, const Finding& finding, const std::vector<std::string>& fields,
                   const std::vector<std::string>& marks, double deform, double most) {
  JsonObject out;
  out.text("id", id).text("alt", finding.title + ": " + finding.text).add("fields", json_texts(fields));
  return out.add("marks", json_list(marks)).number("deform", deform).number("most", most).done();
}

/// A press fit: what the displacements close is not in the drawing, and drawn large they would open it.
bool overlaps(const Result& r) {
  return std::ranges::any_of(r.cracks, [](const CrackResult& crack) {
    return std::ranges::any_of(crack.rows, [](const CrackRow& row) { return row.gap < 0; });
  });
}

std::string figures(const Result& r, const PageData& data) {
  if (!find_array(data.arrays, "points")) return "[]";
  const std::vector<std::string> of_state{"von_mises", "first", "second", "s_xx", "s_yy",
                                          "s_xy",      "u",     "u_x",    "u_y",  "error"};
  const double times = exaggeration(data);
  std::vector<std::string> all{
      figure("stress", stress_finding(r), of_state, find_array(data.arrays, "map") ? state_marks(r) : [&] {
        std::vector<std::string> marks = state_marks(r), more = map_marks(r);
        marks.insert(marks.end(), more.begin(), more.end());
        return marks;
      }(), overlaps(r) ? 0 : times, 2 * times)};
  if (r.map && find_array(data.arrays, "map"))
    all.push_back(figure("map", map_finding(r), {"T", "lower", "upper", "angle"}, map_marks(r), 0, 2 * times));
  return json_list(all);
}

std::string mask(const Result& r) {
  const std::vector<std::string> near{
      "something else", "the boundary", "a crack", "another material", "the ring of the functional", "the second term"};
  JsonObject out;
  const double radii = clear_radii, radius = r.map ? r.map->radius : 0;
  return out.number("clear", radii * radius).number("radii", radii).add("near", json_texts(near)).done();
}

std::string curve_of_crack(const char* id, const CrackResult& crack, const std::string& label,
                           const std::vector<double>& columns, const std::vector<std::string>& names,
                           const std::string& alt) {
  JsonObject out;
  out.text("id", id).text("label", label).add("columns", json_numbers(columns)).add("names", json_texts(names));
  return out.text("alt", fmt::format("Along crack {}: {}", crack.name, alt)).done();
}

std::string cracks(const Result& r) {
  const auto in = [&](const Dimension& of) { return r.units.given() ? " in " + unit(r.units, of) : std::string(); };
  std::vector<std::string> all;
  for (const CrackResult& c : r.cracks) {
    std::string changes = "no transition between open and closed";
    if (!c.transitions.empty()) {
      changes.clear();
      for (const auto& t : c.transitions)
        changes += fmt::format("{}{} to {} at {}", changes.empty() ? "" : ", ", t.from, t.to, place(t.at));
    }
    double slip = 0;
    for (const CrackRow& row : c.rows) slip = std::max(slip, std::abs(row.jump_t));
    std::vector<double> pressures{3};
    std::vector<std::string> names{"pressure along " + c.name};
    if (c.fluid_pressure) {
      pressures.push_back(4);
      names.emplace_back("fluid pressure");
    }
    const std::vector<std::string> curves{
        curve_of_crack("opening", c, "opening" + in(dimension::length), {1}, {"opening along " + c.name},
                       fmt::format("opens by at most {}; {}.", pretty(c.max_opening), changes)),
        curve_of_crack("slip", c, "slip" + in(dimension::length), {2}, {"slip along " + c.name},
                       fmt::format("slides by at most {}.", pretty(slip))),
        curve_of_crack("pressure", c, "pressure" + in(dimension::stress), pressures, names,
                       fmt::format("largest contact pressure {}; {}.", pretty(c.max_pressure), changes))};
    JsonObject out;
    all.push_back(out.text("name", c.name)
                      .text("x", "arc length" + in(dimension::length))
                      .add("curves", json_list(curves))
                      .done());
  }
  return json_list(all);
}

std::string validation(const ValidationResult& v) {
  std::vector<std::string> points;
  std::string alt = "Difference of J and what the prediction leaves of it, against the radius.";
  for (const Validation& p : v.points) {
    if (p.rows.size() < 2 || points.size() == 8) continue;
    std::vector<double> radius, remainder, difference;
    for (const ValidationRow& row : p.rows) {
      radius.push_back(row.radius);
      remainder.push_back(row.remainder);
      difference.push_back(row.difference);
    }
    JsonObject point;
    point.text("name", place(p.at)).add("radius", json_numbers(radius)).add("remainder", json_numbers(remainder));
    points.push_back(point.add("difference", json_numbers(difference)).done());
    alt += fmt::format(" At {}: {}{}.", place(p.at), word(p.verdict),
                       std::isfinite(p.order) ? fmt::format(", observed order {:.2f}", p.order) : std::string());
  }
  JsonObject out;
  out.text("x", "radius ε").text("y", "|remainder|, |difference|").text("alt", alt);
  return out.add("points", json_list(points)).done();
}

struct HistoryPart {
  const char* id;
  std::string label;
  std::vector<std::vector<double>> values;
  std::vector<std::string> names;
  std::vector<double> dashed = {};
  bool linear = false;  // never a logarithm
};

/// `of`: what counts along the axis.
std::string history_part(const HistoryPart& part, const char* of, const std::vector<double>& places) {
  std::vector<std::string> values;
  std::vector<double> all;
  for (const auto& column : part.values) {
    values.push_back(json_numbers(column));
    all.insert(all.end(), column.begin(), column.end());
  }
  const auto ends = [&](const std::vector<double>& v) {
    return fmt::format("{} at the start, {} at the end", pretty(v.front()), pretty(v.back()));
  };
  JsonObject out;
  out.text("id", part.id).text("label", part.label).add("log", !part.linear && wants_logarithm(all) ? "true" : "false");
  out.text("x", of)
      .add("places", json_numbers(places))
      .add("values", json_list(values))
      .add("names", json_texts(part.names));
  out.add("dashed", json_numbers(part.dashed));
  return out.text("alt", fmt::format("{}: {}.", part.label, ends(part.values.front()))).done();
}

/// A step that was refused leaves the values.
std::vector<std::string> history(const Result& r) {
  const auto& rows = r.optimize->history;
  std::vector<double> iteration;
  for (const Iteration& row : rows) iteration.push_back(row.number);
  const auto column = [&](const auto& value) {
    std::vector<double> out;
    for (const Iteration& row : rows) out.push_back(row.accepted || out.empty() ? value(row) : out.back());
    return out;
  };
  const OptimizeNames& names = r.optimize_names;
  std::vector<HistoryPart> parts;
  parts.push_back(
      {"objective", "objective J", {column([](const Iteration& row) { return row.objective; })}, {"objective J"}});
  HistoryPart volume{"volume",
                     "volume fraction",
                     {column([](const Iteration& row) { return row.volume_fraction; })},
                     {"volume fraction"}};
  if (names.volume_at_most) {
    volume.values.emplace_back(rows.size(), *names.volume_at_most);
    volume.names.emplace_back("at most");
    volume.dashed = {1};
  }
  parts.push_back(std::move(volume));
  if (!names.bounds.empty()) {
    HistoryPart bounds{
        "bounds", names.bounds.size() == 1 ? names.bounds[0] : std::string("bounded, over its bound"), {}, {}};
    for (std::size_t i = 0; i < names.bounds.size(); ++i) {
      const double scale = names.bounds.size() == 1 ? 1 : names.at_most[i];
      bounds.values.push_back(
          column([&](const Iteration& row) { return i < row.bounds.size() ? row.bounds[i] / scale : nan; }));
      bounds.names.push_back(names.bounds[i]);
    }
    bounds.values.emplace_back(rows.size(), names.bounds.size() == 1 ? names.at_most[0] : 1.0);
    bounds.names.emplace_back("at most");
    bounds.dashed = {static_cast<double>(names.bounds.size())};
    parts.push_back(std::move(bounds));
  }
  std::vector<std::string> out;
  for (const HistoryPart& part : parts) out.push_back(history_part(part, "iteration", iteration));
  return out;
}

std::vector<std::string> steps(const Result& r) {
  const auto in = [&](const Dimension& of) { return r.units.given() ? " in " + unit(r.units, of) : std::string(); };
  const auto column = [&](double StepResult::*value) {
    std::vector<double> out;
    for (const StepResult& s : r.steps) out.push_back(s.*value);
    return out;
  };
  const std::vector<HistoryPart> energies_and_lengths{
      {"step-energy",
       "energy" + in(dimension::energy),
       {column(&StepResult::strain_energy), column(&StepResult::work), column(&StepResult::dissipation)},
       {"strain energy", "work of loads and supports", "taken by friction"},
       {},
       true},
      {"step-length",
       "length" + in(dimension::length),
       {column(&StepResult::open_length), column(&StepResult::stick_length), column(&StepResult::slip_length)},
       {"open", "sticks", "slides"},
       {},
       true}};
  std::vector<std::string> out;
  const std::vector<double> places = places_in_history(r.steps);
  for (const HistoryPart& part : energies_and_lengths) out.push_back(history_part(part, "step", places));
  for (const auto& [id, name, K] : {std::tuple{"step-K_I", "K_I", &StepResult::Tip::K_I},
                                    std::tuple{"step-K_II", "K_II", &StepResult::Tip::K_II}}) {
    HistoryPart part{id, name + in(dimension::stress_intensity), {}, {}, {}, true};
    for (std::size_t k = 0; k < r.steps.front().tips.size(); ++k) {
      const StepResult::Tip& tip = r.steps.front().tips[k];
      part.names.push_back(fmt::format("{} of {} at {}", name, tip.crack, place(tip.at)));
      std::vector<double>& values = part.values.emplace_back();
      for (const StepResult& s : r.steps) values.push_back(k < s.tips.size() ? (s.tips[k].*K).value_or(nan) : nan);
    }
    if (!part.values.empty()) out.push_back(history_part(part, "step", places));
  }
  return out;
}

/// Of every tip that grew, over cycles or steps.
std::vector<std::string> growth_curves(const Result& r) {
  const GrowthResult& g = *r.growth;
  const auto in = [&](const Dimension& of) { return r.units.given() ? " in " + unit(r.units, of) : std::string(); };
  const bool fatigue = g.law != "quasi-static";
  HistoryPart lengths{"growth-length", "length" + in(dimension::length), {}, {}, {}, true},
      intensities{"growth-K", (fatigue ? "dK" : "K") + in(dimension::stress_intensity), {}, {}, {}, true};
  std::vector<double> places;
  for (const growth::GrowthStep& s : g.steps) places.push_back(fatigue ? s.cycles : s.number);
  for (const growth::GrownTip& first : g.steps.front().tips) {
    lengths.names.push_back(first.name);
    intensities.names.push_back(first.name);
    std::vector<double>&a = lengths.values.emplace_back(), &K = intensities.values.emplace_back();
    for (const growth::GrowthStep& s : g.steps) {
      const auto tip = std::ranges::find(s.tips, first.name, &growth::GrownTip::name);
      a.push_back(tip == s.tips.end() ? nan : tip->a);
      K.push_back(tip == s.tips.end() ? nan : tip->dK);
    }
  }
  if (lengths.values.empty()) return {};
  const char* of = fatigue ? "cycles" : "step";
  return {history_part(lengths, of, places), history_part(intensities, of, places)};
}

/// Bodies under a slider, each with the words that belong to it.
std::string under_slider(const std::string& slider, const NamedArray& shots,
                         const std::function<std::string(int number, double value, double volume)>& words) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i + 2 < shots.numbers.size(); i += 3) {
    JsonObject shot;
    all.push_back(
        shot.text("text", words(static_cast<int>(shots.numbers[i]), shots.numbers[i + 1], shots.numbers[i + 2]))
            .done());
  }
  JsonObject out;
  return out.text("slider", slider).add("shots", json_list(all)).done();
}

std::string design(const Result& r, const NamedArray& shots) {
  const std::string in = r.functional_dimension ? unit(r.units, *r.functional_dimension) : std::string();
  return under_slider("iteration", shots, [&](int number, double objective, double volume) {
    return fmt::format("iteration {}: objective {:.6g}{}, volume fraction {:.4g}", number, objective,
                       in.empty() ? in : " " + in, volume);
  });
}

std::string grown(const GrowthResult& g, const NamedArray& shots) {
  const bool fatigue = g.law != "quasi-static";
  return under_slider("step", shots, [&](int number, double value, double) {
    return fatigue ? fmt::format("step {}: {:.6g} cycles", number, value)
                   : fmt::format("step {}: load {:.6g}", number, value);
  });
}

}  // namespace

std::string data_elements(const Result& r, const PageData& data) {
  JsonObject head;
  JsonObject units;
  head.add("units", units.text("length", r.units.length).text("stress", r.units.stress).done());
  JsonObject tables;
  tables.text("linear", hex(Scale::Linear)).text("diverging", hex(Scale::Diverging));
  head.add("colors", tables.done()).add("fields", fields(r)).add("figures", figures(r, data)).add("mask", mask(r));
  head.add("cracks", cracks(r));
  if (r.validate) head.add("validation", validation(*r.validate));
  std::vector<std::string> curves;
  if (r.optimize && r.optimize->history.size() > 1) curves = history(r);
  if (r.steps.size() > 1) curves = steps(r);
  if (r.growth && r.growth->steps.size() > 1) std::ranges::copy(growth_curves(r), std::back_inserter(curves));
  if (!curves.empty()) head.add("history", json_list(curves));
  if (const NamedArray* shots = find_array(data.arrays, "design.shots"); shots && r.optimize)
    head.add("design", design(r, *shots));
  if (const NamedArray* shots = find_array(data.arrays, "growth.shots"); shots && r.growth)
    head.add("growth", grown(*r.growth, *shots));
  std::string out = "<script type=\"application/json\" id=\"kerf-data\">" + head.done() + "</script>\n";
  for (const NamedArray& a : data.arrays) out += array_element(a);
  for (std::size_t i = 0; i < r.cracks.size(); ++i) out += array_element(crack_array(r.cracks[i], i));
  return out;
}

}  // namespace kerf
