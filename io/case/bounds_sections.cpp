// [bounds]: points, labels, discs and lines whose quantities get guaranteed intervals; and mesh.adapt.of, the quantity
// that meshes are adapted for.

#include "io/case/formula.hpp"
#include "io/case/sections.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

namespace {

/// The crack of that name, which has faces.
Index open_crack(const Value& field, const Case& c) {
  std::vector<std::string> known;
  for (const Crack& crack : c.shape.cracks) known.push_back(crack.name);
  const auto found = std::ranges::find(known, text(field));
  if (found == known.end())
    fail(field.node->position, fmt::format("{}: there is no crack {}; {}", field.name, quote(text(field)),
                                           known.empty() ? "the body has none" : suggest(text(field), known)));
  return static_cast<Index>(found - known.begin());
}

/// Labels that have a support each.
std::vector<Index> supported_labels(const Value& field, const Case& c) {
  std::vector<Index> labels = find_labels(field, c.shape);
  for (const Index label : labels)
    if (std::ranges::none_of(c.scene.supports, [&](const Support& s) { return s.label == label; }))
      fail(field.node->position, fmt::format("{}: label {} has no displacement, and so no force of a support",
                                             field.name, quote(c.shape.labels[static_cast<std::size_t>(label)])));
  return labels;
}

}  // namespace

void read_bounds(const Value& document, Case& c) {
  const auto table = find_table(document, "bounds");
  if (!table) return;
  allow_only(*table);
  c.bounds.emplace();
  take(*table, "tips", c.bounds->tips);
  if (const auto at = find(*table, "points")) c.bounds->points = points(*at, 1);
  if (const auto on = find(*table, "displacements")) c.bounds->displacements = find_labels(*on, c.shape);
  if (const auto on = find(*table, "reactions")) c.bounds->reactions = supported_labels(*on, c);
  take(*table, "compliance", c.bounds->compliance);
  for (const Value& disc : find_tables(*table, "disc")) {
    allow_only(disc);
    c.bounds->discs.push_back({point(need(disc, "center")), in_range(need(disc, "radius"))});
  }
  for (const Value& line : find_tables(*table, "line")) {
    allow_only(line);
    const Value to = need(line, "to");
    c.bounds->lines.push_back({point(need(line, "from")), point(to)});
    if (c.bounds->lines.back().from == c.bounds->lines.back().to)
      fail(to.node->position, fmt::format("{} is where the line begins; it must have a length", to.name));
  }
}

std::optional<GoalRequest> read_goal(const Value& adapt, const Case& c) {
  const auto of = find(adapt, "of");
  for (const char* key : {"crack", "tip", "at"})
    if (const auto extra = find(adapt, key); extra && !of)
      fail(extra->node->position, fmt::format("{} goes with of, the quantity to bound", extra->name));
  if (!of) return std::nullopt;
  GoalRequest goal{.quantity = std::string(choice(*of))};
  const bool of_tip = goal.quantity == "K_I" || goal.quantity == "K_II" || goal.quantity == "G",
             of_point = !of_tip && goal.quantity != "energy";
  for (const auto& [key, fits] : {std::pair("crack", of_tip), std::pair("tip", of_tip), std::pair("at", of_point)})
    if (const auto extra = find(adapt, key); extra && !fits)
      fail(extra->node->position, fmt::format("{} does not go with of = {}", extra->name, quote(goal.quantity)));
  if (of_tip) {
    goal.crack = open_crack(need(adapt, "crack"), c);
    goal.at_start = choice(need(adapt, "tip")) == "start";
  }
  if (of_point) goal.at = point(need(adapt, "at"));
  return goal;
}

}  // namespace kerf
