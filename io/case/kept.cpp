#include "io/kept.hpp"

#include "io/case/named_files.hpp"
#include "io/case/write.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace kerf {

namespace {

namespace fs = std::filesystem;

/// Copies of the files that documents name, each once.
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
    std::string name = file.filename().string();
    const auto taken = [&](const auto& other) { return other.second == name; };
    for (int k = 2; std::any_of(name_of_.begin(), name_of_.end(), taken); ++k)
      name = fmt::format("{}_{}", k, file.filename().string());
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

KeptCase keep(const Case& c, const std::vector<std::string>& head) {
  KeptCase out;
  Node document = *c.document;
  Copies(out).take(document, c.folder, "input/");
  for (const std::string& line : head) out.text += fmt::format("# {}\n", line);
  out.text += fmt::format("title = {}\n", quoted(c.title));
  std::erase_if(document.entries, [](const Entry& e) { return e.key == "title"; });
  add_entries(document.entries, out.text);
  return out;
}

}  // namespace kerf
