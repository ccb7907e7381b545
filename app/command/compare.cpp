// Two runs side by side, from the files in their folders: the keys of the cases and the quantities of the results that
// differ, those that engineers read first above the others; and their pictures in pairs. Numbers that agree to twelve
// digits are the same. Times and memory are left out: no two runs agree in them.

#include "app/command/report.hpp"
#include "app/sweep/sweep_page.hpp"
#include "io/document.hpp"
#include "io/files.hpp"
#include "io/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace kerf {

namespace {

namespace fs = std::filesystem;

/// Values by their names, in the order of the first run, then what the second has more.
struct Paired {
  std::vector<std::string> names;
  std::map<std::string, std::array<std::string, 2>> values;
  void add(const std::string& name, int run, const std::string& value) {
    const auto [found, is_new] = values.try_emplace(name);
    if (is_new) names.push_back(name);
    found->second[static_cast<std::size_t>(run)] = value;
  }
};

/// Keys of a case with their values in TOML; entries of lists of tables by their name or number.
void add_keys(const Node& node, const std::string& path, int run, Paired& to) {
  const bool tables = node.kind == Node::Kind::Array && !node.items.empty() &&
                      std::ranges::all_of(node.items, [](const Node& n) { return n.kind == Node::Kind::Table; });
  if (node.kind == Node::Kind::Table) {
    for (const Entry& e : node.entries) add_keys(e.value, path.empty() ? e.key : path + "." + e.key, run, to);
  } else if (tables) {
    for (std::size_t k = 0; k < node.items.size(); ++k) {
      std::string name = std::to_string(k);
      for (const Entry& e : node.items[k].entries)
        if (e.key == "name" && e.value.kind == Node::Kind::String) name = e.value.text;
      add_keys(node.items[k], fmt::format("{}[{}]", path, name), run, to);
    }
  } else {
    to.add(path, run, inline_text(node));
  }
}

bool differ(const std::array<std::string, 2>& pair) {
  constexpr double digits = 1e-12;
  const auto a = number_in(pair[0]), b = number_in(pair[1]);
  if (a && b) return std::abs(*a - *b) > digits * std::max(std::abs(*a), std::abs(*b));
  return pair[0] != pair[1];
}

std::string change(const std::array<std::string, 2>& pair) {
  const auto a = number_in(pair[0]), b = number_in(pair[1]);
  if (!a || !b) return "";
  return *a == 0 ? fmt::format("{:+.4g}", *b - *a)
                 : fmt::format("{:+.4g} ({:+.3g} %)", *b - *a, 100 * (*b - *a) / std::abs(*a));
}

std::string shown_cell(const std::string& cell) {
  constexpr std::size_t longest = 120;
  if (const auto value = number_in(cell)) return fmt::format("{:.8g}", *value);
  if (cell.empty()) return "–";
  return escape_html(cell.size() > longest ? cell.substr(0, longest) + " ..." : cell);
}

/// Rows of what differs, of those names that `wanted` takes.
std::string rows_of(const Paired& all, const std::function<bool(const std::string&)>& wanted) {
  std::string out;
  for (const std::string& name : all.names) {
    const auto& pair = all.values.at(name);
    if (differ(pair) && wanted(name))
      out += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", escape_html(name),
                         shown_cell(pair[0]), shown_cell(pair[1]), change(pair));
  }
  return out;
}

std::string table_of_rows(const std::string& title, const std::string& rows, const std::string& none) {
  if (rows.empty()) return none.empty() ? none : fmt::format("<h2>{}</h2>\n<p>{}</p>\n", title, none);
  return fmt::format(
      "<h2>{}</h2>\n<div class=\"wide\"><table>\n<tr><th></th><th>A</th><th>B</th><th>change</th></tr>\n"
      "{}</table></div>\n",
      title, rows);
}

std::string pairs_of_pictures(const std::array<fs::path, 2>& folders, const fs::path& from) {
  std::string out;
  for (const char* picture : {"check.png", "von_mises.png", "map.png", "design.png", "growth.png", "edge_cracks.png"}) {
    if (!std::ranges::all_of(folders, [&](const fs::path& f) { return fs::exists(f / picture); })) continue;
    for (std::size_t k = 0; k < 2; ++k)
      out += fmt::format(
          "<figure><img loading=\"lazy\" src=\"{}\" alt=\"{} of {}\"><figcaption>{}: {}</figcaption></figure>\n",
          escape_html((fs::relative(folders[k], from) / picture).generic_string()), picture, k == 0 ? "A" : "B",
          k == 0 ? "A" : "B", picture);
  }
  return out.empty() ? out : fmt::format("<h2>Pictures</h2>\n<div class=\"grid two\">\n{}</div>\n", out);
}

}  // namespace

void write_comparison(const fs::path& a, const fs::path& b, const fs::path& page) {
  const std::array<fs::path, 2> folders{a, b};
  Paired keys, results;
  for (int run = 0; run < 2; ++run) {
    const fs::path& folder = folders[static_cast<std::size_t>(run)];
    require_result(folder);
    for (const Leaf& leaf : leaves_of_result(folder / "result.json")) results.add(leaf.name, run, leaf.value);
    if (fs::exists(folder / "case.toml")) add_keys(read_document(folder / "case.toml"), "", run, keys);
  }
  const auto of_machine = [](const std::string& name) {
    return name.starts_with("time_s") || name.starts_with("peak_memory");
  };
  const fs::path from = page.has_parent_path() ? page.parent_path() : fs::path(".");
  const std::string usual = rows_of(results, [](const std::string& name) { return is_usual(name); });
  const std::string others =
      rows_of(results, [&](const std::string& name) { return !is_usual(name) && !of_machine(name); });
  write_file(page,
             plain_page("Two runs compared",
                        fmt::format("<p>A: {}<br>B: {}</p>\n", escape_html(a.string()), escape_html(b.string())) +
                            table_of_rows("Keys of the case that differ",
                                          rows_of(keys, [](const std::string&) { return true; }),
                                          "None: the cases are the same.") +
                            table_of_rows("Quantities that differ", usual, "None: all agree to twelve digits.") +
                            pairs_of_pictures(folders, from) + table_of_rows("Other numbers that differ", others, "")));
}

}  // namespace kerf
