// Case files as trees: read by toml++, in the order of the file, and written again, with whatever the tree holds.

#include "tests/fuzz/tree.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace kerf::fuzz {

namespace {

using Kind = Value::Kind;

Value from_node(const toml::node& node);

Value from_table(const toml::table& table) {
  std::vector<std::pair<toml::source_position, std::pair<std::string, Value>>> members;
  for (const auto& [key, node] : table)
    members.push_back({key.source().begin, {std::string(key.str()), from_node(node)}});
  std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) {
    return a.first.line != b.first.line ? a.first.line < b.first.line : a.first.column < b.first.column;
  });
  Value out{.kind = Kind::Table};
  for (auto& [at, named] : members) out.items.push_back(std::move(named));
  return out;
}

Value from_node(const toml::node& node) {
  if (const auto* t = node.as_table()) return from_table(*t);
  if (const auto* a = node.as_array()) {
    Value out{.kind = Kind::Array};
    for (const toml::node& item : *a) out.items.emplace_back("", from_node(item));
    return out;
  }
  if (const auto* s = node.as_string()) return text(s->get());
  if (const auto* d = node.as_floating_point()) {
    const double x = d->get();
    std::string digits = fmt::format("{}", x);
    if (digits.find_first_of(".en") == std::string::npos) digits += ".0";
    return token(digits);
  }
  if (const auto* i = node.as_integer()) return token(fmt::format("{}", i->get()));
  if (const auto* b = node.as_boolean()) return token(b->get() ? "true" : "false");
  std::ostringstream out;
  node.visit([&](const auto& n) {
    if constexpr (toml::is_value<decltype(n)>) out << n;
  });
  return token(out.str());
}

std::string quoted(const std::string& s) {
  std::string out = "\"";
  for (const char c : s) {
    if (c == '"' || c == '\\')
      out += '\\', out += c;
    else if (c == '\n')
      out += "\\n";
    else
      out += c;
  }
  return out + '"';
}

std::string key_words(const std::string& key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-';
  });
  return bare ? key : quoted(key);
}

std::string in_line(const Value& v) {
  switch (v.kind) {
    case Kind::Token:
      return v.text;
    case Kind::Text:
      return quoted(v.text);
    default:
      break;
  }
  const bool table = v.kind == Kind::Table;
  std::string out = table ? "{ " : "[";
  bool first = true;
  for (const auto& [key, item] : v.items) {
    if (!first) out += ", ";
    first = false;
    if (table) out += key_words(key) + " = ";
    out += in_line(item);
  }
  return out + (table ? " }" : "]");
}

void add_members(std::string& out, const Value& table) {
  for (const auto& [key, value] : table.items) out += key_words(key) + " = " + in_line(value) + '\n';
}

void collect(Value& node, const std::string& path, std::vector<Place>& out) {
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    Value& value = node.items[i].second;
    std::string here = path;
    if (node.kind == Kind::Table) {
      if (!here.empty()) here += '.';
      here += node.items[i].first;
      if (is_table_list(value)) here += "[]";
    } else if (!here.ends_with("[]")) {
      here += "[]";
    }
    out.push_back({&node, i, here});
    collect(value, here, out);
  }
}

}  // namespace

Value token(std::string text) {
  return {.kind = Kind::Token, .text = std::move(text)};
}
Value text(std::string text) {
  return {.kind = Kind::Text, .text = std::move(text)};
}
Value pair(const std::string& x, const std::string& y) {
  Value out{.kind = Kind::Array};
  out.items.emplace_back("", token(x));
  out.items.emplace_back("", token(y));
  return out;
}

Value* member(Value& table, std::string_view key) {
  if (table.kind != Kind::Table) return nullptr;
  for (auto& [name, value] : table.items)
    if (name == key) return &value;
  return nullptr;
}

Value& member_or_new(Value& table, const std::string& key) {
  if (Value* there = member(table, key)) return *there;
  return table.items.emplace_back(key, Value{}).second;
}

bool is_table_list(const Value& value) {
  return value.kind == Kind::Array && !value.items.empty() &&
         std::all_of(value.items.begin(), value.items.end(),
                     [](const auto& item) { return item.second.kind == Kind::Table; });
}

Value read_toml(std::string_view text) {
  return from_table(toml::parse(text, std::string_view("corpus")));
}

std::string write_toml(const Value& document) {
  std::string out, headed;
  for (const auto& [key, value] : document.items) {
    if (value.kind == Kind::Table) {
      headed += fmt::format("[{}]\n", key_words(key));
      add_members(headed, value);
    } else if (is_table_list(value)) {
      for (const auto& [none, table] : value.items) {
        headed += fmt::format("[[{}]]\n", key_words(key));
        add_members(headed, table);
      }
    } else {
      out += key_words(key) + " = " + in_line(value) + '\n';
    }
  }
  return out + headed;
}

std::vector<Place> places(Value& document) {
  std::vector<Place> out;
  collect(document, "", out);
  return out;
}

}  // namespace kerf::fuzz
