#pragma once
// One value of a case file and how messages call it; every reader here throws Error(Usage) with the position.

#include "io/case/reader.hpp"
#include "kerf/types.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

struct Value {
  const Node* node;
  std::string name;  // "young in [material]", "[material]"; empty: the whole document
};

[[noreturn]] void fail(const Position& position, const std::string& what);

/// A key that a later release reads, and what to do in this one.
struct Later {
  std::string key, instead;
};
/// Refuses unknown keys (naming the nearest known one) and those of later releases.
void allow_only(const Value& table, const std::vector<std::string>& known, const std::vector<Later>& later = {});

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
double between(const Value& field, double low, double high);
int whole_number(const Value& field, int low, int high);
std::string text(const Value& field);
std::string safe_name(const Value& field);
std::vector<Value> items(const Value& field, std::size_t least = 0);
std::vector<Value> pair(const Value& field);  // exactly two
Vec2 point(const Value& field);
std::vector<Vec2> points(const Value& field, std::size_t least);

/// One of a few words; `later` are those of later releases.
std::string choice(const Value& field, const std::vector<std::string>& known,
                   const std::vector<std::string>& later = {});

/// The value of an enum whose words these are, in the order of its values.
template <typename Enum, std::size_t n>
Enum choose(const Value& field, const std::array<std::string_view, n>& words,
            const std::vector<std::string>& later = {}) {
  const std::string word = choice(field, {words.begin(), words.end()}, later);
  return static_cast<Enum>(std::find(words.begin(), words.end(), word) - words.begin());
}

/// The single key of `keys` that the table has.
std::string one_of(const Value& table, const std::vector<std::string>& keys);

}  // namespace kerf
