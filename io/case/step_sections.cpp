// [[step]]: a history of loads. A step changes numbers of [define], on the straight line from the values before it over
// its substeps, and eigenstrains and conditions are read once more for each substep.

#include "io/case/fields.hpp"
#include "io/case/sections.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace kerf {

namespace {

/// The places of the names that a step changes among the definitions, and what it changes them to.
std::vector<std::pair<std::size_t, double>> changes_of(const Value& step, const Definitions& definitions) {
  const Value table = need(step, "define");
  std::vector<std::string> known;
  for (const Definition& d : definitions.context.definitions) known.push_back(d.name);
  std::vector<std::pair<std::size_t, double>> changes;
  for (const Entry& entry : table.node->entries) {
    const auto found = std::ranges::find(known, entry.key);
    if (found == known.end())
      fail(entry.position,
           fmt::format("{}: [define] has no name {}; {}", table.name, quote(entry.key), suggest(entry.key, known)));
    changes.emplace_back(found - known.begin(), number(*find(table, entry.key)));
  }
  if (changes.empty())
    fail(table.node->position, fmt::format("{} changes nothing; give names of [define] new values, such as "
                                           "{{ shear = 0.3 }}",
                                           table.name));
  return changes;
}

/// The value of a definition that a step changes; an expression has none.
double value_before(const Value& document, const Definition& d, const Value& step) {
  const Value field = *find(*find_table(document, "define"), d.name);
  if (field.node->kind != Node::Kind::Integer && field.node->kind != Node::Kind::Float)
    fail(step.node->position,
         fmt::format("{}: {} in [define] is an expression; steps change numbers alone", step.name, quote(d.name)));
  return number(field);
}

}  // namespace

void read_steps(const Value& document, const std::vector<std::optional<Value>>& regions, Definitions& definitions,
                Case& c) {
  const std::vector<Value> tables = find_tables(document, "step");
  std::map<std::size_t, double> now;
  std::vector<Definition>& names = definitions.context.definitions;
  for (const Value& table : tables)
    for (const auto& [k, value] : changes_of(table, definitions))
      now.emplace(k, value_before(document, names[k], table));
  for (const Value& table : tables) {
    allow_only(table);
    LoadStep step;
    step.name = new_name(need(table, "name"), c.steps);
    if (const auto field = find(table, "substeps")) step.parts = whole_number(*field, {1, 1000});
    const std::map<std::size_t, double> before = now;
    for (const auto& [k, value] : changes_of(table, definitions)) now[k] = value;
    std::vector<LoadStep> parts;
    for (step.part = 1; step.part <= step.parts; ++step.part) {
      const double share = static_cast<double>(step.part) / step.parts;
      step.values.clear();
      for (const auto& [k, value] : now) {
        const double here = step.part == step.parts ? value : before.at(k) + share * (value - before.at(k));
        names[k].text = fmt::format("({})", here);
        step.values.emplace_back(names[k].name, here);
      }
      Case at = c;
      read_eigenstrains(document, regions, definitions, at);
      read_conditions(document, definitions, at);
      step.scene = std::move(at.scene);
      parts.push_back(step);
    }
    c.steps.insert(c.steps.end(), parts.begin(), parts.end());
  }
}

}  // namespace kerf
