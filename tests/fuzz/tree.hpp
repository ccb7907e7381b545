#pragma once
// A case file as a tree that may hold what TOML forbids: keys twice, numbers that are none.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerf::fuzz {

struct Value {
  enum class Kind { Token, Text, Array, Table };  // Token: a number, a boolean, a date, or anything else without quotes
  Kind kind = Kind::Token;
  std::string text;                                  // of a token or a text
  std::vector<std::pair<std::string, Value>> items;  // of an array (without keys) or a table, in the order of the file
};

Value token(std::string text);
Value text(std::string text);
/// [x, y]
Value pair(const std::string& x, const std::string& y);

/// The first member of that name; nullptr: none, or no table.
Value* member(Value& table, std::string_view key);
/// The member of that name, made where it is missing.
Value& member_or_new(Value& table, const std::string& key);

bool is_table_list(const Value& value);

/// The document of a file. Throws std::runtime_error where it is no TOML.
Value read_toml(std::string_view text);
/// As TOML; tables and lists of tables of the document under headings, all that is deeper in one line.
std::string write_toml(const Value& document);

/// A node with its path as the table of keys writes it ("hole[].circle.radius").
struct Place {
  Value* parent = nullptr;
  std::size_t index = 0;
  std::string path;
  Value& value() const {
    return parent->items[index].second;
  }
};
/// All nodes below the document, parents first.
std::vector<Place> places(Value& document);

}  // namespace kerf::fuzz
