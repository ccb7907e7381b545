// Benchmarks of the validation manual, read from their files (TOML): setup, source, second check, the case, its runs,
// and values, each with what is taken from the results, an expression of these, the published number, a tolerance and
// its reason. Unknown keys are refused with their place, and what must go together is checked: a published value has a
// tolerance with a reason, a benchmark a case or the reason why it is impossible. Expressions are those of case files,
// with the taken numbers as definitions.

#include "bench/verify/manual.hpp"

#include "bench/verify/texts.hpp"
#include "io/document.hpp"
#include "io/files.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

namespace {

[[noreturn]] void refuse(const Position& where, const std::string& what) {
  throw Error(Fault::Usage, fmt::format("{}: {}", to_string(where), what));
}

/// A table whose keys are all known; each reads its value or says what is wrong with it.
class Table {
 public:
  Table(const Node& node, const std::vector<std::string>& known) : node_(node) {
    if (node.kind != Node::Kind::Table) refuse(node.position, "a table is wanted");
    for (const Entry& e : node.entries)
      if (std::ranges::find(known, e.key) == known.end())
        refuse(e.position, fmt::format("unknown key {}; {}", quote(e.key), suggest(e.key, known)));
  }

  const Node* find(const std::string& key) const {
    const auto found = std::ranges::find(node_.entries, key, &Entry::key);
    return found == node_.entries.end() ? nullptr : &found->value;
  }
  std::string text(const std::string& key) const {
    const Node* value = find(key);
    if (!value) return {};
    if (value->kind != Node::Kind::String) refuse(value->position, key + " is a text");
    std::string out = value->text;
    while (!out.empty() && (out.back() == '\n' || out.back() == ' ')) out.pop_back();
    return out;
  }
  std::string needed_text(const std::string& key) const {
    std::string out = text(key);
    if (out.empty()) refuse(node_.position, key + " is missing");
    return out;
  }
  std::optional<double> number(const std::string& key) const {
    const Node* value = find(key);
    if (!value) return std::nullopt;
    if (value->kind != Node::Kind::Float && value->kind != Node::Kind::Integer)
      refuse(value->position, key + " is a number");
    return value->number;
  }
  bool flag(const std::string& key) const {
    const Node* value = find(key);
    if (value && value->kind != Node::Kind::Boolean) refuse(value->position, key + " is true or false");
    return value && value->boolean;
  }
  std::vector<std::string> texts(const std::string& key) const {
    std::vector<std::string> out;
    for (const Node& item : items(key)) {
      if (item.kind != Node::Kind::String) refuse(item.position, key + " is a list of texts");
      out.push_back(item.text);
    }
    return out;
  }
  std::vector<Node> items(const std::string& key) const {
    const Node* value = find(key);
    if (!value) return {};
    if (value->kind != Node::Kind::Array) refuse(value->position, key + " is a list");
    return value->items;
  }
  const Position& position() const {
    return node_.position;
  }

 private:
  const Node& node_;
};

/// The published number, or the expression that it is the value of.
void read_published(const Table& table, ManualValue& value) {
  const Node* published = table.find("published");
  if (published && published->kind == Node::Kind::String)
    value.formula = published->text, value.published = value_of(value.formula);
  else
    value.published = table.number("published");
}

void read_tolerance(const Table& table, ManualValue& value) {
  const auto relative = table.number("tolerance"), absolute = table.number("absolute");
  if (relative && absolute) refuse(table.position(), "tolerance and absolute exclude each other");
  if (value.published.has_value() != (relative || absolute))
    refuse(table.position(), "published goes with a tolerance or absolute");
  value.absolute = absolute.has_value();
  value.tolerance = relative ? *relative : absolute.value_or(0);
  value.reason = value.published ? table.needed_text("reason") : table.text("reason");
  const std::string relation = table.text("relation");
  if (relation == "at least")
    value.relation = ManualValue::Relation::AtLeast;
  else if (relation == "at most")
    value.relation = ManualValue::Relation::AtMost;
  else if (!relation.empty())
    refuse(table.position(), "relation is at least or at most");
}

std::size_t run_named(const std::string& name, const ManualEntry& entry, const Position& position) {
  const auto found = std::ranges::find(entry.runs, name, &ManualRun::name);
  if (found == entry.runs.end()) refuse(position, "there is no run " + quote(name));
  return static_cast<std::size_t>(found - entry.runs.begin());
}

/// "/state/energy", or that of another run, "@coarse /state/energy".
ManualValue::Take read_take(const Entry& take, std::size_t run, const ManualEntry& entry) {
  if (take.value.kind != Node::Kind::String) refuse(take.position, "a take is a text");
  const std::string& text = take.value.text;
  if (!text.starts_with("@")) return {take.key, text, run};
  const std::size_t end = text.rfind(' ');
  if (end == std::string::npos) refuse(take.position, "@name of a run, a blank, and a place are wanted");
  return {take.key, text.substr(end + 1), run_named(text.substr(1, end - 1), entry, take.position)};
}

ManualValue read_value(const Node& node, const ManualEntry& entry) {
  const Table table(node,
                    {"name", "run", "take", "quantity", "published", "tolerance", "absolute", "relation", "reason"});
  ManualValue value;
  value.name = table.needed_text("name");
  read_published(table, value);
  if (!entry.impossible.empty()) {  // nothing to measure
    return value;
  }
  read_tolerance(table, value);
  if (table.find("run")) value.run = run_named(table.text("run"), entry, table.position());
  if (const Node* take = table.find("take"))
    for (const Entry& e : take->entries) value.takes.push_back(read_take(e, value.run, entry));
  value.quantity = table.needed_text("quantity");
  return value;
}

ManualReference read_reference(const Node& node) {
  const Table table(node, {"name", "title", "points"});
  ManualReference r{table.needed_text("name"), table.needed_text("title"), {}};
  if (r.name.find_first_of(" :") != std::string::npos) refuse(table.position(), "name has neither blanks nor colons");
  const auto is_number = [](const Node& n) { return n.kind == Node::Kind::Float || n.kind == Node::Kind::Integer; };
  for (const Node& point : table.items("points")) {
    if (point.kind != Node::Kind::Array || point.items.size() != 2 || !std::ranges::all_of(point.items, is_number))
      refuse(point.position, "points is a list of pairs");
    r.points.emplace_back(point.items[0].number, point.items[1].number);
  }
  if (r.points.empty()) refuse(table.position(), "points is missing");
  return r;
}

}  // namespace

std::vector<std::string> manual_ids() {
  std::vector<std::string> ids;
  for (const ScenarioText& text : manual_texts()) ids.push_back(text.name);
  return ids;
}

double value_of(const std::string& expression, const std::vector<std::pair<std::string, double>>& numbers) {
  ExpressionContext context{.definitions = {}, .on_boundary = false};
  for (const auto& [name, value] : numbers) context.definitions.push_back({name, fmt::format("{:.17g}", value)});
  return parse_expression(expression, context)(Vec2::Zero(), Vec2::Zero());
}

ManualEntry read_manual(const std::string& id, const std::filesystem::path& folder) {
  const auto found = std::ranges::find(manual_texts(), id, &ScenarioText::name);
  if (found == manual_texts().end()) throw Error(Fault::Usage, "the manual has no benchmark " + quote(id));
  const std::filesystem::path path = folder / (id + ".toml");
  write_file(path, found->text);
  return read_manual_file(path);
}

ManualEntry read_manual_file(const std::filesystem::path& path) {
  const Node document = read_document(path);
  const Table table(document, {"title", "group", "setup", "source", "check", "impossible", "picture", "case", "quick",
                               "run", "again", "value", "reference"});
  ManualEntry entry{.id = path.stem().string(),
                    .title = table.needed_text("title"),
                    .group = table.needed_text("group"),
                    .setup = table.needed_text("setup"),
                    .source = table.needed_text("source"),
                    .check = table.needed_text("check"),
                    .impossible = table.text("impossible"),
                    .picture = table.text("picture"),
                    .case_text = table.text("case"),
                    .quick = table.flag("quick"),
                    .runs = {},
                    .again = table.texts("again"),
                    .values = {},
                    .references = {}};
  if (entry.case_text.empty() == entry.impossible.empty())
    refuse(table.position(), "a benchmark has either a case, or the reason why it is impossible");
  if (entry.picture.empty()) entry.picture = "von_mises.png";
  for (const Node& node : table.items("run")) {
    const Table run(node, {"name", "set"});
    entry.runs.push_back({run.needed_text("name"), run.texts("set")});
  }
  if (entry.runs.empty()) entry.runs.emplace_back();
  for (const Node& node : table.items("reference")) entry.references.push_back(read_reference(node));
  for (const Node& node : table.items("value")) entry.values.push_back(read_value(node, entry));
  if (entry.values.empty()) refuse(table.position(), "a benchmark needs at least one value");
  return entry;
}

}  // namespace kerf
