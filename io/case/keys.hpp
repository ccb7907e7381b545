#pragma once
// The keys of a case file, one row each: what the reader allows, what `kerf keys` prints, what the pages of
// docs/case-files, the JSON Schema and the shell completion are made from. Units and refusals are in key_facts.cpp.

#include "kerf/types.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// What stands behind a key; `a | b` is either.
enum class KeyType : unsigned {
  Table = 1,            // [key] or { ... }
  Tables = 1 << 1,      // [[key]], or a list of { ... }; the path ends in []
  Boolean = 1 << 2,     //
  Whole = 1 << 3,       // a whole number
  Number = 1 << 4,      //
  Text = 1 << 5,        //
  Name = 1 << 6,        // letters, digits, _ . or -
  Word = 1 << 7,        // one of Key::words
  Names = 1 << 8,       // a list of strings
  Pair = 1 << 9,        // [number, number]
  PointList = 1 << 10,  // a list of pairs
  Numbers = 1 << 11,    // a list of numbers
  Formula = 1 << 12,    // a number, or an expression in a string
  Vector = 1 << 13,     // a pair of formulas
  Box = 1 << 14,        // a number, or [low, high]
  BoxPair = 1 << 15,    // a pair of boxes
  BoxPairs = 1 << 16,
  Formulas = 1 << 17,  // a table whose keys are names and whose values are formulas
  Tensor = 1 << 18,    // three or four formulas
};
constexpr KeyType operator|(KeyType a, KeyType b) {
  return static_cast<KeyType>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
constexpr bool has(KeyType all, KeyType one) {
  return (static_cast<unsigned>(all) & static_cast<unsigned>(one)) != 0;
}

/// Of numbers, and of the numbers in a pair or a list.
struct KeyRange {
  double least = -infinity, most = infinity;
  bool above = false, below = false;  // least, most themselves are excluded
  bool holds(double x) const {
    return (above ? x > least : x >= least) && (below ? x < most : x <= most);
  }
  bool limited() const {
    return least != KeyRange{}.least || most != KeyRange{}.most;
  }
};

using KeyWords = std::span<const std::string_view>;

/// What the reader checks.
struct KeyRules {
  KeyRange range = {};
  KeyWords words = {};         // of a Word
  std::string_view with = {};  // "p|q": goes with these keys of its table, or these words of its table's `kind` or
                               // `method`, or these shapes of what it starts, only; empty: with everything
  bool required = false;       // wherever it may stand
  bool one_of = false;         // its table needs exactly one of the keys that have this
  bool bare = false;           // a table that may have none of them
  std::string_view like = {};  // a table: has the keys of that one, too
};

struct Key {
  std::string_view path;  // "mesh.size", "hole[].circle.center"; of entries of a list "domain.outline[].arc_to"
  KeyType type;
  KeyRules rules;
  std::string_view text;  // what it is
  std::string_view example = {};
  std::string_view otherwise = {};  // the default: a value in TOML, or words
};

std::span<const Key> all_keys();

/// The last part of the path, without [].
std::string_view name(const Key& key);

/// The path of the table that it stands in: "" for the document.
std::string_view parent(std::string_view path);

/// The row of a path, for what lies in a table like another one the other's; of an entry of a list that of the list.
/// nullptr: none.
const Key* find_key(std::string_view path);

/// The keys of a table, or of the document (""). With a variant only those that go with it: a kind, a method, one of
/// the keys that exclude each other.
std::vector<const Key*> keys_in(std::string_view table, std::string_view variant = {});

/// "positive", "between 0 and 0.5"; empty: any.
std::string in_words(const KeyRange& range);

}  // namespace kerf
