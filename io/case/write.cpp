// Nodes of a document as TOML, numbers with as many digits as read back to the same bits.

#include "io/case/write.hpp"

#include <fmt/format.h>

namespace kerf {

std::string number(double x) {
  const std::string text = fmt::format("{}", x);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += fmt::format("\\{}", c);
    else if (static_cast<unsigned char>(c) < 32 || c == 127)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + "\"";
}

std::string inline_text(const Node& node) {
  std::vector<std::string> parts;
  switch (node.kind) {
    case Node::Kind::Boolean:
      return node.boolean ? "true" : "false";
    case Node::Kind::Integer:
      return fmt::format("{:.0f}", node.number);
    case Node::Kind::Float:
      return number(node.number);
    case Node::Kind::String:
    case Node::Kind::Function:  // what it is called: a file cannot have more of it
      return quoted(node.text);
    case Node::Kind::Date:
      return node.text;
    case Node::Kind::Array:
      for (const Node& item : node.items) parts.push_back(inline_text(item));
      return fmt::format("[{}]", fmt::join(parts, ", "));
    case Node::Kind::Table:
      break;
  }
  for (const Entry& entry : node.entries)
    parts.push_back(fmt::format("{} = {}", quoted(entry.key), inline_text(entry.value)));
  return fmt::format("{{ {} }}", fmt::join(parts, ", "));
}

namespace {

void add_table(const std::string& header, const Node& table, std::string& out) {
  out += header + "\n";
  for (const Entry& entry : table.entries) out += fmt::format("{} = {}\n", entry.key, inline_text(entry.value));
  out += "\n";
}

}  // namespace

void add_entry(const Entry& entry, std::string& out) {
  if (entry.value.kind == Node::Kind::Table) return add_table(fmt::format("[{}]", entry.key), entry.value, out);
  if (entry.value.kind == Node::Kind::Array) {
    for (const Node& table : entry.value.items) add_table(fmt::format("[[{}]]", entry.key), table, out);
    return;
  }
  out += fmt::format("{} = {}\n", entry.key, inline_text(entry.value));
}

void add_entries(const std::vector<Entry>& entries, std::string& out) {
  const auto single = [](const Entry& e) {
    return e.value.kind != Node::Kind::Table && e.value.kind != Node::Kind::Array;
  };
  for (const Entry& entry : entries)
    if (single(entry)) add_entry(entry, out);
  out += "\n";
  for (const Entry& entry : entries)
    if (!single(entry)) add_entry(entry, out);
  while (out.ends_with("\n\n")) out.pop_back();
}

}  // namespace kerf
