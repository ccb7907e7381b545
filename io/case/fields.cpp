// One value of a case file as a number, a word, a list, a point, ... A Value carries the node of the document, the name
// that messages call it by ("young in [material]", "entry 2 of outline") and its path in the table of keys, which gives
// its range and its words; find() and items() hand all three down. Refusals have the form
//   file:line:column: NAME must be WHAT IS ALLOWED, not WHAT IS THERE
// with the nearest known word where a word is unknown. Nothing is converted silently: a number that is not finite, not
// whole or out of its range is an error.

#include "io/case/fields.hpp"

#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

std::string describe(const Node& node) {
  switch (node.kind) {
    case Node::Kind::Boolean:
      return node.boolean ? "true" : "false";
    case Node::Kind::Integer:
    case Node::Kind::Float:
      return fmt::format("{}", node.number);
    case Node::Kind::String:
      return quote(node.text);
    case Node::Kind::Date:
      return "a date";
    case Node::Kind::Function:
      return "a function";
    case Node::Kind::Array:
      return fmt::format("a list of {}", node.items.size());
    case Node::Kind::Table:
      return "a table";
  }
  return "";
}

[[noreturn]] void refuse(const Value& field, const std::string& expected) {
  fail(field.node->position, fmt::format("{} must be {}, not {}", field.name, expected, describe(*field.node)));
}

std::string child_name(const Value& table, const std::string& key) {
  if (table.name.empty()) return key;
  return fmt::format("{} in {}", key, table.name);
}

std::string place_in(const Value& table) {
  return table.name.empty() ? "" : " in " + table.name;
}

std::string child_path(const Value& table, const std::string& key) {
  return table.path.empty() ? key : table.path + "." + key;
}

/// "optimize" of "[optimize]" and "[[optimize]]".
std::string bare(const std::string& header) {
  const std::size_t from = header.find_first_not_of('['), to = header.find_last_not_of(']');
  return from == std::string::npos ? "" : header.substr(from, to + 1 - from);
}

void check_table(const Value& field) {
  if (field.node->kind != Node::Kind::Table) refuse(field, "a table");
}

}  // namespace

void fail(const Position& position, const std::string& what) {
  throw Error(Fault::Usage, to_string(position) + ": " + what);
}

void allow_only(const Value& table, std::string_view variant) {
  check_table(table);
  std::vector<std::string> known;
  for (const Key* key : keys_in(table.path, variant)) known.emplace_back(kerf::name(*key));
  for (const Entry& entry : table.node->entries)
    if (!contains(known, entry.key)) refuse_unknown(entry, table, known);
}

void refuse_unknown(const Entry& entry, const Value& table, const std::vector<std::string>& known) {
  fail(entry.position,
       fmt::format("unknown key {}{}; {}", quote(entry.key), place_in(table), suggest(entry.key, known)));
}

std::optional<Value> find(const Value& table, const std::string& key) {
  check_table(table);
  for (const Entry& entry : table.node->entries)
    if (entry.key == key) return Value{&entry.value, child_name(table, key), child_path(table, key)};
  return std::nullopt;
}

Value need(const Value& table, const std::string& key) {
  if (auto field = find(table, key)) return *field;
  if (table.name.empty()) fail(table.node->position, fmt::format("missing table [{}]; add it", key));
  fail(table.node->position, fmt::format("missing key {} in {}; add it", quote(key), table.name));
}

std::optional<Value> find_table(const Value& document, const std::string& key) {
  auto field = find(document, key);
  if (!field) return field;
  field->name = fmt::format("[{}]", key);
  if (field->node->kind == Node::Kind::Array)
    fail(field->node->position, fmt::format("there is only one {0}; write {0} instead of [[{1}]]", field->name, key));
  check_table(*field);
  return field;
}

std::vector<Value> find_tables(const Value& table, const std::string& key) {
  const auto field = find(table, key);
  if (!field) return {};
  const std::string parent = bare(table.name);
  const std::string name = fmt::format("[[{}{}{}]]", parent, parent.empty() ? "" : ".", key);
  if (field->node->kind != Node::Kind::Array)
    fail(field->node->position, fmt::format("{} may appear several times; write {}", quote(key), name));
  std::vector<Value> tables;
  for (const Node& item : field->node->items) {
    tables.push_back({&item, name, field->path + "[]"});
    check_table(tables.back());
  }
  return tables;
}

bool boolean(const Value& field) {
  if (field.node->kind != Node::Kind::Boolean) refuse(field, "true or false");
  return field.node->boolean;
}

double number(const Value& field) {
  if (field.node->kind != Node::Kind::Integer && field.node->kind != Node::Kind::Float) refuse(field, "a number");
  if (!std::isfinite(field.node->number)) refuse(field, "a finite number");
  return field.node->number;
}

double positive(const Value& field) {
  if (!(number(field) > 0)) refuse(field, "positive");
  return field.node->number;
}

namespace {

KeyRange range_of(const Value& field) {
  const Key* key = find_key(field.path);
  return key ? key->rules.range : KeyRange{};
}

double within(const Value& field, const KeyRange& range) {
  const double value = number(field);
  if (!range.holds(value)) refuse(field, in_words(range));
  return value;
}

}  // namespace

double in_range(const Value& field) {
  return within(field, range_of(field));
}

int whole_number(const Value& field) {
  return whole_number(field, range_of(field));
}

int whole_number(const Value& field, const KeyRange& range) {
  const double value = within(field, range);
  if (value != std::floor(value)) refuse(field, "a whole number");
  return static_cast<int>(value);
}

std::string text(const Value& field) {
  if (field.node->kind != Node::Kind::String) refuse(field, "a string");
  return field.node->text;
}

std::string safe_name(const Value& field) {
  const std::string name = text(field);
  if (!is_safe_name(name)) refuse(field, "a name of letters, digits, _ . or - (1 to 100)");
  return name;
}

void refuse_taken(const Value& field, const std::string& name) {
  fail(field.node->position, fmt::format("{}: the name {} is taken; give each its own", field.name, quote(name)));
}

std::vector<Value> items(const Value& field, std::size_t least) {
  if (field.node->kind != Node::Kind::Array) refuse(field, "a list");
  if (field.node->items.size() < least) refuse(field, fmt::format("a list of at least {}", least));
  std::vector<Value> out;
  out.reserve(field.node->items.size());
  for (std::size_t k = 0; k < field.node->items.size(); ++k)
    out.push_back({&field.node->items[k], fmt::format("entry {} of {}", k + 1, field.name), field.path + "[]"});
  return out;
}

std::vector<Value> pair(const Value& field) {
  if (field.node->kind != Node::Kind::Array || field.node->items.size() != 2) refuse(field, "a pair [x, y]");
  return items(field);
}

Vec2 point(const Value& field) {
  const std::vector<Value> xy = pair(field);
  return {number(xy[0]), number(xy[1])};
}

std::vector<Vec2> points(const Value& field, std::size_t least) {
  std::vector<Vec2> out;
  for (const Value& item : items(field, least)) out.push_back(point(item));
  return out;
}

std::string choice(const Value& field) {
  const KeyWords words = find_key(field.path)->rules.words;
  const std::vector<std::string> known(words.begin(), words.end());
  const std::string word = text(field);
  if (contains(known, word)) return word;
  fail(field.node->position, fmt::format("unknown {} {}; {}", field.name, quote(word), suggest(word, known)));
}

std::size_t place_in_words(const Value& field) {
  const KeyWords words = find_key(field.path)->rules.words;
  return static_cast<std::size_t>(std::find(words.begin(), words.end(), choice(field)) - words.begin());
}

void take(const Value& table, const std::string& key, double& out) {
  if (const auto field = find(table, key)) out = in_range(*field);
}

void take(const Value& table, const std::string& key, int& out) {
  if (const auto field = find(table, key)) out = whole_number(*field);
}

void take(const Value& table, const std::string& key, unsigned& out) {
  if (const auto field = find(table, key)) out = static_cast<unsigned>(whole_number(*field));
}

void take(const Value& table, const std::string& key, bool& out) {
  if (const auto field = find(table, key)) out = boolean(*field);
}

std::string one_of(const Value& table) {
  std::vector<std::string> keys;
  for (const Key* key : keys_in(table.path))
    if (key->rules.one_of) keys.emplace_back(kerf::name(*key));
  return one_of(table, keys);
}

std::string one_of(const Value& table, const std::vector<std::string>& keys) {
  std::string found;
  for (const std::string& key : keys) {
    const auto field = find(table, key);
    if (!field) continue;
    if (!found.empty())
      fail(field->node->position, fmt::format("{} has both {} and {}; keep one", table.name, found, key));
    found = key;
  }
  if (found.empty()) fail(table.node->position, fmt::format("{} needs one of {}", table.name, fmt::join(keys, ", ")));
  return found;
}

}  // namespace kerf
