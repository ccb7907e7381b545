#pragma once
// One value of a case file and how messages call it; every reader here throws Error(Usage) with the position.

#include "cases/reader.hpp"
#include "geometry/types.hpp"

#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kerf {

struct Field {
  const Node* node;
  std::string name;  // "young in [material]", "[material]"; empty: the whole document
};

[[noreturn]] void fail(const Position& position, const std::string& what);

/// A key that a later release reads, and what to do in this one.
struct Later {
  std::string key, instead;
};
/// Refuses unknown keys (naming the nearest known one) and those of later releases.
void allow_only(const Field& table, const std::vector<std::string>& known, const std::vector<Later>& later = {});

/// The value of a key of a table, if it is there; `need` refuses its absence.
std::optional<Field> find(const Field& table, const std::string& key);
Field need(const Field& table, const std::string& key);

/// A table of the document, or the entries of an array of tables (none if it is absent) of the document or of a table
/// of it.
std::optional<Field> find_table(const Field& document, const std::string& key);
std::vector<Field> find_tables(const Field& table, const std::string& key);

bool boolean(const Field& field);
double number(const Field& field);  // finite
double positive(const Field& field);
double between(const Field& field, double low, double high);
int whole_number(const Field& field, int low, int high);
std::string text(const Field& field);
std::string safe_name(const Field& field);
std::vector<Field> items(const Field& field, std::size_t least = 0);
std::vector<Field> pair(const Field& field);  // exactly two
Vec2 point(const Field& field);
std::vector<Vec2> points(const Field& field, std::size_t least);

/// One of a few words; `later` are those of later releases.
std::string choice(const Field& field, const std::vector<std::string>& known,
                   const std::vector<std::string>& later = {});

/// The single key of `keys` that the table has.
std::string one_of(const Field& table, const std::vector<std::string>& keys);

}  // namespace kerf
