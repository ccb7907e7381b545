#pragma once
// A TOML document as plain data that remembers where everything stands. toml++ lives in reader.cpp and nowhere else.

#include "io/case/expression.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// A place in a file, or (line 0) the override that a value came from.
struct Position {
  std::shared_ptr<const std::string> source;
  std::uint32_t line = 0, column = 0;
};
std::string to_string(const Position& position);  // "file:line:column" or "--set key"

struct Entry;
struct Node {
  enum class Kind { Boolean, Integer, Float, String, Date, Function, Array, Table } kind = Kind::Table;
  bool boolean = false;
  double number = 0;         // of Integer too
  std::string text;          // of Function what it is called
  Expression function = {};  // in place of an expression, in documents that are no files
  PairExpression pair = {};  // of Function: in place of the two components of a vector
  std::vector<Node> items;
  std::vector<Entry> entries;  // in the order of the file
  Position position;
};
struct Entry {
  std::string key;
  Position position;
  Node value;
};

/// Throws Error(Files) when the file cannot be read, Error(Usage) when it is not TOML.
Node read_document(const std::filesystem::path& path);
/// The same of a text, which messages call `name`.
Node parse_document(std::string_view text, const std::string& name);

/// The whole of a regular file. Throws Error(Files), naming what is wrong with it.
std::string read_text(const std::filesystem::path& path);

/// "mesh.size=0.02", "crack[0].contact='open'", "crack.c.contact='open'" of the crack whose name is c: replaces a value
/// or adds a key. Throws Error(Usage) naming the override.
void override_value(Node& document, std::string_view assignment);

}  // namespace kerf
