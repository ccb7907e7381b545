// The table of keys as text: `kerf keys` for a terminal (lines of at most 100 columns), headings and facts in Markdown
// between the marks <!-- keys: --> of a document, and one key with its value, default, example and alternatives. A name
// that is not a path is searched for in all tables, so that `kerf keys radius` finds every radius; without any hit the
// nearest name is suggested.

#include "io/case/key_facts.hpp"
#include "io/case/keys.hpp"
#include "io/keys.hpp"
#include "io/words.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace kerf {

namespace {

using enum KeyType;
using View = std::string_view;

constexpr std::size_t columns = 100;

constexpr std::pair<KeyType, View> type_words[] = {{Table, "table"},
                                                   {Tables, "tables"},
                                                   {Boolean, "true or false"},
                                                   {Whole, "whole number"},
                                                   {Number, "number"},
                                                   {Text, "text"},
                                                   {Name, "name of letters, digits, _ . or -"},
                                                   {Names, "list of texts"},
                                                   {Pair, "[number, number]"},
                                                   {PointList, "[[x, y], ...]"},
                                                   {Numbers, "list of numbers"},
                                                   {Formula, "number or expression"},
                                                   {Vector, "pair of numbers or expressions"},
                                                   {Box, "number or [low, high]"},
                                                   {BoxPair, "pair of numbers or [low, high]"},
                                                   {BoxPairs, "list of pairs of numbers or [low, high]"},
                                                   {Formulas, "names with numbers or expressions"},
                                                   {Tensor, "3 or 4 numbers or expressions"}};

std::string quoted(KeyWords words) {
  return fmt::format("\"{}\"", fmt::join(words, "\", \""));
}

/// "[mesh]", "[[optimize.hole]]"; of a table inside an entry, which is written in braces, its path.
std::string header(View path) {
  const bool several = path.ends_with("[]");
  if (several) path.remove_suffix(2);
  if (path.find('[') != View::npos) return several ? fmt::format("{}[]", path) : std::string(path);
  return several ? fmt::format("[[{}]]", path) : fmt::format("[{}]", path);
}

/// "number, positive", "table, as hole[].circle".
std::string value_in_words(const Key& key) {
  std::vector<std::string> kinds;
  if (has(key.type, Word)) kinds.push_back(quoted(key.rules.words));
  for (const auto& [type, words] : type_words)
    if (has(key.type, type)) kinds.emplace_back(words);
  std::string out = fmt::format("{}", fmt::join(kinds, " or "));
  if (const std::string range = in_words(key.rules.range); !range.empty()) out += ", " + range;
  if (!key.rules.like.empty()) out += ", as " + header(key.rules.like);
  return out;
}

std::vector<View> split(View list) {
  std::vector<View> words;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find('|'), list.size());
    words.push_back(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return words;
}

/// `kind = "misfit"` where the words are those of a key beside it, else the words.
std::string goes_with(const Key& key) {
  const std::vector<View> words = split(key.rules.with);
  if (words.empty()) return "";
  for (const Key* beside : keys_in(parent(key.path))) {
    const KeyWords known = beside->rules.words;
    if (std::find(known.begin(), known.end(), words[0]) != known.end())
      return fmt::format("{} = {}", name(*beside), quoted(words));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Of the keys that exclude each other, "circle, ellipse, polygon".
std::string alternatives(const Key& key) {
  std::vector<View> names;
  if (key.rules.one_of)
    for (const Key* beside : keys_in(parent(key.path)))
      if (beside->rules.one_of) names.push_back(name(*beside));
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string default_in_words(const Key& key) {
  if (key.rules.required) return "none, it is needed";
  return std::string(key.otherwise);
}

/// Words in lines that begin with `indent` spaces (the first line is begun already) and end before column 100.
std::string wrapped(View text, std::size_t indent) {
  std::string out;
  std::size_t column = indent;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const bool first = column == indent;
    if (!first && column + 1 + end > columns) {
      out += '\n' + std::string(indent, ' ');
      column = indent;
    } else if (!first) {
      out += ' ';
      ++column;
    }
    out += text.substr(0, end);
    column += end;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out + '\n';
}

/// A row of a list of keys: what may stand there, and what it is if nothing does.
std::string summary_of(const Key& key) {
  std::string out = value_in_words(key);
  if (key.rules.required)
    out += "; needed";
  else if (!key.otherwise.empty())
    out += fmt::format("; default {}", key.otherwise);
  if (const std::string others = alternatives(key); !others.empty()) out += "; one of " + others;
  if (const std::string with = goes_with(key); !with.empty()) out += "; with " + with;
  return out;
}

/// A key and how it is called in its section: "adapt.error".
struct Listed {
  const Key* key;
  std::string name;
};

/// The own keys of a table, those of tables in braces after them; tables of the form [[ ]] without their keys.
void list_keys(View table, const std::string& prefix, std::vector<Listed>& out) {
  for (const Key& key : all_keys()) {
    if (parent(key.path) != table || key.path == table) continue;
    const std::string called = prefix + std::string(name(key));
    out.push_back({&key, called});
    if (!has(key.type, Tables)) list_keys(key.path, called + ".", out);
    const std::string entry = std::string(key.path) + "[]";
    if (has(key.type, PointList)) list_keys(entry, called + "[].", out);
    if (has(key.type, Tables) && !key.rules.like.empty()) list_keys(key.path, called + "[].", out);
  }
}

/// A table with a header of its own.
bool is_section(const Key& key) {
  const bool top = parent(key.path).empty();
  return (has(key.type, Tables) && key.rules.like.empty()) ||
         (top && (has(key.type, Table) || has(key.type, Formulas)));
}

std::string as_list(const std::vector<Listed>& keys, bool with_text) {
  std::size_t width = 0;
  for (const Listed& l : keys) width = std::max(width, l.name.size());
  std::string out;
  for (const Listed& l : keys) {
    out += fmt::format("  {:<{}}  {}", l.name, width, wrapped(summary_of(*l.key), width + 4));
    if (with_text) out += fmt::format("{:{}}{}", "", width + 4, wrapped(l.key->text, width + 4));
  }
  return out;
}

std::string everything() {
  std::string out = "Keys of a case file; kerf keys NAME says more about one key or table.\n\n";
  std::vector<Listed> top;
  for (const Key* key : keys_in(""))
    if (!is_section(*key)) top.push_back({key, std::string(name(*key))});
  out += as_list(top, false);
  for (const Key& key : all_keys()) {
    if (!is_section(key)) continue;
    std::vector<Listed> keys;
    list_keys(key.path, "", keys);
    const std::string title = header(key.path);
    out += fmt::format("\n{}  {}{}", title, wrapped(key.text, title.size() + 2), as_list(keys, false));
  }
  return out;
}

/// What there is to say about one key, under the name by which it was found.
std::string about(const Key& key, const std::string& path) {
  const std::string title = has(key.type, Table) || has(key.type, Tables) ? header(path) : path;
  std::string out = fmt::format("{}\n  {}\n", title, wrapped(key.text, 2));
  const auto add = [&](View what, const std::string& text) {
    if (!text.empty()) out += fmt::format("  {:<11}{}", what, wrapped(text, 13));
  };
  add("value", value_in_words(key));
  if (const View unit = unit_of(key); unit != "none") add("unit", std::string(unit));
  add("default", default_in_words(key));
  if (!key.example.empty()) add("example", fmt::format("{} = {}", name(key), key.example));
  add("one of", alternatives(key));
  add("goes with", goes_with(key));
  add("refused", std::string(refused_with(key)));
  std::vector<Listed> keys;
  if (!key.rules.like.empty()) list_keys(key.rules.like, "", keys);
  list_keys(key.path, "", keys);
  if (has(key.type, PointList)) list_keys(std::string(key.path) + "[]", "", keys);
  if (!keys.empty()) out += fmt::format("\n{}", as_list(keys, true));
  return out;
}

/// A path without brackets and what is in them.
std::string plain(View path) {
  std::string out;
  int depth = 0;
  for (const char c : path) {
    if (c == ']') --depth;
    if (depth == 0 && c != ']' && c != '[') out += c;
    if (c == '[') ++depth;
  }
  return out;
}

/// The key that a path without brackets leads to, through tables that are like others, too; with its full path.
std::pair<const Key*, std::string> walk(View path) {
  std::string table;
  const Key* key = nullptr;
  while (!path.empty()) {
    const std::size_t end = std::min(path.find('.'), path.size());
    std::vector<const Key*> keys = keys_in(table);
    if (keys.empty()) keys = keys_in(table += "[]");
    const auto found =
        std::find_if(keys.begin(), keys.end(), [&](const Key* k) { return name(*k) == path.substr(0, end); });
    if (found == keys.end()) return {};
    key = *found;
    table += fmt::format("{}{}{}", table.empty() ? "" : ".", name(*key), key->path.ends_with("[]") ? "[]" : "");
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return {key, table};
}

/// Text in Markdown: what looks like a tag is none.
std::string escaped(View text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '*' ? "\\*" : std::string(1, c);
  return out;
}

/// A key under a heading of its full path, whose anchor is the path without dots and brackets.
std::string entry(const Key& key, View called) {
  std::string out =
      fmt::format("### `{}`\n\n{}\n\n**Value:** {}", called, escaped(key.text), escaped(value_in_words(key)));
  const auto add = [&](View what, View text) {
    if (!text.empty()) out += fmt::format(". **{}:** {}", what, text);
  };
  const View unit = unit_of(key);
  if (unit != "none") add("Unit", escaped(unit));
  add("Default", key.rules.required ? "none (needed)" : escaped(key.otherwise));
  add("One of", escaped(alternatives(key)));
  add("Goes with", escaped(goes_with(key)));
  if (!key.example.empty() && !has(key.type, Word) && !has(key.type, Boolean) && !has(key.type, Name))
    add("Example", fmt::format("`{}`", key.example));
  out += ".\n\n";
  if (const View refused = refused_with(key); !refused.empty())
    out += fmt::format("**Refused:** {}.\n\n", escaped(refused));
  return out;
}

std::string entries_of(View path, const Key& section) {
  std::vector<Listed> keys;
  list_keys(path, "", keys);
  std::string out = fmt::format("## `{}`\n\n{}\n\n", header(path), escaped(section.text));
  if (const View refused = refused_with(section); !refused.empty())
    out += fmt::format("**Refused:** {}.\n\n", escaped(refused));
  for (const Listed& l : keys) out += entry(*l.key, fmt::format("{}.{}", path, l.name));
  return out;
}

}  // namespace

std::string keys_as_text(std::string_view wanted) {
  if (wanted.empty()) return everything();
  std::string path = plain(wanted);
  if (path.empty()) path = std::string(wanted.substr(std::min(wanted.find_first_not_of('['), wanted.size())));
  path.erase(std::remove(path.begin(), path.end(), ']'), path.end());
  if (const auto [key, full] = walk(path); key) return about(*key, full);
  std::string out;
  std::vector<std::string> known, sections;
  for (const Key& key : all_keys()) {
    known.push_back(plain(key.path));
    known.emplace_back(name(key));
    if (parent(key.path).empty()) sections.emplace_back(name(key));
    if (name(key) == path) out += fmt::format("{}{}", out.empty() ? "" : "\n", about(key, std::string(key.path)));
  }
  if (!out.empty()) return out;
  std::string near = suggest(path, known);
  if (!near.starts_with("did you mean")) near = suggest(path, sections);
  throw Error(Fault::Usage, fmt::format("unknown key {}; {}", quote(wanted), near));
}

std::string keys_as_markdown(const std::vector<std::string>& tables) {
  std::string out;
  for (const Key& key : all_keys()) {
    const std::string section = plain(key.path);
    const bool wanted = tables.empty() || std::any_of(tables.begin(), tables.end(), [&](const std::string& table) {
                          return section == table || section.starts_with(table + ".");
                        });
    if (wanted && is_section(key)) out += entries_of(key.path, key);
    if (wanted && parent(key.path).empty() && !is_section(key)) out += entry(key, name(key));
  }
  return out;
}

std::string with_key_tables(std::string_view document) {
  constexpr View begin = "<!-- keys:", finish = "<!-- end of keys -->";
  std::string out;
  while (true) {
    const std::size_t at = document.find(begin);
    if (at == View::npos) return out + std::string(document);
    const std::size_t line = document.find('\n', at), end = document.find(finish, at);
    if (end == View::npos || line > end)
      throw Error(Fault::Usage, fmt::format("a line {} is missing after {}", finish, begin));
    std::vector<std::string> tables;
    View list = document.substr(at + begin.size(), line - at - begin.size());
    while (!list.empty()) {
      const std::size_t stop = std::min(list.find(' '), list.size());
      if (const View word = list.substr(0, stop); !word.empty() && word != "-->") tables.emplace_back(word);
      list.remove_prefix(std::min(stop + 1, list.size()));
    }
    out += fmt::format("{}\n\n{}{}", document.substr(0, line), keys_as_markdown(tables), finish);
    document.remove_prefix(end + finish.size());
  }
}

}  // namespace kerf
