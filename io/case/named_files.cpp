// Which values of a case file are names of files.

#include "io/case/named_files.hpp"

namespace kerf {

bool names_file(std::string_view key, const std::string& text) {
  if (key.ends_with(".measured")) return text != "synthetic";
  return key.ends_with(".file") || key.ends_with(".start.design");
}

namespace {

void visit(Node& node, const std::string& key, const std::function<void(Node&)>& see) {
  if (node.kind == Node::Kind::String && names_file(key, node.text)) see(node);
  for (Node& item : node.items)
    if (item.kind == Node::Kind::Table) visit(item, key + "[]", see);
  for (Entry& entry : node.entries) visit(entry.value, key + "." + entry.key, see);
}

}  // namespace

void for_each_file(Node& document, const std::function<void(Node& name)>& see) {
  visit(document, "", see);
}

}  // namespace kerf
