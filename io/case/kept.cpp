// A copy of a case beside its results: the document with overrides in it, and copies of the files that it names under
// names of kerf's own, so that the folder runs again anywhere.

#include "io/kept.hpp"

#include "io/case/named_files.hpp"
#include "io/case/write.hpp"
#include "io/document.hpp"
#include "io/files.hpp"
#include "io/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>

namespace kerf {

namespace {

namespace fs = std::filesystem;

/// A name that means nothing to a shell or a folder: letters, digits, points, dashes; of a long one the end.
std::string plain(std::string name) {
  constexpr std::size_t longest = 60;
  // Of a copy the name before it was copied.
  const std::size_t digits = name.find_first_not_of("0123456789");
  if (digits != 0 && digits != std::string::npos && name[digits] == '_') name.erase(0, digits + 1);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
  return name.size() > longest ? name.substr(name.size() - longest) : name;
}

/// Copies of the files that documents name, each once, with names of kerf's own: 1_readings.csv.
class Copies {
 public:
  explicit Copies(KeptCase& out) : out_(out) {}

  /// `prefix`: from the document's folder to that of the copies.
  void take(Node& document, const fs::path& folder, const std::string& prefix) {
    for_each_file(document, [&](Node& name) { name.text = prefix + copy_of(folder / name.text); });
  }

 private:
  std::string copy_of(const fs::path& file) {
    const std::string source = fs::absolute(file).lexically_normal().string();
    if (const auto known = name_of_.find(source); known != name_of_.end()) return known->second;
    const std::string name = fmt::format("{}_{}", name_of_.size() + 1, plain(file.filename().string()));
    name_of_[source] = name;
    std::string bytes = file.extension() == ".toml" ? body_of(file) : read_file(file);
    out_.files.emplace_back("input/" + name, std::move(bytes));
    return name;
  }

  /// Of a design only its body counts.
  std::string body_of(const fs::path& file) {
    static constexpr std::string_view body[] = {"domain", "hole", "crack", "region", "material"};
    Node document = read_document(file);
    std::erase_if(document.entries, [](const Entry& e) { return std::ranges::find(body, e.key) == std::end(body); });
    take(document, file.parent_path(), "");
    std::string text;
    add_entries(document.entries, text);
    return text;
  }

  KeptCase& out_;
  std::map<std::string, std::string> name_of_;
};

}  // namespace

namespace {

KeptCase keep_document(Node document, const fs::path& folder, const std::string& title,
                       const std::vector<std::string>& head) {
  KeptCase out;
  Copies(out).take(document, folder, "input/");
  if (has_functions(document)) out.text += "# Not all of it: functions stand here as their names\n";
  for (const std::string& line : head) out.text += fmt::format("# {}\n", clean_text(line));
  out.text += fmt::format("title = {}\n", quoted(title));
  std::erase_if(document.entries, [](const Entry& e) { return e.key == "title"; });
  add_entries(document.entries, out.text);
  return out;
}

}  // namespace

KeptCase keep(const Case& c, const std::vector<std::string>& head) {
  return keep_document(*c.document, c.folder, c.title, head);
}

KeptCase keep_file(const fs::path& path, std::span<const std::string> overrides) {
  Node document = read_document(path);
  for (const std::string& assignment : overrides) override_value(document, assignment);
  std::string title = path.stem().string();
  for (const Entry& entry : document.entries)
    if (entry.key == "title") title = entry.value.text;
  return keep_document(std::move(document), path.parent_path(), title, {});
}

}  // namespace kerf
