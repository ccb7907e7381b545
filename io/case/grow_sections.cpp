// [grow]: the law of growth, the tips that grow, the loads of a cycle, and where growth ends.

#include "growth/rates.hpp"
#include "io/case/expression.hpp"
#include "io/case/sections.hpp"
#include "io/case/table.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

growth::GrowthLaw fatigue_law(const Value& law, const std::string& kind) {
  growth::GrowthLaw of;
  const double C = in_range(need(law, "C")), m = in_range(need(law, "m"));
  if (kind == "paris") of.form = growth::Paris{C, m};
  if (kind == "forman") of.form = growth::Forman{C, m};
  if (kind == "walker") {
    growth::Walker walker{C, m};
    take(law, "gamma", walker.gamma);
    of.form = walker;
  }
  if (kind == "nasgro") {
    growth::Nasgro nasgro{.C = C, .m = m};
    take(law, "p", nasgro.p);
    take(law, "q", nasgro.q);
    take(law, "alpha", nasgro.alpha);
    take(law, "flow_ratio", nasgro.flow_ratio);
    take(law, "dK_0", nasgro.dK_0);
    take(law, "a_0", nasgro.a_0);
    take(law, "C_plus", nasgro.C_plus);
    take(law, "C_minus", nasgro.C_minus);
    of.form = nasgro;
  }
  take(law, "threshold", of.threshold);
  take(law, "K_c", of.K_c);
  try {
    growth::check(of);
  } catch (const Error& e) {
    fail(law.node->position, fmt::format("{}: {}", law.name, e.what()));
  }
  return of;
}

/// phi is the angle of the point at which the formula is evaluated.
std::function<double(double)> of_direction(const Value& field) {
  try {
    Expression value = parse_expression(text(field), {.definitions = {{"phi", "atan2(y, x)"}}, .on_boundary = false});
    return [value = std::move(value)](double phi) { return value(Vec2(std::cos(phi), std::sin(phi)), Vec2::Zero()); };
  } catch (const Error& e) {
    fail(field.node->position, fmt::format("{}: {}", field.name, e.what()));
  }
}

growth::RegionLaw read_region(const Value& table, const Case& c) {
  allow_only(table);
  const Value name = need(table, "name"), law = need(table, "law");
  std::vector<std::string> known;
  for (const Loop& region : c.shape.regions) known.push_back(region.name);
  const auto region = std::ranges::find(known, text(name));
  if (region == known.end())
    fail(name.node->position, fmt::format("{}: there is no [[region]] {}; {}", name.name, quote(text(name)),
                                          known.empty() ? "the body has none" : suggest(text(name), known)));
  growth::RegionLaw own{.region = static_cast<Index>(region - known.begin())};
  const std::string kind = choice(need(law, "kind"));
  allow_only(law, kind);
  const bool of_fatigue = kind != "quasi-static";
  if (of_fatigue != c.grow->law.has_value())
    fail(law.node->position, law.name + ": either all laws are \"quasi-static\", or none is");
  if (of_fatigue)
    own.law = fatigue_law(law, kind);
  else
    own.toughness = in_range(need(law, "K_c"));
  return own;
}

growth::CrackEnd read_end(const Value& item, const Case& c) {
  const std::string word = text(item);
  const std::size_t colon = word.rfind(':');
  const std::string name = word.substr(0, colon), end = colon == std::string::npos ? "" : word.substr(colon + 1);
  std::vector<std::string> known;
  for (const Crack& crack : c.shape.cracks) known.push_back(crack.name);
  const auto crack = std::ranges::find(known, name);
  if (crack == known.end())
    fail(item.node->position, fmt::format("{}: there is no crack {}; {}", item.name, quote(name),
                                          known.empty() ? "the body has none" : suggest(name, known)));
  if (end != "start" && end != "end")
    fail(item.node->position, fmt::format("{}: {} is no end of a crack; write \"{}:start\" or \"{}:end\"", item.name,
                                          quote(word), name, name));
  return {static_cast<Index>(crack - known.begin()), end == "start"};
}

/// The factors of the loads in a table, and the largest and the least of them.
void read_spectrum(const Value& file, const std::filesystem::path& folder, growth::GrowRequest& to) {
  for (const std::vector<double>& row : read_table(folder / text(file), file, {"load"})) to.spectrum.push_back(row[0]);
  const auto [least, most] = std::ranges::minmax(to.spectrum);
  if (!(most > 0 && least < most))
    fail(file.node->position, file.name + ": the loads must change, and the largest one must be positive");
  to.max = most;
  to.min = least;
}

}  // namespace

void read_growth_law(const Value& law, growth::GrowRequest& to) {
  const std::string kind = choice(need(law, "kind"));
  allow_only(law, kind);
  if (kind == "quasi-static")
    to.toughness = in_range(need(law, "K_c"));
  else
    to.law = fatigue_law(law, kind);
}

void read_grow(const Value& document, const std::filesystem::path& folder, Case& c) {
  const auto table = find_table(document, "grow");
  if (!table) return;
  allow_only(*table);
  if (!c.half_tips.empty())
    fail(table->node->position,
         fmt::format(
             "[grow]: the crack that ends at ({:.6g}, {:.6g}) lies in a plane of symmetry, and such cracks do not "
             "grow: their tip is the point where two sides meet; draw the whole body with a [[crack]]",
             c.half_tips[0].x(), c.half_tips[0].y()));
  growth::GrowRequest& to = c.grow.emplace();
  const Value law = need(*table, "law");
  read_growth_law(law, to);
  if (to.toughness) {
    take(law, "K_IIc", to.toughness_shear);
    if (const auto formula = find(law, "anisotropy")) to.anisotropy = of_direction(*formula);
  }
  for (const Value& region : find_tables(*table, "region")) {
    to.regions.push_back(read_region(region, c));
    if (std::ranges::count(to.regions, to.regions.back().region, &growth::RegionLaw::region) > 1)
      fail(region.node->position, region.name + ": this region has a law already");
  }
  take(*table, "criterion", to.criterion);
  if (const auto tips = find(*table, "tips"))
    for (const Value& item : items(*tips, 1)) to.tips.push_back(read_end(item, c));
  if (const auto cycle = find(*table, "cycle")) {
    allow_only(*cycle);
    if (to.toughness)
      fail(cycle->node->position, cycle->name + " goes with a law of fatigue, not with \"quasi-static\"");
    const auto file = find(*cycle, "file");
    if (file && (find(*cycle, "max") || find(*cycle, "min")))
      fail(file->node->position, file->name + " has all loads; leave out max and min");
    if (file) read_spectrum(*file, folder, to);
    take(*cycle, "max", to.max);
    take(*cycle, "min", to.min);
    if (!(to.min < to.max)) fail(cycle->node->position, cycle->name + ": min must be below max");
  }
  take(*table, "step", to.step);
  take(*table, "tolerance", to.tolerance);
  take(*table, "bounds", to.bounds);
  take(*table, "stress", to.stress);
  if (const auto until = find(*table, "until")) {
    allow_only(*until);
    take(*until, "length", to.length);
    take(*until, "K", to.K);
    take(*until, "steps", to.steps);
    if (const auto cycles = find(*until, "cycles")) {
      if (to.toughness) fail(cycles->node->position, cycles->name + " goes with a law of fatigue");
      to.cycles = in_range(*cycles);
    }
  }
}

}  // namespace kerf
