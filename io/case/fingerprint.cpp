// The fingerprint of a case: a checksum of its document with the keys in alphabetical order and the contents of files
// in the place of their names.

#include "io/case/fingerprint.hpp"

#include "io/case/named_files.hpp"
#include "io/files.hpp"
#include "optimize/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace kerf {

namespace {

/// Everything with its kind and its length, so that no two documents give the same text.
void append(std::string& out, const Node& node, const std::string& path, const std::filesystem::path& folder) {
  const auto append_text = [&out](const std::string& text) { out += fmt::format("{}:{}", text.size(), text); };
  const auto begin = [&](char kind, std::size_t count) { out += fmt::format("{}{},", kind, count); };
  switch (node.kind) {
    case Node::Kind::Boolean:
      return begin('b', node.boolean ? 1 : 0);
    case Node::Kind::Integer:  // 1 and 1.0 mean the same
    case Node::Kind::Float:
      return begin('n', std::bit_cast<std::uint64_t>(node.number + 0.0));
    case Node::Kind::String:
    case Node::Kind::Date:
    case Node::Kind::Function:
      begin('s', 0);
      // Of files their contents count: a copy of the case elsewhere goes on with the same optimization.
      append_text(names_file(path, node.text) && std::filesystem::is_regular_file(folder / node.text)
                      ? read_file(folder / node.text)
                      : node.text);
      return;
    case Node::Kind::Array:
      begin('a', node.items.size());
      for (const Node& item : node.items) append(out, item, path, folder);
      return;
    case Node::Kind::Table:
      break;
  }
  std::vector<const Entry*> entries;
  for (const Entry& entry : node.entries) {
    const std::string inner = path + "." + entry.key;
    if (inner != ".title" && inner != ".output" && inner != ".probe" && inner != ".optimize.max_iterations")
      entries.push_back(&entry);
  }
  std::sort(entries.begin(), entries.end(), [](const Entry* a, const Entry* b) { return a->key < b->key; });
  begin('t', entries.size());
  for (const Entry* entry : entries) {
    append_text(entry->key);
    append(out, entry->value, path + "." + entry->key, folder);
  }
}

}  // namespace

std::string fingerprint(const Node& document, const std::filesystem::path& folder) {
  std::string text;
  append(text, document, "", folder);
  return fmt::format("{:016x}", checksum(text));
}

}  // namespace kerf
