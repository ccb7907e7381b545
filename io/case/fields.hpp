#pragma once
// One value of a case file and how messages call it; every reader here throws Error(Usage) with the position.

#include "io/case/keys.hpp"
#include "io/case/reader.hpp"
#include "kerf/types.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kerf {

struct Value {
  const Node* node;
  std::string name;  // "young in [material]", "[material]"; empty: the whole document
  std::string path;  // in the table of keys: "material.young"
};

[[noreturn]] void fail(const Position& position, const std::string& what);

/// Refuses keys that the table of keys (keys.hpp) does not have here, naming the nearest one that it has, and those of
/// later releases. With a variant: those that do not go with it.
void allow_only(const Value& table, std::string_view variant = {});

/// Says that the key is unknown, and which one was probably meant.
[[noreturn]] void refuse_unknown(const Entry& entry, const Value& table, const std::vector<std::string>& known);

/// The value of a key of a table, if it is there; `need` refuses its absence.
std::optional<Value> find(const Value& table, const std::string& key);
Value need(const Value& table, const std::string& key);

/// A table of the document, or the entries of an array of tables (none if it is absent) of the document or of a table
/// of it.
std::optional<Value> find_table(const Value& document, const std::string& key);
std::vector<Value> find_tables(const Value& table, const std::string& key);

bool boolean(const Value& field);
double number(const Value& field);  // finite
double positive(const Value& field);
double in_range(const Value& field);   // that of its key
int whole_number(const Value& field);  // in the range of its key
int whole_number(const Value& field, const KeyRange& range);
std::string text(const Value& field);
std::string safe_name(const Value& field);
[[noreturn]] void refuse_taken(const Value& field, const std::string& name);
/// A safe name that none of the things has.
template <typename Named>
std::string new_name(const Value& field, const std::vector<Named>& things) {
  const std::string name = safe_name(field);
  for (const Named& thing : things)
    if (thing.name == name) refuse_taken(field, name);
  return name;
}
std::vector<Value> items(const Value& field, std::size_t least = 0);
std::vector<Value> pair(const Value& field);  // exactly two
Vec2 point(const Value& field);
std::vector<Vec2> points(const Value& field, std::size_t least);

/// One of the words of its key.
std::string choice(const Value& field);

/// Which of the words of its key, counted from 0.
std::size_t place_in_words(const Value& field);

/// The value of an enum whose words are those of the key, in the order of the values.
template <typename Enum>
Enum choose(const Value& field) {
  return static_cast<Enum>(place_in_words(field));
}

/// The value of a key goes to `out`, if the key is there.
void take(const Value& table, const std::string& key, double& out);
void take(const Value& table, const std::string& key, int& out);
void take(const Value& table, const std::string& key, unsigned& out);
void take(const Value& table, const std::string& key, bool& out);
template <typename Enum>
requires std::is_enum_v<Enum>
void take(const Value& table, const std::string& key, Enum& out) {
  if (const auto field = find(table, key)) out = choose<Enum>(*field);
}

/// The one that the table has of those keys that exclude each other.
std::string one_of(const Value& table);
std::string one_of(const Value& table, const std::vector<std::string>& keys);

}  // namespace kerf
