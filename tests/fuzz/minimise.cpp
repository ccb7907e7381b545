// Greedy search for a small input that still fails: options, nodes of the case file (each one left out, then made a
// simple number), files, and pieces of half, a quarter, ... of their bytes are left out as long as the fault stays the
// same. It ends when a whole round removes nothing.

#include "tests/fuzz/minimise.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

namespace kerf::fuzz {

namespace {

using Fails = std::function<bool(const Input&)>;

/// Keeps the change when the input still fails.
bool keep(Input& input, Input changed, const Fails& fails) {
  if (!fails(changed)) return false;
  input = std::move(changed);
  return true;
}

bool fewer_arguments(Input& input, const Fails& fails) {
  bool any = false;
  for (std::size_t length : {2, 1})
    for (std::size_t i = 2; i + length <= input.arguments.size();) {
      Input less = input;
      const auto at = less.arguments.begin() + static_cast<std::ptrdiff_t>(i);
      less.arguments.erase(at, at + static_cast<std::ptrdiff_t>(length));
      if (keep(input, std::move(less), fails))
        any = true;
      else
        ++i;
    }
  return any;
}

std::optional<Value> tree_of(const Input& input) {
  try {
    return read_toml(input.files.at("case.toml"));
  } catch (const std::exception&) {
    return {};
  }
}

Input with_tree(const Input& input, const Value& tree) {
  Input out = input;
  out.files["case.toml"] = write_toml(tree);
  return out;
}

/// Node by node, the large ones first.
bool smaller_tree(Input& input, const Fails& fails) {
  std::optional<Value> tree = tree_of(input);
  if (!tree) return false;
  bool any = false;
  for (std::size_t i = 0; i < places(*tree).size();) {
    Value less = *tree;
    const Place place = places(less)[i];
    place.parent->items.erase(place.parent->items.begin() + static_cast<std::ptrdiff_t>(place.index));
    if (keep(input, with_tree(input, less), fails)) {
      any = true;
      tree = std::move(less);
    } else {
      ++i;
    }
  }
  for (std::size_t i = 0; i < places(*tree).size(); ++i)
    for (const char* simple : {"0", "1", "0.5", "10"}) {
      Value less = *tree;
      Value& v = places(less)[i].value();
      if (v.kind == Value::Kind::Array || v.kind == Value::Kind::Table ||
          v.text.size() <= std::string_view(simple).size())
        continue;
      v.text = simple;
      if (!keep(input, with_tree(input, less), fails)) continue;
      any = true;
      tree = std::move(less);
      break;
    }
  return any;
}

/// Pieces of half, a quarter, ... of a file.
bool smaller_bytes(Input& input, const std::string& name, const Fails& fails) {
  bool any = false;
  for (std::size_t piece = input.files[name].size() / 2; piece > 0; piece /= 2)
    for (std::size_t at = 0; at < input.files[name].size();) {
      Input less = input;
      less.files[name].erase(at, piece);
      if (keep(input, std::move(less), fails))
        any = true;
      else
        at += piece;
      if (input.files[name].size() > 4000 && piece < 16) return any;  // of a mesh, lines are enough
    }
  return any;
}

}  // namespace

Input minimise(Input input, const Fails& fails) {
  for (bool any = true; any;) {
    any = fewer_arguments(input, fails);
    any = smaller_tree(input, fails) || any;
    std::vector<std::string> names;
    for (const auto& [name, bytes] : input.files) names.push_back(name);
    for (const std::string& name : names) {
      if (name == "case.toml" && tree_of(input)) continue;
      Input without = input;
      without.files.erase(name);
      if (name != "case.toml" && keep(input, std::move(without), fails))
        any = true;
      else
        any = smaller_bytes(input, name, fails) || any;
    }
  }
  return input;
}

}  // namespace kerf::fuzz
