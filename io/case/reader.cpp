// Case files as plain data, by toml++ and nothing else of toml++. Every value remembers its line and column; a value
// that --set gives remembers the override instead. Entries are sorted by their place, since toml++ keeps them by name
// and messages go through a file from the top. Files are bounded before they are parsed: 64 MiB, regular (a pipe may
// never end), and dotted keys of at most 32 parts, since toml++ recurses into each part. What toml++ says of a mistake
// goes through plain_words (toml_words.cpp).

#include "io/case/reader.hpp"

#include "base/read_whole_file.hpp"
#include "io/case/named_files.hpp"
#include "io/case/toml_words.hpp"
#include "io/words.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <sstream>

namespace kerf {

namespace {

constexpr std::uintmax_t largest_file = 64u << 20;
constexpr int deepest_key = 32;

/// Parts of the longest dotted key outside strings and comments. toml++ makes a table of each part and recurses into
/// them; strings end at the line end here if they are not triple, as toml++ refuses those that do not.
int longest_dotted_key(std::string_view text) {
  int longest = 1, parts = 1;
  const auto starts = [&](std::size_t k, std::string_view what) { return text.substr(k, what.size()) == what; };
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (c == '#') {
      k = std::min(text.find('\n', k), text.size() - 1);
      parts = 1;
    } else if (c == '"' || c == '\'') {
      const std::string triple(3, c);
      const bool is_triple = starts(k, triple);
      k += is_triple ? 3 : 1;
      while (k < text.size() && !(is_triple ? starts(k, triple) : text[k] == c || text[k] == '\n'))
        k += c == '"' && text[k] == '\\' ? 2 : 1;
      if (is_triple) k += 2;
    } else if (c == '.') {
      longest = std::max(longest, ++parts);
    } else if (std::string_view(",=[]{}\n").find(c) != std::string_view::npos) {
      parts = 1;
    }
  }
  return longest;
}

/// Keys and names of files stand in messages as they are: nothing in them may be what a terminal obeys, or ends a text.
void require_printable(std::string_view text, const Position& position, std::string_view what) {
  if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }))
    throw Error(Fault::Usage, fmt::format("{}: {} {} has a control character; write it with letters and digits",
                                          to_string(position), what, quote(text)));
}

Node convert(const toml::node& node, const Position& whole) {
  // `whole` without a line stands for an override: everything in it is there.
  const auto place = [&](const toml::source_region& region) {
    return whole.line == 0 || !region.begin ? whole : Position{whole.source, region.begin.line, region.begin.column};
  };
  Node out;
  out.position = place(node.source());
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, value] : *table) {
      require_printable(key.str(), place(key.source()), "the key");
      out.entries.push_back({std::string(key.str()), place(key.source()), convert(value, whole)});
    }
    const auto earlier = [](const Entry& a, const Entry& b) {
      return std::pair(a.position.line, a.position.column) < std::pair(b.position.line, b.position.column);
    };
    std::stable_sort(out.entries.begin(), out.entries.end(), earlier);
  } else if (const toml::array* array = node.as_array()) {
    out.kind = Node::Kind::Array;
    for (const toml::node& item : *array) out.items.push_back(convert(item, whole));
  } else if (const auto* text = node.as_string()) {
    out.kind = Node::Kind::String;
    out.text = text->get();
  } else if (const auto* integer = node.as_integer()) {
    out.kind = Node::Kind::Integer;
    out.number = static_cast<double>(integer->get());
  } else if (const auto* number = node.as_floating_point()) {
    out.kind = Node::Kind::Float;
    out.number = number->get();
  } else if (const auto* boolean = node.as_boolean()) {
    out.kind = Node::Kind::Boolean;
    out.boolean = boolean->get();
  } else {
    out.kind = Node::Kind::Date;
    std::ostringstream words;
    if (const auto* date = node.as_date()) words << date->get();
    if (const auto* time = node.as_time()) words << time->get();
    if (const auto* moment = node.as_date_time()) words << moment->get();
    out.text = words.str();
  }
  return out;
}

std::string_view line_of(std::string_view text, std::uint32_t number) {
  for (; number > 1 && !text.empty(); --number) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return text.substr(0, text.find('\n'));
}

toml::table parse(std::string_view text, const Position& start) {
  try {
    if (longest_dotted_key(text) > deepest_key)
      throw Error(Fault::Usage, fmt::format("{}: a dotted key has more than {} parts", to_string(start), deepest_key));
    return toml::parse(text);  // with a name, toml++ ends the program when there is no memory for it
  } catch (const toml::parse_error& e) {
    const auto where = e.source().begin;
    std::string description(e.description());  // may quote a line end
    std::replace_if(
        description.begin(), description.end(), [](char c) { return c >= 0 && c < 32; }, ' ');
    throw Error(Fault::Usage,
                fmt::format("{}: {}", to_string({start.source, start.line == 0 ? 0 : where.line, where.column}),
                            plain_words(description, line_of(text, where.line), where.column)));
  }
}

struct Step {
  std::string key;  // or, if empty:
  std::size_t index = 0;
};

/// "crack[0].contact" -> crack, 0, contact
std::vector<Step> parse_path(std::string_view path, const std::string& override_name) {
  const auto fail = [&]() {
    throw Error(Fault::Usage, fmt::format("{}: {} is not the path of a key; write for example mesh.size=0.02 or "
                                          "crack[0].contact='\"open\"'",
                                          override_name, quote(path)));
  };
  const auto is_key = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  std::vector<Step> steps;
  std::size_t k = 0;
  while (k < path.size()) {
    if (path[k] == '[' && !steps.empty()) {
      Step step;
      const auto [end, error] = std::from_chars(path.data() + k + 1, path.data() + path.size(), step.index);
      k = static_cast<std::size_t>(end - path.data());
      if (error != std::errc() || k >= path.size() || path[k] != ']') fail();
      steps.push_back(step);
      ++k;
    } else {
      if (!steps.empty() && path[k++] != '.') fail();
      const std::size_t start = k;
      while (k < path.size() && is_key(path[k])) ++k;
      if (k == start) fail();
      steps.push_back({std::string(path.substr(start, k - start)), 0});
    }
  }
  if (steps.empty() || steps.size() > static_cast<std::size_t>(deepest_key)) fail();
  return steps;
}

}  // namespace

std::string to_string(const Position& p) {
  const std::string source = p.source ? *p.source : std::string("case");
  return p.line == 0 ? source : fmt::format("{}:{}:{}", source, p.line, p.column);
}

std::string read_text(const std::filesystem::path& path) {
  using Refusal = WholeFile::Refusal;
  const std::string name = path.string();
  const auto fail = [&](const std::string& what) { throw Error(Fault::Files, fmt::format("{}: {}", name, what)); };
  WholeFile file = read_whole_file(path, largest_file);
  if (file.refusal == Refusal::Missing) fail("no such file");
  if (file.refusal == Refusal::System && file.problem == EACCES) fail("cannot be opened; check its permissions");
  if (file.refusal == Refusal::System) fail("cannot be read: " + in_words(file));
  if (file.refusal == Refusal::Folder) fail("is a directory; name a file in it");
  if (file.refusal == Refusal::Special) fail("is not a regular file");
  if (file.refusal == Refusal::TooLarge) fail(fmt::format("is too large; at most {} MiB are read", largest_file >> 20));
  std::string text = std::move(file.bytes);
  // Marks of the encoding that editors on Windows put first.
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw Error(Fault::Usage, fmt::format("{}:1:1: the file is UTF-16; save it as UTF-8", name));
  return text;
}

Node read_document(const std::filesystem::path& path) {
  return parse_document(read_text(path), path.string());
}

Node parse_document(std::string_view text, const std::string& name) {
  const Position start{std::make_shared<const std::string>(name), 1, 1};
  Node document = convert(parse(text, start), start);
  for_each_file(document, [](const Node& name) { require_printable(name.text, name.position, "the name of a file"); });
  return document;
}

namespace {

/// The value of an override: TOML; or a number as shells and calculators write it (.5, 5.); or text without its quotes,
/// which the shell has eaten.
Node value_of(std::string_view text, const Position& origin) {
  const std::string name = to_string(origin);
  try {
    Node parsed = convert(parse(fmt::format("value = {}", text), origin), origin);
    if (parsed.entries.size() == 1) return std::move(parsed.entries[0].value);
  } catch (const Error&) {
  }
  Node value{.position = origin};
  const std::string_view digits = text.substr(text.starts_with("+") ? 1 : 0);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value.number);
  if (!digits.empty() && error == std::errc() && end == digits.data() + digits.size()) {
    value.kind = Node::Kind::Float;
    return value;
  }
  if (const std::string number = with_decimal_point(text); !number.empty())
    throw Error(Fault::Usage, fmt::format("{}: {}: a decimal comma? write {}", name, quote(text), number));
  const bool one_line = std::none_of(text.begin(), text.end(), [](unsigned char c) { return c < 32; });
  if (text.empty() || !one_line || std::string_view("\"'[{").find(text[0]) != std::string_view::npos)
    throw Error(Fault::Usage,
                fmt::format("{}: {} is no value; write a number, a word, or '[1, 2]'", name, quote(text)));
  value.kind = Node::Kind::String;
  value.text = std::string(text);
  return value;
}

/// The table of a list whose name that is: "c" of crack.c.path.
Node& entry_called(Node& list, const std::string& word, const std::string& override_name) {
  std::vector<std::string> names;
  for (Node& item : list.items)
    for (const Entry& entry : item.entries)
      if (entry.key == "name" && entry.value.kind == Node::Kind::String) {
        if (entry.value.text == word) return item;
        names.push_back(entry.value.text);
      }
  throw Error(Fault::Usage,
              fmt::format("{}: {} needs an index before it, counted from 0: [0].{}{}", override_name, quote(word), word,
                          names.empty() ? "" : fmt::format("; or a name: {}", fmt::join(names, ", "))));
}

}  // namespace

void override_value(Node& document, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos)
    throw Error(Fault::Usage, fmt::format("--set {}: a value is missing; write key=value", quote(assignment)));
  const std::string_view path = trim(assignment.substr(0, equals)), text = trim(assignment.substr(equals + 1));
  const bool printable = !path.empty() && path.size() < 100 &&
                         std::all_of(path.begin(), path.end(), [](char c) { return c > 32 && c < 127; });
  const std::string name = "--set " + (printable ? std::string(path) : quote(assignment));
  const std::vector<Step> steps = parse_path(path, name);
  const Position origin{std::make_shared<const std::string>(name), 0, 0};

  Node value = value_of(text, origin);

  Node* node = &document;
  for (const Step& step : steps) {
    if (step.key.empty()) {
      if (node->kind != Node::Kind::Array) throw Error(Fault::Usage, name + ": an index into what is no list");
      if (step.index >= node->items.size())
        throw Error(Fault::Usage, fmt::format("{}: there is no [{}]; the list has {} entries, counted from 0", name,
                                              step.index, node->items.size()));
      node = &node->items[step.index];
    } else {
      if (node->kind == Node::Kind::Array) {
        node = &entry_called(*node, step.key, name);
        continue;
      }
      if (node->kind != Node::Kind::Table)
        throw Error(Fault::Usage,
                    fmt::format("{}: {} would lie inside a value that is no table", name, quote(step.key)));
      const auto found = std::find_if(node->entries.begin(), node->entries.end(),
                                      [&](const Entry& entry) { return entry.key == step.key; });
      if (found != node->entries.end()) {
        node = &found->value;
      } else {
        Node table;
        table.position = origin;
        node->entries.push_back({step.key, origin, table});
        node = &node->entries.back().value;
      }
    }
  }
  *node = std::move(value);
}

}  // namespace kerf
